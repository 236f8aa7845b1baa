//! The study in the reports of `dwell validate`: three cases, and a reproducible text.

use super::combination::{
    CostMeasure, Effort, ErrorQuantity, Evaluation, Integrator, WorkPrecision,
};
use super::{figure, measure, report};
use dwell_report::Files;
use dwell_scene::PlaneScene;
use dwell_study::StudyError;
use dwell_study::number_format::digits;
use dwell_study::output::Picture;
use dwell_study::{Outcome, no_progress};
use rayon::prelude::*;
use std::fmt::Write as _;

/// A short rotation, a motion with a dwell, and a motor-driven one with friction.
const SELECTED_CASES: [&str; 3] = ["crank-rocker", "single-dwell", "slider-crank-friction"];
/// The finest tolerance of the text: below it, rounding affects the number of steps.
const FINEST_PRINTED_TOLERANCE: f64 = 0.9e-9;
/// Accuracies of the text.
const ACCURACIES: [f64; 3] = [1e-3, 1e-6, 1e-9];

/// The brief study of the selected cases among some scenes: `work-precision/NAME.png` and `.md`,
/// and `work-precision.txt`, with counts and errors but without times.
///
/// # Errors
/// As [`measure`].
pub fn selected_case_reports(scenes: &[&PlaneScene]) -> Result<Outcome, StudyError> {
    let is_selected = |scene: &&&PlaneScene| SELECTED_CASES.contains(&scene.name.as_str());
    let selected: Vec<&PlaneScene> = scenes.iter().filter(is_selected).copied().collect();
    let one = |scene: &&PlaneScene| -> Result<(Files, Picture, String), StudyError> {
        let found = measure(*scene, &Effort::brief(), &no_progress)?;
        let name = &scene.name;
        let mut files = Files::new();
        let figure = figure::figure(scene, &found, name);
        let path = format!("work-precision/{name}.png");
        let picture = Picture::figure(scene, path, true, figure);
        let document = report::document(scene, &found, name);
        files.add_document(&format!("work-precision/{name}"), &document);
        // With dry friction the last bit of a sine can decide which steps are rejected, so the counts are not reproducible.
        let text = found.quadrature().map(|_| snapshot(scene, &found));
        Ok((files, picture, text.unwrap_or_default()))
    };
    let done: Vec<_> = selected
        .par_iter()
        .map(one)
        .collect::<Result<_, StudyError>>()?;
    let mut outcome = Outcome::default();
    let mut text = "Work–precision study\n".to_owned();
    for (files, picture, text_of_case) in done {
        outcome.files.extend("", files);
        outcome.pictures.push(picture);
        text += &text_of_case;
    }
    outcome.files.add("work-precision.txt", text);
    outcome.summary = format!("work-precision: {} cases\n", selected.len());
    Ok(outcome)
}

/// Counts to two digits and errors to powers of ten, if they do not depend on rounding.
fn snapshot(scene: &PlaneScene, found: &WorkPrecision) -> String {
    let mut text = format!(
        "\n{}, t = 0 to {} s, against quadrature: evaluations, and errors of coordinate ({}), energy and worst reaction\n",
        scene.title.trim_end_matches('.'),
        digits(found.duration, 3),
        found.unit
    );
    for point in &found.points {
        let Integrator::Steps(method, tolerance) = point.combination.integrator else {
            continue;
        };
        let exact = point.combination.evaluation == Evaluation::Exact;
        if !exact || tolerance < FINEST_PRINTED_TOLERANCE {
            continue;
        }
        let errors = ErrorQuantity::ALL.map(|q| nearest_power(point.errors.of(q)));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "  {:<8} {tolerance:.0e}  {:>6}  {:<6} {:<6} {}",
            method.name(),
            digits(point.cost.weighted_evaluations as f64, 2),
            errors[0],
            errors[1],
            errors[2]
        );
    }
    for accuracy in ACCURACIES {
        let (quantity, measure) = (ErrorQuantity::Coordinate, CostMeasure::Evaluations);
        let k = found.cheapest(quantity, measure, accuracy);
        let name = k.map_or("none".to_owned(), |k| found.points[k].combination.name());
        let unit = found.unit;
        text += &format!("  fewest evaluations for {accuracy:.0e} {unit}: {name}\n");
    }
    text
}

/// An error as the nearest power of ten.
fn nearest_power(error: f64) -> String {
    if error > 0.0 && error.is_finite() {
        // As an integer, to avoid −0.
        format!("1e{}", error.log10().round() as i32)
    } else {
        "–".to_owned()
    }
}
