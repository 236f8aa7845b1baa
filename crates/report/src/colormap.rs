//! Colours for values: from nearly white to dark blue.

use crate::theme::{INK, Rgb, WHITE, luminance};

/// One hue, so that every kind of colour-blind reader sees the same order, and brightness falls all the way, so that a grey
/// print keeps it. The third is the palette's blue.
const STOPS: [Rgb; 4] = [[236, 243, 249], [140, 193, 224], [0, 114, 178], [4, 42, 86]];

/// The colour of a position from 0 to 1; beyond them that of the nearer end.
pub(crate) fn color(fraction: f64) -> Rgb {
    let intervals = STOPS.len() - 1;
    let position = fraction.clamp(0.0, 1.0) * intervals as f64;
    let first = (position.floor() as usize).min(intervals - 1);
    let weight = position - first as f64;
    let mix = |k: usize| {
        let [from, to] = [STOPS[first][k], STOPS[first + 1][k]].map(f64::from);
        (from + weight * (to - from)).round() as u8
    };
    [mix(0), mix(1), mix(2)]
}

/// Contrast (WCAG 2) from which on light letters are taken. Where dark and light ones have the same by that measure, in the
/// middle of the scale, light ones on blue are the more legible.
const MIN_CONTRAST: f64 = 3.5;

/// Dark letters on light ground, light ones on dark.
pub(crate) fn text_color_on(background: Rgb) -> Rgb {
    let against_white = (luminance(WHITE) + 0.05) / (luminance(background) + 0.05);
    if against_white < MIN_CONTRAST {
        INK
    } else {
        WHITE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contrast(a: Rgb, b: Rgb) -> f64 {
        let (a, b) = (luminance(a) + 0.05, luminance(b) + 0.05);
        (a / b).max(b / a)
    }

    #[test]
    fn brightness_falls_all_the_way_in_steps_that_a_grey_print_keeps() {
        let steps: Vec<f64> = (0..=100)
            .map(|i| luminance(color(f64::from(i) / 100.0)))
            .collect();
        assert!(steps.windows(2).all(|pair| pair[1] < pair[0]));
        // CIE lightness: 3 is a step one sees, and a seventh of the scale must be well above it.
        let lightness = |y: f64| 116.0 * y.cbrt() - 16.0;
        let seventh: Vec<f64> = (0..=7)
            .map(|i| lightness(luminance(color(f64::from(i) / 7.0))))
            .collect();
        assert!(seventh.windows(2).all(|pair| pair[0] - pair[1] > 6.0));
    }

    #[test]
    fn letters_are_legible_on_every_colour() {
        for i in 0..=1000 {
            let background = color(f64::from(i) / 1000.0);
            // WCAG 2 asks for 3 of letters as large as these.
            assert!(contrast(text_color_on(background), background) >= MIN_CONTRAST);
        }
        assert_eq!(text_color_on(color(0.0)), INK);
        assert_eq!(text_color_on(color(1.0)), WHITE);
    }

    #[test]
    fn the_ends_are_those_of_the_scale_and_no_value_leaves_it() {
        assert_eq!((color(-3.0), color(7.0)), (STOPS[0], STOPS[3]));
    }
}
