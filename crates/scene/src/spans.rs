//! Places of a scene, by the ids the crates above work with, and where they are in the text.

use crate::diagnostics::Span;
use dwell_geometry::{ActuatorId, BodyId, JointId};
use std::collections::HashMap;

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
    /// What the sweep gives for the actuator.
    Swept(ActuatorId),
    /// The name of the k-th of the scene's loads where it is defined: of a friction, that of its joint
    /// in `[friction]`; of a separating force, that of its joint. After the loads come the drives, as in a model that has them as its last loads.
    Load(usize),
    /// The magnitude of the k-th of the scene's loads, or after them that of a drive.
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
    /// The motion law of the actuator in a free motion.
    MotionLaw(ActuatorId),
    /// The name of the k-th of the motion's events where it is defined.
    Event(usize),
    /// The motion's periods or duration.
    Duration,
    /// The number that the calibration fits.
    Calibration,
}

/// Where each place is. A place that is not written down is absent.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct SceneSpans(HashMap<SceneLocation, Span>);

impl SceneSpans {
    pub(crate) fn put(&mut self, location: SceneLocation, span: impl Into<Option<Span>>) {
        self.0.extend(span.into().map(|span| (location, span)));
    }

    /// The places of a list, by their indices in it.
    pub(crate) fn put_all<S: Into<Option<Span>>>(
        &mut self,
        location: impl Fn(usize) -> SceneLocation,
        spans: impl IntoIterator<Item = S>,
    ) {
        for (k, span) in spans.into_iter().enumerate() {
            self.put(location(k), span);
        }
    }

    pub(crate) fn span(&self, location: SceneLocation) -> Option<Span> {
        self.0.get(&location).cloned()
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
