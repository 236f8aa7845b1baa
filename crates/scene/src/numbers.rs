//! The numbers of a scene by their path, such as `crank.inertia`: asking for one, and the same
//! scene with one of them changed.

use crate::build::Sections;
use crate::diagnostics::Span;
use crate::error::{SceneError, Source};
use crate::file::SceneFile;
use crate::load_functions::keep_functions;
use crate::number_paths::{SceneNumber, no_number};
use crate::scene_data::SceneIn;
use crate::spans::SceneLocation;
use crate::swept::{PARAMETERS, TiedNumber, variables};
use dwell_laws::Expression;
use miette::NamedSource;
use std::fmt::Write as _;
use std::sync::Arc;

impl SceneFile {
    /// The path of every number that [`value`](Self::value) and [`with_value`](crate::PlaneScene::with_value) accept,
    /// in the order of the file: `crank.mass`, `crank.inertia`, `crank.center[0]` (when it is written as [x, y]),
    /// `crank.points.B[1]`. Only numbers in the file have a path. The ground has only its points, because its mass has
    /// no effect.
    pub fn number_paths(&self) -> Vec<String> {
        self.body_numbers.iter().map(|n| n.path.clone()).collect()
    }

    /// The path of every number of the bodies and of the sections of joints, loads, frictions, drives and motions.
    pub fn all_number_paths(&self) -> Vec<String> {
        let all = self.body_numbers.iter().chain(&self.section_numbers);
        all.map(|number| number.path.clone()).collect()
    }

    /// The number at `path`, in the scene's own unit. In addition to [`number_paths`](Self::number_paths), these are all numbers in
    /// the sections of joints, loads, frictions, drives and motions, by their keys: `loads.brake.damping`,
    /// `motion.initial-velocity.phi`, `joints.guide.axis[0]`.
    ///
    /// # Errors
    /// [`SceneError`] when the path does not exist.
    pub fn value(&self, path: &str) -> Result<f64, SceneError> {
        self.find_number(path).map(|n| n.value)
    }

    /// The unit of the number at `path`, such as `mm` or `kg m2`; empty if there is no such number, it has no unit, or its unit depends on
    /// other numbers.
    pub fn unit_of(&self, path: &str) -> String {
        let units = &self.units;
        let unit = match self.location_of(path) {
            SceneLocation::Mass(_) => "mass",
            SceneLocation::Inertia(_) => "inertia",
            SceneLocation::Center(_) | SceneLocation::Point(..) => "length",
            _ => self.find_number(path).map_or("", |number| number.unit),
        };
        if unit.contains(" or ") || unit.contains(',') || unit == "SI" {
            return String::new();
        }
        let named = [
            ("length", &units.length),
            ("angle", &units.angle),
            ("mass", &units.mass),
            ("inertia", &units.inertia),
        ];
        let named = named.into_iter();
        named.fold(unit.to_owned(), |text, (word, unit)| {
            text.replace(word, &unit.name)
        })
    }

    /// The text with the numbers at some paths replaced by values in the scene's own unit; all else stays, comments too.
    ///
    /// # Errors
    /// [`SceneError`] when a path does not exist or is named twice, or a value is not finite.
    pub fn text_with(&self, values: &[(&str, f64)]) -> Result<String, SceneError> {
        Ok(self.source_with(values)?.inner().clone())
    }

    fn source_with(&self, values: &[(&str, f64)]) -> Result<Source, SceneError> {
        let mut changes = Vec::with_capacity(values.len());
        for &(path, value) in values {
            let span = self.find_number(path)?.span.clone();
            if !value.is_finite() {
                let message = format!("{value} is not a value for `{path}`: it is not finite");
                return Err(self.error_at(message, span, "this number"));
            }
            changes.push((span, path, value));
        }
        changes.sort_by_key(|(span, ..)| span.start);
        if let Some(duplicate) = changes.windows(2).find(|two| two[0].0 == two[1].0) {
            let message = format!("`{}` is given two values", duplicate[0].1);
            return Err(self.error_at(message, duplicate[0].0.clone(), "one number"));
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
        Ok(Arc::new(NamedSource::new(self.source.name(), text)))
    }

    fn error_at(&self, message: String, span: Span, label: &str) -> SceneError {
        SceneError::with_labels(&self.source, message, None, [(span, label.to_owned())])
    }

    /// The place of the number at `path`: the number itself, or its point.
    pub fn location_of(&self, path: &str) -> SceneLocation {
        let mut numbers = self.body_numbers.iter();
        let found = numbers.find(|n| n.path == path);
        found.map_or(SceneLocation::Whole, |n| n.location)
    }

    /// The number at a path, or the parameter of that name; of a body that is called as a section is, before the section's.
    fn find_number(&self, path: &str) -> Result<&SceneNumber, SceneError> {
        let mut all = self.body_numbers.iter().chain(&self.section_numbers);
        let is_parameter = |n: &&SceneNumber| n.path.strip_prefix(PARAMETERS) == Some(path);
        let found = all.find(|n| n.path == path);
        let found = found.or_else(|| self.section_numbers.iter().find(is_parameter));
        found.ok_or_else(|| {
            let all = self.body_numbers.iter().chain(&self.section_numbers);
            let (message, help) = no_number(path, all);
            SceneError::without_labels(message, Some(help))
        })
    }
}

impl SceneFile {
    /// The number at a path, tied to others by an expression.
    ///
    /// # Errors
    /// Message and help if there is no such number, or the expression is none.
    pub fn tied_number(&self, path: &str, text: &str) -> Result<TiedNumber, (String, String)> {
        let numbers = self.body_numbers.iter().chain(&self.section_numbers);
        if !numbers.clone().any(|number| number.path == path) {
            return Err(no_number(path, numbers));
        }
        let variables = variables(numbers);
        let expression = Expression::parse(text, &variables);
        let expression = expression.map_err(|e| (e.message, e.help.unwrap_or_default()))?;
        Ok(TiedNumber {
            path: path.to_owned(),
            text: text.to_owned(),
            expression: expression.retain_used(),
        })
    }
}

#[expect(private_bounds, reason = "there are two kinds of scene")]
impl<D: Sections> SceneIn<D> {
    /// This scene with the number at `path` replaced by `value`, in the scene's unit.
    ///
    /// The number is replaced in the text, and the text is read again. Derived values follow, and messages show the new
    /// number.
    ///
    /// # Errors
    /// As [`with_values`](Self::with_values).
    pub fn with_value(&self, path: &str, value: f64) -> Result<Self, SceneError> {
        self.with_values(&[(path, value)])
    }

    /// This scene with several numbers replaced at once; the text is read again only once.
    ///
    /// # Errors
    /// [`SceneError`] when a path does not exist or is named twice, a value is not finite, or the scene is invalid with
    /// these numbers.
    pub fn with_values(&self, values: &[(&str, f64)]) -> Result<Self, SceneError> {
        let mut scene = Self::build(self.name.clone(), &self.source_with(values)?)?;
        keep_functions(&mut scene.loads, &self.loads);
        Ok(scene)
    }
}
