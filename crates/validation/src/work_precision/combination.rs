//! What is combined, and what came of it: plain data.

use dwell_dynamics::Method;
use dwell_study::number_format::digits;

/// In what the equation of motion is evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Evaluation {
    /// The mechanism itself, in double precision.
    Exact,
    /// The same in single precision.
    SinglePrecision,
    /// A table of the reduced model.
    Table {
        /// What it was asked to keep, as a part of the largest value.
        accuracy: f64,
        /// Cells of m and ½m′.
        cells: usize,
        /// Bytes of m and ½m′.
        bytes: usize,
    },
    /// Something else, which a caller brought.
    Other(&'static str),
}

impl Evaluation {
    /// What figures and tables call it.
    pub fn name(&self) -> String {
        match self {
            Self::Exact => "exact f64".to_owned(),
            Self::SinglePrecision => "exact f32".to_owned(),
            Self::Table { accuracy, .. } => format!("table {accuracy:.0e}"),
            Self::Other(name) => (*name).to_owned(),
        }
    }

    /// The coarsest that its own errors make of any motion, as a rule: beyond it no tolerance helps.
    pub(super) fn relative_error(&self) -> f64 {
        match self {
            Self::Exact | Self::Other(_) => 0.0,
            Self::SinglePrecision => f64::from(f32::EPSILON),
            Self::Table { accuracy, .. } => *accuracy,
        }
    }
}

/// How the equation is followed in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// Step by step, with this relative and absolute tolerance.
    Steps(Method, f64),
    /// By its energy: the time is a quadrature over the coordinate.
    Quadrature,
}

impl Integrator {
    /// What figures and tables call it, without its tolerance.
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

/// A way to compute the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Combination {
    /// In what the equation is evaluated.
    pub evaluation: Evaluation,
    /// How it is followed.
    pub integrator: Integrator,
}

impl Combination {
    /// What figures and tables call it.
    pub fn name(&self) -> String {
        let tolerance = match self.integrator.tolerance() {
            Some(tolerance) => format!(" {tolerance:.0e}"),
            None => String::new(),
        };
        let evaluation = match self.evaluation {
            Evaluation::Exact => String::new(),
            other => format!(", {}", other.name().trim_start_matches("exact ")),
        };
        format!("{}{tolerance}{evaluation}", self.integrator.name())
    }
}

/// True errors: the largest over the times that are looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Of the free coordinates, rad or m.
    pub coordinate: f64,
    /// Of kinetic + potential energy − work, as a part of the largest kinetic energy; the energies are
    /// those of the exact model.
    pub energy: f64,
    /// Of the worst reaction, as a part of the largest reaction of its unit; not a number where there is
    /// none.
    pub reaction: f64,
}

impl Errors {
    /// One of them.
    pub fn of(&self, quantity: ErrorQuantity) -> f64 {
        match quantity {
            ErrorQuantity::Coordinate => self.coordinate,
            ErrorQuantity::Energy => self.energy,
            ErrorQuantity::Reaction => self.reaction,
        }
    }
}

/// What an error is of.
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

/// What a combination costs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cost {
    /// Steps taken.
    pub steps: usize,
    /// Steps rejected.
    pub rejected: usize,
    /// Evaluations of the equation of motion; of a quadrature, of the inertia (and potential).
    pub evaluations: usize,
    /// Jacobians.
    pub jacobians: usize,
    /// Evaluations, with each Jacobian as so many as it has numbers beside the values.
    pub weighted_evaluations: usize,
    /// Time, in units of one exact evaluation in double precision of the same equation, in the same run:
    /// the least of the repetitions.
    pub time: f64,
    /// Time of making what is evaluated (a table), in the same unit; zero where nothing is made.
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

/// The measure of a cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CostMeasure {
    /// Evaluations with the weighed Jacobians: counted, so every machine finds the same.
    Evaluations,
    /// Time of a run, once everything is made.
    Time,
    /// Time of the first run: with the making of the table.
    TimeWithBuild,
}

/// A combination that was run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CombinationResult {
    /// Which.
    pub combination: Combination,
    /// Its true errors.
    pub errors: Errors,
    /// What it took.
    pub cost: Cost,
}

/// What the errors are measured from.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceInfo {
    /// How it was found, in words.
    pub method: String,
    /// How well it is known: a smaller error says no more than that it is below.
    pub error: Errors,
}

/// The whole study of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkPrecision {
    /// Everything that was run.
    pub points: Vec<CombinationResult>,
    /// Of what was not run or not finished: what and why.
    pub omitted: Vec<String>,
    /// What the errors are measured from.
    pub reference: ReferenceInfo,
    /// What was followed, in words: how long, and what of the scene was changed for it.
    pub motion_notes: Vec<String>,
    /// How long the motion is, s.
    pub duration: f64,
    /// `rad` or `m`, or both where coordinates of both kinds are free.
    pub unit: &'static str,
    /// Runs of which each time is the least.
    pub repetitions: usize,
    /// One exact evaluation, s.
    pub evaluation_time: f64,
    /// One exact Jacobian, in such units.
    pub jacobian_cost: f64,
}

impl WorkPrecision {
    /// An error of a point, or the floor where that is larger.
    pub fn error_bound(&self, point: &CombinationResult, quantity: ErrorQuantity) -> f64 {
        let error = point.errors.of(quantity);
        // A number that is none must stay none.
        if error < self.reference.error.of(quantity) {
            self.reference.error.of(quantity)
        } else {
            error
        }
    }

    /// Whether an error of a point is below what is known.
    pub fn is_below_reference_error(
        &self,
        point: &CombinationResult,
        quantity: ErrorQuantity,
    ) -> bool {
        point.errors.of(quantity) < self.reference.error.of(quantity)
    }

    /// The Pareto front, as places in `points`, from the cheapest to the most precise: nothing else
    /// that is stepped in time is at once as cheap and as precise. Quadrature is left out, since it knows the
    /// whole motion at once and nothing that is followed comes near it: see [`WorkPrecision::quadrature`]. Counted
    /// evaluations compare integrators alone, so the front over them is that of the exact evaluations: one of
    /// a table is another thing.
    pub fn pareto_front(&self, quantity: ErrorQuantity, measure: CostMeasure) -> Vec<usize> {
        let stepped = |&k: &usize| {
            let point = &self.points[k];
            let stepped = matches!(point.combination.integrator, Integrator::Steps(..));
            let by_count = measure == CostMeasure::Evaluations;
            let alike = !by_count || point.combination.evaluation == Evaluation::Exact;
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

    /// The cheapest combination that is stepped in time and reaches an accuracy, as a place in `points`.
    pub fn cheapest(
        &self,
        quantity: ErrorQuantity,
        measure: CostMeasure,
        accuracy: f64,
    ) -> Option<usize> {
        let front = self.pareto_front(quantity, measure);
        let enough = |&&k: &&usize| self.error_bound(&self.points[k], quantity) <= accuracy;
        front.iter().find(enough).copied()
    }

    /// The motion by quadrature of the exact model, where it has one.
    pub fn quadrature(&self) -> Option<&CombinationResult> {
        let exact = |p: &&CombinationResult| {
            p.combination.integrator == Integrator::Quadrature
                && p.combination.evaluation == Evaluation::Exact
        };
        self.points.iter().find(exact)
    }
}

/// How much is tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Effort {
    /// Tolerances as powers of ten, from the coarsest to the finest.
    pub tolerance_exponents: Vec<i32>,
    /// Accuracies of tables.
    pub table_accuracies: Vec<f64>,
    /// Most steps of one combination.
    pub max_steps: usize,
    /// Runs of which the least time counts; at least one.
    pub repetitions: usize,
}

impl Effort {
    /// Everything: a study of its own.
    pub fn full() -> Self {
        Self {
            tolerance_exponents: (-13..=-3).rev().collect(),
            table_accuracies: vec![1e-4, 1e-6, 1e-8, 1e-10, 1e-12],
            max_steps: 20_000,
            repetitions: 3,
        }
    }

    /// The finest tolerance.
    pub(super) fn finest_tolerance(&self) -> Option<f64> {
        self.tolerance_exponents
            .last()
            .map(|&power| 10_f64.powi(power))
    }

    /// What a report has time for.
    pub fn brief() -> Self {
        Self {
            tolerance_exponents: vec![-3, -5, -7, -9, -11, -13],
            table_accuracies: vec![1e-6, 1e-10],
            max_steps: 5_000,
            repetitions: 3,
        }
    }
}

/// A part in words; what is no number is said to be none.
pub(super) fn digits_or_dash(value: f64, count: usize) -> String {
    if value.is_nan() {
        "–".to_owned()
    } else {
        digits(value, count)
    }
}

/// An error in words: an error below what the reference resolves is given as an upper bound.
pub(super) fn describe_error(error: f64, reference_error: f64) -> String {
    if error < reference_error {
        format!("< {}", digits(reference_error, 2))
    } else {
        digits_or_dash(error, 2)
    }
}
