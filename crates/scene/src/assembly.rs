//! The coordinates at assembly, and the initial guesses that select the assembly mode.

use crate::bodies::Bodies;
use crate::coordinates::ParsedActuator;
use crate::diagnostics::{Diagnostics, Span};
use crate::joints::{Joints, kind_name};
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::{ActuatorId, BodyId, BranchHint};

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
    /// points are at 0 from each other by default: reports which distances are missing, in the section or else at the actuator.
    pub(crate) fn coordinates_or(
        &self,
        initial: &[Option<f64>],
        actuators: &[ParsedActuator<'_>],
        section: Option<&Span>,
        log: &Diagnostics,
    ) -> Vec<f64> {
        let mut coordinates = Vec::with_capacity(actuators.len());
        for (k, a) in actuators.iter().enumerate() {
            let coordinate = self.coordinates[k].or(initial.get(k).copied().flatten());
            if a.is_distance() && coordinate.is_none() && !self.mentioned.contains(&k) {
                let name = shorten(a.name);
                let message = format!("the length of `{name}` at the start is not given");
                let labels = [(section.unwrap_or(&a.key), "no length at assembly")];
                let help = format!("add it to [assembly], such as `{name} = 0.5`");
                log.report(message, &labels, help);
            }
            coordinates.push(coordinate.unwrap_or(0.0));
        }
        coordinates
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
    let label = format!("its kind is {}", kind_name(kind));
    let help = format!(
        "a prismatic joint or a slot takes an initial travel, a distance a direction; {help}"
    );
    entry.reject(message, &label, help)
}
