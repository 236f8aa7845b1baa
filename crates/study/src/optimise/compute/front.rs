//! The Pareto front of two goals: the least of each, and between them the least of the first where the second is at most a limit.

use super::job::STARTS;
use super::optimised::{Search, with_engine};
use super::problem::{Condition, Goal, Sense};
use super::search::{Ended, from_start, scale_problem, search, starts};
use crate::explain::StudyError;
use crate::gradient::GradientScene;
use crate::progress::{Progress, Step};
use dwell_dynamics::interruption;

/// Points between the ends.
const BETWEEN: usize = 9;
/// The part of the extent of the second goal by which its least is exceeded at the end.
const SLACK: f64 = 1e-6;

/// A design of a front.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontPoint {
    /// The goals.
    pub goals: [f64; 2],
    /// The derivative of the first by the second along the front; `None` at the ends.
    pub slope: Option<f64>,
    /// All numbers that change.
    pub assigned: Vec<(String, f64)>,
    /// Whether the conditions of an optimum hold.
    pub is_converged: bool,
}

/// A Pareto front.
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    /// The name of the job.
    pub job: String,
    /// The goals as written, with their units.
    pub goals: [(String, String); 2],
    /// The goals of the scene, if it can be evaluated.
    pub before: Option<[f64; 2]>,
    /// From the least of the first goal to that of the second.
    pub points: Vec<FrontPoint>,
    /// The number of evaluations of a design with its derivatives.
    pub evaluations: usize,
    /// Whether the computation was interrupted.
    pub is_interrupted: bool,
}

impl Front {
    /// The point that is nearest to the least of both goals, each in parts of its extent.
    pub fn knee(&self) -> Option<&FrontPoint> {
        let (first, last) = (self.points.first()?.goals, self.points.last()?.goals);
        let distance = |of: &&FrontPoint| {
            let part = |k: usize| {
                let least = first[k].min(last[k]);
                (of.goals[k] - least) / (first[k] - last[k]).abs().max(f64::MIN_POSITIVE)
            };
            part(0).hypot(part(1))
        };
        let points = self.points.iter();
        points.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

/// The front of the job of this number, whose random designs depend on the seed.
///
/// # Errors
/// As of [`optimise`](super::optimise).
pub fn optimise_front<S: GradientScene>(
    scene: &S,
    job: usize,
    seed: u64,
    progress: Progress<'_>,
) -> Result<Front, StudyError> {
    with_engine(
        scene,
        job,
        seed,
        &mut |scene, prepared, engine, own, first| {
            let of = Search {
                scene,
                prepared,
                engine,
                own,
                first,
                job,
            };
            of.front(progress)
        },
    )
}

impl<S: GradientScene> Search<'_, '_, S> {
    // Long because the ends and what is between them share their data.
    fn front(&self, progress: Progress<'_>) -> Result<Front, StudyError> {
        let job = &self.scene.jobs[self.job];
        let mut worker = self.engine.worker();
        let requested = &self.prepared.requested;
        let refuse = |message: &str| {
            let place = (
                dwell_scene::SceneLocation::Job(self.job),
                "this job".to_owned(),
            );
            StudyError::from(self.scene.error(message.to_owned(), None, &[place]))
        };
        let [a, b] = &self.prepared.front[..] else {
            return Err(refuse("a front has two goals"));
        };
        let mut found = Front {
            job: job.name.clone(),
            goals: [a, b].map(|of| {
                let unit = of.result().map(|k| requested.quantities[k].unit.clone());
                (of.text.clone(), unit.unwrap_or_default())
            }),
            before: None,
            points: Vec::new(),
            evaluations: 0,
            is_interrupted: false,
        };
        let both = |worker: &mut super::engine::Worker<'_, '_>, values: &[f64]| {
            let results = worker.evaluate(values, false)?;
            let numbers = self.prepared.design.numbers(values);
            let at = super::expressions::DesignValues {
                results: &results,
                numbers: &numbers,
                effects: &[],
            };
            Some([a.value(&at), b.value(&at)])
        };
        found.before = self.own.and_then(|own| both(&mut worker, own));
        let (mut ends, mut total) = (Vec::new(), BETWEEN);
        for of in [a, b] {
            let summands = vec![(of.clone(), 1.0)];
            let mut problem = self.prepared.problem(Goal { summands });
            let scaled = scale_problem(&mut problem, &mut worker, self.first, requested);
            scaled.ok_or_else(|| refuse("no design has derivatives"))?;
            let own = Some(self.own.unwrap_or(self.first));
            let starts = starts(&problem, self.engine, own, job.starts.unwrap_or(STARTS));
            total = 2 * starts.len() + BETWEEN;
            let of_all = |step: Step<'_>| progress(Step { total, ..step });
            let ended = search(&problem, self.engine, &starts, &of_all);
            found.evaluations += ended.iter().map(|of| of.optimum.evaluations).sum::<usize>();
            let feasible = ended.iter().filter(|of| of.is_feasible());
            let best = feasible
                .min_by(|a, b| (a.optimum.evaluation.goal).total_cmp(&b.optimum.evaluation.goal));
            let best = best.ok_or_else(|| refuse("no design satisfies the conditions"))?;
            let values = problem.values(&best.optimum.x[..problem.bounds.len()]);
            let goals = both(&mut worker, &values).ok_or_else(|| refuse("no results"))?;
            ends.push((values, goals, best.is_converged()));
        }
        let [(first, from, _), (last, to, _)] = &ends[..] else {
            return Ok(found);
        };
        let mut point = |values: &[f64], slope: Option<f64>, is_converged: bool| {
            let goals = both(&mut worker, values)?;
            let numbers = self.prepared.design.numbers(values);
            let assigned = self.prepared.design.assigned(&numbers).into_iter();
            Some(FrontPoint {
                goals,
                slope,
                assigned: assigned
                    .map(|(path, value)| (path.to_owned(), value))
                    .collect(),
                is_converged,
            })
        };
        found.points.extend(point(first, None, ends[0].2));
        let mut near = first.clone();
        for k in 1..=BETWEEN {
            if interruption::is_requested() {
                break;
            }
            // Equal angles of a quarter of an ellipse: dense at both ends, where a front is steep.
            let part = (std::f64::consts::FRAC_PI_2 * k as f64 / (BETWEEN + 1) as f64).sin();
            let limit = from[1] + (to[1] - from[1]) * part;
            let ended = self.between(limit, &near, &mut found.evaluations);
            progress(Step {
                total,
                done: "points of the front",
            });
            if let Some((ended, values, slope)) = ended.filter(|(ended, ..)| ended.is_feasible()) {
                found
                    .points
                    .extend(point(&values, slope, ended.is_converged()));
                near = values;
            }
        }
        // Of designs with the least second goal, that with the least first one.
        let limit = to[1] + SLACK * (from[1] - to[1]);
        let ended = self.between(limit, last, &mut found.evaluations);
        let better = ended.filter(|(ended, ..)| ended.is_feasible());
        let (values, is_converged) = match &better {
            Some((ended, values, _)) => (values, ended.is_converged()),
            None => (last, ends[1].2),
        };
        found.points.extend(point(values, None, is_converged));
        found.is_interrupted = interruption::is_requested();
        Ok(found)
    }

    /// The least of the first goal where the second is at most a limit, from a design nearby.
    fn between(
        &self,
        limit: f64,
        near: &[f64],
        evaluations: &mut usize,
    ) -> Option<(Ended, Vec<f64>, Option<f64>)> {
        let [a, b] = &self.prepared.front[..] else {
            return None;
        };
        let summands = vec![(a.clone(), 1.0)];
        let mut problem = self.prepared.problem(Goal { summands });
        problem.conditions.push(Condition {
            expression: b.clone(),
            sense: Sense::AtMost,
            limit,
            scale: 1.0,
        });
        let mut worker = self.engine.worker();
        scale_problem(
            &mut problem,
            &mut worker,
            self.first,
            &self.prepared.requested,
        )?;
        let ended = from_start(&problem, &mut worker, near, 0)?;
        *evaluations += ended.optimum.evaluations;
        let values = problem.values(&ended.optimum.x[..problem.bounds.len()]);
        let family = problem.conditions.len() - 1;
        let optimum = &ended.optimum;
        let rows = optimum
            .evaluation
            .constraints
            .iter()
            .zip(&optimum.multipliers);
        let multiplier: f64 = rows
            .filter(|(c, _)| c.family == family)
            .map(|(_, m)| m)
            .sum();
        let goal = problem.goal_of(optimum.evaluation.goal);
        let slope = problem.price(family, multiplier, goal);
        Some((ended, values, Some(slope)))
    }
}
