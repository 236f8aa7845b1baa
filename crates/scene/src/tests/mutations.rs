//! No text breaks the reader: a valid scene cut short at every byte, and with every piece of it
//! replaced by something else, is either read or told what is wrong within the text.

use super::*;
use dwell_geometry::JointKind;

fn survive(text: &str) -> bool {
    match parse(text) {
        Ok(scene) => {
            // What was accepted is whole: one mass and one list of points for each body.
            assert_eq!(scene.masses.len(), scene.mechanism.bodies.len());
            assert_eq!(scene.points.len(), scene.mechanism.bodies.len());
            let actuators = scene.mechanism.actuators.len();
            assert_eq!(scene.assembly.coordinates.len(), actuators);
            // So is what the new sections say: a law for each actuator, numbers that are finite.
            if let Some(prescribed) = &scene.prescribed {
                assert_eq!(prescribed.laws.len(), actuators);
                assert!(prescribed.duration > 0.0 && prescribed.points >= 2);
            }
            if let Some(sweep) = &scene.sweep {
                assert!(sweep.actuator.0 < actuators && sweep.fixed_coordinates.len() == actuators);
                assert!(sweep.fixed_coordinates.iter().all(|q| q.is_finite()) && sweep.speed > 0.0);
            }
            if let Some(motion) = &scene.motion {
                assert_eq!(motion.laws.len(), actuators);
                let start = motion
                    .initial_coordinates
                    .iter()
                    .chain(&motion.initial_velocities);
                assert!(start.filter(|q| q.is_finite()).count() == 2 * actuators);
            }
            for joint in &scene.mechanism.joints {
                if let JointKind::Coupling(k) = joint.kind {
                    assert!(k < scene.mechanism.couplings.len());
                }
            }
            true
        }
        Err(error) => {
            assert!(!render(&error).is_empty());
            false
        }
    }
}

/// Byte ranges of the pieces of a text: words, and single other characters.
pub(super) fn pieces(text: &str) -> Vec<std::ops::Range<usize>> {
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
    for text in [&text, MACHINE, FREE_MOTION] {
        for end in 0..=text.len() {
            survive(&String::from_utf8_lossy(&text.as_bytes()[..end]));
            survive(&String::from_utf8_lossy(&text.as_bytes()[end..]));
        }
    }
}

#[test]
fn any_piece_replaced() {
    let strange = [
        "", "[", "]", "{", "}", "\"", "=", ".", "\n", "nan", "-1e999", "\"\"", "a.b", "ground",
        "φ", "\u{0}", "0",
    ];
    // The second scene is long; its own sections are what is new in it.
    let laws = ["", "[", "\"", "nan", "phi", "0", "lift.velocity"];
    for (scene, from, strange) in [
        (WHOLE, 0, &strange[..]),
        (MACHINE, MACHINE.find("[joints]").unwrap(), &laws[..]),
        (FREE_MOTION, FREE_MOTION.find("[loads]").unwrap(), &laws[..]),
    ] {
        let pieces: Vec<_> = pieces(scene);
        let pieces = pieces.iter().filter(|p| p.start >= from);
        let (mut read, mut all) = (0, 0);
        for piece in pieces {
            for new in strange {
                let text = format!("{}{new}{}", &scene[..piece.start], &scene[piece.end..]);
                read += usize::from(survive(&text));
                all += 1;
            }
        }
        // Most changes are mistakes, but a changed title is not.
        assert!(read > all / 100 && read < all / 2, "{read} of {all} read");
    }
}

#[test]
fn any_piece_twice_or_swapped_with_the_next_but_one() {
    for scene in [WHOLE, MACHINE, FREE_MOTION] {
        let pieces = pieces(scene);
        for (k, piece) in pieces.iter().enumerate() {
            let (before, this) = (&scene[..piece.start], &scene[piece.clone()]);
            survive(&format!("{before}{this}{this}{}", &scene[piece.end..]));
            if let Some(other) = pieces.get(k + 2) {
                let (between, that) = (&scene[piece.end..other.start], &scene[other.clone()]);
                survive(&format!(
                    "{before}{that}{between}{this}{}",
                    &scene[other.end..]
                ));
            }
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
