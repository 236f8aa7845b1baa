//! Errors for arguments beyond the ends of a load's table, where the load is undefined.

use super::{NamedScene, StudyError, scene_error};
use crate::number_format::{coordinate_unit, number};
use dwell_kinetostatics::{Magnitude, Signal};
use dwell_laws::{Law, Spline};
use dwell_scene::SceneLocation;

/// Fraction of a table's range by which its argument may exceed it: angles and lengths computed from a pose carry a few roundings.
const RANGE_TOLERANCE: f64 = 1e-12;

/// The table of a load and its argument, if it has one.
pub(crate) fn table_of<C: Copy>(magnitude: &Magnitude<C>) -> Option<(Signal<C>, &Spline)> {
    match magnitude {
        Magnitude::Law(signal, Law::Spline(spline)) => Some((*signal, spline)),
        _ => None,
    }
}

/// Whether a table covers `x`.
pub(crate) fn covers(table: &Spline, x: f64) -> bool {
    let [first, last] = table.range();
    let tolerance = RANGE_TOLERANCE * (last - first);
    (first - tolerance..=last + tolerance).contains(&x)
}

/// The error if the table of a magnitude does not cover a value of its argument; `when` describes the place in the motion. Coordinates
/// are given by their names and whether they are angles.
pub(crate) fn off_table_error<C: Copy>(
    scene: &impl NamedScene,
    magnitude: &Magnitude<C>,
    name_of: impl Fn(C) -> String,
    is_angle: impl Fn(C) -> bool,
    load: usize,
    value: f64,
    when: &str,
) -> Option<StudyError> {
    let (signal, table) = table_of(magnitude)?;
    let (name, unit) = match signal {
        Signal::Time => ("t".to_owned(), "s"),
        Signal::Value(c) => (name_of(c), coordinate_unit(is_angle(c))),
        Signal::Velocity(c) => {
            let unit = if is_angle(c) { "rad/s" } else { "m/s" };
            (format!("{}.velocity", name_of(c)), unit)
        }
    };
    let value_text = |value: f64| match unit {
        "rad" => format!("{} rad ({}°)", number(value), number(value.to_degrees())),
        unit => format!("{} {unit}", number(value)),
    };
    let [first, last] = table.range().map(value_text);
    let table_range = format!("from {first} to {last}");
    let help = match unit {
        "rad" => format!(
            "extend the table to the angles of the motion, which are not reduced to one revolution; or write an \
             expression, in which `{name} - tau*floor({name}/tau)` is the angle within a revolution"
        ),
        _ => "extend the table, or write an expression".to_owned(),
    };
    let (load_name, value) = (scene.load_name(load).unwrap_or(""), value_text(value));
    let message = format!(
        "the table of load `{load_name}` covers {name} {table_range}, but {name} is {value} {when}"
    );
    let place = (SceneLocation::Magnitude(load), table_range);
    Some(scene_error(scene, message, help, [place]))
}
