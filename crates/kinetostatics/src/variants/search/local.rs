//! One peak of a curve: its place by interpolation, then by three values about it.

use std::f64::consts::TAU;

/// Distance of the positions about a peak, in steps of the rule: their differences err by its square, and by rounding
/// over it.
const SPACING: f64 = 2e-3;
/// A peak is found where its place differs from the middle of its three positions by less than this part of their
/// distance: what they say of its value then errs by less than rounding.
const CENTERED: f64 = 0.1;
/// Longest step towards a peak, in distances of its positions.
const MAX_STEP: f64 = 16.0;
/// Peaks that the interpolation puts below the highest by more than this part of the curve's size are left out.
const CANDIDATE: f64 = 1e-3;
/// Three values that differ by less than this part of the curve's size are one.
const FLAT: f64 = 1e-13;
/// How many times a peak is looked for anew.
const MAX_ROUNDS: usize = 8;
/// Newton's steps on the interpolant.
const INTERPOLANT_STEPS: usize = 4;
/// Positions on each side of the polynomial's middle one.
const REACH: usize = 3;

/// A curve by values at equally spaced positions of a turn; between them by the polynomial through seven of them.
#[derive(Debug, Clone, Default)]
pub(super) struct Interpolant {
    /// The values, with those of the next turn and of the one before at the ends.
    values: Vec<f64>,
    pub(super) size: f64,
}

impl Interpolant {
    /// Takes the values of a turn.
    pub(super) fn set(&mut self, values: &[f64]) {
        self.values.clear();
        self.values
            .extend_from_slice(&values[values.len() - REACH..]);
        self.values.extend_from_slice(values);
        self.values.extend_from_slice(&values[..REACH]);
        self.size = values.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
    }

    /// The coefficients of the polynomial about a position, by powers of the step: of Stirling's formula.
    fn coefficients(&self, i: usize) -> [f64; 7] {
        let v: [f64; 7] = std::array::from_fn(|k| self.values[i + k]);
        let even = |k: usize| v[3 + k] + v[3 - k];
        let odd = |k: usize| v[3 + k] - v[3 - k];
        let second = even(1) - 2.0 * v[3];
        let fourth = even(2) - 4.0 * even(1) + 6.0 * v[3];
        let sixth = even(3) - 6.0 * even(2) + 15.0 * even(1) - 20.0 * v[3];
        let first = 0.5 * odd(1);
        let third = 0.5 * (odd(2) - 2.0 * odd(1));
        let fifth = 0.5 * (odd(3) - 4.0 * odd(2) + 5.0 * odd(1));
        [
            v[3],
            first - third / 6.0 + fifth / 30.0,
            second / 2.0 - fourth / 24.0 + sixth / 180.0,
            third / 6.0 - fifth / 24.0,
            fourth / 24.0 - sixth / 144.0,
            fifth / 120.0,
            sixth / 720.0,
        ]
    }
}

fn polynomial(c: [f64; 7], x: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

fn derivative(c: [f64; 7]) -> [f64; 7] {
    std::array::from_fn(|k| c.get(k + 1).map_or(0.0, |c| (k + 1) as f64 * c))
}

/// The zero of a polynomial near zero, by Newton's method, between −1 and 1.
fn zero_near(c: [f64; 7]) -> f64 {
    let slope = derivative(c);
    let mut x = 0.0_f64;
    for _ in 0..INTERPOLANT_STEPS {
        let step = polynomial(c, x) / polynomial(slope, x);
        x = if step.is_finite() { x - step } else { x };
        x = x.clamp(-1.0, 1.0);
    }
    x
}

/// A peak, or with the sign −1 a trough.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peak {
    pub(super) curve: usize,
    pub(super) sign: f64,
    pub(super) q: f64,
    pub(super) value: f64,
    pub(super) is_found: bool,
    /// Whether it could not be found.
    pub(super) has_failed: bool,
    size: f64,
    /// Distance of its three positions, rad.
    spacing: f64,
    /// Third derivative of the curve, by interpolation.
    third: f64,
    rounds: usize,
}

impl Peak {
    /// The highest and the lowest peaks of a curve, which are appended to `peaks`.
    pub(super) fn find(curve: usize, of: &Interpolant, peaks: &mut Vec<Self>) {
        for sign in [-1.0, 1.0] {
            let mut highest = f64::NEG_INFINITY;
            let first = peaks.len();
            for (i, about) in of.values[REACH - 1..].windows(3).enumerate() {
                let [before, here, after] = [about[0], about[1], about[2]].map(|v| sign * v);
                let is_peak = here >= before && here > after;
                // Half a step from a peak a parabola has lost a quarter of the step before.
                if !is_peak
                    || i + 2 * REACH >= of.values.len()
                    || 2.0 * here - before.min(after) < highest
                {
                    continue;
                }
                let peak = Self::about(curve, sign, i, of);
                highest = highest.max(sign * peak.value);
                peaks.push(peak);
            }
            let mut at = first;
            while at < peaks.len() {
                if sign * peaks[at].value < highest - CANDIDATE * of.size {
                    peaks.swap_remove(at);
                } else {
                    at += 1;
                }
            }
        }
    }

    /// The peak next to a position, by interpolation.
    fn about(curve: usize, sign: f64, i: usize, of: &Interpolant) -> Self {
        let step = TAU / (of.values.len() - 2 * REACH) as f64;
        let about = of.coefficients(i);
        let slopes = derivative(about);
        let x = zero_near(slopes);
        let third = polynomial(derivative(derivative(slopes)), x);
        Self {
            curve,
            sign,
            q: step * (i as f64 + x),
            value: polynomial(about, x),
            is_found: false,
            has_failed: false,
            size: of.size,
            spacing: SPACING * step,
            third: third / (step * step * step),
            rounds: 0,
        }
    }

    /// Where its three values are wanted.
    pub(super) fn triple(&self) -> [f64; 3] {
        [-1.0, 0.0, 1.0].map(|side| self.q + side * self.spacing)
    }

    /// Moves it by its three values, or where they are known by their derivatives; whether three are wanted anew.
    pub(super) fn take_triple(&mut self, values: [f64; 3], slopes: Option<[f64; 3]>) -> bool {
        let [low, middle, high] = values;
        let h = self.spacing;
        if (high - middle).abs().max((low - middle).abs()) <= FLAT * self.size {
            (self.value, self.is_found) = (middle, true);
            return false;
        }
        let [slope, rate, third] = match slopes {
            Some([left, slope, right]) => [
                slope,
                (right - left) / (2.0 * h),
                (right - 2.0 * slope + left) / (h * h),
            ],
            None => [
                // The difference of the outer values errs by the third derivative.
                (high - low) / (2.0 * h) - self.third * h * h / 6.0,
                (high - 2.0 * middle + low) / (h * h),
                self.third,
            ],
        };
        // The zero of slope + rate x + ½ third x², from that of its first two terms.
        let start = -slope / rate;
        let curved = slope + start * (rate + 0.5 * third * start);
        let refined = start - curved / (rate + third * start);
        let is_vertex = self.sign * rate < 0.0 && refined.is_finite();
        let limit = MAX_STEP * h;
        // Uphill where the parabola has no vertex.
        let step = if is_vertex {
            refined.clamp(-limit, limit)
        } else {
            limit.copysign(self.sign * slope)
        };
        self.q += step;
        self.value = middle + step * (slope + step * (0.5 * rate + step * third / 6.0));
        self.is_found = is_vertex && step.abs() <= CENTERED * h;
        self.rounds += 1;
        self.has_failed = !self.is_found && self.rounds > MAX_ROUNDS;
        !self.is_found && !self.has_failed
    }
}
