//! Numbers of a summary and of printed lines, compared with their expected values.

use super::difference::Differences;
use serde_json::Value;

/// A value that should stand somewhere, and its scale.
pub(crate) type Expected = (f64, f64);

/// Numbers of the results of a summary in a printed unit; none if one is missing.
pub(crate) fn expected(summary: &Value, names: &[&str], unit: f64) -> Option<Vec<Expected>> {
    let numbers = names.iter().map(|name| result(summary, name));
    let in_unit = |x: f64| (x / unit, (x / unit).abs().max(f64::MIN_POSITIVE));
    numbers.map(|x| x.map(in_unit)).collect()
}

/// A number of the results of a summary.
pub(crate) fn result(summary: &Value, name: &str) -> Option<f64> {
    summary["results"][name]["value"].as_f64()
}

/// Numbers of printed lines that begin with given words, to their digits.
pub(crate) fn sentence_differences(
    printed: &str,
    expected: &[(String, Vec<Expected>)],
    command: &str,
) -> Differences {
    let mut all = Differences::default();
    for (line, values) in expected {
        let said = printed.lines().map(str::trim_start);
        let said = said.filter_map(|said| said.strip_prefix(line.as_str()));
        let mut said = said.map(numbers_in);
        let Some(numbers) = said.find(|numbers| numbers.len() >= values.len()) else {
            let count = values.len();
            all.fail(format!(
                "`{command}` prints no line `{line}` with {count} numbers"
            ));
            continue;
        };
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

/// The value of one in the last printed digit; trailing zeros of a whole number do not count as digits.
pub(crate) fn last_digit(number: &str) -> f64 {
    let (digits, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let decimals = digits
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    let zeros = match digits.contains('.') {
        true => 0,
        false => digits.len() - digits.trim_end_matches('0').len(),
    };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let [decimals, zeros] = [decimals, zeros].map(|n| i32::try_from(n).unwrap_or(0));
    10_f64.powi(exponent - decimals + zeros)
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
        assert_eq!(found.count(), 0);
    }
}
