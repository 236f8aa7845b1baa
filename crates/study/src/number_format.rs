//! Numbers in text.

/// `value` to `count` significant digits without trailing zeros, with a power of ten if it is very large or small.
pub fn digits(value: f64, count: usize) -> String {
    let text = format!("{value:.*e}", count.saturating_sub(1));
    let Some((mantissa, exponent)) = text.split_once('e') else {
        // Infinite or NaN.
        return text;
    };
    let power: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: &str| {
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text.to_owned()
        }
    };
    let max_exponent = i32::try_from(count).unwrap_or(i32::MAX).max(6);
    if value == 0.0 {
        "0".to_owned()
    } else if (-4..max_exponent).contains(&power) {
        let rounded: f64 = text.parse().unwrap_or(value);
        let decimals = count as i64 - 1 - i64::from(power);
        trimmed(&format!("{rounded:.*}", decimals.max(0) as usize))
    } else {
        format!("{}e{exponent}", trimmed(mantissa))
    }
}

/// `value` with the digits that its `error` leaves, at most `count`; zero if it leaves none.
pub(crate) fn digits_within(value: f64, error: f64, count: usize) -> String {
    if !(value.abs() > error && value.is_finite()) {
        return if value.is_finite() && error.is_finite() {
            "0".to_owned()
        } else {
            digits(value, count)
        };
    }
    let known = value.abs().log10().floor() - error.log10().ceil() + 1.0;
    digits(value, known.clamp(1.0, count as f64) as usize)
}

/// To six significant digits.
pub fn number(value: f64) -> String {
    digits(value, 6)
}

/// Unit of a coordinate: an angle or a length.
pub fn coordinate_unit(is_angle: bool) -> &'static str {
    if is_angle { "rad" } else { "m" }
}

/// Unit of the force along a coordinate.
pub fn force_unit(is_angle: bool) -> &'static str {
    if is_angle { "N m" } else { "N" }
}

/// `1 actuator`, `2 actuators`, `3 degrees of freedom`, `0 bodies`.
pub fn count(number: usize, thing: &str) -> String {
    if number == 1 {
        return format!("1 {thing}");
    }
    let (noun, rest) = match thing.find(" of ") {
        Some(at) => thing.split_at(at),
        None => (thing, ""),
    };
    match noun.strip_suffix('y') {
        Some(stem) => format!("{number} {stem}ies{rest}"),
        None => format!("{number} {noun}s{rest}"),
    }
}

/// How often something happens, in words.
pub(crate) fn how_often(count: usize) -> String {
    match count {
        0 => "never".to_owned(),
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        _ => format!("{count} times"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_digit_is_printed_beyond_the_error() {
        for (value, error, text) in [
            (197.358_021_3, 3.1e-6, "197.35802"),
            (197.358_021_3, 0.0, "197.358021"),
            (197.358_021_3, 0.4, "197"),
            (197.358_021_3, 12.0, "200"),
            (-0.012_345, 1e-4, "-0.0123"),
            (9.0, 5.0, "9"),
            (1e-12, 1e-11, "0"),
            (0.0, 0.0, "0"),
        ] {
            assert_eq!(digits_within(value, error, 9), text, "{value} {error}");
        }
    }

    #[test]
    fn numbers_are_short_and_true() {
        for (value, six, twelve) in [
            (0.0, "0", "0"),
            (-0.0, "0", "0"),
            (1.0, "1", "1"),
            (0.626_326_641_678_442_9, "0.626327", "0.626326641678"),
            (-1.371_564_239_549_725_8, "-1.37156", "-1.37156423955"),
            (2000.0, "2000", "2000"),
            (123_456_789.0, "1.23457e8", "123456789"),
            (1e59, "1e59", "1e59"),
            (2.356e-9, "2.356e-9", "2.356e-9"),
            (0.000_1, "0.0001", "0.0001"),
            (0.999_999_9, "1", "0.9999999"),
            (f64::INFINITY, "inf", "inf"),
            (f64::NAN, "NaN", "NaN"),
        ] {
            assert_eq!(number(value), six);
            assert_eq!(digits(value, 12), twelve);
        }
        assert_eq!(digits(2187.41, 2), "2200");
        assert_eq!(count(1, "degree of freedom"), "1 degree of freedom");
        assert_eq!(count(3, "degree of freedom"), "3 degrees of freedom");
        assert_eq!(count(0, "actuator"), "0 actuators");
        assert_eq!(count(2, "moving body"), "2 moving bodies");
    }
}
