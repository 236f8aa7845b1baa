//! What can go wrong in a mechanism: in its structure, in its assembly, and at one position.
//! Errors carry ids; whoever holds the names (the mechanism) and the places (the scene) adds them.

use crate::mechanism::{ActuatorId, BodyId, JointId};
use thiserror::Error;

/// The mechanism's structure does not make a driven system with one solution per branch.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum StructureError {
    /// No chain of joints leads from the ground to these bodies.
    #[error("no chain of joints connects {} bodies with the ground", bodies.len())]
    Detached {
        /// The bodies that are not reached.
        bodies: Vec<BodyId>,
    },
    /// More ways to move than actuators.
    #[error("{dof} degrees of freedom, but {actuators} actuators drive them")]
    UnderDriven {
        /// Degrees of freedom by counting unknowns and equations.
        dof: usize,
        /// Number of actuators.
        actuators: usize,
        /// Bodies whose motion nothing determines.
        bodies: Vec<BodyId>,
        /// Joints that hold each other twice, so that counting alone would not tell.
        twice: Vec<JointId>,
    },
    /// More constraints or actuators than ways to move.
    #[error("{} constraints more than the bodies can follow", excess)]
    OverConstrained {
        /// How many equations are too many.
        excess: usize,
        /// Joints among which the surplus lies.
        joints: Vec<JointId>,
        /// Actuators among which the surplus lies.
        actuators: Vec<ActuatorId>,
    },
    /// A joint, an actuator or the ground refers to a body that is not there, or the start does not
    /// fit the mechanism. No scene can say this; a caller can.
    #[error("the description does not fit together: {what}")]
    Malformed {
        /// What does not fit.
        what: &'static str,
    },
}

/// The mechanism cannot be put together at the start as asked.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum AssemblyError {
    /// The structure is already wrong.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// A group of bodies does not close at the start.
    #[error("the bodies do not reach each other at the start: {gap:.3e} m are missing")]
    CannotClose {
        /// Bodies of the group.
        bodies: Vec<BodyId>,
        /// Joints that stay open.
        joints: Vec<JointId>,
        /// The length that is missing, m.
        gap: f64,
    },
    /// Several ways to assemble, and nothing says which.
    #[error("{} ways to assemble, and nothing rough that tells them apart", choices.len())]
    Ambiguous {
        /// The bodies whose angles tell them apart.
        bodies: Vec<BodyId>,
        /// The joints that do where no body does, by their travels or directions.
        joints: Vec<JointId>,
        /// For each way that may be meant, the angle (rad) of each of `bodies`, and the travel (m)
        /// or direction (rad) of each of `joints`.
        choices: Vec<Vec<f64>>,
    },
    /// Joints hold bodies twice, and not in the same way.
    #[error("joints that hold the same bodies twice contradict each other: {gap:.3e} m stay open")]
    Inconsistent {
        /// Those joints.
        joints: Vec<JointId>,
        /// How many constraints are too many.
        excess: usize,
        /// What stays open, m.
        gap: f64,
    },
    /// Gears, or a rack and its pinion, stand at another distance than their radii ask for.
    #[error("gears stand {distance} m apart, and their radii ask for {wanted} m")]
    NotMeshing {
        /// The joint.
        joint: JointId,
        /// Distance of the centres, or of the pinion's centre from the pitch line (positive on the
        /// side of the normal), m.
        distance: f64,
        /// What the radii ask for, m.
        wanted: f64,
    },
    /// The start is a position where the driven system is singular.
    #[error("the start is a singular position: the actuator does not determine the motion there")]
    SingularStart {
        /// Bodies of the group.
        bodies: Vec<BodyId>,
        /// Its joints.
        joints: Vec<JointId>,
    },
}

/// No pose, or no motion, at one position. Small and `Copy`: it is made in the inner loop.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PlaceError {
    /// The bodies of a group cannot reach each other: the coordinate is outside the range.
    #[error("group {group} cannot close at q = {q}: {gap:.3e} m are missing")]
    Unreachable {
        /// Index of the group in the plan.
        group: usize,
        /// The coordinate of the first actuator, rad.
        q: f64,
        /// The length that is missing, m.
        gap: f64,
    },
    /// The group's Jacobian is singular: a limit position of this actuator.
    #[error("group {group} is singular at q = {q} (relative determinant {measure:.1e})")]
    Singular {
        /// Index of the group in the plan.
        group: usize,
        /// The coordinate of the first actuator, rad.
        q: f64,
        /// Determinant relative to the lengths that make it.
        measure: f64,
    },
    /// Newton's method closed the group on another assembly branch than the start's.
    #[error("group {group} closes on another assembly branch at q = {q}")]
    OtherBranch {
        /// Index of the group in the plan.
        group: usize,
        /// The coordinate of the first actuator, rad.
        q: f64,
    },
    /// Newton's method did not close the group.
    #[error("group {group} did not close at q = {q} (residual {residual:.1e} m)")]
    NotClosed {
        /// Index of the group in the plan.
        group: usize,
        /// The coordinate of the first actuator, rad.
        q: f64,
        /// What is left of the residual, m.
        residual: f64,
    },
    /// The coordinate lies outside the range that was found for it.
    #[error("q = {q} is outside the range of the actuator, {from} to {to}")]
    OutOfRange {
        /// The coordinate, rad.
        q: f64,
        /// Lower end of the range, rad.
        from: f64,
        /// Upper end of the range, rad.
        to: f64,
    },
    /// A coordinate that is not a finite number was asked for.
    #[error("the coordinate {q} is not a finite number")]
    NotFinite {
        /// The coordinate.
        q: f64,
    },
    /// Poses side by side were asked for ([`Lanes`](crate::Lanes)) of a mechanism whose groups go different
    /// ways at different coordinates: each is to be evaluated alone.
    #[error("the poses at q = {q} and beside it can only be evaluated one by one")]
    Apart {
        /// The first of the coordinates.
        q: f64,
    },
}

impl PlaceError {
    /// The group the error speaks of.
    pub fn group(&self) -> Option<usize> {
        match *self {
            Self::Unreachable { group, .. }
            | Self::Singular { group, .. }
            | Self::OtherBranch { group, .. }
            | Self::NotClosed { group, .. } => Some(group),
            Self::OutOfRange { .. } | Self::NotFinite { .. } | Self::Apart { .. } => None,
        }
    }
}
