//! Findings, tables and figures as PNG, Markdown, JSON and CSV.
//!
//! Everything here is plain data with public fields and a writer for it:
//!
//! - [`Figure`] (charts and drawings on one page) → [`png()`]
//! - [`Table`] → [`Table::csv`]
//! - [`Document`] (a study in words, tables, figures and findings) → [`Document::markdown`]
//! - anything serialisable → [`json()`], which never turns a NaN into `null`
//! - findings → [`stable`], the text that every machine reproduces
//! - [`Files`]: all of these by relative path, written at the end, each file whole or not at all
//!
//! The crate knows plotters and resvg, and neither a solver nor a mechanism. Of plotters it uses the SVG backend and
//! the text measure; ticks, margins and the places of labels are decided here, from measured text and
//! from where the data lie, because a picture that hides the datum it reports is no evidence.

mod animation;
mod axes;
mod canvas;
mod chart;
mod curve;
mod drawing;
mod error;
mod extent;
mod figure;
mod files;
mod fonts;
mod json;
mod labels;
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
mod table;
mod theme;
mod ticks;
mod words;

pub use animation::Animation;
pub use error::ReportError;
pub use figure::{Axis, Chart, Figure, Mark, Paint, Panel, Scale, Series, Stroke};
pub use files::Files;
pub use json::json;
pub use markdown::{Block, Document, stable};
pub use png::png;
pub use shape::{Drawing, Pen, Shape, Side};
pub use table::{Column, Table};
