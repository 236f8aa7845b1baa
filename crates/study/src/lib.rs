//! Analyses of a scene: from a mechanism description to results, and then to tables, figures and text.
//!
//! Each analysis is a folder. Its `compute` yields plain results and compiles anywhere; its `figures` and `document`
//! draw and write them, and belong to the feature `output` (on by default).
//!
//! ```
//! use dwell_scene::Scene;
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
//! let scene = Scene::parse("pendulum.toml", text)?;
//! let reduction = dwell_study::compute_reduction(&scene, None)?;
//! // m = I + M r² about the pin, at every position.
//! assert!((reduction.curves.coefficients[0].m - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
pub mod linearise;
pub mod machines;
pub mod reduce;
mod space;
pub mod sweep;
mod symbolic;
mod symbols;
pub mod trajectory;
pub mod unit_runs;

pub use calibrate::{CalibratedScene, CalibrationResult, find_value};
pub use check::describe_scene;
pub use cycle::compute::{CycleSearch, CycleStability, compute_cycle};
pub use dwell_symbolic::Language;
pub use equilibria::compute::compute_equilibria;
pub use explain::{StudyError, SweepError};
#[cfg(feature = "fmu")]
pub use export::fmu_archive;
pub use export::{
    ExportRequest, compute_export, compute_export_in_cells, compute_export_of_several_freedoms,
};
pub use exported_runs::{ColumnNames, ExportedTable, SampleInterpolation};
pub use free_motion::compute::{MotionSolver, compute_free_motion, compute_period};
pub use linearise::compute::{OperatingPoint, compute_linearisation};
pub use models::{PRESETS, PreparedScene, SolverSettings};
pub use progress::{Progress, Step, no_progress};
pub use reduce::compute::{TableRequest, compute_reduction};
pub use space::{
    FreeMotionInSpace, PreparedSpaceScene, compute_export_in_space, compute_free_motion_in_space,
    compute_period_in_space, compute_reduction_in_space, compute_trajectory_in_space,
    describe_scene_in_space, free_motion_page_in_space, loaded_model_in_space,
    reduction_page_in_space, trajectory_page_in_space,
};
pub use sweep::{Shard, compute_sweep};
pub use symbolic::compute::{compute_closed_form, symbolic_findings};
pub use trajectory::compute::{Analysis, compute_trajectory};

#[cfg(feature = "output")]
pub use {
    calibrate::calibrate,
    check::check,
    cycle::output::cycle,
    equilibria::output::equilibria,
    export::output::{ExportTarget, export},
    exported_runs::reduce_runs,
    free_motion::output::{simulate, simulate_to_accuracy, simulate_with, simulate_within},
    linearise::output::linearise,
    output::{CommandResult, Outcome, PictureFormat, Pictures, add_page, add_summary},
    reduce::output::reduce,
    space::{
        analyse_in_space, check_in_space, export_in_space, mechanism_figure_in_space,
        reduce_in_space, simulate_in_space,
    },
    sweep::output::{ParameterSweep, RowStore, sweep},
    symbolic::output::{FormulaFormat, symbolic},
    trajectory::figures::PictureSpan,
    trajectory::output::{TrajectoryOutcome, analyse_trajectory, analyse_trajectory_within},
    unit_runs::output::unit_runs,
};
