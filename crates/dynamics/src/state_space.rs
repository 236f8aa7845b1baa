//! The linearised motion of a machine about a state,
//!
//! ```text
//! δẋ = A δx + B δu,    δz = C δx + D δu                            (1)
//! x   coordinates and speeds of the free actuators, states of the drives
//! u   by drive: its applied force, voltage or reference speed
//! z   the free coordinates, their speeds, the reactions of the machine's model, the drives' actions
//! ```
//!
//! from dual numbers: exact to rounding.

use crate::eigenvalues::{eigenvalues, eigenvalues_with_errors};
use crate::error::Result;
use crate::machine::{Machine, MachineState, MachineWorkspace, MovingModel};
use dwell_numerics::{DoubleDouble, Dual, Scalar};

/// A linearised motion. Matrices are lists of rows.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// ẋ at the state itself: zero in an equilibrium.
    pub state_derivative: Vec<f64>,
    /// z at the state itself.
    pub outputs: Vec<f64>,
    /// By state, by state.
    pub a: Vec<Vec<f64>>,
    /// By state, by drive.
    pub b: Vec<Vec<f64>>,
    /// By output, by state.
    pub c: Vec<Vec<f64>>,
    /// By output, by drive.
    pub d: Vec<Vec<f64>>,
}

/// Linearises a machine about time `t` (s) and state `y`.
///
/// # Errors
/// As [`Machine::evaluate`].
pub fn linearise<M: MovingModel>(machine: &Machine<M>, t: f64, y: &[f64]) -> Result<StateSpace> {
    machine.require_smooth("its force at rest is no smooth function of the state")?;
    linearise_where_it_holds(machine, t, y)
}

/// The linearisation at a state in which sticking friction holds everything at rest.
pub(crate) fn linearise_where_it_holds<M: MovingModel>(
    machine: &Machine<M>,
    t: f64,
    y: &[f64],
) -> Result<StateSpace> {
    let (states, inputs) = (machine.drive_states().end, machine.drives());
    let mut workspace: MachineWorkspace<Dual, M> = machine.workspace();
    let mut at: Vec<Dual> = y.iter().map(|&y| Dual::from_f64(y)).collect();
    let mut rates = vec![Dual::from_f64(0.0); machine.state_count()];
    let mut state_space = StateSpace {
        state_derivative: Vec::new(),
        outputs: Vec::new(),
        a: vec![Vec::with_capacity(states); states],
        b: vec![Vec::with_capacity(inputs); states],
        c: Vec::new(),
        d: Vec::new(),
    };
    // One more column, for the values themselves: a machine may have neither states nor inputs.
    for column in 0..=states + inputs {
        let of_state = column < states;
        if of_state {
            at[column].d = 1.0;
        } else if let Some(input) = workspace.input_offsets.get_mut(column - states) {
            input.d = 1.0;
        }
        let state = machine.evaluate(t, &at, &mut workspace)?;
        state.derivative(&mut rates);
        let outputs = outputs(machine, &state);
        let plain = column == states + inputs;
        if plain {
            state_space.state_derivative = rates[..states].iter().map(|r| r.v).collect();
            state_space.outputs = outputs.iter().map(|z| z.v).collect();
            break;
        }
        let StateSpace { a, b, c, d, .. } = &mut state_space;
        c.resize(outputs.len(), Vec::new());
        d.resize(outputs.len(), Vec::new());
        let [state_rows, output_rows] = if of_state { [a, c] } else { [b, d] };
        for (row, rate) in state_rows.iter_mut().zip(&rates) {
            row.push(rate.d);
        }
        for (row, output) in output_rows.iter_mut().zip(&outputs) {
            row.push(output.d);
        }
        if of_state {
            at[column].d = 0.0;
        } else {
            workspace.input_offsets[column - states].d = 0.0;
        }
    }
    Ok(state_space)
}

/// A rate below this part of the terms that it is the sum of is zero.
const RATE_TOLERANCE: f64 = 64.0 * f64::EPSILON;
/// A rate below this multiple of its rounding counts as zero, too.
const ROUNDINGS: f64 = 8.0;

/// Whether a state about which a machine was linearised is an equilibrium: each rate is zero within the rounding of the
/// state and of the evaluation. A coordinate is known to some roundings of itself, or of 1 rad or 1 m.
///
/// # Errors
/// As [`Machine::evaluate`].
pub fn is_equilibrium<M: MovingModel>(
    machine: &Machine<M>,
    t: f64,
    y: &[f64],
    linear: &StateSpace,
) -> Result<bool> {
    let coordinates = machine.free().len();
    let size = |j: usize| state_size(y, j, coordinates);
    let mut workspace: MachineWorkspace<DoubleDouble, M> = machine.workspace();
    let at: Vec<DoubleDouble> = y.iter().map(|&y| DoubleDouble::from_f64(y)).collect();
    let mut finer = vec![DoubleDouble::from_f64(0.0); machine.state_count()];
    machine
        .evaluate(t, &at, &mut workspace)?
        .derivative(&mut finer);
    let rows = linear.state_derivative.iter().zip(&linear.a).zip(&finer);
    let is_zero = |((rate, row), finer): ((&f64, &Vec<f64>), &DoubleDouble)| {
        let terms = row.iter().enumerate().map(|(j, a)| a.abs() * size(j));
        let rounding = (DoubleDouble::from_f64(*rate) - *finer).hi.abs();
        rate.abs() <= RATE_TOLERANCE * terms.sum::<f64>() + ROUNDINGS * rounding
    };
    // A speed is exact: a coordinate that moves, however slowly, is in no equilibrium.
    let moves = y[coordinates..2 * coordinates].iter().any(|v| *v != 0.0);
    Ok(!moves && rows.skip(coordinates).all(is_zero))
}

/// The size of a state: a coordinate, of which the first are, is of the size of 1 rad or 1 m at least.
fn state_size(y: &[f64], j: usize, coordinates: usize) -> f64 {
    let least = if j < coordinates { 1.0 } else { 0.0 };
    y[j].abs().max(least)
}

/// z of a state.
fn outputs<M: MovingModel>(machine: &Machine<M>, state: &MachineState<'_, Dual, M>) -> Vec<Dual> {
    let free = machine.free();
    let coordinates = free.iter().map(|&i| state.q()[i]);
    let velocities = free.iter().map(|&i| state.q_dot()[i]);
    let reactions = state.inverse_dynamics().reactions.iter().copied();
    let drive_forces = state.drive_forces().iter().copied();
    let all = coordinates
        .chain(velocities)
        .chain(reactions)
        .chain(drive_forces);
    all.collect()
}

impl StateSpace {
    /// The eigenvalues of A, 1/s, as real and imaginary parts, the largest real part first.
    ///
    /// # Errors
    /// [`DynamicsError::NoEigenvalues`](crate::DynamicsError::NoEigenvalues).
    pub fn eigenvalues(&self) -> Result<Vec<[f64; 2]>> {
        let n = self.a.len();
        let flat: Vec<f64> = self.a.iter().flatten().copied().collect();
        eigenvalues(&flat, n)
    }
}

/// Roundings of a coordinate, and of an entry of A, that its error counts.
const STATE_ROUNDINGS: f64 = 2.0;
const ENTRY_ROUNDINGS: f64 = 4.0;
/// Signs by which neighbouring states are changed, for the errors of A.
const SIDES: [[f64; 2]; 4] = [[1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]];

/// The eigenvalues of a linearised motion, 1/s, as real and imaginary parts, the largest real part first; and the estimated
/// error of each. The state is known to `state_errors`, and to rounding: both this change of A and its other rounding are
/// included.
///
/// # Errors
/// [`DynamicsError::NoEigenvalues`](crate::DynamicsError::NoEigenvalues).
pub fn eigenvalues_about<M: MovingModel>(
    machine: &Machine<M>,
    t: f64,
    y: &[f64],
    state_errors: &[f64],
    linear: &StateSpace,
) -> Result<(Vec<[f64; 2]>, Vec<f64>)> {
    let (n, coordinates) = (linear.a.len(), machine.free().len());
    let entries = || linear.a.iter().flatten().copied();
    let mut changes = vec![0.0_f64; n * n];
    for sides in SIDES {
        let mut near = y.to_vec();
        for j in 0..n {
            let size = state_size(y, j, coordinates);
            let error = state_errors.get(j).copied().unwrap_or(0.0);
            near[j] += sides[j % 2] * error.max(STATE_ROUNDINGS * f64::EPSILON * size);
        }
        // Next to a limit position there may be no other state.
        let Ok(near) = linearise_where_it_holds(machine, t, &near) else {
            continue;
        };
        let others = near.a.iter().flatten();
        for ((change, entry), other) in changes.iter_mut().zip(entries()).zip(others) {
            *change = change.max((other - entry).abs());
        }
    }
    let errors = changes.iter().zip(entries());
    let errors = errors.map(|(change, a)| change + ENTRY_ROUNDINGS * f64::EPSILON * a.abs());
    let matrix: Vec<f64> = entries().collect();
    eigenvalues_with_errors(&matrix, &errors.collect::<Vec<_>>(), n)
}
