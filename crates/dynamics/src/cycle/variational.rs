//! The variational system of a machine with its coordinate as the independent variable: the state together with
//! its sensitivity S to the initial speed and drive states (Hairer, Nørsett and Wanner 1993, I.14).

use super::CycleProblem;
use crate::error::{DynamicsError, Result};
use crate::machine::MovingModel;
use crate::machine_ode::MachineOde;
use crate::ode::OdeSystem;

/// In the states, time replaces the coordinate; the columns of S follow.
pub(super) struct VariationalSystem<'t, 'm, M: MovingModel> {
    problem: &'t CycleProblem<'m, M>,
    ode: MachineOde<'m, M>,
    /// Number of columns of S that are integrated.
    sensitivity_columns: usize,
    /// |q̇| of the last evaluation.
    speed: f64,
    y: Vec<f64>,
    rhs: Vec<f64>,
    jacobian: Vec<f64>,
}

impl<'t, 'm, M: MovingModel> VariationalSystem<'t, 'm, M> {
    pub(super) fn new(
        problem: &'t CycleProblem<'m, M>,
        x: &[f64],
        sensitivity_columns: usize,
    ) -> Result<Self> {
        let n = problem.machine.state_count();
        let start = problem.machine_state(0.0, x).y;
        Ok(Self {
            problem,
            ode: MachineOde::new(problem.machine, 0.0, &start)?,
            speed: start[1].abs(),
            sensitivity_columns,
            y: vec![0.0; n],
            rhs: vec![0.0; n],
            jacobian: vec![0.0; n * n],
        })
    }

    /// Evaluates ẏ at a displacement from the start; returns 1/|q̇|.
    fn evaluate(&mut self, displacement: f64, x: &[f64]) -> Result<f64> {
        let CycleProblem {
            start_angle: from,
            direction,
            ..
        } = *self.problem;
        self.y.copy_from_slice(&x[..self.rhs.len()]);
        self.y[0] = from + direction * displacement;
        let speed = direction * self.y[1];
        if speed.is_nan() || speed <= 0.0 {
            return Err(DynamicsError::ComesToRest { q: self.y[0] });
        }
        self.speed = speed;
        self.ode.rhs(x[0], &self.y, &mut self.rhs)?;
        // dt/dt, where the coordinate's rate stood.
        self.rhs[0] = 1.0;
        Ok(1.0 / speed)
    }

    /// ∂(ẋ/|q̇|)/∂x of the machine's states, row by row, and 1/|q̇|.
    fn evaluate_jacobian(&mut self, displacement: f64, x: &[f64]) -> Result<f64> {
        let time_density = self.evaluate(displacement, x)?;
        let n = self.rhs.len();
        self.ode.jacobian(x[0], &self.y, &mut self.jacobian)?;
        for (i, row) in self.jacobian.chunks_exact_mut(n).enumerate() {
            if i == 0 {
                row.fill(0.0);
            }
            // The coordinate is no state here, and nothing depends on time.
            row[0] = 0.0;
            row[1] -= self.rhs[i] * time_density * self.problem.direction;
            row.iter_mut().for_each(|entry| *entry *= time_density);
        }
        Ok(time_density)
    }
}

impl<M: MovingModel> OdeSystem for VariationalSystem<'_, '_, M> {
    fn size(&self) -> usize {
        self.rhs.len() + self.sensitivity_columns * self.problem.unknowns()
    }

    fn rhs(&mut self, displacement: f64, x: &[f64], out: &mut [f64]) -> Result<()> {
        let n = self.rhs.len();
        let time_density = if self.sensitivity_columns > 0 {
            let time_density = self.evaluate_jacobian(displacement, x)?;
            let unknowns = self.problem.unknowns();
            let (s, ds) = (&x[n..], &mut out[n..]);
            for i in 0..unknowns {
                for j in 0..unknowns {
                    let terms = (0..unknowns)
                        .map(|k| self.jacobian[(i + 1) * n + k + 1] * s[k * unknowns + j]);
                    ds[i * unknowns + j] = terms.sum();
                }
            }
            time_density
        } else {
            self.evaluate(displacement, x)?
        };
        for (out, rate) in out.iter_mut().zip(&self.rhs) {
            *out = rate * time_density;
        }
        Ok(())
    }

    /// The derivatives of S by the state are left out: implicit methods then take a few more Newton iterations.
    fn jacobian(&mut self, displacement: f64, x: &[f64], out: &mut [f64]) -> Result<()> {
        self.evaluate_jacobian(displacement, x)?;
        let (n, size, unknowns) = (self.rhs.len(), self.size(), self.problem.unknowns());
        out.fill(0.0);
        for i in 0..n {
            out[i * size..i * size + n].copy_from_slice(&self.jacobian[i * n..(i + 1) * n]);
        }
        for j in 0..self.sensitivity_columns {
            for i in 0..unknowns {
                for k in 0..unknowns {
                    let [row, column] = [i, k].map(|r| n + r * unknowns + j);
                    out[row * size + column] = self.jacobian[(i + 1) * n + k + 1];
                }
            }
        }
        Ok(())
    }

    fn error_weight(&self, state: usize) -> f64 {
        match state {
            // The scale of time is about the duration of a cycle.
            0 => self.problem.cycle_angle / self.speed,
            state if state < self.rhs.len() => self.ode.error_weight(state),
            _ => 1.0,
        }
    }
}
