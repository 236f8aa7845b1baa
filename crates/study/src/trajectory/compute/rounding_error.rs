//! Rounding error of a trajectory analysis: some positions are evaluated again in 32-digit arithmetic.

use crate::estimate::{error_scale, relative};
use crate::trajectory::compute::{Analysis, force_scales};
use dwell_geometry::BodyId;
use dwell_geometry::body_states::{BodyState, BodyStates};
use dwell_kinetostatics::{InverseDynamics, Model, Workspace};
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::Scene;

/// Number of positions that are evaluated again, along the whole trajectory.
const POSITIONS: usize = 48;

/// Estimated errors along a trajectory: of positions, velocities and accelerations where no forces are computed, else of
/// actuator forces and reactions.
pub(crate) enum RoundingError {
    Motion(Box<MotionRounding>),
    Forces(Box<ForceRounding>),
}

impl RoundingError {
    /// For a trajectory of `points` positions; none of a free motion, whose error is that of its integration.
    pub(crate) fn new(
        scene: &Scene,
        model: &Model,
        (analysis, points): (Analysis, usize),
    ) -> Option<Self> {
        // WebAssembly has no fused multiply–add, on which these numbers are built: the estimate would take most of the time.
        if cfg!(target_family = "wasm") {
            return None;
        }
        let stride = points.div_ceil(POSITIONS).max(1);
        match analysis {
            Analysis::Kinematics => {
                let rounding = MotionRounding::new(scene, model, stride);
                Some(Self::Motion(Box::new(rounding)))
            }
            Analysis::Statics | Analysis::Kinetostatics => {
                let rounding = ForceRounding::new(scene, model, stride);
                Some(Self::Forces(Box::new(rounding)))
            }
            Analysis::FreeMotion => None,
        }
    }

    /// Adds position `k`, at (t, q, q̇, q̈), if it is one of those evaluated again.
    pub(crate) fn add_position(
        &mut self,
        k: usize,
        model: &Model,
        t: f64,
        at: [&[f64]; 3],
        inverse_dynamics: &InverseDynamics<f64>,
    ) {
        match self {
            Self::Motion(rounding) => rounding.add_position(k, model, at),
            Self::Forces(rounding) => rounding.add_position(k, model, t, at, inverse_dynamics),
        }
    }

    /// The largest error, relative to the largest value of its unit.
    pub(crate) fn max_relative(&self) -> f64 {
        match self {
            Self::Motion(rounding) => rounding.max_relative(),
            Self::Forces(rounding) => rounding.max_relative(),
        }
    }
}

/// Numbers of a body: position, orientation, velocity, angular velocity, acceleration, angular acceleration.
const BODY_NUMBERS: usize = 6;

/// Estimated errors of the states of all bodies, by unit.
pub(crate) struct MotionRounding {
    stride: usize,
    plain: Workspace<f64>,
    precise: Workspace<DoubleDouble>,
    /// The largest error and the largest value of each kind.
    maxima: [[f64; 2]; BODY_NUMBERS],
    /// Size of the mechanism, m.
    size: f64,
}

impl MotionRounding {
    fn new(scene: &Scene, model: &Model, stride: usize) -> Self {
        Self {
            stride,
            plain: model.workspace(),
            precise: model.workspace(),
            maxima: [[0.0; 2]; BODY_NUMBERS],
            size: scene.mechanism.size(),
        }
    }

    fn add_position(&mut self, k: usize, model: &Model, at: [&[f64]; 3]) {
        if !k.is_multiple_of(self.stride) {
            return;
        }
        let (plain, precise) = (&mut self.plain, &mut self.precise);
        // Next to a limit position there may be a pose in double precision and none in 32 digits.
        let (Some(plain), Some(precise)) =
            (states_at(model, at, plain), states_at(model, at, precise))
        else {
            return;
        };
        for body in (0..plain.len()).map(BodyId) {
            let each = numbers(plain.body(body))
                .into_iter()
                .zip(numbers(precise.body(body)));
            for ([max_error, max_value], (plain, precise)) in self.maxima.iter_mut().zip(each) {
                for (value, precise) in plain.into_iter().zip(precise) {
                    let error = (precise - DoubleDouble::from_f64(value)).value().abs();
                    *max_error = max_error.max(error);
                    *max_value = max_value.max(value.abs());
                }
            }
        }
    }

    /// The largest error, relative to the largest value of its unit. What does not move has the error of what does.
    fn max_relative(&self) -> f64 {
        let [position, orientation, linear @ ..] = self.maxima;
        let position = relative(position[0], position[1].max(self.size));
        let mut largest = position.max(orientation[0]);
        for [[error, value], [angular_error, angular]] in
            [[linear[0], linear[1]], [linear[2], linear[3]]]
        {
            let references = [self.size * angular, value / self.size];
            largest = largest
                .max(relative(error, error_scale(value, references[0])))
                .max(relative(angular_error, error_scale(angular, references[1])));
        }
        largest
    }
}

/// The states of all bodies at (q, q̇, q̈) in a kind of number; none where there is no pose.
fn states_at<'w, T: Scalar>(
    model: &'w Model,
    at: [&[f64]; 3],
    workspace: &'w mut Workspace<T>,
) -> Option<BodyStates<T>> {
    let [q, q_dot, q_ddot] =
        at.map(|values| -> Vec<T> { values.iter().map(|&v| T::from_f64(v)).collect() });
    let mut state = model.kinematic_state(&q, &q_dot, workspace).ok()?;
    Some(state.bodies_at(&q_ddot).clone())
}

/// The numbers of a body, by kind.
fn numbers<T: Scalar>(body: &BodyState<T>) -> [[T; 2]; BODY_NUMBERS] {
    let zero = T::from_f64(0.0);
    [
        [body.joint_origin.x, body.joint_origin.y],
        [body.rotation.x, body.rotation.y],
        [body.velocity.x, body.velocity.y],
        [body.angular_velocity, zero],
        [body.acceleration.x, body.acceleration.y],
        [body.angular_acceleration, zero],
    ]
}

/// Estimated errors of actuator forces and reactions, separately for forces and moments.
pub(crate) struct ForceRounding {
    stride: usize,
    workspace: Workspace<DoubleDouble>,
    errors: InverseDynamics<f64>,
    /// By actuator and by reaction: whether it is a force.
    is_force: [Vec<bool>; 2],
    /// The largest error and the largest value, of moments and of forces.
    maxima: [[f64; 2]; 2],
    /// Size of the mechanism, m.
    size: f64,
}

impl ForceRounding {
    fn new(scene: &Scene, model: &Model, stride: usize) -> Self {
        let actuators = scene.mechanism.actuators.iter();
        let reactions = model.reactions().iter();
        Self {
            stride,
            workspace: model.workspace(),
            errors: model.result_buffer(),
            is_force: [
                actuators.map(|a| !a.coordinate().is_angle()).collect(),
                reactions.map(|r| r.component.unit() == "N").collect(),
            ],
            maxima: [[0.0; 2]; 2],
            size: scene.mechanism.size(),
        }
    }

    fn add_position(
        &mut self,
        k: usize,
        model: &Model,
        t: f64,
        at: [&[f64]; 3],
        inverse_dynamics: &InverseDynamics<f64>,
    ) {
        if !k.is_multiple_of(self.stride) {
            return;
        }
        let (workspace, errors) = (&mut self.workspace, &mut self.errors);
        // Next to a limit position there may be a pose in double precision and none in 32 digits.
        let Ok(()) =
            model.kinetostatics_rounding_errors(t, at, inverse_dynamics, workspace, errors)
        else {
            return;
        };
        let errors = [&self.errors.tau, &self.errors.reactions];
        let values = [&inverse_dynamics.tau, &inverse_dynamics.reactions];
        for ((errors, values), forces) in errors.into_iter().zip(values).zip(&self.is_force) {
            for ((error, value), &force) in errors.iter().zip(values).zip(forces) {
                let [max_error, max_value] = &mut self.maxima[usize::from(force)];
                *max_error = max_error.max(*error);
                *max_value = max_value.max(value.abs());
            }
        }
    }

    fn max_relative(&self) -> f64 {
        let [[moment_error, moment], [force_error, force]] = self.maxima;
        let references = force_scales(self.size, [force, moment], 0.0);
        let forces = relative(force_error, error_scale(force, references[0]));
        let moments = relative(moment_error, error_scale(moment, references[1]));
        moments.max(forces)
    }
}
