//! The free motion, and the calibration of one number to a period.

use crate::coordinates::ParsedActuator;
use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::keys::table;
use crate::prescribed::law_of;
use crate::scene::{Calibration, MotionDuration, NamedEvent};
use crate::table_reader::{Entry, TableReader, Value, number, quantity, string};
use crate::units::Units;
use crate::wording::{list, shorten};
use dwell_laws::Law;
use std::fmt::Arguments;
use toml::de::DeValue;

/// `[motion]` as read: what it says of each actuator, in rad and rad/s or m and m/s.
#[derive(Debug)]
pub(crate) struct ParsedMotion<'a> {
    pub(crate) initial_coordinates: Vec<Option<(f64, Span)>>,
    pub(crate) initial_velocities: Vec<Option<(f64, Span)>>,
    pub(crate) duration: Option<(MotionDuration, Span)>,
    /// The entry of each prescribed actuator's motion law.
    pub(crate) prescribed: Vec<Option<Entry<'a>>>,
    /// The laws of these, which [`Self::read_laws`] reads.
    pub(crate) laws: Vec<Option<Law>>,
    pub(crate) events: Vec<(NamedEvent, Span)>,
}

impl<'a> ParsedMotion<'a> {
    /// `can_start_at_rest`: loads or drives can move the mechanism.
    pub(crate) fn read(
        fields: &TableReader<'a>,
        actuators: &[ParsedActuator<'_>],
        can_start_at_rest: bool,
        units: &Units,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        fields.reject_unknown_keys(table("motion"), diagnostics);
        let mut parsed = Self {
            initial_coordinates: vec![None; actuators.len()],
            initial_velocities: vec![None; actuators.len()],
            duration: duration(fields, diagnostics),
            prescribed: vec![None; actuators.len()],
            laws: vec![None; actuators.len()],
            events: Vec::new(),
        };
        if actuators.is_empty() {
            diagnostics.push(
                Diagnostic::new("there is a [motion] but no actuator")
                    .label(fields.span.clone(), "no coordinate can move")
                    .help("declare an independent coordinate, as in `[actuators.phi]`"),
            );
            return parsed;
        }
        let all_known = parsed.find_prescribed(fields, actuators, diagnostics);
        let each = |key, diagnostics: &mut Diagnostics| {
            let entry = fields.get(key);
            let each = PerActuator {
                key,
                actuators,
                prescribed: &parsed.prescribed,
                units,
            };
            each.read(entry, diagnostics)
        };
        let (initial_coordinates, initial_velocities) = (
            each("initial-coordinate", diagnostics),
            each("initial-velocity", diagnostics),
        );
        if let Some(initial_velocities) = &initial_velocities
            && all_known
            && !can_start_at_rest
            && parsed.prescribed.iter().all(Option::is_none)
        {
            report_missing_velocities(fields, actuators, initial_velocities, units, diagnostics);
        }
        if all_known {
            parsed.count_free(fields, actuators, diagnostics);
        }
        parsed.initial_coordinates = initial_coordinates.unwrap_or(parsed.initial_coordinates);
        parsed.initial_velocities = initial_velocities.unwrap_or(parsed.initial_velocities);
        parsed
    }

    /// Finds which actuators are prescribed; false where one of the names is unknown.
    fn find_prescribed(
        &mut self,
        fields: &TableReader<'a>,
        actuators: &[ParsedActuator<'_>],
        diagnostics: &mut Diagnostics,
    ) -> bool {
        let count = diagnostics.count();
        let laws = fields.get("prescribed");
        let laws = laws.and_then(|e| TableReader::open(e, "prescribed of [motion]", diagnostics));
        for entry in laws.iter().flat_map(|f| &f.entries) {
            if let Some(k) = find(entry, actuators, diagnostics) {
                self.prescribed[k] = Some(entry.clone());
            }
        }
        diagnostics.count() == count
    }

    /// At least one actuator has to be free, and exactly one where the duration is in periods.
    fn count_free(
        &self,
        fields: &TableReader<'_>,
        actuators: &[ParsedActuator<'_>],
        diagnostics: &mut Diagnostics,
    ) {
        let free = actuators
            .iter()
            .zip(&self.prescribed)
            .filter(|(_, l)| l.is_none());
        let free: Vec<_> = free.map(|(a, _)| a.name).collect();
        let names = list(free.iter().copied());
        if let (None, Some(laws)) = (&names, fields.get("prescribed")) {
            diagnostics.push(
                Diagnostic::new("[motion] prescribes every actuator: none is free")
                    .label(laws.key.clone(), "all of them")
                    .help("a motion in which all actuators are prescribed belongs in [prescribed]"),
            );
        }
        if let (Some(names), Some(periods)) = (names, fields.get("periods"))
            && free.len() > 1
        {
            diagnostics.push(
                Diagnostic::new(format!("`periods` with {} free actuators", free.len()))
                    .label(periods.key.clone(), "ambiguous: several actuators are free")
                    .help(format!(
                        "{names} are free: give the duration in s, as in `duration = 5.0`"
                    )),
            );
        }
    }

    /// Reads the laws of the prescribed actuators, which start at `assembly_coordinates` (SI, by actuator).
    pub(crate) fn read_laws(
        &mut self,
        actuators: &[ParsedActuator<'_>],
        assembly_coordinates: &[f64],
        units: &Units,
        diagnostics: &mut Diagnostics,
    ) {
        let end = match self.duration {
            Some((MotionDuration::Seconds(end), _)) => end,
            // How long periods take is not known yet, and no length has been reported.
            _ => 0.0,
        };
        for (k, actuator) in actuators.iter().enumerate() {
            if let Some(entry) = &self.prescribed[k] {
                let section = "[motion.prescribed]";
                self.laws[k] = law_of(
                    entry,
                    section,
                    actuator,
                    (assembly_coordinates[k], end),
                    units,
                    diagnostics,
                );
            }
        }
    }
}

/// The actuator that an entry is named by.
fn find(
    entry: &Entry<'_>,
    actuators: &[ParsedActuator<'_>],
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    let found = actuators.iter().position(|a| a.name == entry.name);
    if found.is_none() {
        let names = actuators.iter().map(|a| a.name);
        let help = diagnostics.choices(entry.name, "actuators", names);
        diagnostics.push(
            Diagnostic::new(format!("there is no actuator `{}`", shorten(entry.name)))
                .label(entry.key.clone(), "unknown actuator")
                .help(help),
        );
    }
    found
}

/// Reports missing initial velocities of a motion without loads, drives and motion laws.
fn report_missing_velocities(
    fields: &TableReader<'_>,
    actuators: &[ParsedActuator<'_>],
    initial_velocities: &[Option<(f64, Span)>],
    units: &Units,
    diagnostics: &mut Diagnostics,
) {
    let missing = actuators
        .iter()
        .zip(initial_velocities)
        .filter(|(_, s)| s.is_none());
    let missing: Vec<_> = missing.map(|(a, _)| a).collect();
    let Some(names) = list(missing.iter().map(|a| a.name)) else {
        return;
    };
    let at = fields
        .get("initial-velocity")
        .map_or(&fields.span, |e| &e.key);
    let unit = &missing[0].unit(units).name;
    diagnostics.push(
        Diagnostic::new(format!("the initial velocity of {names} is not given"))
            .label(at.clone(), "no initial velocity")
            .help(format!(
                "in {unit}/s: `initial-velocity = {{ {} = 1.0 }}`; without loads and drives the mechanism would not move",
                missing[0].name
            )),
    );
}

/// `initial-coordinate` or `initial-velocity`: one value for each free actuator, or a number for the only one.
struct PerActuator<'p, 'a> {
    key: &'static str,
    actuators: &'p [ParsedActuator<'p>],
    prescribed: &'p [Option<Entry<'a>>],
    units: &'p Units,
}

impl PerActuator<'_, '_> {
    /// What it says of each actuator; none if it is wrong.
    fn read(
        &self,
        entry: Option<&Entry<'_>>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<Option<(f64, Span)>>> {
        let mut values = vec![None; self.actuators.len()];
        let Some(entry) = entry else {
            return Some(values);
        };
        let what = format!("{} of [motion]", self.key);
        if let DeValue::Integer(_) | DeValue::Float(_) = entry.value.get_ref() {
            let k = self.only_free(entry, &what, diagnostics)?;
            let si = self.value(k, entry.value, format_args!("{what}"), diagnostics)?;
            values[k] = Some((si, entry.value.span()));
            return Some(values);
        }
        let count = diagnostics.count();
        let fields = TableReader::open(entry, what, diagnostics)?;
        for value in &fields.entries {
            let Some(k) = find(value, self.actuators, diagnostics) else {
                continue;
            };
            let (key, name) = (self.key, shorten(value.name));
            if let Some(law) = &self.prescribed[k] {
                diagnostics.push(
                    Diagnostic::new(format!(
                        "`{name}` in [motion] has both a motion law and an {key}"
                    ))
                    .label(law.key.clone(), "prescribed here")
                    .label(value.key.clone(), format!("{key} given here"))
                    .help("keep one of them: the law determines the whole motion of the actuator"),
                );
                continue;
            }
            let what = format_args!("{key} of `{name}` in [motion]");
            let si = self.value(k, value.value, what, diagnostics);
            values[k] = si.map(|si| (si, value.value.span()));
        }
        (diagnostics.count() == count).then_some(values)
    }

    /// The only free actuator.
    fn only_free(
        &self,
        entry: &Entry<'_>,
        what: &str,
        diagnostics: &mut Diagnostics,
    ) -> Option<usize> {
        let free: Vec<_> = (0..self.prescribed.len())
            .filter(|&k| self.prescribed[k].is_none())
            .collect();
        // Where none is free, that is reported elsewhere.
        if let [] | [_] = free.as_slice() {
            return free.first().copied();
        }
        let each = free
            .iter()
            .map(|&k| format!("{} = 0.0", self.actuators[k].name));
        let example = each.collect::<Vec<_>>().join(", ");
        let kind = match free.len() == self.prescribed.len() {
            true => "actuators",
            false => "free actuators",
        };
        diagnostics.push(
            Diagnostic::new(format!("{what} is one number for {} {kind}", free.len()))
                .label(entry.value.span(), "ambiguous")
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
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        let actuator = &self.actuators[k];
        match self.key {
            "initial-coordinate" => actuator.coordinate_value(value, self.units, what, diagnostics),
            _ => quantity(value, actuator.unit(self.units), what, diagnostics).map(|(_, si)| si),
        }
    }
}

fn duration(
    fields: &TableReader<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<(MotionDuration, Span)> {
    let (periods, duration) = (fields.get("periods"), fields.get("duration"));
    if let (Some(a), Some(b)) = (periods, duration) {
        diagnostics.push(
            Diagnostic::new("[motion] has both `periods` and `duration`")
                .label(a.key.clone(), "duration in periods")
                .label(b.key.clone(), "duration in seconds")
                .help("keep one of them"),
        );
        return None;
    }
    let Some(entry) = periods.or(duration) else {
        diagnostics.push(
            Diagnostic::new("[motion] has no duration")
                .label(fields.span.clone(), "no duration")
                .help("add `periods = 10`, or `duration = 5.0` in s"),
        );
        return None;
    };
    let value = positive(entry, "[motion]", diagnostics)?;
    let motion_duration = match periods {
        Some(_) => MotionDuration::Periods(value),
        None => MotionDuration::Seconds(value),
    };
    Some((motion_duration, entry.key.start..entry.value.span().end))
}

/// A number above zero: a time in s, or a count.
fn positive(entry: &Entry<'_>, section: &str, diagnostics: &mut Diagnostics) -> Option<f64> {
    let key = entry.name;
    let value = number(entry.value, format_args!("{key} in {section}"), diagnostics)?;
    if value > 0.0 {
        return Some(value);
    }
    diagnostics.push(
        Diagnostic::new(format!("{key} in {section} is not above zero"))
            .label(entry.value.span(), "expected a number above 0"),
    );
    None
}

/// `[calibration]`, and where the number it sets is named.
pub(crate) fn calibration(
    fields: &TableReader<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<(Calibration, Span)> {
    fields.reject_unknown_keys(table("calibration"), diagnostics);
    let missing = |key: &str, help: &str| {
        Diagnostic::new(format!("[calibration] has no `{key}`"))
            .label(fields.span.clone(), format!("`{key}` is missing"))
            .help(help)
    };
    let path = match fields.get("parameter") {
        Some(e) => string(
            e.value,
            format_args!("parameter in [calibration]"),
            diagnostics,
        )
        .map(|path| (path, e.value.span())),
        None => {
            let help = "name the number to be fitted: `parameter = \"crank.inertia\"`";
            diagnostics.push(missing("parameter", help));
            None
        }
    };
    let period = match fields.get("period") {
        Some(e) => positive(e, "[calibration]", diagnostics),
        None => {
            let help = "give the period to be met, in s: `period = 5.42`";
            diagnostics.push(missing("period", help));
            None
        }
    };
    let (path, at) = path?;
    let period = period?;
    let path = path.to_owned();
    Some((Calibration { path, period }, at))
}
