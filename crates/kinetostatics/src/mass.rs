//! The inertia of a body.

use dwell_geometry::{Vec2, vec2};

/// Mass properties of one body, SI. A massless link has all of them zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mass<C = f64> {
    /// Mass, kg.
    pub mass: C,
    /// Centre of mass in the body's frame, m.
    pub center: Vec2<C>,
    /// Moment of inertia about the centre of mass, kg m².
    pub inertia: C,
}

impl Mass {
    /// A uniform bar of a mass, kg, and a length, m, from the origin of its frame along the x axis.
    ///
    /// ```
    /// use dwell_kinetostatics::Mass;
    ///
    /// let bar = Mass::uniform_bar(3.0, 2.0);
    /// assert_eq!((bar.center.x, bar.inertia), (1.0, 1.0));
    /// ```
    pub fn uniform_bar(mass: f64, length: f64) -> Self {
        Self {
            mass,
            center: vec2(0.5 * length, 0.0),
            inertia: mass * length * length / 12.0,
        }
    }

    /// Whether all numbers are finite, and mass and inertia not negative.
    pub(crate) fn is_valid(&self) -> bool {
        let not_negative = |value: f64| value >= 0.0 && value.is_finite();
        not_negative(self.mass) && not_negative(self.inertia) && self.center.is_finite()
    }
}
