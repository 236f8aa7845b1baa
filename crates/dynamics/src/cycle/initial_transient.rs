//! The transient before a cycle, and machines that come to rest instead.

use super::NO_CYCLE;
use crate::error::{DynamicsError, Result};
use crate::integrate::integrate;
use crate::machine::{Machine, MovingModel};
use crate::machine_ode::MachineOde;
use crate::ode::{DenseOutput, OdeState, OdeSystem, Step, StepControl};
use crate::options::Options;
use dwell_numerics::root;
use std::f64::consts::TAU;

/// A machine has come to rest if its speed, and its acceleration times the time of a radian at the largest speed so
/// far, are below this fraction of that speed.
const REST_TOLERANCE: f64 = 1e-6;
/// A machine that moves by less than this (rad) in a number of steps has come to rest, too.
const REST_ANGLE: f64 = 1e-6;
const REST_STEPS: usize = 1000;

/// The state after some revolutions from a start, at rest or not: a guess for [`steady_cycle`].
///
/// # Errors
/// [`DynamicsError::ComesToRest`]; as of [`Machine::evaluate`] and [`integrate`], among them that the steps allowed are
/// used up, where the machine never completes the revolutions.
pub fn initial_transient<M: MovingModel>(
    machine: &Machine<M>,
    start: &[f64],
    revolutions: u32,
    options: &Options,
) -> Result<Vec<f64>> {
    machine.require_smooth(NO_CYCLE)?;
    let mut ode = MachineOde::new(machine, 0.0, start)?;
    let from = start[0];
    let distance = TAU * f64::from(revolutions);
    let mut reached = start.to_vec();
    let mut rest = RestMonitor::new(machine, start)?;
    let mut came_to_rest = None;
    let mut observer = |before: &OdeState, now: &OdeState, dense: DenseOutput<'_>| {
        if (now.y[0] - from).abs() < distance {
            let at_rest = rest.is_at_rest(now)?;
            came_to_rest = at_rest.then_some(now.y[0]);
            return Ok(if at_rest {
                StepControl::Stop
            } else {
                StepControl::Continue
            });
        }
        let mut step = Step { before, now, dense };
        let difference =
            |t: f64| -> Result<f64> { Ok((step.state_at(t)?.y[0] - from).abs() - distance) };
        let t = root::find(difference, before.t, now.t)?;
        reached = step.state_at(t.unwrap_or(now.t))?.y;
        Ok(StepControl::Stop)
    };
    let start = OdeState {
        t: 0.0,
        y: start.to_vec(),
    };
    integrate(&mut ode, &start, None, options, &mut observer)?.completed()?;
    if let Some(q) = came_to_rest {
        return Err(DynamicsError::ComesToRest { q });
    }
    // The works of the cycle start from zero.
    reached[machine.work_offset()..].fill(0.0);
    Ok(reached)
}

/// Recognises a machine that has come to rest, where an integrator's steps grow without bound.
struct RestMonitor<'m, M: MovingModel> {
    ode: MachineOde<'m, M>,
    rates: Vec<f64>,
    /// Coordinate, speed and states of the drives.
    states: usize,
    /// The largest value of each state so far.
    largest: Vec<f64>,
    /// The coordinate at the last movement of the machine, rad, and the steps since then.
    last: f64,
    still_steps: usize,
}

impl<'m, M: MovingModel> RestMonitor<'m, M> {
    fn new(machine: &'m Machine<M>, start: &[f64]) -> Result<Self> {
        Ok(Self {
            ode: MachineOde::new(machine, 0.0, start)?,
            rates: vec![0.0; start.len()],
            states: machine.work_offset(),
            largest: start.iter().map(|x| x.abs()).collect(),
            last: start[0],
            still_steps: 0,
        })
    }

    fn is_at_rest(&mut self, now: &OdeState) -> Result<bool> {
        for (largest, x) in self.largest.iter_mut().zip(&now.y) {
            *largest = largest.max(x.abs());
        }
        self.still_steps += 1;
        if (now.y[0] - self.last).abs() > REST_ANGLE {
            (self.last, self.still_steps) = (now.y[0], 0);
        }
        if self.still_steps >= REST_STEPS {
            return Ok(true);
        }
        let speed = self.largest[1];
        if speed == 0.0 || now.y[1].abs() > REST_TOLERANCE * speed {
            return Ok(false);
        }
        self.ode.rhs(now.t, &now.y, &mut self.rates)?;
        let is_constant =
            |i: usize| self.rates[i].abs() <= REST_TOLERANCE * self.largest[i] * speed;
        Ok((1..self.states).all(is_constant))
    }
}
