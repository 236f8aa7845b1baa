//! Computes the steady cycle, its tables, and the flywheel.

use crate::explain::StudyError;
use crate::models::{SceneMachine, SolverSettings};
use crate::number_format::{count, digits};
use dwell_dynamics::{
    Cycle, DynamicsError, Flywheel, Machine, Options, initial_transient, size_flywheel,
    steady_cycle,
};
use dwell_findings::{Column, Table};
use dwell_geometry::ActuatorId;
use dwell_scene::{Scene, SceneLocation};

/// Revolutions from the initial state to the first guess.
const RUN_UP_REVOLUTIONS: u32 = 3;
/// Tolerance of this transient.
const GUESS_TOLERANCE: f64 = 1e-6;
/// Maximum steps of an integration: a machine that has not completed its revolutions by then never does.
const MAX_STEPS: usize = 100_000;

/// The same cycle, shifted to the first revolution of the coordinate.
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
fn require_rotating(scene_machine: &SceneMachine<'_>) -> Result<(), StudyError> {
    let free = scene_machine.machine.free();
    if scene_machine.machine.nonconservative_sources().is_empty() {
        return Err(scene_machine.error(
            "no unique steady cycle: without a drive or losses the machine cycles at any speed"
                .to_owned(),
            "add a drive, as in `[drives]`; `dwell simulate` shows the free motion and its period",
            &[scene_machine.initial_state_label("of this motion")],
        ));
    }
    let label = |i: usize, words: &str| (SceneLocation::Actuator(ActuatorId(i)), words.to_owned());
    if free.len() != 1 {
        let labels: Vec<_> = free.iter().take(8).map(|&i| label(i, "free")).collect();
        return Err(scene_machine.error(
            format!(
                "a steady cycle needs exactly one free coordinate; {} are free",
                free.len()
            ),
            "prescribe the others by constant laws in [motion]",
            &labels,
        ));
    }
    let (coordinate, is_angle) = scene_machine.first_free_coordinate();
    let range = scene_machine.machine.model().plan().range();
    let extent_text = match range.limits() {
        None if is_angle => return Ok(()),
        None => "is a length".to_owned(),
        Some((from, to)) => {
            let unit = if is_angle { "rad" } else { "m" };
            let [from, to] = [from, to].map(|end| digits(end, 6));
            format!("is limited to {from} to {to} {unit}")
        }
    };
    Err(scene_machine.error(
        format!(
            "`{}` {extent_text}, so there is no steady cycle",
            scene_machine.coordinate_name(coordinate)
        ),
        "use the angle of a body that rotates fully as the actuator",
        &[label(coordinate, "does not rotate fully")],
    ))
}

/// Explains a machine that does not complete the first revolutions.
fn run_up_error(scene_machine: &SceneMachine<'_>, error: &DynamicsError) -> StudyError {
    let DynamicsError::MaxStepsReached {
        t,
        max_steps: steps,
    } = *error
    else {
        return scene_machine.explain(error);
    };
    scene_machine.error(
        format!(
            "the machine does not complete its revolutions: after {}, at t = {} s, it has not made {} from \
             its initial state",
            count(steps, "step"),
            digits(t, 2),
            count(RUN_UP_REVOLUTIONS as usize, "revolution")
        ),
        "increase the drive or the initial speed so that it passes the position of largest resistance; \
         `dwell simulate` shows the motion",
        &[scene_machine.initial_state_label("from here")],
    )
}

/// One cycle: time, states, acceleration and works since its start.
fn cycle_table(
    scene_machine: &SceneMachine<'_>,
    machine: &Machine,
    cycle: &Cycle,
) -> Result<Table, StudyError> {
    let mut columns = vec![Column::new("t", "s")];
    let mut states = scene_machine.state_columns().into_iter();
    columns.extend(states.by_ref().take(2));
    let (coordinate, _) = scene_machine.first_free_coordinate();
    let name = scene_machine.coordinate_name(coordinate);
    columns.push(Column::new(format!("{name}.acceleration"), "rad/s2"));
    columns.extend(states);
    for source in machine.nonconservative_sources() {
        let name = format!("{}.work", scene_machine.source_name(*source));
        columns.push(Column::new(name, "J"));
    }
    let mut workspace = machine.workspace();
    let mut rows = Vec::with_capacity(cycle.samples.len());
    for point in &cycle.samples {
        let state = machine.evaluate(point.t, &point.y, &mut workspace);
        let state = state.map_err(|e| scene_machine.explain(&e))?;
        let mut row = vec![point.t, point.y[0], point.y[1], state.q_ddot()[coordinate]];
        row.extend(&point.y[2..]);
        rows.push(row);
    }
    Ok(Table { columns, rows })
}

/// The work of each load and drive over the cycle, and their sum.
fn work_table(scene_machine: &SceneMachine<'_>, cycle: &Cycle) -> Table {
    let sources = scene_machine.machine.nonconservative_sources().iter();
    let mut columns: Vec<Column> = sources
        .map(|source| {
            let name = format!("{}.work", scene_machine.source_name(*source));
            Column::new(name, "J")
        })
        .collect();
    let mut row = cycle.works.clone();
    columns.push(Column::new("work_sum", "J"));
    row.push(cycle.works.iter().sum());
    Table {
        columns,
        rows: vec![row],
    }
}

/// A steady cycle with its tables, and with the flywheel if a fluctuation was required.
pub struct CycleResults<'a> {
    pub(crate) scene_machine: SceneMachine<'a>,
    /// The cycle.
    pub steady: Cycle,
    /// One cycle: time, states, acceleration and works since its start.
    pub samples: Table,
    /// The work of each load and drive over the cycle, and their sum.
    pub works: Table,
    /// The required coefficient of fluctuation, and the flywheel for it.
    pub flywheel: Option<(f64, Flywheel)>,
    /// The cycle with the flywheel, if one is needed.
    pub flywheel_samples: Option<Table>,
}

/// Computes the steady cycle of a scene, and the flywheel for a coefficient of `fluctuation` if given.
///
/// # Errors
/// As [`cycle`](crate::cycle()).
pub fn compute_cycle<'a>(
    scene: &'a Scene,
    settings: &SolverSettings,
    fluctuation: Option<f64>,
) -> Result<CycleResults<'a>, StudyError> {
    let scene_machine = SceneMachine::new(scene)?;
    require_rotating(&scene_machine)?;
    scene_machine.require_autonomous("a steady cycle")?;
    let options = Options {
        atol: settings.atol,
        max_steps: MAX_STEPS,
        max_step: settings.max_step,
        ..Options::new(settings.method, settings.rtol)
    };
    let machine = &scene_machine.machine;
    // The guess need not be exact, and a coarse integration starts more easily from rest.
    let coarse = Options {
        atol: options.atol.max(GUESS_TOLERANCE),
        rtol: options.rtol.max(GUESS_TOLERANCE),
        ..options
    };
    let guess = initial_transient(
        machine,
        &scene_machine.initial_state(),
        RUN_UP_REVOLUTIONS,
        &coarse,
    );
    let guess = guess.map_err(|e| run_up_error(&scene_machine, &e))?;
    let explain = |e: DynamicsError| scene_machine.explain(&e);
    let steady = in_first_revolution(steady_cycle(machine, &guess, &options).map_err(explain)?);
    let flywheel = match fluctuation {
        None => None,
        Some(target) => {
            let sized = size_flywheel(machine, &steady.initial_state, target, &options);
            let sized = sized.map_err(explain)?;
            let cycle = in_first_revolution(sized.cycle);
            Some((target, Flywheel { cycle, ..sized }))
        }
    };
    let samples = cycle_table(&scene_machine, machine, &steady)?;
    let works = work_table(&scene_machine, &steady);
    let flywheel_samples = match &flywheel {
        Some((_, sized)) if sized.inertia > 0.0 => {
            let heavier = machine.clone();
            let heavier = heavier.with_flywheel(0, machine.flywheel(0) + sized.inertia);
            Some(cycle_table(&scene_machine, &heavier, &sized.cycle)?)
        }
        _ => None,
    };
    Ok(CycleResults {
        scene_machine,
        steady,
        samples,
        works,
        flywheel,
        flywheel_samples,
    })
}
