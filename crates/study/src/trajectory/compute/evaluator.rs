//! Evaluates one position of a trajectory after another.

use crate::bodies::{BodyPose, body_poses};
use crate::explain::{StudyError, explain_model, table_of};
use crate::machines::first_uncovered;
use crate::trajectory::compute::{
    Analysis, Column, CouplingMonitor, Quantity, RowEvaluator, SpeedScale, StopCause,
    TrajectorySample,
};
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::{BodyId, Motion, Plan, Pose, Vec2};
use dwell_kinetostatics::{
    AppliedWrench, EvaluatedState, ForceSource, FreeBodyForces, InverseDynamics, LinkForces,
    LoadKind, Model, PowerBalance, Workspace, Wrench,
};
use dwell_scene::PlaneScene;

/// Evaluates the forces at one position after another.
#[derive(Clone)]
pub(crate) struct ForceEvaluator<'a> {
    pub(crate) model: &'a Model,
    analysis: Analysis,
    workspace: Workspace<f64>,
    pub(crate) results: InverseDynamics<f64>,
    pose: Pose<f64>,
    /// Whether something is computed from the pose that the forces do not need.
    keeps_poses: bool,
    /// Whether forces are computed, or the motion of the bodies alone.
    has_forces: bool,
    motion_buffer: Motion<f64>,
    /// The bodies at the velocities of the trajectory, whatever the analysis.
    body_states: BodyStates,
    couplings: CouplingMonitor<'a>,
    /// Whether the table of a load may be exceeded.
    has_tables: bool,
}

impl<'a> ForceEvaluator<'a> {
    pub(crate) fn new(scene: &'a PlaneScene, model: &'a Model, analysis: Analysis) -> Self {
        Self {
            model,
            analysis,
            workspace: model.workspace(),
            results: model.result_buffer(),
            pose: model.plan().pose(),
            keeps_poses: false,
            has_forces: true,
            motion_buffer: model.plan().motion(),
            body_states: BodyStates::new(model.plan()),
            couplings: CouplingMonitor::new(scene),
            has_tables: (model.loads().iter()).any(|load| table_of(&load.magnitude).is_some()),
        }
    }

    /// Evaluates the position of a sample, with the loads at time `t`; its state, where forces are computed.
    pub(crate) fn evaluate(
        &mut self,
        sample: &TrajectorySample,
        t: f64,
    ) -> Result<Option<EvaluatedState<'_>>, StopCause> {
        let (model, workspace, results) = (self.model, &mut self.workspace, &mut self.results);
        let (q, q_dot, q_ddot) = (&sample.q, &sample.q_dot, &sample.q_ddot);
        let state = match self.analysis {
            Analysis::Kinematics => {
                model.plan().positions(q, &mut self.pose)?;
                return Ok(None);
            }
            Analysis::Statics => model.statics(t, q, workspace, results)?,
            Analysis::Kinetostatics | Analysis::FreeMotion if !self.has_forces => {
                let mut state = model.kinematic_state(q, q_dot, workspace)?;
                if self.keeps_poses {
                    self.pose.clone_from(state.pose());
                }
                self.body_states.copy_from(state.bodies_at(q_ddot));
                check_tables((model, self.has_tables), t, &self.body_states)?;
                return Ok(None);
            }
            Analysis::Kinetostatics | Analysis::FreeMotion => {
                let mut state = model.kinematic_state(q, q_dot, workspace)?.apply_loads(t)?;
                for &(load, magnitude) in &sample.drive_magnitudes {
                    state.set_magnitude(load, magnitude);
                }
                state.evaluate(q_ddot, results)?
            }
        };
        if self.analysis == Analysis::Statics || self.keeps_poses {
            self.pose.clone_from(state.pose());
        }
        if self.analysis != Analysis::Statics {
            self.body_states.copy_from(state.bodies());
        }
        check_tables((model, self.has_tables), t, state.bodies())?;
        Ok(Some(state))
    }

    /// Computes the states of the bodies at the velocities of the sample, unless the forces were evaluated at them; fails where a
    /// coupling jumps.
    pub(crate) fn fill_states(&mut self, sample: &TrajectorySample) -> Result<(), StopCause> {
        if matches!(self.analysis, Analysis::Statics | Analysis::Kinematics) {
            let (plan, pose) = (self.model.plan(), &self.pose);
            plan.velocities(pose, &sample.q_dot, &mut self.motion_buffer);
            plan.accelerations(pose, &sample.q_ddot, &mut self.motion_buffer);
            self.body_states.fill(plan, pose, &self.motion_buffer);
        }
        self.couplings.check(&self.body_states)
    }
}

/// Fails at the first load of a model whose table, if any has one, does not cover the state of the bodies at time `t` (s).
fn check_tables(
    (model, has_tables): (&Model, bool),
    t: f64,
    states: &BodyStates,
) -> Result<(), StopCause> {
    let uncovered = has_tables.then(|| first_uncovered(model, t, |of| states.coordinate(of)));
    match uncovered.flatten() {
        Some((load, value)) => Err(StopCause::OffTable { load, value }),
        None => Ok(()),
    }
}

/// What the forces at one position are computed into.
#[derive(Clone)]
pub(crate) struct PositionForces<'a> {
    scene: &'a PlaneScene,
    body_forces: FreeBodyForces,
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
    fn new(scene: &'a PlaneScene, model: &Model) -> Result<Self, StudyError> {
        Ok(Self {
            body_forces: FreeBodyForces::new(model).map_err(|e| explain_model(scene, &e))?,
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
        let (body_forces, wrenches) = (&self.body_forces, &mut self.wrenches);
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

/// The second body of a load whose force follows from the motion of two.
fn second_body(load: &LoadKind) -> Option<BodyId> {
    match load {
        LoadKind::Spring { bodies, .. }
        | LoadKind::Damper { bodies, .. }
        | LoadKind::TorsionSpring { bodies, .. }
        | LoadKind::RotationalDamper { bodies } => Some(bodies[1]),
        LoadKind::SlideForce(guide) | LoadKind::SlideDamper(guide) => Some(guide.bodies[1]),
        LoadKind::Gravity { .. }
        | LoadKind::Force { .. }
        | LoadKind::Torque { .. }
        | LoadKind::PointToPointForce { .. }
        | LoadKind::SeparatingForce(_) => None,
    }
}

/// Whether a quantity is a quotient of velocities.
fn is_quotient(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::VelocityRatio(_)) || has_scale(quantity)
}

/// Whether a quantity is one where its divisor is not too small beside the speeds of all bodies.
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
            | Q::BodyAngle(..)
            | Q::PointCoordinate(..)
            | Q::TransmissionAngle(_)
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
pub(crate) struct PositionEvaluator<'a> {
    scene: &'a PlaneScene,
    pub(crate) forces: ForceEvaluator<'a>,
    pub(crate) position: PositionForces<'a>,
    /// With several actuators, the unpruned mechanism: the trajectory ends where any of its groups cannot be assembled.
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
        Ok(Self {
            position: PositionForces::new(scene, model)?,
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

    /// The k-th reaction within the mechanism that the i-th body of varying inertia stands for.
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
            LoadKind::Gravity { .. }
            | LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::PointToPointForce { .. }
            | LoadKind::SeparatingForce(_) => self.position.magnitudes[k],
            LoadKind::Spring { bodies, points, .. } | LoadKind::Damper { bodies, points } => {
                let line = states.separation(bodies, points).direction;
                let force_and_line = on_second.zip(line);
                force_and_line.map_or(0.0, |(wrench, line)| wrench.force.dot(line))
            }
            LoadKind::TorsionSpring { .. } | LoadKind::RotationalDamper { .. } => {
                on_second.map_or(0.0, |wrench| wrench.couple)
            }
            LoadKind::SlideForce(guide) | LoadKind::SlideDamper(guide) => {
                let axis = guide.axis.rotate(states.body(guide.bodies[0]).rotation);
                on_second.map_or(0.0, |wrench| wrench.force.dot(axis))
            }
        }
    }

    pub(crate) fn body_poses(&self) -> Vec<BodyPose> {
        body_poses(&self.forces.body_states, &self.scene.mechanism)
    }
}

impl RowEvaluator for PositionEvaluator<'_> {
    fn limit_to(&mut self, quantities: impl Iterator<Item = Quantity>) {
        (self.has_forces_on_bodies, self.forces.has_forces) = (false, false);
        (self.has_quotients, self.has_scales) = (false, false);
        for quantity in quantities {
            self.has_forces_on_bodies |= needs_forces_on_bodies(quantity);
            self.forces.has_forces |= !is_kinematic(quantity);
            self.has_quotients |= is_quotient(quantity);
            self.has_scales |= has_scale(quantity);
        }
        self.forces.keeps_poses = self.has_quotients;
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

    // One arm for each quantity.
    fn value(&self, quantity: Quantity, sample: &TrajectorySample) -> f64 {
        let (forces, states) = (&self.forces.results, &self.forces.body_states);
        let (unit_speed, balance) = (&self.unit_speed_states, &self.position.power_balance);
        let joint_forces = &self.position.joint_forces;
        let component = |v: Vec2, axis: usize| if axis == 0 { v.x } else { v.y };
        match quantity {
            Quantity::Time => sample.t,
            Quantity::ActuatorCoordinate(i, order) => match sample.actuator_coordinate {
                Some(actuator_coordinate) => actuator_coordinate[order],
                None => [&sample.q, &sample.q_dot, &sample.q_ddot][order][i],
            },
            Quantity::ActuatorForce(i) => forces.tau[i],
            Quantity::Measured(measured, order) => states.coordinate(measured)[order],
            // As couplings and loads count revolutions, so that columns of one angle agree.
            Quantity::BodyAngle(body, 0) => {
                states.angle([BodyId(self.scene.mechanism.ground), body])[0]
            }
            Quantity::BodyAngle(body, 1) => states.body(body).angular_velocity,
            Quantity::BodyAngle(body, _) => states.body(body).angular_acceleration,
            Quantity::VelocityRatio(body) => unit_speed.body(body).angular_velocity,
            Quantity::MechanicalAdvantage(body, point) => {
                self.speed_scales[0].mechanical_advantage(unit_speed, body, point)
            }
            Quantity::Pole(body, order, axis) => {
                let [at_unit_speed, scale] = &self.speed_scales;
                let pole = match order {
                    // At rest of a single actuator the body still has its pole.
                    1 if self.forces.model.plan().actuators() == 1 => {
                        at_unit_speed.pole(unit_speed, body)
                    }
                    1 => scale.pole(states, body),
                    _ => scale.acceleration_pole(states, body),
                };
                component(pole, axis)
            }
            Quantity::PointCoordinate(body, at, k) => {
                let point = states.point(body, at);
                let vector = match k / 2 {
                    0 => point.position,
                    1 => point.velocity,
                    _ => point.acceleration,
                };
                component(vector, k % 2)
            }
            Quantity::TransmissionAngle(dyad) => dyad.angle(states),
            Quantity::Reaction(k) => forces.reactions[k],
            Quantity::KnownReaction(i, k) => self.known_reaction(i, k),
            Quantity::BodyFrameForce(joint, body, axis) => {
                let rotation = states.body(body).rotation;
                component(joint_forces[joint.0].rotate_inverse(rotation), axis)
            }
            Quantity::ForceMagnitude(joint) => joint_forces[joint.0].norm(),
            Quantity::ForceDirection(joint) => joint_forces[joint.0].angle(),
            Quantity::ShakingForce(2) => self.position.shaking_wrench.moment,
            Quantity::ShakingForce(axis) => component(self.position.shaking_wrench.force, axis),
            Quantity::Power(0) => balance.actuators,
            Quantity::Power(1) => balance.loads,
            Quantity::Power(2) => balance.kinetic_energy_rate,
            Quantity::Power(3) => balance.residual(),
            Quantity::Power(_) => balance.kinetic_energy,
            Quantity::LoadForce(k) => self.load_force(k),
            Quantity::LoadPower(k) => self.position.load_powers[k],
            Quantity::Extra(k) => sample.extra_values[k],
            // The columns of a mechanism in the plane are none of these.
            Quantity::PointInSpace(..)
            | Quantity::MeasuredInSpace(..)
            | Quantity::RotationInSpace(..)
            | Quantity::MomentMagnitude(_) => f64::NAN,
        }
    }

    fn angular_velocity(&self, angle: Quantity) -> f64 {
        match angle {
            Quantity::Measured(measured @ CoordinateFunction::Angle(_), _) => {
                self.forces.body_states.coordinate(measured)[1]
            }
            Quantity::BodyAngle(body, _) => self.forces.body_states.body(body).angular_velocity,
            _ => 0.0,
        }
    }
}
