//! Rows of numbers under named columns: the results of motions and sweeps.

use crate::error::Error;
use dwell_findings::Column;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ColumnTable {
    pub(crate) columns: Vec<Column>,
    pub(crate) rows: Vec<Vec<f64>>,
}

impl ColumnTable {
    /// Names and units of the columns.
    pub(crate) fn columns(&self) -> impl Iterator<Item = (&str, &str)> + Clone {
        self.columns
            .iter()
            .map(|c| (c.name.as_str(), c.unit.as_str()))
    }

    /// A column.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    pub(crate) fn column(&self, name: &str) -> Result<Vec<f64>, Error> {
        let found = self.columns.iter().position(|c| c.name == name);
        let names = self.columns().map(|(name, _)| name);
        let k = found.ok_or_else(|| Error::unknown("column", "columns", name, names))?;
        Ok(self.rows.iter().map(|row| row[k]).collect())
    }
}
