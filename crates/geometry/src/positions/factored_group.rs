//! Groups that are not closed forms throughout: positions by Newton's method, linear equations or a construction, rates by factors.

use super::closed_forms::{gap, is_plain, singular_tolerance, unit};
use super::{InitialIterate, rotate_frame};
use crate::error::PositionError;
use crate::plan::{FactoredGroup, GroupKind, LoopClosure, PlacementMethod, Plan, Pose};
use crate::plane::{Vec2, vec2};
use crate::structure::coupling::LinearForm;
use crate::structure::groups::{Group, Unknown};
use dwell_numerics::{Constant, FactorOutcome, Lift, Scalar, lu, qr};
use std::ops::Range;

/// Newton's correction (rad, or relative to the group's size) after which its square is rounding.
const CONVERGED: f64 = 1e-9;
/// A correction after which the factors of the Jacobian before it are those after it, to rounding: as a part of the pivots' ratio.
const SAME_FACTORS: f64 = 2e-15;
/// A step whose fourth power is rounding, rad.
const SHORT_SERIES: f64 = 1e-4;
/// A step that would change no digit, rad or relative.
const NO_STEP: f64 = 1e-17;
/// Second derivatives of the closure equations as a multiple of the first, with room: angles and lengths over the group's size.
const CURVATURE: f64 = 10.0;
/// Newton's method doubles the correct digits in each step: 30 steps are far more than it needs.
const MAX_NEWTON_STEPS: usize = 30;
/// Residual in roundings of the group's size, below which it is closed although corrections, next to a singular position, stay larger.
const CLOSED: f64 = 64.0;
/// Residual of a closed group with redundant equations, as a part of its size: the precision of lengths in a scene.
const REDUNDANT_RESIDUAL: f64 = 1e-9;

/// Sine and cosine of a step, by their series where two terms have all digits.
fn small_sin_cos<T: Scalar>(step: T) -> (T, T) {
    if !is_plain::<T>() || step.value().abs() > SHORT_SERIES {
        return step.sin_cos();
    }
    let one = T::from_f64(1.0);
    let square = step * step;
    let sin = step * (one - square * T::from_f64(1.0 / 6.0));
    (sin, one - square * T::from_f64(0.5))
}

impl FactoredGroup {
    /// The range of its factors in [`Pose::lu`].
    pub(crate) fn lu_range(&self) -> Range<usize> {
        self.lu_offset..self.lu_offset + self.factor_len()
    }

    /// The range of its row exchanges in [`Pose::pivots`].
    fn pivots_range(&self) -> Range<usize> {
        self.pivots_offset..self.pivots_offset + self.columns
    }

    /// Whether some equations are redundant: more rows than columns.
    pub(crate) fn is_overdetermined(&self) -> bool {
        self.rows > self.columns
    }

    /// The determinant, up to its sign where the group is tall.
    pub(crate) fn determinant<T: Scalar>(&self, pose: &Pose<T>) -> T {
        let n = self.columns;
        (0..n).fold(T::from_f64(1.0), |product, i| {
            product * pose.lu[self.lu_offset + i * n + i]
        })
    }

    /// Solves J x = b in place: x is in the first entries (least squares for a tall group).
    pub(crate) fn solve<T: Scalar>(&self, pose: &Pose<T>, b: &mut [T]) {
        let (m, n, lu) = (self.rows, self.columns, &pose.lu[self.lu_range()]);
        if self.is_overdetermined() {
            let (a, heads) = lu.split_at(m * n);
            qr::solve(a, heads, m, b);
        } else {
            lu::solve(lu, &pose.pivots[self.pivots_range()], &mut b[..n]);
        }
    }

    /// Solves Jᵀ x = b in place (the smallest x for a tall group).
    pub(crate) fn solve_transposed<T: Scalar>(&self, pose: &Pose<T>, b: &mut [T]) {
        let (m, n, lu) = (self.rows, self.columns, &pose.lu[self.lu_range()]);
        if self.is_overdetermined() {
            let (a, heads) = lu.split_at(m * n);
            qr::solve_transposed(a, heads, m, b);
        } else {
            lu::solve_transposed(lu, &pose.pivots[self.pivots_range()], &mut b[..n]);
        }
    }

    /// Factors the Jacobian of a group that is assembled in the pose.
    pub(crate) fn factor<T: Scalar>(
        &self,
        group: usize,
        pose: &mut Pose<T>,
    ) -> Result<FactorOutcome, PositionError> {
        let (m, n, lu) = (self.rows, self.columns, &mut pose.lu[self.lu_range()]);
        let outcome = if self.is_overdetermined() {
            let (a, heads) = lu.split_at_mut(m * n);
            qr::factor(a, heads, m)
        } else {
            lu::factor(lu, &mut pose.pivots[self.pivots_range()])
        };
        if outcome.pivot_ratio > singular_tolerance::<T>() {
            Ok(outcome)
        } else {
            Err(PositionError::Singular {
                group,
                q: pose.q.first().map_or(0.0, |q| q.value()),
                relative_determinant: outcome.pivot_ratio,
            })
        }
    }
}

impl<C: Constant> Plan<C> {
    /// Not inlined, because the closed forms would then have fewer registers.
    #[inline(never)]
    pub(crate) fn factored_positions<T: Lift<C>>(
        &self,
        group: usize,
        factored_group: &FactoredGroup,
        pose: &mut Pose<T>,
        initial_iterate: InitialIterate,
    ) -> Result<(), PositionError> {
        let outcome = match factored_group.method {
            PlacementMethod::Newton => {
                self.iterated_positions(group, factored_group, pose, initial_iterate)?
            }
            PlacementMethod::Linear => self.solve_linear(group, factored_group, pose)?,
            PlacementMethod::GearTrain => self.gear_train_positions(group, factored_group, pose)?,
            PlacementMethod::Triangle(..)
            | PlacementMethod::LineCircle(..)
            | PlacementMethod::PointOnLine(_) => {
                self.construct(group, factored_group, pose)?;
                self.rotate_group(group, pose);
                self.factor_jacobian(group, factored_group, pose)?
            }
        };
        // A pose on the other side of a singular position is another branch.
        if initial_iterate == InitialIterate::StoredPose
            && outcome.determinant_sign * factored_group.branch <= 0.0
        {
            let q = pose.first_coordinate();
            return Err(PositionError::OtherBranch { group, q });
        }
        for &l in &self.groups[group].group.loops {
            let closure = &self.loop_closures[l];
            if let Some((axis, _)) = closure.axis {
                pose.closure_travel[l] =
                    pose.vector[axis].dot(gap(closure, &pose.vector, &pose.slide_travel));
            }
        }
        Ok(())
    }

    /// Checks that every group's determinant has the sign it has at assembly.
    pub(crate) fn check_branch<T: Scalar>(&self, pose: &Pose<T>) -> Result<(), PositionError> {
        for (group, assur) in self.groups.iter().enumerate() {
            if let GroupKind::Factored(factored_group) = &assur.kind
                && !assur.pruned
                && !factored_group.is_overdetermined()
                && self.determinant_sign(factored_group, pose) * factored_group.branch <= 0.0
            {
                let q = pose.first_coordinate();
                return Err(PositionError::OtherBranch { group, q });
            }
        }
        Ok(())
    }

    /// Sign of the determinant, from its factors.
    pub(crate) fn determinant_sign<T: Scalar>(
        &self,
        factored_group: &FactoredGroup,
        pose: &Pose<T>,
    ) -> f64 {
        let pivots = &pose.pivots[factored_group.pivots_range()];
        let swaps = pivots.iter().enumerate().filter(|(k, p)| k != *p).count();
        let sign = if swaps % 2 == 0 { 1.0 } else { -1.0 };
        let n = factored_group.columns;
        (0..n).fold(sign, |sign, i| {
            sign * pose.lu[factored_group.lu_offset + i * n + i]
                .value()
                .signum()
        })
    }

    /// Sets a group's unknowns to the polynomial between its stored poses with their derivatives.
    pub(super) fn set_predicted_pose<T: Scalar>(
        &self,
        group: usize,
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        let stored_poses = &self.groups[group].stored_poses;
        let enclosing = stored_poses.enclosing(pose.first_coordinate(), self.range)?;
        // The derivative of the prediction does not matter: Newton's last step replaces it.
        for (i, &unknown) in self.groups[group].group.unknowns.iter().enumerate() {
            match unknown {
                Unknown::ClassAngle(class) if self.revolution_counted[self.class_frame(class)] => {
                    let angle = T::from_f64(stored_poses.predict_between(enclosing, i));
                    self.set_class_angle(class, angle, pose);
                }
                Unknown::ClassAngle(class) => {
                    pose.rotation[self.class_frame(class)] = enclosing.predict_rotation(i).cast();
                }
                Unknown::SlideTravel(slide) => {
                    let travel = stored_poses.predict_between(enclosing, i);
                    pose.slide_travel[slide] = T::from_f64(travel);
                }
            }
        }
        Ok(())
    }

    /// Sets a class to a counted angle.
    pub(crate) fn set_class_angle<T: Scalar>(&self, class: usize, angle: T, pose: &mut Pose<T>) {
        let class_frame = self.class_frame(class);
        let (sin, cos) = angle.sin_cos();
        pose.angle[class_frame] = angle;
        pose.rotation[class_frame] = vec2(cos, sin);
    }

    /// Newton's method; leaves the factors of the Jacobian where it ends.
    pub(super) fn solve_by_newton<T: Lift<C>>(
        &self,
        group: usize,
        factored_group: &FactoredGroup,
        pose: &mut Pose<T>,
    ) -> Result<FactorOutcome, PositionError> {
        let (mut residual, mut once_more) = (f64::INFINITY, true);
        let q = pose.first_coordinate();
        let converged = CONVERGED.max(0.05 * T::EPSILON.sqrt());
        for _ in 0..MAX_NEWTON_STEPS {
            self.rotate_group(group, pose);
            residual = self.residual(group, pose);
            let outcome = self.factor_jacobian(group, factored_group, pose)?;
            let largest = self.apply_newton_step(group, factored_group, pose);
            if !largest.is_finite() {
                return Err(PositionError::NotConverged { group, q, residual });
            }
            // The next step by the square of this one, over the distance to a singular Jacobian.
            let next = CURVATURE * largest * largest / outcome.pivot_ratio;
            let is_exact = is_plain::<T>() && next < NO_STEP;
            // One step past convergence: it makes the derivative of a dual number exact.
            if largest < converged && (is_exact || !std::mem::replace(&mut once_more, false)) {
                self.rotate_group(group, pose);
                self.check_redundant(group, factored_group, pose)?;
                if is_plain::<T>() && largest < SAME_FACTORS * outcome.pivot_ratio {
                    return Ok(outcome);
                }
                return self.factor_jacobian(group, factored_group, pose);
            }
        }
        if residual <= CLOSED * T::EPSILON * self.groups[group].size {
            self.rotate_group(group, pose);
            self.check_redundant(group, factored_group, pose)?;
            return self.factor_jacobian(group, factored_group, pose);
        }
        Err(PositionError::NotConverged { group, q, residual })
    }

    /// Checks that redundant equations agree with the others; otherwise the group is not closed.
    pub(crate) fn check_redundant<T: Lift<C>>(
        &self,
        group: usize,
        factored_group: &FactoredGroup,
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        if !factored_group.is_overdetermined() {
            return Ok(());
        }
        // Radii are as precise as lengths: what they leave open grows with the angle.
        let classes = self.groups[group].group.classes();
        let angles = classes.map(|c| pose.angle[self.class_frame(c)].value().abs());
        let tolerance = REDUNDANT_RESIDUAL.max(64.0 * T::EPSILON) * angles.fold(1.0, f64::max);
        let residual = self.residual(group, pose);
        let q = pose.first_coordinate();
        if residual <= tolerance * self.groups[group].size {
            return Ok(());
        }
        Err(PositionError::NotConverged { group, q, residual })
    }

    /// One step from zero, for equations that are linear in the unknowns.
    fn solve_linear<T: Lift<C>>(
        &self,
        group: usize,
        factored_group: &FactoredGroup,
        pose: &mut Pose<T>,
    ) -> Result<FactorOutcome, PositionError> {
        for &unknown in &self.groups[group].group.unknowns {
            match unknown {
                Unknown::ClassAngle(class) => self.set_class_angle(class, T::from_f64(0.0), pose),
                Unknown::SlideTravel(slide) => pose.slide_travel[slide] = T::from_f64(0.0),
            }
        }
        self.rotate_group(group, pose);
        self.residual(group, pose);
        let outcome = self.factor_jacobian(group, factored_group, pose)?;
        let largest = self.apply_newton_step(group, factored_group, pose);
        if !largest.is_finite() {
            return Err(PositionError::NotFinite);
        }
        self.rotate_group(group, pose);
        self.check_redundant(group, factored_group, pose)?;
        Ok(outcome)
    }

    /// Newton's correction from the residual in the work space: the largest change, rad or relative.
    pub(crate) fn apply_newton_step<T: Lift<C>>(
        &self,
        group: usize,
        factored_group: &FactoredGroup,
        pose: &mut Pose<T>,
    ) -> f64 {
        let scale = self.groups[group].scale;
        let mut workspace = std::mem::take(&mut pose.workspace);
        factored_group.solve(pose, &mut workspace[..factored_group.rows]);
        let mut largest = 0.0_f64;
        for (&unknown, &step) in self.groups[group].group.unknowns.iter().zip(&workspace) {
            match unknown {
                Unknown::ClassAngle(class) => {
                    let frame = self.class_frame(class);
                    if self.revolution_counted[frame] {
                        self.set_class_angle(class, pose.angle[frame] - step, pose);
                    } else {
                        let (sin, cos) = small_sin_cos(step);
                        pose.rotation[frame] = unit(pose.rotation[frame].rotate(vec2(cos, -sin)));
                    }
                }
                Unknown::SlideTravel(slide) => {
                    pose.slide_travel[slide] -= step * T::from_f64(scale);
                }
            }
            let change = step.value().abs();
            largest = if change.is_nan() {
                f64::INFINITY
            } else {
                largest.max(change)
            };
        }
        pose.workspace = workspace;
        largest
    }

    /// Turns a group's actuated frames and rotates the vectors of its loops, after its unknowns changed.
    pub(crate) fn rotate_group<T: Lift<C>>(&self, group: usize, pose: &mut Pose<T>) {
        let assur = &self.groups[group];
        for actuated in &assur.actuated_frames {
            rotate_frame(actuated, pose);
        }
        for &l in &assur.group.loops {
            let LoopClosure {
                vectors: arms,
                slides,
                axis,
                ..
            } = &self.loop_closures[l];
            let slide_directions = slides.iter().map(|&(_, a, _)| a);
            for vector in arms
                .iter()
                .chain(axis)
                .map(|&(a, _)| a)
                .chain(slide_directions)
            {
                let crate::structure::tree::FrameVector { frame, local } =
                    self.frame_vectors[vector];
                pose.vector[vector] = local.cast::<T>().rotate(pose.rotation[frame]);
            }
        }
    }

    /// Writes a group's residual into the work space; its largest component, m.
    pub(crate) fn residual<T: Lift<C>>(&self, group: usize, pose: &mut Pose<T>) -> f64 {
        let mut row = 0;
        let Group {
            loops, couplings, ..
        } = &self.groups[group].group;
        for &l in loops {
            let closure = &self.loop_closures[l];
            let closure_gap = gap(closure, &pose.vector, &pose.slide_travel);
            if let Some((axis, _)) = closure.axis {
                pose.workspace[row] = pose.vector[axis].perp().dot(closure_gap);
                row += 1;
            } else {
                pose.workspace[row] = closure_gap.x;
                pose.workspace[row + 1] = closure_gap.y;
                row += 2;
            }
        }
        for &r in couplings {
            let value = self.couplings[r].value(&pose.angle, &pose.slide_travel);
            pose.workspace[row] =
                value * self.groups[group].coupling_weight::<T>(&self.couplings[r]);
            row += 1;
        }
        let values = pose.workspace[..row]
            .iter()
            .map(|value| value.value().abs());
        values.fold(0.0, f64::max)
    }

    /// Assembles and factors a group's Jacobian at the pose.
    pub(crate) fn factor_jacobian<T: Lift<C>>(
        &self,
        group: usize,
        factored_group: &FactoredGroup,
        pose: &mut Pose<T>,
    ) -> Result<FactorOutcome, PositionError> {
        self.assemble_jacobian(group, factored_group, pose);
        factored_group.factor(group, pose)
    }

    pub(crate) fn assemble_jacobian<T: Lift<C>>(
        &self,
        group: usize,
        factored_group: &FactoredGroup,
        pose: &mut Pose<T>,
    ) {
        let assur = &self.groups[group];
        let of = &assur.group;
        let (unknowns, loops, couplings) = (&of.unknowns, &of.loops, &of.couplings);
        let (n, mut row) = (unknowns.len(), factored_group.lu_offset);
        let unit_of = |unknown: Unknown| match unknown {
            Unknown::ClassAngle(_) => T::from_f64(1.0),
            Unknown::SlideTravel(_) => T::from_f64(assur.scale),
        };
        for &l in loops {
            let closure = &self.loop_closures[l];
            // The gap matters only where the axis of a slide turns with an unknown.
            let turning = closure.axis.map(|(axis, frame)| {
                let class = self.frames.frames[frame].orientation_class;
                let closure_gap = gap(closure, &pose.vector, &pose.slide_travel);
                (pose.vector[axis], Unknown::ClassAngle(class), closure_gap)
            });
            for (column, &unknown) in unknowns.iter().enumerate() {
                let change = self.gap_derivative(closure, unknown, pose) * unit_of(unknown);
                if let Some((along, of_axis, closure_gap)) = turning {
                    let mut entry = along.perp().dot(change);
                    if unknown == of_axis {
                        entry -= along.dot(closure_gap);
                    }
                    pose.lu[row + column] = entry;
                } else {
                    pose.lu[row + column] = change.x;
                    pose.lu[row + n + column] = change.y;
                }
            }
            row += if closure.axis.is_some() { n } else { 2 * n };
        }
        for &r in couplings {
            let coupling = &self.couplings[r];
            let weight = assur.coupling_weight::<T>(coupling);
            for (column, &unknown) in unknowns.iter().enumerate() {
                let factor = |form: &LinearForm| match unknown {
                    Unknown::ClassAngle(class) => form.class_factor(&self.frames, class),
                    Unknown::SlideTravel(slide) => form.slide_factor(slide),
                };
                let entry = coupling.derivative(factor, &pose.angle, &pose.slide_travel);
                pose.lu[row + column] = entry * weight * unit_of(unknown);
            }
            row += n;
        }
    }

    /// ∂L/∂unknown of a loop L = P₂ − P₁.
    fn gap_derivative<T: Lift<C>>(
        &self,
        closure: &LoopClosure<C>,
        unknown: Unknown,
        pose: &Pose<T>,
    ) -> Vec2<T> {
        let mut sum = Vec2::zero();
        match unknown {
            Unknown::ClassAngle(class) => {
                let of_class = |frame: usize| self.frames.frames[frame].orientation_class == class;
                for &(vector, frame) in &closure.vectors {
                    if of_class(frame) {
                        sum += pose.vector[vector].perp();
                    }
                }
                for &(slide, vector, frame) in &closure.slides {
                    if of_class(frame) {
                        sum += pose.vector[vector].perp() * pose.slide_travel[slide];
                    }
                }
            }
            Unknown::SlideTravel(slide) => {
                for &(s, vector, _) in &closure.slides {
                    if s == slide {
                        sum += pose.vector[vector];
                    }
                }
            }
        }
        sum
    }
}
