//! The legend: its entries, its shape, and a place where it hides nothing.

use crate::canvas::{Align, Canvas, Drawn, Line, Type};
use crate::fonts;
use crate::marks::{Marker, marker};
use crate::occupancy::Occupancy;
use crate::rect::Rect;
use crate::theme::{EDGE, INK, Rgb, TICK, WHITE};

/// Length of a sample line.
const SAMPLE: f64 = 46.0;
/// Between sample and name.
const GAP: f64 = 12.0;
/// Between columns.
const COLUMN_GAP: f64 = 34.0;
/// Between the edge and the entries.
const PAD: f64 = 12.0;
/// Height of an entry.
pub(crate) const ROW: f64 = 37.0;
/// Distance kept from the data and from the frame.
const CLEAR: f64 = 9.0;

/// What stands before a name.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    /// The line, if there is one.
    pub(crate) line: Option<Line>,
    /// Shape and colour of the marker, if there is one.
    pub(crate) marker: Option<(Marker, Rgb)>,
    /// Colour of a filled patch behind the line, if there is one.
    pub(crate) patch: Option<Rgb>,
}

/// A line of the legend.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) name: String,
    pub(crate) sample: Sample,
}

/// A legend set in a number of columns.
#[derive(Debug, Clone)]
pub(crate) struct Legend {
    entries: Vec<Entry>,
    widths: Vec<f64>,
    rows: usize,
    size: f64,
}

impl Legend {
    /// The entries in so many columns, in smaller type if it would be wider than `room`.
    pub(crate) fn new(entries: &[Entry], columns: usize, room: f64) -> Self {
        let rows = entries.len().div_ceil(columns.max(1)).max(1);
        let mut legend = Self {
            entries: entries.to_vec(),
            widths: Vec::new(),
            rows,
            size: TICK,
        };
        legend.measure();
        let fixed = legend.width() - legend.widths.iter().sum::<f64>();
        let names: f64 = legend.widths.iter().sum();
        if legend.width() > room && names > 0.0 {
            legend.size *= ((room - fixed) / names).clamp(0.4, 1.0);
            legend.measure();
        }
        legend
    }

    fn measure(&mut self) {
        let widest = |c: &[Entry]| {
            c.iter()
                .map(|e| fonts::width(&e.name, self.size, false))
                .fold(0.0, f64::max)
        };
        self.widths = self.entries.chunks(self.rows).map(widest).collect();
    }

    pub(crate) fn width(&self) -> f64 {
        let columns = self.widths.len() as f64;
        2.0 * PAD
            + self.widths.iter().map(|w| w + SAMPLE + GAP).sum::<f64>()
            + (columns - 1.0).max(0.0) * COLUMN_GAP
    }

    pub(crate) fn height(&self) -> f64 {
        PAD + ROW * self.rows as f64
    }

    /// Draws it with its upper left corner at the place.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, place: &Rect, boxed: bool) -> Drawn {
        if boxed {
            canvas.rect(place, WHITE)?;
            canvas.frame(place, Line::solid(EDGE, 1.5))?;
        }
        let mut x = place.x0 + PAD;
        for (column, width) in self.entries.chunks(self.rows).zip(&self.widths) {
            let mut y = place.y0 + 0.5 * (PAD + ROW);
            for entry in column {
                let Sample {
                    line,
                    marker: shape,
                    patch,
                } = entry.sample;
                if let Some(color) = patch {
                    canvas.rect(&Rect::sized(x, y - 9.0, SAMPLE, 18.0), color)?;
                }
                if let Some(line) = line {
                    canvas.line(&[[x, y], [x + SAMPLE, y]], line)?;
                }
                if let Some((shape, color)) = shape {
                    marker(canvas, shape, [x + 0.5 * SAMPLE, y], color)?;
                }
                canvas.text_beside(
                    &entry.name,
                    [x + SAMPLE + GAP, y],
                    Type::new(self.size, INK, Align::Start),
                )?;
                y += ROW;
            }
            x += SAMPLE + GAP + width + COLUMN_GAP;
        }
        Ok(())
    }
}

/// A free place for the legend in the plot, and the shape that fits it: the corners first, then the edges, then
/// anywhere. None if every place would hide something.
pub(crate) fn inside(entries: &[Entry], plot: &Rect, taken: &Occupancy) -> Option<(Legend, Rect)> {
    let most = entries.len();
    let mut shapes = vec![1, 2, most];
    shapes.retain(|&columns| columns <= most);
    shapes.dedup();
    for columns in shapes {
        let legend = Legend::new(entries, columns, f64::INFINITY);
        if let Some(place) = free_place(legend.width(), legend.height(), plot, taken) {
            return Some((legend, place));
        }
    }
    None
}

fn free_place(width: f64, height: f64, plot: &Rect, taken: &Occupancy) -> Option<Rect> {
    let (rx, ry) = (
        plot.width() - width - 2.0 * CLEAR,
        plot.height() - height - 2.0 * CLEAR,
    );
    // Wider than this it would cut the plot in two even where it hides nothing.
    if rx < 0.25 * plot.width() || ry < 0.2 * plot.height() {
        return None;
    }
    let at = |u: f64, v: f64| {
        Rect::sized(
            plot.x0 + CLEAR + u * rx,
            plot.y0 + CLEAR + v * ry,
            width,
            height,
        )
    };
    let corners = [(1.0, 0.0), (0.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let steps = || (0..=12).map(|i| f64::from(i) / 12.0);
    let edges = steps().flat_map(|t| [(t, 0.0), (1.0, t), (0.0, t), (t, 1.0)]);
    let middle = steps().flat_map(|u| steps().map(move |v| (u, v)));
    let mut places = corners
        .into_iter()
        .chain(edges)
        .chain(middle)
        .map(|(u, v)| at(u, v));
    places.find(|place| taken.count(&place.grown(CLEAR)) == 0)
}

/// The legend above the plot, in rows as wide as the plot, which gives way to it.
pub(crate) fn above(entries: &[Entry], plot: &mut Rect) -> (Legend, Rect) {
    let room = plot.width() + PAD;
    let fits = |columns: &usize| Legend::new(entries, *columns, f64::INFINITY).width() <= room;
    let columns = (1..=entries.len()).rev().find(fits).unwrap_or(1);
    let legend = Legend::new(entries, columns, room);
    // Samples begin at the frame, as the title does.
    let place = Rect::sized(
        plot.x0 - PAD,
        plot.y0 - 6.0,
        legend.width(),
        legend.height(),
    );
    plot.y0 = (plot.y0 + legend.height()).min(plot.y1 - 60.0);
    (legend, place)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLOT: Rect = Rect {
        x0: 100.0,
        y0: 50.0,
        x1: 900.0,
        y1: 550.0,
    };

    fn entries(n: usize) -> Vec<Entry> {
        let sample = Sample {
            line: Some(Line::solid(INK, 4.0)),
            marker: None,
            patch: None,
        };
        (0..n)
            .map(|i| Entry {
                name: format!("series {i}"),
                sample,
            })
            .collect()
    }

    #[test]
    fn the_legend_goes_to_a_corner_without_data() {
        fonts::ready().unwrap();
        let mut taken = Occupancy::new(PLOT);
        // Rising steeply, then along the top: only the lower right is free.
        taken.line(&[[100.0, 550.0], [300.0, 60.0], [900.0, 60.0]]);
        taken.line(&[[100.0, 60.0], [300.0, 60.0]]);
        let (_, place) = inside(&entries(3), &PLOT, &taken).unwrap();
        assert_eq!(taken.count(&place), 0);
        assert!(
            place.centre()[0] > 500.0 && place.centre()[1] > 300.0,
            "{place:?}"
        );
        assert!(PLOT.holds(&place));
    }

    #[test]
    fn no_legend_is_put_on_data() {
        fonts::ready().unwrap();
        let mut taken = Occupancy::new(PLOT);
        let wave = |i: i32| {
            [
                100.0 + f64::from(i),
                300.0 + 249.0 * (f64::from(i) * 0.05).sin(),
            ]
        };
        taken.line(&(0..800).map(wave).collect::<Vec<_>>());
        assert!(inside(&entries(4), &PLOT, &taken).is_none());
    }

    #[test]
    fn above_the_plot_it_keeps_to_the_width_and_the_plot_gives_way() {
        fonts::ready().unwrap();
        let mut plot = Rect { x1: 600.0, ..PLOT };
        let (legend, place) = above(&entries(7), &mut plot);
        assert!(place.x1 <= plot.x1 && place.y1 <= plot.y0);
        assert!(legend.rows > 1 && legend.rows < 7);
    }
}
