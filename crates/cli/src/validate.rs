//! `dwell validate`: validates every case; a failing case does not stop the others.

use crate::interface::interface;
use crate::options::DEFAULT_CASE_FOLDER;
use crate::{cases, print_warnings, validation_error};
use dwell_scene::{PlaneScene, Scene, SceneError};
use dwell_study::{Outcome, Step, StudyError};
use dwell_validation::manual::{Manual, capability_scenes};
use dwell_validation::{
    ValidatedCase, Validation, ValidationRun, audit, export_study, extremes, index, work_precision,
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
    let mut cases: Vec<CaseScene> = cases::find(names, folder)?
        .into_iter()
        .map(|path| CaseScene {
            scene: Scene::read(&path),
            path,
        })
        .collect();
    // Those in space come last.
    cases.sort_by_key(|case| matches!(case.scene, Ok(Scene::Space(_))));
    reject_duplicate_names(&cases)?;
    let read = || cases.iter().filter_map(|case| case.scene.as_ref().ok());
    read().for_each(|scene| print_warnings(scene));
    let program = std::env::current_exe().ok();
    let all_cases = names.is_empty() && folder == Path::new(DEFAULT_CASE_FOLDER);
    let mut audited: Vec<PathBuf> = cases.iter().map(|case| case.path.clone()).collect();
    if all_cases {
        audited.extend(capability_scenes(folder));
    }
    let planar: Vec<&PlaneScene> = read()
        .filter_map(|scene| match scene {
            Scene::Plane(scene) => Some(&**scene),
            Scene::Space(_) => None,
        })
        .collect();
    let one = |case: &CaseScene| {
        let scene = case.scene.as_ref().map_err(Clone::clone)?;
        let progress = |step: Step<'_>| {
            bar.set_length((step.total * planar.len() + audited.len()) as u64);
            bar.set_message(format!("{}: {}", scene.name, step.done));
            bar.inc(1);
        };
        // The program runs itself to check its files. If the system does not know its path, only the library is checked.
        let folder = case.path.parent().unwrap_or(Path::new(""));
        let done = dwell_validation::validate(scene, folder, program.as_deref(), &progress);
        done.map_err(validation_error)
    };
    let all = all_cases.then_some(&planar[..]);
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
            || cases.par_iter().map(one).collect(),
            || {
                rayon::join(
                    || studies(all, slow),
                    || rayon::join(|| all.map(|scenes| Manual::new(scenes, folder)), audit),
                )
            },
        );
    bar.finish_and_clear();
    let mut studies = studies.map_err(SceneError::from)?;
    let (audit, no_reader) = match audit {
        Ok(audited) => {
            for (result, findings) in results.iter_mut().zip(audited.by_scene) {
                if let Ok(validation) = result {
                    validation.audited = findings;
                }
            }
            (Some(audited.outcome), None)
        }
        Err(reason) => (None, Some(reason)),
    };
    let said = match (&audit, &no_reader) {
        (Some(audit), _) => audit.summary.trim().to_owned(),
        (None, reason) => format!("not run ({})", reason.as_deref().unwrap_or_default()),
    };
    let shown: Vec<String> = cases.iter().map(|case| cases::shown(&case.path)).collect();
    let by_case = validated_cases(&shown, &cases, &results);
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
        cases: by_case,
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
    let mut failed = Vec::new();
    for result in results {
        match result {
            Ok(done) => add(&mut all, done.outcome),
            Err(error) => failed.push(error),
        }
    }
    let failures = combined_error(failed);
    all.record.add_count("cases", cases.len());
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

/// The scene of a case, or why there is none.
struct CaseScene {
    path: PathBuf,
    scene: Result<Scene, SceneError>,
}

/// The cases for the verdict.
fn validated_cases<'a>(
    shown: &'a [String],
    cases: &'a [CaseScene],
    results: &'a [Result<Validation, SceneError>],
) -> Vec<ValidatedCase<'a>> {
    let all = shown.iter().zip(cases).zip(results);
    all.map(|((shown, case), result)| {
        let (name, title) = match (&case.scene, result) {
            (Ok(scene), Ok(_)) => (&scene.name, &scene.title),
            _ => (shown, shown),
        };
        ValidatedCase {
            name,
            title,
            in_space: matches!(case.scene, Ok(Scene::Space(_))),
            result: result.as_ref().map_err(|error| error.message.clone()),
        }
    })
    .collect()
}

/// Rejects two cases with one name: they would write the same files.
fn reject_duplicate_names(cases: &[CaseScene]) -> Result<(), Report> {
    for (k, case) in cases.iter().enumerate() {
        let Ok(scene) = &case.scene else { continue };
        let same = |other: &&CaseScene| matches!(&other.scene, Ok(s) if s.name == scene.name);
        if let Some(other) = cases[..k].iter().find(same) {
            return Err(miette!(
                help = "validate them one after the other, each with its own --out",
                "`{}` and `{}` are both named `{}`: their reports would be the same files",
                cases::shown(&other.path),
                cases::shown(&case.path),
                scene.name
            ));
        }
    }
    Ok(())
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
