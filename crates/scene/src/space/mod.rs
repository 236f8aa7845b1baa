//! The parts of scenes that exist only in space, where points have three numbers.

mod actuators;
mod assembly;
mod bodies;
mod friction;
mod joints;
mod loads;
mod reactions;
mod sections;
mod values;
