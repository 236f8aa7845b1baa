//! Names of what a machine has besides its mechanism: states of drives, and sources of work.

use crate::number_format::coordinate_unit;
use dwell_dynamics::NonconservativeSource;
use dwell_kinetostatics::DriveKind;
use dwell_scene::Scene;

/// Name, unit and meaning of each state of the drives.
pub(crate) fn drive_states(scene: &Scene) -> Vec<(String, &'static str, &'static str)> {
    let state = |drive: &dwell_kinetostatics::Drive| match &drive.kind {
        DriveKind::Motor(motor) if motor.inductance > 0.0 => {
            Some((format!("{}.current", drive.name), "A", ""))
        }
        DriveKind::SpeedController(controller) if controller.integral_gain > 0.0 => {
            let unit = coordinate_unit(drive.coordinate.is_angle());
            let meaning = "integral of the controller error";
            Some((format!("{}.integral", drive.name), unit, meaning))
        }
        DriveKind::Motor(_) | DriveKind::SpeedController(_) | DriveKind::AppliedForce(_) => None,
    };
    scene.drives.iter().filter_map(state).collect()
}

/// The name of what does work on a machine.
pub(crate) fn source_name(scene: &Scene, source: NonconservativeSource) -> &str {
    match source {
        NonconservativeSource::Load(load) => &scene.loads[load].name,
        NonconservativeSource::Drive(drive) => &scene.drives[drive].name,
        NonconservativeSource::Stop(stop) => &scene.stops[stop].name,
        NonconservativeSource::Prescribed(actuator) => &scene.mechanism.actuators[actuator].name,
    }
}
