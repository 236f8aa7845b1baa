//! How the bodies are carried from the ground, and the loops that the remaining joints close.
//!
//! A spanning tree of joints carries each body from a body that comes earlier. A body's *root*
//! is its point in the joint that carries it; every other attachment is measured from there, so
//! nothing depends on where the mechanism or a body's frame stands. A joint outside the tree is a
//! *chord*: its loop says that the point on the second body, reached through the tree, meets the
//! point on the first.

use crate::error::StructureError;
use crate::frames::Frames;
use crate::mechanism::{BodyId, JointId, JointKind, Mechanism};
use crate::plane::Vec2;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A constant vector in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arm {
    /// The frame it turns with.
    pub frame: usize,
    /// Its components in that frame, m (or a unit direction).
    pub local: Vec2,
}

/// How a body is carried from an earlier one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carry {
    /// The body.
    pub body: BodyId,
    /// The body that carries it.
    pub parent: BodyId,
    /// The joint that carries it.
    pub joint: JointId,
    /// From the parent's root to the joint's point on the parent.
    pub arm: Arm,
    /// The slide, if the joint is prismatic: its index and the direction, in the frame of both
    /// bodies, along which the body moves away from the parent.
    pub slide: Option<(usize, Vec2)>,
}

/// The tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    /// The moving bodies, each after the one that carries it.
    pub carries: Vec<Carry>,
    /// By body: its place in `carries`; none for the ground.
    pub place: Vec<Option<usize>>,
    /// By body: its root, in its own frame, m.
    pub roots: Vec<Vec2>,
    /// The joints outside the tree.
    pub chords: Vec<JointId>,
    /// Number of slides.
    pub slides: usize,
}

/// The closure of a chord: P₂ − P₁ as a sum of arms and slides.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// The chord.
    pub joint: JointId,
    /// One arm for each frame it passes, all attachments of that frame summed.
    pub arms: Vec<Arm>,
    /// The slides it passes, each with the direction it counts along.
    pub slides: Vec<(usize, Arm)>,
    /// For a prismatic chord, its axis (first body): only the part along the normal must vanish.
    pub axis: Option<Arm>,
}

impl Tree {
    /// Carries every body from the ground: over driven joints first, then revolute ones, then
    /// prismatic ones, and along as few joints as possible.
    ///
    /// # Errors
    /// [`StructureError::Detached`] when some bodies cannot be reached.
    pub fn find(mechanism: &Mechanism, frames: &Frames) -> Result<Self, StructureError> {
        let n = mechanism.bodies.len();
        let mut joints_of: Vec<Vec<usize>> = vec![Vec::new(); n];
        for (j, joint) in mechanism.joints.iter().enumerate() {
            for body in joint.bodies {
                joints_of[body.0].push(j);
            }
        }
        let mut tree = Self {
            carries: Vec::with_capacity(n.saturating_sub(1)),
            place: vec![None; n],
            roots: vec![Vec2::ZERO; n],
            chords: Vec::new(),
            slides: 0,
        };
        let ground = mechanism.ground;
        let mut reached = vec![false; n];
        let mut in_tree = vec![false; mechanism.joints.len()];
        let mut queue = BinaryHeap::new();
        reached[ground] = true;
        // Measured from one of its own points, the ground adds no rounding of where it stands.
        if let Some(&j) = joints_of[ground].first() {
            tree.roots[ground] = point_on(mechanism, j, ground);
        }
        let rank = driven_ranks(mechanism);
        let offer = |queue: &mut BinaryHeap<_>, body: usize, depth: usize| {
            for &j in &joints_of[body] {
                queue.push(Reverse((rank[j], depth + 1, j, body)));
            }
        };
        offer(&mut queue, ground, 0);
        while let Some(Reverse((_, depth, j, parent))) = queue.pop() {
            let joint = &mechanism.joints[j];
            let child = joint.bodies[usize::from(joint.bodies[0].0 == parent)].0;
            if std::mem::replace(&mut reached[child], true) {
                continue;
            }
            in_tree[j] = true;
            tree.roots[child] = point_on(mechanism, j, child);
            tree.carry(mechanism, frames, j, parent, child);
            offer(&mut queue, child, depth);
        }
        let detached: Vec<_> = (0..n).filter(|&b| !reached[b]).map(BodyId).collect();
        if !detached.is_empty() {
            return Err(StructureError::Detached { bodies: detached });
        }
        tree.chords = (0..in_tree.len())
            .filter(|&j| !in_tree[j])
            .map(JointId)
            .collect();
        Ok(tree)
    }

    fn carry(
        &mut self,
        mechanism: &Mechanism,
        frames: &Frames,
        j: usize,
        parent: usize,
        child: usize,
    ) {
        let joint = &mechanism.joints[j];
        let slide = match joint.kind {
            JointKind::Prismatic { axes } => {
                let axis = axes[0].turn(frames.attitudes[joint.bodies[0].0].offset);
                let away = if joint.bodies[1].0 == child {
                    axis
                } else {
                    -axis
                };
                self.slides += 1;
                Some((self.slides - 1, away))
            }
            _ => None,
        };
        let arm = self.arm(frames, parent, point_on(mechanism, j, parent));
        self.place[child] = Some(self.carries.len());
        self.carries.push(Carry {
            body: BodyId(child),
            parent: BodyId(parent),
            joint: JointId(j),
            arm,
            slide,
        });
    }

    /// The arm from a body's root to one of its points.
    pub fn arm(&self, frames: &Frames, body: usize, point: Vec2) -> Arm {
        arm_between(frames, body, self.roots[body], point)
    }

    /// The loop that a chord closes.
    pub fn close(&self, mechanism: &Mechanism, frames: &Frames, chord: JointId) -> Loop {
        let joint = &mechanism.joints[chord.0];
        let mut arms: Vec<Arm> = Vec::new();
        let mut slides: Vec<(usize, Arm)> = Vec::new();
        // Walk both ends down to the body where they meet, the later one first.
        let [mut first, mut second] = [0, 1].map(|i| (joint.bodies[i].0, joint.points[i]));
        while first.0 != second.0 {
            let step_second = self.place[second.0] > self.place[first.0];
            let (end, sign) = if step_second {
                (&mut second, 1.0)
            } else {
                (&mut first, -1.0)
            };
            // The end that comes later in the tree is never the ground, so it is carried.
            let Some(at) = self.place[end.0] else { break };
            let carry = &self.carries[at];
            add(
                &mut arms,
                arm_between(frames, end.0, self.roots[end.0], end.1),
                sign,
            );
            if let Some((slide, away)) = carry.slide {
                let frame = frames.attitudes[end.0].frame;
                let local = away * sign;
                slides.push((slide, Arm { frame, local }));
            }
            *end = (
                carry.parent.0,
                point_on(mechanism, carry.joint.0, carry.parent.0),
            );
        }
        add(
            &mut arms,
            arm_between(frames, first.0, first.1, second.1),
            1.0,
        );
        arms.retain(|arm| arm.local != Vec2::ZERO);
        let axis = match joint.kind {
            JointKind::Prismatic { axes } => {
                let attitude = frames.attitudes[joint.bodies[0].0];
                Some(Arm {
                    frame: attitude.frame,
                    local: axes[0].turn(attitude.offset),
                })
            }
            _ => None,
        };
        Loop {
            joint: chord,
            arms,
            slides,
            axis,
        }
    }
}

/// By joint: 0 where an actuator drives it, 1 revolute, 2 prismatic.
fn driven_ranks(mechanism: &Mechanism) -> Vec<u8> {
    let mut pairs: Vec<[BodyId; 2]> = mechanism
        .actuators
        .iter()
        .map(|a| sorted(a.bodies))
        .collect();
    pairs.sort_unstable();
    let rank = |joint: &crate::mechanism::Joint| match joint.kind {
        JointKind::Revolute if pairs.binary_search(&sorted(joint.bodies)).is_ok() => 0,
        JointKind::Revolute => 1,
        _ => 2,
    };
    mechanism.joints.iter().map(rank).collect()
}

fn sorted([a, b]: [BodyId; 2]) -> [BodyId; 2] {
    if a <= b { [a, b] } else { [b, a] }
}

/// The joint's point on one of its bodies.
fn point_on(mechanism: &Mechanism, joint: usize, body: usize) -> Vec2 {
    let joint = &mechanism.joints[joint];
    joint.points[usize::from(joint.bodies[0].0 != body)]
}

/// The vector from one point of a body to another, in its frame. What is left of two points that
/// coincide to the rounding of their coordinates is nothing: a mechanism drawn far from the origin
/// has the structure of the same one drawn near it.
fn arm_between(frames: &Frames, body: usize, from: Vec2, to: Vec2) -> Arm {
    let attitude = frames.attitudes[body];
    let difference = to - from;
    let rounding = 4.0 * f64::EPSILON * (from.norm() + to.norm());
    let local = if difference.norm() <= rounding {
        Vec2::ZERO
    } else {
        difference.turn(attitude.offset)
    };
    Arm {
        frame: attitude.frame,
        local,
    }
}

/// Adds an arm to a loop, into the one that turns with the same frame if there is one.
fn add(arms: &mut Vec<Arm>, arm: Arm, sign: f64) {
    let local = arm.local * sign;
    if let Some(same) = arms.iter_mut().find(|a| a.frame == arm.frame) {
        let sum = same.local + local;
        let rounding = 4.0 * f64::EPSILON * (same.local.norm() + local.norm());
        same.local = if sum.norm() <= rounding {
            Vec2::ZERO
        } else {
            sum
        };
    } else {
        arms.push(Arm {
            frame: arm.frame,
            local,
        });
    }
}
