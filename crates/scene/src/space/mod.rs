//! Scenes of mechanisms in space: those whose points have three numbers.

mod actuators;
mod any_scene;
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

pub use any_scene::AnyScene;
pub(crate) use points::{planar_only, three_numbers};
pub use scene::{SpacePathPoint, SpaceScene};
