//! Minimum of a function on an interval.

/// The golden section of an interval.
const GOLDEN: f64 = 0.381_966_011_250_105_1;
/// Highest number of evaluations.
const MAX_EVALUATIONS: usize = 60;

/// The minimum [x, f(x)] of `f` between `a` and `b`, by parabolas and golden sections (Brent 1973). The search
/// stops at the first value of at most `enough`, or when x is known to `resolution`.
///
/// # Errors
/// The first error of `f`.
// Long because Brent's iteration is one loop over six numbers.
pub fn find<E>(
    mut f: impl FnMut(f64) -> Result<f64, E>,
    [mut a, mut b]: [f64; 2],
    resolution: f64,
    enough: f64,
) -> Result<[f64; 2], E> {
    let mut x = a + GOLDEN * (b - a);
    let mut fx = f(x)?;
    // The second and third best x, and the last two changes of the best.
    let ([mut w, mut v], [mut fw, mut fv]) = ([x; 2], [fx; 2]);
    let (mut change, mut change_before) = (0.0_f64, 0.0_f64);
    for _ in 1..MAX_EVALUATIONS {
        let middle = 0.5 * (a + b);
        let is_found = (x - middle).abs() + 0.5 * (b - a) <= 2.0 * resolution;
        // A NaN is no minimum.
        if fx <= enough || is_found || fx.is_nan() {
            break;
        }
        let mut step = None;
        if change_before.abs() > resolution {
            let r = (x - w) * (fx - fv);
            let q = (x - v) * (fx - fw);
            let p = (x - v) * q - (x - w) * r;
            let denominator = 2.0 * (q - r);
            let parabolic = if denominator == 0.0 {
                f64::INFINITY
            } else {
                -p / denominator
            };
            let to = x + parabolic;
            if parabolic.abs() < 0.5 * change_before.abs() && a < to && to < b {
                // Near an end, the other side of the best x is tried.
                let is_at_end = to - a < 2.0 * resolution || b - to < 2.0 * resolution;
                let inwards = resolution.copysign(middle - x);
                step = Some(if is_at_end { inwards } else { parabolic });
            }
        }
        change_before = change;
        change = step.unwrap_or_else(|| {
            change_before = if x < middle { b - x } else { a - x };
            GOLDEN * change_before
        });
        let least = resolution.copysign(change);
        let at = x + if change.abs() >= resolution {
            change
        } else {
            least
        };
        let value = f(at)?;
        if value <= fx {
            if at < x {
                b = x;
            } else {
                a = x;
            }
            ([v, w, x], [fv, fw, fx]) = ([w, x, at], [fw, fx, value]);
        } else {
            if at < x {
                a = at;
            } else {
                b = at;
            }
            if value <= fw || w == x {
                ([v, w], [fv, fw]) = ([w, at], [fw, value]);
            } else if value <= fv || v == x || v == w {
                (v, fv) = (at, value);
            }
        }
    }
    Ok([x, fx])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn finds_minima_with_few_evaluations() {
        let mut evaluations = 0;
        let mut cosine = |x: f64| {
            evaluations += 1;
            Ok::<_, Infallible>((x - 0.3).cos())
        };
        let [at, value] = find(&mut cosine, [2.0, 5.0], 1e-5, f64::NEG_INFINITY).unwrap();
        assert!((at - 0.3 - std::f64::consts::PI).abs() < 1e-5, "{at}");
        assert!(
            (value + 1.0).abs() < 1e-10 && evaluations < 15,
            "{evaluations}"
        );
        // A minimum at an end; and a first value that is already small enough.
        let [at, _] = find(|x: f64| Ok::<_, Infallible>(x), [1.0, 2.0], 1e-6, 0.5).unwrap();
        assert!((at - 1.0).abs() < 1e-5, "{at}");
        let [_, value] = find(
            |x: f64| Ok::<_, Infallible>(x * x - 1.0),
            [-1.0, 2.0],
            1e-9,
            -0.5,
        )
        .unwrap();
        assert!(value <= -0.5);
    }
}
