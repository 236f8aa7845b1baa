//! A scene in space as plain data.

use crate::error::SceneError;
use crate::file::SceneFile;
use crate::plane_scene::{
    CoordinateSweep, FreeMotionSpec, NamedCoordinate, NamedStop, PathPoint, PrescribedMotion,
};
use crate::read::{named_text, text_of_file};
use dwell_geometry::space::{Assembly, Coordinate, Mechanism, Vec3};
use dwell_kinetostatics::Drive;
use dwell_kinetostatics::space::{Load, Mass, Reaction};
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
    /// The named coordinates of `[coordinates]`. Every actuator's is one besides.
    pub coordinates: Vec<NamedCoordinate<Coordinate>>,
    /// The prescribed motion.
    pub prescribed: Option<PrescribedMotion>,
    /// The positions of kinematics, statics and kinetostatics without a prescribed motion.
    pub sweep: Option<CoordinateSweep>,
    /// The loads.
    pub loads: Vec<Load>,
    /// What drives it in a free motion.
    pub drives: Vec<Drive<Coordinate>>,
    /// The end stops of free coordinates.
    pub stops: Vec<NamedStop>,
    /// The free motion.
    pub motion: Option<FreeMotionSpec<Coordinate, Reaction>>,
    /// The requested reactions.
    pub reactions: Vec<Reaction>,
    /// Whether the file lists the reactions; otherwise all in the axes of the ground are requested.
    pub lists_reactions: bool,
    /// The points whose paths are drawn; all where there are none.
    pub paths: Vec<SpacePathPoint>,
    /// The requested columns; all where there is no list.
    pub variables: Option<Vec<String>>,
}

/// A point of a moving body in space whose path is drawn.
pub type SpacePathPoint = PathPoint<Vec3>;

impl Deref for SpaceScene {
    type Target = SceneFile;

    fn deref(&self) -> &SceneFile {
        &self.file
    }
}

impl SpaceScene {
    /// Reads a scene in space from a file.
    ///
    /// # Errors
    /// [`SceneError`] when the file cannot be read, or is not a scene in space.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let (name, source) = text_of_file(path.as_ref())?;
        Self::build(name, &source)
    }

    /// Reads the text of a scene in space. `source_name` is the file's name in messages.
    ///
    /// # Errors
    /// [`SceneError`] when it is not a scene in space.
    pub fn parse(source_name: &str, text: &str) -> Result<Self, SceneError> {
        let (name, source) = named_text(source_name, text);
        Self::build(name, &source)
    }

    /// The error of what takes only scenes in the plane.
    pub fn planar_only(&self) -> SceneError {
        let at = crate::read::syntax(&self.source).ok();
        let at = at.and_then(|root| super::points::three_numbers(root.get_ref()));
        super::points::planar_only(&self.source, at.unwrap_or_default())
    }

    /// The name of a coordinate: an actuator's, or one of `[coordinates]`; empty if it has none.
    pub fn name_of(&self, coordinate: Coordinate) -> String {
        let mut named = self.all_coordinates();
        let found = named.find(|(_, c)| *c == coordinate);
        found.map_or_else(String::new, |(name, _)| name.to_owned())
    }

    /// Every coordinate that has a name, those of the actuators first.
    pub fn all_coordinates(&self) -> impl Iterator<Item = (&str, Coordinate)> + Clone {
        let actuators = self.mechanism.actuators.iter();
        let actuators = actuators.map(|a| {
            let joint = &self.mechanism.joints[a.kind.joint().0];
            (a.name.as_str(), a.kind.coordinate(joint))
        });
        let named = self.coordinates.iter();
        actuators.chain(named.map(|c| (c.name.as_str(), c.coordinate)))
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
