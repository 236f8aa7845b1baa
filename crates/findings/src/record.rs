//! The printed results of a command as plain data: numbers with all digits, extrema, events and files.

use crate::Column;

/// A printed number.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedNumber {
    /// Its name, such as `period`, unique within a record.
    pub name: String,
    /// Its unit; empty where it has none.
    pub unit: String,
    /// The number, with all its digits.
    pub value: f64,
    /// Its estimated error in the same unit, if known.
    pub error: Option<f64>,
}

/// The smallest and the largest value of a column.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedExtrema {
    /// The column with its unit.
    pub column: Column,
    /// The smallest and the largest value, each with the abscissa where it occurs.
    pub ends: [[f64; 2]; 2],
    /// The estimated error of the values, if known.
    pub error: Option<f64>,
}

/// An event of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedEvent {
    /// Its name.
    pub name: String,
    /// Its time, s.
    pub t: f64,
}

/// The printed results of a command, for programs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// The printed numbers, in their order.
    pub numbers: Vec<RecordedNumber>,
    /// The abscissa of the extrema: time, or a coordinate.
    pub abscissa: Option<Column>,
    /// The extrema of all columns.
    pub extrema: Vec<RecordedExtrema>,
    /// The events, in order of time.
    pub events: Vec<RecordedEvent>,
    /// Files that the command has written itself, relative to the output folder.
    pub files: Vec<String>,
}

impl Record {
    /// Adds a number without a known error, under a name that is unique within the record.
    pub fn add(&mut self, name: impl Into<String>, unit: &str, value: f64) {
        self.push(name.into(), unit, value, None);
    }

    /// Adds a number with its estimated error.
    pub fn add_within(&mut self, name: impl Into<String>, unit: &str, value: f64, error: f64) {
        self.push(name.into(), unit, value, Some(error));
    }

    /// Adds a count.
    pub fn add_count(&mut self, name: impl Into<String>, count: usize) {
        self.push(name.into(), "", count as f64, None);
    }

    fn push(&mut self, name: String, unit: &str, value: f64, error: Option<f64>) {
        let unit = unit.to_owned();
        self.numbers.push(RecordedNumber {
            name,
            unit,
            value,
            error,
        });
    }

    /// Appends another record.
    pub fn extend(&mut self, other: Self) {
        self.numbers.extend(other.numbers);
        self.abscissa = other.abscissa.or(self.abscissa.take());
        self.extrema.extend(other.extrema);
        self.events.extend(other.events);
        self.files.extend(other.files);
    }
}
