//! Parts from catalogues: every combination is optimised.

use super::optimised::{Optimised, optimise};
use crate::explain::StudyError;
use crate::gradient::GradientScene;
use crate::progress::{Progress, Step};
use dwell_dynamics::interruption;
use dwell_scene::{JobPart, SceneLocation};
use std::path::Path;

/// Combinations that are optimised at most.
const MOST: usize = 1000;

/// A part of a catalogue: its name, and the numbers that it gives the scene, by their paths.
#[derive(Debug, Clone, PartialEq)]
struct Part {
    name: String,
    numbers: Vec<(String, f64)>,
}

/// A combination of parts, with its goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Combination {
    /// The names of the parts, in the order of the job.
    pub parts: Vec<String>,
    /// The least goal; `None` if no design satisfies the conditions.
    pub goal: Option<f64>,
}

/// Optimises a job with every combination of its parts: the best, and all combinations, the best first.
///
/// # Errors
/// [`StudyError`] where a catalogue cannot be read, the job is at fault, or no combination has a design.
// Long because each way to fail has an error.
pub fn optimise_choices<S: GradientScene>(
    scene: &S,
    job: usize,
    seed: u64,
    progress: Progress<'_>,
) -> Result<(Optimised, Vec<Combination>), StudyError> {
    let choices = 0..scene.jobs[job].choose.len();
    let catalogues: Vec<Vec<Part>> = choices
        .map(|k| catalogue(scene, job, k))
        .collect::<Result<_, _>>()?;
    let count = catalogues.iter().map(Vec::len).product::<usize>();
    if count > MOST {
        let message = format!("{count} combinations of parts, but at most {MOST} are optimised");
        let place = (
            SceneLocation::JobPart(job, JobPart::Choice, 0),
            "this choice".to_owned(),
        );
        return Err(scene.error(message, None, &[place]).into());
    }
    let (mut best, mut all, mut failed): (Option<Optimised>, Vec<Combination>, _) =
        (None, Vec::new(), None);
    for k in 0..count {
        if interruption::is_requested() {
            break;
        }
        let mut rest = k;
        let chosen = catalogues.iter().map(|parts| {
            let part = &parts[rest % parts.len()];
            rest /= parts.len();
            part
        });
        let chosen: Vec<&Part> = chosen.collect();
        let numbers: Vec<(&str, f64)> = (chosen.iter())
            .flat_map(|part| {
                part.numbers
                    .iter()
                    .map(|(path, value)| (path.as_str(), *value))
            })
            .collect();
        let found = scene.varied(&numbers).map_err(StudyError::from);
        let of_all = |step: Step<'_>| {
            progress(Step {
                total: count * step.total,
                ..step
            });
        };
        let found = found.and_then(|variant| optimise(&variant, job, seed, &of_all));
        let goal = match found {
            Ok(mut found) if found.is_admissible() => {
                found.assigned.extend(
                    numbers
                        .iter()
                        .map(|(path, value)| ((*path).to_owned(), *value)),
                );
                let goal = found.after;
                if best.as_ref().is_none_or(|best| goal < best.after) {
                    best = Some(found);
                }
                Some(goal)
            }
            Ok(_) => None,
            Err(error) => {
                failed = Some(error);
                None
            }
        };
        all.push(Combination {
            parts: chosen.iter().map(|part| part.name.clone()).collect(),
            goal,
        });
    }
    let goal = |of: &Combination| of.goal.unwrap_or(f64::INFINITY);
    all.sort_by(|a, b| goal(a).total_cmp(&goal(b)));
    match (best, failed) {
        (Some(best), _) => Ok((best, all)),
        (None, Some(error)) => Err(error),
        (None, None) => {
            let message = if interruption::is_requested() {
                "the search was interrupted before it had a design"
            } else {
                "no combination of parts satisfies the conditions"
            };
            let place = (SceneLocation::Job(job), "this job".to_owned());
            Err(scene.error(message.to_owned(), None, &[place]).into())
        }
    }
}

/// The parts of a catalogue: a header with the name of the part and paths of numbers, then a row for each.
fn catalogue<S: GradientScene>(scene: &S, job: usize, k: usize) -> Result<Vec<Part>, StudyError> {
    let choice = &scene.jobs[job].choose[k];
    let refuse = |message: String| {
        let place = (
            SceneLocation::JobPart(job, JobPart::Choice, k),
            "this table".to_owned(),
        );
        let help = "a header such as `motor,drives.motor.stall-torque`, and a row for each part: `M20,0.8`";
        StudyError::from(scene.error(message, Some(help.to_owned()), &[place]))
    };
    let folder = Path::new(scene.source.name())
        .parent()
        .unwrap_or(Path::new(""));
    let path = folder.join(&choice.table);
    let text = std::fs::read_to_string(&path);
    let text = text.map_err(|e| {
        refuse(format!(
            "the table `{}` cannot be read: {e}",
            path.display()
        ))
    })?;
    let mut rows = text.lines().filter(|line| !line.trim().is_empty());
    let header = rows
        .next()
        .ok_or_else(|| refuse(format!("the table `{}` is empty", choice.table)))?;
    let paths: Vec<&str> = header.split(',').skip(1).map(str::trim).collect();
    if let Some(path) = paths.iter().find(|path| scene.value(path).is_err()) {
        return Err(refuse(format!(
            "the scene has no number `{path}`, which the table `{}` names",
            choice.table
        )));
    }
    let part = |line: &str| {
        let mut cells = line.split(',').map(str::trim);
        let name = cells.next().unwrap_or_default().to_owned();
        let values: Vec<f64> = cells.map_while(|cell| cell.parse().ok()).collect();
        if values.len() != paths.len() {
            return Err(refuse(format!(
                "part `{name}` of the table `{}` has not {} numbers",
                choice.table,
                paths.len()
            )));
        }
        let numbers = paths.iter().map(|path| (*path).to_owned()).zip(values);
        Ok(Part {
            name,
            numbers: numbers.collect(),
        })
    };
    let parts: Vec<Part> = rows.map(part).collect::<Result<_, _>>()?;
    if parts.is_empty() {
        return Err(refuse(format!("the table `{}` has no part", choice.table)));
    }
    Ok(parts)
}
