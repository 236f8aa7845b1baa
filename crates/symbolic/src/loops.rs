//! Loops as sums of link vectors, derived independently of the plan, body by body, so that each vector can be rotated or
//! shifted when a joint is released.

use crate::algebra::Term;
use dwell_geometry::frames::Frames;
use dwell_geometry::lower::{Owner, PairKind};
use dwell_geometry::{Mechanism, Plan, Vec2, vec2};

/// A constant vector on a body.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LinkVector {
    pub(crate) body: usize,
    pub(crate) frame: usize,
    /// In the frame, m, in the direction of the loop.
    pub(crate) local: Vec2,
    /// The joints at its beginning and its end.
    pub(crate) joints: [String; 2],
}

/// A travel in a loop.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SlideTerm {
    pub(crate) slide: usize,
    /// The first body of its pair, in which its direction is fixed.
    pub(crate) body: usize,
    pub(crate) frame: usize,
    /// The direction of positive travel, in the frame.
    pub(crate) local: Vec2,
}

/// A loop: P₂ − P₁ of its loop joint, through the tree.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct LoopEquation {
    pub(crate) loop_joint: usize,
    pub(crate) link_vectors: Vec<LinkVector>,
    pub(crate) slide_terms: Vec<SlideTerm>,
    /// The tree joints in the loop, each with the sign of a shift of its second point.
    pub(crate) tree_pairs: Vec<(usize, f64)>,
    /// If only the normal component must be zero: the axis, with its body and frame.
    pub(crate) axis: Option<(usize, usize, Vec2)>,
    /// The steps of the part that earlier groups determine; a released joint shifts them.
    pub(crate) known_part: Option<[Term; 2]>,
    /// If it closes along a normal only: the step of the remaining normal distance, and the travel along the axis. A released
    /// joint shifts them, too.
    pub(crate) normal_distance: Option<(Term, Term)>,
}

/// Differences below this fraction of the coordinates are rounding errors.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The vector between two points of a body, in its frame.
pub(crate) fn vector_between(frames: &Frames, body: usize, from: Vec2, to: Vec2) -> Vec2 {
    let difference = without_rounding(to - from, from.norm() + to.norm());
    rotated_constant(difference, frames.orientations[body].offset)
}

/// A vector with components set to zero if they are rounding errors of terms of a given size.
pub(crate) fn without_rounding(vector: Vec2, terms: f64) -> Vec2 {
    let rounding = ROUNDING * terms;
    let clean = |d: f64| if d.abs() <= rounding { 0.0 } else { d };
    vec2(clean(vector.x), clean(vector.y))
}

/// A vector oriented along +x (or +y), and its sign, so that a vector and its reverse share a constant.
pub(crate) fn forward(local: Vec2) -> (Vec2, f64) {
    let back = local.x < 0.0 || (local.x == 0.0 && local.y < 0.0);
    let sign = if back { -1.0 } else { 1.0 };
    (local * sign + Vec2::ZERO, sign)
}

/// A vector rotated by a constant rotation; rounding errors of rotations by multiples of 90° are set to
/// zero.
pub(crate) fn rotated_constant(vector: Vec2, by: Vec2) -> Vec2 {
    without_rounding(vector.rotate(by), vector.norm())
}

/// The name of the joint or actuator of a kinematic pair.
pub(crate) fn pair_name(mechanism: &Mechanism, plan: &Plan, pair: usize) -> String {
    owner_name(mechanism, plan.pairs()[pair].owner)
}

/// The name of a joint or actuator.
pub(crate) fn owner_name(mechanism: &Mechanism, owner: Owner) -> String {
    match owner {
        Owner::Joint(joint) => mechanism.joints[joint.0].name.clone(),
        Owner::Actuator(actuator) => mechanism.actuators[actuator.0].name.clone(),
    }
}

impl LoopEquation {
    /// The loop that a loop joint closes.
    pub(crate) fn of(mechanism: &Mechanism, plan: &Plan, closure: usize) -> Self {
        let (tree, frames) = (plan.tree(), plan.frames());
        let loop_joint = plan.loop_closures[closure].pair;
        let pair = &plan.pairs()[loop_joint];
        let mut loop_equation = Self {
            loop_joint,
            ..Self::default()
        };
        let pairs = plan.pairs();
        let point_on = |b: usize, body| pairs[b].points[usize::from(pairs[b].bodies[0] != body)];
        let mut ends = [0, 1].map(|i| (pair.bodies[i], pair.points[i], loop_joint));
        while ends[0].0 != ends[1].0 {
            let which = usize::from(tree.joint_of_body[ends[1].0] > tree.joint_of_body[ends[0].0]);
            let sign = if which == 1 { 1.0 } else { -1.0 };
            let (body, point, reached) = ends[which];
            let Some(tree_joint) = tree.joint_of_body[body].map(|at| &tree.joints[at]) else {
                break;
            };
            let joint_origin = point_on(tree_joint.pair, body);
            let names = [tree_joint.pair, reached].map(|b| pair_name(mechanism, plan, b));
            loop_equation.add_link_vector(frames, body, [joint_origin, point], sign, names);
            let is_first = plan.pairs()[tree_joint.pair].bodies[1] != body;
            let pair_sign = if is_first { -sign } else { sign };
            loop_equation.tree_pairs.push((tree_joint.pair, pair_sign));
            if let Some((slide, away)) = tree_joint.slide {
                loop_equation.slide_terms.push(SlideTerm {
                    slide,
                    body: plan.pairs()[tree_joint.pair].bodies[0],
                    frame: frames.orientations[body].frame,
                    local: away * sign,
                });
            }
            let (parent, pair) = (tree_joint.parent, tree_joint.pair);
            ends[which] = (parent, point_on(pair, parent), pair);
        }
        let names = [ends[0].2, ends[1].2].map(|b| pair_name(mechanism, plan, b));
        loop_equation.add_link_vector(frames, ends[0].0, [ends[0].1, ends[1].1], 1.0, names);
        let vectors = &mut loop_equation.link_vectors;
        vectors.retain(|vector| vector.local != Vec2::ZERO);
        if let PairKind::Prismatic { axes, .. } = pair.kind {
            let body = pair.bodies[0];
            let orientation = frames.orientations[body];
            let local = rotated_constant(axes[0], orientation.offset);
            // A loop joint has a slide only if its travel is a coordinate.
            match tree.slide_pairs.iter().position(|&b| b == loop_joint) {
                Some(slide) => loop_equation.slide_terms.push(SlideTerm {
                    slide,
                    body,
                    frame: orientation.frame,
                    local: -local,
                }),
                None => loop_equation.axis = Some((body, orientation.frame, local)),
            }
        }
        loop_equation
    }

    fn add_link_vector(
        &mut self,
        frames: &Frames,
        body: usize,
        [from, to]: [Vec2; 2],
        sign: f64,
        joints: [String; 2],
    ) {
        self.link_vectors.push(LinkVector {
            body,
            frame: frames.orientations[body].frame,
            local: vector_between(frames, body, from, to) * sign,
            joints,
        });
    }
}
