//! Claimed states by differences: of the inertias over the coordinates, and of positions along the motion.
//!
//! ```text
//! τ + Q = M q̈ + Ṁ q̇ − ½ ∂(q̇ᵀ M q̇)/∂q,     τ·q̇ + P = d/dt ½ q̇ᵀ M q̇                                       (1)
//! F = d/dt m ċ,     M = dL/dt,     L = R I Rᵀ ω,     ω̂ = Ṙ Rᵀ        along q(t) = q + q̇ t + ½ q̈ t²       (2)
//! ```

use super::balances::power;
use super::state::{DenseState, SpaceCase, SpaceChecker, SpaceState};
use crate::comparison::{ComparisonSet, FindingSpec};
use crate::subject::SubjectError;
use dwell_findings::{Check, Finding};
use dwell_geometry::BodyId;
use dwell_geometry::space::{Placement, Vec3};

const LAGRANGE: FindingSpec<'_> = FindingSpec {
    key: "state-lagrange",
    check: Check::EnergySlope,
    comparison: "actuators' actions with Lagrange's equations, by differences of the inertias",
    scale: "the sum of absolute terms, or the largest force on a body at the size",
    // The largest seen in a case is 1.3e-10.
    tolerance: 1e-8,
    tolerance_reason: "differences of the fourth order",
};
const ENERGY_RATE: FindingSpec<'_> = FindingSpec {
    key: "state-energy-rate",
    comparison: "the power of actuators and loads with the rate of the kinetic energy, by differences of the inertias",
    ..LAGRANGE
};
const NEWTON_EULER: FindingSpec<'_> = FindingSpec {
    key: "state-newton-euler-differences",
    check: Check::NewtonEuler,
    comparison: "forces and moments on each body with the rates of its momenta, differenced from positions",
    scale: "the largest sum of absolute terms on a body, moments over the size, or a thousandth of what the motion makes of the whole mass",
    // The largest seen in a case is 5.9e-10.
    tolerance: 5e-8,
    tolerance_reason: "second differences of positions, of the fourth order",
};

/// The step of the differences of M, in rad or sizes of the mechanism.
const INERTIA_STEP: f64 = 5e-4;
/// The step of the differences of positions, in rad or sizes of the mechanism that the fastest coordinate or body moves.
const POSITION_STEP: f64 = 2e-3;
/// Steps on each side: two of the second differences beyond two of the first.
const REACH: usize = 4;

/// The first derivative at the middle of five equally spaced values, of the fourth order in their distance.
fn derivative(of: impl Fn(usize) -> Vec3, middle: usize, step: f64) -> Vec3 {
    let near = of(middle + 1) - of(middle - 1);
    let far = of(middle + 2) - of(middle - 2);
    (near.scaled(8.0) - far).scaled(1.0 / (12.0 * step))
}

impl DenseState<'_> {
    /// The generalised forces of the loads: their power at unit speed of each actuator, with the sum of absolute terms; none without a
    /// dense solution.
    fn generalised_loads(&self) -> Option<Vec<[f64; 2]>> {
        let (closed, dense) = self.solved.as_ref().ok()?;
        let mut forces = vec![[0.0; 2]; closed.unit.len()];
        for wrenches in self.load_wrenches(&dense.motions) {
            for ([force, size], unit) in forces.iter_mut().zip(&closed.unit) {
                for (wrench, motion) in wrenches.iter().zip(unit) {
                    let power = power(wrench, motion);
                    *force += power;
                    *size += power.abs();
                }
            }
        }
        Some(forces)
    }
}

impl SpaceChecker<'_> {
    /// ∂M/∂q_k at a state.
    fn inertia_slope(&self, state: &SpaceState, k: usize) -> Result<Vec<f64>, SubjectError> {
        let step = INERTIA_STEP * self.case.unit(k);
        let at = |steps: f64| {
            let mut q = state.q.clone();
            q[k] += steps * step;
            self.subject.inertias(&q)
        };
        let [far_before, before, after, far_after] = [at(-2.0)?, at(-1.0)?, at(1.0)?, at(2.0)?];
        let of = |i: usize| {
            let near = after[i] - before[i];
            (8.0 * near - (far_after[i] - far_before[i])) / (12.0 * step)
        };
        Ok((0..after.len()).map(of).collect())
    }

    /// (1).
    pub(super) fn by_inertias(&self) -> [Finding; 2] {
        let [mut lagrange, mut rates] = [(); 2].map(|()| ComparisonSet::with_individual_scales());
        let mut failure = None;
        for state in &self.states {
            let SpaceState {
                q_dot,
                q_ddot,
                tau,
                inertias,
                load_power,
                ..
            } = state.claimed;
            let n = q_dot.len();
            let slopes = (0..n).map(|k| self.inertia_slope(state.claimed, k));
            let slopes = match slopes.collect::<Result<Vec<_>, _>>() {
                Ok(slopes) => slopes,
                Err(error) => {
                    failure = Some(error.to_string());
                    continue;
                }
            };
            let Some(loads) = state.generalised_loads() else {
                continue;
            };
            let (mut rate, mut supplied, mut scale_of_rate) = (0.0, *load_power, load_power.abs());
            for k in 0..n {
                let (mut wanted, mut scale) = (0.0, tau[k].abs() + loads[k][1]);
                let mut add = |part: f64| {
                    wanted += part;
                    scale += part.abs();
                };
                for j in 0..n {
                    add(inertias[k * n + j] * q_ddot[j]);
                    for i in 0..n {
                        let turning = slopes[j][k * n + i] - 0.5 * slopes[k][i * n + j];
                        add(turning * q_dot[i] * q_dot[j]);
                    }
                }
                let error = tau[k] + loads[k][0] - wanted;
                let name = &self.case.mechanism.actuators[k].name;
                let scale = scale.max(state.largest_force() * self.case.lever(k));
                state.compare(&mut lagrange, [error, scale], "N m", name);
                rate += wanted * q_dot[k];
                supplied += tau[k] * q_dot[k];
                scale_of_rate += scale * q_dot[k].abs();
            }
            let numbers = [supplied - rate, scale_of_rate.max(state.largest_power())];
            state.compare(&mut rates, numbers, "W", "all bodies");
        }
        [
            self.finding(&LAGRANGE, lagrange, failure.clone()),
            self.finding(&ENERGY_RATE, rates, failure),
        ]
    }

    /// (2). A state at rest shows no momentum, but its acceleration does.
    pub(super) fn newton_euler_by_differences(&self) -> Finding {
        let mut set = ComparisonSet::with_individual_scales();
        let mut failure = None;
        for state in &self.states {
            match self.placements_along(state.claimed) {
                Ok((poses, step)) => {
                    let rates = |body: usize| momentum_rates(self.case, &poses, body, step);
                    state.add_balances(rates, &mut set);
                }
                Err(error) => failure = Some(error.to_string()),
            }
        }
        self.finding(&NEWTON_EULER, set, failure)
    }

    /// The placements at successive times around a state, and the time between them, s.
    fn placements_along(
        &self,
        state: &SpaceState,
    ) -> Result<(Vec<Vec<Placement>>, f64), SubjectError> {
        let fastest = |of: &[f64]| {
            let parts = of.iter().enumerate();
            let parts = parts.map(|(k, v)| v.abs() / self.case.unit(k));
            parts.fold(0.0, f64::max)
        };
        let coordinates = fastest(&state.q_dot).max(fastest(&state.q_ddot).sqrt());
        // A screw may turn much faster than its coordinate.
        let pace = state.motions.iter().fold(coordinates, |max, m| {
            max.max(m.angular_velocity.norm())
                .max(m.angular_acceleration.norm().sqrt())
        });
        let is_moving = pace > 0.0 && pace.is_finite();
        let step = POSITION_STEP / if is_moving { pace } else { 1.0 };
        let at = |k: usize| {
            let t = step * (k as f64 - REACH as f64);
            let parts = state.q.iter().zip(&state.q_dot).zip(&state.q_ddot);
            let q: Vec<f64> = parts.map(|((q, v), a)| q + t * (v + 0.5 * t * a)).collect();
            self.subject.placements(&q)
        };
        let poses: Result<Vec<_>, _> = (0..=2 * REACH).map(at).collect();
        Ok((poses?, step))
    }
}

/// The rates of momentum and of angular momentum about the centre in the middle of successive placements.
fn momentum_rates(
    case: &SpaceCase<'_>,
    poses: &[Vec<Placement>],
    body: usize,
    step: f64,
) -> [Vec3; 2] {
    let around = REACH - 2..=REACH + 2;
    let all: Vec<[Vec3; 2]> = around
        .map(|at| momenta(case, poses, body, (at, step)))
        .collect();
    [0, 1].map(|k| derivative(|i| all[i][k], 2, step))
}

/// Momentum and angular momentum about the centre that successive placements show.
fn momenta(
    case: &SpaceCase<'_>,
    poses: &[Vec<Placement>],
    body: usize,
    (at, step): (usize, f64),
) -> [Vec3; 2] {
    let mass = &case.masses[body];
    let center = |k: usize| {
        let Placement { position, rotation } = poses[k][body];
        position + rotation.apply(mass.center)
    };
    let velocity = derivative(center, at, step);
    let rotation = poses[at][body].rotation;
    // ω = ½ Σ u × u̇ over the body's axes.
    let mut omega = Vec3::ZERO;
    for (axis, along) in Vec3::AXES.iter().zip(rotation.columns) {
        let rate = derivative(|k| poses[k][body].rotation.apply(*axis), at, step);
        omega += along.cross(rate).scaled(0.5);
    }
    // How a body stands about the line of its two balls is nobody's: there its rotation is none.
    for idle in case.idle.iter().filter(|idle| idle.body == BodyId(body)) {
        let line = rotation.apply(idle.axis);
        omega -= line.scaled(line.dot(omega));
    }
    let angular = rotation.apply(mass.angular_momentum(rotation.apply_inverse(omega)));
    [velocity.scaled(mass.mass), angular]
}
