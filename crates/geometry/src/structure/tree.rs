//! The spanning tree of joints from the ground, and the loops that the remaining joints close.
//!
//! A spanning tree of joints carries each body from a body that comes earlier. A body's *root* is its point in the
//! joint that carries it; every other attachment is measured from there, so nothing depends on the position of the
//! mechanism or of a body's frame. A joint outside the tree is a *loop joint*: its loop closes where the point on the
//! second body, reached through the tree, meets the point on the first.

use crate::error::StructureError;
use crate::plane::Vec2;
use crate::structure::frames::Frames;
use crate::structure::lower::{ActuatedCoordinate, Lowered, PairKind};
use dwell_numerics::Constant;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A constant vector in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameVector<C = f64> {
    /// The frame it turns with.
    pub frame: usize,
    /// Its components in this frame, m, or those of a unit vector.
    pub local: Vec2<C>,
}

/// How a body is carried from an earlier one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TreeJoint<C = f64> {
    /// The body; an index beyond the mechanism's bodies is an added, massless one.
    pub body: usize,
    /// The body that carries it.
    pub parent: usize,
    /// The pair that carries it.
    pub pair: usize,
    /// From the parent's root to the pair's point on the parent.
    pub joint_vector: FrameVector<C>,
    /// The slide, if the pair is one: its index and the direction, in the frame of both
    /// bodies, along which the body moves away from the parent.
    pub slide: Option<(usize, Vec2)>,
}

/// The tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree<C = f64> {
    /// The moving bodies, each after the one that carries it.
    pub joints: Vec<TreeJoint<C>>,
    /// By body: its place in `carries`; none for the ground.
    pub joint_of_body: Vec<Option<usize>>,
    /// By body: its root, in its own frame, m.
    pub joint_origins: Vec<Vec2<C>>,
    /// The pairs outside the tree.
    pub loop_joints: Vec<usize>,
    /// By slide: its pair.
    pub slide_pairs: Vec<usize>,
}

/// The closure of a loop joint: P₂ − P₁ as a sum of vectors and slides.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoopJoint {
    /// The loop joint, by pair.
    pub(crate) pair: usize,
    /// One vector for each frame it passes, all attachments of that frame summed.
    pub(crate) vectors: Vec<FrameVector>,
    /// The slides it passes, each with the direction it counts along.
    pub(crate) slides: Vec<(usize, FrameVector)>,
    /// For a slide whose travel nothing measures, its axis (first body): only the part along the
    /// normal must vanish.
    pub(crate) axis: Option<FrameVector>,
}

impl Tree {
    /// Carries every body from the ground: over driven joints first, then revolute ones, then
    /// prismatic ones, and along as few joints as possible.
    ///
    /// # Errors
    /// [`StructureError::NotConnected`] when some bodies cannot be reached.
    pub(crate) fn find(lowered: &Lowered, frames: &Frames) -> Result<Self, StructureError> {
        let n = lowered.bodies;
        let mut pairs_of: Vec<Vec<usize>> = vec![Vec::new(); n];
        for (b, pair) in lowered.pairs.iter().enumerate() {
            for body in pair.bodies {
                pairs_of[body].push(b);
            }
        }
        let mut tree = Self {
            joints: Vec::with_capacity(n.saturating_sub(1)),
            joint_of_body: vec![None; n],
            joint_origins: vec![Vec2::ZERO; n],
            loop_joints: Vec::new(),
            slide_pairs: Vec::new(),
        };
        let ground = lowered.ground;
        let mut reached = vec![false; n];
        let mut in_tree = vec![false; lowered.pairs.len()];
        let mut queue = BinaryHeap::new();
        reached[ground] = true;
        // Measured from one of its own points, the ground adds no rounding of where it stands.
        if let Some(&b) = pairs_of[ground].first() {
            tree.joint_origins[ground] = lowered.pairs[b].point_on(ground);
        }
        let priority = priorities(lowered);
        let offer = |queue: &mut BinaryHeap<_>, body: usize, depth: usize| {
            for &b in &pairs_of[body] {
                queue.push(Reverse((priority[b], depth + 1, b, body)));
            }
        };
        offer(&mut queue, ground, 0);
        while let Some(Reverse((_, depth, b, parent))) = queue.pop() {
            let pair = &lowered.pairs[b];
            let child = pair.bodies[usize::from(pair.bodies[0] == parent)];
            if std::mem::replace(&mut reached[child], true) {
                continue;
            }
            in_tree[b] = true;
            tree.joint_origins[child] = lowered.pairs[b].point_on(child);
            tree.add_joint(lowered, frames, b, parent, child);
            offer(&mut queue, child, depth);
        }
        let unreached = lowered.mechanism_bodies((0..n).filter(|&b| !reached[b]));
        if !unreached.is_empty() {
            return Err(StructureError::NotConnected { bodies: unreached });
        }
        tree.loop_joints = (0..in_tree.len()).filter(|&b| !in_tree[b]).collect();
        let counts_travel = |b: &&usize| lowered.pairs[**b].kind.counts_travel();
        let counted = tree.loop_joints.iter().filter(counts_travel);
        tree.slide_pairs.extend(counted);
        Ok(tree)
    }

    fn add_joint(
        &mut self,
        lowered: &Lowered,
        frames: &Frames,
        b: usize,
        parent: usize,
        child: usize,
    ) {
        let pair = &lowered.pairs[b];
        let slide = match pair.kind {
            PairKind::Prismatic { axes, .. } => {
                let axis = axes[0].rotate(frames.orientations[pair.bodies[0]].offset);
                let direction = if pair.bodies[1] == child { axis } else { -axis };
                self.slide_pairs.push(b);
                Some((self.slide_pairs.len() - 1, direction))
            }
            PairKind::Revolute | PairKind::Rigid(_) => None,
        };
        let joint_vector = self.vector_to(frames, parent, pair.point_on(parent));
        self.joint_of_body[child] = Some(self.joints.len());
        self.joints.push(TreeJoint {
            body: child,
            parent,
            pair: b,
            joint_vector,
            slide,
        });
    }

    /// The slide of a pair, if its travel is an unknown or a coordinate.
    pub(crate) fn slide_of_pair(&self, pair: usize) -> Option<usize> {
        self.slide_pairs.iter().position(|&b| b == pair)
    }

    /// The loop that a loop joint closes.
    pub(crate) fn loop_joint(
        &self,
        lowered: &Lowered,
        frames: &Frames,
        loop_joint: usize,
    ) -> LoopJoint {
        let pair = &lowered.pairs[loop_joint];
        let mut vectors: Vec<FrameVector> = Vec::new();
        let mut slides: Vec<(usize, FrameVector)> = Vec::new();
        // Walk both ends down to the body where they meet, the later one first.
        let [mut first, mut second] = [0, 1].map(|i| (pair.bodies[i], pair.points[i]));
        while first.0 != second.0 {
            let step_second = self.joint_of_body[second.0] > self.joint_of_body[first.0];
            let (end, sign) = if step_second {
                (&mut second, 1.0)
            } else {
                (&mut first, -1.0)
            };
            // The end that comes later in the tree is never the ground, so it is carried.
            let Some(at) = self.joint_of_body[end.0] else {
                break;
            };
            let tree_joint = &self.joints[at];
            let vector = self.vector_to(frames, end.0, end.1);
            add_vector(&mut vectors, vector, sign);
            if let Some((slide, direction)) = tree_joint.slide {
                let frame = frames.orientations[end.0].frame;
                let local = direction * sign;
                slides.push((slide, FrameVector { frame, local }));
            }
            let parent = tree_joint.parent;
            *end = (parent, lowered.pairs[tree_joint.pair].point_on(parent));
        }
        let last = vector_between(frames, first.0, first.1, second.1);
        add_vector(&mut vectors, last, 1.0);
        vectors.retain(|vector| vector.local != Vec2::ZERO);
        let mut axis = None;
        if let PairKind::Prismatic { axes, .. } = pair.kind {
            let orientation = frames.orientations[pair.bodies[0]];
            let frame = orientation.frame;
            let local = axes[0].rotate(orientation.offset);
            match self.slide_of_pair(loop_joint) {
                // Its travel is a coordinate: the loop closes along the axis too.
                Some(travel) => {
                    let local = -local;
                    slides.push((travel, FrameVector { frame, local }));
                }
                None => axis = Some(FrameVector { frame, local }),
            }
        }
        LoopJoint {
            pair: loop_joint,
            vectors,
            slides,
            axis,
        }
    }
}

impl<C: Constant> Tree<C> {
    /// The vector from a body's root to one of its points.
    pub fn vector_to(&self, frames: &Frames, body: usize, point: Vec2<C>) -> FrameVector<C> {
        vector_between(frames, body, self.joint_origins[body], point)
    }
}

/// By pair: 0 where an actuator drives it or its travel is measured, 1 a pin or a weld, 2 a slide.
fn priorities(lowered: &Lowered) -> Vec<u8> {
    let mut pairs: Vec<[usize; 2]> = lowered
        .actuated_coordinates
        .iter()
        .filter_map(|coordinate| match *coordinate {
            ActuatedCoordinate::Angle(bodies) => Some(sorted(bodies)),
            ActuatedCoordinate::Travel(_) => None,
        })
        .collect();
    pairs.sort_unstable();
    let priority = |pair: &crate::structure::lower::KinematicPair| match pair.kind {
        PairKind::Revolute if pairs.binary_search(&sorted(pair.bodies)).is_ok() => 0,
        PairKind::Prismatic { .. } if pair.kind.counts_travel() => 0,
        PairKind::Revolute | PairKind::Rigid(_) => 1,
        PairKind::Prismatic { .. } => 2,
    };
    lowered.pairs.iter().map(priority).collect()
}

fn sorted([a, b]: [usize; 2]) -> [usize; 2] {
    if a <= b { [a, b] } else { [b, a] }
}

/// The vector from one point of a body to another, in its frame. The vector is zero if the points coincide to the
/// rounding of their coordinates, so that a mechanism far from the origin has the structure of the same mechanism near
/// it.
fn vector_between<C: Constant>(
    frames: &Frames,
    body: usize,
    from: Vec2<C>,
    to: Vec2<C>,
) -> FrameVector<C> {
    let orientation = frames.orientations[body];
    FrameVector {
        frame: orientation.frame,
        local: rounded_sum(to, -from).rotate(orientation.offset.cast()),
    }
}

/// A sum; zero if it is below the rounding of its parts, unless an evaluation is to depend on it.
fn rounded_sum<C: Constant>(a: Vec2<C>, b: Vec2<C>) -> Vec2<C> {
    let sum = a + b;
    let length = |vector: Vec2<C>| vector.values().norm();
    let rounding = 4.0 * f64::EPSILON * (length(a) + length(b));
    if C::IS_PREPARED && length(sum) <= rounding {
        Vec2::zero()
    } else {
        sum
    }
}

/// Adds a vector to a loop, into the one that turns with the same frame if there is one.
fn add_vector(vectors: &mut Vec<FrameVector>, vector: FrameVector, sign: f64) {
    let local = vector.local * sign;
    if let Some(same) = vectors.iter_mut().find(|a| a.frame == vector.frame) {
        same.local = rounded_sum(same.local, local);
    } else {
        vectors.push(FrameVector { local, ..vector });
    }
}
