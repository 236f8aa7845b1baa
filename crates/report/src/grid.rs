//! A matrix of checked or measured cells as plain data.

use crate::axis::Axis;

/// Rows and columns of cells, coloured by their values, such as the faults that each check detects, or the digits of each case.
///
/// The panel is as wide as its cell on the page and grows with its rows: about 40 pixels each, 21 if compact. Give it a page of one
/// column, and no more than about 24 columns. The colours go from nearly white to dark blue, so that they can be distinguished in
/// grey and by colour-blind readers; a bar above the cells states them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grid {
    /// Line above the panel.
    pub title: String,
    /// Names of the columns; turned upwards if they do not fit across.
    pub columns: Vec<String>,
    /// The rows, under headings.
    pub groups: Vec<Group>,
    /// What the values are, their unit and scale, and the range that the colours cover (found from the values if absent). A value
    /// beyond the range has the colour of its end.
    pub values: Axis,
    /// Whether rows and letters are small, so that some 60 rows fit a screen.
    pub compact: bool,
}

/// Rows under one heading.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Group {
    /// Words above the rows, or nothing.
    pub heading: String,
    /// The rows, from above.
    pub rows: Vec<Row>,
}

/// One row of a [`Grid`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    /// Its name, to the left of the cells.
    pub name: String,
    /// One cell for each column. `None`, and what is missing at the end, does not apply: it is hatched, with a dash. What is
    /// beyond the last column is not shown.
    pub cells: Vec<Option<Cell>>,
}

/// One cell of a [`Grid`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cell {
    /// The value that the colour shows, in the unit of [`Grid::values`]; white if there is none, or if the scale cannot show
    /// it.
    pub value: Option<f64>,
    /// A short text in the cell, or empty.
    pub text: String,
    /// Whether to mark the cell as failed: vermilion, with bold letters.
    pub failed: bool,
}

impl Row {
    /// A named row of cells.
    pub fn new(name: impl Into<String>, cells: Vec<Option<Cell>>) -> Self {
        Self {
            name: name.into(),
            cells,
        }
    }
}

impl Cell {
    /// A cell coloured by a value, with a few letters.
    pub fn new(value: f64, text: impl Into<String>) -> Self {
        Self {
            value: Some(value),
            ..Self::text_only(text)
        }
    }

    /// A white cell with a few letters.
    pub fn text_only(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            ..Self::default()
        }
    }

    /// Marks the cell as failed.
    pub fn failed(self) -> Self {
        Self {
            failed: true,
            ..self
        }
    }
}

/// Key statements side by side, each a short value with its name above and its reason below.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tiles {
    /// Tiles in a row (at least one).
    pub columns: usize,
    /// The tiles, row by row.
    pub tiles: Vec<Tile>,
}

/// One of [`Tiles`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tile {
    /// Its name.
    pub name: String,
    /// The value, in large letters; set smaller where it is wider than its tile.
    pub value: String,
    /// Its reason or source; wrapped.
    pub note: String,
    /// For a verdict, whether it passed: a green or vermilion edge.
    pub passed: Option<bool>,
}

impl Tile {
    /// A statement.
    pub fn new(name: impl Into<String>, value: impl Into<String>, note: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            value: value.into(),
            note: note.into(),
            passed: None,
        }
    }

    /// Makes the statement a verdict.
    pub fn with_result(self, passed: bool) -> Self {
        Self {
            passed: Some(passed),
            ..self
        }
    }
}
