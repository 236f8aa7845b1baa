//! A plain kinetostatic solution in dense rows, in the frames as they are described and with its
//! own elimination: the results of the plan, by a method that the checks do not use.
//!
//! ```text
//! J ẋ = [0; q̇],  J ẍ = [0; q̈] − Φ̇ₓẋ,  Jᵀ [λ; τ] = M ẍ + h
//! ```

use super::gauss::gauss;
use dwell_geometry::constraint_rows::ConstraintRows;
use dwell_geometry::{BodyId, Mechanism, Vec2};
use dwell_kinetostatics::Mass;
use dwell_verify::{Coefficients, InverseDynamics, Pose, Range, Subject, SubjectError};
use std::f64::consts::TAU;

/// Mistakes of the method itself, which a wrapper outside cannot make.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Mutation {
    None,
    /// h = 0.
    NoCentrifugal,
    /// J ẍ = [0; q̈].
    NoVelocityProduct,
}

pub(crate) struct DenseSubject {
    mechanism: Mechanism,
    masses: Vec<Mass>,
    rows: ConstraintRows,
    stored_solutions: Vec<(f64, Vec<f64>)>,
    pub(crate) mutation: Mutation,
}

impl DenseSubject {
    /// Closes at `q0` from the rough poses, then follows the range and keeps a seed at every step.
    pub(crate) fn new(
        m: &Mechanism,
        masses: &[Mass],
        range: Range,
        q0: f64,
        initial_guess: &[[f64; 3]],
    ) -> Self {
        let rows = ConstraintRows::new(m).unwrap();
        assert_eq!(rows.len(), rows.columns());
        let mut subject = Self {
            mechanism: m.clone(),
            masses: masses.to_vec(),
            rows,
            stored_solutions: Vec::new(),
            mutation: Mutation::None,
        };
        let start: Vec<f64> = (0..m.bodies.len())
            .filter(|&b| b != m.ground)
            .flat_map(|b| initial_guess[b])
            .collect();
        let first = subject.close(&start, q0).expect("the rough poses close");
        let (low, high) = match range.limits() {
            None => (q0, q0 + TAU),
            Some((low, high)) => (low, high),
        };
        for end in [low, high] {
            let steps = ((end - q0).abs() / 0.01).ceil() as u32;
            let mut x = first.clone();
            for i in 0..=steps {
                let q = q0 + (end - q0) * f64::from(i) / f64::from(steps.max(1));
                x = subject.close(&x, q).expect("the range is reachable");
                subject.stored_solutions.push((q, x.clone()));
            }
        }
        subject.stored_solutions.sort_by(|a, b| a.0.total_cmp(&b.0));
        if range == Range::Full {
            // Any number of revolutions may be asked for.
            subject.stored_solutions.pop();
        }
        subject
    }

    fn error(&self, q: f64) -> SubjectError {
        SubjectError {
            q,
            message: "does not close".into(),
        }
    }

    fn close(&self, initial_guess: &[f64], q: f64) -> Result<Vec<f64>, SubjectError> {
        let n = self.rows.len();
        let mut x = initial_guess.to_vec();
        let mut row_values = vec![0.0; n];
        row_values[n - 1] = q;
        let mut residual = vec![0.0; n];
        for _ in 0..30 {
            self.rows.residual(&x, &row_values, &mut residual);
            let step = gauss(self.jacobian(&x), &residual, n);
            for (x, s) in x.iter_mut().zip(&step) {
                *x -= s;
            }
            if step.iter().fold(0.0_f64, |m, s| m.max(s.abs())) < 1e-10 {
                return Ok(x);
            }
        }
        Err(self.error(q))
    }

    fn coordinates(&self, q: f64) -> Result<Vec<f64>, SubjectError> {
        let distance = |stored: f64| {
            let gap = q - stored;
            (gap - TAU * (gap / TAU).round()).abs()
        };
        let (_, stored) = self
            .stored_solutions
            .iter()
            .min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)))
            .ok_or_else(|| self.error(q))?;
        self.close(stored, q)
    }

    fn jacobian(&self, x: &[f64]) -> Vec<f64> {
        let mut jacobian = vec![0.0; x.len() * self.rows.len()];
        self.rows.jacobian(x, &mut jacobian);
        jacobian
    }

    /// [λ; τ] at a state.
    fn multipliers(&self, x: &[f64], q_dot: f64, q_ddot: f64) -> Vec<f64> {
        let n = x.len();
        let jacobian = self.jacobian(x);
        let mut rates = vec![0.0; n];
        rates[n - 1] = q_dot;
        let x_dot = gauss(jacobian.clone(), &rates, n);
        let mut velocity_products = vec![0.0; n];
        if self.mutation != Mutation::NoVelocityProduct {
            self.rows
                .velocity_product(x, &x_dot, &mut velocity_products);
        }
        let mut right: Vec<f64> = velocity_products.iter().map(|c| -c).collect();
        right[n - 1] += q_ddot;
        let x_ddot = gauss(jacobian.clone(), &right, n);
        let mut force = vec![0.0; n];
        for (b, mass) in self.masses.iter().enumerate() {
            if let Some(c) = self.rows.column(BodyId(b)) {
                let arm = mass.center.rotate(Vec2::from_angle(x[c + 2]));
                let (m, omega) = (mass.mass, x_dot[c + 2]);
                let [ax, ay, alpha] = [x_ddot[c], x_ddot[c + 1], x_ddot[c + 2]];
                let factor = if self.mutation == Mutation::NoCentrifugal {
                    0.0
                } else {
                    1.0
                };
                force[c] = m * (ax - arm.y * alpha - factor * arm.x * omega * omega);
                force[c + 1] = m * (ay + arm.x * alpha - factor * arm.y * omega * omega);
                force[c + 2] =
                    mass.inertia * alpha + m * (arm.x * ay - arm.y * ax + arm.dot(arm) * alpha);
            }
        }
        let transposed = (0..n * n).map(|i| jacobian[(i % n) * n + i / n]).collect();
        gauss(transposed, &force, n)
    }
}

impl Subject for DenseSubject {
    fn poses(&self, q: f64) -> Result<Vec<Pose>, SubjectError> {
        let x = self.coordinates(q)?;
        let pose = |b| {
            let column = self.rows.column(BodyId(b));
            column
                .map_or([0.0; 3], |c| [x[c], x[c + 1], x[c + 2]])
                .into()
        };
        Ok((0..self.mechanism.bodies.len()).map(pose).collect())
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let x = self.coordinates(q)?;
        let mut b = self.multipliers(&x, 1.0, 0.0);
        let mut a = self.multipliers(&x, 0.0, 1.0);
        let (half_dm, m) = (b.pop().unwrap(), a.pop().unwrap());
        Ok(Coefficients { m, half_dm, a, b })
    }

    fn inverse_dynamics(
        &self,
        q: f64,
        q_dot: f64,
        q_ddot: f64,
    ) -> Result<InverseDynamics, SubjectError> {
        let x = self.coordinates(q)?;
        let mut reactions = self.multipliers(&x, q_dot, q_ddot);
        let tau = reactions.pop().unwrap();
        Ok(InverseDynamics { tau, reactions })
    }
}
