//! `dwell export`: what its options ask for.

use crate::options::ExportArgs;
use dwell_export::{Precision, Request};
use dwell_scene::Scene;
use dwell_study::{ExportRequest, Outcome, StudyError};

/// Exports a scene as its options say.
pub(crate) fn run(arguments: &ExportArgs, scene: &Scene) -> Result<Outcome, StudyError> {
    let precision = match arguments.float {
        true => Precision::Float,
        false => Precision::Double,
    };
    let asked = ExportRequest {
        request: Request {
            accuracy: arguments.accuracy,
            precision,
        },
        interval: arguments.from.zip(arguments.until),
    };
    dwell_study::export(scene, arguments.to, &asked)
}
