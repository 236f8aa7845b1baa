//! The estimated errors of a steady cycle, from a second computation at a tenth of the tolerance.

use crate::estimate;
use dwell_dynamics::{Cycle, DynamicsError, Machine, MovingModel, Options, steady_cycle};

/// A cycle whose speeds err by more than this part of them has not been found.
pub(crate) const MAX_SPEED_ERROR: f64 = 1e-3;

/// The estimated errors of a steady cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleErrors {
    /// Relative error of the period and of every speed.
    pub speed: f64,
    /// Errors of the coordinates at which the speed is least and greatest, rad.
    pub positions: [f64; 2],
    /// Error of the coefficient of fluctuation.
    pub fluctuation: f64,
    /// Error of every work, J.
    pub work: f64,
    /// By Floquet multiplier.
    pub multipliers: Vec<f64>,
}

/// The stability of a cycle, as far as its errors decide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CycleStability {
    /// A small disturbance decays.
    Stable,
    /// A small disturbance grows.
    Unstable,
    /// The error does not let it be decided.
    Undecided,
}

impl CycleErrors {
    /// The errors of a cycle that was computed with these options.
    ///
    /// # Errors
    /// As [`steady_cycle`], of the second computation.
    pub(crate) fn new<M: MovingModel>(
        machine: &Machine<M>,
        cycle: &Cycle,
        options: &Options,
    ) -> Result<Self, DynamicsError> {
        let finer = estimate::comparison_options(options);
        let second = steady_cycle(machine, &cycle.initial_state, &finer)?;
        let of = estimate::of_number;
        let speeds = [
            (cycle.initial_state[1], second.initial_state[1]),
            (cycle.mean_speed, second.mean_speed),
            (cycle.slowest[1], second.slowest[1]),
            (cycle.fastest[1], second.fastest[1]),
        ];
        let relative = speeds.map(|(a, b)| of(a, b) / a.abs());
        let speed = relative.into_iter().fold(0.0, f64::max);
        let works = cycle.works.iter().zip(&second.works);
        let works = works.map(|(&a, &b)| of(a, b)).fold(0.0, f64::max);
        // The works of an exact cycle add up to zero.
        let sum: f64 = cycle.works.iter().sum();
        let position = |of: fn(&Cycle) -> f64| {
            let turns = (of(cycle) - of(&second)) / cycle.cycle_angle;
            estimate::of_number((turns - turns.round()) * cycle.cycle_angle, 0.0)
        };
        let multiplier = |[re, im]: [f64; 2]| {
            let others = second.floquet_multipliers.iter();
            let distances = others.map(|other| (re - other[0]).hypot(im - other[1]));
            of(distances.fold(f64::INFINITY, f64::min), 0.0)
        };
        let multipliers = cycle.floquet_multipliers.iter();
        Ok(Self {
            speed,
            positions: [position(|c| c.slowest[0]), position(|c| c.fastest[0])],
            fluctuation: of(cycle.fluctuation, second.fluctuation)
                + speed * cycle.fluctuation.abs(),
            work: works.max(sum.abs()),
            multipliers: multipliers.map(|&z| multiplier(z)).collect(),
        })
    }

    /// The stability of the cycle with these errors.
    pub fn stability(&self, cycle: &Cycle) -> CycleStability {
        let sizes = cycle.floquet_multipliers.iter();
        let sizes = sizes.map(|[re, im]| re.hypot(*im)).zip(&self.multipliers);
        if sizes.clone().all(|(size, error)| size + error < 1.0) {
            CycleStability::Stable
        } else if sizes.clone().any(|(size, error)| size - error > 1.0) {
            CycleStability::Unstable
        } else {
            CycleStability::Undecided
        }
    }

    /// Whether the speed varies at all, within the error.
    pub fn varies(&self, cycle: &Cycle) -> bool {
        cycle.fluctuation.abs() > self.fluctuation
    }
}
