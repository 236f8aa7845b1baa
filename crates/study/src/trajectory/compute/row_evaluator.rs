//! The evaluator of the columns of a trajectory, in the plane or in space.

use crate::assembled::BodyStates;
use crate::bodies::BodyPose;
use crate::trajectory::compute::{LargestErrors, Quantity, StopCause, TrajectorySample};
use dwell_geometry::BodyId;
use dwell_kinetostatics::{InverseDynamics, LinkForces, MachineModel, ReducibleModel};
use dwell_numerics::DoubleDouble;

/// The memory for a position in 32 digits.
type PreciseWorkspace<M> = <M as ReducibleModel>::Workspace<DoubleDouble>;

/// Evaluates all quantities at one position after another.
pub trait RowEvaluator: Clone + Send + Sync {
    /// Its kind of model.
    type Model: MachineModel;

    /// Its model.
    fn model(&self) -> &Self::Model;

    /// Limits further evaluations to some quantities; parts that these do not need may be omitted.
    fn limit_to(&mut self, _: impl Iterator<Item = Quantity>) {}

    /// Goes on where the evaluator of another chart was last.
    fn continue_from(&mut self, _: &Self) {}

    /// Evaluates the position of a sample, with the loads at time `t`.
    fn evaluate(&mut self, sample: &TrajectorySample, t: f64) -> Result<(), StopCause>;

    /// Actuator forces and reactions at the position that was evaluated last.
    fn forces(&self) -> &InverseDynamics<f64>;

    /// The bodies there.
    fn bodies(&self) -> &impl BodyStates;

    /// The rotation of a body, rad about each axis.
    fn rotation(&self, body: BodyId) -> [f64; 3];

    /// A measured coordinate with its rate and acceleration.
    fn measured(&self, k: usize) -> [f64; 3];

    /// Power of actuators and loads, rate of the kinetic energy and the residual, W; the kinetic energy, J.
    fn power(&self) -> [f64; 5];

    /// The sum of the absolute terms of the power balance, W.
    fn power_scale(&self) -> f64;

    /// The power of a load, W.
    fn load_power(&self, load: usize) -> f64;

    /// A quantity of joints or of loads, or one that only the plane or only space has.
    fn other(&self, quantity: Quantity) -> f64;

    /// The poses of the bodies, where pictures are drawn by these.
    fn body_poses(&self) -> Vec<BodyPose> {
        Vec::new()
    }

    /// The internal forces of the requested links.
    fn link_forces(&self) -> &[Option<LinkForces>] {
        &[]
    }

    /// How many reactions of the model are results.
    fn result_reactions(&self) -> usize;

    /// Adds the errors of the position at (t, q, q̇, q̈) that was evaluated last.
    fn add_rounding(
        &self,
        t: f64,
        at: [&[f64]; 3],
        precise: &mut PreciseWorkspace<Self::Model>,
        largest: &mut LargestErrors,
    );

    /// The value of a column at the position that was evaluated last.
    fn value(&self, quantity: Quantity, sample: &TrajectorySample) -> f64 {
        match quantity {
            Quantity::Time => sample.t,
            // Of a chart of a free motion in another coordinate, the actuator's own.
            Quantity::ActuatorCoordinate(i, order) => match sample.actuator_coordinate {
                Some(own) => own[order],
                None => [&sample.q, &sample.q_dot, &sample.q_ddot][order][i],
            },
            Quantity::Extra(k) => sample.extra_values[k],
            Quantity::ActuatorForce(i) => self.forces().tau[i],
            Quantity::Reaction(k) => self.forces().reactions[k],
            Quantity::Measured(k, order) => self.measured(k)[order],
            Quantity::Rotation(body, 0, axis) => self.rotation(body)[axis],
            Quantity::Rotation(body, order, axis) => self.bodies().turning(body.0)[order - 1][axis],
            Quantity::Point(body, at, order, axis) => self.bodies().point(body.0, at)[order][axis],
            Quantity::Power(k) => self.power()[k],
            Quantity::LoadPower(k) => self.load_power(k),
            other => self.other(other),
        }
    }

    /// The rate of an angle that is unwrapped along the trajectory, rad/s.
    fn angular_velocity(&self, angle: Quantity) -> f64 {
        match angle {
            Quantity::Measured(k, _) => self.measured(k)[1],
            Quantity::Rotation(body, _, axis) => self.bodies().turning(body.0)[0][axis],
            _ => 0.0,
        }
    }
}
