//! A scene, in the plane or in space.

use crate::error::{SceneError, Source};
use crate::file::SceneFile;
use crate::load_functions::NamedFunction;
use crate::points::three_numbers;
use crate::read::{name_of_file, named_text, syntax, text_of_file, text_of_stream};
use crate::scene_data::{PlaneScene, SpaceScene};
use dwell_kinetostatics::MagnitudeFunction;
use std::ops::Deref;
use std::path::Path;

/// The scene of a file. Its points have two numbers in the plane and three in space.
#[derive(Debug, Clone)]
pub enum Scene {
    /// In the plane.
    Plane(Box<PlaneScene>),
    /// In space.
    Space(Box<SpaceScene>),
}

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    /// [`SceneError`] when the file cannot be read, or is not a scene.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let (name, source) = text_of_file(path.as_ref())?;
        Self::build(name, &source)
    }

    /// Reads a scene from a stream, such as standard input: `name` is the name of the scene, `source_name` that of the
    /// stream in messages.
    ///
    /// # Errors
    /// [`SceneError`] when the stream cannot be read, or is not a scene.
    pub fn read_from(
        stream: impl std::io::Read,
        name: impl Into<String>,
        source_name: &str,
    ) -> Result<Self, SceneError> {
        let source = text_of_stream(stream, source_name)?;
        Self::build(name.into(), &source)
    }

    /// Reads the text of a scene. `source_name` is the file's name in messages.
    ///
    /// # Errors
    /// [`SceneError`] when it is not a scene.
    pub fn parse(source_name: &str, text: &str) -> Result<Self, SceneError> {
        let (name, source) = named_text(source_name, text);
        Self::build(name, &source)
    }

    fn build(name: String, source: &Source) -> Result<Self, SceneError> {
        let parsed = syntax(source)?;
        let root = parsed.get_ref();
        Ok(match three_numbers(root) {
            Some(_) => SpaceScene::of_root(name, source, root)?.into(),
            None => PlaneScene::of_root(name, source, root)?.into(),
        })
    }

    /// The name of the scene in a file: its stem, or its folder's name if it is `scene.toml`.
    pub fn name_of_file(path: &Path) -> String {
        name_of_file(path)
    }

    /// Renames its results.
    #[must_use]
    pub fn named(mut self, name: String) -> Self {
        match &mut self {
            Self::Plane(scene) => scene.file.name = name,
            Self::Space(scene) => scene.file.name = name,
        }
        self
    }

    /// This scene with several numbers replaced at once, in its own units, as by [`PlaneScene::with_values`].
    ///
    /// # Errors
    /// [`SceneError`] when a path does not exist or is named twice, a value is not finite, or the scene is invalid with
    /// these numbers.
    pub fn with_values(&self, values: &[(&str, f64)]) -> Result<Self, SceneError> {
        Ok(match self {
            Self::Plane(scene) => scene.with_values(values)?.into(),
            Self::Space(scene) => scene.with_values(values)?.into(),
        })
    }

    /// This scene with the magnitude of a load computed by `function` from `signals`: `t`, a coordinate such as `phi` (rad or m), or its
    /// velocity `phi.velocity`, in SI. The magnitude in the file is dropped. `breakpoints` are values of signals, by their names, at which
    /// the function jumps or has a kink.
    ///
    /// # Errors
    /// [`SceneError`] if there is no such load or signal, or a breakpoint belongs to another signal or is not finite.
    pub fn with_load_function(
        mut self,
        load: &str,
        signals: &[&str],
        function: MagnitudeFunction,
        breakpoints: &[(&str, &[f64])],
    ) -> Result<Self, SceneError> {
        let named = NamedFunction {
            load,
            signals,
            function,
            breakpoints,
        };
        match &mut self {
            Self::Plane(scene) => named.give_to(scene)?,
            Self::Space(scene) => named.give_to(scene)?,
        }
        Ok(self)
    }
}

impl Deref for Scene {
    type Target = SceneFile;

    fn deref(&self) -> &SceneFile {
        match self {
            Self::Plane(scene) => &scene.file,
            Self::Space(scene) => &scene.file,
        }
    }
}

impl From<PlaneScene> for Scene {
    fn from(scene: PlaneScene) -> Self {
        Self::Plane(Box::new(scene))
    }
}

impl From<SpaceScene> for Scene {
    fn from(scene: SpaceScene) -> Self {
        Self::Space(Box::new(scene))
    }
}
