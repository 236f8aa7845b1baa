//! Names at the ends of curves, where a reader needs no legend.

use crate::axes::Frame;
use crate::canvas::{Align, Canvas, Drawn, Line, Type};
use crate::chart::Look;
use crate::extent::marked;
use crate::figure::Chart;
use crate::fonts;
use crate::rect::Rect;
use crate::theme::{INK, TICK};

/// Length of the sample before a name.
const SAMPLE: f64 = 26.0;
/// Between frame, sample and name.
const GAP: f64 = 8.0;
/// Least distance of two names.
const ROW: f64 = 1.2 * TICK;
/// How far a name may stand from the end of its curve.
const NUDGE: f64 = 0.9 * TICK;
/// Largest share of the plot's width that names may take.
const SHARE: f64 = 0.24;

/// A name beside the end of its curve.
#[derive(Debug, Clone)]
pub(crate) struct EndLabel {
    name: String,
    line: Line,
    y: f64,
}

/// Names for all curves at the right end of the plot, if every curve ends there, apart from the others.
pub(crate) fn at_ends(chart: &Chart, looks: &[Look], frame: &Frame) -> Option<Vec<EndLabel>> {
    if chart.y2.is_some() {
        return None;
    }
    let mut labels = Vec::new();
    for (series, look) in chart.series.iter().zip(looks) {
        if series.name.trim().is_empty() {
            continue;
        }
        if marked(series.stroke) {
            return None;
        }
        let [x, y] = series
            .points
            .iter()
            .rev()
            .find_map(|p| frame.point(*p, false))?;
        let ends_there = (x - frame.plot.x1).abs() < 0.012 * frame.plot.width();
        if !ends_there || !(frame.plot.y0..=frame.plot.y1).contains(&y) {
            return None;
        }
        labels.push(EndLabel {
            name: series.name.trim().to_owned(),
            line: look.line,
            y,
        });
    }
    let widest = labels
        .iter()
        .map(|l| fonts::width(&l.name, TICK, false))
        .fold(0.0, f64::max);
    if labels.len() < 2 || widest > SHARE * frame.plot.width() {
        return None;
    }
    spread(&mut labels, &frame.plot).then_some(labels)
}

/// Moves names apart, each by a little at the most; false if that is not enough.
fn spread(labels: &mut [EndLabel], plot: &Rect) -> bool {
    labels.sort_by(|a, b| a.y.total_cmp(&b.y));
    let wanted: Vec<f64> = labels.iter().map(|l| l.y).collect();
    for _ in 0..60 {
        for i in 1..labels.len() {
            let overlap = ROW - (labels[i].y - labels[i - 1].y);
            if overlap > 0.0 {
                labels[i - 1].y -= 0.5 * overlap;
                labels[i].y += 0.5 * overlap;
            }
        }
        for label in labels.iter_mut() {
            label.y = label.y.clamp(plot.y0, plot.y1);
        }
    }
    let apart = labels
        .windows(2)
        .all(|pair| pair[1].y - pair[0].y > 0.98 * ROW);
    apart
        && labels
            .iter()
            .zip(wanted)
            .all(|(label, y)| (label.y - y).abs() <= NUDGE)
}

/// Room the names need to the right of the plot.
pub(crate) fn room(labels: &[EndLabel]) -> f64 {
    let widest = labels
        .iter()
        .map(|l| fonts::width(&l.name, TICK, false))
        .fold(0.0, f64::max);
    SAMPLE + 3.0 * GAP + widest
}

/// Draws the names.
pub(crate) fn draw(canvas: &mut Canvas<'_>, labels: &[EndLabel], plot: &Rect) -> Drawn {
    for label in labels {
        let x = plot.x1 + GAP;
        canvas.line(&[[x, label.y], [x + SAMPLE, label.y]], label.line)?;
        canvas.text_beside(
            &label.name,
            [x + SAMPLE + GAP, label.y],
            Type::new(TICK, INK, Align::Start),
        )?;
    }
    Ok(())
}
