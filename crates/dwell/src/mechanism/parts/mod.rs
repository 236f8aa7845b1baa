//! The parts of a mechanism, each as the keys of a scene file.

mod actuator;
mod drive;
mod friction;
mod joint;
mod law;
mod load;
mod motion;

pub use actuator::{Actuator, Coordinate};
pub use drive::Drive;
pub use friction::Friction;
pub use joint::Joint;
pub use law::Law;
pub use load::{Load, Magnitude};
pub(crate) use load::{LoadFunction, NO_VALUE};
pub use motion::{Event, Motion};

use crate::value::Value;

/// Keys with their values, in the given order.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Keys(pub(crate) Vec<(String, Value)>);

impl Keys {
    pub(crate) fn new(key: &str, value: impl Into<Value>) -> Self {
        Self::default().with(key, value)
    }

    /// Sets another key; a key given twice keeps its last value.
    pub(crate) fn with(mut self, key: &str, value: impl Into<Value>) -> Self {
        self.0.retain(|(known, _)| known != key);
        self.0.push((key.to_owned(), value.into()));
        self
    }
}

impl From<Keys> for Value {
    fn from(keys: Keys) -> Self {
        Self::Table(keys.0)
    }
}
