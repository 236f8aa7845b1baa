//! Computes the steady cycle, its tables, and the flywheel.

use crate::cycle::errors::MAX_SPEED_ERROR;
pub use crate::cycle::errors::{CycleErrors, CycleStability};
use crate::explain::{StudyError, describe_ends, labels};
use crate::machines::{MachineScene, SceneMachine};
use crate::models::SolverSettings;
use crate::number_format::{count, digits};
use dwell_dynamics::{
    Cycle, DynamicsError, Flywheel, Machine, MovingModel, OdeState, Options, initial_transient,
    size_flywheel, steady_cycle,
};
use dwell_findings::{Column, Table};
use dwell_geometry::ActuatorId;
use dwell_kinetostatics::ReducibleModel as _;
use dwell_scene::{PlaneScene, SceneLocation};

/// Revolutions from the initial state to the first guess.
const RUN_UP_REVOLUTIONS: u32 = 3;
/// Tolerance of this transient.
const GUESS_TOLERANCE: f64 = 1e-6;
/// Maximum steps of an integration: a machine that has not completed its revolutions by then never does.
const MAX_STEPS: usize = 100_000;

/// The cycle, shifted to the first revolution of the coordinate.
fn in_first_revolution(mut cycle: Cycle) -> Cycle {
    let offset = cycle.cycle_angle * (cycle.initial_state[0] / cycle.cycle_angle).floor();
    cycle.initial_state[0] -= offset;
    for point in &mut cycle.samples {
        point.y[0] -= offset;
    }
    for extreme in [&mut cycle.slowest, &mut cycle.fastest] {
        extreme[0] = (extreme[0] - offset).rem_euclid(cycle.cycle_angle);
    }
    cycle
}

/// Rejects a machine whose free coordinate does not rotate fully.
fn require_rotating(prepared: &SceneMachine<'_, impl MachineScene>) -> Result<(), StudyError> {
    let free = prepared.machine.free();
    if prepared.machine.nonconservative_sources().is_empty() {
        return Err(prepared.error(
            "no unique steady cycle: without a drive or losses the machine cycles at any speed",
            "add a drive, as in `[drives]`; `dwell simulate` shows the free motion and its period",
            prepared.initial_state_label("of this motion"),
        ));
    }
    let actuators = free.iter().map(|&i| SceneLocation::Actuator(ActuatorId(i)));
    if free.len() != 1 {
        let count = free.len();
        return Err(prepared.error(
            format!("a steady cycle needs exactly one free coordinate; {count} are free"),
            "prescribe the others by constant laws in [motion]",
            labels(actuators.take(8), "free"),
        ));
    }
    let (coordinate, is_angle) = prepared.first_free_coordinate();
    let range = prepared.machine.model().range();
    let fault = match range.limits() {
        None if is_angle => return Ok(()),
        None => "is a length".to_owned(),
        Some((from, to)) => {
            let range = describe_ends(prepared.scene, from, to, is_angle);
            format!("is limited to {range}")
        }
    };
    let name = prepared.coordinate_name(coordinate);
    Err(prepared.error(
        format!("`{name}` {fault}, so there is no steady cycle"),
        "use the angle of a body that rotates fully as the actuator",
        labels(actuators, "does not rotate fully"),
    ))
}

/// Explains a machine that does not complete the first revolutions.
fn run_up_error(
    prepared: &SceneMachine<'_, impl MachineScene>,
    error: &DynamicsError,
    max_step: Option<f64>,
) -> StudyError {
    let DynamicsError::MaxStepsReached { t, max_steps } = *error else {
        return prepared.explain(error);
    };
    let is_limited = |longest: &f64| t >= 0.5 * longest * max_steps as f64;
    let (steps, time) = (count(max_steps, "step"), digits(t, 2));
    let (message, help) = match max_step.filter(is_limited) {
        Some(longest) => {
            let longest = digits(longest, 2);
            let message = format!(
                "after {steps}, at t = {time} s, the first revolutions are not complete: --max-step allows none above {longest} s"
            );
            (message, "give a longer --max-step, or none")
        }
        None => {
            let revolutions = count(RUN_UP_REVOLUTIONS as usize, "revolution");
            let message = format!(
                "the machine does not complete its revolutions: after {steps}, at t = {time} s, it has not made {revolutions} from \
                 its initial state"
            );
            let help = "increase the drive or the initial speed so that it passes the position of largest resistance; \
                 `dwell simulate` shows the motion";
            (message, help)
        }
    };
    prepared.error(message, help, prepared.initial_state_label("from here"))
}

/// A column for the work of each load and drive.
fn work_columns(prepared: &SceneMachine<'_, impl MachineScene>) -> impl Iterator<Item = Column> {
    let sources = prepared.machine.nonconservative_sources().iter();
    sources.map(|&source| {
        Column::new(
            format!("{}.work", prepared.scene.name_of_source(source)),
            "J",
        )
    })
}

/// The column of the coordinate in the samples of a cycle with a single coordinate.
pub const COORDINATE_COLUMN: usize = 1;

/// One cycle: time, states, acceleration and works since its start.
fn cycle_table<S: MachineScene>(
    prepared: &SceneMachine<'_, S>,
    machine: &Machine<S::Model>,
    cycle: &Cycle,
) -> Result<Table, StudyError> {
    let (coordinate, _) = prepared.first_free_coordinate();
    let name = format!("{}.acceleration", prepared.coordinate_name(coordinate));
    let mut columns = vec![Column::new("t", "s")];
    columns.extend(prepared.state_columns());
    columns.insert(3, Column::new(name, "rad/s2"));
    columns.extend(work_columns(prepared));
    let mut workspace = machine.workspace();
    let row = |point: &OdeState| -> Result<Vec<f64>, StudyError> {
        let state = machine.evaluate(point.t, &point.y, &mut workspace);
        let state = state.map_err(|e| prepared.explain(&e))?;
        let mut row = vec![point.t];
        row.extend(&point.y);
        row.insert(3, state.q_ddot()[coordinate]);
        Ok(row)
    };
    let rows = cycle.samples.iter().map(row).collect::<Result<_, _>>()?;
    Ok(Table { columns, rows })
}

/// The work of each load and drive over the cycle, and their sum.
fn work_table(prepared: &SceneMachine<'_, impl MachineScene>, cycle: &Cycle) -> Table {
    let mut columns: Vec<Column> = work_columns(prepared).collect();
    let mut row = cycle.works.clone();
    columns.push(Column::new("work_sum", "J"));
    row.push(cycle.works.iter().sum());
    Table {
        columns,
        rows: vec![row],
    }
}

/// A flywheel for a coefficient of fluctuation.
pub struct SizedFlywheel {
    /// The coefficient of fluctuation.
    pub target: f64,
    /// The flywheel and the cycle with it.
    pub flywheel: Flywheel,
    /// The estimated error of its moment of inertia, kg m².
    pub inertia_error: f64,
    /// The estimated errors of the cycle with it.
    pub errors: CycleErrors,
}

/// Whether a machine has a steady cycle.
pub enum CycleSearch<'a, S: MachineScene = PlaneScene> {
    /// The cycle was found.
    Steady(Box<CycleResults<'a, S>>),
    /// No cycle was found, or its error is too large to decide; with the reason.
    NoCycle {
        /// The scene with its machine.
        prepared: Box<SceneMachine<'a, S>>,
        /// Why not.
        reason: StudyError,
    },
}

/// A steady cycle with its tables, and with the flywheel if a fluctuation was required.
pub struct CycleResults<'a, S: MachineScene = PlaneScene> {
    /// The scene with its machine.
    pub prepared: SceneMachine<'a, S>,
    /// The cycle.
    pub steady: Cycle,
    /// Its estimated errors.
    pub errors: CycleErrors,
    /// One cycle: time, states, acceleration and works since its start.
    pub samples: Table,
    /// The work of each load and drive over the cycle, and their sum.
    pub works: Table,
    /// The flywheel, if a coefficient of fluctuation was required.
    pub flywheel: Option<SizedFlywheel>,
    /// The cycle with the flywheel, if one is needed.
    pub flywheel_samples: Option<Table>,
}

/// Computes the steady cycle of a scene, and the flywheel for a coefficient of `fluctuation` if given.
///
/// # Errors
/// As [`cycle`](crate::cycle()).
pub fn compute_cycle<'a, S: MachineScene>(
    scene: &'a S,
    settings: &SolverSettings,
    fluctuation: Option<f64>,
) -> Result<CycleSearch<'a, S>, StudyError> {
    scene.reject_unknown_columns()?;
    let prepared = SceneMachine::new(scene)?;
    require_rotating(&prepared)?;
    prepared.require_autonomous("a steady cycle")?;
    let options = Options {
        max_steps: MAX_STEPS,
        ..settings.options()
    };
    let found = find_cycle(&prepared, &options).and_then(|(steady, errors)| {
        let size = |target| size_for(&prepared, &steady, target, &options);
        let flywheel = fluctuation.map(size).transpose()?;
        Ok((steady, errors, flywheel))
    });
    let (steady, errors, flywheel) = match found {
        Ok(found) => found,
        Err(reason) => {
            let prepared = Box::new(prepared);
            return Ok(CycleSearch::NoCycle { prepared, reason });
        }
    };
    let machine = &prepared.machine;
    let samples = cycle_table(&prepared, machine, &steady)?;
    let works = work_table(&prepared, &steady);
    let flywheel_samples = match &flywheel {
        Some(sized) if sized.flywheel.inertia > 0.0 => {
            let heavier = with_flywheel(machine, sized.flywheel.inertia);
            Some(cycle_table(&prepared, &heavier, &sized.flywheel.cycle)?)
        }
        _ => None,
    };
    Ok(CycleSearch::Steady(Box::new(CycleResults {
        prepared,
        steady,
        errors,
        samples,
        works,
        flywheel,
        flywheel_samples,
    })))
}

/// The cycle from the scene's initial state, with its errors.
fn find_cycle(
    prepared: &SceneMachine<'_, impl MachineScene>,
    options: &Options,
) -> Result<(Cycle, CycleErrors), StudyError> {
    // The guess need not be exact, and a coarse integration starts more easily from rest.
    let coarse = Options {
        atol: options.atol.max(GUESS_TOLERANCE),
        rtol: options.rtol.max(GUESS_TOLERANCE),
        ..*options
    };
    let (machine, start) = (&prepared.machine, prepared.initial_state());
    let guess = initial_transient(machine, &start, RUN_UP_REVOLUTIONS, &coarse)
        .map_err(|e| run_up_error(prepared, &e, options.max_step))?;
    let explain = |e: DynamicsError| prepared.explain(&e);
    let steady = in_first_revolution(steady_cycle(machine, &guess, options).map_err(explain)?);
    let errors = estimated_errors(prepared, machine, &steady, options)?;
    Ok((steady, errors))
}

/// The errors of a cycle, unless they are so large that there may be none.
fn estimated_errors<S: MachineScene>(
    prepared: &SceneMachine<'_, S>,
    machine: &Machine<S::Model>,
    cycle: &Cycle,
    options: &Options,
) -> Result<CycleErrors, StudyError> {
    let errors = CycleErrors::new(machine, cycle, options).map_err(|e| prepared.explain(&e))?;
    if errors.speed <= MAX_SPEED_ERROR {
        return Ok(errors);
    }
    let mean = digits(cycle.mean_speed, 3);
    let error = digits(errors.speed * cycle.mean_speed.abs(), 1);
    Err(prepared.error(
        format!(
            "no steady cycle is certain: one at {mean} rad/s is found, with an estimated error of {error} rad/s"
        ),
        "use a smaller --rtol, or another --method",
        prepared.initial_state_label("from here"),
    ))
}

/// The machine with a flywheel added.
fn with_flywheel<M: MovingModel>(machine: &Machine<M>, inertia: f64) -> Machine<M> {
    let inertia = machine.flywheel(0) + inertia;
    machine.clone().with_flywheel(0, inertia)
}

/// The flywheel for a coefficient of fluctuation, and its errors.
fn size_for(
    prepared: &SceneMachine<'_, impl MachineScene>,
    steady: &Cycle,
    target: f64,
    options: &Options,
) -> Result<SizedFlywheel, StudyError> {
    let machine = &prepared.machine;
    let explain = |e: DynamicsError| prepared.explain(&e);
    let sized = size_flywheel(machine, &steady.initial_state, target, options).map_err(explain)?;
    let cycle = in_first_revolution(sized.cycle);
    let heavier = with_flywheel(machine, sized.inertia);
    let errors = estimated_errors(prepared, &heavier, &cycle, options)?;
    let mut workspace = heavier.workspace();
    let state = heavier.evaluate(0.0, &cycle.initial_state, &mut workspace);
    let [kinetic, _] = state.map_err(explain)?.energy();
    let whole = 2.0 * kinetic / cycle.initial_state[1].powi(2);
    Ok(SizedFlywheel {
        target,
        // The fluctuation falls as the inverse of the whole inertia.
        inertia_error: whole * errors.fluctuation / target,
        flywheel: Flywheel { cycle, ..sized },
        errors,
    })
}
