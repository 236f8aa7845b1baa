//! Surfaces that stick and slide: dry friction in the joints of a machine.
//!
//! A friction without regularisation speed slides with its coefficient µ, against the direction in which it moves, or it sticks: its force
//! keeps its surfaces at rest, up to µₛ times the normal force. Its [mode](ContactMode) says which. The mode is a part of the machine's
//! state. It is constant in the right-hand side, and changes only between two integrations: when surfaces come to rest, or when the force
//! of sticking surfaces reaches its limit.
//!
//! End stops limit a coordinate: one that meets its stop rebounds, or rests on it until a force lifts it off (`stop`).
//!
//! `mode` names the modes, `relations` collects the effect of a unit of each force, `held` solves for the forces at given modes (with the
//! contacts that are `independent`), and `search` finds the modes of surfaces at rest. Their events are in `contact_events`.

mod held;
mod independent;
mod mode;
mod relations;
mod search;
mod stop;

pub(crate) use held::ContactProblem;
pub(crate) use independent::independent;
pub use mode::{ContactEvent, ContactMode, ContactStep, StopChange};
pub(crate) use relations::ContactWorkspace;
pub use stop::{EndStop, YieldingStop};
pub(crate) use stop::{Stop, one_sided};

use dwell_geometry::body_states::CoordinateFunction;
use dwell_kinetostatics::MachineModel;

/// A friction that holds at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Contact<F = CoordinateFunction> {
    /// Its index among the loads of the model that depend on reactions.
    pub(crate) dependent: usize,
    /// Its index among all loads.
    pub(crate) load: usize,
    /// Coefficient of sliding surfaces.
    pub(crate) coefficient: f64,
    /// Coefficient of surfaces at rest.
    pub(crate) static_coefficient: f64,
    /// The coordinate whose speed is that of the surfaces.
    pub(crate) coordinate: F,
}

impl<F> Contact<F> {
    /// The frictions of a model.
    pub(crate) fn of_model<M: MachineModel<CoordinateFunction = F>>(model: &M) -> Vec<Self> {
        let each = model.frictions().enumerate();
        let sticking = each.filter_map(|(dependent, load)| {
            let (friction, coordinate) = model.sticking_friction(dependent)?;
            Some(Self {
                dependent,
                load,
                coefficient: friction.coefficient,
                static_coefficient: friction.static_coefficient,
                coordinate,
            })
        });
        sticking.collect()
    }
}
