//! Random numbers of a sweep once more: Philox4x32-10 from its paper (Salmon, Moraes, Dror and Shaw, "Parallel random numbers:
//! as easy as 1, 2, 3", SC 2011), and the distance of a sample from its distribution (Kolmogorov and Smirnov).

/// Two numbers between 0 and 1 of a sample of an axis.
pub(super) fn uniform(seed: u64, axis: u32, sample: u64) -> [f64; 2] {
    let lower = |x: u64| x & 0xffff_ffff;
    // Table 2 of the paper: rounds of two products of 32 × 32 bits, and keys that grow by Weyl's sequences.
    let mut block = [lower(sample), sample >> 32, u64::from(axis), 0];
    for round in 0..10_u64 {
        let key = [(seed, 0x9E37_79B9), (seed >> 32, 0xBB67_AE85)];
        let key = key.map(|(start, weyl)| lower(lower(start) + round * weyl));
        let first = block[0] * 0xD251_1F53;
        let second = block[2] * 0xCD9E_8D57;
        block = [
            (second >> 32) ^ block[1] ^ key[0],
            lower(second),
            (first >> 32) ^ block[3] ^ key[1],
            lower(first),
        ];
    }
    // The first 52 bits of each half, at the middle of their interval.
    [[block[0], block[1]], [block[2], block[3]]]
        .map(|[high, low]| (high as f64 * 2f64.powi(20) + (low >> 12) as f64 + 0.5) / 2f64.powi(52))
}

/// A number of the standard normal distribution, of two uniform ones (Box and Muller, 1958).
pub(super) fn normal([first, second]: [f64; 2]) -> f64 {
    (second * std::f64::consts::TAU).cos() * (2.0 * (1.0 / first).ln()).sqrt()
}

/// The standard normal distribution function, by Simpson's rule from the middle on.
pub(super) fn normal_distribution(x: f64) -> f64 {
    const PANELS: u32 = 400;
    let density = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
    let h = x / f64::from(PANELS);
    let panel = |k: u32| {
        let at = f64::from(k) * h;
        h / 6.0 * (density(at) + 4.0 * density(at + 0.5 * h) + density(at + h))
    };
    0.5 + (0..PANELS).map(panel).sum::<f64>()
}

/// The largest distance of the distribution of a sample from a distribution function, times √n.
pub(super) fn distance(mut sample: Vec<f64>, distribution: impl Fn(f64) -> f64) -> f64 {
    sample.sort_by(f64::total_cmp);
    let n = sample.len() as f64;
    let aside = |(k, x): (usize, &f64)| {
        let [below, above] = [k as f64 / n, (k + 1) as f64 / n];
        let expected = distribution(*x);
        (expected - below).abs().max((above - expected).abs())
    };
    sample.iter().enumerate().map(aside).fold(0.0, f64::max) * n.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distribution_is_the_normal_one() {
        // Abramowitz and Stegun, table 26.1.
        for (x, p) in [(0.0, 0.5), (1.0, 0.841_344_746), (-2.0, 0.022_750_132)] {
            assert!((normal_distribution(x) - p).abs() < 1e-9, "{x}");
        }
    }

    #[test]
    fn a_narrower_sample_is_told_apart() {
        let draws = |width: f64| (0..256).map(move |k| width * normal(uniform(11, 1, k)));
        assert!(distance(draws(1.0).collect(), normal_distribution) < 1.5);
        assert!(distance(draws(0.5).collect(), normal_distribution) > 2.2);
    }
}
