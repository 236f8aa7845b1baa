//! Places of a scene, by the ids the crates above work with, and where they are in the text.

use crate::error::SceneError;
use crate::problem::Span;
use crate::scene::Scene;
use dwell_geometry::{ActuatorId, BodyId, JointId};

/// Something a message can point at. What the file does not write down points at the nearest
/// thing around it that it does: a missing mass at its body, a missing section at the beginning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Place {
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
    JointEnd(JointId, usize),
    /// The axis or axes of a joint.
    Axis(JointId),
    /// The law of a relation.
    Law(JointId),
    /// The actuator's name where it is defined.
    Actuator(ActuatorId),
    /// The name of the k-th of the scene's named coordinates where it is defined.
    Coordinate(usize),
    /// `[assembly]`.
    Assembly,
    /// The actuator's coordinate at assembly.
    Start(ActuatorId),
    /// The body's rough angle at assembly.
    Rough(BodyId),
    /// `[prescribed]`.
    Prescribed,
    /// The prescribed law of the actuator.
    Motor(ActuatorId),
    /// `[sweep]`.
    Sweep,
    /// What the sweep says of the actuator.
    Swept(ActuatorId),
    /// The name of the k-th of the scene's loads where it is defined: of a friction, that of its joint
    /// in `[friction]`. After the loads come the drives, as in a model that has them as its last loads.
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
    MotionStart(ActuatorId),
    /// The actuator's speed at the start of the motion.
    Speed(ActuatorId),
    /// The law by which the motion leads the actuator.
    Led(ActuatorId),
    /// The name of the k-th of the motion's events where it is defined.
    Event(usize),
    /// The motion's periods or duration.
    Length,
    /// The number the calibration sets.
    Calibration,
}

/// Where each place is. A place that is not written down is `None`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Places {
    pub(crate) units: Option<Span>,
    pub(crate) bodies: Vec<BodyPlaces>,
    pub(crate) joints: Vec<JointPlaces>,
    pub(crate) actuators: Vec<Span>,
    pub(crate) coordinates: Vec<Span>,
    pub(crate) assembly: Option<Span>,
    pub(crate) start: Vec<Option<Span>>,
    pub(crate) rough: Vec<Option<Span>>,
    pub(crate) prescribed: Option<Span>,
    pub(crate) laws: Vec<Option<Span>>,
    pub(crate) sweep: Option<Span>,
    pub(crate) swept: Vec<Option<Span>>,
    pub(crate) loads: Vec<LoadPlaces>,
    pub(crate) drives: Vec<LoadPlaces>,
    pub(crate) requests: Option<Span>,
    pub(crate) reactions: Vec<Option<Span>>,
    pub(crate) paths: Vec<Span>,
    pub(crate) dwell: Option<Span>,
    pub(crate) variables: Vec<Span>,
    pub(crate) sections: Vec<Span>,
    pub(crate) motion: Option<Span>,
    pub(crate) motion_start: Vec<Option<Span>>,
    pub(crate) speed: Vec<Option<Span>>,
    pub(crate) led: Vec<Option<Span>>,
    pub(crate) events: Vec<Span>,
    pub(crate) length: Option<Span>,
    pub(crate) calibration: Option<Span>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BodyPlaces {
    pub(crate) key: Span,
    pub(crate) points: Vec<Span>,
    pub(crate) mass: Option<Span>,
    pub(crate) inertia: Option<Span>,
    pub(crate) center: Option<Span>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JointPlaces {
    pub(crate) key: Span,
    pub(crate) ends: [Span; 2],
    pub(crate) axis: Option<Span>,
    pub(crate) law: Option<Span>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoadPlaces {
    pub(crate) key: Span,
    pub(crate) magnitude: Option<Span>,
}

impl Places {
    fn span(&self, place: Place) -> Option<Span> {
        let body = |b: BodyId| self.bodies.get(b.0);
        let joint = |j: JointId| self.joints.get(j.0);
        let load = |k: usize| {
            let mut all = self.loads.iter().chain(&self.drives);
            all.nth(k)
        };
        let nth = |list: &[Option<Span>], k: usize| list.get(k).cloned().flatten();
        match place {
            Place::Whole => None,
            Place::Units => self.units.clone(),
            Place::Body(b) => body(b).map(|b| b.key.clone()),
            Place::Point(b, k) => body(b)?.points.get(k).cloned(),
            Place::Mass(b) => body(b)?.mass.clone(),
            Place::Inertia(b) => body(b)?.inertia.clone(),
            Place::Center(b) => body(b)?.center.clone(),
            Place::Joint(j) => joint(j).map(|j| j.key.clone()),
            Place::JointEnd(j, k) => joint(j)?.ends.get(k).cloned(),
            Place::Axis(j) => joint(j)?.axis.clone(),
            Place::Law(j) => joint(j)?.law.clone(),
            Place::Actuator(a) => self.actuators.get(a.0).cloned(),
            Place::Coordinate(k) => self.coordinates.get(k).cloned(),
            Place::Assembly => self.assembly.clone(),
            Place::Start(a) => nth(&self.start, a.0),
            Place::Rough(b) => nth(&self.rough, b.0),
            Place::Prescribed => self.prescribed.clone(),
            Place::Motor(a) => nth(&self.laws, a.0),
            Place::Sweep => self.sweep.clone(),
            Place::Swept(a) => nth(&self.swept, a.0),
            Place::Load(k) => load(k).map(|l| l.key.clone()),
            Place::Magnitude(k) => load(k)?.magnitude.clone(),
            Place::Drive(k) => self.drives.get(k).map(|d| d.key.clone()),
            Place::Requests => self.requests.clone(),
            Place::Reaction(k) => nth(&self.reactions, k),
            Place::Path(k) => self.paths.get(k).cloned(),
            Place::Dwell => self.dwell.clone(),
            Place::Variable(k) => self.variables.get(k).cloned(),
            Place::Section(k) => self.sections.get(k).cloned(),
            Place::Motion => self.motion.clone(),
            Place::MotionStart(a) => nth(&self.motion_start, a.0),
            Place::Speed(a) => nth(&self.speed, a.0),
            Place::Led(a) => nth(&self.led, a.0),
            Place::Event(k) => self.events.get(k).cloned(),
            Place::Length => self.length.clone(),
            Place::Calibration => self.calibration.clone(),
        }
    }

    /// What stands around a place that is not written down.
    fn around(place: Place) -> Place {
        match place {
            Place::Point(b, _) | Place::Mass(b) | Place::Inertia(b) | Place::Center(b) => {
                Place::Body(b)
            }
            Place::JointEnd(j, _) | Place::Axis(j) | Place::Law(j) => Place::Joint(j),
            Place::Motor(_) => Place::Prescribed,
            Place::Swept(_) => Place::Sweep,
            Place::Magnitude(k) => Place::Load(k),
            Place::Start(a) => Place::MotionStart(a),
            Place::MotionStart(a) | Place::Speed(a) => Place::Actuator(a),
            Place::Rough(b) => Place::Body(b),
            Place::Reaction(_)
            | Place::Path(_)
            | Place::Dwell
            | Place::Variable(_)
            | Place::Section(_) => Place::Requests,
            Place::Led(_) | Place::Event(_) | Place::Length => Place::Motion,
            _ => Place::Whole,
        }
    }
}

impl Scene {
    /// An error at places of the scene, each with a remark of its own, for what is found out
    /// about the scene later.
    pub fn error(
        &self,
        message: String,
        help: Option<String>,
        at: &[(Place, String)],
    ) -> SceneError {
        let labels = at
            .iter()
            .map(|(place, label)| (self.span(*place), label.clone()));
        SceneError::at(&self.source, message, help, labels)
    }

    /// Bytes of the text where a place is.
    pub fn span(&self, mut place: Place) -> std::ops::Range<usize> {
        // Every step outwards ends at the whole, which has no span: three steps at most.
        while place != Place::Whole {
            if let Some(span) = self.places.span(place) {
                return span;
            }
            place = Places::around(place);
        }
        0..0
    }
}
