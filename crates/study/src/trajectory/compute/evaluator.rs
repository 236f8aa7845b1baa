//! Evaluates one position of a trajectory after another.

use crate::bodies::{BodyPose, body_poses};
use crate::explain::{StudyError, explain_model};
use crate::trajectory::compute::{
    Analysis, BodyNumbers, Column, ForceEvaluator, LargestErrors, Quantity, RowEvaluator,
    RowScene as _, SpeedScale, StopCause, TrajectorySample,
};
use dwell_geometry::body_states::{BodyState, BodyStates, CoordinateFunction};
use dwell_geometry::{BodyId, Plan, Pose, Vec2};
use dwell_kinetostatics::{
    AppliedWrench, EvaluatedState, ForceSource, FreeBodyForces, InverseDynamics, LinkForces,
    LoadKind, Model, PowerBalance, Strength, Workspace, Wrench,
};
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::PlaneScene;

/// The memory for the forces at one position.
#[derive(Clone)]
pub(crate) struct PositionForces<'a> {
    scene: &'a PlaneScene,
    /// None of a model that computes some reactions only.
    body_forces: Option<FreeBodyForces>,
    wrenches: Vec<AppliedWrench>,
    /// By load: the place among the wrenches of that on its second body, if it acts between two.
    on_second_bodies: Vec<Option<usize>>,
    /// By load: its magnitude and its power.
    magnitudes: Vec<f64>,
    load_powers: Vec<f64>,
    /// By joint: the force on its second body, N.
    joint_forces: Vec<Vec2>,
    shaking_wrench: Wrench,
    pub(crate) power_balance: PowerBalance,
    /// By requested link: its internal forces.
    pub(crate) link_forces: Vec<Option<LinkForces>>,
}

impl<'a> PositionForces<'a> {
    fn new(scene: &'a PlaneScene, model: &Model, is_needed: bool) -> Result<Self, StudyError> {
        let body_forces = match FreeBodyForces::new(model) {
            Err(_) if !is_needed => None,
            found => Some(found.map_err(|e| explain_model(scene, &e))?),
        };
        Ok(Self {
            body_forces,
            scene,
            wrenches: Vec::new(),
            on_second_bodies: vec![None; scene.loads.len()],
            magnitudes: vec![0.0; scene.loads.len()],
            load_powers: vec![0.0; scene.loads.len()],
            joint_forces: vec![Vec2::ZERO; scene.mechanism.joints.len()],
            shaking_wrench: Wrench::default(),
            power_balance: PowerBalance::default(),
            link_forces: Vec::new(),
        })
    }

    /// Computes joint forces, shaking force, power balance and internal forces.
    fn compute(&mut self, state: &EvaluatedState<'_>) {
        let Some(body_forces) = &self.body_forces else {
            return;
        };
        let wrenches = &mut self.wrenches;
        body_forces.wrenches(state, wrenches);
        self.joint_forces.fill(Vec2::ZERO);
        self.on_second_bodies.fill(None);
        for (place, wrench) in wrenches.iter().enumerate() {
            match wrench.source {
                ForceSource::Joint(j)
                    if wrench.body == self.scene.mechanism.joints[j.0].bodies[1] =>
                {
                    self.joint_forces[j.0] += wrench.force;
                }
                ForceSource::Load(k)
                    if second_body(&self.scene.loads[k].kind) == Some(wrench.body) =>
                {
                    self.on_second_bodies[k].get_or_insert(place);
                }
                _ => {}
            }
        }
        let shaking = body_forces.shaking_force(state, wrenches);
        let [by_reactions, by_loads] = [shaking.from_reactions, shaking.loads_on_ground];
        self.shaking_wrench = Wrench {
            force: by_reactions.force + by_loads.force,
            moment: by_reactions.moment + by_loads.moment,
        };
        self.power_balance = state.power_balance();
        state.load_powers(&mut self.load_powers);
        self.magnitudes.clone_from(&state.loads().magnitude);
        let links = self.scene.requests.sections.iter();
        let forces = links.map(|l| body_forces.link_forces(state, l.body, l.points, wrenches));
        self.link_forces.clear();
        self.link_forces.extend(forces);
    }
}

/// The body on which the force of a load is read that follows from the motion, the second of two.
fn second_body(load: &LoadKind) -> Option<BodyId> {
    match *load {
        LoadKind::Along(CoordinateFunction::Travel(guide), _) => Some(guide.bodies[1]),
        LoadKind::Along(
            CoordinateFunction::Angle(bodies) | CoordinateFunction::Length { bodies, .. },
            law,
        ) => (law != Strength::Direct).then_some(bodies[1]),
        LoadKind::Drag { body, .. } => Some(body),
        LoadKind::Gravity { .. } | LoadKind::Force { .. } | LoadKind::Special(_) => None,
    }
}

/// Whether a quantity is a quotient of velocities.
fn is_quotient(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::VelocityRatio(_)) || has_scale(quantity)
}

/// Whether a quantity is undefined if its divisor is too small relative to the speeds of all bodies.
fn has_scale(quantity: Quantity) -> bool {
    matches!(
        quantity,
        Quantity::MechanicalAdvantage(..) | Quantity::Pole(..)
    )
}

/// Whether a quantity is computed from the motion of the bodies alone.
fn is_kinematic(quantity: Quantity) -> bool {
    use Quantity as Q;
    matches!(
        quantity,
        Q::Time
            | Q::ActuatorCoordinate(..)
            | Q::Measured(..)
            | Q::Rotation(..)
            | Q::Point(..)
            | Q::TransmissionAngle(_)
            | Q::LeastDeterminant
            | Q::VelocityRatio(_)
    )
}

/// Whether a quantity is computed from the forces on all bodies, beyond actuator forces and reactions.
fn needs_forces_on_bodies(quantity: Quantity) -> bool {
    use Quantity as Q;
    matches!(
        quantity,
        Q::BodyFrameForce(..)
            | Q::ForceMagnitude(_)
            | Q::ForceDirection(_)
            | Q::ShakingForce(_)
            | Q::Power(_)
            | Q::LoadForce(_)
            | Q::LoadPower(_)
    )
}

/// Evaluates all quantities at one position after another.
#[derive(Clone)]
pub struct PositionEvaluator<'a> {
    scene: &'a PlaneScene,
    pub(crate) forces: ForceEvaluator<'a>,
    pub(crate) position: PositionForces<'a>,
    /// With several actuators, the unpruned mechanism: the trajectory ends if any of its groups cannot be assembled.
    whole_mechanism: Option<(&'a Plan, Pose<f64>)>,
    /// Whether a requested quantity is a quotient of velocities; whether one is compared with the speeds of all bodies.
    has_quotients: bool,
    has_scales: bool,
    /// Whether the forces on all bodies are computed.
    has_forces_on_bodies: bool,
    /// The bodies at q̇ = 1 of a single actuator.
    unit_speed_states: BodyStates,
    /// Size of the mechanism, m; and the scales at q̇ = 1 of a single actuator, and along the trajectory.
    size: f64,
    speed_scales: [SpeedScale; 2],
    measured: Vec<Option<CoordinateFunction>>,
}

impl<'a> PositionEvaluator<'a> {
    pub(crate) fn new(
        scene: &'a PlaneScene,
        whole_plan: &'a Plan,
        model: &'a Model,
        analysis: Analysis,
        columns: &[Column],
    ) -> Result<Self, StudyError> {
        let is_pruned = model.plan().pruned_groups().contains(&true);
        let checks_whole = is_pruned && whole_plan.actuators() > 1;
        let has_quotients = columns.iter().any(|c| is_quotient(c.quantity));
        let mut forces = ForceEvaluator::new(scene, model, analysis);
        forces.keeps_poses = has_quotients;
        let measured = scene.measured(model).into_iter();
        Ok(Self {
            measured: measured.map(|of| of.function).collect(),
            position: PositionForces::new(scene, model, !columns.is_empty())?,
            scene,
            forces,
            has_forces_on_bodies: true,
            whole_mechanism: checks_whole.then(|| (whole_plan, whole_plan.pose())),
            has_quotients,
            has_scales: has_quotients,
            size: scene.mechanism.size(),
            speed_scales: [SpeedScale::default(); 2],
            unit_speed_states: BodyStates::new(model.plan()),
        })
    }

    /// The k-th reaction within the mechanism that the i-th body of varying inertia represents.
    fn known_reaction(&self, i: usize, k: usize) -> f64 {
        let varying = &self.scene.varying_inertias[i];
        let body = self.forces.body_states.body(varying.body);
        let angle = body.rotation.angle();
        varying.reactions[k].value(angle, body.angular_velocity, body.angular_acceleration)
    }

    /// The force of a load along its direction or line, or its moment on its second body.
    fn load_force(&self, k: usize) -> f64 {
        let states = &self.forces.body_states;
        let on_second =
            self.position.on_second_bodies[k].map(|place| self.position.wrenches[place]);
        match self.scene.loads[k].kind {
            LoadKind::Along(CoordinateFunction::Travel(guide), _) => {
                let axis = guide.axis.rotate(states.body(guide.bodies[0]).rotation);
                on_second.map_or(0.0, |wrench| wrench.force.dot(axis))
            }
            LoadKind::Along(CoordinateFunction::Length { bodies, points }, law)
                if law != Strength::Direct =>
            {
                let line = states.separation(bodies, points).direction;
                let force_and_line = on_second.zip(line);
                force_and_line.map_or(0.0, |(wrench, line)| wrench.force.dot(line))
            }
            LoadKind::Along(CoordinateFunction::Angle(_), law) if law != Strength::Direct => {
                on_second.map_or(0.0, |wrench| wrench.couple)
            }
            LoadKind::Drag { .. } => on_second.map_or(0.0, |wrench| -wrench.force.norm()),
            LoadKind::Gravity { .. }
            | LoadKind::Force { .. }
            | LoadKind::Along(..)
            | LoadKind::Special(_) => self.position.magnitudes[k],
        }
    }

    /// Where a body has no velocity (order 1) or no acceleration (order 2).
    fn pole(&self, body: BodyId, order: usize) -> Vec2 {
        let ([at_unit_speed, scale], states) = (&self.speed_scales, &self.forces.body_states);
        match order {
            // At rest of a single actuator the body still has its pole.
            1 if self.forces.model.plan().actuators() == 1 => {
                at_unit_speed.pole(&self.unit_speed_states, body)
            }
            1 => scale.pole(states, body),
            _ => scale.acceleration_pole(states, body),
        }
    }
}

impl RowEvaluator for PositionEvaluator<'_> {
    type Model = Model;

    fn model(&self) -> &Model {
        self.forces.model
    }

    fn limit_to(&mut self, quantities: impl Iterator<Item = Quantity>) {
        (self.has_forces_on_bodies, self.forces.has_forces) = (false, false);
        (self.has_quotients, self.has_scales) = (false, false);
        let mut has_determinants = false;
        for quantity in quantities {
            has_determinants |= quantity == Quantity::LeastDeterminant;
            self.has_forces_on_bodies |= needs_forces_on_bodies(quantity);
            self.forces.has_forces |= !is_kinematic(quantity);
            self.has_quotients |= is_quotient(quantity);
            self.has_scales |= has_scale(quantity);
        }
        self.forces.keeps_poses = self.has_quotients || has_determinants;
    }

    fn evaluate(&mut self, sample: &TrajectorySample, t: f64) -> Result<(), StopCause> {
        if let Some((whole_plan, pose)) = &mut self.whole_mechanism {
            whole_plan.positions(&sample.q, pose)?;
        }
        let state = self.forces.evaluate(sample, t)?;
        if let Some(state) = state.filter(|_| self.has_forces_on_bodies) {
            self.position.compute(&state);
        }
        let forces = &mut self.forces;
        let plan = forces.model.plan();
        if self.has_quotients && plan.actuators() == 1 {
            let (pose, motion) = (&forces.pose, &mut forces.motion_buffer);
            plan.velocities(pose, &[1.0], motion);
            self.unit_speed_states.fill(plan, pose, motion);
        }
        forces.fill_states(sample)?;
        if self.has_scales {
            self.speed_scales = [&self.unit_speed_states, &forces.body_states]
                .map(|states| SpeedScale::new(states, self.size));
        }
        Ok(())
    }

    fn forces(&self) -> &InverseDynamics<f64> {
        &self.forces.results
    }

    fn bodies(&self) -> &impl crate::assembled::BodyStates {
        &self.forces.body_states
    }

    // As couplings and loads count revolutions, so that columns of one angle agree.
    fn rotation(&self, body: BodyId) -> [f64; 3] {
        let ground = BodyId(self.scene.mechanism.ground);
        let [angle, ..] = self.forces.body_states.angle([ground, body]);
        [0.0, 0.0, angle]
    }

    fn measured(&self, k: usize) -> [f64; 3] {
        let found = self.measured[k].map(|of| self.forces.body_states.coordinate(of));
        found.unwrap_or([f64::NAN; 3])
    }

    fn power(&self) -> [f64; 5] {
        let balance = &self.position.power_balance;
        [
            balance.actuators,
            balance.loads,
            balance.kinetic_energy_rate,
            balance.residual(),
            balance.kinetic_energy,
        ]
    }

    fn power_scale(&self) -> f64 {
        self.position.power_balance.scale
    }

    fn load_power(&self, load: usize) -> f64 {
        self.position.load_powers[load]
    }

    fn other(&self, quantity: Quantity) -> f64 {
        let (states, unit_speed) = (&self.forces.body_states, &self.unit_speed_states);
        let joint_forces = &self.position.joint_forces;
        let component = |v: Vec2, axis: usize| if axis == 0 { v.x } else { v.y };
        match quantity {
            Quantity::VelocityRatio(body) => unit_speed.body(body).angular_velocity,
            Quantity::MechanicalAdvantage(body, point) => {
                self.speed_scales[0].mechanical_advantage(unit_speed, body, point)
            }
            Quantity::Pole(body, order, axis) => component(self.pole(body, order), axis),
            Quantity::TransmissionAngle(dyad) => dyad.angle(states),
            Quantity::LeastDeterminant => {
                let forces = &self.forces;
                let plan = forces.model.plan();
                plan.least_relative_determinant(&forces.pose)
            }
            Quantity::KnownReaction(i, k) => self.known_reaction(i, k),
            Quantity::BodyFrameForce(joint, body, axis) => {
                let rotation = states.body(body).rotation;
                component(joint_forces[joint.0].rotate_inverse(rotation), axis)
            }
            Quantity::ForceMagnitude(joint) => joint_forces[joint.0].norm(),
            Quantity::ForceDirection(joint) => joint_forces[joint.0].angle(),
            Quantity::ShakingForce(2) => self.position.shaking_wrench.moment,
            Quantity::ShakingForce(axis) => component(self.position.shaking_wrench.force, axis),
            Quantity::LoadForce(k) => self.load_force(k),
            _ => f64::NAN,
        }
    }

    fn body_poses(&self) -> Vec<BodyPose> {
        body_poses(&self.forces.body_states, &self.scene.mechanism)
    }

    fn link_forces(&self) -> &[Option<LinkForces>] {
        &self.position.link_forces
    }

    fn result_reactions(&self) -> usize {
        self.forces.model.reactions().len()
    }

    // Next to a limit position there may be a pose in double precision and none in 32 digits.
    fn add_rounding(
        &self,
        t: f64,
        at: [&[f64]; 3],
        precise: &mut Workspace<DoubleDouble>,
        largest: &mut LargestErrors,
    ) {
        let (model, forces) = (self.forces.model, &self.forces.results);
        if largest.analysis != Analysis::Kinematics {
            let mut errors = model.result_buffer();
            let known = model.kinetostatics_rounding_errors(t, at, forces, precise, &mut errors);
            if known.is_ok() {
                largest.add_forces(forces, [&errors.tau, &errors.reactions]);
            }
            return;
        }
        let lift = |values: &[f64]| values.iter().map(|&v| DoubleDouble::from_f64(v)).collect();
        let [q, q_dot, q_ddot]: [Vec<DoubleDouble>; 3] = at.map(lift);
        if let Ok(mut state) = model.kinematic_state(&q, &q_dot, precise) {
            let (plain, precise) = (&self.forces.body_states, state.bodies_at(&q_ddot));
            for body in (0..plain.len()).map(BodyId) {
                largest.add_body(numbers(plain.body(body)), numbers(precise.body(body)));
            }
        }
    }
}

/// The numbers of a body, by kind.
fn numbers<T: Scalar>(body: &BodyState<T>) -> BodyNumbers<T> {
    [
        vec![body.joint_origin.x, body.joint_origin.y],
        vec![body.rotation.x, body.rotation.y],
        vec![body.velocity.x, body.velocity.y],
        vec![body.angular_velocity],
        vec![body.acceleration.x, body.acceleration.y],
        vec![body.angular_acceleration],
    ]
}
