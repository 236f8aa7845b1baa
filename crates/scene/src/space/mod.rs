//! What is written in scenes in space alone, whose points have three numbers.

mod actuators;
mod assembly;
mod bodies;
mod friction;
mod joints;
mod loads;
mod reactions;
mod sections;
mod values;
