//! The free motion of a mechanism that turns fully, by quadrature: no integrator.
//!
//! The kinetic energy E = ½ m q̇² stays, so
//!
//! ```text
//! dt/dq = √(m(q) / 2E) = Σ c_k cos kq + s_k sin kq               (1)
//! T = ∮ dt/dq dq = 2π c_0                                       (2)
//! t(q) = c_0 q + Σ (c_k sin kq + s_k (1 − cos kq)) / k            (3)
//! ```
//!
//! with q measured from the start. The trapezoid rule on a smooth periodic integrand gains digits
//! as fast as its Fourier coefficients fall, so it is doubled until they have fallen to rounding.

use crate::equation::positive;
use crate::error::DynamicsError;
use crate::free::State;
use dwell_kinetostatics::Reduced;
use std::f64::consts::TAU;

/// Points of the first rule, and of the last that is tried.
const FEWEST: usize = 32;
const MOST: usize = 8192;
/// Coefficients below this part of the mean are rounding.
const NEGLIGIBLE: f64 = 1e-16;

/// A free turning motion, known at every time.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeTurn {
    start: State,
    /// Time of one turn, s.
    pub period: f64,
    /// Kinetic energy, J.
    pub energy: f64,
    /// Points of the rule that resolved it.
    pub points: usize,
    /// (c_k, s_k) for k = 1, 2, …, s/rad.
    harmonics: Vec<[f64; 2]>,
}

impl FreeTurn {
    /// The free motion of a model from a start.
    ///
    /// # Errors
    /// [`DynamicsError::NoFullTurn`], [`DynamicsError::AtRest`], [`DynamicsError::BadEnergy`],
    /// [`DynamicsError::NoInertia`], or [`DynamicsError::NotResolved`] when the inertia varies too
    /// sharply.
    pub fn new<R: Reduced>(model: &R, start: State) -> Result<Self, DynamicsError> {
        if let Some((from, to)) = model.range().limits() {
            return Err(DynamicsError::NoFullTurn { from, to });
        }
        if start.q_dot == 0.0 {
            return Err(DynamicsError::AtRest);
        }
        let mut work = model.work();
        let mut inertia =
            |q: f64| -> Result<f64, DynamicsError> { positive(model.inertia(q, &mut work)?.0, q) };
        let energy = 0.5 * inertia(start.q)? * start.q_dot * start.q_dot;
        if !energy.is_normal() {
            let q_dot = start.q_dot;
            return Err(DynamicsError::BadEnergy { q_dot, energy });
        }
        // The same position without its whole turns, which would cost it digits.
        let first = start.q % TAU;
        // Backwards, q falls: the rule runs over the way that is left behind either way.
        let forward = start.q_dot.signum();
        let mut slowness = |part: f64| -> Result<f64, DynamicsError> {
            Ok((inertia(first + forward * TAU * part)? / (2.0 * energy)).sqrt())
        };
        let mut values = Vec::new();
        for k in 0..FEWEST {
            values.push(slowness(k as f64 / FEWEST as f64)?);
        }
        loop {
            let points = values.len();
            let harmonics = harmonics(&values);
            let mean = values.iter().sum::<f64>() / points as f64;
            let tail = &harmonics[harmonics.len() - 4..];
            let left = tail.iter().flatten().fold(0.0, |m: f64, c| m.max(c.abs())) / mean;
            // Sixteen roundings of a point remain in a coefficient.
            if left < 16.0 * NEGLIGIBLE {
                let last = harmonics
                    .iter()
                    .rposition(|[c, s]| c.abs().max(s.abs()) > NEGLIGIBLE * mean);
                return Ok(Self {
                    start,
                    period: TAU * mean,
                    energy,
                    points,
                    harmonics: harmonics[..last.map_or(0, |l| l + 1)].to_vec(),
                });
            }
            if points >= MOST {
                return Err(DynamicsError::NotResolved { points, left });
            }
            let mut finer = Vec::with_capacity(2 * points);
            for (k, value) in values.into_iter().enumerate() {
                finer.push(value);
                finer.push(slowness((k as f64 + 0.5) / points as f64)?);
            }
            values = finer;
        }
    }

    /// The time (s) at which the coordinate is `q` (rad), by (3).
    pub fn time_at(&self, q: f64) -> f64 {
        let way = (q - self.start.q) * self.start.q_dot.signum();
        let turns = (way / TAU).floor();
        let within = way - turns * TAU;
        let mut sum = self.period * (within / TAU + turns);
        let (sin, cos) = within.sin_cos();
        let (mut c, mut s) = (1.0, 0.0);
        for (k, [ck, sk]) in self.harmonics.iter().enumerate() {
            (c, s) = (c * cos - s * sin, s * cos + c * sin);
            sum += (ck * s + sk * (1.0 - c)) / (k + 1) as f64;
        }
        self.start.t + sum
    }

    /// The state at time `t` (s), by Newton's method on (3).
    ///
    /// # Errors
    /// As [`FreeTurn::new`].
    pub fn at<R: Reduced>(
        &self,
        t: f64,
        model: &R,
        work: &mut R::Work,
    ) -> Result<State, DynamicsError> {
        let forward = self.start.q_dot.signum();
        let mut q = self.start.q + forward * TAU * (t - self.start.t) / self.period;
        let mut q_dot = self.start.q_dot;
        for _ in 0..50 {
            let (m, _) = model.inertia(q, work)?;
            q_dot = forward * (2.0 * self.energy / positive(m, q)?).sqrt();
            let step = (t - self.time_at(q)) * q_dot;
            q += step;
            if step.abs() <= 4.0 * f64::EPSILON * (1.0 + q.abs()) {
                break;
            }
        }
        Ok(State { t, q, q_dot })
    }
}

/// Fourier coefficients (c_k, s_k), k = 1 … below half the number of points.
fn harmonics(values: &[f64]) -> Vec<[f64; 2]> {
    let n = values.len();
    let table: Vec<(f64, f64)> = (0..n)
        .map(|i| (TAU * i as f64 / n as f64).sin_cos())
        .collect();
    (1..n / 2)
        .map(|k| {
            let mut sum = [0.0; 2];
            for (i, value) in values.iter().enumerate() {
                let (sin, cos) = table[i * k % n];
                sum[0] += value * cos;
                sum[1] += value * sin;
            }
            sum.map(|s| 2.0 * s / n as f64)
        })
        .collect()
}
