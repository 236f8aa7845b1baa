//! A table as it was read: columns with names and units.

/// A column: numbers where all its cells are numbers or empty, words otherwise.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct WrittenColumn {
    pub(crate) name: String,
    /// Empty where it has none.
    pub(crate) unit: String,
    /// By row; NaN for an empty cell or a word.
    pub(crate) numbers: Vec<f64>,
    /// By row, as it is written; empty where the format holds numbers alone.
    pub(crate) words: Vec<String>,
}

/// Columns of equal length.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct WrittenTable {
    pub(crate) columns: Vec<WrittenColumn>,
    pub(crate) rows: usize,
}

impl WrittenTable {
    /// The column of a name, if it is there.
    pub(crate) fn find(&self, name: &str) -> Option<&WrittenColumn> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// The numbers of a column, if it is there.
    pub(crate) fn numbers(&self, name: &str) -> Option<&[f64]> {
        self.find(name).map(|column| column.numbers.as_slice())
    }

    /// The numbers of a column that must be there in a given unit.
    ///
    /// # Errors
    /// That it is missing, or has another unit.
    pub(crate) fn required(&self, name: &str, unit: &str) -> Result<&[f64], String> {
        match self.find(name) {
            Some(column) if column.unit == unit => Ok(&column.numbers),
            Some(column) => Err(format!(
                "column `{name}` is in `{}`, not in `{unit}`",
                column.unit
            )),
            None => Err(format!("there is no column `{name}`")),
        }
    }
}
