//! Where the mechanism is put together, and how: it picks the branch.

use crate::bodies::Bodies;
use crate::coordinates::ActuatorText;
use crate::fields::{Entry, Fields, angle, coordinate};
use crate::names::shorten;
use crate::problem::{Problem, Problems, Span};
use crate::units::Units;

/// `[assembly]` as read: what it says of each actuator, in rad or m, and of each body, in rad.
#[derive(Debug)]
pub(crate) struct AssemblyText {
    pub(crate) start: Vec<Option<(f64, Span)>>,
    pub(crate) rough: Vec<Option<(f64, Span)>>,
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
        };
        for entry in fields.iter().flat_map(|f| &f.entries) {
            let name = entry.name;
            let shown = shorten(name);
            if let Some(k) = actuators.iter().position(|a| a.name == name) {
                let start = start(entry, &actuators[k], units, problems);
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

    /// Says which distances that are driven have no start: no two points are at 0 by default.
    pub(crate) fn check_lengths(
        &self,
        actuators: &[ActuatorText<'_>],
        at: Option<&Span>,
        problems: &mut Problems,
    ) {
        for (a, _) in actuators
            .iter()
            .zip(&self.start)
            .filter(|(a, start)| a.is_distance() && start.is_none())
        {
            let name = shorten(a.name);
            let at = at.unwrap_or(&a.key).clone();
            problems.push(
                Problem::new(format!("the length of `{name}` at the start is not given"))
                    .at(at, "how long?")
                    .help(format!("add it to [assembly], such as `{name} = 0.5`")),
            );
        }
    }
}

/// An actuator's coordinate, SI.
fn start(
    entry: &Entry<'_>,
    actuator: &ActuatorText<'_>,
    units: &Units,
    problems: &mut Problems,
) -> Option<f64> {
    let name = shorten(entry.name);
    let what = format_args!("`{name}` in [assembly]");
    let si = coordinate(entry.value, actuator.is_angle(), units, what, problems)?;
    if actuator.is_distance() && si <= 0.0 {
        problems.push(
            Problem::new(format!("{what} is a length that is not above zero"))
                .at(entry.value.span(), "expected a number above 0")
                .help("two points that coincide have no line along which to drive them"),
        );
        return None;
    }
    Some(si)
}
