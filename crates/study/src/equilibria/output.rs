//! Writes equilibria: table, figure and summary.

use super::figures;
use crate::equilibria::compute::{EquilibriaResults, SearchedRange, compute_equilibria};
use crate::explain::StudyError;
use crate::machines::{MachineScene, SceneMachine};
use crate::number_format::{coordinate_unit, count, digits, digits_within, force_unit, number};
use crate::output::{Outcome, Picture, results_page};
use crate::page::{scene_page, table_page, unit_group};
use crate::ranges::extent;
use dwell_dynamics::{Equilibrium, Stability};
use dwell_findings::{Column, Record, Table};
use dwell_page::Page;
use dwell_report::TableExport as _;
use std::f64::consts::TAU;

/// The equilibria of a scene: with one coordinate all of its range, with several those that Newton's method finds from
/// many starts.
///
/// # Errors
/// [`StudyError`] when a load depends on time, or with several coordinates none is found.
pub fn equilibria<S: MachineScene>(scene: &S) -> Result<Outcome, StudyError> {
    let results = compute_equilibria(scene)?;
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-equilibria.{rest}", scene.name);
    outcome.files.add(name("csv"), results.table.csv()?);
    outcome.summary = summary(&results);
    outcome.record = record(&results);
    outcome.run = static_force_page(scene, &results).map(Box::new);
    let figure = results.curves.as_ref();
    let figure = figure.map(|curves| figures::equilibria(&results, curves));
    let figures: Vec<_> = figure.iter().map(|figure| (figure, name("png"))).collect();
    let text = (outcome.summary.as_str(), &outcome.record);
    let page = results_page(scene, "equilibria", text, &figures);
    outcome.page = Some((name("md"), page));
    outcome.pictures = figure
        .into_iter()
        .map(|figure| Picture::figure(scene, name("png"), true, figure))
        .collect();
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

fn summary(results: &EquilibriaResults<'_, impl MachineScene>) -> String {
    let (prepared, found) = (&results.prepared, &results.found);
    let title = &prepared.scene.title;
    let found_count = match found.len() {
        0 => "no equilibrium".to_owned(),
        1 => "1 equilibrium".to_owned(),
        n => format!("{n} equilibria"),
    };
    let free = prepared.machine.free();
    let mut text = match &results.searched {
        SearchedRange::Interval([from, to]) => {
            let (coordinate, is_angle) = prepared.first_free_coordinate();
            let is_whole_period = is_angle && (to - from) >= TAU * (1.0 - 1e-12);
            let period = match is_whole_period {
                true => ", one revolution around the start",
                false => "",
            };
            let interval = interval_text(prepared, coordinate, [*from, *to]);
            let ends = [(*from, from - to), (*to, to - from)];
            let tables = ends.map(|(end, width)| prepared.table_that_ends(end, width));
            let tables = tables.iter().flatten();
            let tables = tables.map(|load| format!("; the table of load `{load}` ends there"));
            let tables: String = tables.take(1).collect();
            format!("{title}: {found_count} of {interval}{period}{tables}\n")
        }
        SearchedRange::Starts { starts, ranges } => {
            let ranges = free.iter().zip(ranges);
            let ranges: Vec<String> = ranges
                .map(|(&i, range)| interval_text(prepared, i, *range))
                .collect();
            format!(
                "{title}: {found_count} of {} found from {starts} starts, spread evenly over {}; a search from starts \
                 cannot prove that there are no others\n",
                count(free.len(), "free coordinate"),
                ranges.join(", ")
            )
        }
    };
    if let Some(curves) = results.curves.as_ref().filter(|_| found.is_empty()) {
        let (coordinate, is_angle) = prepared.first_free_coordinate();
        let forces = curves.force_and_potential.iter().map(|[force, _]| *force);
        let [low, high] = extent(forces).map(number);
        let (name, unit) = (prepared.coordinate_name(coordinate), force_unit(is_angle));
        text += &match low == high {
            true => format!("  the static force along {name} is {low} {unit} everywhere\n"),
            false => {
                format!("  the static force along {name} stays between {low} and {high} {unit}\n")
            }
        };
    }
    for equilibrium in found {
        text += &describe_equilibrium(prepared, equilibrium);
    }
    text + &prepared.branch_note()
}

/// The numbers of the summary.
fn record(results: &EquilibriaResults<'_, impl MachineScene>) -> Record {
    let (prepared, found) = (&results.prepared, &results.found);
    let mut record = Record::default();
    record.add_count("equilibria", found.len());
    let mut range = |i: usize, [from, to]: [f64; 2]| {
        let (name, unit) = coordinate(prepared, i);
        record.add(format!("searched.{name}.from"), unit, from);
        record.add(format!("searched.{name}.to"), unit, to);
    };
    match &results.searched {
        SearchedRange::Interval(interval) => range(prepared.first_free_coordinate().0, *interval),
        SearchedRange::Starts { starts, ranges } => {
            let free = prepared.machine.free().iter();
            free.zip(ranges).for_each(|(&i, of)| range(i, *of));
            record.add_count("starts", *starts);
            record.add_count("free_coordinates", ranges.len());
        }
    }
    if let Some(curves) = results.curves.as_ref().filter(|_| found.is_empty()) {
        let (_, is_angle) = prepared.first_free_coordinate();
        let forces = curves.force_and_potential.iter().map(|[force, _]| *force);
        let [low, high] = extent(forces);
        record.add("static_force.min", force_unit(is_angle), low);
        record.add("static_force.max", force_unit(is_angle), high);
    }
    for (k, equilibrium) in found.iter().enumerate() {
        record_equilibrium(
            prepared,
            equilibrium,
            &format!("equilibrium.{}", k + 1),
            &mut record,
        );
    }
    record
}

/// The name of a coordinate, and its unit.
fn coordinate<'a>(
    prepared: &'a SceneMachine<'_, impl MachineScene>,
    i: usize,
) -> (&'a str, &'static str) {
    (
        prepared.coordinate_name(i),
        coordinate_unit(prepared.is_angle(i)),
    )
}

/// The numbers of an equilibrium, under names that begin with `of`.
pub(crate) fn record_equilibrium(
    prepared: &SceneMachine<'_, impl MachineScene>,
    equilibrium: &Equilibrium,
    of: &str,
    record: &mut Record,
) {
    let start = prepared.initial_state();
    for (k, &i) in prepared.machine.free().iter().enumerate() {
        let (name, unit) = coordinate(prepared, i);
        let (q, error) = (equilibrium.y[k], equilibrium.errors[k]);
        record.add_within(format!("{of}.{name}"), unit, q, error);
        let error_from_start = error + f64::EPSILON * q.abs().max(start[k].abs());
        let name = format!("{of}.{name}.from_start");
        record.add_within(name, unit, q - start[k], error_from_start);
    }
    for (n, neutral) in equilibrium.neutral.iter().enumerate() {
        let free = prepared.machine.free().iter().zip(&neutral.direction);
        for (&i, &part) in free.filter(|(_, part)| **part != 0.0) {
            let (name, unit) = coordinate(prepared, i);
            let of = format!("{of}.neutral.{}.{name}", n + 1);
            record.add(&of, unit, part);
            if let Some([from, to]) = neutral.extent {
                record.add(format!("{of}.from"), unit, from);
                record.add(format!("{of}.to"), unit, to);
            }
        }
    }
    let (values, errors) = (&equilibrium.eigenvalues, &equilibrium.eigenvalue_errors);
    record_eigenvalues(values, errors, of, record);
}

/// Eigenvalues under names that begin with `of`: a complex pair also with its frequency and damping.
pub(crate) fn record_eigenvalues(
    values: &[[f64; 2]],
    errors: &[f64],
    of: &str,
    record: &mut Record,
) {
    for (k, (&[re, im], &error)) in values.iter().zip(errors).enumerate() {
        let name = |what: &str| format!("{of}.eigenvalue.{}.{what}", k + 1);
        record.add_within(name("re"), "1/s", re, error);
        record.add_within(name("im"), "1/s", im, error);
        let size = re.hypot(im);
        if im > error {
            record.add_within(name("angular_frequency"), "rad/s", size, error);
            record.add_within(name("frequency"), "Hz", size / TAU, error / TAU);
            record.add_within(name("damping_ratio"), "", -re / size, error / size);
        }
    }
    record.add(format!("{of}.error.eigenvalues"), "1/s", largest(errors));
}

/// `phi between 10° and 20°`.
fn interval_text(
    prepared: &SceneMachine<'_, impl MachineScene>,
    actuator: usize,
    interval: [f64; 2],
) -> String {
    let [from, to] = interval.map(|q| match prepared.is_angle(actuator) {
        true => format!("{}°", digits(q.to_degrees(), 6)),
        false => format!("{} m", digits(q, 6)),
    });
    format!(
        "{} between {from} and {to}",
        prepared.coordinate_name(actuator)
    )
}

/// An equilibrium as text.
pub(crate) fn describe_equilibrium(
    prepared: &SceneMachine<'_, impl MachineScene>,
    equilibrium: &Equilibrium,
) -> String {
    let start = prepared.initial_state();
    let free = || prepared.machine.free().iter().enumerate();
    let positions: Vec<String> = free()
        .map(|(k, &i)| {
            let (q, error) = (equilibrium.y[k], equilibrium.errors[k]);
            let error_from_start = error + f64::EPSILON * q.abs().max(start[k].abs());
            let deflection = digits_within(q - start[k], error_from_start, 6);
            let unit = coordinate_unit(prepared.is_angle(i));
            let position = prepared.describe_coordinate_within(i, q, error);
            format!("{position}, {deflection} {unit} from the start")
        })
        .collect();
    let stability = match equilibrium.stability {
        Stability::Asymptotic => "asymptotically stable",
        Stability::Centre => "stable without damping (centre)",
        Stability::Unstable => "unstable",
        Stability::Neutral => "neutral",
        Stability::Undecided => "stability is not decided by the linearisation",
    };
    let mut text = format!("  {}: {stability}\n", positions.join("; "));
    text += &describe_neutral(prepared, equilibrium);
    text += &describe_eigenvalues(&equilibrium.eigenvalues, &equilibrium.eigenvalue_errors);
    let errors = free().map(|(k, &i)| {
        let unit = coordinate_unit(prepared.is_angle(i));
        format!(
            "{:.1e} {unit} in {}",
            equilibrium.errors[k],
            prepared.coordinate_name(i)
        )
    });
    let errors: Vec<String> = errors.collect();
    let eigenvalues = largest(&equilibrium.eigenvalue_errors);
    text + &format!(
        "    estimated errors: {}, {eigenvalues:.1e} 1/s in the eigenvalues\n",
        errors.join(", ")
    )
}

/// The directions in which equilibria go on.
fn describe_neutral(
    prepared: &SceneMachine<'_, impl MachineScene>,
    equilibrium: &Equilibrium,
) -> String {
    let mut text = String::new();
    for neutral in &equilibrium.neutral {
        let free = prepared.machine.free().iter().zip(&neutral.direction);
        let moved: Vec<(usize, f64)> = free
            .filter(|(_, part)| **part != 0.0)
            .map(|(&i, part)| (i, *part))
            .collect();
        text += &match (neutral.extent, moved.as_slice()) {
            (Some(extent), &[(i, _)]) => {
                let interval = interval_text(prepared, i, extent);
                format!("    neutral: every position of {interval} is an equilibrium\n")
            }
            (_, &[(i, _)]) => {
                let name = prepared.coordinate_name(i);
                format!(
                    "    neutral direction {name}: nothing drives it back or away, it stays where it is put\n"
                )
            }
            (_, several) => {
                let parts = several.iter().map(|&(i, part)| {
                    let name = prepared.coordinate_name(i);
                    format!(
                        "{} {} of {name}",
                        digits(part, 4),
                        coordinate_unit(prepared.is_angle(i))
                    )
                });
                let parts: Vec<String> = parts.collect();
                format!(
                    "    neutral direction {}: nothing drives them back or away along it\n",
                    parts.join(" with ")
                )
            }
        };
    }
    text
}

/// The largest of some errors.
pub(crate) fn largest(errors: &[f64]) -> f64 {
    errors.iter().copied().fold(0.0, f64::max)
}

/// Eigenvalues as text, to the digits that their errors leave: a complex pair once, with its frequency and damping.
pub(crate) fn describe_eigenvalues(values: &[[f64; 2]], errors: &[f64]) -> String {
    let one = |(&[re, im], &error): (&[f64; 2], &f64)| {
        let size = re.hypot(im);
        let within = |value: f64, error: f64| digits_within(value, error, 9);
        let [a, b] = [re, im].map(|part| within(part, error));
        if im.abs() <= error {
            return format!("    eigenvalue {a} 1/s\n");
        } else if im < 0.0 {
            return String::new();
        }
        let (angular, frequency) = (within(size, error), within(size / TAU, error / TAU));
        let damping = digits_within(-re / size, error / size, 6);
        format!(
            "    eigenvalues {a} ± {b}i 1/s: {angular} rad/s = {frequency} Hz, damping ratio {damping}\n"
        )
    };
    values.iter().zip(errors).map(one).collect()
}
