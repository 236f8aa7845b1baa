//! Positions: from the actuators' coordinates to the orientation of every body, group by group.

mod closed_forms;
mod construct;
mod factored_group;
mod nearness;
mod solution;

use crate::error::PositionError;
use crate::motion::Motion;
use crate::plan::{ActuatedFrame, GroupKind, PlacementMethod, Plan, Pose, Step};
use crate::plane::{Vec2, vec2};
use crate::structure::groups::Unknown;
use crate::structure::lower::Owner;
use crate::structure::tree::FrameVector;
pub(crate) use closed_forms::is_plain;
use closed_forms::{guided_point_positions, rrr_dyad_positions};
use dwell_numerics::{Constant, Lift, Scalar, lu};
use std::f64::consts::TAU;

/// Steps per revolution of an actuator where a branch is followed. A group's pose changes little over 3°,
/// so that Newton's method needs two or three iterations; where it changes faster, steps are halved.
pub(crate) const STEPS_PER_REVOLUTION: usize = 120;

/// Largest number of steps from the assembly: no mechanism is driven a thousand revolutions away
/// from where it was assembled, but a careless number may ask for it.
const MAX_PATH_STEPS: f64 = 120_000.0;

/// Where Newton's method starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum InitialIterate {
    /// From stored poses, so that the pose depends on the coordinate alone.
    StoredPose,
    /// From the values in the pose (while the branch is being followed).
    CurrentPose,
    /// From the values in the pose, which solve the equations: one step of Newton's method makes their derivatives exact.
    Solution,
}

impl<C: Constant> Plan<C> {
    /// Computes the positions at the coordinates `q` (rad or m). The pose depends on `q` alone.
    ///
    /// # Errors
    /// [`PositionError`] when a group cannot close there, is singular, or `q` is out of range.
    #[inline(always)]
    pub fn positions<T: Lift<C>>(&self, q: &[T], pose: &mut Pose<T>) -> Result<(), PositionError> {
        if T::LANES > 1 && !self.supports_lanes() {
            return Err(PositionError::LanesDiverge { q: q[0].value() });
        }
        // Outside its range a closed form may close again, but on a branch that cannot be reached.
        if self.range.limits().is_some() {
            let lanes = (0..T::LANES).map(|lane| q[0].lane(lane));
            for q in lanes.filter(|q| q.is_finite()) {
                self.range.wrap(q)?;
            }
        }
        if self.actuators() > 1 && self.groups.iter().any(|g| g.uses_stored_poses && !g.pruned) {
            return self.positions_continued(q, pose);
        }
        self.positions_from(q, pose, InitialIterate::StoredPose)
    }

    /// Whether every group has a closed form whose decisions can be checked in every lane: no iteration, no counted
    /// revolutions, no coupling by a law.
    pub fn supports_lanes(&self) -> bool {
        self.groups.iter().filter(|g| !g.pruned).all(|assur| {
            let straight = match &assur.kind {
                GroupKind::RrrDyad(_) | GroupKind::GuidedPoint(_) => true,
                GroupKind::Factored(factored_group) => {
                    factored_group.method != PlacementMethod::Newton
                        && !factored_group.is_overdetermined()
                        && !lu::uses_faer(factored_group.columns)
                }
            };
            let of = &assur.group.couplings;
            straight
                && !assur.counts_revolutions
                && of.iter().all(|&r| self.couplings[r].law.is_none())
        })
    }

    /// Whether every group is a dyad or a guided body, whose closed forms are inlined into an evaluation. The
    /// others have functions of their own.
    pub fn is_dyadic(&self) -> bool {
        let mut groups = self.groups.iter().filter(|g| !g.pruned);
        groups.all(|g| matches!(g.kind, GroupKind::RrrDyad(_) | GroupKind::GuidedPoint(_)))
    }

    /// Follows the straight path from the assembly to `q`: with several actuators there are no stored poses to start
    /// from.
    #[inline(never)]
    fn positions_continued<T: Lift<C>>(
        &self,
        q: &[T],
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        let Some(assembly_pose) = &self.assembly_pose else {
            return self.positions_from(q, pose, InitialIterate::CurrentPose);
        };
        pose.start_from(assembly_pose);
        let mut steps = 1.0_f64;
        for (i, (to, from)) in q.iter().zip(&self.assembly_coordinates).enumerate() {
            let whole = (to.value() - from) / self.continuation_step(i);
            steps = steps.max(whole.abs().ceil());
        }
        let mut coordinates = std::mem::take(&mut pose.path_coordinates);
        let mut result = Ok(());
        for k in 1..=steps.min(MAX_PATH_STEPS) as usize {
            let fraction = k as f64 / steps;
            let ends = q.iter().zip(&self.assembly_coordinates);
            for (on, (&to, &from)) in coordinates.iter_mut().zip(ends) {
                *on = if fraction < 1.0 {
                    T::from_f64(from + (to.value() - from) * fraction)
                } else {
                    to
                };
            }
            result = self.positions_from(&coordinates, pose, InitialIterate::CurrentPose);
            if result.is_err() {
                break;
            }
        }
        pose.path_coordinates = coordinates;
        result?;
        self.check_branch(pose)
    }

    /// A step of an actuator over which a pose changes little, rad or m.
    pub(crate) fn continuation_step(&self, actuator: usize) -> f64 {
        if self.angular[actuator] {
            TAU / STEPS_PER_REVOLUTION as f64
        } else {
            self.size * TAU / STEPS_PER_REVOLUTION as f64
        }
    }

    #[inline(always)]
    pub(crate) fn positions_from<T: Lift<C>>(
        &self,
        q: &[T],
        pose: &mut Pose<T>,
        initial_iterate: InitialIterate,
    ) -> Result<(), PositionError> {
        take_coordinates(q, pose)?;
        self.run_steps(&self.steps, pose, initial_iterate)
    }

    /// The positions at the coordinates `q` of a group and all before it.
    pub(crate) fn positions_up_to<T: Lift<C>>(
        &self,
        group: usize,
        q: &[T],
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        pose.q.copy_from_slice(q);
        let steps = &self.steps[..=self.solve_steps[group]];
        self.run_steps(steps, pose, InitialIterate::CurrentPose)
    }

    /// The step after the group before.
    fn first_step(&self, group: usize) -> usize {
        let before = group.checked_sub(1);
        before.map_or(0, |before| self.solve_steps[before] + 1)
    }

    #[inline(always)]
    fn run_steps<T: Lift<C>>(
        &self,
        steps: &[Step<C>],
        pose: &mut Pose<T>,
        initial_iterate: InitialIterate,
    ) -> Result<(), PositionError> {
        for step in steps {
            match step {
                Step::SetSlide(slide, actuator) => pose.slide_travel[*slide] = pose.q[*actuator],
                Step::RotateFrame(actuated) => rotate_frame(actuated, pose),
                Step::RotateVector(vector, FrameVector { frame, local }) => {
                    pose.vector[*vector] = local.cast::<T>().rotate(pose.rotation[*frame]);
                }
                Step::SolveGroup(g) => {
                    match &self.groups[*g].kind {
                        GroupKind::RrrDyad(dyad) => {
                            rrr_dyad_positions(dyad, &self.frame_vectors, *g, pose)?;
                        }
                        GroupKind::GuidedPoint(guided) => {
                            guided_point_positions(guided, &self.frame_vectors, *g, pose)?;
                        }
                        GroupKind::Factored(factored_group) => {
                            self.factored_positions(*g, factored_group, pose, initial_iterate)?;
                        }
                    }
                    if self.groups[*g].counts_revolutions {
                        self.count_revolutions(*g, pose, initial_iterate)?;
                    }
                    if self.groups[*g].has_table {
                        self.check_tables(*g, pose)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Checks that the tables of a group's couplings have values. Few groups have any: the steps of the others stay as they are compiled.
    #[cold]
    fn check_tables<T: Scalar>(&self, group: usize, pose: &Pose<T>) -> Result<(), PositionError> {
        for &r in &self.groups[group].group.couplings {
            let off_table = self.couplings[r].off_table(&pose.angle, &pose.slide_travel);
            if let (Some([x, end]), Owner::Joint(coupling)) = (off_table, self.couplings[r].owner) {
                let q = pose.first_coordinate();
                return Err(PositionError::OffTable {
                    coupling,
                    q,
                    x,
                    end,
                });
            }
        }
        Ok(())
    }

    /// Counts the whole revolutions of a group's classes where a coupling or a load needs them: the number that is
    /// nearest to the stored angle, or to the last one while a branch is followed.
    #[inline(never)]
    fn count_revolutions<T: Scalar>(
        &self,
        group: usize,
        pose: &mut Pose<T>,
        initial_iterate: InitialIterate,
    ) -> Result<(), PositionError> {
        let assur = &self.groups[group];
        if let Some(PlacementMethod::Newton | PlacementMethod::GearTrain) =
            assur.kind.placement_method()
        {
            return Ok(());
        }
        let nearest = match initial_iterate {
            InitialIterate::StoredPose if assur.uses_stored_poses => Some(
                assur
                    .stored_poses
                    .nearest(pose.first_coordinate(), self.range)?,
            ),
            _ => None,
        };
        for (i, &unknown) in assur.group.unknowns.iter().enumerate() {
            let Unknown::ClassAngle(class) = unknown else {
                continue;
            };
            let class_frame = self.class_frame(class);
            if !self.revolution_counted[class_frame] {
                continue;
            }
            let expected = match (self.carrier_phases.get(&class_frame), nearest) {
                (Some(&(carrier, phase)), _) => pose.angle[carrier].value() + phase,
                (None, Some(nearest)) => assur.stored_poses.predict(nearest, i),
                (None, None) => pose.angle[class_frame].value(),
            };
            let angle = pose.rotation[class_frame]
                .y
                .atan2(pose.rotation[class_frame].x);
            let revolutions = ((expected - angle.value()) / TAU).round();
            pose.angle[class_frame] = angle + T::from_revolutions(revolutions);
        }
        Ok(())
    }

    /// Sets a pose from the coordinates, the angles of all frames (rad) and the travels of all slides
    /// (m), from any source. It holds no factors: states of bodies can be taken from it, but no velocities
    /// or multipliers.
    pub fn set_coordinates<T: Lift<C>>(
        &self,
        q: &[T],
        angles: &[T],
        slides: &[T],
        pose: &mut Pose<T>,
    ) {
        pose.q.copy_from_slice(q);
        pose.angle.copy_from_slice(angles);
        pose.slide_travel.copy_from_slice(slides);
        for (rotation, angle) in pose.rotation.iter_mut().zip(angles) {
            let (sin, cos) = angle.sin_cos();
            *rotation = vec2(cos, sin);
        }
        for (vector, FrameVector { frame, local }) in
            pose.vector.iter_mut().zip(&self.frame_vectors)
        {
            *vector = local.cast::<T>().rotate(pose.rotation[*frame]);
        }
    }

    /// The frame whose angle is a class's unknown.
    pub fn class_frame(&self, class: usize) -> usize {
        self.class_frames[class]
    }

    /// The joint origin of each moving body in ground axes, in their order, m.
    pub fn joint_origins<T: Lift<C>>(&self, pose: &Pose<T>, joint_origins: &mut Vec<Vec2<T>>) {
        joint_origins.clear();
        for (moving_body, tree_joint) in self.moving_bodies.iter().zip(&self.tree.joints) {
            let mut joint_origin = match moving_body.parent {
                Some(parent) => joint_origins[parent],
                None => self.tree.joint_origins[self.lowered.ground].cast(),
            };
            joint_origin += match moving_body.joint_vector {
                Some(vector) => pose.vector[vector],
                None => tree_joint.joint_vector.local.cast(),
            };
            if let Some((slide, direction)) = moving_body.slide {
                joint_origin += pose.vector[direction] * pose.slide_travel[slide];
            }
            joint_origins.push(joint_origin);
        }
    }
}

impl Plan {
    /// The positions at a coordinate of a plan of closed forms, and its velocities at unit velocity there, group by group: of a
    /// large plan each group is read from memory once. `each` is called after each group, and ends all where it is false.
    ///
    /// # Errors
    /// [`PositionError`] where a group cannot close.
    pub(crate) fn unit_motion_by_groups(
        &self,
        q: f64,
        pose: &mut Pose<f64>,
        motion: &mut Motion<f64>,
        mut each: impl FnMut(usize, &Pose<f64>, &Motion<f64>) -> bool,
    ) -> Result<bool, PositionError> {
        take_coordinates(&[q], pose)?;
        self.set_actuated(&[1.0], &mut motion.velocity);
        for (g, assur) in self.groups.iter().enumerate() {
            self.group_positions(g, pose)?;
            let inverse = pose.inverse_determinant[g];
            self.group_velocities(assur, inverse, pose, &[1.0], motion);
            if !each(g, pose, motion) {
                return Ok(false);
            }
        }
        let rest = &self.steps[self.first_step(self.groups.len())..];
        self.run_steps(rest, pose, InitialIterate::CurrentPose)?;
        Ok(true)
    }

    /// Runs the steps after the group before, this group's solution included: at assembly, when all groups before it are
    /// solved.
    pub(crate) fn group_positions(
        &self,
        group: usize,
        pose: &mut Pose<f64>,
    ) -> Result<(), PositionError> {
        let steps = &self.steps[self.first_step(group)..=self.solve_steps[group]];
        self.run_steps(steps, pose, InitialIterate::CurrentPose)
    }

    /// Runs the steps between the group before and this one.
    pub(crate) fn positions_before(
        &self,
        group: usize,
        pose: &mut Pose<f64>,
    ) -> Result<(), PositionError> {
        let steps = &self.steps[self.first_step(group)..self.solve_steps[group]];
        self.run_steps(steps, pose, InitialIterate::CurrentPose)
    }
}

/// Sets the actuators' coordinates.
#[inline(always)]
fn take_coordinates<T: Scalar>(q: &[T], pose: &mut Pose<T>) -> Result<(), PositionError> {
    for (coordinate, &value) in pose.q.iter_mut().zip(q) {
        // Of several lanes all at once; where that does not tell, each.
        if T::LANES == 1 || !T::from_f64(f64::MAX).exceeds(value * value) {
            for q in (0..T::LANES).map(|lane| value.lane(lane)) {
                if !q.is_finite() {
                    return Err(PositionError::NotFinite);
                }
            }
        }
        *coordinate = value;
    }
    Ok(())
}

/// Rotates a frame by its actuator's coordinate.
#[inline(always)]
pub(crate) fn rotate_frame<T: Scalar>(actuated: &ActuatedFrame, pose: &mut Pose<T>) {
    let (sin, cos) = pose.q[actuated.actuator].sin_cos();
    let by = vec2(cos, if actuated.sign < 0.0 { -sin } else { sin });
    pose.rotation[actuated.frame] = if actuated.parent == 0 {
        by
    } else {
        pose.rotation[actuated.parent].rotate(by)
    };
    if actuated.revolution_counted {
        pose.angle[actuated.frame] =
            pose.angle[actuated.parent] + T::from_f64(actuated.sign) * pose.q[actuated.actuator];
    }
}
