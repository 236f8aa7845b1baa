//! No text breaks the reader: a valid scene cut short at every byte, and with every piece of it
//! replaced by something else, is either read or told what is wrong within the text.

use super::*;

fn survive(text: &str) -> bool {
    match parse(text) {
        Ok(scene) => {
            // What was accepted is whole: one mass and one list of points for each body.
            assert_eq!(scene.masses.len(), scene.mechanism.bodies.len());
            assert_eq!(scene.points.len(), scene.mechanism.bodies.len());
            assert_eq!(scene.assembly.start.len(), scene.mechanism.actuators.len());
            true
        }
        Err(error) => {
            assert!(!render(&error).is_empty());
            false
        }
    }
}

/// Byte ranges of the pieces of a text: words, and single other characters.
fn pieces(text: &str) -> Vec<std::ops::Range<usize>> {
    let mut pieces: Vec<std::ops::Range<usize>> = Vec::new();
    let mut in_word = false;
    for (at, c) in text.char_indices() {
        let word = c.is_alphanumeric() || matches!(c, '_' | '.');
        match pieces.last_mut() {
            Some(last) if word && in_word => last.end = at + c.len_utf8(),
            _ => pieces.push(at..at + c.len_utf8()),
        }
        in_word = word;
    }
    pieces
}

#[test]
fn cut_short_anywhere() {
    let text = with("For tests.", "φ ünd ½");
    for end in 0..=text.len() {
        survive(&String::from_utf8_lossy(&text.as_bytes()[..end]));
        survive(&String::from_utf8_lossy(&text.as_bytes()[end..]));
    }
}

#[test]
fn any_piece_replaced() {
    let strange = [
        "", "[", "]", "{", "}", "\"", "=", ".", "\n", "nan", "-1e999", "\"\"", "a.b", "ground",
        "φ", "\u{0}", "0",
    ];
    let pieces = pieces(WHOLE);
    let mut read = 0;
    for piece in &pieces {
        for new in strange {
            let text = format!("{}{new}{}", &WHOLE[..piece.start], &WHOLE[piece.end..]);
            read += usize::from(survive(&text));
        }
    }
    // Most changes are mistakes, but a changed title is not.
    let all = pieces.len() * strange.len();
    assert!(read > all / 100 && read < all / 2, "{read} of {all} read");
}

#[test]
fn any_piece_twice_or_swapped_with_the_next_but_one() {
    let pieces = pieces(WHOLE);
    for (k, piece) in pieces.iter().enumerate() {
        let (before, this) = (&WHOLE[..piece.start], &WHOLE[piece.clone()]);
        survive(&format!("{before}{this}{this}{}", &WHOLE[piece.end..]));
        if let Some(other) = pieces.get(k + 2) {
            let (between, that) = (&WHOLE[piece.end..other.start], &WHOLE[other.clone()]);
            survive(&format!(
                "{before}{that}{between}{this}{}",
                &WHOLE[other.end..]
            ));
        }
    }
}

#[test]
fn any_bytes() {
    // Knuth's 64-bit linear congruential generator: the same bytes in every run.
    let mut state = 1_u64;
    for _ in 0..500 {
        let bytes: Vec<u8> = (0..200)
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (state >> 33) as u8 & 0x7f
            })
            .collect();
        survive(&String::from_utf8_lossy(&bytes));
    }
}
