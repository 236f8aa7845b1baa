//! Motions of the grid, each run twice to estimate its error.

use super::mechanisms::scene;
use super::series::{CellResult, cell};
use dwell_dynamics::{
    CoordinateMode, DynamicsError, Machine, OdeState, Options, Orbit, ReducedState, Solution,
    solve, solve_reduced,
};
use dwell_kinetostatics::{Load, LoadKind, Magnitude, ReducedModel};
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_study::estimate;
use dwell_study::models::compile_model;

/// Times of a motion at which its two runs are compared, the end among them.
const COMPARED_TIMES: usize = 64;

/// The states of a motion at the same times in a run and in its second.
pub(super) struct RunPair {
    first: Vec<Vec<f64>>,
    second: Vec<Vec<f64>>,
}

impl RunPair {
    /// The final value of a function of the states, and its estimated error.
    pub(super) fn final_value(&self, of: impl Fn(&[f64]) -> f64, rounding: f64) -> (f64, f64) {
        let all = |states: &[Vec<f64>]| states.iter().map(|y| of(y)).collect::<Vec<f64>>();
        let (first, second) = (all(&self.first), all(&self.second));
        let last = first.last().copied().unwrap_or(f64::NAN);
        (last, estimate::of_motion(&first, &second, rounding))
    }

    /// Runs a motion with some options, and again with those that estimate the error.
    pub(super) fn of<E>(
        options: &Options,
        run: impl Fn(&Options) -> Result<Vec<Vec<f64>>, E>,
    ) -> Result<Self, E> {
        Ok(Self {
            first: run(options)?,
            second: run(&estimate::comparison_options(options))?,
        })
    }
}

/// The options with samples at the compared times of a motion of some duration, s.
pub(super) fn sampled(options: &Options, duration: f64) -> Options {
    Options {
        sample_interval: Some(duration / COMPARED_TIMES as f64),
        ..*options
    }
}

/// The states of a complete motion at the compared times.
fn compared_states(solution: Solution) -> Result<Vec<Vec<f64>>, DynamicsError> {
    let Solution { steps, samples, .. } = solution.completed()?;
    let mut states = samples;
    states.truncate(COMPARED_TIMES);
    states.extend(steps.last().cloned());
    Ok(states.into_iter().map(|s| s.y).collect())
}

/// A motion without loads.
pub(super) fn free_motion(
    model: &impl ReducedModel,
    start: ReducedState,
    end: f64,
    options: &Options,
) -> Result<RunPair, DynamicsError> {
    RunPair::of(&sampled(options, end - start.t), |options| {
        solve_reduced(model, start, Some(end), options, &[]).and_then(compared_states)
    })
}

/// A motion without loads in parts of equal duration, s, each of which rotates by `advance`. The angle is wrapped
/// after each part, so that it keeps its digits. The ends of the parts are compared.
pub(super) fn wrapped_free_motion(
    model: &impl ReducedModel,
    start: ReducedState,
    parts: usize,
    duration: f64,
    advance: DoubleDouble,
    options: &Options,
) -> Result<RunPair, DynamicsError> {
    RunPair::of(options, |options| {
        let mut at = start;
        let mut final_states = Vec::with_capacity(parts);
        for _ in 0..parts {
            let part = solve_reduced(model, at, Some(duration), options, &[])?.completed()?;
            if let Some(end) = part.steps.last().map(ReducedState::from) {
                let q = (DoubleDouble::from_f64(end.q) - advance).value();
                at = ReducedState { t: 0.0, q, ..end };
            }
            final_states.push(vec![at.q, at.q_dot]);
        }
        Ok(final_states)
    })
}

/// The kinetic energy of a state, J; NaN if it does not exist.
pub(super) fn kinetic_energy(model: &impl ReducedModel, y: &[f64]) -> f64 {
    let m = model.inertia(y[0], &mut model.workspace());
    m.map_or(f64::NAN, |(m, _)| 0.5 * m * y[1] * y[1])
}

/// A load of constant magnitude.
pub(super) fn load(kind: LoadKind, magnitude: f64) -> Load {
    Load {
        name: "load".into(),
        kind,
        magnitude: Magnitude::Constant(magnitude),
    }
}

/// A machine of one degree of freedom under loads.
pub(super) fn machine(text: &str, loads: &[Load]) -> Result<Machine, String> {
    let model = compile_model(&scene(text)?, &[]).map_err(|e| e.to_string())?;
    let free = vec![CoordinateMode::Free];
    Machine::new(model, loads, free, &[]).map_err(|e| e.to_string())
}

/// A motion under loads.
pub(super) fn loaded_motion(
    machine: &Machine,
    [q, q_dot]: [f64; 2],
    end: f64,
    options: &Options,
) -> Result<RunPair, DynamicsError> {
    let start = OdeState {
        t: 0.0,
        y: machine.initial_state(&[q], &[q_dot]),
    };
    RunPair::of(&sampled(options, end), |options| {
        solve(machine, machine.model(), &start, end, options, &[]).and_then(compared_states)
    })
}

/// The period by quadrature with its estimated error; `orbit` is the orbit at a multiple of the initial state.
pub(super) fn quadrature(
    orbit: impl Fn(f64) -> Result<Orbit, DynamicsError>,
    reference: DoubleDouble,
) -> CellResult {
    let exact = orbit(1.0).map_err(|e| e.to_string())?;
    let error = estimate::of_period(&exact, orbit).map_err(|e| e.to_string())?;
    cell((exact.period, error), reference)
}
