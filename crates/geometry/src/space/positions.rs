//! Positions: each group by Newton's method from a stored pose. A group with redundant rows is solved by least squares, and what
//! stays open is looked at: least squares converge where a loop does not close, too.

use super::groups::Group;
use super::plan::{Plan, Pose};
use super::tree::Step;
use super::vector::{Vec3, vec3};
use crate::error::PositionError;
use dwell_numerics::{FactorOutcome, Scalar, qr};

/// Newton's steps at most.
const MAX_STEPS: usize = 40;
/// The square of a step, relative to the pivots, below which a further step would be rounding.
const NO_STEP: f64 = 2e-16;
/// A residual this large, relative to the size, is no closure.
pub(super) const OPEN: f64 = 1e-9;
/// Pivots this far apart make a group singular.
pub(super) const SINGULAR: f64 = 1e-9;
/// Steps this long, rad, leave the branch.
pub(super) const LONG_STEP: f64 = 0.5;

impl Plan {
    /// The pose at these coordinates, rad or m.
    ///
    /// # Errors
    /// [`PositionError`] when there is none.
    pub fn positions<T: Scalar>(&self, q: &[T], pose: &mut Pose<T>) -> Result<(), PositionError> {
        if let Some(wrong) = q.iter().find(|q| !q.value().is_finite()) {
            return Err(PositionError::NotFinite { q: wrong.value() });
        }
        let Some(first) = q.first() else {
            self.start_from(&self.nodes[0], 0.0, pose);
            return self.close(q, pose);
        };
        if q.len() > 1 {
            return self.continue_to(q, pose);
        }
        let value = self.within_range(first.value())?;
        let next = self.nodes.partition_point(|n| n.q < value);
        match self.pieces.get(next.max(1) - 1) {
            Some(piece) => piece.predict(value, pose),
            None => {
                let node = &self.nodes[next.min(self.nodes.len() - 1)];
                self.start_from(node, value - node.q, pose);
            }
        }
        self.close(q, pose)
    }

    /// Closes all groups in order, from the coordinates in the pose.
    pub(super) fn close<T: Scalar>(
        &self,
        q: &[T],
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        for (&(freedom, sign), &q) in self.drivers.iter().zip(q) {
            pose.coordinates[freedom] = q * T::from_f64(sign);
        }
        self.place(&self.first_links, pose);
        for g in 0..self.groups.len() {
            self.close_group(g, q.first().map_or(0.0, |q| q.value()), pose)?;
        }
        self.place(&self.last_links, pose);
        Ok(())
    }

    /// The frames of some bodies, with the screws of their freedoms.
    pub(super) fn place<T: Scalar>(&self, links: &[usize], pose: &mut Pose<T>) {
        let freedoms = &self.tree.freedoms;
        for link in links.iter().map(|l| &self.tree.links[*l]) {
            let Pose {
                coordinates,
                balls,
                frames,
                screws,
                ..
            } = pose;
            frames[link.body] =
                link.place(&frames[link.parent], coordinates, balls, freedoms, screws);
        }
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
            if outcome.pivot_ratio.is_nan() || outcome.pivot_ratio < SINGULAR {
                let relative_determinant = outcome.pivot_ratio;
                return Err(PositionError::Singular {
                    group: g,
                    q,
                    relative_determinant,
                });
            }
            if settled {
                let residual = self.largest_residual(group, pose);
                return if residual <= OPEN {
                    Ok(())
                } else {
                    Err(PositionError::NoAssembly {
                        group: g,
                        q,
                        gap: residual * self.size,
                    })
                };
            }
            let step = self.newton_step(group, pose);
            if step.is_nan() || step > LONG_STEP {
                return Err(PositionError::NotConverged {
                    group: g,
                    q,
                    residual: step,
                });
            }
            // Derivatives are exact after one step more than values.
            settled = match T::HAS_DERIVATIVES {
                true => step < 1e-14 / outcome.pivot_ratio,
                false => step * step / outcome.pivot_ratio < NO_STEP,
            };
        }
        let residual = self.largest_residual(group, pose) * self.size;
        Err(PositionError::NotConverged {
            group: g,
            q,
            residual,
        })
    }

    /// Residuals and Jacobian of a group's rows.
    pub(super) fn fill_rows<T: Scalar>(&self, group: &Group, pose: &mut Pose<T>) {
        let mut last = usize::MAX;
        let [mut at, mut d] = [Vec3::zero(); 2];
        for &(c, k) in &group.rows {
            let closure = &self.closures[c];
            // The rows of a closure follow each other: its points are the same for all.
            if c != last {
                [_, at, d] = closure.ends(&pose.frames);
                last = c;
            }
            let row = closure.row(closure.kinds[k], &pose.frames, d);
            let index = closure.rows.start + k;
            pose.residuals[index] = row.residual;
            pose.row_wrenches[index] = row.wrench;
            let first = closure.entries + k * closure.path.len();
            for (entry, &(freedom, sign)) in pose.entries[first..].iter_mut().zip(&closure.path) {
                let kind = self.tree.freedoms[freedom];
                let power = pose.screws[freedom].power(kind, row.wrench, at);
                *entry = if sign > 0.0 { power } else { -power };
            }
        }
    }

    /// Factors a group's Jacobian, scaled.
    pub(super) fn factor<T: Scalar>(&self, group: &Group, pose: &mut Pose<T>) -> FactorOutcome {
        let (m, n) = (group.rows.len(), group.unknowns.len());
        let matrix = &mut pose.factors[group.factors..][..m * n];
        matrix.fill(T::from_f64(0.0));
        for inner in &group.inner {
            matrix[inner.at] = pose.entries[inner.entry] * T::from_f64(inner.scale);
        }
        qr::factor(matrix, &mut pose.heads[group.heads..][..n], m)
    }

    /// The solution of a group's equations for the right-hand sides in the scratch memory, by row; it leaves the unknowns there.
    pub(super) fn solve<T: Scalar>(&self, group: &Group, pose: &mut Pose<T>) {
        let (m, n) = (group.rows.len(), group.unknowns.len());
        let Pose {
            scratch,
            factors,
            heads,
            ..
        } = pose;
        for (value, scale) in scratch.iter_mut().zip(&group.row_scales) {
            *value = *value * T::from_f64(*scale);
        }
        qr::solve(
            &factors[group.factors..][..m * n],
            &heads[group.heads..][..n],
            m,
            &mut scratch[..m],
        );
        for (value, scale) in scratch.iter_mut().zip(&group.column_scales) {
            *value = *value * T::from_f64(*scale);
        }
    }

    /// One step of Newton's method; its largest component, over the unit of its freedom.
    fn newton_step<T: Scalar>(&self, group: &Group, pose: &mut Pose<T>) -> f64 {
        for (i, &(c, k)) in group.rows.iter().enumerate() {
            pose.scratch[i] = -pose.residuals[self.closures[c].rows.start + k];
        }
        self.solve(group, pose);
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
    pub(super) fn turn_ball<T: Scalar>(
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

    /// The largest residual of a group, over the size where it is a length.
    pub(super) fn largest_residual<T: Scalar>(&self, group: &Group, pose: &Pose<T>) -> f64 {
        let rows = group.rows.iter().zip(&group.row_scales);
        let sizes = rows.map(|(&(c, k), scale)| {
            pose.residuals[self.closures[c].rows.start + k]
                .value()
                .abs()
                * scale
        });
        sizes.fold(0.0, f64::max)
    }
}
