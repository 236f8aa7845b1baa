//! Readers of written tables: CSV and NumPy's archives by code that shares nothing with their writers, Parquet files by the crate that wrote them (`just designs`
//! reads them by other programs).

use super::rows::Rows;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

/// The columns of a CSV file without quotes inside numbers; the units in brackets are not part of the names.
pub(crate) fn csv_rows(text: &str) -> Option<Rows> {
    let mut lines = text.lines();
    let names = fields(lines.next()?);
    let names: Vec<&str> = names
        .iter()
        .map(|head| head.split(" [").next().unwrap_or("").trim())
        .collect();
    let mut columns = vec![Vec::new(); names.len()];
    for line in lines.filter(|line| !line.is_empty()) {
        let values: Vec<&str> = line.split(',').collect();
        if values.len() != names.len() {
            return None;
        }
        for (column, value) in columns.iter_mut().zip(values) {
            let value = value.trim();
            column.push(if value.is_empty() {
                f64::NAN
            } else {
                value.parse().ok()?
            });
        }
    }
    let count = columns.first().map_or(0, Vec::len);
    let columns: BTreeMap<String, Vec<f64>> = names
        .iter()
        .map(|name| (*name).to_owned())
        .zip(columns)
        .collect();
    Some(Rows { columns, count })
}

/// Adds the columns of numbers of a Parquet file to those of the files before it; null values become NaN.
pub(crate) fn add_parquet_rows(path: &Path, rows: &mut Rows) -> Result<(), ParquetError> {
    let reader = SerializedFileReader::new(File::open(path)?)?;
    for row in reader.get_row_iter(None)? {
        for (name, cell) in row?.get_column_iter() {
            let value = match cell {
                Field::Double(value) => *value,
                Field::Long(value) => *value as f64,
                _ => f64::NAN,
            };
            let name = name.split(" [").next().unwrap_or("").to_owned();
            rows.columns.entry(name).or_default().push(value);
        }
        rows.count += 1;
    }
    Ok(())
}

/// The headings of the columns; a heading with a comma is quoted.
fn fields(line: &str) -> Vec<String> {
    let mut all = vec![String::new()];
    let mut in_quotes = false;
    for c in line.chars() {
        match (c, all.last_mut()) {
            ('"', _) => in_quotes = !in_quotes,
            (',', _) if !in_quotes => all.push(String::new()),
            (c, Some(field)) => field.push(c),
            (_, None) => {}
        }
    }
    all
}

fn number(bytes: &[u8], at: usize, width: usize) -> Option<usize> {
    let bytes = bytes.get(at..at + width)?;
    Some(
        bytes
            .iter()
            .rev()
            .fold(0, |sum, byte| (sum << 8) | usize::from(*byte)),
    )
}

/// The arrays of an archive whose members are stored without compression, by its central directory.
pub(crate) fn npz_rows(bytes: &[u8]) -> Option<Rows> {
    let end = bytes.windows(4).rposition(|w| w == [b'P', b'K', 5, 6])?;
    let members = number(bytes, end + 10, 2)?;
    let mut at = number(bytes, end + 16, 4)?;
    let mut rows = Rows::default();
    for _ in 0..members {
        let [method, size] = [number(bytes, at + 10, 2)?, number(bytes, at + 24, 4)?];
        let lengths = [28, 30, 32].map(|field| number(bytes, at + field, 2));
        let [name, extra, comment] = [lengths[0]?, lengths[1]?, lengths[2]?];
        let local = number(bytes, at + 42, 4)?;
        let file = std::str::from_utf8(bytes.get(at + 46..at + 46 + name)?).ok()?;
        let data = local + 30 + number(bytes, local + 26, 2)? + number(bytes, local + 28, 2)?;
        if method != 0 {
            return None;
        }
        let member = bytes.get(data..data + size)?;
        let column = file.strip_suffix(".npy");
        // What is no array of numbers, such as a text, is no column.
        if let (Some(column), Some(values)) = (column, array(member)) {
            rows.count = rows.count.max(values.len());
            rows.columns.insert(column.to_owned(), values);
        }
        at += 46 + name + extra + comment;
    }
    Some(rows)
}

/// The numbers of a `.npy` array of 64-bit numbers.
fn array(bytes: &[u8]) -> Option<Vec<f64>> {
    let (head, data) = described(bytes)?;
    if !head.contains("'<f8'") {
        return None;
    }
    let (values, _) = data.as_chunks::<8>();
    Some(values.iter().map(|b| f64::from_le_bytes(*b)).collect())
}

/// The header of a `.npy` array, and its data.
fn described(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let head = if *bytes.get(6)? == 1 {
        10 + number(bytes, 8, 2)?
    } else {
        12 + number(bytes, 8, 4)?
    };
    let text = std::str::from_utf8(bytes.get(10..head)?).ok()?;
    Some((text, bytes.get(head..)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_without_units() {
        let rows = csv_rows("t [s],\"a, b\" [m],c\n0,1.5,\n1,2.5,3\n").expect("a table");
        assert_eq!(
            (rows.count, rows.get(1, "a, b"), rows.get(1, "c")),
            (2, Some(2.5), Some(3.0))
        );
        assert!(rows.get(0, "c").is_some_and(f64::is_nan));
        assert_eq!(csv_rows("a,b\n1\n"), None);
        assert_eq!(csv_rows("a\nx\n"), None);
    }
}
