//! A sinusoid.

use std::f64::consts::TAU;

use crate::error::{LawError, require_finite, require_positive};

/// offset + amplitude · sin(angular frequency · x + phase).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sinusoid {
    /// The mean value.
    pub offset: f64,
    /// The amplitude, in the unit of the value.
    pub amplitude: f64,
    /// The angular frequency, rad over the unit of x.
    pub angular_frequency: f64,
    /// The phase at x = 0, rad.
    pub phase: f64,
}

impl Sinusoid {
    /// The oscillation that passes through `start` at x = 0, where its phase is `phase`, rad:
    /// start + amplitude · (sin(2π x/period + phase) − sin(phase)).
    ///
    /// # Errors
    /// [`LawError::NotFinite`] for any of the four, [`LawError::NotPositive`] for the period.
    pub fn starting_at(
        start: f64,
        amplitude: f64,
        period: f64,
        phase: f64,
    ) -> Result<Self, LawError> {
        let phase = require_finite("phase", phase)?;
        let amplitude = require_finite("amplitude", amplitude)?;
        Ok(Self {
            offset: require_finite("start", start)? - amplitude * phase.sin(),
            amplitude,
            angular_frequency: TAU / require_positive("period", period)?,
            phase,
        })
    }

    /// The value and its first three derivatives at `x`.
    pub fn eval(&self, x: f64) -> [f64; 4] {
        let w = self.angular_frequency;
        let (sin, cos) = (w * x + self.phase).sin_cos();
        let speed = self.amplitude * w;
        [
            self.offset + self.amplitude * sin,
            speed * cos,
            -speed * w * sin,
            -speed * w * w * cos,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of a period after a zero phase the sine stands at its crest.
    #[test]
    fn crest_and_crossing() {
        let law = Sinusoid::starting_at(2.0, 3.0, TAU / 2.0, 0.0).expect("a sinusoid");
        assert_eq!(law.eval(0.0), [2.0, 6.0, 0.0, -24.0]);
        let [value, speed, acceleration, _] = law.eval(TAU / 8.0);
        assert_eq!([value, acceleration], [5.0, -12.0]);
        // The cosine of π/2, rounded, is 6e-17.
        assert!(speed.abs() < 1e-15);
    }

    #[test]
    fn it_starts_where_it_was_told_to() {
        let law = Sinusoid::starting_at(0.1, 0.3, 2.0, 1.0).expect("a sinusoid");
        // One rounding each in offset and sum, of numbers below 0.5.
        assert!((law.eval(0.0)[0] - 0.1).abs() < 1e-16);
    }

    #[test]
    fn errors_say_which_number() {
        assert_eq!(
            Sinusoid::starting_at(0.0, 1.0, 0.0, 0.0),
            Err(LawError::NotPositive {
                name: "period",
                value: 0.0
            })
        );
        let error = Sinusoid::starting_at(0.0, f64::INFINITY, 1.0, 0.0).expect_err("infinite");
        assert_eq!(
            error.to_string(),
            "`amplitude` is inf, and must be a finite number"
        );
    }
}
