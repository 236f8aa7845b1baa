//! NumPy archives (`.npz`): a ZIP archive of stored `.npy` arrays, found through its central directory.
//!
//! Sources: PKWARE, *APPNOTE.TXT*, 4.3; NumPy Enhancement Proposal 1, "A simple file format for NumPy arrays".

use std::collections::BTreeMap;

/// Marks of the end of the central directory, and of one of its entries.
const END: [u8; 4] = *b"PK\x05\x06";
const ENTRY: [u8; 4] = *b"PK\x01\x02";

/// An array as it was read.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct WrittenArray {
    pub(crate) shape: Vec<usize>,
    /// Row by row; empty for words.
    pub(crate) numbers: Vec<f64>,
    /// Empty for numbers.
    pub(crate) words: Vec<String>,
}

/// The arrays by name.
///
/// # Errors
/// That it is no such archive, or an array of another type.
pub(crate) fn read_npz(bytes: &[u8]) -> Result<BTreeMap<String, WrittenArray>, String> {
    let cut = || "the archive is cut off".to_owned();
    let end = (0..bytes.len().saturating_sub(21))
        .rev()
        .find(|&k| bytes[k..].starts_with(&END));
    let end = end.ok_or("no ZIP archive")?;
    let count = number(bytes, end + 10, 2).ok_or_else(cut)?;
    let mut at = number(bytes, end + 16, 4).ok_or_else(cut)?;
    let mut arrays = BTreeMap::new();
    for _ in 0..count {
        let field = |offset: usize, size: usize| number(bytes, at + offset, size).ok_or_else(cut);
        if !bytes.get(at..).is_some_and(|b| b.starts_with(&ENTRY)) {
            return Err("the archive has no entry where its directory says".to_owned());
        }
        if field(10, 2)? != 0 {
            return Err("an array is compressed".to_owned());
        }
        let (size, local) = (field(24, 4)?, field(42, 4)?);
        let name_length = field(28, 2)?;
        let name = bytes.get(at + 46..at + 46 + name_length).ok_or_else(cut)?;
        let name = String::from_utf8_lossy(name);
        let name = name.strip_suffix(".npy").unwrap_or(&name).to_owned();
        let skip = |offset| number(bytes, local + offset, 2).ok_or_else(cut);
        let start = local + 30 + skip(26)? + skip(28)?;
        let data = bytes.get(start..start + size).ok_or_else(cut)?;
        let array = array(data).map_err(|why| format!("array `{name}`: {why}"))?;
        arrays.insert(name, array);
        at += 46 + name_length + field(30, 2)? + field(32, 2)?;
    }
    Ok(arrays)
}

/// A whole number of some bytes, the lowest first.
fn number(bytes: &[u8], at: usize, size: usize) -> Option<usize> {
    let bytes = bytes.get(at..at + size)?;
    Some(bytes.iter().rev().fold(0, |n, b| n << 8 | usize::from(*b)))
}

/// An `.npy` file of version 1 or 2.
fn array(bytes: &[u8]) -> Result<WrittenArray, &'static str> {
    let cut = "it is cut off";
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err("it is no NumPy array");
    }
    let size = if bytes.get(6) == Some(&1) { 2 } else { 4 };
    let length = number(bytes, 8, size).ok_or(cut)?;
    let header = bytes.get(8 + size..8 + size + length).ok_or(cut)?;
    let header = String::from_utf8_lossy(header);
    let data = bytes.get(8 + size + length..).ok_or(cut)?;
    let shape = between(&header, "'shape': (", ")").ok_or("it has no shape")?;
    let shape: Vec<usize> = shape
        .split(',')
        .filter_map(|part| part.trim().parse().ok())
        .collect();
    let kind = between(&header, "'descr': '", "'").ok_or("it has no type")?;
    let count: usize = shape.iter().product();
    let mut read = WrittenArray {
        shape,
        ..WrittenArray::default()
    };
    if kind == "<f8" {
        let (cells, _) = data.as_chunks::<8>();
        read.numbers = cells.iter().map(|b| f64::from_le_bytes(*b)).collect();
    } else if let Some(width) = kind.strip_prefix("<U").and_then(|w| w.parse().ok()) {
        let width: usize = width;
        let (letters, _) = data.as_chunks::<4>();
        let letters: Vec<char> = letters
            .iter()
            .filter_map(|b| char::from_u32(u32::from_le_bytes(*b)))
            .collect();
        let word = |cell: &[char]| cell.iter().filter(|c| **c != '\0').collect();
        read.words = letters.chunks(width.max(1)).map(word).collect();
    } else {
        return Err("it is of another type than <f8 and <U");
    }
    match read.numbers.len() + read.words.len() == count {
        true => Ok(read),
        false => Err("it has not as many values as its shape says"),
    }
}

/// The text between two others.
fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(before)?;
    rest.split_once(after).map(|(inside, _)| inside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_report::{Column, Table, TableExport as _};

    #[test]
    fn a_written_table_is_read_with_its_names_and_units() {
        let table = Table {
            columns: vec![Column::new("t", "s"), Column::new("φ", "rad")],
            rows: vec![vec![0.0, 1.5], vec![1.0, -2.5]],
        };
        let arrays = read_npz(&table.npz().unwrap()).unwrap();
        assert_eq!(arrays["φ"].numbers, [1.5, -2.5]);
        assert_eq!(arrays["φ"].shape, [2]);
        assert_eq!(arrays["columns"].words, ["t", "φ"]);
        assert_eq!(arrays["units"].words, ["s", "rad"]);
    }

    #[test]
    fn what_is_no_archive_or_cut_off_is_an_error() {
        assert!(read_npz(b"PK").is_err());
        let table = Table {
            columns: vec![Column::new("t", "s")],
            rows: vec![vec![0.0]],
        };
        let bytes = table.npz().unwrap();
        assert!(read_npz(&bytes[..bytes.len() / 2]).is_err());
        assert!(read_npz(&bytes[40..]).is_err());
    }
}
