//! A scene's machine in C.

use dwell_export::{Precision, Request, c_files as c_files_of};
use dwell_scene::{Scene, SceneError};
use dwell_study::{ExportRequest, compute_export_in_cells};

/// The default accuracy of `dwell export`.
const ACCURACY: f64 = 1e-9;

/// Name and text of header and source.
pub(crate) fn c_files(scene: &Scene) -> Result<Vec<(String, String)>, SceneError> {
    let Scene::Plane(scene) = scene else {
        let message = "this page exports mechanisms in the plane only".to_owned();
        let help = "`dwell export --to c` exports those in space".to_owned();
        return Err(SceneError::without_labels(message, Some(help)));
    };
    let asked = ExportRequest {
        request: Request {
            accuracy: ACCURACY,
            precision: Precision::Double,
        },
        interval: None,
        exact: false,
    };
    Ok(c_files_of(&compute_export_in_cells(scene, &asked)?).into())
}
