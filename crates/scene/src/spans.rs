//! Places of a scene, by the ids the crates above work with, and where they are in the text.

use crate::diagnostics::Span;
use dwell_geometry::{ActuatorId, BodyId, JointId};

/// Something a message can point at. What the file does not write down points at the nearest
/// thing around it that it does: a missing mass at its body, a missing section at the beginning.
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
    /// The body's centre of mass.
    Center(BodyId),
    /// The joint's name where it is defined.
    Joint(JointId),
    /// The first (0) or second (1) point the joint holds.
    JointPoint(JointId, usize),
    /// The axis or axes of a joint.
    Axis(JointId),
    /// The law of a relation.
    CouplingLaw(JointId),
    /// The actuator's name where it is defined.
    Actuator(ActuatorId),
    /// The name of the k-th of the scene's named coordinates where it is defined.
    Coordinate(usize),
    /// `[assembly]`.
    Assembly,
    /// The actuator's coordinate at assembly.
    AssemblyCoordinate(ActuatorId),
    /// The body's rough angle at assembly.
    InitialGuess(BodyId),
    /// `[prescribed]`.
    Prescribed,
    /// The prescribed law of the actuator.
    PrescribedLaw(ActuatorId),
    /// `[sweep]`.
    CoordinateSweep,
    /// What the sweep says of the actuator.
    Swept(ActuatorId),
    /// The name of the k-th of the scene's loads where it is defined: of a friction, that of its joint
    /// in `[friction]`; of a separating force, that of its joint. After the loads come the drives, as in a model that has them as its last loads.
    Load(usize),
    /// How strong the k-th of the scene's loads is, or after them what a drive is given.
    Magnitude(usize),
    /// The name of the k-th of the scene's drives where it is defined.
    Drive(usize),
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
    /// The law by which the motion leads the actuator.
    MotionLaw(ActuatorId),
    /// The name of the k-th of the motion's events where it is defined.
    Event(usize),
    /// The motion's periods or duration.
    Duration,
    /// The number the calibration sets.
    Calibration,
}

/// Where each place is. A place that is not written down is `None`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct SceneSpans {
    pub(crate) units: Option<Span>,
    pub(crate) bodies: Vec<BodySpans>,
    pub(crate) joints: Vec<JointSpans>,
    pub(crate) actuators: Vec<Span>,
    pub(crate) coordinates: Vec<Span>,
    pub(crate) assembly: Option<Span>,
    pub(crate) assembly_coordinates: Vec<Option<Span>>,
    pub(crate) initial_guess: Vec<Option<Span>>,
    pub(crate) prescribed: Option<Span>,
    pub(crate) prescribed_laws: Vec<Option<Span>>,
    pub(crate) sweep: Option<Span>,
    pub(crate) swept: Vec<Option<Span>>,
    pub(crate) loads: Vec<LoadSpans>,
    pub(crate) drives: Vec<LoadSpans>,
    pub(crate) requests: Option<Span>,
    pub(crate) reactions: Vec<Option<Span>>,
    pub(crate) paths: Vec<Span>,
    pub(crate) dwell: Option<Span>,
    pub(crate) variables: Vec<Span>,
    pub(crate) sections: Vec<Span>,
    pub(crate) motion: Option<Span>,
    pub(crate) initial_coordinates: Vec<Option<Span>>,
    pub(crate) initial_velocities: Vec<Option<Span>>,
    pub(crate) motion_laws: Vec<Option<Span>>,
    pub(crate) events: Vec<Span>,
    pub(crate) duration: Option<Span>,
    pub(crate) calibration: Option<Span>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BodySpans {
    pub(crate) key: Span,
    pub(crate) points: Vec<Span>,
    pub(crate) mass: Option<Span>,
    pub(crate) inertia: Option<Span>,
    pub(crate) center: Option<Span>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JointSpans {
    pub(crate) key: Span,
    pub(crate) points: [Span; 2],
    pub(crate) axis: Option<Span>,
    pub(crate) law: Option<Span>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoadSpans {
    pub(crate) key: Span,
    pub(crate) magnitude: Option<Span>,
}

impl SceneSpans {
    pub(crate) fn span(&self, location: SceneLocation) -> Option<Span> {
        let body = |b: BodyId| self.bodies.get(b.0);
        let joint = |j: JointId| self.joints.get(j.0);
        let load = |k: usize| {
            let mut all = self.loads.iter().chain(&self.drives);
            all.nth(k)
        };
        let nth = |list: &[Option<Span>], k: usize| list.get(k).cloned().flatten();
        match location {
            SceneLocation::Whole => None,
            SceneLocation::Units => self.units.clone(),
            SceneLocation::Body(b) => body(b).map(|b| b.key.clone()),
            SceneLocation::Point(b, k) => body(b)?.points.get(k).cloned(),
            SceneLocation::Mass(b) => body(b)?.mass.clone(),
            SceneLocation::Inertia(b) => body(b)?.inertia.clone(),
            SceneLocation::Center(b) => body(b)?.center.clone(),
            SceneLocation::Joint(j) => joint(j).map(|j| j.key.clone()),
            SceneLocation::JointPoint(j, k) => joint(j)?.points.get(k).cloned(),
            SceneLocation::Axis(j) => joint(j)?.axis.clone(),
            SceneLocation::CouplingLaw(j) => joint(j)?.law.clone(),
            SceneLocation::Actuator(a) => self.actuators.get(a.0).cloned(),
            SceneLocation::Coordinate(k) => self.coordinates.get(k).cloned(),
            SceneLocation::Assembly => self.assembly.clone(),
            SceneLocation::AssemblyCoordinate(a) => nth(&self.assembly_coordinates, a.0),
            SceneLocation::InitialGuess(b) => nth(&self.initial_guess, b.0),
            SceneLocation::Prescribed => self.prescribed.clone(),
            SceneLocation::PrescribedLaw(a) => nth(&self.prescribed_laws, a.0),
            SceneLocation::CoordinateSweep => self.sweep.clone(),
            SceneLocation::Swept(a) => nth(&self.swept, a.0),
            SceneLocation::Load(k) => load(k).map(|l| l.key.clone()),
            SceneLocation::Magnitude(k) => load(k)?.magnitude.clone(),
            SceneLocation::Drive(k) => self.drives.get(k).map(|d| d.key.clone()),
            SceneLocation::Requests => self.requests.clone(),
            SceneLocation::Reaction(k) => nth(&self.reactions, k),
            SceneLocation::Path(k) => self.paths.get(k).cloned(),
            SceneLocation::Dwell => self.dwell.clone(),
            SceneLocation::Variable(k) => self.variables.get(k).cloned(),
            SceneLocation::Section(k) => self.sections.get(k).cloned(),
            SceneLocation::Motion => self.motion.clone(),
            SceneLocation::InitialCoordinate(a) => nth(&self.initial_coordinates, a.0),
            SceneLocation::InitialVelocity(a) => nth(&self.initial_velocities, a.0),
            SceneLocation::MotionLaw(a) => nth(&self.motion_laws, a.0),
            SceneLocation::Event(k) => self.events.get(k).cloned(),
            SceneLocation::Duration => self.duration.clone(),
            SceneLocation::Calibration => self.calibration.clone(),
        }
    }

    /// What stands around a place that is not written down.
    pub(crate) fn enclosing(location: SceneLocation) -> SceneLocation {
        match location {
            SceneLocation::Point(b, _)
            | SceneLocation::Mass(b)
            | SceneLocation::Inertia(b)
            | SceneLocation::Center(b) => SceneLocation::Body(b),
            SceneLocation::JointPoint(j, _)
            | SceneLocation::Axis(j)
            | SceneLocation::CouplingLaw(j) => SceneLocation::Joint(j),
            SceneLocation::PrescribedLaw(_) => SceneLocation::Prescribed,
            SceneLocation::Swept(_) => SceneLocation::CoordinateSweep,
            SceneLocation::Magnitude(k) => SceneLocation::Load(k),
            SceneLocation::AssemblyCoordinate(a) => SceneLocation::InitialCoordinate(a),
            SceneLocation::InitialCoordinate(a) | SceneLocation::InitialVelocity(a) => {
                SceneLocation::Actuator(a)
            }
            SceneLocation::InitialGuess(b) => SceneLocation::Body(b),
            SceneLocation::Reaction(_)
            | SceneLocation::Path(_)
            | SceneLocation::Dwell
            | SceneLocation::Variable(_)
            | SceneLocation::Section(_) => SceneLocation::Requests,
            SceneLocation::MotionLaw(_) | SceneLocation::Event(_) | SceneLocation::Duration => {
                SceneLocation::Motion
            }
            _ => SceneLocation::Whole,
        }
    }
}
