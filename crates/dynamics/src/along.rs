//! A machine over the way of its coordinate instead of time, with the sensitivity of its speed and its
//! drives' states to those it began with.

use crate::cycle::Turning;
use crate::error::DynamicsError;
use crate::moving::Moving;
use crate::system::System;

/// Time takes the coordinate's place among the states, and the columns of S follow them.
pub(crate) struct Along<'t, 'm> {
    turning: &'t Turning<'m>,
    moving: Moving<'m>,
    /// Columns of S that are carried.
    columns: usize,
    y: Vec<f64>,
    rates: Vec<f64>,
    jacobian: Vec<f64>,
}

impl<'t, 'm> Along<'t, 'm> {
    pub(crate) fn new(
        turning: &'t Turning<'m>,
        x: &[f64],
        columns: usize,
    ) -> Result<Self, DynamicsError> {
        let n = turning.machine.states();
        let moving = Moving::new(turning.machine, 0.0, &turning.state(0.0, x).y)?;
        Ok(Self {
            turning,
            moving,
            columns,
            y: vec![0.0; n],
            rates: vec![0.0; n],
            jacobian: vec![0.0; n * n],
        })
    }

    /// ẏ at a way, and 1/|q̇|.
    fn evaluate(&mut self, along: f64, x: &[f64]) -> Result<f64, DynamicsError> {
        let Turning { from, way, .. } = *self.turning;
        self.y.copy_from_slice(&x[..self.rates.len()]);
        self.y[0] = from + way * along;
        let speed = way * self.y[1];
        if speed.is_nan() || speed <= 0.0 {
            return Err(DynamicsError::Stalls { q: self.y[0] });
        }
        self.moving.rates(x[0], &self.y, &mut self.rates)?;
        // dt/dt, where the coordinate's rate stood.
        self.rates[0] = 1.0;
        Ok(1.0 / speed)
    }

    /// ∂(ẋ/|q̇|)/∂x of the machine's states, row by row, and 1/|q̇|.
    fn slope(&mut self, along: f64, x: &[f64]) -> Result<f64, DynamicsError> {
        let slow = self.evaluate(along, x)?;
        let n = self.rates.len();
        self.moving.jacobian(x[0], &self.y, &mut self.jacobian)?;
        for (i, row) in self.jacobian.chunks_exact_mut(n).enumerate() {
            if i == 0 {
                row.fill(0.0);
            }
            // The coordinate is no state here, and nothing depends on time.
            row[0] = 0.0;
            row[1] -= self.rates[i] * slow * self.turning.way;
            row.iter_mut().for_each(|entry| *entry *= slow);
        }
        Ok(slow)
    }
}

impl System for Along<'_, '_> {
    fn size(&self) -> usize {
        self.rates.len() + self.columns * self.turning.unknowns()
    }

    fn rates(&mut self, along: f64, x: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        let n = self.rates.len();
        let slow = if self.columns > 0 {
            let slow = self.slope(along, x)?;
            let unknowns = self.turning.unknowns();
            let (s, ds) = (&x[n..], &mut out[n..]);
            for i in 0..unknowns {
                for j in 0..unknowns {
                    let terms = (0..unknowns)
                        .map(|k| self.jacobian[(i + 1) * n + k + 1] * s[k * unknowns + j]);
                    ds[i * unknowns + j] = terms.sum();
                }
            }
            slow
        } else {
            self.evaluate(along, x)?
        };
        for (out, rate) in out.iter_mut().zip(&self.rates) {
            *out = rate * slow;
        }
        Ok(())
    }

    /// Without what S itself would have to be differentiated for: implicit methods then take some steps
    /// of their Newton's method more.
    fn jacobian(&mut self, along: f64, x: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        self.slope(along, x)?;
        let (n, size, unknowns) = (self.rates.len(), self.size(), self.turning.unknowns());
        out.fill(0.0);
        for i in 0..n {
            out[i * size..i * size + n].copy_from_slice(&self.jacobian[i * n..(i + 1) * n]);
        }
        for j in 0..self.columns {
            for i in 0..unknowns {
                for k in 0..unknowns {
                    let [row, column] = [i, k].map(|r| n + r * unknowns + j);
                    out[row * size + column] = self.jacobian[(i + 1) * n + k + 1];
                }
            }
        }
        Ok(())
    }

    fn weight(&self, state: usize) -> f64 {
        match state {
            // A time is measured by a turn's.
            0 => self.turning.turn / self.moving.work.q_dot[self.turning.machine.free()[0]].abs(),
            state if state < self.rates.len() => self.moving.weight(state),
            _ => 1.0,
        }
    }
}
