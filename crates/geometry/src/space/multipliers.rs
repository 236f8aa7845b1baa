//! Multipliers of the loops: the transposed factors, group by group in reverse order.

use super::plan::{Plan, Pose};
use dwell_numerics::{Scalar, qr};

impl Plan {
    /// Multipliers λ of all rows for the generalised forces `balance` on the freedoms, Jᵀ λ = g, N or N·m; where redundant rows leave
    /// them open, the smallest. What stays in `balance` on the driven freedoms is the actuators' action.
    pub fn multipliers<T: Scalar>(&self, pose: &mut Pose<T>, balance: &mut [T], multipliers: &mut [T]) {
        for group in self.groups.iter().rev() {
            let (m, n) = (group.rows.len(), group.unknowns.len());
            let Pose { scratch, factors, heads, entries, .. } = &mut *pose;
            for (j, (&freedom, scale)) in group.unknowns.iter().zip(&group.column_scales).enumerate() {
                scratch[j] = balance[freedom] * T::from_f64(*scale);
            }
            let (factors, heads) = (&factors[group.factors..][..m * n], &heads[group.heads..][..n]);
            qr::solve_transposed(factors, heads, m, &mut scratch[..m]);
            for (i, (&(c, k), scale)) in group.rows.iter().zip(&group.row_scales).enumerate() {
                scratch[i] = scratch[i] * T::from_f64(*scale);
                multipliers[self.chords[c].rows.start + k] = scratch[i];
            }
            for outer in &group.outer {
                let change = entries[outer.entry] * scratch[outer.row];
                balance[outer.freedom] -= change;
            }
        }
    }
}
