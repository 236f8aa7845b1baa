//! Mean, standard deviation and quantiles of a sample.

/// How the values of a result are spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spread {
    pub(crate) least: f64,
    pub(crate) most: f64,
    pub(crate) mean: f64,
    /// With n − 1 in the denominator; none of a single value.
    pub(crate) deviation: Option<f64>,
    /// Between which 95 % of the values lie: the quantiles of 2.5 and 97.5 %.
    pub(crate) limits: [f64; 2],
}

impl Spread {
    /// Of the values that are numbers; none if there are none.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let (least, most) = (*sorted.first()?, *sorted.last()?);
        let count = sorted.len() as f64;
        // About the least value, so that a small spread keeps its digits.
        let mean = least + sorted.iter().map(|v| v - least).sum::<f64>() / count;
        let squares: f64 = sorted.iter().map(|v| (v - mean).powi(2)).sum();
        Some(Self {
            least,
            most,
            mean,
            deviation: (sorted.len() > 1).then(|| (squares / (count - 1.0)).sqrt()),
            limits: [0.025, 0.975].map(|part| quantile(&sorted, part)),
        })
    }
}

/// The quantile of sorted values, linearly between them (type 7 of Hyndman and Fan, 1996).
fn quantile(sorted: &[f64], part: f64) -> f64 {
    let place = part * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let [low, high] = [below, below + 1].map(|k| sorted[k.min(sorted.len() - 1)]);
    low + (place - below as f64) * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_sample_has_its_known_spread() {
        let values = (0..=40).rev().map(f64::from).chain([f64::NAN]);
        let spread = Spread::of(values).expect("values");
        assert_eq!([spread.least, spread.mean, spread.most], [0.0, 20.0, 40.0]);
        assert_eq!(spread.limits, [1.0, 39.0]);
        // Σ (k − 20)² over 0 … 40 is 2 · 20 · 21 · 41 / 6 = 5740, over n − 1 = 40; one rounding of a root.
        let deviation = spread.deviation.expect("two values");
        assert!((deviation - 143.5_f64.sqrt()).abs() < 1e-14);
        assert_eq!(Spread::of([f64::NAN].into_iter()), None);
        assert_eq!(
            Spread::of([2.0].into_iter()).and_then(|s| s.deviation),
            None
        );
    }
}
