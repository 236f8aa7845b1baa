//! The modes of surfaces at rest: which hold, and which begin to slide, and to which side.
//!
//! All are tried as holding first. The one that is farthest beyond its limit lets go, to the side to which it is pushed,
//! and the others are tried again without it; one that would then slide against its direction holds again. Surfaces
//! that others keep at rest are not moved by letting go: their force stays at its limit.

use super::held::{HeldContacts, Unloaded, solve_at_modes};
use super::mode::sign;
use super::{Contact, ContactMode, ContactWorkspace};
use crate::error::{DynamicsError, Result};
use dwell_kinetostatics::{ForceState, MachineModel};
use dwell_numerics::Scalar;

/// Trials, and those more for each contact, after which no mode is found.
const TRIALS: usize = 8;
/// How far beyond its limit, as a part of it, a force counts as within.
const LIMIT_TOLERANCE: f64 = 1e-12;
/// Contacts whose shares of their limits are the same to this part let go together.
const TOGETHER: f64 = 1.0 - 1e-6;
/// An acceleration below this part of its terms has no sign.
const ACCELERATION_TOLERANCE: f64 = 1e-9;

/// Finds the modes of contacts at rest, and solves for the forces at them.
///
/// # Errors
/// Those of [`solve_at_modes`]; [`DynamicsError::NoContactMode`] where none agree with the forces.
// Long because it is one loop: each trial decides the next.
pub(super) fn find_modes<T: Scalar, M: MachineModel>(
    contacts: &[Contact<M::CoordinateFunction>],
    state: &mut ForceState<'_, T, M>,
    workspace: &mut ContactWorkspace<T>,
    unloaded: &Unloaded<'_, T>,
    held: &mut HeldContacts<T>,
) -> Result<()> {
    let at_limit = |mode: &ContactMode| *mode == ContactMode::AtRest { at_limit: true };
    let mut let_go: Vec<usize> = (0..contacts.len())
        .filter(|&i| at_limit(&workspace.modes[i]))
        .collect();
    let is_open = |mode: &ContactMode| matches!(mode, ContactMode::AtRest { .. });
    let open: Vec<usize> = (0..contacts.len())
        .filter(|&i| is_open(&workspace.modes[i]))
        .collect();
    for &i in &open {
        workspace.modes[i] = ContactMode::Holds;
    }
    for _ in 0..TRIALS * (1 + open.len()) {
        if let Err(error) = solve_at_modes(contacts, state, workspace, unloaded, held) {
            // Surfaces that others slide past can be held by forces without bounds alone.
            let Some(i) = hardest_to_hold(&open, contacts, workspace) else {
                return Err(error);
            };
            let forward = workspace.free[i].value() > 0.0;
            workspace.modes[i] = ContactMode::Slides { forward };
            set_moving(&open, contacts, workspace);
            continue;
        }
        if let_go.is_empty() {
            let_go = beyond_their_limit(&open, held, contacts, workspace);
        }
        if !let_go.is_empty() {
            for i in let_go.drain(..) {
                let [acceleration, _] = workspace.acceleration(i);
                // It is pushed against the force that holds it; what no force moves goes where it goes.
                let force = workspace.forces[contacts[i].dependent].value();
                let push = if force == 0.0 { acceleration } else { -force };
                workspace.modes[i] = ContactMode::Slides {
                    forward: push > 0.0,
                };
            }
            set_moving(&open, contacts, workspace);
            continue;
        }
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
        set_moving(&open, contacts, workspace);
    }
    let load = open.first().map_or(0, |&i| contacts[i].load);
    Err(DynamicsError::NoContactMode { source_index: load })
}

/// The contacts that are farthest beyond their limits, or move although they are to hold; those that share a load let go
/// together.
fn beyond_their_limit<T: Scalar, F>(
    open: &[usize],
    held: &HeldContacts<T>,
    contacts: &[Contact<F>],
    workspace: &ContactWorkspace<T>,
) -> Vec<usize> {
    let holds = open
        .iter()
        .copied()
        .filter(|&i| workspace.modes[i] == ContactMode::Holds);
    let excess = |i: usize| {
        let [acceleration, terms] = workspace.acceleration(i);
        let moves = acceleration.abs() > ACCELERATION_TOLERANCE * terms
            && !held.hold_still(i, contacts, workspace);
        match moves || workspace.shares[i].is_nan() {
            // What is no number is beyond every limit.
            true => f64::INFINITY,
            false => workspace.shares[i],
        }
    };
    let all: Vec<(f64, usize)> = holds.map(|i| (excess(i), i)).collect();
    let largest = all
        .iter()
        .fold(1.0 + LIMIT_TOLERANCE, |max, (share, _)| share.max(max));
    let together = |share: f64| share > 1.0 + LIMIT_TOLERANCE && share >= TOGETHER * largest;
    let beyond = all.into_iter().filter(|(share, _)| together(*share));
    beyond.map(|(_, i)| i).collect()
}

/// Of the contacts that are to hold, the one that takes the largest force for it; none if none does.
fn hardest_to_hold<T: Scalar, F>(
    open: &[usize],
    contacts: &[Contact<F>],
    workspace: &ContactWorkspace<T>,
) -> Option<usize> {
    let holds = open
        .iter()
        .copied()
        .filter(|&i| workspace.modes[i] == ContactMode::Holds);
    let force = |i: &usize| {
        let own = workspace.compliance[*i][contacts[*i].dependent].value();
        workspace.free[*i].value().abs() / own
    };
    holds.max_by(|one, other| force(one).total_cmp(&force(other)))
}

/// Distinguishes contacts that slide from those that are at their limit while others hold them.
fn set_moving<T: Scalar, F>(
    open: &[usize],
    contacts: &[Contact<F>],
    workspace: &mut ContactWorkspace<T>,
) {
    let mut held = HeldContacts::default();
    held.find(contacts, workspace);
    for &i in open {
        if let ContactMode::Slides { forward } | ContactMode::AtLimit { forward } =
            workspace.modes[i]
        {
            workspace.modes[i] = match held.hold_still(i, contacts, workspace) {
                true => ContactMode::AtLimit { forward },
                false => ContactMode::Slides { forward },
            };
        }
    }
}
