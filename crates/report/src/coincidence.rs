//! Coinciding curves, drawn with alternating dashes, so that each of them is visible.

use crate::curve::{self, dashes};
use crate::dash::Dash;
use crate::occupancy::Occupancy;
use crate::rect::Rect;
use crate::series_style::SeriesStyle;

/// A curve is hidden if later curves cover this fraction of it.
const HIDDEN_SHARE: f64 = 0.85;
/// A later curve belongs to those that hide it if it covers this fraction of it.
const COVERING_SHARE: f64 = 0.25;
/// Number of searches for hidden curves.
const PASSES: usize = 3;
/// Length in pixels after which the turns of curves come again, and of one turn: the least of many curves, the largest of few. Longer
/// ones would leave of a curve with a short part of its own a few strokes.
const PERIOD: f64 = 48.0;
const TURN: [f64; 2] = [8.0, 20.0];
/// Half the width of what a curve covers, beside the cells that it goes through.
const REACH: f64 = 1.0;
/// Curves closer than this appear as one.
const CLEAR: f64 = 4.0;

/// The lines of a curve in pixels: its parts in the plot.
pub(crate) type Lines = Vec<Vec<[f64; 2]>>;

/// The cells that a curve covers, and its points.
struct Cover {
    occupied: Occupancy,
    points: Vec<[f64; 2]>,
}

/// Gives curves that would hide each other dashes in turn; `lines` are those of each curve.
pub(crate) fn separate(styles: &mut [SeriesStyle], lines: &[Lines], plot: &Rect) {
    // Dashes in turn leave no gaps for a third curve below them, which is found only then.
    // By curve: the first of its group.
    let mut group: Vec<usize> = (0..styles.len()).collect();
    for _ in 0..PASSES {
        find_groups(&mut group, styles, lines, plot);
        take_turns(&group, styles);
    }
}

/// The parts of a curve with no other curve nearby, which need no dashes.
pub(crate) fn alone(curve: usize, lines: &[Lines], plot: &Rect) -> Lines {
    let mut occupied = Occupancy::new(plot.grown(10.0));
    let others = lines.iter().enumerate().filter(|(k, _)| *k != curve);
    others
        .flat_map(|(_, lines)| lines)
        .for_each(|line| occupied.line(line));
    let mut parts = Lines::new();
    for line in &lines[curve] {
        let mut part = Vec::new();
        for at in steps(line) {
            if occupied.count(&Rect::around(at, CLEAR)) == 0 {
                part.push(at);
            } else {
                parts.push(std::mem::take(&mut part));
            }
        }
        parts.push(part);
    }
    parts.retain(|part| part.len() > 1);
    parts
}

/// Points of a line a few pixels apart; of each segment all but its end.
fn steps(line: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
    line.windows(2).flat_map(|pair| {
        let all = curve::steps([pair[0], pair[1]], 4.0, 1e3);
        let count = all.len() - 1;
        all.take(count)
    })
}

/// Joins the groups of curves that hide each other.
fn find_groups(group: &mut [usize], styles: &[SeriesStyle], lines: &[Lines], plot: &Rect) {
    let covers: Vec<Cover> = styles
        .iter()
        .zip(lines)
        .map(|(style, lines)| Cover::of(style, lines, plot))
        .collect();
    for i in 0..covers.len() {
        let later = i + 1..covers.len();
        if !covers[i].is_hidden_by(&covers[later.clone()]) {
            continue;
        }
        for j in later.filter(|&j| covers[i].share_under(&covers[j]) > COVERING_SHARE) {
            let (one, other) = (group[i].min(group[j]), group[i].max(group[j]));
            group
                .iter_mut()
                .filter(|g| **g == other)
                .for_each(|g| *g = one);
        }
    }
}

/// Each of n curves has one turn of n, and is drawn in those of the later ones too, which lie on it: where they do not, more of it is
/// seen.
fn take_turns(group: &[usize], styles: &mut [SeriesStyle]) {
    for first in 0..group.len() {
        let members: Vec<usize> = (0..group.len()).filter(|&k| group[k] == first).collect();
        let count = members.len() as f64;
        let turn = (PERIOD / count).clamp(TURN[0], TURN[1]);
        for (k, &member) in members.iter().enumerate().filter(|_| members.len() > 1) {
            // The lowest may be solid: the others leave gaps.
            if k > 0 || styles[member].line.dash.is_some() {
                let k = k as f64;
                let drawn = if k > 0.0 { count - k } else { 1.0 };
                styles[member].line.dash = Some(Dash {
                    length: drawn * turn,
                    gap: (count - drawn) * turn,
                    offset: k * turn,
                });
            }
        }
    }
}

impl Cover {
    fn of(style: &SeriesStyle, lines: &Lines, plot: &Rect) -> Self {
        let drawn: Lines = match style.line.dash {
            None => lines.clone(),
            Some(dash) => lines.iter().flat_map(|line| dashes(line, dash)).collect(),
        };
        let mut cover = Self {
            occupied: Occupancy::new(plot.grown(10.0)),
            points: Vec::new(),
        };
        for at in drawn.iter().flat_map(|line| steps(line)) {
            cover.occupied.block(&Rect::around(at, REACH));
            cover.points.push(at);
        }
        cover
    }

    fn is_under(at: [f64; 2], other: &Self) -> bool {
        other.occupied.count(&Rect::around(at, 0.0)) > 0
    }

    fn is_hidden_by(&self, later: &[Self]) -> bool {
        let hidden = |at: &&[f64; 2]| later.iter().any(|other| Self::is_under(**at, other));
        let count = self.points.iter().filter(hidden).count();
        !self.points.is_empty() && count as f64 > HIDDEN_SHARE * self.points.len() as f64
    }

    fn share_under(&self, other: &Self) -> f64 {
        let under = self.points.iter().filter(|at| Self::is_under(**at, other));
        under.count() as f64 / self.points.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use crate::figure::{Chart, Figure, Series, Stroke};
    use crate::layout_record::Layout;

    fn figure(heights: &[f64], stroke: Stroke) -> Figure {
        let series = |(k, height): (usize, &f64)| {
            let points = (0..=100).map(|i| [f64::from(i), height + (0.1 * f64::from(i)).sin()]);
            Series::line(format!("curve {k}"), points.collect()).stroke(stroke)
        };
        let chart = Chart {
            series: heights.iter().enumerate().map(series).collect(),
            ..Chart::default()
        };
        Figure {
            panels: vec![chart.into()],
            ..Figure::default()
        }
    }

    #[test]
    fn each_of_several_equal_curves_is_visible() {
        for stroke in [Stroke::Solid, Stroke::Dashed] {
            for heights in [&[0.0; 2][..], &[0.0; 3], &[0.0, 5.0, 0.0], &[0.0; 8]] {
                let layout = Layout::of(&figure(heights, stroke)).unwrap();
                assert_eq!(layout.defects(), Vec::<String>::new());
                assert_eq!(layout.legend.len(), heights.len());
                let equal = heights.iter().filter(|h| **h == 0.0).count() as f64;
                for curve in &layout.curves {
                    assert!(curve.visible > 0.5 * curve.drawn / equal, "{curve:?}");
                }
            }
        }
    }

    #[test]
    fn curves_apart_stay_solid() {
        let layout = Layout::of(&figure(&[0.0, 1.0, 3.0], Stroke::Solid)).unwrap();
        let areas: Vec<f64> = layout.curves.iter().map(|c| c.drawn).collect();
        let mean = areas.iter().sum::<f64>() / 3.0;
        assert!(
            areas.iter().all(|area| (area / mean - 1.0).abs() < 0.05),
            "{areas:?}"
        );
    }
}
