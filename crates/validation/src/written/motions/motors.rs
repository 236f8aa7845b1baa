//! What motors take and what they deliver: their columns of electrical power with voltage and current of the scene's text, and of efficiency
//! with the power at the shaft.

use super::row_forces::MotionReading;
use crate::written::poses::difference::Differences;
use crate::written::poses::motion::Motion;
use crate::written::poses::rows::{Rows, largest};

/// Differences of the columns of motors.
#[derive(Debug, Default)]
pub(super) struct Motors {
    /// Electrical power with that of the circuit in the scene's text, W.
    pub(super) electrical: Differences,
    /// The delivered part: the efficiency times what is not stored, with the power at the shaft by the columns of the force, W.
    pub(super) delivered: Differences,
}

/// The columns of all motors that are given by their circuit; one given by its torque–speed line has none.
pub(super) fn motors(motion: &MotionReading, rows: &Rows, file: &str) -> Motors {
    let mut found = Motors::default();
    for drive in &motion.drives {
        if !drive.has_circuit() {
            // Of one given by its torque–speed line nobody knows them.
            for end in ["current", "electrical_power", "efficiency"] {
                let name = format!("{}.{end}", drive.name);
                if rows.columns.contains_key(&name) {
                    found
                        .electrical
                        .fail(format!("{file}: `{name}` of a drive without a circuit"));
                }
            }
            continue;
        }
        let column = |end: &str| rows.columns.get(&format!("{}.{end}", drive.name));
        let (Some(taken), Some(efficiency)) = (column("electrical_power"), column("efficiency"))
        else {
            found
                .electrical
                .fail(format!("{file}: no electrical power of `{}`", drive.name));
            continue;
        };
        let scale = largest(taken);
        for (row, (taken, efficiency)) in taken.iter().zip(efficiency).enumerate() {
            let Some(state) = Motion::new(&motion.reading, rows, row) else {
                continue;
            };
            let place = || format!("{file}, row {row}, `{}`", drive.name);
            let Some(circuit) = drive.circuit(&state) else {
                continue;
            };
            let lost = circuit.resistance * circuit.current * circuit.current;
            let difference = taken - circuit.voltage * circuit.current;
            found.electrical.add(difference, scale, "W", place);
            if let Some(written) = state.get(&format!("{}.current", drive.name)) {
                let difference = (written - circuit.current) * circuit.voltage;
                found.electrical.add(difference, scale, "W", place);
            }
            let [_, speed, acceleration] = state.measure(drive.measure).0;
            let Some(net) = drive.written_force(&state) else {
                continue;
            };
            // With what accelerates the rotor.
            let delivered = (net + drive.rotor_inertia * acceleration) * speed;
            // None is delivered by a motor that brakes.
            let difference = match delivered > 0.0 {
                true => efficiency * (delivered + lost) - delivered,
                false => efficiency * scale,
            };
            found.delivered.add(difference, scale, "W", place);
        }
    }
    found
}
