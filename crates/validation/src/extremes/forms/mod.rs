//! The forms in which a result of the grid is computed: in the plane, obliquely in space, in single precision, on a table, as exported
//! code. The series are the same, with the same references; each form states what it may lose of their digits.

mod model;
mod report;

pub(super) use model::FormModel;
pub(super) use report::add_to;
pub use report::check;

use super::all_in;
use super::series::{ParameterSeries, Requirement, SeriesResult};
use dwell_export::Precision;
use dwell_numerics::Scalar;

/// A kind of evaluation, in a kind of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    /// What is evaluated.
    pub evaluated: Evaluated,
    /// Its numbers.
    pub precision: Precision,
}

/// What is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Evaluated {
    /// The planar mechanism.
    Plane,
    /// The mechanism in an oblique plane in space, which may take its planar equivalent.
    Space,
    /// The same with every loop closed in space.
    Loops,
    /// Its table.
    Table,
    /// Exported cells.
    Cells,
    /// The model's own operations, exported.
    Operations,
}

/// The accuracy that is asked of tables and cells.
const ACCURACY: f64 = 1e-9;
/// The same of cells in single precision.
const SINGLE_ACCURACY: f64 = 1e-6;
/// Roundings of a form, or its accuracies, that a result may err by: twice the 16 of a dyad, since the numbers are rounded, too, and in a
/// cell a value may be a small part of the largest.
const ALLOWED: f64 = 32.0;
/// Values of a series that are run in each form.
const VALUES: usize = 5;

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

    fn is_in_space(self) -> bool {
        matches!(self.evaluated, Evaluated::Space | Evaluated::Loops)
    }

    /// Whether it keeps an accuracy that is asked for, relative to the largest value, instead of that of its numbers.
    fn is_fitted(self) -> bool {
        matches!(self.evaluated, Evaluated::Table | Evaluated::Cells)
    }

    /// The error of one of its numbers or functions.
    pub(super) fn accuracy(self) -> f64 {
        match (self.is_fitted(), self.is_single()) {
            (true, false) => ACCURACY,
            (true, true) => SINGLE_ACCURACY,
            (false, false) => f64::EPSILON,
            (false, true) => f32::EPSILON.into(),
        }
    }

    /// The nearest coordinate that it can be asked for.
    pub(super) fn coordinate(self, q: f64) -> f64 {
        self.precision.round(q)
    }

    /// What it has to keep where double precision in the plane has to keep this: it loses as many roundings of its own numbers. A typed
    /// error is an answer where half of its digits are lost, or where the model that it is fitted to has an error of its accuracy.
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
        let refusable_from = match (self.is_fitted(), self.is_single()) {
            (true, _) => self.accuracy() / (ALLOWED * f64::EPSILON),
            (false, true) => self.accuracy().sqrt().recip(),
            (false, false) => plane.refusable_from,
        };
        Requirement {
            refusable_from,
            ..Requirement::from_error(error, plane.condition_number)
        }
    }

    /// Why a series makes no sense in it, by its key.
    pub fn no_sense(self, key: &str) -> Option<&'static str> {
        let in_space = |keys: &[&str]| self.is_in_space() && keys.contains(&key);
        if in_space(&["placement"]) {
            return Some("an oblique plane rounds what is far from the origin; the series of places in space has points that are not rounded");
        }
        if in_space(&["light-crank", "gear-ratio", "cam-steepness"]) {
            return Some("its joints lie in a plane: a slot, teeth between parallel axes, a cam");
        }
        None
    }
}

/// Whether the cells of a series are those of a motion.
fn is_motion(series: &ParameterSeries) -> bool {
    ["motions", "tolerances", "stiff", "edges"].contains(&series.figure.0)
}

/// A series as it is run in a form: some of its values, and what the form has to keep.
fn in_form(mut series: ParameterSeries, form: Form) -> ParameterSeries {
    let (count, motion) = (series.values.len(), is_motion(&series));
    let kept = (0..VALUES.min(count)).map(|k| k * (count - 1) / (VALUES.min(count) - 1).max(1));
    series.values = kept.map(|k| series.values[k]).collect();
    let plane = series.requirement;
    series.requirement = Box::new(move |at, quantity| form.requirement(plane(at, quantity), motion));
    series
}

/// The series that make sense in each form, with their results.
pub fn evaluate(forms: &[Form]) -> Vec<(Form, Vec<SeriesResult>)> {
    let one = |&form: &Form| {
        let all = all_in(form, false).into_iter();
        let sensible = all.filter(|series| form.no_sense(&series.key).is_none());
        let series = sensible.map(|series| in_form(series, form)).collect();
        (form, super::evaluate(series))
    };
    forms.iter().map(one).collect()
}
