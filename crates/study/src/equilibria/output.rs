//! Writes equilibria: table, figure and summary.

use super::figures;
use crate::equilibria::compute::{EquilibriaResults, SearchedRange, compute_equilibria};
use crate::explain::StudyError;
use crate::machines::{MachineScene, SceneMachine};
use crate::number_format::{coordinate_unit, count, digits, digits_within, force_unit, number};
use crate::output::{Outcome, add_results_page};
use crate::page::{scene_page, table_page, unit_group};
use crate::ranges::extent;
use dwell_dynamics::{Equilibrium, NeutralDirection, Stability};
use dwell_findings::{Column, Record, Table};
use dwell_page::Page;
use dwell_report::TableExport as _;
use std::f64::consts::TAU;

/// The equilibria of a scene: with one coordinate, all in its range; with several, those that Newton's method finds
/// from many starts.
///
/// # Errors
/// [`StudyError`] when a load depends on time, or with several coordinates none is found.
pub fn equilibria<S: MachineScene>(scene: &S) -> Result<Outcome, StudyError> {
    let results = compute_equilibria(scene)?;
    let mut outcome = Outcome::default();
    let stem = format!("{}-equilibria", scene.name);
    outcome
        .files
        .add(format!("{stem}.csv"), results.table.csv()?);
    outcome.summary = summary(&results, &mut outcome.record);
    outcome.run = static_force_page(scene, &results).map(Box::new);
    let figure = results.curves.as_ref();
    let figure = figure.map(|curves| figures::equilibria(&results, curves));
    add_results_page(&mut outcome, scene, "equilibria", &stem, figure);
    Ok(outcome)
}

/// The static force and the potential over the range of the only coordinate, with the mechanism, unless another one is
/// prescribed.
fn static_force_page<S: MachineScene>(
    scene: &S,
    results: &EquilibriaResults<'_, S>,
) -> Option<Page> {
    let curves = results.curves.as_ref()?;
    let (i, is_angle) = results.prepared.first_free_coordinate();
    let (name, unit) = coordinate(&results.prepared, i);
    let rows = curves.q.iter().zip(&curves.force_and_potential);
    let table = Table {
        columns: vec![
            Column::new(name, unit),
            Column::new("static_force", force_unit(is_angle)),
            Column::new("potential", "J"),
        ],
        rows: rows
            .map(|(q, [force, potential])| vec![*q, *force, *potential])
            .collect(),
    };
    let mut page = table_page(scene_page(scene, "equilibria"), &table, unit_group);
    page.subtitle = format!("static force and potential over {name}");
    page.drawing = scene.drawing_along(&page.columns[0].values);
    Some(page)
}

/// The summary of the equilibria; its numbers are recorded.
fn summary(results: &EquilibriaResults<'_, impl MachineScene>, record: &mut Record) -> String {
    let (prepared, found) = (&results.prepared, &results.found);
    record.add_count("equilibria", found.len());
    let found_count = match found.len() {
        0 => "no equilibrium".to_owned(),
        1 => "1 equilibrium".to_owned(),
        n => format!("{n} equilibria"),
    };
    let searched = searched_text(results, record);
    let mut text = format!("{}: {found_count} of {searched}\n", prepared.scene.title);
    if let Some(curves) = results.curves.as_ref().filter(|_| found.is_empty()) {
        let (coordinate, is_angle) = prepared.first_free_coordinate();
        let forces = curves.force_and_potential.iter().map(|[force, _]| *force);
        let ends = extent(forces);
        let (name, unit) = (prepared.coordinate_name(coordinate), force_unit(is_angle));
        record.add("static_force.min", unit, ends[0]);
        record.add("static_force.max", unit, ends[1]);
        let [low, high] = ends.map(number);
        text += &if low == high {
            format!("  the static force along {name} is {low} {unit} everywhere\n")
        } else {
            format!("  the static force along {name} stays between {low} and {high} {unit}\n")
        };
    }
    for (k, equilibrium) in found.iter().enumerate() {
        let of = format!("equilibrium.{}", k + 1);
        text += &describe_equilibrium(prepared, equilibrium, &of, record);
    }
    text + &prepared.branch_note()
}

/// The text about the range in which equilibria were searched for.
fn searched_text(
    results: &EquilibriaResults<'_, impl MachineScene>,
    record: &mut Record,
) -> String {
    let (prepared, free) = (&results.prepared, results.prepared.machine.free());
    let mut range = |i: usize, [from, to]: [f64; 2]| {
        let (name, unit) = coordinate(prepared, i);
        record.add(format!("searched.{name}.from"), unit, from);
        record.add(format!("searched.{name}.to"), unit, to);
        interval_text(prepared, i, [from, to])
    };
    match &results.searched {
        SearchedRange::Interval([from, to]) => {
            let (first, is_angle) = prepared.first_free_coordinate();
            let is_whole_period = is_angle && (to - from) >= TAU * (1.0 - 1e-12);
            let period = if is_whole_period {
                ", one revolution around the start"
            } else {
                ""
            };
            let interval = range(first, [*from, *to]);
            let ends = [(*from, from - to), (*to, to - from)];
            let tables = ends.map(|(end, width)| prepared.table_that_ends(end, width));
            let tables = tables.iter().flatten();
            let tables = tables.map(|load| format!("; the table of load `{load}` ends there"));
            let tables: String = tables.take(1).collect();
            format!("{interval}{period}{tables}")
        }
        SearchedRange::Starts { starts, ranges } => {
            let each = free.iter().zip(ranges);
            let each: Vec<String> = each.map(|(&i, of)| range(i, *of)).collect();
            record.add_count("starts", *starts);
            record.add_count("free_coordinates", ranges.len());
            format!(
                "{} found from {starts} starts, spread evenly over {}; a search from starts \
                 cannot prove that there are no others",
                count(free.len(), "free coordinate"),
                each.join(", ")
            )
        }
    }
}

/// The name of a coordinate, and its unit.
fn coordinate<'a>(
    prepared: &'a SceneMachine<'_, impl MachineScene>,
    i: usize,
) -> (&'a str, &'static str) {
    let unit = coordinate_unit(prepared.is_angle(i));
    (prepared.coordinate_name(i), unit)
}

/// `phi between 10° and 20°`.
fn interval_text(
    prepared: &SceneMachine<'_, impl MachineScene>,
    actuator: usize,
    interval: [f64; 2],
) -> String {
    let [from, to] = interval.map(|q| {
        if prepared.is_angle(actuator) {
            format!("{}°", digits(q.to_degrees(), 6))
        } else {
            format!("{} m", digits(q, 6))
        }
    });
    format!(
        "{} between {from} and {to}",
        prepared.coordinate_name(actuator)
    )
}

/// An equilibrium as text; its numbers are recorded under names that begin with `of`.
pub(crate) fn describe_equilibrium(
    prepared: &SceneMachine<'_, impl MachineScene>,
    equilibrium: &Equilibrium,
    of: &str,
    record: &mut Record,
) -> String {
    let start = prepared.initial_state();
    let (mut positions, mut errors) = (Vec::new(), Vec::new());
    for (k, &i) in prepared.machine.free().iter().enumerate() {
        let (name, unit) = coordinate(prepared, i);
        let (q, error) = (equilibrium.y[k], equilibrium.errors[k]);
        let from_start = q - start[k];
        let error_from_start = error + f64::EPSILON * q.abs().max(start[k].abs());
        record.add_within(format!("{of}.{name}"), unit, q, error);
        let name_from_start = format!("{of}.{name}.from_start");
        record.add_within(name_from_start, unit, from_start, error_from_start);
        let deflection = digits_within(from_start, error_from_start, 6);
        let position = prepared.describe_coordinate_within(i, q, error);
        positions.push(format!("{position}, {deflection} {unit} from the start"));
        errors.push(format!("{error:.1e} {unit} in {name}"));
    }
    let stability = match equilibrium.stability {
        Stability::Asymptotic => "asymptotically stable",
        Stability::Centre => "stable without damping (centre)",
        Stability::Unstable => "unstable",
        Stability::Neutral => "neutral",
        Stability::Undecided => "stability is not decided by the linearisation",
    };
    let mut text = format!("  {}: {stability}\n", positions.join("; "));
    for (n, neutral) in equilibrium.neutral.iter().enumerate() {
        text += &describe_neutral(
            prepared,
            neutral,
            &format!("{of}.neutral.{}", n + 1),
            record,
        );
    }
    let (values, value_errors) = (&equilibrium.eigenvalues, &equilibrium.eigenvalue_errors);
    let (lines, error) = describe_eigenvalues(values, value_errors, of, record);
    let errors = errors.join(", ");
    text + &lines + &format!("    estimated errors: {errors}, {error}")
}

/// A direction in which equilibria go on, as text and as numbers under names that begin with `of`.
fn describe_neutral(
    prepared: &SceneMachine<'_, impl MachineScene>,
    neutral: &NeutralDirection,
    of: &str,
    record: &mut Record,
) -> String {
    let free = prepared.machine.free().iter().zip(&neutral.direction);
    let moved: Vec<(usize, f64)> = free
        .filter(|(_, part)| **part != 0.0)
        .map(|(&i, part)| (i, *part))
        .collect();
    for &(i, part) in &moved {
        let (name, unit) = coordinate(prepared, i);
        let of = format!("{of}.{name}");
        record.add(&of, unit, part);
        if let Some([from, to]) = neutral.extent {
            record.add(format!("{of}.from"), unit, from);
            record.add(format!("{of}.to"), unit, to);
        }
    }
    match (neutral.extent, moved.as_slice()) {
        (Some(extent), &[(i, _)]) => {
            let interval = interval_text(prepared, i, extent);
            format!("    neutral: every position of {interval} is an equilibrium\n")
        }
        (_, &[(i, _)]) => {
            let name = prepared.coordinate_name(i);
            format!(
                "    neutral direction {name}: no force drives it back or away, so it stays at any position\n"
            )
        }
        (_, several) => {
            let parts = several.iter().map(|&(i, part)| {
                let (name, unit) = coordinate(prepared, i);
                format!("{} {unit} of {name}", digits(part, 4))
            });
            let parts: Vec<String> = parts.collect();
            format!(
                "    neutral direction {}: no force drives them back or away along this direction\n",
                parts.join(" with ")
            )
        }
    }
}

/// Eigenvalues as text, to the digits that their errors leave, and their largest error: a complex pair once, with its frequency and
/// damping. The numbers are recorded under names that begin with `of`.
pub(crate) fn describe_eigenvalues(
    values: &[[f64; 2]],
    errors: &[f64],
    of: &str,
    record: &mut Record,
) -> (String, String) {
    let mut text = String::new();
    for (k, (&[re, im], &error)) in values.iter().zip(errors).enumerate() {
        let name = |what: &str| format!("{of}.eigenvalue.{}.{what}", k + 1);
        record.add_within(name("re"), "1/s", re, error);
        record.add_within(name("im"), "1/s", im, error);
        let within = |value: f64, error: f64| digits_within(value, error, 9);
        let [a, b] = [re, im].map(|part| within(part, error));
        if im.abs() <= error {
            text += &format!("    eigenvalue {a} 1/s\n");
        } else if im >= 0.0 {
            let size = re.hypot(im);
            let (frequency, frequency_error) = (size / TAU, error / TAU);
            let (damping, damping_error) = (-re / size, error / size);
            record.add_within(name("angular_frequency"), "rad/s", size, error);
            record.add_within(name("frequency"), "Hz", frequency, frequency_error);
            record.add_within(name("damping_ratio"), "", damping, damping_error);
            let (angular, frequency) = (within(size, error), within(frequency, frequency_error));
            let damping = digits_within(damping, damping_error, 6);
            text += &format!(
                "    eigenvalues {a} ± {b}i 1/s: {angular} rad/s = {frequency} Hz, damping ratio {damping}\n"
            );
        }
    }
    let largest = errors.iter().copied().fold(0.0, f64::max);
    record.add(format!("{of}.error.eigenvalues"), "1/s", largest);
    (text, format!("{largest:.1e} 1/s in the eigenvalues\n"))
}
