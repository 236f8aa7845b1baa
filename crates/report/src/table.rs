//! Tables of numbers as CSV.

use crate::error::ReportError;

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Column {
    /// What it holds.
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
    /// The rows, each as long as `columns`.
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    /// The table as CSV text: a header `name [unit]`, then the rows with the fewest digits that give back every bit.
    /// What is not finite is written `NaN`, `inf` or `-inf`.
    ///
    /// # Errors
    ///
    /// [`ReportError::Row`] if a row is not as long as the header; [`ReportError::Csv`] if the writer refuses.
    pub fn csv(&self) -> Result<String, ReportError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let header = |c: &Column| {
            if c.unit.is_empty() {
                c.name.clone()
            } else {
                format!("{} [{}]", c.name, c.unit)
            }
        };
        writer.write_record(self.columns.iter().map(header))?;
        for (row, values) in self.rows.iter().enumerate() {
            if values.len() != self.columns.len() {
                return Err(ReportError::Row {
                    row,
                    found: values.len(),
                    expected: self.columns.len(),
                });
            }
            // `Debug` of a float is its shortest exact form, with an exponent where that is shorter.
            writer.write_record(values.iter().map(|v| format!("{v:?}")))?;
        }
        let bytes = writer
            .into_inner()
            .map_err(|e| csv::Error::from(e.into_error()))?;
        // Only strings have been written.
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_comes_back() {
        let values = [
            0.1 + 0.2,
            -0.0,
            1e-310,
            f64::MAX,
            f64::MIN_POSITIVE,
            1.0 / 3.0,
            -6.02e23,
            5.419_662_677_064_27,
        ];
        let table = Table {
            columns: vec![
                Column::new("φ, of the crank", "rad"),
                Column::new("ratio", ""),
            ],
            rows: values.chunks(2).map(<[f64]>::to_vec).collect(),
        };
        let text = table.csv().unwrap();
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        assert_eq!(
            reader.headers().unwrap(),
            vec!["φ, of the crank [rad]", "ratio"]
        );
        let read: Vec<f64> = reader
            .records()
            .flat_map(|r| {
                r.unwrap()
                    .iter()
                    .map(|v| v.parse().unwrap())
                    .collect::<Vec<f64>>()
            })
            .collect();
        assert_eq!(read.len(), values.len());
        assert!(
            read.iter()
                .zip(values)
                .all(|(a, b)| a.to_bits() == b.to_bits()),
            "{text}"
        );
    }

    #[test]
    fn what_is_not_finite_is_named() {
        let table = Table {
            columns: vec![Column::default(); 3],
            rows: vec![vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY]],
        };
        assert!(table.csv().unwrap().ends_with("NaN,inf,-inf\n"));
    }

    #[test]
    fn a_short_row_is_an_error_that_says_which() {
        let table = Table {
            columns: vec![Column::default(); 2],
            rows: vec![vec![1.0, 2.0], vec![3.0]],
        };
        assert!(matches!(
            table.csv(),
            Err(ReportError::Row {
                row: 1,
                found: 1,
                expected: 2
            })
        ));
    }
}
