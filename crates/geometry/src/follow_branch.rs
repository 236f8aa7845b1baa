//! Follows the branch of the assembly over the range of a single actuator, and stores poses along it for the groups
//! whose positions are found by iteration.

mod margins;
mod separation;
mod step_buffers;

use crate::error::{AssemblyError, PositionError};
use crate::plan::range::{NearBranch, Range, RangeLimit};
use crate::plan::stored_poses::{StoredPose, StoredPoses};
use crate::plan::{AssurGroup, GroupKind, PlacementMethod, Plan, Pose};
use crate::plane::{Vec2, vec2};
use crate::positions::{InitialIterate, STEPS_PER_REVOLUTION};
use crate::structure::groups::Unknown;
use crate::structure::lower::Owner;
use dwell_numerics::Dual;
use std::f64::consts::TAU;
use step_buffers::StepBuffers;

/// Revolutions after which a branch that neither ends nor closes is no longer followed.
const MAX_REVOLUTIONS: u32 = 8;
/// A branch ends at a change point where a determinant has fallen to this part of its largest value so far: its
/// rounding error is eps over that part, so that closer to the change point rounding would decide which branch follows.
const CHANGE_POINT_DETERMINANT: f64 = 1e-6;
/// A change point is distinguished from a limit position by the product of the determinant and its slope: to
/// the former it falls as the determinant itself, to the latter (a square root) it stays as it is.
const CHANGE_POINT_PRODUCT: f64 = 1e-3;
/// Beyond a limit position with a smaller product another branch may be near.
const NEAR_PRODUCT: f64 = 0.1;
/// A step is taken if the tangents of all determinants stay clear of zero over this multiple of its length: towards a
/// limit position, where they fall as a square root, the distance left is halved.
const TANGENT_CLEARANCE: f64 = 4.0;
/// Two poses are one if they differ by less: rad, or of the lengths of a group.
const SAME_POSE: f64 = 1e-6;
/// Where the branch cannot be followed any further, the step is halved until it is this small, rad.
const MIN_STEP: f64 = 2e-14;
/// A pose from which the poses next to a limit can be followed again has a determinant of this part of the largest.
const ANCHOR_DETERMINANT: f64 = 1e-2;
/// Branches that both fold back within this part of the coordinate cannot be followed to their limits one by one.
const MIN_FOLD_HALF_WIDTH: f64 = 2e-6;

impl Plan {
    /// Follows the branch from the assembly over the range of a single actuator, in both directions, and
    /// stores poses. With several actuators there is no range to follow.
    pub(crate) fn follow_branch(&mut self, assembly_pose: &Pose<f64>) -> Result<(), AssemblyError> {
        if self.actuators() != 1 {
            self.range = Range::Unbounded;
            return Ok(());
        }
        let mut ahead = vec![assembly_pose.clone()];
        let mut up = None;
        let mut near = Vec::new();
        for revolutions in 1..=MAX_REVOLUTIONS {
            up = self.follow_direction(&mut ahead, 1.0, 1, &mut near);
            if up.is_some() {
                break;
            }
            // A table is not continued by another revolution.
            let repeats = self.angular[0] && !self.groups.iter().any(|g| g.has_table);
            if repeats && self.is_same_pose(assembly_pose, ahead.last()) {
                self.store_poses(&ahead);
                self.near_branches = near;
                self.range = match revolutions {
                    1 => Range::Full,
                    revolutions => Range::Revolutions(revolutions),
                };
                return Ok(());
            }
        }
        let mut back = vec![assembly_pose.clone()];
        let down = self.follow_direction(&mut back, -1.0, MAX_REVOLUTIONS, &mut near);
        self.near_branches = near;
        back.reverse();
        back.pop();
        back.extend(ahead);
        self.store_poses(&back);
        self.range_limits = [down, up];
        let far = |pose: Option<&Pose<f64>>| pose.map_or(assembly_pose.q[0], |p| p.q[0]);
        let (first, last) = (far(back.first()), far(back.last()));
        let [down, up] = [down.map(|_| first), up.map(|_| last)];
        self.range = match (down, up) {
            (Some(from), Some(to)) if self.angular[0] => Range::Limited(from, to),
            (Some(from), Some(to)) => Range::Stroke(from, to),
            (None, None) if !self.groups.iter().any(|g| g.uses_stored_poses) => Range::Unbounded,
            (None, None) => Range::Unresolved(first, last),
            // An end on one side only: the other is as far as it was followed.
            (from, to) => Range::Stroke(from.unwrap_or(first), to.unwrap_or(last)),
        };
        Ok(())
    }

    /// Follows the branch for some revolutions from the last pose and collects the poses; returns where the branch ends,
    /// if it does: at a limit position, or at a change point, where two branches meet.
    //
    // Long: the step length, the margins and the largest margins change together at each step.
    fn follow_direction(
        &self,
        poses: &mut Vec<Pose<f64>>,
        direction: f64,
        revolutions: u32,
        near: &mut Vec<NearBranch>,
    ) -> Option<RangeLimit> {
        let uses_stored_poses = self.groups.iter().any(|g| g.uses_stored_poses);
        let mut pose = poses.last()?.clone();
        let q0 = pose.q[0];
        let mut buffers = StepBuffers::new(self);
        let Some(mut margins) = self.margins_of_pose(&pose, &mut buffers) else {
            return Some(RangeLimit {
                q: q0,
                group: 0,
                change_point: false,
                separation: None,
                table: None,
            });
        };
        let mut anchor = pose.clone();
        let size = |m: &Dual| [m.v, (m.v * m.d).abs()];
        let mut largest: Vec<[f64; 2]> = margins.iter().map(size).collect();
        for k in 1..=revolutions as usize * STEPS_PER_REVOLUTION {
            let target = if self.angular[0] {
                q0 + direction * TAU * k as f64 / STEPS_PER_REVOLUTION as f64
            } else {
                q0 + direction * self.continuation_step(0) * k as f64
            };
            let mut fine = target - pose.q[0];
            while pose.q[0] != target {
                let left = target - pose.q[0];
                let next = if fine.abs() >= left.abs() {
                    target
                } else {
                    pose.q[0] + fine
                };
                let ended = |left: &[Dual]| {
                    let mut both = left.iter().zip(&largest);
                    both.any(|(margin, maximum)| {
                        let [value, product] = size(margin);
                        value < CHANGE_POINT_DETERMINANT * maximum[0]
                            && product < CHANGE_POINT_PRODUCT * maximum[1]
                    })
                };
                let advanced = self.advance(&pose, &margins, next, &mut buffers);
                let reached = &mut buffers.reached;
                let at_change_point = advanced.as_ref().is_some_and(|left| ended(left));
                match advanced.filter(|_| !at_change_point) {
                    Some(left) => {
                        for (maximum, margin) in largest.iter_mut().zip(&left) {
                            let [value, product] = size(margin);
                            *maximum = [maximum[0].max(value), maximum[1].max(product)];
                        }
                        near.extend(
                            self.branches_passed([pose.q[0], reached.q[0]], [&margins, &left]),
                        );
                        let mut both = left.iter().zip(&largest);
                        if both.all(|(margin, maximum)| {
                            size(margin)[0] > ANCHOR_DETERMINANT * maximum[0]
                        }) {
                            self.note_pose(&mut anchor, reached);
                        }
                        match &mut poses[..] {
                            // Only the ends are wanted.
                            [_, .., last] if !uses_stored_poses => self.note_pose(last, reached),
                            _ => poses.push(reached.clone()),
                        }
                        std::mem::swap(&mut pose, reached);
                        margins = left;
                        fine *= 2.0;
                    }
                    None => {
                        fine = (next - pose.q[0]) * 0.5;
                        let unit = if self.angular[0] { 1.0 } else { self.size };
                        if fine.abs() < MIN_STEP * (unit + pose.q[0].abs()) {
                            if let Some(limit) = self.table_end(&pose, next) {
                                self.complete_pose(poses.last_mut());
                                return Some(limit);
                            }
                            let relative_margin = |g: &usize| margins[*g].v / largest[*g][0];
                            let group = (0..margins.len())
                                .min_by(|a, b| relative_margin(a).total_cmp(&relative_margin(b)))
                                .unwrap_or(0);
                            let change_point = at_change_point
                                || size(&margins[group])[1]
                                    < CHANGE_POINT_PRODUCT * largest[group][1];
                            let margin = &margins[group];
                            let shallow = size(margin)[1] < NEAR_PRODUCT * largest[group][1];
                            self.complete_pose(Some(&mut anchor));
                            self.complete_pose(poses.last_mut());
                            let anchor = Some(&anchor).filter(|_| shallow || change_point);
                            let (limit, behind) = self.limit_near(
                                &pose,
                                margin,
                                direction,
                                group,
                                change_point,
                                anchor,
                            );
                            near.extend(behind);
                            return Some(limit);
                        }
                    }
                }
            }
        }
        self.complete_pose(poses.last_mut());
        None
    }

    /// The end of the range after a pose, where a coupling's table has no value at the next coordinate.
    fn table_end(&self, pose: &Pose<f64>, next: f64) -> Option<RangeLimit> {
        let mut beyond = pose.clone();
        let found = self.positions_from(&[next], &mut beyond, InitialIterate::CurrentPose);
        let Err(PositionError::OffTable { coupling, .. }) = found else {
            return None;
        };
        let owns = |&r: &usize| self.couplings[r].owner == Owner::Joint(coupling);
        let mut groups = self.groups.iter();
        Some(RangeLimit {
            q: pose.q[0],
            group: groups.position(|g| g.group.couplings.iter().any(owns))?,
            change_point: false,
            separation: None,
            table: Some(coupling),
        })
    }

    /// The limit at which a branch ends soon after a pose, in a direction of the coordinate, and the branch beyond it, if
    /// one is near. `margin` is that of the group that ends it.
    fn limit_near(
        &self,
        pose: &Pose<f64>,
        margin: &Dual,
        direction: f64,
        group: usize,
        change_point: bool,
        anchor: Option<&Pose<f64>>,
    ) -> (RangeLimit, Option<NearBranch>) {
        // Where the determinant crosses zero, the last step is Newton's.
        let left = if change_point {
            -margin.v / margin.d
        } else {
            0.0
        };
        let is_near = left * direction > 0.0 && left.abs() < self.continuation_step(0);
        let q = pose.q[0] + if is_near { left } else { 0.0 };
        let found = anchor.and_then(|anchor| self.separation(group, q, anchor));
        let behind = found.and_then(|found| self.branch_beyond(group, found));
        let smallest = MIN_FOLD_HALF_WIDTH * self.coordinate_unit();
        let folds = found.is_some_and(|found| found.square < -smallest * smallest);
        // Where both branches fold back, it is a limit position of each.
        let meets = change_point && !folds;
        let limit = RangeLimit {
            q: if meets == change_point { q } else { pose.q[0] },
            group,
            change_point: meets,
            separation: behind.filter(|_| meets).map(|b| b.half_width),
            table: None,
        };
        (limit, behind)
    }

    /// The pose at `q` on the same branch as a nearby pose, with its margins, if it is certain to be
    /// the same branch. Where the tangent of a margin, from either end, reaches zero within the step,
    /// two branches may meet in between: a parallelogram's margin falls to zero and rises again on
    /// the other branch, with the same sign at both ends.
    fn advance(
        &self,
        from: &Pose<f64>,
        margins: &[Dual],
        q: f64,
        buffers: &mut StepBuffers,
    ) -> Option<Vec<Dual>> {
        let clearance = TANGENT_CLEARANCE * (q - from.q[0]);
        // The tangents at this end need no pose at the other.
        if !margins.iter().all(|a| a.v + a.d * clearance > 0.0) {
            return None;
        }
        let is_clear = |new: &Dual| new.v - new.d * clearance > 0.0;
        if self.is_dyadic() {
            // Closed forms need no prediction.
            return self.closed_form_margins(from, q, buffers, is_clear);
        }
        buffers.reached = self.corrected_pose(from, q)?;
        let found = self.margins_by_duals(&buffers.reached, &mut buffers.with_slopes)?;
        found.iter().all(is_clear).then_some(found)
    }

    /// The pose at `q` near another one, if every correction is small relative to its prediction.
    fn corrected_pose(&self, from: &Pose<f64>, q: f64) -> Option<Pose<f64>> {
        let mut pose = from.clone();
        if self.is_explicit() {
            let found = self.positions_from(&[q], &mut pose, InitialIterate::CurrentPose);
            return found.is_ok().then_some(pose);
        }
        self.predict_unknowns(from, q - from.q[0], &mut pose);
        let predicted = pose.clone();
        self.positions_from(&[q], &mut pose, InitialIterate::CurrentPose)
            .ok()?;
        for (g, assur) in self.groups.iter().enumerate() {
            let GroupKind::Factored(factored_group) = &assur.kind else {
                continue;
            };
            let outcome = self.factor_jacobian(g, factored_group, &mut pose).ok()?;
            if outcome.determinant_sign * factored_group.branch <= 0.0 {
                return None;
            }
            if factored_group.method != PlacementMethod::Newton {
                continue;
            }
            for &unknown in &assur.group.unknowns {
                // A correction as large as the step itself may have led to another branch.
                let (moved, corrected) = match unknown {
                    Unknown::ClassAngle(c) => {
                        let f = self.class_frame(c);
                        let angle_between = |a: Vec2, b: Vec2| a.cross(b).atan2(a.dot(b)).abs();
                        (
                            angle_between(from.rotation[f], predicted.rotation[f]),
                            angle_between(predicted.rotation[f], pose.rotation[f]),
                        )
                    }
                    Unknown::SlideTravel(s) => (
                        (predicted.slide_travel[s] - from.slide_travel[s]).abs() / assur.size,
                        (pose.slide_travel[s] - predicted.slide_travel[s]).abs() / assur.size,
                    ),
                };
                if corrected > 0.25 * moved.max(0.02) {
                    return None;
                }
            }
        }
        Some(pose)
    }

    /// First-order prediction of the Newton groups' unknowns.
    fn predict_unknowns(&self, from: &Pose<f64>, step: f64, pose: &mut Pose<f64>) {
        let mut motion = self.motion();
        self.velocities(from, &[1.0], &mut motion);
        for assur in &self.groups {
            if assur.kind.placement_method() != Some(PlacementMethod::Newton) {
                continue;
            }
            for &unknown in &assur.group.unknowns {
                match unknown {
                    Unknown::ClassAngle(c) => {
                        let f = self.class_frame(c);
                        let by = motion.velocity.angular[f] * step;
                        if self.revolution_counted[f] {
                            self.set_class_angle(c, from.angle[f] + by, pose);
                        } else {
                            pose.rotation[f] = from.rotation[f].rotate(Vec2::from_angle(by));
                        }
                    }
                    Unknown::SlideTravel(s) => {
                        pose.slide_travel[s] =
                            from.slide_travel[s] + motion.velocity.slide[s] * step;
                    }
                }
            }
        }
    }

    /// Whether a pose is the start again.
    fn is_same_pose(&self, start: &Pose<f64>, end: Option<&Pose<f64>>) -> bool {
        let Some(end) = end else {
            return false;
        };
        let is_same = |assur: &AssurGroup| {
            assur.group.unknowns.iter().all(|&u| match u {
                Unknown::ClassAngle(c) => {
                    let f = self.class_frame(c);
                    (start.rotation[f] - end.rotation[f]).norm() < SAME_POSE
                }
                Unknown::SlideTravel(s) => {
                    (start.slide_travel[s] - end.slide_travel[s]).abs() < SAME_POSE * assur.size
                }
            })
        };
        self.groups.iter().all(is_same)
    }

    fn store_poses(&mut self, poses: &[Pose<f64>]) {
        if !self.groups.iter().any(|g| g.uses_stored_poses) {
            return;
        }
        let mut motion = self.motion();
        let mut all = vec![StoredPoses::default(); self.groups.len()];
        for pose in poses {
            self.velocities(pose, &[1.0], &mut motion);
            self.accelerations(pose, &[0.0], &mut motion);
            for (assur, stored) in self.groups.iter().zip(&mut all) {
                if !assur.uses_stored_poses {
                    continue;
                }
                let unknowns = assur.group.unknowns.iter();
                let value = |unknown: &Unknown| match *unknown {
                    Unknown::ClassAngle(c) => {
                        let f = self.class_frame(c);
                        let angle = vec2(pose.angle[f], 0.0);
                        let counted = self.revolution_counted[f];
                        if counted { angle } else { pose.rotation[f] }
                    }
                    Unknown::SlideTravel(s) => vec2(pose.slide_travel[s], 0.0),
                };
                let derivatives = |unknown: &Unknown| match *unknown {
                    Unknown::ClassAngle(c) => {
                        let f = self.class_frame(c);
                        (motion.velocity.angular[f], motion.acceleration.angular[f])
                    }
                    Unknown::SlideTravel(s) => {
                        (motion.velocity.slide[s], motion.acceleration.slide[s])
                    }
                };
                let values = unknowns.clone().map(value).collect();
                let (slopes, curvatures) = unknowns.map(derivatives).unzip();
                stored.poses.push(StoredPose {
                    q: pose.q[0],
                    values,
                    slopes,
                    curvatures,
                });
            }
        }
        let gain = |(unknown, (first, last)): (&Unknown, (&Vec2, &Vec2))| match *unknown {
            Unknown::ClassAngle(c) if self.revolution_counted[self.class_frame(c)] => {
                last.x - first.x
            }
            Unknown::ClassAngle(_) | Unknown::SlideTravel(_) => 0.0,
        };
        for (stored, assur) in all.iter_mut().zip(&self.groups) {
            if let (Some(first), Some(last)) = (stored.poses.first(), stored.poses.last()) {
                let first_and_last = first.values.iter().zip(&last.values);
                let unknowns = assur.group.unknowns.iter();
                stored.gain_per_period = unknowns.zip(first_and_last).map(gain).collect();
            }
        }
        for (assur, stored) in self.groups.iter_mut().zip(all) {
            assur.stored_poses = stored;
        }
    }
}
