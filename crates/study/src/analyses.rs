//! Every analysis as a function of a scene, in the plane or in space.

use crate::explain::StudyError;
use crate::export::ExportRequest;
use crate::free_motion::compute::{FreeMotion, MotionSolver};
use crate::progress::Progress;
use crate::reduce::compute::{Reduction, peak_between_rows};
use crate::reduce::page_of;
use crate::study_scene::{PageAndStop, StudyScene};
use crate::trajectory::compute::{
    Analysis, ComputedTrajectory, RowSource, RowStorage, compute_trajectory_in,
};
use dwell_dynamics::Orbit;
use dwell_export::{Export, SeveralFreedomsExport};
use dwell_findings::{Finding, Record, RecordedEvent};
use dwell_page::Page;
use dwell_symbolic::ClosedForm;
#[cfg(feature = "output")]
use {
    crate::export::output::{ExportTarget, export_machine, several_freedoms_outcome},
    crate::models::SolverSettings,
    crate::output::Outcome,
    crate::reduce::compute::TableRequest,
    crate::reduce::output::{add_table, reduction_outcome},
    crate::symbolic::output::{FormulaFormat, WrittenForm, closed_form_outcome},
    crate::trajectory::figures::PictureSpan,
    crate::trajectory::output::TrajectoryOutcome,
    dwell_report::TableExport as _,
};

/// Describes a scene: degrees of freedom, groups, assembly modes, range, pruning and requests. It writes
/// no file.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled, or a requested column does not exist.
#[cfg(feature = "output")]
pub fn check<S: StudyScene>(scene: &S) -> Result<Outcome, StudyError> {
    let mut record = Record::default();
    Ok(Outcome {
        summary: scene.description(&mut record)?,
        record,
        ..Outcome::default()
    })
}

/// The text of [`check`].
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled, or a requested column does not exist.
pub fn describe_scene<S: StudyScene>(scene: &S) -> Result<String, StudyError> {
    scene.description(&mut Record::default())
}

/// Analyses a scene along its prescribed motion, its sweep, or the range of its only actuator, at `points` positions
/// (two or more) if given.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled, the scene defines no actuator
/// coordinates, a requested column does not exist, or the first position cannot be reached.
pub fn compute_trajectory<'a, S: StudyScene>(
    scene: &'a S,
    analysis: Analysis,
    points: Option<usize>,
    progress: Progress<'_>,
) -> Result<ComputedTrajectory<'a>, StudyError> {
    compute_trajectory_in(RowStorage::Whole, scene, analysis, points, progress)
}

/// The page of an analysis of a scene along its prescribed motion, its sweep, or the range of its only actuator: the rows of its table,
/// peaks, the mechanism in each row, and the reason for an early end of the motion. In the plane it prints notes on the assembly.
///
/// A page of very many rows holds every n-th row, and states this.
///
/// # Errors
/// As [`compute_trajectory`].
///
/// ```
/// use dwell_scene::SpaceScene;
/// use dwell_study::{Analysis, no_progress, trajectory_page};
///
/// let scene = SpaceScene::read("../../validation/spatial/rssr.toml")?;
/// let (page, early_stop) = trajectory_page(&scene, Analysis::Kinematics, Some(13), &no_progress)?;
/// let encoded = page.encode()?;
/// assert!(encoded.description.contains("rocker.C.x") && early_stop.is_none());
/// assert_eq!(encoded.numbers.len() % 13, 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn trajectory_page<S: StudyScene>(
    scene: &S,
    analysis: Analysis,
    points: Option<usize>,
    progress: Progress<'_>,
) -> Result<PageAndStop, StudyError> {
    let rows = scene.rows()?;
    let source = RowSource::new(scene, &rows);
    let computed = source.analysed(analysis, points, progress)?;
    let mut page = S::page(&source, &computed);
    page.printed = computed.notes;
    Ok((page, computed.early_stop))
}

/// The page of a free motion, and why it ended early or misses the required accuracy, if so.
///
/// # Errors
/// As [`compute_free_motion`].
///
/// ```
/// use dwell_study::{MotionSolver, SolverSettings, free_motion_page, no_progress};
///
/// let text = r#"
/// bodies.ground.points = { O = [0, 0, 0] }
/// bodies.bob = { points = { O = [0, 0, 0] }, mass = 2.0, center = [0.5, 0, 0] }
/// joints.O = { revolute = ["ground.O", "bob.O"], axis = [0, 1, 0] }
/// actuators.phi = { angle = "O" }
/// assembly.phi = 0.0
/// loads.weight = { gravity = [0, 0, -9.81] }
/// motion.duration = 1.0
/// "#;
/// let scene = dwell_scene::SpaceScene::parse("pendulum.toml", text)?;
/// let solver = MotionSolver::Settings(SolverSettings::default());
/// let (page, early_stop) = free_motion_page(&scene, &solver, &no_progress)?;
/// assert!(page.drawing.is_some() && early_stop.is_none());
/// # Ok::<(), dwell_study::StudyError>(())
/// ```
pub fn free_motion_page<S: StudyScene>(
    scene: &S,
    solver: &MotionSolver,
    progress: Progress<'_>,
) -> Result<PageAndStop, StudyError> {
    scene.simulate_then(solver, None, progress, |source, described| {
        let FreeMotion {
            computed, events, ..
        } = described.motion;
        let mut page = S::page(source, &computed);
        let description = (described.description)();
        page.printed = description.summary;
        page.numbers = description.record.numbers;
        page.events = recorded(events);
        (page, computed.early_stop)
    })
}

/// Analyses a scene along its prescribed motion, its sweep, or the range of its only actuator, at
/// `points` positions (two or more) if given.
///
/// # Errors
/// As [`compute_trajectory`]; [`StudyError::Scene`] where many rows cannot be stored.
#[cfg(feature = "output")]
pub fn analyse_trajectory<S: StudyScene>(
    scene: &S,
    analysis: Analysis,
    points: Option<usize>,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    analyse_trajectory_within(scene, analysis, points, PictureSpan::default(), progress)
}

/// As [`analyse_trajectory`], with curves that show a part of the trajectory.
///
/// # Errors
/// As [`compute_trajectory`]; [`StudyError::Scene`] if the part is not within the trajectory.
#[cfg(feature = "output")]
pub fn analyse_trajectory_within<S: StudyScene>(
    scene: &S,
    analysis: Analysis,
    points: Option<usize>,
    span: PictureSpan,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let rows = scene.rows()?;
    let source = RowSource {
        storage: RowStorage::Bounded,
        ..RowSource::new(scene, &rows)
    };
    let computed = source.analysed(analysis, points, progress)?;
    let mut outcome = S::report(&source, &computed, span)?;
    outcome.summary += &computed.notes;
    Ok(TrajectoryOutcome {
        outcome,
        early_stop: computed.early_stop,
    })
}

/// Computes the reduced parameters of a scene over its range, at `points` positions (two or more) if given.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled, or a position of the range cannot be evaluated.
pub fn compute_reduction<S: StudyScene>(
    scene: &S,
    points: Option<usize>,
) -> Result<Reduction<S::Prepared<'_>>, StudyError> {
    Reduction::new(scene.prepared()?, points)
}

/// The page of the reduced parameters of a scene.
///
/// # Errors
/// [`StudyError::Scene`] where a position cannot be reached.
///
/// ```
/// # let text = r#"
/// # bodies.ground.points = { O = [0, 0] }
/// # bodies.bob = { points = { O = [0, 0] }, mass = 2.0, center = [0.5, 0] }
/// # joints.O = { revolute = ["ground.O", "bob.O"] }
/// # actuators.phi = { angle = ["ground", "bob"] }
/// # "#;
/// let scene = dwell_scene::PlaneScene::parse("pendulum.toml", text)?;
/// let reduction = dwell_study::compute_reduction(&scene, Some(5))?;
/// let page = dwell_study::reduction_page::<dwell_scene::PlaneScene>(&reduction)?;
/// // m = M r² everywhere.
/// assert_eq!(page.columns[1].values, [0.5; 5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn reduction_page<S: StudyScene>(
    reduction: &Reduction<S::Prepared<'_>>,
) -> Result<Page, StudyError> {
    let peak = peak_between_rows(&reduction.prepared, &reduction.curves);
    let mut page = page_of(reduction, &reduction.table(), peak);
    page.drawing = S::drawing_of(&reduction.prepared, &page.columns[0].values)?;
    Ok(page)
}

/// The reduced parameters of a scene over its range, at `points` positions (two or more) if given, and an interpolation
/// table if requested.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled, a figure cannot be drawn or the table cannot be
/// built.
#[cfg(feature = "output")]
pub fn reduce<S: StudyScene>(
    scene: &S,
    points: Option<usize>,
    table: Option<TableRequest>,
) -> Result<Outcome, StudyError> {
    let reduction = compute_reduction(scene, points)?;
    let mut outcome = reduction_outcome(&reduction)?;
    if let Some(run) = &mut outcome.run {
        run.drawing = S::drawing_of(&reduction.prepared, &run.columns[0].values)?;
    }
    if let Some(request) = table {
        add_table(&reduction.prepared, &request, &mut outcome)?;
    }
    if let Some([figure, animation]) = S::range_pictures(&reduction.prepared)? {
        outcome.pictures.insert(0, figure);
        outcome.pictures.push(animation);
    }
    Ok(outcome)
}

/// The free motion of a scene.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or its initial state cannot be evaluated. An error later in
/// the motion, or an accuracy that is not reached, is in [`ComputedTrajectory::early_stop`].
pub fn compute_free_motion<S: StudyScene>(
    scene: &S,
    solver: &MotionSolver,
    progress: Progress<'_>,
) -> Result<FreeMotion, StudyError> {
    scene.simulate_then(solver, None, progress, |_, described| described.motion)
}

/// The period (s) and the energy (J) of the free motion of a scene, by quadrature: for one free coordinate and conservative
/// loads.
///
/// # Errors
/// [`StudyError`] where the scene has no motion, or it is not conservative or does not repeat itself.
///
/// ```
/// # let scene = dwell_scene::PlaneScene::read("../../validation/single-dwell/scene.toml")?;
/// let orbit = dwell_study::compute_period(&scene)?;
/// assert!((orbit.period - 5.41966267706427).abs() < 1e-12);
/// # Ok::<(), dwell_study::StudyError>(())
/// ```
pub fn compute_period<S: StudyScene>(scene: &S) -> Result<Orbit, StudyError> {
    scene.orbit()
}

/// The free motion of a scene, by a method and a tolerance.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or its initial state cannot be evaluated. An error later in
/// the motion is in [`TrajectoryOutcome::early_stop`].
#[cfg(feature = "output")]
pub fn simulate<S: StudyScene>(
    scene: &S,
    settings: &SolverSettings,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    simulate_with(scene, &MotionSolver::Settings(*settings), None, progress)
}

/// The free motion of a scene to a required accuracy, by the cheapest method that reaches it. `accuracy` bounds the
/// error of angles in rad, of lengths relative to their largest change, and of energy and reactions relative to their
/// largest value.
///
/// # Errors
/// As [`simulate`]. If the accuracy is not reached, [`TrajectoryOutcome::early_stop`] has the reason.
#[cfg(feature = "output")]
pub fn simulate_to_accuracy<S: StudyScene>(
    scene: &S,
    accuracy: f64,
    sample_interval: Option<f64>,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let solver = MotionSolver::Accuracy {
        accuracy,
        sample_interval,
    };
    simulate_with(scene, &solver, None, progress)
}

/// The free motion of a scene, with rows at wanted `times` (s, ascending) and at its end, or else equally spaced.
///
/// # Errors
/// As [`simulate`]; [`StudyError::Scene`] for a time outside the motion.
#[cfg(feature = "output")]
pub fn simulate_with<S: StudyScene>(
    scene: &S,
    solver: &MotionSolver,
    times: Option<&[f64]>,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    simulate_within(scene, solver, times, PictureSpan::default(), progress)
}

/// As [`simulate_with`], with curves that show a part of the motion.
///
/// # Errors
/// As [`simulate_with`]; [`StudyError::Scene`] if the part is not within the motion.
#[cfg(feature = "output")]
pub fn simulate_within<S: StudyScene>(
    scene: &S,
    solver: &MotionSolver,
    times: Option<&[f64]>,
    span: PictureSpan,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    scene.simulate_then(solver, times, progress, |source, described| {
        let FreeMotion {
            computed, events, ..
        } = described.motion;
        let mut outcome = S::report(source, &computed, span)?;
        let description = (described.description)();
        if !events.is_empty() {
            let name = format!("{}-motion-events.csv", scene.name);
            outcome.files.add(name, description.event_table.csv()?);
        }
        outcome.summary += &description.summary;
        outcome.record.extend(description.record);
        outcome.record.events = recorded(events);
        Ok(TrajectoryOutcome {
            outcome,
            early_stop: computed.early_stop,
        })
    })?
}

/// The events that happened, with their times.
fn recorded(events: Vec<(f64, String)>) -> Vec<RecordedEvent> {
    let event = |(t, name)| RecordedEvent { name, t };
    events.into_iter().map(event).collect()
}

/// Closed forms of a scene, and their comparison with the exact model.
///
/// # Errors
/// [`StudyError`] where the mechanism is in space, is not made of dyads, has several actuators, or has no such
/// reaction.
pub fn compute_closed_form<S: StudyScene>(
    scene: &S,
    reaction: Option<&str>,
) -> Result<(ClosedForm, Vec<Finding>), StudyError> {
    scene.closed_form(reaction)
}

/// The closed forms of a scene as formulas or code, for the named reaction or the first that the scene requests.
///
/// # Errors
/// [`StudyError`] where the mechanism is in space, is not made of dyads, has several actuators, or has no such
/// reaction.
#[cfg(feature = "output")]
pub fn symbolic<S: StudyScene>(
    scene: &S,
    format: FormulaFormat,
    reaction: Option<&str>,
) -> Result<Outcome, StudyError> {
    let (form, findings) = scene.closed_form(reaction)?;
    let written = WrittenForm {
        file: scene,
        coordinate: scene.actuator(0).unwrap_or_default().0,
        notes: &scene.closed_form_notes(&form),
    };
    Ok(closed_form_outcome(&written, &form, findings, format))
}

/// Fits the functions of a scene's machine for export.
///
/// # Errors
/// [`StudyError::Scene`] if the scene cannot be exported; the error states the reason and a change.
pub fn compute_export<S: StudyScene>(
    scene: &S,
    asked: &ExportRequest,
) -> Result<Export, StudyError> {
    scene.fitted_export(asked)
}

/// The operations of the equations of motion and of all reactions of a scene with several actuators, each of which is a free
/// coordinate.
///
/// # Errors
/// [`StudyError::Scene`] if the scene cannot be exported; the error states the reason and a change.
pub fn compute_export_of_several_freedoms<S: StudyScene>(
    scene: &S,
    asked: &ExportRequest,
) -> Result<SeveralFreedomsExport, StudyError> {
    scene.several_freedoms(asked)
}

/// Exports the reduced model of a scene's machine, or the equations of motion of one with several actuators.
///
/// # Errors
/// [`StudyError::Scene`] if the scene cannot be exported; the error states the reason and a change.
#[cfg(feature = "output")]
pub fn export<S: StudyScene>(
    scene: &S,
    target: ExportTarget,
    asked: &ExportRequest,
) -> Result<Outcome, StudyError> {
    if scene.actuator(1).is_some() {
        let export = match target {
            ExportTarget::C => scene.several_freedoms(asked)?,
            _ => return Err(scene.several_freedoms_error()),
        };
        return Ok(several_freedoms_outcome(&export));
    }
    let table = || Ok(compute_reduction(scene, None)?.table());
    export_machine(scene, target, asked, table, || scene.fitted_export(asked))
}
