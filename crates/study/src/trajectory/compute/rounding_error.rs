//! Rounding error of a trajectory analysis: some positions are evaluated again in 32-digit arithmetic.

use crate::estimate::{error_scale, relative};
use crate::trajectory::compute::{Analysis, force_scales};
use dwell_geometry::BodyId;
use dwell_geometry::body_states::{BodyState, BodyStates};
use dwell_kinetostatics::{InverseDynamics, Model, Workspace};
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::PlaneScene;

/// Number of positions that are evaluated again, along the whole trajectory.
const POSITIONS: usize = 48;

/// Numbers of a body: position, orientation, velocity, angular velocity, acceleration, angular acceleration.
pub(crate) type BodyNumbers<T> = [Vec<T>; 6];

/// The largest errors along a trajectory in the plane or in space, by kind of number: of positions, velocities and accelerations where
/// no forces are computed, else of actuator forces and reactions.
pub(crate) struct LargestErrors {
    pub(crate) analysis: Analysis,
    stride: usize,
    /// Size of the mechanism, m.
    size: f64,
    /// By kind of the numbers of a body: the largest error and the largest value.
    motion: [[f64; 2]; 6],
    /// The same of moments and of forces.
    forces: [[f64; 2]; 2],
    /// By actuator and by reaction: whether it is a force.
    is_force: [Vec<bool>; 2],
}

impl LargestErrors {
    /// For a trajectory of so many positions; none of a free motion, whose error is that of its integration.
    pub(crate) fn new(
        (analysis, points): (Analysis, usize),
        size: f64,
        is_force: [Vec<bool>; 2],
    ) -> Option<Self> {
        // WebAssembly has no fused multiply–add, on which these numbers are built: the estimate would take most of the time.
        let is_estimated = !cfg!(target_family = "wasm") && analysis != Analysis::FreeMotion;
        is_estimated.then(|| Self {
            analysis,
            stride: points.div_ceil(POSITIONS).max(1),
            size,
            motion: [[0.0; 2]; 6],
            forces: [[0.0; 2]; 2],
            is_force,
        })
    }

    /// Whether the `k`th position is one of those evaluated again.
    pub(crate) fn include(&self, k: usize) -> bool {
        k.is_multiple_of(self.stride)
    }

    /// Adds the numbers of a body.
    pub(crate) fn add_body(&mut self, plain: BodyNumbers<f64>, precise: BodyNumbers<DoubleDouble>) {
        let each = plain.into_iter().zip(precise);
        for (largest, (plain, precise)) in self.motion.iter_mut().zip(each) {
            for (value, precise) in plain.into_iter().zip(precise) {
                let error = (precise - DoubleDouble::from_f64(value)).value().abs();
                add(largest, error, value);
            }
        }
    }

    /// Adds actuator forces and reactions with their errors.
    pub(crate) fn add_forces(&mut self, found: &InverseDynamics<f64>, errors: [&[f64]; 2]) {
        let values = [&found.tau, &found.reactions].into_iter().zip(errors);
        for ((values, errors), forces) in values.zip(&self.is_force) {
            for ((value, error), &force) in values.iter().zip(errors).zip(forces) {
                add(&mut self.forces[usize::from(force)], *error, *value);
            }
        }
    }

    /// The largest error, relative to the largest value of its unit. What does not move has the error of what does.
    pub(crate) fn max_relative(&self) -> f64 {
        let pair =
            |[error, value]: [f64; 2], [other_error, other]: [f64; 2], references: [f64; 2]| {
                let one = relative(error, error_scale(value, references[0]));
                one.max(relative(other_error, error_scale(other, references[1])))
            };
        if self.analysis != Analysis::Kinematics {
            let [moment, force] = self.forces;
            return pair(
                force,
                moment,
                force_scales(self.size, [force[1], moment[1]], 0.0),
            );
        }
        let [position, orientation, linear @ ..] = self.motion;
        let position = relative(position[0], position[1].max(self.size));
        let mut largest = position.max(orientation[0]);
        for [linear, angular] in [[linear[0], linear[1]], [linear[2], linear[3]]] {
            let references = [self.size * angular[1], linear[1] / self.size];
            largest = largest.max(pair(linear, angular, references));
        }
        largest
    }
}

fn add([max_error, max_value]: &mut [f64; 2], error: f64, value: f64) {
    *max_error = max_error.max(error);
    *max_value = max_value.max(value.abs());
}

/// Estimated errors along a trajectory in the plane.
pub(crate) struct RoundingError<'a> {
    model: &'a Model,
    largest: LargestErrors,
    plain: Workspace<f64>,
    precise: Workspace<DoubleDouble>,
    errors: InverseDynamics<f64>,
}

impl<'a> RoundingError<'a> {
    /// For a trajectory of so many positions; none of a free motion.
    pub(crate) fn new(scene: &PlaneScene, model: &'a Model, of: (Analysis, usize)) -> Option<Self> {
        let actuators = scene.mechanism.actuators.iter();
        let reactions = model.reactions().iter();
        let is_force = [
            actuators.map(|a| !a.coordinate().is_angle()).collect(),
            reactions.map(|r| r.component.unit() == "N").collect(),
        ];
        Some(Self {
            model,
            largest: LargestErrors::new(of, scene.mechanism.size(), is_force)?,
            plain: model.workspace(),
            precise: model.workspace(),
            errors: model.result_buffer(),
        })
    }

    /// Adds position `k`, at (t, q, q̇, q̈), if it is one of those evaluated again.
    pub(crate) fn add_position(
        &mut self,
        (k, t): (usize, f64),
        at: [&[f64]; 3],
        found: &InverseDynamics<f64>,
    ) {
        if !self.largest.include(k) {
            return;
        }
        let (model, precise, errors) = (self.model, &mut self.precise, &mut self.errors);
        // Next to a limit position there may be a pose in double precision and none in 32 digits.
        if self.largest.analysis != Analysis::Kinematics {
            let known = model.kinetostatics_rounding_errors(t, at, found, precise, errors);
            if known.is_ok() {
                let errors = [&errors.tau[..], &errors.reactions];
                self.largest.add_forces(found, errors);
            }
        } else if let (Some(plain), Some(precise)) = (
            states_at(model, at, &mut self.plain),
            states_at(model, at, precise),
        ) {
            for body in (0..plain.len()).map(BodyId) {
                let precise = numbers(precise.body(body));
                self.largest.add_body(numbers(plain.body(body)), precise);
            }
        }
    }

    /// The largest error, relative to the largest value of its unit.
    pub(crate) fn max_relative(&self) -> f64 {
        self.largest.max_relative()
    }
}

/// The states of all bodies at (q, q̇, q̈) in a kind of number; none where there is no pose.
fn states_at<T: Scalar>(
    model: &Model,
    at: [&[f64]; 3],
    workspace: &mut Workspace<T>,
) -> Option<BodyStates<T>> {
    let [q, q_dot, q_ddot] =
        at.map(|values| -> Vec<T> { values.iter().map(|&v| T::from_f64(v)).collect() });
    let mut state = model.kinematic_state(&q, &q_dot, workspace).ok()?;
    Some(state.bodies_at(&q_ddot).clone())
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
