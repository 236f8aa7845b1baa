//! Scenes of mechanisms in space: those whose points have three numbers.

mod actuators;
mod assembly;
mod bodies;
mod build;
mod coordinates;
mod friction;
mod joints;
mod loads;
mod points;
mod requests;
mod scene;
mod values;

pub(crate) use points::{is_in_space, planar_only, three_numbers};
pub use scene::{SpacePathPoint, SpaceScene};
