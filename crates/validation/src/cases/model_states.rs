//! States of motion by a scene's model, under its loads: the claims that the checks of states are applied to.

use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{ActuatorId, BodyId, Pose, Vec2};
use dwell_kinetostatics::{
    EvaluatedState, InverseDynamics, KinematicState, MachineModel, Model, Workspace,
};
use dwell_numerics::Scalar;
use dwell_scene::{PlaneScene, SceneLocation};
use dwell_study::StudyError;
use dwell_study::explain::{explain_motion, explain_position};
use dwell_study::models::loaded_model;
use dwell_verify::{
    ClaimedState, Pose as BodyPose, Twist, condition_number, load_wrenches, magnitude_by_reactions,
};
use std::f64::consts::TAU;

/// Between two positions no coordinate changes by more than this, rad, or this part of the size:
/// then no body rotates by half a revolution, and whole revolutions are counted.
const MAX_COORDINATE_STEP: f64 = 0.1;

/// A state of motion to be evaluated: time (s), coordinates, velocities and accelerations (rad or
/// m, per s, per s²). Without accelerations it is one of free motion: without actuator forces.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StateRequest {
    pub(crate) t: f64,
    pub(crate) q: Vec<f64>,
    pub(crate) q_dot: Vec<f64>,
    pub(crate) q_ddot: Option<Vec<f64>>,
}

/// A scene's model with every reaction, under its loads, stepping from state to state.
#[derive(Debug)]
pub(crate) struct ModelStates<'a> {
    scene: &'a PlaneScene,
    pub(crate) model: Model,
    reached: ReachedPose,
    /// By body: its angle, rad, whole revolutions counted from the assembly on.
    angles: Vec<f64>,
    /// The coordinates, rad or m, and the largest step of each.
    coordinates: Vec<f64>,
    coordinate_steps: Vec<f64>,
    /// Where all bodies are as assembled.
    pub(crate) assembly_poses: Vec<BodyPose>,
}

/// The pose that was reached, with the memory to evaluate states of motion there.
#[derive(Debug)]
struct ReachedPose {
    pose: Pose<f64>,
    workspace: Workspace<f64>,
    result: InverseDynamics<f64>,
}

impl ReachedPose {
    fn evaluate<'s>(
        &'s mut self,
        scene: &PlaneScene,
        model: &'s Model,
        StateRequest { t, q_dot, .. }: &StateRequest,
        q_ddot: &[f64],
    ) -> Result<EvaluatedState<'s>, StudyError> {
        let state = kinematic_state(model, &self.pose, q_dot, &mut self.workspace);
        let loaded = state.apply_loads(*t);
        let evaluated = loaded.and_then(|state| state.evaluate(q_ddot, &mut self.result));
        evaluated.map_err(|e| explain_motion(scene, model.plan(), &e.into()))
    }
}

/// The velocities at a pose.
fn kinematic_state<'s>(
    model: &'s Model,
    reached: &Pose<f64>,
    q_dot: &[f64],
    workspace: &'s mut Workspace<f64>,
) -> KinematicState<'s> {
    model.given_kinematic_state(q_dot, workspace, |pose, motion| {
        pose.clone_from(reached);
        model.plan().velocities(pose, q_dot, motion);
    })
}

/// A state of motion that was evaluated.
#[derive(Debug)]
pub(crate) struct StateValues<'m> {
    pub(crate) scene: &'m PlaneScene,
    pub(crate) state: EvaluatedState<'m>,
    pub(crate) q_ddot: Vec<f64>,
    /// The frames of all bodies.
    body_poses: Vec<[f64; 3]>,
    /// By body: its angle with whole revolutions, rad.
    pub(crate) angles: &'m [f64],
}

impl StateValues<'_> {
    /// The frames of all bodies, their angles with whole revolutions.
    fn counted_frames(&self) -> Vec<[f64; 3]> {
        let both = self.body_poses.iter().zip(self.angles);
        both.map(|(&[x, y, _], angle)| [x, y, *angle]).collect()
    }

    /// Condition number of the dense rows.
    pub(crate) fn condition_number(&self) -> f64 {
        condition_number(&self.scene.mechanism, &self.body_poses)
    }
}

impl<'a> ModelStates<'a> {
    /// Compiles a scene for all reactions, at its assembly.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be put together or a load does not fit.
    pub(crate) fn new(scene: &'a PlaneScene) -> Result<Self, StudyError> {
        let model = loaded_model(scene)?;
        let size = scene.mechanism.size();
        let step = |a: usize| match model.plan().is_angle(a) {
            true => MAX_COORDINATE_STEP,
            false => MAX_COORDINATE_STEP * size,
        };
        let mut model_states = Self {
            scene,
            reached: ReachedPose {
                pose: model.plan().pose(),
                workspace: model.workspace(),
                result: model.result_buffer(),
            },
            angles: Vec::new(),
            coordinates: scene.assembly.coordinates.clone(),
            coordinate_steps: (0..model.plan().actuators()).map(step).collect(),
            assembly_poses: Vec::new(),
            model,
        };
        model_states.set_coordinates(&scene.assembly.coordinates)?;
        model_states.assembly_poses = BodyPose::all_in_plane(&model_states.body_poses());
        let angles = model_states.assembly_poses.iter().map(|pose| pose.angle);
        model_states.angles = angles.collect();
        Ok(model_states)
    }

    /// A state as it is claimed.
    ///
    /// # Errors
    /// As [`ModelStates::evaluate_at`].
    pub(crate) fn state(&mut self, request: &StateRequest) -> Result<ClaimedState, StudyError> {
        let values = self.evaluate_at(request)?;
        let bodies = values.counted_frames();
        let (scene, state) = (values.scene, &values.state);
        let (states, result) = (state.bodies(), state.inverse_dynamics());
        let motion = claimed_motion(&bodies, states);
        let velocities: Vec<_> = motion.velocities.iter().map(Twist::in_plane).collect();
        let loads = scene.loads.iter().zip(&state.loads().magnitude);
        let (ground, masses) = (scene.mechanism.ground, &scene.masses);
        let reactions = &result.reactions;
        let loads = loads.filter_map(|(load, &magnitude)| {
            let magnitude = magnitude_by_reactions(load, magnitude, &scene.mechanism, reactions);
            load_wrenches(&load.kind, magnitude, ground, masses, &bodies, &velocities)
        });
        Ok(ClaimedState {
            name: format!("t = {} s", request.t),
            t: request.t,
            q: request.q.clone(),
            q_dot: request.q_dot.clone(),
            load_wrenches: loads.flatten().collect(),
            q_ddot: values.q_ddot,
            reactions: reactions.clone(),
            tau: result.tau.clone(),
            ..motion
        })
    }

    /// The generalised inertias at the last state, by unit accelerations, row by row.
    pub(crate) fn mass_matrix(&mut self) -> Vec<f64> {
        let at_rest = vec![0.0; self.coordinate_steps.len()];
        let ReachedPose {
            pose, workspace, ..
        } = &mut self.reached;
        mass_matrix(
            &self.model,
            &mut kinematic_state(&self.model, pose, &at_rest, workspace),
        )
    }

    /// Steps to a state and evaluates it.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when it cannot be reached, or a load has no magnitude or direction
    /// there.
    pub(crate) fn evaluate_at(
        &mut self,
        request: &StateRequest,
    ) -> Result<StateValues<'_>, StudyError> {
        self.step_to(&request.q)?;
        let q_ddot = match &request.q_ddot {
            Some(given) => given.clone(),
            None => self.free_acceleration(request)?,
        };
        let (scene, angles, body_poses) = (self.scene, &self.angles, self.body_poses());
        let state = self
            .reached
            .evaluate(scene, &self.model, request, &q_ddot)?;
        Ok(StateValues {
            scene,
            state,
            q_ddot,
            body_poses,
            angles,
        })
    }

    /// Steps to a position in equal steps, counting the whole revolutions of every body.
    ///
    /// # Errors
    /// As [`ModelStates::evaluate_at`].
    pub(crate) fn step_to(&mut self, to: &[f64]) -> Result<(), StudyError> {
        let from = self.coordinates.clone();
        let distances = from.iter().zip(to).zip(&self.coordinate_steps);
        let counts = distances.map(|((a, b), stride)| ((b - a) / stride).abs().ceil());
        let steps = counts.fold(1.0, f64::max);
        for k in 1..=steps as usize {
            let fraction = k as f64 / steps;
            let between = from.iter().zip(to).map(|(a, b)| a + fraction * (b - a));
            let q = if fraction == 1.0 {
                to.to_vec()
            } else {
                between.collect()
            };
            self.set_coordinates(&q)?;
            let poses = self.body_poses();
            for (angle, pose) in self.angles.iter_mut().zip(poses) {
                *angle = pose[2] + ((*angle - pose[2]) / TAU).round() * TAU;
            }
        }
        self.coordinates = to.to_vec();
        Ok(())
    }

    fn set_coordinates(&mut self, q: &[f64]) -> Result<(), StudyError> {
        let plan = self.model.plan();
        let done = plan.positions(q, &mut self.reached.pose);
        done.map_err(|e| explain_position(self.scene, plan, &e))
    }

    /// The frames of all bodies at the position that was reached.
    pub(crate) fn body_poses(&self) -> Vec<[f64; 3]> {
        let plan = self.model.plan();
        plan.body_frames(&self.scene.mechanism, &self.reached.pose)
    }

    /// The acceleration without actuator force, which is linear in it.
    fn free_acceleration(&mut self, request: &StateRequest) -> Result<Vec<f64>, StudyError> {
        if self.coordinate_steps.len() != 1 {
            let actuator = SceneLocation::Actuator(ActuatorId(0));
            let message = "a free motion is only that of one actuator".to_owned();
            let label = (actuator, "one of several".to_owned());
            return Err(self.scene.error(message, None, &[label]).into());
        }
        let (scene, model, reached) = (self.scene, &self.model, &mut self.reached);
        let mut tau = |q_ddot: f64| -> Result<f64, StudyError> {
            let state = reached.evaluate(scene, model, request, &[q_ddot])?;
            Ok(state.inverse_dynamics().tau[0])
        };
        let at_rest = tau(0.0)?;
        let mut found = -at_rest / (tau(1.0)? - at_rest);
        // Once more from there: the difference above is rounded relative to the loads.
        let remaining = tau(found)?;
        if at_rest != 0.0 {
            found += remaining * found / at_rest;
        }
        Ok(vec![found])
    }
}

/// The generalised inertias of a state by unit accelerations, row by row.
pub(crate) fn mass_matrix<T: Scalar, M: MachineModel>(
    model: &M,
    state: &mut KinematicState<'_, T, M>,
) -> Vec<f64> {
    let (n, mut run) = (model.actuators(), model.result_buffer());
    let mut inertias = vec![0.0; n * n];
    for j in 0..n {
        state.mass_matrix_column(j, &mut run);
        for (i, tau) in run.tau.iter().enumerate() {
            inertias[i * n + j] = tau.value();
        }
    }
    inertias
}

/// What is claimed of the motion of all bodies in the plane, whose frames are these.
pub fn claimed_motion<T: Scalar>(frames: &[[f64; 3]], states: &BodyStates<T>) -> ClaimedState {
    let twist = |linear: Vec2<T>, angular: T| {
        Twist::from([linear.x, linear.y, angular].map(|part| part.value()))
    };
    let rates = |b: usize| {
        let (body, at) = (states.body(BodyId(b)), states.point(BodyId(b), Vec2::ZERO));
        let velocity = twist(at.velocity, body.angular_velocity);
        (velocity, twist(at.acceleration, body.angular_acceleration))
    };
    let (velocities, accelerations) = (0..frames.len()).map(rates).unzip();
    ClaimedState {
        poses: BodyPose::all_in_plane(frames),
        velocities,
        accelerations,
        ..ClaimedState::default()
    }
}
