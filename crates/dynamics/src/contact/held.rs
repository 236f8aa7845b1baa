//! The forces of all contacts at given modes.
//!
//! Surfaces that slide, or are at their limit, have the force of eq. (1) of the friction solver with φ = ±µ or ±µₛ. Those
//! that hold keep their acceleration at zero:
//!
//! ```text
//! F_j = −(w_j/√D_jj) Σ_k t_jk η_k,    W_j = Σ_k t_jk W_k,    a_k = 0          k independent contacts that hold    (1)
//! w_j = µₛ g_j(R)
//! ```
//!
//! With as many independent contacts as hold, this is their force, whatever the weights w. With more, as where every pin of
//! a four-bar holds, statics does not decide which of them holds how much: (1) gives each the same share of its limit
//! where one coordinate is held, and shares in proportion to the speeds they would have where several are. So they reach
//! their limits together. The motion does not depend on it while they hold.

use super::mode::sign;
use super::{Contact, ContactMode, ContactWorkspace};
use crate::error::Result;
use dwell_kinetostatics::{ForceState, FrictionState, InverseDynamics, MachineModel};
use dwell_numerics::{Scalar, lu};

/// A contact whose row is that of others to this part of it, squared, is not independent of them.
const INDEPENDENT: f64 = 1e-11;
/// Rounds in which the weights and the forces are made to agree, the change with which they do, and rounds after which
/// only half of each change is made.
const MAX_ROUNDS: usize = 80;
const AGREED: f64 = 4.0 * f64::EPSILON;
const DAMPED: usize = 20;
/// The weight of contacts that nothing presses together, where no others can hold, as a part of the largest.
const SMALL_WEIGHT: f64 = 1e-9;

/// The state without the loads that depend on reactions: the reactions, and what a unit of each of these loads adds to
/// them, with the accelerations it causes.
pub(crate) struct Unloaded<'r, T> {
    pub(crate) reactions: &'r [T],
    pub(crate) responses: &'r [InverseDynamics<T>],
}

/// Contacts that hold, with the independent ones among them.
pub(super) struct HeldContacts<T> {
    /// The contacts that hold, by their indices.
    held: Vec<usize>,
    /// The independent ones.
    basis: Vec<usize>,
    /// By contact that holds: its row as a sum of theirs, t.
    coefficients: Vec<Vec<T>>,
}

/// Finds the modes that are open, and solves for all forces: they become the magnitudes of their loads.
///
/// # Errors
/// [`KinetostaticsError::SelfLocking`](dwell_kinetostatics::KinetostaticsError::SelfLocking) where surfaces that slide have
/// no unique force, [`DynamicsError::NoContactMode`](crate::DynamicsError::NoContactMode) where no mode agrees with the forces.
pub(crate) fn solve_contacts<T: Scalar, M: MachineModel>(
    contacts: &[Contact<M::CoordinateFunction>],
    state: &mut ForceState<'_, T, M>,
    workspace: &mut ContactWorkspace<T>,
    unloaded: &Unloaded<'_, T>,
    accelerations: (&[T], &[Vec<T>]),
    freedoms: usize,
) -> Result<()> {
    workspace.collect(contacts, state, accelerations);
    for (mode, speed) in workspace.modes.iter_mut().zip(&workspace.speeds) {
        if *mode == ContactMode::Undecided {
            *mode = match *speed == 0.0 {
                true => ContactMode::AtRest { at_limit: false },
                false => ContactMode::Slides {
                    forward: *speed > 0.0,
                },
            };
        }
    }
    let is_open = |mode: &ContactMode| matches!(mode, ContactMode::AtRest { .. });
    let held = match workspace.modes.iter().any(is_open) {
        true => super::search::find_modes(contacts, state, workspace, unloaded)?,
        false => solve_at_modes(contacts, state, workspace, unloaded)?,
    };
    // Nothing that could accelerate is free of them.
    let at_rest = |&i: &usize| workspace.convective[i].value() == 0.0;
    workspace.nothing_moves = held.basis.len() == freedoms && held.basis.iter().all(at_rest);
    Ok(())
}

/// Solves for the forces at the modes of the workspace.
pub(super) fn solve_at_modes<T: Scalar, M: MachineModel>(
    contacts: &[Contact<M::CoordinateFunction>],
    state: &mut ForceState<'_, T, M>,
    workspace: &mut ContactWorkspace<T>,
    unloaded: &Unloaded<'_, T>,
) -> Result<HeldContacts<T>> {
    let loads = workspace.forces.len();
    let known = |j: usize| {
        let i = contacts.iter().position(|contact| contact.dependent == j);
        let Some(i) = i else {
            return FrictionState::BySpeed;
        };
        match workspace.modes[i] {
            ContactMode::Slides { forward } => {
                FrictionState::Factor(contacts[i].coefficient * sign(forward))
            }
            ContactMode::AtLimit { forward } => {
                FrictionState::Factor(contacts[i].static_coefficient * sign(forward))
            }
            ContactMode::Holds | ContactMode::Undecided | ContactMode::AtRest { .. } => {
                FrictionState::Force(T::from_f64(0.0))
            }
        }
    };
    state.set_friction_states((0..loads).map(known));
    let held = HeldContacts::of(contacts, workspace);
    workspace.shares.fill(0.0);
    if held.held.is_empty() {
        state.solve_friction(unloaded.reactions, unloaded.responses)?;
        read_forces(state, workspace);
        return Ok(held);
    }
    hold(contacts, state, workspace, unloaded, &held)?;
    for &i in &held.held {
        let contact = &contacts[i];
        let force = workspace.forces[contact.dependent].value().abs();
        let press = state.contact_force(contact.dependent, &workspace.reactions);
        let limit = contact.static_coefficient * press.value();
        // Where nothing presses, nothing is held but what needs no force.
        workspace.shares[i] = if force == 0.0 { 0.0 } else { force / limit };
    }
    Ok(held)
}

/// The magnitudes of the loads that depend on reactions, as their forces.
fn read_forces<T: Scalar, M: MachineModel>(
    state: &ForceState<'_, T, M>,
    workspace: &mut ContactWorkspace<T>,
) {
    for (force, load) in workspace.forces.iter_mut().zip(state.frictions()) {
        *force = state.magnitudes()[load];
    }
}

/// Solves for the forces of contacts that hold, with those of all others.
// Long because it is one loop: the weights of those that hold depend on the reactions under all forces.
fn hold<T: Scalar, M: MachineModel>(
    contacts: &[Contact<M::CoordinateFunction>],
    state: &mut ForceState<'_, T, M>,
    workspace: &mut ContactWorkspace<T>,
    unloaded: &Unloaded<'_, T>,
    held: &HeldContacts<T>,
) -> Result<()> {
    let zero = T::from_f64(0.0);
    let count = workspace.forces.len();
    let is_held = |j: &usize| held.held.iter().any(|&i| contacts[i].dependent == *j);
    let others: Vec<usize> = (0..count).filter(|j| !is_held(j)).collect();
    let mut weights: Vec<T> = held.weights(
        contacts,
        |contact| T::from_f64(contact.static_coefficient.max(f64::MIN_POSITIVE)),
        workspace,
    );
    let mut last = f64::INFINITY;
    for round in 0..MAX_ROUNDS {
        let system = HoldingSystem::new(contacts, workspace, held, &weights);
        // What the others see: the mechanism with the contacts that hold.
        let at_zero: Vec<T> = held.basis.iter().map(|&i| workspace.free[i]).collect();
        let own = system.forces(at_zero);
        let mut by_other: Vec<Vec<T>> = Vec::with_capacity(others.len());
        for &j in &others {
            let column = held.basis.iter().map(|&i| workspace.compliance[i][j]);
            by_other.push(system.forces(column.collect()));
        }
        workspace.held_reactions.copy_from_slice(unloaded.reactions);
        let add = |reactions: &mut [T], forces: &[T]| {
            for (&i, force) in held.held.iter().zip(forces) {
                let response = &unloaded.responses[contacts[i].dependent].reactions;
                for (sum, one) in reactions.iter_mut().zip(response) {
                    *sum += *one * *force;
                }
            }
        };
        add(&mut workspace.held_reactions, &own);
        workspace.forces.fill(zero);
        if !others.is_empty() {
            for (&j, forces) in others.iter().zip(&by_other) {
                let response = &mut workspace.held_responses[j];
                response.clone_from(&unloaded.responses[j]);
                add(&mut response.reactions, forces);
            }
            state.solve_friction(&workspace.held_reactions, &workspace.held_responses)?;
            read_forces(state, workspace);
        }
        for (h, &i) in held.held.iter().enumerate() {
            let from_others = others.iter().zip(&by_other);
            workspace.forces[contacts[i].dependent] = from_others
                .fold(own[h], |sum, (&j, forces)| {
                    sum + forces[h] * workspace.forces[j]
                });
        }
        workspace.reactions.copy_from_slice(unloaded.reactions);
        for (force, response) in workspace.forces.iter().zip(unloaded.responses) {
            for (sum, one) in workspace.reactions.iter_mut().zip(&response.reactions) {
                *sum += *one * *force;
            }
        }
        if held.basis.len() == held.held.len() {
            break;
        }
        let pressed = held.weights(
            contacts,
            |contact| {
                let press = state.contact_force(contact.dependent, &workspace.reactions);
                press * T::from_f64(contact.static_coefficient)
            },
            workspace,
        );
        let mut change = 0.0_f64;
        let largest = pressed.iter().fold(0.0, |max, w| w.value().max(max));
        for (weight, next) in weights.iter_mut().zip(pressed) {
            let step = next - *weight;
            change = change.max(step.value().abs() / largest);
            let part = if round < DAMPED { 1.0 } else { 0.5 };
            *weight += step * T::from_f64(part);
        }
        if change <= AGREED || (change < 1e-12 && change >= last) || !change.is_finite() {
            break;
        }
        last = change;
    }
    let forces = held
        .held
        .iter()
        .map(|&i| (contacts[i].load, workspace.forces[contacts[i].dependent]));
    Ok(state.set_magnitudes(forces)?)
}

impl<T: Scalar> HeldContacts<T> {
    /// Those whose mode is to hold.
    pub(super) fn of<F>(contacts: &[Contact<F>], workspace: &ContactWorkspace<T>) -> Self {
        let modes = workspace.modes.iter().enumerate();
        let held: Vec<usize> = modes
            .filter(|(_, mode)| **mode == ContactMode::Holds)
            .map(|(i, _)| i)
            .collect();
        let of_two = |i: usize, j: usize| workspace.compliance[i][contacts[j].dependent];
        let basis = independent(&held, |i, j| of_two(i, j).value());
        let r = basis.len();
        let mut matrix: Vec<T> = Vec::with_capacity(r * r);
        for &i in &basis {
            matrix.extend(basis.iter().map(|&k| of_two(i, k)));
        }
        let mut pivots = vec![0; r];
        lu::factor(&mut matrix, &mut pivots);
        let row = |&j: &usize| {
            let mut row: Vec<T> = basis.iter().map(|&i| of_two(i, j)).collect();
            lu::solve(&matrix, &pivots, &mut row);
            row
        };
        let coefficients = held.iter().map(row).collect();
        Self {
            coefficients,
            held,
            basis,
        }
    }

    /// By contact that holds: a weight over √D.
    fn weights<F>(
        &self,
        contacts: &[Contact<F>],
        of: impl Fn(&Contact<F>) -> T,
        workspace: &ContactWorkspace<T>,
    ) -> Vec<T> {
        let weight = |&i: &usize| {
            let own = workspace.compliance[i][contacts[i].dependent].value();
            match own > 0.0 {
                true => of(&contacts[i]) * T::from_f64(1.0 / own.sqrt()),
                false => T::from_f64(0.0),
            }
        };
        self.held.iter().map(weight).collect()
    }

    /// Whether a contact is held by those that hold, whatever its own force is.
    pub(super) fn hold_still<F>(
        &self,
        i: usize,
        contacts: &[Contact<F>],
        workspace: &ContactWorkspace<T>,
    ) -> bool {
        let mut with: Vec<usize> = self.basis.clone();
        if !with.contains(&i) {
            with.push(i);
        }
        let of_two = |i: usize, j: usize| workspace.compliance[i][contacts[j].dependent].value();
        let own = of_two(i, i);
        independent(&with, of_two).len() <= self.basis.len() && own > 0.0
    }
}

/// A largest independent set of contacts, by the Cholesky factorisation of D with the largest pivots first.
pub(crate) fn independent(of: &[usize], compliance: impl Fn(usize, usize) -> f64) -> Vec<usize> {
    let n = of.len();
    let scale: Vec<f64> = of.iter().map(|&i| compliance(i, i).sqrt()).collect();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut chosen: Vec<usize> = Vec::new();
    let mut left: Vec<f64> = scale
        .iter()
        .map(|s| f64::from(u8::from(*s > 0.0 && s.is_finite())))
        .collect();
    while chosen.len() < n {
        let best = (0..n).filter(|k| !chosen.contains(k));
        let Some(best) = best.max_by(|a, b| left[*a].total_cmp(&left[*b])) else {
            break;
        };
        if left[best] <= INDEPENDENT {
            break;
        }
        let root = left[best].sqrt();
        let column: Vec<f64> = (0..n)
            .map(|k| {
                if scale[k] <= 0.0 {
                    return 0.0;
                }
                let entry = compliance(of[k], of[best]) / (scale[k] * scale[best]);
                let known = columns.iter().map(|c: &Vec<f64>| c[k] * c[best]);
                (entry - known.sum::<f64>()) / root
            })
            .collect();
        for (left, entry) in left.iter_mut().zip(&column) {
            *left -= entry * entry;
        }
        columns.push(column);
        chosen.push(best);
    }
    chosen.into_iter().map(|k| of[k]).collect()
}

/// The linear equations (1) at some weights.
struct HoldingSystem<'h, T> {
    held: &'h HeldContacts<T>,
    weights: Vec<T>,
    matrix: Vec<T>,
    pivots: Vec<usize>,
}

impl<'h, T: Scalar> HoldingSystem<'h, T> {
    fn new<F>(
        contacts: &[Contact<F>],
        workspace: &ContactWorkspace<T>,
        held: &'h HeldContacts<T>,
        weights: &[T],
    ) -> Self {
        let r = held.basis.len();
        let mut system = Self {
            held,
            weights: weights.to_vec(),
            matrix: vec![T::from_f64(0.0); r * r],
            pivots: vec![0; r],
        };
        if !system.factor(contacts, workspace) {
            let largest = weights.iter().fold(0.0, |max, w| w.value().max(max));
            let least = if largest > 0.0 {
                SMALL_WEIGHT * largest
            } else {
                1.0
            };
            for weight in &mut system.weights {
                if weight.value() < least {
                    *weight = T::from_f64(least);
                }
            }
            system.factor(contacts, workspace);
        }
        system
    }

    /// Composes and factors the matrix; whether it is regular.
    fn factor<F>(&mut self, contacts: &[Contact<F>], workspace: &ContactWorkspace<T>) -> bool {
        let r = self.held.basis.len();
        self.matrix.fill(T::from_f64(0.0));
        for (h, &j) in self.held.held.iter().enumerate() {
            for (row, &i) in self.held.basis.iter().enumerate() {
                let entry = workspace.compliance[i][contacts[j].dependent] * self.weights[h];
                for (k, t) in self.held.coefficients[h].iter().enumerate() {
                    self.matrix[row * r + k] += entry * *t;
                }
            }
        }
        let factored = lu::factor(&mut self.matrix, &mut self.pivots);
        r == 0 || (factored.determinant_sign != 0.0 && factored.pivot_ratio > f64::EPSILON)
    }

    /// By contact that holds: the force that takes these accelerations off.
    fn forces(&self, mut accelerations: Vec<T>) -> Vec<T> {
        lu::solve(&self.matrix, &self.pivots, &mut accelerations);
        let each = self.held.coefficients.iter().zip(&self.weights);
        let force = |(row, weight): (&Vec<T>, &T)| {
            let terms = row.iter().zip(&accelerations);
            let sum = terms.fold(T::from_f64(0.0), |sum, (t, eta)| sum + *t * *eta);
            -(*weight * sum)
        };
        each.map(force).collect()
    }
}
