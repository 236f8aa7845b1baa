//! A rotation with known kinetic energy: dt/ds = (P/2π) √(m / 2E_c), q = q₀ + P s/2π.

use crate::conservative::{ConservativeSystem, EnergyTerms};
use crate::error::{DynamicsError, Result};
use crate::time_density::{ResolvedMotion, Sample, TimeDensity, hides_turns, watched_panels};
use dwell_numerics::fourier::{FourierSeries, SHARP_POINTS, refine_samples};
use std::f64::consts::TAU;

/// A rotation sampled at equally spaced phases.
pub(crate) struct SampledRotation {
    /// Its coordinate at phase zero, rad.
    first: f64,
    pub(crate) angle_per_period: f64,
    /// Kinetic and potential energy at the start, J.
    energies: [f64; 2],
    samples: Vec<Sample>,
}

impl SampledRotation {
    /// A rotation from a coordinate with its kinetic and potential energy (J), without sample points.
    pub(crate) fn new(q: f64, energies: [f64; 2], angle_per_period: f64) -> Self {
        Self {
            // The same position without its whole revolutions, which would cost digits.
            first: q % angle_per_period,
            angle_per_period,
            energies,
            samples: Vec::new(),
        }
    }

    /// The rotation by twice as many points as before, or by `first`. Where equal steps do not resolve it to an
    /// accuracy, a part of the mean of dt/ds, it is integrated on panels.
    pub(crate) fn next(
        &mut self,
        system: &mut dyn ConservativeSystem,
        first: usize,
        accuracy: f64,
    ) -> Result<ResolvedMotion> {
        let (from, angle_per_period) = (self.first, self.angle_per_period);
        let samples = std::mem::take(&mut self.samples);
        self.samples = refine_samples(samples, first, |part| {
            let terms = system.energy_terms(from + angle_per_period * part)?;
            Ok::<_, DynamicsError>((terms, system.turns()))
        })?;
        let [kinetic, potential] = self.energies;
        let kinetic_left = |at: &EnergyTerms| kinetic + (potential - at.potential);
        let density = |at: &EnergyTerms| {
            angle_per_period.abs() / TAU * (at.m / (2.0 * kinetic_left(at))).sqrt()
        };
        let terms = || self.samples.iter().map(|(terms, _)| terms);
        let values: Vec<f64> = terms().map(density).collect();
        let max_kinetic = terms().map(kinetic_left).fold(0.0, f64::max);
        let mut points = self.samples.len();
        let size = values.iter().sum::<f64>() / points as f64;
        let mut series = FourierSeries::new(&values, size);
        series.check_between::<DynamicsError>(size, |part| {
            Ok(density(
                &system.energy_terms(from + angle_per_period * part)?,
            ))
        })?;
        let step = TAU / points as f64;
        let samples = self.samples.iter().chain(self.samples.first());
        let rate = |_| angle_per_period / TAU;
        let is_hidden = hides_turns(&mut series, accuracy, samples, step, rate);
        let mut is_resolved = series.is_resolved;
        let is_sharp = (points >= SHARP_POINTS || is_hidden) && !is_resolved;
        let time_density = if is_sharp && (series.tail >= accuracy || series.tail.is_nan()) {
            let panels = watched_panels(
                system,
                |system: &mut dyn ConservativeSystem, phase: f64| {
                    let q = from + angle_per_period * (phase / TAU);
                    Ok(density(&system.energy_terms(q)?))
                },
                rate,
            )?;
            points += panels.points;
            is_resolved = true;
            TimeDensity::Piecewise(panels)
        } else {
            TimeDensity::Fourier(series)
        };
        Ok(ResolvedMotion {
            time_density,
            max_kinetic,
            points,
            is_resolved,
        })
    }
}
