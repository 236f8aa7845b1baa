//! The command-line options: the names of fields are the names of options.

use crate::export::ExportArgs;
use crate::values::{
    Choices, choice, parse_accuracy, parse_count, parse_finite, parse_fluctuation, parse_name,
    parse_table_accuracy, parse_time, parse_tolerance,
};
use clap::{Args, Parser, Subcommand};
use dwell_dynamics::Method;
use dwell_report::TableFormat;
use dwell_study::{
    FormulaFormat, Language, OperatingPoint, PictureFormat, Pictures, RowStore,
    SampleInterpolation, Shard,
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
    /// Name of the scene, which the names of its files begin with (default: that of its file, or `stdin`)
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
    Reduce {
        /// The scene file, or `-` for standard input
        #[arg(required_unless_present = "runs")]
        scene: Option<PathBuf>,
        /// Instead of a scene: the exported tables (CSV or NPZ) of two kinetostatic runs of any program, of run i (uniform
        /// speed) and of run ii (uniform acceleration), as `dwell runs` writes them
        #[arg(long = "from", num_args = 2, value_names = ["RUN_I", "RUN_II"],
              conflicts_with_all = ["scene", "table_accuracy", "accuracy", "points"])]
        runs: Option<Vec<PathBuf>>,
        /// TOML file that names the columns of the exported tables: coordinate, speed, acceleration, force, unit, [reactions]
        #[arg(long, requires = "runs", value_name = "FILE")]
        columns: Option<PathBuf>,
        /// How values between the exported positions are found (default: trigonometric over a whole revolution at equal
        /// distances, otherwise cubic)
        #[arg(long, requires = "runs", value_parser = choice(INTERPOLATIONS), value_name = "INTERPOLATION")]
        interpolation: Option<SampleInterpolation>,
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
    },
    /// Free motion under loads and drives, with energies and reactions: tables and figures
    Simulate {
        /// The scene file, or `-` for standard input
        scene: PathBuf,
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
        /// File of the wanted instants, instead of a sample interval: one time in s on each line, in ascending order.
        /// The last instant of the motion is a row, too
        #[arg(long, value_name = "FILE", conflicts_with = "sample_interval")]
        times: Option<PathBuf>,
        /// Time at which curves begin in the pictures, s; files keep all rows
        #[arg(long, value_parser = parse_finite, value_name = "SECONDS", allow_hyphen_values = true)]
        from: Option<f64>,
        /// Time at which they end, s
        #[arg(long, value_parser = parse_finite, value_name = "SECONDS", allow_hyphen_values = true)]
        to: Option<f64>,
    },
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
    /// Parameter study over many variants of a scene, on all cores, stored in an SQLite file or in Parquet files; an
    /// interrupted run can be resumed
    Sweep {
        /// The scene file, or `-` for standard input
        scene: PathBuf,
        /// Parameter to vary, in the scene's unit: PATH=FROM:TO:COUNT, PATH=A,B,C, PATH~normal(MEAN,SD),
        /// PATH~uniform(FROM,TO), PATH±TOLERANCE or PATH±PERCENT%; may be given several times
        #[arg(
            long,
            required = true,
            value_name = "VARIATION",
            allow_hyphen_values = true
        )]
        vary: Vec<String>,
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
        /// Compute only this part of the points, such as 2/8, in files of its own
        #[arg(long, value_name = "PART/PARTS", allow_hyphen_values = true)]
        shard: Option<Shard>,
        /// Compute nothing; export the stored results, including those of all shards
        #[arg(long, value_parser = choice(TABLE_FORMATS), value_name = "FORMAT")]
        export: Option<TableFormat>,
        /// Where rows are stored (default: sqlite below 100 000 points, parquet from there on)
        #[arg(long, value_parser = choice(ROW_STORES), value_name = "KIND")]
        store: Option<RowStore>,
    },
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
        /// Seed of the pulses and machines that the extreme-parameter checks draw at random
        #[arg(long, default_value_t = 1, value_name = "NUMBER")]
        seed: u64,
    },
    /// Write the live page with a scene, and open it in the browser: there every result follows the scene as it is edited
    View {
        /// The scene file, or `-` for standard input
        scene: PathBuf,
        /// The live page that `just web` builds (default: dwell.html in the folder of this program, or in ../web)
        #[arg(long, value_name = "FILE")]
        page: Option<PathBuf>,
    },
    /// Print the JSON schema of scene files, for editors
    Schema,
    /// Write a commented scene to begin with; an existing file is not replaced
    Init {
        /// The scene file to write, with or without `.toml`
        #[arg(default_value = "slider-crank.toml")]
        scene: PathBuf,
    },
}

impl Command {
    /// The scene file, of a command that studies one.
    pub(crate) fn scene(&self) -> Option<&Path> {
        match self {
            Self::Reduce { scene, .. } => scene.as_deref(),
            Self::Check { scene }
            | Self::Simulate { scene, .. }
            | Self::Cycle { scene, .. }
            | Self::WorkPrecision { scene }
            | Self::Equilibria { scene }
            | Self::Linearise { scene, .. }
            | Self::Runs { scene, .. }
            | Self::Symbolic { scene, .. }
            | Self::Calibrate { scene, .. }
            | Self::Sweep { scene, .. }
            | Self::View { scene, .. } => Some(scene),
            Self::Export(arguments) => Some(&arguments.scene),
            Self::Kinematics(arguments)
            | Self::Statics(arguments)
            | Self::Kinetostatics(arguments) => Some(&arguments.scene),
            Self::Validate { .. } | Self::Schema | Self::Init { .. } => None,
        }
    }
}

/// The scene that is read from standard input, and its name.
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
    pub(crate) points: Option<u32>,
    /// Where curves begin in the pictures: the time in s, or the swept coordinate in the scene's unit; files keep all rows
    #[arg(long, value_parser = parse_finite, value_name = "ABSCISSA", allow_hyphen_values = true)]
    pub(crate) from: Option<f64>,
    /// Where they end
    #[arg(long, value_parser = parse_finite, value_name = "ABSCISSA", allow_hyphen_values = true)]
    pub(crate) to: Option<f64>,
}

const METHODS: Choices<Method> = &[
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

const TABLE_FORMATS: Choices<TableFormat> = &[
    ("csv", TableFormat::Csv, "Text"),
    ("npz", TableFormat::Npz, "A NumPy archive"),
];

const ROW_STORES: Choices<RowStore> = &[
    ("sqlite", RowStore::Sqlite, "One SQLite file"),
    ("parquet", RowStore::Parquet, "A folder of Parquet files"),
];
