//! Dash patterns.

/// A dash pattern: lengths in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dash {
    pub(crate) length: f64,
    pub(crate) gap: f64,
    /// Where the first dash begins.
    pub(crate) offset: f64,
}

impl Dash {
    /// The dashes of a line of some width.
    pub(crate) fn of_width(width: f64) -> Self {
        Self {
            length: 4.0 * width + 2.0,
            gap: 2.6 * width + 2.0,
            offset: 0.0,
        }
    }

    /// The pattern with at least one dash and one gap in a length.
    pub(crate) fn within(self, length: f64) -> Self {
        let scale = (length / (self.length + self.gap)).min(1.0);
        Self {
            length: scale * self.length,
            gap: scale * self.gap,
            offset: scale * self.offset,
        }
    }
}
