//! What direct-current motors take and deliver along a motion.

use crate::models::motor_of;
use dwell_dynamics::{Machine, MachineState, MovingModel};
use dwell_kinetostatics::Drive;

/// By motor among the drives of a machine, in the order of [`motor_columns`](crate::models::motor_columns): the current, A, of one without
/// inductance, whose current is no state; the electrical power, W; the efficiency. At the state `y` of the machine.
pub(crate) fn motor_values<M: MovingModel>(
    (machine, drives): (&Machine<M>, &[Drive<M::Coordinate>]),
    state: &MachineState<'_, f64, M>,
    y: &[f64],
) -> Vec<f64> {
    let mut values = Vec::new();
    if drives.is_empty() {
        return values;
    }
    let mut rates = vec![0.0; machine.state_count()];
    state.derivative(&mut rates);
    let mut states = machine.drive_states();
    for (d, drive) in drives.iter().enumerate() {
        let has_state = drive.kind.words(true).state.is_some();
        let rate = if has_state { states.next() } else { None };
        let Some(motor) = motor_of(drive) else {
            continue;
        };
        let measured = machine.model().coordinate_function(drive.coordinate);
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

/// The part of what a motor delivers and loses (W) that it delivers; zero where it delivers none, as when it brakes. What the
/// inductance stores and gives back is in neither.
fn efficiency(lost: f64, delivered: f64) -> f64 {
    match delivered > 0.0 {
        true => delivered / (delivered + lost),
        false => 0.0,
    }
}
