//! Columns of NumPy archives (`.npz`), as `numpy.savez` and this crate write them.

use std::collections::BTreeMap;
use std::io::{Cursor, Read as _};
use thiserror::Error;
use zip::ZipArchive;

/// Why no columns can be read from an archive.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum NpzError {
    /// The file is no archive.
    #[error("this is no NumPy archive: {reason}")]
    NotAnArchive {
        /// The message of the archive reader.
        reason: String,
    },
    /// An array is compressed.
    #[error(
        "the array `{name}` is compressed: write the file with numpy.savez, not savez_compressed"
    )]
    Compressed {
        /// Its name.
        name: String,
    },
    /// An array has another form.
    #[error("the array `{name}` is no row of 64-bit numbers (`<f8`)")]
    Form {
        /// Its name.
        name: String,
    },
}

/// What an array holds.
enum Array {
    Numbers(Vec<f64>),
    Words(Vec<String>),
}

/// The named columns of an archive, with units in brackets if it has the arrays `columns` and `units`.
///
/// # Errors
/// [`NpzError`]: no archive, a compressed array, an array that is no row of numbers.
pub fn npz_columns(bytes: &[u8]) -> Result<Vec<(String, Vec<f64>)>, NpzError> {
    let refused = |e: &dyn std::fmt::Display| NpzError::NotAnArchive {
        reason: e.to_string(),
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| refused(&e))?;
    let mut columns = Vec::new();
    let mut words = BTreeMap::new();
    for k in 0..archive.len() {
        let file = archive.by_index_raw(k).map_err(|e| refused(&e))?;
        let name = file
            .name()
            .map_err(|e| refused(&e))?
            .trim_end_matches(".npy")
            .to_owned();
        if file.compression() != zip::CompressionMethod::Stored {
            return Err(NpzError::Compressed { name });
        }
        let mut content = Vec::new();
        let mut file = file;
        file.read_to_end(&mut content).map_err(|e| refused(&e))?;
        match array(&content) {
            Some(Array::Numbers(values)) => columns.push((name, values)),
            Some(Array::Words(list)) => {
                words.insert(name, list);
            }
            None => return Err(NpzError::Form { name }),
        }
    }
    if let (Some(names), Some(units)) = (words.get("columns"), words.get("units")) {
        let order: BTreeMap<&str, (usize, &str)> = names
            .iter()
            .zip(units)
            .enumerate()
            .map(|(k, (name, unit))| (name.as_str(), (k, unit.as_str())))
            .collect();
        columns.sort_by_key(|(name, _)| order.get(name.as_str()).map_or(usize::MAX, |(k, _)| *k));
        for (name, _) in &mut columns {
            if let Some((_, unit)) = order
                .get(name.as_str())
                .filter(|(_, unit)| !unit.is_empty())
            {
                *name = format!("{name} [{unit}]");
            }
        }
    }
    Ok(columns)
}

/// An array of format 1 or 2: one dimension of `<f8`, or of words.
fn array(bytes: &[u8]) -> Option<Array> {
    if bytes.get(..6)? != b"\x93NUMPY" {
        return None;
    }
    let (length, start) = match bytes.get(6)? {
        1 => (
            usize::from(u16::from_le_bytes(bytes.get(8..10)?.try_into().ok()?)),
            10,
        ),
        _ => (
            u32::from_le_bytes(bytes.get(8..12)?.try_into().ok()?) as usize,
            12,
        ),
    };
    let header = std::str::from_utf8(bytes.get(start..start + length)?).ok()?;
    let data = bytes.get(start + length..)?;
    let shape = header.split_once("'shape': (")?.1.split_once(')')?.0;
    let mut sizes = shape
        .split(',')
        .map(str::trim)
        .filter(|size| !size.is_empty());
    let count: usize = sizes.next()?.parse().ok()?;
    // A column of a matrix of one column is one, too.
    if sizes.any(|size| size != "1") {
        return None;
    }
    let kind = header.split_once("'descr': '")?.1.split_once('\'')?.0;
    if kind == "<f8" {
        let (values, _) = data.as_chunks::<8>();
        let values = values.iter().map(|bits| f64::from_le_bytes(*bits));
        return (data.len() == 8 * count).then(|| Array::Numbers(values.collect()));
    }
    let width: usize = kind.strip_prefix("<U")?.parse().ok()?;
    let word = |bytes: &[u8]| {
        let (characters, _) = bytes.as_chunks::<4>();
        let characters = characters
            .iter()
            .filter_map(|c| char::from_u32(u32::from_le_bytes(*c)));
        characters.filter(|c| *c != '\0').collect::<String>()
    };
    match width {
        0 => Some(Array::Words(vec![String::new(); count])),
        _ => Some(Array::Words(data.chunks(4 * width).map(word).collect())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TableExport as _;
    use dwell_findings::{Column, Table};

    #[test]
    fn what_is_written_comes_back() {
        let table = Table {
            columns: vec![
                Column::new("phi", "rad"),
                Column::new("m", "kg m2"),
                Column::new("ratio", ""),
            ],
            rows: vec![
                vec![0.1, 2.0, -1.0 / 3.0],
                vec![0.2, 3.0, f64::MIN_POSITIVE],
            ],
        };
        let bytes = table.npz().expect("an archive");
        let columns = npz_columns(&bytes).expect("columns");
        assert_eq!(columns[0], ("phi [rad]".to_owned(), vec![0.1, 0.2]));
        assert_eq!(
            columns[2],
            ("ratio".to_owned(), vec![-1.0 / 3.0, f64::MIN_POSITIVE])
        );
        assert!(matches!(
            npz_columns(b"t,phi\n"),
            Err(NpzError::NotAnArchive { .. })
        ));
    }
}
