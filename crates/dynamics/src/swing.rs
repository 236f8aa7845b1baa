//! A swing between two turning points a and b: dt/ds = √(m / 2g) with g = E_c / ((q − a)(b − q)).
//!
//! Near a turning point E_c is the difference of two large energies. It is therefore taken from the force
//! Q = −V′, a series in cos ks of the phase (q = (a + b)/2 − h cos s):
//!
//! ```text
//! Q(s) = Σ c_k cos ks
//! E_c = ∫ Q dq = h (1 − cos s) G(s),    G = ½ Σ c_k (F_{k+1}/(k+1) − F_{k−1}/(k−1))      (1)
//! F_m(s) = (1 − cos ms)/(1 − cos s) = (sin(ms/2) / sin(s/2))²                            (2)
//! g = G / (h (1 + cos s))                                                                (3)
//! ```
//!
//! F_{k−1}/(k−1) is −F₁ for k = 0 and zero for k = 1. The half towards b is the mirror image. The same
//! integral places the turning points: to the rounding of Q, not of V.

use crate::conservative::{Conservative, Held};
use crate::error::DynamicsError;
use crate::fourier::{MANY, MOST, Series, refine};
use crate::orbit::phase_of;
use crate::panels::{Panels, Slowness};
use std::f64::consts::{PI, TAU};

/// Times that the turning points are improved.
const MOST_ROUNDS: usize = 60;

/// A resolved swing.
pub(crate) struct Swing {
    pub(crate) ends: [f64; 2],
    pub(crate) slowness: Slowness,
    /// The largest kinetic energy at a point, J.
    pub(crate) most: f64,
    pub(crate) points: usize,
}

impl Swing {
    /// The swing that passes `q` with a kinetic energy (J), from turning points that are nearly right.
    pub(crate) fn new(
        field: &mut dyn Conservative,
        q: f64,
        kinetic: f64,
        mut ends: [f64; 2],
    ) -> Result<Self, DynamicsError> {
        for _ in 0..MOST_ROUNDS {
            let sampled = Sampled::new(field, ends, |_| true)?;
            let moved = sampled.better(q, kinetic);
            let size = ends[0].abs().max(ends[1].abs());
            let near = |a: f64, b: f64| (a - b).abs() <= 2.0 * f64::EPSILON * size;
            let settled = near(moved[0], ends[0]) && near(moved[1], ends[1]);
            ends = moved;
            if settled {
                break;
            }
        }
        let resolved = |s: &Sampled| s.known.len() >= MANY || s.slowness().resolved;
        let sampled = Sampled::new(field, ends, resolved)?;
        let (most, points, series) = (sampled.most(), sampled.known.len(), sampled.slowness());
        let (slowness, points) = if series.resolved {
            (Slowness::Even(series), points)
        } else {
            let panels = sampled.panels(field)?;
            let taken = points + panels.points;
            (Slowness::Sharp(panels), taken)
        };
        Ok(Self {
            ends,
            most,
            points,
            slowness,
        })
    }

    /// The phase on the way up.
    pub(crate) fn phase(&self, q: f64) -> f64 {
        let middle = if q < 0.5 * (self.ends[0] + self.ends[1]) {
            0.0
        } else {
            PI
        };
        phase_of(q, self.ends).unwrap_or(middle)
    }
}

/// A swing by what it has at equally spaced phases of the way up and down.
struct Sampled {
    ends: [f64; 2],
    known: Vec<Held>,
    force: Series,
}

impl Sampled {
    fn new(
        field: &mut dyn Conservative,
        ends: [f64; 2],
        resolved: impl Fn(&Self) -> bool,
    ) -> Result<Self, DynamicsError> {
        let [a, b] = ends;
        let half = 0.5 * (b - a);
        let mut sampled = Self {
            ends,
            known: Vec::new(),
            force: Series::default(),
        };
        loop {
            let known = std::mem::take(&mut sampled.known);
            sampled.known = refine(known, |part| {
                // 1 − cos s, and from the nearer end: the same on the way up and down.
                let sine = (PI * part).sin();
                let cosine = (PI * part).cos();
                let q = if sine.abs() < cosine.abs() {
                    a + 2.0 * half * sine * sine
                } else {
                    b - 2.0 * half * cosine * cosine
                };
                field.held(q)
            })?;
            let forces: Vec<f64> = sampled.known.iter().map(|h| h.force).collect();
            let size = forces.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
            sampled.force = Series::new(&forces, size);
            if sampled.force.resolved && resolved(&sampled) {
                return Ok(sampled);
            }
            let points = sampled.known.len();
            if points >= MOST {
                let left = sampled.force.left.max(sampled.slowness().left);
                return Err(DynamicsError::NotResolved { points, left });
            }
        }
    }

    /// h (1 − cos s) G: the kinetic energy gained from the lower end to a phase.
    fn gained(&self, phase: f64) -> f64 {
        let one = |m: f64| {
            let sine = (0.5 * m * phase).sin();
            2.0 * sine * sine
        };
        let mut sum = self.force.mean * one(1.0);
        for (k, [c, _]) in self.force.harmonics.iter().enumerate() {
            let k = (k + 1) as f64;
            let below = if k > 1.0 {
                one(k - 1.0) / (k - 1.0)
            } else {
                0.0
            };
            sum += 0.5 * c * (one(k + 1.0) / (k + 1.0) - below);
        }
        0.5 * (self.ends[1] - self.ends[0]) * sum
    }

    /// The turning points by a step of Newton's method on the kinetic energy there.
    fn better(&self, q: f64, kinetic: f64) -> [f64; 2] {
        let [a, b] = self.ends;
        let width = b - a;
        let phase = phase_of(q, self.ends).unwrap_or(if q < a { 0.0 } else { PI });
        let from_a = self.gained(phase);
        let left = [kinetic - from_a, kinetic - from_a + self.gained(PI)];
        let at = [self.known[0].force, self.known[self.known.len() / 2].force];
        // At the lower end the force must point up, at the upper one down; else the end is too near.
        let mut moved = [a - width, b + width];
        if at[0] > 0.0 {
            moved[0] = a - (left[0] / at[0]).clamp(-width, width);
        }
        if at[1] < 0.0 {
            moved[1] = b - (left[1] / at[1]).clamp(-width, width);
        }
        if kinetic == 0.0 {
            // It started at rest, from one of them.
            let end = usize::from((q - a).abs() > (b - q).abs());
            moved[end] = q;
        }
        [moved[0].min(q), moved[1].max(q)]
    }

    /// G towards an end: `phase` counted from it, `mirrored` for the upper one. `table` holds the sines
    /// of multiples of π over the number of points.
    fn quotient(&self, phase: usize, mirrored: bool, table: &[f64]) -> f64 {
        self.sum(mirrored, |m: usize| {
            if phase == 0 {
                return (m * m) as f64;
            }
            let ratio = table[m * phase % table.len()] / table[phase];
            ratio * ratio
        })
    }

    /// G of (1) with F_m from `fejer`; `mirrored` from the upper end.
    fn sum(&self, mirrored: bool, fejer: impl Fn(usize) -> f64) -> f64 {
        let sign = |k: usize| if mirrored && k % 2 == 1 { -1.0 } else { 1.0 };
        let mut sum = self.force.mean;
        for (k, [c, _]) in self.force.harmonics.iter().enumerate() {
            let k = k + 1;
            let below = if k > 1 {
                fejer(k - 1) / (k - 1) as f64
            } else {
                0.0
            };
            sum += 0.5 * sign(k) * c * (fejer(k + 1) / (k + 1) as f64 - below);
        }
        if mirrored { -sum } else { sum }
    }

    /// By point of the way up: g, per (3).
    fn quotients(&self) -> Vec<f64> {
        let n = self.known.len();
        let half = 0.5 * (self.ends[1] - self.ends[0]);
        let table: Vec<f64> = (0..2 * n)
            .map(|i| (PI * i as f64 / n as f64).sin())
            .collect();
        let one = |j: usize| {
            let mirrored = j > n / 4;
            let phase = if mirrored { n / 2 - j } else { j };
            let cosine = (TAU * phase as f64 / n as f64).cos();
            self.quotient(phase, mirrored, &table) / (half * (1.0 + cosine))
        };
        (0..=n / 2).map(one).collect()
    }

    /// dt/ds.
    fn slowness(&self) -> Series {
        let n = self.known.len();
        let quotients = self.quotients();
        let values: Vec<f64> = (0..n)
            .map(|j| {
                let j = j.min(n - j);
                (self.known[j].m / (2.0 * quotients[j])).sqrt()
            })
            .collect();
        let size = values.iter().sum::<f64>() / n as f64;
        Series::new(&values, size)
    }

    /// dt/ds where equal steps do not resolve it.
    fn panels(&self, field: &mut dyn Conservative) -> Result<Panels, DynamicsError> {
        let [a, b] = self.ends;
        let half = 0.5 * (b - a);
        Panels::new(|phase| {
            // The way down is the way up.
            let phase = if phase > PI { TAU - phase } else { phase };
            let mirrored = phase > 0.5 * PI;
            let from_end = if mirrored { PI - phase } else { phase };
            let (sin, cos) = (0.5 * from_end).sin_cos();
            let way = 2.0 * half * sin * sin;
            let m = field.held(if mirrored { b - way } else { a + way })?.m;
            let quotient = self.sum(mirrored, |k| {
                if sin == 0.0 {
                    return (k * k) as f64;
                }
                let ratio = (0.5 * k as f64 * from_end).sin() / sin;
                ratio * ratio
            });
            Ok((m * half * cos * cos / quotient).sqrt())
        })
    }

    /// The largest kinetic energy, J.
    fn most(&self) -> f64 {
        let n = self.known.len();
        let half = 0.5 * (self.ends[1] - self.ends[0]);
        let energy = |(j, g): (usize, f64)| {
            let sine = half * (TAU * j as f64 / n as f64).sin();
            g * sine * sine
        };
        let all = self.quotients().into_iter().enumerate().map(energy);
        all.fold(0.0, f64::max)
    }
}
