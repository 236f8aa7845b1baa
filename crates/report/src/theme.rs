//! Colours and sizes: one look for every figure.

use crate::axis::Paint;

/// Red, green and blue.
pub(crate) type Rgb = [u8; 3];

/// Okabe and Ito's palette (2008), distinguishable for colour-blind readers; without its yellow, which vanishes on white,
/// and its black, which is [`Paint::Ink`].
const PALETTE: [Rgb; 6] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
];

/// The colours of failed and passed: vermilion and green of the palette.
pub(crate) const FAILED: Rgb = PALETTE[1];
pub(crate) const PASSED: Rgb = PALETTE[2];
pub(crate) const WHITE: Rgb = [255, 255, 255];
pub(crate) const INK: Rgb = [32, 32, 36];
pub(crate) const GREY: Rgb = [120, 120, 126];
pub(crate) const CAPTION_GREY: Rgb = [96, 96, 102];
pub(crate) const GRID: Rgb = [226, 227, 230];
pub(crate) const MINOR_GRID: Rgb = [241, 241, 243];
pub(crate) const BAND: Rgb = [236, 240, 247];
pub(crate) const EDGE: Rgb = [205, 206, 210];

/// Font sizes, in pixels of the final picture. The tick size keeps figures legible at half their size.
pub(crate) const TICK_SIZE: f64 = 27.0;
pub(crate) const LABEL_SIZE: f64 = 30.0;
pub(crate) const PANEL_TITLE_SIZE: f64 = 31.0;
pub(crate) const TITLE_SIZE: f64 = 42.0;
pub(crate) const CAPTION_SIZE: f64 = 27.0;
pub(crate) const PROVENANCE_SIZE: f64 = 22.0;

pub(crate) const CURVE_WIDTH: f64 = 4.2;
pub(crate) const MARK_WIDTH: f64 = 2.6;
pub(crate) const SPINE_WIDTH: f64 = 2.2;
pub(crate) const GRID_WIDTH: f64 = 1.6;
pub(crate) const MARKER_RADIUS: f64 = 8.0;
pub(crate) const TICK_LENGTH: f64 = 9.0;

/// The default colour of a series: the palette, then the two greys, then from the start again.
pub(crate) fn default_paint(index: usize) -> Paint {
    match index % (PALETTE.len() + 2) {
        6 => Paint::Ink,
        7 => Paint::Grey,
        palette => Paint::Palette(palette),
    }
}

/// The colour of a role.
pub(crate) fn rgb(paint: Paint) -> Rgb {
    match paint {
        Paint::Palette(index) => PALETTE[index % PALETTE.len()],
        Paint::Ink => INK,
        Paint::Grey => GREY,
    }
}

/// The colour moved towards white: 0 keeps it, 1 is white.
pub(crate) fn lightened(color: Rgb, lightness: f64) -> Rgb {
    let fraction = if lightness.is_finite() {
        lightness.clamp(0.0, 1.0)
    } else {
        0.0
    };
    color.map(|c| {
        let c = f64::from(c);
        (c + (255.0 - c) * fraction).round() as u8
    })
}

/// Relative luminance (WCAG 2), 1 for white.
pub(crate) fn luminance(color: Rgb) -> f64 {
    let [r, g, b] = color.map(|c| {
        let c = f64::from(c) / 255.0;
        if c <= 0.03928 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    });
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_colour_stands_out_from_white() {
        for index in 0..PALETTE.len() {
            let contrast = 1.05 / (luminance(rgb(Paint::Palette(index))) + 0.05);
            assert!(
                contrast > 2.0,
                "palette {index} has a contrast of {contrast}"
            );
        }
    }

    #[test]
    fn the_palette_goes_round_and_lightness_ends_at_white() {
        assert_eq!(rgb(Paint::Palette(0)), rgb(Paint::Palette(PALETTE.len())));
        assert_eq!(lightened(INK, 1.0), WHITE);
        assert_eq!(lightened(INK, 0.0), INK);
        assert_eq!(lightened(INK, f64::NAN), INK);
    }
}
