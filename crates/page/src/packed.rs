//! Numbers as text: bytes of equal significance together, compressed, in Base64.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::{Compression, GzBuilder};
use std::io::{self, Write as _};

/// Bytes of a number.
const BYTES: usize = 8;

/// The numbers as Base64 of a gzip stream: first the least significant bytes of all numbers, then the next, and so on, because
/// the exponents of a column are similar. The stream contains no time.
pub(crate) fn packed(numbers: &[f64]) -> io::Result<String> {
    let bytes: Vec<u8> = (0..BYTES)
        .flat_map(|k| numbers.iter().map(move |v| v.to_le_bytes()[k]))
        .collect();
    let mut gzip = GzBuilder::new().write(Vec::new(), Compression::best());
    gzip.write_all(&bytes)?;
    Ok(STANDARD.encode(gzip.finish()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::GzDecoder;
    use std::io::Read as _;

    #[test]
    fn every_bit_comes_back() {
        let numbers = [0.1, -0.0, f64::NAN, 5e-324, f64::MAX, 1.0 / 3.0];
        let gzip = STANDARD.decode(packed(&numbers).unwrap()).unwrap();
        let mut bytes = Vec::new();
        GzDecoder::new(&gzip[..]).read_to_end(&mut bytes).unwrap();
        for (k, number) in numbers.iter().enumerate() {
            let own = std::array::from_fn(|b| bytes[b * numbers.len() + k]);
            assert_eq!(f64::from_le_bytes(own).to_bits(), number.to_bits());
        }
    }
}
