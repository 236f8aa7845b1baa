//! Equilibria, linearised motion and the steady cycle of a machine.

use crate::error::Error;
use crate::motion::Solver;
use dwell_dynamics::Stability;
use dwell_findings::Column;
use dwell_study::machines::MachineScene;
use dwell_study::{
    CycleSearch, CycleStability, OperatingPoint, compute_cycle, compute_equilibria,
    compute_linearisation,
};

/// The equilibria of a machine in the plane or in space.
pub(crate) fn equilibria_of<S: MachineScene>(scene: &S) -> Result<Vec<Equilibrium>, Error> {
    let results = compute_equilibria(scene)?;
    let start = scene.motion_start();
    let free = start.laws.iter().filter(|law| law.is_none()).count();
    let equilibrium = |e: &dwell_dynamics::Equilibrium| Equilibrium {
        coordinates: e.y[..free].to_vec(),
        stability: e.stability,
        modes: e.modes(),
        eigenvalues: e.eigenvalues.clone(),
    };
    Ok(results.found.iter().map(equilibrium).collect())
}

/// Small motions of a machine in the plane or in space.
pub(crate) fn linearisation_of<S: MachineScene>(scene: &S) -> Result<StateSpace, Error> {
    let found = compute_linearisation(scene, OperatingPoint::Equilibrium)?;
    let named = |columns: &[Column]| columns.iter().map(heading).collect();
    Ok(StateSpace {
        states: named(&found.names.states),
        inputs: named(&found.names.inputs),
        outputs: named(&found.names.outputs),
        operating_point: found.state[..found.names.states.len()].to_vec(),
        a: found.linear.a,
        b: found.linear.b,
        c: found.linear.c,
        d: found.linear.d,
        eigenvalues: found.eigenvalues,
    })
}

/// The steady cycle of a machine in the plane or in space.
pub(crate) fn cycle_of<S: MachineScene>(
    scene: &S,
    solver: &Solver,
    fluctuation: Option<f64>,
) -> Result<Cycle, Error> {
    let search = compute_cycle(scene, &solver.settings(), fluctuation)?;
    let found = match search {
        CycleSearch::Steady(found) => found,
        CycleSearch::NoCycle { reason, .. } => return Err(reason.into()),
    };
    let works = found
        .works
        .columns
        .iter()
        .zip(found.works.rows.iter().flatten());
    Ok(Cycle {
        period: found.steady.period,
        mean_speed: found.steady.mean_speed,
        fluctuation: found.steady.fluctuation,
        is_stable: found.errors.stability(&found.steady) == CycleStability::Stable,
        works: works
            .map(|(column, work)| (column.name.clone(), *work))
            .collect(),
        flywheel: found.flywheel.map(|sized| sized.flywheel.inertia),
    })
}

/// A column's name with its unit.
fn heading(column: &Column) -> String {
    match column.unit.as_str() {
        "" => column.name.clone(),
        unit => format!("{} [{unit}]", column.name),
    }
}

/// An equilibrium.
///
/// ```
/// # fn show(found: &dwell::Equilibrium) {
/// for mode in &found.modes {
///     println!("{:.3} Hz", mode.angular_frequency / std::f64::consts::TAU);
/// }
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// The free coordinates, rad or m.
    pub coordinates: Vec<f64>,
    /// Whether a small disturbance grows or decays.
    pub stability: Stability,
    /// The vibration modes of the linearised motion, by increasing frequency.
    pub modes: Vec<dwell_dynamics::Mode>,
    /// The eigenvalues, 1/s, as real and imaginary parts.
    pub eigenvalues: Vec<[f64; 2]>,
}

/// A linearised motion: ẋ = A x + B u, z = C x + D u, in deviations from the operating point. Matrices are lists of rows.
///
/// ```
/// # fn show(linear: &dwell::StateSpace) {
/// for (state, row) in linear.states.iter().zip(&linear.a) {
///     println!("{state}: {row:?}");
/// }
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// Names and units of the states x.
    pub states: Vec<String>,
    /// Names and units of the inputs u: one for each drive.
    pub inputs: Vec<String>,
    /// Names and units of the outputs z: coordinates, velocities, reactions, forces of drives.
    pub outputs: Vec<String>,
    /// The states about which it is linearised.
    pub operating_point: Vec<f64>,
    /// By state, by state.
    pub a: Vec<Vec<f64>>,
    /// By state, by input.
    pub b: Vec<Vec<f64>>,
    /// By output, by state.
    pub c: Vec<Vec<f64>>,
    /// By output, by input.
    pub d: Vec<Vec<f64>>,
    /// The eigenvalues of A, 1/s, as real and imaginary parts.
    pub eigenvalues: Vec<[f64; 2]>,
}

/// A steady cycle.
///
/// ```
/// # fn show(cycle: &dwell::Cycle) {
/// println!("{:.2} rad/s, coefficient of fluctuation {:.4}", cycle.mean_speed, cycle.fluctuation);
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    /// Its duration, s.
    pub period: f64,
    /// Mean speed, rad/s.
    pub mean_speed: f64,
    /// Coefficient of fluctuation: (largest − smallest speed) / mean speed.
    pub fluctuation: f64,
    /// Whether a small disturbance decays.
    pub is_stable: bool,
    /// The work of each load and drive in a cycle, J, and their sum.
    pub works: Vec<(String, f64)>,
    /// The moment of inertia to be added along the coordinate for the requested coefficient of fluctuation,
    /// kg·m².
    pub flywheel: Option<f64>,
}
