//! Scenes of mechanisms in space: those whose points have three numbers.

mod actuators;
mod assembly;
mod bodies;
mod build;
mod joints;
mod loads;
mod requests;
mod scene;
mod values;

pub(crate) use build::three_numbers;
pub use scene::{AnyScene, NamedLoad, SpaceScene};
