//! Factors of the groups' Jacobians: LU with row exchanges where a group is square, Householder's QR where equations are redundant; a
//! [rod](super::rod) has closed forms.

use super::groups::Group;
use super::plan::{Plan, Pose};
use dwell_numerics::qr::{self, relative_volume};
use dwell_numerics::{Constant, FactorOutcome, Scalar, lu};

impl<C: Constant> Plan<C> {
    /// Factors a group's Jacobian, scaled.
    #[inline(always)]
    pub(super) fn factor<T: Scalar>(&self, group: &Group, pose: &mut Pose<T>) -> FactorOutcome {
        let (m, n) = (group.rows.len(), group.unknowns.len());
        let matrix = &mut pose.factors[group.factors..][..m * n];
        for zero in &group.zeros {
            matrix[*zero] = T::from_f64(0.0);
        }
        for inner in &group.inner {
            matrix[inner.at] = pose.entries[inner.entry] * T::from_f64(inner.scale);
        }
        if group.is_square() {
            lu::factor(matrix, &mut pose.pivots[group.columns..][..n])
        } else {
            qr::factor(matrix, &mut pose.reflections[group.columns..][..n], m)
        }
    }

    /// The solution of a closed group's equations for the right-hand sides in the scratch memory, by row; it leaves the unknowns there.
    #[inline(always)]
    pub(super) fn solve<T: Scalar>(&self, group: &Group, pose: &mut Pose<T>) {
        match &group.rod {
            Some(rod) => Self::solve_rod(group, rod, pose),
            None => self.solve_factored(group, pose),
        }
    }

    /// Solves with the factors of the group's Jacobian.
    #[inline(always)]
    pub(super) fn solve_factored<T: Scalar>(&self, group: &Group, pose: &mut Pose<T>) {
        let (m, n) = (group.rows.len(), group.unknowns.len());
        let Pose {
            scratch,
            factors,
            pivots,
            reflections,
            ..
        } = pose;
        let scratch = &mut scratch[..m];
        for (value, scale) in scratch.iter_mut().zip(&group.row_scales) {
            *value = *value * T::from_f64(*scale);
        }
        let factors = &factors[group.factors..][..m * n];
        if group.is_square() {
            lu::solve(factors, &pivots[group.columns..][..n], scratch);
        } else {
            qr::solve(factors, &reflections[group.columns..][..n], m, scratch);
        }
        for (value, scale) in scratch.iter_mut().zip(&group.column_scales) {
            *value = *value * T::from_f64(*scale);
        }
    }

    /// The multipliers of a group's equations, by row. On entry the same memory holds the forces that the unknowns require. If
    /// equations are redundant, the multipliers of least norm.
    #[inline(always)]
    pub(super) fn solve_transposed<T: Scalar>(
        &self,
        group: &Group,
        pose: &Pose<T>,
        values: &mut [T],
    ) {
        if let Some(rod) = &group.rod {
            return Self::solve_rod_transposed(group, rod, pose, values);
        }
        let (m, n) = (group.rows.len(), group.unknowns.len());
        let values = &mut values[..m];
        for (value, scale) in values.iter_mut().zip(&group.column_scales) {
            *value = *value * T::from_f64(*scale);
        }
        let factors = &pose.factors[group.factors..][..m * n];
        if group.is_square() {
            lu::solve_transposed(factors, &pose.pivots[group.columns..][..n], values);
        } else {
            let reflections = &pose.reflections[group.columns..][..n];
            qr::solve_transposed(factors, reflections, m, values);
        }
        for (value, scale) in values.iter_mut().zip(&group.row_scales) {
            *value = *value * T::from_f64(*scale);
        }
    }
}

impl Plan {
    /// The least determinant of a group's Jacobian, as that in the [plane](crate::Plan::least_relative_determinant), with lengths in parts of
    /// the size of the mechanism.
    pub fn least_relative_determinant(&self, pose: &Pose<f64>) -> f64 {
        let mut memory = pose.clone();
        let each = self.groups.iter().map(|group| {
            self.fill_rows(group, &mut memory);
            let (m, n) = (group.rows.len(), group.unknowns.len());
            let mut matrix = vec![0.0; m * n];
            for inner in &group.inner {
                matrix[inner.at] = memory.entries[inner.entry] * inner.scale;
            }
            relative_volume(&mut matrix, m, n)
        });
        each.fold(1.0, f64::min)
    }

    /// The inverse of a group's factored Jacobian, unknowns by rows; the least-squares inverse if equations are
    /// redundant.
    pub(super) fn inverse(&self, group: &Group, pose: &mut Pose) -> Vec<f64> {
        let (m, n) = (group.rows.len(), group.unknowns.len());
        let mut inverse = vec![0.0; n * m];
        for row in 0..m {
            pose.scratch[..m].fill(0.0);
            pose.scratch[row] = 1.0;
            self.solve(group, pose);
            for unknown in 0..n {
                inverse[unknown * m + row] = pose.scratch[unknown];
            }
        }
        inverse
    }
}
