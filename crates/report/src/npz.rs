//! Tables of numbers as NumPy archives.

use crate::error::{ReportError, check_rows};
use dwell_findings::{Column, Table};
use std::collections::BTreeSet;
use std::io::{self, Cursor, Seek, Write};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

/// Keys of the two arrays that describe the others.
const COLUMNS: &str = "columns";
const UNITS: &str = "units";
/// The data of an array begin at a multiple of this.
const ALIGNMENT: usize = 64;

/// An array of an archive.
#[derive(Debug, Clone, PartialEq)]
pub enum Array {
    /// Rows with equal numbers of columns.
    Matrix {
        /// Number of columns.
        columns: usize,
        /// The rows.
        rows: Vec<Vec<f64>>,
    },
    /// A list of strings.
    Strings(Vec<String>),
}

/// Named arrays as a NumPy archive (`.npz`): matrices are `<f8` of shape (rows, columns), words `<U`. Names become
/// keys as those of [`TableExport::npz`](crate::TableExport::npz).
///
/// # Errors
///
/// [`ReportError::Row`] if a row of a matrix has a wrong number of columns; [`ReportError::Npz`] if the archive cannot be written.
pub fn npz(arrays: &[(&str, Array)]) -> Result<Vec<u8>, ReportError> {
    let bytes = |array: &Array| -> Result<_, ReportError> {
        Ok(match array {
            Array::Strings(list) => string_array(list),
            Array::Matrix { columns, rows } => {
                check_rows(rows, *columns)?;
                let shape = format!("({}, {columns})", rows.len());
                number_array(&shape, rows.iter().flatten())
            }
        })
    };
    let arrays = arrays
        .iter()
        .map(|(name, array)| Ok((file_name(name), bytes(array)?)));
    Ok(archive(Cursor::new(Vec::new()), arrays)?.into_inner())
}

/// Arrays under their keys, in an archive that is written to `out`.
fn archive<W: Write + Seek>(
    out: W,
    arrays: impl Iterator<Item = Result<(String, Vec<u8>), ReportError>>,
) -> Result<W, ReportError> {
    let mut archive = ZipWriter::new(out);
    for array in arrays {
        let (key, bytes) = array?;
        archive.start_file(format!("{key}.npy"), options())?;
        archive.write_all(&bytes).map_err(ZipError::Io)?;
    }
    Ok(archive.finish()?)
}

/// See [`TableExport::npz`](crate::TableExport::npz).
pub(crate) fn table_npz(table: &Table) -> Result<Vec<u8>, ReportError> {
    check_rows(&table.rows, table.columns.len())?;
    let values = |k: usize| Ok(table.rows.iter().map(|row| row[k]).collect());
    let out = Cursor::new(Vec::new());
    Ok(table_archive(out, &table.columns, table.rows.len(), &values)?.into_inner())
}

/// A table of so many rows as an archive, written to `out` column by column.
pub(crate) fn table_archive<W: Write + Seek>(
    out: W,
    columns: &[Column],
    rows: usize,
    values: &dyn Fn(usize) -> io::Result<Vec<f64>>,
) -> Result<W, ReportError> {
    let keys = array_keys(columns);
    let units: Vec<&str> = columns.iter().map(|c| c.unit.as_str()).collect();
    let described = [
        (COLUMNS.to_owned(), string_array(&keys)),
        (UNITS.to_owned(), string_array(&units)),
    ];
    let shape = format!("({rows},)");
    let column = |i: usize| {
        let values = values(i).map_err(ZipError::Io)?;
        Ok::<_, ReportError>(number_array(&shape, values.iter()))
    };
    let numbers = keys
        .into_iter()
        .enumerate()
        .map(|(i, key)| Ok((key, column(i)?)));
    archive(out, numbers.chain(described.map(Ok)))
}

/// The columns' names as keys: file names, and each but once.
fn array_keys(columns: &[Column]) -> Vec<String> {
    let mut used: BTreeSet<String> = [COLUMNS, UNITS].map(str::to_owned).into();
    let mut unused = |name: &str| {
        let numbered = (2_usize..).map(|n| format!("{name}_{n}"));
        let mut all = std::iter::once(name.to_owned()).chain(numbered);
        let key = all.find(|key| !used.contains(key)).unwrap_or_default();
        used.insert(key.clone());
        key
    };
    columns
        .iter()
        .map(|c| unused(&file_name(&c.name)))
        .collect()
}

/// The name with `_` for what a file name cannot hold.
fn file_name(name: &str) -> String {
    let refused = |c: char| c.is_control() || r#"/\:*?"<>|"#.contains(c);
    match name {
        "" => "_".to_owned(),
        name => name.replace(refused, "_"),
    }
}

/// Options independent of date and machine. Without compression, because the digits of measured numbers hardly compress.
fn options() -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .system(System::Unix)
        .unix_permissions(0o644)
}

fn number_array<'v>(shape: &str, values: impl Iterator<Item = &'v f64>) -> Vec<u8> {
    let mut array = header("<f8", shape);
    values.for_each(|v| array.extend(v.to_le_bytes()));
    array
}

/// Words as four bytes a character, padded with zeros to the longest.
fn string_array(words: &[impl AsRef<str>]) -> Vec<u8> {
    let width = words
        .iter()
        .map(|w| w.as_ref().chars().count())
        .max()
        .unwrap_or(0)
        .max(1);
    let mut array = header(&format!("<U{width}"), &format!("({},)", words.len()));
    for word in words {
        let end = array.len() + 4 * width;
        word.as_ref()
            .chars()
            .for_each(|c| array.extend(u32::from(c).to_le_bytes()));
        array.resize(end, 0);
    }
    array
}

/// What stands before the data of an array, padded with blanks.
///
/// Source: NumPy Enhancement Proposal 1, "A simple file format for NumPy arrays", format version 1.0.
fn header(dtype: &str, shape: &str) -> Vec<u8> {
    let text = format!("{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}");
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    let before = header.len() + 2;
    let whole = (before + text.len() + 1).next_multiple_of(ALIGNMENT);
    let text = format!("{text:width$}\n", width = whole - before - 1);
    // At most two numbers of twenty digits stand in it.
    header.extend((text.len() as u16).to_le_bytes());
    header.extend(text.as_bytes());
    header
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::TableExport as _;
    use std::io::Read as _;
    use zip::ZipArchive;

    #[test]
    fn a_matrix_is_stored_row_by_row_with_its_shape() {
        let rows = vec![vec![1.0, 2.0, 3.0], vec![4.0, 5.0, -0.0]];
        let matrix = |columns, rows| super::Array::Matrix { columns, rows };
        let none = matrix(0, vec![Vec::new(); 2]);
        let states = super::Array::Strings(vec!["phi".to_owned()]);
        let bytes = npz(&[
            ("A", matrix(3, rows.clone())),
            ("B", none),
            ("states", states),
        ]);
        let mut archive = ZipArchive::new(Cursor::new(bytes.unwrap())).unwrap();
        let mut read = |name: &str| {
            let mut bytes = Vec::new();
            archive
                .by_name(name)
                .unwrap()
                .read_to_end(&mut bytes)
                .unwrap();
            let end = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
            assert_eq!(end % 64, 0);
            (
                String::from_utf8(bytes[10..end].to_vec()).unwrap(),
                bytes[end..].to_vec(),
            )
        };
        let (header, data) = read("A.npy");
        assert!(header.contains("'shape': (2, 3)"), "{header}");
        let all: Vec<u8> = rows
            .iter()
            .flatten()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        assert_eq!(data, all);
        let (header, data) = read("B.npy");
        assert!(
            header.contains("'shape': (2, 0)") && data.is_empty(),
            "{header}"
        );
        assert!(read("states.npy").0.contains("'shape': (1,)"));
        let short = npz(&[("A", matrix(3, vec![vec![1.0]]))]);
        assert!(matches!(
            short,
            Err(ReportError::Row {
                row: 0,
                found: 1,
                expected: 3
            })
        ));
    }

    /// An array read back by the rules of its format: kind, length and data.
    struct Array {
        kind: String,
        count: usize,
        data: Vec<u8>,
    }

    impl Array {
        fn read(bytes: &[u8]) -> Self {
            assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
            let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
            let start = 10 + length;
            assert_eq!(start % 64, 0, "data begin at {start}");
            let header = std::str::from_utf8(&bytes[10..start]).unwrap();
            assert!(header.ends_with('\n') && header.contains("'fortran_order': False"));
            let between = |from: &str, to: &str| {
                let rest = header.split_once(from).unwrap().1;
                rest.split_once(to).unwrap().0.to_owned()
            };
            Self {
                kind: between("'descr': '", "'"),
                count: between("'shape': (", ",)").parse().unwrap(),
                data: bytes[start..].to_vec(),
            }
        }

        fn bits(&self) -> Vec<u64> {
            assert_eq!(
                (self.kind.as_str(), self.data.len()),
                ("<f8", 8 * self.count)
            );
            let eight = self.data.chunks_exact(8);
            eight
                .map(|b| u64::from_le_bytes(b.try_into().unwrap()))
                .collect()
        }

        fn words(&self) -> Vec<String> {
            let width: usize = self.kind.strip_prefix("<U").unwrap().parse().unwrap();
            assert_eq!(self.data.len(), 4 * width * self.count);
            let letter = |b: &[u8]| char::from_u32(u32::from_le_bytes(b.try_into().unwrap()));
            let word = |w: &[u8]| {
                w.chunks_exact(4)
                    .map(|b| letter(b).unwrap())
                    .collect::<String>()
            };
            let all = self.data.chunks_exact(4 * width);
            all.map(|w| word(w).trim_end_matches('\0').to_owned())
                .collect()
        }
    }

    /// Entries in their order.
    fn entries(bytes: &[u8]) -> Vec<(String, Array)> {
        let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
        let count = archive.len();
        let entry = |place: usize| {
            let mut file = archive.by_index(place).unwrap();
            assert_eq!(file.compression(), CompressionMethod::Stored);
            let name = file.name().unwrap().into_owned();
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes).unwrap();
            (name, Array::read(&bytes))
        };
        (0..count).map(entry).collect()
    }

    fn named(names: &[&str]) -> Table {
        Table {
            columns: names.iter().map(|n| Column::new(*n, "")).collect(),
            rows: vec![(0..names.len()).map(|i| i as f64).collect()],
        }
    }

    #[test]
    fn every_bit_of_every_column_comes_back_in_order() {
        let signalling = f64::from_bits(0x7ff0_0000_0000_0001);
        let rows = [
            [0.1 + 0.2, -0.0, 1e-310],
            [f64::MAX, signalling, -f64::NAN],
            [f64::INFINITY, f64::MIN_POSITIVE, 1.0 / 3.0],
            [-6.02e23, 5.419_662_677_064_27, f64::NEG_INFINITY],
        ];
        let table = Table {
            columns: vec![
                Column::new("φ", "rad"),
                Column::new("slider.P.x", "m"),
                Column::new("½ m′", "kg m²/rad"),
            ],
            rows: rows.map(|r| r.to_vec()).to_vec(),
        };
        let found = entries(&table.npz().unwrap());
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names,
            [
                "φ.npy",
                "slider.P.x.npy",
                "½ m′.npy",
                "columns.npy",
                "units.npy"
            ]
        );
        for (place, (name, array)) in found[..3].iter().enumerate() {
            let expected = rows.map(|row| row[place].to_bits());
            assert_eq!(array.bits(), expected, "{name}");
        }
        assert_eq!(found[3].1.words(), ["φ", "slider.P.x", "½ m′"]);
        assert_eq!(found[4].1.words(), ["rad", "m", "kg m²/rad"]);
    }

    #[test]
    fn the_same_table_makes_the_same_bytes_and_the_dates_are_fixed() {
        let bytes = named(&["a", "b"]).npz().unwrap();
        assert_eq!(bytes, named(&["a", "b"]).npz().unwrap());
        let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
        let date = archive.by_index(0).unwrap().last_modified().unwrap();
        assert_eq!((date.year(), date.month(), date.day()), (1980, 1, 1));
    }

    #[test]
    fn keys_are_file_names_and_differ() {
        let table = named(&["a/b", "a:b", "x", "x", "x_2", "columns", "", "..", "R [1]"]);
        let found = entries(&table.npz().unwrap());
        let keys = [
            "a_b",
            "a_b_2",
            "x",
            "x_2",
            "x_2_2",
            "columns_2",
            "_",
            "..",
            "R [1]",
        ];
        for (place, key) in keys.iter().enumerate() {
            assert_eq!(found[place].0, format!("{key}.npy"));
            assert_eq!(found[place].1.bits(), [(place as f64).to_bits()]);
        }
        assert_eq!(found[keys.len()].1.words(), keys);
    }

    #[test]
    fn a_table_without_rows_or_columns_is_an_archive() {
        let mut table = named(&["a"]);
        table.rows.clear();
        assert_eq!(entries(&table.npz().unwrap())[0].1.count, 0);
        let nothing = entries(&Table::default().npz().unwrap());
        assert_eq!(nothing.len(), 2);
        assert!(nothing.iter().all(|(_, array)| array.count == 0));
    }

    #[test]
    fn headers_of_any_length_are_aligned() {
        for count in (0..25).map(|digits| 10_usize.saturating_pow(digits)) {
            let header = header("<f8", &format!("({count},)"));
            assert_eq!(header.len() % 64, 0);
            assert_eq!(usize::from(header[8]), header.len() - 10);
        }
    }

    #[test]
    fn a_short_row_is_an_error_that_says_which() {
        let mut table = named(&["a", "b"]);
        table.rows.push(vec![1.0]);
        assert!(matches!(
            table.npz(),
            Err(ReportError::Row {
                row: 1,
                found: 1,
                expected: 2
            })
        ));
    }
}
