//! Where the mechanism is put together, and how: it picks the branch.

use crate::bodies::Bodies;
use crate::coordinates::ActuatorText;
use crate::fields::{Entry, Fields, angle, coordinate};
use crate::joints::{Joints, word};
use crate::names::shorten;
use crate::problem::{Problem, Problems, Span};
use crate::units::Units;
use dwell_geometry::Told;

/// `[assembly]` as read: what it says of each actuator, in rad or m, of each body, in
/// rad, and of each joint, in m or rad.
#[derive(Debug)]
pub(crate) struct AssemblyText {
    pub(crate) start: Vec<Option<(f64, Span)>>,
    pub(crate) rough: Vec<Option<(f64, Span)>>,
    pub(crate) joints: Vec<Option<(f64, Span)>>,
    /// The actuators it speaks of, rightly or wrongly.
    pub(crate) spoken: Vec<usize>,
}

impl AssemblyText {
    pub(crate) fn read(
        fields: Option<&Fields<'_>>,
        bodies: &Bodies<'_>,
        joints: &Joints<'_>,
        actuators: &[ActuatorText<'_>],
        units: &Units,
        problems: &mut Problems,
    ) -> Self {
        let mut text = Self {
            start: vec![None; actuators.len()],
            rough: vec![None; bodies.list.len()],
            joints: vec![None; joints.list.len()],
            spoken: Vec::new(),
        };
        for entry in fields.iter().flat_map(|f| &f.entries) {
            let name = entry.name;
            let shown = shorten(name);
            if let Some(k) = actuators.iter().position(|a| a.name == name) {
                let what = format_args!("`{shown}` in [assembly]");
                text.spoken.push(k);
                let start = actuators[k].position(entry.value, units, what, problems);
                text.start[k] = start.map(|si| (si, entry.key.start..entry.value.span().end));
            } else if let Some(k) = bodies.position(name) {
                let what = format_args!("`{shown}` in [assembly]");
                let angle = angle(entry.value, &units.angle, what, problems);
                text.rough[k] = angle.map(|si| (si, entry.key.start..entry.value.span().end));
                if bodies.ground == Some(k) && angle.is_some_and(|si| si != 0.0) {
                    problems.push(
                        Problem::new(format!("the ground `{}` cannot be turned", shorten(name)))
                            .at(entry.value.span(), "its angle is 0")
                            .help("leave it out: its frame is the frame of the plane"),
                    );
                }
            } else if let Some(k) = joints.list.iter().position(|j| j.name == name) {
                let told = told(entry, joints, k, units, problems);
                text.joints[k] = told.map(|si| (si, entry.key.start..entry.value.span().end));
            } else {
                let names = actuators
                    .iter()
                    .map(|a| a.name)
                    .chain(bodies.list.iter().map(|b| b.name))
                    .chain(told_names(joints));
                let help = problems.choices(name, "actuators, bodies and slides", names);
                problems.push(
                    Problem::new(format!(
                        "`{}` in [assembly] is neither an actuator nor a body nor a joint",
                        shorten(name)
                    ))
                    .at(entry.key.clone(), "unknown name")
                    .help(help),
                );
            }
        }
        text
    }
}

/// The joints of which something rough can be told.
fn told_names<'j>(joints: &'j Joints<'_>) -> impl Iterator<Item = &'j str> + Clone {
    let told = joints.list.iter().filter(|j| {
        let kind = j.joint.as_ref().map(|j| j.kind);
        kind.is_some_and(|kind| kind.told().is_some())
    });
    told.map(|j| j.name.as_str())
}

/// The rough travel of a prismatic joint or a slot, m, or the direction of a distance, rad.
fn told(
    entry: &Entry<'_>,
    joints: &Joints<'_>,
    k: usize,
    units: &Units,
    problems: &mut Problems,
) -> Option<f64> {
    let shown = shorten(entry.name);
    // One that could not be read has been reported.
    let kind = joints.list[k].joint.as_ref()?.kind;
    if let Some(told) = kind.told() {
        let what = format_args!("`{shown}` in [assembly]");
        return coordinate(entry.value, told == Told::Direction, units, what, problems);
    }
    let help = problems.choices("", "joints that can", told_names(joints));
    problems.push(
        Problem::new(format!("no rough number tells anything of joint `{shown}`"))
            .at(entry.key.clone(), format!("its kind is {}", word(kind)))
            .help(format!(
                "a prismatic joint or a slot has a rough travel, a distance a rough direction; {help}"
            )),
    );
    None
}
