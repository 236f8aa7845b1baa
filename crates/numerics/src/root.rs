//! A root between two points of different sign.

/// The root of `f` between `a` and `b`, where `f` has different signs, by the Illinois variant of
/// false position, with a bisection where it stalls. The search stops at an exact zero or when the
/// bracket has the size of rounding. `None` if the signs are equal or a value is NaN.
///
/// # Errors
/// The first error of `f`.
pub fn find<E>(
    mut f: impl FnMut(f64) -> Result<f64, E>,
    mut a: f64,
    mut b: f64,
) -> Result<Option<f64>, E> {
    let (mut fa, mut fb) = (f(a)?, f(b)?);
    if fa == 0.0 {
        return Ok(Some(a));
    }
    if fb == 0.0 {
        return Ok(Some(b));
    }
    if (fa * fb).is_nan() || fa.signum() == fb.signum() {
        return Ok(None);
    }
    for k in 0..200 {
        let width = (b - a).abs();
        if width <= 2.0 * f64::EPSILON * a.abs().max(b.abs()) {
            break;
        }
        let secant = b - fb * (b - a) / (fb - fa);
        let is_inside = (secant - a) * (secant - b) < 0.0;
        let next = if is_inside && k % 4 != 3 {
            secant
        } else {
            0.5 * (a + b)
        };
        let value = f(next)?;
        if value == 0.0 {
            return Ok(Some(next));
        }
        if value.is_nan() {
            return Ok(None);
        }
        if value.signum() == fb.signum() {
            // The same end moves again: halving the value of the other end keeps it from staying fixed.
            fa *= 0.5;
        } else {
            (a, fa) = (b, fb);
        }
        (b, fb) = (next, value);
    }
    Ok(Some(if fa.abs() < fb.abs() { a } else { b }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn finds_zeros_to_rounding_and_refuses_what_has_none() {
        let cube = |x: f64| Ok::<_, Infallible>(x * x * x - 2.0);
        let found = find(cube, 0.0, 3.0).unwrap().unwrap();
        assert!((found - 2.0_f64.cbrt()).abs() < 1e-15);
        assert_eq!(find(cube, 2.0, 3.0).unwrap(), None);
        // A step is bracketed to adjacent numbers.
        let step = |x: f64| Ok::<_, Infallible>(if x < 0.3 { -1.0 } else { 5.0 });
        assert!((find(step, 0.0, 1.0).unwrap().unwrap() - 0.3).abs() < 1e-15);
    }
}
