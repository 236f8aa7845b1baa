//! Truths 1 to 3 of a state with any number of coordinates, under loads: kinetic energy and virtual
//! work alone.
//!
//! Every row r of the dense mechanism, an actuator's or a joint's, may be given a value y_r. With u_r its
//! unit speeds, ẋ = Σ uᵢ q̇ᵢ over the actuators and E = ½ ⟨ẋ, ẋ⟩,
//!
//! ```text
//! M_ij = E(e_i + e_j) − E(e_i) − E(e_j)                                    (1)
//! E = ½ q̇ᵀ M q̇                                                            (2)
//! λ_r = d/dt ∂E/∂ẏ_r − ∂E/∂y_r − Σ power of the loads at the speeds u_r     (3)  (Lagrange)
//! ```
//!
//! ∂E/∂ẏ_r = ⟨u_r, ẋ⟩ is differenced in time along q(t) = q + q̇ t + ½ q̈ t²; ∂E/∂y_r is differenced with the
//! row really opened (or the actuator moved) and closed again. Only positions and velocities of the
//! dense side are used: no acceleration, no multiplier, no mass times acceleration. Of one freedom
//! without loads, (3) is τ = m q̈ + ½ m′ q̇² and R = a q̈ + b q̇².

use super::measured::{FIRST_TURN, Measured};
use super::{Judge, State, Tally, Words, place};
use crate::dense::Dense;
use crate::differences::{Estimate, Order, derivatives};
use dwell_findings::Finding;
use dwell_geometry::{Component, Mechanism, vec2};
use dwell_kinetostatics::Mass;
use rayon::prelude::*;

const INERTIA: Words = Words {
    key: "state-inertia",
    truth: "1 kinetic energy",
    compared: "every M_ij of unit runs with E(e_i + e_j) - E(e_i) - E(e_j), by dense velocities",
    scale: "the root of M_ii M_jj",
    tolerance: 1e-13,
    why: "sums of rounded squares, some ten roundings per body",
};
const KINETIC: Words = Words {
    key: "state-kinetic",
    truth: "1 kinetic energy",
    compared: "half q_dot M q_dot with the sum of half m v2 + half I omega2 of the claimed velocities",
    scale: "the largest kinetic energy",
    tolerance: 1e-13,
    why: INERTIA.why,
};
const ACTIONS: Words = Words {
    key: "state-lagrange",
    truth: "2 Lagrange's equations of the coordinates",
    compared: "actuator actions with d/dt dE/dq_dot - dE/dq - power of the loads at unit speed, by differences of E",
    scale: "the largest of them or of the forces they balance, moments over the size",
    tolerance: 2e-11,
    why: "rounding of E over the shortest step that the extrapolation uses",
};
const RELEASED: Words = Words {
    key: "state-released",
    truth: "3 released constraint",
    compared: "reactions with d/dt dE/dv - dE/dy - power of the loads at unit speed, each constraint opened as a coordinate y",
    scale: ACTIONS.scale,
    tolerance: 2e-11,
    why: ACTIONS.why,
};

/// Judges claimed states by kinetic energy and virtual work alone, as [`judge_states`] does by the
/// equations of motion. `inertias` are by state the claimed generalised inertias M_ij, row by row.
/// Each reaction costs some twenty closings a state.
///
/// The findings are state-inertia, state-kinetic, state-lagrange and state-released, in this order. Reactions
/// that are not determined are left out. If the mechanism is not determinate there is one failed finding.
///
/// [`judge_states`]: super::judge_states
pub fn judge_energies(
    mechanism: &Mechanism,
    masses: &[Mass],
    start: &[[f64; 3]],
    states: &[State],
    inertias: &[Vec<f64>],
) -> Vec<Finding> {
    match Dense::meshed(mechanism, masses, start) {
        Ok(dense) => {
            let judge = Judge::new(&dense, mechanism, states);
            let inertias: Vec<&[f64]> = (states.iter().enumerate())
                .map(|(k, _)| inertias.get(k).map_or(&[][..], Vec::as_slice))
                .collect();
            let mut findings = judge.inertias(states, &inertias).to_vec();
            findings.extend(judge.lagrange());
            findings
        }
        Err(error) => vec![super::not_dense(&INERTIA, error.to_string())],
    }
}

impl Judge<'_> {
    /// (1) and (2).
    fn inertias(&self, states: &[State], claimed: &[&[f64]]) -> [Finding; 2] {
        let (mut matrix, mut kinetic) = (Tally::of_each("kg m2"), Tally::new("J"));
        for m in &self.measured {
            let own = states.iter().zip(claimed);
            let of = own.filter(|(state, _)| std::ptr::eq(*state, m.state));
            let claimed = of.map(|(_, claimed)| *claimed).next().unwrap_or(&[]);
            let n = m.state.q.len();
            let at = |i: usize, j: usize| claimed.get(i * n + j).copied().unwrap_or(f64::NAN);
            let dense = m.inertias();
            let mut half = 0.0;
            for i in 0..n {
                for j in 0..n {
                    let scale = (dense[i][i] * dense[j][j]).sqrt();
                    let name = |k: usize| self.mechanism.actuators[k].name.as_str();
                    let there = format!("{}, {} {}", place(m), name(i), name(j));
                    let own = m.relative_noise() * scale;
                    matrix.read(m, at(i, j) - dense[i][j], own, scale, there);
                    half += 0.5 * m.state.q_dot[i] * at(i, j) * m.state.q_dot[j];
                }
            }
            let energy = m.claimed_energy();
            let own = m.relative_noise() * energy;
            kinetic.read(m, half - energy, own, energy, place(m));
        }
        [matrix.judge(&INERTIA, self), kinetic.judge(&KINETIC, self)]
    }

    /// (3), of the actuators and of the reactions.
    fn lagrange(&self) -> [Finding; 2] {
        let size = self.dense.size();
        let driven = self.dense.actuator_row();
        let reactions = self.mechanism.reactions();
        let (mut actions, mut released) = (Tally::new("N"), Tally::new("N"));
        let forces: Vec<_> = self.measured.par_iter().map(Measured::lagrange).collect();
        for (m, forces) in self.measured.iter().zip(forces) {
            let claimed = m.state.reactions.iter().chain(&m.state.tau);
            let brought = m.largest_force();
            for (k, (claimed, force)) in claimed.zip(forces).enumerate() {
                let Some(force) = force else { continue };
                let (moment, name) = match reactions.get(k) {
                    Some(&r) => (
                        r.component == Component::Moment,
                        self.mechanism.reaction_name(r),
                    ),
                    None => {
                        let actuator = &self.mechanism.actuators[k - driven];
                        (actuator.coordinate().is_angle(), actuator.name.clone())
                    }
                };
                let arm = if moment { 1.0 / size } else { 1.0 };
                let (value, own) = (force.value * arm, force.error * arm);
                let tally = if k < driven {
                    &mut released
                } else {
                    &mut actions
                };
                let scale = brought.max(value.abs());
                let there = format!("{}, {name}", place(m));
                tally.read(m, claimed * arm - value, own, scale, there);
            }
        }
        let mut released = released.judge(&RELEASED, self);
        let shared = self.dense.unique[..driven]
            .iter()
            .filter(|&&unique| !unique);
        match shared.count() {
            0 => {}
            n => released.over += &format!("; {n} reactions that joints share are not determined"),
        }
        [actions.judge(&ACTIONS, self), released]
    }
}

impl Measured<'_> {
    /// (1) at the state.
    fn inertias(&self) -> Vec<Vec<f64>> {
        let (dense, n) = (self.dense, self.state.q.len());
        let row = |i: usize| dense.actuator_row() + i;
        let energy = |rates: &[(usize, f64)]| dense.kinetic_energy(&self.closed, rates);
        let single: Vec<f64> = (0..n).map(|i| energy(&[(row(i), 1.0)])).collect();
        let both = |i: usize, j: usize| energy(&[(row(i), 1.0), (row(j), 1.0)]);
        let of = |i: usize, j: usize| both(i, j) - single[i] - single[j];
        (0..n).map(|i| (0..n).map(|j| of(i, j)).collect()).collect()
    }

    /// Kinetic energy of the claimed velocities, J.
    fn claimed_energy(&self) -> f64 {
        0.5 * self
            .dense
            .inertia(&self.closed, &self.claimed_dot, &self.claimed_dot)
    }

    /// (3) for every row; none for those that are not determined.
    fn lagrange(&self) -> Vec<Option<Estimate>> {
        let dense = self.dense;
        let unit_speeds = dense.unit_speeds(&self.closed);
        let rates = self.momentum_rates();
        let row = |r: usize| {
            let slope = self.energy_slope(r, &unit_speeds[r]);
            let power = self.load_power(&unit_speeds[r]);
            let rate = rates.get(r);
            Estimate {
                value: rate.map_or(f64::NAN, |rate| rate.value) - slope.value - power,
                error: rate.map_or(f64::NAN, |rate| rate.error) + slope.error,
            }
        };
        (0..unit_speeds.len())
            .map(|r| dense.unique[r].then(|| row(r)))
            .collect()
    }

    /// d/dt ⟨u_r, ẋ⟩ of every row, along the motion.
    fn momentum_rates(&self) -> Vec<Estimate> {
        let (dense, state) = (self.dense, self.state);
        let driven = dense.actuator_row();
        let rounding = self.relative_noise().max(f64::EPSILON);
        let mut imposed = self.closed.imposed.clone();
        derivatives(Order::First, self.time_step(), rounding, |t| {
            for (i, imposed) in imposed[driven..].iter_mut().enumerate() {
                *imposed = state.q[i] + t * (state.q_dot[i] + 0.5 * t * state.q_ddot[i]);
            }
            let start = &self.closed.x;
            let closed = dense.close_beside(&self.closed, start, &imposed).ok()?;
            let speeds = dense.unit_speeds(&closed);
            let mut x_dot = vec![0.0; dense.rows.columns()];
            for (i, u) in speeds[driven..].iter().enumerate() {
                let rate = state.q_dot[i] + t * state.q_ddot[i];
                x_dot.iter_mut().zip(u).for_each(|(v, u)| *v += u * rate);
            }
            Some(
                speeds
                    .iter()
                    .map(|u| dense.inertia(&closed, u, &x_dot))
                    .collect(),
            )
        })
    }

    /// ∂E/∂y of a row with the unit speeds `u`, at the speeds of the actuators.
    fn energy_slope(&self, row: usize, u: &[f64]) -> Estimate {
        let (dense, state) = (self.dense, self.state);
        let none = |value| Estimate { value, error: 0.0 };
        if state.q_dot.iter().all(|&rate| rate == 0.0) {
            return none(0.0);
        }
        let driven = dense.actuator_row();
        let rates: Vec<_> = (driven..).zip(state.q_dot.iter().copied()).collect();
        let rounding = self.relative_noise().max(f64::EPSILON);
        let slopes = derivatives(Order::First, FIRST_TURN / dense.reach(u), rounding, |h| {
            let value = self.closed.imposed[row] + h;
            let opened = dense.step(&self.closed, row, u, value).ok()?;
            Some(vec![dense.kinetic_energy(&opened, &rates)])
        });
        slopes.first().copied().unwrap_or(none(f64::NAN))
    }

    /// What the loads do at the speeds `u`, W.
    fn load_power(&self, u: &[f64]) -> f64 {
        let power = |load: &crate::acts::Act| {
            self.dense.bodies[load.body].column.map_or(0.0, |c| {
                let origin = vec2(self.closed.x[c], self.closed.x[c + 1]);
                load.force.dot(vec2(u[c], u[c + 1])) + load.moment(origin) * u[c + 2]
            })
        };
        self.loads.iter().map(power).sum()
    }
}
