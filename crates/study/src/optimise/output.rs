//! Writes the result of a job: summary, tables, the better scene.

use super::compute::{
    Certificate, Combination, ConditionReport, Optimised, OptimisedNumber, job_number, optimise,
    optimise_choices,
};
use super::front_output::front;
use super::picture::figure;
use crate::explain::StudyError;
use crate::gradient::output::aligned;
use crate::number_format::{count, digits, number};
use crate::output::{Outcome, add_results_page};
use crate::progress::Progress;
use crate::study_scene::StudyScene;
use dwell_findings::{Check, Finding, Record};
use dwell_report::Files;
use std::path::{Component, Path};

/// Numbers, conditions and other optima that the summary lists.
const LISTED: usize = 10;
const OTHER_OPTIMA: usize = 3;

/// Optimises a job of a scene; the only one if none is named.
///
/// # Errors
/// [`StudyError`] where the job is at fault, or no design can be evaluated.
pub(crate) fn optimise_job<S: StudyScene>(
    scene: &S,
    job: Option<&str>,
    seed: u64,
    progress: Progress<'_>,
) -> Result<Outcome, StudyError> {
    let number = job_number(scene, job)?;
    if !scene.jobs[number].front.is_empty() {
        return front(scene, number, seed, progress);
    }
    let (found, combinations) = match scene.jobs[number].choose.is_empty() {
        true => (optimise(scene, number, seed, progress)?, Vec::new()),
        false => optimise_choices(scene, number, seed, progress)?,
    };
    let stem = format!("{}-optimise-{}", scene.name, found.job);
    let mut outcome = Outcome {
        record: record(&found),
        summary: summary(&scene.title, &found) + &chosen(&combinations, &found.unit),
        ..Outcome::default()
    };
    outcome.files.add(format!("{stem}.csv"), history(&found));
    let values: Vec<(&str, f64)> = found
        .assigned
        .iter()
        .map(|(p, v)| (p.as_str(), *v))
        .collect();
    add_scene(&mut outcome.files, scene, &stem, &values)?;
    let better = scene.varied(&values)?;
    outcome.findings.extend(finding(&found));
    let figure = figure(scene, &found, &better)?;
    add_results_page(&mut outcome, scene, "better design", &stem, figure);
    Ok(outcome)
}

/// Adds the scene with other numbers, and the tables beside or below it that it names: it is read from where it is written.
pub(super) fn add_scene<S: StudyScene>(
    files: &mut Files,
    scene: &S,
    stem: &str,
    values: &[(&str, f64)],
) -> Result<(), StudyError> {
    files.add(format!("{stem}.toml"), scene.text_with(values)?);
    let targets = scene.sweep_section.targets.iter().map(|of| &of.table);
    let choices = scene.jobs.iter().flat_map(|job| &job.choose);
    let choices = choices.map(|of| &of.table);
    let folder = Path::new(scene.source.name()).parent();
    for table in targets.chain(choices) {
        let path = Path::new(table);
        let is_below = path
            .components()
            .all(|part| matches!(part, Component::Normal(_)));
        // The table of another job may be missing.
        if is_below && let Ok(bytes) = std::fs::read(folder.unwrap_or(Path::new("")).join(path)) {
            files.add_kept(path, bytes);
        }
    }
    Ok(())
}

/// The best combinations of parts.
fn chosen(all: &[Combination], unit: &str) -> String {
    if all.is_empty() {
        return String::new();
    }
    let line = |of: &Combination| {
        let goal = of.goal.map_or("no admissible design".to_owned(), |goal| {
            format!("{} {unit}", digits(goal, 6))
        });
        format!("    {}: {}\n", of.parts.join(", "), goal.trim_end())
    };
    let lines: String = all.iter().take(LISTED / 2).map(line).collect();
    format!(
        "  {}, the best first:\n{lines}",
        count(all.len(), "combination")
    )
}

/// Where no start converged, a check that fails.
fn finding(found: &Optimised) -> Option<Finding> {
    let has_converged = found.starts[1] < found.starts[0];
    let of = &found.certificate;
    let worst = of.residual.max(of.violation).max(of.complementarity);
    (!has_converged).then(|| Finding {
        comparison: "conditions of an optimum from every start".to_owned(),
        ..Finding::new("optimum", Check::default(), [worst; 2], 1e-6)
    })
}

fn record(found: &Optimised) -> Record {
    let mut record = Record::default();
    if let Some(before) = found.before {
        record.add("goal.before", &found.unit, before);
    }
    record.add("goal", &found.unit, found.after);
    for of in &found.numbers {
        record.add(of.path.clone(), &of.unit, of.after);
        if let Some(price) = of.bound_price {
            record.add(format!("{}.price", of.path), "", price);
        }
    }
    // By number: several conditions may have one expression.
    for (k, of) in found.conditions.iter().enumerate() {
        record.add(format!("condition[{k}]"), &of.unit, of.after);
        if let Some(price) = of.price {
            record.add(format!("condition[{k}].price"), "", price);
        }
    }
    for (k, peak) in found.peaks.iter().enumerate() {
        record.add(format!("peak[{k}].place"), "", peak.place);
        record.add(format!("peak[{k}].multiplier"), "", peak.multiplier);
    }
    let of = &found.certificate;
    record.add(
        "certificate.is_certified",
        "",
        f64::from(u8::from(of.doubt.is_none())),
    );
    record.add("certificate.residual", "", of.residual);
    record.add("certificate.violation", "", of.violation);
    record.add("certificate.complementarity", "", of.complementarity);
    if let Some([least, largest]) = of.curvature {
        record.add("certificate.least_eigenvalue", "", least);
        record.add("certificate.largest_eigenvalue", "", largest);
    }
    if let Some(difference) = of.sweep_difference {
        record.add("certificate.sweep_difference", "", difference);
    }
    for (name, probes) in ["computed", "admissible", "better"].iter().zip(of.probes) {
        record.add(format!("certificate.probes.{name}"), "", probes as f64);
    }
    for (k, optimum) in found.optima.iter().enumerate() {
        record.add(format!("optimum[{k}].goal"), &found.unit, optimum.goal);
        record.add(format!("optimum[{k}].count"), "", optimum.count as f64);
    }
    record.add("starts", "", found.starts[0] as f64);
    record.add("starts.not_converged", "", found.starts[1] as f64);
    record.add("evaluations", "", found.evaluations as f64);
    record
}

/// The accepted points of the best start.
fn history(found: &Optimised) -> String {
    let mut text = "start,iteration,goal,violation\n".to_owned();
    for of in &found.history {
        text += &format!(
            "{},{},{:?},{:?}\n",
            of.start, of.iteration, of.goal, of.violation
        );
    }
    text
}

/// The printed summary.
fn summary(title: &str, found: &Optimised) -> String {
    let with_unit = |value: f64| {
        format!("{} {}", digits(value, 7), found.unit)
            .trim_end()
            .to_owned()
    };
    let change = match found.before {
        Some(before) => {
            let percent = 100.0 * (found.after - before) / before.abs();
            format!(
                "{} → {} ({percent:+.1} %)",
                digits(before, 7),
                with_unit(found.after)
            )
        }
        None => format!(
            "{}; the scene itself cannot be evaluated",
            with_unit(found.after)
        ),
    };
    let mut text = format!("{title}: job `{}`\n  {}: {change}\n", found.job, found.goal);
    let mut rows = vec![["number", "from", "to", "", ""].map(str::to_owned)];
    rows.extend(found.numbers.iter().take(LISTED).map(|of| row(of, found)));
    text += &aligned(&rows);
    if found.numbers.len() > LISTED {
        text += &format!("    {} more in the scene\n", found.numbers.len() - LISTED);
    }
    for of in &found.conditions {
        text += &format!("  {}\n", condition(of, &found.unit));
    }
    if found.peaks.len() > 1 {
        let parts: Vec<String> = found
            .peaks
            .iter()
            .map(|p| digits(p.multiplier, 4))
            .collect();
        let many = count(found.peaks.len(), "extremum").replace("extremums", "extrema");
        text += &format!("  {many} tie, with multipliers {}\n", parts.join(", "));
    }
    text += &certificate(&found.certificate, found);
    text += &starts(found);
    text
}

/// A number with its bound and what that costs.
fn row(of: &OptimisedNumber, found: &Optimised) -> [String; 5] {
    let note = match of.bound_price {
        None => String::new(),
        Some(price) => {
            let side = if of.after > of.bounds[0] {
                "upper"
            } else {
                "lower"
            };
            format!(
                "at its {side} bound; {}",
                price_of(price, &of.unit, &found.unit)
            )
        }
    };
    [
        of.path.clone(),
        number(of.before),
        number(of.after),
        of.unit.clone(),
        note,
    ]
}

/// A condition with its value and what it costs.
fn condition(of: &ConditionReport, goal_unit: &str) -> String {
    let limit = format!("{} {} {}", of.text, of.sign, digits(of.limit, 6));
    let limit = format!("{limit} {}", of.unit).trim_end().to_owned();
    match of.price {
        Some(price) => format!("{limit}: active; {}", price_of(price, &of.unit, goal_unit)),
        None => format!("{limit}: {}, not active", digits(of.after, 6)),
    }
}

/// A derivative of the goal by a limit in words: angles by degrees, lengths in m by mm, others by their units.
fn price_of(price: f64, unit: &str, goal_unit: &str) -> String {
    let (step, words) = match unit {
        "rad" => (1.0_f64.to_radians(), "1°".to_owned()),
        "m" => (1e-3, "1 mm".to_owned()),
        "" => (1.0, "1".to_owned()),
        unit => (1.0, format!("1 {unit}")),
    };
    let way = if price > 0.0 { "less" } else { "more" };
    let saved = format!("{} {goal_unit}", digits((price * step).abs(), 4));
    format!("{words} {way} saves {}", saved.trim_end())
}

fn certificate(of: &Certificate, found: &Optimised) -> String {
    let mut text = match &of.doubt {
        None => "  certified as a local optimum".to_owned(),
        Some(doubt) => format!("  not certified: {doubt}"),
    };
    text += &format!(
        "; residual {:.0e}, violation {:.0e}",
        of.residual, of.violation
    );
    if let Some([least, largest]) = of.curvature {
        text += &format!(", curvature {} to {}", digits(least, 3), digits(largest, 3));
    }
    if let Some(difference) = of.sweep_difference {
        text += &format!("\n  the sweep agrees within {difference:.0e}");
    }
    let [_, admissible, better] = of.probes;
    if admissible > 0 {
        text += &format!(
            "; of {admissible} random designs nearby that are admissible {better} are better"
        );
    }
    text.push('\n');
    for flat in of.flat.iter().take(OTHER_OPTIMA) {
        let largest = flat
            .iter()
            .zip(&found.numbers)
            .map(|(v, of)| share(*v, of).abs());
        let largest = largest.fold(0.0, f64::max);
        let parts = flat.iter().zip(&found.numbers);
        let parts = parts.filter(|(v, of)| share(**v, of).abs() > 0.02 * largest);
        let parts = parts.map(|(v, of)| {
            let percent = 100.0 * v / of.after.abs();
            match percent.is_finite() {
                true => format!("{} {percent:+.2} %", of.path),
                false => format!("{} {} {}", of.path, digits(*v, 3), of.unit),
            }
        });
        let parts: Vec<String> = parts.collect();
        text += &format!("  flat: the goal stays with {}\n", parts.join(", "));
    }
    text
}

/// A change in parts of the range.
fn share(change: f64, of: &OptimisedNumber) -> f64 {
    change / (of.bounds[1] - of.bounds[0])
}

fn starts(found: &Optimised) -> String {
    let [all, open] = found.starts;
    let mut text = format!("  {}", count(all, "start"));
    if !found.optima.is_empty() {
        text += ": ";
    }
    let optima = found.optima.iter().take(1 + OTHER_OPTIMA);
    let optima = optima.map(|of| format!("{} ({} times)", digits(of.goal, 6), of.count));
    text += &optima.collect::<Vec<_>>().join(", ");
    if found.optima.len() > 1 + OTHER_OPTIMA {
        text += &format!(" and {} others", found.optima.len() - 1 - OTHER_OPTIMA);
    }
    if open > 0 {
        text += &format!("; {open} not converged");
    }
    text += &format!("; {}", count(found.evaluations, "evaluation"));
    if !found.is_exact {
        text += ", by variants of the scene";
    }
    if found.is_interrupted {
        text += "; interrupted";
    }
    text.push('\n');
    text
}
