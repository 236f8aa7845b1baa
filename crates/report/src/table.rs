//! Tables of numbers as CSV.

use crate::error::{ReportError, check_rows};
use crate::npz::table_npz;
pub use dwell_findings::{Column, Table};
use rayon::prelude::*;
use std::fmt::Write as _;

/// Rows whose lines are made at once.
const ROWS_AT_ONCE: usize = 256;

/// A file format of tables. Writers take a list of formats, so a new format is added here and in
/// [`Files::add_table`](crate::Files::add_table).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableFormat {
    /// Text, by [`TableExport::csv`].
    Csv,
    /// A NumPy archive, by [`TableExport::npz`].
    Npz,
}

impl TableFormat {
    /// Every format.
    pub const ALL: [Self; 2] = [Self::Csv, Self::Npz];

    /// The extension of its files, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Npz => "npz",
        }
    }
}

/// The file formats of a [`Table`].
pub trait TableExport {
    /// The table as CSV text: a header `name [unit]`, then the rows with the fewest digits that restore every bit.
    /// NaN is an empty field; infinite numbers are `inf` and `-inf`.
    ///
    /// # Errors
    ///
    /// [`ReportError::Row`] if a row is not as long as the header; [`ReportError::Csv`] if the writer fails.
    fn csv(&self) -> Result<String, ReportError>;

    /// The table as a NumPy archive (`.npz`, arrays of format 1.0), which `numpy.load` reads bit for bit.
    ///
    /// Every column is an array of its own, `<f8` of shape (rows,), under its name. The array `columns` holds these
    /// keys in the order of the table, and `units` their units: `dict(zip(z["columns"], z["units"]))`.
    ///
    /// A key is also a file name within the archive: characters that some systems reject in file names (`/ \ : * ? " < > |`
    /// and control characters) become `_`, and repeated names get the suffix `_2`, `_3` … A table gives the
    /// same bytes on every machine.
    ///
    /// # Errors
    ///
    /// [`ReportError::Row`] if a row is not as long as the header; [`ReportError::Npz`] if the archive cannot be written, as with a
    /// name of more than 65 000 bytes.
    fn npz(&self) -> Result<Vec<u8>, ReportError>;
}

impl TableExport for Table {
    fn csv(&self) -> Result<String, ReportError> {
        check_rows(&self.rows, self.columns.len())?;
        let mut text = csv_header(&self.columns)?;
        csv_lines(&self.rows).iter().for_each(|lines| text += lines);
        Ok(text)
    }

    fn npz(&self) -> Result<Vec<u8>, ReportError> {
        table_npz(self)
    }
}

/// The header of a table as CSV.
pub(crate) fn csv_header(columns: &[Column]) -> Result<String, ReportError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header = |c: &Column| match c.unit.as_str() {
        "" => c.name.clone(),
        unit => format!("{} [{unit}]", c.name),
    };
    writer.write_record(columns.iter().map(header))?;
    let bytes = writer
        .into_inner()
        .map_err(|e| csv::Error::from(e.into_error()))?;
    // Only strings have been written.
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Rows as CSV, some lines at a time, made on all cores: most of the time of a large table is that of its digits.
pub(crate) fn csv_lines(rows: &[Vec<f64>]) -> Vec<String> {
    let lines = |rows: &[Vec<f64>]| {
        let (mut text, mut digits) = (String::new(), zmij::Buffer::new());
        for row in rows {
            for (k, value) in row.iter().enumerate() {
                if k > 0 {
                    text.push(',');
                }
                if !value.is_nan() {
                    push_number(&mut text, &mut digits, *value);
                }
            }
            if matches!(row.as_slice(), [only] if only.is_nan()) {
                // An empty line would not count as a row.
                text += "\"\"";
            }
            text.push('\n');
        }
        text
    };
    rows.par_chunks(ROWS_AT_ONCE).map(lines).collect()
}

/// Adds the shortest exact form of a number: with an exponent where `Debug` writes one.
fn push_number(text: &mut String, digits: &mut zmij::Buffer, value: f64) {
    // Outside this range the two differ in where an exponent begins.
    if (1e-4..1e16).contains(&value.abs()) {
        *text += digits.format_finite(value);
    } else {
        // A string never refuses.
        let _ = write!(text, "{value:?}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// As many digits as `Debug` writes give back every bit, of numbers of all sizes and of short ones. Of two last digits that are
        /// equally near, the even one is taken.
        #[test]
        fn no_number_has_more_digits_than_it_needs(bits: u64, short in -100_000..100_000_i32, exponent in -8..18_i32) {
            let (mut text, mut digits) = (String::new(), zmij::Buffer::new());
            let short = f64::from(short) * 10_f64.powi(exponent);
            let near = f64::from_bits((bits >> 12) | ((1023 - 20 + (bits % 80)) << 52));
            for value in [f64::from_bits(bits), short, near, 1e-4, 1e16, 1e15] {
                text.clear();
                push_number(&mut text, &mut digits, value);
                prop_assert_eq!(text.len(), format!("{value:?}").len(), "{}", &text);
                let read: f64 = text.parse().unwrap();
                prop_assert!(read.to_bits() == value.to_bits() || value.is_nan(), "{}", &text);
            }
        }
    }

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
