//! Strength laws: the meaning of the magnitude F of a load, in the plane and in space.
//!
//! A load along a coordinate s, or against the velocity of a point, is a shape (its place) times a strength law:
//!
//! | law | force along s | F is |
//! |---|---|---|
//! | direct | F | the force or couple |
//! | elastic | −F (s − free) | the stiffness |
//! | viscous | −F ṡ | the damping |
//! | quadratic | −F \|ṡ\| ṡ | the coefficient of drag |
//!
//! A new law is a variant here, with an arm in each function of this file.

use dwell_geometry::Vec2;
use dwell_geometry::space::Vec3;
use dwell_numerics::{Constant, Lift, Scalar};
use std::ops::{Add, Neg};

/// The meaning of the magnitude F of a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Strength<C = f64> {
    /// F is the force, N, or the couple, N·m.
    Direct,
    /// F is a stiffness, N/m or N·m/rad.
    Elastic {
        /// The length, travel (m) or angle (rad) without force; an angle with its whole revolutions.
        free: C,
    },
    /// F is a damping, N·s/m or N·m·s/rad.
    Viscous,
    /// F is a coefficient of drag, N·s²/m² or N·m·s²/rad².
    Quadratic,
}

/// How a law is named and written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StrengthWords {
    /// Name of its magnitude.
    pub magnitude: &'static str,
    /// The units of the magnitude, of a force and of a couple.
    pub units: [&'static str; 2],
    /// Names of a load of this law: as a force, and as a couple.
    pub load: [&'static str; 2],
    /// Why its magnitude must not be negative; `None` if it may.
    pub not_negative: Option<&'static str>,
}

/// The symbol between the two ends of a load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoadSymbol {
    /// A spring.
    Spring,
    /// A damper.
    Damper,
}

impl Strength {
    /// Its names and units.
    pub fn words(self) -> StrengthWords {
        match self {
            Self::Direct => StrengthWords {
                magnitude: "magnitude",
                units: ["N", "N m"],
                load: ["force", "couple"],
                not_negative: None,
            },
            Self::Elastic { .. } => StrengthWords {
                magnitude: "stiffness",
                units: ["N/m", "N m/rad"],
                load: ["spring", "torsion spring"],
                not_negative: Some("a negative stiffness would push away from the free position"),
            },
            Self::Viscous => StrengthWords {
                magnitude: "damping",
                units: ["N s/m", "N m s/rad"],
                load: ["damper", "rotational damper"],
                not_negative: Some("negative damping would accelerate the motion"),
            },
            Self::Quadratic => StrengthWords {
                magnitude: "coefficient",
                units: ["N s2/m2", "N m s2/rad2"],
                load: ["drag", "rotational drag"],
                not_negative: Some("negative drag would accelerate the motion"),
            },
        }
    }

    /// The units of the generalised force and of a reaction force and moment of a unit of the load, by whether it is a couple and whether the
    /// coordinate of the mechanism is an angle.
    pub(super) fn response_units(self, is_couple: bool, is_angle: bool) -> [&'static str; 3] {
        let [along_angle, along_length, force, moment] = match (self, is_couple) {
            (Self::Direct | Self::Viscous, false) => ["m", "", "", "m"],
            (Self::Direct | Self::Viscous, true) => ["", "1/m", "1/m", ""],
            (Self::Elastic { .. }, false) => ["m2", "m", "m", "m2"],
            (Self::Elastic { .. }, true) => ["rad", "rad/m", "rad/m", "rad"],
            // At unit speed of the coordinate.
            (Self::Quadratic, false) if is_angle => ["m3", "", "m2", "m3"],
            (Self::Quadratic, false) => ["", "", "", "m"],
            (Self::Quadratic, true) if is_angle => ["", "", "1/m", ""],
            (Self::Quadratic, true) => ["", "1/m3", "1/m3", "1/m2"],
        };
        let work = if is_angle { along_angle } else { along_length };
        [work, force, moment]
    }

    /// The factor of w, the generalised force of a [unit](Self::unit), at the speed q̇ of a mechanism of one coordinate.
    #[inline]
    pub fn on_response<T: Scalar>(self, f: T, w: T, q_dot: T) -> T {
        match self {
            Self::Direct | Self::Elastic { .. } => f,
            // w is −ds/dq.
            Self::Viscous => -(f * w * q_dot),
            Self::Quadratic => f * absolute(q_dot * q_dot) * q_dot,
        }
    }

    /// Whether its number is usable: finite, and of a distance not negative.
    pub(crate) fn is_sound(self, is_distance: bool) -> bool {
        self.free()
            .is_none_or(|free| free.is_finite() && (free >= 0.0 || !is_distance))
    }

    /// The work of a unit of the magnitude over a length: the length for a force, its square for a stiffness, zero for
    /// resistances.
    pub(crate) fn work_lever(self, length: f64) -> f64 {
        match self {
            Self::Direct => length,
            Self::Elastic { .. } => length * length,
            Self::Viscous | Self::Quadratic => 0.0,
        }
    }

    /// The symbol between its ends.
    pub fn symbol(self) -> Option<LoadSymbol> {
        match self {
            Self::Direct => None,
            Self::Elastic { .. } => Some(LoadSymbol::Spring),
            Self::Viscous | Self::Quadratic => Some(LoadSymbol::Damper),
        }
    }
}

impl<C: Constant> Strength<C> {
    /// Whether it acts against a velocity.
    pub fn resists(self) -> bool {
        match self {
            Self::Direct | Self::Elastic { .. } => false,
            Self::Viscous | Self::Quadratic => true,
        }
    }

    /// The law and the magnitude of a unit of the load, whose response tables contain. For a damper it is a unit of its resistance, which
    /// does not depend on the velocity. For a drag it is coefficient 1 at the velocities of the state, because c |v| v has no direction
    /// at rest.
    pub fn unit(self) -> (Self, f64) {
        match self {
            Self::Direct | Self::Elastic { .. } | Self::Quadratic => (self, 1.0),
            Self::Viscous => (Self::Direct, -1.0),
        }
    }

    /// Its length (m) or angle (rad) without force, if it has one.
    pub fn free(self) -> Option<C> {
        match self {
            Self::Elastic { free } => Some(free),
            Self::Direct | Self::Viscous | Self::Quadratic => None,
        }
    }

    /// The force or couple along a coordinate, from its magnitude, and from the value (rad or m) and the rate of the coordinate.
    #[inline]
    pub fn force<T: Lift<C>>(self, f: T, value: impl FnOnce() -> T, rate: impl FnOnce() -> T) -> T {
        match self {
            Self::Direct => f,
            Self::Elastic { free } => -(f * (value() - T::lift(free))),
            Self::Viscous => -(f * rate()),
            Self::Quadratic => {
                let rate = rate();
                -(f * absolute(rate * rate) * rate)
            }
        }
    }

    /// The force on the second of two points, along the line from the first; `None` if they coincide and it needs a direction.
    #[inline]
    pub(crate) fn force_along_line<T: Lift<C>, V: LoadVector<T>>(
        self,
        f: T,
        line: &Line<V>,
    ) -> Option<V> {
        let Line {
            gap,
            direction,
            velocity,
        } = *line;
        // Where the force is to depend on the free length, a length of zero is a number as any other.
        let is_zero = C::IS_PREPARED && self.free().is_some_and(|free| free.value() == 0.0);
        let Some(e) = direction else {
            let is_still = self.resists() && velocity.is_zero();
            return match self {
                Self::Elastic { .. } if is_zero => Some(-gap.times(f)),
                _ => (is_still || f.value() == 0.0).then(V::zero),
            };
        };
        Some(match self {
            Self::Direct => e.times(f),
            // −k d + k free e: the first part is smooth where the points meet.
            Self::Elastic { .. } if is_zero => -gap.times(f),
            Self::Elastic { free } => -gap.times(f) + e.times(f * T::lift(free)),
            Self::Viscous => -e.times(e.dot(velocity) * f),
            Self::Quadratic => {
                let rate = e.dot(velocity);
                -e.times(absolute(rate * rate) * rate * f)
            }
        })
    }
}

/// The force −F |v| v on a point of this velocity.
#[inline]
pub(crate) fn drag<T: Scalar, V: LoadVector<T>>(f: T, velocity: V) -> V {
    -velocity.times(f * absolute(velocity.dot(velocity)))
}

/// The square root, with the derivative zero at zero: of the square of a velocity that is multiplied by the velocity.
#[inline]
fn absolute<T: Scalar>(square: T) -> T {
    if T::LANES == 1 && square.value() == 0.0 {
        T::from_f64(0.0)
    } else {
        square.sqrt()
    }
}

/// The line between two points.
pub(crate) struct Line<V> {
    /// The vector from the first point to the second, m.
    pub(crate) gap: V,
    /// Its unit vector; `None` if the points coincide.
    pub(crate) direction: Option<V>,
    /// The rate of the gap, m/s.
    pub(crate) velocity: V,
}

/// A vector in which a force along a line is computed.
pub(crate) trait LoadVector<T>: Copy + Neg<Output = Self> + Add<Output = Self> {
    /// The zero vector.
    fn zero() -> Self;
    /// Scalar product.
    fn dot(self, other: Self) -> T;
    /// The vector times a number.
    fn times(self, by: T) -> Self;
    /// Whether all its components are zero.
    fn is_zero(self) -> bool;
}

impl<T: Scalar> LoadVector<T> for Vec2<T> {
    #[inline(always)]
    fn zero() -> Self {
        Self::zero()
    }

    #[inline(always)]
    #[track_caller]
    fn dot(self, other: Self) -> T {
        self.dot(other)
    }

    #[inline(always)]
    #[track_caller]
    fn times(self, by: T) -> Self {
        self * by
    }

    fn is_zero(self) -> bool {
        self.x.value() == 0.0 && self.y.value() == 0.0
    }
}

impl<T: Scalar> LoadVector<T> for Vec3<T> {
    #[inline(always)]
    fn zero() -> Self {
        Self::zero()
    }

    #[inline(always)]
    #[track_caller]
    fn dot(self, other: Self) -> T {
        self.dot(other)
    }

    #[inline(always)]
    #[track_caller]
    fn times(self, by: T) -> Self {
        self.scaled(by)
    }

    fn is_zero(self) -> bool {
        self.dot(self).value() == 0.0
    }
}
