//! MAT-files of level 5, uncompressed: a header of 128 bytes, then one element for each matrix, all padded to eight bytes.

/// The file as it grows.
#[derive(Debug)]
pub(super) struct MatFile(Vec<u8>);

const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const UINT16: u32 = 4;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const CHARACTER_CLASS: u32 = 4;
const DOUBLE_CLASS: u32 = 6;

/// An element: its type, its length and its bytes, padded.
fn element(kind: u32, bytes: &[u8]) -> Vec<u8> {
    let mut all = Vec::with_capacity(bytes.len() + 16);
    all.extend(kind.to_le_bytes());
    all.extend((bytes.len() as u32).to_le_bytes());
    all.extend(bytes);
    all.resize(all.len().next_multiple_of(8), 0);
    all
}

impl MatFile {
    pub(super) fn new(writer: &str) -> Self {
        let mut header = format!("MATLAB 5.0 MAT-file, written by {writer}").into_bytes();
        header.resize(124, b' ');
        // Version 1, and the order of the bytes.
        header.extend(0x0100_u16.to_le_bytes());
        header.extend(*b"IM");
        Self(header)
    }

    /// Adds numbers in rows of `columns` columns.
    pub(super) fn add_rows(&mut self, name: &str, columns: usize, values: &[f64]) {
        let rows = values.len().checked_div(columns).unwrap_or(0);
        let columns = if rows == 0 { 0 } else { columns };
        // Columns follow each other.
        let places = (0..columns).flat_map(|c| (0..rows).map(move |r| r * columns + c));
        let bytes: Vec<u8> = places.flat_map(|k| values[k].to_le_bytes()).collect();
        self.add(
            name,
            DOUBLE_CLASS,
            [rows, columns],
            &element(DOUBLE, &bytes),
        );
    }

    /// One row of numbers.
    pub(super) fn add_row(&mut self, name: &str, values: &[f64]) {
        self.add_rows(name, values.len(), values);
    }

    /// A row of characters.
    pub(super) fn add_text(&mut self, name: &str, text: &str) {
        let bytes: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let size = [1, text.encode_utf16().count()];
        self.add(name, CHARACTER_CLASS, size, &element(UINT16, &bytes));
    }

    fn add(&mut self, name: &str, class: u32, size: [usize; 2], data: &[u8]) {
        let numbers = |two: [u32; 2]| two.map(u32::to_le_bytes).concat();
        let mut inside = element(UINT32, &numbers([class, 0]));
        inside.extend(element(INT32, &numbers(size.map(|n| n as u32))));
        inside.extend(element(INT8, name.as_bytes()));
        inside.extend(data);
        self.0.extend(element(MATRIX, &inside));
    }

    pub(super) fn finish(self) -> Vec<u8> {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix of two rows and one column: 128 bytes of header, 8 of the element's tag, 16 of flags, 16 of sizes, 16 of the
    /// name and 24 of the numbers.
    #[test]
    fn elements_have_their_sizes() {
        let mut file = MatFile::new("a test");
        file.add_rows("x", 1, &[1.0, 2.0]);
        let bytes = file.finish();
        assert_eq!(bytes.len(), 128 + 8 + 16 + 16 + 16 + 24);
        assert_eq!(bytes[128..136], [14, 0, 0, 0, 72, 0, 0, 0]);
        assert_eq!(bytes[bytes.len() - 8..], 2.0_f64.to_le_bytes());
    }
}
