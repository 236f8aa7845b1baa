//! Numbers in printed sentences, found by the words before them.

/// A number as it is printed: its value, half of its last digit, and the word that follows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PrintedNumber {
    pub(crate) value: f64,
    /// What the digits that are not printed may amount to.
    pub(crate) half_digit: f64,
    /// The unit, without a comma or another mark behind it.
    pub(crate) unit: String,
}

/// A printed line with its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line<'a>(pub(crate) &'a str);

impl Line<'_> {
    /// All numbers of the line, from left to right. A word that only begins with a digit is none.
    pub(crate) fn numbers(self) -> Vec<PrintedNumber> {
        let words: Vec<&str> = self.0.split_whitespace().collect();
        (words.iter().enumerate())
            .filter_map(|(k, word)| printed_number(word, words.get(k + 1)))
            .collect()
    }

    /// The first number behind these words.
    pub(crate) fn after(self, words: &str) -> Option<PrintedNumber> {
        let (_, rest) = self.0.split_once(words)?;
        Line(rest).numbers().into_iter().next()
    }
}

/// The first number behind these words, in the first line of a text that has both.
pub(crate) fn number_after(text: &str, words: &str) -> Option<PrintedNumber> {
    text.lines().find_map(|line| Line(line).after(words))
}

fn printed_number(word: &str, next: Option<&&str>) -> Option<PrintedNumber> {
    let word = word.trim_start_matches('(');
    let trimmed = word.trim_end_matches([',', ';', ':', ')', '.']);
    // An imaginary number keeps its i; degrees are a unit.
    let (digits, attached) = match trimmed.find(['i', '°', '%']) {
        Some(k) => trimmed.split_at(k),
        None => (trimmed, ""),
    };
    let value: f64 = digits.parse().ok()?;
    if !digits.contains(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let unit = match (attached, next) {
        ("", Some(next)) if trimmed == word => next.trim_end_matches([',', ';', ':', ')', '.']),
        (attached, _) => attached,
    };
    Some(PrintedNumber {
        value,
        half_digit: half_digit(digits),
        unit: unit.to_owned(),
    })
}

/// Half of the last printed digit.
fn half_digit(digits: &str) -> f64 {
    let (mantissa, exponent) = digits.split_once(['e', 'E']).unwrap_or((digits, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len());
    0.5 * 10_f64.powi(exponent - i32::try_from(decimals).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_found_by_the_words_before_it() {
        let text = "bar: cycle\n  mean speed 83.689086 rad/s (799.17 1/min)\n  eigenvalues 0 ± 3.65i 1/s: 3.65 rad/s = 5.8e-1 Hz, damping ratio 0";
        let speed = number_after(text, "mean speed").unwrap();
        assert_eq!((speed.value, speed.unit.as_str()), (83.689_086, "rad/s"));
        assert!((speed.half_digit - 5e-7).abs() < 1e-20);
        let hertz = number_after(text, "rad/s =").unwrap();
        assert_eq!((hertz.value, hertz.unit.as_str()), (0.58, "Hz"));
        assert!((hertz.half_digit - 5e-3).abs() < 1e-17);
        let all = Line("eigenvalues 0 ± 3.65i 1/s: phi = 90°, 0.1 s.").numbers();
        let all: Vec<_> = all.iter().map(|n| (n.value, n.unit.as_str())).collect();
        assert_eq!(all, [(0.0, "±"), (3.65, "i"), (90.0, "°"), (0.1, "s")]);
        assert!(number_after(text, "fastest").is_none());
    }
}
