//! Bodies, joints and actuators; the structure of a mechanism; its positions, velocities and accelerations.

mod assemble;
pub mod circle;
mod construct;
pub mod error;
pub mod frames;
pub mod groups;
mod lanes;
mod large;
mod locate;
pub mod lower;
pub mod measure;
pub mod mechanism;
pub mod mobility;
pub mod motion;
mod need;
mod place;
pub mod plan;
pub mod plane;
pub mod range;
pub mod relation;
mod rough;
pub mod rows;
pub mod scalar;
mod seeds;
pub mod small;
mod solve;
mod tall;
pub mod tree;
mod ways;
pub mod wide;

pub use error::{AssemblyError, PlaceError, StructureError};
pub use lanes::Lanes;
pub use mechanism::{
    Actuator, ActuatorId, Body, BodyId, Component, Coordinate, Drive, Joint, JointId, JointKind,
    Mechanism, Reaction, Relation, Told,
};
pub use motion::{Balance, Motion};
pub use plan::{Plan, Pose, Start};
pub use plane::{Vec2, vec2};
pub use range::{End, Range};
pub use scalar::{Dual, Scalar};
pub use wide::Wide;
