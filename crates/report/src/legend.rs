//! The legend: its entries, its shape, and an area where it hides nothing.

use crate::canvas::{Align, Canvas, LineStyle, TextStyle};
use crate::fonts;
use crate::marks::{Marker, draw_marker};
use crate::occupancy::Occupancy;
use crate::rect::Rect;
use crate::theme::{EDGE, INK, Rgb, TICK_SIZE, WHITE};

/// Length of a sample line.
const HANDLE_WIDTH: f64 = 46.0;
/// Between sample and name.
const GAP: f64 = 12.0;
/// Between columns.
const COLUMN_GAP: f64 = 34.0;
/// Between the edge and the entries.
const PAD: f64 = 12.0;
/// Height of an entry.
pub(crate) const ROW_HEIGHT: f64 = 37.0;
/// Distance kept from the data and from the frame.
const CLEARANCE: f64 = 9.0;

/// What stands before a name.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LegendHandle {
    /// The line, if there is one.
    pub(crate) line: Option<LineStyle>,
    /// Shape and colour of the marker, if there is one.
    pub(crate) marker: Option<(Marker, Rgb)>,
    /// Colour of a filled patch behind the line, if there is one.
    pub(crate) patch: Option<Rgb>,
}

/// A line of the legend.
#[derive(Debug, Clone)]
pub(crate) struct LegendEntry {
    pub(crate) name: String,
    pub(crate) handle: LegendHandle,
}

impl LegendEntry {
    /// The name of the curve, without the arrow to its axis.
    fn curve_name(&self) -> &str {
        self.name.trim_end_matches([' ', '→', '←'])
    }
}

/// A legend set in a number of columns.
#[derive(Debug, Clone)]
pub(crate) struct Legend {
    entries: Vec<LegendEntry>,
    widths: Vec<f64>,
    rows: usize,
    size: f64,
}

impl Legend {
    /// The entries in so many columns, in smaller type if it would be wider than `room`.
    pub(crate) fn new(entries: &[LegendEntry], columns: usize, room: f64) -> Self {
        let rows = entries.len().div_ceil(columns.max(1)).max(1);
        let mut legend = Self {
            entries: entries.to_vec(),
            widths: Vec::new(),
            rows,
            size: TICK_SIZE,
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
        let widest = |c: &[LegendEntry]| fonts::widest(c.iter().map(|e| &e.name), self.size, false);
        self.widths = self.entries.chunks(self.rows).map(widest).collect();
    }

    pub(crate) fn width(&self) -> f64 {
        let gaps = (self.widths.len() as f64 - 1.0).max(0.0) * COLUMN_GAP;
        let columns = self.widths.iter().map(|w| w + HANDLE_WIDTH + GAP);
        2.0 * PAD + columns.sum::<f64>() + gaps
    }

    pub(crate) fn height(&self) -> f64 {
        PAD + ROW_HEIGHT * self.rows as f64
    }
}

/// A legend and where it stands.
pub(crate) struct PlacedLegend {
    legend: Legend,
    pub(crate) area: Rect,
    /// Within the plot, in a box; else above it.
    is_inside: bool,
}

impl PlacedLegend {
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>) {
        let (legend, area) = (&self.legend, &self.area);
        if self.is_inside {
            canvas.rect(area, WHITE);
            canvas.rect_outline(area, LineStyle::solid(EDGE, 1.5));
        }
        let mut x = area.x0 + PAD;
        for (column, width) in legend.entries.chunks(legend.rows).zip(&legend.widths) {
            let mut y = area.y0 + 0.5 * (PAD + ROW_HEIGHT);
            for entry in column {
                let LegendHandle {
                    line,
                    marker,
                    patch,
                } = entry.handle;
                if let Some(color) = patch {
                    canvas.rect(&Rect::sized(x, y - 9.0, HANDLE_WIDTH, 18.0), color);
                }
                if let Some(line) = line {
                    canvas.line(&[[x, y], [x + HANDLE_WIDTH, y]], line.sample(HANDLE_WIDTH));
                }
                if let Some((marker, color)) = marker {
                    draw_marker(canvas, marker, [x + 0.5 * HANDLE_WIDTH, y], color);
                }
                canvas.note(|record| record.legend_entry(entry.curve_name()));
                let style = TextStyle::new(legend.size, INK, Align::Start);
                canvas.text_centred(&entry.name, [x + HANDLE_WIDTH + GAP, y], style);
                y += ROW_HEIGHT;
            }
            x += HANDLE_WIDTH + GAP + width + COLUMN_GAP;
        }
    }

    /// Height that it takes from the plot.
    pub(crate) fn height_above(&self) -> f64 {
        if self.is_inside {
            0.0
        } else {
            self.legend.height()
        }
    }
}

/// A free area for the legend in the plot, and the shape that fits it: the corners first, then the edges, then
/// anywhere. None if every area would hide something.
pub(crate) fn place_inside(
    entries: &[LegendEntry],
    plot: &Rect,
    occupied: &Occupancy,
) -> Option<PlacedLegend> {
    let max_columns = entries.len();
    let mut column_counts = vec![1, 2, max_columns];
    column_counts.retain(|&columns| columns <= max_columns);
    column_counts.dedup();
    column_counts.into_iter().find_map(|columns| {
        let legend = Legend::new(entries, columns, f64::INFINITY);
        let area = free_area(legend.width(), legend.height(), plot, occupied)?;
        Some(PlacedLegend {
            legend,
            area,
            is_inside: true,
        })
    })
}

fn free_area(width: f64, height: f64, plot: &Rect, occupied: &Occupancy) -> Option<Rect> {
    let rx = plot.width() - width - 2.0 * CLEARANCE;
    let ry = plot.height() - height - 2.0 * CLEARANCE;
    // Wider than this it would cut the plot in two even where it hides nothing.
    if rx < 0.25 * plot.width() || ry < 0.2 * plot.height() {
        return None;
    }
    let at = |(u, v): (f64, f64)| {
        let (x, y) = (plot.x0 + CLEARANCE + u * rx, plot.y0 + CLEARANCE + v * ry);
        Rect::sized(x, y, width, height)
    };
    let corners = [(1.0, 0.0), (0.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let steps = || (0..=12).map(|i| f64::from(i) / 12.0);
    let edges = steps().flat_map(|t| [(t, 0.0), (1.0, t), (0.0, t), (t, 1.0)]);
    let middle = steps().flat_map(|u| steps().map(move |v| (u, v)));
    let mut areas = corners.into_iter().chain(edges).chain(middle).map(at);
    areas.find(|area| occupied.count(&area.grown(CLEARANCE)) == 0)
}

/// The legend above the plot, in rows as wide as the plot, which becomes smaller.
pub(crate) fn place_above(entries: &[LegendEntry], plot: &mut Rect) -> PlacedLegend {
    let room = plot.width() + PAD;
    let fits = |columns: &usize| Legend::new(entries, *columns, f64::INFINITY).width() <= room;
    let columns = (1..=entries.len()).rev().find(fits).unwrap_or(1);
    let legend = Legend::new(entries, columns, room);
    // Samples begin at the frame, as the title does.
    let (width, height) = (legend.width(), legend.height());
    let area = Rect::sized(plot.x0 - PAD, plot.y0 - 6.0, width, height);
    plot.y0 = (plot.y0 + legend.height()).min(plot.y1 - 60.0);
    PlacedLegend {
        legend,
        area,
        is_inside: false,
    }
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

    fn entries(n: usize) -> Vec<LegendEntry> {
        let handle = LegendHandle {
            line: Some(LineStyle::solid(INK, 4.0)),
            marker: None,
            patch: None,
        };
        (0..n)
            .map(|i| LegendEntry {
                name: format!("series {i}"),
                handle,
            })
            .collect()
    }

    #[test]
    fn the_legend_goes_to_a_corner_without_data() {
        let mut occupied = Occupancy::new(PLOT);
        // Rising steeply, then along the top: only the lower right is free.
        occupied.line(&[[100.0, 550.0], [300.0, 60.0], [900.0, 60.0]]);
        occupied.line(&[[100.0, 60.0], [300.0, 60.0]]);
        let area = place_inside(&entries(3), &PLOT, &occupied).unwrap().area;
        assert_eq!(occupied.count(&area), 0);
        assert!(
            area.centre()[0] > 500.0 && area.centre()[1] > 300.0,
            "{area:?}"
        );
        assert!(PLOT.contains_rect(&area));
    }

    #[test]
    fn no_legend_is_put_on_data() {
        let mut occupied = Occupancy::new(PLOT);
        let wave = |i: i32| {
            [
                100.0 + f64::from(i),
                300.0 + 249.0 * (f64::from(i) * 0.05).sin(),
            ]
        };
        occupied.line(&(0..800).map(wave).collect::<Vec<_>>());
        assert!(place_inside(&entries(4), &PLOT, &occupied).is_none());
    }

    #[test]
    fn above_the_plot_it_keeps_to_the_width_and_the_plot_gives_way() {
        let mut plot = Rect { x1: 600.0, ..PLOT };
        let PlacedLegend { legend, area, .. } = place_above(&entries(7), &mut plot);
        assert!(area.x1 <= plot.x1 && area.y1 <= plot.y0);
        assert!(legend.rows > 1 && legend.rows < 7);
    }
}
