//! Change points in the range of the only coordinate: another branch meets this one there, and this one continues. The Jacobian J of a
//! group is singular there: one singular value σ changes its sign, or several do if several loops of the group are flat at once. Between
//! two stored poses, by the inverses P of J (of least squares where equations are redundant),
//!
//! ```text
//! det(P₁ P₂ᵀ) < 0   or   P₁·P₂ = Σ P₁ᵢⱼ P₂ᵢⱼ < 0,    and at the change point 1/‖P‖ = 0                      (1)
//! ```
//!
//! The first finds an odd number of signs wherever they change. Close to a change point P is Σ u vᵀ/σ of those singular values, so that
//! P₁·P₂ is the sum of 1/σ₁σ₂, which is negative for any number of them; it also shows on which side of the change point an intermediate
//! pose is.

use super::branch_fit::{BranchFit, BranchFitWorkspace};
use super::groups::Group;
use super::plan::{Plan, Pose};
use dwell_numerics::{lu, root};

/// The poses from which the branch across is fitted: rad, or parts of the size.
const FITTED: [f64; 2] = [0.02, 0.2];
/// Least ratio of the inverse at a change point to the inverse at the stored poses.
const GROWTH: f64 = 100.0;

/// A change point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangePoint {
    /// The coordinate, rad or m.
    pub q: f64,
    /// The group whose branches meet there.
    pub group: usize,
}

impl Plan {
    /// The change points in the range of the only coordinate, of one of its periods, ascending.
    pub fn change_points(&self) -> &[ChangePoint] {
        &self.change_points
    }

    /// Finds them between the stored poses.
    pub(super) fn find_change_points(&mut self) {
        let unit = if self.is_angle(0) { 1.0 } else { self.size };
        let mut found = Vec::new();
        for (g, group) in self.groups.iter().enumerate() {
            let stored: Vec<(f64, &[f64])> = self.predictions.stored_inverses().collect();
            for pair in stored.windows(2) {
                let [one, other] = [0, 1].map(|k| (pair[k].0, of_group(group, pair[k].1)));
                if is_between(group, one.1, other.1) {
                    let q = self.change_point_between(group, [one, other], unit);
                    found.extend(q.map(|q| ChangePoint { q, group: g }));
                }
            }
        }
        found.sort_by(|a, b| a.q.total_cmp(&b.q));
        self.change_points = found;
    }

    /// The change point of a group between two stored poses, by their coordinates and inverses; none where its Jacobian is not singular there.
    fn change_point_between(
        &self,
        group: &Group,
        [(from, first), (to, second)]: [(f64, &[f64]); 2],
        unit: f64,
    ) -> Option<f64> {
        let smallest = [first, second].map(|p| 1.0 / norm(p));
        let guess = from + (to - from) * smallest[0] / (smallest[0] + smallest[1]);
        let fit = self
            .fit_branch(guess, FITTED.map(|part| part * unit))
            .ok()?;
        let (mut pose, mut memory) = (self.pose::<f64>(), BranchFitWorkspace::default());
        let mut signed = |q: f64| {
            let there = self.inverse_on_fit(group, &fit, [q, q - guess], &mut memory, &mut pose);
            let size = norm(&there);
            match (size.is_finite(), product(first, &there) < 0.0) {
                (true, false) => 1.0 / size,
                (true, true) => -1.0 / size,
                // Singular to the last digit.
                (false, _) => 0.0,
            }
        };
        let at = root::find(|q| Ok::<_, std::convert::Infallible>(signed(q)), from, to);
        let at = at.ok().flatten()?;
        let is_singular = signed(at).abs() * GROWTH < smallest[0].max(smallest[1]);
        is_singular.then_some(at)
    }

    /// The inverse of a group's Jacobian at a pose of a fit.
    fn inverse_on_fit(
        &self,
        group: &Group,
        fit: &BranchFit,
        at: [f64; 2],
        memory: &mut BranchFitWorkspace<f64>,
        pose: &mut Pose,
    ) -> Vec<f64> {
        self.set_on_fit(fit, at, [1.0, 0.0], memory, pose);
        self.factor_closed(group, pose);
        self.inverse(group, pose)
    }
}

/// The inverse of a group in the inverses of a stored pose.
fn of_group<'i>(group: &Group, inverses: &'i [f64]) -> &'i [f64] {
    &inverses[group.factors..][..group.rows.len() * group.unknowns.len()]
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// The sum of the products of entries.
fn product(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

/// Whether a change point is between two poses, by (1).
fn is_between(group: &Group, one: &[f64], other: &[f64]) -> bool {
    product(one, other) < 0.0 || changes_sign(group, one, other)
}

/// Whether the determinant of a group's Jacobian changes its sign from one pose to another, by (1).
fn changes_sign(group: &Group, one: &[f64], other: &[f64]) -> bool {
    let (m, n) = (group.rows.len(), group.unknowns.len());
    let mut products = vec![0.0; n * n];
    for (i, a) in one.chunks_exact(m).enumerate() {
        for (j, b) in other.chunks_exact(m).enumerate() {
            products[i * n + j] = product(a, b);
        }
    }
    lu::factor(&mut products, &mut vec![0; n]).determinant_sign < 0.0
}

#[cfg(test)]
mod tests {
    use super::{Group, changes_sign, is_between};

    /// The inverse of U diag(3, s, s or 1) Vᵀ with rotations U and V that turn with the coordinate.
    fn inverse(s: f64, is_double: bool) -> Vec<f64> {
        let turned = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            [
                [cos, -sin * 0.6, sin * 0.8],
                [sin, cos * 0.6, -cos * 0.8],
                [0.0, 0.8, 0.6],
            ]
        };
        let (u, v) = (turned(0.4 + s), turned(-0.7 + 2.0 * s));
        let values = [3.0, s, if is_double { s } else { 1.0 }];
        let entry = |i: usize, j: usize| (0..3).map(|k| v[i][k] * u[j][k] / values[k]).sum();
        (0..9).map(|k| entry(k / 3, k % 3)).collect()
    }

    /// The determinant changes its sign with one singular value, but not with two. Both kinds are found, and nothing else.
    #[test]
    fn several_loops_that_are_flat_at_once_are_found() {
        let group = Group {
            unknowns: vec![0, 1, 2],
            rows: vec![(0, 0), (0, 1), (0, 2)],
            ..Group::default()
        };
        for (is_double, changes) in [(false, true), (true, false)] {
            let [before, after, later] = [-2e-3, 3e-3, 9e-3].map(|s| inverse(s, is_double));
            assert_eq!(changes_sign(&group, &before, &after), changes);
            assert!(is_between(&group, &before, &after));
            assert!(!is_between(&group, &after, &later));
        }
    }
}
