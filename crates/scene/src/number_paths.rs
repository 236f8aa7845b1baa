//! The numbers that a scene gives, and their paths.

use crate::diagnostics::Span;
use crate::wording::{choices, shorten};
use dwell_geometry::BodyId;

/// A number of the scene that may be changed, and where it is written.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BodyNumber {
    pub(crate) body: BodyId,
    pub(crate) field: BodyField,
    /// As written, in the scene's unit.
    pub(crate) value: f64,
    pub(crate) span: Span,
}

/// Which number of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BodyField {
    Mass,
    Inertia,
    /// Component of the centre of mass.
    Center(usize),
    /// Component of the k-th point.
    Point(usize, usize),
}

/// A number outside the bodies.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SectionNumber {
    /// The keys that lead to it, by their current names.
    pub(crate) path: String,
    /// The same by their former names; equal to `path` where no key was renamed.
    pub(crate) former_path: String,
    /// As written, in the scene's unit.
    pub(crate) value: f64,
    pub(crate) span: Span,
}

impl BodyNumber {
    /// Its path; `point` gives the name of the k-th point of the body.
    pub(crate) fn path<'n>(&self, body: &str, point: impl Fn(usize) -> &'n str) -> String {
        match self.field {
            BodyField::Mass => format!("{body}.mass"),
            BodyField::Inertia => format!("{body}.inertia"),
            BodyField::Center(axis) => format!("{body}.center[{axis}]"),
            BodyField::Point(k, axis) => format!("{body}.points.{}[{axis}]", point(k)),
        }
    }
}

/// Message and help for a path without a number: the numbers of that body, or all.
pub(crate) fn no_number(path: &str, all: &[String]) -> (String, String) {
    let first = |path: &str| path.split('.').next().map(str::to_owned);
    let body = first(path).unwrap_or_default();
    let of_body: Vec<_> = all
        .iter()
        .filter(|p| first(p).as_deref() == Some(&body))
        .map(String::as_str)
        .collect();
    let help = if of_body.is_empty() {
        choices(
            path,
            "numbers written in the scene",
            all.iter().map(String::as_str),
        )
    } else {
        choices(
            path,
            &format!("numbers written in `{body}`"),
            of_body.into_iter(),
        )
    };
    (format!("the scene has no number `{}`", shorten(path)), help)
}
