//! Prescribed motions and coordinate sweeps.

use crate::coordinates::ParsedActuator;
use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::keys::{TableSchema, table};
use crate::law::{LawDomain, law};
use crate::scene::{CoordinateSweep, PrescribedMotion};
use crate::table_reader::{Entry, SignRule, TableReader, Value, array, count, quantity_with_sign};
use crate::units::{Unit, Units};
use crate::wording::{list, shorten};
use dwell_geometry::ActuatorId;
use dwell_laws::Law;
use toml::de::DeValue;

/// Positions or times, where the scene does not say how many.
const DEFAULT_POINTS: usize = 361;

/// `[prescribed]` as read, and where each actuator's law is.
#[derive(Debug)]
pub(crate) struct ParsedPrescribedMotion {
    pub(crate) prescribed: Option<PrescribedMotion>,
    pub(crate) laws: Vec<Option<Span>>,
}

/// `[coordinate-sweep]` as read, and the span of each actuator's entry.
#[derive(Debug)]
pub(crate) struct ParsedSweep {
    pub(crate) sweep: Option<CoordinateSweep>,
    pub(crate) actuators: Vec<Option<Span>>,
}

/// The entries of a section that are named by actuators, in the order of these; the section's own
/// keys are no names.
fn by_actuator<'f, 'a>(
    fields: &'f TableReader<'a>,
    table: &TableSchema,
    actuators: &[ParsedActuator<'_>],
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Option<&'f Entry<'a>>>> {
    let section = &fields.what;
    if actuators.is_empty() {
        diagnostics.push(
            Diagnostic::new(format!("there is a {section} but no actuator"))
                .label(fields.span.clone(), "no coordinate can move")
                .help("declare an independent coordinate, as in `[actuators.phi]`"),
        );
        return None;
    }
    if let Some(a) = actuators.iter().find(|a| table.contains_key(a.name)) {
        let name = shorten(a.name);
        diagnostics.push(
            Diagnostic::new(format!(
                "actuator `{name}` has the name of a key of {section}"
            ))
            .label(a.key.clone(), "this name")
            .help(format!(
                "rename it: in {section} the name would be ambiguous"
            )),
        );
        return None;
    }
    let mut entries = vec![None; actuators.len()];
    for entry in fields
        .entries
        .iter()
        .filter(|e| !table.contains_key(e.name))
    {
        if let Some(k) = actuators.iter().position(|a| a.name == entry.name) {
            entries[k] = Some(entry);
            continue;
        }
        let section_keys = table.names();
        let names: Vec<&str> = actuators
            .iter()
            .map(|a| a.name)
            .chain(section_keys)
            .collect();
        let kind = format!("keys of {section}");
        let help = diagnostics.choices(entry.name, &kind, names.into_iter());
        diagnostics.push(
            Diagnostic::new(format!(
                "`{}` in {section} is neither an actuator nor a key of it",
                shorten(entry.name)
            ))
            .label(entry.key.clone(), "unknown name")
            .help(help),
        );
    }
    Some(entries)
}

impl ParsedPrescribedMotion {
    /// `start` holds each actuator's coordinate at assembly, SI.
    pub(crate) fn read(
        fields: &TableReader<'_>,
        actuators: &[ParsedActuator<'_>],
        start: &[f64],
        units: &Units,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let help = "add `duration = 2.0`: how long the motion lasts, in s";
        let duration = fields.require("duration", &fields.span, help, diagnostics);
        let duration = duration.and_then(|e| positive(e, fields, diagnostics));
        let points = points(fields, diagnostics);
        let Some(entries) = by_actuator(fields, table("prescribed"), actuators, diagnostics) else {
            return Self {
                prescribed: None,
                laws: Vec::new(),
            };
        };
        let missing = actuators.iter().zip(&entries).filter(|(_, e)| e.is_none());
        let missing: Vec<_> = missing.map(|(a, _)| a.name).collect();
        if let Some(names) = list(missing.iter().copied()) {
            diagnostics.push(
                Diagnostic::new(format!("[prescribed] has no law of {names}"))
                    .label(fields.span.clone(), "no motion law")
                    .help(format!(
                        "add for instance `{} = {{ speed = 1.0 }}`; a fixed actuator has speed 0",
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
                law_of((*e)?, "[prescribed]", a, (start, end), units, diagnostics)
            })
            .collect();
        let laws: Option<Vec<Law>> = laws.into_iter().collect();
        Self {
            prescribed: duration
                .zip(points)
                .zip(laws)
                .map(|((duration, points), laws)| PrescribedMotion {
                    duration,
                    points,
                    laws,
                }),
            laws: entries.iter().map(|e| e.map(|e| e.key.clone())).collect(),
        }
    }
}

/// The law of an actuator from time 0 to `end` (s); a constant speed, a sinusoid and a rise start from `start` (SI).
pub(crate) fn law_of(
    entry: &Entry<'_>,
    section: &str,
    actuator: &ParsedActuator<'_>,
    (start, end): (f64, f64),
    units: &Units,
    diagnostics: &mut Diagnostics,
) -> Option<Law> {
    let what = format!("`{}` in {section}", shorten(entry.name));
    let fields = TableReader::open(entry, what, diagnostics)?;
    fields.reject_unknown_keys(table("law"), diagnostics);
    let Some(chosen) = fields
        .one_of(|n| table("law").contains_key(n), diagnostics)
        .ok()?
    else {
        if fields.has_unknown_keys(table("law")) {
            return None;
        }
        let laws = list(table("law").names()).unwrap_or_default();
        diagnostics.push(
            Diagnostic::new(format!("{} has no law", fields.what))
                .label(entry.value.span(), "no motion law")
                .help(format!(
                    "write it as `{{ speed = 1.0 }}`; the laws are {laws}"
                )),
        );
        return None;
    };
    let domain = LawDomain {
        variable: "t",
        x_unit: &Unit::si_unit(),
        y_unit: actuator.unit(units),
        start_value: start,
        end_time: Some(end),
    };
    law(chosen, &fields.what, &domain, units, diagnostics)
}

fn positive(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let what = format_args!("{} in {}", entry.name, fields.what);
    let seconds = Unit::si_unit();
    quantity_with_sign(
        entry.value,
        &seconds,
        SignRule::Positive,
        what,
        "",
        diagnostics,
    )
}

fn points(fields: &TableReader<'_>, diagnostics: &mut Diagnostics) -> Option<usize> {
    let Some(entry) = fields.get("points") else {
        return Some(DEFAULT_POINTS);
    };
    let what = format_args!("points in {}", fields.what);
    count(entry.value, what, diagnostics)
}

impl ParsedSweep {
    pub(crate) fn read(
        fields: &TableReader<'_>,
        actuators: &[ParsedActuator<'_>],
        start: &[f64],
        units: &Units,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let before = diagnostics.count();
        let points = points(fields, diagnostics);
        let Some(entries) = by_actuator(fields, table("coordinate-sweep"), actuators, diagnostics)
        else {
            return Self {
                sweep: None,
                actuators: Vec::new(),
            };
        };
        let mut fixed_coordinates = start.to_vec();
        let mut range: Option<(usize, [f64; 2], Span)> = None;
        for (k, entry) in entries.iter().enumerate() {
            let Some(entry) = entry else { continue };
            match sweep_coordinate(entry, &actuators[k], units, diagnostics) {
                Some(SweepCoordinate::Fixed(at)) => fixed_coordinates[k] = at,
                Some(SweepCoordinate::Swept(ends)) => match &range {
                    Some((_, _, other)) => diagnostics.push(
                        Diagnostic::new("[coordinate-sweep] sweeps two actuators")
                            .label(other.clone(), "swept here")
                            .label(entry.value.span(), "and swept here")
                            .help("fix all but one of them with a single number"),
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
        if swept.is_none() && diagnostics.count() == before {
            diagnostics.push(
                Diagnostic::new("[coordinate-sweep] does not name the swept actuator")
                    .label(fields.span.clone(), "several actuators are possible")
                    .help(format!(
                        "give one of them an interval: `{} = [0.0, 1.0]`",
                        actuators[0].name
                    )),
            );
        }
        let speed = match (fields.get("speed"), swept) {
            (None, _) => Some(1.0),
            (Some(e), k) => {
                let unit = units.coordinate_unit(k.is_none_or(|k| actuators[k].is_angle()));
                let why = "the order of the interval's ends gives the direction";
                let what = format_args!("speed in [coordinate-sweep]");
                quantity_with_sign(e.value, unit, SignRule::Positive, what, why, diagnostics)
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
            sweep: Some(CoordinateSweep {
                actuator: ActuatorId(k),
                range: range.map(|(_, ends, _)| ends),
                fixed_coordinates,
                points,
                speed,
            }),
            actuators: spans,
        }
    }
}

/// Where an actuator is during a sweep.
enum SweepCoordinate {
    Fixed(f64),
    Swept([f64; 2]),
}

fn sweep_coordinate(
    entry: &Entry<'_>,
    actuator: &ParsedActuator<'_>,
    units: &Units,
    diagnostics: &mut Diagnostics,
) -> Option<SweepCoordinate> {
    let name = shorten(entry.name);
    let read = |value: &Value<'_>, diagnostics: &mut Diagnostics| {
        let what = format_args!("`{name}` in [coordinate-sweep]");
        actuator.coordinate_value(value, units, what, diagnostics)
    };
    if let DeValue::Integer(_) | DeValue::Float(_) = entry.value.get_ref() {
        return read(entry.value, diagnostics).map(SweepCoordinate::Fixed);
    }
    let expected = "a number, or an interval [from, to]";
    let what = format_args!("`{name}` in [coordinate-sweep]");
    let values = array(entry.value, expected, what, diagnostics)?;
    let [from, to] = values else {
        diagnostics.push(
            Diagnostic::new(format!("{what}: expected {expected}"))
                .label(entry.value.span(), format!("{} values", values.len())),
        );
        return None;
    };
    let (from, to) = (read(from, diagnostics), read(to, diagnostics));
    let (from, to) = (from?, to?);
    if from == to {
        diagnostics.push(
            Diagnostic::new(format!("{what} ends where it begins"))
                .label(entry.value.span(), "nothing to sweep")
                .help("a single number fixes the actuator there"),
        );
        return None;
    }
    Some(SweepCoordinate::Swept([from, to]))
}
