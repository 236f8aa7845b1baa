//! The exported code of several degrees of freedom in Rust, in one kind of number.

use super::description::SeveralFreedomsDescription;
use crate::evaluator::{Status, has_rotor, scene_value};
use crate::machine::{LoadDescription, LoadEffect};
use crate::real::Real;
use crate::straight_line::StraightLine;

/// The exported code, with the parameters and inputs of the scene.
#[derive(Debug, Clone)]
pub struct SeveralFreedomsEvaluator<'a> {
    machine: &'a SeveralFreedomsDescription,
    code: &'a [StraightLine; 3],
    pairs: Vec<[usize; 2]>,
    /// By load the place of its current in the state, if it has one.
    currents: Vec<Option<usize>>,
    order: usize,
}

impl<'a> SeveralFreedomsEvaluator<'a> {
    /// Of a machine and the operations of its functions.
    pub fn new(machine: &'a SeveralFreedomsDescription, code: &'a [StraightLine; 3]) -> Self {
        let mut order = 2 * machine.freedoms();
        let currents = machine.loads.iter().map(|load| {
            let inductance = load.effect.motor().map_or(0.0, |motor| motor.inductance);
            (inductance > 0.0).then(|| {
                order += 1;
                order - 1
            })
        });
        let currents = currents.collect();
        Self {
            pairs: machine.pairs(),
            machine,
            code,
            currents,
            order,
        }
    }

    /// The numbers of a state: coordinates, velocities, currents.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The number of coordinates.
    pub fn freedoms(&self) -> usize {
        self.machine.freedoms()
    }

    /// The outputs of the motion's code at a state.
    fn motion<R: Real>(&self, y: &[R]) -> Result<Vec<R>, Status> {
        let terms = self.code[0].evaluate(&y[..self.machine.freedoms()]);
        match terms.iter().all(|term| term.to_f64().is_finite()) {
            true => Ok(terms),
            false => Err(Status::OutOfRange),
        }
    }

    /// By coordinate Σ h q̇ᵢ q̇ⱼ.
    fn velocity_terms<R: Real>(&self, terms: &[R], y: &[R]) -> Vec<R> {
        let (n, pairs) = (self.machine.freedoms(), self.pairs.len());
        let sum = |i: usize| {
            let each = self.pairs.iter().enumerate();
            each.fold(R::of(0.0), |sum, (p, [a, b])| {
                sum + terms[pairs + p * n + i] * (y[n + a] * y[n + b])
            })
        };
        (0..n).map(sum).collect()
    }

    /// The velocity of a load's line, or what its w is multiplied by.
    fn along<R: Real>(&self, terms: &[R], load: usize, of: &[R]) -> R {
        let n = self.machine.freedoms();
        let w = &terms[self.pairs.len() * (n + 1) + load * n..][..n];
        w.iter()
            .zip(of)
            .fold(R::of(0.0), |sum, (w, x)| sum + *w * *x)
    }

    /// F of each load at a state, without that of rotors.
    fn forces<R: Real>(&self, terms: &[R], y: &[R]) -> Vec<R> {
        let n = self.machine.freedoms();
        let loads = self.machine.loads.iter().enumerate();
        let force = |(k, load): (usize, &LoadDescription)| {
            let value = R::of(scene_value(&load.effect));
            let velocity = self.along(terms, k, &y[n..2 * n]);
            match &load.effect {
                LoadEffect::Conservative { .. }
                | LoadEffect::Constant { .. }
                | LoadEffect::Input { .. } => value,
                LoadEffect::Damper { .. } | LoadEffect::VariableDamper { .. } => {
                    R::of(0.0) - value * velocity
                }
                LoadEffect::Motor(motor) => {
                    let constant = R::of(motor.gear_ratio) * R::of(motor.torque_constant);
                    match self.currents[k] {
                        Some(place) => constant * y[place],
                        None => constant * (value - constant * velocity) / R::of(motor.resistance),
                    }
                }
            }
        };
        loads.map(force).collect()
    }

    /// N² J of a motor with a rotor.
    fn reflected<R: Real>(&self, load: usize) -> Option<R> {
        let effect = &self.machine.loads[load].effect;
        let motor = effect.motor().filter(|_| has_rotor(effect))?;
        let ratio = R::of(motor.gear_ratio);
        Some(ratio * ratio * R::of(motor.rotor_inertia))
    }

    /// The mass matrix with rotors, row by row.
    fn mass_matrix<R: Real>(&self, terms: &[R]) -> Vec<R> {
        let (n, first) = (self.machine.freedoms(), self.pairs.len());
        let mut m = vec![R::of(0.0); n * n];
        for (p, [i, j]) in self.pairs.iter().enumerate() {
            [m[i * n + j], m[j * n + i]] = [terms[p]; 2];
        }
        for load in 0..self.machine.loads.len() {
            let Some(reflected) = self.reflected::<R>(load) else {
                continue;
            };
            let w = &terms[first * (n + 1) + load * n..][..n];
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
    pub fn required_forces<R: Real>(&self, y: &[R], q_ddot: &[R]) -> Result<Vec<R>, Status> {
        let n = self.machine.freedoms();
        let terms = self.motion(y)?;
        let (m, forces) = (self.mass_matrix(&terms), self.forces(&terms, y));
        let mut found = self.velocity_terms(&terms, y);
        let w = &terms[self.pairs.len() * (n + 1)..];
        for i in 0..n {
            for j in 0..n {
                found[i] = found[i] + m[i * n + j] * q_ddot[j];
            }
            for (k, force) in forces.iter().enumerate() {
                found[i] = found[i] - *force * w[k * n + i];
            }
        }
        Ok(found)
    }

    /// The rates of a state: velocities, accelerations, and those of the currents.
    ///
    /// # Errors
    /// [`Status`] where the mechanism cannot be assembled, or its mass matrix is not positive definite.
    pub fn rates<R: Real>(&self, y: &[R]) -> Result<Vec<R>, Status> {
        let n = self.machine.freedoms();
        let rest = self.required_forces(y, &vec![R::of(0.0); n])?;
        let terms = self.motion(y)?;
        let right = rest.iter().map(|force| R::of(0.0) - *force).collect();
        let q_ddot = solve(self.mass_matrix(&terms), right)?;
        let mut rates = y[n..2 * n].to_vec();
        rates.extend(q_ddot);
        for (k, load) in self.machine.loads.iter().enumerate() {
            if let (Some(_), Some(motor)) = (self.currents[k], load.effect.motor()) {
                let [resistance, inductance] = [motor.resistance, motor.inductance].map(R::of);
                let constant = R::of(motor.gear_ratio) * R::of(motor.torque_constant);
                let velocity = self.along(&terms, k, &y[n..2 * n]);
                let current = y[rates.len()];
                let voltage = R::of(scene_value(&load.effect));
                rates.push((voltage - resistance * current - constant * velocity) / inductance);
            }
        }
        Ok(rates)
    }

    /// Every reaction at a state with accelerations, N or N m.
    ///
    /// # Errors
    /// [`Status`] where the mechanism cannot be assembled.
    pub fn reactions<R: Real>(&self, y: &[R], q_ddot: &[R]) -> Result<Vec<R>, Status> {
        let (n, r, p) = (
            self.machine.freedoms(),
            self.machine.reactions.len(),
            self.pairs.len(),
        );
        let terms = self.motion(y)?;
        let mut forces = self.forces(&terms, y);
        for (k, force) in forces.iter_mut().enumerate() {
            if let Some(reflected) = self.reflected::<R>(k) {
                *force = *force - reflected * self.along(&terms, k, q_ddot);
            }
        }
        let of = self.code[1].evaluate(&y[..n]);
        let products = self.pairs.iter().map(|[i, j]| y[n + i] * y[n + j]);
        let factors: Vec<R> = q_ddot
            .iter()
            .copied()
            .chain(products)
            .chain(forces)
            .collect();
        debug_assert_eq!(factors.len(), n + p + self.machine.loads.len());
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
    pub fn energies<R: Real>(&self, y: &[R]) -> Result<[R; 2], Status> {
        let n = self.machine.freedoms();
        let terms = self.motion(y)?;
        let m = self.mass_matrix(&terms);
        let mut twice = R::of(0.0);
        for i in 0..n {
            for j in 0..n {
                twice = twice + m[i * n + j] * y[n + i] * y[n + j];
            }
        }
        let first = self.pairs.len() * (n + 1) + self.machine.loads.len() * n;
        let mut potential = R::of(0.0);
        for (load, v) in self.machine.loads.iter().zip(&terms[first..]) {
            if load.effect.is_conservative() {
                potential = potential + R::of(scene_value(&load.effect)) * *v;
            }
        }
        Ok([R::of(0.5) * twice, potential])
    }

    /// One step of the classical Runge–Kutta method of fourth order, s.
    ///
    /// # Errors
    /// [`Status`] where a stage has no rates; the state is then as it was.
    pub fn step<R: Real>(&self, h: R, y: &mut [R]) -> Result<(), Status> {
        let half = R::of(0.5) * h;
        let moved = |by: R, rates: &[R]| -> Vec<R> {
            let both = y.iter().zip(rates);
            both.map(|(y, rate)| *y + by * *rate).collect()
        };
        let one = self.rates(y)?;
        let two = self.rates(&moved(half, &one))?;
        let three = self.rates(&moved(half, &two))?;
        let four = self.rates(&moved(h, &three))?;
        let sixth = h / R::of(6.0);
        for (i, y) in y.iter_mut().enumerate() {
            *y = *y + sixth * (one[i] + R::of(2.0) * (two[i] + three[i]) + four[i]);
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
        if pivot.partial_cmp(&R::of(0.0)) != Some(std::cmp::Ordering::Greater) {
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
