//! One peak of a curve: its place by interpolation, then by its slope there.

use crate::reduced::{LaneScalar, MAX_LANES};
use std::f64::consts::TAU;

/// Positions on each side of the middle one of the interpolating polynomial.
pub(super) const REACH: usize = 5;
/// By power x² to x¹⁰ and by distance of the positions, the weights of the polynomial through eleven equally spaced values:
/// of their second differences for this power, of their central ones times the distance for the power before.
const WEIGHTS: [[f64; REACH]; REACH] = [
    [
        5.0 / 6.0,
        -5.0 / 42.0,
        5.0 / 252.0,
        -5.0 / 2016.0,
        1.0 / 6300.0,
    ],
    [
        -1669.0 / 4320.0,
        4369.0 / 30240.0,
        -541.0 / 20160.0,
        1261.0 / 362_880.0,
        -41.0 / 181_440.0,
    ],
    [
        323.0 / 5760.0,
        -13.0 / 480.0,
        29.0 / 3840.0,
        -19.0 / 17280.0,
        13.0 / 172_800.0,
    ],
    [
        -1.0 / 320.0,
        17.0 / 10080.0,
        -23.0 / 40320.0,
        13.0 / 120_960.0,
        -1.0 / 120_960.0,
    ],
    [
        1.0 / 17280.0,
        -1.0 / 30240.0,
        1.0 / 80640.0,
        -1.0 / 362_880.0,
        1.0 / 3_628_800.0,
    ],
];
/// Truncation error of the second and third derivative of the polynomial next to the middle, as a multiple of its last even and
/// odd coefficients (one of each times x): half of the estimate from these two for the second derivative, the whole estimate
/// for the third, by which most curves are judged.
const LEFT_OUT: [[f64; 2]; 2] = [[576.0, 2460.0], [19680.0, 4920.0]];
/// Distance of the positions about a peak, in steps of the rule, and rounding error of a second derivative by their
/// differences, relative to the curve's size.
const SPACING: f64 = 1e-3;
const SECOND_ROUNDING: f64 = 1e-9;
/// A peak has converged if the error of its derivatives changes its value by less, relative to the curve's size, or if its slope
/// in a step is smaller.
const ACCURACY: f64 = 2e-14;
const FLAT: f64 = 1e-12;
/// Longest step towards a peak, in steps of the rule.
const MAX_STEP: f64 = 0.03;
/// Peaks that the interpolation puts below the highest by more than this part of the curve's size are left out.
const CANDIDATE: f64 = 1e-3;
/// Largest number of rounds of the search for a peak.
const MAX_ROUNDS: usize = 8;
/// Newton's steps on the interpolant: the error of the last one is squared twice.
const INTERPOLANT_STEPS: usize = 3;

/// A curve by values at equally spaced positions of a turn.
#[derive(Debug, Clone, Default)]
pub(super) struct Interpolant {
    /// The values, with those of the next turn and of the one before at the ends.
    padded: Vec<f64>,
    /// Largest magnitude.
    pub(super) size: f64,
}

impl Interpolant {
    /// Number of positions.
    pub(super) fn count(&self) -> usize {
        self.padded.len().saturating_sub(2 * REACH)
    }

    pub(super) fn clear(&mut self) {
        self.padded.clear();
    }

    /// The values from the first position on, and a few of the next turn.
    #[inline(always)]
    pub(super) fn values(&self) -> &[f64] {
        &self.padded[REACH..]
    }

    /// The mean over the turn, and the mean of the square.
    pub(super) fn means(&self) -> [f64; 2] {
        let values = &self.values()[..self.count()];
        let mean_of =
            |of: fn(f64) -> f64| values.iter().map(|v| of(*v)).sum::<f64>() / values.len() as f64;
        [mean_of(|v| v), mean_of(|v| v * v)]
    }

    /// Takes the values of the first rule, or those between the positions of the rule before.
    pub(super) fn add(&mut self, values: &[f64]) {
        let count = self.count();
        if count == 0 {
            self.padded.resize(values.len() + 2 * REACH, 0.0);
            self.padded[REACH..REACH + values.len()].copy_from_slice(values);
        } else {
            let mut both = vec![0.0; 2 * count + 2 * REACH];
            let pairs = both[REACH..].chunks_exact_mut(2);
            for ((pair, &old), &new) in pairs.zip(&self.padded[REACH..]).zip(values) {
                (pair[0], pair[1]) = (old, new);
            }
            self.padded = both;
        }
        let count = self.count();
        self.padded.copy_within(count..count + REACH, 0);
        self.padded.copy_within(REACH..2 * REACH, REACH + count);
    }

    /// The values at a position and at its neighbours.
    #[inline(always)]
    fn about(&self, i: usize) -> &[f64] {
        &self.padded[i..=i + 2 * REACH]
    }
}

/// Polynomials through eleven equally spaced values, by powers of the step from the middle one.
#[inline(always)]
fn polynomial<S: LaneScalar>(about: [S; 2 * REACH + 1]) -> [S; 2 * REACH + 1] {
    let middle = about[REACH];
    let mut coefficients = [S::from_f64(0.0); 2 * REACH + 1];
    coefficients[0] = middle;
    for j in 1..=REACH {
        let (before, after) = (about[REACH - j], about[REACH + j]);
        let even = (after - middle) + (before - middle);
        let odd = (after - before) * S::from_f64(j as f64);
        for (k, weights) in WEIGHTS.iter().enumerate() {
            let weight = S::from_f64(weights[j - 1]);
            coefficients[2 * k + 1] += weight * odd;
            coefficients[2 * k + 2] += weight * even;
        }
    }
    coefficients
}

/// Value, first, second and third derivative of polynomials.
#[inline(always)]
fn derivatives<S: LaneScalar>(of: &[S; 2 * REACH + 1], x: S) -> [S; 4] {
    let zero = S::from_f64(0.0);
    let [mut value, mut first, mut half_second, mut sixth_third] = [zero; 4];
    for &c in of.iter().rev() {
        sixth_third = sixth_third * x + half_second;
        half_second = half_second * x + first;
        first = first * x + value;
        value = value * x + c;
    }
    let [two, six] = [S::from_f64(2.0), S::from_f64(6.0)];
    [value, first, two * half_second, six * sixth_third]
}

/// By lane: the place of a peak next to the middle of eleven values, the value there, the second and third derivative, and their
/// truncation errors.
#[inline(always)]
fn derivatives_at_peak<S: LaneScalar>(about: [S; 2 * REACH + 1]) -> [S; 6] {
    let (zero, one) = (S::from_f64(0.0), S::from_f64(1.0));
    let of = polynomial(about);
    let mut x = zero;
    let [mut value, mut first, mut second, mut third] = derivatives(&of, x);
    for _ in 0..INTERPOLANT_STEPS {
        // Between −1 and 1.
        x = -(-(x - first / second).maximum(-one)).maximum(-one);
        [value, first, second, third] = derivatives(&of, x);
    }
    let (odd, even) = (of[2 * REACH - 1], of[2 * REACH]);
    let (odd, even, distance) = (odd.maximum(-odd), even.maximum(-even), x.maximum(-x));
    let [of_second, of_third] = LEFT_OUT;
    let second_error =
        S::from_f64(of_second[0]) * even + S::from_f64(of_second[1]) * odd * distance;
    let third_error = S::from_f64(of_third[0]) * even * distance + S::from_f64(of_third[1]) * odd;
    [x, value, second, second_error, third, third_error]
}

/// A position that is higher than its neighbours, or, with the sign −1, lower.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) curve: usize,
    pub(super) sign: f64,
    position: usize,
    /// An upper bound of the extreme near it, times the sign.
    bound: f64,
}

impl Candidate {
    /// Appends the positions of a curve that may be next to its highest peak (or, with the sign −1, to its lowest
    /// trough) to `candidates`. The bits of `at` mark positions that are higher than their neighbours.
    pub(super) fn find(
        curve: usize,
        sign: f64,
        of: &Interpolant,
        at: &[u64],
        candidates: &mut Vec<Self>,
    ) {
        let first = candidates.len();
        let mut highest = f64::NEG_INFINITY;
        for (word, &bits) in at.iter().enumerate() {
            let mut bits = bits;
            while bits != 0 {
                let position = 64 * word + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let about = &of.padded[position + REACH - 1..][..3];
                let [before, value, after] = [sign * about[0], sign * about[1], sign * about[2]];
                highest = highest.max(value);
                candidates.push(Self {
                    curve,
                    sign,
                    position,
                    // Half a step from a peak a parabola has lost a quarter of the step before.
                    bound: 2.0 * value - before.min(after),
                });
            }
        }
        let mut at = first;
        while at < candidates.len() {
            if candidates[at].bound < highest {
                candidates.swap_remove(at);
            } else {
                at += 1;
            }
        }
    }
}

/// A peak, or with the sign −1 a trough. Its derivatives are by the step of the rule.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peak {
    pub(super) curve: usize,
    pub(super) sign: f64,
    pub(super) q: f64,
    pub(super) value: f64,
    pub(super) is_found: bool,
    /// Whether it could not be found.
    pub(super) has_failed: bool,
    /// Largest magnitude of the curve.
    size: f64,
    /// The step of the rule, rad.
    pub(super) step: f64,
    /// Second and third derivative, and their error bounds.
    second: f64,
    second_error: f64,
    third: f64,
    third_error: f64,
    /// The slope at the place before, and how far that is.
    before: Option<(f64, f64)>,
    rounds: usize,
}

impl Peak {
    /// The peaks next to candidates, by interpolation, are appended to `peaks`: as many of them at a time as there are lanes.
    #[inline(always)]
    pub(super) fn interpolate<S: LaneScalar>(
        candidates: &[Candidate],
        curves: &[Interpolant],
        peaks: &mut Vec<Self>,
    ) {
        for candidates in candidates.chunks(S::LANES) {
            let mut about = [[0.0; MAX_LANES]; 2 * REACH + 1];
            for (lane, of) in candidates.iter().enumerate() {
                for (about, &value) in about.iter_mut().zip(curves[of.curve].about(of.position)) {
                    about[lane] = value;
                }
            }
            let mut in_lanes = [S::from_f64(0.0); 2 * REACH + 1];
            for (in_lanes, about) in in_lanes.iter_mut().zip(&about) {
                *in_lanes = S::load(about);
            }
            let mut found = [[0.0; MAX_LANES]; 6];
            for (lanes, of_all) in found.iter_mut().zip(derivatives_at_peak(in_lanes)) {
                of_all.store(lanes);
            }
            for (lane, of) in candidates.iter().enumerate() {
                peaks.push(Self::new(of, &curves[of.curve], &found, lane));
            }
        }
    }

    fn new(
        of: &Candidate,
        curve: &Interpolant,
        found: &[[f64; MAX_LANES]; 6],
        lane: usize,
    ) -> Self {
        let step = TAU / curve.count() as f64;
        let [x, value, second, second_error, third, third_error] = found;
        let x = x[lane];
        Self {
            curve: of.curve,
            sign: of.sign,
            q: step * (of.position as f64 + x),
            value: value[lane],
            is_found: false,
            has_failed: false,
            size: curve.size,
            step,
            second: second[lane],
            second_error: second_error[lane],
            third: third[lane],
            third_error: third_error[lane],
            before: None,
            rounds: 0,
        }
    }

    /// Keeps the peaks and troughs of a curve that may be the highest and the lowest; for a force, those that may have the
    /// largest magnitude.
    pub(super) fn keep_highest(curve: usize, is_force: bool, peaks: &mut Vec<Self>) {
        let height = |peak: &Self| {
            if is_force {
                peak.value.abs()
            } else {
                peak.sign * peak.value
            }
        };
        let of_kind =
            |peak: &Self, sign: f64| peak.curve == curve && (is_force || peak.sign == sign);
        for sign in [1.0, -1.0] {
            let kind = peaks.iter().filter(|peak| of_kind(peak, sign));
            let highest = kind.map(height).fold(f64::NEG_INFINITY, f64::max);
            peaks.retain(|peak| {
                !of_kind(peak, sign) || height(peak) >= highest - CANDIDATE * peak.size
            });
        }
    }

    /// Three positions about it.
    pub(super) fn triple(&self) -> [f64; 3] {
        [-1.0, 0.0, 1.0].map(|side| self.q + side * SPACING * self.step)
    }

    /// Moves it by its values at the three positions; returns whether it needs new values.
    pub(super) fn take_triple(&mut self, [low, middle, high]: [f64; 3]) -> bool {
        let h = SPACING;
        // The difference of the outer values errs by the third derivative.
        let slope = (high - low) / (2.0 * h) - self.third * h * h / 6.0;
        self.second = ((high - middle) + (low - middle)) / (h * h);
        self.second_error = SECOND_ROUNDING * self.size;
        self.take(middle, slope, self.third_error * h * h / 6.0)
    }

    /// Moves it by its value and its slope; returns whether it needs new ones.
    pub(super) fn take_slope(&mut self, value: f64, slope: f64) -> bool {
        if let Some((slope_before, moved)) = self.before {
            // The change of the slope over the last move gives the second derivative midway.
            self.second = (slope - slope_before) / moved + 0.5 * self.third * moved;
            self.second_error = self.third_error * moved.abs() + FLAT * self.size / moved.abs();
        }
        self.take(value, slope, 0.0)
    }

    fn take(&mut self, value: f64, slope: f64, slope_error: f64) -> bool {
        self.rounds += 1;
        if slope.abs() <= FLAT * self.size {
            (self.value, self.is_found) = (value, true);
            return false;
        }
        // The zero of slope + second x + ½ third x², from that of its first two terms.
        let start = -slope / self.second;
        let curved = slope + start * (self.second + 0.5 * self.third * start);
        let x = start - curved / (self.second + self.third * start);
        let is_vertex = self.sign * self.second < 0.0 && x.is_finite();
        let x = if is_vertex {
            x.clamp(-MAX_STEP, MAX_STEP)
        } else {
            // Uphill where the parabola has no vertex.
            MAX_STEP.copysign(self.sign * slope)
        };
        let of_slope = self.second_error / 2.0 + self.third_error * x.abs() / 6.0;
        let error = x.abs() * (slope_error + x.abs() * of_slope);
        self.q += x * self.step;
        self.value = value + x * (slope + x * (0.5 * self.second + x * self.third / 6.0));
        self.before = Some((slope, x));
        self.is_found = is_vertex && x.abs() < MAX_STEP && error <= ACCURACY * self.size;
        self.has_failed = !self.is_found && self.rounds > MAX_ROUNDS;
        !self.is_found && !self.has_failed
    }
}
