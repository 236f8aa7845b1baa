//! The exported code of several degrees of freedom in Rust, in one kind of number.

use super::description::SeveralFreedomsDescription;
use crate::evaluator::{Load, Status, runge_kutta};
use dwell_numerics::Real;
use dwell_numerics::StraightLine;

/// The exported code in one kind of number, with the parameters and inputs of the scene.
#[derive(Debug, Clone)]
pub struct SeveralFreedomsEvaluator<'a, R> {
    code: &'a [StraightLine; 3],
    freedoms: usize,
    reactions: usize,
    pairs: Vec<[usize; 2]>,
    loads: Vec<Load<R>>,
    order: usize,
}

impl<'a, R: Real> SeveralFreedomsEvaluator<'a, R> {
    /// The evaluator of a machine and the operations of its functions.
    pub fn new(machine: &SeveralFreedomsDescription, code: &'a [StraightLine; 3]) -> Self {
        let (loads, order) = Load::all(&machine.loads, machine.freedoms());
        Self {
            code,
            freedoms: machine.freedoms(),
            reactions: machine.reactions.len(),
            pairs: machine.pairs(),
            loads,
            order,
        }
    }

    /// The numbers of a state: coordinates, velocities, currents.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The number of coordinates.
    pub fn freedoms(&self) -> usize {
        self.freedoms
    }

    /// The outputs of the motion's code at a state.
    fn motion(&self, y: &[R]) -> Result<Vec<R>, Status> {
        let terms = self.code[0].evaluate(&y[..self.freedoms]);
        if terms.iter().all(|term| term.to_f64().is_finite()) {
            return Ok(terms);
        }
        Err(Status::OutOfRange)
    }

    /// By coordinate Σ h q̇ᵢ q̇ⱼ.
    fn velocity_terms(&self, terms: &[R], y: &[R]) -> Vec<R> {
        let (n, pairs) = (self.freedoms, self.pairs.len());
        let sum = |i: usize| {
            let each = self.pairs.iter().enumerate();
            each.fold(R::of(0.0), |sum, (p, [a, b])| {
                sum + terms[pairs + p * n + i] * (y[n + a] * y[n + b])
            })
        };
        (0..n).map(sum).collect()
    }

    /// The velocity along a load's line, or the sum of its w with other factors.
    fn along(&self, terms: &[R], load: usize, of: &[R]) -> R {
        let w = self.w(terms, load).iter().zip(of);
        w.fold(R::of(0.0), |sum, (w, x)| sum + *w * *x)
    }

    /// w of a load.
    fn w<'t>(&self, terms: &'t [R], load: usize) -> &'t [R] {
        let n = self.freedoms;
        &terms[self.pairs.len() * (n + 1) + load * n..][..n]
    }

    /// F of each load at a state, without the forces that accelerate rotors.
    fn forces(&self, terms: &[R], y: &[R]) -> Vec<R> {
        let n = self.freedoms;
        let force = |(k, load): (usize, &Load<R>)| {
            let velocity = self.along(terms, k, &y[n..2 * n]);
            load.force(y, |factor| factor * velocity)
        };
        self.loads.iter().enumerate().map(force).collect()
    }

    /// The mass matrix with rotors, row by row.
    fn mass_matrix(&self, terms: &[R]) -> Vec<R> {
        let n = self.freedoms;
        let mut m = vec![R::of(0.0); n * n];
        for (p, [i, j]) in self.pairs.iter().enumerate() {
            [m[i * n + j], m[j * n + i]] = [terms[p]; 2];
        }
        for (k, load) in self.loads.iter().enumerate() {
            let Some(reflected) = load.rotor() else {
                continue;
            };
            let w = self.w(terms, k);
            for i in 0..n {
                for j in 0..n {
                    m[i * n + j] = m[i * n + j] + reflected * w[i] * w[j];
                }
            }
        }
        m
    }

    /// The forces on the coordinates that give accelerations against all loads, N m or N.
    ///
    /// # Errors
    /// [`Status`] where the mechanism cannot be assembled.
    pub fn required_forces(&self, y: &[R], q_ddot: &[R]) -> Result<Vec<R>, Status> {
        let n = self.freedoms;
        let terms = self.motion(y)?;
        let (m, forces) = (self.mass_matrix(&terms), self.forces(&terms, y));
        let mut found = self.velocity_terms(&terms, y);
        for i in 0..n {
            for j in 0..n {
                found[i] = found[i] + m[i * n + j] * q_ddot[j];
            }
            for (k, force) in forces.iter().enumerate() {
                found[i] = found[i] - *force * self.w(&terms, k)[i];
            }
        }
        Ok(found)
    }

    /// The rates of a state: velocities, accelerations, and those of the currents.
    ///
    /// # Errors
    /// [`Status`] if the mechanism cannot be assembled, or its mass matrix is not positive definite.
    pub fn rates(&self, y: &[R]) -> Result<Vec<R>, Status> {
        let n = self.freedoms;
        let rest = self.required_forces(y, &vec![R::of(0.0); n])?;
        let terms = self.motion(y)?;
        let right = rest.iter().map(|force| R::of(0.0) - *force).collect();
        let q_ddot = solve(self.mass_matrix(&terms), right)?;
        let mut rates = y[n..2 * n].to_vec();
        rates.extend(q_ddot);
        for (k, load) in self.loads.iter().enumerate() {
            let velocity = self.along(&terms, k, &y[n..2 * n]);
            rates.extend(
                load.current_rate(y, |factor| factor * velocity)
                    .map(|(_, rate)| rate),
            );
        }
        Ok(rates)
    }

    /// Every reaction at a state with accelerations, N or N m.
    ///
    /// # Errors
    /// [`Status`] where the mechanism cannot be assembled.
    pub fn reactions(&self, y: &[R], q_ddot: &[R]) -> Result<Vec<R>, Status> {
        let (n, r) = (self.freedoms, self.reactions);
        let terms = self.motion(y)?;
        let mut forces = self.forces(&terms, y);
        for (k, force) in forces.iter_mut().enumerate() {
            if let Some(reflected) = self.loads[k].rotor() {
                *force = *force - reflected * self.along(&terms, k, q_ddot);
            }
        }
        let of = self.code[1].evaluate(&y[..n]);
        let products = self.pairs.iter().map(|[i, j]| y[n + i] * y[n + j]);
        let accelerations = q_ddot.iter().copied();
        let factors: Vec<R> = accelerations.chain(products).chain(forces).collect();
        let reaction = |k: usize| {
            let each = factors.iter().enumerate();
            each.fold(R::of(0.0), |sum, (f, factor)| sum + of[f * r + k] * *factor)
        };
        Ok((0..r).map(reaction).collect())
    }

    /// Kinetic and potential energy at a state, J.
    ///
    /// # Errors
    /// [`Status`] where the mechanism cannot be assembled.
    pub fn energies(&self, y: &[R]) -> Result<[R; 2], Status> {
        let n = self.freedoms;
        let terms = self.motion(y)?;
        let m = self.mass_matrix(&terms);
        let mut twice = R::of(0.0);
        for i in 0..n {
            for j in 0..n {
                twice = twice + m[i * n + j] * y[n + i] * y[n + j];
            }
        }
        let potentials = &terms[self.pairs.len() * (n + 1) + self.loads.len() * n..];
        let potential = Load::potential(self.loads.iter().zip(potentials));
        Ok([R::of(0.5) * twice, potential])
    }

    /// One step of the classical Runge–Kutta method of fourth order, s.
    ///
    /// # Errors
    /// [`Status`] if a stage has no rates; the state is then not changed.
    pub fn step(&self, h: R, y: &mut [R]) -> Result<(), Status> {
        let changes = runge_kutta(y, h, |y| self.rates(y))?;
        for (y, change) in y.iter_mut().zip(changes) {
            *y = *y + change;
        }
        Ok(())
    }
}

/// The solution of m x = b by m = L D Lᵀ.
fn solve<R: Real>(mut m: Vec<R>, mut b: Vec<R>) -> Result<Vec<R>, Status> {
    let n = b.len();
    for j in 0..n {
        for i in j..n {
            for k in 0..j {
                m[i * n + j] = m[i * n + j] - m[i * n + k] * m[j * n + k] * m[k * n + k];
            }
        }
        let pivot = m[j * n + j];
        let is_definite = pivot.to_f64() > 0.0;
        if !is_definite {
            return Err(Status::NoInertia);
        }
        for i in j + 1..n {
            m[i * n + j] = m[i * n + j] / pivot;
        }
    }
    for i in 0..n {
        for k in 0..i {
            b[i] = b[i] - m[i * n + k] * b[k];
        }
    }
    for i in (0..n).rev() {
        b[i] = b[i] / m[i * n + i];
        for k in i + 1..n {
            b[i] = b[i] - m[k * n + i] * b[k];
        }
    }
    Ok(b)
}
