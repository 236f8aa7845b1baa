//! The compiled form of a mechanism: a flat list of steps that compute its positions, group by group. A plan
//! is constant and shared; results live in a caller's [`Pose`] and [`Motion`](crate::motion::Motion).

mod closed_form_lengths;
mod group_info;
mod pose;
mod pruning;
pub(crate) mod range;
pub(crate) mod stored_poses;

pub use pose::Pose;

use crate::mechanism::{BodyId, JointId};
use crate::plan::range::{NearBranch, Range, RangeLimit};
use crate::plan::stored_poses::StoredPoses;
use crate::plane::Vec2;
use crate::structure::coupling::CouplingEquation;
use crate::structure::frames::Frames;
use crate::structure::groups::Group;
use crate::structure::lower::{KinematicPair, Lowered, LoweredCoordinate};
use crate::structure::tree::{FrameVector, Tree};
use dwell_numerics::{Constant, Lift, Scalar};
use std::collections::HashMap;

/// The coordinates and the assembly mode at which the mechanism is assembled.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AssemblyConfiguration {
    /// The coordinate of each actuator at assembly, rad or m.
    pub q: Vec<f64>,
    /// Approximate angle of each body, rad; `None` without one. The angles select the assembly branch.
    pub initial_guess: Vec<Option<f64>>,
    /// By joint, an approximate coordinate where one is given: selects the assembly mode where the angles of the bodies
    /// do not. It is the travel of a prismatic joint or a slot, m, or the direction of a distance, rad
    /// ([`BranchHint`](crate::mechanism::BranchHint)). Empty where no joint has one.
    pub branch_hints: Vec<Option<f64>>,
}

/// A mechanism compiled for evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan<C = f64> {
    pub(crate) lowered: Lowered<C>,
    pub(crate) frames: Frames,
    pub(crate) tree: Tree<C>,
    pub(crate) frame_vectors: Vec<FrameVector<C>>,
    pub(crate) moving_bodies: Vec<MovingBody>,
    /// The loops.
    pub loop_closures: Vec<LoopClosure<C>>,
    /// The couplings between angles and travels.
    pub couplings: Vec<CouplingEquation>,
    pub(crate) groups: Vec<AssurGroup<C>>,
    pub(crate) steps: Vec<Step<C>>,
    /// By kinematic pair: whether it is in the tree or closes a loop.
    pub pair_roles: Vec<PairRole>,
    /// By group: the step that solves it.
    pub(crate) solve_steps: Vec<usize>,
    /// By class: the frame whose angle is the unknown (the ground's for class 0).
    pub(crate) class_frames: Vec<usize>,
    /// The frames that actuators turn from the ground, each after the one it is turned from.
    pub(crate) actuated_frames: Vec<ActuatedFrame>,
    /// By frame: whether its whole revolutions are counted, because a coupling or a load needs its angle.
    pub(crate) revolution_counted: Vec<bool>,
    /// By body: the whole revolutions between it and its frame, rad.
    pub(crate) revolution_offsets: Vec<f64>,
    /// By frame of a line of centres: the carrier's frame, with which its revolutions are counted, and its constant angle
    /// from that, rad.
    pub(crate) carrier_phases: HashMap<usize, (usize, f64)>,
    /// By slide: the actuator that drives it, if any.
    pub actuated_slides: Vec<Option<usize>>,
    /// By actuator: whether it drives an angle rather than a length.
    pub(crate) angular: Vec<bool>,
    /// [`Mechanism::size`](crate::mechanism::Mechanism::size), m: a step of a driven length is a part of it.
    pub(crate) size: f64,
    pub(crate) assembly_coordinates: Vec<f64>,
    pub(crate) range: Range,
    /// The lower and the upper end of the range, if there are any.
    pub(crate) range_limits: [Option<RangeLimit>; 2],
    /// The places in the followed range where other branches come near this one.
    pub(crate) near_branches: Vec<NearBranch>,
    /// The pose at assembly.
    pub(crate) assembly_pose: Option<Box<Pose<f64>>>,
    /// By reaction of the mechanism: whether the loads determine it; empty where they determine all.
    pub(crate) determinate: Vec<bool>,
    /// By group: its assembly modes at the start.
    pub group_modes: Vec<GroupModes>,
}

/// The assembly modes of a group at the start.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GroupModes {
    /// The bodies whose angles distinguish the modes.
    pub bodies: Vec<BodyId>,
    /// The joints that distinguish them where no body does:
    /// [`JointKind::branch_hint`](crate::mechanism::JointKind::branch_hint) says by which coordinate.
    pub joints: Vec<JointId>,
    /// For each mode, the angle of each of `bodies`, rad, and the travel or direction of each of
    /// `joints`, m or rad; the selected mode comes first.
    pub modes: Vec<Vec<f64>>,
}

/// The role of a kinematic pair in the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairRole {
    /// It connects a body with its parent in the tree: index in [`Plan::moving_bodies`].
    TreeJoint(usize),
    /// It closes a loop: index in [`Plan::loop_closures`].
    LoopJoint(usize),
}

/// A moving body, in the order of the tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingBody {
    /// The body; an index beyond the mechanism's bodies is an added, massless one.
    pub body: usize,
    /// The pair that connects it with its parent.
    pub pair: usize,
    /// Index of its parent in the same order; none for the ground.
    pub parent: Option<usize>,
    /// Its frame.
    pub frame: usize,
    /// The frame of its parent.
    pub parent_frame: usize,
    /// The rotated vector from the parent's root to the joint; `None` if it has no length or
    /// belongs to the ground itself. (A body that slides without turning carries moments by it.)
    pub joint_vector: Option<usize>,
    /// The slide of a prismatic joint: its index, and the rotated direction of its travel.
    pub slide: Option<(usize, usize)>,
}

/// A frame turned from another one by an actuator's coordinate, times `sign`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ActuatedFrame {
    pub(crate) frame: usize,
    pub(crate) parent: usize,
    pub(crate) actuator: usize,
    pub(crate) sign: f64,
    /// The frame whose angle is the unknown of its class.
    pub(crate) class_frame: usize,
    /// Whether its whole revolutions are counted.
    pub(crate) revolution_counted: bool,
}

/// A loop with its vectors in the plan's table: L = P₂ − P₁ = fixed + Σ vectors + Σ travel · direction.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopClosure<C = f64> {
    /// The pair that closes the loop.
    pub pair: usize,
    /// The part of the loop on the ground, m.
    pub fixed: Vec2<C>,
    /// The vectors it sums, as (vector, frame).
    pub vectors: Vec<(usize, usize)>,
    /// The slides it passes, as (slide, direction vector, frame).
    pub slides: Vec<(usize, usize, usize)>,
    /// For a slide whose travel nothing measures, the rotated axis of its first body, as (vector, frame).
    pub axis: Option<(usize, usize)>,
}

/// A group with the data of its method of solution.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AssurGroup<C = f64> {
    pub(crate) group: Group,
    pub(crate) kind: GroupKind<C>,
    /// The actuated frames of its classes, each after the one it is turned from.
    pub(crate) actuated_frames: Vec<ActuatedFrame>,
    /// The loops of the group, each with the parts that earlier groups or actuators move.
    pub(crate) known_terms: Vec<KnownTerms>,
    /// Sum of the lengths in its loops, m: residuals are compared with it.
    pub(crate) size: f64,
    /// A power of two near `size`, m: the unit of travels in the Jacobian, so that pivots can be compared.
    pub(crate) scale: f64,
    /// The start values of Newton's method, from which whole revolutions are also counted.
    pub(crate) stored_poses: StoredPoses,
    /// Whether revolutions are to be counted after a closed form.
    pub(crate) counts_revolutions: bool,
    /// Whether a coupling of it has a table, which must have a value.
    pub(crate) has_table: bool,
    /// Whether the stored poses are needed.
    pub(crate) uses_stored_poses: bool,
    /// Whether it is left out, because no requested result needs it.
    pub(crate) pruned: bool,
}

impl<C> AssurGroup<C> {
    /// The factor of the row of a coupling. A coupling of angles is multiplied by the size of its group, so that it
    /// compares with the lengths of loops.
    pub(crate) fn coupling_weight<T: Scalar>(&self, coupling: &CouplingEquation) -> T {
        T::from_f64(if coupling.angular { self.scale } else { 1.0 })
    }
}

/// The part of a closure that an earlier group or an actuator moves: its multiplier acts there too.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct KnownTerms {
    pub(crate) closure: usize,
    /// The axis of a prismatic loop joint, and its frame if an earlier group or an actuator moves it.
    pub(crate) axis: Option<usize>,
    pub(crate) axis_frame: Option<usize>,
    /// Vectors, with their frames.
    pub(crate) vectors: Vec<(usize, usize)>,
    /// All slides of the closure, as (slide, direction vector, frame).
    pub(crate) slides: Vec<(usize, usize, usize)>,
}

/// How a group is solved.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum GroupKind<C = f64> {
    RrrDyad(RrrDyad<C>),
    GuidedPoint(GuidedPoint<C>),
    Factored(FactoredGroup),
}

impl<C> GroupKind<C> {
    /// How a group is placed that is not a closed form throughout.
    pub(crate) fn placement_method(&self) -> Option<PlacementMethod> {
        match self {
            Self::RrrDyad(_) | Self::GuidedPoint(_) => None,
            Self::Factored(factored_group) => Some(factored_group.method),
        }
    }

    /// Chooses the sign of the root in a closed form or a construction.
    pub(crate) fn set_root_sign(&mut self, root_sign: f64) {
        match self {
            Self::RrrDyad(dyad) => dyad.branch = root_sign,
            Self::GuidedPoint(guided) => guided.branch = root_sign,
            Self::Factored(factored_group) => factored_group.root_sign = root_sign,
        }
    }
}

/// Two bodies pinned to each other and to known points: a triangle.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct RrrDyad<C = f64> {
    pub(crate) closure: usize,
    /// The two vectors that turn, and their frames.
    pub(crate) vectors: [usize; 2],
    pub(crate) frames: [usize; 2],
    /// The vectors in their frames, each over its length squared: recovers the rotation from the rotated vector.
    pub(crate) per_square: [Vec2; 2],
    /// Squares of the vectors' sum, difference and (second less first) lengths, m².
    pub(crate) sum_squared: f64,
    pub(crate) difference_squared: f64,
    pub(crate) square_difference: f64,
    /// The other vectors of the loop: those on the ground, and those that move.
    pub(crate) fixed: Vec2<C>,
    pub(crate) known: Vec<(usize, usize)>,
    /// Sign of vector₁ × vector₂: the assembly branch.
    pub(crate) branch: f64,
}

/// A body turned until a point of its loop lies on a line.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct GuidedPoint<C = f64> {
    pub(crate) closure: usize,
    pub(crate) frame: usize,
    /// The rotated axis of the line, with its frame.
    pub(crate) axis: (usize, usize),
    /// Whether the line turns (a slotted guide) or the vector does (a connecting rod).
    pub(crate) line_rotates: bool,
    /// The rotated vector that comes with the solution: the axis, or the vector of the loop.
    pub(crate) found_vector: usize,
    /// The vectors of the loop that move.
    pub(crate) vectors: Vec<(usize, usize)>,
    /// The vector of the loop in the turning frame.
    pub(crate) local: Vec2<C>,
    /// Its length, m.
    pub(crate) length: f64,
    /// The unit vector that is found: the line's normal, or the vector's direction.
    pub(crate) unit: Vec2,
    /// The other vectors of the loop: those on the ground, and those that move.
    pub(crate) fixed: Vec2<C>,
    pub(crate) known: Vec<(usize, usize)>,
    /// Sign of −∂(normal distance)/∂angle: the assembly branch.
    pub(crate) branch: f64,
}

/// Any other group, whose motion and forces come from the factors of its Jacobian.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FactoredGroup {
    pub(crate) method: PlacementMethod,
    /// Numbers of equations and unknowns.
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    /// Where its factors begin in [`Pose::lu`], and its pivots in [`Pose::pivots`].
    pub(crate) lu_offset: usize,
    pub(crate) pivots_offset: usize,
    /// Sign of the determinant at the start.
    pub(crate) branch: f64,
    /// Sign of the root that a construction takes.
    pub(crate) root_sign: f64,
}

impl FactoredGroup {
    /// Number of stored values of its factors; a tall matrix has an additional factor for each column.
    pub(crate) fn factor_len(&self) -> usize {
        let heads = usize::from(self.is_overdetermined()) * self.columns;
        self.rows * self.columns + heads
    }
}

/// How a group is placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PlacementMethod {
    /// Newton's method from stored poses.
    Newton,
    /// Its equations are linear in its unknowns.
    Linear,
    /// Gears whose lines of centres turn with their carriers: linear in the angles.
    GearTrain,
    /// Two classes turn until a loop closes: a triangle with sides that may change.
    Triangle(usize, usize),
    /// A class turns and a slide travels until a loop closes.
    LineCircle(usize, usize),
    /// A class turns until a point lies on a line.
    PointOnLine(usize),
}

/// One step of the computation of positions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Step<C = f64> {
    /// Rotate a frame by an actuator's coordinate.
    RotateFrame(ActuatedFrame),
    /// Set a slide to an actuator's coordinate: (slide, actuator).
    SetSlide(usize, usize),
    /// Solve a group.
    SolveGroup(usize),
    /// Rotate a vector whose frame has become known.
    RotateVector(usize, FrameVector<C>),
}

impl<C: Constant> Plan<C> {
    /// Number of independent coordinates.
    pub fn actuators(&self) -> usize {
        self.angular.len()
    }

    /// Whether an actuator's coordinate is an angle (rad) rather than a length (m).
    pub fn is_angle(&self, actuator: usize) -> bool {
        self.angular[actuator]
    }

    /// The coordinates at which the mechanism was assembled, rad or m.
    pub fn assembly_coordinates(&self) -> &[f64] {
        &self.assembly_coordinates
    }

    /// The range of the single actuator on this branch.
    pub fn range(&self) -> Range {
        self.range
    }

    /// Limits the range of the single actuator to coordinates (rad or m) beyond which something of the mechanism is not known.
    pub fn limit_range(&mut self, [from, to]: [f64; 2]) {
        let (low, high) = self
            .range
            .limits()
            .unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        self.range = Range::Unresolved(low.max(from), high.min(to));
    }

    /// The lower and the upper end of the range, with their causes.
    pub fn range_limits(&self) -> [Option<RangeLimit>; 2] {
        self.range_limits
    }

    /// The unit with which changes of the first actuator's coordinate are compared: 1 rad, or the mechanism's size, m.
    pub fn coordinate_unit(&self) -> f64 {
        match self.angular.first() {
            Some(false) => self.size,
            _ => 1.0,
        }
    }

    /// The places where other branches come near the branch of the single actuator. If the pose repeats, those of one
    /// period.
    pub fn near_branches(&self) -> &[NearBranch] {
        &self.near_branches
    }

    /// The moving bodies, each after the one that carries it.
    pub fn moving_bodies(&self) -> &[MovingBody] {
        &self.moving_bodies
    }

    /// The orientations of the bodies.
    pub fn frames(&self) -> &Frames {
        &self.frames
    }

    /// The spanning tree of joints.
    pub fn tree(&self) -> &Tree<C> {
        &self.tree
    }

    /// The kinematic pairs (pins, slides and welds) that the mechanism is lowered to; those of joints come first.
    pub fn pairs(&self) -> &[KinematicPair<C>] {
        &self.lowered.pairs
    }

    /// Indices of a joint's first kinematic pair and of its coupling.
    pub fn joint_parts(&self, joint: JointId) -> (Option<usize>, Option<usize>) {
        self.lowered.joint_parts[joint.0]
    }

    /// Whether the loads determine a reaction, by its index in [`Mechanism::reactions`](crate::mechanism::Mechanism::reactions). Reactions of
    /// redundant joints are not: of all forces that balance the loads, the smallest are given.
    pub fn is_determinate(&self, reaction: usize) -> bool {
        self.determinate.get(reaction).copied().unwrap_or(true)
    }

    /// The slide of an actuator that drives a length.
    pub fn slide_of_actuator(&self, actuator: usize) -> Option<usize> {
        self.actuated_slides
            .iter()
            .position(|&by| by == Some(actuator))
    }

    /// The derivative of a coupling with the angle of each body it names.
    pub fn coupling_angle_derivatives<T: Lift<C>>(
        &self,
        coupling: usize,
        pose: &Pose<T>,
        mut add: impl FnMut(usize, T),
    ) {
        let lowered_coupling = &self.lowered.couplings[coupling];
        let mut add_terms = |sum: &[(LoweredCoordinate, f64)], by: T| {
            for &(coordinate, factor) in sum {
                if let LoweredCoordinate::Angle(body) = coordinate {
                    add(body, by * T::from_f64(factor));
                }
            }
        };
        add_terms(&lowered_coupling.dependent, T::from_f64(1.0));
        if let Some((_, sum)) = &lowered_coupling.law {
            let slope = self.couplings[coupling].slope(&pose.angle, &pose.slide_travel);
            add_terms(sum, -slope);
        }
    }
}
