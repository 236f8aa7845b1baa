//! A scene in space as plain data, and a scene of either kind.

use crate::error::{SceneError, Source};
use crate::file::SceneFile;
use crate::scene::Scene;
use dwell_geometry::space::{Assembly, Mechanism, Vec3};
use dwell_kinetostatics::space::{LoadKind, Mass, Reaction};
use std::ops::Deref;
use std::path::Path;

/// A scene of a mechanism in space. SI throughout; the bodies, joints and actuators are in the order of the file.
#[derive(Debug, Clone)]
pub struct SpaceScene {
    /// Its file, with its name and title.
    pub file: SceneFile,
    /// Bodies, joints and actuators.
    pub mechanism: Mechanism,
    /// Of each body. The ground has none, whatever the file says.
    pub masses: Vec<Mass>,
    /// The named points of each body, in its frame, m.
    pub points: Vec<Vec<(String, Vec3)>>,
    /// Where the mechanism is assembled.
    pub assembly: Assembly,
    /// The loads.
    pub loads: Vec<NamedLoad>,
    /// The requested reactions.
    pub reactions: Vec<Reaction>,
    /// Whether the file lists the reactions; otherwise all in the axes of the ground are requested.
    pub lists_reactions: bool,
}

/// A load of a scene in space.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedLoad {
    /// Its name.
    pub name: String,
    /// How a unit of it acts.
    pub kind: LoadKind,
    /// Its magnitude: N, N·m, or m/s².
    pub magnitude: f64,
}

impl Deref for SpaceScene {
    type Target = SceneFile;

    fn deref(&self) -> &SceneFile {
        &self.file
    }
}

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

    fn build(name: String, source: &Source) -> Result<Self, SceneError> {
        Ok(match super::build::is_in_space(source)? {
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
        let at = at.and_then(|root| super::build::three_numbers(root.get_ref()));
        crate::build::planar_only(&self.source, at.unwrap_or_default())
    }

    /// The name of a reaction: `joint.component`.
    pub fn reaction_name(&self, reaction: Reaction) -> String {
        let joint = &self.mechanism.joints[reaction.joint.0].name;
        format!(
            "{joint}.{}",
            super::requests::component_name(reaction.component)
        )
    }
}
