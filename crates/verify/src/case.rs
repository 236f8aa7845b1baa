//! The checked mechanism, and the positions at which it is checked.

use crate::dense::DenseMechanism;
use crate::error::Result;
use crate::inertias::Inertias;
use dwell_geometry::space::{IdleBody, Mechanism as SpaceMechanism};
use dwell_geometry::{Mechanism, Range};
use dwell_kinetostatics::space::Mass as SpaceMass;
use std::f64::consts::TAU;

/// A mechanism with its masses, in the plane or in space.
#[derive(Debug, Clone, Copy)]
pub enum CheckedMechanism<'a> {
    /// In the plane.
    Plane(&'a Mechanism, Inertias<'a>),
    /// In space, with the bodies that have an idle rotation about the line through their spherical joints.
    Space(&'a SpaceMechanism, &'a [SpaceMass], &'a [IdleBody]),
}

impl CheckedMechanism<'_> {
    /// The mechanism in dense rows, not yet assembled.
    pub(crate) fn dense(&self) -> Result<DenseMechanism> {
        match *self {
            Self::Plane(mechanism, inertias) => {
                DenseMechanism::without_rank_check(mechanism, inertias)
            }
            Self::Space(mechanism, masses, idle) => {
                DenseMechanism::in_space(mechanism, masses, idle)
            }
        }
    }
}

/// A mechanism, and the positions at which a subject is checked.
#[derive(Debug, Clone)]
pub struct Case<'a> {
    /// The mechanism; one actuator.
    pub mechanism: CheckedMechanism<'a>,
    /// The range of the coordinate.
    pub range: Range,
    /// The sampled coordinates, rad. See [`spread`].
    pub positions: Vec<f64>,
}

/// `count` positions inside the range, spaced by the golden ratio: no two are equal, none is at a round angle or at an
/// end, and even a few positions cover every part of the range.
pub fn spread(range: Range, count: usize) -> Vec<f64> {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let (low, high) = range.limits().unwrap_or((0.0, TAU));
    let mut share = 0.5 * GOLDEN;
    (0..count)
        .map(|_| {
            share = (share + GOLDEN).fract();
            low + (high - low) * share
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_fill_the_range() {
        let mut all = spread(Range::Limited(1.0, 3.0), 24);
        all.sort_by(f64::total_cmp);
        assert!(all[0] > 1.0 && all[23] < 3.0);
        // The three gaps of a golden sequence: no gap above twice the mean.
        assert!(all.windows(2).all(|w| w[1] - w[0] < 2.0 * 2.0 / 24.0));
        assert!(spread(Range::Full, 0).is_empty());
    }
}
