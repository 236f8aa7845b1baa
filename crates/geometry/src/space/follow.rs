//! The branch over the range of the coordinate, and the poses stored along it: a pose depends on q alone, never on earlier
//! evaluations.

use super::frames::Frame;
use super::groups::Group;
use super::joint_kinds::{Condition, JointKind};
use super::mechanism::{ActuatorKind, Mechanism};
use super::plan::{Plan, Pose};
use super::planes::is_parallel;
use super::positions::OPEN;
use super::prediction::Predictions;
use super::tree::{FreedomKind, Step};
use super::vector::{Rotation, Vec3, vec3};
use crate::error::{AssemblyError, PositionError};
use crate::mechanism::JointId;
use crate::plan::range::Range;
use dwell_numerics::{Constant, Scalar};
use std::f64::consts::TAU;
use std::sync::OnceLock;

/// A stored pose with its first and second derivatives by the coordinate.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Node {
    pub(super) q: f64,
    pub(super) coordinates: Vec<[f64; 3]>,
    pub(super) balls: Vec<Rotation>,
    /// By ball: its turn's derivatives, in the axes of the joint's frame on the parent.
    pub(super) turns: Vec<[Vec3; 2]>,
    /// The inverses of the groups' Jacobians, concatenated.
    pub(super) inverses: Vec<f64>,
}

/// Steps of one revolution, or of the size of the mechanism: between two of them the error of a prediction of degree five
/// is below rounding.
const STEPS: f64 = 1024.0;
/// A step is halved where the prediction misses by more, rad or parts of the size.
const MISS: f64 = 2e-3;
/// A step this small, relative to the first, ends the range.
const SMALLEST: f64 = 1e-9;
/// Revolutions after which a pose that has not come back is taken not to, and sizes after which a stroke has no end.
const MAX_REVOLUTIONS: u32 = 8;
/// Two poses are the same: rad, or parts of the size.
pub(super) const SAME: f64 = 1e-7;
/// If redundant rows are open by this fraction of the tolerance at the end of a range, they are its cause: at limit positions they are
/// closed to rounding.
const DRIFTED: f64 = 0.5;
/// Axes that differ by less are probably meant to be parallel, rad.
const MEANT_PARALLEL: f64 = 1e-3;

impl Plan {
    /// Sets the coordinates to the prediction from a stored pose at so much more of the coordinate.
    pub(super) fn start_from<T: Scalar>(&self, node: &Node, ahead: f64, pose: &mut Pose<T>) {
        for (c, [value, first, second]) in pose.coordinates.iter_mut().zip(&node.coordinates) {
            *c = T::from_f64(value + ahead * (first + 0.5 * ahead * second));
        }
        for ((ball, stored), [first, second]) in
            pose.balls.iter_mut().zip(&node.balls).zip(&node.turns)
        {
            let turn = first.scaled(ahead) + second.scaled(0.5 * ahead * ahead);
            *ball = stored.turned_by(turn).cast();
        }
    }

    /// A node at the pose, with its derivatives for one actuator.
    fn node(&self, q: f64, pose: &mut Pose) -> Node {
        if self.actuators() == 1 {
            self.velocities(&[1.0], pose);
            self.accelerations(&[0.0], pose);
        }
        let mut turns = vec![[Vec3::ZERO; 2]; self.tree.balls];
        for link in &self.tree.links {
            for step in &link.steps {
                if let Step::Ball(ball, first) = *step {
                    let of =
                        |values: &[f64]| vec3(values[first], values[first + 1], values[first + 2]);
                    let (rate, second) = (of(&pose.motion.rates), of(&pose.motion.accelerations));
                    let carried = pose.motion.states[link.body].angular_velocity - rate;
                    let to_frame = |v: Vec3| {
                        pose.balls[ball].apply(pose.frames[link.body].rotation.apply_inverse(v))
                    };
                    turns[ball] = [to_frame(rate), to_frame(second - carried.cross(rate))];
                }
            }
        }
        let mut inverses = Vec::new();
        for group in &self.groups {
            inverses.extend(self.inverse(group, pose));
        }
        let freedoms = 0..self.tree.freedoms.len();
        let of = |f: usize| {
            [
                pose.coordinates[f],
                pose.motion.rates[f],
                pose.motion.accelerations[f],
            ]
        };
        // The coordinates of a ball are its rotation.
        Node {
            q,
            coordinates: freedoms.map(of).collect(),
            balls: pose.balls.clone(),
            turns,
            inverses,
        }
    }

    /// Follows the branch from the assembly.
    pub(super) fn follow_range(
        &mut self,
        q: &[f64],
        start: Pose,
        kind: Option<ActuatorKind>,
    ) -> Result<(), PositionError> {
        let mut pose = start;
        self.close(q, None, &mut pose)?;
        let first = self.node(q.first().copied().unwrap_or(0.0), &mut pose);
        self.start = first.clone();
        let (true, Some(kind)) = (self.actuators() == 1, kind) else {
            self.range = Range::Unbounded;
            self.revolutions.0 = vec![OnceLock::new(); self.actuators()];
            return Ok(());
        };
        let is_angle = matches!(kind, ActuatorKind::Angle(_));
        let unit = if is_angle { TAU } else { self.size };
        let start_frames = pose.frames.clone();
        let mut forward = vec![first.clone()];
        let mut revolution_ends = vec![0];
        for revolution in 1..=MAX_REVOLUTIONS {
            let end = first.q + f64::from(revolution) * unit;
            if !self.continue_branch(&mut forward, end, unit, &mut pose) {
                return self.follow_back(forward, &first, unit, is_angle, &mut pose);
            }
            revolution_ends.push(forward.len() - 1);
            let same = self.moved_by(&start_frames, &pose.frames) < SAME;
            if is_angle && same {
                self.range = if revolution == 1 {
                    Range::Full
                } else {
                    Range::Revolutions(revolution)
                };
                self.store(&forward);
                return Ok(());
            }
        }
        let mut strides = (1..=revolution_ends.len() / 2).map(|k| revolution_ends[k]);
        if let Some(stride) = strides.find(|stride| self.repeats(&forward, *stride)) {
            self.repetition = Some(forward[stride].q - first.q);
            self.store(&forward[..=stride]);
            return Ok(());
        }
        self.follow_back(forward, &first, unit, is_angle, &mut pose)
    }

    /// Whether the pose repeats after this number of stored poses, except for coordinates that change by a constant amount each time, as
    /// those of a screw do. Then nothing ends the range.
    fn repeats(&self, nodes: &[Node], stride: usize) -> bool {
        let unit = if self.is_angle(0) { 1.0 } else { self.size };
        let (first, end) = (&nodes[0], &nodes[stride]);
        let (period, near) = (end.q - first.q, SAME * unit);
        let numbers = |f: &usize| self.tree.freedoms[*f] != FreedomKind::BallTurn;
        let same = |a: &Node, b: &Node, f: usize| {
            let gain = end.coordinates[f][0] - first.coordinates[f][0];
            let (a, b, size) = (a.coordinates[f], b.coordinates[f], self.unit(f));
            let slope = (b[1] - a[1]) * unit;
            let differences = [b[0] - a[0] - gain, slope, (b[2] - a[2]) * unit * unit];
            differences
                .iter()
                .all(|d| d.abs() <= SAME * (size + (a[1] * unit).abs()))
        };
        nodes[stride..].iter().all(|b| {
            let before = nodes.partition_point(|node| node.q < b.q - period - near);
            let a = &nodes[before];
            let mut balls = a.balls.iter().zip(&b.balls);
            let mut freedoms = (0..a.coordinates.len()).filter(numbers);
            (b.q - a.q - period).abs() <= near
                && freedoms.all(|f| same(a, b, f))
                && balls.all(|(a, b)| a.inverse().after(b).vector().norm() <= SAME)
        })
    }

    /// Refuses redundant constraints that hold at the assembly and open along the range, before its end: that is no limit position.
    pub(super) fn require_closed_range(&self, mechanism: &Mechanism) -> Result<(), AssemblyError> {
        let ends = self.predictions.range().into_iter().flatten();
        let blocked = ends.zip(self.range_ends).filter(|(_, blocked)| *blocked);
        let mut pose = self.pose::<f64>();
        for (q, _) in blocked {
            if self.positions(&[q], &mut pose).is_err() {
                continue;
            }
            for group in self.groups.iter().filter(|group| !group.is_square()) {
                let open = self.largest_residual(group, &pose);
                if open > DRIFTED * OPEN {
                    let (joints, gap) = (self.loop_joints(group), open * self.size);
                    let rotation = |body| self.placement(&pose, body).rotation;
                    return Err(AssemblyError::NotThroughout {
                        nearly_parallel: nearly_parallel(mechanism, &joints, rotation),
                        joints,
                        q,
                        gap,
                    });
                }
            }
        }
        Ok(())
    }

    /// The joints of a group's loops.
    fn loop_joints(&self, group: &Group) -> Vec<JointId> {
        let closures = group.closures.iter().map(|(c, _)| &self.closures[*c]);
        let joints = closures.flat_map(|closure| {
            let links = closure.links.iter().map(|(l, _)| self.tree.links[*l].joint);
            links.chain([closure.joint]).flatten()
        });
        let mut joints: Vec<JointId> = joints.collect();
        joints.sort_unstable();
        joints.dedup();
        joints
    }

    /// How far bodies are from where they were, rad or parts of the size; how a body that turns idly stands about its line
    /// does not count.
    pub(super) fn moved_by(&self, before: &[Frame<f64>], after: &[Frame<f64>]) -> f64 {
        let moved = |body: usize| {
            let (a, b) = (&before[body], &after[body]);
            let idle = self.mobility.idle.iter().find(|idle| idle.body.0 == body);
            let turned =
                match idle.map(|idle| self.tree.internal[body].rotation.apply_inverse(idle.axis)) {
                    Some(axis) => (a.rotation.apply(axis) - b.rotation.apply(axis)).norm(),
                    None => a.rotation.inverse().after(&b.rotation).vector().norm(),
                };
            turned.max((a.position - b.position).norm() / self.size)
        };
        (0..before.len()).map(moved).fold(0.0, f64::max)
    }

    /// Follows the branch backwards, too.
    fn follow_back(
        &mut self,
        forward: Vec<Node>,
        first: &Node,
        unit: f64,
        is_angle: bool,
        pose: &mut Pose,
    ) -> Result<(), PositionError> {
        let far = f64::from(MAX_REVOLUTIONS) * unit;
        let mut back = vec![first.clone()];
        let blocked_back = !self.continue_branch(&mut back, first.q - far, unit, pose);
        back.reverse();
        back.extend(forward.into_iter().skip(1));
        let [from, to] = [0, back.len() - 1].map(|k| back[k].q);
        self.range_ends = [blocked_back, to < first.q + 0.99 * far];
        self.range = match (self.range_ends == [true; 2], is_angle) {
            (true, true) => Range::Limited(from, to),
            (true, false) => Range::Stroke(from, to),
            (false, _) => Range::Unresolved(from, to),
        };
        self.store(&back);
        Ok(())
    }

    /// Stores the poses along the range, with the predictions between them.
    fn store(&mut self, nodes: &[Node]) {
        let mut scalars = self.unknowns();
        scalars.retain(|f| self.tree.freedoms[*f] != FreedomKind::BallTurn);
        self.predictions = Predictions::new(nodes, scalars);
    }

    /// Continues from the last node to a coordinate, in steps that the prediction follows; whether it was reached.
    fn continue_branch(&self, nodes: &mut Vec<Node>, to: f64, unit: f64, pose: &mut Pose) -> bool {
        let largest = unit / STEPS;
        let mut step = largest;
        while let Some(last) = nodes.last() {
            let left = to - last.q;
            if left.abs() < 1e-12 * unit {
                return true;
            }
            let ahead = left.signum() * step.min(left.abs());
            self.start_from(last, ahead, pose);
            let (coordinates, balls) = (pose.coordinates.clone(), pose.balls.clone());
            let q = if left.abs() <= step {
                to
            } else {
                last.q + ahead
            };
            let is_closed = self.close(&[q], None, pose).is_ok();
            if is_closed && self.missed_by(&coordinates, &balls, pose) < MISS {
                let node = self.node(q, pose);
                nodes.push(node);
                step = (2.0 * step).min(largest);
            } else {
                step *= 0.5;
                if step < SMALLEST * unit {
                    self.reach_table_end(nodes, q, pose);
                    return false;
                }
            }
        }
        false
    }

    /// Adds the pose where the table of a coupling ends, if that is what ends the branch at a coordinate and its variable is the
    /// coordinate itself.
    fn reach_table_end(&self, nodes: &mut Vec<Node>, q: f64, pose: &mut Pose) {
        let Err(PositionError::OffTable { coupling, end, .. }) = self.close(&[q], None, pose)
        else {
            return;
        };
        let closure = self.closures.iter().find(|c| c.joint == Some(coupling));
        let coupled = closure.and_then(|closure| closure.coupled.as_ref());
        let variable = coupled.map(|coupled| coupled.coordinates[1]);
        let (driver, Some(last)) = (self.drivers[0], nodes.last()) else {
            return;
        };
        let Some(variable) = variable.filter(|x| x.freedom == driver.freedom) else {
            return;
        };
        let q = end * variable.factor / driver.factor;
        self.start_from(last, q - last.q, pose);
        if self.close(&[q], None, pose).is_ok() {
            let node = self.node(q, pose);
            nodes.push(node);
        }
    }

    /// How far a pose is from its prediction, by its coordinates and balls.
    fn missed_by(&self, coordinates: &[f64], balls: &[Rotation], pose: &Pose) -> f64 {
        let driven = |f: usize| self.drivers.iter().any(|d| d.freedom == f);
        let ball = |f: usize| self.tree.freedoms[f] == FreedomKind::BallTurn;
        let scalar = (0..coordinates.len()).filter(|f| !driven(*f) && !ball(*f));
        let scalar = scalar.map(|f| (coordinates[f] - pose.coordinates[f]).abs() / self.unit(f));
        let turned = balls
            .iter()
            .zip(&pose.balls)
            .map(|(a, b)| a.inverse().after(b).vector().norm());
        scalar.chain(turned).fold(0.0, f64::max)
    }
}

impl<C: Constant> Plan<C> {
    /// The coordinate in the range of the stored poses.
    pub(super) fn within_range(&self, q: f64) -> Result<f64, PositionError> {
        let [first, last] = self.predictions.range().unwrap_or([self.start.q; 2]);
        if q >= first && q < last {
            return Ok(q);
        }
        match (self.period(), self.range.limits()) {
            (Some(period), _) => Ok(first + (q - first).rem_euclid(period)),
            (None, Some((from, to))) if q < from || q > to => {
                Err(PositionError::OutOfRange { q, from, to })
            }
            (None, _) => Ok(q),
        }
    }

    /// The change of the only coordinate after which the pose repeats, except for freedoms that change by a constant
    /// amount each time.
    pub(super) fn period(&self) -> Option<f64> {
        self.range.period().or(self.repetition)
    }
}

/// The first two joints whose axes are the farthest from parallel among those that are nearly so, with the angle between them, rad.
pub(super) fn nearly_parallel(
    mechanism: &Mechanism,
    joints: &[JointId],
    rotation: impl Fn(usize) -> Rotation,
) -> Option<([JointId; 2], f64)> {
    let is_held_to = |kind: JointKind| kind.holds(Condition::Axes) && kind.freedoms() > 0;
    let of = |id: &JointId| Some((*id, mechanism.joints.get(id.0)?));
    let joints = joints.iter().filter_map(of);
    let axes = joints.filter(|(_, joint)| is_held_to(joint.kind));
    let axes: Vec<(JointId, Vec3)> = axes
        .map(|(id, joint)| (id, rotation(joint.bodies[0].0).apply(joint.sides[0].axis)))
        .collect();
    let mut found: Option<([JointId; 2], f64)> = None;
    for (k, (a, u)) in axes.iter().enumerate() {
        for (b, v) in &axes[k + 1..] {
            let angle = u.cross(*v).norm();
            if angle < MEANT_PARALLEL && !is_parallel(*u, *v) && found.is_none_or(|f| f.1 < angle) {
                found = Some(([*a, *b], angle));
            }
        }
    }
    found
}
