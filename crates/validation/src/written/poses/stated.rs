//! Numbers of a summary and of printed lines, against those that they should be.

use super::difference::Differences;
use super::formats::last_digit;
use serde_json::Value;

/// A value that should stand somewhere, and its scale.
pub(crate) type Expected = (f64, f64);

/// A number of the results of a summary.
pub(crate) fn result(summary: &Value, name: &str) -> Option<f64> {
    summary["results"][name]["value"].as_f64()
}

/// Numbers of a summary, by their names.
pub(super) fn summary_differences<'a>(
    summary: &Value,
    expected: impl IntoIterator<Item = (&'a str, Expected)>,
    command: &str,
) -> Differences {
    let mut all = Differences::default();
    for (name, (value, scale)) in expected {
        let difference = result(summary, name).unwrap_or(f64::NAN) - value;
        all.add(difference, scale, "", || format!("{command}, {name}"));
    }
    all
}

/// Numbers of printed lines that begin with given words, to their digits.
pub(crate) fn sentence_differences(
    printed: &str,
    expected: &[(String, Vec<Expected>)],
    command: &str,
) -> Differences {
    let mut all = Differences::default();
    for (line, values) in expected {
        let mut said = printed.lines().map(str::trim_start);
        let numbers = said.find_map(|said| said.strip_prefix(line.as_str()));
        let numbers = numbers.map_or_else(Vec::new, numbers_in);
        if numbers.len() < values.len() {
            let count = values.len();
            all.fail(format!(
                "`{command}` prints no line `{line}` with {count} numbers"
            ));
            continue;
        }
        for (number, (value, scale)) in numbers.iter().zip(values) {
            let read = number.parse::<f64>().unwrap_or(f64::NAN);
            // Half of the last printed digit is rounding.
            let excess = (read - value).abs() - 0.500_000_1 * last_digit(number);
            all.add(excess.max(0.0), *scale, "", || {
                format!("{command}, `{line}`, {number}")
            });
        }
    }
    all
}

/// The numbers in a line.
fn numbers_in(line: &str) -> Vec<&str> {
    let parts = line.split(|c: char| !(c.is_ascii_alphanumeric() || ".+-".contains(c)));
    let parts = parts.map(|part| part.trim_end_matches(['.', '-']));
    let numbers = parts.filter(|part| part.parse::<f64>().is_ok_and(f64::is_finite));
    numbers.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_beyond_its_digits_is_a_difference() {
        let line = |value: f64| vec![("m    from ".to_owned(), vec![(value, 1.0), (2.0, 1.0)])];
        let printed = "Press\n  m    from 1.25 to 2 kg m²\n";
        let largest = |value: f64| sentence_differences(printed, &line(value), "reduce").largest();
        assert_eq!(largest(1.2549), 0.0);
        assert!(largest(1.2561) > 1e-3);
        let missing = [("½m′  from ".to_owned(), vec![(1.0, 1.0)])];
        let found = sentence_differences(printed, &missing, "reduce");
        assert_eq!(found.count, 0);
    }
}
