//! The free motion, and the one number fitted to a period.

use crate::coordinates::ActuatorText;
use crate::fields::{Entry, Fields, Value, number, quantity, string};
use crate::keys;
use crate::names::shorten;
use crate::prescribed::law_of;
use crate::problem::{Problem, Problems, Span, list};
use crate::scene::{Calibration, Length, NamedEvent};
use crate::units::Units;
use dwell_laws::Law;
use std::fmt::Arguments;
use toml::de::DeValue;

/// `[motion]` as read: what it says of each actuator, in rad and rad/s or m and m/s.
#[derive(Debug)]
pub(crate) struct MotionText<'a> {
    pub(crate) start: Vec<Option<(f64, Span)>>,
    pub(crate) speed: Vec<Option<(f64, Span)>>,
    pub(crate) length: Option<(Length, Span)>,
    /// What leads each actuator, where it is led.
    pub(crate) led: Vec<Option<Entry<'a>>>,
    /// The laws of these: [`Self::lead`] reads them.
    pub(crate) laws: Vec<Option<Law>>,
    pub(crate) events: Vec<(NamedEvent, Span)>,
}

impl<'a> MotionText<'a> {
    /// `moved`: loads or drives move the mechanism, so that it can start from rest.
    pub(crate) fn read(
        fields: &Fields<'a>,
        actuators: &[ActuatorText<'_>],
        moved: bool,
        units: &Units,
        problems: &mut Problems,
    ) -> Self {
        fields.allow(&keys::MOTION, problems);
        let mut text = Self {
            start: vec![None; actuators.len()],
            speed: vec![None; actuators.len()],
            length: length(fields, problems),
            led: vec![None; actuators.len()],
            laws: vec![None; actuators.len()],
            events: Vec::new(),
        };
        if actuators.is_empty() {
            problems.push(
                Problem::new("there is a motion but no actuator")
                    .at(fields.span.clone(), "of which coordinate?")
                    .help("declare the coordinate it starts from, as in `[actuators.phi]`"),
            );
            return text;
        }
        let all_known = text.led_by(fields, actuators, problems);
        let each = |key, problems: &mut Problems| {
            let entry = fields.get(key);
            let each = PerActuator {
                key,
                actuators,
                led: &text.led,
                units,
            };
            each.read(entry, problems)
        };
        let (start, speed) = (each("start", problems), each("speed", problems));
        if let Some(speed) = &speed
            && all_known
            && !moved
            && text.led.iter().all(Option::is_none)
        {
            no_speed(fields, actuators, speed, units, problems);
        }
        if all_known {
            text.count_free(fields, actuators, problems);
        }
        text.start = start.unwrap_or(text.start);
        text.speed = speed.unwrap_or(text.speed);
        text
    }

    /// Finds which actuators are led; false where a name of them is wrong.
    fn led_by(
        &mut self,
        fields: &Fields<'a>,
        actuators: &[ActuatorText<'_>],
        problems: &mut Problems,
    ) -> bool {
        let count = problems.count();
        let laws = fields.get("laws");
        let laws = laws.and_then(|e| Fields::open(e, "laws of [motion]", problems));
        for entry in laws.iter().flat_map(|f| &f.entries) {
            if let Some(k) = find(entry, actuators, problems) {
                self.led[k] = Some(entry.clone());
            }
        }
        problems.count() == count
    }

    /// Something has to be free, and a period is that of one coordinate.
    fn count_free(
        &self,
        fields: &Fields<'_>,
        actuators: &[ActuatorText<'_>],
        problems: &mut Problems,
    ) {
        let free = actuators.iter().zip(&self.led).filter(|(_, l)| l.is_none());
        let free: Vec<_> = free.map(|(a, _)| a.name).collect();
        let names = list(free.iter().copied());
        if let (None, Some(laws)) = (&names, fields.get("laws")) {
            problems.push(
                Problem::new("[motion] leads every actuator: none is free")
                    .at(laws.key.clone(), "all of them")
                    .help("a motion by laws alone is a [prescribed] one"),
            );
        }
        if let (Some(names), Some(periods)) = (names, fields.get("periods"))
            && free.len() > 1
        {
            problems.push(
                Problem::new(format!("`periods` with {} free actuators", free.len()))
                    .at(periods.key.clone(), "the period of which of them?")
                    .help(format!(
                        "{names} are free: say how long it lasts, as in `duration = 5.0`"
                    )),
            );
        }
    }

    /// The laws of the led actuators, that begin at `start` (SI, by actuator).
    pub(crate) fn lead(
        &mut self,
        actuators: &[ActuatorText<'_>],
        start: &[f64],
        units: &Units,
        problems: &mut Problems,
    ) {
        let end = match self.length {
            Some((Length::Duration(end), _)) => end,
            // How long periods take is not known yet, and no length has been reported.
            _ => 0.0,
        };
        for (k, actuator) in actuators.iter().enumerate() {
            if let Some(entry) = &self.led[k] {
                let section = "[motion.laws]";
                self.laws[k] = law_of(entry, section, actuator, (start[k], end), units, problems);
            }
        }
    }
}

/// The actuator that an entry is named by.
fn find(
    entry: &Entry<'_>,
    actuators: &[ActuatorText<'_>],
    problems: &mut Problems,
) -> Option<usize> {
    let found = actuators.iter().position(|a| a.name == entry.name);
    if found.is_none() {
        let names = actuators.iter().map(|a| a.name);
        let help = problems.choices(entry.name, "actuators", names);
        problems.push(
            Problem::new(format!("there is no actuator `{}`", shorten(entry.name)))
                .at(entry.key.clone(), "unknown actuator")
                .help(help),
        );
    }
    found
}

/// Says which speeds are missing of a motion that nothing but its speed starts.
fn no_speed(
    fields: &Fields<'_>,
    actuators: &[ActuatorText<'_>],
    speed: &[Option<(f64, Span)>],
    units: &Units,
    problems: &mut Problems,
) {
    let missing = actuators.iter().zip(speed).filter(|(_, s)| s.is_none());
    let missing: Vec<_> = missing.map(|(a, _)| a).collect();
    let Some(names) = list(missing.iter().map(|a| a.name)) else {
        return;
    };
    let at = fields.get("speed").map_or(&fields.span, |e| &e.key);
    let unit = &missing[0].unit(units).name;
    problems.push(
        Problem::new(format!("the speed of {names} at the start is not given"))
            .at(at.clone(), "how fast?")
            .help(format!(
                "in {unit}/s: `speed = {{ {} = 1.0 }}`; without loads and drives nothing else moves it",
                missing[0].name
            )),
    );
}

/// `start` or `speed` of a motion: one value for each free actuator, or a bare number for the only one.
struct PerActuator<'p, 'a> {
    key: &'static str,
    actuators: &'p [ActuatorText<'p>],
    led: &'p [Option<Entry<'a>>],
    units: &'p Units,
}

impl PerActuator<'_, '_> {
    /// What it says of each actuator; none if it is wrong.
    fn read(
        &self,
        entry: Option<&Entry<'_>>,
        problems: &mut Problems,
    ) -> Option<Vec<Option<(f64, Span)>>> {
        let mut values = vec![None; self.actuators.len()];
        let Some(entry) = entry else {
            return Some(values);
        };
        let what = format!("{} of [motion]", self.key);
        if let DeValue::Integer(_) | DeValue::Float(_) = entry.value.get_ref() {
            let k = self.only(entry, &what, problems)?;
            let si = self.value(k, entry.value, format_args!("{what}"), problems)?;
            values[k] = Some((si, entry.value.span()));
            return Some(values);
        }
        let count = problems.count();
        let fields = Fields::open(entry, what, problems)?;
        for value in &fields.entries {
            let Some(k) = find(value, self.actuators, problems) else {
                continue;
            };
            let (key, name) = (self.key, shorten(value.name));
            if let Some(law) = &self.led[k] {
                problems.push(
                    Problem::new(format!("`{name}` in [motion] has both a law and a {key}"))
                        .at(law.key.clone(), "led here")
                        .at(value.key.clone(), format!("and given a {key} here"))
                        .help("keep one of them: a law says all of its motion"),
                );
                continue;
            }
            let what = format_args!("{key} of `{name}` in [motion]");
            let si = self.value(k, value.value, what, problems);
            values[k] = si.map(|si| (si, value.value.span()));
        }
        (problems.count() == count).then_some(values)
    }

    /// The only free actuator.
    fn only(&self, entry: &Entry<'_>, what: &str, problems: &mut Problems) -> Option<usize> {
        let free: Vec<_> = (0..self.led.len())
            .filter(|&k| self.led[k].is_none())
            .collect();
        // Where none is free, that is said.
        if let [] | [_] = free.as_slice() {
            return free.first().copied();
        }
        let each = free
            .iter()
            .map(|&k| format!("{} = 0.0", self.actuators[k].name));
        let example = each.collect::<Vec<_>>().join(", ");
        let kind = match free.len() == self.led.len() {
            true => "actuators",
            false => "free actuators",
        };
        problems.push(
            Problem::new(format!("{what} is one number for {} {kind}", free.len()))
                .at(entry.value.span(), "for which of them?")
                .help(format!(
                    "write `{} = {{ {} }}`",
                    self.key,
                    shorten(&example)
                )),
        );
        None
    }

    fn value(
        &self,
        k: usize,
        value: &Value<'_>,
        what: Arguments<'_>,
        problems: &mut Problems,
    ) -> Option<f64> {
        let actuator = &self.actuators[k];
        match self.key {
            "start" => actuator.position(value, self.units, what, problems),
            _ => quantity(value, actuator.unit(self.units), what, problems).map(|(_, si)| si),
        }
    }
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
