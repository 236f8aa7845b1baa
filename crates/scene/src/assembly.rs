//! The coordinates at assembly, and the initial guesses that select the assembly mode.

use crate::bodies::Bodies;
use crate::coordinates::ParsedActuator;
use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::joints::{Joints, kind_name};
use crate::table_reader::{Entry, TableReader, angle, coordinate};
use crate::units::Units;
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
    pub(crate) mentioned: Vec<usize>,
}

impl ParsedAssembly {
    pub(crate) fn read(
        fields: Option<&TableReader<'_>>,
        bodies: &Bodies<'_>,
        joints: &Joints<'_>,
        actuators: &[ParsedActuator<'_>],
        units: &Units,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut parsed = Self {
            coordinates: vec![None; actuators.len()],
            initial_guess: vec![None; bodies.list.len()],
            branch_hints: vec![None; joints.list.len()],
            mentioned: Vec::new(),
        };
        for entry in fields.iter().flat_map(|f| &f.entries) {
            let name = entry.name;
            let short_name = shorten(name);
            if let Some(k) = actuators.iter().position(|a| a.name == name) {
                let what = format_args!("`{short_name}` in [assembly]");
                parsed.mentioned.push(k);
                let coordinate =
                    actuators[k].coordinate_value(entry.value, units, what, diagnostics);
                parsed.coordinates[k] =
                    coordinate.map(|si| (si, entry.key.start..entry.value.span().end));
            } else if let Some(k) = bodies.position(name) {
                let what = format_args!("`{short_name}` in [assembly]");
                let angle = angle(entry.value, &units.angle, what, diagnostics);
                parsed.initial_guess[k] =
                    angle.map(|si| (si, entry.key.start..entry.value.span().end));
                if bodies.ground == Some(k) && angle.is_some_and(|si| si != 0.0) {
                    diagnostics.push(
                        Diagnostic::new(format!(
                            "the ground `{}` cannot be rotated",
                            shorten(name)
                        ))
                        .label(entry.value.span(), "its angle is 0")
                        .help("leave it out: its frame is the frame of the plane"),
                    );
                }
            } else if let Some(k) = joints.list.iter().position(|j| j.name == name) {
                let hint = branch_hint(entry, joints, k, units, diagnostics);
                parsed.branch_hints[k] =
                    hint.map(|si| (si, entry.key.start..entry.value.span().end));
            } else {
                let names = actuators
                    .iter()
                    .map(|a| a.name)
                    .chain(bodies.list.iter().map(|b| b.name))
                    .chain(hintable_joints(joints));
                let help = diagnostics.choices(name, "actuators, bodies and slides", names);
                diagnostics.push(
                    Diagnostic::new(format!(
                        "`{}` in [assembly] is neither an actuator nor a body nor a joint",
                        shorten(name)
                    ))
                    .label(entry.key.clone(), "unknown name")
                    .help(help),
                );
            }
        }
        parsed
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
fn branch_hint(
    entry: &Entry<'_>,
    joints: &Joints<'_>,
    k: usize,
    units: &Units,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let short_name = shorten(entry.name);
    // One that could not be read has been reported.
    let kind = joints.list[k].joint.as_ref()?.kind;
    if let Some(hint) = kind.branch_hint() {
        let what = format_args!("`{short_name}` in [assembly]");
        return coordinate(
            entry.value,
            hint == BranchHint::Direction,
            units,
            what,
            diagnostics,
        );
    }
    let help = diagnostics.choices("", "joints that can", hintable_joints(joints));
    diagnostics.push(
        Diagnostic::new(format!(
            "joint `{short_name}` takes no initial guess"
        ))
        .label(
            entry.key.clone(),
            format!("its kind is {}", kind_name(kind)),
        )
        .help(format!(
            "a prismatic joint or a slot takes an initial travel, a distance a direction; {help}"
        )),
    );
    None
}
