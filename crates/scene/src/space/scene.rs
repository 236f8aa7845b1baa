//! A scene in space as plain data.

use crate::file::SceneFile;
use crate::scene::{CoordinateSweep, PrescribedMotion};
use dwell_geometry::space::{Assembly, Mechanism, Vec3};
use dwell_kinetostatics::space::{LoadKind, Mass, Reaction};
use std::ops::Deref;

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
    /// The prescribed motion of `[prescribed]`.
    pub prescribed: Option<PrescribedMotion>,
    /// The sweep of `[coordinate-sweep]`.
    pub sweep: Option<CoordinateSweep>,
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

impl SpaceScene {
    /// The name of a reaction: `joint.component`.
    pub fn reaction_name(&self, reaction: Reaction) -> String {
        let joint = &self.mechanism.joints[reaction.joint.0].name;
        format!(
            "{joint}.{}",
            super::requests::component_name(reaction.component)
        )
    }
}
