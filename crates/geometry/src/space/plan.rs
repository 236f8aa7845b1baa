//! The compiled mechanism, and the memory of one thread in which it is evaluated.

use super::change_points::ChangePoint;
use super::closure::{Closure, RowKind};
use super::coordinate::StoredAngles;
use super::follow::Node;
use super::frames::{BodyMotion, Frame, Screw};
use super::groups::Group;
use super::lower::Lowered;
use super::mechanism::{Assembly, Mechanism, Placement};
use super::prediction::Predictions;
use super::rank::Mobility;
use super::stations::{Revolutions, Stations};
use super::tree::{Driver, FreedomKind, Tree};
use super::vector::{Rotation, Vec3};
use super::wrench::Wrench;
use crate::error::{AssemblyError, StructureError};
use crate::mechanism::JointId;
use crate::plan::range::Range;
use dwell_numerics::{Constant, Scalar};

/// Where a joint is in the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum JointPlace {
    /// It carries a body of the tree: the index of the link.
    Link(usize),
    /// It closes a loop: the index of the closure.
    Closure(usize),
}

/// A group of unknowns that are solved together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GroupDescription {
    /// The joints that close its loops.
    pub joints: Vec<JointId>,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Number of equations, redundant ones among them.
    pub equations: usize,
}

/// A compiled mechanism: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan<C = f64> {
    pub(super) ground: usize,
    pub(super) size: f64,
    /// Whether loops that keep to a [plane](super::planes) are solved in it.
    pub(super) has_planes: bool,
    pub(super) tree: Tree<C>,
    pub(super) closures: Vec<Closure<C>>,
    /// By joint.
    pub(super) joint_places: Vec<JointPlace>,
    pub(super) groups: Vec<Group>,
    /// Links that depend on the driven freedoms alone; then those that no group places.
    pub(super) first_links: Vec<usize>,
    pub(super) last_links: Vec<usize>,
    /// By actuator.
    pub(super) drivers: Vec<Driver<C>>,
    /// Whether a coupling has a table, which must have a value.
    pub(super) has_tables: bool,
    /// The joints whose second body is a massless one that is [welded](super::lower) to their own; the welds follow in this order.
    pub(super) split: Vec<JointId>,
    /// By coupled coordinate: the joint that measures it, if it is a distance. These joints come last.
    pub(super) measured: Vec<Option<JointId>>,
    /// The stored pose of the assembly.
    pub(super) start: Node,
    /// The poses stored along the range of one actuator.
    pub(super) predictions: Predictions,
    pub(super) range: Range,
    /// After how much of the only coordinate everything repeats but coordinates that gain the same each time.
    pub(super) repetition: Option<f64>,
    /// Whether the branch ends at the lower and at the upper end of the range; otherwise it was not followed any further.
    pub(super) range_ends: [bool; 2],
    /// The coordinates at the assembly.
    pub(super) assembly_q: Vec<f64>,
    pub(super) mobility: Mobility,
    /// The angles along the range of joints that close loops.
    pub(super) closure_angles: Vec<StoredAngles>,
    /// By freedom: its change in a period of the only coordinate.
    pub(super) freedom_gains: Vec<f64>,
    /// By each of several coordinates.
    pub(super) revolutions: Revolutions,
    /// The freedoms that count all periods: those that teeth turn, and those that change in every period if the pose does not
    /// repeat.
    pub(super) geared: Vec<usize>,
    /// In the range of the only coordinate.
    pub(super) change_points: Vec<ChangePoint>,
}

/// A pose with its velocities, for one thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose<T = f64> {
    pub(super) coordinates: Vec<T>,
    pub(super) balls: Vec<Rotation<T>>,
    pub(super) frames: Vec<Frame<T>>,
    pub(super) screws: Vec<Screw<T>>,
    /// Entries of the Jacobian, by closure, row and freedom of its path.
    pub(super) entries: Vec<T>,
    pub(super) residuals: Vec<T>,
    /// By row: its wrench on the second body, at that body's point.
    pub(super) row_wrenches: Vec<Wrench<T>>,
    /// By group: its factors; by column of them the row exchanged with it, or the factor of its reflection.
    pub(super) factors: Vec<T>,
    pub(super) pivots: Vec<usize>,
    pub(super) reflections: Vec<T>,
    pub(super) scratch: Vec<T>,
    pub(super) motion: PoseMotion<T>,
    /// By body: the contributions of the accelerations of the freedoms to those of its origin and of its rotation.
    pub(super) added: Vec<[Vec3<T>; 2]>,
    pub(super) stations: Stations,
}

/// The velocities and accelerations of a pose, for one thread.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseMotion<T = f64> {
    pub(super) rates: Vec<T>,
    pub(super) accelerations: Vec<T>,
    /// Whether the states of the bodies are those without accelerations of the freedoms.
    pub(super) has_no_acceleration: bool,
    pub(super) states: Vec<BodyMotion<T>>,
}

impl<T> Pose<T> {
    /// Exchanges the velocities and accelerations for others: for a virtual motion of the same pose, and back.
    #[inline]
    pub fn swap_motion(&mut self, other: &mut PoseMotion<T>) {
        std::mem::swap(&mut self.motion, other);
    }
}

impl Plan {
    /// Assembles a mechanism and compiles it.
    ///
    /// # Errors
    /// [`AssemblyError`] where it cannot be assembled, its freedoms are not those of its actuators, or its loops contradict each other.
    pub fn compile(mechanism: &Mechanism, assembly: &Assembly) -> Result<Self, AssemblyError> {
        Self::compile_with(mechanism, assembly, true)
    }

    /// As [`Plan::compile`], but solves planar loops as loops in space, too. Tests compare with it.
    ///
    /// # Errors
    /// As [`Plan::compile`].
    pub fn compile_without_planes(
        mechanism: &Mechanism,
        assembly: &Assembly,
    ) -> Result<Self, AssemblyError> {
        Self::compile_with(mechanism, assembly, false)
    }

    fn compile_with(
        mechanism: &Mechanism,
        assembly: &Assembly,
        has_planes: bool,
    ) -> Result<Self, AssemblyError> {
        if let Some(reason) = mechanism.fault() {
            return Err(StructureError::Malformed { reason }.into());
        }
        let lowered = Lowered::new(mechanism)?;
        let compiled = Self::compile_lowered(&lowered, assembly, has_planes);
        compiled.map_err(|error| lowered.described(error))
    }

    fn compile_lowered(
        lowered: &Lowered,
        assembly: &Assembly,
        has_planes: bool,
    ) -> Result<Self, AssemblyError> {
        let (mechanism, assembly) = (&lowered.mechanism, &lowered.assembly(assembly));
        let mut plan = Self::whole(lowered)?;
        plan.has_planes = has_planes;
        plan.measure_gears()?;
        let start = plan.assemble(mechanism, assembly)?;
        plan.check_tables_at_start(&start)?;
        let start = plan.find_groups(mechanism, start)?;
        let kind = mechanism.actuators.first().map(|a| a.kind);
        plan.assembly_q.clone_from(&assembly.q);
        // At the assembly everything is closed: what fails there is a singular position.
        let singular = |_| AssemblyError::SingularAssembly {
            bodies: Vec::new(),
            joints: Vec::new(),
        };
        plan.follow_range(&assembly.q, start, kind)
            .map_err(singular)?;
        plan.require_closed_range(mechanism)?;
        plan.count_revolutions(mechanism);
        if plan.actuators() == 1 {
            plan.find_change_points();
        }
        Ok(plan)
    }

    /// The range of the coordinate.
    pub fn range(&self) -> Range {
        self.range
    }

    /// Whether a limit position was found at the lower and at the upper end of the range.
    pub fn range_ends(&self) -> [bool; 2] {
        self.range_ends
    }

    /// Degrees of freedom, redundant constraints and determined reactions, by rank.
    pub fn mobility(&self) -> &Mobility {
        &self.mobility
    }

    /// The groups of unknowns that are solved together, in their order.
    pub fn described_groups(&self) -> Vec<GroupDescription> {
        let describe = |group: &Group| {
            let mut joints: Vec<JointId> = Vec::new();
            for joint in group
                .rows
                .iter()
                .filter_map(|&(c, _)| self.closures[c].joint)
            {
                if !joints.contains(&joint) {
                    joints.push(joint);
                }
            }
            GroupDescription {
                joints,
                unknowns: group.unknowns.len(),
                equations: group.rows.len(),
            }
        };
        self.groups.iter().map(describe).collect()
    }

    /// A length of the order of the mechanism, m.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// For each hinge and screw: its angle, rad, and its rate in a motion of the pose, rad/s.
    pub fn turns(&self, pose: &Pose<f64>, motion: &PoseMotion<f64>) -> Vec<[f64; 2]> {
        let all = self.tree.freedoms.iter().zip(&pose.coordinates);
        let turning = all
            .zip(&motion.rates)
            .filter(|((kind, _), _)| matches!(kind, FreedomKind::Turn | FreedomKind::Screw(_)));
        turning.map(|((_, &angle), &rate)| [angle, rate]).collect()
    }

    /// The turns in the motion of the pose.
    pub fn unit_turns(&self, pose: &Pose<f64>) -> Vec<[f64; 2]> {
        self.turns(pose, &pose.motion)
    }

    /// The placement of a body: its own frame in that of the ground.
    pub fn placement(&self, pose: &Pose<f64>, body: usize) -> Placement {
        let mut placed = pose.frames[body].then(&self.tree.internal[body].inverse());
        placed.position += self.origin();
        placed
    }

    /// A point of a body, m in its frame, in the frame of the ground.
    pub fn point(&self, pose: &Pose<f64>, body: usize, point: Vec3) -> Vec3 {
        let inner = self.tree.internal[body].inner_point(point);
        self.origin() + pose.frames[body].point(inner)
    }
}

impl<C: Constant> Plan<C> {
    /// The point of the ground from which the [frames](Plan::frame) are counted, m.
    pub fn origin(&self) -> Vec3<C> {
        self.tree.internal[self.ground].position
    }

    /// Number of actuators.
    pub fn actuators(&self) -> usize {
        self.drivers.len()
    }

    /// Whether an actuator drives an angle; otherwise it drives a travel.
    pub fn is_angle(&self, actuator: usize) -> bool {
        !self.drivers[actuator].is_force
    }

    /// Memory for the velocities and accelerations of another motion of a pose.
    pub fn pose_motion<T: Scalar>(&self) -> PoseMotion<T> {
        let zeros = vec![T::from_f64(0.0); self.tree.freedoms.len()];
        PoseMotion {
            rates: zeros.clone(),
            accelerations: zeros,
            has_no_acceleration: false,
            states: vec![BodyMotion::default(); self.tree.internal.len()],
        }
    }

    /// How many rows all closures have, and how many entries of the Jacobian.
    pub(super) fn row_and_entry_counts(&self) -> [usize; 2] {
        let end = |c: &Closure<C>| [c.rows.end, c.entries + c.rows.len() * c.path.len()];
        self.closures.last().map_or([0; 2], end)
    }

    /// Memory for one thread.
    pub fn pose<T: Scalar>(&self) -> Pose<T> {
        let zero = T::from_f64(0.0);
        let freedoms = self.tree.freedoms.len();
        let [rows, entries] = self.row_and_entry_counts();
        let group = |f: fn(&Group) -> usize| self.groups.iter().map(f).sum::<usize>();
        let mut pose = Pose {
            coordinates: vec![zero; freedoms],
            balls: vec![Rotation::default(); self.tree.balls],
            frames: vec![Frame::default(); self.tree.internal.len()],
            screws: vec![Screw::default(); freedoms],
            entries: vec![zero; entries],
            residuals: vec![zero; rows],
            row_wrenches: vec![Wrench::default(); rows],
            factors: vec![zero; group(|g| g.rows.len() * g.unknowns.len())],
            pivots: vec![0; group(|g| g.unknowns.len())],
            reflections: vec![zero; group(|g| g.unknowns.len())],
            scratch: vec![zero; self.groups.iter().map(|g| g.rows.len()).max().unwrap_or(0)],
            motion: self.pose_motion(),
            added: vec![[Vec3::zero(); 2]; self.tree.internal.len()],
            stations: Stations::default(),
        };
        // The wrenches of points do not change.
        for closure in &self.closures {
            for (kind, row) in closure.kinds.iter().zip(closure.rows.clone()) {
                if let RowKind::Point(axis) = kind {
                    pose.row_wrenches[row].force = Vec3::AXES[*axis].cast();
                }
            }
        }
        pose
    }

    /// The evaluation frame of a body at a pose. Its origin is relative to that of the ground's evaluation frame, so that
    /// nothing depends on the position of the mechanism.
    #[inline(always)]
    pub fn frame<'a, T: Scalar>(&self, pose: &'a Pose<T>, body: usize) -> &'a Frame<T> {
        &pose.frames[body]
    }

    /// The frame in which a body is evaluated, relative to the body's own frame: the frame of the joint that carries
    /// the body.
    pub fn evaluation_frame(&self, body: usize) -> Frame<C> {
        self.tree.internal[body]
    }
}
