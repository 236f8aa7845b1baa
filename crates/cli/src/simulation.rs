//! `dwell simulate`: its options, and its request.

use crate::instants;
use crate::values::{Choices, choice, parse_accuracy, parse_finite, parse_time, parse_tolerance};
use clap::Args;
use dwell_dynamics::Method;
use dwell_scene::SceneError;
use dwell_study::{MotionSolver, PictureSpan, SolverSettings};
use std::path::PathBuf;

pub(crate) const METHODS: Choices<Method> = &[
    (
        "bdf",
        Method::Bdf,
        "Implicit, variable order 1 to 5: for stiff equations, such as those of friction",
    ),
    (
        "esdirk34",
        Method::Esdirk34,
        "Implicit Runge–Kutta of order 4",
    ),
    ("tr-bdf2", Method::TrBdf2, "Implicit, order 2"),
    (
        "tsit45",
        Method::Tsit45,
        "Explicit Runge–Kutta of order 5: for smooth motions",
    ),
    (
        "dop853",
        Method::Dop853,
        "Explicit Runge–Kutta of order 8: for smooth motions at high accuracy",
    ),
];

#[derive(Debug, Args)]
pub(crate) struct SimulateArgs {
    /// The scene file, or `-` for standard input
    pub(crate) scene: PathBuf,
    /// The integrator
    #[arg(long, value_parser = choice(METHODS), default_value = "bdf")]
    method: Method,
    /// Relative tolerance
    #[arg(long, default_value = "1e-10", value_parser = parse_tolerance, value_name = "TOLERANCE", allow_hyphen_values = true)]
    rtol: f64,
    /// Absolute tolerance, in rad and rad/s, or m and m/s (default: that of --rtol)
    #[arg(long, value_parser = parse_tolerance, value_name = "TOLERANCE", allow_hyphen_values = true)]
    atol: Option<f64>,
    /// Maximum step, s (default: no limit)
    #[arg(long, value_parser = parse_time, value_name = "SECONDS", allow_hyphen_values = true)]
    max_step: Option<f64>,
    /// Required accuracy, instead of method and tolerance. The cheapest method that meets it is chosen. In rad for
    /// angles, otherwise relative to the largest value: a number such as 1e-6, or draft (1e-3), standard (1e-6),
    /// precise (1e-9) or reference (1e-10)
    #[arg(long, value_parser = parse_accuracy, value_name = "ACCURACY", allow_hyphen_values = true,
          conflicts_with_all = ["method", "rtol", "atol", "max_step"])]
    accuracy: Option<f64>,
    /// Time between the rows of the table, s (default: a thousandth of the duration)
    #[arg(long, value_parser = parse_time, value_name = "SECONDS", allow_hyphen_values = true)]
    sample_interval: Option<f64>,
    /// File of requested instants, instead of a sample interval: one time in s on each line, in ascending order.
    /// The last instant of the motion is a row, too
    #[arg(long, value_name = "FILE", conflicts_with = "sample_interval")]
    times: Option<PathBuf>,
    /// Start of the curves in the pictures, s; files keep all rows
    #[arg(long, value_parser = parse_finite, value_name = "SECONDS", allow_hyphen_values = true)]
    from: Option<f64>,
    /// End of the curves in the pictures, s
    #[arg(long, value_parser = parse_finite, value_name = "SECONDS", allow_hyphen_values = true)]
    to: Option<f64>,
}

impl SimulateArgs {
    /// Method and tolerances.
    pub(crate) fn solver(&self) -> MotionSolver {
        let sample_interval = self.sample_interval;
        match self.accuracy {
            Some(accuracy) => MotionSolver::Accuracy {
                accuracy,
                sample_interval,
            },
            None => MotionSolver::Settings(SolverSettings {
                method: self.method,
                rtol: self.rtol,
                atol: self.atol.unwrap_or(self.rtol),
                max_step: self.max_step,
                sample_interval,
            }),
        }
    }

    /// The requested instants.
    pub(crate) fn times(&self) -> Result<Option<Vec<f64>>, SceneError> {
        self.times.as_deref().map(instants::read).transpose()
    }

    /// The part of the motion that curves show.
    pub(crate) fn span(&self) -> PictureSpan {
        let Self { from, to, .. } = *self;
        PictureSpan { from, to }
    }
}
