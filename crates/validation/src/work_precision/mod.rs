//! `dwell work-precision`: the cost of accuracy. Every combination of evaluation, integrator and tolerance computes
//! the motion of a scene; its true error is compared with its cost.

mod combination;
mod commands;
mod evaluator;
mod exported_code;
mod figure;
mod fixed_step;
mod reference_solution;
mod report;
mod requested;
mod run;
mod selected_cases;
mod studied_scene;
mod subject;

pub use combination::{
    Combination, CombinationResult, Cost, CostMeasure, Effort, ErrorQuantity, Errors, Evaluation,
    Integrator, ReferenceInfo, WorkPrecision,
};
pub use commands::CommandRun;
use commands::{PRESETS, command_runs};
pub use evaluator::{Evaluator, ModelEvaluator, ReactionFn};
pub use exported_code::ExportedCode;
pub use fixed_step::FixedStep;
pub use requested::RequestedCosts;
pub use selected_cases::selected_case_reports;
pub use studied_scene::{CommandedMotion, PreliminaryRun, StudiedScene};

use dwell_dynamics::{DynamicsError, Method, TabulationError};
use dwell_geometry::Range;
use dwell_kinetostatics::{
    ExactModel, ReducedModel, ReducibleModel as _, TableDomain, TabulatedModel,
};
use dwell_report::TableExport as _;
use dwell_scene::{Scene, SceneLocation};
use dwell_study::StudyError;
use dwell_study::output::Picture;
use dwell_study::{Outcome, Progress, Step};
use evaluator::{MachineEvaluator, SinglePrecisionModel};
use reference_solution::ReferenceSolution;
use run::{Run, ToleranceSeries};
use std::time::Instant;
use subject::Subject;

/// Margin of a table of a limited range beyond the motion, relative to the motion's range.
const TABLE_MARGIN: f64 = 0.05;
/// Runs with more evaluations are timed only once.
const MAX_REPEATED_EVALUATIONS: usize = 30_000;
/// Number of passes in which an evaluation is timed.
const TIMING_PASSES: usize = 20;

/// The full study of a scene: `NAME-work-precision.md`, `.csv`, `.npz` and `.png`.
///
/// # Errors
/// As [`measure`]; [`StudyError::Report`] when a table cannot be written.
pub fn work_precision(scene: &Scene, progress: Progress<'_>) -> Result<Outcome, StudyError> {
    match scene {
        Scene::Plane(scene) => outcome(&**scene, progress),
        Scene::Space(scene) => outcome(&**scene, progress),
    }
}

fn outcome<S: StudiedScene>(scene: &S, progress: Progress<'_>) -> Result<Outcome, StudyError> {
    let found = measure(scene, &Effort::full(), progress)?;
    let name = format!("{}-work-precision", scene.name);
    let mut outcome = Outcome {
        summary: report::summary(scene, &found)
            + &report::exported_code_summary(&found)
            + &report::command_summary(scene, &found),
        record: report::record(&found),
        ..Outcome::default()
    };
    let figure = figure::figure(scene, &found, &name);
    let picture = Picture::figure(scene, format!("{name}.png"), true, figure);
    outcome.pictures.push(picture);
    let files = &mut outcome.files;
    files.add(format!("{name}.csv"), report::csv(&found)?);
    files.add(format!("{name}.npz"), report::table(&found).npz()?);
    let mut document = report::document(scene, &found, &name);
    document.blocks.extend(report::exported_code_blocks(&found));
    document.blocks.extend(report::command_blocks(&found));
    outcome.page = Some((format!("{name}.md"), document));
    Ok(outcome)
}

/// Cost and true error of each combination on the motion of a scene: that of `[motion]`, or a free
/// motion from the assembly, for at most three periods or revolutions.
///
/// # Errors
/// [`StudyError::Scene`] if the scene cannot be assembled, nothing in it is free or moves, or no two methods
/// reach the end of its motion.
pub fn measure<S: StudiedScene>(
    scene: &S,
    effort: &Effort,
    progress: Progress<'_>,
) -> Result<WorkPrecision, StudyError> {
    measure_with(scene, effort, &|_| Vec::new(), progress)
}

/// Further evaluators, built from the reduced model of a motion of one degree of freedom without loads.
pub type ExtraEvaluators<'m, M> = &'m dyn Fn(&ExactModel<M>) -> Vec<Box<dyn Evaluator>>;

/// [`measure`] with further evaluators.
///
/// # Errors
/// As [`measure`].
// Long, because it is the whole study from its subject to its results.
pub fn measure_with<S: StudiedScene>(
    scene: &S,
    effort: &Effort,
    extra: ExtraEvaluators<'_, S::Model>,
    progress: Progress<'_>,
) -> Result<WorkPrecision, StudyError> {
    let subject = Subject::new(scene)?;
    let mut omitted = Vec::new();
    let evaluators = evaluators(&subject, effort, extra, &mut omitted);
    let Some(exact) = evaluators.first().map(|exact| &**exact) else {
        return Err(subject.explain(&DynamicsError::DurationTooShort));
    };
    let total = Method::ALL.len() * evaluators.len() + effort.repetitions.max(1) + PRESETS.len();
    let done = |what: &str| progress(Step { total, done: what });
    let series =
        |evaluator: &dyn Evaluator, method: Method, reference: Option<&ToleranceSeries>| {
            let series = ToleranceSeries::new(evaluator, &subject, method, effort, reference);
            done(&format!(
                "{}, {}",
                evaluator.evaluation().name(),
                method.name()
            ));
            series
        };
    let series_by_method = Method::ALL.map(|method| series(exact, method, None));
    let mut reference = ReferenceSolution::new(&subject, exact, &series_by_method, effort)
        .map_err(|e| no_reference_error(&subject, &e, &series_by_method))?;
    let mut trials: Vec<Trial<'_>> = Vec::new();
    for (k, evaluator) in evaluators.iter().map(|e| &**e).enumerate() {
        let rerun = |of: &ToleranceSeries| series(evaluator, of.method, Some(of));
        let all = match k {
            0 => series_by_method.to_vec(),
            _ => series_by_method.iter().map(rerun).collect(),
        };
        collect_trials(evaluator, &subject, all, &mut trials, &mut omitted);
    }
    let timed = || done("times");
    let unit_times = time_runs(&subject, &reference, exact, &mut trials, effort, &timed);
    let [evaluation_time, jacobian_time] = unit_times.map_err(|e| subject.explain(&e))?;
    let points = results(&mut reference, trials, evaluation_time, &mut omitted);
    let fixed_step = fixed_step::fixed_step(&mut reference, exact, &subject, evaluation_time);
    let fixed_step =
        fixed_step.map_err(|e| omitted.push(format!("fixed step: {}", run::reason(&e))));
    let exported_code = if effort.exported_code {
        exported_code::exported_code(&mut reference, exact, &subject, evaluation_time)
    } else {
        Ok(Vec::new())
    };
    let exported_code = exported_code.map_err(|e| omitted.push(format!("exported code: {e}")));
    Ok(WorkPrecision {
        points,
        fixed_step: fixed_step.ok(),
        requested: requested::requested_costs(&subject, &reference.states)?,
        commands: command_runs(&mut reference, exact, &subject, effort.exported_code, &done)?,
        exported_code: exported_code.unwrap_or_default(),
        omitted,
        reference: reference.info,
        motion_notes: subject.notes.clone(),
        duration: subject.end(),
        unit: subject.unit(),
        repetitions: effort.repetitions.max(1),
        evaluation_time,
        jacobian_cost: jacobian_time / evaluation_time,
    })
}

/// Errors and costs of all runs. A run that leaves the range of an evaluator or of the mechanism has no error.
fn results<S: StudiedScene>(
    reference: &mut ReferenceSolution<'_, S>,
    trials: Vec<Trial<'_>>,
    evaluation_time: f64,
    omitted: &mut Vec<String>,
) -> Vec<CombinationResult> {
    let mut points = Vec::new();
    for (evaluator, combination, run) in trials {
        match reference.errors(&run.states, &mut evaluator.reactions()) {
            Ok(errors) => points.push(CombinationResult {
                combination,
                errors,
                cost: cost(evaluator, &run, evaluation_time),
            }),
            Err(error) => omitted.push(format!("{}: {}", combination.name(), run::reason(&error))),
        }
    }
    points
}

/// The runs of one evaluator, with the quadrature if the motion follows from the energy.
fn collect_trials<'e, S: StudiedScene>(
    evaluator: &'e dyn Evaluator,
    subject: &Subject<S>,
    all_series: Vec<ToleranceSeries>,
    trials: &mut Vec<Trial<'e>>,
    omitted: &mut Vec<String>,
) {
    let evaluation = evaluator.evaluation();
    let mut add = |integrator: Integrator, run: Run| {
        let combination = Combination {
            evaluation,
            integrator,
        };
        trials.push((evaluator, combination, run));
    };
    for series in all_series {
        omitted.extend(series.omitted);
        for (tolerance, run) in series.runs {
            add(Integrator::Steps(series.method, tolerance), run);
        }
    }
    if subject.orbit.is_none() {
        return;
    }
    match run::quadrature(evaluator, subject) {
        Some(run) => add(Integrator::Quadrature, run),
        None => {
            let name = evaluation.name();
            omitted.push(format!("{name}, quadrature: not smooth or not known"));
        }
    }
}

/// All evaluators of the motion, the exact one first. New evaluators are added here.
fn evaluators<'s, S: StudiedScene>(
    subject: &'s Subject<S>,
    effort: &Effort,
    extra: ExtraEvaluators<'_, S::Model>,
    omitted: &mut Vec<String>,
) -> Vec<Box<dyn Evaluator + 's>> {
    let mut all: Vec<Box<dyn Evaluator + 's>> = match &subject.reduced {
        Some(exact) => vec![
            Box::new(ModelEvaluator {
                model: exact.clone(),
                evaluation: Evaluation::Exact,
                build_time: 0.0,
            }),
            Box::new(ModelEvaluator {
                model: SinglePrecisionModel::new(exact),
                evaluation: Evaluation::SinglePrecision,
                build_time: 0.0,
            }),
        ],
        None => {
            let machine = |evaluation| MachineEvaluator {
                subject,
                evaluation,
                table: None,
                build_time: 0.0,
            };
            let [exact, single] = [Evaluation::Exact, Evaluation::SinglePrecision].map(machine);
            vec![Box::new(exact), Box::new(single)]
        }
    };
    let range = match &subject.reduced {
        Some(exact) => exact.range(),
        None => subject.machine.model().range(),
    };
    let domain = table_domain(range, subject.coordinate_range);
    for &accuracy in &effort.table_accuracies {
        let Some(table) = table_evaluator(subject, accuracy, domain) else {
            omitted.push("tables: a machine in space with loads or drives has none".to_owned());
            break;
        };
        match table {
            Ok(table) => all.push(table),
            Err(error @ TabulationError::Table(_)) => {
                omitted.push(format!("table {accuracy:.0e}: {error}"));
            }
            Err(error) => {
                omitted.push(format!("tables: {error}"));
                break;
            }
        }
    }
    if let Some(exact) = &subject.reduced {
        all.extend(extra(exact));
    }
    all
}

/// A table, or the reason why there is none with this accuracy.
type TableResult<'s> = Result<Box<dyn Evaluator + 's>, TabulationError>;

/// The reduced model, or otherwise the machine, on a table; `None` if such machines have no tables.
fn table_evaluator<S: StudiedScene>(
    subject: &Subject<S>,
    accuracy: f64,
    domain: TableDomain,
) -> Option<TableResult<'_>> {
    let started = Instant::now();
    let evaluation = |cells, bytes| Evaluation::Table {
        accuracy,
        cells,
        bytes,
    };
    if let Some(exact) = &subject.reduced {
        let model = TabulatedModel::new(exact, accuracy, domain);
        let evaluator = model.map(|model| -> Box<dyn Evaluator> {
            Box::new(ModelEvaluator {
                build_time: started.elapsed().as_secs_f64(),
                evaluation: evaluation(model.cells()[0], model.bytes()[0]),
                model,
            })
        });
        return Some(evaluator.map_err(Into::into));
    }
    let table = S::tabulated(&subject.machine, accuracy, domain)?;
    Some(table.map(|table| -> Box<dyn Evaluator + '_> {
        Box::new(MachineEvaluator {
            subject,
            build_time: started.elapsed().as_secs_f64(),
            evaluation: evaluation(table.cells()[0], table.bytes()),
            table: Some(table),
        })
    }))
}

/// The range of a motion with a margin.
fn table_domain(range: Range, [low, high]: [f64; 2]) -> TableDomain {
    if range.period().is_some() {
        return TableDomain::Full;
    }
    let margin = TABLE_MARGIN * (high - low);
    let limits = range.limits();
    let (min, max) = limits.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    TableDomain::Between((low - margin).max(min), (high + margin).min(max))
}

fn cost(evaluator: &dyn Evaluator, run: &Run, evaluation_time: f64) -> Cost {
    let statistics = run.statistics;
    Cost {
        steps: statistics.steps,
        rejected: statistics.rejected_steps,
        evaluations: statistics.evaluations,
        jacobians: statistics.jacobians,
        weighted_evaluations: statistics.evaluations
            + evaluator.jacobian_weight() * statistics.jacobians,
        time: run.seconds / evaluation_time,
        build_time: evaluator.build_time() / evaluation_time,
    }
}

/// A combination with its evaluator and the best of its runs.
type Trial<'e> = (&'e dyn Evaluator, Combination, Run);

/// Repeats all runs one after another, measures the unit between them, and keeps the minimum times. Returns the unit:
/// the time of one evaluation and of one Jacobian, s.
fn time_runs<S: StudiedScene>(
    subject: &Subject<S>,
    reference: &ReferenceSolution<'_, S>,
    exact: &dyn Evaluator,
    trials: &mut [Trial<'_>],
    effort: &Effort,
    done: &dyn Fn(),
) -> Result<[f64; 2], DynamicsError> {
    let mut unit_times = [f64::INFINITY; 2];
    let mut update = || update_unit_times(&mut unit_times, subject, reference, exact);
    update()?;
    for _ in 1..effort.repetitions {
        for (k, (evaluator, combination, best_run)) in trials.iter_mut().enumerate() {
            if k % 16 == 0 {
                update()?;
            }
            if best_run.statistics.evaluations > MAX_REPEATED_EVALUATIONS {
                continue;
            }
            let rerun = match combination.integrator {
                Integrator::Steps(method, tolerance) => {
                    run::solve(*evaluator, subject, method, tolerance, usize::MAX).ok()
                }
                Integrator::Quadrature => run::quadrature(*evaluator, subject),
            };
            let seconds = rerun.map_or(f64::INFINITY, |run| run.seconds);
            best_run.seconds = best_run.seconds.min(seconds);
        }
        done();
    }
    update()?;
    done();
    Ok(unit_times)
}

/// Times evaluations at every state of the reference, which are independent and at different positions.
fn update_unit_times<S: StudiedScene>(
    [evaluation, jacobian]: &mut [f64; 2],
    subject: &Subject<S>,
    reference: &ReferenceSolution<'_, S>,
    exact: &dyn Evaluator,
) -> Result<(), DynamicsError> {
    let mut system = exact.system()?;
    let n = system.size();
    let (mut out, mut matrix) = (vec![0.0; n], vec![0.0; n * n]);
    let states = || reference.states.iter().zip(&subject.times);
    let since = |started: Instant| started.elapsed().as_secs_f64() / states().len().max(1) as f64;
    for _ in 0..TIMING_PASSES {
        let started = Instant::now();
        for (y, &t) in states() {
            system.rhs(t, y, &mut out)?;
        }
        *evaluation = since(started).max(f64::MIN_POSITIVE).min(*evaluation);
        let started = Instant::now();
        for (y, &t) in states() {
            system.jacobian(t, y, &mut matrix)?;
        }
        *jacobian = jacobian.min(since(started));
    }
    Ok(())
}

/// The error if there is no reference, because no two methods reach the end.
fn no_reference_error<S: StudiedScene>(
    subject: &Subject<S>,
    error: &DynamicsError,
    all_series: &[ToleranceSeries],
) -> StudyError {
    let reasons = all_series.iter().flat_map(|series| series.omitted.first());
    let label = |reason: &String| (SceneLocation::Duration, reason.clone());
    let labels: Vec<_> = reasons.take(4).map(label).collect();
    if labels.is_empty() {
        return subject.explain(error);
    }
    let help = "use a shorter `duration` or a less stiff model (friction with a larger `regularization-speed`)";
    let message = "no two methods reach the end of this motion, so no error can be determined";
    let (message, help) = (message.to_owned(), Some(help.to_owned()));
    subject.scene.error(message, help, &labels).into()
}
