//! `dwell export`: a machine of one degree of freedom as code for controllers and simulations.

pub(crate) mod description;
#[cfg(feature = "fmu")]
mod fmu_archive;
mod hidden_motion;
#[cfg(feature = "output")]
pub(crate) mod output;
pub(crate) mod sampler;
mod several_freedoms;

#[cfg(feature = "fmu")]
pub use fmu_archive::fmu_archive;
pub(crate) use several_freedoms::{only_as_c, several_freedoms_in_plane};

use crate::explain::{StudyError, explain_motion, scene_error};
use crate::number_format::number;
use description::ExportedScene;
use dwell_dynamics::DynamicsError;
use dwell_export::{Export, FitError, Function, MachineDescription, Request};
use dwell_geometry::ActuatorId;
use dwell_numerics::RecordingError;
use dwell_scene::{PlaneScene, SceneFile, SceneLocation};
use hidden_motion::reject_hidden_motion;
use sampler::{SceneSampler, recorded};
use std::fmt::Display;

/// The mark of the only coordinate.
const OVER_COORDINATE: (SceneLocation, &str) = (
    SceneLocation::Actuator(ActuatorId(0)),
    "over this coordinate",
);

/// The exported parts of a scene, and the accuracy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExportRequest {
    /// Accuracy and numbers.
    pub request: Request,
    /// The operations of the model instead of cells; the error is then that of rounding.
    pub exact: bool,
    /// Interval in the scene's unit; `None` for a full period, or the range without 2 % at each end.
    pub interval: Option<(f64, f64)>,
}

/// Fits the functions of the machine of a scene in the plane for export.
pub(crate) fn fit_in_plane(
    scene: &PlaneScene,
    asked: &ExportRequest,
) -> Result<Export, StudyError> {
    if !asked.exact {
        return compute_export_in_cells(scene, asked);
    }
    let exported = ExportedScene::new(scene, asked.interval)?;
    let code = recorded(&exported).map_err(|error| match error {
        RecordingError::Evaluation(error) => explain_sampler(&exported, &error),
        RecordingError::Function => no_operations(
            scene,
            "a law of a cam, a joint or an inertia is given by its values only",
        ),
        RecordingError::Differs { .. } => no_operations(scene, SEARCHED),
    })?;
    let (machine, precision) = (exported.description.clone(), asked.request.precision);
    let export = Export::exact(machine, precision, code, &mut SceneSampler::new(&exported));
    export.map_err(|error| explain_export(scene, &exported, asked, error))
}

/// Fits the functions of a scene's machine in cells, even if the model's operations are requested. A program that calls only this
/// function does not contain the code that records operations.
///
/// # Errors
/// As [`compute_export`](crate::compute_export).
pub fn compute_export_in_cells(
    scene: &PlaneScene,
    asked: &ExportRequest,
) -> Result<Export, StudyError> {
    let exported = ExportedScene::new(scene, asked.interval)?;
    reject_hidden_motion(scene, &exported)?;
    let machine = exported.description.clone();
    let export = Export::new(machine, asked.request, &mut SceneSampler::new(&exported));
    export.map_err(|error| explain_export(scene, &exported, asked, error))
}

fn explain_sampler(exported: &ExportedScene<'_>, error: &DynamicsError) -> StudyError {
    explain_motion(&exported.loaded, exported.model.plan(), error)
}

fn explain_export(
    scene: &SceneFile,
    exported: &ExportedScene<'_>,
    asked: &ExportRequest,
    error: FitError<DynamicsError>,
) -> StudyError {
    match error {
        FitError::Sampler(error) => explain_sampler(exported, &error),
        other => explain_fit(scene, &exported.description, asked, &other),
    }
}

/// Why the operations of a model are not the same at all coordinates.
const SEARCHED: &str = "its positions are searched by Newton's method or chosen by cases";

/// Refuses the operations of a model, with the reason.
pub(crate) fn no_operations(scene: &SceneFile, reason: &str) -> StudyError {
    scene_error(
        scene,
        format!("no exact export: {reason}"),
        "leave --exact out: with --accuracy 1e-12, cells reproduce every function to that accuracy",
        [OVER_COORDINATE],
    )
}

/// Explains why no cells were found, with names and places of the scene.
pub(crate) fn explain_fit<E: Display>(
    scene: &SceneFile,
    machine: &MachineDescription,
    asked: &ExportRequest,
    error: &FitError<E>,
) -> StudyError {
    let place = |function: &Function| match function {
        Function::Potential(load) | Function::W(load) | Function::C(load, _) => {
            (SceneLocation::Load(*load), "this load")
        }
        Function::Position(point, _) => (SceneLocation::Path(*point), "this point"),
        Function::Inertia | Function::A(_) | Function::B(_) => OVER_COORDINATE,
    };
    match error {
        FitError::Sampler(error) => scene_error(scene, error.to_string(), "", [OVER_COORDINATE]),
        FitError::NotPeriodic { name, function } => scene_error(
            scene,
            format!("no export: {name} is not periodic over a revolution"),
            "what depends on the number of revolutions needs an interval: give --from and --until",
            [place(function)],
        ),
        FitError::TooLarge { name } => scene_error(
            scene,
            format!("no export: {name} is too large for single precision"),
            "leave --float out",
            [(SceneLocation::Whole, "of this scene")],
        ),
        FitError::OtherOperations { .. } => no_operations(scene, SEARCHED),
        FitError::NarrowPeak { error } => scene_error(
            scene,
            format!(
                "no export: a body moves within a part of the range that is too narrow for cells, which have an error of {error:.1e} of the largest value"
            ),
            "give an interval around the fast motion with --from and --until, or a smoother law",
            [OVER_COORDINATE],
        ),
        FitError::NotReached { name, q, .. } => {
            let (at, unit) = scene.to_scene_unit(*q, machine.is_angle);
            let accuracy = asked.request.accuracy;
            let message = format!(
                "no export of accuracy {accuracy:e}: {name} varies too sharply near {} {unit}",
                number(at)
            );
            scene_error(
                scene,
                message,
                "ask for less accuracy, or for a smaller part of the range with --from and --until, away from limit positions and change points",
                [OVER_COORDINATE],
            )
        }
    }
}
