//! Prescribed motions and coordinate sweeps.

use crate::coordinates::NamedActuator;
use crate::diagnostics::Span;
use crate::keys::{TableSchema, table};
use crate::law::{LawDomain, interpolation, law};
use crate::scene_data::{CoordinateSweep, PrescribedMotion};
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::SI;
use crate::value::{NumberRule, SignRule, Value};
use crate::wording::{list, shorten};
use dwell_geometry::ActuatorId;
use dwell_laws::{Interpolation, Law};

/// Positions or times, where the scene does not give their number.
const DEFAULT_POINTS: usize = 361;

/// Reports a section of motion in a scene without actuators.
pub(crate) fn require_actuators(
    fields: &TableReader<'_>,
    actuators: &[NamedActuator<'_>],
) -> Option<()> {
    if actuators.is_empty() {
        let message = format!("there is a {} but no actuator", fields.what);
        let labels = [(&fields.span, "no coordinate can move")];
        let help = "declare an independent coordinate, as in `[actuators.phi]`";
        return fields.log().reject(message, &labels, help);
    }
    Some(())
}

/// The actuator that an entry is named by.
pub(crate) fn actuator_named(entry: &Entry<'_>, actuators: &[NamedActuator<'_>]) -> Option<usize> {
    let found = actuators.iter().position(|a| a.name == entry.name);
    found.or_else(|| {
        let names = actuators.iter().map(|a| a.name);
        let help = entry.log().choices(entry.name, "actuators", names);
        let message = format!("there is no actuator `{}`", shorten(entry.name));
        entry.reject(message, "unknown actuator", help)
    })
}

/// The entries of a section that are named by actuators, in the order of these; the section's own
/// keys are no names.
fn entries_by_actuator<'f, 'a>(
    fields: &'f TableReader<'a>,
    table: &'static TableSchema,
    actuators: &[NamedActuator<'_>],
) -> Option<Vec<Option<&'f Entry<'a>>>> {
    let section = &fields.what;
    require_actuators(fields, actuators)?;
    if let Some(a) = actuators.iter().find(|a| table.contains_key(a.name)) {
        let name = shorten(a.name);
        let message = format!("actuator `{name}` has the name of a key of {section}");
        let help = format!("rename it: in {section} the name would be ambiguous");
        return fields.log().reject(message, &[(&a.key, "this name")], help);
    }
    let mut entries = vec![None; actuators.len()];
    for entry in fields.unknown_entries(table) {
        if let Some(k) = actuators.iter().position(|a| a.name == entry.name) {
            entries[k] = Some(entry);
            continue;
        }
        let names = actuators.iter().map(|a| a.name).chain(table.names());
        let (name, kind) = (shorten(entry.name), format!("keys of {section}"));
        let help = fields.log().choices(entry.name, &kind, names);
        let message = format!("`{name}` in {section} is neither an actuator nor a key of it");
        entry.reject::<()>(message, "unknown name", help);
    }
    Some(entries)
}

/// `[prescribed]`; `start` holds each actuator's coordinate at assembly, SI.
pub(crate) fn prescribed_motion(
    fields: &TableReader<'_>,
    actuators: &[NamedActuator<'_>],
    start: &[f64],
) -> Option<PrescribedMotion> {
    let help = "add `duration = 2.0`: how long the motion lasts, in s";
    let duration = fields.require("duration", help);
    let duration = duration.and_then(|e| positive(e, &fields.what));
    let points = points(fields);
    let entries = entries_by_actuator(fields, table("prescribed"), actuators)?;
    let missing = actuators.iter().zip(&entries).filter(|(_, e)| e.is_none());
    let missing: Vec<_> = missing.map(|(a, _)| a.name).collect();
    if let Some(names) = list(missing.iter().copied()) {
        let message = format!("[prescribed] has no law of {names}");
        let help = format!(
            "add for instance `{} = {{ speed = 1.0 }}`; a fixed actuator has speed 0",
            missing[0]
        );
        fields
            .log()
            .report(message, &[(&fields.span, "no motion law")], help);
    }
    // A wrong duration is reported once, not again for each table.
    let end = duration.unwrap_or(0.0);
    let law = |(k, entry): (usize, &Option<&Entry<'_>>)| {
        let entry = (*entry)?;
        let location = SceneLocation::PrescribedLaw(ActuatorId(k));
        entry.place(location);
        law_of(entry, "[prescribed]", &actuators[k], start[k], end)
    };
    // All are read before one is missed, so that each error is reported.
    let laws: Vec<Option<Law>> = entries.iter().enumerate().map(law).collect();
    Some(PrescribedMotion {
        duration: duration?,
        points: points?,
        laws: laws.into_iter().collect::<Option<_>>()?,
    })
}

/// The law of an actuator from time 0 to `end` (s); a constant speed, a sinusoid and a rise start from `start` (SI).
pub(crate) fn law_of(
    entry: &Entry<'_>,
    section: &str,
    actuator: &NamedActuator<'_>,
    start: f64,
    end: f64,
) -> Option<Law> {
    let fields = TableReader::open(entry, format!("`{}` in {section}", shorten(entry.name)))?;
    fields.reject_unknown_keys(table("law"));
    let laws = list(table("law").alternatives().into_iter()).unwrap_or_default();
    let help = format!("write it as `{{ speed = 1.0 }}`; the laws are {laws}");
    let chosen = fields.alternative(table("law"), "has no law", "no motion law", help)?;
    let domain = LawDomain {
        variable: "t",
        x_unit: &SI,
        y_unit: actuator.unit(fields.units()),
        start_value: start,
        interpolation: interpolation(&fields, Interpolation::Spline)?,
        end_time: Some(end),
    };
    law(chosen, &fields.what, &domain)
}

/// A number above zero: a time in s, or a count.
pub(crate) fn positive(entry: &Entry<'_>, section: &str) -> Option<f64> {
    let rule = NumberRule::new(&SI, SignRule::Positive);
    entry
        .value
        .quantity_with_sign(&rule, format_args!("{} in {section}", entry.written()))
}

fn points(fields: &TableReader<'_>) -> Option<usize> {
    match fields.get("points") {
        Some(entry) => entry.value.count(format_args!("points in {}", fields.what)),
        None => Some(DEFAULT_POINTS),
    }
}

/// `[coordinate-sweep]`; `start` holds each actuator's coordinate at assembly, SI.
pub(crate) fn coordinate_sweep(
    fields: &TableReader<'_>,
    actuators: &[NamedActuator<'_>],
    start: &[f64],
) -> Option<CoordinateSweep> {
    let before = fields.log().count();
    let points = points(fields);
    let entries = entries_by_actuator(fields, table("coordinate-sweep"), actuators)?;
    let mut fixed_coordinates = start.to_vec();
    let mut range: Option<(usize, [f64; 2], Span)> = None;
    for (k, entry) in entries.iter().enumerate() {
        let Some(entry) = entry else { continue };
        let location = SceneLocation::Swept(ActuatorId(k));
        fields.log().place(location, &entry.span());
        match sweep_coordinate(entry, &actuators[k]) {
            Some(SweepCoordinate::Fixed(at)) => fixed_coordinates[k] = at,
            Some(SweepCoordinate::Swept(ends)) => match &range {
                Some((_, _, other)) => {
                    let message = "[coordinate-sweep] sweeps two actuators";
                    let second = (&entry.value.span(), "and swept here");
                    let help = "fix all but one of them with a single number";
                    fields
                        .log()
                        .report(message, &[(other, "swept here"), second], help);
                }
                None => range = Some((k, ends, entry.value.span())),
            },
            None => {}
        }
    }
    let mut not_named = (0..actuators.len()).filter(|&k| entries[k].is_none());
    let swept = match (&range, not_named.next(), not_named.next()) {
        (Some((k, ..)), ..) => Some(*k),
        (None, only, None) => only,
        (None, ..) => None,
    };
    if swept.is_none() && fields.log().count() == before {
        let message = "[coordinate-sweep] does not name the swept actuator";
        let labels = [(&fields.span, "several actuators are possible")];
        let first = actuators[0].name;
        let help = format!("give one of them an interval: `{first} = [0.0, 1.0]`");
        fields.log().report(message, &labels, help);
    }
    let is_angle = swept.is_none_or(|k| actuators[k].is_angle());
    let rule = NumberRule::new(fields.units().coordinate_unit(is_angle), SignRule::Positive)
        .because("the order of the interval's ends gives the direction");
    let speed = fields.number_or(1.0, "speed", &rule);
    Some(CoordinateSweep {
        actuator: ActuatorId(swept?),
        range: range.map(|(_, ends, _)| ends),
        fixed_coordinates,
        points: points?,
        speed: speed?,
    })
}

/// Where an actuator is during a sweep.
enum SweepCoordinate {
    Fixed(f64),
    Swept([f64; 2]),
}

fn sweep_coordinate(entry: &Entry<'_>, actuator: &NamedActuator<'_>) -> Option<SweepCoordinate> {
    let what = format!("`{}` in [coordinate-sweep]", shorten(entry.name));
    let read = |value: Value<'_>| actuator.coordinate_value(value, &what);
    let value = entry.value;
    if value.is_number() {
        return read(value).map(SweepCoordinate::Fixed);
    }
    let expected = "a number, or an interval [from, to]";
    let values = value.array(expected, &what)?;
    let [from, to] = values.as_slice() else {
        let label = format!("{} values", values.len());
        return value.reject(format!("{what}: expected {expected}"), &label, "");
    };
    let (from, to) = (read(*from), read(*to));
    let (from, to) = (from?, to?);
    if from == to {
        let message = format!("{what} ends where it begins");
        let help = "a single number fixes the actuator there";
        return value.reject(message, "nothing to sweep", help);
    }
    Some(SweepCoordinate::Swept([from, to]))
}
