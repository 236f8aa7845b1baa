//! Combinations of evaluation, integrator and tolerance, and their results: plain data.

use super::commands::CommandRun;
use super::exported_code::ExportedCode;
use super::fixed_step::FixedStep;
use super::requested::RequestedCosts;
use dwell_dynamics::Method;
use dwell_study::number_format::digits;

/// The evaluation of the equation of motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Evaluation {
    /// The mechanism itself, in double precision.
    Exact,
    /// The mechanism itself, in single precision.
    SinglePrecision,
    /// A table of the reduced model.
    Table {
        /// The required accuracy, relative to the largest value.
        accuracy: f64,
        /// Cells of m and ½m′.
        cells: usize,
        /// Bytes of m and ½m′.
        bytes: usize,
    },
    /// Another evaluation, given by the caller.
    Other(&'static str),
}

impl Evaluation {
    /// Its name in figures and tables.
    pub fn name(&self) -> String {
        match self {
            Self::Exact => "exact f64".to_owned(),
            Self::SinglePrecision => "exact f32".to_owned(),
            Self::Table { accuracy, .. } => format!("table {accuracy:.0e}"),
            Self::Other(name) => (*name).to_owned(),
        }
    }

    /// Its typical relative error: smaller tolerances do not improve a motion.
    pub(super) fn relative_error(&self) -> f64 {
        match self {
            Self::Exact | Self::Other(_) => 0.0,
            Self::SinglePrecision => f64::from(f32::EPSILON),
            Self::Table { accuracy, .. } => *accuracy,
        }
    }
}

/// The integration of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// Step by step, with this relative and absolute tolerance.
    Steps(Method, f64),
    /// By its energy: the time is a quadrature over the coordinate.
    Quadrature,
}

impl Integrator {
    /// Its name in figures and tables, without its tolerance.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Steps(method, _) => method.name(),
            Self::Quadrature => "quadrature",
        }
    }

    /// Its tolerance, if it has one.
    pub fn tolerance(&self) -> Option<f64> {
        match self {
            Self::Steps(_, tolerance) => Some(*tolerance),
            Self::Quadrature => None,
        }
    }
}

/// A method of computing the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Combination {
    /// Its evaluation.
    pub evaluation: Evaluation,
    /// Its integrator.
    pub integrator: Integrator,
}

impl Combination {
    /// Its name in figures and tables.
    pub fn name(&self) -> String {
        let tolerance = self
            .integrator
            .tolerance()
            .map(|t| format!(" {t:.0e}"))
            .unwrap_or_default();
        let evaluation = match self.evaluation {
            Evaluation::Exact => String::new(),
            other => format!(", {}", other.name().trim_start_matches("exact ")),
        };
        format!("{}{tolerance}{evaluation}", self.integrator.name())
    }
}

/// True errors: the largest over the compared times.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// Error of the free coordinates, rad or m.
    pub coordinate: f64,
    /// Error of kinetic + potential energy − work, relative to the largest kinetic energy; the energies are
    /// those of the exact model.
    pub energy: f64,
    /// Error of the worst reaction, relative to the largest reaction of its unit; NaN without reactions.
    pub reaction: f64,
}

impl Errors {
    /// The errors of a motion with missing rows.
    pub(super) const UNKNOWN: Self = Self {
        coordinate: f64::NAN,
        energy: f64::NAN,
        reaction: f64::NAN,
    };

    /// One of them.
    pub fn of(&self, quantity: ErrorQuantity) -> f64 {
        match quantity {
            ErrorQuantity::Coordinate => self.coordinate,
            ErrorQuantity::Energy => self.energy,
            ErrorQuantity::Reaction => self.reaction,
        }
    }
}

/// The quantity of an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorQuantity {
    /// The free coordinates.
    Coordinate,
    /// The energy balance.
    Energy,
    /// The worst reaction.
    Reaction,
}

impl ErrorQuantity {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Coordinate, Self::Energy, Self::Reaction];
}

/// The cost of a combination.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cost {
    /// Steps taken.
    pub steps: usize,
    /// Steps rejected.
    pub rejected: usize,
    /// Evaluations of the equation of motion, or for a quadrature of the inertia (and potential).
    pub evaluations: usize,
    /// Jacobians.
    pub jacobians: usize,
    /// Evaluations, with each Jacobian as the number of its dual-number evaluations.
    pub weighted_evaluations: usize,
    /// Time, in units of one exact evaluation of the equation in double precision in the same run:
    /// the minimum of the repetitions.
    pub time: f64,
    /// Time of building a table, in the same unit; zero without table.
    pub build_time: f64,
}

impl Cost {
    /// One of them.
    pub fn of(&self, measure: CostMeasure) -> f64 {
        match measure {
            CostMeasure::Evaluations => self.weighted_evaluations as f64,
            CostMeasure::Time => self.time,
            CostMeasure::TimeWithBuild => self.time + self.build_time,
        }
    }
}

impl CostMeasure {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Evaluations, Self::Time, Self::TimeWithBuild];
}

/// The measure of a cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CostMeasure {
    /// Evaluations with the weighted Jacobians: counted, so the same on every machine.
    Evaluations,
    /// Time of a run, once tables are built.
    Time,
    /// Time of the first run, with the building of the table.
    TimeWithBuild,
}

/// A combination that was run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CombinationResult {
    /// The combination.
    pub combination: Combination,
    /// Its true errors.
    pub errors: Errors,
    /// Its cost.
    pub cost: Cost,
}

/// The reference of the errors.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceInfo {
    /// How it was computed.
    pub method: String,
    /// Its own error; smaller errors are only known to be below it.
    pub error: Errors,
}

/// The whole study of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkPrecision {
    /// All results.
    pub points: Vec<CombinationResult>,
    /// The classical Runge–Kutta method with a fixed step of 1 ms, if it reaches the end.
    pub fixed_step: Option<FixedStep>,
    /// The exported code with steps of a millisecond.
    pub exported_code: Vec<ExportedCode>,
    /// The command at each named accuracy.
    pub commands: Vec<CommandRun>,
    /// The cost of an evaluation by the requested results.
    pub requested: RequestedCosts,
    /// The combinations that were omitted or not finished, with the reason.
    pub omitted: Vec<String>,
    /// The reference of the errors.
    pub reference: ReferenceInfo,
    /// Notes on the motion: its duration, and changes of the scene.
    pub motion_notes: Vec<String>,
    /// Duration of the motion, s.
    pub duration: f64,
    /// `rad` or `m`, or both if coordinates of both kinds are free.
    pub unit: &'static str,
    /// Number of repetitions; each time is their minimum.
    pub repetitions: usize,
    /// One exact evaluation, s.
    pub evaluation_time: f64,
    /// One exact Jacobian, in such units.
    pub jacobian_cost: f64,
}

impl WorkPrecision {
    /// An error of a point, or the error of the reference if that is larger.
    pub fn error_bound(&self, point: &CombinationResult, quantity: ErrorQuantity) -> f64 {
        let (error, floor) = (point.errors.of(quantity), self.reference.error.of(quantity));
        // NaN must remain NaN.
        if error < floor { floor } else { error }
    }

    /// Whether an error of a point is below that of the reference.
    pub fn is_below_reference(&self, point: &CombinationResult, quantity: ErrorQuantity) -> bool {
        point.errors.of(quantity) < self.reference.error.of(quantity)
    }

    /// An error of a point as text: below the error of the reference as an upper bound.
    pub(super) fn describe_error(&self, of: &CombinationResult, quantity: ErrorQuantity) -> String {
        if self.is_below_reference(of, quantity) {
            format!("< {}", digits(self.reference.error.of(quantity), 2))
        } else {
            digits_or_dash(of.errors.of(quantity), 2)
        }
    }

    /// The Pareto front of the integrators, as indices of `points`, from the cheapest to the most accurate: no other
    /// combination is both as cheap and as accurate. Quadrature is excluded, because no integrator is competitive with it (see
    /// [`WorkPrecision::quadrature`]). Numbers of evaluations compare integrators, so their front contains exact
    /// evaluations only: an evaluation of a table is not comparable.
    pub fn pareto_front(&self, quantity: ErrorQuantity, measure: CostMeasure) -> Vec<usize> {
        let stepped = |&k: &usize| {
            let point = &self.points[k];
            let stepped = matches!(point.combination.integrator, Integrator::Steps(..));
            let exact = point.combination.evaluation == Evaluation::Exact;
            let alike = exact || measure != CostMeasure::Evaluations;
            stepped && alike && point.errors.of(quantity).is_finite()
        };
        let of = |k: usize| {
            let point = &self.points[k];
            (point.cost.of(measure), self.error_bound(point, quantity))
        };
        let mut order: Vec<usize> = (0..self.points.len()).filter(stepped).collect();
        order.sort_by(|&i, &j| {
            let ((a, b), (c, d)) = (of(i), of(j));
            a.total_cmp(&c).then(b.total_cmp(&d))
        });
        let mut min_error = f64::INFINITY;
        order.retain(|&k| {
            let (_, error) = of(k);
            let better = error < min_error;
            min_error = min_error.min(error);
            better
        });
        order
    }

    /// Whether a point and all finer tolerances of its integrator with its evaluation reach an accuracy: a single one may reach it
    /// by chance.
    fn reaches(&self, point: &CombinationResult, quantity: ErrorQuantity, accuracy: f64) -> bool {
        let of = |point: &CombinationResult| match point.combination.integrator {
            Integrator::Steps(method, tolerance) => (Some(method), tolerance),
            Integrator::Quadrature => (None, 0.0),
        };
        let (method, tolerance) = of(point);
        let mut finer = self.points.iter().filter(|other| {
            let (own, finer) = of(other);
            let alike = other.combination.evaluation == point.combination.evaluation;
            own == method && alike && finer <= tolerance
        });
        finer.all(|other| self.error_bound(other, quantity) <= accuracy)
    }

    /// The cheapest integrator that reaches an accuracy with its tolerance and all finer ones, as an index of `points`.
    pub fn cheapest(
        &self,
        quantity: ErrorQuantity,
        measure: CostMeasure,
        accuracy: f64,
    ) -> Option<usize> {
        let alike = |point: &CombinationResult| {
            let stepped = matches!(point.combination.integrator, Integrator::Steps(..));
            let exact = point.combination.evaluation == Evaluation::Exact;
            stepped && (exact || measure != CostMeasure::Evaluations)
        };
        let points = self.points.iter().enumerate();
        let enough = points.filter(|(_, p)| alike(p) && self.reaches(p, quantity, accuracy));
        let cost = |point: &CombinationResult| point.cost.of(measure);
        let cheapest = enough.min_by(|(_, a), (_, b)| cost(a).total_cmp(&cost(b)));
        cheapest.map(|(k, _)| k)
    }

    /// The motion by quadrature of the exact model, if possible.
    pub fn quadrature(&self) -> Option<&CombinationResult> {
        let exact = |p: &&CombinationResult| {
            p.combination.integrator == Integrator::Quadrature
                && p.combination.evaluation == Evaluation::Exact
        };
        self.points.iter().find(exact)
    }
}

/// The extent of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Effort {
    /// Tolerances as powers of ten, from the coarsest to the finest.
    pub tolerance_exponents: Vec<i32>,
    /// Accuracies of tables.
    pub table_accuracies: Vec<f64>,
    /// Maximum number of steps of a combination.
    pub max_steps: usize,
    /// Number of repetitions, at least one; the minimum time counts.
    pub repetitions: usize,
    /// Whether exported code is compiled and measured, and the command with its files.
    pub exported_code: bool,
}

impl Effort {
    /// The effort of `dwell work-precision`.
    pub fn full() -> Self {
        Self {
            tolerance_exponents: (-13..=-3).rev().collect(),
            table_accuracies: vec![1e-4, 1e-6, 1e-8, 1e-10, 1e-12],
            max_steps: 20_000,
            repetitions: 3,
            exported_code: true,
        }
    }

    /// The effort of the study in the reports of `dwell validate`.
    pub fn brief() -> Self {
        Self {
            tolerance_exponents: vec![-3, -5, -7, -9, -11, -13],
            table_accuracies: vec![1e-6, 1e-10],
            max_steps: 5_000,
            repetitions: 3,
            exported_code: false,
        }
    }
}

/// A number as text; a dash for NaN.
pub(super) fn digits_or_dash(value: f64, count: usize) -> String {
    if value.is_nan() {
        "–".to_owned()
    } else {
        digits(value, count)
    }
}
