//! The source of the coordinates along which an analysis is evaluated, for a scene in the plane or in space.

use crate::explain::{StudyError, labels, missing_section_label, scene_error};
use crate::number_format::count;
use crate::trajectory::compute::{Analysis, SweepLimits};
use dwell_geometry::ActuatorId;
use dwell_scene::{CoordinateSweep, PrescribedMotion, SceneFile, SceneLocation};

/// The source of the coordinates along which an analysis is evaluated.
pub struct FollowedScene<'a> {
    pub(crate) file: &'a SceneFile,
    pub(crate) prescribed: Option<&'a PrescribedMotion>,
    pub(crate) sweep: Option<&'a CoordinateSweep>,
    /// By actuator: its name, and whether its coordinate is an angle.
    pub(crate) coordinates: Vec<(&'a str, bool)>,
    /// By actuator: its coordinate at assembly, rad or m.
    pub(crate) start: Vec<f64>,
    /// Period of the pose in the coordinate of the only actuator, rad.
    pub(crate) period: Option<f64>,
    /// The followed range of the only actuator.
    pub(crate) default_limits: Option<SweepLimits>,
}

impl FollowedScene<'_> {
    /// The error of a scene that prescribes no actuator coordinates.
    pub(super) fn no_trajectory(&self, analysis: Analysis) -> StudyError {
        if self.coordinates.is_empty() {
            let message = "the scene has no actuators, so nothing moves";
            let help = "declare an independent coordinate, as in `[actuators.phi]`; a structure, which has none, is described by \
                        `dwell check`";
            return scene_error(self.file, message, help, missing_section_label("actuators"));
        }
        let message = match analysis {
            Analysis::Kinetostatics => {
                "the scene prescribes no motion, so there are no accelerations".to_owned()
            }
            Analysis::Kinematics | Analysis::Statics | Analysis::FreeMotion => {
                let given = count(self.coordinates.len(), "actuator");
                format!("the scene has {given} and no coordinates for them")
            }
        };
        let example = self.coordinates.first().map_or("phi", |(name, _)| name);
        let help = format!(
            "add [prescribed] with a `duration` and a law for each, as in `{example} = {{ speed = 1.0 }}`; or \
             [coordinate-sweep] with a range for one of them, as in `{example} = [0.0, 1.0]`"
        );
        let actuators = (0..self.coordinates.len()).map(ActuatorId);
        let places = labels(
            actuators.map(SceneLocation::Actuator),
            "no coordinate is given",
        );
        scene_error(self.file, message, help, places)
    }

    /// The error of a swept length that has no limits, in a mechanism with several actuators.
    pub(super) fn open_sweep(&self, actuator: usize) -> StudyError {
        let (name, _) = self.coordinates[actuator];
        scene_error(
            self.file,
            format!("[coordinate-sweep] gives no range for `{name}`"),
            format!("add `{name} = [from, to]`: the range is computed for a single actuator only"),
            [(SceneLocation::CoordinateSweep, "no range")],
        )
    }
}
