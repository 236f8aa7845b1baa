//! Tables as text files, described in docs/table-format.md. Numbers are written with as many digits as it takes to
//! read the same bits again. Of m only its values in the middles of the cells are stored: the rest is integrated
//! from ½m′, as when the table was built.

use super::bound::MAX_CELLS;
use super::piecewise::{Grid, IntegratedCurve, PiecewiseColumns, TERMS};
use super::{Bound, TabulatedModel, table_quantities};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::str::Lines;
use thiserror::Error;

type Result<T> = std::result::Result<T, FileError>;

/// First word of every file.
const MAGIC: &str = "dwell-table";
/// The only version so far.
const VERSION: u32 = 1;
/// Highest number of revolutions after which a mechanism repeats itself.
const MAX_REVOLUTIONS: u32 = 8;

/// The names in a table, which a model does not know. None may contain a line break.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Labels {
    /// Hash of the scene's text.
    pub scene: String,
    /// The coordinate.
    pub coordinate: String,
    /// The reactions, in their order.
    pub reactions: Vec<String>,
    /// The loads, in their order.
    pub loads: Vec<String>,
}

/// Why a table cannot be written or read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum FileError {
    /// Names that do not fit the table, or with a line break in them.
    #[error("the names do not fit the table: {reactions} reactions and {loads} loads, a line each")]
    Labels {
        /// Reactions of the table.
        reactions: usize,
        /// Loads of the table.
        loads: usize,
    },
    /// The text is no table.
    #[error("this is not a table file: its first line is not `dwell-table` and a version")]
    NotATable,
    /// An unknown version.
    #[error("a table file of version {found}: only version {VERSION} can be read")]
    Version {
        /// The entry of the file.
        found: String,
    },
    /// The last line is missing: the file was cut short.
    #[error("the table is cut short: its last line, `check`, is missing")]
    Truncated,
    /// The sum in the last line is not that of the lines before.
    #[error("the table file was changed or damaged: its checksum is wrong")]
    ChecksumMismatch,
    /// A line violates the format.
    #[error("line {line} of the table: expected {expected}")]
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// The expected contents.
        expected: &'static str,
    },
}

impl TabulatedModel {
    /// The table as the text of a file.
    ///
    /// # Errors
    /// [`FileError::Labels`] for names that do not fit.
    pub fn to_text(&self, labels: &Labels) -> Result<String> {
        let lists = [&labels.reactions, &labels.loads];
        let (scene, coordinate) = (&labels.scene, &labels.coordinate);
        let mut names = lists.into_iter().flatten().chain([scene, coordinate]);
        let broken = names.any(|name| name.contains(['\n', '\r']));
        if broken || lists.map(Vec::len) != self.counts {
            let [reactions, loads] = self.counts;
            return Err(FileError::Labels { reactions, loads });
        }
        let grid = &self.inertia.grid;
        let unit = if self.is_angle { "rad" } else { "m" };
        let cells = self.cells().map(|n| n as f64);
        let mut text =
            format!("{MAGIC} {VERSION}\nscene {scene}\ncoordinate {unit} {coordinate}\n");
        for (keyword, list) in ["reaction", "load"].into_iter().zip(lists) {
            write_line(&mut text, &format!("{keyword}s"), [list.len() as f64]);
            for name in list {
                text.push_str(&format!("{keyword} {name}\n"));
            }
        }
        write_line(&mut text, "accuracy", [self.accuracy]);
        write_line(&mut text, "extent", [grid.from, grid.length]);
        write_line(&mut text, "turns", [f64::from(grid.revolutions)]);
        write_line(&mut text, "cells", cells);
        write_line(&mut text, "scales", self.bounds.iter().map(|b| b.scale));
        write_line(&mut text, "errors", self.bounds.iter().map(|b| b.error));
        for (m, slope) in self.inertia.cell_data() {
            write_line(&mut text, "m", [m].into_iter().chain(slope));
        }
        for (keyword, columns) in [("ab", &self.reactions), ("wc", &self.loads)] {
            for cell in columns.terms.chunks(TERMS * columns.width.max(1)) {
                write_line(&mut text, keyword, cell.iter().copied());
            }
        }
        let sum = fnv1a_64(text.as_bytes());
        text.push_str(&format!("check {sum:016x}\n"));
        Ok(text)
    }

    /// The table in a text, with its names.
    ///
    /// # Errors
    /// [`FileError`] where it is not a complete, unaltered table.
    pub fn from_text(text: &str) -> Result<(Self, Labels)> {
        let first = text.lines().next().unwrap_or_default();
        let version = first.strip_prefix(MAGIC).and_then(|v| v.strip_prefix(' '));
        let version = version.ok_or(FileError::NotATable)?;
        if version != VERSION.to_string() {
            return Err(FileError::Version {
                found: version.to_owned(),
            });
        }
        let whole = text.strip_suffix('\n').ok_or(FileError::Truncated)?;
        let (_, last) = whole.rsplit_once('\n').ok_or(FileError::Truncated)?;
        let stated = last.strip_prefix("check ").ok_or(FileError::Truncated)?;
        let body = &text[..whole.len() - last.len()];
        if format!("{:016x}", fnv1a_64(body.as_bytes())) != stated {
            return Err(FileError::ChecksumMismatch);
        }
        let (lines, line) = (body.lines(), 0);
        Reader { lines, line }.table()
    }
}

/// Writes a keyword and numbers as a line.
fn write_line(text: &mut String, keyword: &str, numbers: impl IntoIterator<Item = f64>) {
    text.push_str(keyword);
    for number in numbers {
        // Writing to a string does not fail.
        let _ = write!(text, " {number:e}");
    }
    text.push('\n');
}

/// Fowler, Noll and Vo's sum of 64 bits (1a). Each byte's step can be undone, so no single altered byte
/// leaves it as it was.
fn fnv1a_64(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, &byte| {
        (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Reads a text line by line.
struct Reader<'a> {
    lines: Lines<'a>,
    line: usize,
}

impl<'a> Reader<'a> {
    fn table(mut self) -> Result<(TabulatedModel, Labels)> {
        self.after_keyword(MAGIC)?;
        let scene = self.after_keyword("scene")?.to_owned();
        let coordinate = self.after_keyword("coordinate")?;
        let (unit, coordinate) = coordinate
            .split_once(' ')
            .filter(|(unit, _)| ["rad", "m"].contains(unit))
            .ok_or_else(|| self.line_error("rad or m, and a name"))?;
        let labels = Labels {
            scene,
            coordinate: coordinate.to_owned(),
            reactions: self.names("reactions", "reaction")?,
            loads: self.names("loads", "load")?,
        };
        let accuracy = self.numbers("accuracy", 1)?[0];
        let domain = self.numbers("extent", 2)?;
        let revolutions = self.count("turns", MAX_REVOLUTIONS as usize)? as u32;
        let grid = self.grid(&domain, revolutions)?;
        let cells = self.counts("cells", 3, MAX_CELLS)?;
        let counts = [labels.reactions.len(), labels.loads.len()];
        let widths = [2 * counts[0], counts[1] * (1 + counts[0])];
        let none = [false, widths[0] == 0, widths[1] == 0];
        let mut pairs = cells.iter().zip(none);
        if pairs.any(|(&cells, none)| (cells == 0) != none) {
            return Err(self.line_error("cells of every function of the table, and of no other"));
        }
        let (both, ab, wc) = table_quantities(counts);
        let entries = [both.to_vec(), ab, wc].concat();
        let scales = self.numbers("scales", entries.len())?;
        let errors = self.numbers("errors", entries.len())?;
        let known = entries.iter().zip(scales).zip(errors);
        let bounds = known.map(|((&quantity, scale), error)| Bound {
            quantity,
            scale,
            error,
        });
        let mut cell_data = Vec::new();
        for _ in 0..cells[0] {
            let numbers = self.numbers("m", 1 + TERMS)?;
            cell_data.push((numbers[0], std::array::from_fn(|j| numbers[1 + j])));
        }
        let table = TabulatedModel {
            accuracy,
            is_angle: unit == "rad",
            inertia: IntegratedCurve::from_cell_data(grid.with_cells(cells[0]), cell_data),
            reactions: self.columns("ab", grid.with_cells(cells[1].max(1)), widths[0])?,
            loads: self.columns("wc", grid.with_cells(cells[2].max(1)), widths[1])?,
            counts,
            bounds: bounds.collect(),
        };
        if self.lines.next().is_some() {
            self.line += 1;
            return Err(self.line_error("nothing after the last cell but `check`"));
        }
        Ok((table, labels))
    }

    /// The extent as a grid of one cell.
    fn grid(&self, domain: &[f64], revolutions: u32) -> Result<Grid> {
        let (from, length) = (domain[0], domain[1]);
        let whole = revolutions == 0 || (from == 0.0 && length == TAU * f64::from(revolutions));
        if whole && length > 0.0 && (from + length).is_finite() {
            Ok(Grid::new(from, length, revolutions, 1))
        } else {
            let expected =
                "an interval that is not empty, and of whole revolutions if it repeats itself";
            Err(self.line_error(expected))
        }
    }

    fn columns(
        &mut self,
        keyword: &'static str,
        grid: Grid,
        width: usize,
    ) -> Result<PiecewiseColumns> {
        let mut terms = Vec::new();
        let cells = if width > 0 { grid.cells } else { 0 };
        for _ in 0..cells {
            terms.extend(self.numbers(keyword, TERMS * width)?);
        }
        Ok(PiecewiseColumns { grid, width, terms })
    }

    fn line_error(&self, expected: &'static str) -> FileError {
        let line = self.line;
        FileError::Line { line, expected }
    }

    /// The rest of the next line after its keyword.
    fn after_keyword(&mut self, keyword: &'static str) -> Result<&'a str> {
        self.line += 1;
        let line = self.lines.next().unwrap_or_default();
        let rest = line.strip_prefix(keyword).and_then(|l| l.strip_prefix(' '));
        rest.ok_or_else(|| self.line_error(keyword))
    }

    fn list(
        &mut self,
        keyword: &'static str,
        count: usize,
        fits: impl Fn(&f64) -> bool,
        expected: &'static str,
    ) -> Result<Vec<f64>> {
        if count == 0 {
            // Without a number there is no blank either.
            self.line += 1;
            let empty = self.lines.next() == Some(keyword);
            return empty.then(Vec::new).ok_or_else(|| self.line_error(keyword));
        }
        let words = self.after_keyword(keyword)?.split(' ');
        let numbers: Option<Vec<f64>> = words.map(|n| n.parse().ok().filter(&fits)).collect();
        let complete = numbers.filter(|numbers| numbers.len() == count);
        complete.ok_or_else(|| self.line_error(expected))
    }

    fn numbers(&mut self, keyword: &'static str, count: usize) -> Result<Vec<f64>> {
        let expected = "finite numbers, as many as the counts say";
        self.list(keyword, count, |n| n.is_finite(), expected)
    }

    fn counts(&mut self, keyword: &'static str, count: usize, max: usize) -> Result<Vec<usize>> {
        let whole = |n: &f64| n.fract() == 0.0 && (0.0..=max as f64).contains(n);
        let expected = "whole numbers that are not too large";
        let found = self.list(keyword, count, whole, expected)?;
        Ok(found.into_iter().map(|n| n as usize).collect())
    }

    fn count(&mut self, keyword: &'static str, max: usize) -> Result<usize> {
        Ok(self.counts(keyword, 1, max)?[0])
    }

    fn names(&mut self, keyword: &'static str, each: &'static str) -> Result<Vec<String>> {
        let count = self.count(keyword, u32::MAX as usize)?;
        let names = (0..count).map(|_| self.after_keyword(each).map(str::to_owned));
        names.collect()
    }
}
