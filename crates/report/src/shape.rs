//! A scaled drawing as plain data: enough for a planar linkage in several positions.

use crate::axis::{Axis, Paint};

/// Shapes in a plane with equal axes, fitted to the panel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// Line above the panel.
    pub title: String,
    /// Horizontal axis; its scale is always linear, and a range is the least that is shown.
    pub x: Axis,
    /// Vertical axis; likewise.
    pub y: Axis,
    /// The shapes, the first at the back.
    pub shapes: Vec<Shape>,
    /// Whether to omit axes, ticks and grid lines, for a view in which lengths cannot be measured.
    pub without_axes: bool,
}

/// The style of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pen {
    /// Colour.
    pub color: Paint,
    /// Width in pixels of a page about 1000 pixels wide per column.
    pub width: f64,
    /// From 0 (the full colour) to 1 (white). Ghosts are lightened, not transparent, so that crossings do not
    /// darken.
    pub lightness: f64,
    /// Dashed instead of solid.
    pub dashed: bool,
}

impl Pen {
    /// A solid line of the full colour.
    pub fn new(color: Paint, width: f64) -> Self {
        Self {
            color,
            width,
            lightness: 0.0,
            dashed: false,
        }
    }

    /// Sets the lightness.
    pub fn lightness(self, lightness: f64) -> Self {
        Self { lightness, ..self }
    }

    /// Makes the line dashed.
    pub fn dashed(self) -> Self {
        Self {
            dashed: true,
            ..self
        }
    }
}

/// One shape of a drawing. Places are in the axes' units, lengths named `_px` in pixels.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A line or, closed, a polygon: links, sliding blocks, paths, arcs.
    Polyline {
        /// The points; one that is not finite breaks the line.
        points: Vec<[f64; 2]>,
        /// Its style.
        pen: Pen,
        /// Whether the last point is joined to the first.
        closed: bool,
        /// Opacity of the inside, from 0 to 1, in the pen's colour; none if absent.
        fill: Option<f64>,
        /// Name in the legend; shapes of the same name share the first one's entry.
        name: Option<String>,
    },
    /// A disc or ring of fixed size, such as a pin.
    Disc {
        /// Centre.
        at: [f64; 2],
        /// Radius in pixels.
        radius_px: f64,
        /// Outline.
        pen: Pen,
        /// Whether it is filled with the pen's colour; otherwise white.
        filled: bool,
        /// Name in the legend.
        name: Option<String>,
    },
    /// A bearing on ground: support, hatching and pin.
    GroundPin {
        /// Centre of the pin.
        at: [f64; 2],
    },
    /// A fixed surface, such as a guide, hatched on the right of the line from `from` to `to`.
    GroundLine {
        /// Its start.
        from: [f64; 2],
        /// Its end.
        to: [f64; 2],
    },
    /// A line with a head at `to`.
    Arrow {
        /// Tail.
        from: [f64; 2],
        /// Head.
        to: [f64; 2],
        /// Its style.
        pen: Pen,
        /// Name in the legend.
        name: Option<String>,
    },
    /// Words.
    Text {
        /// The point they belong to.
        at: [f64; 2],
        /// The words.
        text: String,
        /// Their position relative to `at`.
        placement: TextPlacement,
        /// Colour.
        color: Paint,
    },
}

impl Shape {
    /// An open line without a name.
    pub fn line(points: Vec<[f64; 2]>, pen: Pen) -> Self {
        Self::Polyline {
            points,
            pen,
            closed: false,
            fill: None,
            name: None,
        }
    }

    /// A closed polygon, filled with the given opacity, without a name.
    pub fn area(points: Vec<[f64; 2]>, pen: Pen, fill: f64) -> Self {
        Self::Polyline {
            points,
            pen,
            closed: true,
            fill: Some(fill),
            name: None,
        }
    }

    /// A white pin with an outline of two and a half pixels.
    pub fn pin(at: [f64; 2], color: Paint, lightness: f64) -> Self {
        Self::Disc {
            at,
            radius_px: 8.0,
            pen: Pen::new(color, 2.5).lightness(lightness),
            filled: false,
            name: None,
        }
    }

    /// Words of the usual size.
    pub fn text(at: [f64; 2], text: impl Into<String>, placement: TextPlacement) -> Self {
        Self::Text {
            at,
            text: text.into(),
            placement,
            color: Paint::Ink,
        }
    }

    /// Its name in the legend, if it has one.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Polyline { name, .. } | Self::Disc { name, .. } | Self::Arrow { name, .. } => {
                name.as_deref()
            }
            Self::GroundPin { .. } | Self::GroundLine { .. } | Self::Text { .. } => None,
        }
    }

    /// Sets the name in the legend; no effect on words and supports.
    pub fn named(mut self, label: impl Into<String>) -> Self {
        match &mut self {
            Self::Polyline { name, .. } | Self::Disc { name, .. } | Self::Arrow { name, .. } => {
                *name = Some(label.into());
            }
            Self::GroundPin { .. } | Self::GroundLine { .. } | Self::Text { .. } => {}
        }
        self
    }
}

/// The position of words relative to their point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TextPlacement {
    /// On it.
    #[default]
    Centre,
    /// To the left.
    Left,
    /// To the right.
    Right,
    /// Above.
    Above,
    /// Below.
    Below,
    /// Above, to the left.
    AboveLeft,
    /// Above, to the right.
    AboveRight,
    /// Below, to the left.
    BelowLeft,
    /// Below, to the right.
    BelowRight,
}
