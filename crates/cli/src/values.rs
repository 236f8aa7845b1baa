//! The values of options: words, numbers and names, with the messages for invalid ones.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// The values of an option: name, value, help.
pub(crate) type Choices<T> = &'static [(&'static str, T, &'static str)];

/// Longest name of a scene, bytes: the name of a file has at most 255.
const MAX_NAME: usize = 100;

/// The parser of an option with these values.
pub(crate) fn choice<T: Copy + Send + Sync>(
    choices: Choices<T>,
) -> impl TypedValueParser<Value = T> {
    let value =
        |&(name, _, help): &(&'static str, T, &'static str)| PossibleValue::new(name).help(help);
    PossibleValuesParser::new(choices.iter().map(value)).try_map(move |given| {
        let found = choices.iter().find(|(known, ..)| *known == given);
        let value = found.map(|(_, value, _)| *value);
        value.ok_or_else(|| format!("unknown value `{given}`"))
    })
}

pub(crate) fn parse_number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "not a number".to_owned())
}

/// A number that satisfies a condition, or a message.
pub(crate) fn parse_checked(
    text: &str,
    is_valid: impl Fn(f64) -> bool,
    message: &str,
) -> Result<f64, String> {
    let value = Some(parse_number(text)?).filter(|value| is_valid(*value));
    value.ok_or_else(|| message.to_owned())
}

/// The name of a scene: part of the names of its files.
pub(crate) fn parse_name(text: &str) -> Result<String, String> {
    let is_plain = |c: char| c.is_alphanumeric() || "-_ ".contains(c);
    if !text.trim().is_empty() && text.len() <= MAX_NAME && text.chars().all(is_plain) {
        Ok(text.to_owned())
    } else {
        Err(format!(
            "a name has letters, digits, `-`, `_` and spaces, at most {MAX_NAME} bytes"
        ))
    }
}

pub(crate) fn parse_count(text: &str) -> Result<u64, String> {
    text.parse()
        .map_err(|_| "expected a whole number, 0 or more".to_owned())
}

pub(crate) fn parse_finite(text: &str) -> Result<f64, String> {
    parse_checked(text, f64::is_finite, "not a finite number")
}

/// A coefficient of fluctuation, at most 2: above that the machine would reverse.
pub(crate) fn parse_fluctuation(text: &str) -> Result<f64, String> {
    let message = "expected a number between 0 and 2";
    parse_checked(text, |v| v > 0.0 && v < 2.0, message)
}

/// A tolerance of an integrator: below 1e-14 it cannot be met in double precision, and above 1e-3 the energy of a
/// motion has an error of a quarter within two revolutions.
pub(crate) fn parse_tolerance(text: &str) -> Result<f64, String> {
    let message = "a tolerance must be between 1e-14 and 1e-3";
    parse_checked(text, |v| (1e-14..=1e-3).contains(&v), message)
}

/// An accuracy: a number, or the name of a preset.
pub(crate) fn parse_accuracy(text: &str) -> Result<f64, String> {
    let preset = dwell_study::PRESETS.iter().find(|(name, _)| *name == text);
    if let Some((_, value)) = preset {
        return Ok(*value);
    }
    parse_number(text).map_err(|_| {
        let names = dwell_study::PRESETS.map(|(name, _)| name).join(", ");
        format!("expected a number such as 1e-6, or one of {names}")
    })?;
    let message = "an accuracy must be between 1e-13 and 1e-2";
    parse_checked(text, |v| (1e-13..=1e-2).contains(&v), message)
}

/// The accuracy of a table, from 1e-14 (double precision) to 1e-2.
pub(crate) fn parse_table_accuracy(text: &str) -> Result<f64, String> {
    let message = "the accuracy of a table must be between 1e-14 and 1e-2";
    parse_checked(text, |v| (1e-14..=1e-2).contains(&v), message)
}

pub(crate) fn parse_length(text: &str) -> Result<f64, String> {
    let message = "expected a positive length in metres";
    parse_checked(text, |v| v.is_finite() && v > 0.0, message)
}

pub(crate) fn parse_time(text: &str) -> Result<f64, String> {
    let message = "expected a positive time in seconds";
    parse_checked(text, |v| v.is_finite() && v > 0.0, message)
}
