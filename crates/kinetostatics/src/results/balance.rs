//! Two balances of a whole mechanism at one state of motion: of power, and of the forces on its frame.

use super::FreeBodyForces;
use crate::load::{AppliedWrench, ForceSource};
use crate::model::stages::EvaluatedState;
use dwell_geometry::{BodyId, Vec2};

/// The power balance at one state: actuators + loads = dE_c/dt, W.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PowerBalance {
    /// Power of the actuators, Σ τ q̇, W.
    pub actuators: f64,
    /// Power of all loads, W.
    pub loads: f64,
    /// dE_c/dt = Σ m v·a + I ω α.
    pub kinetic_energy_rate: f64,
    /// Kinetic energy Σ ½ m v² + ½ I ω², J.
    pub kinetic_energy: f64,
    /// Sum of the absolute terms, against which the residual is small.
    pub scale: f64,
}

impl PowerBalance {
    /// The residual: actuators + loads − dE_c/dt, W.
    pub fn residual(&self) -> f64 {
        self.actuators + self.loads - self.kinetic_energy_rate
    }
}

/// A force, and its moment about the ground's origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// N.
    pub force: Vec2,
    /// N·m.
    pub moment: f64,
}

impl Wrench {
    fn add(&mut self, force: Vec2, point: Vec2, couple: f64) {
        self.force += force;
        self.moment += point.cross(force) + couple;
    }
}

/// The shaking force and the shaking moment: the action of the mechanism on its frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ShakingForce {
    /// From momentum: the loads on the moving bodies less the rate of change of their momentum.
    pub from_momentum: Wrench,
    /// From reactions: the sum of the wrenches of joints and actuators on the ground.
    pub from_reactions: Wrench,
    /// The wrench of loads on the ground itself (the end of a spring that is fixed there), in neither of the two.
    pub loads_on_ground: Wrench,
}

impl EvaluatedState<'_> {
    /// The power balance.
    pub fn power_balance(&self) -> PowerBalance {
        let states = self.bodies();
        let mut sum = PowerBalance::default();
        let q_dot = &self.workspace.q_dot;
        for (tau, q_dot) in self.inverse_dynamics().tau.iter().zip(q_dot) {
            sum.actuators += tau * q_dot;
            sum.scale += (tau * q_dot).abs();
        }
        for wrench in &self.loads().wrenches {
            let power = wrench.power(states);
            sum.loads += power;
            sum.scale += power.abs();
        }
        for [of_mass, of_inertia, power_of_mass, power_of_inertia] in
            self.model.inertia_terms(states)
        {
            sum.kinetic_energy += 0.5 * (of_mass + of_inertia);
            for term in [power_of_mass, power_of_inertia] {
                sum.kinetic_energy_rate += term;
                sum.scale += term.abs();
            }
        }
        sum
    }

    /// The power of each load, W, into `powers`, one for each load.
    pub fn load_powers(&self, powers: &mut [f64]) {
        powers.fill(0.0);
        for wrench in &self.loads().wrenches {
            if let ForceSource::Load(load) = wrench.source {
                powers[load] += wrench.power(self.bodies());
            }
        }
    }
}

impl FreeBodyForces {
    /// The shaking force and moment, by both methods, from the result of [`FreeBodyForces::wrenches`].
    pub fn shaking_force(
        &self,
        state: &EvaluatedState<'_>,
        wrenches: &[AppliedWrench],
    ) -> ShakingForce {
        let (model, states) = (state.model(), state.bodies());
        let mut shaking = ShakingForce::default();
        for wrench in wrenches {
            let total = match (wrench.body == self.ground, wrench.source) {
                (true, ForceSource::Load(_)) => &mut shaking.loads_on_ground,
                (true, _) => &mut shaking.from_reactions,
                (false, ForceSource::Load(_)) => &mut shaking.from_momentum,
                (false, _) => continue,
            };
            total.add(wrench.force, wrench.point(states), wrench.couple);
        }
        for body in &model.pass_model.inertial_bodies {
            let id = BodyId(body.body);
            let center = states.point(id, model.masses[id.0].center);
            let couple = body.inertia * states.body(id).angular_acceleration;
            let force = center.acceleration * body.mass;
            shaking.from_momentum.add(-force, center.position, -couple);
        }
        for varying in &model.pass_model.varying_inertias {
            let body = states.body(BodyId(varying.body));
            let ([inertia, half_slope], w) = (varying.at(body.rotation), body.angular_velocity);
            let couple = inertia * body.angular_acceleration + half_slope * w * w;
            shaking.from_momentum.add(Vec2::ZERO, Vec2::ZERO, -couple);
        }
        shaking
    }
}
