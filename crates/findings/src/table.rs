//! Tables of numbers.

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Column {
    /// Its name, such as `phi.velocity`.
    pub name: String,
    /// Its unit; empty if there is none.
    pub unit: String,
}

impl Column {
    /// A column of the given name and unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
        }
    }
}

/// Numbers in columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows, each as long as `columns`; NaN where there is no value.
    pub rows: Vec<Vec<f64>>,
}
