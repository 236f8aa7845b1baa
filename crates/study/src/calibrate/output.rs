//! Writes a calibration: its summary.

use crate::calibrate::compute::find_value;
use crate::explain::{StudyError, missing_section_label, scene_error};
use crate::models::PreparedScene;
use crate::number_format::digits;
use crate::output::Outcome;
use dwell_scene::Scene;

/// `dwell calibrate`, with the path and the period of the scene's `[calibration]` where none is given.
///
/// # Errors
/// As [`find_value`]; when neither the caller nor the scene gives path and period; when a length is
/// driven or there are loads.
pub fn calibrate(
    scene: &Scene,
    path: Option<&str>,
    period: Option<f64>,
) -> Result<Outcome, StudyError> {
    PreparedScene::for_driven_angle(scene, true)?;
    let section = scene.calibration.as_ref();
    let path = path.or(section.map(|c| c.path.as_str()));
    let period = period.or(section.map(|c| c.period));
    let (Some(path), Some(period)) = (path, period) else {
        return Err(scene_error(
            scene,
            "the value to calibrate or the required period is not given",
            "give --parameter BODY.inertia and --period SECONDS, or a [calibration] in the scene",
            missing_section_label("calibration"),
        ));
    };
    let result = find_value(scene, path, period)?;
    Ok(Outcome {
        summary: format!(
            "{}: {} = {} {} gives the period {} s\n  the scene has {} {}, which gives {} s\n",
            scene.title,
            result.path,
            digits(result.value, 12),
            result.unit,
            digits(result.period, 12),
            digits(result.current, 12),
            result.unit,
            digits(result.current_period, 13),
        ),
        ..Outcome::default()
    })
}
