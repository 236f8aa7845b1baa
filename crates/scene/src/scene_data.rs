//! The scene as plain data.

use crate::dimensions::{Dimensions, Plane, Space};
use crate::file::SceneFile;
use dwell_geometry::space::Vec3;
use dwell_geometry::{
    ActuatorId, AssemblyConfiguration, BodyId, Coordinate, Mechanism, Reaction, Vec2, space,
};
use dwell_kinetostatics::space as kinetostatics_in_space;
use dwell_kinetostatics::{Drive, Load, LoadKind, Mass, VaryingInertia};
use dwell_laws::Law;
use std::ops::Deref;

/// A scene in the plane or in space: a mechanism, its masses, its assembly, its motions and the requests. SI units
/// throughout; the bodies, joints and actuators are in the order of the file.
#[derive(Debug, Clone)]
pub struct SceneIn<D: Dimensions> {
    /// Its file, with its name and title.
    pub file: SceneFile,
    /// Bodies, joints and actuators.
    pub mechanism: D::Mechanism,
    /// The mass of each body. The ground has none, even if the file states one.
    pub masses: Vec<D::Mass>,
    /// The bodies whose moment of inertia is a function of their angle, in addition to their constant one; empty in
    /// space.
    pub varying_inertias: Vec<VaryingInertia>,
    /// The named points of each body, in its frame, m.
    pub points: Vec<Vec<(String, D::Point)>>,
    /// The named coordinates of `[coordinates]`. The coordinates of actuators are not included: see
    /// [`coordinate`](Self::coordinate).
    pub coordinates: Vec<NamedCoordinate<D::Coordinate>>,
    /// Where and how the mechanism is put together.
    pub assembly: D::Assembly,
    /// The prescribed motion.
    pub prescribed: Option<PrescribedMotion>,
    /// The positions of kinematics, statics and kinetostatics without a prescribed motion.
    pub sweep: Option<CoordinateSweep>,
    /// The loads on the mechanism, and the friction in its joints.
    pub loads: Vec<Load<D::LoadKind, D::Coordinate>>,
    /// Its drives in a free motion.
    pub drives: Vec<Drive<D::Coordinate>>,
    /// The end stops of free coordinates.
    pub stops: Vec<NamedStop>,
    /// The requests.
    pub requests: Requests<D::Point, D::Reaction>,
    /// The free motion.
    pub motion: Option<FreeMotionSpec<D::Coordinate, D::Reaction>>,
    /// The one fitted number; none in space.
    pub calibration: Option<Calibration>,
}

/// A scene in the plane.
pub type PlaneScene = SceneIn<Plane>;

/// A scene in space.
pub type SpaceScene = SceneIn<Space>;

impl<D: Dimensions> Deref for SceneIn<D> {
    type Target = SceneFile;

    fn deref(&self) -> &SceneFile {
        &self.file
    }
}

impl Dimensions for Plane {
    type Point = Vec2;
    type Mass = Mass;
    type Mechanism = Mechanism;
    type Assembly = Assembly;
    type Coordinate = Coordinate;
    type Reaction = Reaction;
    type LoadKind = LoadKind;
}

impl Dimensions for Space {
    type Point = Vec3;
    type Mass = kinetostatics_in_space::Mass;
    type Mechanism = space::Mechanism;
    type Assembly = space::Assembly;
    type Coordinate = space::Coordinate;
    type Reaction = kinetostatics_in_space::Reaction;
    type LoadKind = kinetostatics_in_space::LoadKind;
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
    /// For a compliant stop: its stiffness (N·m/rad or N/m) and its damping (N·m·s/rad or N·s/m).
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
    /// The assembly in the form of a plan.
    pub fn to_configuration(&self) -> AssemblyConfiguration {
        AssemblyConfiguration {
            q: self.coordinates.clone(),
            initial_guess: self.initial_guess.clone(),
            branch_hints: self.branch_hints.clone(),
        }
    }
}

/// The requests of the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Requests<V = Vec2, R = Reaction> {
    /// Reactions: those named, in that order and each once, or else all of the mechanism's, in space in the axes of the ground.
    pub reactions: Vec<R>,
    /// Whether the scene names reactions: an analysis of forces then yields these, and no column that is not requested.
    pub lists_reactions: bool,
    /// Points whose paths are drawn; in space, all points if the list is empty.
    pub paths: Vec<PathPoint<V>>,
    /// A body whose dwell is marked; none in space.
    pub dwell: Option<DwellRequest>,
    /// Names of the columns of the tables, each once; none: all of them. Whether they exist is for
    /// the level above to find out ([`SceneLocation::Variable`](crate::SceneLocation::Variable)).
    pub variables: Option<Vec<String>>,
    /// Links whose internal forces are requested; none in space.
    pub sections: Vec<SectionRequest<V>>,
}

impl<V, R> Default for Requests<V, R> {
    fn default() -> Self {
        Self {
            reactions: Vec::new(),
            lists_reactions: false,
            paths: Vec::new(),
            dwell: None,
            variables: None,
            sections: Vec::new(),
        }
    }
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

/// A point of a moving body in space whose path is drawn.
pub type SpacePathPoint = PathPoint<Vec3>;

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
pub struct SectionRequest<V = Vec2> {
    /// The body, not the ground.
    pub body: BodyId,
    /// Names of the points it runs from and to.
    pub names: [String; 2],
    /// The points in the body's frame, m. They differ.
    pub points: [V; 2],
}

/// A coordinate with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedCoordinate<C = Coordinate> {
    /// The name: no other coordinate's, no actuator's, no body's.
    pub name: String,
    /// The measured coordinate.
    pub coordinate: C,
}

/// A prescribed motion from t = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct PrescribedMotion {
    /// How long it lasts, s, above zero.
    pub duration: f64,
    /// Number of times at which it is evaluated, including the ends: two or more.
    pub points: usize,
    /// The coordinate of each actuator, rad or m, as a function of the time, s.
    pub laws: Vec<Law>,
}

/// Positions: one actuator is swept, the others are held.
#[derive(Debug, Clone, PartialEq)]
pub struct CoordinateSweep {
    /// The actuator that is swept.
    pub actuator: ActuatorId,
    /// First and last coordinate, rad or m; `None` for its range, or one revolution.
    pub range: Option<[f64; 2]>,
    /// Coordinate of each actuator, rad or m: the fixed value, or, for the swept one, that at assembly.
    pub fixed_coordinates: Vec<f64>,
    /// How many positions, the ends among them: two or more.
    pub points: usize,
    /// Speed of the swept actuator in kinematics and kinetostatics, rad/s or m/s, above zero.
    pub speed: f64,
}

/// A free motion.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeMotionSpec<C = Coordinate, R = Reaction> {
    /// Coordinate of each actuator at the start, rad or m; for a prescribed one, that of its law.
    pub initial_coordinates: Vec<f64>,
    /// Speed of each actuator at the start, rad/s or m/s; for a prescribed one, that of its law.
    pub initial_velocities: Vec<f64>,
    /// By actuator: the law it follows; `None` if it is free.
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
    /// Its trigger.
    pub trigger: EventTrigger<C, R>,
    /// Whether the motion ends with it.
    pub terminal: bool,
}

/// The trigger of an event.
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
    /// A number of periods of the free motion.
    Periods(f64),
    /// A time, s.
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
