//! How far a single actuator can go on the branch of the assembly.

use crate::error::PositionError;
use crate::mechanism::JointId;
use std::f64::consts::TAU;

/// The range of a single actuator's coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// Every angle can be reached, with period 2π.
    Full,
    /// Every angle can be reached; the pose repeats after this number of revolutions.
    Revolutions(u32),
    /// An angle between two limit positions or change points, rad.
    Limited(f64, f64),
    /// A driven length between two limit positions or change points, m.
    Stroke(f64, f64),
    /// No end was found, and the pose does not repeat, as with a driven length or gears, or there are several
    /// actuators.
    Unbounded,
    /// No end was found between these coordinates, and no position is known beyond: rad or m.
    Unresolved(f64, f64),
}

/// Where a branch ends, and why.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeLimit {
    /// The coordinate, rad or m. A range that ends at a change point stops about a millionth of a revolution
    /// short of it, where the positions lose digits.
    pub q: f64,
    /// The group that cannot be followed any further.
    pub group: usize,
    /// Whether another branch meets this one there and could be followed: a change point; else it is
    /// a limit position, where the coordinate turns back.
    pub change_point: bool,
    /// At a change point: the half-width (rad or m) within which the two branches come close without meeting, so close
    /// that rounding does not show which of them a motion follows. `None` if they meet.
    pub separation: Option<f64>,
    /// The coupling whose table ends there, where that ends the range.
    pub table: Option<JointId>,
}

/// A place where another branch comes near this one without meeting it. Within the half-width of the coordinate, the
/// velocity ratios change from those of one branch of a change point to those of the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearBranch {
    /// The coordinate where they are nearest, rad or m. At a limit position it is that much beyond the range.
    pub q: f64,
    /// The half-width, rad or m.
    pub half_width: f64,
    /// The group of bodies whose branches they are.
    pub group: usize,
}

impl Range {
    /// The ends, rad or m, if there are any.
    pub fn limits(self) -> Option<(f64, f64)> {
        match self {
            Self::Limited(from, to) | Self::Stroke(from, to) | Self::Unresolved(from, to) => {
                Some((from, to))
            }
            Self::Full | Self::Revolutions(_) | Self::Unbounded => None,
        }
    }

    /// The period of the pose, rad, where it has one.
    pub fn period(self) -> Option<f64> {
        match self {
            Self::Full => Some(TAU),
            Self::Revolutions(revolutions) => Some(TAU * f64::from(revolutions)),
            _ => None,
        }
    }

    /// The coordinate within the range that differs from `q` by whole revolutions; the pose is the same.
    ///
    /// # Errors
    /// [`PositionError::OutOfRange`] where there is none.
    pub fn wrap(self, q: f64) -> Result<f64, PositionError> {
        let Some((from, to)) = self.limits() else {
            return Ok(q);
        };
        if !q.is_finite() {
            return Err(PositionError::NotFinite);
        }
        if (from..=to).contains(&q) {
            return Ok(q);
        }
        let wrapped = q - TAU * ((q - from) / TAU).floor();
        // A range of more than a revolution holds two poses at such a coordinate: neither is "the" pose.
        let is_angular = matches!(self, Self::Limited(..));
        if is_angular && (from..=to).contains(&wrapped) && to - from < TAU {
            Ok(wrapped)
        } else {
            Err(PositionError::OutOfRange { q, from, to })
        }
    }
}
