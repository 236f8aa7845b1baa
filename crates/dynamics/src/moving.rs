//! A machine as a system to be integrated, with its exact Jacobian by dual numbers.

use crate::error::DynamicsError;
use crate::machine::{Machine, MachineWork};
use crate::system::System;
use dwell_geometry::{Dual, Scalar};

/// A machine with the working memory to integrate it, for one thread.
#[derive(Debug)]
pub struct Moving<'m> {
    machine: &'m Machine,
    /// The last evaluation in plain numbers.
    pub work: MachineWork<f64>,
    dual: MachineWork<Dual>,
    y: Vec<Dual>,
    out: Vec<Dual>,
    weights: Vec<f64>,
}

impl<'m> Moving<'m> {
    /// A machine about to move, from a state whose energies give the works their scale.
    ///
    /// # Errors
    /// [`DynamicsError`] where the start cannot be evaluated.
    pub fn new(machine: &'m Machine, t: f64, y: &[f64]) -> Result<Self, DynamicsError> {
        let mut work = machine.work();
        machine.evaluate(t, y, &mut work)?;
        let mut weights = vec![1.0; machine.states()];
        let scale = machine.energy_scale(&work);
        weights[machine.first_work()..].fill(scale);
        let zero = vec![Dual::lift(0.0); machine.states()];
        Ok(Self {
            machine,
            work,
            dual: machine.work(),
            y: zero.clone(),
            out: zero,
            weights,
        })
    }

    /// The machine.
    pub fn machine(&self) -> &'m Machine {
        self.machine
    }
}

impl Machine {
    /// An energy to measure works by, J: the kinetic one, or what the loads and drives do in one unit of
    /// the coordinates.
    fn energy_scale(&self, work: &MachineWork<f64>) -> f64 {
        let [kinetic, _] = self.energy(work);
        let forces = work.actions().tau.iter().chain(&work.action);
        let scale = kinetic + forces.map(|f| f.abs()).sum::<f64>();
        if scale.is_normal() { scale } else { 1.0 }
    }
}

impl System for Moving<'_> {
    fn size(&self) -> usize {
        self.machine.states()
    }

    fn rates(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        self.machine.evaluate(t, y, &mut self.work)?;
        self.machine.rates(&self.work, out);
        Ok(())
    }

    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        let n = self.size();
        out.fill(0.0);
        // No rate depends on the works.
        for j in 0..self.machine.first_work() {
            for (i, (dual, &value)) in self.y.iter_mut().zip(y).enumerate() {
                *dual = if i == j {
                    Dual::variable(value)
                } else {
                    Dual::lift(value)
                };
            }
            self.machine.evaluate(t, &self.y, &mut self.dual)?;
            self.machine.rates(&self.dual, &mut self.out);
            for (i, rate) in self.out.iter().enumerate() {
                out[i * n + j] = rate.d;
            }
        }
        Ok(())
    }

    fn weight(&self, state: usize) -> f64 {
        self.weights[state]
    }
}
