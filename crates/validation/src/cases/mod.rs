//! A case as it is read: its scene in the positions to be checked, and the published numbers beside it.

pub(crate) mod model_states;
pub(crate) mod reference;
pub(crate) mod state_quantity;
pub(crate) mod subject;
