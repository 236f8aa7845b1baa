//! Joints and couplings.

use super::{Keys, Law};
use crate::value::Value;

/// A joint of two bodies, or a coupling of two coordinates. A point is written `body.point`; an axis and an angle are
/// in the frame of the first-named body. The reaction is the force or moment of the first-named body on the second.
///
/// Each kind has a function with its required keys; [`with`](Joint::with) sets optional ones. `docs/scene-format.md` describes the kinds and
/// their keys.
///
/// ```
/// use dwell::Joint;
/// let pin = Joint::revolute("ground.A", "crank.A");
/// let mesh = Joint::gear("sun.S", "ring.R", [0.02, 0.06]).with("internal", true);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Joint(pub(crate) Keys);

impl Joint {
    /// A pin. Its reaction has the components `x` and `y`, N, in the ground's axes. In space it rotates about an axis, which is the same in
    /// the frames of both bodies, and its reaction has `x`, `y`, `z`, `moment-x`, `moment-y` and `moment-z`.
    ///
    /// ```
    /// let pin = dwell::Joint::revolute("ground.A", "crank.A");
    /// let in_space = dwell::Joint::revolute("ground.A", "crank.A").with("axis", [0.0, 0.0, 1.0]);
    /// ```
    pub fn revolute(first: &str, second: &str) -> Self {
        Self(Keys::new("revolute", [first, second]))
    }

    /// A slide: the second body's point stays on the line through the first body's point along `axis`, which is the
    /// same in the frames of both bodies. Its reaction has `normal`, N, and `moment`, N·m.
    ///
    /// ```
    /// let guide = dwell::Joint::prismatic("ground.G", "piston.C", [1.0, 0.0]);
    /// ```
    pub fn prismatic<const N: usize>(first: &str, second: &str, axis: [f64; N]) -> Self {
        Self(Keys::new("prismatic", [first, second]).with("axis", axis))
    }

    /// A ball joint, in space. Its reaction is `x`, `y` and `z`, N.
    ///
    /// ```
    /// let ball = dwell::Joint::spherical("crank.B", "coupler.B");
    /// ```
    pub fn spherical(first: &str, second: &str) -> Self {
        Self(Keys::new("spherical", [first, second]))
    }

    /// A pin of the second body in a straight slot of the first, along `axis`. Its reaction is `normal`, N.
    ///
    /// ```
    /// let slot = dwell::Joint::slot("rocker.O", "crank.B", [1.0, 0.0]);
    /// ```
    pub fn slot(first: &str, second: &str, axis: [f64; 2]) -> Self {
        Self(Keys::new("slot", [first, second]).with("axis", axis))
    }

    /// A rigid connection. Its reaction has `x`, `y`, N, and `moment`, N·m.
    ///
    /// ```
    /// let weld = dwell::Joint::weld("rod.P", "tool.P").with("angle", 0.5);
    /// ```
    pub fn weld(first: &str, second: &str) -> Self {
        Self(Keys::new("weld", [first, second]))
    }

    /// Two points at a constant distance `length`, m, as if joined by a massless link. Its reaction is `axial`, N.
    ///
    /// ```
    /// let link = dwell::Joint::distance("crank.B", "piston.P", 0.2);
    /// ```
    pub fn distance(first: &str, second: &str, length: f64) -> Self {
        Self(Keys::new("distance", [first, second]).with("length", length))
    }

    /// Two gears with their centres and pitch radii, m. Its reaction is `tooth`, N. Further keys: `internal`, and
    /// `pressure-angle` (rad), which adds the separating force of the teeth.
    ///
    /// ```
    /// let mesh = dwell::Joint::gear("crank.A", "wheel.C", [0.03, 0.02]);
    /// ```
    pub fn gear(first: &str, second: &str, radii: [f64; 2]) -> Self {
        Self(Keys::new("gear", [first, second]).with("radii", radii))
    }

    /// A straight rack with a point of its pitch line and the line's direction, and a pinion with its centre and pitch
    /// radius, m. Its reaction is `tooth`, N. A further key: `pressure-angle` (rad).
    ///
    /// ```
    /// let mesh = dwell::Joint::rack("piston.P", "wheel.C", [1.0, 0.0], 0.02);
    /// ```
    pub fn rack(rack: &str, pinion: &str, axis: [f64; 2], radius: f64) -> Self {
        let keys = Keys::new("rack", [rack, pinion]).with("axis", axis);
        Self(keys.with("radius", radius))
    }

    /// A disc of a radius, m, that rolls on a straight track. Its reaction has `normal` and `tangent`, N.
    ///
    /// ```
    /// let contact = dwell::Joint::rolling("ground.T", "wheel.C", [1.0, 0.0], 0.02);
    /// ```
    pub fn rolling(track: &str, disc: &str, axis: [f64; 2], radius: f64) -> Self {
        let keys = Keys::new("rolling", [track, disc]).with("axis", axis);
        Self(keys.with("radius", radius))
    }

    /// A coupling: the first coordinate is a function of the second, such as the travel of a follower of the angle of its
    /// cam. Its reaction is `force`, N, or `moment`, N·m.
    ///
    /// ```
    /// use dwell::{Joint, Law};
    /// let cam = Joint::coupling("lift", "phi", Law::cycloidal(0.02, 2.0));
    /// ```
    pub fn coupling(dependent: &str, independent: &str, law: Law) -> Self {
        let keys = Keys::new("coupling", [dependent, independent]);
        let all = law.0.0.into_iter();
        Self(all.fold(keys, |keys, (key, value)| keys.with(&key, value)))
    }

    /// Sets another key of its kind.
    ///
    /// ```
    /// let mesh = dwell::Joint::gear("sun.S", "ring.R", [0.02, 0.06]).with("internal", true);
    /// ```
    #[must_use]
    pub fn with(self, key: &str, value: impl Into<Value>) -> Self {
        Self(self.0.with(key, value))
    }
}
