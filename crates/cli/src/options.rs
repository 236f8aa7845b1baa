//! The command-line options: the names of fields are the names of options.

use crate::export::ExportArgs;
use crate::gradient::GradientArgs;
use crate::import::ImportArgs;
use crate::optimise::OptimiseArgs;
use crate::reduction::ReduceArgs;
use crate::simulation::{METHODS, SimulateArgs};
use crate::sweep::SweepArgs;
use crate::values::{
    Choices, choice, parse_finite, parse_fluctuation, parse_name, parse_time, parse_tolerance,
};
use clap::{Args, Parser, Subcommand};
use dwell_dynamics::Method;
use dwell_study::{
    Analysis, FormulaFormat, Language, OperatingPoint, PictureFormat, PictureSpan, Pictures,
};
use std::path::{Path, PathBuf};

/// Kinetostatics and dynamics of mechanisms in the plane and in space, with independent checks
#[derive(Debug, Parser)]
#[command(name = "dwell", version, arg_required_else_help = true)]
pub(crate) struct Options {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Folder for the output files
    #[arg(long, global = true, default_value = "reports", value_name = "FOLDER")]
    pub(crate) out: PathBuf,
    /// Pictures to draw; they take most of the time. Validation draws all of its own
    #[arg(long, global = true, value_parser = choice(PICTURES), default_value = "main", value_name = "PICTURES")]
    pub(crate) pictures: Pictures,
    /// Format of the pictures; animations are always GIF. Validation always draws its PNG, too
    #[arg(long, global = true, value_parser = choice(PICTURE_FORMATS), default_value = "png", value_name = "FORMAT")]
    pub(crate) picture_format: PictureFormat,
    /// Also write the results as one HTML page, NAME-COMMAND.html, which opens without a connection: mechanism in motion, curves,
    /// largest values, findings. Validation always writes its pages
    #[arg(long, global = true)]
    pub(crate) html: bool,
    /// Base name of the output files (default: that of the scene file, or `stdin`)
    #[arg(long, global = true, value_parser = parse_name, value_name = "NAME")]
    pub(crate) name: Option<String>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Degrees of freedom, groups, assembly mode and range of the mechanism in a scene
    Check {
        /// The scene file, or `-` for standard input
        scene: PathBuf,
    },
    /// Reduced model (m, ½m′, a, b, w, c) over the range: table and figures
    Reduce(ReduceArgs),
    /// Free motion under loads and drives, with energies and reactions: tables and figures
    Simulate(SimulateArgs),
    /// Steady cycle of a driven machine, and the flywheel for a given coefficient of fluctuation
    Cycle {
        /// The scene file, or `-` for standard input
        scene: PathBuf,
        /// Target coefficient of speed fluctuation, such as 0.02; sizes the flywheel that reaches it
        #[arg(long, value_parser = parse_fluctuation, value_name = "RATIO", allow_hyphen_values = true)]
        fluctuation: Option<f64>,
        /// The integrator
        #[arg(long, value_parser = choice(METHODS), default_value = "bdf")]
        method: Method,
        /// Relative and absolute tolerance
        #[arg(long, default_value = "1e-10", value_parser = parse_tolerance, value_name = "TOLERANCE", allow_hyphen_values = true)]
        rtol: f64,
    },
    /// Work–precision diagram: cost against error for every combination of model, integrator and tolerance
    WorkPrecision {
        /// The scene file, or `-` for standard input
        scene: PathBuf,
    },
    /// Equilibria of a machine, with their stability and natural frequencies
    Equilibria {
        /// The scene file, or `-` for standard input
        scene: PathBuf,
    },
    /// State-space model linearised about an equilibrium or the initial state: A, B, C, D and eigenvalues
    Linearise {
        /// The scene file, or `-` for standard input
        scene: PathBuf,
        /// State to linearise about
        #[arg(long, value_parser = choice(OPERATING_POINTS), default_value = "equilibrium")]
        about: OperatingPoint,
    },
    /// Derivatives of results of a sweep by all numbers of the scene: on which of them a peak, a mean or a period depends, and how much
    Gradient(GradientArgs),
    /// The two kinetostatic runs that give the reduced parameters (unit speed, unit acceleration), in time, and their combination
    Runs {
        /// The scene file
        scene: PathBuf,
        /// Number of positions of each run (default: 361)
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000_000))]
        points: Option<u32>,
    },
    /// Closed forms for a mechanism made of dyads: positions, m, ½m′, and a and b of a reaction, as LaTeX or code
    Symbolic {
        /// The scene file, or `-` for standard input
        scene: PathBuf,
        /// Output format
        #[arg(long, value_parser = choice(FORMATS), default_value = "latex")]
        format: FormulaFormat,
        /// The reaction, such as A.x (default: the first that the scene requests)
        #[arg(long, value_name = "NAME")]
        reaction: Option<String>,
    },
    /// The reduced model as code for controllers and simulations: coefficients, motion, reactions and a fixed step, with
    /// measured errors and a self-test
    Export(ExportArgs),
    /// Positions, velocities and accelerations along the prescribed motion, the coordinate sweep or the range
    Kinematics(TrajectoryArgs),
    /// Actuator forces and reactions under the loads, at rest in each position
    Statics(TrajectoryArgs),
    /// Actuator forces and reactions under loads and inertia, along the prescribed motion, the coordinate sweep or the
    /// range
    Kinetostatics(TrajectoryArgs),
    /// Find the value of a scene parameter that gives the free motion a target period
    Calibrate {
        /// The scene file, or `-` for standard input
        scene: PathBuf,
        /// The parameter to fit, such as crank.inertia (default: that of [calibration])
        #[arg(long, value_name = "PATH")]
        parameter: Option<String>,
        /// Target period, s (default: that of [calibration])
        #[arg(long, value_parser = parse_time, value_name = "SECONDS", allow_hyphen_values = true)]
        period: Option<f64>,
    },
    /// Parameter study over many variants of a scene, on all cores, stored in Parquet files; an interrupted run can be
    /// resumed
    Sweep(SweepArgs),
    /// Best design of a job of [optimise], with a certificate and the price of each condition
    Optimise(OptimiseArgs),
    /// Run all checks on all cases, or on the named ones; exit status 1 if a check fails
    Validate {
        /// Names of cases, or folders with a scene.toml (default: all cases)
        cases: Vec<String>,
        /// Folder of the cases
        #[arg(long, default_value = DEFAULT_CASE_FOLDER, value_name = "FOLDER")]
        folder: PathBuf,
        /// Include the extreme-parameter checks that take minutes, such as a hundred thousand revolutions
        #[arg(long)]
        slow: bool,
    },
    /// Write the live page with a scene and open it in the browser: edit the scene there, and every result is updated
    View {
        /// The scene file, or `-` for standard input
        scene: PathBuf,
        /// The live page that `just web` builds (default: dwell.html in the folder of this program, or in ../web)
        #[arg(long, value_name = "FILE")]
        page: Option<PathBuf>,
    },
    /// Write a scene from a model of another program: MJCF, URDF, SDF, ASMT, or a link of PMKS+. `--out` names the scene, or `-`
    Import(ImportArgs),
    /// Print the JSON schema of scene files, for editors
    Schema,
    /// Write a commented scene to start from; an existing file is not replaced
    Init {
        /// The scene file to write, with or without `.toml`
        #[arg(default_value = "slider-crank.toml")]
        scene: PathBuf,
    },
}

impl Command {
    /// Options and analysis of a command that analyses a trajectory.
    pub(crate) fn trajectory(&self) -> Option<(&TrajectoryArgs, Analysis)> {
        match self {
            Self::Kinematics(arguments) => Some((arguments, Analysis::Kinematics)),
            Self::Statics(arguments) => Some((arguments, Analysis::Statics)),
            Self::Kinetostatics(arguments) => Some((arguments, Analysis::Kinetostatics)),
            _ => None,
        }
    }

    /// The scene file of a command that studies one.
    pub(crate) fn scene(&self) -> Option<&Path> {
        match self {
            Self::Reduce(arguments) => arguments.scene.as_deref(),
            Self::Simulate(arguments) => Some(&arguments.scene),
            Self::Sweep(arguments) => Some(&arguments.scene),
            Self::Optimise(arguments) => Some(&arguments.scene),
            Self::Gradient(arguments) => Some(&arguments.scene),
            Self::Check { scene }
            | Self::Cycle { scene, .. }
            | Self::WorkPrecision { scene }
            | Self::Equilibria { scene }
            | Self::Linearise { scene, .. }
            | Self::Runs { scene, .. }
            | Self::Symbolic { scene, .. }
            | Self::Calibrate { scene, .. }
            | Self::View { scene, .. } => Some(scene),
            Self::Export(arguments) => Some(&arguments.scene),
            Self::Kinematics(arguments)
            | Self::Statics(arguments)
            | Self::Kinetostatics(arguments) => Some(&arguments.scene),
            Self::Validate { .. } | Self::Schema | Self::Init { .. } | Self::Import(_) => None,
        }
    }
}

/// The argument for standard input, and the name of a scene read from it.
pub(crate) const STANDARD_INPUT: &str = "-";
pub(crate) const STANDARD_INPUT_NAME: &str = "stdin";

/// The folder of Dwell's own cases.
pub(crate) const DEFAULT_CASE_FOLDER: &str = "validation";

#[derive(Debug, Args)]
pub(crate) struct TrajectoryArgs {
    /// The scene file, or `-` for standard input
    pub(crate) scene: PathBuf,
    /// Number of positions, both ends included (default: the scene's `points`, or 361)
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=1_000_000), value_name = "COUNT", allow_hyphen_values = true)]
    points: Option<u32>,
    /// Start of the curves in the pictures: the time in s, or the swept coordinate in the scene's unit; files keep all rows
    #[arg(long, value_parser = parse_finite, value_name = "ABSCISSA", allow_hyphen_values = true)]
    from: Option<f64>,
    /// End of the curves in the pictures
    #[arg(long, value_parser = parse_finite, value_name = "ABSCISSA", allow_hyphen_values = true)]
    to: Option<f64>,
}

impl TrajectoryArgs {
    pub(crate) fn points(&self) -> Option<usize> {
        self.points.map(|n| n as usize)
    }

    pub(crate) fn span(&self) -> PictureSpan {
        let Self { from, to, .. } = *self;
        PictureSpan { from, to }
    }
}

const PICTURES: Choices<Pictures> = &[
    ("none", Pictures::None, "None"),
    (
        "main",
        Pictures::Main,
        "The mechanism and the first results of the command",
    ),
    (
        "all",
        Pictures::All,
        "All, and the animation of the mechanism",
    ),
];

const PICTURE_FORMATS: Choices<PictureFormat> = &[
    ("png", PictureFormat::Png, "Pixels, for screens"),
    ("svg", PictureFormat::Svg, "Lines and letters, for papers"),
    ("both", PictureFormat::Both, "PNG and SVG"),
];

const OPERATING_POINTS: Choices<OperatingPoint> = &[
    (
        "equilibrium",
        OperatingPoint::Equilibrium,
        "The equilibrium nearest to the initial state",
    ),
    (
        "initial",
        OperatingPoint::InitialState,
        "The initial state of [motion], or else the assembly at rest",
    ),
];

const FORMATS: Choices<FormulaFormat> = &[
    (
        "latex",
        FormulaFormat::Latex,
        "Markdown with formulas in LaTeX",
    ),
    (
        "rust",
        FormulaFormat::Code(Language::Rust),
        "A function in Rust",
    ),
    ("c", FormulaFormat::Code(Language::C), "A function in C"),
    (
        "python",
        FormulaFormat::Code(Language::Python),
        "A function in Python",
    ),
];
