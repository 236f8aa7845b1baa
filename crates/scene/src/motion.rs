//! The free motion, and the one number fitted to a period.

use crate::coordinates::ActuatorText;
use crate::fields::{Entry, Fields, Value, number, quantity, string};
use crate::keys;
use crate::names::shorten;
use crate::problem::{Problem, Problems, Span, list};
use crate::scene::{Calibration, Length};
use crate::units::Units;
use std::fmt::Arguments;
use toml::de::DeValue;

/// `[motion]` as read: what it says of each actuator, in rad and rad/s or m and m/s.
#[derive(Debug)]
pub(crate) struct MotionText {
    pub(crate) start: Vec<Option<(f64, Span)>>,
    pub(crate) speed: Vec<Option<(f64, Span)>>,
    pub(crate) length: Option<(Length, Span)>,
}

impl MotionText {
    pub(crate) fn read(
        fields: &Fields<'_>,
        actuators: &[ActuatorText<'_>],
        units: &Units,
        problems: &mut Problems,
    ) -> Self {
        fields.allow(&keys::MOTION, problems);
        if actuators.is_empty() {
            problems.push(
                Problem::new("there is a motion but no actuator")
                    .at(fields.span.clone(), "of which coordinate?")
                    .help("declare the coordinate it starts from, as in `[actuators.phi]`"),
            );
            return Self {
                start: Vec::new(),
                speed: Vec::new(),
                length: length(fields, problems),
            };
        }
        let each = |key, problems: &mut Problems| {
            let entry = fields.get(key);
            per_actuator(entry, key, actuators, units, problems)
        };
        let (start, speed) = (each("start", problems), each("speed", problems));
        if let Some(speed) = &speed {
            let missing = actuators.iter().zip(speed).filter(|(_, s)| s.is_none());
            let missing: Vec<_> = missing.map(|(a, _)| a).collect();
            if let Some(names) = list(missing.iter().map(|a| a.name)) {
                let at = fields.get("speed").map_or(&fields.span, |e| &e.key);
                let unit = &missing[0].unit(units).name;
                problems.push(
                    Problem::new(format!("the speed of {names} at the start is not given"))
                        .at(at.clone(), "how fast?")
                        .help(format!(
                            "in {unit}/s: `speed = {{ {} = 1.0 }}`",
                            missing[0].name
                        )),
                );
            }
        }
        let none = || vec![None; actuators.len()];
        Self {
            start: start.unwrap_or_else(none),
            speed: speed.unwrap_or_else(none),
            length: length(fields, problems),
        }
    }
}

/// What one value for every actuator, or a bare number for the only one, says of each actuator.
/// None if it is wrong.
fn per_actuator(
    entry: Option<&Entry<'_>>,
    key: &str,
    actuators: &[ActuatorText<'_>],
    units: &Units,
    problems: &mut Problems,
) -> Option<Vec<Option<(f64, Span)>>> {
    let mut values = vec![None; actuators.len()];
    let Some(entry) = entry else {
        return Some(values);
    };
    let what = format!("{key} of [motion]");
    let read = |k: usize, value: &Value<'_>, what: Arguments<'_>, problems: &mut Problems| {
        let actuator = &actuators[k];
        match key {
            "start" => actuator.position(value, units, what, problems),
            _ => quantity(value, actuator.unit(units), what, problems).map(|(_, si)| si),
        }
    };
    if let DeValue::Integer(_) | DeValue::Float(_) = entry.value.get_ref() {
        let si = read(0, entry.value, format_args!("{what}"), problems)?;
        if let [one] = values.as_mut_slice() {
            *one = Some((si, entry.value.span()));
            return Some(values);
        }
        let example: Vec<_> = actuators
            .iter()
            .map(|a| format!("{} = 0.0", a.name))
            .collect();
        problems.push(
            Problem::new(format!(
                "{what} is one number for {} actuators",
                actuators.len()
            ))
            .at(entry.value.span(), "for which of them?")
            .help(format!(
                "write `{key} = {{ {} }}`",
                shorten(&example.join(", "))
            )),
        );
        return None;
    }
    let count = problems.count();
    let fields = Fields::open(entry, what, problems)?;
    for value in &fields.entries {
        let name = shorten(value.name);
        let Some(k) = actuators.iter().position(|a| a.name == value.name) else {
            let names = actuators.iter().map(|a| a.name);
            let help = problems.choices(value.name, "actuators", names);
            problems.push(
                Problem::new(format!("there is no actuator `{name}`"))
                    .at(value.key.clone(), "unknown actuator")
                    .help(help),
            );
            continue;
        };
        let what = format_args!("{key} of `{name}` in [motion]");
        let si = read(k, value.value, what, problems);
        values[k] = si.map(|si| (si, value.value.span()));
    }
    (problems.count() == count).then_some(values)
}

fn length(fields: &Fields<'_>, problems: &mut Problems) -> Option<(Length, Span)> {
    let (periods, duration) = (fields.get("periods"), fields.get("duration"));
    if let (Some(a), Some(b)) = (periods, duration) {
        problems.push(
            Problem::new("[motion] has both `periods` and `duration`")
                .at(a.key.clone(), "so many periods")
                .at(b.key.clone(), "or so many seconds")
                .help("keep one of them"),
        );
        return None;
    }
    let Some(entry) = periods.or(duration) else {
        problems.push(
            Problem::new("[motion] does not say how long it lasts")
                .at(fields.span.clone(), "until when?")
                .help("add `periods = 10`, or `duration = 5.0` in s"),
        );
        return None;
    };
    let value = positive(entry, "[motion]", problems)?;
    let length = match periods {
        Some(_) => Length::Periods(value),
        None => Length::Duration(value),
    };
    Some((length, entry.key.start..entry.value.span().end))
}

/// A number above zero: a time in s, or a count.
fn positive(entry: &Entry<'_>, section: &str, problems: &mut Problems) -> Option<f64> {
    let key = entry.name;
    let value = number(entry.value, format_args!("{key} in {section}"), problems)?;
    if value > 0.0 {
        return Some(value);
    }
    problems.push(
        Problem::new(format!("{key} in {section} is not above zero"))
            .at(entry.value.span(), "expected a number above 0"),
    );
    None
}

/// `[calibration]`, and where the number it sets is named.
pub(crate) fn calibration(
    fields: &Fields<'_>,
    problems: &mut Problems,
) -> Option<(Calibration, Span)> {
    fields.allow(&keys::CALIBRATION, problems);
    let missing = |key: &str, help: &str| {
        Problem::new(format!("[calibration] has no `{key}`"))
            .at(fields.span.clone(), format!("`{key}` is missing"))
            .help(help)
    };
    let path = match fields.get("set") {
        Some(e) => string(e.value, format_args!("set in [calibration]"), problems)
            .map(|path| (path, e.value.span())),
        None => {
            let help = "name the number to be fitted: `set = \"crank.inertia\"`";
            problems.push(missing("set", help));
            None
        }
    };
    let period = match fields.get("period") {
        Some(e) => positive(e, "[calibration]", problems),
        None => {
            let help = "give the period to be met, in s: `period = 5.42`";
            problems.push(missing("period", help));
            None
        }
    };
    let (path, at) = path?;
    let period = period?;
    let path = path.to_owned();
    Some((Calibration { path, period }, at))
}
