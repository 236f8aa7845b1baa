//! The numbers of a scene by their path, such as `crank.inertia`: asking for one, and the same
//! scene with one of them changed.

use crate::bodies::Bodies;
use crate::error::SceneError;
use crate::names::shorten;
use crate::place::Place;
use crate::problem::{Problem, Problems, Span, choices};
use crate::scene::Scene;
use dwell_geometry::BodyId;
use miette::NamedSource;
use std::fmt::Write as _;
use std::sync::Arc;

/// A number of the scene that may be changed, and where it is written.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Number {
    pub(crate) body: BodyId,
    pub(crate) field: Field,
    /// As written, in the scene's unit.
    pub(crate) value: f64,
    pub(crate) span: Span,
}

/// Which number of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Field {
    Mass,
    Inertia,
    /// Component of the centre of mass.
    Center(usize),
    /// Component of the k-th point.
    Point(usize, usize),
}

impl Scene {
    /// The path of every number that [`value`](Self::value) and [`with_value`](Self::with_value)
    /// know, in the order of the file: `crank.mass`, `crank.inertia`, `crank.center[0]` (when it is
    /// written as [x, y]), `crank.points.B[1]`. Only what the file writes down has a path. The
    /// ground has its points alone, since its mass has no effect.
    pub fn numbers(&self) -> Vec<String> {
        self.numbers.iter().map(|n| self.path_of(n)).collect()
    }

    /// The number at `path`, in the scene's own unit.
    /// Beside those of [`numbers`](Self::numbers) these are all that the sections of joints, loads, frictions, drives and
    /// motions write, by their keys: `loads.brake.constant`, `motion.speed.phi`, `joints.guide.axis[0]`.
    ///
    /// # Errors
    /// [`SceneError`] when the path leads nowhere.
    pub fn value(&self, path: &str) -> Result<f64, SceneError> {
        self.written_at(path).map(|(value, _)| value)
    }

    /// The unit of the number at `path`, such as `mm` or `kg m2`; empty if there is no such number.
    pub fn unit_of(&self, path: &str) -> &str {
        match self.number_at(path).map(|n| n.field) {
            None => "",
            Some(Field::Mass) => &self.units.mass.name,
            Some(Field::Inertia) => &self.units.inertia.name,
            Some(Field::Center(_) | Field::Point(..)) => &self.units.length.name,
        }
    }

    /// A length, m, or an angle, rad, as the file would write it: in the scene's unit, and that unit.
    pub fn written(&self, si: f64, is_angle: bool) -> (f64, &str) {
        let unit = self.units.of(is_angle);
        (unit.written(si), &unit.name)
    }

    /// A length or an angle in the scene's unit, as one of SI: m or rad.
    pub fn si(&self, written: f64, is_angle: bool) -> f64 {
        self.units.of(is_angle).si(written)
    }

    /// The same scene with the number at `path` replaced by `value`, in the scene's own unit.
    ///
    /// The number is replaced in the text and the text read again: whatever follows from the
    /// number follows here too, and a message about it shows the number it is about.
    ///
    /// # Errors
    /// As [`with_values`](Self::with_values).
    pub fn with_value(&self, path: &str, value: f64) -> Result<Self, SceneError> {
        self.with_values(&[(path, value)])
    }

    /// The same with several numbers replaced at once; the text is read again but once.
    ///
    /// # Errors
    /// [`SceneError`] when a path leads nowhere or is named twice, a value is not finite, or the scene makes
    /// no sense with these numbers.
    pub fn with_values(&self, values: &[(&str, f64)]) -> Result<Self, SceneError> {
        let mut changes = Vec::with_capacity(values.len());
        for &(path, value) in values {
            let (_, span) = self.written_at(path)?;
            if !value.is_finite() {
                let message = format!("{value} is not a value for `{path}`: it is not finite");
                let label = (span.clone(), "this number".to_owned());
                return Err(SceneError::at(&self.source, message, None, [label]));
            }
            changes.push((span, path, value));
        }
        changes.sort_by_key(|(span, ..)| span.start);
        if let Some(twice) = changes.windows(2).find(|two| two[0].0 == two[1].0) {
            let message = format!("`{}` is given two values", twice[0].1);
            let label = (twice[0].0.clone(), "one number".to_owned());
            return Err(SceneError::at(&self.source, message, None, [label]));
        }
        let old = self.source.inner();
        let (mut text, mut from) = (String::with_capacity(old.len() + 24 * changes.len()), 0);
        for (span, _, value) in changes {
            // The spans come from this very text; still, no slicing that could fail.
            text += old.get(from..span.start).unwrap_or_default();
            let _ = write!(text, "{value:?}");
            from = span.end;
        }
        text += old.get(from..).unwrap_or_default();
        let source = Arc::new(NamedSource::new(self.source.name(), text));
        Self::build(self.name.clone(), &source)
    }

    /// Where the number at `path` is written: itself, or the point it belongs to.
    pub fn place_of(&self, path: &str) -> Place {
        match self.number_at(path).map(|n| (n.field, n.body)) {
            None => Place::Whole,
            Some((Field::Mass, body)) => Place::Mass(body),
            Some((Field::Inertia, body)) => Place::Inertia(body),
            Some((Field::Center(_), body)) => Place::Center(body),
            Some((Field::Point(k, _), body)) => Place::Point(body, k),
        }
    }

    fn number_at(&self, path: &str) -> Option<&Number> {
        // The body first: a large scene has many numbers, and few of them need their path spelt.
        let body = path.split('.').next()?;
        self.numbers
            .iter()
            .find(|n| self.mechanism.body_name(n.body) == body && self.path_of(n) == path)
    }

    /// The number at a path and where it is written; of a body that is called as a section is, before the section's.
    fn written_at(&self, path: &str) -> Result<(f64, &Span), SceneError> {
        if let Some(number) = self.number_at(path) {
            return Ok((number.value, &number.span));
        }
        let found = self.elsewhere.iter().find(|n| n.path == path);
        found.map(|n| (n.value, &n.span)).ok_or_else(|| {
            let mut all = self.numbers();
            all.extend(self.elsewhere.iter().map(|n| n.path.clone()));
            let (message, help) = no_number(path, &all);
            SceneError::bare(message, Some(help))
        })
    }

    fn path_of(&self, number: &Number) -> String {
        let body = number.body.0;
        let point = |k: usize| self.points[body][k].0.as_str();
        number.path(&self.mechanism.bodies[body].name, point)
    }
}

impl Number {
    fn path<'n>(&self, body: &str, point: impl Fn(usize) -> &'n str) -> String {
        match self.field {
            Field::Mass => format!("{body}.mass"),
            Field::Inertia => format!("{body}.inertia"),
            Field::Center(axis) => format!("{body}.center[{axis}]"),
            Field::Point(k, axis) => format!("{body}.points.{}[{axis}]", point(k)),
        }
    }
}

impl Bodies<'_> {
    /// Says so if there is no number at `path`, which the text names at `at`.
    pub(crate) fn check_number(&self, path: &str, at: &Span, problems: &mut Problems) {
        let path_of = |n: &Number| {
            let body = &self.list[n.body.0];
            n.path(body.name, |k| body.points[k].name)
        };
        let all: Vec<_> = self.numbers.iter().map(path_of).collect();
        if !all.iter().any(|p| p == path) {
            let (message, help) = no_number(path, &all);
            problems.push(
                Problem::new(message)
                    .at(at.clone(), "unknown number")
                    .help(help),
            );
        }
    }
}

/// Message and help for a path that leads nowhere: what there is of that body, or at all.
fn no_number(path: &str, all: &[String]) -> (String, String) {
    let first = |path: &str| path.split('.').next().map(str::to_owned);
    let body = first(path).unwrap_or_default();
    let own: Vec<_> = all
        .iter()
        .filter(|p| first(p).as_deref() == Some(&body))
        .map(String::as_str)
        .collect();
    let help = if own.is_empty() {
        choices(
            path,
            "numbers written in the scene",
            all.iter().map(String::as_str),
        )
    } else {
        choices(
            path,
            &format!("numbers written in `{body}`"),
            own.into_iter(),
        )
    };
    (format!("the scene has no number `{}`", shorten(path)), help)
}
