//! Prescribed motions and sweeps: where the actuators are, without the mechanics.

use crate::coordinates::ActuatorText;
use crate::fields::{Entry, Fields, Sign, Value, array, count, signed};
use crate::keys;
use crate::law::{Reach, law};
use crate::names::shorten;
use crate::problem::{Problem, Problems, Span, list};
use crate::scene::{Prescribed, Sweep};
use crate::units::{Unit, Units};
use dwell_geometry::ActuatorId;
use dwell_laws::Law;
use toml::de::DeValue;

/// Positions or times, where the scene does not say how many.
const POINTS: usize = 361;

/// `[prescribed]` as read, and where each actuator's law is.
#[derive(Debug)]
pub(crate) struct PrescribedText {
    pub(crate) prescribed: Option<Prescribed>,
    pub(crate) laws: Vec<Option<Span>>,
}

/// `[sweep]` as read, and where it speaks of each actuator.
#[derive(Debug)]
pub(crate) struct SweepText {
    pub(crate) sweep: Option<Sweep>,
    pub(crate) actuators: Vec<Option<Span>>,
}

/// The entries of a section that are named by actuators, in the order of these; the section's own
/// keys are no names.
fn by_actuator<'f, 'a>(
    fields: &'f Fields<'a>,
    table: &keys::Table,
    actuators: &[ActuatorText<'_>],
    problems: &mut Problems,
) -> Option<Vec<Option<&'f Entry<'a>>>> {
    let section = &fields.what;
    if actuators.is_empty() {
        problems.push(
            Problem::new(format!("there is a {section} but no actuator"))
                .at(fields.span.clone(), "of which coordinate?")
                .help("declare the coordinate, as in `[actuators.phi]`"),
        );
        return None;
    }
    if let Some(a) = actuators.iter().find(|a| table.knows(a.name)) {
        let name = shorten(a.name);
        problems.push(
            Problem::new(format!(
                "actuator `{name}` has the name of a key of {section}"
            ))
            .at(a.key.clone(), "this name")
            .help(format!(
                "rename it: in {section} it could not be told which is meant"
            )),
        );
        return None;
    }
    let mut entries = vec![None; actuators.len()];
    for entry in fields.entries.iter().filter(|e| !table.knows(e.name)) {
        if let Some(k) = actuators.iter().position(|a| a.name == entry.name) {
            entries[k] = Some(entry);
            continue;
        }
        let own = table.keys.iter().map(|k| k.name);
        let names: Vec<&str> = actuators.iter().map(|a| a.name).chain(own).collect();
        let kind = format!("keys of {section}");
        let help = problems.choices(entry.name, &kind, names.into_iter());
        problems.push(
            Problem::new(format!(
                "`{}` in {section} is neither an actuator nor a key of it",
                shorten(entry.name)
            ))
            .at(entry.key.clone(), "unknown name")
            .help(help),
        );
    }
    Some(entries)
}

impl PrescribedText {
    /// `start` holds each actuator's coordinate at assembly, SI.
    pub(crate) fn read(
        fields: &Fields<'_>,
        actuators: &[ActuatorText<'_>],
        start: &[f64],
        units: &Units,
        problems: &mut Problems,
    ) -> Self {
        let help = "add `duration = 2.0`: how long the motion lasts, in s";
        let duration = fields.need("duration", &fields.span, help, problems);
        let duration = duration.and_then(|e| positive(e, fields, problems));
        let points = points(fields, problems);
        let Some(entries) = by_actuator(fields, &keys::PRESCRIBED, actuators, problems) else {
            return Self {
                prescribed: None,
                laws: Vec::new(),
            };
        };
        let missing = actuators.iter().zip(&entries).filter(|(_, e)| e.is_none());
        let missing: Vec<_> = missing.map(|(a, _)| a.name).collect();
        if let Some(names) = list(missing.iter().copied()) {
            problems.push(
                Problem::new(format!("[prescribed] has no law of {names}"))
                    .at(fields.span.clone(), "how does it move?")
                    .help(format!(
                        "add for instance `{} = {{ speed = 1.0 }}`; one that stays has speed 0",
                        missing[0]
                    )),
            );
        }
        let laws: Vec<_> = actuators
            .iter()
            .zip(&entries)
            .zip(start)
            .map(|((a, e), &start)| {
                // A wrong duration is reported once, not again for each table.
                let end = duration.unwrap_or(0.0);
                law_of((*e)?, "[prescribed]", a, (start, end), units, problems)
            })
            .collect();
        let laws: Option<Vec<Law>> = laws.into_iter().collect();
        Self {
            prescribed: duration
                .zip(points)
                .zip(laws)
                .map(|((duration, points), laws)| Prescribed {
                    duration,
                    points,
                    laws,
                }),
            laws: entries.iter().map(|e| e.map(|e| e.key.clone())).collect(),
        }
    }
}

/// The law of an actuator from time 0 to `end` (s), that a speed, a sine or a rise begins at `start`.
pub(crate) fn law_of(
    entry: &Entry<'_>,
    section: &str,
    actuator: &ActuatorText<'_>,
    (start, end): (f64, f64),
    units: &Units,
    problems: &mut Problems,
) -> Option<Law> {
    let what = format!("`{}` in {section}", shorten(entry.name));
    let fields = Fields::open(entry, what, problems)?;
    fields.allow(&keys::LAW, problems);
    let Some(chosen) = fields.one_of(|n| keys::LAW.knows(n), problems).ok()? else {
        if fields.has_others_than(&keys::LAW) {
            return None;
        }
        let laws = list(keys::LAW.names()).unwrap_or_default();
        problems.push(
            Problem::new(format!("{} has no law", fields.what))
                .at(entry.value.span(), "how does it move?")
                .help(format!(
                    "write it as `{{ speed = 1.0 }}`; the laws are {laws}"
                )),
        );
        return None;
    };
    let reach = Reach {
        variable: "t",
        x: &Unit::of_si(),
        y: actuator.unit(units),
        start,
        end: Some(end),
    };
    law(chosen, &fields.what, &reach, units, problems)
}

fn positive(entry: &Entry<'_>, fields: &Fields<'_>, problems: &mut Problems) -> Option<f64> {
    let what = format_args!("{} in {}", entry.name, fields.what);
    let seconds = Unit::of_si();
    signed(entry.value, &seconds, Sign::Positive, what, "", problems)
}

fn points(fields: &Fields<'_>, problems: &mut Problems) -> Option<usize> {
    let Some(entry) = fields.get("points") else {
        return Some(POINTS);
    };
    let what = format_args!("points in {}", fields.what);
    count(entry.value, what, problems)
}

impl SweepText {
    pub(crate) fn read(
        fields: &Fields<'_>,
        actuators: &[ActuatorText<'_>],
        start: &[f64],
        units: &Units,
        problems: &mut Problems,
    ) -> Self {
        let before = problems.count();
        let points = points(fields, problems);
        let Some(entries) = by_actuator(fields, &keys::SWEEP, actuators, problems) else {
            return Self {
                sweep: None,
                actuators: Vec::new(),
            };
        };
        let mut held = start.to_vec();
        let mut range: Option<(usize, [f64; 2], Span)> = None;
        for (k, entry) in entries.iter().enumerate() {
            let Some(entry) = entry else { continue };
            match position(entry, &actuators[k], units, problems) {
                Some(Position::Held(at)) => held[k] = at,
                Some(Position::Swept(ends)) => match &range {
                    Some((_, _, other)) => problems.push(
                        Problem::new("[sweep] sweeps two actuators")
                            .at(other.clone(), "from here to there")
                            .at(entry.value.span(), "and this one too")
                            .help("hold all but one of them: a single number"),
                    ),
                    None => range = Some((k, ends, entry.value.span())),
                },
                None => {}
            }
        }
        let free: Vec<_> = (0..actuators.len())
            .filter(|&k| entries[k].is_none())
            .collect();
        let swept = match (&range, free.as_slice()) {
            (Some((k, ..)), _) => Some(*k),
            (None, [only]) => Some(*only),
            (None, _) => None,
        };
        if swept.is_none() && problems.count() == before {
            problems.push(
                Problem::new("[sweep] does not say which actuator is swept")
                    .at(fields.span.clone(), "which one?")
                    .help(format!(
                        "give one of them a range: `{} = [0.0, 1.0]`",
                        actuators[0].name
                    )),
            );
        }
        let speed = match (fields.get("speed"), swept) {
            (None, _) => Some(1.0),
            (Some(e), k) => {
                let unit = units.of(k.is_none_or(|k| actuators[k].is_angle()));
                let why = "the range says which way: from where to where";
                let what = format_args!("speed in [sweep]");
                signed(e.value, unit, Sign::Positive, what, why, problems)
            }
        };
        let whole = |e: &Entry<'_>| e.key.start..e.value.span().end;
        let spans = entries.iter().map(|e| e.map(whole)).collect();
        let (Some(k), Some(points), Some(speed)) = (swept, points, speed) else {
            return Self {
                sweep: None,
                actuators: spans,
            };
        };
        Self {
            sweep: Some(Sweep {
                actuator: ActuatorId(k),
                range: range.map(|(_, ends, _)| ends),
                held,
                points,
                speed,
            }),
            actuators: spans,
        }
    }
}

/// Where an actuator is during a sweep.
enum Position {
    Held(f64),
    Swept([f64; 2]),
}

fn position(
    entry: &Entry<'_>,
    actuator: &ActuatorText<'_>,
    units: &Units,
    problems: &mut Problems,
) -> Option<Position> {
    let name = shorten(entry.name);
    let read = |value: &Value<'_>, problems: &mut Problems| {
        let what = format_args!("`{name}` in [sweep]");
        actuator.position(value, units, what, problems)
    };
    if let DeValue::Integer(_) | DeValue::Float(_) = entry.value.get_ref() {
        return read(entry.value, problems).map(Position::Held);
    }
    let expected = "a number, or from where to where [from, to]";
    let what = format_args!("`{name}` in [sweep]");
    let values = array(entry.value, expected, what, problems)?;
    let [from, to] = values else {
        problems.push(
            Problem::new(format!("{what}: expected {expected}"))
                .at(entry.value.span(), format!("{} values", values.len())),
        );
        return None;
    };
    let (from, to) = (read(from, problems), read(to, problems));
    let (from, to) = (from?, to?);
    if from == to {
        problems.push(
            Problem::new(format!("{what} ends where it begins"))
                .at(entry.value.span(), "nothing to sweep")
                .help("a single number holds the actuator there"),
        );
        return None;
    }
    Some(Position::Swept([from, to]))
}
