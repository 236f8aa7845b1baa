//! Figures, tables, documents and findings as plain data, each with a writer: PNG, GIF, Markdown, JSON, CSV and NumPy
//! archives. The crate depends on neither solvers nor mechanisms.
//!
//! ```
//! use dwell_report::{Column, Files, Table, TableExport as _, TableFormat};
//!
//! let table = Table {
//!     columns: vec![Column::new("phi", "rad"), Column::new("m", "kg m2")],
//!     rows: vec![vec![0.0, 0.5], vec![0.1, 0.75]],
//! };
//! assert_eq!(table.csv()?, "phi [rad],m [kg m2]\n0.0,0.5\n0.1,0.75\n");
//! let mut files = Files::new();
//! files.add_table("reduced", &table, &TableFormat::ALL)?;
//! assert_eq!(files.len(), 2);
//! # Ok::<(), dwell_report::ReportError>(())
//! ```
//!
//! - [`Figure`] (charts, stacks of charts, drawings and grids on one page) → [`png()`], [`svg()`]; [`Layout`] has the positions of its words
//!   and the visible areas of its curves
//! - [`Animation`] (drawings one after another) → [`Animation::gif`]
//! - [`Table`] → [`TableExport::csv`] to read, [`TableExport::npz`] to compute with: both give back every bit
//! - named matrices → [`npz()`]
//! - [`Document`] (a study in words, tables, figures and findings) → [`Document::markdown`], [`Document::html`]
//! - anything serialisable → [`json()`], with [`Number`] for numbers that may not be finite
//! - [`Summary`] (the results of a command, for programs) → [`Summary::json`]
//! - findings → [`reproducible_text`], the text that every machine reproduces
//! - [`Files`]: all of these by relative path, written at the end, each file whole or not at all
//!
//! How to choose a picture:
//!
//! | to show | use |
//! |---|---|
//! | curves over an angle or a time | [`Chart`]; named curves get their names at their ends, or else a legend |
//! | a position, its speed and its acceleration | [`Panel::Stack`]: charts over one horizontal axis |
//! | axial force, shear and moment along a link | the same with [`Stroke::Filled`], two points of one abscissa at a jump |
//! | cost over size, error over step | [`Axis::log`] both ways, [`Stroke::LineAndPoints`] and a [`Mark::Slope`] |
//! | a path, a mechanism in one or more positions | [`Drawing`], whose axes have equal scales |
//! | a mechanism that moves | [`Animation`] |
//! | many cases under many checks | [`Grid`], cells coloured by a value, with a few letters each |
//! | a verdict, and the few numbers it rests on | [`Tiles`] |
//!
//! The example `gallery` draws one of each. Six colours, ink and grey distinguish eight curves, also for colour-blind
//! readers; from the seventh curve on use [`Stroke::Dashed`] too.
//!
//! plotters draws the pages on a backend of our own that writes SVG, which resvg converts into pixels. The chart coordinates of plotters are not used:
//! they are whole units, and its ticks omit values below 2e-16. Ticks, margins and the positions of labels are computed here, from
//! measured text and the positions of the data, so that labels do not hide data.

mod animation;
mod axes;
mod axis;
mod axis_range;
mod canvas;
mod cell_marks;
mod chart;
mod coincidence;
mod color_bar;
mod colormap;
mod curve;
mod dash;
mod drawing;
mod drawn_words;
mod end_labels;
mod error;
mod extent;
mod figure;
mod files;
mod fonts;
mod grid;
mod header;
mod heat_map;
mod html;
mod ink;
mod json;
mod layout;
mod layout_record;
mod legend;
mod linear_ticks;
mod log_ticks;
mod long_export;
mod markdown;
mod marks;
mod npz;
mod npz_reader;
mod number;
mod occupancy;
mod output_folder;
mod page;
mod palette;
mod png;
mod raster;
mod rect;
mod series_style;
mod shape;
mod shape_drawing;
mod stack;
mod summary;
mod svg;
mod svg_backend;
mod table;
mod theme;
mod ticks;
mod tile_rows;
mod typeset;
mod unit_change;
mod wrapped_text;

pub use animation::Animation;
pub use axis::{Axis, Paint, Scale};
pub use error::ReportError;
pub use figure::{Chart, Figure, Mark, Panel, Series, Stroke};
pub use files::Files;
pub use grid::{Cell, Grid, Group, Row, Tile, Tiles};
pub use html::escaped;
pub use json::{FindingRecord, Number, json};
pub use layout_record::{Label, Layout, NamedCurve};
pub use markdown::{Block, Document, markdown_text, reproducible_text};
pub use npz::{Array, npz};
pub use npz_reader::{NpzError, npz_columns};
pub use output_folder::OutputFolder;
pub use png::png;
pub use shape::{Drawing, Pen, Shape, TextPlacement};
pub use summary::{Message, SceneRecord, Summary};
pub use svg::svg;
pub use table::{Column, Table, TableExport, TableFormat};
