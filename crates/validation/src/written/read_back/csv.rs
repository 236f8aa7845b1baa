//! Comma-separated values (RFC 4180): a header of `name [unit]`, then rows.

use super::table::{WrittenColumn, WrittenTable};

/// The table of a text.
///
/// # Errors
/// A row that has not as many cells as the header, or a quote that is not closed.
pub(crate) fn read_csv(text: &str) -> Result<WrittenTable, String> {
    let mut records = records(text)?.into_iter();
    let header = records.next().ok_or("a CSV file without a header")?;
    let mut columns: Vec<WrittenColumn> = header.iter().map(|cell| heading(cell)).collect();
    let mut rows = 0;
    for record in records {
        rows += 1;
        if record.len() != columns.len() {
            let (found, wanted) = (record.len(), columns.len());
            return Err(format!("row {rows} has {found} cells, the header {wanted}"));
        }
        for (column, cell) in columns.iter_mut().zip(record) {
            column.numbers.push(cell.parse().unwrap_or(f64::NAN));
            column.words.push(cell);
        }
    }
    Ok(WrittenTable { columns, rows })
}

/// Name and unit of `name [unit]`.
fn heading(cell: &str) -> WrittenColumn {
    let parts = cell.strip_suffix(']').and_then(|c| c.rsplit_once(" ["));
    let (name, unit) = parts.unwrap_or((cell, ""));
    WrittenColumn {
        name: name.to_owned(),
        unit: unit.to_owned(),
        ..WrittenColumn::default()
    }
}

/// The cells of each line, with the quotes of RFC 4180 taken off.
fn records(text: &str) -> Result<Vec<Vec<String>>, String> {
    let (mut records, mut record, mut cell) = (Vec::new(), Vec::new(), String::new());
    let mut quoted = false;
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match (letter, quoted) {
            ('"', true) if letters.peek() == Some(&'"') => {
                letters.next();
                cell.push('"');
            }
            ('"', _) => quoted = !quoted,
            (',', false) => record.push(std::mem::take(&mut cell)),
            ('\r', false) => {}
            ('\n', false) => {
                record.push(std::mem::take(&mut cell));
                records.push(std::mem::take(&mut record));
            }
            (letter, _) => cell.push(letter),
        }
    }
    if quoted {
        return Err("a quote is not closed".to_owned());
    }
    if !cell.is_empty() || !record.is_empty() {
        record.push(cell);
        records.push(record);
    }
    Ok(records)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_units_numbers_and_words_are_read() {
        let text =
            "t [s],phi [rad],name,\"a, b [N m]\"\n0.5,-1e-3,stop,\n1.5,2,\"said \"\"go\"\"\",7\n";
        let table = read_csv(text).unwrap();
        assert_eq!(table.rows, 2);
        assert_eq!(table.required("phi", "rad").unwrap(), [-1e-3, 2.0]);
        assert_eq!(table.find("name").unwrap().words, ["stop", "said \"go\""]);
        let last = table.required("a, b", "N m").unwrap();
        assert!(last[0].is_nan() && last[1] == 7.0);
        let error = table.required("phi", "deg").unwrap_err();
        assert_eq!(error, "column `phi` is in `rad`, not in `deg`");
        assert!(table.numbers("psi").is_none());
    }

    #[test]
    fn a_row_of_another_length_is_an_error() {
        let error = read_csv("a,b\n1,2\n3\n").unwrap_err();
        assert_eq!(error, "row 2 has 1 cells, the header 2");
        assert!(read_csv("a\n\"b\n").is_err());
        assert!(read_csv("").is_err());
    }
}
