//! States of a case under its loads, with any number of coordinates, for the checks of states.

use super::claims::SpaceClaims;
use crate::error::ValidationError;
use dwell_dynamics::{CoordinateMode, Machine};
use dwell_findings::Finding;
use dwell_kinetostatics::space::{Axes, Model};
use dwell_scene::SpaceScene;
use dwell_study::{StudyError, model_with_loads};
use dwell_verify::{ClaimedState, SubjectError, check_branch, check_states};

/// Speeds and accelerations of the states, by state and actuator, in the unit of the coordinate: rad, or a fifth of the size.
pub(super) const SPEEDS: [[f64; 4]; STATES] = [
    [1.0, -0.6, 0.4, 0.3],
    [-0.8, 0.9, -0.5, 0.7],
    [0.6, 0.7, 1.1, -0.4],
    [0.0, 0.0, 0.0, 0.0],
];
const ACCELERATIONS: [[f64; 4]; STATES] = [
    [0.7, 0.5, -0.9, 0.2],
    [0.5, -1.1, 0.6, -0.3],
    [-1.2, 0.8, 0.7, 0.5],
    [0.4, 0.3, -0.2, 0.6],
];
/// Steps of the coordinates from the assembly, in these units, where there are several.
const STEPS: [[f64; 4]; STATES] = [
    [0.0, 0.0, 0.0, 0.0],
    [0.1, -0.15, 0.1, 0.2],
    [-0.15, 0.2, -0.05, 0.1],
    [0.2, 0.35, 0.15, -0.1],
];
/// States in which forces are prescribed; as many follow in which nothing acts but the loads.
pub(super) const STATES: usize = 4;
/// A coordinate that is a length, in parts of the size.
const LENGTH_UNIT: f64 = 0.2;

/// The numbers of a row in the units of the coordinates.
pub(super) fn in_units(model: &Model, row: &[f64; 4]) -> Vec<f64> {
    let unit = |k: usize| match model.plan().is_angle(k) {
        true => 1.0,
        false => LENGTH_UNIT * model.plan().size(),
    };
    let row = row.iter().cycle().take(model.plan().actuators());
    row.enumerate().map(|(k, v)| v * unit(k)).collect()
}

/// Coordinates near the assembly, where there are several.
pub(super) fn near_assembly(scene: &SpaceScene, model: &Model) -> Vec<Vec<f64>> {
    let near = |steps: &[f64; 4]| {
        let all = scene.assembly.q.iter().zip(in_units(model, steps));
        all.map(|(q, step)| q + step).collect()
    };
    STEPS.iter().map(near).collect()
}

/// A machine of the scene whose coordinates are all free, under its loads alone.
pub(super) fn free_machine(scene: &SpaceScene) -> Result<Option<Machine<Model>>, StudyError> {
    let model = model_with_loads(scene, &[])?;
    let modes = vec![CoordinateMode::Free; model.plan().actuators()];
    Ok(Machine::new(model, &scene.loads, modes, &[]).ok())
}

/// The accelerations of a machine without actuators' actions.
pub(super) fn free_accelerations(
    machine: &Machine<Model>,
    t: f64,
    [q, q_dot]: [&[f64]; 2],
) -> Option<Vec<f64>> {
    let y = machine.initial_state(q, q_dot);
    let mut workspace = machine.workspace();
    let state = machine.evaluate(t, &y, &mut workspace).ok()?;
    Some(state.q_ddot().to_vec())
}

/// So many states are checked by kinetic energy alone, which takes some twenty closings a row of the constraints.
const BY_ENERGIES: usize = 4;

/// The findings of states at these coordinates: at prescribed accelerations, and in free motion.
pub(super) fn state_findings(
    claims: &SpaceClaims<'_>,
    positions: &[Vec<f64>],
) -> Result<Vec<Finding>, ValidationError> {
    let machine = free_machine(claims.scene())?;
    let mut states: Vec<ClaimedState> = Vec::new();
    let mut refusals: Vec<SubjectError> = Vec::new();
    for (k, q) in positions.iter().enumerate() {
        let axes = [Axes::Ground, Axes::Joint][k % 2];
        let of = |rows: &[[f64; 4]; STATES]| in_units(claims.model(), &rows[k % STATES]);
        let (q_dot, q_ddot) = (of(&SPEEDS), of(&ACCELERATIONS));
        let t = 0.1 * k as f64;
        let mut add = |state: Result<ClaimedState, SubjectError>| match state {
            Ok(state) => states.push(state),
            Err(error) => refusals.push(error),
        };
        add(claims.state::<f64>(t, [q, &q_dot, &q_ddot], axes));
        // Each load alone, at rest.
        let loads = 0..claims.unit_loads().len();
        loads.for_each(|load| add(claims.load_response::<f64>(q, load, axes)));
        let machine = machine.as_ref();
        if let Some(free) = machine.and_then(|m| free_accelerations(m, t, [q, &q_dot])) {
            // Nothing acts but the loads: that is what its accelerations claim.
            let state = claims.state::<f64>(t, [q, &q_dot, &free], axes);
            add(state.map(|state| ClaimedState {
                tau: vec![0.0; q.len()],
                ..state
            }));
        }
    }
    let mut findings = check_states(&claims.assembled(), &states, BY_ENERGIES);
    findings.push(check_branch(&claims.assembled(), &states));
    if let Some(refusal) = refusals.first() {
        for finding in &mut findings {
            (finding.pass, finding.worst_at) = (false, refusal.to_string());
        }
    }
    Ok(findings)
}
