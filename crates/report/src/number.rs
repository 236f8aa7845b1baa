//! Numbers as text.

/// `10` to a power, with a raised exponent: `10⁻¹²`.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize]);
    let exponent: String = exponent.to_string().chars().map(raised).collect();
    format!("10{exponent}")
}

/// With a fixed number of decimals and a true minus sign; never `−0`.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// In e-notation to `digits` significant digits, trailing zeros dropped: `3.5e-16`, `1e-12`, `0`.
pub(crate) fn scientific(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return format!("{value}");
    }
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    match text.split_once('e') {
        Some((mantissa, exponent)) => format!("{}e{exponent}", trimmed(mantissa)),
        None => text,
    }
}

/// A number in decimals without zeros at its end.
pub(crate) fn trimmed(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

/// Exponent of the leading decimal digit.
pub(crate) fn exponent(value: f64) -> i32 {
    if value == 0.0 || !value.is_finite() {
        return 0;
    }
    // Through the decimal form: log10 is off by one just below a power of ten.
    let text = format!("{value:e}");
    text.split_once('e')
        .and_then(|(_, e)| e.parse().ok())
        .unwrap_or(0)
}

/// The text on one line.
pub(crate) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_raised() {
        assert_eq!(power_of_ten(-12), "10⁻¹²");
        assert_eq!(power_of_ten(0), "10⁰");
        assert_eq!(power_of_ten(305), "10³⁰⁵");
    }

    #[test]
    fn short_numbers_are_short() {
        assert_eq!(scientific(3.5e-16, 3), "3.5e-16");
        assert_eq!(scientific(1e-12, 3), "1e-12");
        assert_eq!(scientific(-123_456.0, 3), "-1.23e5");
        assert_eq!(scientific(0.0, 3), "0");
        assert_eq!(scientific(f64::NAN, 3), "NaN");
        assert_eq!(scientific(f64::NEG_INFINITY, 3), "-inf");
    }

    #[test]
    fn fixed_numbers_have_no_negative_zero() {
        assert_eq!(fixed(-0.001, 2), "0.00");
        assert_eq!(fixed(-1.5, 1), "−1.5");
    }

    #[test]
    fn exponents_hold_at_powers_of_ten() {
        assert_eq!(exponent(1000.0), 3);
        assert_eq!(exponent(999.999_999_999_999_9), 2);
        assert_eq!(exponent(1e-300), -300);
        assert_eq!(exponent(-0.05), -2);
    }
}
