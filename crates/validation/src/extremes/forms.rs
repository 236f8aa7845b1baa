//! The forms of evaluation of the grid: in the plane, in an oblique plane in space, in single precision, on a table, as exported
//! code. All forms have the same series and references; each form states how many digits it may lose.

use super::all_in;
pub(super) use super::form_model::FormModel;
pub use super::form_report::{add_to, check};
use super::series::{ParameterSeries, Requirement, SeriesResult};
use dwell_export::Precision;
use std::sync::Arc;

/// A kind of evaluation, in a kind of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    /// The evaluated object.
    pub evaluated: Evaluated,
    /// Its numbers.
    pub precision: Precision,
}

/// The evaluated object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Evaluated {
    /// The planar mechanism.
    Plane,
    /// The mechanism in an oblique plane in space, which may take its planar equivalent.
    Space,
    /// The mechanism in space without its planar equivalent, with every loop closed in space.
    Loops,
    /// Its table.
    Table,
    /// Exported cells.
    Cells,
    /// The model's own operations, exported.
    Operations,
}

/// The required accuracy of tables and cells.
const ACCURACY: f64 = 1e-9;
/// The required accuracy of cells in single precision.
const SINGLE_ACCURACY: f64 = 1e-6;
/// Largest difference of exported operations from the model, in double and in single precision, that the export accepts.
const OPERATIONS: [f64; 2] = [1e-7, 1e-3];
/// A peak narrower than this fraction of its domain needs more samples than a table takes.
const NARROW: f64 = 1e-4;
/// Rounding errors of the lift: points and directions of the ground are rounded when they are placed in an oblique plane, as are the numbers
/// of a motion in each form.
const STATED: f64 = 8.0;
/// Allowed error of a result, in rounding errors or accuracies of the form: twice the 16 of a dyad, because the numbers are rounded, too, and in a
/// cell a value may be a small fraction of the largest.
const ALLOWED: f64 = 32.0;
/// Number of values of a series that are run in each form, and as exported code, whose own measurement takes thousands of coordinates.
const VALUES: [usize; 2] = [5, 3];
/// Values above these take long and are run in the plane only.
const LARGEST_VALUES: [(&str, f64); 2] = [("revolutions", 100.0), ("large-group", 8.0)];

impl Form {
    /// The form of the grid itself.
    pub const PLANE: Self = Self::of(Evaluated::Plane, Precision::Double);

    /// The others.
    pub const OTHERS: [Self; 9] = [
        Self::of(Evaluated::Space, Precision::Double),
        Self::of(Evaluated::Loops, Precision::Double),
        Self::of(Evaluated::Plane, Precision::Float),
        Self::of(Evaluated::Space, Precision::Float),
        Self::of(Evaluated::Loops, Precision::Float),
        Self::of(Evaluated::Table, Precision::Double),
        Self::of(Evaluated::Cells, Precision::Double),
        Self::of(Evaluated::Operations, Precision::Double),
        Self::of(Evaluated::Operations, Precision::Float),
    ];

    const fn of(evaluated: Evaluated, precision: Precision) -> Self {
        Self {
            evaluated,
            precision,
        }
    }

    /// The default form of a series, by its key.
    pub(super) fn of_grid(key: &str) -> Self {
        match key {
            "place-in-space" => Self::of(Evaluated::Loops, Precision::Double),
            "place-in-space-single" => Self::of(Evaluated::Loops, Precision::Float),
            _ => Self::PLANE,
        }
    }

    /// Its name in tables.
    pub fn name(self) -> String {
        let evaluated = match self.evaluated {
            Evaluated::Plane => "plane",
            Evaluated::Space => "space",
            Evaluated::Loops => "space, loops",
            Evaluated::Table => "table",
            Evaluated::Cells => "exported cells",
            Evaluated::Operations => "exported operations",
        };
        let precision = if self.is_single() { ", single" } else { "" };
        format!("{evaluated}{precision}")
    }

    fn is_single(self) -> bool {
        self.precision == Precision::Float
    }

    pub(super) fn is_in_space(self) -> bool {
        matches!(self.evaluated, Evaluated::Space | Evaluated::Loops)
    }

    /// Whether its accuracy is requested (relative to the largest value) instead of given by its number type.
    pub(super) fn is_fitted(self) -> bool {
        matches!(self.evaluated, Evaluated::Table | Evaluated::Cells)
    }

    /// The relative error of its numbers or functions.
    pub(super) fn accuracy(self) -> f64 {
        match (self.is_fitted(), self.is_single()) {
            (true, false) => ACCURACY,
            (true, true) => SINGLE_ACCURACY,
            (false, false) => f64::EPSILON,
            (false, true) => f32::EPSILON.into(),
        }
    }

    /// The nearest coordinate that its number type can represent.
    pub(super) fn coordinate(self, q: f64) -> f64 {
        self.precision.round(q)
    }

    /// The tolerance of a motion in it: below its rounding error, step control is meaningless.
    pub(super) fn tolerance(self, tolerance: f64) -> f64 {
        if self.is_single() {
            tolerance.max(SINGLE_ACCURACY)
        } else {
            tolerance
        }
    }

    /// Its requirement, from that of double precision in the plane: it loses as many rounding errors of its own numbers. A typed
    /// error is permitted if half of its digits are lost, or beyond the limits that an export or a table states.
    fn requirement(self, plane: Requirement, is_motion: bool) -> Requirement {
        if self == Self::PLANE {
            return plane;
        }
        let magnified = if self.is_fitted() && !is_motion {
            1.0
        } else {
            plane.condition_number
        };
        let error = 10_f64.powf(-plane.min_digits) + ALLOWED * self.accuracy() * magnified;
        let rounding = ALLOWED * self.accuracy();
        let refusable_from = match (self.evaluated, self.is_single()) {
            (Evaluated::Table | Evaluated::Cells, _) => NARROW.recip(),
            // One quantity of the worst condition suffices to reject the whole export.
            (Evaluated::Operations, single) => 0.1 * OPERATIONS[usize::from(single)] / rounding,
            (_, true) => self.accuracy().sqrt().recip(),
            (_, false) => plane.refusable_from,
        };
        Requirement {
            refusable_from,
            ..Requirement::from_error(error, plane.condition_number)
        }
    }

    /// The reason why a series is not run in it, by its key.
    pub fn not_run(self, key: &str) -> Option<&'static str> {
        let own = NOT_RUN.iter().find(|(evaluated, keys, _)| {
            evaluated.contains(&self.evaluated) && keys.contains(&key)
        });
        let is_run = key.starts_with("tolerance-") || IN_FORMS.split(' ').any(|other| other == key);
        let alone =
            "motions under loads, results of commands and places in space run in one form alone";
        let reason = own.map(|(_, _, reason)| *reason);
        reason.or((!is_run).then_some(alone))
    }
}

/// Series without counterpart in a form, or rejected there, by key, with the reason.
const NOT_RUN: [(&[Evaluated], &[&str], &str); 5] = [
    (
        SPACE,
        &["placement"],
        "an oblique plane rounds the points of what is far from the origin",
    ),
    (
        SPACE,
        &["light-crank", "gear-ratio", "cam-steepness"],
        "the lift has revolute and prismatic joints alone: no slot, teeth or cam",
    ),
    (
        &[Evaluated::Operations],
        &["cam-steepness"],
        "refused: a law known by its values alone has no operations",
    ),
    (
        &[Evaluated::Operations],
        &["large-group"],
        "refused: positions that Newton's method searches have no operations",
    ),
    (
        &[Evaluated::Table],
        &["cam-steepness"],
        "refused: a table's cells are of one width, and its first 64 samples miss a steep cam",
    ),
];
const SPACE: &[Evaluated] = &[Evaluated::Space, Evaluated::Loops];

/// Whether the cells of a series are those of a motion.
fn is_motion(series: &ParameterSeries) -> bool {
    ["motions", "tolerances", "stiff", "edges"].contains(&series.figure.0)
}

/// A series in a form: some of its values, with the requirements and stated errors of the form.
fn in_form(mut series: ParameterSeries, form: Form) -> ParameterSeries {
    let (motion, quantities) = (is_motion(&series), series.quantities.len());
    let (plane, run) = (series.requirement, series.run);
    let required = move |at, quantity| form.requirement(plane(at, quantity), motion);
    // A motion without correct digits shows nothing, and single precision overflows for the fourth power of a large length.
    let overflows = form.is_single() && series.key == "power-of-two";
    let slow = LARGEST_VALUES.iter().find(|(key, _)| *key == series.key);
    // The last digits of a compiler's own sines are not part of this study.
    let drops = motion || (form.is_single() && form.evaluated == Evaluated::Operations);
    series.values.retain(|&at| {
        let kept = (0..quantities).all(|quantity| required(at, quantity).min_digits > 0.0);
        (kept || !drops) && !(overflows && at > 1e9) && slow.is_none_or(|(_, most)| at <= *most)
    });
    let count = series.values.len();
    let is_exported = matches!(form.evaluated, Evaluated::Cells | Evaluated::Operations);
    let values = VALUES[usize::from(is_exported)].min(count);
    let kept = (0..values).map(|k| k * (count - 1) / (values - 1).max(1));
    series.values = kept.map(|k| series.values[k]).collect();
    let required = Arc::new(required);
    let stated = Arc::clone(&required);
    series.requirement = Box::new(move |at, quantity| required(at, quantity));
    series.run = Box::new(move |at| {
        let mut cells = run(at)?;
        if motion || form.is_in_space() {
            for (quantity, cell) in cells.iter_mut().enumerate() {
                let Ok(value) = cell else { continue };
                let magnified = stated(at, quantity).condition_number;
                value.error_estimate += STATED * form.accuracy() * magnified * value.scale;
            }
        }
        Ok(cells)
    });
    series
}

/// The series of the grid that are run in a form.
pub fn series(form: Form) -> Vec<ParameterSeries> {
    let all = all_in(form, false).into_iter();
    let run = all.filter(|series| form.not_run(&series.key).is_none());
    run.map(|series| in_form(series, form)).collect()
}

/// The results of forms.
pub fn evaluate(forms: &[Form]) -> Vec<(Form, Vec<SeriesResult>)> {
    let one = |&form: &Form| (form, super::evaluate(series(form)));
    forms.iter().map(one).collect()
}

/// The series that run in each form, in addition to those of tolerances; all others run once.
const IN_FORMS: &str = "limit-four-bar limit-slider-crank flat-parallelogram mass-ratio length power-of-two placement speed revolutions \
                        light-crank short-crank guide-near-path gear-ratio cam-steepness long-links large-group";
