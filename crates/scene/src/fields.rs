//! Typed reading of the TOML tree: each reader returns what it was asked for, or says what it
//! found instead.

use crate::names::shorten;
use crate::problem::{Problem, Problems, Span};
use crate::units::Unit;
use std::fmt::{Arguments, Display};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and where it stands.
pub(crate) type Value<'a> = Spanned<DeValue<'a>>;

/// Largest magnitude of a number in SI: a product of mass, length², speed² and more of such
/// numbers is still finite.
const LARGEST: f64 = 1e60;

/// Largest angle, rad: beyond it, less than ten digits of the position within a turn are left.
const LARGEST_ANGLE: f64 = 1e6;

/// A key of a table with its value.
#[derive(Debug, Clone)]
pub(crate) struct Entry<'a> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    pub(crate) value: &'a Value<'a>,
}

/// A table in the order of the file.
#[derive(Debug)]
pub(crate) struct Fields<'a> {
    /// How a message calls the table.
    pub(crate) what: String,
    /// Where it begins: its header, or the whole of an inline table.
    pub(crate) span: Span,
    pub(crate) entries: Vec<Entry<'a>>,
}

impl<'a> Fields<'a> {
    pub(crate) fn of(what: impl Into<String>, span: Span, table: &'a DeTable<'a>) -> Self {
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
        problems: &mut Problems,
    ) -> Option<Self> {
        let what = what.into();
        match entry.value.get_ref() {
            DeValue::Table(table) => Some(Self::of(what, entry.value.span(), table)),
            _ => {
                mismatch(entry.value, "a table", format_args!("{what}"), problems);
                None
            }
        }
    }

    pub(crate) fn get(&self, name: &str) -> Option<&Entry<'a>> {
        self.entries.iter().find(|e| e.name == name)
    }

    /// Says which keys are none of `known`.
    pub(crate) fn allow(&self, known: &[&str], problems: &mut Problems) {
        for entry in self.entries.iter().filter(|e| !known.contains(&e.name)) {
            let help = problems.choices(entry.name, "keys here", known.iter().copied());
            let name = shorten(entry.name);
            problems.push(
                Problem::new(format!("unknown key `{name}` in {}", self.what))
                    .at(entry.key.clone(), "unknown key")
                    .help(help),
            );
        }
    }
}

fn mismatch(value: &Value<'_>, expected: &str, what: Arguments<'_>, problems: &mut Problems) {
    let found = match value.get_ref() {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
    };
    let mut problem = Problem::new(format!("{what}: expected {expected}, found {found}"))
        .at(value.span(), format!("expected {expected}"));
    if let (DeValue::String(text), "a number") = (value.get_ref(), expected) {
        problem = problem.help(if text.trim().parse::<f64>().is_ok() {
            "write it without the quotes"
        } else {
            "a number stands without quotes; its unit is said once, in [units]"
        });
    }
    if let (DeValue::Array(_), "a table") = (value.get_ref(), expected) {
        problem = problem.help("every entry is a table under its own name, as in `[bodies.crank]`");
    }
    problems.push(problem);
}

/// A finite number, in the unit of the scene.
pub(crate) fn number(
    value: &Value<'_>,
    what: Arguments<'_>,
    problems: &mut Problems,
) -> Option<f64> {
    let parsed = match value.get_ref() {
        // Decimal digits go to the float parser whatever their count, so that they round once.
        DeValue::Integer(i) if i.radix() == 10 => i.as_str().parse().ok(),
        DeValue::Integer(i) => u64::from_str_radix(i.as_str(), i.radix())
            .ok()
            .map(|n| n as f64),
        DeValue::Float(x) => x.as_str().parse().ok(),
        _ => {
            mismatch(value, "a number", what, problems);
            return None;
        }
    };
    let written_infinite = matches!(value.get_ref(), DeValue::Float(x) if x.as_str().contains('n'));
    match parsed {
        Some(x) if f64::is_finite(x) => Some(x),
        _ if written_infinite => {
            problems.push(
                Problem::new(format!("{what} is not finite"))
                    .at(value.span(), "expected a finite number"),
            );
            None
        }
        _ => {
            too_large(value, what, problems);
            None
        }
    }
}

fn too_large(value: &Value<'_>, what: impl Display, problems: &mut Problems) {
    problems.push(
        Problem::new(format!("{what} is too large to compute with"))
            .at(value.span(), "too large")
            .help(format!("the largest number, in SI, is {LARGEST:e}")),
    );
}

/// A number as (as written, in SI).
pub(crate) fn quantity(
    value: &Value<'_>,
    unit: &Unit,
    what: Arguments<'_>,
    problems: &mut Problems,
) -> Option<(f64, f64)> {
    let written = number(value, what, problems)?;
    let si = unit.si(written);
    if si.abs() <= LARGEST {
        return Some((written, si));
    }
    too_large(value, what, problems);
    None
}

/// An angle in rad.
pub(crate) fn angle(
    value: &Value<'_>,
    unit: &Unit,
    what: Arguments<'_>,
    problems: &mut Problems,
) -> Option<f64> {
    let (_, si) = quantity(value, unit, what, problems)?;
    if si.abs() <= LARGEST_ANGLE {
        return Some(si);
    }
    problems.push(
        Problem::new(format!("{what} is more than {LARGEST_ANGLE:e} rad"))
            .at(value.span(), "too many turns")
            .help("take whole turns off it: so large an angle has lost its last digits"),
    );
    None
}

/// A string.
pub(crate) fn string<'a>(
    value: &'a Value<'a>,
    what: Arguments<'_>,
    problems: &mut Problems,
) -> Option<&'a str> {
    if let DeValue::String(text) = value.get_ref() {
        return Some(text);
    }
    mismatch(value, "a string", what, problems);
    None
}

/// `true` or `false`.
pub(crate) fn boolean(
    value: &Value<'_>,
    what: Arguments<'_>,
    problems: &mut Problems,
) -> Option<bool> {
    if let DeValue::Boolean(b) = value.get_ref() {
        return Some(*b);
    }
    mismatch(value, "true or false", what, problems);
    None
}

/// The values of an array of any length.
pub(crate) fn array<'a>(
    value: &'a Value<'a>,
    expected: &str,
    what: Arguments<'_>,
    problems: &mut Problems,
) -> Option<&'a [Value<'a>]> {
    if let DeValue::Array(values) = value.get_ref() {
        return Some(values);
    }
    mismatch(value, expected, what, problems);
    None
}

/// The two values of an array; `expected` says two of what, and how it is written.
pub(crate) fn pair<'a>(
    value: &'a Value<'a>,
    expected: &str,
    what: Arguments<'_>,
    problems: &mut Problems,
) -> Option<[&'a Value<'a>; 2]> {
    let values = array(value, expected, what, problems)?;
    if let [first, second] = values {
        return Some([first, second]);
    }
    let found = match values.len() {
        0 => "an empty array".to_owned(),
        1 => "only one value".to_owned(),
        n => format!("{n} values"),
    };
    problems.push(
        Problem::new(format!("{what}: expected {expected}, found {found}"))
            .at(value.span(), format!("expected {expected}")),
    );
    None
}

/// Two strings.
pub(crate) fn two_strings<'a>(
    value: &'a Value<'a>,
    expected: &str,
    what: Arguments<'_>,
    problems: &mut Problems,
) -> Option<[(&'a str, Span); 2]> {
    let [first, second] = pair(value, expected, what, problems)?;
    // Both are looked at before either fails, so that both are reported.
    let a = string(first, what, problems);
    let b = string(second, what, problems);
    Some([(a?, first.span()), (b?, second.span())])
}
