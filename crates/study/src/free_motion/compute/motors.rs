//! What direct-current motors take and deliver along a motion.

use crate::free_motion::compute::FreeMotionProblem;
use crate::models::motor_of;
use dwell_dynamics::{Machine, MachineState};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_kinetostatics::DriveKind;

impl FreeMotionProblem<'_> {
    /// By motor of the scene, in the order of [`motor_columns`](crate::models::motor_columns): the current, A, of one without
    /// inductance, whose current is no state; the electrical power, W; the efficiency.
    pub(super) fn motor_values(
        &self,
        machine: &Machine,
        state: &MachineState<'_>,
        (y, rates): (&[f64], &[f64]),
    ) -> Vec<f64> {
        let (drives, scene) = (&self.loaded_scene.drives, self.loaded_scene);
        let mut values = Vec::new();
        let mut states = machine.drive_states();
        for (d, drive) in drives.iter().enumerate() {
            let has_state = match &drive.kind {
                DriveKind::Motor(motor) => motor.inductance > 0.0,
                DriveKind::SpeedController(controller) => controller.integral_gain > 0.0,
                DriveKind::AppliedForce(_) => false,
            };
            let rate = if has_state { states.next() } else { None };
            let Some(motor) = motor_of(drive) else {
                continue;
            };
            let measured = CoordinateFunction::find(&scene.mechanism, drive.coordinate);
            let speed = measured.map_or(f64::NAN, |measured| state.coordinate(measured)[1]);
            // Before the inertia of the rotor.
            let force = state.drive_forces()[d];
            let constant = motor.torque_constant * motor.gear_ratio;
            let (current, current_rate) = match rate {
                Some(k) => (y[k], rates[k]),
                None => (force / constant, 0.0),
            };
            let voltage =
                motor.resistance * current + motor.inductance * current_rate + constant * speed;
            let (taken, delivered) = (voltage * current, force * speed);
            if !has_state {
                values.push(current);
            }
            values.push(taken);
            values.push(efficiency(motor.resistance * current * current, delivered));
        }
        values
    }
}

/// The part of what a motor delivers and loses (W) that it delivers; zero where it delivers none, as when it brakes. What the
/// inductance stores and gives back is in neither.
fn efficiency(lost: f64, delivered: f64) -> f64 {
    match delivered > 0.0 {
        true => delivered / (delivered + lost),
        false => 0.0,
    }
}
