//! The effect of a unit of each force on the accelerations of all surfaces:
//!
//! ```text
//! aᵢ = bᵢ + Σⱼ Dᵢⱼ Fⱼ,    Dᵢⱼ = Wᵢ M⁻¹ Wⱼᵀ,    vᵢ = Wᵢ q̇ + …,    bᵢ = Wᵢ q̈⁰ + Ẇᵢ q̇ + …
//! ```
//!
//! with F the loads that depend on reactions, a the accelerations of the surfaces and q̈⁰ those of the coordinates without
//! these loads. The omitted terms are those of prescribed coordinates.

use super::held::HeldContacts;
use super::mode::sign;
use super::{Contact, ContactMode};
use dwell_kinetostatics::{ForceState, InverseDynamics, MachineModel};
use dwell_numerics::Scalar;

/// Working memory for the contacts of a machine.
#[derive(Debug, Clone)]
pub(crate) struct ContactWorkspace<T> {
    /// By contact: its mode, found where the state left it open.
    pub(crate) modes: Vec<ContactMode>,
    /// By contact: its force relative to its limit if it sticks, otherwise zero.
    pub(crate) shares: Vec<f64>,
    /// By contact: the speed of its surfaces.
    pub(crate) speeds: Vec<f64>,
    /// By load that depends on reactions: the force along each free coordinate of a unit of it, Wⱼ.
    pub(crate) rows: Vec<Vec<T>>,
    /// By contact: b, and the part of it that is not of q̈⁰.
    pub(super) free: Vec<T>,
    pub(super) convective: Vec<T>,
    /// By contact and load: D.
    pub(super) compliance: Vec<Vec<T>>,
    /// By contact: its load.
    dependents: Vec<usize>,
    /// By load: F.
    pub(super) forces: Vec<T>,
    /// The reactions under all forces, and those with the sticking contacts.
    pub(super) reactions: Vec<T>,
    pub(super) held_reactions: Vec<T>,
    pub(super) held_responses: Vec<InverseDynamics<T>>,
    /// The contacts that hold, with their equations.
    pub(super) held: HeldContacts<T>,
    /// Whether no coordinate accelerates.
    pub(crate) nothing_moves: bool,
}

impl<T: Scalar> ContactWorkspace<T> {
    /// Memory for these contacts, for given numbers of free coordinates and loads, and for results of this size.
    pub(crate) fn new<F>(
        contacts: &[Contact<F>],
        free: usize,
        loads: usize,
        result: &InverseDynamics<T>,
    ) -> Self {
        let zero = T::from_f64(0.0);
        let n = contacts.len();
        let loads = if n == 0 { 0 } else { loads };
        Self {
            modes: vec![ContactMode::Undecided; n],
            shares: vec![0.0; n],
            speeds: vec![0.0; n],
            rows: vec![vec![zero; free]; loads],
            free: vec![zero; n],
            convective: vec![zero; n],
            compliance: vec![vec![zero; loads]; n],
            dependents: contacts.iter().map(|of| of.dependent).collect(),
            forces: vec![zero; loads],
            reactions: result.reactions.clone(),
            held_reactions: result.reactions.clone(),
            held_responses: vec![result.clone(); loads],
            held: HeldContacts::default(),
            nothing_moves: false,
        }
    }

    /// Collects them at a state, whose bodies have the accelerations of prescribed coordinates alone; `frictionless` is
    /// q̈⁰, and `by_load` what a unit of each load adds.
    pub(super) fn collect<M: MachineModel>(
        &mut self,
        contacts: &[Contact<M::CoordinateFunction>],
        state: &mut ForceState<'_, T, M>,
        frictionless: &[T],
        by_load: &[Vec<T>],
    ) {
        state.update_bodies();
        for (i, contact) in contacts.iter().enumerate() {
            let row = &self.rows[contact.dependent];
            let along = |q_ddot: &[T]| {
                let terms = row.iter().zip(q_ddot);
                terms.fold(T::from_f64(0.0), |sum, (w, q)| sum + *w * *q)
            };
            let [_, speed, convective] = state.coordinate_motion(contact.coordinate);
            self.speeds[i] = speed.value();
            self.convective[i] = convective;
            self.free[i] = convective + along(frictionless);
            for (entry, accelerations) in self.compliance[i].iter_mut().zip(by_load) {
                *entry = along(accelerations);
            }
        }
    }

    /// D of a contact and the load of another.
    pub(crate) fn of_two(&self, contact: usize, other: usize) -> T {
        self.compliance[contact][self.dependents[other]]
    }

    /// The margin of a contact to a change of its mode: the remaining speed of sliding surfaces, or the remaining fraction of
    /// the largest force of sticking surfaces.
    pub(crate) fn margin(&self, i: usize) -> f64 {
        /// Bound of a force relative to its limit, because the ratio is infinite without a normal force.
        const MAX_SHARE: f64 = 2.0;
        match self.modes[i] {
            ContactMode::Slides { forward } => sign(forward) * self.speeds[i],
            ContactMode::Holds if self.shares[i].is_nan() => 1.0 - MAX_SHARE,
            ContactMode::Holds => 1.0 - self.shares[i].min(MAX_SHARE),
            ContactMode::AtLimit { .. } | ContactMode::AtRest { .. } | ContactMode::Undecided => {
                f64::NAN
            }
        }
    }

    /// The acceleration of the surfaces of a contact, and the sum of the absolute terms.
    pub(super) fn acceleration(&self, i: usize) -> [f64; 2] {
        let first = self.free[i].value();
        let mut sums = [first, first.abs()];
        for (d, force) in self.compliance[i].iter().zip(&self.forces) {
            let term = (*d * *force).value();
            sums[0] += term;
            sums[1] += term.abs();
        }
        sums
    }
}
