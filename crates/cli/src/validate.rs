//! `dwell validate`: validates every case; a failing case does not stop the others.

use crate::interface::interface;
use crate::options::DEFAULT_CASE_FOLDER;
use crate::{cases, print_warnings, validation_error};
use dwell_scene::{PlaneScene, SceneError, SpaceScene};
use dwell_study::{Outcome, Step, StudyError};
use dwell_validation::manual::{Manual, capability_scenes};
use dwell_validation::{
    CaseResult, ValidatedCase, Validation, ValidationRun, audit, export_study, extremes, index,
    validate_program, work_precision,
};
use indicatif::ProgressBar;
use miette::{Report, miette};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Validates the cases in parallel; with all of Dwell's own cases also the extreme parameters (with `slow` those
/// that take minutes, too) and the verification manual. The outcome contains the validated cases, the report the errors of the others.
// Long, because it is the whole command from its arguments to its outcome.
pub(crate) fn validate(
    names: &[String],
    folder: &Path,
    slow: bool,
    bar: &ProgressBar,
) -> Result<(Outcome, Option<SceneError>), Report> {
    let (in_space, others) = cases::find_in_space(names, folder);
    let cases = if names.is_empty() || !others.is_empty() {
        cases::find(&others, folder)?
    } else {
        Vec::new()
    };
    let read = |case: &PathBuf| PlaneScene::read(case.join("scene.toml"));
    let scenes: Vec<_> = cases.iter().map(read).collect();
    reject_duplicate_names(&cases, &scenes)?;
    scenes
        .iter()
        .flatten()
        .for_each(|scene| print_warnings(scene));
    let program = std::env::current_exe().ok();
    let all_cases = names.is_empty() && folder == Path::new(DEFAULT_CASE_FOLDER);
    let mut audited: Vec<PathBuf> = cases.iter().map(|case| case.join("scene.toml")).collect();
    audited.extend(in_space.iter().cloned());
    if all_cases {
        audited.extend(capability_scenes(folder));
    }
    let one = |(scene, case): (&Result<PlaneScene, SceneError>, &PathBuf)| {
        let scene = scene.as_ref().map_err(Clone::clone)?;
        let progress = |step: Step<'_>| {
            bar.set_length((step.total * cases.len() + audited.len()) as u64);
            bar.set_message(format!("{}: {}", scene.name, step.done));
            bar.inc(1);
        };
        // The program runs itself to check its files. If the system does not know its path, only the library is checked.
        let done = match &program {
            Some(program) => validate_program(scene, case, program, &progress),
            None => dwell_validation::validate(scene, case, &progress),
        };
        done.map_err(validation_error)
    };
    let read: Vec<&PlaneScene> = scenes.iter().flatten().collect();
    let all = all_cases.then_some(&read[..]);
    let audit = || {
        let done = |name: &str| {
            bar.set_message(format!("{name}: files"));
            bar.inc(1);
        };
        let reader = folder.join(audit::NAME);
        let program = program.as_deref().ok_or("the program is not found")?;
        audit::study(&reader, program, &audited, &done)
    };
    let (mut results, (studies, (keys, audit))): (Vec<Result<Validation, SceneError>>, _) =
        rayon::join(
            || scenes.par_iter().zip(&cases).map(one).collect(),
            || {
                rayon::join(
                    || studies(all, slow),
                    || rayon::join(|| all.map(|scenes| Manual::new(scenes, folder)), audit),
                )
            },
        );
    let mut spatial: Vec<_> = in_space
        .par_iter()
        .map(|path| case_in_space(path, program.as_deref()))
        .collect();
    bar.finish_and_clear();
    let mut studies = studies.map_err(SceneError::from)?;
    let (audit, no_reader) = match audit {
        Ok(audited) => {
            let planar = results.iter_mut().map(|result| result.as_mut().ok());
            let spatial = spatial
                .iter_mut()
                .map(|result| Some(&mut result.as_mut().ok()?.1));
            for (case, findings) in planar.chain(spatial).zip(audited.by_scene) {
                case.into_iter()
                    .for_each(|case| case.audited.clone_from(&findings));
            }
            (Some(audited.outcome), None)
        }
        Err(reason) => (None, Some(reason)),
    };
    let said = match (&audit, &no_reader) {
        (Some(audit), _) => audit.summary.trim().to_owned(),
        (None, reason) => format!("not run ({})", reason.as_deref().unwrap_or_default()),
    };
    let names: Vec<String> = cases.iter().map(|c| c.display().to_string()).collect();
    let by_case = case_results(&names, &scenes, &results);
    let manual = keys.map(|keys| {
        let extremes: Vec<_> = studies
            .iter()
            .flat_map(|(_, o)| o.findings.clone())
            .collect();
        keys.outcome(&by_case, &extremes, &interface(), &said)
    });
    studies.extend(audit.map(|audit| (audit::NAME, audit)));
    let mut all = Outcome::default();
    let judged = ValidationRun {
        cases: validated_cases(&by_case, &in_space, &spatial),
        studies: studies
            .iter()
            .map(|(name, o)| (*name, &o.findings[..]))
            .collect(),
        no_reader,
        manual: manual.as_ref().map(|manual| {
            let number = |name: &str| {
                let mut numbers = manual.record.numbers.iter();
                numbers
                    .find(|n| n.name == name)
                    .map_or(0, |n| n.value as usize)
            };
            [number("passed"), number("required")]
        }),
    };
    let is_any_validated = judged.cases.iter().any(|case| case.result.is_ok());
    if let (Some(reason), true) = (&judged.no_reader, is_any_validated) {
        eprintln!("independent reader: not run ({reason})");
    }
    if judged.cases.len() > 1 && is_any_validated {
        add(&mut all, index(&judged));
    }
    let (done, failed) = separate(results);
    done.into_iter().for_each(|one| add(&mut all, one.outcome));
    let (done, failed_in_space) = separate(spatial);
    done.into_iter()
        .for_each(|(_, one)| add(&mut all, one.outcome));
    let failures = combined_error(failed.into_iter().chain(failed_in_space).collect());
    all.record.add_count("cases", cases.len() + in_space.len());
    let studies = studies.into_iter().map(|(_, study)| study);
    studies.chain(manual).for_each(|added| add(&mut all, added));
    let failed = all.findings.iter().filter(|finding| !finding.pass);
    all.record.add_count("findings.failed", failed.count());
    all.record.add_count("findings", all.findings.len());
    Ok((all, failures))
}

/// Adds the results of a study or a case to all results.
fn add(all: &mut Outcome, added: Outcome) {
    all.summary += &added.summary;
    all.findings.extend(added.findings);
    all.files.extend("", added.files);
    all.pictures.extend(added.pictures);
}

/// The studies beside the cases: extreme parameters, and with all of Dwell's own cases work–precision diagrams and the accuracy of exported
/// runs.
fn studies(
    all: Option<&[&PlaneScene]>,
    slow: bool,
) -> Result<Vec<(&'static str, Outcome)>, StudyError> {
    let exported = all.and_then(|scenes| scenes.iter().find(|s| s.name == export_study::CASE));
    let (extremes, (costs, exports)) = rayon::join(
        || (all.is_some() || slow).then(|| extremes::study(slow)),
        || {
            rayon::join(
                || all.map(work_precision::selected_case_reports),
                || exported.map(|scene| export_study::study(scene)),
            )
        },
    );
    let names = ["extremes", "work-precision", export_study::NAME];
    let studies = names.into_iter().zip([extremes, costs, exports]);
    let done = studies.filter_map(|(name, study)| study.map(|study| Ok((name, study?))));
    done.collect()
}

/// The validation of a scene in space, with its reference if there is one, and of its files.
fn case_in_space(
    path: &Path,
    program: Option<&Path>,
) -> Result<(SpaceScene, Validation), SceneError> {
    let scene = SpaceScene::read(path)?;
    print_warnings(&scene);
    let reference_path = path.with_extension("json");
    let reference = reference_path.is_file().then_some(reference_path);
    let done = dwell_validation::validate_in_space(&scene, reference.as_deref(), program);
    Ok((scene, done.map_err(validation_error)?))
}

/// The cases in the plane and in space, for the verdict.
fn validated_cases<'a>(
    by_case: &'a [CaseResult<'a>],
    in_space: &'a [PathBuf],
    spatial: &'a [Result<(SpaceScene, Validation), SceneError>],
) -> Vec<ValidatedCase<'a>> {
    let planar = by_case.iter().map(|(name, result)| match result {
        Ok((scene, done)) => (&scene.name[..], &scene.title[..], Ok(*done)),
        Err(reason) => (*name, *name, Err(reason.clone())),
    });
    let spatial = in_space
        .iter()
        .zip(spatial)
        .map(|(path, result)| match result {
            Ok((scene, done)) => (&scene.name[..], &scene.title[..], Ok(done)),
            Err(error) => {
                let name = path
                    .file_stem()
                    .and_then(|name| name.to_str())
                    .unwrap_or("");
                (name, name, Err(error.message.clone()))
            }
        });
    let judged = |in_space: bool| {
        move |(name, title, result)| ValidatedCase {
            name,
            title,
            in_space,
            result,
        }
    };
    planar
        .map(judged(false))
        .chain(spatial.map(judged(true)))
        .collect()
}

/// Rejects two cases with one name: they would write the same files.
fn reject_duplicate_names(
    cases: &[PathBuf],
    scenes: &[Result<PlaneScene, SceneError>],
) -> Result<(), Report> {
    for (k, scene) in scenes.iter().enumerate() {
        let Ok(scene) = scene else { continue };
        let same = |s: &Result<PlaneScene, SceneError>| matches!(s, Ok(s) if s.name == scene.name);
        if let Some(other) = scenes[..k].iter().position(same) {
            return Err(miette!(
                help = "validate them one after the other, each with its own --out",
                "`{}` and `{}` are both named `{}`: their reports would be the same files",
                cases[other].display(),
                cases[k].display(),
                scene.name
            ));
        }
    }
    Ok(())
}

/// Each case by its name with its result.
fn case_results<'a>(
    names: &'a [String],
    scenes: &'a [Result<PlaneScene, SceneError>],
    results: &'a [Result<Validation, SceneError>],
) -> Vec<CaseResult<'a>> {
    let results_of = scenes.iter().zip(results).map(|of_case| match of_case {
        (Ok(scene), Ok(done)) => Ok((scene, done)),
        (Err(error), _) | (_, Err(error)) => Err(error.message.clone()),
    });
    names.iter().map(String::as_str).zip(results_of).collect()
}

/// The validated cases, and the errors of the others.
fn separate<T>(results: Vec<Result<T, SceneError>>) -> (Vec<T>, Vec<SceneError>) {
    let (done, failed): (Vec<_>, Vec<_>) = results.into_iter().partition(Result::is_ok);
    let failed = failed.into_iter().filter_map(Result::err);
    (done.into_iter().flatten().collect(), failed.collect())
}

/// Combines all errors in one.
fn combined_error(mut errors: Vec<SceneError>) -> Option<SceneError> {
    match errors.len() {
        0 => None,
        1 => Some(errors.remove(0)),
        n => Some(SceneError {
            related: errors,
            ..SceneError::without_labels(format!("{n} cases cannot be validated"), None)
        }),
    }
}
