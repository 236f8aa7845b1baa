//! The study as a part of the reports: three telling cases, and a text that every machine reproduces.

use super::combination::{Effort, Evaluation, Integrator, Price, Quantity, Tradeoff};
use super::{figure, measure, page};
use crate::error::StudyError;
use crate::outcome::{Outcome, silent};
use crate::provenance::picture;
use crate::words::digits;
use dwell_report::Files;
use dwell_scene::Scene;
use rayon::prelude::*;
use std::fmt::Write as _;

/// A short turning motion, one with a dwell, and one under friction that a motor drives.
const TELLING: [&str; 3] = ["crank-rocker", "single-dwell", "slider-crank-friction"];
/// The finest tolerance of the text: below it rounding has a say in the steps that are taken.
const STABLE: f64 = 0.9e-9;
/// Accuracies of the text.
const ACCURACIES: [f64; 3] = [1e-3, 1e-6, 1e-9];

/// The study of the telling cases among some scenes, with what there is time for: `tradeoff/NAME.png` and `.md`,
/// and `tradeoff.txt`, which holds counts and errors and no times.
///
/// # Errors
/// As [`measure`]; [`StudyError::Report`] when a picture cannot be drawn.
pub fn reports(scenes: &[&Scene]) -> Result<Outcome, StudyError> {
    let telling = |scene: &&&Scene| TELLING.contains(&scene.name.as_str());
    let told: Vec<&Scene> = scenes.iter().filter(telling).copied().collect();
    let one = |scene: &&Scene| -> Result<(Files, String), StudyError> {
        let found = measure(scene, &Effort::brief(), &silent)?;
        let name = &scene.name;
        let mut files = Files::new();
        let figure = figure::figure(scene, &found, name);
        files.add(format!("tradeoff/{name}.png"), picture(scene, &figure)?);
        let document = page::document(scene, &found, name);
        files.add(format!("tradeoff/{name}.md"), document.markdown());
        // Under dry friction the last bit of a sine decides which steps are rejected: nothing to be reproduced.
        let words = match found.quadrature() {
            Some(_) => snapshot(scene, &found),
            None => String::new(),
        };
        Ok((files, words))
    };
    let done: Vec<(Files, String)> = told.par_iter().map(one).collect::<Result<_, _>>()?;
    let mut outcome = Outcome::default();
    let mut text = "What accuracy costs\n".to_owned();
    for (files, words) in done {
        outcome.files.extend("", files);
        text += &words;
    }
    outcome.files.add("tradeoff.txt", text);
    outcome.summary = format!("tradeoff: {} cases\n", told.len());
    Ok(outcome)
}

/// Counts to two digits and errors to powers of ten, of what does not hang on rounding.
fn snapshot(scene: &Scene, found: &Tradeoff) -> String {
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
        if point.combination.evaluation != Evaluation::Exact || tolerance < STABLE {
            continue;
        }
        let errors = Quantity::ALL.map(|q| power(point.errors.of(q)));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "  {:<8} {tolerance:.0e}  {:>6}  {:<6} {:<6} {}",
            method.name(),
            digits(point.cost.weighed as f64, 2),
            errors[0],
            errors[1],
            errors[2]
        );
    }
    for accuracy in ACCURACIES {
        let k = found.cheapest(Quantity::Coordinate, Price::Evaluations, accuracy);
        let name = k.map_or("none".to_owned(), |k| found.points[k].combination.name());
        let _ = writeln!(
            text,
            "  fewest evaluations for {accuracy:.0e} {}: {name}",
            found.unit
        );
    }
    text
}

/// An error as the nearest power of ten.
fn power(error: f64) -> String {
    if error > 0.0 && error.is_finite() {
        // As a whole number, for there is no power of −0.
        format!("1e{}", error.log10().round() as i32)
    } else {
        "–".to_owned()
    }
}
