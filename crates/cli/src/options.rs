//! The arguments.

use clap::{Args, Parser, Subcommand, ValueEnum};
use dwell_dynamics::Method;
use dwell_study::{About, Exported, Language, Printed, Shard};
use std::path::PathBuf;

/// The reduced-parameter dynamics of mechanisms, checked.
#[derive(Debug, Parser)]
#[command(name = "dwell", version, arg_required_else_help = true)]
pub(crate) struct Options {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Folder for the files that are written
    #[arg(long, global = true, default_value = "reports", value_name = "FOLDER")]
    pub(crate) out: PathBuf,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Degrees of freedom, groups, branch and range of a scene
    Check {
        /// The scene file
        scene: PathBuf,
    },
    /// Reduced parameters over the range: table and pictures
    Reduce {
        /// The scene file
        scene: PathBuf,
        /// Also a table that gives everything back to this part of its largest value, such as 1e-12
        #[arg(long, value_parser = part, value_name = "ACCURACY", allow_hyphen_values = true)]
        table: Option<f64>,
        /// How near everything must be over the whole range, as --accuracy of simulate: what meets it at the least
        /// cost is picked, exact rows or a table too
        #[arg(long, value_parser = wanted, value_name = "ACCURACY", allow_hyphen_values = true, conflicts_with = "table")]
        accuracy: Option<f64>,
        /// The table begins here, in the scene's unit (over all turns, or all but 2 % of the range at each end, if absent)
        #[arg(long, requires_all = ["table", "to"], value_parser = finite, value_name = "COORDINATE", allow_hyphen_values = true)]
        from: Option<f64>,
        /// The table ends here
        #[arg(long, requires_all = ["table", "from"], value_parser = finite, value_name = "COORDINATE", allow_hyphen_values = true)]
        to: Option<f64>,
    },
    /// Motion in time under loads and drives, with energies and reactions: tables and pictures
    Simulate {
        /// The scene file
        scene: PathBuf,
        /// The integrator
        #[arg(long, value_enum, default_value_t = MethodName::Bdf)]
        method: MethodName,
        /// Relative tolerance
        #[arg(long, default_value = "1e-10", value_parser = tolerance, value_name = "TOLERANCE", allow_hyphen_values = true)]
        rtol: f64,
        /// Absolute tolerance, rad and rad/s (as the relative one, if absent)
        #[arg(long, value_parser = tolerance, value_name = "TOLERANCE", allow_hyphen_values = true)]
        atol: Option<f64>,
        /// Longest step, s (as long as the tolerance lets it be, if absent)
        #[arg(long, value_parser = time, value_name = "SECONDS", allow_hyphen_values = true)]
        max_step: Option<f64>,
        /// In place of method and tolerance: how near the result must be, in rad and parts of the largest, such as 1e-6;
        /// or draft (1e-3), standard (1e-6), precise (1e-9), reference (1e-10). What meets it at the least cost is picked
        #[arg(long, value_parser = wanted, value_name = "ACCURACY", allow_hyphen_values = true,
              conflicts_with_all = ["method", "rtol", "atol", "max_step"])]
        accuracy: Option<f64>,
        /// Time between the samples of the table, s (a thousandth of the motion, if absent)
        #[arg(long, value_parser = time, value_name = "SECONDS", allow_hyphen_values = true)]
        every: Option<f64>,
    },
    /// The steady cycle of a driven machine, and the flywheel for a wanted evenness
    Cycle {
        /// The scene file
        scene: PathBuf,
        /// Wanted coefficient of fluctuation, such as 0.02: tells the flywheel it takes
        #[arg(long, value_parser = fraction, value_name = "RATIO", allow_hyphen_values = true)]
        fluctuation: Option<f64>,
        /// The integrator
        #[arg(long, value_enum, default_value_t = MethodName::Bdf)]
        method: MethodName,
        /// Relative and absolute tolerance
        #[arg(long, default_value = "1e-10", value_parser = tolerance, value_name = "TOLERANCE", allow_hyphen_values = true)]
        rtol: f64,
    },
    /// What accuracy costs: every combination of evaluation, integrator and tolerance on the motion, against its
    /// true error
    Tradeoff {
        /// The scene file
        scene: PathBuf,
    },
    /// Where a machine stays at rest, with stability and natural frequencies
    Equilibria {
        /// The scene file
        scene: PathBuf,
    },
    /// Small motions about an equilibrium: the matrices A, B, C and D, and eigenvalues
    Linearise {
        /// The scene file
        scene: PathBuf,
        /// About which state
        #[arg(long, value_enum, default_value_t = AboutName::Equilibrium)]
        at: AboutName,
    },
    /// Closed forms of a mechanism made of dyads: positions, m, ½m′ and a reaction's a and b, as LaTeX or code
    Symbolic {
        /// The scene file
        scene: PathBuf,
        /// In which language
        #[arg(long, value_enum, default_value_t = PrintedName::Latex)]
        to: PrintedName,
        /// The reaction, such as A.x (the first that the scene requests, if absent)
        #[arg(long, value_name = "NAME")]
        reaction: Option<String>,
    },
    /// Positions, speeds and accelerations along the prescribed motion, the sweep or the range
    Kinematics(Along),
    /// Actions and reactions under the loads, at rest in each position
    Statics(Along),
    /// Actions and reactions under loads and inertia, along the prescribed motion or the sweep
    Kinetostatics(Along),
    /// The scene value that gives a wanted period of the free motion
    Calibrate {
        /// The scene file
        scene: PathBuf,
        /// The value, such as crank.inertia (the scene's calibration, if absent)
        #[arg(long, value_name = "VALUE")]
        set: Option<String>,
        /// The wanted period, s (the scene's calibration, if absent)
        #[arg(long, value_parser = time, value_name = "SECONDS", allow_hyphen_values = true)]
        period: Option<f64>,
    },
    /// A study of many variants of a scene, on all cores, kept in an SQLite file: a run that was ended goes on
    Sweep {
        /// The scene file
        scene: PathBuf,
        /// What varies, in the scene's unit: PATH=FROM:TO:COUNT, PATH=A,B,C, PATH~normal(MEAN,SD),
        /// PATH~uniform(FROM,TO), PATH±TOLERANCE or PATH±PERCENT%; may be given several times
        #[arg(
            long,
            required = true,
            value_name = "VARIATION",
            allow_hyphen_values = true
        )]
        vary: Vec<String>,
        /// How often what is random is drawn
        #[arg(long, value_parser = whole, value_name = "COUNT", allow_hyphen_values = true)]
        samples: Option<u64>,
        /// Which random numbers
        #[arg(
            long,
            default_value_t = 1,
            value_name = "NUMBER",
            allow_hyphen_values = true
        )]
        seed: u64,
        /// Results, such as period or m.most, or all that begin so, such as m (all, if absent)
        #[arg(long, value_name = "RESULT", value_delimiter = ',')]
        want: Vec<String>,
        /// Only this part of the points, such as 2/8, in a file of its own
        #[arg(long, value_name = "PART/PARTS", allow_hyphen_values = true)]
        shard: Option<Shard>,
        /// Compute nothing: write what is there, that of shards too
        #[arg(long, value_enum, value_name = "FORM")]
        export: Option<ExportName>,
    },
    /// All checks on all cases, or on those named; exit status 1 if one fails
    Validate {
        /// Names of cases, or folders with a scene.toml; all cases if none
        cases: Vec<String>,
        /// The folder of the cases
        #[arg(long, default_value = OWN_CASES, value_name = "FOLDER")]
        folder: PathBuf,
        /// With the rows of the extremes that take minutes
        #[arg(long)]
        long: bool,
    },
    /// The JSON schema of scenes, for editors that complete TOML
    Schema,
}

/// The folder of the workbench's own cases.
pub(crate) const OWN_CASES: &str = "validation";

#[derive(Debug, Args)]
pub(crate) struct Along {
    /// The scene file
    pub(crate) scene: PathBuf,
    /// Positions, the ends among them (as the scene says, if absent)
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=1_000_000), value_name = "COUNT", allow_hyphen_values = true)]
    pub(crate) points: Option<u32>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum MethodName {
    /// Implicit, variable order 1 to 5: for whatever is stiff, such as friction
    Bdf,
    /// Implicit Runge–Kutta of order 4
    Esdirk34,
    /// Implicit, order 2
    TrBdf2,
    /// Explicit Runge–Kutta of order 5: for what is smooth
    Tsit45,
    /// Explicit Runge–Kutta of order 8: for what is smooth, to many digits
    Dop853,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Bdf => Self::Bdf,
            MethodName::Esdirk34 => Self::Esdirk34,
            MethodName::TrBdf2 => Self::TrBdf2,
            MethodName::Tsit45 => Self::Tsit45,
            MethodName::Dop853 => Self::Dop853,
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum AboutName {
    /// The equilibrium next to the start
    Equilibrium,
    /// The start of [motion], or else of the assembly at rest
    Start,
}

impl From<AboutName> for About {
    fn from(name: AboutName) -> Self {
        match name {
            AboutName::Equilibrium => Self::Equilibrium,
            AboutName::Start => Self::Start,
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum ExportName {
    /// Text, with the messages
    Csv,
    /// A NumPy archive
    Npz,
}

impl From<ExportName> for Exported {
    fn from(name: ExportName) -> Self {
        match name {
            ExportName::Csv => Self::Csv,
            ExportName::Npz => Self::Npz,
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum PrintedName {
    /// Markdown with formulas in LaTeX
    Latex,
    /// A function in Rust
    Rust,
    /// A function in C
    C,
    /// A function in Python
    Python,
}

impl From<PrintedName> for Printed {
    fn from(name: PrintedName) -> Self {
        match name {
            PrintedName::Latex => Self::Latex,
            PrintedName::Rust => Self::Code(Language::Rust),
            PrintedName::C => Self::Code(Language::C),
            PrintedName::Python => Self::Code(Language::Python),
        }
    }
}

/// A coefficient of fluctuation that makes sense: a machine of more than 2 would turn back.
fn fraction(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value > 0.0 && value < 2.0 {
        Ok(value)
    } else {
        Err("expected a number between 0 and 2".to_owned())
    }
}

fn whole(text: &str) -> Result<u64, String> {
    text.parse()
        .map_err(|_| "expected a whole number from 0 on".to_owned())
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "not a number".to_owned())
}

fn finite(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err("not a finite number".to_owned())
    }
}

/// A tolerance that an integrator can keep: below 1e-14 none of them can in double precision, and
/// above 1e-3 the energy of a motion is off by a quarter within two turns.
fn tolerance(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if (1e-14..=1e-3).contains(&value) {
        Ok(value)
    } else {
        Err("a tolerance is between 1e-14 and 1e-3".to_owned())
    }
}

/// What a result can be asked for: a number, or a preset by its name.
fn wanted(text: &str) -> Result<f64, String> {
    let preset = dwell_study::PRESETS.iter().find(|(name, _)| *name == text);
    let value = match preset {
        Some((_, value)) => *value,
        None => number(text).map_err(|_| {
            let names = dwell_study::PRESETS.map(|(name, _)| name).join(", ");
            format!("expected a number such as 1e-6, or one of {names}")
        })?,
    };
    if (1e-13..=1e-2).contains(&value) {
        Ok(value)
    } else {
        Err("an accuracy is between 1e-13 and 1e-2".to_owned())
    }
}

/// What a table can be asked for: double precision has 1e-14, and above 1e-2 it is none.
fn part(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if (1e-14..=1e-2).contains(&value) {
        Ok(value)
    } else {
        Err("a table's accuracy is between 1e-14 and 1e-2".to_owned())
    }
}

fn time(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err("expected a time above zero, in seconds".to_owned())
    }
}
