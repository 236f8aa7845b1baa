//! Motions from rest to rest.

use std::f64::consts::{PI, TAU};

use crate::error::{LawError, require_finite, require_positive};

/// The shape of a motion from rest to rest (for the three first R. L. Norton, *Cam Design and
/// Manufacturing Handbook*, chapter 3). Peaks: speed times rise/duration, acceleration times
/// rise/duration².
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Polynomial 3-4-5: speed and acceleration zero at both ends; peaks 1.875 and 5.7735.
    Polynomial345,
    /// Polynomial 4-5-6-7: speed, acceleration and jerk zero at both ends; peaks 2.1875 and 7.5132.
    Polynomial4567,
    /// Cycloidal: sinusoidal acceleration, zero at both ends; peaks 2 and 2π.
    Cycloidal,
    /// Trapezoidal speed: a constant acceleration, a constant speed, and as long a constant
    /// deceleration. The acceleration jumps at four corners, and is given as 0 exactly there.
    /// Peaks 1/(1 − r) and 1/(r (1 − r)) with r = ramp/duration.
    Trapezoidal {
        /// Length of each of the two ramps, s; at most half the duration.
        ramp: f64,
    },
}

/// Start value, rise and timing of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rise {
    /// The value before the motion.
    pub start: f64,
    /// The change of the value, positive or negative.
    pub rise: f64,
    /// Duration, s.
    pub duration: f64,
    /// Start, s.
    pub delay: f64,
}

/// A motion that rests exactly at start until its delay is over, and exactly at start + rise from
/// delay + duration on. (It need not be a motion in time: a cam's rise over an angle is one too.)
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    shape: Shape,
    rise: Rise,
}

impl Profile {
    /// The motion of a shape.
    ///
    /// # Errors
    /// [`LawError::NotFinite`], [`LawError::NotPositive`] for the duration or the ramp,
    /// [`LawError::RampTooLong`].
    pub fn new(shape: Shape, rise: Rise) -> Result<Self, LawError> {
        require_finite("start", rise.start)?;
        require_finite("rise", rise.rise)?;
        require_finite("delay", rise.delay)?;
        let duration = require_positive("duration", rise.duration)?;
        if let Shape::Trapezoidal { ramp } = shape
            && 2.0 * require_positive("ramp", ramp)? > duration
        {
            return Err(LawError::RampTooLong { ramp, duration });
        }
        Ok(Self { shape, rise })
    }

    /// Where its derivatives may jump: its ends, and the corners of a trapezoidal velocity.
    pub fn corners(&self) -> Vec<f64> {
        let Rise {
            duration, delay, ..
        } = self.rise;
        match self.shape {
            Shape::Trapezoidal { ramp } => [0.0, ramp, duration - ramp, duration]
                .map(|at| delay + at)
                .to_vec(),
            Shape::Polynomial345 | Shape::Polynomial4567 | Shape::Cycloidal => {
                vec![delay, delay + duration]
            }
        }
    }

    /// The value and its first three derivatives at `x`. At an end, where a derivative may jump,
    /// those of the rest.
    pub fn eval(&self, x: f64) -> [f64; 4] {
        let Rise {
            start,
            rise,
            duration,
            delay,
        } = self.rise;
        if x <= delay {
            return [start, 0.0, 0.0, 0.0];
        }
        if x >= delay + duration {
            return [start + rise, 0.0, 0.0, 0.0];
        }
        if x.is_nan() {
            return [f64::NAN; 4];
        }
        // The second half is the reversed first half, so it is as accurate near its end as near the start.
        let passed = (x - delay) / duration;
        let [s, v, a, j] = if passed <= 0.5 {
            self.shape.first_half(passed, duration)
        } else {
            let [s, v, a, j] = self.shape.first_half(1.0 - passed, duration);
            [1.0 - s, v, -a, j]
        };
        let speed = rise / duration;
        let acceleration = speed / duration;
        let jerk = acceleration / duration;
        [start + rise * s, speed * v, acceleration * a, jerk * j]
    }
}

impl Shape {
    /// The unit motion and its derivatives at 0 ≤ u ≤ ½.
    fn first_half(self, u: f64, duration: f64) -> [f64; 4] {
        let w = u * (1.0 - u);
        let w_prime = 1.0 - 2.0 * u;
        match self {
            Self::Polynomial345 => [
                u * u * u * (10.0 + u * (-15.0 + u * 6.0)),
                30.0 * w * w,
                60.0 * w * w_prime,
                60.0 * (1.0 - 6.0 * w),
            ],
            Self::Polynomial4567 => [
                u * u * u * u * (35.0 + u * (-84.0 + u * (70.0 - u * 20.0))),
                140.0 * w * w * w,
                420.0 * w * w * w_prime,
                840.0 * w * (1.0 - 5.0 * w),
            ],
            Self::Cycloidal => {
                let (sin, cos) = (TAU * u).sin_cos();
                let half = (PI * u).sin();
                [
                    u - sin / TAU,
                    // 1 − cos(2πu), without the cancellation.
                    2.0 * half * half,
                    TAU * sin,
                    TAU * TAU * cos,
                ]
            }
            Self::Trapezoidal { ramp } => {
                let ramp = ramp / duration;
                let peak = 1.0 / (1.0 - ramp);
                if u < ramp {
                    let a = peak / ramp;
                    [0.5 * a * u * u, a * u, a, 0.0]
                } else {
                    [peak * (u - 0.5 * ramp), peak, 0.0, 0.0]
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [Shape; 4] = [
        Shape::Polynomial345,
        Shape::Polynomial4567,
        Shape::Cycloidal,
        Shape::Trapezoidal { ramp: 0.1 },
    ];
    const RISE: Rise = Rise {
        start: -0.3,
        rise: 1.7,
        duration: 0.5,
        delay: 0.25,
    };

    fn profile(shape: Shape) -> Profile {
        Profile::new(shape, RISE).expect("a profile")
    }

    #[test]
    fn at_rest_outside_exactly() {
        for shape in SHAPES {
            let law = profile(shape);
            for x in [f64::NEG_INFINITY, -1.0, 0.25] {
                assert_eq!(law.eval(x), [-0.3, 0.0, 0.0, 0.0]);
            }
            for x in [0.75, 0.8, f64::INFINITY] {
                assert_eq!(law.eval(x), [-0.3 + 1.7, 0.0, 0.0, 0.0]);
            }
        }
    }

    /// How many derivatives vanish at the ends, from inside: beside the end, at 1e-9 of the
    /// duration, those are of the order 1e-9 times the next (at most 52.5 × 16 × 1.7 × 1e-9), the
    /// next itself is far from zero.
    #[test]
    fn derivatives_at_the_ends() {
        for (shape, smooth) in SHAPES.into_iter().zip([2, 3, 2, 1]) {
            let law = profile(shape);
            for x in [0.25 + 0.5e-9, 0.75 - 0.5e-9] {
                let derivatives = law.eval(x);
                assert!(
                    derivatives[1..=smooth].iter().all(|d| d.abs() < 2e-5),
                    "{derivatives:?}"
                );
                if smooth < 3 {
                    assert!(derivatives[smooth + 1].abs() > 1.0, "{derivatives:?}");
                }
            }
        }
    }

    /// Peaks after Norton, in closed form: 15/8 and 10/√3; 35/16 and 84/√125; 2 and 2π; and the
    /// trapezium's. Two grids of 1000 and 1001 points hold the place of every peak to 5e-4 of the
    /// duration, so below it by no more than 1e-5 of its height.
    #[test]
    fn peaks() {
        let r = 0.2;
        let peaks = [
            [1.875, 10.0 / 3_f64.sqrt()],
            [2.1875, 84.0 / 125_f64.sqrt()],
            [2.0, TAU],
            [1.0 / (1.0 - r), 1.0 / (r * (1.0 - r))],
        ];
        for (shape, [speed, acceleration]) in SHAPES.into_iter().zip(peaks) {
            let law = profile(shape);
            let mut found = [0.0_f64; 2];
            for i in 0..=1000 {
                for n in [1000.0, 1001.0] {
                    let derivatives = law.eval(0.25 + 0.5 * f64::from(i) / n);
                    found = [
                        found[0].max(derivatives[1].abs()),
                        found[1].max(derivatives[2].abs()),
                    ];
                }
            }
            for (found, peak) in [
                (found[0], speed * 1.7 / 0.5),
                (found[1], acceleration * 1.7 / 0.25),
            ] {
                assert!(
                    found <= peak * (1.0 + 1e-15) && found > peak * (1.0 - 1e-5),
                    "{shape:?}: {found} {peak}"
                );
            }
        }
        // As the books print them.
        assert!((10.0 / 3_f64.sqrt() - 5.7735_f64).abs() < 5e-5);
        assert!((84.0 / 125_f64.sqrt() - 7.5132_f64).abs() < 5e-5);
    }

    /// Half the rise at half the time, and symmetry about it. Values are below 2.
    #[test]
    fn both_halves_are_alike() {
        for shape in SHAPES {
            let law = profile(shape);
            assert!((law.eval(0.5)[0] - (-0.3 + 0.85)).abs() < 4e-16);
            for d in [0.01, 0.1, 0.2] {
                let [a, b] = [law.eval(0.5 - d), law.eval(0.5 + d)];
                assert!((a[0] + b[0] - 2.0 * -0.3 - 1.7).abs() < 2e-15);
                // The next derivative, up to 1e2 and 1e3, times a few roundings of the time.
                assert!((a[1] - b[1]).abs() < 1e-13 && (a[2] + b[2]).abs() < 1e-12);
            }
        }
    }

    /// The limit is a triangular velocity: its maximum is twice the mean.
    #[test]
    fn ramps_may_fill_the_duration() {
        let law = profile(Shape::Trapezoidal { ramp: 0.25 });
        assert_eq!(law.eval(0.5)[1], 2.0 * 1.7 / 0.5);
    }

    #[test]
    fn errors_say_which_number() {
        let new = |shape, change: fn(&mut Rise)| {
            let mut rise = RISE;
            change(&mut rise);
            Profile::new(shape, rise).map_err(|error| error.to_string())
        };
        let plain = Shape::Cycloidal;
        for (result, message) in [
            (
                new(plain, |t| t.duration = -1.0),
                "`duration` is -1, and must be greater than 0",
            ),
            (
                new(plain, |t| t.rise = f64::NAN),
                "`rise` is NaN, and must be a finite number",
            ),
            (
                new(Shape::Trapezoidal { ramp: 0.0 }, |_| {}),
                "`ramp` is 0, and must be greater than 0",
            ),
            (
                new(Shape::Trapezoidal { ramp: 0.3 }, |_| {}),
                "two ramps of 0.3 s are longer than the duration of 0.5 s",
            ),
        ] {
            assert_eq!(result, Err(message.to_owned()));
        }
    }
}
