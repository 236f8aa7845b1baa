//! The few colours a picture or an animation may have, chosen from those it has.

use crate::theme::Rgb;
use std::collections::HashMap;

/// Colours of pictures and the index of each; a colour that is not among them gets the index of the nearest.
pub(crate) struct Palette {
    pub(crate) colors: Vec<Rgb>,
    indices: HashMap<Rgb, u8>,
}

impl Palette {
    /// At most `max_colors` colours (up to 256) for the counted ones.
    ///
    /// The colours of surfaces and lines are by far the most frequent and are kept exactly; the tints at their edges are
    /// many and rare. So the colours are taken by decreasing count, and a colour is omitted if its distance from a
    /// kept one is below a bound, which grows from 0 until the rest fits. (Methods that average
    /// colours, made for photographs, would shift the flat ones, too.)
    pub(crate) fn of(counts: &HashMap<Rgb, u64>, max_colors: usize) -> Self {
        let ordered = ordered(counts);
        let max_colors = max_colors.clamp(1, 256);
        let kept = (0..=u8::MAX).find_map(|error| covering(&ordered, error, max_colors));
        // A distance of 255 covers every colour by one.
        Self::new(kept.unwrap_or_default(), &ordered, distance)
    }

    /// The most frequent colours, up to 256.
    pub(crate) fn most_frequent(counts: &HashMap<Rgb, u64>) -> Self {
        let ordered = ordered(counts);
        Self::new(
            ordered.iter().take(256).copied().collect(),
            &ordered,
            |a, b| {
                let differences = (0..3).map(|i| u32::from(a[i].abs_diff(b[i])));
                differences.map(|difference| difference.pow(2)).sum::<u32>()
            },
        )
    }

    fn new<D: Ord>(colors: Vec<Rgb>, all: &[Rgb], distance: impl Fn(Rgb, Rgb) -> D) -> Self {
        let index = |color: Rgb| {
            let nearest = (0..colors.len()).min_by_key(|&i| distance(colors[i], color));
            nearest.unwrap_or(0) as u8
        };
        let indices = all.iter().map(|&color| (color, index(color))).collect();
        Self { colors, indices }
    }

    /// The indices of a picture whose colours have been counted.
    pub(crate) fn indices(&self, picture: &[Rgb]) -> Vec<u8> {
        let mut indices = Vec::with_capacity(picture.len());
        for run in picture.chunk_by(|a, b| a == b) {
            let index = self.indices.get(&run[0]).copied().unwrap_or(0);
            indices.resize(indices.len() + run.len(), index);
        }
        indices
    }
}

/// Counts the colours of pictures.
pub(crate) fn counts<'a>(pictures: impl IntoIterator<Item = &'a [Rgb]>) -> HashMap<Rgb, u64> {
    let mut counts = HashMap::new();
    for picture in pictures {
        // Neighbours are mostly alike: one look-up for a run of them.
        for run in picture.chunk_by(|a, b| a == b) {
            *counts.entry(run[0]).or_default() += run.len() as u64;
        }
    }
    counts
}

/// The most frequent first. The order of a hash map is none: ties are broken by the colour.
fn ordered(counts: &HashMap<Rgb, u64>) -> Vec<Rgb> {
    let mut ordered: Vec<(Rgb, u64)> = counts.iter().map(|(color, n)| (*color, *n)).collect();
    ordered.sort_unstable_by_key(|&(color, n)| (std::cmp::Reverse(n), color));
    ordered.into_iter().map(|(color, _)| color).collect()
}

/// Colours that leave none farther away than `error`; none if there would be more than `most`.
fn covering(ordered: &[Rgb], error: u8, max_colors: usize) -> Option<Vec<Rgb>> {
    let mut kept: Vec<Rgb> = Vec::new();
    for &color in ordered {
        if kept.iter().any(|k| distance(*k, color) <= error) {
            continue;
        }
        if kept.len() == max_colors {
            return None;
        }
        kept.push(color);
    }
    Some(kept)
}

/// The largest difference of a channel.
fn distance(a: Rgb, b: Rgb) -> u8 {
    (0..3).map(|i| a[i].abs_diff(b[i])).fold(0, u8::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest difference between a colour and what is shown in its stead.
    fn error(palette: &Palette, counts: &HashMap<Rgb, u64>) -> u8 {
        let shown = |color: &Rgb| palette.colors[usize::from(palette.indices(&[*color])[0])];
        let errors = counts.keys().map(|color| distance(shown(color), *color));
        errors.fold(0, u8::max)
    }

    #[test]
    fn colours_that_fit_are_kept_exactly() {
        let counts: HashMap<Rgb, u64> = (0..=254).map(|i| ([i, 255 - i, 7], 1)).collect();
        let palette = Palette::of(&counts, 255);
        assert_eq!((palette.colors.len(), error(&palette, &counts)), (255, 0));
    }

    #[test]
    fn too_many_colours_keep_the_frequent_ones_and_none_is_far_off() {
        // Every tint between two flat colours and white, as edges have them.
        let flat = [[0, 114, 178], [213, 94, 0], [255, 255, 255]];
        let mut counts: HashMap<Rgb, u64> = flat.map(|color| (color, 10_000)).into();
        for (one, other) in [(0, 1), (0, 2), (1, 2)] {
            for i in 0..=255 {
                let mix = |k: usize| {
                    (u32::from(flat[one][k]) * i + u32::from(flat[other][k]) * (255 - i)) / 255
                };
                let tint = [0, 1, 2].map(|k| mix(k) as u8);
                *counts.entry(tint).or_default() += 1;
            }
        }
        assert!(counts.len() > 600);
        let palette = Palette::of(&counts, 255);
        assert!(palette.colors.len() <= 255 && palette.colors.len() > 100);
        for color in flat {
            assert_eq!(
                palette.colors[usize::from(palette.indices(&[color])[0])],
                color
            );
        }
        // Three lines of about 240 tints under 255 colours: each stands for itself and one on either side.
        assert!(error(&palette, &counts) <= 2);
    }

    #[test]
    fn colours_everywhere_still_fit() {
        let cube = (0..32_768_u32).map(|i| [i & 31, (i >> 5) & 31, i >> 10]);
        let counts: HashMap<Rgb, u64> = cube.map(|c| (c.map(|c| (c * 8) as u8), 1)).collect();
        let palette = Palette::of(&counts, 255);
        // 255 cubes of side 40 fill the space of 248; they overlap, since their positions are random.
        assert!(palette.colors.len() <= 255 && error(&palette, &counts) < 64);
        assert_eq!(Palette::of(&HashMap::new(), 255).colors.len(), 0);
    }
}
