//! Evaluation along a trajectory: the table, and what sections and drawings need of each position.

use crate::bodies::{BodyPose, mean_body_length};
use crate::explain::{StudyError, explain_model};
use crate::trajectory::compute::{
    Analysis, Column, ColumnQuantity, Columns, EarlyStop, PowerTerm, RoundingError, SectionedLink,
    SpeedScale, StopCause, Trajectory, TrajectoryMonitor, TrajectorySample, is_requested,
    prune_model, unreachable_error,
};
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::{BodyId, Motion, Plan, Pose, Vec2};
use dwell_kinetostatics::{
    AppliedWrench, ForceSource, FreeBodyForces, InverseDynamics, LoadKind, Model, PowerBalance,
    Workspace, Wrench,
};
use dwell_scene::Scene;
use std::f64::consts::TAU;

/// Results of an analysis along a trajectory.
pub(crate) struct TrajectoryResults {
    /// All columns of the analysis.
    pub(crate) columns: Vec<Column>,
    /// By position: a value for each column.
    pub(crate) rows: Vec<Vec<f64>>,
    /// By position and body.
    pub(crate) body_poses: Vec<Vec<BodyPose>>,
    /// The links whose internal forces are requested.
    pub(crate) sectioned_links: Vec<SectionedLink>,
    /// The largest residual of the power balance, relative to the sum of its absolute terms.
    pub(crate) power_residual: f64,
    /// The estimated rounding error of actuator forces and reactions, relative to the largest of their unit.
    pub(crate) rounding_error: Option<f64>,
    /// The statically indeterminate reactions, by name.
    pub(crate) indeterminate: Vec<String>,
    /// By body: whether it is modelled.
    pub(crate) modelled: Vec<bool>,
    /// Where and why the trajectory ended early, if it did.
    pub(crate) early_stop: Option<EarlyStop>,
}

impl TrajectoryResults {
    /// The bodies that are not modelled, because nothing needs them.
    pub(crate) fn unmodelled_bodies(&self, scene: &Scene) -> Vec<String> {
        let bodies = scene.mechanism.bodies.iter().zip(&self.modelled);
        let unmodelled = bodies.filter(|(_, modelled)| !**modelled);
        unmodelled.map(|(body, _)| body.name.clone()).collect()
    }
}

/// Evaluates one position after another.
struct PositionEvaluator<'a> {
    scene: &'a Scene,
    model: &'a Model,
    body_forces: FreeBodyForces,
    analysis: Analysis,
    /// With several actuators, the unpruned mechanism: the trajectory ends where any of its groups cannot be assembled.
    whole_mechanism: Option<(&'a Plan, Pose<f64>)>,
    workspace: Workspace<f64>,
    inverse_dynamics: InverseDynamics<f64>,
    wrenches: Vec<AppliedWrench>,
    motion_buffer: Motion<f64>,
    /// The bodies at the velocities of the trajectory, whatever the analysis.
    body_states: BodyStates,
    /// The bodies at q̇ = 1 of a single actuator.
    unit_speed_states: BodyStates,
    /// Mean length of a body, m; and the scales at q̇ = 1 of a single actuator, and along the trajectory.
    size: f64,
    speed_scales: [SpeedScale; 2],
    load_powers: Vec<f64>,
    /// By joint: the force on its second body, N.
    joint_forces: Vec<Vec2>,
    shaking_wrench: Wrench,
    power_balance: PowerBalance,
    monitor: TrajectoryMonitor<'a>,
}

impl<'a> PositionEvaluator<'a> {
    fn new(
        scene: &'a Scene,
        whole_plan: &'a Plan,
        model: &'a Model,
        analysis: Analysis,
    ) -> Result<Self, StudyError> {
        let is_pruned = model.plan().pruned_groups().contains(&true);
        let checks_whole = is_pruned && whole_plan.actuators() > 1;
        let body_forces = FreeBodyForces::new(model).map_err(|e| explain_model(scene, &e))?;
        Ok(Self {
            body_forces,
            scene,
            model,
            analysis,
            whole_mechanism: checks_whole.then(|| (whole_plan, whole_plan.pose())),
            size: mean_body_length(scene),
            speed_scales: [SpeedScale::default(); 2],
            workspace: model.workspace(),
            inverse_dynamics: model.result_buffer(),
            wrenches: Vec::new(),
            motion_buffer: model.plan().motion(),
            body_states: BodyStates::new(model.plan()),
            unit_speed_states: BodyStates::new(model.plan()),
            load_powers: vec![0.0; scene.loads.len()],
            joint_forces: vec![Vec2::ZERO; scene.mechanism.joints.len()],
            shaking_wrench: Wrench::default(),
            power_balance: PowerBalance::default(),
            monitor: TrajectoryMonitor::new(scene),
        })
    }

    fn evaluate(&mut self, sample: &TrajectorySample, timed: bool) -> Result<(), StopCause> {
        let plan = self.model.plan();
        let TrajectorySample {
            t,
            q,
            q_dot,
            q_ddot,
            drive_magnitudes: given,
            ..
        } = sample;
        if let Some((whole_plan, pose)) = &mut self.whole_mechanism {
            whole_plan.positions(q, pose)?;
        }
        let (workspace, inverse_dynamics) = (&mut self.workspace, &mut self.inverse_dynamics);
        // Without time, loads have their value at t = 0.
        let t = if timed { *t } else { 0.0 };
        match self.analysis {
            Analysis::Kinematics => plan.positions(q, &mut workspace.pose)?,
            Analysis::Statics => self.model.statics(t, q, workspace, inverse_dynamics)?,
            Analysis::Kinetostatics | Analysis::FreeMotion => {
                for &(load, magnitude) in given {
                    workspace.set_magnitude(load, magnitude);
                }
                self.model
                    .kinetostatics(t, q, q_dot, q_ddot, workspace, inverse_dynamics)?;
            }
        }
        if self.analysis != Analysis::Kinematics
            && let Some(fault) = self.monitor.off_table(t, workspace.states())
        {
            return Err(StopCause::Fault(fault));
        }
        if plan.actuators() == 1 {
            plan.velocities(&workspace.pose, &[1.0], &mut self.motion_buffer);
            self.unit_speed_states
                .fill(plan, &workspace.pose, &self.motion_buffer);
        }
        plan.velocities(&workspace.pose, q_dot, &mut self.motion_buffer);
        plan.accelerations(&workspace.pose, q_ddot, &mut self.motion_buffer);
        self.body_states
            .fill(plan, &workspace.pose, &self.motion_buffer);
        self.speed_scales = [&self.unit_speed_states, &self.body_states]
            .map(|states| SpeedScale::new(states, self.size));
        if let Some(fault) = self.monitor.discontinuity(&self.body_states) {
            return Err(StopCause::Fault(fault));
        }
        if self.analysis != Analysis::Kinematics {
            self.compute_forces();
        }
        Ok(())
    }

    /// Computes joint forces, shaking force and power balance.
    fn compute_forces(&mut self) {
        let (model, workspace, inverse_dynamics) =
            (self.model, &self.workspace, &self.inverse_dynamics);
        self.body_forces
            .wrenches(model, workspace, inverse_dynamics, &mut self.wrenches);
        self.joint_forces.fill(Vec2::ZERO);
        for wrench in &self.wrenches {
            if let ForceSource::Joint(j) = wrench.source
                && wrench.body == self.scene.mechanism.joints[j.0].bodies[1]
            {
                self.joint_forces[j.0] += wrench.force;
            }
        }
        let shaking_force = self
            .body_forces
            .shaking_force(model, workspace, &self.wrenches);
        let [by_reactions, by_loads] =
            [shaking_force.from_reactions, shaking_force.loads_on_ground];
        self.shaking_wrench = Wrench {
            force: by_reactions.force + by_loads.force,
            moment: by_reactions.moment + by_loads.moment,
        };
        self.power_balance = model.power_balance(workspace, inverse_dynamics);
        model.load_powers(workspace, &mut self.load_powers);
    }

    fn value(&self, quantity: ColumnQuantity, sample: &TrajectorySample) -> f64 {
        let states = &self.body_states;
        match quantity {
            ColumnQuantity::Time => sample.t,
            ColumnQuantity::ActuatorCoordinate(i, order) => match sample.actuator_coordinate {
                Some(actuator_coordinate) => actuator_coordinate[order],
                None => [&sample.q, &sample.q_dot, &sample.q_ddot][order][i],
            },
            ColumnQuantity::ActuatorForce(i) => self.inverse_dynamics.tau[i],
            ColumnQuantity::Measured(measured, order) => states.coordinate(measured)[order],
            // As couplings and loads count revolutions, so that columns of one angle agree.
            ColumnQuantity::BodyAngle(body, 0) => {
                let ground = BodyId(self.scene.mechanism.ground);
                states.angle([ground, body])[0]
            }
            ColumnQuantity::BodyAngle(body, 1) => states.body(body).angular_velocity,
            ColumnQuantity::BodyAngle(body, _) => states.body(body).angular_acceleration,
            ColumnQuantity::VelocityRatio(body) => {
                self.unit_speed_states.body(body).angular_velocity
            }
            ColumnQuantity::MechanicalAdvantage(body, point) => {
                self.speed_scales[0].mechanical_advantage(&self.unit_speed_states, body, point)
            }
            ColumnQuantity::Pole(body, order, axis) => {
                let pole = match order {
                    // At rest of a single actuator the body still has its pole.
                    1 if self.model.plan().actuators() == 1 => {
                        self.speed_scales[0].pole(&self.unit_speed_states, body)
                    }
                    1 => self.speed_scales[1].pole(states, body),
                    _ => self.speed_scales[1].acceleration_pole(states, body),
                };
                if axis == 0 { pole.x } else { pole.y }
            }
            ColumnQuantity::PointCoordinate(body, at, k) => {
                let point = states.point(body, at);
                let vector = [point.position, point.velocity, point.acceleration][k / 2];
                if k % 2 == 0 { vector.x } else { vector.y }
            }
            ColumnQuantity::TransmissionAngle(dyad) => dyad.angle(states),
            ColumnQuantity::Reaction(k) => self.inverse_dynamics.reactions[k],
            ColumnQuantity::BodyFrameForce(joint, body, axis) => {
                let local = self.joint_forces[joint.0].rotate_inverse(states.body(body).rotation);
                if axis == 0 { local.x } else { local.y }
            }
            ColumnQuantity::ForceMagnitude(joint) => self.joint_forces[joint.0].norm(),
            ColumnQuantity::ForceDirection(joint) => self.joint_forces[joint.0].angle(),
            ColumnQuantity::ShakingForce(0) => self.shaking_wrench.force.x,
            ColumnQuantity::ShakingForce(1) => self.shaking_wrench.force.y,
            ColumnQuantity::ShakingForce(_) => self.shaking_wrench.moment,
            ColumnQuantity::Power(PowerTerm::Actuators) => self.power_balance.actuators,
            ColumnQuantity::Power(PowerTerm::Loads) => self.power_balance.loads,
            ColumnQuantity::Power(PowerTerm::KineticRate) => self.power_balance.kinetic_energy_rate,
            ColumnQuantity::Power(PowerTerm::Residual) => self.power_balance.residual(),
            ColumnQuantity::Power(PowerTerm::KineticEnergy) => self.power_balance.kinetic_energy,
            ColumnQuantity::LoadForce(k) => self.load_force(k),
            ColumnQuantity::LoadPower(k) => self.load_powers[k],
            ColumnQuantity::Extra(k) => sample.extra_values[k],
        }
    }

    /// The force of a load along its direction or line, or its moment on its second body.
    fn load_force(&self, k: usize) -> f64 {
        let by_load = || {
            self.wrenches
                .iter()
                .filter(|wrench| wrench.source == ForceSource::Load(k))
        };
        match self.scene.loads[k].kind {
            LoadKind::Gravity { .. }
            | LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::PointToPointForce { .. }
            | LoadKind::SeparatingForce(_) => self.workspace.loads().magnitude[k],
            LoadKind::Spring { bodies, points, .. } | LoadKind::Damper { bodies, points } => {
                let line = self.workspace.states().separation(bodies, points).direction;
                let on_second = by_load().find(|wrench| wrench.body == bodies[1]);
                match (line, on_second) {
                    (Some(line), Some(wrench)) => wrench.force.dot(line),
                    _ => 0.0,
                }
            }
            LoadKind::TorsionSpring { bodies, .. } | LoadKind::RotationalDamper { bodies } => {
                by_load()
                    .find(|wrench| wrench.body == bodies[1])
                    .map_or(0.0, |wrench| wrench.couple)
            }
            LoadKind::SlideForce(guide) | LoadKind::SlideDamper(guide) => {
                let [first, second] = guide.bodies;
                let axis = guide
                    .axis
                    .rotate(self.workspace.states().body(first).rotation);
                let on_second = by_load().find(|wrench| wrench.body == second);
                on_second.map_or(0.0, |wrench| wrench.force.dot(axis))
            }
        }
    }

    fn body_poses(&self) -> Vec<BodyPose> {
        let bodies = (0..self.scene.mechanism.bodies.len()).map(BodyId);
        let body_pose = |b| {
            let origin = self.body_states.point(b, Vec2::ZERO).position;
            (origin, self.body_states.body(b).rotation)
        };
        bodies.map(body_pose).collect()
    }
}

/// Unwraps angles: adds the revolutions that bring a value nearest to the one extrapolated by the velocities.
struct AngleUnwrapper {
    last: Vec<Option<(f64, f64, f64)>>,
}

impl AngleUnwrapper {
    fn unwrap_angle(&mut self, k: usize, value: f64, speed: f64, t: f64) -> f64 {
        let unwrapped = self.last[k].map_or(value, |(previous, previous_speed, previous_time)| {
            let expected = previous + 0.5 * (previous_speed + speed) * (t - previous_time);
            value + TAU * ((expected - value) / TAU).round()
        });
        self.last[k] = Some((unwrapped, speed, t));
        unwrapped
    }
}

/// Evaluates a scene along a trajectory.
///
/// # Errors
/// [`StudyError::Scene`] when not even the first position can be reached.
pub(crate) fn evaluate_trajectory(
    scene: &Scene,
    full_model: &Model,
    trajectory: &Trajectory<'_>,
    analysis: Analysis,
    on_position: &dyn Fn(usize),
) -> Result<TrajectoryResults, StudyError> {
    // The trajectory ends where the whole mechanism does, however much of it is modelled.
    let plan: &Plan = full_model.plan();
    let model = &prune_model(scene, full_model);
    let modelled = model.plan().placed_bodies();
    let is_modelled = |column: &Column| {
        let bodies = column.quantity.bodies(scene, model.reactions());
        bodies.iter().all(|b| modelled[b.0])
    };
    // A static sweep has no time.
    let timed = trajectory.swept_actuator().is_none() || analysis != Analysis::Statics;
    let extra = trajectory
        .extra_columns()
        .iter()
        .enumerate()
        .map(|(k, extra)| Column {
            name: extra.name.clone(),
            former: None,
            unit: extra.unit,
            quantity: ColumnQuantity::Extra(k),
            meaning: extra.meaning.clone(),
        });
    let columns: Vec<Column> = Columns::all(scene, model, timed)
        .into_iter()
        .chain(extra)
        .filter(|c| c.is_computed_by(analysis) && is_modelled(c))
        .filter(|c| !matches!(c.quantity, ColumnQuantity::ActuatorForce(i) if !trajectory.exerts_force(i)))
        .filter(|c| !c.is_optional() || is_requested(scene, c))
        .collect();
    trajectory.check_laws(scene)?;
    let charts = match trajectory.charts() {
        [] => std::slice::from_ref(model),
        charts => charts,
    };
    let mut evaluators = charts
        .iter()
        .map(|chart| PositionEvaluator::new(scene, plan, chart, analysis))
        .collect::<Result<Vec<_>, _>>()?;
    let mut unwrapper = AngleUnwrapper {
        last: vec![None; columns.len()],
    };
    let sections = match analysis {
        Analysis::Kinematics => &[],
        _ => scene.requests.sections.as_slice(),
    };
    let mut results = TrajectoryResults {
        columns,
        rows: Vec::with_capacity(trajectory.points),
        body_poses: Vec::with_capacity(trajectory.points),
        sectioned_links: sections.iter().map(SectionedLink::new).collect(),
        power_residual: 0.0,
        rounding_error: None,
        indeterminate: (0..model.reactions().len())
            .filter(|&k| !model.plan().is_determinate(k))
            .map(|k| scene.mechanism.reaction_name(model.reactions()[k]))
            .collect(),
        modelled,
        early_stop: None,
    };
    let estimates_rounding = matches!(analysis, Analysis::Statics | Analysis::Kinetostatics);
    let mut rounding_error =
        estimates_rounding.then(|| RoundingError::new(scene, model, trajectory.points));
    let mut previous: Option<f64> = None;
    for k in 0..trajectory.points {
        let fraction = trajectory.fraction_at(k);
        let sample = trajectory.sample_at(fraction);
        let evaluator = &mut evaluators[sample.chart];
        let unreachable = previous
            .filter(|_| plan.actuators() == 1 && trajectory.charts().is_empty())
            .and_then(|q| unreachable_error(plan, q, sample.q[0]));
        let done = match unreachable {
            Some(error) => Err(error.into()),
            None => evaluator.evaluate(&sample, timed),
        };
        if let Err(error) = done {
            let reached = if k > 0 {
                trajectory.fraction_at(k - 1)
            } else {
                fraction
            };
            let early_stop = EarlyStop::find(plan, trajectory, [reached, fraction], error);
            if k == 0 {
                return Err(early_stop.explain(scene, plan, trajectory));
            }
            results.early_stop = Some(early_stop);
            break;
        }
        previous = sample.q.first().copied();
        let value = |(i, column): (usize, &Column)| {
            let value = evaluator.value(column.quantity, &sample);
            if !column.unwraps() {
                return value;
            }
            let speed = match column.quantity {
                ColumnQuantity::Measured(measured @ CoordinateFunction::Angle(_), _) => {
                    evaluator.body_states.coordinate(measured)[1]
                }
                ColumnQuantity::BodyAngle(body, _) => {
                    evaluator.body_states.body(body).angular_velocity
                }
                _ => 0.0,
            };
            unwrapper.unwrap_angle(i, value, speed, sample.t)
        };
        let row = results.columns.iter().enumerate().map(value).collect();
        results.rows.push(row);
        results.body_poses.push(evaluator.body_poses());
        for sectioned_link in &mut results.sectioned_links {
            sectioned_link.add_position(
                k,
                &evaluator.body_forces,
                evaluator.model,
                &evaluator.workspace,
                &evaluator.wrenches,
            );
        }
        if matches!(analysis, Analysis::Kinetostatics | Analysis::FreeMotion)
            && evaluator.power_balance.scale > 0.0
        {
            let residual = evaluator.power_balance.residual().abs() / evaluator.power_balance.scale;
            results.power_residual = results.power_residual.max(residual);
        }
        if let Some(rounding_error) = &mut rounding_error {
            let t = if timed { sample.t } else { 0.0 };
            let rest = vec![0.0; sample.q.len()];
            let at = match analysis {
                Analysis::Statics => [sample.q.as_slice(), &rest, &rest],
                _ => [&sample.q, &sample.q_dot, &sample.q_ddot].map(Vec::as_slice),
            };
            rounding_error.add_position(k, model, t, at, &evaluator.inverse_dynamics);
        }
        on_position(k);
    }
    results.rounding_error = rounding_error.map(|rounding_error| rounding_error.max_relative());
    Ok(results)
}
