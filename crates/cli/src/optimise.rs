//! `dwell optimise`: its options, and its request.

use clap::Args;
use dwell_study::Request;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct OptimiseArgs {
    /// The scene file, or `-` for standard input
    pub(crate) scene: PathBuf,
    /// The job of [optimise] (default: the only one)
    pub(crate) job: Option<String>,
    /// Seed of the random designs
    #[arg(
        long,
        default_value_t = 1,
        value_name = "NUMBER",
        allow_hyphen_values = true
    )]
    seed: u64,
}

impl OptimiseArgs {
    /// The requested study.
    pub(crate) fn request(&self) -> Request<'_> {
        Request::Optimise {
            job: self.job.as_deref(),
            seed: self.seed,
        }
    }
}
