//! The coordinates at assembly, and the initial guesses that select the assembly mode.

use crate::bodies::Bodies;
use crate::coordinates::ParsedActuator;
use crate::diagnostics::{Diagnostics, Span};
use crate::joints::{Joints, kind_name};
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::BranchHint;

/// `[assembly]` as read: the coordinate of each actuator, rad or m, the angle of each body, rad, and the travel or
/// direction of each joint, m or rad.
#[derive(Debug)]
pub(crate) struct ParsedAssembly {
    pub(crate) coordinates: Vec<Option<(f64, Span)>>,
    pub(crate) initial_guess: Vec<Option<(f64, Span)>>,
    pub(crate) branch_hints: Vec<Option<(f64, Span)>>,
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
            let with_span = |si: Option<f64>| si.map(|si| (si, entry.span()));
            if let Some(k) = actuators.iter().position(|a| a.name == name) {
                parsed.mentioned.push(k);
                let coordinate = actuators[k].coordinate_value(entry.value, what);
                parsed.coordinates[k] = with_span(coordinate);
            } else if let Some(k) = bodies.position(name) {
                let angle = entry.value.angle(what);
                parsed.initial_guess[k] = with_span(angle);
                if bodies.ground == Some(k) && angle.is_some_and(|si| si != 0.0) {
                    let message = format!("the ground `{}` cannot be rotated", shorten(name));
                    let diagnostic = entry.value.wrong(message, "its angle is 0");
                    diagnostic
                        .help("leave it out: its frame is the frame of the plane")
                        .report();
                }
            } else if let Some(k) = joints.list.iter().position(|j| j.name == name) {
                parsed.branch_hints[k] = with_span(branch_hint(entry, &what, joints, k));
            } else {
                let bodies = bodies.list.iter().map(|b| b.name);
                let names = actuators.iter().map(|a| a.name).chain(bodies);
                let names = names.chain(hintable_joints(joints));
                let help = entry
                    .log()
                    .choices(name, "actuators, bodies and slides", names);
                let message = format!("{what} is neither an actuator nor a body nor a joint");
                entry
                    .error(message)
                    .label(&entry.key, "unknown name")
                    .help(help)
                    .report();
            }
        }
        parsed
    }

    /// Coordinate of each actuator at assembly: as it is given, or as in `initial` where the motion starts, or 0. No two
    /// points are at 0 from each other by default: reports which distances are missing, in the section or else at the actuator.
    pub(crate) fn coordinates_or(
        &self,
        initial: &[Option<(f64, Span)>],
        actuators: &[ParsedActuator<'_>],
        section: Option<&Span>,
        log: &Diagnostics,
    ) -> Vec<f64> {
        let mut coordinates = Vec::with_capacity(actuators.len());
        for (k, a) in actuators.iter().enumerate() {
            let coordinate = given_value(&self.coordinates, k).or(given_value(initial, k));
            if a.is_distance() && coordinate.is_none() && !self.mentioned.contains(&k) {
                let name = shorten(a.name);
                log.error(format!("the length of `{name}` at the start is not given"))
                    .label(section.unwrap_or(&a.key), "no length at assembly")
                    .help(format!("add it to [assembly], such as `{name} = 0.5`"))
                    .report();
            }
            coordinates.push(coordinate.unwrap_or(0.0));
        }
        coordinates
    }
}

/// What is given of the k-th actuator.
pub(crate) fn given_value(values: &[Option<(f64, Span)>], k: usize) -> Option<f64> {
    values.get(k)?.as_ref().map(|s| s.0)
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
    let name = shorten(entry.name);
    entry
        .error(format!("joint `{name}` takes no initial guess"))
        .label(&entry.key, format!("its kind is {}", kind_name(kind)))
        .help(format!(
            "a prismatic joint or a slot takes an initial travel, a distance a direction; {help}"
        ))
        .reject()
}
