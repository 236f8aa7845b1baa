//! `dwell sweep`: its options, and its request.

use crate::values::{Choices, choice, parse_count};
use clap::Args;
use dwell_report::TableFormat;
use dwell_study::{ParameterSweep, Shard, SweepRequest};
use std::path::{Path, PathBuf};

const TABLE_FORMATS: Choices<TableFormat> = &[
    ("csv", TableFormat::Csv, "Text"),
    ("npz", TableFormat::Npz, "A NumPy archive"),
];

#[derive(Debug, Args)]
pub(crate) struct SweepArgs {
    /// The scene file, or `-` for standard input
    pub(crate) scene: PathBuf,
    /// Parameter to vary, in the scene's unit: PATH=FROM:TO:COUNT, PATH=A,B,C, PATH~normal(MEAN,SD),
    /// PATH~uniform(FROM,TO), PATH±TOLERANCE or PATH±PERCENT%; may be given several times
    #[arg(
        long,
        required = true,
        value_name = "VARIATION",
        allow_hyphen_values = true
    )]
    vary: Vec<String>,
    /// A number that follows from others: PATH=EXPRESSION of parameters and paths, these between backticks if they have brackets; may be given several times
    #[arg(long, value_name = "TIE", allow_hyphen_values = true)]
    tied: Vec<String>,
    /// Number of random samples for each combination of listed values
    #[arg(long, value_parser = parse_count, value_name = "COUNT", allow_hyphen_values = true)]
    samples: Option<u64>,
    /// Random seed
    #[arg(
        long,
        default_value_t = 1,
        value_name = "NUMBER",
        allow_hyphen_values = true
    )]
    seed: u64,
    /// Result columns to compute, by name or prefix, such as period or m (default: all)
    #[arg(long = "result", value_name = "RESULT", value_delimiter = ',')]
    results: Vec<String>,
    /// Leave out the points beyond a limit: RESULT<=LIMIT or RESULT>=LIMIT; may be given several times
    #[arg(long = "subject-to", value_name = "LIMIT", allow_hyphen_values = true)]
    limits: Vec<String>,
    /// Compute only this part of the points, such as 2/8, in the folder that all parts share
    #[arg(long, value_name = "PART/PARTS", allow_hyphen_values = true)]
    pub(crate) shard: Option<Shard>,
    /// Also write the rows as a table
    #[arg(long, value_parser = choice(TABLE_FORMATS), value_name = "FORMAT")]
    export: Option<TableFormat>,
}

impl SweepArgs {
    /// The requested sweep, with its files in a folder.
    pub(crate) fn sweep<'a>(&'a self, folder: &'a Path) -> ParameterSweep<'a> {
        ParameterSweep {
            request: SweepRequest {
                vary: &self.vary,
                tied: &self.tied,
                samples: self.samples,
                seed: self.seed,
                requests: &self.results,
                limits: &self.limits,
            },
            shard: self.shard,
            export: self.export,
            folder,
        }
    }
}
