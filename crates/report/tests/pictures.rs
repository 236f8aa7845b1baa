//! Figures as their readers get them: PNG files.

use dwell_report::{
    Axis, Cell, Chart, Drawing, Figure, Grid, Group, Layout, Paint, Panel, Pen, Row, Series, Shape,
    Stroke, png,
};
use std::collections::BTreeMap;

struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    #[allow(
        clippy::unwrap_used,
        reason = "Clippy knows a test by its attribute, and not the helpers beside it"
    )]
    fn of(figure: &Figure) -> Self {
        let bytes = png(figure).unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut buffer).unwrap();
        assert_eq!(
            (info.color_type, info.bit_depth),
            (png::ColorType::Rgb, png::BitDepth::Eight)
        );
        let pixels = buffer[..info.buffer_size()]
            .chunks_exact(3)
            .map(|p| [p[0], p[1], p[2]])
            .collect();
        Self {
            width: info.width,
            height: info.height,
            pixels,
        }
    }

    fn count(&self, color: [u8; 3]) -> usize {
        self.pixels.iter().filter(|p| **p == color).count()
    }

    /// Columns in which a colour occurs, as first and last.
    fn columns(&self, color: [u8; 3]) -> Option<(usize, usize)> {
        let places = || {
            self.pixels
                .iter()
                .enumerate()
                .filter(|(_, p)| **p == color)
                .map(|(i, _)| i % self.width as usize)
        };
        places().min().zip(places().max())
    }
}

const WHITE: [u8; 3] = [255, 255, 255];
const BLUE: [u8; 3] = [0, 114, 178];

fn wave(name: &str) -> Chart {
    let points = (0..=2000)
        .map(|i| f64::from(i) * 0.18)
        .map(|d| [d, d.to_radians().sin()])
        .collect();
    Chart {
        x: Axis::degrees("crank angle φ"),
        y: Axis::new("speed", "m/s"),
        series: vec![Series::line(name, points)],
        ..Chart::default()
    }
}

fn page(columns: usize, charts: Vec<Chart>) -> Figure {
    let panels = charts.into_iter().map(Into::into).collect();
    Figure {
        name: "page".to_owned(),
        title: "Title".to_owned(),
        caption: "Caption.".to_owned(),
        columns,
        panels,
        ..Figure::default()
    }
}

#[test]
fn a_page_of_two_columns_is_2000_pixels_wide_and_shows_its_curves() {
    let picture = Picture::of(&page(2, vec![wave(""), wave("")]));
    assert_eq!(picture.width, 2000);
    assert!((700..1100).contains(&picture.height));
    let mut colors: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    picture
        .pixels
        .iter()
        .for_each(|p| *colors.entry(*p).or_default() += 1);
    assert!(colors.len() > 20);
    assert!(
        picture.count(BLUE) > 4000,
        "{} pixels of the curves",
        picture.count(BLUE)
    );
    assert!(picture.count(WHITE) > picture.pixels.len() / 2);
    // One curve in each half of the page.
    let (first, last) = picture.columns(BLUE).unwrap();
    assert!(first < 300 && last > 1900);
}

#[test]
fn values_without_a_place_are_left_out_of_a_logarithmic_chart() {
    let mut points: Vec<[f64; 2]> = (1..=100)
        .map(|i| [f64::from(i), 10f64.powi(-(i % 10))])
        .collect();
    let clean = Picture::of(&page(1, vec![log_chart(points.clone())]));
    // Beyond the end of the line, so that a break leaves no trace.
    points.extend([
        [50.0, 0.0],
        [60.0, -1.0],
        [f64::NAN, 1.0],
        [70.0, f64::INFINITY],
    ]);
    let soiled = Picture::of(&page(1, vec![log_chart(points)]));
    assert!(clean.pixels == soiled.pixels);
    assert!(clean.count(BLUE) > 1000);
}

fn log_chart(points: Vec<[f64; 2]>) -> Chart {
    Chart {
        y: Axis::log("error", ""),
        series: vec![Series::line("", points)],
        ..Chart::default()
    }
}

#[test]
fn charts_without_data_say_so_and_do_not_fail() {
    let blank = Picture::of(&page(1, vec![log_chart(vec![])]));
    let zeros = Picture::of(&page(1, vec![log_chart(vec![[f64::NAN, 0.0]; 5])]));
    assert_eq!(blank.count(BLUE), 0);
    assert!(blank.pixels == zeros.pixels);
    // The words in the middle are the only grey ink inside the plot.
    assert!(blank.count([120, 120, 126]) > 50);
    assert!(Picture::of(&Figure::default()).count(WHITE) > 0);
}

#[test]
fn a_drawing_keeps_proportions_and_lightens_ghosts() {
    let square = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let ghost = Pen::new(Paint::Palette(0), 6.0).lightness(0.5);
    let drawing = Drawing {
        shapes: vec![Shape::area(square, ghost, 1.0)],
        ..Drawing::default()
    };
    let picture = Picture::of(&Figure {
        panels: vec![drawing.into()],
        columns: 1,
        ..Figure::default()
    });
    let light = [128, 185, 217];
    let (first, last) = picture.columns(light).unwrap();
    let side = last - first + 1;
    let (filled, expected) = (picture.count(light), side * side);
    assert!(
        filled.abs_diff(expected) < expected / 50,
        "{filled} pixels in a square of {side}"
    );
    assert_eq!(picture.count(BLUE), 0);
}

#[test]
fn a_filled_series_covers_the_area_down_to_zero() {
    // A jump half way, to the other sign: two of four quarters are filled.
    let points = vec![[0.0, 0.6], [0.5, 0.6], [0.5, -0.6], [1.0, -0.6]];
    let chart = Chart {
        y: Axis::default().with_range(-1.0, 1.0),
        series: vec![Series::line("", points).stroke(Stroke::Filled)],
        ..Chart::default()
    };
    let picture = Picture::of(&page(1, vec![chart]));
    // Blue at an opacity of 0.22 on white.
    let tint = [199, 224, 238];
    let width = picture.width as usize;
    let places = picture.pixels.iter().enumerate();
    let rows = places.filter(|(_, p)| **p == tint).map(|(i, _)| i / width);
    let (top, bottom) = (rows.clone().min().unwrap(), rows.max().unwrap());
    let (left, right) = picture.columns(tint).unwrap();
    let all = (bottom - top + 1) * (right - left + 1);
    // As wide as the line, but for its ends.
    let (first, last) = picture.columns(BLUE).unwrap();
    assert!(left.abs_diff(first) < 6 && right.abs_diff(last) < 6);
    // The line and the grid take some hundredths of it.
    let share = picture.count(tint) as f64 / all as f64;
    assert!((0.46..0.5).contains(&share), "{share} of {all} pixels");
}

#[test]
fn a_stack_is_one_panel_and_shows_every_chart() {
    let three = vec![wave(""), wave(""), wave("")];
    let stack = Figure {
        panels: vec![three.clone().into()],
        ..page(1, vec![])
    };
    let (stacked, separate) = (Picture::of(&stack), Picture::of(&page(1, three)));
    assert!(2 * stacked.height < separate.height);
    // Three curves as long as the plot is wide, each four pixels thick.
    assert!(stacked.count(BLUE) > 3 * 4 * 1000);
    let none = Figure {
        panels: vec![Panel::Stack(vec![])],
        ..page(1, vec![])
    };
    assert_eq!(Picture::of(&none).count(BLUE), 0);
}

fn grid(cells: Vec<Option<Cell>>) -> Picture {
    let grid = Grid {
        columns: vec!["a".to_owned(); 4],
        groups: vec![Group {
            rows: vec![Row::new("row", cells)],
            ..Group::default()
        }],
        values: Axis::new("digits", "").with_range(0.0, 16.0),
        ..Grid::default()
    };
    Picture::of(&Figure {
        panels: vec![grid.into()],
        ..Figure::default()
    })
}

#[test]
fn a_cell_has_the_colour_of_its_value_and_a_failed_one_is_vermilion() {
    const DARKEST: [u8; 3] = [4, 42, 86];
    const VERMILION: [u8; 3] = [213, 94, 0];
    let low = grid(vec![Some(Cell::new(0.0, "0"))]);
    let high = grid(vec![Some(Cell::new(16.0, "16"))]);
    let beyond = grid(vec![Some(Cell::new(99.0, "16"))]);
    // One of four columns of 1250 pixels, 38 high, less two digits.
    assert!(high.count(DARKEST) > low.count(DARKEST) + 9000);
    assert!(high.pixels == beyond.pixels);
    assert_eq!(high.count(VERMILION), 0);
    let failed = grid(vec![Some(Cell::new(16.0, "16").failed())]);
    // A cell of 300 by 38 pixels, less two digits, and its like in the key.
    assert!(failed.count(VERMILION) > 9000 && failed.count(DARKEST) < 9000);
}

#[test]
fn what_does_not_apply_is_not_the_lowest_value_nor_a_cell_without_one() {
    let absent = grid(vec![None; 4]);
    assert!(absent.pixels == grid(vec![]).pixels);
    let nothing = grid(vec![Some(Cell::text_only("")); 4]);
    let nowhere = grid(vec![Some(Cell::new(f64::NAN, "")); 4]);
    assert!(nothing.pixels == nowhere.pixels);
    // The dash is the only grey ink of that kind; its edges are tints.
    let grey = |picture: &Picture| picture.count([120, 120, 126]);
    assert!(
        grey(&absent) >= 4 && grey(&nothing) == 0,
        "{}",
        grey(&absent)
    );
    assert!(absent.pixels != nothing.pixels);
    let lowest = grid(vec![Some(Cell::new(0.0, "")); 4]);
    assert!(lowest.count([236, 243, 249]) > 30_000 && absent.count([236, 243, 249]) == 0);
}

#[test]
fn text_of_any_kind_is_drawn_or_left_out() {
    let mut figure = page(1, vec![wave("<b>&amp; \u{0} \u{1F600} φ̇₁²")]);
    figure.title = "\"quotes\" & <tags>\u{7}".to_owned();
    figure.caption = "\n\n   \n".to_owned();
    assert!(Picture::of(&figure).count(BLUE) > 1000);
}

#[test]
fn threads_draw_the_same_bytes() {
    let figure = page(
        2,
        vec![wave("a"), log_chart(vec![[1.0, 1.0], [2.0, 1e-12]])],
    );
    let alone = png(&figure).unwrap();
    std::thread::scope(|scope| {
        let drawn: Vec<_> = (0..4)
            .map(|_| scope.spawn(|| png(&figure).unwrap()))
            .collect();
        for thread in drawn {
            assert!(thread.join().unwrap() == alone);
        }
    });
}

/// A view of space has no ticks, and none of their words: its plot is as wide as its cell.
#[test]
fn a_view_without_axes_has_no_words_but_its_own() {
    let layout = |without_axes| {
        let square = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let drawing = Drawing {
            shapes: vec![Shape::area(square, Pen::new(Paint::Ink, 2.0), 0.5)],
            without_axes,
            ..Drawing::default()
        };
        let figure = Figure {
            panels: vec![drawing.into()],
            columns: 1,
            ..Figure::default()
        };
        Layout::of(&figure).unwrap()
    };
    assert!(layout(true).labels.is_empty());
    assert!(layout(false).labels.len() > 4);
}
