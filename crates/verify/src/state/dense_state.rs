//! One state closed densely, with all that it is compared with.

use super::ClaimedState;
use crate::checks::MAX_DIFFERENCE_STEP;
use crate::comparison::{Comparison, ComparisonSet};
use crate::constraint_closing::Configuration;
use crate::dense::{DenseBody, DenseMechanism, add_scaled};
use crate::differences::Extrapolated;
use crate::error::Result;
use crate::wrenches::{BodyWrench, NetWrench};
use dwell_geometry::{BodyId, Vec2, vec2};

/// A state with its dense solution.
pub(super) struct DenseState<'a> {
    pub(super) dense: &'a DenseMechanism,
    pub(super) state: &'a ClaimedState,
    pub(super) configuration: Configuration,
    /// How far closing moved the claimed poses, relative to the largest coordinate in them.
    pub(super) closing_correction: f64,
    /// The dense solution, and how much rounding may have moved it.
    pub(super) solution: DenseSolution,
    pub(super) bounds: DenseSolution,
    /// The claimed velocities and accelerations of the moved frames.
    pub(super) claimed_dot: Vec<f64>,
    pub(super) claimed_ddot: Vec<f64>,
    pub(super) pose_rounding_bound: f64,
    pub(super) condition_number: f64,
    pub(super) load_wrenches: Vec<BodyWrench>,
    joint_wrenches: Vec<BodyWrench>,
}

/// Velocities and accelerations of the moved frames, and the multipliers: reactions, then actuator forces.
pub(super) struct DenseSolution {
    pub(super) x_dot: Vec<f64>,
    pub(super) x_ddot: Vec<f64>,
    pub(super) multipliers: Vec<f64>,
}

impl DenseSolution {
    fn new(
        dense: &DenseMechanism,
        state: &ClaimedState,
        at: &Configuration,
        unit_velocities: &[Vec<f64>],
        loads: &[BodyWrench],
    ) -> Result<Self> {
        let actuator_row = dense.actuator_row();
        let mut x_dot = vec![0.0; dense.rows.columns()];
        for (u, rate) in unit_velocities[actuator_row..].iter().zip(&state.q_dot) {
            add_scaled(&mut x_dot, *rate, u);
        }
        let mut rates = vec![0.0; dense.rows.len()];
        rates[actuator_row..].copy_from_slice(&state.q_ddot);
        let x_ddot = dense.acceleration(at, &x_dot, &rates);
        // M ẍ + h − f: what the joints and actuators have to exert.
        let inertia = inertia_wrenches(dense, at, &x_dot, &x_ddot);
        let mut forces = vec![0.0; dense.rows.columns()];
        dense.add_wrenches(&at.x, inertia.iter().chain(loads), -1.0, &mut forces);
        Ok(Self {
            multipliers: dense.multipliers(at, &forces)?,
            x_dot,
            x_ddot,
        })
    }

    fn flat(&self) -> Vec<f64> {
        [&self.x_dot[..], &self.x_ddot, &self.multipliers].concat()
    }
}

/// The inertia forces −m a_G and couples −I α of all moving bodies.
fn inertia_wrenches(
    dense: &DenseMechanism,
    at: &Configuration,
    x_dot: &[f64],
    x_ddot: &[f64],
) -> Vec<BodyWrench> {
    let wrench = |(b, body, c): (usize, &DenseBody, usize)| BodyWrench {
        body: BodyId(b),
        force: -(dense.center_acceleration(body, at, x_dot, x_ddot) * body.mass.mass),
        point: dense.center(body, at),
        couple: -body.inertia_moment(at.x[c + 2], x_dot[c + 2], x_ddot[c + 2]),
    };
    dense.moving_bodies().map(wrench).collect()
}

impl<'a> DenseState<'a> {
    /// A state that has passed [`check_counts`].
    pub(super) fn new(dense: &'a DenseMechanism, state: &'a ClaimedState) -> Result<Self> {
        let (configuration, closing_correction) = dense.close_at(&state.poses, &state.q)?;
        dense.check_redundant_rows(&configuration)?;
        let loads = dense.shifted_wrenches(&state.load_wrenches);
        let velocities = dense.unit_velocities(&configuration);
        let solution = DenseSolution::new(dense, state, &configuration, &velocities, &loads)?;
        let exact = solution.flat();
        let bounds = dense.rounding_bounds(&configuration, &velocities, &exact, |perturbed| {
            let velocities = dense.unit_velocities(perturbed);
            Ok(DenseSolution::new(dense, state, perturbed, &velocities, &loads)?.flat())
        });
        let (bounds, pose_rounding_bound) = bounds?;
        let n = dense.rows.columns();
        Ok(Self {
            closing_correction,
            joint_wrenches: dense.joint_wrenches(&configuration, &state.reactions, &state.tau),
            dense,
            state,
            condition_number: dense.condition_number(&configuration.x),
            configuration,
            solution,
            claimed_dot: dense.velocities(&state.poses, &state.velocities),
            claimed_ddot: shifted_accelerations(dense, state),
            pose_rounding_bound,
            bounds: DenseSolution {
                x_dot: bounds[..n].to_vec(),
                x_ddot: bounds[n..2 * n].to_vec(),
                multipliers: bounds[2 * n..].to_vec(),
            },
            load_wrenches: loads,
        })
    }

    /// One comparison in the state: the difference, what the scale is at least, and the error of the reference. `what`
    /// names the quantity after the state; empty where there is only one.
    pub(super) fn compare(
        &self,
        set: &mut ComparisonSet,
        numbers: [f64; 3],
        unit: &'static str,
        what: &str,
    ) {
        let separator = if what.is_empty() { "" } else { ", " };
        let location = format!("t = {} s{separator}{what}", self.state.t);
        let comparison = Comparison::new(numbers, unit, self.condition_number);
        set.add(comparison, location);
    }

    /// How much rounding may have moved the dense motion, relative to it.
    pub(super) fn relative_rounding_bound(&self) -> f64 {
        let of = |bound: &[f64], value: &[f64]| {
            let [bound, value] = [bound, value].map(|v| self.dense.scaled_norm(v));
            if bound == 0.0 { 0.0 } else { bound / value }
        };
        self.pose_rounding_bound
            .max(of(&self.bounds.x_dot, &self.solution.x_dot))
            .max(of(&self.bounds.x_ddot, &self.solution.x_ddot))
    }

    /// The largest force of inertia or of a load, moments over the size: what reactions are
    /// relative to where they all vanish.
    pub(super) fn largest_force(&self) -> f64 {
        let size = self.dense.size();
        let loads = self.load_wrenches.iter();
        let loads = loads.map(|l| l.force.norm().max(l.couple.abs() / size));
        let inertia = self.dense.moving_bodies().map(|(body, ..)| {
            let [x, y, moment] = self.inertia_forces(body);
            x.hypot(y).max(moment.abs() / size)
        });
        loads.chain(inertia).fold(0.0, f64::max)
    }

    /// Everything that acts on a body.
    pub(super) fn net_wrench(&self, body: usize) -> NetWrench {
        let body_at = &self.dense.bodies[body];
        let center = self.dense.center(body_at, &self.configuration);
        let all = self.joint_wrenches.iter().chain(&self.load_wrenches);
        NetWrench::of(all.filter(|a| a.body.0 == body), center)
    }

    /// m a_G and I α with the claimed motion.
    pub(super) fn inertia_forces(&self, body: usize) -> [f64; 3] {
        let (dense, of) = (self.dense, &self.dense.bodies[body]);
        let (u, a) = (&self.claimed_dot, &self.claimed_ddot);
        let acceleration = dense.center_acceleration(of, &self.configuration, u, a);
        let force = acceleration * of.mass.mass;
        let x = &self.configuration.x;
        let moment = |c: usize| of.inertia_moment(x[c + 2], u[c + 2], a[c + 2]);
        [force.x, force.y, of.column.map_or(0.0, moment)]
    }

    /// Of a varying moment of inertia: its value, and ½ I′ ω² with the claimed motion.
    pub(super) fn varying_inertia(&self, body: usize) -> [f64; 2] {
        let of = &self.dense.bodies[body];
        of.column.map_or([0.0; 2], |c| {
            let (angle, omega) = (self.configuration.x[c + 2], self.claimed_dot[c + 2]);
            let inertia = of.angular_inertia(angle) - of.mass.inertia;
            [inertia, of.varying_moment(angle, omega, 0.0)]
        })
    }

    /// Second derivatives in time of every moving body's centre of mass and angle, from positions
    /// alone. Newton's method starts from the state itself, not where its speeds would lead.
    pub(super) fn second_differences(&self) -> Vec<Extrapolated> {
        self.dense.second_differences(
            &self.configuration,
            self.time_step(),
            self.pose_rounding_bound.max(f64::EPSILON),
            |t, q| self.coordinates_at(t, q),
        )
    }

    /// q + q̇ t + ½ q̈ t² of every actuator.
    pub(super) fn coordinates_at(&self, t: f64, q: &mut [f64]) {
        let s = self.state;
        for (i, q) in q.iter_mut().enumerate() {
            *q = s.q[i] + t * (s.q_dot[i] + 0.5 * t * s.q_ddot[i]);
        }
    }

    /// t with v t + ½ a t² = the longest step; a second where nothing moves.
    pub(super) fn time_step(&self) -> f64 {
        let DenseSolution { x_dot, x_ddot, .. } = &self.solution;
        let [v, a] = [x_dot, x_ddot].map(|x| self.dense.scaled_norm(x));
        let step = 2.0 * MAX_DIFFERENCE_STEP / (v + (v * v + 2.0 * a * MAX_DIFFERENCE_STEP).sqrt());
        if step.is_finite() { step } else { 1.0 }
    }

    /// Power of actuators and loads less the rate of the kinetic energy, and the sum of what its
    /// terms could be, |F| |v|, W: a force across its velocity is rounded as if it were along it.
    pub(super) fn power_balance(&self) -> (f64, f64) {
        let (mut sum, mut terms) = (0.0, 0.0);
        let mut add = |power: f64, max: f64| {
            sum += power;
            terms += max;
        };
        for (tau, rate) in self.state.tau.iter().zip(&self.state.q_dot) {
            add(tau * rate, (tau * rate).abs());
        }
        let (at, solution) = (&self.configuration, &self.solution);
        let (u, a) = (&solution.x_dot, &solution.x_ddot);
        for load in &self.load_wrenches {
            if let Some(c) = self.dense.bodies[load.body.0].column {
                let arm = load.point - vec2(at.x[c], at.x[c + 1]);
                let v = vec2(u[c], u[c + 1]);
                add(load.force.dot(v), load.force.norm() * v.norm());
                let max = (u[c + 2] * arm.norm() * load.force.norm()).abs();
                add(u[c + 2] * arm.cross(load.force), max);
                add(u[c + 2] * load.couple, (u[c + 2] * load.couple).abs());
            }
        }
        for (_, body, c) in self.dense.moving_bodies() {
            let v = self.dense.center_velocity(body, at, u);
            let force = self.dense.center_acceleration(body, at, u, a) * body.mass.mass;
            let moment = body.inertia_moment(at.x[c + 2], u[c + 2], a[c + 2]);
            let angular_power = u[c + 2] * moment;
            add(-v.dot(force), v.norm() * force.norm());
            add(-angular_power, angular_power.abs());
        }
        (sum, terms)
    }

    /// What the ground and the loads do less the rate of the momentum, with the sum of absolute
    /// terms: x, y, and the moment about the ground's moved origin over the size, N.
    pub(super) fn momentum_balance(&self) -> [(f64, f64, &'static str); 3] {
        let ground = self.dense.mechanism.ground;
        let on_ground = self.joint_wrenches.iter().filter(|a| a.body.0 == ground);
        let on_bodies = self.load_wrenches.iter().filter(|a| a.body.0 != ground);
        let mut total = NetWrench::of(on_bodies, Vec2::ZERO);
        // The ground's action is the opposite of what acts on it.
        let on_ground = NetWrench::of(on_ground, Vec2::ZERO);
        for c in 0..3 {
            total.sum[c] -= on_ground.sum[c];
            total.terms[c] += on_ground.terms[c];
        }
        let DenseSolution { x_dot, x_ddot, .. } = &self.solution;
        for wrench in inertia_wrenches(self.dense, &self.configuration, x_dot, x_ddot) {
            total.add(&wrench, Vec2::ZERO);
        }
        let size = self.dense.size();
        [
            (total.sum[0], total.terms[0], "x"),
            (total.sum[1], total.terms[0], "y"),
            (total.sum[2] / size, total.terms[2] / size, "moment"),
        ]
    }
}

/// Everything must be there, and as many as there should be.
pub(super) fn check_counts(dense: &DenseMechanism, state: &ClaimedState) -> Result<(), String> {
    let (bodies, actuators) = (dense.bodies.len(), dense.mechanism.actuators.len());
    let counts = [
        ("coordinates", state.q.len(), actuators),
        ("actuator velocities", state.q_dot.len(), actuators),
        ("actuator accelerations", state.q_ddot.len(), actuators),
        ("poses", state.poses.len(), bodies),
        ("velocities", state.velocities.len(), bodies),
        ("accelerations", state.accelerations.len(), bodies),
        ("reactions", state.reactions.len(), dense.actuator_row()),
        ("actuator forces", state.tau.len(), actuators),
    ];
    if let Some((what, found, expected)) = counts.into_iter().find(|c| c.1 != c.2) {
        return Err(format!("{found} {what} where there are {expected}"));
    }
    let mut loaded = state.load_wrenches.iter().map(|l| l.body.0);
    match loaded.find(|&b| b >= bodies) {
        Some(body) => Err(format!(
            "a load acts on body {body}, but there are {bodies} bodies"
        )),
        None => Ok(()),
    }
}

/// The claimed accelerations of the moved frames, in dense order.
fn shifted_accelerations(dense: &DenseMechanism, state: &ClaimedState) -> Vec<f64> {
    let mut x_ddot = vec![0.0; dense.rows.columns()];
    for (b, body, c) in dense.moving_bodies() {
        let arm = body.shift.rotate(Vec2::from_angle(state.poses[b][2]));
        let ([.., omega], [ax, ay, alpha]) = (state.velocities[b], state.accelerations[b]);
        let a = vec2(ax, ay) + arm.perp() * alpha - arm * (omega * omega);
        x_ddot[c..c + 3].copy_from_slice(&[a.x, a.y, alpha]);
    }
    x_ddot
}
