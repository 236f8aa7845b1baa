//! A job of a scene, prepared: its design, its results, its problem.

use super::expressions::{JobExpression, Names, Place, Variable};
use super::problem::{Condition, Goal, Problem, Sense};
use crate::explain::{StudyError, SweepError};
use crate::sweep::compute::{Design, RequestedQuantities, SweptScene, result_names};
use dwell_laws::Expression;
use dwell_scene::{JobPart, OptimiseJob, SceneFile, SceneLocation};

/// Starts unless they are given, and random designs for each.
pub(super) const STARTS: usize = 20;
const POOL_OF_START: usize = 50;

/// A job with what it needs of its scene.
pub(super) struct PreparedJob {
    pub(super) design: Design,
    pub(super) requested: RequestedQuantities,
    pub(super) goal: Goal,
    pub(super) conditions: Vec<Condition>,
    /// Of two goals: their expressions.
    pub(super) front: Vec<JobExpression>,
}

impl PreparedJob {
    /// The job of this number, of a scene that can be assembled, with random designs of a seed.
    ///
    /// # Errors
    /// [`StudyError`] that points to the part of the job that is at fault.
    // Long because each part of a job is read with its place.
    pub(super) fn new<S: SweptScene>(
        scene: &S,
        number: usize,
        seed: u64,
    ) -> Result<Self, StudyError> {
        let job = &scene.jobs[number];
        let design = design(scene, job, seed)?;
        let names = Names {
            scene,
            results: result_names(scene)?,
            design: &design,
        };
        let mut used = Vec::new();
        let mut read = |text: &str, part, k| {
            let place: Place = (number, part, k);
            names.read(text, place, &mut used)
        };
        let summands = job.minimise.iter().enumerate();
        let summands =
            summands.map(|(k, (text, weight))| Ok((read(text, JobPart::Goal, k)?, *weight)));
        let goal = Goal {
            summands: summands.collect::<Result<_, StudyError>>()?,
        };
        let front = job.front.iter().enumerate();
        let front = front.map(|(k, text)| read(text, JobPart::Goal, k));
        let front = front.collect::<Result<_, StudyError>>()?;
        let mut conditions = Vec::new();
        for (k, text) in job.subject_to.iter().enumerate() {
            let place = (number, JobPart::Condition, k);
            let (of, sense, limit) = parts_of_condition(text).map_err(|message| {
                let help = "write it as `m.max <= 2` or `psi.stroke = 60*pi/180`, in the unit of the result";
                names.error(place, message, help)
            })?;
            conditions.push(Condition {
                expression: names.read(of, place, &mut used)?,
                sense,
                limit,
                scale: 1.0,
            });
        }
        // The limits of [sweep] hold in all variants.
        for limit in &scene.sweep_section.limits {
            let place = (number, JobPart::Condition, 0);
            conditions.push(Condition {
                expression: names.read(&limit.result, place, &mut used)?,
                sense: if limit.is_upper {
                    Sense::AtMost
                } else {
                    Sense::AtLeast
                },
                limit: limit.limit,
                scale: 1.0,
            });
        }
        if used.is_empty() {
            let error = names.error(
                (number, JobPart::Goal, 0),
                "the goal depends on no result".to_owned(),
                "minimise a result of `dwell sweep`, such as `m.max`",
            );
            return Err(error);
        }
        let requested = RequestedQuantities::within(scene, &used, &[])?;
        let mut prepared = Self {
            requested,
            goal,
            conditions,
            front,
            design,
        };
        prepared.renumber(&used);
        Ok(prepared)
    }

    /// Numbers the results as the sweep orders them.
    fn renumber(&mut self, used: &[String]) {
        let quantities = &self.requested.quantities;
        let place = |k: usize| {
            quantities
                .iter()
                .position(|q| q.name == used[k])
                .unwrap_or(0)
        };
        let summands = self.goal.summands.iter_mut().map(|(of, _)| of);
        let conditions = self.conditions.iter_mut().map(|of| &mut of.expression);
        for of in summands.chain(conditions).chain(&mut self.front) {
            for variable in &mut of.variables {
                if let Variable::Result(k) = variable {
                    *k = place(*k);
                }
            }
        }
    }

    /// The problem of a goal, without scales yet.
    pub(super) fn problem(&self, goal: Goal) -> Problem<'_> {
        Problem {
            design: &self.design,
            bounds: self.design.axes.iter().map(|axis| axis.span()).collect(),
            goal,
            conditions: self.conditions.clone(),
            scale: 1.0,
            levels: Vec::new(),
            is_square: false,
        }
    }
}

/// The varied numbers with their ties.
pub(super) fn design<S: SweptScene>(
    scene: &S,
    job: &OptimiseJob,
    seed: u64,
) -> Result<Design, StudyError> {
    let vary = job.vary.iter().map(|of| {
        let [from, to] = of.bounds;
        format!("{}~uniform({from:?},{to:?})", of.path)
    });
    let vary: Vec<String> = vary.collect();
    let starts = job.starts.unwrap_or(STARTS);
    let pool = job.pool.unwrap_or(POOL_OF_START * starts);
    let tied = job
        .tied
        .iter()
        .map(|tie| format!("{}={}", tie.path, tie.text));
    let tied: Vec<String> = tied.collect();
    Design::new(scene, &vary, Some(pool as u64), seed)?.tied(scene, &tied)
}

/// The expression, the sense and the limit of a condition.
fn parts_of_condition(text: &str) -> Result<(&str, Sense, f64), String> {
    let signs = [
        ("<=", Sense::AtMost),
        (">=", Sense::AtLeast),
        ("=", Sense::Equal),
    ];
    let found = signs.into_iter().find_map(|(sign, sense)| {
        let (of, limit) = text.split_once(sign)?;
        Some((of.trim(), sense, limit.trim()))
    });
    let (of, sense, limit) =
        found.ok_or("a condition is an expression, `<=`, `>=` or `=`, and a limit")?;
    let limit = Expression::parse(limit, &[]).map_err(|error| error.message)?;
    Ok((of, sense, limit.eval(&[])))
}

/// The number of the job of a name; without one, of the only job.
///
/// # Errors
/// [`StudyError`] that names the jobs.
pub fn job_number(scene: &SceneFile, name: Option<&str>) -> Result<usize, StudyError> {
    let names: Vec<&str> = scene.jobs.iter().map(|job| job.name.as_str()).collect();
    let refuse = |message: String, help: String| {
        let place = (SceneLocation::Job(0), "a job".to_owned());
        let places = if names.is_empty() {
            vec![]
        } else {
            vec![place]
        };
        Err(scene.error(message, Some(help), &places).into())
    };
    match name {
        _ if names.is_empty() => {
            let example = "add one: `[optimise.balance]` with `vary`, the numbers with their bounds, and `minimise`, a result of `dwell sweep`";
            refuse(
                "the scene has no job of [optimise]".to_owned(),
                example.to_owned(),
            )
        }
        Some(name) => match names.iter().position(|known| *known == name) {
            Some(k) => Ok(k),
            None => {
                let help = dwell_scene::choices(name, "jobs", names.iter().copied());
                refuse(format!("the scene has no job `{name}`"), help)
            }
        },
        None if names.len() == 1 => Ok(0),
        None => {
            let help = format!("name one of them: {}", names.join(", "));
            refuse(
                SweepError::Design("the scene has several jobs".to_owned()).to_string(),
                help,
            )
        }
    }
}
