//! Names of the states of drives, and of sources of work.

use dwell_kinetostatics::{Drive, Motor};

/// Name, unit and meaning of each state of the drives.
pub(crate) fn drive_states<C: Copy>(
    drives: &[Drive<C>],
    is_angle: impl Fn(C) -> bool,
) -> Vec<(String, &'static str, &'static str)> {
    let state = |drive: &Drive<C>| {
        let [what, unit, meaning] = drive.kind.words(is_angle(drive.coordinate)).state?;
        Some((format!("{}.{what}", drive.name), unit, meaning))
    };
    drives.iter().filter_map(state).collect()
}

/// The motor of a drive that is one, given by its circuit; none of a motor given by its torque–speed line, whose circuit is not known, or whose
/// current makes no torque.
pub(crate) fn motor_of<C: Copy>(drive: &Drive<C>) -> Option<&Motor<C>> {
    drive.kind.motor().filter(|motor| {
        motor.torque_constant * motor.gear_ratio != 0.0 && !motor.is_torque_speed_line
    })
}

/// Name, unit and meaning of the quantities of motors other than states: the current of a motor without inductance, the
/// electrical power and the efficiency.
pub(crate) fn motor_columns<C: Copy>(
    drives: &[Drive<C>],
) -> Vec<(String, &'static str, &'static str)> {
    let mut all = Vec::new();
    for drive in drives {
        let Some(motor) = motor_of(drive) else {
            continue;
        };
        let name = |what: &str| format!("{}.{what}", drive.name);
        if motor.inductance <= 0.0 {
            all.push((name("current"), "A", "current of the motor"));
        }
        let power = "voltage times current; negative where the motor gives back";
        all.push((name("electrical_power"), "W", power));
        let efficiency = "mechanical power, before the rotor's inertia, over its sum with the loss in the resistance; 0 where the motor delivers none";
        all.push((name("efficiency"), "", efficiency));
    }
    all
}
