//! `dwell export`: what its options ask for.

use crate::options::ExportArgs;
use dwell_export::{Precision, Request};
use dwell_scene::{Scene, SpaceScene};
use dwell_study::{ExportRequest, Outcome, StudyError};

/// Exports a scene as its options say.
pub(crate) fn run(arguments: &ExportArgs, scene: &Scene) -> Result<Outcome, StudyError> {
    dwell_study::export(scene, arguments.to, &request(arguments))
}

/// Exports a scene in space as its options say.
pub(crate) fn run_in_space(
    arguments: &ExportArgs,
    scene: &SpaceScene,
) -> Result<Outcome, StudyError> {
    dwell_study::export_in_space(scene, arguments.to, &request(arguments))
}

fn request(arguments: &ExportArgs) -> ExportRequest {
    let precision = match arguments.float {
        true => Precision::Float,
        false => Precision::Double,
    };
    ExportRequest {
        request: Request {
            accuracy: arguments.accuracy,
            precision,
        },
        interval: arguments.from.zip(arguments.until),
    }
}
