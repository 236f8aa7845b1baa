//! A plain kinetostatic solution in dense rows, in the frames as they are described and with its
//! own elimination: what the product's plan computes, by other means than the truths use.
//!
//! ```text
//! J ẋ = [0; q̇],  J ẍ = [0; q̈] − Φ̇ₓẋ,  Jᵀ [λ; τ] = M ẍ + h
//! ```

use super::gauss::gauss;
use dwell_geometry::rows::Rows;
use dwell_geometry::{BodyId, Mechanism, Vec2};
use dwell_kinetostatics::Mass;
use dwell_verify::{Actions, Coefficients, Range, Subject, SubjectError};
use std::f64::consts::TAU;

/// Mistakes of the method itself, which a wrapper outside cannot make.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Fault {
    None,
    /// h = 0.
    NoCentrifugal,
    /// J ẍ = [0; q̈].
    NoCurvature,
}

pub(crate) struct DenseSubject {
    mechanism: Mechanism,
    masses: Vec<Mass>,
    rows: Rows,
    seeds: Vec<(f64, Vec<f64>)>,
    pub(crate) fault: Fault,
}

impl DenseSubject {
    /// Closes at `q0` from the rough poses, then follows the range and keeps a seed at every step.
    pub(crate) fn new(
        m: &Mechanism,
        masses: &[Mass],
        range: Range,
        q0: f64,
        rough: &[[f64; 3]],
    ) -> Self {
        let rows = Rows::new(m).unwrap();
        assert_eq!(rows.len(), rows.columns());
        let mut subject = Self {
            mechanism: m.clone(),
            masses: masses.to_vec(),
            rows,
            seeds: Vec::new(),
            fault: Fault::None,
        };
        let start: Vec<f64> = (0..m.bodies.len())
            .filter(|&b| b != m.ground)
            .flat_map(|b| rough[b])
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
                subject.seeds.push((q, x.clone()));
            }
        }
        subject.seeds.sort_by(|a, b| a.0.total_cmp(&b.0));
        if range == Range::Full {
            // Asked for any number of turns.
            subject.seeds.pop();
        }
        subject
    }

    fn error(&self, q: f64) -> SubjectError {
        SubjectError {
            q,
            message: "does not close".into(),
        }
    }

    fn close(&self, start: &[f64], q: f64) -> Result<Vec<f64>, SubjectError> {
        let n = self.rows.len();
        let mut x = start.to_vec();
        let mut imposed = vec![0.0; n];
        imposed[n - 1] = q;
        let mut residual = vec![0.0; n];
        for _ in 0..30 {
            self.rows.residual(&x, &imposed, &mut residual);
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

    fn at(&self, q: f64) -> Result<Vec<f64>, SubjectError> {
        let off = |seed: f64| {
            let gap = q - seed;
            (gap - TAU * (gap / TAU).round()).abs()
        };
        let (_, seed) = self
            .seeds
            .iter()
            .min_by(|a, b| off(a.0).total_cmp(&off(b.0)))
            .ok_or_else(|| self.error(q))?;
        self.close(seed, q)
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
        let mut curvature = vec![0.0; n];
        if self.fault != Fault::NoCurvature {
            self.rows.curvature(x, &x_dot, &mut curvature);
        }
        let mut right: Vec<f64> = curvature.iter().map(|c| -c).collect();
        right[n - 1] += q_ddot;
        let x_ddot = gauss(jacobian.clone(), &right, n);
        let mut force = vec![0.0; n];
        for (b, mass) in self.masses.iter().enumerate() {
            if let Some(c) = self.rows.column(BodyId(b)) {
                let arm = mass.center.turn(Vec2::from_angle(x[c + 2]));
                let (m, omega) = (mass.mass, x_dot[c + 2]);
                let [ax, ay, alpha] = [x_ddot[c], x_ddot[c + 1], x_ddot[c + 2]];
                let kept = if self.fault == Fault::NoCentrifugal {
                    0.0
                } else {
                    1.0
                };
                force[c] = m * (ax - arm.y * alpha - kept * arm.x * omega * omega);
                force[c + 1] = m * (ay + arm.x * alpha - kept * arm.y * omega * omega);
                force[c + 2] =
                    mass.inertia * alpha + m * (arm.x * ay - arm.y * ax + arm.dot(arm) * alpha);
            }
        }
        let transposed = (0..n * n).map(|i| jacobian[(i % n) * n + i / n]).collect();
        gauss(transposed, &force, n)
    }
}

impl Subject for DenseSubject {
    fn poses(&self, q: f64) -> Result<Vec<[f64; 3]>, SubjectError> {
        let x = self.at(q)?;
        let pose = |b| {
            let column = self.rows.column(BodyId(b));
            column.map_or([0.0; 3], |c| [x[c], x[c + 1], x[c + 2]])
        };
        Ok((0..self.mechanism.bodies.len()).map(pose).collect())
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let x = self.at(q)?;
        let mut b = self.multipliers(&x, 1.0, 0.0);
        let mut a = self.multipliers(&x, 0.0, 1.0);
        let (half_dm, m) = (b.pop().unwrap(), a.pop().unwrap());
        Ok(Coefficients { m, half_dm, a, b })
    }

    fn actions(&self, q: f64, q_dot: f64, q_ddot: f64) -> Result<Actions, SubjectError> {
        let x = self.at(q)?;
        let mut reactions = self.multipliers(&x, q_dot, q_ddot);
        let tau = reactions.pop().unwrap();
        Ok(Actions { tau, reactions })
    }
}
