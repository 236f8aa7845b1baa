//! Random draws that are the same on every machine: what a study draws is its seed and the number of the draw.

/// Draws of one subject of a study (Steele, Lea and Flood 2014, SplitMix64).
pub(super) struct Draws(u64);

impl Draws {
    /// The draws of subject `number` of a seed.
    pub(super) fn new(seed: u64, number: usize) -> Self {
        let mut draws = Self(seed);
        // The seed and the number are mixed, so that neighbours have nothing in common.
        let mixed = draws.next() ^ (number as u64).wrapping_mul(0xD6E8_FEB8_6659_FD93);
        Self(mixed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number between two others.
    pub(super) fn between(&mut self, from: f64, to: f64) -> f64 {
        let part = (self.next() >> 11) as f64 / (1_u64 << 53) as f64;
        from + (to - from) * part
    }

    /// A power of ten with an exponent between two others.
    pub(super) fn power_of_ten(&mut self, from: f64, to: f64) -> f64 {
        10_f64.powf(self.between(from, to))
    }

    /// One of some choices.
    pub(super) fn choose<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// A whole number below another.
    pub(super) fn below(&mut self, count: usize) -> usize {
        (self.next() % count.max(1) as u64) as usize
    }

    /// Whether something of a probability happens.
    pub(super) fn happens(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }
}
