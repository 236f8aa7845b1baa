//! A joint that is released along one component, and how that shifts each step.
//!
//! A second coordinate shifts the joint's second body along the component by one unit. To first order,
//! which is all that a and b take of it, the known part of each loop is shifted by a sum over its pieces, and
//! the points of the bodies are shifted by what carries them.

use crate::algebra::{Term, number, scale, symbol, times, zero};
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

/// A released joint: what it adds to each step, and to each body's angle beside its frame's.
#[derive(Debug, Clone)]
pub(crate) struct Release {
    pub(crate) shifts: BTreeMap<String, Term>,
    pub(crate) extra_rotation: Vec<f64>,
}

impl PositionFormulas<'_> {
    /// Releases one component of a joint. Further constants may be named, and no steps.
    pub(crate) fn release(&mut self, reaction: Reaction) -> Result<Release, SymbolicError> {
        let all = self.mechanism.reactions();
        let at = all.iter().position(|&r| r == reaction);
        if !at.is_some_and(|k| self.plan.is_determinate(k)) {
            return Err(SymbolicError::Reaction(reaction));
        }
        let released = self.released_constraint(reaction)?;
        let extra_rotation = self.extra_rotations(&released);
        let mut shifts = BTreeMap::new();
        for closure in 0..self.loops.len() {
            self.shift_loop(closure, &released, &extra_rotation, &mut shifts);
        }
        self.shift_joint_origins(&released, &extra_rotation, &mut shifts);
        self.shift_mass_centres(&extra_rotation, &mut shifts);
        self.shift_couplings(&released, &extra_rotation, &mut shifts);
        Ok(Release {
            shifts,
            extra_rotation,
        })
    }

    fn released_constraint(&mut self, reaction: Reaction) -> Result<Released, SymbolicError> {
        let Reaction { joint, component } = reaction;
        let unsupported = SymbolicError::Reaction(reaction);
        let (pair, coupling) = self.plan.joint_parts(joint);
        let is_relation = matches!(self.mechanism.joints[joint.0].kind, JointKind::Coupling(_));
        match (component, pair, coupling) {
            (Component::Tooth | Component::Tangent | Component::Force, _, Some(coupling)) => {
                return Ok(Released::Coupling(coupling));
            }
            (Component::Moment, _, Some(coupling)) if is_relation => {
                return Ok(Released::Coupling(coupling));
            }
            (Component::Moment, Some(pair), _) => return Ok(Released::Moment(pair)),
            // Along a direction of a pair, below; or there is nothing to release, which is refused there.
            (Component::X | Component::Y | Component::Normal | Component::Axial, _, _)
            | (Component::Tooth | Component::Tangent | Component::Force, _, None)
            | (Component::Moment, None, _) => {}
        }
        let pair = pair.ok_or(unsupported.clone())?;
        let described = self.plan.pairs()[pair];
        let direction = match (component, described.kind) {
            (Component::X, _) => [number(1.0), zero()],
            (Component::Y, _) => [zero(), number(1.0)],
            (Component::Normal, PairKind::Prismatic { axes, .. }) => {
                let (frame, axis) = self.to_frame(described.bodies[0], axes[0]);
                let axis = self.direction(frame, axis, "direction of the guide");
                perp(&rotate(&axis, &self.angle(frame)))
            }
            // The line of a distance is the x axis of its second body.
            (Component::Axial, _) => {
                let (frame, axis) = self.to_frame(described.bodies[1], Vec2::IDENTITY);
                let axis = self.direction(frame, axis, "direction of the line");
                rotate(&axis, &self.angle(frame))
            }
            (Component::Normal, PairKind::Revolute | PairKind::Rigid { .. })
            | (Component::Moment | Component::Tooth | Component::Tangent | Component::Force, _) => {
                return Err(unsupported);
            }
        };
        Ok(Released::Pair(pair, direction))
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

    fn shift_loop(
        &mut self,
        closure: usize,
        released: &Released,
        extra_rotation: &[f64],
        shifts: &mut BTreeMap<String, Term>,
    ) {
        let Some(gap) = self.loop_symbols[closure].known_part.clone() else {
            return;
        };
        let loop_equation = self.loops[closure].clone();
        let mut sum = [zero(), zero()];
        for link_vector in loop_equation
            .link_vectors
            .iter()
            .filter(|p| extra_rotation[p.body] != 0.0)
        {
            let meaning = self.meaning(link_vector);
            let vector = self.frame_vector(link_vector.frame, link_vector.local, &meaning);
            let vector = rotate(&vector, &self.angle(link_vector.frame));
            sum = add(
                &sum,
                &perp(&vector).map(|c| scale(&c, extra_rotation[link_vector.body])),
            );
        }
        for slide_term in loop_equation
            .slide_terms
            .iter()
            .filter(|p| extra_rotation[p.body] != 0.0)
        {
            let along = self.direction(slide_term.frame, slide_term.local, "direction of travel");
            let along = rotate(&along, &self.angle(slide_term.frame));
            let travel = self.travels[slide_term.slide].clone().unwrap_or_else(zero);
            let travel = scale(&travel, extra_rotation[slide_term.body]);
            sum = add(&sum, &perp(&along).map(|c| times(&c, &travel)));
        }
        if let Released::Pair(released_pair, along) = released {
            for &(_, sign) in loop_equation
                .tree_pairs
                .iter()
                .filter(|(b, _)| b == released_pair)
            {
                sum = add(&sum, &along.clone().map(|c| scale(&c, sign)));
            }
            if loop_equation.loop_joint == *released_pair {
                sum = add(&sum, &along.clone().map(|c| scale(&c, -1.0)));
            }
        }
        for (code, shift) in gap.into_iter().zip(sum) {
            shifts.insert(code, shift.simplify());
        }
        if let (Some((code, travel)), Some((body, ..))) = (
            self.loop_symbols[closure].normal_distance.clone(),
            loop_equation.axis,
        ) && extra_rotation[body] != 0.0
        {
            shifts.insert(code, scale(&travel, extra_rotation[body]));
        }
    }

    fn shift_joint_origins(
        &mut self,
        released: &Released,
        extra_rotation: &[f64],
        shifts: &mut BTreeMap<String, Term>,
    ) {
        for index in 0..self.plan.tree().joints.len() {
            let tree_joint = self.plan.tree().joints[index];
            let kinematic_pair = self.plan.pairs()[tree_joint.pair];
            let mut sum = [zero(), zero()];
            let parent = self.joint_origins[tree_joint.parent].clone();
            let joint_origin = self.joint_origins[tree_joint.body].clone();
            let (Some(joint_origin), parent_rotation) =
                (joint_origin, extra_rotation[tree_joint.parent])
            else {
                continue;
            };
            let first = extra_rotation[kinematic_pair.bodies[0]];
            if parent_rotation != 0.0 || first != 0.0 {
                // From the parent's root, and the travel along the first body's axis.
                let mut whole = joint_origin.clone().map(|c| symbol(&c));
                if let Some(parent) = parent {
                    let parent = parent.map(|c| scale(&symbol(&c), -1.0));
                    whole = add(&whole, &parent);
                }
                let mut along = [zero(), zero()];
                if let Some((slide, away)) = tree_joint.slide {
                    let body_frame = self.plan.frames().orientations[tree_joint.body].frame;
                    let vector = self.direction(body_frame, away, "direction of travel");
                    let vector = rotate(&vector, &self.angle(body_frame));
                    let travel = self.travels[slide].clone().unwrap_or_else(zero);
                    along = vector.map(|c| times(&c, &travel));
                }
                let arm = add(&whole, &along.clone().map(|c| scale(&c, -1.0)));
                sum = add(
                    &perp(&arm).map(|c| times(&c, &number(parent_rotation))),
                    &sum,
                );
                sum = add(&perp(&along).map(|c| times(&c, &number(first))), &sum);
            }
            if let Released::Pair(released, along) = released
                && *released == tree_joint.pair
            {
                let sign = if kinematic_pair.bodies[1] == tree_joint.body {
                    1.0
                } else {
                    -1.0
                };
                sum = add(&sum, &along.clone().map(|c| scale(&c, sign)));
            }
            for (code, shift) in joint_origin.into_iter().zip(sum) {
                shifts.insert(code, shift.simplify());
            }
        }
    }

    fn shift_mass_centres(&self, extra_rotation: &[f64], shifts: &mut BTreeMap<String, Term>) {
        for (body, &parent_rotation) in extra_rotation.iter().enumerate() {
            let (Some(centre), Some(joint_origin)) = (
                self.mass_centres[body].clone(),
                self.joint_origins[body].clone(),
            ) else {
                continue;
            };
            if parent_rotation != 0.0 && centre != joint_origin {
                let arm = [0, 1].map(|i| symbol(&centre[i]) - symbol(&joint_origin[i]));
                let arm = perp(&arm).map(|c| scale(&c, parent_rotation).simplify());
                shifts.extend(centre.into_iter().zip(arm));
            }
        }
    }

    fn shift_couplings(
        &self,
        released: &Released,
        extra_rotation: &[f64],
        shifts: &mut BTreeMap<String, Term>,
    ) {
        let mut pose = self.plan.pose::<f64>();
        let plan = self.plan;
        if plan
            .positions(plan.assembly_coordinates(), &mut pose)
            .is_err()
        {
            return;
        }
        for coupling in 0..self.solved_couplings.len() {
            let Some((code, slope)) = &self.solved_couplings[coupling] else {
                continue;
            };
            let mut shift = 0.0;
            plan.coupling_angle_derivatives(coupling, &pose, |body, factor| {
                shift += factor * extra_rotation[body];
            });
            if matches!(released, Released::Coupling(r) if *r == coupling) {
                shift -= 1.0;
            }
            if shift != 0.0 {
                let shift = number(-shift) / slope.clone();
                shifts.insert(code.clone(), shift.simplify());
            }
        }
    }
}
