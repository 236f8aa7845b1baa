//! A libration between two turning points a and b: dt/ds = √(m / 2g) with g = E_c / ((q − a)(b − q)).
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

use crate::conservative::ConservativeSystem;
use crate::error::{DynamicsError, Result};
use crate::time_density::{ResolvedMotion, Sample, TimeDensity, hides_turns, watched_panels};
use dwell_numerics::fourier::{
    FourierSeries, MAX_POINTS, MIN_POINTS, SHARP_POINTS, refine_samples,
};
use dwell_numerics::panels::Panels;
use std::f64::consts::{PI, TAU};

/// Highest number of improvements of the turning points.
const MAX_REFINEMENTS: usize = 60;
/// Samples at which the work of the force is compared with the potential, and the allowed difference, relative to the largest difference of
/// potentials, or as a multiple of the last coefficients of the force.
const COMPARED_WORKS: usize = 16;
const WORK_ERROR: f64 = 1e-6;
const LEFT_OUT: f64 = 100.0;

/// The turning points of the libration that passes `q` with a kinetic energy (J), from approximate ones.
pub(crate) fn turning_points(
    system: &mut dyn ConservativeSystem,
    q: f64,
    kinetic: f64,
    mut turning_points: [f64; 2],
) -> Result<[f64; 2]> {
    for _ in 0..MAX_REFINEMENTS {
        let mut sampled = SampledLibration::new(turning_points);
        while !sampled.force_series.is_resolved {
            sampled.double_points(system, MIN_POINTS)?;
            sampled.check_points()?;
        }
        let improved = sampled.improved_turning_points(q, kinetic);
        let size = turning_points[0].abs().max(turning_points[1].abs());
        let near = |a: f64, b: f64| (a - b).abs() <= 2.0 * f64::EPSILON * size;
        let settled = (0..2).all(|end| near(improved[end], turning_points[end]));
        turning_points = improved;
        if settled {
            break;
        }
    }
    Ok(turning_points)
}

/// A libration sampled at equally spaced phases from the lower turning point up and back.
pub(crate) struct SampledLibration {
    pub(crate) turning_points: [f64; 2],
    samples: Vec<Sample>,
    force_series: FourierSeries,
}

impl SampledLibration {
    /// A libration without sample points.
    pub(crate) fn new(turning_points: [f64; 2]) -> Self {
        Self {
            turning_points,
            samples: Vec::new(),
            force_series: FourierSeries::default(),
        }
    }

    /// The libration by twice as many points as before, or by `first`. Where equal steps do not resolve it to an
    /// accuracy, a part of the mean of dt/ds, it is integrated on panels.
    pub(crate) fn next(
        &mut self,
        system: &mut dyn ConservativeSystem,
        first: usize,
        accuracy: f64,
    ) -> Result<ResolvedMotion> {
        loop {
            self.double_points(system, first)?;
            let force = &self.force_series;
            if force.is_resolved || force.tail < accuracy {
                break;
            }
            self.check_points()?;
        }
        let mut points = self.samples.len();
        let mut series = self.time_density();
        let (step, half) = (TAU / points as f64, self.half_width());
        let upwards = self.samples.iter().take(points / 2 + 1);
        let rate = |phase: f64| half * phase.sin();
        let is_hidden = hides_turns(&mut series, accuracy, upwards, step, rate);
        if let (true, Some(tail)) = (is_hidden, self.missed_work()) {
            return Err(DynamicsError::NotResolved { points, tail });
        }
        let is_resolved = self.force_series.is_resolved && series.is_resolved;
        let is_sharp = (points >= SHARP_POINTS || is_hidden) && !is_resolved;
        let time_density = if is_sharp && (series.tail >= accuracy || series.tail.is_nan()) {
            while !self.force_series.is_resolved {
                self.check_points()?;
                self.double_points(system, first)?;
            }
            let panels = self.piecewise_time_density(system)?;
            points = self.samples.len() + panels.points;
            TimeDensity::Piecewise(panels)
        } else {
            TimeDensity::Fourier(series)
        };
        Ok(ResolvedMotion {
            is_resolved: is_resolved || matches!(time_density, TimeDensity::Piecewise(_)),
            time_density,
            max_kinetic: self.max_kinetic(),
            points,
        })
    }

    /// An error where no more points are to be had.
    fn check_points(&self) -> Result<()> {
        let points = self.samples.len();
        if points >= MAX_POINTS && !self.force_series.is_resolved {
            let tail = self.force_series.tail.max(self.time_density().tail);
            return Err(DynamicsError::NotResolved { points, tail });
        }
        Ok(())
    }

    /// Samples twice as many points as before, or the `first`.
    fn double_points(&mut self, system: &mut dyn ConservativeSystem, first: usize) -> Result<()> {
        let [a, b] = self.turning_points;
        let half = 0.5 * (b - a);
        let mut terms_at = |part: f64| {
            // 1 − cos s, from the nearer end: the same upwards and downwards.
            let sine = (PI * part).sin();
            let cosine = (PI * part).cos();
            let q = if sine.abs() < cosine.abs() {
                a + 2.0 * half * sine * sine
            } else {
                b - 2.0 * half * cosine * cosine
            };
            let terms = system.energy_terms(q)?;
            Ok::<_, DynamicsError>((terms, system.turns()))
        };
        let samples = std::mem::take(&mut self.samples);
        // Downwards is as upwards: half of a period is evaluated.
        let (known, mut found) = (samples.len(), Vec::<Sample>::new());
        self.samples = refine_samples::<_, DynamicsError>(samples, first, |part| {
            let k = found.len();
            let terms = match (part <= 0.5, known) {
                (true, _) => terms_at(part)?,
                (false, 0) => found[first - k].clone(),
                (false, _) => found[known - 1 - k].clone(),
            };
            found.push(terms.clone());
            Ok(terms)
        })?;
        let forces: Vec<f64> = self.samples.iter().map(|(h, _)| h.force).collect();
        let size = forces.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        self.force_series = FourierSeries::new(&forces, size);
        let series = &mut self.force_series;
        series.check_between(size, |part| terms_at(part).map(|(terms, _)| terms.force))
    }

    /// The largest difference between the work of the series of the force and that of the potential, relative to the largest
    /// potential difference, if it exceeds the truncation error of the series. A force that acts within a small part of the phase
    /// may be at no sample, but its work shows.
    fn missed_work(&self) -> Option<f64> {
        let n = self.samples.len();
        let upwards = self.samples[..=n / 2].iter();
        let works: Vec<f64> = upwards
            .map(|(at, _)| self.samples[0].0.potential - at.potential)
            .collect();
        let size = works
            .iter()
            .fold(0.0_f64, |size, work| size.max(work.abs()));
        let compared = works
            .iter()
            .enumerate()
            .step_by((n / 2).div_ceil(COMPARED_WORKS));
        let missed = compared.fold(0.0_f64, |missed, (k, work)| {
            missed.max((work - self.kinetic_gain(TAU * k as f64 / n as f64)).abs())
        });
        let left_out = WORK_ERROR.max(LEFT_OUT * self.force_series.tail);
        (missed > left_out * size).then_some(missed / size)
    }

    /// h (1 − cos s) G: the kinetic energy gained from the lower end to a phase.
    fn kinetic_gain(&self, phase: f64) -> f64 {
        let one = |m: usize| {
            let sine = (0.5 * m as f64 * phase).sin();
            2.0 * sine * sine
        };
        self.half_width() * self.sum(false, one(1), one)
    }

    /// Half the distance of the turning points, h.
    fn half_width(&self) -> f64 {
        0.5 * (self.turning_points[1] - self.turning_points[0])
    }

    /// The turning points by a step of Newton's method on the kinetic energy there.
    fn improved_turning_points(&self, q: f64, kinetic: f64) -> [f64; 2] {
        let [a, b] = self.turning_points;
        let width = b - a;
        let phase = phase_of(q, self.turning_points).unwrap_or(if q < a { 0.0 } else { PI });
        let from_a = self.kinetic_gain(phase);
        let kinetic_left = [kinetic - from_a, kinetic - from_a + self.kinetic_gain(PI)];
        let at = [0, self.samples.len() / 2].map(|k| self.samples[k].0.force);
        // At the lower end the force must point up, at the upper one down; else the end is too near.
        let mut moved = [a - width, b + width];
        if at[0] > 0.0 {
            moved[0] = a - (kinetic_left[0] / at[0]).clamp(-width, width);
        }
        if at[1] < 0.0 {
            moved[1] = b - (kinetic_left[1] / at[1]).clamp(-width, width);
        }
        if kinetic == 0.0 {
            // It started at rest, from one of them.
            let end = usize::from((q - a).abs() > (b - q).abs());
            moved[end] = q;
        }
        [moved[0].min(q), moved[1].max(q)]
    }

    /// G of (1) with F_m from `fejer`, the `first` of which is 1 except for a common factor; `mirrored` counts from the
    /// upper end.
    fn sum(&self, mirrored: bool, first: f64, fejer: impl Fn(usize) -> f64) -> f64 {
        let sign = |k: usize| if mirrored && k % 2 == 1 { -1.0 } else { 1.0 };
        let mut sum = self.force_series.mean * first;
        for (k, [c, _]) in self.force_series.harmonics.iter().enumerate() {
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

    /// By point upwards: g, by (3).
    fn quotients(&self) -> Vec<f64> {
        let n = self.samples.len();
        let half = self.half_width();
        let sine = |i: usize| (PI * i as f64 / n as f64).sin();
        let sines: Vec<f64> = (0..2 * n).map(sine).collect();
        let one = |j: usize| {
            let mirrored = j > n / 4;
            let phase = if mirrored { n / 2 - j } else { j };
            let cosine = (TAU * phase as f64 / n as f64).cos();
            let quotient = self.sum(mirrored, 1.0, |m| {
                if phase == 0 {
                    return (m * m) as f64;
                }
                let ratio = sines[m * phase % sines.len()] / sines[phase];
                ratio * ratio
            });
            quotient / (half * (1.0 + cosine))
        };
        (0..=n / 2).map(one).collect()
    }

    /// dt/ds.
    fn time_density(&self) -> FourierSeries {
        let n = self.samples.len();
        let quotients = self.quotients();
        let mirrored = (0..n).map(|j| j.min(n - j));
        let value = |j: usize| (self.samples[j].0.m / (2.0 * quotients[j])).sqrt();
        let values: Vec<f64> = mirrored.map(value).collect();
        let size = values.iter().sum::<f64>() / n as f64;
        FourierSeries::new(&values, size)
    }

    /// dt/ds where equal steps do not resolve it.
    fn piecewise_time_density(&self, system: &mut dyn ConservativeSystem) -> Result<Panels> {
        let [a, b] = self.turning_points;
        let half = 0.5 * (b - a);
        let density = |system: &mut dyn ConservativeSystem, phase: f64| {
            // Downwards is as upwards.
            let phase = if phase > PI { TAU - phase } else { phase };
            let mirrored = phase > 0.5 * PI;
            let from_end = if mirrored { PI - phase } else { phase };
            let (sin, cos) = (0.5 * from_end).sin_cos();
            let distance = 2.0 * half * sin * sin;
            let q = if mirrored { b - distance } else { a + distance };
            let m = system.energy_terms(q)?.m;
            let quotient = self.sum(mirrored, 1.0, |k| {
                if sin == 0.0 {
                    return (k * k) as f64;
                }
                let ratio = (0.5 * k as f64 * from_end).sin() / sin;
                ratio * ratio
            });
            Ok((m * half * cos * cos / quotient).sqrt())
        };
        watched_panels(system, density, |phase| half * phase.sin())
    }

    /// The largest kinetic energy, J.
    fn max_kinetic(&self) -> f64 {
        let n = self.samples.len();
        let half = self.half_width();
        let energy = |(j, g): (usize, f64)| {
            let sine = half * (TAU * j as f64 / n as f64).sin();
            g * sine * sine
        };
        let all = self.quotients().into_iter().enumerate().map(energy);
        all.fold(0.0, f64::max)
    }
}

/// The phase at which a libration between two turning points passes `q` upwards, or the phase of the nearer turning
/// point.
pub(crate) fn nearest_phase(q: f64, turning_points: [f64; 2]) -> f64 {
    let middle = 0.5 * (turning_points[0] + turning_points[1]);
    phase_of(q, turning_points).unwrap_or(if q < middle { 0.0 } else { PI })
}

/// The phase in 0 … π at which a libration between two turning points passes `q`; none if it does not.
pub(crate) fn phase_of(q: f64, [a, b]: [f64; 2]) -> Option<f64> {
    let [from, to] = [q - a, b - q];
    (from >= 0.0 && to >= 0.0).then(|| 2.0 * from.sqrt().atan2(to.sqrt()))
}
