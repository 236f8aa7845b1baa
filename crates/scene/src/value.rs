//! Typed reading of one value: each reader returns the requested type, or reports what it found instead. `what` names
//! the value in messages.

use crate::diagnostics::{Diagnostics, Span};
use crate::units::{Unit, Units};
use dwell_geometry::{Vec2, vec2};
use std::fmt::Display;
use toml::Spanned;
use toml::de::DeValue;

/// Largest magnitude of a number in SI: a product of mass, length², speed² and more of such
/// numbers is still finite.
const MAX_NUMBER: f64 = 1e60;

/// Largest angle, rad: beyond it, less than ten digits of the position within a revolution are left.
pub const MAX_ANGLE: f64 = 1e6;

/// How a point or a direction is written.
pub(crate) const POINT: &str = "two numbers [x, y]";

/// The common data of all readers of a scene: its units, and the list of its errors.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context<'a> {
    pub(crate) units: &'a Units,
    pub(crate) log: &'a Diagnostics,
}

/// A value of the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Value<'a> {
    pub(crate) tree: &'a Spanned<DeValue<'a>>,
    pub(crate) context: Context<'a>,
}

/// The sign rule of a number, which must also be finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SignRule {
    Any,
    /// Zero or more.
    NotNegative,
    /// More than zero.
    Positive,
    /// Not zero.
    NotZero,
}

/// Unit and sign of a number; `why` is the reason for the sign, shown where it is violated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NumberRule<'u> {
    pub(crate) unit: &'u Unit,
    pub(crate) sign: SignRule,
    pub(crate) why: &'u str,
}

impl<'u> NumberRule<'u> {
    pub(crate) fn new(unit: &'u Unit, sign: SignRule) -> Self {
        let why = "";
        Self { unit, sign, why }
    }

    pub(crate) fn because(self, why: &'u str) -> Self {
        Self { why, ..self }
    }
}

/// The number that a value is, if it is one of double precision.
pub(crate) fn written_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        // Decimal digits go to the float parser whatever their count, so that they round once.
        DeValue::Integer(i) if i.radix() == 10 => i.as_str().parse().ok(),
        DeValue::Integer(i) => u64::from_str_radix(i.as_str(), i.radix())
            .ok()
            .map(|n| n as f64),
        DeValue::Float(x) => x.as_str().parse().ok(),
        _ => None,
    }
}

impl<'a> Value<'a> {
    pub(crate) fn get(self) -> &'a DeValue<'a> {
        self.tree.get_ref()
    }

    pub(crate) fn span(self) -> Span {
        self.tree.span()
    }

    pub(crate) fn log(self) -> &'a Diagnostics {
        self.context.log
    }

    pub(crate) fn units(self) -> &'a Units {
        self.context.units
    }

    pub(crate) fn is_number(self) -> bool {
        matches!(self.get(), DeValue::Integer(_) | DeValue::Float(_))
    }

    /// Reports that this value is wrong.
    pub(crate) fn reject<T>(
        self,
        message: impl Into<String>,
        label: &str,
        help: impl Into<String>,
    ) -> Option<T> {
        self.log().reject(message, &[(&self.span(), label)], help)
    }

    /// Reports that it differs from the expected type.
    pub(crate) fn mismatch<T>(self, expected: &str, what: impl Display) -> Option<T> {
        let found = match self.get() {
            DeValue::String(_) => "a string",
            DeValue::Integer(_) | DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date or time",
            DeValue::Array(_) => "an array",
            DeValue::Table(_) => "a table",
        };
        let help = match (self.get(), expected) {
            (DeValue::String(text), "a number") if text.trim().parse::<f64>().is_ok() => {
                "write it without the quotes"
            }
            (DeValue::String(_), "a number") => {
                "a number stands without quotes; its unit is given once, in [units]"
            }
            (DeValue::Array(_), "a table") => {
                "every entry is a table under its own name, as in `[bodies.crank]`"
            }
            _ => "",
        };
        self.unexpected(expected, found, what, help)
    }

    fn unexpected<T>(
        self,
        expected: &str,
        found: &str,
        what: impl Display,
        help: &str,
    ) -> Option<T> {
        let message = format!("{what}: expected {expected}, found {found}");
        self.reject(message, &format!("expected {expected}"), help)
    }

    /// A finite number, in the unit of the scene.
    pub(crate) fn number(self, what: impl Display) -> Option<f64> {
        if !self.is_number() {
            return self.mismatch("a number", what);
        }
        match (written_number(self.get()), self.get()) {
            (Some(x), _) if x.is_finite() => Some(x),
            (_, DeValue::Float(x)) if x.as_str().contains('n') => {
                let message = format!("{what} is not finite");
                self.reject(message, "expected a finite number", "")
            }
            _ => self.too_large(what),
        }
    }

    fn too_large<T>(self, what: impl Display) -> Option<T> {
        let message = format!("{what} is too large to compute with");
        let help = format!("the largest number, in SI, is {MAX_NUMBER:e}");
        self.reject(message, "too large", help)
    }

    /// A number in SI.
    pub(crate) fn quantity(self, unit: &Unit, what: impl Display) -> Option<f64> {
        let si = unit.to_si(self.number(&what)?);
        if si.abs() <= MAX_NUMBER {
            return Some(si);
        }
        self.too_large(what)
    }

    /// A point, m.
    pub(crate) fn point(self, what: &str) -> Option<Vec2> {
        let unit = &self.units().length;
        let coordinate = |value: Self, what: String| value.quantity(unit, what);
        let [x, y] = self.pair_of(POINT, what, ["x", "y"], coordinate)?;
        Some(vec2(x, y))
    }

    /// An angle in rad.
    pub(crate) fn angle(self, what: impl Display) -> Option<f64> {
        let si = self.quantity(&self.units().angle, &what)?;
        if si.abs() <= MAX_ANGLE {
            return Some(si);
        }
        let help = "subtract whole revolutions: so large an angle has lost its last digits";
        let message = format!("{what} is more than {MAX_ANGLE:e} rad");
        self.reject(message, "too many revolutions", help)
    }

    /// A coordinate or its speed, in SI: an angle does not have too many revolutions.
    pub(crate) fn coordinate(self, is_angle: bool, what: impl Display) -> Option<f64> {
        if is_angle {
            self.angle(what)
        } else {
            self.quantity(&self.units().length, what)
        }
    }

    /// A number in SI, of the sign it has to have.
    pub(crate) fn quantity_with_sign(
        self,
        rule: &NumberRule<'_>,
        what: impl Display,
    ) -> Option<f64> {
        let si = self.quantity(rule.unit, &what)?;
        let (good, wrong, expected) = match rule.sign {
            SignRule::Any => return Some(si),
            SignRule::NotNegative => (si >= 0.0, "is negative", "expected 0 or more"),
            SignRule::Positive => (
                si > 0.0,
                "must be greater than zero",
                "expected a number greater than 0",
            ),
            SignRule::NotZero => (si != 0.0, "is zero", "expected a number other than 0"),
        };
        if good {
            return Some(si);
        }
        self.reject(format!("{what} {wrong}"), expected, rule.why)
    }

    /// A count of at least two and at most a million.
    pub(crate) fn count(self, what: impl Display) -> Option<usize> {
        const MAX_COUNT: f64 = 1e6;
        let x = self.number(&what)?;
        if x.fract() == 0.0 && (2.0..=MAX_COUNT).contains(&x) {
            return Some(x as usize);
        }
        let message = format!("{what} is not a whole number from 2 to {MAX_COUNT:e}");
        self.reject(message, "expected a whole number", "")
    }

    /// The rows [x, y] of a table in SI: two or more, each x above the one before.
    pub(crate) fn rows(self, units: [&Unit; 2], what: &str) -> Option<Vec<[f64; 2]>> {
        let values = self.array("rows [[x, y], [x, y], ...]", what)?;
        let before = self.log().count();
        let mut rows: Vec<[f64; 2]> = Vec::with_capacity(values.len());
        for (k, row) in values.iter().enumerate() {
            let name = format!("row {} of {what}", k + 1);
            let Some([x, y]) = row.pair(POINT, &name) else {
                continue;
            };
            let x = x.quantity(units[0], format_args!("x in {name}"));
            let y = y.quantity(units[1], format_args!("y in {name}"));
            let (Some(x), Some(y)) = (x, y) else {
                continue;
            };
            if rows.last().is_some_and(|last| x <= last[0]) {
                let message = format!("x in {name} is not above that of the row before");
                let help = "sort the rows of a table by x, each x once";
                row.reject::<()>(message, "out of order", help);
            }
            rows.push([x, y]);
        }
        if self.log().count() != before {
            return None;
        }
        if rows.len() < 2 {
            let message = format!("{what} has fewer than two rows");
            return self.reject(message, "no curve", "give at least two rows [x, y]");
        }
        Some(rows)
    }

    /// A direction: only the ratio of its components counts, so it has no unit.
    pub(crate) fn unit_vector(self, what: impl Display) -> Option<Vec2> {
        let component = |value: Self, what: String| value.number(what);
        let [x, y] = self.pair_of(POINT, &what, ["x", "y"], component)?;
        let largest = x.abs().max(y.abs());
        if largest == 0.0 {
            let message = format!("{what} has no length");
            return self.reject(message, "no direction", "give a direction, such as [1, 0]");
        }
        // Scaled first: the largest and the smallest numbers would lose their direction in a square.
        let (x, y) = (x / largest, y / largest);
        let length = x.hypot(y);
        Some(vec2(x / length, y / length))
    }

    /// A string.
    pub(crate) fn string(self, what: impl Display) -> Option<&'a str> {
        match self.get() {
            DeValue::String(text) => Some(text),
            _ => self.mismatch("a string", what),
        }
    }

    /// `true` or `false`.
    pub(crate) fn boolean(self, what: impl Display) -> Option<bool> {
        match self.get() {
            DeValue::Boolean(b) => Some(*b),
            _ => self.mismatch("true or false", what),
        }
    }

    /// The values of an array of any length.
    pub(crate) fn array(self, expected: &str, what: impl Display) -> Option<Vec<Value<'a>>> {
        let context = self.context;
        match self.get() {
            DeValue::Array(all) => Some(all.iter().map(|tree| Self { tree, context }).collect()),
            _ => self.mismatch(expected, what),
        }
    }

    /// The two values of an array; `expected` describes them and their notation.
    pub(crate) fn pair(self, expected: &str, what: impl Display) -> Option<[Value<'a>; 2]> {
        let values = self.array(expected, &what)?;
        let found = match values.len() {
            0 => "an empty array".to_owned(),
            1 => "only one value".to_owned(),
            2 => return Some([values[0], values[1]]),
            n => format!("{n} values"),
        };
        self.unexpected(expected, &found, what, "")
    }

    /// The two values of an array, read by `one`, which gets a name of each for messages. Both are read before either fails, so
    /// that both are reported.
    pub(crate) fn pair_of<T>(
        self,
        expected: &str,
        what: impl Display,
        names: [&str; 2],
        one: impl Fn(Self, String) -> Option<T>,
    ) -> Option<[T; 2]> {
        let [a, b] = self.pair(expected, &what)?;
        let [first, second] = names.map(|name| format!("{name} of {what}"));
        let (a, b) = (one(a, first), one(b, second));
        Some([a?, b?])
    }

    /// Two strings.
    pub(crate) fn two_strings(
        self,
        expected: &str,
        what: impl Display,
    ) -> Option<[(&'a str, Span); 2]> {
        let [first, second] = self.pair(expected, &what)?;
        // Both are read before either fails, so that both are reported.
        let (a, b) = (first.string(&what), second.string(&what));
        Some([(a?, first.span()), (b?, second.span())])
    }
}
