//! Derivatives from values alone: central differences at ever shorter steps, extrapolated to step
//! zero.
//!
//! The error of a central difference is a series in h², so the polynomial in h² through several of
//! them is evaluated at h = 0 by Neville's scheme (Richardson; on halved steps, Romberg):
//!
//! ```text
//! D₁(h) = (f(h) − f(−h)) / 2h                                (1)
//! D₂(h) = (f(h) − 2 f(0) + f(−h)) / h²                       (2)
//! Tᵢⱼ = Tᵢ,ⱼ₋₁ + (Tᵢ,ⱼ₋₁ − Tᵢ₋₁,ⱼ₋₁) / ((hᵢ₋ⱼ / hᵢ)² − 1)       (3)
//! ```
//!
//! A long step is poor because the series has not converged, a short one because f is rounded:
//! which entry of the scheme is best depends on the function. It is chosen by its own estimated
//! error, the distance to its two parents (C. Ridders, *Accurate computation of F′(x) and
//! F′(x)F″(x)*, Advances in Engineering Software 4, 1982) plus the rounding of the shortest step
//! it uses, so that two entries which agree by chance at a short step are not preferred.

/// A derivative with the estimate of its error that chose it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extrapolated {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

/// No step could be evaluated.
pub(crate) const NO_ESTIMATE: Extrapolated = Extrapolated {
    value: f64::NAN,
    error: f64::NAN,
};

/// Less than the customary 2: the shortest step, on which rounding weighs most, stays longer for
/// the same number of steps.
const STEP_RATIO: f64 = 1.6;
/// Steps taken in any case, and at most; the last is 1/27 or 1/3000 of the first.
const MIN_STEPS: usize = 8;
const MAX_STEPS: usize = 18;
/// More steps are taken while another step reduces the estimated error of a component to this fraction. Next to a dead
/// point, for example, the first steps are too long for the series to converge.
const MIN_IMPROVEMENT: f64 = 0.5;

/// Which derivative.
#[derive(Debug, Clone, Copy)]
pub(crate) enum DerivativeOrder<'a> {
    First,
    /// Second, with the values at zero.
    Second(&'a [f64]),
}

/// Neville's scheme of one component: its last row, and its best entry.
struct NevilleTable {
    row: Vec<f64>,
    best: Extrapolated,
    largest: f64,
}

/// The derivative at zero of every component of `f`, from the step `first` down. A step at which `f` has no value on a
/// side, because the mechanism does not reach that far, is omitted. Empty if no step has values. Values are taken as
/// rounded to `rounding` of themselves.
pub(crate) fn derivatives<F>(
    order: DerivativeOrder<'_>,
    first_step: f64,
    rounding: f64,
    mut f: F,
) -> Vec<Extrapolated>
where
    F: FnMut(f64) -> Option<Vec<f64>>,
{
    let mut steps: Vec<f64> = Vec::with_capacity(MAX_STEPS);
    let mut tables: Vec<NevilleTable> = Vec::new();
    let mut h = first_step;
    let mut steps_without_gain = 0;
    for _ in 0..MAX_STEPS {
        if let (Some(plus), Some(minus)) = (f(h), f(-h)) {
            steps.push(h);
            if tables.is_empty() {
                tables.resize_with(plus.len(), NevilleTable::new);
            }
            let mut improved = false;
            for (c, table) in tables.iter_mut().enumerate() {
                let before = table.best.error;
                table.add(order, &steps, rounding, c, [plus[c], minus[c]]);
                improved |= table.best.error < MIN_IMPROVEMENT * before;
            }
            steps_without_gain = if improved { 0 } else { steps_without_gain + 1 };
            if steps.len() >= MIN_STEPS && steps_without_gain >= 2 {
                break;
            }
        }
        h /= STEP_RATIO;
    }
    tables.into_iter().map(|s| s.best).collect()
}

/// The first derivative at zero of a single value; `None` if no step could be taken.
pub(crate) fn slope(
    first_step: f64,
    rounding: f64,
    mut f: impl FnMut(f64) -> Option<f64>,
) -> Option<Extrapolated> {
    let first = DerivativeOrder::First;
    let slopes = derivatives(first, first_step, rounding, |h| Some(vec![f(h)?]));
    slopes.first().copied()
}

impl NevilleTable {
    fn new() -> Self {
        Self {
            row: Vec::with_capacity(MAX_STEPS),
            best: NO_ESTIMATE,
            largest: 0.0,
        }
    }

    /// One more row of the scheme, eq. (3), for the last of `steps`.
    fn add(
        &mut self,
        order: DerivativeOrder<'_>,
        steps: &[f64],
        rounding: f64,
        component: usize,
        [plus, minus]: [f64; 2],
    ) {
        let i = steps.len() - 1;
        let h = steps[i];
        self.largest = self.largest.max(plus.abs()).max(minus.abs());
        let (mut value, rounding_gain) = match order {
            DerivativeOrder::First => ((plus - minus) / (2.0 * h), self.largest / h),
            DerivativeOrder::Second(middle) => {
                let middle = middle[component];
                let second_difference = (plus - middle) + (minus - middle);
                (second_difference / (h * h), 2.0 * self.largest / (h * h))
            }
        };
        // In place: `above` is the entry of the row before that the next one is made from.
        for j in 0..i {
            let above = std::mem::replace(&mut self.row[j], value);
            let ratio = steps[i - j - 1] / h;
            let next = value + (value - above) / (ratio * ratio - 1.0);
            let error = (next - value).abs().max((next - above).abs()) + rounding * rounding_gain;
            if self.best.error.is_nan() || error < self.best.error {
                self.best = Extrapolated { value: next, error };
            }
            value = next;
        }
        self.row.push(value);
    }
}

/// One plain or extrapolated central difference for the curve of error against step: with `order`
/// 2, 4 or 6 at the step `h`, the higher ones from h, h/2 and h/4 by eq. (3).
pub(crate) fn central_difference<F>(order: u32, h: f64, mut f: F) -> Option<f64>
where
    F: FnMut(f64) -> Option<f64>,
{
    let mut central = |h: f64| Some((f(h)? - f(-h)?) / (2.0 * h));
    let second = central(h)?;
    if order <= 2 {
        return Some(second);
    }
    let half = central(0.5 * h)?;
    let fourth = half + (half - second) / 3.0;
    if order <= 4 {
        return Some(fourth);
    }
    let quarter = central(0.25 * h)?;
    let finer = quarter + (quarter - half) / 3.0;
    Some(finer + (finer - fourth) / 15.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIRST_STEP: f64 = 0.4;

    #[test]
    fn a_smooth_function_is_differenced_nearly_to_rounding() {
        let f = |h: f64| Some(vec![(0.3 + h).sin(), 1.0 / (1.5 + h)]);
        let first = derivatives(DerivativeOrder::First, FIRST_STEP, f64::EPSILON, f);
        assert!((first[0].value - 0.3_f64.cos()).abs() < 5e-15);
        assert!((first[1].value + 1.0 / 2.25).abs() < 5e-14);
        let middle = f(0.0).unwrap();
        let second = derivatives(
            DerivativeOrder::Second(&middle),
            FIRST_STEP,
            f64::EPSILON,
            f,
        );
        assert!((second[0].value + 0.3_f64.sin()).abs() < 1e-13);
        assert!((second[1].value - 2.0 / 3.375).abs() < 1e-12);
    }

    /// The estimate is an upper bound in practice, and stays one where a far step is wrong.
    #[test]
    fn a_step_onto_another_branch_is_not_used() {
        let f = |h: f64| Some(vec![if h.abs() > 0.1 { 7.0 } else { 0.0 } + h.exp()]);
        let got = derivatives(DerivativeOrder::First, FIRST_STEP, f64::EPSILON, f)[0];
        let error = (got.value - 1.0).abs();
        assert!(error < 1e-11 && got.error > error, "{error:e} {got:?}");
    }

    #[test]
    fn steps_that_cannot_be_taken_are_left_out() {
        let f = |h: f64| (h < 0.2).then(|| vec![h.exp()]);
        assert!(
            (derivatives(DerivativeOrder::First, FIRST_STEP, f64::EPSILON, f)[0].value - 1.0).abs()
                < 1e-12
        );
        assert!(derivatives(DerivativeOrder::First, FIRST_STEP, f64::EPSILON, |_| None).is_empty());
    }

    #[test]
    fn a_function_that_is_not_a_number_gives_none() {
        let got = derivatives(DerivativeOrder::First, FIRST_STEP, f64::EPSILON, |_| {
            Some(vec![f64::NAN])
        })[0];
        assert!(got.value.is_nan() && got.error.is_nan());
    }

    #[test]
    fn orders_fall_as_they_should() {
        let f = |h: f64| Some((1.0 + h).exp());
        let error = |order, h| (central_difference(order, h, f).unwrap() - 1_f64.exp()).abs();
        for (order, at_least) in [(2, 95.0), (4, 9e3), (6, 6e5)] {
            assert!(error(order, 0.5) / error(order, 0.05) > at_least);
        }
    }
}
