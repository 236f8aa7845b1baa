//! Positions: each group from a prediction between stored poses, closed with the predicted inverse of its Jacobian, or by Newton's method.
//! A group with redundant rows is solved by least squares, and the residual is checked, because least squares also converge if a loop does
//! not close.

use super::closure::RowKind;
use super::groups::Group;
use super::plan::{Plan, Pose};
use super::prediction::PiecePoint;
use super::tree::{FreedomKind, Step};
use super::vector::vec3;
use crate::error::PositionError;
use crate::positions::is_plain;
use dwell_numerics::{Constant, Lift, Scalar};

/// Steps with a predicted inverse at most.
const MAX_PREDICTED_STEPS: usize = 3;
/// A residual below this fraction of the size is the rounding of the points along a loop, which no step reduces.
const fn rounding<T: Scalar>() -> f64 {
    2e-15_f64.max(9.0 * T::EPSILON)
}
/// One step with a predicted inverse leaves rounding of so large a residual: where the inverse is wrong by a part of a thousand.
const fn one_step<T: Scalar>() -> f64 {
    1e-13_f64.max(450.0 * T::EPSILON)
}
/// Newton's steps at most.
const MAX_STEPS: usize = 40;
/// The square of a step, relative to the pivots, below which a further step would be rounding.
const fn no_step<T: Scalar>() -> f64 {
    2e-16_f64.max(0.9 * T::EPSILON)
}
/// A residual this large, relative to the size, is no closure.
pub(super) const OPEN: f64 = 1e-9;
/// The tolerance in a number type; in one coarser than `f64`, some roundings of the coordinates.
const fn open<T: Scalar>() -> f64 {
    OPEN.max(64.0 * T::EPSILON)
}
/// Pivots this far apart make a group singular.
const SINGULAR: f64 = 1e-9;
/// The tolerance in a number type; in one coarser than `f64`, the level at which pivots are rounding.
pub(super) const fn singular<T: Scalar>() -> f64 {
    SINGULAR.max(8.0 * T::EPSILON)
}
/// Steps this long, rad, leave the branch.
pub(super) const LONG_STEP: f64 = 0.5;

impl Plan {
    /// The pose at these coordinates, rad or m.
    ///
    /// # Errors
    /// [`PositionError`] when there is none.
    pub fn positions<T: Scalar>(&self, q: &[T], pose: &mut Pose<T>) -> Result<(), PositionError> {
        if q.iter().any(|q| !q.value().is_finite()) {
            return Err(PositionError::NotFinite);
        }
        let Some(first) = q.first() else {
            self.start_from(&self.start, 0.0, pose);
            return self.close(q, None, pose);
        };
        if q.len() > 1 {
            return self.continue_to(q, pose);
        }
        let value = self.within_range(first.value())?;
        let at = self.predictions.at(value);
        match at {
            Some(at) => {
                self.predictions.predict(at, pose);
                self.count_teeth(first.value(), pose);
            }
            None => self.start_from(&self.start, value - self.start.q, pose),
        }
        self.close(q, at, pose)
    }

    /// Adds the changes in whole periods to the freedoms that teeth turn, because the row of a gear pair counts all
    /// revolutions.
    #[inline(always)]
    fn count_teeth<T: Scalar>(&self, q: f64, pose: &mut Pose<T>) {
        if self.geared.is_empty() {
            return;
        }
        let periods = self.periods(q);
        for &freedom in &self.geared {
            pose.coordinates[freedom] += T::from_f64(periods * self.freedom_gains[freedom]);
        }
    }

    /// The size of the largest coordinate, to whose rounding steps can be small: those that teeth turn count all revolutions.
    #[inline(always)]
    fn count_size<T: Scalar>(&self, pose: &Pose<T>) -> f64 {
        let counted = self
            .geared
            .iter()
            .map(|f| pose.coordinates[*f].value().abs());
        counted.fold(1.0, f64::max)
    }

    /// Closes all groups in order, from the coordinates in the pose, which are those of a prediction at a coordinate if that is given.
    #[inline(always)]
    pub(super) fn close<T: Scalar>(
        &self,
        q: &[T],
        predicted: Option<PiecePoint>,
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        for (driver, &q) in self.drivers.iter().zip(q) {
            pose.coordinates[driver.freedom] = q * T::from_f64(driver.factor);
        }
        self.place(&self.first_links, pose);
        let predicted = predicted.filter(|_| is_plain::<T>());
        for (g, group) in self.groups.iter().enumerate() {
            let closed = predicted.is_some_and(|at| self.close_predicted(group, at, pose));
            if !(closed && self.factor_closed(group, pose)) {
                self.close_group(g, q.first().map_or(0.0, |q| q.value()), pose)?;
            }
        }
        self.place(&self.last_links, pose);
        if self.has_tables {
            self.check_tables(q.first().map_or(0.0, |q| q.value()), pose)?;
        }
        Ok(())
    }

    /// Closes a predicted group by steps with the predicted inverse of its Jacobian: each step reduces the residual by the relative
    /// error of this inverse. Returns false if the group does not close in this way.
    #[inline(always)]
    fn close_predicted<T: Scalar>(
        &self,
        group: &Group,
        at: PiecePoint,
        pose: &mut Pose<T>,
    ) -> bool {
        let m = group.rows.len();
        self.place(&group.links, pose);
        for _ in 0..MAX_PREDICTED_STEPS {
            self.fill_residuals(group, pose);
            let residual = self.largest_residual(group, pose);
            if residual <= rounding::<T>() {
                return true;
            }
            for (i, row) in group.residuals.iter().enumerate() {
                pose.scratch[i] = -pose.residuals[*row];
            }
            let mut turns = [T::from_f64(0.0); 3];
            for (j, &freedom) in group.unknowns.iter().enumerate() {
                let row = self.predictions.inverse(at, group.factors + j * m);
                let entries = row.zip(&pose.scratch[..m]);
                let step = entries.fold(T::from_f64(0.0), |sum, (entry, r)| {
                    sum + T::from_f64(entry) * *r
                });
                pose.coordinates[freedom] += step;
                // The three turns of a ball follow each other.
                turns = [turns[1], turns[2], step];
                if let Some(&(link, _)) = group.balls.iter().find(|(_, first)| first + 2 == j) {
                    self.turn_ball(link, vec3(turns[0], turns[1], turns[2]), pose);
                }
            }
            self.place(&group.links, pose);
            if residual <= one_step::<T>() {
                return true;
            }
        }
        false
    }

    fn close_group<T: Scalar>(
        &self,
        g: usize,
        q: f64,
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        let group = &self.groups[g];
        let mut settled = false;
        for _ in 0..MAX_STEPS {
            self.place(&group.links, pose);
            self.fill_rows(group, pose);
            let outcome = self.factor(group, pose);
            // Not a number becomes zero.
            let relative_determinant = outcome.pivot_ratio.max(0.0);
            if relative_determinant < singular::<T>() {
                return Err(PositionError::Singular {
                    group: g,
                    q,
                    relative_determinant,
                });
            }
            if settled {
                let residual = self.largest_residual(group, pose);
                if let Some(rod) = &group.rod {
                    self.factor_rod(group, rod, pose);
                }
                if residual <= open::<T>() {
                    return Ok(());
                }
                return Err(PositionError::NoAssembly {
                    group: g,
                    q,
                    gap: residual * self.size,
                });
            }
            let step = self.newton_step(group, pose);
            if step.is_nan() {
                return Err(PositionError::NotFinite);
            }
            if step > LONG_STEP {
                return Err(PositionError::NotConverged {
                    group: g,
                    q,
                    residual: step,
                });
            }
            // Derivatives are exact after one step more than values.
            settled = if T::HAS_DERIVATIVES {
                step < 1e-14 * self.count_size(pose) / outcome.pivot_ratio
            } else {
                step * step / outcome.pivot_ratio < no_step::<T>()
            };
        }
        let residual = self.largest_residual(group, pose) * self.size;
        Err(PositionError::NotConverged {
            group: g,
            q,
            residual,
        })
    }
}

impl<C: Constant> Plan<C> {
    /// Factors the Jacobian of a closed group; returns false if it is singular.
    #[inline(always)]
    pub(super) fn factor_closed<T: Lift<C>>(&self, group: &Group, pose: &mut Pose<T>) -> bool {
        if let Some(rod) = &group.rod {
            return self.factor_rod(group, rod, pose);
        }
        self.fill_rows(group, pose);
        self.factor(group, pose).pivot_ratio >= singular::<T>()
    }

    /// The frames of some bodies, with the screws of their freedoms.
    pub(super) fn place<T: Lift<C>>(&self, links: &[usize], pose: &mut Pose<T>) {
        let freedoms = &self.tree.freedoms;
        for link in links.iter().map(|l| &self.tree.links[*l]) {
            let Pose {
                coordinates,
                balls,
                frames,
                screws,
                ..
            } = pose;
            let base = link.base(&frames[link.parent], link.parent == self.ground);
            frames[link.body] = link.place(base, coordinates, balls, freedoms, screws);
        }
    }

    /// Residuals of a group's rows alone.
    #[inline(always)]
    fn fill_residuals<T: Lift<C>>(&self, group: &Group, pose: &mut Pose<T>) {
        for (c, rows) in &group.closures {
            let closure = &self.closures[*c];
            let [_, _, d] = closure.ends(&pose.frames);
            for &(_, k) in &group.rows[rows.clone()] {
                let row = closure.row(closure.kinds[k], &pose.frames, &pose.coordinates, d);
                pose.residuals[closure.rows.start + k] = row.residual;
            }
        }
    }

    /// Residuals and Jacobian of a group's rows.
    #[inline(always)]
    pub(super) fn fill_rows<T: Lift<C>>(&self, group: &Group, pose: &mut Pose<T>) {
        for (c, rows) in &group.closures {
            let closure = &self.closures[*c];
            let rows = &group.rows[rows.clone()];
            let [_, at, d] = closure.ends(&pose.frames);
            for &(_, k) in rows {
                let row = closure.row(closure.kinds[k], &pose.frames, &pose.coordinates, d);
                let index = closure.rows.start + k;
                pose.residuals[index] = row.residual;
                pose.row_wrenches[index] = row.wrench;
            }
            if let Some(coupled) = &closure.coupled {
                let derivatives = coupled.derivatives(&pose.coordinates);
                pose.entries[closure.entries..][..2].copy_from_slice(&derivatives);
                continue;
            }
            let freedoms = closure.path.len();
            for (p, &(freedom, sign)) in closure.path.iter().enumerate() {
                let kind = self.tree.freedoms[freedom];
                if kind == FreedomKind::Length {
                    // The row is the distance less the length.
                    pose.entries[closure.entries + p] = T::from_f64(-1.0);
                    continue;
                }
                let is_moved = |&(_, k): &(usize, usize)| closure.is_moved(k, p);
                if !closure.unmoved.is_empty() && !rows.iter().any(is_moved) {
                    continue;
                }
                let twist = pose.screws[freedom].twist(kind, at, sign);
                for &(_, k) in rows {
                    let wrench = &pose.row_wrenches[closure.rows.start + k];
                    pose.entries[closure.entries + k * freedoms + p] = match closure.kinds[k] {
                        RowKind::Point(axis) => twist.linear.component(axis),
                        RowKind::Along(_) | RowKind::InPlane(_) => twist.force_power(wrench),
                        RowKind::Length(_) | RowKind::Driven(_) => twist.force_power(wrench),
                        RowKind::Mesh(_) => twist.force_power(wrench),
                        RowKind::Parallel(..) | RowKind::NoSpin(_) => twist.moment_power(wrench),
                        // The derivatives of a coupling are those of its law.
                        RowKind::Coupled(..) => continue,
                    };
                }
            }
        }
    }

    /// One step of Newton's method; its largest component, over the unit of its freedom.
    pub(super) fn newton_step<T: Lift<C>>(&self, group: &Group, pose: &mut Pose<T>) -> f64 {
        for (i, row) in group.residuals.iter().enumerate() {
            pose.scratch[i] = -pose.residuals[*row];
        }
        self.solve_factored(group, pose);
        let mut largest = 0.0_f64;
        for (j, (&freedom, scale)) in group.unknowns.iter().zip(&group.column_scales).enumerate() {
            let step = pose.scratch[j];
            pose.coordinates[freedom] += step;
            let size = step.value().abs() / scale;
            largest = if size.is_nan() {
                f64::NAN
            } else {
                largest.max(size)
            };
        }
        for &(link, first) in &group.balls {
            let step = vec3(
                pose.scratch[first],
                pose.scratch[first + 1],
                pose.scratch[first + 2],
            );
            self.turn_ball(link, step, pose);
        }
        largest
    }

    /// Turns the ball of a link by a small turn in the axes of the ground.
    pub(super) fn turn_ball<T: Lift<C>>(
        &self,
        link: usize,
        turn: super::Vec3<T>,
        pose: &mut Pose<T>,
    ) {
        let link = &self.tree.links[link];
        for step in &link.steps {
            if let Step::Ball(ball, _) = *step {
                let inner = pose.frames[link.body].rotation.apply_inverse(turn);
                let before = pose.balls[ball];
                pose.balls[ball] = before.turned_by(before.apply(inner));
            }
        }
    }

    /// The largest residual of a group; lengths are divided by the size.
    pub(super) fn largest_residual<T: Scalar>(&self, group: &Group, pose: &Pose<T>) -> f64 {
        let rows = group.residuals.iter().zip(&group.row_scales);
        let sizes = rows.map(|(row, scale)| pose.residuals[*row].value().abs() * scale);
        sizes.fold(0.0, f64::max)
    }
}
