//! `dwell validate`: every case, whatever becomes of the others.

use crate::options::OWN_CASES;
use crate::{as_scene_error, cases, plain, progress_bar};
use dwell_report::Files;
use dwell_scene::{Scene, SceneError};
use dwell_study::{Outcome, Step, Validation, extremes, index, tradeoff};
use miette::{Report, miette};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Validates the cases in parallel, and with all of the workbench's own ones the extremes (`long`: all of
/// them). The outcome is that of those that can be validated; the report tells of the others.
pub(crate) fn validate(
    names: &[String],
    folder: &Path,
    long: bool,
) -> Result<(Outcome, Option<Report>), Report> {
    let cases = cases::find(names, folder)?;
    let scenes: Vec<_> = cases
        .iter()
        .map(|case| Scene::read(case.join("scene.toml")))
        .collect();
    refuse_twins(&cases, &scenes)?;
    let bar = progress_bar();
    let one = |(scene, case): (&Result<Scene, SceneError>, &PathBuf)| {
        let scene = scene.as_ref().map_err(Clone::clone)?;
        let heard = |step: Step<'_>| {
            bar.set_length((step.total * cases.len()) as u64);
            bar.set_message(format!("{}: {}", scene.name, step.done));
            bar.inc(1);
        };
        dwell_study::validate(scene, case, &heard).map_err(as_scene_error)
    };
    let everything = names.is_empty() && folder == Path::new(OWN_CASES);
    let read: Vec<&Scene> = scenes.iter().flatten().collect();
    let (results, (extremes, costs)): (Vec<Result<Validation, SceneError>>, _) = rayon::join(
        || scenes.par_iter().zip(&cases).map(one).collect(),
        || {
            rayon::join(
                || (everything || long).then(|| extremes::study(long)),
                || everything.then(|| tradeoff::reports(&read)),
            )
        },
    );
    bar.finish_and_clear();
    let (mut all, bad) = gathered(&cases, &scenes, results);
    for more in [extremes, costs].into_iter().flatten() {
        let more = more.map_err(as_scene_error)?;
        all.summary += &more.summary;
        all.findings.extend(more.findings);
        all.files.extend("", more.files);
    }
    Ok((all, bad))
}

/// Two cases of one name would write the same files.
fn refuse_twins(cases: &[PathBuf], scenes: &[Result<Scene, SceneError>]) -> Result<(), Report> {
    for (k, scene) in scenes.iter().enumerate() {
        let Ok(scene) = scene else { continue };
        let same = |s: &Result<Scene, SceneError>| matches!(s, Ok(s) if s.name == scene.name);
        if let Some(other) = scenes[..k].iter().position(same) {
            return Err(miette!(
                help = "validate them one after the other, each with an --out of its own",
                "`{}` and `{}` are both named `{}`: their reports would be the same files",
                cases[other].display(),
                cases[k].display(),
                scene.name
            ));
        }
    }
    Ok(())
}

fn gathered(
    cases: &[PathBuf],
    scenes: &[Result<Scene, SceneError>],
    results: Vec<Result<Validation, SceneError>>,
) -> (Outcome, Option<Report>) {
    let mut all = Outcome::default();
    let names: Vec<_> = cases
        .iter()
        .map(|case| case.display().to_string())
        .collect();
    let verdicts: Vec<_> = names
        .iter()
        .zip(scenes)
        .zip(&results)
        .map(|((name, scene), result)| {
            let told = match (scene, result) {
                (Ok(scene), Ok(done)) => Ok((scene, done)),
                (Err(error), _) | (_, Err(error)) => Err(error.message.clone()),
            };
            (name.as_str(), told)
        })
        .collect();
    let mut bad = Vec::new();
    let mut files = Files::new();
    if cases.len() > 1 && results.iter().any(Result::is_ok) {
        match index(&verdicts) {
            Ok(overview) => files.extend("", overview),
            Err(error) => bad.push(as_scene_error(error)),
        }
    }
    for result in results {
        match result {
            Ok(one) => {
                all.summary += &one.outcome.summary;
                all.findings.extend(one.outcome.findings);
                files.extend("", one.outcome.files);
            }
            Err(error) => bad.push(error),
        }
    }
    all.files = files;
    (all, told(bad))
}

/// All the errors in one report.
fn told(mut errors: Vec<SceneError>) -> Option<Report> {
    match errors.len() {
        0 => None,
        1 => Some(Report::new(errors.remove(0))),
        n => Some(Report::new(SceneError {
            others: errors,
            ..plain(format!("{n} cases cannot be validated"))
        })),
    }
}
