//! The forces of all contacts at given modes.
//!
//! Surfaces that slide, or are at their limit, have the force of eq. (1) of the friction solver with φ = ±µ or ±µₛ. The
//! acceleration of sticking surfaces is zero:
//!
//! ```text
//! F_j = −(w_j/√D_jj) Σ_k t_jk η_k,    W_j = Σ_k t_jk W_k,    a_k = 0          k independent contacts that hold    (1)
//! w_j = µₛ g_j(R)
//! ```
//!
//! If the sticking contacts are independent, this determines their forces for any weights w. If they are not, as when every
//! pin of a four-bar sticks, statics does not determine the single forces. Then (1) gives each contact the same share of
//! its limit if one coordinate is held, and shares in proportion to the speeds that they would have if several are.
//! Therefore they reach their limits together. The motion does not depend on the shares while they stick.

use super::independent::{IndependentSet, independent};
use super::mode::sign;
use super::{Contact, ContactMode, ContactWorkspace};
use crate::error::Result;
use dwell_kinetostatics::{ForceState, FrictionState, InverseDynamics, MachineModel};
use dwell_numerics::{Scalar, lu};

/// Rounds in which the weights and the forces are made to agree, the change with which they do, and rounds after which
/// only half of each change is made.
const MAX_ROUNDS: usize = 80;
const AGREED: f64 = 4.0 * f64::EPSILON;
const DAMPED: usize = 20;
/// The weight of contacts without a normal force, relative to the largest weight, if no other contacts can stick.
const SMALL_WEIGHT: f64 = 1e-9;

/// The contacts of a machine at a state.
pub(crate) struct ContactProblem<'p, 's, T: Scalar, M: MachineModel> {
    pub(crate) contacts: &'p [Contact<M::CoordinateFunction>],
    pub(crate) state: &'p mut ForceState<'s, T, M>,
    pub(crate) workspace: &'p mut ContactWorkspace<T>,
    /// The reactions without the loads that depend on reactions, and the contribution of a unit of each of these loads
    /// to them.
    pub(crate) unloaded: &'p [T],
    pub(crate) responses: &'p [InverseDynamics<T>],
}

/// Contacts that hold, with the independent ones among them, and the working memory of their equations.
#[derive(Debug, Clone, Default)]
pub(super) struct HeldContacts<T> {
    /// The contacts that hold, by their indices.
    held: Vec<usize>,
    /// The independent ones.
    basis: Vec<usize>,
    /// By contact that holds: its row as a sum of theirs, t.
    coefficients: Vec<T>,
    independent: IndependentSet,
    /// By contact that holds: w/√D, and the same at the next round.
    weights: Vec<T>,
    next_weights: Vec<T>,
    /// The equations (1) at some weights, none of which is too small.
    equations: HoldingEquations<T>,
    /// The loads that depend on reactions and do not hold.
    others: Vec<usize>,
    /// By sticking contact: its force without the others, and the contribution of a unit of each of them.
    own: Vec<T>,
    by_other: Vec<T>,
}

impl<T: Scalar, M: MachineModel> ContactProblem<'_, '_, T, M> {
    /// Finds the modes that are open, and solves for all forces: they become the magnitudes of their loads. The accelerations of the
    /// coordinates are `frictionless` without the loads that depend on reactions; `by_load` is what a unit of each load adds.
    ///
    /// # Errors
    /// [`KinetostaticsError::SelfLocking`](dwell_kinetostatics::KinetostaticsError::SelfLocking) where surfaces that slide have
    /// no unique force, [`DynamicsError::NoContactMode`](crate::DynamicsError::NoContactMode) where no mode agrees with the forces.
    pub(crate) fn solve(
        &mut self,
        frictionless: &[T],
        by_load: &[Vec<T>],
        freedoms: usize,
    ) -> Result<()> {
        let workspace = &mut *self.workspace;
        workspace.collect(self.contacts, self.state, frictionless, by_load);
        for (mode, speed) in workspace.modes.iter_mut().zip(&workspace.speeds) {
            if *mode == ContactMode::Undecided {
                *mode = if *speed == 0.0 {
                    ContactMode::AtRest { at_limit: false }
                } else {
                    ContactMode::Slides {
                        forward: *speed > 0.0,
                    }
                };
            }
        }
        let is_open = |mode: &ContactMode| matches!(mode, ContactMode::AtRest { .. });
        let mut held = std::mem::take(&mut workspace.held);
        let solved = if workspace.modes.iter().any(is_open) {
            self.find_modes(&mut held)
        } else {
            self.solve_at_modes(&mut held)
        };
        let workspace = &mut *self.workspace;
        // Nothing that could accelerate is free of them.
        let at_rest = |&i: &usize| workspace.convective[i].value() == 0.0;
        workspace.nothing_moves = held.basis.len() == freedoms && held.basis.iter().all(at_rest);
        workspace.held = held;
        solved
    }

    /// Solves for the forces at the modes of the workspace.
    pub(super) fn solve_at_modes(&mut self, held: &mut HeldContacts<T>) -> Result<()> {
        let (contacts, workspace) = (self.contacts, &mut *self.workspace);
        let known = |j: usize| {
            let i = contacts.iter().position(|contact| contact.dependent == j);
            let Some(i) = i else {
                return FrictionState::BySpeed;
            };
            let contact = &contacts[i];
            match workspace.modes[i] {
                ContactMode::Slides { forward } => {
                    FrictionState::Factor(contact.coefficient * sign(forward))
                }
                ContactMode::AtLimit { forward } => {
                    FrictionState::Factor(contact.static_coefficient * sign(forward))
                }
                ContactMode::Holds | ContactMode::Undecided | ContactMode::AtRest { .. } => {
                    FrictionState::Force(T::from_f64(0.0))
                }
            }
        };
        let loads = 0..workspace.forces.len();
        self.state.set_friction_states(loads.map(known));
        held.find(workspace);
        workspace.shares.fill(0.0);
        if held.held.is_empty() {
            self.state.solve_friction(self.unloaded, self.responses)?;
            self.read_forces();
            return Ok(());
        }
        self.hold(held)?;
        let workspace = &mut *self.workspace;
        for &i in &held.held {
            let contact = &contacts[i];
            let force = workspace.forces[contact.dependent].value().abs();
            let reactions = &workspace.reactions;
            let press = self.state.contact_force(contact.dependent, reactions);
            let limit = contact.static_coefficient * press.value();
            // Where nothing presses, nothing is held but what needs no force.
            workspace.shares[i] = if force == 0.0 { 0.0 } else { force / limit };
        }
        Ok(())
    }

    /// The magnitudes of the loads that depend on reactions, as their forces.
    fn read_forces(&mut self) {
        let forces = self.workspace.forces.iter_mut();
        for (force, load) in forces.zip(self.state.frictions()) {
            *force = self.state.magnitudes()[load];
        }
    }

    /// Solves for the forces of the sticking contacts together with those of all others.
    // Long because it is one loop: the weights of those that hold depend on the reactions under all forces.
    fn hold(&mut self, of: &mut HeldContacts<T>) -> Result<()> {
        let (contacts, responses) = (self.contacts, self.responses);
        let count = self.workspace.forces.len();
        let HeldContacts { held, others, .. } = &mut *of;
        let is_held = |j: &usize| held.iter().any(|&i| contacts[i].dependent == *j);
        others.clear();
        others.extend((0..count).filter(|j| !is_held(j)));
        let limit = |i: usize| contacts[i].static_coefficient.max(f64::MIN_POSITIVE);
        of.set_next_weights(|i| T::from_f64(limit(i)), self.workspace);
        std::mem::swap(&mut of.weights, &mut of.next_weights);
        let mut last = f64::INFINITY;
        for round in 0..MAX_ROUNDS {
            let workspace = &mut *self.workspace;
            of.solve_for_others(workspace);
            workspace.held_reactions.copy_from_slice(self.unloaded);
            let add = |reactions: &mut [T], forces: &[T]| {
                for (&i, force) in of.held.iter().zip(forces) {
                    let response = &responses[contacts[i].dependent].reactions;
                    for (sum, one) in reactions.iter_mut().zip(response) {
                        *sum += *one * *force;
                    }
                }
            };
            add(&mut workspace.held_reactions, &of.own);
            workspace.forces.fill(T::from_f64(0.0));
            if !of.others.is_empty() {
                let each = of.by_other.chunks_exact(of.held.len());
                for (&j, forces) in of.others.iter().zip(each) {
                    let response = &mut workspace.held_responses[j];
                    response.tau.copy_from_slice(&responses[j].tau);
                    response.reactions.copy_from_slice(&responses[j].reactions);
                    add(&mut response.reactions, forces);
                }
                let (reactions, responses) = (&workspace.held_reactions, &workspace.held_responses);
                self.state.solve_friction(reactions, responses)?;
                self.read_forces();
            }
            let workspace = &mut *self.workspace;
            for (h, &i) in of.held.iter().enumerate() {
                let each = of.by_other.chunks_exact(of.held.len());
                let from_others = of.others.iter().zip(each);
                let force = from_others.fold(of.own[h], |sum, (&j, forces)| {
                    sum + forces[h] * workspace.forces[j]
                });
                workspace.forces[contacts[i].dependent] = force;
            }
            workspace.reactions.copy_from_slice(self.unloaded);
            for (force, response) in workspace.forces.iter().zip(responses) {
                for (sum, one) in workspace.reactions.iter_mut().zip(&response.reactions) {
                    *sum += *one * *force;
                }
            }
            if of.basis.len() == of.held.len() {
                break;
            }
            let press = |i: usize| {
                let (j, reactions) = (contacts[i].dependent, &workspace.reactions);
                let press = self.state.contact_force(j, reactions);
                press * T::from_f64(contacts[i].static_coefficient)
            };
            of.set_next_weights(press, workspace);
            let change = of.approach_next_weights(if round < DAMPED { 1.0 } else { 0.5 });
            if change <= AGREED || (change < 1e-12 && change >= last) || !change.is_finite() {
                break;
            }
            last = change;
        }
        let forces = &self.workspace.forces;
        let force = |&i: &usize| (contacts[i].load, forces[contacts[i].dependent]);
        Ok(self.state.set_magnitudes(of.held.iter().map(force))?)
    }
}

impl<T: Scalar> HeldContacts<T> {
    /// Finds those whose mode is to hold, and the independent ones among them.
    pub(super) fn find(&mut self, workspace: &ContactWorkspace<T>) {
        let modes = workspace.modes.iter().enumerate();
        self.held.clear();
        let holds = modes.filter(|(_, mode)| **mode == ContactMode::Holds);
        self.held.extend(holds.map(|(i, _)| i));
        let of_two = |i: usize, j: usize| workspace.of_two(i, j);
        let found = self
            .independent
            .find(&self.held, |i, j| of_two(i, j).value());
        self.basis.clear();
        self.basis.extend(found);
        let (basis, HoldingEquations { matrix, pivots, .. }) = (&self.basis, &mut self.equations);
        matrix.clear();
        for &i in basis {
            matrix.extend(basis.iter().map(|&k| of_two(i, k)));
        }
        pivots.clear();
        pivots.resize(basis.len(), 0);
        lu::factor(matrix, pivots);
        self.coefficients.clear();
        for &j in &self.held {
            let first = self.coefficients.len();
            self.coefficients
                .extend(basis.iter().map(|&i| of_two(i, j)));
            lu::solve(matrix, pivots, &mut self.coefficients[first..]);
        }
    }

    /// Sets the next weight over √D of each contact that holds.
    fn set_next_weights(&mut self, of: impl Fn(usize) -> T, workspace: &ContactWorkspace<T>) {
        let weight = |&i: &usize| {
            let own = workspace.of_two(i, i).value();
            if own > 0.0 {
                of(i) * T::from_f64(1.0 / own.sqrt())
            } else {
                T::from_f64(0.0)
            }
        };
        self.next_weights.clear();
        self.next_weights.extend(self.held.iter().map(weight));
    }

    /// Goes a part of the way to the next weights; the largest change, as a part of the largest weight.
    fn approach_next_weights(&mut self, part: f64) -> f64 {
        let values = self.next_weights.iter().map(|w| w.value());
        let largest = values.fold(0.0, f64::max);
        let mut change = 0.0_f64;
        for (weight, next) in self.weights.iter_mut().zip(&self.next_weights) {
            let step = *next - *weight;
            change = change.max(step.value().abs() / largest);
            *weight += step * T::from_f64(part);
        }
        change
    }

    /// The forces of the sticking contacts, without the others and for a unit of each of them.
    fn solve_for_others(&mut self, workspace: &ContactWorkspace<T>) {
        let Self {
            held,
            basis,
            coefficients,
            weights,
            equations,
            others,
            own,
            by_other,
            ..
        } = self;
        let rows = HeldRows {
            held,
            basis,
            coefficients,
        };
        equations.compose(workspace, rows, weights);
        own.clear();
        by_other.clear();
        equations.add_forces(rows, |i| workspace.free[i], own);
        for &j in others.iter() {
            equations.add_forces(rows, |i| workspace.compliance[i][j], by_other);
        }
    }

    /// Whether the sticking contacts hold this contact at rest, independent of its own force.
    pub(super) fn hold_still(&self, i: usize, workspace: &ContactWorkspace<T>) -> bool {
        let mut with: Vec<usize> = self.basis.clone();
        if !with.contains(&i) {
            with.push(i);
        }
        let of_two = |i: usize, j: usize| workspace.of_two(i, j).value();
        independent(&with, of_two).len() <= self.basis.len() && of_two(i, i) > 0.0
    }
}

/// The linear equations (1) at some weights.
#[derive(Debug, Clone, Default)]
struct HoldingEquations<T> {
    weights: Vec<T>,
    matrix: Vec<T>,
    pivots: Vec<usize>,
    right_hand_side: Vec<T>,
}

/// The contacts that hold, the independent ones (`basis`), and the rows of the first as sums of those of the others.
#[derive(Clone, Copy)]
struct HeldRows<'h, T> {
    held: &'h [usize],
    basis: &'h [usize],
    coefficients: &'h [T],
}

impl<T: Scalar> HoldingEquations<T> {
    /// Composes and factors them; where they are singular, no weight is far below the largest.
    fn compose(&mut self, workspace: &ContactWorkspace<T>, rows: HeldRows<'_, T>, weights: &[T]) {
        self.weights.clear();
        self.weights.extend_from_slice(weights);
        if self.factor(workspace, rows) {
            return;
        }
        let largest = weights.iter().fold(0.0, |max, w| w.value().max(max));
        let least = if largest > 0.0 {
            SMALL_WEIGHT * largest
        } else {
            1.0
        };
        for weight in &mut self.weights {
            if weight.value() < least {
                *weight = T::from_f64(least);
            }
        }
        self.factor(workspace, rows);
    }

    /// Composes and factors the matrix; whether it is regular.
    fn factor(&mut self, workspace: &ContactWorkspace<T>, rows: HeldRows<'_, T>) -> bool {
        let r = rows.basis.len();
        self.matrix.clear();
        self.matrix.resize(r * r, T::from_f64(0.0));
        self.pivots.clear();
        self.pivots.resize(r, 0);
        for (h, &j) in rows.held.iter().enumerate() {
            for (row, &i) in rows.basis.iter().enumerate() {
                let entry = workspace.of_two(i, j) * self.weights[h];
                for (k, t) in rows.coefficients[h * r..(h + 1) * r].iter().enumerate() {
                    self.matrix[row * r + k] += entry * *t;
                }
            }
        }
        let factored = lu::factor(&mut self.matrix, &mut self.pivots);
        r == 0 || (factored.determinant_sign != 0.0 && factored.pivot_ratio > f64::EPSILON)
    }

    /// Adds to a list, by contact that holds, the force that takes these accelerations off.
    fn add_forces(
        &mut self,
        rows: HeldRows<'_, T>,
        acceleration: impl Fn(usize) -> T,
        to: &mut Vec<T>,
    ) {
        let r = rows.basis.len();
        let solution = &mut self.right_hand_side;
        solution.clear();
        solution.extend(rows.basis.iter().map(|&i| acceleration(i)));
        lu::solve(&self.matrix, &self.pivots, solution);
        for (h, weight) in self.weights[..rows.held.len()].iter().enumerate() {
            let terms = rows.coefficients[h * r..(h + 1) * r].iter().zip(&*solution);
            let sum = terms.fold(T::from_f64(0.0), |sum, (t, eta)| sum + *t * *eta);
            to.push(-(*weight * sum));
        }
    }
}
