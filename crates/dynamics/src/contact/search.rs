//! The modes of surfaces at rest: which hold, and which begin to slide, and to which side.
//!
//! All are tried as holding first. The one that is farthest beyond its limit lets go, to the side to which it is pushed,
//! and the others are tried again without it; one that would then slide against its direction holds again. Surfaces
//! that others keep at rest are not moved by letting go: their force stays at its limit.

use super::ContactMode;
use super::held::{ContactProblem, HeldContacts};
use super::mode::sign;
use crate::error::{DynamicsError, Result};
use dwell_kinetostatics::MachineModel;
use dwell_numerics::Scalar;

/// Trials, and those more for each contact, after which no mode is found.
const TRIALS: usize = 8;
/// A force that exceeds its limit by this fraction counts as within it.
const LIMIT_TOLERANCE: f64 = 1e-12;
/// Contacts whose shares of their limits are the same to this part let go together.
const TOGETHER: f64 = 1.0 - 1e-6;
/// An acceleration below this part of its terms has no sign.
const ACCELERATION_TOLERANCE: f64 = 1e-9;

impl<T: Scalar, M: MachineModel> ContactProblem<'_, '_, T, M> {
    /// Finds the modes of contacts at rest, and solves for the forces at them.
    ///
    /// # Errors
    /// Those of [`Self::solve_at_modes`]; [`DynamicsError::NoContactMode`] where none agree with the forces.
    // Long because it is one loop: each trial decides the next.
    pub(super) fn find_modes(&mut self, held: &mut HeldContacts<T>) -> Result<()> {
        let modes = &mut self.workspace.modes;
        let at_rest = |i: &usize| matches!(modes[*i], ContactMode::AtRest { .. });
        let open: Vec<usize> = (0..modes.len()).filter(at_rest).collect();
        let at_limit = |i: &usize| modes[*i] == ContactMode::AtRest { at_limit: true };
        let mut let_go: Vec<usize> = (0..modes.len()).filter(at_limit).collect();
        for &i in &open {
            modes[i] = ContactMode::Holds;
        }
        for _ in 0..TRIALS * (1 + open.len()) {
            if let Err(error) = self.solve_at_modes(held) {
                // Surfaces that others slide past can be held by forces without bounds alone.
                let Some(i) = self.hardest_to_hold(&open) else {
                    return Err(error);
                };
                let forward = self.workspace.free[i].value() > 0.0;
                self.workspace.modes[i] = ContactMode::Slides { forward };
                self.set_moving(&open);
                continue;
            }
            if let_go.is_empty() {
                let_go = self.beyond_their_limit(&open, held);
            }
            if !let_go.is_empty() {
                for i in let_go.drain(..) {
                    let [acceleration, _] = self.workspace.acceleration(i);
                    // It is pushed against the force that holds it; what no force moves goes where it goes.
                    let force = self.workspace.forces[self.contacts[i].dependent].value();
                    let push = if force == 0.0 { acceleration } else { -force };
                    let forward = push > 0.0;
                    self.workspace.modes[i] = ContactMode::Slides { forward };
                }
                self.set_moving(&open);
                continue;
            }
            let workspace = &mut *self.workspace;
            let returns = open.iter().copied().find(|&i| match workspace.modes[i] {
                ContactMode::Slides { forward } => {
                    let [acceleration, terms] = workspace.acceleration(i);
                    sign(forward) * acceleration < -ACCELERATION_TOLERANCE * terms
                }
                _ => false,
            });
            let Some(returns) = returns else {
                return Ok(());
            };
            workspace.modes[returns] = ContactMode::Holds;
            self.set_moving(&open);
        }
        let load = open.first().map_or(0, |&i| self.contacts[i].load);
        Err(DynamicsError::NoContactMode { source_index: load })
    }

    /// The contacts among these that are to stick.
    fn holding(&self, open: &[usize]) -> impl Iterator<Item = usize> {
        let open = open.iter().copied();
        open.filter(|&i| self.workspace.modes[i] == ContactMode::Holds)
    }

    /// The contacts that are farthest beyond their limits, or move although they are to stick. Contacts that share a load
    /// are released together.
    fn beyond_their_limit(&self, open: &[usize], held: &HeldContacts<T>) -> Vec<usize> {
        let workspace = &*self.workspace;
        let excess = |i: usize| {
            let [acceleration, terms] = workspace.acceleration(i);
            let moves = acceleration.abs() > ACCELERATION_TOLERANCE * terms
                && !held.hold_still(i, workspace);
            if moves || workspace.shares[i].is_nan() {
                // What is no number is beyond every limit.
                f64::INFINITY
            } else {
                workspace.shares[i]
            }
        };
        let all: Vec<(f64, usize)> = self.holding(open).map(|i| (excess(i), i)).collect();
        let largest = all
            .iter()
            .fold(1.0 + LIMIT_TOLERANCE, |max, (share, _)| share.max(max));
        let together = |share: f64| share > 1.0 + LIMIT_TOLERANCE && share >= TOGETHER * largest;
        let beyond = all.into_iter().filter(|(share, _)| together(*share));
        beyond.map(|(_, i)| i).collect()
    }

    /// The contact that needs the largest force to stick; `None` if none needs one.
    fn hardest_to_hold(&self, open: &[usize]) -> Option<usize> {
        let workspace = &*self.workspace;
        let force = |&i: &usize| workspace.free[i].value().abs() / workspace.of_two(i, i).value();
        let holds = self.holding(open);
        holds.max_by(|one, other| force(one).total_cmp(&force(other)))
    }

    /// Distinguishes sliding contacts from those that are at their limit while others hold them.
    fn set_moving(&mut self, open: &[usize]) {
        let workspace = &mut *self.workspace;
        let mut held = HeldContacts::default();
        held.find(workspace);
        for &i in open {
            if let ContactMode::Slides { forward } | ContactMode::AtLimit { forward } =
                workspace.modes[i]
            {
                workspace.modes[i] = if held.hold_still(i, workspace) {
                    ContactMode::AtLimit { forward }
                } else {
                    ContactMode::Slides { forward }
                };
            }
        }
    }
}
