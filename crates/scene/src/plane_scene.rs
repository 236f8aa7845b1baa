//! The scene as plain data.

use crate::file::SceneFile;
use dwell_geometry::{
    ActuatorId, AssemblyConfiguration, BodyId, Coordinate, Mechanism, Reaction, Vec2,
};
use dwell_kinetostatics::{Drive, Load, Mass, VaryingInertia};
use dwell_laws::Law;
use std::ops::Deref;

/// A scene: a mechanism, its masses, where it starts and what is asked of it. SI throughout; the
/// bodies, joints and actuators are in the order of the file.
#[derive(Debug, Clone)]
pub struct PlaneScene {
    /// Its file, with its name and title.
    pub file: SceneFile,
    /// Bodies, joints and actuators.
    pub mechanism: Mechanism,
    /// Of each body. The ground has none, whatever the file says.
    pub masses: Vec<Mass>,
    /// The bodies whose moment of inertia is a function of their angle, besides their constant one.
    pub varying_inertias: Vec<VaryingInertia>,
    /// The named points of each body, in its frame, m.
    pub points: Vec<Vec<(String, Vec2)>>,
    /// The named coordinates of `[coordinates]`. Every actuator's is one besides: see
    /// [`coordinate`](Self::coordinate).
    pub coordinates: Vec<NamedCoordinate>,
    /// Where and how the mechanism is put together.
    pub assembly: Assembly,
    /// The prescribed motion.
    pub prescribed: Option<PrescribedMotion>,
    /// The positions of kinematics, statics and kinetostatics without a prescribed motion.
    pub sweep: Option<CoordinateSweep>,
    /// The loads on the mechanism, and the friction in its joints.
    pub loads: Vec<Load>,
    /// What drives it in a free motion.
    pub drives: Vec<Drive>,
    /// The end stops of free coordinates.
    pub stops: Vec<NamedStop>,
    /// What is asked for.
    pub requests: Requests,
    /// The free motion.
    pub motion: Option<FreeMotionSpec>,
    /// The one fitted number.
    pub calibration: Option<Calibration>,
}

impl Deref for PlaneScene {
    type Target = SceneFile;

    fn deref(&self) -> &SceneFile {
        &self.file
    }
}

/// An end stop of an actuator's coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedStop {
    /// Its name.
    pub name: String,
    /// The actuator.
    pub actuator: ActuatorId,
    /// Lower limit, rad or m, if there is one.
    pub min: Option<f64>,
    /// Upper limit, rad or m, if there is one.
    pub max: Option<f64>,
    /// Coefficient of restitution, from 0 to 1.
    pub restitution: f64,
    /// Of one that yields: its stiffness (N·m/rad or N/m) and its damping (N·m·s/rad or N·s/m).
    pub yielding: Option<[f64; 2]>,
}

/// Where and how the mechanism is put together at the start; it picks the branch.
#[derive(Debug, Clone, PartialEq)]
pub struct Assembly {
    /// Exact coordinate of each actuator, rad or m.
    pub coordinates: Vec<f64>,
    /// Initial guess of the angle of each body, rad, where the scene gives one.
    pub initial_guess: Vec<Option<f64>>,
    /// Approximate travel, m, or direction, rad, of each joint, where the scene gives one.
    pub branch_hints: Vec<Option<f64>>,
}

impl Assembly {
    /// The same as a plan takes it.
    pub fn to_configuration(&self) -> AssemblyConfiguration {
        AssemblyConfiguration {
            q: self.coordinates.clone(),
            initial_guess: self.initial_guess.clone(),
            branch_hints: self.branch_hints.clone(),
        }
    }
}

/// What the scene asks for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Requests {
    /// Reactions: those named, in that order and each once, or else all of the mechanism's.
    pub reactions: Vec<Reaction>,
    /// Whether the scene names reactions: an analysis of forces then yields these, and no column that is not requested.
    pub lists_reactions: bool,
    /// Points whose paths are drawn.
    pub paths: Vec<PathPoint>,
    /// A body whose dwell is marked.
    pub dwell: Option<DwellRequest>,
    /// Names of the columns of the tables, each once; none: all of them. Whether they exist is for
    /// the level above to find out ([`SceneLocation::Variable`](crate::SceneLocation::Variable)).
    pub variables: Option<Vec<String>>,
    /// Links whose internal forces are requested.
    pub sections: Vec<SectionRequest>,
}

/// A point of a moving body whose path is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPoint<V = Vec2> {
    /// The body.
    pub body: BodyId,
    /// The point's name within the body.
    pub name: String,
    /// The point in the body's frame, m.
    pub at: V,
}

/// A dwell to be marked: where the body's angle stays within a fraction of its swing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DwellRequest {
    /// The body.
    pub body: BodyId,
    /// The fraction of the swing, between 0 and 1.
    pub relative_band: f64,
}

/// A line along a body, whose axial force, shear and bending moment are requested.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionRequest {
    /// The body, not the ground.
    pub body: BodyId,
    /// Names of the points it runs from and to.
    pub names: [String; 2],
    /// The points in the body's frame, m. They differ.
    pub points: [Vec2; 2],
}

/// A coordinate with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedCoordinate<C = Coordinate> {
    /// The name: no other coordinate's, no actuator's, no body's.
    pub name: String,
    /// What is measured.
    pub coordinate: C,
}

/// A prescribed motion from t = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct PrescribedMotion {
    /// How long it lasts, s, above zero.
    pub duration: f64,
    /// At how many times it is evaluated, the ends among them: two or more.
    pub points: usize,
    /// The coordinate of each actuator, rad or m, as a function of the time, s.
    pub laws: Vec<Law>,
}

/// Positions: one actuator is swept, the others are held.
#[derive(Debug, Clone, PartialEq)]
pub struct CoordinateSweep {
    /// The actuator that is swept.
    pub actuator: ActuatorId,
    /// From where to where, rad or m; none: over its range, or one revolution.
    pub range: Option<[f64; 2]>,
    /// Coordinate of each actuator, rad or m: where it is held, or the swept one's at assembly.
    pub fixed_coordinates: Vec<f64>,
    /// How many positions, the ends among them: two or more.
    pub points: usize,
    /// Speed of the swept actuator in kinematics and kinetostatics, rad/s or m/s, above zero.
    pub speed: f64,
}

/// A free motion.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeMotionSpec<C = Coordinate, R = Reaction> {
    /// Coordinate of each actuator at the start, rad or m; of a prescribed one, that of its law.
    pub initial_coordinates: Vec<f64>,
    /// Speed of each actuator at the start, rad/s or m/s; of a prescribed one, that of its law.
    pub initial_velocities: Vec<f64>,
    /// By actuator: the law it follows; none where it is free.
    pub laws: Vec<Option<Law>>,
    /// How long it lasts.
    pub duration: MotionDuration,
    /// The events that are located.
    pub events: Vec<NamedEvent<C, R>>,
}

/// An event of a free motion.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedEvent<C = Coordinate, R = Reaction> {
    /// The name.
    pub name: String,
    /// What makes it.
    pub trigger: EventTrigger<C, R>,
    /// Whether the motion ends with it.
    pub terminal: bool,
}

/// What makes an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EventTrigger<C = Coordinate, R = Reaction> {
    /// A coordinate passes a value, rad or m.
    Reaches(C, f64),
    /// The speed of a coordinate changes its sign.
    Reversal(C),
    /// A reaction passes a value, N or N·m.
    Reaction(R, f64),
    /// A coordinate completes a whole revolution from where it started.
    Revolution(C),
}

/// How long a motion lasts. Above zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotionDuration {
    /// So many periods of the free motion.
    Periods(f64),
    /// So many seconds.
    Seconds(f64),
}

/// A number of the scene fitted so that the free motion has a given period.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The number, as [`PlaneScene::value`] takes it.
    pub path: String,
    /// The period, s.
    pub period: f64,
}

impl PlaneScene {
    /// The coordinate of that name: an actuator's, or one of `[coordinates]`.
    pub fn coordinate(&self, name: &str) -> Option<Coordinate> {
        let mut named = self.all_coordinates();
        named.find(|(n, _)| *n == name).map(|(_, c)| c)
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
        let named = self
            .coordinates
            .iter()
            .map(|c| (c.name.as_str(), c.coordinate));
        actuators
            .map(|a| (a.name.as_str(), a.coordinate()))
            .chain(named)
    }
}
