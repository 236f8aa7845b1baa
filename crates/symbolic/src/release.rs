//! A joint released along one component, and the resulting shift of each step.
//!
//! A second coordinate shifts the joint's second body along the component by one unit. To first order,
//! which suffices for a and b, the known part of each loop is shifted by a sum over its vectors, and
//! the points of the bodies are shifted with the bodies that carry them.

use crate::algebra::{Term, number, scale, times, zero};
use crate::error::SymbolicError;
use crate::positions::{PositionFormulas, Vector, add, perp, rotate};
use dwell_geometry::frames::AngularConstraintSource;
use dwell_geometry::lower::PairKind;
use dwell_geometry::{Component, JointKind, Reaction, Vec2};
use std::collections::BTreeMap;

/// The constraint that is released.
#[derive(Debug, Clone)]
enum Released {
    /// A kinematic pair, along a direction in the plane.
    Pair(usize, Vector),
    /// The couple of a kinematic pair.
    Moment(usize),
    Coupling(usize),
}

/// A released joint: its shift of each step, and the rotation of each body relative to its frame.
#[derive(Debug, Clone)]
pub(crate) struct Release {
    released: Released,
    pub(crate) shifts: BTreeMap<String, Term>,
    pub(crate) extra_rotation: Vec<f64>,
}

impl Release {
    fn shift(&mut self, step: &Term, by: Term) {
        self.shifts.insert(step.to_string(), by);
    }
}

impl PositionFormulas<'_> {
    /// Releases one component of a joint. It may add constants, but no steps.
    pub(crate) fn release(&mut self, reaction: Reaction) -> Result<Release, SymbolicError> {
        let all = self.mechanism.reactions();
        let at = all.iter().position(|&r| r == reaction);
        if !at.is_some_and(|k| self.plan.is_determinate(k)) {
            return Err(SymbolicError::Reaction(reaction));
        }
        let released = self.released_constraint(reaction)?;
        let mut release = Release {
            extra_rotation: self.extra_rotations(&released),
            shifts: BTreeMap::new(),
            released,
        };
        for closure in 0..self.loops.len() {
            self.shift_loop(closure, &mut release);
        }
        self.shift_joint_origins(&mut release);
        self.shift_mass_centres(&mut release);
        self.shift_couplings(&mut release);
        Ok(release)
    }

    fn released_constraint(&mut self, reaction: Reaction) -> Result<Released, SymbolicError> {
        let Reaction { joint, component } = reaction;
        let unsupported = SymbolicError::Reaction(reaction);
        let (pair, coupling) = self.plan.joint_parts(joint);
        let is_relation = matches!(self.mechanism.joints[joint.0].kind, JointKind::Coupling(_));
        let pairs = self.plan.pairs();
        Ok(match (component, pair, coupling) {
            (Component::Tooth | Component::Tangent | Component::Force, _, Some(coupling)) => {
                Released::Coupling(coupling)
            }
            (Component::Moment, _, Some(coupling)) if is_relation => Released::Coupling(coupling),
            (Component::Moment, Some(pair), _) => Released::Moment(pair),
            (Component::X, Some(pair), _) => Released::Pair(pair, [number(1.0), zero()]),
            (Component::Y, Some(pair), _) => Released::Pair(pair, [zero(), number(1.0)]),
            (Component::Normal, Some(pair), _) => match pairs[pair].kind {
                PairKind::Prismatic { axes, .. } => {
                    let (frame, axis) = self.to_frame(pairs[pair].bodies[0], axes[0]);
                    let axis = self.direction(frame, axis, "direction of the guide");
                    Released::Pair(pair, perp(&rotate(&axis, &self.angle(frame))))
                }
                PairKind::Revolute | PairKind::Rigid { .. } => return Err(unsupported),
            },
            // The line of a distance is the x axis of its second body.
            (Component::Axial, Some(pair), _) => {
                let (frame, axis) = self.to_frame(pairs[pair].bodies[1], Vec2::IDENTITY);
                let axis = self.direction(frame, axis, "direction of the line");
                Released::Pair(pair, rotate(&axis, &self.angle(frame)))
            }
            (Component::X | Component::Y | Component::Normal | Component::Axial, None, _)
            | (Component::Tooth | Component::Tangent | Component::Force, _, None)
            | (Component::Moment, None, _) => return Err(unsupported),
        })
    }

    /// By body: its rotation from its frame for each unit.
    fn extra_rotations(&self, released: &Released) -> Vec<f64> {
        let mut extra_rotation = vec![0.0; self.plan.frames().orientations.len()];
        let Released::Moment(pair) = *released else {
            return extra_rotation;
        };
        for constraint in &self.plan.frames().angular_constraints {
            let relative = if constraint.source == AngularConstraintSource::Pair(pair) {
                // Its second body rotates from its first.
                if constraint.body_is_first { -1.0 } else { 1.0 }
            } else {
                0.0
            };
            extra_rotation[constraint.body] = extra_rotation[constraint.reference_body] + relative;
        }
        extra_rotation
    }

    fn shift_loop(&mut self, closure: usize, release: &mut Release) {
        let loop_equation = self.loops[closure].clone();
        let Some(known_part) = &loop_equation.known_part else {
            return;
        };
        let rotation = |body: usize| release.extra_rotation[body];
        let mut sum = [zero(), zero()];
        let link_vectors = loop_equation.link_vectors.iter();
        for link_vector in link_vectors.filter(|p| rotation(p.body) != 0.0) {
            let meaning = self.meaning(link_vector);
            let vector = self.frame_vector(link_vector.frame, link_vector.local, &meaning);
            let vector = rotate(&vector, &self.angle(link_vector.frame));
            let shift = perp(&vector).map(|c| scale(&c, rotation(link_vector.body)));
            sum = add(&sum, &shift);
        }
        let slide_terms = loop_equation.slide_terms.iter();
        for slide_term in slide_terms.filter(|p| rotation(p.body) != 0.0) {
            let along = self.travel_direction(slide_term.frame, slide_term.local);
            let travel = scale(&self.travel(slide_term.slide), rotation(slide_term.body));
            sum = add(&sum, &perp(&along).map(|c| times(&c, &travel)));
        }
        if let Released::Pair(released_pair, along) = &release.released {
            let closing_pair = (loop_equation.loop_joint, -1.0);
            for &(pair, sign) in loop_equation.tree_pairs.iter().chain([&closing_pair]) {
                if pair == *released_pair {
                    sum = add(&sum, &along.clone().map(|c| scale(&c, sign)));
                }
            }
        }
        for (step, shift) in known_part.iter().zip(sum) {
            release.shift(step, shift.simplify());
        }
        let normal_distance = &loop_equation.normal_distance;
        if let (Some((step, travel)), Some((body, ..))) = (normal_distance, loop_equation.axis)
            && release.extra_rotation[body] != 0.0
        {
            release.shift(step, scale(travel, release.extra_rotation[body]));
        }
    }

    fn shift_joint_origins(&mut self, release: &mut Release) {
        for tree_joint in &self.plan.tree().joints {
            let bodies = self.plan.pairs()[tree_joint.pair].bodies;
            let Some(joint_origin) = self.joint_origins[tree_joint.body].clone() else {
                continue;
            };
            let mut sum = [zero(), zero()];
            let parent_rotation = release.extra_rotation[tree_joint.parent];
            let first = release.extra_rotation[bodies[0]];
            if parent_rotation != 0.0 || first != 0.0 {
                // From the parent's joint origin, plus the travel along the first body's axis.
                let mut whole = joint_origin.clone();
                if let Some(parent) = &self.joint_origins[tree_joint.parent] {
                    whole = add(&whole, &parent.clone().map(|c| scale(&c, -1.0)));
                }
                let along = self.joint_travel(tree_joint);
                let arm = add(&whole, &along.clone().map(|c| scale(&c, -1.0)));
                for (vector, rotation) in [(arm, parent_rotation), (along, first)] {
                    let shift = perp(&vector).map(|c| times(&c, &number(rotation)));
                    sum = add(&shift, &sum);
                }
            }
            if let Released::Pair(released, along) = &release.released
                && *released == tree_joint.pair
            {
                let is_second = bodies[1] == tree_joint.body;
                let sign = if is_second { 1.0 } else { -1.0 };
                sum = add(&sum, &along.clone().map(|c| scale(&c, sign)));
            }
            for (step, shift) in joint_origin.iter().zip(sum) {
                release.shift(step, shift.simplify());
            }
        }
    }

    fn shift_mass_centres(&self, release: &mut Release) {
        let points = self.mass_centres.iter().zip(&self.joint_origins);
        for (body, points) in points.enumerate() {
            let (Some(centre), Some(joint_origin)) = points else {
                continue;
            };
            let rotation = release.extra_rotation[body];
            if rotation != 0.0 && centre != joint_origin {
                let arm = [0, 1].map(|i| centre[i].clone() - joint_origin[i].clone());
                for (step, shift) in centre.iter().zip(perp(&arm)) {
                    release.shift(step, scale(&shift, rotation).simplify());
                }
            }
        }
    }

    fn shift_couplings(&self, release: &mut Release) {
        let mut pose = self.plan.pose::<f64>();
        let plan = self.plan;
        let start = plan.assembly_coordinates();
        if plan.positions(start, &mut pose).is_err() {
            return;
        }
        for (coupling, solved) in self.solved_couplings.iter().enumerate() {
            let Some((step, slope)) = solved else {
                continue;
            };
            let mut shift = 0.0;
            plan.coupling_angle_derivatives(coupling, &pose, |body, factor| {
                shift += factor * release.extra_rotation[body];
            });
            if matches!(release.released, Released::Coupling(r) if r == coupling) {
                shift -= 1.0;
            }
            if shift != 0.0 {
                let shift = number(-shift) / slope.clone();
                release.shift(step, shift.simplify());
            }
        }
    }
}
