//! Instants and angles that a check samples: drawn from a hash of the scene's text, so that no result can be right at
//! the sampled places alone, and the same in every run.
//!
//! Sources: Fowler, Noll, Vo, FNV-1a, 64 bits; Steele, Lea, Flood, *Fast splittable pseudorandom number generators*,
//! OOPSLA 2014 (SplitMix64).

/// A sequence of numbers that a text and a purpose determine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct DrawnNumbers {
    seed: u64,
    state: u64,
}

impl DrawnNumbers {
    /// The sequence of a scene's text for one purpose: the same text gives other numbers for another purpose.
    pub(crate) fn of(text: &str, purpose: &str) -> Self {
        let bytes = text.bytes().chain([0]).chain(purpose.bytes());
        let seed = bytes.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        Self { seed, state: seed }
    }

    /// The seed, as reports name it.
    pub(crate) fn seed(&self) -> String {
        format!("{:016x}", self.seed)
    }

    /// The next number, from 0 up to but not 1.
    pub(crate) fn next_number(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / 2_f64.powi(53)
    }

    /// One number in each of `count` equal parts of `[from, to]`: they rise, and leave no large gap.
    pub(crate) fn spread(&mut self, [from, to]: [f64; 2], count: usize) -> Vec<f64> {
        let part = (to - from) / count as f64;
        (0..count)
            .map(|k| from + part * (k as f64 + self.next_number()))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_text_and_the_purpose() {
        let draw = |text, purpose| DrawnNumbers::of(text, purpose).next_number();
        assert_eq!(draw("a", "rows"), draw("a", "rows"));
        assert_ne!(draw("a", "rows"), draw("b", "rows"));
        assert_ne!(draw("a", "rows"), draw("a", "angles"));
        // Published: FNV-1a of "a" is af63dc4c8601ec8c; here a zero and the purpose follow.
        let mut numbers = DrawnNumbers { seed: 0, state: 0 };
        // Published: the first number of SplitMix64 from zero is e220a8397b1dcdaf.
        let first = numbers.next_number();
        assert_eq!(
            first,
            (0xe220_a839_7b1d_cdaf_u64 >> 11) as f64 / 2_f64.powi(53)
        );
    }

    #[test]
    fn spread_numbers_are_one_to_a_part() {
        let all = DrawnNumbers::of("scene", "angles").spread([-1.0, 3.0], 8);
        for (k, x) in all.iter().enumerate() {
            let from = -1.0 + 0.5 * k as f64;
            assert!(*x >= from && *x < from + 0.5, "{all:?}");
        }
    }
}
