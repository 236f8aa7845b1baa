//! Mean, standard deviation and quantiles of a sample.

/// The distribution of a result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spread {
    pub(crate) min: f64,
    pub(crate) max: f64,
    pub(crate) mean: f64,
    /// Root mean square.
    pub(crate) rms: f64,
    /// Standard deviation with n − 1 in the denominator; `None` for a single value.
    pub(crate) deviation: Option<f64>,
    /// The 2.5 % and 97.5 % quantiles.
    pub(crate) quantiles: [f64; 2],
    /// Number of values.
    pub(crate) count: f64,
}

impl Spread {
    /// The spread of the finite values; `None` if there are none.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        let min = values.iter().copied().min_by(f64::total_cmp)?;
        let max = values.iter().copied().max_by(f64::total_cmp)?;
        let count = values.len() as f64;
        // Relative to the minimum, so that a small spread keeps its digits.
        let mean = min + sum(&values, |v| v - min) / count;
        let squares = sum(&values, |v| (v - mean).powi(2));
        Some(Self {
            min,
            max,
            mean,
            rms: (sum(&values, |v| v * v) / count).sqrt(),
            deviation: (values.len() > 1).then(|| (squares / (count - 1.0)).sqrt()),
            quantiles: [0.025, 0.975].map(|probability| quantile(&mut values, probability)),
            count,
        })
    }

    /// The standard errors of the mean and of a standard deviation, of a normal sample.
    pub(crate) fn sampling_errors(&self, deviation: f64) -> [f64; 2] {
        let mean = deviation / self.count.sqrt();
        [mean, deviation / (2.0 * (self.count - 1.0)).sqrt()]
    }
}

/// A sum in parts, so that the roundings of 10⁸ terms do not add up.
fn sum(values: &[f64], term: impl Fn(f64) -> f64) -> f64 {
    let parts = values.chunks(4096);
    let parts = parts.map(|part| part.iter().map(|v| term(*v)).sum::<f64>());
    parts.sum()
}

/// The quantile of values in any order, linearly between two of them (type 7 of Hyndman and Fan, 1996).
fn quantile(values: &mut [f64], probability: f64) -> f64 {
    let position = probability * (values.len() - 1) as f64;
    let below = position.floor() as usize;
    let (_, low, above) = values.select_nth_unstable_by(below, f64::total_cmp);
    let low = *low;
    let high = above.iter().copied().min_by(f64::total_cmp).unwrap_or(low);
    low + (position - below as f64) * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_sample_has_its_known_spread() {
        let values = (0..=40).rev().map(f64::from).chain([f64::NAN]);
        let spread = Spread::of(values).expect("values");
        assert_eq!([spread.min, spread.mean, spread.max], [0.0, 20.0, 40.0]);
        assert_eq!(spread.quantiles, [1.0, 39.0]);
        // Σ k² over 0 … 40 is 40 · 41 · 81 / 6 = 22140.
        assert!((spread.rms - 540.0_f64.sqrt()).abs() < 1e-13);
        // Σ (k − 20)² over 0 … 40 is 2 · 20 · 21 · 41 / 6 = 5740, over n − 1 = 40; one rounding of a root.
        let deviation = spread.deviation.expect("two values");
        assert!((deviation - 143.5_f64.sqrt()).abs() < 1e-14);
        // √(143.5 / 41) and √(143.5 / 80).
        let errors = spread.sampling_errors(deviation);
        for (error, square) in errors.iter().zip([143.5 / 41.0, 143.5 / 80.0]) {
            assert!((error * error - square).abs() < 1e-13, "{errors:?}");
        }
        assert_eq!(Spread::of([f64::NAN].into_iter()), None);
        assert_eq!(
            Spread::of([2.0].into_iter()).and_then(|s| s.deviation),
            None
        );
    }
}
