//! The flywheel that a machine needs to keep its speed fluctuation within a limit. The inverse of the coefficient of fluctuation is nearly
//! a straight line over the inertia, δ ≈ ΔE / (J ω²), so that few cycles are solved for.

use crate::cycle::{Cycle, steady_cycle};
use crate::error::{DynamicsError, Result, bad_option};
use crate::machine::{Machine, MovingModel};
use crate::options::Options;

/// Trials for the inertia, and how near the fluctuation must come.
const MAX_TRIALS: usize = 40;
const FLUCTUATION_TOLERANCE: f64 = 1e-9;

impl<M: MovingModel> Machine<M> {
    /// This machine with a flywheel (kg m² or kg) along a free coordinate, which replaces any flywheel there.
    #[must_use]
    pub fn with_flywheel(mut self, free: usize, inertia: f64) -> Self {
        self.flywheels[free] = inertia;
        self
    }

    /// The flywheel along a free coordinate, kg m² or kg.
    pub fn flywheel(&self, free: usize) -> f64 {
        self.flywheels[free]
    }
}

/// A flywheel for a wanted fluctuation.
#[derive(Debug, Clone, PartialEq)]
pub struct Flywheel {
    /// Moment of inertia to be added along the coordinate, kg m²; zero if none is needed.
    pub inertia: f64,
    /// The cycle with it.
    pub cycle: Cycle,
}

/// The flywheel that keeps the coefficient of fluctuation of a machine's steady cycle to `wanted`.
///
/// # Errors
/// As [`steady_cycle`].
pub fn size_flywheel<M: MovingModel>(
    machine: &Machine<M>,
    guess: &[f64],
    wanted: f64,
    options: &Options,
) -> Result<Flywheel> {
    if !(wanted.is_finite() && wanted > 0.0) {
        return bad_option("the coefficient of fluctuation", "positive number", wanted);
    }
    let initial_inertia = machine.flywheel(0);
    let mut guess = guess.to_vec();
    let mut with = |inertia: f64| -> Result<Cycle> {
        let heavier = machine.clone().with_flywheel(0, initial_inertia + inertia);
        let cycle = steady_cycle(&heavier, &guess, options)?;
        guess.clone_from(&cycle.initial_state);
        Ok(cycle)
    };
    let cycle = with(0.0)?;
    if cycle.fluctuation <= wanted {
        return Ok(Flywheel {
            inertia: 0.0,
            cycle,
        });
    }
    let difference = |cycle: &Cycle| wanted / cycle.fluctuation - 1.0;
    let mut before = (0.0, difference(&cycle));
    let mut workspace = machine.workspace();
    let state = machine.evaluate(0.0, &cycle.initial_state, &mut workspace)?;
    let [kinetic, _] = state.energy();
    let mean = 2.0 * kinetic / cycle.initial_state[1].powi(2);
    let mut inertia = mean * (cycle.fluctuation / wanted - 1.0);
    for _ in 0..MAX_TRIALS {
        let cycle = with(inertia)?;
        let now = (inertia, difference(&cycle));
        if now.1.abs() <= FLUCTUATION_TOLERANCE {
            return Ok(Flywheel { inertia, cycle });
        }
        let slope = (now.1 - before.1) / (now.0 - before.0);
        let next = now.0 - now.1 / slope;
        // Limits a step of the secant.
        inertia = if next.is_finite() {
            next.clamp(0.5 * now.0, 4.0 * now.0)
        } else {
            2.0 * now.0
        };
        before = now;
    }
    Err(DynamicsError::NoCycle {
        what: "no flywheel gives this coefficient of fluctuation",
    })
}
