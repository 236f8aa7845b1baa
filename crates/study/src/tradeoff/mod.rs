//! `dwell tradeoff`: what accuracy costs. Every combination of evaluation, integrator and tolerance is run on
//! the motion of a scene; its true error is held against what it took.

mod combination;
mod evaluator;
mod figure;
mod page;
mod reports;
mod run;
mod subject;
mod truth;

pub use combination::{
    Combination, Cost, Effort, Errors, Evaluation, Integrator, Measured, Price, Quantity, Tradeoff,
    Truth,
};
pub use evaluator::{ByModel, Evaluator, Reactions};
pub use reports::reports;

use crate::error::StudyError;
use crate::outcome::{Outcome, Progress, Step};
use crate::provenance::picture;
use dwell_dynamics::{DynamicsError, Method, NotTabled, Tabled};
use dwell_geometry::Range;
use dwell_kinetostatics::{Exact, Extent, Reduced, Table, TableError};
use dwell_scene::Scene;
use evaluator::{ByMachine, ByShortMachine, ByTable, Short, of_table};
use run::{Ladder, Run};
use std::time::Instant;
use subject::Subject;
use truth::Known;

/// What a table of a limited range covers beyond where the motion goes, as a part of its way.
const BEYOND: f64 = 0.05;
/// A run of so many evaluations tells its time at once.
const LONG: usize = 30_000;
/// Evaluations between two looks at the clock.
const TIMED: usize = 20;

/// The study of a scene, with everything that is tried: `NAME-tradeoff.md`, `.csv`, `.npz` and `.png`.
///
/// # Errors
/// As [`measure`]; [`StudyError::Report`] when the picture cannot be drawn.
pub fn tradeoff(scene: &Scene, progress: Progress<'_>) -> Result<Outcome, StudyError> {
    let found = measure(scene, &Effort::full(), progress)?;
    let name = format!("{}-tradeoff", scene.name);
    let mut outcome = Outcome {
        summary: page::summary(scene, &found),
        ..Outcome::default()
    };
    let figure = figure::figure(scene, &found, &name);
    let files = &mut outcome.files;
    files.add(format!("{name}.png"), picture(scene, &figure)?);
    files.add(format!("{name}.csv"), page::csv(&found)?);
    files.add(format!("{name}.npz"), page::table(&found).npz()?);
    let document = page::document(scene, &found, &name);
    files.add(format!("{name}.md"), document.markdown());
    Ok(outcome)
}

/// What each combination costs on the motion of a scene, and its true error: that of `[motion]`, or one that it is
/// set free for, followed for three periods or turns at most.
///
/// # Errors
/// [`StudyError::Scene`] when the scene cannot be put together, nothing in it is free or moves, or its motion
/// cannot be followed by two methods.
pub fn measure(
    scene: &Scene,
    effort: &Effort,
    progress: Progress<'_>,
) -> Result<Tradeoff, StudyError> {
    measure_with(scene, effort, &|_| Vec::new(), progress)
}

/// Further evaluators, made of the reduced model of a motion of one freedom without loads.
pub type More<'m> = &'m dyn Fn(&Exact) -> Vec<Box<dyn Evaluator>>;

/// [`measure`] with further evaluators.
///
/// # Errors
/// As [`measure`].
pub fn measure_with(
    scene: &Scene,
    effort: &Effort,
    more: More<'_>,
    progress: Progress<'_>,
) -> Result<Tradeoff, StudyError> {
    let subject = Subject::new(scene)?;
    let mut left_out = Vec::new();
    let evaluators = evaluators(&subject, effort, more, &mut left_out);
    let Some(exact) = evaluators.first().map(|exact| &**exact) else {
        return Err(subject.explain(&DynamicsError::TooShort));
    };
    let total = Method::ALL.len() * evaluators.len() + effort.repetitions.max(1);
    let done = |what: &str| progress(Step { total, done: what });
    let ladder = |evaluator: &dyn Evaluator, method: Method, known: Option<&Ladder>| {
        let ladder = Ladder::new(evaluator, &subject, method, effort, known);
        let name = evaluator.evaluation().name();
        done(&format!("{name}, {}", method.name()));
        ladder
    };
    let methods = Method::ALL.into_iter();
    let ladders: Vec<Ladder> = methods.map(|method| ladder(exact, method, None)).collect();
    let mut known = Known::new(&subject, exact, &ladders, effort)
        .map_err(|e| unknown(&subject, &e, &ladders))?;
    let mut trials: Vec<Trial<'_>> = Vec::new();
    for (k, evaluator) in evaluators.iter().enumerate() {
        let again = |known: &Ladder| ladder(&**evaluator, known.method, Some(known));
        let own = match k {
            0 => ladders.clone(),
            _ => ladders.iter().map(again).collect(),
        };
        collect(&**evaluator, &subject, own, &mut trials, &mut left_out);
    }
    let clock = time(&subject, &known, exact, &mut trials, effort, &|| {
        done("times");
    });
    let clock = clock.map_err(|e| subject.explain(&e))?;
    let mut points = Vec::new();
    for (evaluator, combination, run) in trials {
        // What left the range of an evaluator or the mechanism has no error, and no place in the study.
        match known.errors(&run.states, &mut evaluator.reactions()) {
            Ok(errors) => points.push(Measured {
                combination,
                errors,
                cost: cost(evaluator, &run, clock.second),
            }),
            Err(error) => left_out.push(format!("{}: {error}", combination.name())),
        }
    }
    Ok(Tradeoff {
        points,
        left_out,
        truth: Truth {
            by: known.by,
            floor: known.floor,
        },
        motion: subject.told.clone(),
        duration: subject.end(),
        unit: subject.unit(),
        repetitions: effort.repetitions.max(1),
        second: clock.second,
        jacobian: clock.jacobian / clock.second,
    })
}

/// The runs of one evaluator, with the quadrature where the energy tells the motion.
fn collect<'e>(
    evaluator: &'e dyn Evaluator,
    subject: &Subject,
    ladders: Vec<Ladder>,
    trials: &mut Vec<Trial<'e>>,
    left_out: &mut Vec<String>,
) {
    let evaluation = evaluator.evaluation();
    let mut add = |integrator: Integrator, run: Run| {
        let combination = Combination {
            evaluation,
            integrator,
        };
        trials.push((evaluator, combination, run));
    };
    for ladder in ladders {
        left_out.extend(ladder.left_out);
        for (tolerance, run) in ladder.runs {
            add(Integrator::Steps(ladder.method, tolerance), run);
        }
    }
    if subject.orbit.is_none() {
        return;
    }
    match run::quadrature(evaluator, subject) {
        Some(run) => add(Integrator::Quadrature, run),
        None => left_out.push(format!(
            "{}, quadrature: not smooth enough, or not known",
            evaluation.name()
        )),
    }
}

/// All ways to evaluate the motion, the exact one first. A new one is a line here.
fn evaluators<'s>(
    subject: &'s Subject,
    effort: &Effort,
    more: More<'_>,
    left_out: &mut Vec<String>,
) -> Vec<Box<dyn Evaluator + 's>> {
    let Some(exact) = &subject.reduced else {
        let machine = || ByMachine {
            machine: &subject.machine,
            seen: &subject.seen,
            start: &subject.start,
        };
        let mut all: Vec<Box<dyn Evaluator + 's>> =
            vec![Box::new(machine()), Box::new(ByShortMachine(machine()))];
        for &accuracy in &effort.tables {
            let began = Instant::now();
            match Tabled::new(
                &subject.machine,
                accuracy,
                extent(subject.machine.model().plan().range(), subject.reach),
            ) {
                Ok(table) => all.push(Box::new(ByTable {
                    making: began.elapsed().as_secs_f64(),
                    table,
                    accuracy,
                    exact: machine(),
                })),
                Err(error @ NotTabled::Table(_)) => {
                    left_out.push(format!("table {accuracy:.0e}: {error}"));
                }
                Err(error) => {
                    left_out.push(format!("tables: {error}"));
                    break;
                }
            }
        }
        return all;
    };
    let mut all: Vec<Box<dyn Evaluator + 's>> = vec![
        Box::new(ByModel {
            model: exact.clone(),
            evaluation: Evaluation::Exact,
            making: 0.0,
        }),
        Box::new(ByModel {
            model: Short::new(exact, &subject.scene.mechanism),
            evaluation: Evaluation::Short,
            making: 0.0,
        }),
    ];
    for &accuracy in &effort.tables {
        match table(exact, accuracy, subject.reach) {
            Ok((model, making)) => all.push(Box::new(ByModel {
                evaluation: of_table(&model, accuracy),
                model,
                making,
            })),
            Err(error) => left_out.push(format!("table {accuracy:.0e}: {error}")),
        }
    }
    all.extend(more(exact));
    all
}

/// A table that reaches as far as the motion, and the time of making it, s.
fn table(exact: &Exact, accuracy: f64, reach: [f64; 2]) -> Result<(Table, f64), TableError> {
    let began = Instant::now();
    let table = Table::new(exact, accuracy, extent(exact.range(), reach))?;
    Ok((table, began.elapsed().as_secs_f64()))
}

/// As far as a motion goes, and somewhat farther.
fn extent(range: Range, [low, high]: [f64; 2]) -> Extent {
    match (range.period(), range.limits()) {
        (Some(_), _) => Extent::Whole,
        (None, limits) => {
            let room = BEYOND * (high - low);
            let (least, most) = limits.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            Extent::Between((low - room).max(least), (high + room).min(most))
        }
    }
}

fn cost(evaluator: &dyn Evaluator, run: &Run, second: f64) -> Cost {
    let work = run.statistics;
    Cost {
        steps: work.steps,
        rejected: work.rejected,
        evaluations: work.evaluations,
        jacobians: work.jacobians,
        weighed: work.evaluations + evaluator.jacobian() * work.jacobians,
        time: run.seconds / second,
        making: evaluator.making() / second,
    }
}

/// What one evaluation and one Jacobian take, s.
struct Clock {
    second: f64,
    jacobian: f64,
}

/// A combination with its evaluator and the best of its runs.
type Trial<'e> = (&'e dyn Evaluator, Combination, Run);

/// Runs everything again, one after the other, with the unit between them, and keeps the least times.
fn time(
    subject: &Subject,
    known: &Known<'_>,
    exact: &dyn Evaluator,
    trials: &mut [Trial<'_>],
    effort: &Effort,
    done: &dyn Fn(),
) -> Result<Clock, DynamicsError> {
    let mut clock = Clock {
        second: f64::INFINITY,
        jacobian: f64::INFINITY,
    };
    clock.look(subject, known, exact)?;
    for _ in 1..effort.repetitions {
        for (k, (evaluator, combination, best)) in trials.iter_mut().enumerate() {
            if k % 16 == 0 {
                clock.look(subject, known, exact)?;
            }
            if best.statistics.evaluations > LONG {
                continue;
            }
            let again = match combination.integrator {
                Integrator::Steps(method, tolerance) => {
                    run::follow(*evaluator, subject, (method, tolerance), usize::MAX).ok()
                }
                Integrator::Quadrature => run::quadrature(*evaluator, subject),
            };
            let seconds = again.map_or(f64::INFINITY, |run| run.seconds);
            best.seconds = best.seconds.min(seconds);
        }
        done();
    }
    clock.look(subject, known, exact)?;
    done();
    Ok(clock)
}

impl Clock {
    /// Evaluates at every state of the truth: each waits for no other, but has its own place.
    fn look(
        &mut self,
        subject: &Subject,
        known: &Known<'_>,
        exact: &dyn Evaluator,
    ) -> Result<(), DynamicsError> {
        let mut system = exact.system()?;
        let n = system.size();
        let (mut out, mut matrix) = (vec![0.0; n], vec![0.0; n * n]);
        let count = known.states.len().max(1) as f64;
        for _ in 0..TIMED {
            let began = Instant::now();
            for (y, &t) in known.states.iter().zip(&subject.times) {
                system.rates(t, y, &mut out)?;
            }
            let took = began.elapsed().as_secs_f64() / count;
            self.second = self.second.min(took.max(f64::MIN_POSITIVE));
            let began = Instant::now();
            for (y, &t) in known.states.iter().zip(&subject.times) {
                system.jacobian(t, y, &mut matrix)?;
            }
            let took = began.elapsed().as_secs_f64() / count;
            self.jacobian = self.jacobian.min(took);
        }
        Ok(())
    }
}

/// Why there is no truth: no two methods get to the end.
fn unknown(subject: &Subject, error: &DynamicsError, ladders: &[Ladder]) -> StudyError {
    let why = ladders.iter().flat_map(|ladder| ladder.left_out.first());
    let labels: Vec<_> = why
        .take(4)
        .map(|why| (dwell_scene::Place::Length, why.clone()))
        .collect();
    if labels.is_empty() {
        return subject.explain(error);
    }
    let help =
        "a shorter `duration`, or what is less stiff (a friction that fades over a larger speed)";
    let message = "no two methods follow this motion to its end: nothing tells the error of any";
    let error = subject
        .scene
        .error(message.to_owned(), Some(help.to_owned()), &labels);
    error.into()
}
