//! The dimensions of a plan apart from its structure: constant vectors, and the points from which they follow.

use crate::mechanism::Mechanism;
use crate::plan::{GroupKind, LoopClosure, Plan, Step};
use crate::plane::{Vec2, vec2};
use crate::structure::frames::Frames;
use crate::structure::lower::Lowered;
use crate::structure::tree::{LoopJoint, Tree};
use dwell_numerics::Constant;

/// Vectors that are one in the structure may differ by this part of their lengths in the dimensions of a variant: by the
/// rounding of sums.
const SAME_VECTOR: f64 = 16.0 * f64::EPSILON;

/// The constant vectors of a variant, in the order in which they are found.
struct FoundVectors {
    of_frame: Vec<Option<Vec2>>,
}

impl FoundVectors {
    /// Notes a vector; false where another value was found for it.
    fn set(&mut self, vector: usize, local: Vec2) -> bool {
        let known = self.of_frame[vector].get_or_insert(local);
        (*known - local).norm() <= SAME_VECTOR * local.norm()
    }

    /// Notes the vectors of a loop. Returns the part on the ground; `None` if the structure has no place for a vector.
    fn set_loop(&mut self, closure: &LoopClosure, found: &LoopJoint) -> Option<Vec2> {
        let mut fixed = Vec2::ZERO;
        for found in &found.vectors {
            let mut moving = closure.vectors.iter();
            match moving.find(|(_, frame)| *frame == found.frame) {
                Some(&(vector, _)) if self.set(vector, found.local) => {}
                None if found.frame == 0 => fixed += found.local,
                _ => return None,
            }
        }
        // A vector that has vanished.
        for &(vector, frame) in &closure.vectors {
            if found.vectors.iter().all(|found| found.frame != frame)
                && !self.set(vector, Vec2::ZERO)
            {
                return None;
            }
        }
        let slides = closure.slides.iter().zip(&found.slides);
        let mut directions = slides.map(|((_, vector, _), (_, along))| (*vector, along.local));
        let axis = closure.axis.zip(found.axis);
        let axis_fits = axis.is_none_or(|((vector, _), axis)| self.set(vector, axis.local));
        let directions_fit = directions.all(|(vector, along)| self.set(vector, along));
        (axis_fits && directions_fit).then_some(fixed)
    }
}

impl Tree {
    /// The tree with the points of other pairs.
    fn with_points(&self, lowered: &Lowered, frames: &Frames) -> Self {
        let mut tree = self.clone();
        let mut of_ground = lowered.pairs.iter();
        if let Some(pair) = of_ground.find(|pair| pair.bodies.contains(&lowered.ground)) {
            tree.joint_origins[lowered.ground] = pair.point_on(lowered.ground);
        }
        for i in 0..tree.joints.len() {
            let joint = tree.joints[i];
            let pair = &lowered.pairs[joint.pair];
            tree.joint_origins[joint.body] = pair.point_on(joint.body);
            tree.joints[i].joint_vector =
                tree.vector_to(frames, joint.parent, pair.point_on(joint.parent));
        }
        tree
    }
}

impl Plan {
    /// The dimensions of a mechanism of this structure, m, as [`Plan::set_dimensions`] takes them: constant vectors, parts
    /// of loops on the ground, joint vectors, joint origins and the points of the pairs. `None` if the mechanism has
    /// another structure: other joints, axes, radii or lengths, or a vector that this structure has no place for.
    pub fn dimensions(&self, mechanism: &Mechanism) -> Option<Vec<f64>> {
        let lowered = Lowered::new(mechanism);
        if !lowered.differs_in_points_only(&self.lowered) {
            return None;
        }
        let tree = self.tree.with_points(&lowered, &self.frames);
        let mut found = FoundVectors {
            of_frame: vec![None; self.frame_vectors.len()],
        };
        let mut fixed = Vec::with_capacity(self.loop_closures.len());
        for (closure, &joint) in self.loop_closures.iter().zip(&self.tree.loop_joints) {
            let of_loop = tree.loop_joint(&lowered, &self.frames, joint);
            fixed.push(found.set_loop(closure, &of_loop)?);
        }
        for (body, joint) in self.moving_bodies.iter().zip(&tree.joints) {
            let local = joint.joint_vector.local;
            let fits = match body.joint_vector {
                Some(vector) => found.set(vector, local),
                None => body.parent.is_none() || local == Vec2::ZERO,
            };
            let slide = body.slide.zip(joint.slide);
            let slide_fits = slide.is_none_or(|((_, vector), (_, along))| found.set(vector, along));
            if !fits || !slide_fits {
                return None;
            }
        }
        let vectors: Option<Vec<Vec2>> = found.of_frame.into_iter().collect();
        let joint_vectors = tree.joints.iter().map(|joint| joint.joint_vector.local);
        let points = lowered.pairs.iter().flat_map(|pair| pair.points);
        let all = vectors?.into_iter().chain(fixed).chain(joint_vectors);
        let all = all.chain(tree.joint_origins.iter().copied()).chain(points);
        Some(all.flat_map(|v| [v.x, v.y]).collect())
    }
}

impl<C: Constant> Plan<C> {
    /// How many numbers [`Plan::dimensions`] gives.
    pub fn dimension_count(&self) -> usize {
        let vectors = self.frame_vectors.len() + self.loop_closures.len() + self.tree.joints.len();
        2 * (vectors + self.tree.joint_origins.len() + 2 * self.lowered.pairs.len())
    }

    /// Sets the dimensions of another mechanism of this structure, in the order of [`Plan::dimensions`]. The results of
    /// the compiler on poses of its own mechanism (range, limits, near branches, the assembly and stored poses) are not
    /// changed.
    pub fn set_dimensions(&mut self, dimensions: &[C]) {
        let mut next = dimensions.chunks_exact(2).map(|v| vec2(v[0], v[1]));
        let mut fill = |to: &mut Vec2<C>| *to = next.next().unwrap_or(*to);
        for vector in &mut self.frame_vectors {
            fill(&mut vector.local);
        }
        for closure in &mut self.loop_closures {
            fill(&mut closure.fixed);
        }
        for joint in &mut self.tree.joints {
            fill(&mut joint.joint_vector.local);
        }
        self.tree.joint_origins.iter_mut().for_each(&mut fill);
        for pair in &mut self.lowered.pairs {
            pair.points.iter_mut().for_each(&mut fill);
        }
        for step in &mut self.steps {
            if let Step::RotateVector(vector, copy) = step {
                copy.local = self.frame_vectors[*vector].local;
            }
        }
        for assur in &mut self.groups {
            let local = |vector: usize| self.frame_vectors[vector].local;
            match &mut assur.kind {
                GroupKind::RrrDyad(dyad) => {
                    let fixed = self.loop_closures[dyad.closure].fixed;
                    dyad.set_lengths(dyad.vectors.map(local), fixed);
                }
                GroupKind::GuidedPoint(guided) => {
                    let mut vectors = guided.vectors.iter();
                    let rotating = vectors.find(|(_, frame)| *frame == guided.frame);
                    let vector = rotating.map_or(Vec2::zero(), |&(vector, _)| local(vector));
                    let fixed = self.loop_closures[guided.closure].fixed;
                    guided.set_lengths(local(guided.axis.0), vector, fixed);
                }
                GroupKind::Factored(_) => {}
            }
        }
    }
}
