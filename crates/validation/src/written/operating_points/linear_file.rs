//! The written matrices of `linearise`, by the names of their rows and columns.

use crate::written::poses::rows::Rows;
use std::collections::BTreeMap;

/// A, B, C and D in one: an entry by the name of its row and that of its column, both without units.
#[derive(Debug, Default)]
pub(super) struct LinearFile {
    /// Rows in the order of the file, each with its unit.
    pub(super) rows: Vec<(String, String)>,
    /// States first, then inputs.
    pub(super) columns: Vec<String>,
    entries: BTreeMap<(String, String), f64>,
}

impl LinearFile {
    /// Reads the file; `None` if it has no such table.
    pub(super) fn read(text: &str) -> Option<Self> {
        let mut file = Self::default();
        let mut columns: Vec<String> = Vec::new();
        for line in text.lines() {
            let mut fields = line.split(',');
            let (matrix, row) = (fields.next()?, fields.next()?);
            if matrix == "matrix" {
                columns = fields.map(|head| split(head).0).collect();
                for column in &columns {
                    if !file.columns.contains(column) {
                        file.columns.push(column.clone());
                    }
                }
                continue;
            }
            let (row, unit) = split(row);
            if !file.rows.iter().any(|(name, _)| *name == row) {
                file.rows.push((row.clone(), unit));
            }
            for (column, value) in columns.iter().zip(fields) {
                let value = value.trim().parse().ok()?;
                file.entries.insert((row.clone(), column.clone()), value);
            }
        }
        (!file.rows.is_empty()).then_some(file)
    }

    /// The entry of a row and a column.
    pub(super) fn entry(&self, row: &str, column: &str) -> Option<f64> {
        let key = (row.to_owned(), column.to_owned());
        self.entries.get(&key).copied()
    }

    /// The rates and outputs at the state itself, by row, from the archive.
    pub(super) fn values(&self, archive: &Rows) -> Option<BTreeMap<String, f64>> {
        let [rates, outputs] = ["rates", "output"].map(|name| archive.columns.get(name));
        let values = rates?.iter().chain(outputs?);
        let names = self.rows.iter().map(|(name, _)| name.clone());
        Some(names.zip(values.copied()).collect())
    }
}

/// A head without its unit, and the unit.
fn split(head: &str) -> (String, String) {
    let head = head.trim();
    match head.rsplit_once(" [") {
        Some((name, unit)) => (name.to_owned(), unit.trim_end_matches(']').to_owned()),
        None => (head.to_owned(), String::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrices_are_read_by_their_names() {
        let text = "matrix,row,q [rad],q.velocity [rad/s]\nA,d(q)/dt [rad/s],0.0,1.0\nA,d(q.velocity)/dt [rad/s/s],-4,0\nmatrix,row,u [V]\nB,d(q)/dt [rad/s],2.5\nmatrix,row,q [rad],q.velocity [rad/s]\nC,J.x [N],3,4\nmatrix,row,u [V]\nD,J.x [N],5\n";
        let file = LinearFile::read(text).expect("matrices");
        assert_eq!(file.columns, ["q", "q.velocity", "u"]);
        assert_eq!(file.entry("d(q)/dt", "u"), Some(2.5));
        assert_eq!(file.entry("J.x", "u"), Some(5.0));
        assert_eq!(file.entry("J.x", "q.velocity"), Some(4.0));
        assert_eq!(file.rows[2], ("J.x".to_owned(), "N".to_owned()));
        assert!(LinearFile::read("matrix,row,q\nA,d(q)/dt,x\n").is_none());
    }
}
