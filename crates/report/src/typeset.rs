//! Numbers in text, typeset as in papers.

use crate::number::{exponent, fixed, power_of_ten, trimmed};

/// Powers of ten that are written out: `0.00125`, and not `1.25 × 10⁻³`.
const WRITTEN_OUT: std::ops::RangeInclusive<i32> = -3..=4;
/// With more digits before the point, a text is a hash, not a number in e-notation.
const MAX_WHOLE_DIGITS: usize = 6;

/// The text with its numbers in e-notation set as in papers: `2.7770e-1` as `0.2777`, `1e-10` as `10⁻¹⁰` and `2.5e7` as
/// `2.5 × 10⁷`, with no-break spaces; below zero with the minus sign of the ticks.
pub(crate) fn typeset(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    let mut before: Option<char> = None;
    while let Some(c) = rest.chars().next() {
        let may_begin = before.is_none_or(|c| !c.is_alphanumeric() && !"._".contains(c));
        match may_begin.then(|| leading_number(rest)).flatten() {
            Some((length, number)) => {
                out.push_str(&number);
                before = rest[..length].chars().next_back();
                rest = &rest[length..];
            }
            None => {
                out.push(c);
                before = Some(c);
                rest = &rest[c.len_utf8()..];
            }
        }
    }
    out
}

/// The length of a number in e-notation that the text begins with, and the number as papers print it.
fn leading_number(text: &str) -> Option<(usize, String)> {
    let digits = |text: &str| text.chars().take_while(char::is_ascii_digit).count();
    let sign = usize::from(text.starts_with('-')) + 3 * usize::from(text.starts_with('−'));
    let whole = digits(&text[sign..]);
    if whole == 0 || whole > MAX_WHOLE_DIGITS {
        return None;
    }
    let mut at = sign + whole;
    if text[at..].starts_with('.') {
        let decimals = digits(&text[at + 1..]);
        at += if decimals > 0 { 1 + decimals } else { 0 };
    }
    let mantissa_end = at;
    at += usize::from(text[at..].starts_with('e'));
    if at == mantissa_end {
        let is_alone = !text[at..].starts_with(|c: char| c.is_alphanumeric() || c == '_');
        let signed = text.starts_with('-') && is_alone;
        return signed.then(|| (at, text[..at].replacen('-', "−", 1)));
    }
    let exponent_start = at;
    at += usize::from(text[at..].starts_with(['-', '+']))
        + 3 * usize::from(text[at..].starts_with('−'));
    let power = digits(&text[at..]);
    at += power;
    let goes_on = text[at..]
        .chars()
        .next()
        .is_some_and(|c| c.is_alphanumeric() || c == '_');
    if !(1..=3).contains(&power) || goes_on {
        return None;
    }
    let plain = |text: &str| text.replace('−', "-");
    let mantissa: f64 = plain(&text[..mantissa_end]).parse().ok()?;
    let power: i32 = plain(&text[exponent_start..at]).parse().ok()?;
    let decimals = text[sign + whole..mantissa_end].len().saturating_sub(1);
    if mantissa == 0.0 || WRITTEN_OUT.contains(&(power + exponent(mantissa))) {
        // By decimal text: a product would add digits.
        let value: f64 = plain(&text[..at]).parse().ok()?;
        let places = (decimals as i64 - i64::from(power)).clamp(0, 20) as usize;
        return Some((at, trimmed(&fixed(value, places)).to_owned()));
    }
    let mantissa = match trimmed(&fixed(mantissa, decimals)) {
        "1" => String::new(),
        "−1" => "−".to_owned(),
        mantissa => format!("{mantissa}\u{a0}×\u{a0}"),
    };
    Some((at, format!("{mantissa}{}", power_of_ten(power))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_set_as_in_papers() {
        for (text, expected) in [
            ("at 2.7770e-1 s", "at 0.2777 s"),
            ("tolerance 1e-10", "tolerance 10⁻¹⁰"),
            (
                "(4e-14, 2.50e7 and -1e-6)",
                "(4\u{a0}×\u{a0}10⁻¹⁴, 2.5\u{a0}×\u{a0}10⁷ and −10⁻⁶)",
            ),
            ("1.5e3 N, 0e0, 12e−9", "1500 N, 0, 12\u{a0}×\u{a0}10⁻⁹"),
            // No numbers: a hash, names, an end.
            (
                "sha256 9df18eefb0b8, 5e1234567890",
                "sha256 9df18eefb0b8, 5e1234567890",
            ),
            (
                "scene a1e5 link1e2x 3e 12345678e12",
                "scene a1e5 link1e2x 3e 12345678e12",
            ),
            ("1 − 2 mm, -3.0", "1 − 2 mm, −3.0"),
            ("(-0.2, 1-2) of link-3, -5x", "(−0.2, 1-2) of link-3, -5x"),
        ] {
            assert_eq!(typeset(text), expected);
        }
    }
}
