//! Friction in joints.

use super::Keys;
use crate::value::Value;

/// Dry (Coulomb) and viscous friction in a revolute joint, a prismatic joint or a slot.
///
/// ```
/// use dwell::Friction;
/// let bearing = Friction::pin(0.08, 0.006).with("viscous", 0.001);
/// let guide = Friction::slide(0.1).with("guide-length", 0.04);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Friction(pub(crate) Keys);

impl Friction {
    /// Dry friction of a pin: coefficient, and radius of the pin, m.
    ///
    /// ```
    /// let bearing = dwell::Friction::pin(0.08, 0.006);
    /// ```
    pub fn pin(coefficient: f64, radius: f64) -> Self {
        Self(Keys::new("coefficient", coefficient).with("radius", radius))
    }

    /// Dry friction of a slide or a slot: coefficient.
    ///
    /// ```
    /// let guide = dwell::Friction::slide(0.1);
    /// ```
    pub fn slide(coefficient: f64) -> Self {
        Self(Keys::new("coefficient", coefficient))
    }

    /// Viscous friction alone, N·m·s/rad in a pin or N·s/m in a slide.
    ///
    /// ```
    /// let oil = dwell::Friction::viscous(0.002);
    /// ```
    pub fn viscous(coefficient: f64) -> Self {
        Self(Keys::new("viscous", coefficient))
    }

    /// Sets another key: `viscous`, `guide-length`, `static-coefficient`, or `regularization-speed`, without
    /// which dry friction sticks at rest.
    ///
    /// ```
    /// let guide = dwell::Friction::slide(0.1).with("regularization-speed", 0.005);
    /// ```
    #[must_use]
    pub fn with(self, key: &str, value: impl Into<Value>) -> Self {
        Self(self.0.with(key, value))
    }
}
