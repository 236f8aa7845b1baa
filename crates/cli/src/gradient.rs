//! `dwell gradient`: its options, and its request.

use crate::values::parse_count;
use clap::Args;
use dwell_study::{Request, SweepRequest};
use std::path::PathBuf;

/// Samples unless they are given.
const SAMPLES: u64 = 10_000;

#[derive(Debug, Args)]
pub(crate) struct GradientArgs {
    /// The scene file, or `-` for standard input
    pub(crate) scene: PathBuf,
    /// The results, by their names in a sweep: `phi.actuator_force.rms,m.max`
    #[arg(long, value_name = "RESULT,…", value_delimiter = ',', required = true)]
    of: Vec<String>,
    /// Compare each derivative with differences of results
    #[arg(long, conflicts_with = "tolerance")]
    check: bool,
    /// Instead of derivatives by all numbers, the spread of the results where this number varies at random: PATH±TOLERANCE, PATH±PERCENT%,
    /// PATH~normal(MEAN,SD) or PATH~uniform(FROM,TO); may be given several times
    #[arg(long, value_name = "VARIATION", allow_hyphen_values = true)]
    tolerance: Vec<String>,
    /// Number of random samples (default: 10000)
    #[arg(long, requires = "tolerance", value_parser = parse_count, value_name = "COUNT", allow_hyphen_values = true)]
    samples: Option<u64>,
    /// Random seed (default: 1)
    #[arg(
        long,
        requires = "tolerance",
        value_name = "NUMBER",
        allow_hyphen_values = true
    )]
    seed: Option<u64>,
    /// A number that follows from others: PATH=EXPRESSION; may be given several times
    #[arg(
        long,
        requires = "tolerance",
        value_name = "TIE",
        allow_hyphen_values = true
    )]
    tied: Vec<String>,
    /// A limit whose yield is wanted: RESULT<=LIMIT or RESULT>=LIMIT; may be given several times
    #[arg(
        long = "subject-to",
        requires = "tolerance",
        value_name = "LIMIT",
        allow_hyphen_values = true
    )]
    limits: Vec<String>,
}

impl GradientArgs {
    /// The requested study.
    pub(crate) fn request(&self) -> Request<'_> {
        if !self.is_of_tolerances() {
            return Request::Gradient {
                results: &self.of,
                has_check: self.check,
            };
        }
        Request::Tolerance(SweepRequest {
            vary: &self.tolerance,
            tied: &self.tied,
            samples: Some(self.samples.unwrap_or(SAMPLES)),
            seed: self.seed.unwrap_or(1),
            requests: &self.of,
            limits: &self.limits,
        })
    }

    /// Whether tolerances are wanted, which have files of their own.
    pub(crate) fn is_of_tolerances(&self) -> bool {
        !self.tolerance.is_empty()
    }
}
