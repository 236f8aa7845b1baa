//! A job from its scene to its result.

use super::certificate::{Certificate, certify, probe};
use super::engine::{Engine, Worker};
use super::job::{PreparedJob, STARTS};
use super::problem::{Goal, Problem, Sense};
use super::recorded_designs::RecordedDesigns;
use super::search::{Ended, HistoryPoint, scale_problem, search, starts};
use crate::explain::StudyError;
use crate::gradient::{DesignSlopes, GradientScene, TolerancedNumber};
use crate::progress::Progress;
use dwell_dynamics::interruption;
use dwell_scene::SceneLocation;

/// Random designs among which one is searched that can be evaluated, if the scene cannot.
const ATTEMPTS: u64 = 2000;
/// Optima whose goals differ by less, in parts of the first goal, are one.
const SAME_OPTIMUM: f64 = 1e-6;
/// The part of a range by which numbers are displaced for differences.
const DISPLACED: f64 = 1e-3;
/// A number within this part of its range of a bound is at it.
const AT_BOUND: f64 = 1e-9;

/// A number that was optimised.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimisedNumber {
    /// Its path.
    pub path: String,
    /// Its unit, as in the scene.
    pub unit: String,
    /// As written in the scene.
    pub before: f64,
    /// In the best design.
    pub after: f64,
    /// Its bounds.
    pub bounds: [f64; 2],
    /// By how much the goal rises with the bound at which it is, per unit of the number; `None` if it is at none.
    pub bound_price: Option<f64>,
    /// The derivative of the goal by it, in the unit of the goal per unit of the number.
    pub slope: f64,
}

/// A condition with its price.
#[derive(Debug, Clone, PartialEq)]
pub struct ConditionReport {
    /// The expression.
    pub text: String,
    /// `<=`, `>=` or `=`.
    pub sign: &'static str,
    /// Its unit, if it is a result.
    pub unit: String,
    /// Its limit.
    pub limit: f64,
    /// Its value in the scene, if that can be evaluated.
    pub before: Option<f64>,
    /// In the best design.
    pub after: f64,
    /// By how much the goal rises where the limit rises by one unit; `None` if it is not active.
    pub price: Option<f64>,
}

/// An active extremum of a goal or of a condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActivePeak {
    /// Its place along the trajectory, from 0 to 1.
    pub place: f64,
    /// Its multiplier: of the extrema that make up a goal these are parts of one.
    pub multiplier: f64,
}

/// An optimum that was met.
#[derive(Debug, Clone, PartialEq)]
pub struct MetOptimum {
    /// The goal.
    pub goal: f64,
    /// How often it was met.
    pub count: usize,
    /// The numbers that vary.
    pub values: Vec<f64>,
}

/// The result of a job.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Optimised {
    /// The name of the job.
    pub job: String,
    /// The goal as written, with its unit.
    pub goal: String,
    /// Its unit, if it is a result.
    pub unit: String,
    /// The goal of the scene, if it can be evaluated.
    pub before: Option<f64>,
    /// The goal of the best design.
    pub after: f64,
    /// The numbers that vary.
    pub numbers: Vec<OptimisedNumber>,
    /// All numbers that change: those that vary, and those that follow from them.
    pub assigned: Vec<(String, f64)>,
    /// The conditions.
    pub conditions: Vec<ConditionReport>,
    /// The extrema that are active in the best design.
    pub peaks: Vec<ActivePeak>,
    /// What is known of it.
    pub certificate: Certificate,
    /// The optima that were met, the best first.
    pub optima: Vec<MetOptimum>,
    /// The number of starts, and of those that did not converge.
    pub starts: [usize; 2],
    /// The number of evaluations of a design with its derivatives.
    pub evaluations: usize,
    /// Whether all derivatives are exact.
    pub is_exact: bool,
    /// Whether the computation was interrupted.
    pub is_interrupted: bool,
    /// The accepted points of the start that led to the best design.
    pub history: Vec<HistoryPoint>,
}

impl Optimised {
    /// Whether the best design satisfies the conditions.
    pub fn is_admissible(&self) -> bool {
        self.certificate.violation <= super::search::CONVERGED
    }
}

/// Optimises the job of this number; random designs depend on the seed.
///
/// # Errors
/// [`StudyError`] where the job is at fault, or no design can be evaluated.
pub fn optimise<S: GradientScene>(
    scene: &S,
    job: usize,
    seed: u64,
    progress: Progress<'_>,
) -> Result<Optimised, StudyError> {
    with_engine(
        scene,
        job,
        seed,
        &mut |scene, prepared, engine, own, first| {
            let goal = prepared.goal.clone();
            optimise_goal(
                &Search {
                    scene,
                    prepared,
                    engine,
                    own,
                    first,
                    job,
                },
                goal,
                progress,
            )
        },
    )
}

/// What a search needs.
pub(super) struct Search<'s, 'e, S> {
    /// The scene, or a variant that can be assembled.
    pub(super) scene: &'s S,
    pub(super) prepared: &'s PreparedJob,
    pub(super) engine: &'s Engine<'e>,
    /// The numbers of the scene itself, if it can be evaluated.
    pub(super) own: Option<&'s [f64]>,
    /// The numbers of a design that can be evaluated.
    pub(super) first: &'s [f64],
    pub(super) job: usize,
}

type Task<'t, S, R> =
    dyn FnMut(&S, &PreparedJob, &Engine<'_>, Option<&[f64]>, &[f64]) -> Result<R, StudyError> + 't;

/// Prepares a job, and does something with it.
pub(super) fn with_engine<S: GradientScene, R>(
    scene: &S,
    job: usize,
    seed: u64,
    task: &mut Task<'_, S, R>,
) -> Result<R, StudyError> {
    let assembled = assembled(scene, job, seed)?;
    let scene = &assembled;
    let prepared = PreparedJob::new(scene, job, seed)?;
    let design = &prepared.design;
    let written: Result<Vec<f64>, _> = design
        .axes
        .iter()
        .map(|axis| scene.value(&axis.path))
        .collect();
    let written = written?;
    let is_within = |values: &[f64]| {
        let mut each = values.iter().zip(&design.axes);
        each.all(|(v, axis)| (axis.span()[0]..=axis.span()[1]).contains(v))
    };
    let pool = (0..design.points.min(ATTEMPTS)).map(|k| design.values(k));
    let candidates = std::iter::once(written.clone())
        .filter(|v| is_within(v))
        .chain(pool);
    let mut last = None;
    for values in candidates {
        let found = prepared
            .requested
            .evaluate(scene, &design.assigned(&design.numbers(&values)));
        if let Some(message) = found.message {
            last = Some(message);
            continue;
        }
        let own = (values == written).then_some(&written[..]);
        let variant = scene.varied(&design.assigned(&design.numbers(&values)))?;
        let rows = variant.rows()?;
        let reference = (&variant, &rows, &values[..]);
        let recorded = RecordedDesigns::new(scene, reference, design, &prepared.requested);
        let recorded = recorded.map(|recorded| Engine::Recorded(Box::new(recorded)));
        let recorded = recorded.filter(|engine| agrees(engine, &values, &found.values));
        let numbers = steps(&prepared);
        let engine = recorded.unwrap_or_else(|| {
            Engine::General(Box::new(DesignSlopes {
                scene,
                design,
                requested: &prepared.requested,
                numbers: &numbers,
            }))
        });
        return task(scene, &prepared, &engine, own, &values);
    }
    let message = format!(
        "no design of the job can be evaluated, of {} random ones: {}",
        design.points.min(ATTEMPTS),
        last.unwrap_or_default()
    );
    let place = (SceneLocation::Job(job), "this job".to_owned());
    let help = "change the bounds, or start from a scene that moves along the whole trajectory";
    Err(scene.error(message, Some(help.to_owned()), &[place]).into())
}

/// The scene, or a random variant of the job that can be assembled.
fn assembled<S: GradientScene>(scene: &S, job: usize, seed: u64) -> Result<S, StudyError> {
    let first = scene.unloaded_rows();
    let Err(error) = first else {
        return Ok(scene.varied(&[])?);
    };
    let design = super::job::design(scene, &scene.jobs[job], seed)?;
    let pool = (0..design.points.min(ATTEMPTS)).map(|k| design.values(k));
    let mut variants = pool.filter_map(|values| {
        let variant = scene
            .varied(&design.assigned(&design.numbers(&values)))
            .ok()?;
        variant.unloaded_rows().is_ok().then_some(variant)
    });
    variants.next().ok_or(error)
}

/// Whether an engine has the results of the sweep.
fn agrees(engine: &Engine<'_>, values: &[f64], swept: &[f64]) -> bool {
    let found = engine.worker().evaluate(values, true);
    let same = |(own, swept): (&f64, &f64)| (own - swept).abs() <= 1e-6 * swept.abs().max(1e-9);
    let is_number = |slope: &Vec<f64>| slope.iter().all(|s| s.is_finite());
    found.is_some_and(|found| {
        let own: Vec<f64> = found.iter().map(|of| of.value).collect();
        own.iter().zip(swept).all(same) && found.iter().all(|of| is_number(&of.slope))
    })
}

/// The varied numbers with the steps of their differences.
fn steps(prepared: &PreparedJob) -> Vec<TolerancedNumber> {
    let number = |axis: &crate::sweep::compute::Axis| {
        let [from, to] = axis.span();
        TolerancedNumber {
            path: axis.path.clone(),
            unit: axis.unit.clone(),
            mean: 0.5 * (from + to),
            deviation: DISPLACED * (to - from),
            kurtosis: 1.0,
        }
    };
    prepared.design.axes.iter().map(number).collect()
}

/// Optimises a goal.
///
/// # Errors
/// [`StudyError`] if no start has results.
pub(super) fn optimise_goal<S: GradientScene>(
    of: &Search<'_, '_, S>,
    goal: Goal,
    progress: Progress<'_>,
) -> Result<Optimised, StudyError> {
    let job = &of.scene.jobs[of.job];
    let mut problem = of.prepared.problem(goal);
    let mut worker = of.engine.worker();
    let scaled = scale_problem(&mut problem, &mut worker, of.first, &of.prepared.requested);
    let own = of.own.or(Some(of.first));
    let starts = starts(&problem, of.engine, own, job.starts.unwrap_or(STARTS));
    let ended = search(&problem, of.engine, &starts, progress);
    // The best that satisfies its conditions; converged before others of the same goal.
    let rank = |of: &Ended| {
        let goal = of.optimum.evaluation.goal;
        let bad = if of.is_feasible() {
            0.0
        } else {
            1e6 * (1.0 + of.optimum.evaluation.violation())
        };
        goal + bad + if of.is_converged() { 0.0 } else { SAME_OPTIMUM }
    };
    let best = ended.iter().min_by(|a, b| rank(a).total_cmp(&rank(b)));
    let Some(best) = best.filter(|_| scaled.is_some()) else {
        return Err(no_design(of));
    };
    let mut found = report(of, &problem, &mut worker, best);
    found.certificate = certify(&problem, &mut worker, best);
    let values: Vec<f64> = found.numbers.iter().map(|number| number.after).collect();
    found.is_interrupted = interruption::is_requested();
    let results = worker.evaluate(&values, false);
    if let Some(results) = results.filter(|_| !found.is_interrupted) {
        let results: Vec<f64> = results.iter().map(|of| of.value).collect();
        let requested = &of.prepared.requested;
        probe(
            of.scene,
            &problem,
            requested,
            &values,
            &results,
            &mut found.certificate,
        )?;
    }
    found.optima = optima(&problem, &ended);
    found.starts = [
        ended.len(),
        ended.iter().filter(|of| !of.is_converged()).count(),
    ];
    found.evaluations = ended.iter().map(|of| of.optimum.evaluations).sum();
    found.is_exact = of.engine.is_recorded();
    found.history = best.history.clone();
    found.job.clone_from(&job.name);
    Ok(found)
}

/// The error of a search without a design.
fn no_design<S: GradientScene>(of: &Search<'_, '_, S>) -> StudyError {
    let message = if interruption::is_requested() {
        "the search was interrupted before it had a design"
    } else {
        "no start of the job has results with derivatives"
    };
    let place = SceneLocation::Job(of.job);
    let place = (place, "this job".to_owned());
    of.scene.error(message.to_owned(), None, &[place]).into()
}

/// The best design with its conditions and prices.
// Long because a report has many parts, each read off the optimum.
fn report<S: GradientScene>(
    of: &Search<'_, '_, S>,
    problem: &Problem<'_>,
    worker: &mut Worker<'_, '_>,
    best: &Ended,
) -> Optimised {
    let optimum = &best.optimum;
    let values = problem.values(&optimum.x[..problem.bounds.len()]);
    let numbers = problem.design.numbers(&values);
    let at = |worker: &mut Worker<'_, '_>, values: &[f64]| {
        let results = worker.evaluate(values, false)?;
        Some(problem.report(&results, &problem.design.numbers(values)))
    };
    let before = of.own.and_then(|own| at(worker, own));
    let (goal, conditions) = at(worker, &values).unwrap_or((f64::NAN, Vec::new()));
    let quantities = &of.prepared.requested.quantities;
    let unit_of = |of: &super::expressions::JobExpression| {
        of.result()
            .map_or(String::new(), |k| quantities[k].unit.clone())
    };
    let summand = |(of, weight): &(super::expressions::JobExpression, f64)| match *weight {
        1.0 => of.text.clone(),
        weight => format!("{weight} {}", of.text),
    };
    let summands: Vec<String> = problem.goal.summands.iter().map(summand).collect();
    let units: Vec<String> = problem
        .goal
        .summands
        .iter()
        .map(|(of, _)| unit_of(of))
        .collect();
    let rate = problem.goal_rate(goal);
    let active = |multiplier: f64| multiplier.abs() > 1e-8;
    let multiplier = |family: usize| -> f64 {
        let all = optimum
            .evaluation
            .constraints
            .iter()
            .zip(&optimum.multipliers);
        all.filter(|(c, _)| c.family == family)
            .map(|(_, m)| m)
            .sum()
    };
    let slopes = worker.evaluate(&values, true).map_or_else(Vec::new, |_| {
        let slope = problem.evaluate(worker, &optimum.x).map(|at| at.slope);
        slope.unwrap_or_default()
    });
    let number = |(k, axis): (usize, &crate::sweep::compute::Axis)| {
        let (x, [from, to]) = (optimum.x[k], problem.bounds[k]);
        let is_at_bound = x <= AT_BOUND || x >= 1.0 - AT_BOUND;
        OptimisedNumber {
            path: axis.path.clone(),
            unit: axis.unit.clone(),
            before: of.scene.value(&axis.path).unwrap_or(f64::NAN),
            after: values[k],
            bounds: [from, to],
            bound_price: is_at_bound.then(|| optimum.of_bounds[k] * rate / (to - from)),
            slope: slopes
                .get(k)
                .map_or(f64::NAN, |slope| slope * rate / (to - from)),
        }
    };
    let condition = |(k, of): (usize, &super::problem::Condition)| ConditionReport {
        text: of.expression.text.clone(),
        sign: match of.sense {
            Sense::AtMost => "<=",
            Sense::AtLeast => ">=",
            Sense::Equal => "=",
        },
        unit: unit_of(&of.expression),
        limit: of.limit,
        before: before.as_ref().map(|(_, values)| values[k]),
        after: conditions.get(k).copied().unwrap_or(f64::NAN),
        price: Some(multiplier(k))
            .filter(|m| active(*m))
            .map(|m| problem.price(k, m, goal)),
    };
    let own_families = problem.conditions.len();
    let peaks = optimum
        .evaluation
        .constraints
        .iter()
        .zip(&optimum.multipliers);
    let peaks = peaks.filter(|(c, m)| c.family >= own_families && active(**m));
    let assigned = problem.design.assigned(&numbers).into_iter();
    Optimised {
        goal: summands.join(" + "),
        unit: if units.iter().all(|unit| *unit == units[0]) {
            units[0].clone()
        } else {
            String::new()
        },
        before: before.as_ref().map(|(goal, _)| *goal),
        after: goal,
        numbers: problem.design.axes.iter().enumerate().map(number).collect(),
        assigned: assigned
            .map(|(path, value)| (path.to_owned(), value))
            .collect(),
        conditions: problem
            .conditions
            .iter()
            .enumerate()
            .map(condition)
            .collect(),
        peaks: peaks
            .map(|(c, m)| ActivePeak {
                place: c.place,
                multiplier: *m,
            })
            .collect(),
        ..Optimised::default()
    }
}

/// The optima that were met, the best first.
fn optima(problem: &Problem<'_>, ended: &[Ended]) -> Vec<MetOptimum> {
    let mut found: Vec<MetOptimum> = Vec::new();
    let mut converged: Vec<&Ended> = ended.iter().filter(|of| of.is_converged()).collect();
    converged.sort_by(|a, b| {
        a.optimum
            .evaluation
            .goal
            .total_cmp(&b.optimum.evaluation.goal)
    });
    for of in converged {
        let goal = problem.goal_of(of.optimum.evaluation.goal);
        let size = problem.goal_size();
        match found.last_mut() {
            Some(last) if (goal - last.goal).abs() <= SAME_OPTIMUM * size => last.count += 1,
            _ => found.push(MetOptimum {
                goal,
                count: 1,
                values: problem.values(&of.optimum.x[..problem.bounds.len()]),
            }),
        }
    }
    found
}
