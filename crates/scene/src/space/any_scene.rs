//! Reading a scene in space, or of either kind.

use super::scene::SpaceScene;
use crate::error::{SceneError, Source};
use crate::file::SceneFile;
use crate::scene::Scene;
use std::path::Path;

/// A scene in the plane or in space.
#[derive(Debug, Clone)]
pub enum AnyScene {
    /// In the plane.
    Plane(Box<Scene>),
    /// In space.
    Space(Box<SpaceScene>),
}

impl AnyScene {
    /// Reads a scene from a file, as [`Scene::read`] does.
    ///
    /// # Errors
    /// [`SceneError`] when the file cannot be read, or is not a scene.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let (name, source) = Scene::text_of_file(path.as_ref())?;
        Self::build(name, &source)
    }

    /// Reads a scene from a stream, as [`Scene::read_from`] does.
    ///
    /// # Errors
    /// [`SceneError`] when the stream cannot be read, or is not a scene.
    pub fn read_from(
        stream: impl std::io::Read,
        name: impl Into<String>,
        source_name: &str,
    ) -> Result<Self, SceneError> {
        let source = Scene::text_of_stream(stream, source_name)?;
        Self::build(name.into(), &source)
    }

    /// The scene in a text, as [`Scene::parse`] does.
    ///
    /// # Errors
    /// [`SceneError`] when it is not a scene.
    pub fn parse(source_name: &str, text: &str) -> Result<Self, SceneError> {
        let (name, source) = Scene::named_text(source_name, text);
        Self::build(name, &source)
    }

    fn build(name: String, source: &Source) -> Result<Self, SceneError> {
        Ok(match super::points::is_in_space(source)? {
            true => Self::Space(Box::new(SpaceScene::build(name, source)?)),
            false => Self::Plane(Box::new(Scene::build(name, source)?)),
        })
    }

    /// Its file.
    pub fn file(&self) -> &SceneFile {
        match self {
            Self::Plane(scene) => &scene.file,
            Self::Space(scene) => &scene.file,
        }
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
}

impl SpaceScene {
    /// Reads a scene in space from a file.
    ///
    /// # Errors
    /// [`SceneError`] when the file cannot be read, or is not a scene in space.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let (name, source) = Scene::text_of_file(path.as_ref())?;
        Self::build(name, &source)
    }

    /// The scene in a text, named after `source_name`.
    ///
    /// # Errors
    /// [`SceneError`] when it is not a scene in space.
    pub fn parse(source_name: &str, text: &str) -> Result<Self, SceneError> {
        let (name, source) = Scene::named_text(source_name, text);
        Self::build(name, &source)
    }

    /// The error of what takes only scenes in the plane.
    pub fn planar_only(&self) -> SceneError {
        let at = crate::read::syntax(&self.source).ok();
        let at = at.and_then(|root| super::points::three_numbers(root.get_ref()));
        super::points::planar_only(&self.source, at.unwrap_or_default())
    }
}
