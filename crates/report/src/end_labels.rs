//! Names at the ends of curves, where a reader needs no legend.

use crate::axes::PlotFrame;
use crate::canvas::{Align, Canvas, LineStyle, TextStyle};
use crate::extent::has_markers;
use crate::figure::Chart;
use crate::fonts;
use crate::rect::Rect;
use crate::series_style::SeriesStyle;
use crate::theme::{INK, TICK_SIZE};
use crate::typeset::typeset;

/// Length of the sample before a name.
const SAMPLE: f64 = 26.0;
/// Between frame, sample and name.
const GAP: f64 = 8.0;
/// Least distance of two names.
const MIN_SPACING: f64 = 1.2 * TICK_SIZE;
/// How far a name may stand from the end of its curve.
const MAX_SHIFT: f64 = 0.9 * TICK_SIZE;
/// Largest share of the plot's width that names may take.
const MAX_SHARE: f64 = 0.24;

/// A name beside the end of its curve.
#[derive(Debug, Clone)]
pub(crate) struct EndLabel {
    name: String,
    line: LineStyle,
    y: f64,
}

/// Names for all curves at the right end of the plot, if every curve ends there, apart from the others.
pub(crate) fn at_ends(
    chart: &Chart,
    styles: &[SeriesStyle],
    frame: &PlotFrame,
) -> Option<Vec<EndLabel>> {
    if chart.y2.is_some() {
        return None;
    }
    let mut labels = Vec::new();
    for (series, style) in chart.series.iter().zip(styles) {
        if series.name.trim().is_empty() {
            continue;
        }
        if has_markers(series.stroke) {
            return None;
        }
        let [x, y] = series
            .points
            .iter()
            .rev()
            .find_map(|p| frame.point_to_px(*p, false))?;
        let ends_there = (x - frame.plot.x1).abs() < 0.012 * frame.plot.width();
        if !ends_there || !(frame.plot.y0..=frame.plot.y1).contains(&y) {
            return None;
        }
        labels.push(EndLabel {
            name: typeset(series.name.trim()),
            line: style.line,
            y,
        });
    }
    let widest = fonts::widest(labels.iter().map(|l| &l.name), TICK_SIZE, false);
    if labels.len() < 2 || widest > MAX_SHARE * frame.plot.width() {
        return None;
    }
    spread(&mut labels, &frame.plot).then_some(labels)
}

/// Moves names apart, each by a little at the most; false if that is not enough.
fn spread(labels: &mut [EndLabel], plot: &Rect) -> bool {
    labels.sort_by(|a, b| a.y.total_cmp(&b.y));
    let desired: Vec<f64> = labels.iter().map(|l| l.y).collect();
    for _ in 0..60 {
        for i in 1..labels.len() {
            let overlap = MIN_SPACING - (labels[i].y - labels[i - 1].y);
            if overlap > 0.0 {
                labels[i - 1].y -= 0.5 * overlap;
                labels[i].y += 0.5 * overlap;
            }
        }
        for label in labels.iter_mut() {
            label.y = label.y.clamp(plot.y0, plot.y1);
        }
    }
    let (mut pairs, mut moved) = (labels.windows(2), labels.iter().zip(desired));
    pairs.all(|pair| pair[1].y - pair[0].y > 0.98 * MIN_SPACING)
        && moved.all(|(label, y)| (label.y - y).abs() <= MAX_SHIFT)
}

/// Room the names need to the right of the plot.
pub(crate) fn room(labels: &[EndLabel]) -> f64 {
    let widest = fonts::widest(labels.iter().map(|l| &l.name), TICK_SIZE, false);
    SAMPLE + 3.0 * GAP + widest
}

/// Draws the names.
pub(crate) fn draw(canvas: &mut Canvas<'_>, labels: &[EndLabel], plot: &Rect) {
    for label in labels {
        let x = plot.x1 + GAP;
        let sample = label.line.sample(SAMPLE);
        canvas.line(&[[x, label.y], [x + SAMPLE, label.y]], sample);
        canvas.note(|record| record.legend_entry(&label.name));
        let style = TextStyle::new(TICK_SIZE, INK, Align::Start);
        canvas.text_centred(&label.name, [x + SAMPLE + GAP, label.y], style);
    }
}
