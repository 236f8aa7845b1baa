//! Findings, tables and figures as PNG, GIF, Markdown, JSON, CSV and NumPy archives.
//!
//! Everything here is plain data with public fields and a writer for it:
//!
//! - [`Figure`] (charts, stacks of charts, drawings and grids on one page) → [`png()`]
//! - [`Animation`] (drawings one after another) → [`Animation::gif`]
//! - [`Table`] → [`Table::csv`] to read, [`Table::npz`] to compute with: both give back every bit
//! - named matrices → [`npz()`]
//! - [`Document`] (a study in words, tables, figures and findings) → [`Document::markdown`]
//! - anything serialisable → [`json()`], which never turns a NaN into `null`
//! - findings → [`stable`], the text that every machine reproduces
//! - [`Files`]: all of these by relative path, written at the end, each file whole or not at all
//!
//! Which picture for what:
//!
//! | to show | take |
//! |---|---|
//! | curves over an angle or a time | [`Chart`]; named curves get their names at their ends, or else a legend |
//! | a position, its speed and its acceleration | [`Panel::Stack`]: charts over one horizontal axis |
//! | axial force, shear and moment along a link | the same with [`Stroke::Filled`], two points of one place at a jump |
//! | cost over size, error over step | [`Axis::log`] both ways, [`Stroke::LineAndPoints`] and a [`Mark::Slope`] |
//! | a path, a mechanism in one or more positions | [`Drawing`], whose axes have equal scales |
//! | a mechanism that moves | [`Animation`] |
//! | many cases under many checks | [`Grid`], cells coloured by a value, with a few letters each |
//!
//! The example `gallery` draws one of each. Six colours, ink and grey tell eight curves apart, also for colour-blind
//! readers; from the seventh on take [`Stroke::Dashed`] too.
//!
//! The crate knows plotters and resvg, and neither a solver nor a mechanism. Of plotters it uses the SVG backend and
//! the text measure; ticks, margins and the places of labels are decided here, from measured text and
//! from where the data lie, because a picture that hides the datum it reports is no evidence.

mod animation;
mod axes;
mod canvas;
mod chart;
mod color_bar;
mod curve;
mod drawing;
mod error;
mod extent;
mod figure;
mod files;
mod fonts;
mod grid;
mod header;
mod heat;
mod json;
mod labels;
mod lattice;
mod legend;
mod log_ticks;
mod markdown;
mod marks;
mod npz;
mod number;
mod occupancy;
mod page;
mod palette;
mod png;
mod raster;
mod rect;
mod shape;
mod sketch;
mod span;
mod stack;
mod table;
mod theme;
mod ticks;
mod words;

pub use animation::Animation;
pub use error::ReportError;
pub use figure::{Axis, Chart, Figure, Mark, Paint, Panel, Scale, Series, Stroke};
pub use files::Files;
pub use grid::{Cell, Grid, Group, Row};
pub use json::json;
pub use markdown::{Block, Document, stable};
pub use npz::{Array, npz};
pub use png::png;
pub use shape::{Drawing, Pen, Shape, Side};
pub use table::{Column, Table};
