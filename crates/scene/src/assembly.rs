//! Where the mechanism is put together, and how: it picks the branch.

use crate::bodies::Bodies;
use crate::coordinates::ActuatorText;
use crate::fields::{Fields, angle};
use crate::names::shorten;
use crate::problem::{Problem, Problems, Span};
use crate::units::Units;

/// `[assembly]` as read: what it says of each actuator, in rad or m, and of each body, in rad.
#[derive(Debug)]
pub(crate) struct AssemblyText {
    pub(crate) start: Vec<Option<(f64, Span)>>,
    pub(crate) rough: Vec<Option<(f64, Span)>>,
    /// The actuators it speaks of, rightly or wrongly.
    pub(crate) spoken: Vec<usize>,
}

impl AssemblyText {
    pub(crate) fn read(
        fields: Option<&Fields<'_>>,
        bodies: &Bodies<'_>,
        actuators: &[ActuatorText<'_>],
        units: &Units,
        problems: &mut Problems,
    ) -> Self {
        let mut text = Self {
            start: vec![None; actuators.len()],
            rough: vec![None; bodies.list.len()],
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
            } else {
                let names = actuators
                    .iter()
                    .map(|a| a.name)
                    .chain(bodies.list.iter().map(|b| b.name));
                let help = problems.choices(name, "actuators and bodies", names);
                problems.push(
                    Problem::new(format!(
                        "`{}` in [assembly] is neither an actuator nor a body",
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
