//! Surfaces that hold and slide: dry friction in the joints of a machine.
//!
//! A friction without regularisation speed slides with its coefficient µ, against the direction in which it moves, or it
//! holds: then its force is whatever keeps its surfaces at rest, up to µₛ times the force that presses on them. Which of
//! both it does is its [mode](ContactMode), a part of the machine's state that the right-hand side keeps and that changes
//! between two integrations only: where surfaces come to rest, or where the force of those that hold reaches its limit.
//!
//! End stops limit a coordinate: one that meets its stop rebounds, or rests on it until a force lifts it off (`stop`).
//!
//! `mode` names the modes, `relations` collects what a unit of each force does, `held` solves for the forces at given
//! modes (with the contacts that are `independent`), and `search` finds the modes of surfaces at rest. Their events are in `contact_events`.

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
    /// Of surfaces that slide.
    pub(crate) coefficient: f64,
    /// Of surfaces at rest.
    pub(crate) static_coefficient: f64,
    /// The coordinate whose speed is that of the surfaces.
    pub(crate) coordinate: F,
}

impl<F> Contact<F> {
    /// Those of a model.
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
