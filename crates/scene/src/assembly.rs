//! The coordinates at assembly, and the initial guesses that select the assembly mode.

use crate::bodies::Bodies;
use crate::coordinates::ParsedActuator;
use crate::diagnostics::Span;
use crate::joints::Joints;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::{ActuatorId, AssemblyConfiguration, Body, BodyId, BranchHint, Mechanism};

/// `[assembly]` as read: the coordinate of each actuator, rad or m, the angle of each body, rad, and the travel or
/// direction of each joint, m or rad.
#[derive(Debug)]
pub(crate) struct ParsedAssembly {
    pub(crate) coordinates: Vec<Option<f64>>,
    pub(crate) initial_guess: Vec<Option<f64>>,
    pub(crate) branch_hints: Vec<Option<f64>>,
    /// The actuators it names, with a valid value or not.
    mentioned: Vec<usize>,
}

impl ParsedAssembly {
    pub(crate) fn read(
        fields: Option<&TableReader<'_>>,
        bodies: &Bodies<'_>,
        joints: &Joints<'_>,
        actuators: &[ParsedActuator<'_>],
    ) -> Self {
        let mut parsed = Self {
            coordinates: vec![None; actuators.len()],
            initial_guess: vec![None; bodies.list.len()],
            branch_hints: vec![None; joints.list.len()],
            mentioned: Vec::new(),
        };
        for entry in fields.iter().flat_map(|f| &f.entries) {
            let name = entry.name;
            let what = format!("`{}` in [assembly]", shorten(name));
            let place = |location| entry.log().place(location, &entry.span());
            if let Some(k) = actuators.iter().position(|a| a.name == name) {
                parsed.mentioned.push(k);
                parsed.coordinates[k] = actuators[k].coordinate_value(entry.value, what);
                place(SceneLocation::AssemblyCoordinate(ActuatorId(k)));
            } else if let Some(k) = bodies.position(name) {
                let angle = entry.value.angle(what);
                parsed.initial_guess[k] = angle;
                place(SceneLocation::InitialGuess(BodyId(k)));
                if bodies.ground == Some(k) && angle.is_some_and(|si| si != 0.0) {
                    let message = format!("the ground `{}` cannot be rotated", shorten(name));
                    let help = "leave it out: its frame is the frame of the plane";
                    entry.value.reject::<()>(message, "its angle is 0", help);
                }
            } else if let Some(k) = joints.list.iter().position(|j| j.name == name) {
                parsed.branch_hints[k] = branch_hint(entry, &what, joints, k);
            } else {
                let bodies = bodies.list.iter().map(|b| b.name);
                let names = actuators.iter().map(|a| a.name).chain(bodies);
                let names = names.chain(hintable_joints(joints));
                let help = entry
                    .log()
                    .choices(name, "actuators, bodies and slides", names);
                let message = format!("{what} is neither an actuator nor a body nor a joint");
                entry.reject::<()>(message, "unknown name", help);
            }
        }
        parsed
    }

    /// Coordinate of each actuator at assembly: as it is given, or as in `initial` where the motion starts, or 0. No two
    /// points are at 0 from each other by default: such a distance follows from the approximate angles, or is reported as
    /// missing, in the section or else at the actuator.
    pub(crate) fn coordinates_or(
        &self,
        initial: &[Option<f64>],
        (bodies, joints): (&Bodies<'_>, &Joints<'_>),
        actuators: &[ParsedActuator<'_>],
        section: Option<&Span>,
    ) -> Vec<f64> {
        let given = |k: usize| self.coordinates[k].or(initial.get(k).copied().flatten());
        let given = (0..actuators.len()).map(given);
        let mut coordinates: Vec<f64> = given.clone().map(Option::unwrap_or_default).collect();
        let is_missing =
            |(k, a): &(usize, &ParsedActuator<'_>)| a.is_distance() && !self.mentioned.contains(k);
        let missing = actuators.iter().enumerate().zip(given);
        let missing = missing.filter(|(actuator, given)| given.is_none() && is_missing(actuator));
        let missing: Vec<usize> = missing.map(|((k, _), _)| k).collect();
        for (k, length) in self.guessed_lengths(&missing, &coordinates, (bodies, joints), actuators)
        {
            coordinates[k] = length.unwrap_or_default();
            if length.is_none() {
                let a = &actuators[k];
                let name = shorten(a.name);
                let message = format!("the length of `{name}` at the start is not given");
                let labels = [(section.unwrap_or(&a.key), "no length at assembly")];
                let help = format!(
                    "add it to [assembly], such as `{name} = 0.5`, or the approximate angles of the bodies from the ground to its two points"
                );
                joints.log.report(message, &labels, help);
            }
        }
        coordinates
    }

    /// The lengths of actuators where the bodies stand at their approximate angles, m.
    fn guessed_lengths(
        &self,
        missing: &[usize],
        coordinates: &[f64],
        (bodies, joints): (&Bodies<'_>, &Joints<'_>),
        actuators: &[ParsedActuator<'_>],
    ) -> Vec<(usize, Option<f64>)> {
        let read_joints = joints.list.iter().map(|j| j.joint.clone()).collect();
        let read_actuators = actuators.iter().map(|a| a.actuator.clone()).collect();
        let (Some(ground), Some(joints), Some(actuators)) =
            (bodies.ground, read_joints, read_actuators)
        else {
            // What could not be read is reported.
            return Vec::new();
        };
        let mechanism = Mechanism {
            bodies: bodies.list.iter().map(|b| Body::named(b.name)).collect(),
            ground,
            joints,
            actuators,
            couplings: Vec::new(),
        };
        let assembly = AssemblyConfiguration {
            q: coordinates.to_vec(),
            initial_guess: self.initial_guess.clone(),
            branch_hints: self.branch_hints.clone(),
        };
        let length = |&k: &usize| (k, mechanism.guessed_length(&assembly, ActuatorId(k)));
        missing.iter().map(length).collect()
    }
}

/// The joints that take an initial guess.
fn hintable_joints<'j>(joints: &'j Joints<'_>) -> impl Iterator<Item = &'j str> + Clone {
    let hintable = joints.list.iter().filter(|j| {
        let kind = j.joint.as_ref().map(|j| j.kind);
        kind.is_some_and(|kind| kind.branch_hint().is_some())
    });
    hintable.map(|j| j.name.as_str())
}

/// The approximate travel of a prismatic joint or a slot, m, or direction of a distance, rad.
fn branch_hint(entry: &Entry<'_>, what: &str, joints: &Joints<'_>, k: usize) -> Option<f64> {
    // One that could not be read has been reported.
    let kind = joints.list[k].joint.as_ref()?.kind;
    if let Some(hint) = kind.branch_hint() {
        return entry.value.coordinate(hint == BranchHint::Direction, what);
    }
    let help = entry
        .log()
        .choices("", "joints that can", hintable_joints(joints));
    let message = format!("joint `{}` takes no initial guess", shorten(entry.name));
    let label = format!("its kind is {}", kind.name());
    let help = format!(
        "a prismatic joint or a slot takes an initial travel, a distance a direction; {help}"
    );
    entry.reject(message, &label, help)
}
