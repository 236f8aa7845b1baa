//! The separation of two branches that come close: they meet at a change point, or pass each other.
//!
//! Near such a coordinate the square of a group's determinant is a smooth function of the coordinate,
//!
//! ```text
//! D² = A ((q − q₀)² + s),    A > 0                                                          (1)
//! ```
//!
//! With s = 0 the branches meet in q₀: a change point. With s = w² > 0 they pass each other, and most of what
//! distinguishes them happens within |q − q₀| < w. With s = −w² < 0 both fold back, at q₀ ± w. A length that differs
//! by δ from that of a change point gives s of about δ over the lengths: w is its square root.
//!
//! D² is computed from poses in double-double numbers, so that s has all digits of the given lengths.

use crate::plan::range::NearBranch;
use crate::plan::{GroupKind, Plan, Pose};
use dwell_numerics::{DoubleDouble, Dual, Scalar};

/// Branches that come closer than this part of the coordinate (rad, or of the mechanism's size) meet: lengths that are
/// rounded to their last digit leave 6e-8 (of parallelograms turned by 100 angles), a length that is 1e-15 m off in
/// 0.4 m leaves 1.2e-7.
const MEETING_HALF_WIDTH: f64 = 8e-8;
/// Branches within this half-width of each other are near: steps of an integrator may pass over a narrower separation.
const NEAR_HALF_WIDTH: f64 = 0.03;
/// Distance of the points at which D² is computed. The error is of the order of this distance to the power of their
/// number.
const POINT_DISTANCE: f64 = 1e-3;
const POINTS: usize = 6;
/// Binomial coefficients by which a polynomial through the points is extrapolated to the next one before them.
const EXTRAPOLATION: [f64; POINTS] = [6.0, -15.0, 20.0, -15.0, 6.0, -1.0];

/// The separation of two branches of a group where they come close.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Separation {
    /// q₀ of (1), rad or m.
    pub(super) center: f64,
    /// s of (1), rad² or m²; zero where the branches meet to rounding.
    pub(super) square: f64,
}

impl Plan {
    /// The separation of two branches of a group near a coordinate `q` where its determinant is nearly zero, from poses
    /// on the side of `anchor`, a pose at some distance from `q`. `None` if they cannot be computed.
    pub(super) fn separation(
        &self,
        group: usize,
        q: f64,
        anchor: &Pose<f64>,
    ) -> Option<Separation> {
        let distance = anchor.q[0] - q;
        let unit = self.coordinate_unit();
        let step =
            distance.signum() * (POINT_DISTANCE * unit).min(distance.abs() / (POINTS + 1) as f64);
        let mut pose = anchor.clone();
        let mut fine: Pose<DoubleDouble> = self.pose();
        let mut squares = [DoubleDouble::from_f64(0.0); POINTS];
        for (k, square) in squares.iter_mut().enumerate().rev() {
            let at = q + step * (k + 1) as f64;
            pose = self.corrected_pose(&pose, at)?;
            fine.start_from(&pose);
            let coordinate = [DoubleDouble::from_f64(at)];
            self.positions_up_to(group, &coordinate, &mut fine).ok()?;
            let determinant = self.group_determinant(group, &fine);
            *square = determinant * determinant;
        }
        // D² at q itself and one point beyond, by the polynomial through the points.
        let extrapolated = |points: &[DoubleDouble]| {
            let terms = points.iter().zip(EXTRAPOLATION);
            terms.fold(DoubleDouble::from_f64(0.0), |sum, (&y, factor)| {
                sum + y * DoubleDouble::from_f64(factor)
            })
        };
        let here = extrapolated(&squares);
        let mut shifted = [here; POINTS];
        shifted[1..].copy_from_slice(&squares[..POINTS - 1]);
        let beyond = extrapolated(&shifted);
        let two = DoubleDouble::from_f64(2.0);
        let slope = ((squares[0] - beyond) / two).value();
        let curvature = (squares[0] - here * two + beyond).value();
        if !(curvature > 0.0 && slope.is_finite()) {
            return None;
        }
        let to_center = -slope / curvature;
        let square = (2.0 * here.value() / curvature - to_center * to_center) * step * step;
        let meets = square.abs() <= (MEETING_HALF_WIDTH * unit).powi(2);
        let found = Separation {
            center: q + to_center * step,
            square: if meets { 0.0 } else { square },
        };
        found.square.is_finite().then_some(found)
    }

    /// The determinant of a group at a pose, up to its sign.
    pub(super) fn group_determinant<T: Scalar>(&self, group: usize, pose: &Pose<T>) -> T {
        match &self.groups[group].kind {
            GroupKind::RrrDyad(_) | GroupKind::GuidedPoint(_) => {
                T::from_f64(1.0) / pose.inverse_determinant[group]
            }
            GroupKind::Factored(factored_group) => factored_group.determinant(pose),
        }
    }

    /// Where, between two coordinates, another branch passes near this one, from the determinants of all groups there
    /// with their derivatives.
    pub(super) fn branches_passed<'m>(
        &self,
        [from, to]: [f64; 2],
        [before, after]: [&'m [Dual]; 2],
    ) -> impl Iterator<Item = NearBranch> + use<'m> {
        let widest = NEAR_HALF_WIDTH * self.coordinate_unit();
        let pairs = before.iter().zip(after).enumerate();
        pairs.filter_map(move |(group, (a, b))| {
            // Half the derivative of D², and its rate.
            let slopes = [a.v * a.d, b.v * b.d];
            if slopes[0] * slopes[1] > 0.0 {
                return None;
            }
            let rate = (slopes[1] - slopes[0]) / (to - from);
            let to_center = -slopes[0] / rate;
            let half_width = (a.v * a.v / rate - to_center * to_center).max(0.0).sqrt();
            (rate > 0.0 && half_width < widest).then_some(NearBranch {
                q: from + to_center,
                half_width,
                group,
            })
        })
    }

    /// The near branch beyond a fold, if both branches fold back at a small distance.
    pub(super) fn branch_beyond(&self, group: usize, found: Separation) -> Option<NearBranch> {
        let half_width = found.square.abs().sqrt();
        let is_near = half_width > 0.0 && half_width < NEAR_HALF_WIDTH * self.coordinate_unit();
        is_near.then_some(NearBranch {
            q: found.center,
            half_width,
            group,
        })
    }
}
