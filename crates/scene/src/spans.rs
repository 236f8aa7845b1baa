//! Places of a scene, by the ids of the crates above, and their ranges in the text.

use dwell_geometry::{ActuatorId, BodyId, JointId};
use std::collections::HashMap;
use std::ops::Range;

/// A place to which a message can point. For a part that is not in the file, it is the nearest enclosing part: for a
/// missing mass, its body; for a missing section, the beginning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SceneLocation {
    /// The beginning of the file.
    Whole,
    /// `[units]`.
    Units,
    /// The body's name where it is defined.
    Body(BodyId),
    /// The name of the body's k-th point where it is defined.
    Point(BodyId, usize),
    /// The body's mass.
    Mass(BodyId),
    /// The body's inertia.
    Inertia(BodyId),
    /// The body's moment of inertia over its angle.
    VaryingInertia(BodyId),
    /// The body's centre of mass.
    Center(BodyId),
    /// The joint's name where it is defined.
    Joint(JointId),
    /// The first (0) or second (1) point the joint holds.
    JointPoint(JointId, usize),
    /// The axis or axes of a joint.
    Axis(JointId),
    /// The law of a coupling.
    CouplingLaw(JointId),
    /// The actuator's name where it is defined.
    Actuator(ActuatorId),
    /// The name of the k-th of the scene's named coordinates where it is defined.
    Coordinate(usize),
    /// `[assembly]`.
    Assembly,
    /// The actuator's coordinate at assembly.
    AssemblyCoordinate(ActuatorId),
    /// The initial guess of the body's angle at assembly.
    InitialGuess(BodyId),
    /// `[prescribed]`.
    Prescribed,
    /// The prescribed law of the actuator.
    PrescribedLaw(ActuatorId),
    /// `[coordinate-sweep]`.
    CoordinateSweep,
    /// The entry of the sweep for the actuator.
    Swept(ActuatorId),
    /// The name of the k-th of the scene's loads where it is defined: for a friction, the name of its joint in `[friction]`; for a
    /// separating force, that of its joint. Drives follow the loads, as in a model.
    Load(usize),
    /// The magnitude of the k-th of the scene's loads, or after them that of a drive.
    Magnitude(usize),
    /// The name of the k-th of the scene's drives where it is defined.
    Drive(usize),
    /// The name of the k-th of the scene's end stops where it is defined.
    Stop(usize),
    /// `[requests]`.
    Requests,
    /// The request for the k-th of the scene's reactions.
    Reaction(usize),
    /// The request for the k-th of the scene's paths.
    Path(usize),
    /// The request for a dwell.
    Dwell,
    /// The request for the k-th of the scene's variables.
    Variable(usize),
    /// The request for the k-th of the scene's sections.
    Section(usize),
    /// `[motion]`.
    Motion,
    /// The actuator's coordinate at the start of the motion.
    InitialCoordinate(ActuatorId),
    /// The actuator's speed at the start of the motion.
    InitialVelocity(ActuatorId),
    /// The motion law of the actuator in a free motion.
    MotionLaw(ActuatorId),
    /// The name of the k-th of the motion's events where it is defined.
    Event(usize),
    /// The motion's periods or duration.
    Duration,
    /// The number that the calibration fits.
    Calibration,
    /// The k-th tied number of `[sweep]`.
    Tied(usize),
    /// The k-th limit of `[sweep]`.
    Limit(usize),
    /// The name of the k-th target of `[sweep]`.
    Target(usize),
    /// The name of the k-th job of `[optimise]`.
    Job(usize),
    /// A part of such a job.
    JobPart(usize, JobPart, usize),
}

/// The parts of a job of `[optimise]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum JobPart {
    /// A number that varies.
    Vary,
    /// A tied number.
    Tied,
    /// A summand of the goal.
    Goal,
    /// A condition.
    Condition,
    /// A part that is chosen.
    Choice,
}

/// The places of the parts of a scene.
pub(crate) type SceneSpans = HashMap<SceneLocation, Range<usize>>;

impl SceneLocation {
    /// The part that encloses a place that is not in the file.
    pub(crate) fn enclosing(self) -> Self {
        match self {
            Self::Point(b, _)
            | Self::Mass(b)
            | Self::Inertia(b)
            | Self::VaryingInertia(b)
            | Self::Center(b) => Self::Body(b),
            Self::JointPoint(j, _) | Self::Axis(j) | Self::CouplingLaw(j) => Self::Joint(j),
            Self::PrescribedLaw(_) => Self::Prescribed,
            Self::Swept(_) => Self::CoordinateSweep,
            Self::Magnitude(k) => Self::Load(k),
            Self::JobPart(k, ..) => Self::Job(k),
            Self::AssemblyCoordinate(a) => Self::InitialCoordinate(a),
            Self::InitialCoordinate(a) | Self::InitialVelocity(a) => Self::Actuator(a),
            Self::InitialGuess(b) => Self::Body(b),
            Self::Reaction(_)
            | Self::Path(_)
            | Self::Dwell
            | Self::Variable(_)
            | Self::Section(_) => Self::Requests,
            Self::MotionLaw(_) | Self::Event(_) | Self::Duration => Self::Motion,
            _ => Self::Whole,
        }
    }
}
