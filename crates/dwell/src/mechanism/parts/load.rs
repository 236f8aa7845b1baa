//! Loads and their magnitudes.

use super::Keys;
use crate::value::Value;
use dwell_kinetostatics::MagnitudeFunction;

/// The magnitude of a load: a number, an expression, a table, or a function of your program. Numbers and texts
/// convert into it.
///
/// ```
/// use dwell::{Load, Magnitude};
/// let constant = Load::torque("crank", -3.0);
/// let expression = Load::torque("crank", "-0.2*phi.velocity");
/// let table = Load::torque("crank", Magnitude::table("phi", &[[0.0, 1.0], [6.3, 1.5]]));
/// let own = Load::torque("crank", Magnitude::function(&["phi.velocity"], |s| -0.2 * s[0] * s[0].abs()));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Magnitude {
    value: Value,
    function: Option<LoadFunction>,
}

/// A function of the program.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoadFunction {
    /// The names of its signals.
    pub(crate) signals: Vec<String>,
    pub(crate) function: MagnitudeFunction,
    /// By name of a signal: the values at which the function jumps or has a kink.
    pub(crate) breakpoints: Vec<(String, Vec<f64>)>,
}

impl Magnitude {
    /// A smooth curve through points [x, magnitude], where x is `t`, a coordinate, or a velocity such as `phi.velocity`.
    ///
    /// ```
    /// let gas = dwell::Magnitude::table("phi", &[[0.0, 900.0], [3.2, 100.0], [6.3, 900.0]]);
    /// ```
    pub fn table(of: &str, points: &[[f64; 2]]) -> Self {
        let keys = Keys::new("table", points.to_vec()).with("of", of);
        Self {
            value: keys.into(),
            function: None,
        }
    }

    /// A function of signals: `t` (s), coordinates (rad or m) and velocities such as `phi.velocity`, in the given
    /// order. It must be smooth except at its [breakpoints](Self::breakpoints). The text of a scene
    /// cannot contain it; there the magnitude is an expression without a
    /// value.
    ///
    /// ```
    /// let drag = dwell::Magnitude::function(&["phi.velocity"], |s| -0.2 * s[0] * s[0].abs());
    /// ```
    pub fn function(
        signals: &[&str],
        function: impl Fn(&[f64]) -> f64 + Send + Sync + 'static,
    ) -> Self {
        let signals = signals.iter().map(|&s| s.to_owned()).collect();
        Self {
            value: NO_VALUE.into(),
            function: Some(LoadFunction {
                signals,
                function: MagnitudeFunction::new(function),
                breakpoints: Vec::new(),
            }),
        }
    }

    /// Its function, if it is one.
    pub(crate) fn load_function(&self) -> Option<&LoadFunction> {
        self.function.as_ref()
    }

    /// Adds values of a signal at which the function jumps or has a kink, such as the time at which it is switched on. The integration of a motion
    /// stops at each of them and restarts, as at the switches of an expression. Without breakpoints a jump makes the steps so
    /// short that the motion ends, and a short pulse may be missed. No effect on other kinds of magnitudes.
    ///
    /// ```
    /// let cutting = dwell::Magnitude::function(&["ram.velocity"], |s| if s[0] < -0.02 { 1500.0 } else { 0.0 })
    ///     .breakpoints("ram.velocity", &[-0.02]);
    /// ```
    #[must_use]
    pub fn breakpoints(mut self, signal: &str, values: &[f64]) -> Self {
        if let Some(function) = &mut self.function {
            let values = values.to_vec();
            function.breakpoints.push((signal.to_owned(), values));
        }
        self
    }
}

/// The text in a scene that replaces a function; without the function, every evaluation fails and names the load.
pub(crate) const NO_VALUE: &str = "0/(t - t)";

impl From<f64> for Magnitude {
    fn from(number: f64) -> Self {
        Self {
            value: number.into(),
            function: None,
        }
    }
}

impl From<String> for Magnitude {
    fn from(expression: String) -> Self {
        expression.as_str().into()
    }
}

impl From<&str> for Magnitude {
    fn from(expression: &str) -> Self {
        Self {
            value: expression.into(),
            function: None,
        }
    }
}

/// A load. Points are written `body.point`; a torque between two bodies is that of the first on the second.
///
/// ```
/// let gas = dwell::Load::force("piston.C", [-1.0, 0.0], "400*(1 + cos(phi))");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    pub(crate) keys: Keys,
    pub(crate) function: Option<LoadFunction>,
}

impl Load {
    fn new(keys: Keys, magnitude_key: &str, magnitude: impl Into<Magnitude>) -> Self {
        let Magnitude { value, function } = magnitude.into();
        Self {
            keys: keys.with(magnitude_key, value),
            function,
        }
    }

    /// The weight of every body: the acceleration of gravity, m/s².
    ///
    /// ```
    /// let weight = dwell::Load::gravity([0.0, -9.81]);
    /// ```
    pub fn gravity<const N: usize>(acceleration: [f64; N]) -> Self {
        Self {
            keys: Keys::new("gravity", acceleration),
            function: None,
        }
    }

    /// A force, N, at a point, in a direction of the ground's frame (or the body's: `.with("frame", "body")`).
    ///
    /// ```
    /// let push = dwell::Load::force("piston.P", [-1.0, 0.0], 100.0);
    /// ```
    pub fn force<const N: usize>(
        point: &str,
        direction: [f64; N],
        magnitude: impl Into<Magnitude>,
    ) -> Self {
        let keys = Keys::new("force", point).with("direction", direction);
        Self::new(keys, "magnitude", magnitude)
    }

    /// A torque on a body, N·m, counter-clockwise positive; in space about an axis, `.with("axis", [0.0, 0.0, 1.0])`.
    ///
    /// ```
    /// let brake = dwell::Load::torque("crank", "-0.5*phi.velocity");
    /// ```
    pub fn torque(body: &str, magnitude: impl Into<Magnitude>) -> Self {
        Self::new(Keys::new("torque", body), "magnitude", magnitude)
    }

    /// A torque of the first body on the second, N·m.
    ///
    /// ```
    /// let motor = dwell::Load::torque_between("rod", "crank", 2.0);
    /// ```
    pub fn torque_between(first: &str, second: &str, magnitude: impl Into<Magnitude>) -> Self {
        Self::new(Keys::new("torque", [first, second]), "magnitude", magnitude)
    }

    /// A force that pushes two points apart, N.
    ///
    /// ```
    /// let cylinder = dwell::Load::point_to_point_force("ground.T", "boom.P", 50.0);
    /// ```
    pub fn point_to_point_force(
        first: &str,
        second: &str,
        magnitude: impl Into<Magnitude>,
    ) -> Self {
        let keys = Keys::new("point-to-point-force", [first, second]);
        Self::new(keys, "magnitude", magnitude)
    }

    /// A force along the axis of a prismatic joint or a slot, of its first body on its second, N.
    ///
    /// ```
    /// let cutting = dwell::Load::slide_force("guide", -20.0);
    /// ```
    pub fn slide_force(joint: &str, magnitude: impl Into<Magnitude>) -> Self {
        Self::new(Keys::new("slide-force", joint), "magnitude", magnitude)
    }

    /// A spring between two points: stiffness, N/m, and free length, m.
    ///
    /// ```
    /// let spring = dwell::Load::spring("ground.A", "piston.P", 4530.0, 0.0779);
    /// ```
    pub fn spring(
        first: &str,
        second: &str,
        stiffness: impl Into<Magnitude>,
        free_length: f64,
    ) -> Self {
        let keys = Keys::new("spring", [first, second]).with("free-length", free_length);
        Self::new(keys, "stiffness", stiffness)
    }

    /// A torsional spring between two bodies: stiffness, N·m/rad, and free angle, rad.
    ///
    /// ```
    /// let spring = dwell::Load::torsion_spring("ground", "crank", 10.0, 0.0);
    /// ```
    pub fn torsion_spring(
        first: &str,
        second: &str,
        stiffness: impl Into<Magnitude>,
        free_angle: f64,
    ) -> Self {
        let keys = Keys::new("torsion-spring", [first, second]).with("free-angle", free_angle);
        Self::new(keys, "stiffness", stiffness)
    }

    /// A viscous damper between two points, N·s/m.
    ///
    /// ```
    /// let damper = dwell::Load::damper("ground.A", "piston.P", 100.0);
    /// ```
    pub fn damper(first: &str, second: &str, damping: impl Into<Magnitude>) -> Self {
        Self::new(Keys::new("damper", [first, second]), "damping", damping)
    }

    /// A viscous damper between the angles of two bodies, N·m·s/rad.
    ///
    /// ```
    /// let damper = dwell::Load::rotational_damper("ground", "crank", 0.1);
    /// ```
    pub fn rotational_damper(first: &str, second: &str, damping: impl Into<Magnitude>) -> Self {
        let keys = Keys::new("rotational-damper", [first, second]);
        Self::new(keys, "damping", damping)
    }

    /// The drag of a point in a fluid at rest, −c |v| v, by its coefficient c, N·s²/m².
    ///
    /// ```
    /// let sail = dwell::Load::drag("vane.P", 0.6);
    /// ```
    pub fn drag(point: &str, coefficient: impl Into<Magnitude>) -> Self {
        Self::new(Keys::new("drag", point), "coefficient", coefficient)
    }

    /// The drag of a fan between the angles of two bodies, −c |ω| ω, by its coefficient c, N·m·s²/rad².
    ///
    /// ```
    /// let fan = dwell::Load::rotational_drag("ground", "rotor", 0.002);
    /// ```
    pub fn rotational_drag(first: &str, second: &str, coefficient: impl Into<Magnitude>) -> Self {
        let keys = Keys::new("rotational-drag", [first, second]);
        Self::new(keys, "coefficient", coefficient)
    }

    /// Sets another key of its kind.
    ///
    /// ```
    /// let thrust = dwell::Load::force("boat.P", [1.0, 0.0], 10.0).with("frame", "body");
    /// ```
    #[must_use]
    pub fn with(mut self, key: &str, value: impl Into<Value>) -> Self {
        self.keys = self.keys.with(key, value);
        self
    }
}
