//! Functions of one variable: motion laws, and couplings.

use super::Keys;
use crate::value::Value;

/// A coordinate as a function of time, s, or of another coordinate, rad or m. Units are SI.
///
/// ```
/// use dwell::Law;
/// let constant_speed = Law::speed(10.0);
/// let dwell_rise = Law::cycloidal(0.5, 0.2).with("delay", 0.1);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Law(pub(crate) Keys);

impl Law {
    /// A constant speed, rad/s or m/s (not for a coupling).
    ///
    /// ```
    /// let law = dwell::Law::speed(10.0);
    /// ```
    pub fn speed(speed: f64) -> Self {
        Self(Keys::new("speed", speed))
    }

    /// A sinusoid of an amplitude and a period; further key: `phase`.
    ///
    /// ```
    /// let law = dwell::Law::sinusoid(0.3, 2.0);
    /// ```
    pub fn sinusoid(amplitude: f64, period: f64) -> Self {
        let keys = Keys::new("amplitude", amplitude).with("period", period);
        Self(Keys::new("sinusoid", keys))
    }

    /// A rise from rest to rest by the 3-4-5 polynomial; further key: `delay`.
    ///
    /// ```
    /// let law = dwell::Law::polynomial345(1.0, 0.5);
    /// ```
    pub fn polynomial345(rise: f64, duration: f64) -> Self {
        Self::rise("polynomial345", rise, duration)
    }

    /// A rise from rest to rest by the 4-5-6-7 polynomial; further key: `delay`.
    ///
    /// ```
    /// let law = dwell::Law::polynomial4567(1.0, 0.5);
    /// ```
    pub fn polynomial4567(rise: f64, duration: f64) -> Self {
        Self::rise("polynomial4567", rise, duration)
    }

    /// A cycloidal rise from rest to rest; further key: `delay`.
    ///
    /// ```
    /// let law = dwell::Law::cycloidal(1.0, 0.5);
    /// ```
    pub fn cycloidal(rise: f64, duration: f64) -> Self {
        Self::rise("cycloidal", rise, duration)
    }

    /// A rise with constant acceleration, velocity and deceleration; `ramp` is the duration of the acceleration, and of
    /// the deceleration. Further key: `delay`.
    ///
    /// ```
    /// let law = dwell::Law::trapezoidal(1.0, 0.5, 0.1);
    /// ```
    pub fn trapezoidal(rise: f64, duration: f64, ramp: f64) -> Self {
        Self::rise("trapezoidal", rise, duration).with("ramp", ramp)
    }

    /// A smooth curve through points [x, y].
    ///
    /// ```
    /// let law = dwell::Law::table(&[[0.0, 0.0], [1.0, 0.5], [2.0, 2.0]]);
    /// ```
    pub fn table(points: &[[f64; 2]]) -> Self {
        Self(Keys::new("table", points.to_vec()))
    }

    /// An expression of the time `t`, or in a coupling of the variable `x`.
    ///
    /// ```
    /// let law = dwell::Law::expression("0.5*t^2");
    /// ```
    pub fn expression(expression: &str) -> Self {
        Self(Keys::new("expression", expression))
    }

    fn rise(kind: &str, rise: f64, duration: f64) -> Self {
        let keys = Keys::new("rise", rise).with("duration", duration);
        Self(Keys::new(kind, keys))
    }

    /// Sets another key: `delay` of a rise, `phase` of a sinusoid, `start` of the law of a coupling.
    ///
    /// ```
    /// let law = dwell::Law::cycloidal(1.0, 0.5).with("delay", 0.1);
    /// ```
    #[must_use]
    pub fn with(mut self, key: &str, value: impl Into<Value>) -> Self {
        match self.0.0.first_mut() {
            Some((_, Value::Table(keys))) if key != "start" => {
                *keys = Keys(std::mem::take(keys)).with(key, value).0;
            }
            _ => self.0 = self.0.with(key, value),
        }
        self
    }
}
