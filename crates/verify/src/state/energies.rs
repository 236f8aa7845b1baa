//! Checks 1 to 3 of a state with any number of coordinates, under loads: kinetic energy and virtual
//! work alone.
//!
//! Every row r of the dense mechanism, an actuator's or a joint's, may be given a value y_r. With u_r its
//! unit velocities, ẋ = Σ uᵢ q̇ᵢ over the actuators and E = ½ ⟨ẋ, ẋ⟩,
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

use super::dense_state::DenseState;
use super::{AssembledMechanism, ClaimedState, StateChecker};
use crate::checks::MAX_DIFFERENCE_STEP;
use crate::comparison::{ComparisonSet, FindingSpec};
use crate::dense::add_scaled;
use crate::differences::{DerivativeOrder, Extrapolated, NO_ESTIMATE, derivatives, slope};
use crate::wrenches::BodyWrench;
use dwell_findings::{Check, Finding};
use rayon::prelude::*;

const MASS_MATRIX: FindingSpec<'_> = FindingSpec {
    key: "state-mass-matrix",
    check: Check::KineticEnergy,
    comparison: "every M_ij of unit runs with E(e_i + e_j) - E(e_i) - E(e_j), by dense velocities",
    scale: "the root of M_ii M_jj",
    tolerance: 1e-13,
    tolerance_reason: "sums of rounded squares, some ten roundings per body",
};
const KINETIC_ENERGY: FindingSpec<'_> = FindingSpec {
    key: "state-kinetic-energy",
    comparison: "half q_dot M q_dot with the sum of half m v2 + half I omega2 of the claimed velocities",
    scale: "the largest kinetic energy",
    ..MASS_MATRIX
};
const LAGRANGE: FindingSpec<'_> = FindingSpec {
    key: "state-lagrange",
    check: Check::EnergySlope,
    comparison: "actuator forces with d/dt dE/dq_dot - dE/dq - power of the loads at unit velocity, by differences of E",
    scale: "the largest of them or of the forces they balance, moments over the size",
    tolerance: 2e-11,
    tolerance_reason: "rounding of E over the shortest step that the extrapolation uses",
};
const RELEASED: FindingSpec<'_> = FindingSpec {
    key: "state-released",
    check: Check::ReleasedConstraint,
    comparison: "reactions with d/dt dE/dv - dE/dy - power of the loads at unit velocity, each constraint opened as a coordinate y",
    ..LAGRANGE
};

const ENERGY_RATE: FindingSpec<'_> = FindingSpec {
    key: "state-energy-rate",
    check: Check::EnergySlope,
    comparison: "the claimed power of actuators and loads, and q_dot M q_ddot of the claimed inertias, with rates of the kinetic energy, differenced along the motion",
    scale: "the sum of |force| |velocity| of the state, or the largest force at the largest speed within a step",
    ..LAGRANGE
};

/// Checks claimed states by kinetic energy and virtual work alone, while [`check_states`] uses the equations of motion. Each reaction needs
/// about twenty closings for each state.
///
/// The findings are state-inertia, state-kinetic, state-lagrange and state-released, in this order. Reactions that are not determined are
/// omitted, and so is state-released if none is determined. If the mechanism is not determinate there is one failed finding.
///
/// [`check_states`]: super::check_states
pub fn check_energies(assembled: &AssembledMechanism<'_>, states: &[ClaimedState]) -> Vec<Finding> {
    match assembled.dense() {
        Ok(dense) => StateChecker::new(&dense, states).by_energies(),
        Err(error) => vec![super::not_dense(&MASS_MATRIX, &error)],
    }
}

impl StateChecker<'_> {
    pub(super) fn by_energies(&self) -> Vec<Finding> {
        let mut findings = self.energies().to_vec();
        findings.extend(self.lagrange());
        findings
    }

    /// (1) and (2).
    fn energies(&self) -> [Finding; 2] {
        let mut matrix = ComparisonSet::with_individual_scales();
        let mut kinetic = ComparisonSet::default();
        for m in &self.dense_states {
            let n = m.state.q.len();
            let at = |i: usize, j: usize| m.inertia(i * n + j);
            let dense = m.mass_matrix();
            let mut half = 0.0;
            for i in 0..n {
                for j in 0..n {
                    let scale = (dense[i][i] * dense[j][j]).sqrt();
                    let [one, other] = [i, j].map(|k| &self.dense.actuator_names()[k]);
                    let error = m.relative_rounding_bound() * scale;
                    let numbers = [at(i, j) - dense[i][j], scale, error];
                    m.compare(&mut matrix, numbers, "kg m2", &format!("{one} {other}"));
                    half += 0.5 * m.state.q_dot[i] * at(i, j) * m.state.q_dot[j];
                }
            }
            let energy = m.claimed_energy();
            let error = m.relative_rounding_bound() * energy;
            m.compare(&mut kinetic, [half - energy, energy, error], "J", "");
        }
        [
            self.finding(&MASS_MATRIX, matrix),
            self.finding(&KINETIC_ENERGY, kinetic),
        ]
    }

    /// With D₁ the rate of E along the motion, and D₂ that of E at the speeds of the state throughout: Σ τ q̇ + P = D₁, and q̇ᵀ M q̈ = D₁ − D₂. Of claims
    /// with the power P of the loads.
    pub(super) fn energy_rates(&self) -> Finding {
        let mut comparisons = ComparisonSet::with_individual_scales();
        let states = self.dense_states.par_iter();
        let rates: Vec<_> = states.map(DenseState::energy_rates).collect();
        for (m, [moving, steady]) in self.dense_states.iter().zip(rates) {
            let ClaimedState {
                q_dot, q_ddot, tau, ..
            } = m.state;
            let n = q_dot.len();
            let [_, _, terms] = m.power_balance();
            let scale = terms.max(m.largest_power());
            let supplied: f64 = tau.iter().zip(q_dot).map(|(tau, rate)| tau * rate).sum();
            if let Some(of_loads) = m.state.load_power {
                let numbers = [supplied + of_loads - moving.value, scale, moving.error];
                m.compare(&mut comparisons, numbers, "W", "power");
            }
            let product = (0..n * n).map(|k| q_dot[k / n] * m.inertia(k) * q_ddot[k % n]);
            let difference = product.sum::<f64>() - (moving.value - steady.value);
            let numbers = [difference, scale, moving.error + steady.error];
            m.compare(&mut comparisons, numbers, "W", "inertias");
        }
        self.finding(&ENERGY_RATE, comparisons)
    }

    /// (3), of the actuators and of the rows of the joints.
    fn lagrange(&self) -> Vec<Finding> {
        let actuator_row = self.dense.actuator_row();
        let rows = self.rows();
        let [mut of_actuators, mut released] = [(); 2].map(|()| ComparisonSet::default());
        let states = self.dense_states.par_iter();
        let forces: Vec<_> = states.map(DenseState::lagrange).collect();
        for (m, forces) in self.dense_states.iter().zip(forces) {
            let largest_force = m.largest_force();
            let claimed = m.claimed_multipliers();
            for (k, ((claimed, force), (arm, name))) in
                claimed.into_iter().zip(forces).zip(&rows).enumerate()
            {
                let (Some(claimed), Some(force)) = (claimed, force) else {
                    continue;
                };
                let (value, error) = (force.value * arm, force.error * arm);
                let numbers = [claimed * arm - value, largest_force.max(value.abs()), error];
                let set = if k < actuator_row {
                    &mut released
                } else {
                    &mut of_actuators
                };
                m.compare(set, numbers, "N", name);
            }
        }
        let determinate = self.dense.determinate[..actuator_row].iter();
        let indeterminate = determinate.filter(|&&is| !is).count();
        let mut findings = vec![self.finding(&LAGRANGE, of_actuators)];
        // Teeth in space are rows of velocities: with another constraint open, there is no coordinate of theirs to differentiate by.
        if indeterminate == actuator_row && actuator_row > 0 || self.dense.rows.has_teeth_in_space()
        {
            return findings;
        }
        let mut released = self.finding(&RELEASED, released);
        if indeterminate > 0 {
            released.domain +=
                &format!("; {indeterminate} reactions that joints share are not determined");
        }
        findings.push(released);
        findings
    }
}

impl DenseState<'_> {
    /// By row, those of the actuators last: the claimed multiplier. For a joint whose reactions are components of force and moment, their
    /// power if the row opens at unit speed. `None` for rows that belong to no joint.
    fn claimed_multipliers(&self) -> Vec<Option<f64>> {
        let (dense, state) = (self.dense, self.state);
        let mut all = vec![None; dense.rows.len()];
        for joint in &dense.joints {
            let claimed = &state.reactions[joint.reactions.clone()];
            if !joint.is_wrench {
                let rows = joint.rows.clone().zip(claimed);
                rows.for_each(|(row, claimed)| all[row] = Some(*claimed));
                continue;
            }
            for row in joint.rows.clone() {
                all[row] = Some(self.power_of(joint, &self.unit_velocities[row]));
            }
        }
        let actuators = (dense.actuator_row()..).zip(&state.tau);
        actuators.for_each(|(row, tau)| all[row] = Some(*tau));
        all
    }

    /// One of the claimed generalised inertias; NaN if none is claimed.
    fn inertia(&self, k: usize) -> f64 {
        self.state.inertias.get(k).copied().unwrap_or(f64::NAN)
    }

    /// (1) at the state.
    fn mass_matrix(&self) -> Vec<Vec<f64>> {
        let (dense, n) = (self.dense, self.state.q.len());
        let row = |i: usize| dense.actuator_row() + i;
        let energy = |rates: &[(usize, f64)]| dense.kinetic_energy(&self.configuration, rates);
        let single: Vec<f64> = (0..n).map(|i| energy(&[(row(i), 1.0)])).collect();
        let both = |i: usize, j: usize| energy(&[(row(i), 1.0), (row(j), 1.0)]);
        let of = |i: usize, j: usize| both(i, j) - single[i] - single[j];
        (0..n).map(|i| (0..n).map(|j| of(i, j)).collect()).collect()
    }

    /// Kinetic energy of the claimed velocities, J.
    fn claimed_energy(&self) -> f64 {
        let v = &self.claimed_dot;
        0.5 * self.dense.inertia(&self.configuration, v, v)
    }

    /// (3) for every row; `None` for rows that are not determined.
    fn lagrange(&self) -> Vec<Option<Extrapolated>> {
        let dense = self.dense;
        let unit_velocities = &self.unit_velocities;
        let rates = self.momentum_rates();
        let row = |r: usize| {
            let slope = self.energy_slope(r, &unit_velocities[r]);
            let power = self.load_power(&unit_velocities[r]);
            let rate = rates.get(r).copied().unwrap_or(NO_ESTIMATE);
            Extrapolated {
                value: rate.value - slope.value - power,
                error: rate.error + slope.error,
            }
        };
        let rows = 0..unit_velocities.len();
        rows.map(|r| dense.determinate[r].then(|| row(r))).collect()
    }

    /// d/dt ⟨u_r, ẋ⟩ of every row, along the motion.
    fn momentum_rates(&self) -> Vec<Extrapolated> {
        let (dense, state) = (self.dense, self.state);
        let actuator_row = dense.actuator_row();
        let rounding = self.relative_rounding_bound().max(f64::EPSILON);
        let mut row_values = self.configuration.row_values.clone();
        derivatives(DerivativeOrder::First, self.time_step(), rounding, |t| {
            self.coordinates_at(t, &mut row_values[actuator_row..]);
            let from = &self.configuration;
            let configuration = dense.close_on_branch(from, &from.poses, &row_values).ok()?;
            let velocities = dense.unit_velocities(&configuration);
            let mut x_dot = vec![0.0; dense.rows.columns()];
            for (i, u) in velocities[actuator_row..].iter().enumerate() {
                let rate = state.q_dot[i] + t * state.q_ddot[i];
                add_scaled(&mut x_dot, rate, u);
            }
            let momentum = |u: &Vec<f64>| dense.inertia(&configuration, u, &x_dot);
            Some(velocities.iter().map(momentum).collect())
        })
    }

    /// The rates of E along the motion: with its speeds, and with those of the state throughout.
    fn energy_rates(&self) -> [Extrapolated; 2] {
        let (dense, state) = (self.dense, self.state);
        let actuator_row = dense.actuator_row();
        let rounding = self.relative_rounding_bound().max(f64::EPSILON);
        let mut row_values = self.configuration.row_values.clone();
        let (from, order) = (&self.configuration, DerivativeOrder::First);
        let rates = derivatives(order, self.time_step(), rounding, |t| {
            self.coordinates_at(t, &mut row_values[actuator_row..]);
            let at = dense.close_on_branch(from, &from.poses, &row_values).ok()?;
            let mut speeds = [(); 2].map(|()| vec![0.0; dense.rows.columns()]);
            for i in 0..state.q.len() {
                let u = dense.unit_velocity(&at, actuator_row + i);
                let steady = state.q_dot[i];
                for (speeds, rate) in speeds
                    .iter_mut()
                    .zip([steady + t * state.q_ddot[i], steady])
                {
                    add_scaled(speeds, rate, &u);
                }
            }
            Some(speeds.map(|v| 0.5 * dense.inertia(&at, &v, &v)).to_vec())
        });
        [0, 1].map(|k| rates.get(k).copied().unwrap_or(NO_ESTIMATE))
    }

    /// ∂E/∂y of a row with the unit velocities `u`, at the velocities of the actuators.
    fn energy_slope(&self, row: usize, u: &[f64]) -> Extrapolated {
        let (dense, state) = (self.dense, self.state);
        let none = |value| Extrapolated { value, error: 0.0 };
        if state.q_dot.iter().all(|&rate| rate == 0.0) {
            return none(0.0);
        }
        let actuator_row = dense.actuator_row();
        let rates: Vec<_> = (actuator_row..).zip(state.q_dot.iter().copied()).collect();
        let rounding = self.relative_rounding_bound().max(f64::EPSILON);
        let step = MAX_DIFFERENCE_STEP / dense.scaled_norm(u);
        let slope = slope(step, rounding, |h| {
            let value = self.configuration.row_values[row] + h;
            let opened = dense.step_row(&self.configuration, row, u, value).ok()?;
            Some(dense.kinetic_energy(&opened, &rates))
        });
        slope.unwrap_or(none(f64::NAN))
    }

    /// The power of the loads at the velocities `u`, W.
    fn load_power(&self, u: &[f64]) -> f64 {
        let power = |load: &BodyWrench| {
            let body = load.body.0;
            let twist = self.dense.bodies[body].columns.twist(u);
            twist.power(&load.about(self.configuration.poses[body].position))
        };
        self.load_wrenches.iter().map(power).sum()
    }
}
