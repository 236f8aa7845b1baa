//! MAT-files of level 5, uncompressed: a header of 128 bytes, then one element for each matrix, all padded to eight bytes.

/// A matrix of the file.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Matrix {
    /// Rows of so many columns, by row.
    Numbers {
        /// Columns.
        columns: usize,
        /// By row.
        values: Vec<f64>,
    },
    /// A row of characters.
    Text(String),
}

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

    pub(super) fn add(&mut self, name: &str, matrix: &Matrix) {
        let (class, rows, columns) = match matrix {
            Matrix::Numbers { columns, values } => {
                let rows = values.len().checked_div(*columns).unwrap_or(0);
                (DOUBLE_CLASS, rows, if rows == 0 { 0 } else { *columns })
            }
            Matrix::Text(text) => (CHARACTER_CLASS, 1, text.encode_utf16().count()),
        };
        let data = match matrix {
            // Columns follow each other.
            Matrix::Numbers { values, .. } => {
                let places = (0..columns).flat_map(|c| (0..rows).map(move |r| r * columns + c));
                let bytes: Vec<u8> = places.flat_map(|k| values[k].to_le_bytes()).collect();
                element(DOUBLE, &bytes)
            }
            Matrix::Text(text) => {
                let bytes: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
                element(UINT16, &bytes)
            }
        };
        let flags: Vec<u8> = [class, 0].iter().flat_map(|n| n.to_le_bytes()).collect();
        let size: Vec<u8> = [rows as u32, columns as u32]
            .iter()
            .flat_map(|n| n.to_le_bytes())
            .collect();
        let mut inside = element(UINT32, &flags);
        inside.extend(element(INT32, &size));
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
        let values = vec![1.0, 2.0];
        file.add("x", &Matrix::Numbers { columns: 1, values });
        let bytes = file.finish();
        assert_eq!(bytes.len(), 128 + 8 + 16 + 16 + 16 + 24);
        assert_eq!(bytes[128..136], [14, 0, 0, 0, 72, 0, 0, 0]);
        assert_eq!(bytes[bytes.len() - 8..], 2.0_f64.to_le_bytes());
    }
}
