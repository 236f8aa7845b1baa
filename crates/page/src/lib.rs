//! A run of a command as plain data, and the one HTML file that shows it: mechanism, curves, peaks, findings.
//!
//! The crate depends on neither solvers nor mechanisms. An analysis fills a [`Page`]; [`Page::encode`] converts it into one JSON
//! description and one block of numbers, and [`Page::html`] into a file that needs no other files and no connection.
//! A program with its own document includes [`STYLE`] and [`SCRIPT`] in it, and passes the encoded page to the script.
//!
//! ```
//! use dwell_page::{Page, PageColumn};
//!
//! let page = Page {
//!     title: "Crank".to_owned(),
//!     axis: Some(0),
//!     columns: vec![
//!         PageColumn::new("phi", "rad", vec![0.0, 0.1]),
//!         PageColumn::new("m", "kg m2", vec![0.5, 0.75]),
//!         PageColumn::new("m again", "kg m2", vec![0.5, 0.75]),
//!     ],
//!     ..Page::default()
//! };
//! let encoded = page.encode()?;
//! // Equal columns are stored once.
//! assert_eq!(encoded.numbers, [0.0, 0.1, 0.5, 0.75]);
//! let html = page.html()?;
//! assert!(html.starts_with("<!DOCTYPE html>"));
//! # Ok::<(), dwell_page::PageError>(())
//! ```

mod description;
mod drawing;
mod encoded;
mod html;
mod packed;

pub use description::{
    DisplayUnit, FileLink, Page, PageColumn, PageMessage, PageScene, PageTable, Peak,
};
pub use drawing::{
    Anchor, Direction, Drawing, DrawnBody, DrawnPath, ForceArrow, ForcePart, LinkLook, Mark,
    MarkLook, OutlineLook, Part,
};
pub use encoded::{EncodedPage, FORMAT, PageError};
pub use html::{SCRIPT, STYLE, source_hash};
