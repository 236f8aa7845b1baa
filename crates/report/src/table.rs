//! Tables of numbers as CSV.

use crate::error::ReportError;
use std::fmt::Write as _;

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
    /// The rows, each as long as `columns`; NaN where there is no value.
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    /// The table as CSV text: a header `name [unit]`, then the rows with the fewest digits that give back every bit.
    /// A NaN is an empty field; what is infinite is written `inf` or `-inf`.
    ///
    /// # Errors
    ///
    /// [`ReportError::Row`] if a row is not as long as the header; [`ReportError::Csv`] if the writer refuses.
    pub fn csv(&self) -> Result<String, ReportError> {
        self.check_rows()?;
        let mut writer = csv::Writer::from_writer(Vec::new());
        let header = |c: &Column| {
            if c.unit.is_empty() {
                c.name.clone()
            } else {
                format!("{} [{}]", c.name, c.unit)
            }
        };
        writer.write_record(self.columns.iter().map(header))?;
        // One field for all: a string for each would be most of the time of a large table.
        let mut field = String::new();
        for row in &self.rows {
            for value in row {
                field.clear();
                if !value.is_nan() {
                    // `Debug` of a float is its shortest exact form, with an exponent where that is shorter. It is
                    // written to a string, which never refuses.
                    let _ = write!(field, "{value:?}");
                }
                writer.write_field(&field)?;
            }
            writer.write_record(None::<&[u8]>)?;
        }
        let bytes = writer
            .into_inner()
            .map_err(|e| csv::Error::from(e.into_error()))?;
        // Only strings have been written.
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// Whether every row is as long as the header.
    pub(crate) fn check_rows(&self) -> Result<(), ReportError> {
        let expected = self.columns.len();
        let wrong = self.rows.iter().position(|row| row.len() != expected);
        wrong.map_or(Ok(()), |row| {
            Err(ReportError::Row {
                row,
                found: self.rows[row].len(),
                expected,
            })
        })
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
    fn a_nan_is_an_empty_field_and_infinity_is_named() {
        let table = Table {
            columns: vec![Column::new("x", "m"); 4],
            rows: vec![
                vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -f64::NAN],
                vec![1.0, f64::NAN, 2.5, 0.0],
            ],
        };
        let text = table.csv().unwrap();
        assert_eq!(text, "x [m],x [m],x [m],x [m]\n,inf,-inf,\n1.0,,2.5,0.0\n");
    }

    #[test]
    fn an_absent_value_of_a_lone_column_still_is_a_row() {
        let table = Table {
            columns: vec![Column::new("x", "m")],
            rows: vec![vec![1.0], vec![f64::NAN], vec![3.0]],
        };
        let text = table.csv().unwrap();
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        assert_eq!(reader.records().count(), 3, "{text}");
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
