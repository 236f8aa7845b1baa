//! Rounding error of a trajectory analysis: some positions are evaluated again in 32-digit arithmetic.

use crate::estimate::{error_scale, relative};
use crate::trajectory::compute::force_scales;
use dwell_kinetostatics::{InverseDynamics, Model, Workspace};
use dwell_numerics::DoubleDouble;
use dwell_scene::Scene;

/// Number of positions that are evaluated again, along the whole trajectory.
const POSITIONS: usize = 48;

/// Estimated errors of actuator forces and reactions, separately for forces and moments.
pub(crate) struct RoundingError {
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

impl RoundingError {
    /// For a trajectory of `points` positions.
    pub(crate) fn new(scene: &Scene, model: &Model, points: usize) -> Self {
        let actuators = scene.mechanism.actuators.iter();
        let reactions = model.reactions().iter();
        Self {
            stride: points.div_ceil(POSITIONS).max(1),
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

    /// Adds position `k`, at (t, q, q̇, q̈), if it is one of those evaluated again.
    pub(crate) fn add_position(
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

    /// The largest error, relative to the largest value of its unit.
    pub(crate) fn max_relative(&self) -> f64 {
        let [[moment_error, moment], [force_error, force]] = self.maxima;
        let references = force_scales(self.size, [force, moment], 0.0);
        let forces = relative(force_error, error_scale(force, references[0]));
        let moments = relative(moment_error, error_scale(moment, references[1]));
        moments.max(forces)
    }
}
