//! The time that a motion takes for its phase.

use crate::conservative::{ConservativeSystem, EnergyTerms};
use crate::error::Result;
use dwell_numerics::fourier::FourierSeries;
use dwell_numerics::panels::Panels;
use std::cell::RefCell;
use std::f64::consts::TAU;

/// A motion that repeats itself, resolved over its phase.
pub(crate) struct ResolvedMotion {
    pub(crate) time_density: TimeDensity,
    /// The largest kinetic energy at a point, J.
    pub(crate) max_kinetic: f64,
    pub(crate) points: usize,
    /// Whether more points would change roundings only.
    pub(crate) is_resolved: bool,
}

/// Angles that turn further between two points than their rates say by less than this are roundings of positions, rad.
const ANGLE_ROUNDING: f64 = 1e-6;

/// The data of a point: the energy terms and the [turns](ConservativeSystem::turns).
pub(crate) type Sample = (EnergyTerms, Vec<[f64; 2]>);
/// A point of a rule: its phase and its [turns](ConservativeSystem::turns).
type Turns = (f64, Vec<[f64; 2]>);

/// The largest turn between neighbouring points that the rates there do not account for, rad; zero where all is accounted for. A body
/// that swings within a small part of the phase has a peak of inertia there, which no point needs to show. `rate` is dq/ds by phase.
///
/// The trapezoidal rule errs by h³/12 times the second derivative of a rate, which rates that the points resolve keep below a third of h times
/// their largest difference between neighbours (Bernstein's inequality).
fn hidden_turn(points: &[Turns], rate: impl Fn(f64) -> f64) -> f64 {
    let count = points.iter().map(|(_, turns)| turns.len()).min();
    let mut largest = 0.0_f64;
    for k in 0..count.unwrap_or(0) {
        let (mut difference, mut unexplained) = (0.0_f64, 0.0_f64);
        for pair in points.windows(2) {
            let h = pair[1].0 - pair[0].0;
            let [[from, before], [to, after]] = [0, 1].map(|i| pair[i].1[k]);
            let rates = [before * rate(pair[0].0), after * rate(pair[1].0)];
            let turned = to - from - 0.5 * h * (rates[0] + rates[1]);
            unexplained = unexplained.max((turned - TAU * (turned / TAU).round()).abs());
            difference = difference.max(h * (rates[1] - rates[0]).abs());
        }
        if unexplained > difference + ANGLE_ROUNDING {
            largest = largest.max(unexplained);
        }
    }
    largest
}

/// Whether samples at equal steps of the phase have turns that their rates do not account for, where a series to an accuracy seems to be resolved;
/// its tail then includes the largest. `rate` is dq/ds by phase.
pub(crate) fn hides_turns<'s>(
    series: &mut FourierSeries,
    accuracy: f64,
    samples: impl Iterator<Item = &'s Sample>,
    step: f64,
    rate: impl Fn(f64) -> f64,
) -> bool {
    if !series.is_resolved && series.tail >= accuracy {
        return false;
    }
    let point = |(k, (_, turns)): (usize, &Sample)| (step * k as f64, turns.clone());
    let points: Vec<Turns> = samples.enumerate().map(point).collect();
    let hidden = hidden_turn(&points, rate);
    if hidden > 0.0 {
        series.tail = series.tail.max(hidden / TAU);
        series.is_resolved = false;
    }
    hidden > 0.0
}

/// dt/ds on panels, in each of which the rates account for all turns, if these are known; `rate` is dq/ds by phase. Positions that
/// follow functions of the scene may not be smooth to rounding.
pub(crate) fn watched_panels(
    system: &mut dyn ConservativeSystem,
    density: impl Fn(&mut dyn ConservativeSystem, f64) -> Result<f64>,
    rate: impl Fn(f64) -> f64,
) -> Result<Panels> {
    if system.follows_functions() || system.turns().is_empty() {
        return Panels::new(|phase| density(system, phase));
    }
    let points = RefCell::new(Vec::new());
    let of = |phase| {
        let value = density(system, phase)?;
        points.borrow_mut().push((phase, system.turns()));
        Ok(value)
    };
    Panels::checked(of, || {
        let mut points = std::mem::take(&mut *points.borrow_mut());
        points.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        hidden_turn(&points, &rate) == 0.0
    })
}

/// The time per phase of a motion, dt/ds, s/rad.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum TimeDensity {
    /// A Fourier series, from equally spaced points.
    Fourier(FourierSeries),
    /// Panels, whose points are dense where the function is sharp.
    Piecewise(Panels),
}

impl TimeDensity {
    /// Its mean over a period.
    pub(crate) fn mean(&self) -> f64 {
        match self {
            Self::Fourier(series) => series.mean,
            Self::Piecewise(panels) => panels.mean,
        }
    }

    /// The last coefficients relative to the mean.
    pub(crate) fn tail(&self) -> f64 {
        match self {
            Self::Fourier(series) => series.tail,
            Self::Piecewise(panels) => panels.tail,
        }
    }

    /// Its value and its integral from zero at a phase.
    pub(crate) fn eval(&self, phase: f64) -> [f64; 2] {
        match self {
            Self::Fourier(series) => series.eval(phase),
            Self::Piecewise(panels) => panels.eval(phase),
        }
    }
}
