//! Sums of the loads and the inertia of all bodies: shaking force and power balance.
//!
//! With the momentum p and the angular momentum L of the moving bodies about the ground's origin, and the loads from outside
//! (weights and forces in space) F at points r,
//!
//! ```text
//! force on the ground   Σ F − ṗ         moment on the ground   Σ r × F − L̇
//! ```
//!
//! Actions between bodies, and of the joints and actuators, are in pairs: the remainder of the balance of the moving bodies acts on the
//! ground.

use crate::trajectory::compute::StopCause;
use dwell_geometry::space::{BodyMotion, Placement, Vec3};
use dwell_kinetostatics::InverseDynamics;
use dwell_kinetostatics::space::{Direction, LoadKind, Model, Workspace};
use dwell_scene::SpaceScene;

/// Sums over all bodies and loads.
#[derive(Debug, Clone, Default)]
pub(super) struct Totals {
    /// Force (N) and moment about the origin (N·m) on the ground.
    pub(super) shaking: [f64; 6],
    /// Power of actuators and loads, rate of the kinetic energy, residual, W; the kinetic energy, J.
    pub(super) power: [f64; 5],
    /// The sum of the absolute terms of the power balance, W.
    pub(super) power_scale: f64,
    /// By load: its magnitude and its power, W.
    pub(super) magnitudes: Vec<f64>,
    pub(super) load_powers: Vec<f64>,
}

impl Totals {
    pub(super) fn new(scene: &SpaceScene) -> Self {
        let loads = scene.loads.len() + scene.drives.len();
        Self {
            magnitudes: vec![0.0; loads],
            load_powers: vec![0.0; loads],
            ..Self::default()
        }
    }

    /// Force and moment of inertia and of loads, and the power balance, of bodies in motion with the actions of the actuators.
    pub(super) fn compute(
        &mut self,
        scene: &SpaceScene,
        bodies: &[(Placement, BodyMotion)],
        tau: &[f64],
        q_dot: &[f64],
    ) {
        let (mut force, mut moment) = (Vec3::ZERO, Vec3::ZERO);
        let [mut rate, mut energy, mut scale] = [0.0; 3];
        let weight = self.weight(scene);
        let moving = bodies.iter().zip(&scene.masses).enumerate();
        let moving = moving.filter(|(b, _)| *b != scene.mechanism.ground);
        for (_, ((Placement { position, rotation }, motion), mass)) in moving {
            let arm = rotation.apply(mass.center);
            let center = *position + arm;
            let tensor = |v: Vec3| rotation.apply(mass.angular_momentum(rotation.apply_inverse(v)));
            let (w, v) = (motion.angular_velocity, motion.point_velocity(arm));
            let momentum_rate = motion.point_acceleration(arm).scaled(mass.mass);
            let spin_rate = tensor(motion.angular_acceleration) + w.cross(tensor(w));
            let left = weight.scaled(mass.mass) - momentum_rate;
            force += left;
            moment += center.cross(left) - spin_rate;
            let of_body = v.dot(momentum_rate) + w.dot(spin_rate);
            rate += of_body;
            scale += of_body.abs();
            energy += 0.5 * (mass.mass * v.dot(v) + w.dot(tensor(w)));
        }
        for (load, &magnitude) in scene.loads.iter().zip(&self.magnitudes) {
            if let Some([at, unit]) = outer_force(&load.kind, bodies) {
                let acting = unit.scaled(magnitude);
                force += acting;
                moment += at.cross(acting);
            }
        }
        let actuators = tau.iter().zip(q_dot).map(|(f, v)| f * v);
        let loads: f64 = self.load_powers.iter().sum();
        let driven: f64 = actuators.clone().sum();
        self.shaking = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
        self.power = [driven, loads, rate, driven + loads - rate, energy];
        self.power_scale = scale
            + actuators.map(f64::abs).sum::<f64>()
            + self.load_powers.iter().map(|p| p.abs()).sum::<f64>();
    }

    /// Actuator forces and reactions under inertia and loads at time `t`, at coordinates, speeds and accelerations; `given` are the
    /// magnitudes of drives in a motion that was solved for.
    pub(super) fn evaluate_loads(
        &mut self,
        model: &Model,
        t: f64,
        [q, q_dot, q_ddot]: [&[f64]; 3],
        given: &[(usize, f64)],
        workspace: &mut Workspace<f64>,
        results: &mut InverseDynamics<f64>,
    ) -> Result<(), StopCause> {
        let mut state = model.kinematic_state(q, q_dot, workspace)?.apply_loads(t)?;
        for &(load, magnitude) in given {
            state.set_magnitude(load, magnitude);
        }
        let state = state.evaluate(q_ddot, results)?;
        self.magnitudes.copy_from_slice(state.magnitudes());
        for (load, power) in self.load_powers.iter_mut().enumerate() {
            *power = state.load_power(load);
        }
        Ok(())
    }

    /// The weight of a unit of mass in all gravities, N/kg.
    fn weight(&self, scene: &SpaceScene) -> Vec3 {
        let loads = scene.loads.iter().zip(&self.magnitudes);
        loads.fold(Vec3::ZERO, |sum, (load, &magnitude)| match load.kind {
            LoadKind::Gravity { direction } => sum + direction.scaled(magnitude),
            _ => sum,
        })
    }
}

/// A direction in the axes of the ground.
fn turned(direction: Direction, placement: &Placement) -> Vec3 {
    match direction {
        Direction::Ground(u) => u,
        Direction::Body(u) => placement.rotation.apply(u),
    }
}

/// Where a load from outside acts on one point, and its force at magnitude 1; weights are not among these.
fn outer_force(kind: &LoadKind, bodies: &[(Placement, BodyMotion)]) -> Option<[Vec3; 2]> {
    match *kind {
        LoadKind::Force {
            body,
            point,
            direction,
        } => {
            let (placement, _) = &bodies[body.0];
            let at = placement.position + placement.rotation.apply(point);
            Some([at, turned(direction, placement)])
        }
        LoadKind::Drag { body, point } => {
            let (placement, motion) = &bodies[body.0];
            let arm = placement.rotation.apply(point);
            let velocity = motion.point_velocity(arm);
            Some([placement.position + arm, velocity.scaled(-velocity.norm())])
        }
        // Between two bodies: the ground feels its own part.
        LoadKind::Gravity { .. } | LoadKind::Along(..) | LoadKind::Special(_) => None,
    }
}
