//! An upright rectangle in page pixels; y grows downwards.

/// Upright rectangle: left, top, right, bottom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    pub(crate) x0: f64,
    pub(crate) y0: f64,
    pub(crate) x1: f64,
    pub(crate) y1: f64,
}

/// Widths of the strips around a plot that hold its labels.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Insets {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Insets {
    /// The larger of the two on each side.
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            left: self.left.max(other.left),
            top: self.top.max(other.top),
            right: self.right.max(other.right),
            bottom: self.bottom.max(other.bottom),
        }
    }
}

impl Rect {
    /// From its upper left corner and size.
    pub(crate) fn sized(x0: f64, y0: f64, width: f64, height: f64) -> Self {
        Self {
            x0,
            y0,
            x1: x0 + width,
            y1: y0 + height,
        }
    }

    /// A square by its centre and half its side.
    pub(crate) fn around([x, y]: [f64; 2], half: f64) -> Self {
        Self::sized(x, y, 0.0, 0.0).grown(half)
    }

    pub(crate) fn width(&self) -> f64 {
        self.x1 - self.x0
    }

    pub(crate) fn height(&self) -> f64 {
        self.y1 - self.y0
    }

    pub(crate) fn centre(&self) -> [f64; 2] {
        [0.5 * (self.x0 + self.x1), 0.5 * (self.y0 + self.y1)]
    }

    /// Grown by `by` on every side.
    pub(crate) fn grown(&self, margin: f64) -> Self {
        Self {
            x0: self.x0 - margin,
            y0: self.y0 - margin,
            x1: self.x1 + margin,
            y1: self.y1 + margin,
        }
    }

    /// The rectangle within the insets, with a minimum size, so that crowded labels do not invert it.
    pub(crate) fn inset(&self, insets: Insets) -> Self {
        let x0 = self.x0 + insets.left;
        let y0 = self.y0 + insets.top;
        Self {
            x0,
            y0,
            x1: (self.x1 - insets.right).max(x0 + 60.0),
            y1: (self.y1 - insets.bottom).max(y0 + 60.0),
        }
    }

    pub(crate) fn contains(&self, [x, y]: [f64; 2]) -> bool {
        x >= self.x0 && x <= self.x1 && y >= self.y0 && y <= self.y1
    }

    /// Whether the two have a point in common.
    pub(crate) fn intersects(&self, other: &Self) -> bool {
        self.x0 <= other.x1 && other.x0 <= self.x1 && self.y0 <= other.y1 && other.y0 <= self.y1
    }

    /// Whether `other` lies within.
    pub(crate) fn contains_rect(&self, other: &Self) -> bool {
        other.x0 >= self.x0 && other.x1 <= self.x1 && other.y0 >= self.y0 && other.y1 <= self.y1
    }
}
