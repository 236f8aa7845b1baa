//! Typed reading of the TOML tree: each reader returns what it was asked for, or says what it
//! found instead.

use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::keys::TableSchema;
use crate::units::{Unit, Units};
use crate::wording::shorten;
use dwell_geometry::{Vec2, vec2};
use std::fmt::{Arguments, Display};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and where it stands.
pub(crate) type Value<'a> = Spanned<DeValue<'a>>;

/// Largest magnitude of a number in SI: a product of mass, length², speed² and more of such
/// numbers is still finite.
const MAX_NUMBER: f64 = 1e60;

/// Largest angle, rad: beyond it, less than ten digits of the position within a turn are left.
pub const MAX_ANGLE: f64 = 1e6;

/// How a point or a direction is written.
pub(crate) const POINT: &str = "two numbers [x, y]";

/// A key of a table with its value.
#[derive(Debug, Clone)]
pub(crate) struct Entry<'a> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    pub(crate) value: &'a Value<'a>,
}

/// A table in the order of the file.
#[derive(Debug)]
pub(crate) struct TableReader<'a> {
    /// How a message calls the table.
    pub(crate) what: String,
    /// Where it begins: its header, or the whole of an inline table.
    pub(crate) span: Span,
    pub(crate) entries: Vec<Entry<'a>>,
}

impl<'a> TableReader<'a> {
    pub(crate) fn new(what: impl Into<String>, span: Span, table: &'a DeTable<'a>) -> Self {
        let mut entries: Vec<_> = table
            .iter()
            .map(|(key, value)| Entry {
                name: key.get_ref(),
                key: key.span(),
                value,
            })
            .collect();
        entries.sort_by_key(|e| e.key.start);
        Self {
            what: what.into(),
            span,
            entries,
        }
    }

    /// The table that is the value of `entry`.
    pub(crate) fn open(
        entry: &Entry<'a>,
        what: impl Into<String>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Self> {
        let what = what.into();
        match entry.value.get_ref() {
            DeValue::Table(table) => Some(Self::new(what, entry.value.span(), table)),
            _ => {
                mismatch(entry.value, "a table", format_args!("{what}"), diagnostics);
                None
            }
        }
    }

    pub(crate) fn get(&self, name: &str) -> Option<&Entry<'a>> {
        self.entries.iter().find(|e| e.name == name)
    }

    /// Says which keys are none of the table's.
    pub(crate) fn reject_unknown_keys(&self, table: &TableSchema, diagnostics: &mut Diagnostics) {
        for entry in self.entries.iter().filter(|e| !table.contains_key(e.name)) {
            self.report_unknown_key(entry, "keys here", table.names(), diagnostics);
        }
    }

    /// Says that a key is none of those that can stand here.
    pub(crate) fn report_unknown_key<'n>(
        &self,
        entry: &Entry<'_>,
        kind: &str,
        names: impl Iterator<Item = &'n str> + Clone,
        diagnostics: &mut Diagnostics,
    ) {
        let help = diagnostics.choices(entry.name, kind, names);
        let name = shorten(entry.name);
        diagnostics.push(
            Diagnostic::new(format!("unknown key `{name}` in {}", self.what))
                .label(entry.key.clone(), "unknown key")
                .help(help),
        );
    }

    /// The one of several keys that exclude each other; nothing if none is there, and a problem if
    /// there are two.
    pub(crate) fn one_of(
        &self,
        among: impl Fn(&str) -> bool,
        diagnostics: &mut Diagnostics,
    ) -> Result<Option<&Entry<'a>>, ()> {
        let mut found = self.entries.iter().filter(|e| among(e.name));
        match (found.next(), found.next()) {
            (first, None) => Ok(first),
            (None, Some(_)) => Ok(None),
            (Some(a), Some(b)) => {
                diagnostics.push(
                    Diagnostic::new(format!(
                        "{} has both `{}` and `{}`",
                        self.what, a.name, b.name
                    ))
                    .label(a.key.clone(), "either this")
                    .label(b.key.clone(), "or this")
                    .help("keep one of them"),
                );
                Err(())
            }
        }
    }

    /// Whether it has a key that is none of the table's: what seems to be missing may be that one.
    pub(crate) fn has_unknown_keys(&self, table: &TableSchema) -> bool {
        self.entries.iter().any(|e| !table.contains_key(e.name))
    }

    /// The entry of that key, or a problem that says it is missing; `help` says how to write it.
    pub(crate) fn require(
        &self,
        key: &str,
        at: &Span,
        help: &str,
        diagnostics: &mut Diagnostics,
    ) -> Option<&Entry<'a>> {
        let found = self.get(key);
        if found.is_none() {
            diagnostics.push(
                Diagnostic::new(format!("{} has no `{key}`", self.what))
                    .label(at.clone(), format!("`{key}` is missing"))
                    .help(help),
            );
        }
        found
    }
}

pub(crate) fn mismatch(
    value: &Value<'_>,
    expected: &str,
    what: Arguments<'_>,
    diagnostics: &mut Diagnostics,
) {
    let found = match value.get_ref() {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
    };
    let mut diagnostic = Diagnostic::new(format!("{what}: expected {expected}, found {found}"))
        .label(value.span(), format!("expected {expected}"));
    if let (DeValue::String(text), "a number") = (value.get_ref(), expected) {
        diagnostic = diagnostic.help(if text.trim().parse::<f64>().is_ok() {
            "write it without the quotes"
        } else {
            "a number stands without quotes; its unit is said once, in [units]"
        });
    }
    if let (DeValue::Array(_), "a table") = (value.get_ref(), expected) {
        diagnostic =
            diagnostic.help("every entry is a table under its own name, as in `[bodies.crank]`");
    }
    diagnostics.push(diagnostic);
}

/// A finite number, in the unit of the scene.
pub(crate) fn number(
    value: &Value<'_>,
    what: Arguments<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let parsed = match value.get_ref() {
        // Decimal digits go to the float parser whatever their count, so that they round once.
        DeValue::Integer(i) if i.radix() == 10 => i.as_str().parse().ok(),
        DeValue::Integer(i) => u64::from_str_radix(i.as_str(), i.radix())
            .ok()
            .map(|n| n as f64),
        DeValue::Float(x) => x.as_str().parse().ok(),
        _ => {
            mismatch(value, "a number", what, diagnostics);
            return None;
        }
    };
    let written_infinite = matches!(value.get_ref(), DeValue::Float(x) if x.as_str().contains('n'));
    match parsed {
        Some(x) if f64::is_finite(x) => Some(x),
        _ if written_infinite => {
            diagnostics.push(
                Diagnostic::new(format!("{what} is not finite"))
                    .label(value.span(), "expected a finite number"),
            );
            None
        }
        _ => {
            too_large(value, what, diagnostics);
            None
        }
    }
}

fn too_large(value: &Value<'_>, what: impl Display, diagnostics: &mut Diagnostics) {
    diagnostics.push(
        Diagnostic::new(format!("{what} is too large to compute with"))
            .label(value.span(), "too large")
            .help(format!("the largest number, in SI, is {MAX_NUMBER:e}")),
    );
}

/// A number as (as written, in SI).
pub(crate) fn quantity(
    value: &Value<'_>,
    unit: &Unit,
    what: Arguments<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<(f64, f64)> {
    let written = number(value, what, diagnostics)?;
    let si = unit.to_si(written);
    if si.abs() <= MAX_NUMBER {
        return Some((written, si));
    }
    too_large(value, what, diagnostics);
    None
}

/// An angle in rad.
pub(crate) fn angle(
    value: &Value<'_>,
    unit: &Unit,
    what: Arguments<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let (_, si) = quantity(value, unit, what, diagnostics)?;
    if si.abs() <= MAX_ANGLE {
        return Some(si);
    }
    diagnostics.push(
        Diagnostic::new(format!("{what} is more than {MAX_ANGLE:e} rad"))
            .label(value.span(), "too many revolutions")
            .help("subtract whole revolutions: so large an angle has lost its last digits"),
    );
    None
}

/// A coordinate or its speed, in SI: an angle is not too many turns.
pub(crate) fn coordinate(
    value: &Value<'_>,
    is_angle: bool,
    units: &Units,
    what: Arguments<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    if is_angle {
        return angle(value, &units.angle, what, diagnostics);
    }
    quantity(value, &units.length, what, diagnostics).map(|(_, si)| si)
}

/// What a number has to be, besides finite.
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

/// A number in SI, of the sign it has to have; `why` tells one who gave another.
pub(crate) fn quantity_with_sign(
    value: &Value<'_>,
    unit: &Unit,
    sign: SignRule,
    what: Arguments<'_>,
    why: &str,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let (_, si) = quantity(value, unit, what, diagnostics)?;
    let (good, wrong, expected) = match sign {
        SignRule::Any => return Some(si),
        SignRule::NotNegative => (si >= 0.0, "is negative", "expected 0 or more"),
        SignRule::Positive => (si > 0.0, "is not above zero", "expected a number above 0"),
        SignRule::NotZero => (si != 0.0, "is zero", "expected a number other than 0"),
    };
    if good {
        return Some(si);
    }
    let diagnostic = Diagnostic::new(format!("{what} {wrong}")).label(value.span(), expected);
    diagnostics.push(match why {
        "" => diagnostic,
        why => diagnostic.help(why),
    });
    None
}

/// A count of at least two and at most a million.
pub(crate) fn count(
    value: &Value<'_>,
    what: Arguments<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    const MAX_COUNT: f64 = 1e6;
    let x = number(value, what, diagnostics)?;
    if x.fract() == 0.0 && (2.0..=MAX_COUNT).contains(&x) {
        return Some(x as usize);
    }
    diagnostics.push(
        Diagnostic::new(format!(
            "{what} is not a whole number from 2 to {MAX_COUNT:e}"
        ))
        .label(value.span(), "expected a whole number"),
    );
    None
}

/// The rows [x, y] of a table, as written: two or more, each x above the one before.
pub(crate) fn rows(
    value: &Value<'_>,
    units: [&Unit; 2],
    what: &str,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<[f64; 2]>> {
    let values = array(
        value,
        "rows [[x, y], [x, y], ...]",
        format_args!("{what}"),
        diagnostics,
    )?;
    let before = diagnostics.count();
    let mut rows: Vec<[f64; 2]> = Vec::with_capacity(values.len());
    for (k, row) in values.iter().enumerate() {
        let name = format!("row {} of {what}", k + 1);
        let Some([x, y]) = pair(
            row,
            "two numbers [x, y]",
            format_args!("{name}"),
            diagnostics,
        ) else {
            continue;
        };
        let x = quantity(x, units[0], format_args!("x in {name}"), diagnostics);
        let y = quantity(y, units[1], format_args!("y in {name}"), diagnostics);
        let (Some((_, x)), Some((_, y))) = (x, y) else {
            continue;
        };
        if rows.last().is_some_and(|last| x <= last[0]) {
            diagnostics.push(
                Diagnostic::new(format!("x in {name} is not above that of the row before"))
                    .label(row.span(), "out of order")
                    .help("sort the rows of a table by x, each x once"),
            );
        }
        rows.push([x, y]);
    }
    if diagnostics.count() != before {
        return None;
    }
    if rows.len() < 2 {
        diagnostics.push(
            Diagnostic::new(format!("{what} has fewer than two rows"))
                .label(value.span(), "no curve")
                .help("give at least two rows [x, y]"),
        );
        return None;
    }
    Some(rows)
}

/// A direction: only the ratio of its components counts, so it has no unit.
pub(crate) fn unit_vector(
    value: &Value<'_>,
    what: &str,
    diagnostics: &mut Diagnostics,
) -> Option<Vec2> {
    let [x, y] = pair(value, POINT, format_args!("{what}"), diagnostics)?;
    let x = number(x, format_args!("x of {what}"), diagnostics);
    let y = number(y, format_args!("y of {what}"), diagnostics);
    let (x, y) = (x?, y?);
    let largest = x.abs().max(y.abs());
    if largest == 0.0 {
        diagnostics.push(
            Diagnostic::new(format!("{what} has no length"))
                .label(value.span(), "no direction")
                .help("give a direction, such as [1, 0]"),
        );
        return None;
    }
    // Scaled first: the largest and the smallest numbers would lose their direction in a square.
    let (x, y) = (x / largest, y / largest);
    let length = x.hypot(y);
    Some(vec2(x / length, y / length))
}

/// A string.
pub(crate) fn string<'a>(
    value: &'a Value<'a>,
    what: Arguments<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<&'a str> {
    if let DeValue::String(text) = value.get_ref() {
        return Some(text);
    }
    mismatch(value, "a string", what, diagnostics);
    None
}

/// `true` or `false`.
pub(crate) fn boolean(
    value: &Value<'_>,
    what: Arguments<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<bool> {
    if let DeValue::Boolean(b) = value.get_ref() {
        return Some(*b);
    }
    mismatch(value, "true or false", what, diagnostics);
    None
}

/// The values of an array of any length.
pub(crate) fn array<'a>(
    value: &'a Value<'a>,
    expected: &str,
    what: Arguments<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<&'a [Value<'a>]> {
    if let DeValue::Array(values) = value.get_ref() {
        return Some(values);
    }
    mismatch(value, expected, what, diagnostics);
    None
}

/// The two values of an array; `expected` says two of what, and how it is written.
pub(crate) fn pair<'a>(
    value: &'a Value<'a>,
    expected: &str,
    what: Arguments<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<[&'a Value<'a>; 2]> {
    let values = array(value, expected, what, diagnostics)?;
    if let [first, second] = values {
        return Some([first, second]);
    }
    let found = match values.len() {
        0 => "an empty array".to_owned(),
        1 => "only one value".to_owned(),
        n => format!("{n} values"),
    };
    diagnostics.push(
        Diagnostic::new(format!("{what}: expected {expected}, found {found}"))
            .label(value.span(), format!("expected {expected}")),
    );
    None
}

/// Two strings.
pub(crate) fn two_strings<'a>(
    value: &'a Value<'a>,
    expected: &str,
    what: Arguments<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<[(&'a str, Span); 2]> {
    let [first, second] = pair(value, expected, what, diagnostics)?;
    // Both are looked at before either fails, so that both are reported.
    let a = string(first, what, diagnostics);
    let b = string(second, what, diagnostics);
    Some([(a?, first.span()), (b?, second.span())])
}
