//! `dwell reduce`: its options, and its request.

use crate::values::{Choices, choice, parse_accuracy, parse_finite, parse_table_accuracy};
use clap::Args;
use dwell_study::{SampleInterpolation, TableRequest};
use std::path::PathBuf;

const INTERPOLATIONS: Choices<SampleInterpolation> = &[
    (
        "linear",
        SampleInterpolation::Linear,
        "Straight lines, as tables are usually read",
    ),
    (
        "cubic",
        SampleInterpolation::Cubic,
        "Cubic polynomials; of m with ½m′ for its slope",
    ),
    (
        "trigonometric",
        SampleInterpolation::Trigonometric,
        "A trigonometric series over a whole revolution",
    ),
];

#[derive(Debug, Args)]
pub(crate) struct ReduceArgs {
    /// The scene file, or `-` for standard input
    #[arg(required_unless_present = "runs")]
    pub(crate) scene: Option<PathBuf>,
    /// Instead of a scene: the exported tables (CSV or NPZ) of two kinetostatic runs of any program, of run i (uniform
    /// speed) and of run ii (uniform acceleration), as `dwell runs` writes them
    #[arg(long = "from", num_args = 2, value_names = ["RUN_I", "RUN_II"],
          conflicts_with_all = ["scene", "table_accuracy", "accuracy", "points"])]
    pub(crate) runs: Option<Vec<PathBuf>>,
    /// TOML file that names the columns of the exported tables: coordinate, speed, acceleration, force, unit, [reactions]
    #[arg(long, requires = "runs", value_name = "FILE")]
    pub(crate) columns: Option<PathBuf>,
    /// Interpolation between the exported positions (default: trigonometric over a whole revolution with equal
    /// steps, otherwise cubic)
    #[arg(long, requires = "runs", value_parser = choice(INTERPOLATIONS), value_name = "INTERPOLATION")]
    pub(crate) interpolation: Option<SampleInterpolation>,
    /// Also write an interpolation table with this accuracy, relative to the largest value of each function, such
    /// as 1e-12
    #[arg(long, value_parser = parse_table_accuracy, value_name = "ACCURACY", allow_hyphen_values = true)]
    table_accuracy: Option<f64>,
    /// Required relative accuracy over the whole range; uses exact evaluation or a table, whichever is cheaper
    #[arg(long, value_parser = parse_accuracy, value_name = "ACCURACY", allow_hyphen_values = true, conflicts_with = "table_accuracy")]
    accuracy: Option<f64>,
    /// Number of positions, both ends included (default: 721)
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=1_000_000), value_name = "COUNT", allow_hyphen_values = true)]
    points: Option<u32>,
    /// Lower end of the table, in the scene's unit (default: a full period, or the range without 2 % at each end)
    #[arg(long, requires_all = ["table_accuracy", "table_to"], value_parser = parse_finite, value_name = "COORDINATE", allow_hyphen_values = true)]
    table_from: Option<f64>,
    /// Upper end of the table, in the scene's unit
    #[arg(long, requires_all = ["table_accuracy", "table_from"], value_parser = parse_finite, value_name = "COORDINATE", allow_hyphen_values = true)]
    table_to: Option<f64>,
}

impl ReduceArgs {
    pub(crate) fn points(&self) -> Option<usize> {
        self.points.map(|n| n as usize)
    }

    /// The requested table, over an interval if both ends are given.
    pub(crate) fn table(&self) -> Option<TableRequest> {
        Some(TableRequest {
            accuracy: self.table_accuracy.or(self.accuracy)?,
            interval: self.table_from.zip(self.table_to),
            required: self.table_accuracy.is_some(),
        })
    }
}
