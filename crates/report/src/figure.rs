//! A figure as plain data: panels on one page, each a chart, a drawing or a matrix of cells.

use crate::axis::{Axis, Paint};
use crate::grid::{Grid, Tiles};
use crate::shape::Drawing;

/// One page of panels, written as one PNG.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// File stem, without folder and extension.
    pub name: String,
    /// Line on top of the page.
    pub title: String,
    /// Text at the foot of the page; wrapped, and split at `\n`.
    pub caption: String,
    /// The provenance of the figure: version, scene and its hash, method; printed small and grey under the caption. It is set once
    /// for all figures of a document.
    pub provenance: String,
    /// Panels in a row (at least one); a last row that is not full is stretched over the page.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
}

/// One panel of a figure.
#[derive(Debug, Clone, PartialEq)]
pub enum Panel {
    /// Curves over axes.
    Chart(Chart),
    /// A scaled drawing with equal axes.
    Drawing(Drawing),
    /// Charts one below another over one horizontal axis, that of the first: a position, its speed and its acceleration, or
    /// the forces along a link.
    Stack(Vec<Chart>),
    /// A matrix of coloured cells; best alone on its page.
    Grid(Grid),
    /// Statements side by side.
    Tiles(Tiles),
}

impl From<Tiles> for Panel {
    fn from(tiles: Tiles) -> Self {
        Self::Tiles(tiles)
    }
}

impl From<Grid> for Panel {
    fn from(grid: Grid) -> Self {
        Self::Grid(grid)
    }
}

impl From<Vec<Chart>> for Panel {
    fn from(charts: Vec<Chart>) -> Self {
        Self::Stack(charts)
    }
}

impl From<Chart> for Panel {
    fn from(chart: Chart) -> Self {
        Self::Chart(chart)
    }
}

impl From<Drawing> for Panel {
    fn from(drawing: Drawing) -> Self {
        Self::Drawing(drawing)
    }
}

/// Curves over one horizontal and one or two vertical axes.
///
/// Points that are not finite, or not positive on a logarithmic axis, are omitted and interrupt the line. A chart
/// without drawable points shows "no data".
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart {
    /// Line above the panel.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Left axis.
    pub y: Axis,
    /// Right axis, if any.
    pub y2: Option<Axis>,
    /// The curves.
    pub series: Vec<Series>,
    /// Reference lines, bands and points.
    pub marks: Vec<Mark>,
}

/// One curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Name in the legend; a curve with an empty name is not in the legend.
    pub name: String,
    /// Points in the axes' units, joined in this order.
    pub points: Vec<[f64; 2]>,
    /// The style of the points.
    pub stroke: Stroke,
    /// Whether it belongs to the right axis.
    pub right_axis: bool,
    /// Colour; if absent, the palette by the index of the series, then ink and grey.
    pub color: Option<Paint>,
}

impl Series {
    /// A solid line.
    pub fn line(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self {
            name: name.into(),
            points,
            ..Self::default()
        }
    }

    /// Sets the stroke.
    pub fn stroke(self, stroke: Stroke) -> Self {
        Self { stroke, ..self }
    }

    /// Sets the colour.
    pub fn color(self, color: Paint) -> Self {
        Self {
            color: Some(color),
            ..self
        }
    }

    /// Moves the series to the right axis.
    pub fn right(self) -> Self {
        Self {
            right_axis: true,
            ..self
        }
    }
}

/// The style of the points of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stroke {
    /// A line.
    #[default]
    Solid,
    /// A dashed line.
    Dashed,
    /// Markers only.
    Points,
    /// Hollow markers only, for a variant of a series with filled ones.
    Hollow,
    /// Crosses only, in the colour of the series: another variant.
    Crosses,
    /// A line with markers.
    LineAndPoints,
    /// A line, with the area between it and zero lightly filled; zero is always shown. Two points of one abscissa are a
    /// jump. Between logarithmic heights, which have no zero, a line alone.
    Filled,
}

/// A reference in a chart; it is never a datum.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A vertical line.
    Vertical {
        /// Its position on the horizontal axis.
        at: f64,
        /// Its label, or empty.
        label: String,
    },
    /// A horizontal line.
    Horizontal {
        /// Its position on the left axis.
        at: f64,
        /// Its label, or empty.
        label: String,
    },
    /// An interval of the horizontal axis, lightly filled.
    Band {
        /// Its start.
        from: f64,
        /// Its end.
        to: f64,
        /// Its label, or empty.
        label: String,
    },
    /// The power law `y = y0 (x / x0)^order`: a straight line between logarithmic axes.
    Slope {
        /// The exponent.
        order: f64,
        /// The point (x0, y0) it goes through, on the left axis.
        through: [f64; 2],
        /// Its label, or empty.
        label: String,
    },
    /// A ringed point, such as the largest difference or a published value, on the left axis.
    Point {
        /// The point.
        at: [f64; 2],
        /// Its label, or empty.
        label: String,
    },
    /// Words beside a point that a series draws, on the left axis.
    Text {
        /// The point.
        at: [f64; 2],
        /// The words.
        label: String,
    },
}

impl Mark {
    /// A vertical line.
    pub fn vertical(at: f64, label: impl Into<String>) -> Self {
        let label = label.into();
        Self::Vertical { at, label }
    }

    /// A horizontal line.
    pub fn horizontal(at: f64, label: impl Into<String>) -> Self {
        let label = label.into();
        Self::Horizontal { at, label }
    }
}
