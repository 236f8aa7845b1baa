//! Errors of a mechanism: in its structure, in its assembly, and at one position.
//! They carry ids; the caller, who has the mechanism and the scene, adds names and places.

use crate::mechanism::{ActuatorId, BodyId, JointId};
use thiserror::Error;

/// The mechanism's structure does not make a driven system with one solution per branch.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum StructureError {
    /// No chain of joints leads from the ground to these bodies.
    #[error("no chain of joints connects {} bodies with the ground", bodies.len())]
    NotConnected {
        /// The bodies that are not reached.
        bodies: Vec<BodyId>,
    },
    /// More degrees of freedom than actuators.
    #[error("the mechanism has {degrees_of_freedom} degrees of freedom, but {actuators} actuators")]
    UnderActuated {
        /// Degrees of freedom by counting unknowns and equations.
        degrees_of_freedom: usize,
        /// Number of actuators.
        actuators: usize,
        /// Bodies whose motion nothing determines.
        bodies: Vec<BodyId>,
        /// Redundant joints, which hide the freedom when constraints are only counted.
        redundant_joints: Vec<JointId>,
    },
    /// More constraints or actuators than degrees of freedom.
    #[error("the mechanism is over-constrained: {redundant_count} constraints too many")]
    OverConstrained {
        /// How many equations are too many.
        redundant_count: usize,
        /// Joints among which the redundant constraints are.
        joints: Vec<JointId>,
        /// Actuators among which they are.
        actuators: Vec<ActuatorId>,
    },
    /// A gear pair in space that cannot be one.
    #[error("the teeth of a gear pair cannot mesh: {reason}")]
    Gear {
        /// The gear pair.
        joint: JointId,
        /// Why.
        reason: &'static str,
    },
    /// A joint, an actuator or the ground refers to something that does not exist, or the assembly configuration does not
    /// fit the mechanism. No scene can cause this; a library caller can.
    #[error("the description of the mechanism is inconsistent: {reason}")]
    Malformed {
        /// The inconsistency, as a phrase.
        reason: &'static str,
    },
}

/// The mechanism cannot be assembled at the given coordinates.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum AssemblyError {
    /// An error in the structure.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// The loops of a group cannot be closed at the given coordinates.
    #[error("the loops cannot be closed at assembly: a gap of {gap:.3e} m remains")]
    NoAssembly {
        /// Bodies of the group.
        bodies: Vec<BodyId>,
        /// The joints that cannot be closed.
        joints: Vec<JointId>,
        /// The length that is missing, m.
        gap: f64,
    },
    /// Several assembly modes are equally near to the initial guess.
    #[error("{} assembly modes, and the initial guess does not distinguish them", modes.len())]
    Ambiguous {
        /// The bodies whose angles distinguish the modes.
        bodies: Vec<BodyId>,
        /// The joints that distinguish them where no body does, by their travels or directions.
        joints: Vec<JointId>,
        /// For each possible mode, the angle (rad) of each of `bodies`, and the travel (m)
        /// or direction (rad) of each of `joints`.
        modes: Vec<Vec<f64>>,
    },
    /// Redundant joints are inconsistent.
    #[error("redundant joints are inconsistent: a gap of {gap:.3e} m remains")]
    Inconsistent {
        /// The redundant joints.
        joints: Vec<JointId>,
        /// How many constraints are too many.
        redundant_count: usize,
        /// The gap that remains, m.
        gap: f64,
    },
    /// Redundant constraints agree at the assembly, but not along the range.
    #[error("redundant constraints agree at assembly, but leave a gap of {gap:.3e} m at q = {q}")]
    NotThroughout {
        /// The joints of their loops.
        joints: Vec<JointId>,
        /// The coordinate there, rad or m.
        q: f64,
        /// The gap that remains, m.
        gap: f64,
        /// Two joints whose axes are nearly parallel, and the angle between the axes, rad.
        nearly_parallel: Option<([JointId; 2], f64)>,
    },
    /// Axes that are nearly parallel hold what parallel ones let move.
    #[error(
        "the axes of two joints are {angle} rad from parallel: {degrees_of_freedom} degrees of freedom are left"
    )]
    NearlyParallel {
        /// The two joints.
        joints: [JointId; 2],
        /// The angle between their axes, rad.
        angle: f64,
        /// How many are left.
        degrees_of_freedom: usize,
    },
    /// Gears, or a rack and its pinion, do not stand at the distance that their radii require.
    #[error("the gears are {distance} m apart, but their pitch radii require {required} m")]
    NotMeshing {
        /// The joint.
        joint: JointId,
        /// Distance of the centres, or of the pinion's centre from the pitch line (positive on the
        /// side of the normal), m.
        distance: f64,
        /// The distance that the radii require, m.
        required: f64,
    },
    /// The table of a coupling has no value at the assembly.
    #[error("the table of a coupling ends at {end}, before {x} at the assembly")]
    OffTable {
        /// The coupling.
        coupling: JointId,
        /// Its variable, rad or m.
        x: f64,
        /// The end of its table that `x` is beyond, rad or m.
        end: f64,
    },
    /// The driven system is singular at assembly.
    #[error(
        "the assembly is at a singular position: the actuator does not determine the motion there"
    )]
    SingularAssembly {
        /// Bodies of the group.
        bodies: Vec<BodyId>,
        /// Its joints.
        joints: Vec<JointId>,
    },
}

/// No pose, or no motion, at one position. Small and `Copy`: it is created in the inner loop.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PositionError {
    /// The loops of a group cannot be closed: the coordinate is outside the range.
    #[error("group {group} cannot close at q = {q}: a gap of {gap:.3e} m remains")]
    NoAssembly {
        /// Index of the group in the plan.
        group: usize,
        /// The coordinate of the first actuator, rad.
        q: f64,
        /// The length that is missing, m.
        gap: f64,
    },
    /// The group's Jacobian is singular: a limit position of this actuator.
    #[error(
        "group {group} is singular at q = {q} (relative determinant {relative_determinant:.1e})"
    )]
    Singular {
        /// Index of the group in the plan.
        group: usize,
        /// The coordinate of the first actuator, rad.
        q: f64,
        /// Determinant relative to the lengths that make it.
        relative_determinant: f64,
    },
    /// Newton's method closed the group on a branch other than that of the assembly.
    #[error("group {group} closes on another assembly branch at q = {q}")]
    OtherBranch {
        /// Index of the group in the plan.
        group: usize,
        /// The coordinate of the first actuator, rad.
        q: f64,
    },
    /// Newton's method did not close the group.
    #[error("group {group} did not close at q = {q} (residual {residual:.1e} m)")]
    NotConverged {
        /// Index of the group in the plan.
        group: usize,
        /// The coordinate of the first actuator, rad.
        q: f64,
        /// The remaining residual, m.
        residual: f64,
    },
    /// The coordinate is outside the range of the actuator.
    #[error("q = {q} is outside the range of the actuator, {from} to {to}")]
    OutOfRange {
        /// The coordinate, rad.
        q: f64,
        /// Lower end of the range, rad.
        from: f64,
        /// Upper end of the range, rad.
        to: f64,
    },
    /// The table of a coupling has no value for its variable.
    #[error("the table of a coupling ends at {end}, before {x} at q = {q}")]
    OffTable {
        /// The coupling.
        coupling: JointId,
        /// The coordinate of the first actuator, rad or m.
        q: f64,
        /// Its variable, rad or m.
        x: f64,
        /// The end of its table that `x` is beyond, rad or m.
        end: f64,
    },
    /// A coordinate, or a value computed from it, is not finite. The error names no coordinate.
    #[error("a coordinate is not a finite number")]
    NotFinite,
    /// Several poses were requested at once ([`Lanes`](dwell_numerics::Lanes)), but a decision differs between their
    /// coordinates: each is to be evaluated alone.
    #[error("the poses near q = {q} cannot be evaluated together in SIMD lanes")]
    LanesDiverge {
        /// The first of the coordinates.
        q: f64,
    },
}

impl PositionError {
    /// The coordinate of the first actuator at which it occurred, rad or m; `None` for [`PositionError::NotFinite`].
    pub fn coordinate(&self) -> Option<f64> {
        let (Self::NoAssembly { q, .. }
        | Self::Singular { q, .. }
        | Self::OtherBranch { q, .. }
        | Self::NotConverged { q, .. }
        | Self::OutOfRange { q, .. }
        | Self::OffTable { q, .. }
        | Self::LanesDiverge { q }) = *self
        else {
            return None;
        };
        Some(q)
    }

    /// The group in which the error occurred.
    pub fn group(&self) -> Option<usize> {
        match *self {
            Self::NoAssembly { group, .. }
            | Self::Singular { group, .. }
            | Self::OtherBranch { group, .. }
            | Self::NotConverged { group, .. } => Some(group),
            Self::OutOfRange { .. }
            | Self::OffTable { .. }
            | Self::NotFinite
            | Self::LanesDiverge { .. } => None,
        }
    }
}
