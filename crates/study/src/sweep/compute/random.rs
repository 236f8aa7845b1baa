//! Counter-based random numbers: the same number for the same (seed, axis, sample), on whichever thread.
//!
//! Philox4x32-10 of J. K. Salmon, M. A. Moraes, R. O. Dror and D. E. Shaw, "Parallel random numbers: as easy as
//! 1, 2, 3" (SC 2011): ten rounds that mix a counter of 128 bits with a key of 64.

/// Multipliers of a round, and increments of the key (Weyl sequence).
const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: usize = 10;

/// Philox4x32-10.
fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..ROUNDS {
        let product = |k: usize| u64::from(MULTIPLIERS[k]) * u64::from(counter[2 * k]);
        let [low0, high0] = halves(product(0));
        let [low1, high1] = halves(product(1));
        counter = [
            high1 ^ counter[1] ^ key[0],
            low1,
            high0 ^ counter[3] ^ key[1],
            low0,
        ];
        for (key, weyl) in key.iter_mut().zip(WEYL) {
            *key = key.wrapping_add(weyl);
        }
    }
    counter
}

/// The low and the high half.
fn halves(word: u64) -> [u32; 2] {
    [word as u32, (word >> 32) as u32]
}

/// Two independent numbers, uniform in the open interval (0, 1).
pub(crate) fn uniform(seed: u64, axis: u32, sample: u64) -> [f64; 2] {
    let [low, high] = halves(sample);
    let words = philox([low, high, axis, 0], halves(seed));
    [0, 2].map(|k| {
        // The midpoint of one of 2⁵² equal parts.
        let bits = (u64::from(words[k]) << 32 | u64::from(words[k + 1])) >> 12;
        (bits as f64 + 0.5) / (1_u64 << 52) as f64
    })
}

/// A number of mean 0 and standard deviation 1 by the transform of Box and Muller (1958).
pub(crate) fn normal(seed: u64, axis: u32, sample: u64) -> f64 {
    let [radius, angle] = uniform(seed, axis, sample);
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_answers_come_out() {
        // Known answers that its authors give out with Random123.
        for (counter, key, expected) in [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [u32::MAX; 4],
                [u32::MAX; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ] {
            assert_eq!(philox(counter, key), expected);
        }
    }

    #[test]
    fn moments_are_those_of_the_distributions() {
        let count = 100_000_u64;
        let mean = |of: &dyn Fn(u64) -> f64| (0..count).map(of).sum::<f64>() / count as f64;
        let even = |s: u64| uniform(7, 0, s)[0];
        let bell = |s: u64| normal(7, 1, s);
        // Four standard errors: sd/√n of a mean; of a square's mean √(1/180 n) about and √(2/n).
        let error = 4.0 / (count as f64).sqrt();
        assert!((mean(&even) - 0.5).abs() < error * 12_f64.sqrt().recip());
        let spread = mean(&|s| (even(s) - 0.5).powi(2));
        assert!((spread - 1.0 / 12.0).abs() < error * 180_f64.sqrt().recip());
        assert!(mean(&bell).abs() < error);
        assert!((mean(&|s| bell(s).powi(2)) - 1.0).abs() < error * 2_f64.sqrt());
        // Two axes of one sample have nothing to do with each other.
        let both = mean(&|s| normal(7, 1, s) * normal(7, 2, s));
        assert!(both.abs() < error);
    }

    #[test]
    fn seed_axis_and_sample_all_count() {
        let one = uniform(1, 0, 0);
        for other in [uniform(2, 0, 0), uniform(1, 1, 0), uniform(1, 0, 1)] {
            assert_ne!(one, other);
        }
        assert_ne!(uniform(1, 0, 0), uniform(1 << 32, 0, 0));
        assert_ne!(uniform(1, 0, 0), uniform(1, 0, 1 << 32));
    }
}
