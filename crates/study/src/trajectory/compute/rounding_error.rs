//! Rounding error of a trajectory analysis: some positions are evaluated again in 32-digit arithmetic.

use crate::estimate::{error_scale, relative};
use crate::trajectory::compute::{Analysis, RowEvaluator, TrajectorySample, force_scales};
use dwell_kinetostatics::table::TableModel;
use dwell_kinetostatics::{InverseDynamics, MachineModel};
use dwell_numerics::{DoubleDouble, Scalar as _};

/// Number of positions that are evaluated again, along the whole trajectory.
const POSITIONS: usize = 48;

/// Numbers of a body: position, orientation, velocity, angular velocity, acceleration, angular acceleration.
pub(crate) type BodyNumbers<T> = [Vec<T>; 6];

/// The largest errors along a trajectory in the plane or in space, by kind of number: of positions, velocities and accelerations if no
/// forces are computed, otherwise of actuator forces and reactions.
pub struct LargestErrors {
    pub(crate) analysis: Analysis,
    stride: usize,
    /// Size of the mechanism, m.
    size: f64,
    /// By kind of the numbers of a body: the largest error and the largest value.
    motion: [[f64; 2]; 6],
    /// The errors of moments and of forces.
    forces: [[f64; 2]; 2],
    /// By actuator and by reaction: whether it is a force.
    is_force: [Vec<bool>; 2],
}

impl LargestErrors {
    /// For a trajectory of so many positions; none of a free motion, whose error is that of its integration.
    fn new(analysis: Analysis, points: usize, size: f64, is_force: [Vec<bool>; 2]) -> Option<Self> {
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
    fn include(&self, k: usize) -> bool {
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

    /// The largest error, relative to the largest value of its unit. A part that does not move has the error of those
    /// that do.
    fn max_relative(&self) -> f64 {
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

/// Estimated errors along a trajectory.
pub(crate) struct RoundingError<M: MachineModel> {
    largest: LargestErrors,
    precise: M::Workspace<DoubleDouble>,
}

impl<M: TableModel> RoundingError<M> {
    /// The estimate for a trajectory of this number of positions; `None` for a free motion.
    pub(super) fn new(
        evaluator: &impl RowEvaluator<Model = M>,
        analysis: Analysis,
        points: usize,
    ) -> Option<Self> {
        let model = evaluator.model();
        let actuators = (0..model.actuators()).map(|i| !model.is_angle(i));
        let reactions = (0..evaluator.result_reactions()).map(|k| model.reaction_unit(k) == "N");
        let is_force = [actuators.collect(), reactions.collect()];
        Some(Self {
            largest: LargestErrors::new(analysis, points, model.size(), is_force)?,
            precise: model.pass_workspace(),
        })
    }

    /// Adds position `k`, a sample that was evaluated last, with the loads at time `t`, if it is one of those evaluated again.
    pub(super) fn add_position(
        &mut self,
        k: usize,
        t: f64,
        sample: &TrajectorySample,
        evaluator: &impl RowEvaluator<Model = M>,
    ) {
        if self.largest.include(k) {
            let rest = vec![0.0; sample.q.len()];
            let at = sample.state(self.largest.analysis, &rest);
            evaluator.add_rounding(t, at, &mut self.precise, &mut self.largest);
        }
    }

    /// The largest error, relative to the largest value of its unit.
    pub(super) fn max_relative(&self) -> f64 {
        self.largest.max_relative()
    }
}
