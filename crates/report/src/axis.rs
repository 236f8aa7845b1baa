//! An axis and a colour as plain data.

/// How an axis is labelled and scaled.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// The quantity, such as `crank angle φ`.
    pub label: String,
    /// Its unit, such as `kg m²`; empty if there is none.
    pub unit: String,
    /// The scale.
    pub scale: Scale,
    /// Smallest and largest value shown; found from the data if absent (or unusable on this scale).
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            scale: Scale::Linear,
            range: None,
        }
    }

    /// A logarithmic axis.
    pub fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            scale: Scale::Log,
            ..Self::new(label, unit)
        }
    }

    /// An axis of angles; the data are in degrees.
    pub fn degrees(label: impl Into<String>) -> Self {
        Self {
            scale: Scale::Degrees,
            ..Self::new(label, "°")
        }
    }

    /// The same axis from `low` to `high`.
    pub fn with_range(self, low: f64, high: f64) -> Self {
        Self {
            range: Some([low, high]),
            ..self
        }
    }
}

/// The mapping of values to positions on an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// In proportion.
    #[default]
    Linear,
    /// By the logarithm; values must be positive.
    Log,
    /// In proportion, with ticks at 30, 45, 90, 180 … degrees.
    Degrees,
}

/// A colour by its role.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paint {
    /// Colour of the palette, counted from 0 and taken round: blue, vermilion, green, purple, orange, sky blue.
    Palette(usize),
    /// Near black; its markers are crosses, which stand apart from all others.
    Ink,
    /// Middle grey.
    Grey,
}
