//! Analyses of a scene: from a mechanism description to results, and then to tables, figures and text.
//!
//! Each analysis is a folder. Its `compute` yields plain results and compiles anywhere; its `figures` and `document`
//! draw and write them, and belong to the feature `output` (on by default).
//!
//! ```
//! use dwell_scene::PlaneScene;
//!
//! let text = r#"
//! title = "Pendulum"
//! [bodies.ground]
//! points = { A = [0, 0] }
//! [bodies.bar]
//! points = { A = [0, 0] }
//! mass = 3.0
//! center = [0.5, 0]
//! inertia = 0.25
//! [joints]
//! A = { revolute = ["ground.A", "bar.A"] }
//! [actuators]
//! phi = { angle = ["ground", "bar"] }
//! "#;
//! let scene = PlaneScene::parse("pendulum.toml", text)?;
//! let reduction = dwell_study::compute_reduction(&scene, None)?;
//! // m = I + M r² about the pin, at every position.
//! assert!((reduction.curves.coefficients[0].m - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod analyses;
pub mod assembled;
mod assembled_in_plane;
pub mod bodies;
mod branch_note;
pub mod estimate;
pub mod explain;
pub mod models;
pub mod number_format;
#[cfg(feature = "output")]
pub mod output;
pub mod page;
mod progress;
pub mod ranges;

mod calibrate;
mod check;
mod contents;
pub mod cycle;
pub mod equilibria;
mod export;
pub mod exported_runs;
pub mod free_motion;
pub mod gradient;
mod in_plane;
pub mod linearise;
pub mod machines;
pub mod optimise;
pub mod reduce;
#[cfg(feature = "output")]
mod run;
mod space;
mod study_scene;
pub mod sweep;
mod symbolic;
mod symbols;
pub mod trajectory;
pub mod unit_runs;

pub use analyses::{
    compute_closed_form, compute_export, compute_export_of_several_freedoms, compute_free_motion,
    compute_period, compute_reduction, compute_trajectory, describe_scene, free_motion_page,
    reduction_page, trajectory_page,
};
pub use calibrate::{CalibratedScene, CalibrationResult, find_value};
pub use cycle::compute::{CycleSearch, CycleStability, compute_cycle};
pub use dwell_symbolic::{ClosedForm, Language};
pub use equilibria::compute::compute_equilibria;
pub use explain::{StudyError, SweepError};
#[cfg(feature = "fmu")]
pub use export::fmu_archive;
pub use export::{ExportRequest, compute_export_in_cells};
pub use exported_runs::{ColumnNames, ExportedTable, SampleInterpolation};
pub use free_motion::compute::{FreeMotion, MotionSolver};
pub use linearise::compute::{OperatingPoint, compute_linearisation};
pub use models::{PRESETS, PreparedScene, SolverSettings};
pub use progress::{Progress, Step, no_progress};
pub use reduce::compute::TableRequest;
pub use space::{PreparedSpaceScene, model_with_loads};
pub use study_scene::{PageAndStop, SceneTask, StudyScene, with_dimension};
pub use sweep::{Shard, SweepRequest, compute_request, compute_sweep};
pub use symbolic::compute::symbolic_findings;
pub use trajectory::compute::Analysis;

#[cfg(feature = "output")]
pub use {
    analyses::{
        analyse_trajectory, analyse_trajectory_within, check, export, reduce, simulate,
        simulate_to_accuracy, simulate_with, simulate_within, symbolic,
    },
    calibrate::calibrate,
    cycle::output::cycle,
    equilibria::output::equilibria,
    export::output::ExportTarget,
    exported_runs::reduce_runs,
    linearise::output::linearise,
    output::{CommandResult, Outcome, PictureFormat, Pictures, add_page, add_summary},
    run::{Request, run},
    space::figure_of_positions,
    sweep::output::{ParameterSweep, sweep},
    symbolic::output::FormulaFormat,
    trajectory::figures::PictureSpan,
    trajectory::output::TrajectoryOutcome,
    unit_runs::output::unit_runs,
};
