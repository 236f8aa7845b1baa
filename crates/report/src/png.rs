//! A figure as PNG bytes.

use crate::canvas::document;
use crate::error::ReportError;
use crate::figure::Figure;
use crate::page::Page;
use crate::palette::{Palette, counts};
use crate::raster::rasterized;
use crate::theme::Rgb;
use ::png::{BitDepth, ColorType, DeflateCompression, Encoder, EncodingError, Filter};

/// No side of a page is longer, in pixels.
const MAX_SIDE: u32 = 16_384;

/// Draws the figure and returns it as a PNG.
///
/// Pages of two columns are 2000 pixels wide, of one column 1400. Works from any number of threads at once; needs
/// no font and no library of the system.
///
/// # Errors
///
/// [`ReportError::Size`] if the page is too large; [`ReportError::Draw`] and [`ReportError::Encode`] if a library fails,
/// which no data should cause.
pub fn png(figure: &Figure) -> Result<Vec<u8>, ReportError> {
    let page = page_of(figure)?;
    let document = document(page.size(), false, None, |canvas| page.draw(canvas));
    let picture = rasterized(&document, &figure.name, page.size())?;
    encoded(&picture, page.size()).map_err(|e| ReportError::Encode {
        figure: figure.name.clone(),
        reason: e.to_string(),
    })
}

/// Charts have fewer than 256 colours; drawings have more, nearly all of them shades at edges of
/// letters: the rare ones (at most 0.4 % of the pixels of a page) take the nearest of the others. That halves the bytes.
fn encoded(picture: &[Rgb], [width, height]: [u32; 2]) -> Result<Vec<u8>, EncodingError> {
    let palette = Palette::most_frequent(&counts([picture]));
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(palette.colors.concat());
    encoder.set_deflate_compression(DeflateCompression::Level(4));
    encoder.set_filter(Filter::NoFilter);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&palette.indices(picture))?;
    writer.finish()?;
    Ok(bytes)
}

/// The page of a figure, unless it is too large.
pub(crate) fn page_of(figure: &Figure) -> Result<Page<'_>, ReportError> {
    let page = Page::new(figure);
    let [width, height] = page.size();
    if width.max(height) > MAX_SIDE {
        return Err(ReportError::Size {
            figure: figure.name.clone(),
            width,
            height,
        });
    }
    Ok(page)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Paint;
    use crate::axis::{Axis, Scale};
    use crate::figure::{Chart, Mark, Panel, Series, Stroke};
    use crate::fonts;
    use crate::grid::{Cell, Grid, Group, Row, Tile, Tiles};
    use crate::rect::Rect;
    use crate::shape::{Drawing, Pen, Shape, TextPlacement};
    use proptest::prelude::*;
    use resvg::usvg::{self, Node, Tree};

    /// Every text of the page and where its letters are, in pixels.
    fn texts(figure: &Figure) -> (Rect, Vec<(String, Rect)>) {
        fn collect(group: &usvg::Group, found: &mut Vec<(String, Rect)>) {
            for node in group.children() {
                match node {
                    Node::Group(group) => collect(group, found),
                    Node::Text(text) => {
                        let words: String = text.chunks().iter().map(|c| c.text().trim()).collect();
                        let letters = text.flattened().abs_bounding_box();
                        let [x0, y0] = [letters.left(), letters.top()].map(f64::from);
                        let [x1, y1] = [letters.right(), letters.bottom()].map(f64::from);
                        found.push((words, Rect { x0, y0, x1, y1 }));
                    }
                    Node::Path(_) | Node::Image(_) => {}
                }
            }
        }
        let page = page_of(figure).unwrap();
        let document = document(page.size(), false, None, |canvas| page.draw(canvas));
        let tree = Tree::from_str(&document, &fonts::options()).unwrap();
        let mut found = Vec::new();
        collect(tree.root(), &mut found);
        (Rect::sized(0.0, 0.0, page.width, page.height), found)
    }

    fn legible(figure: &Figure) -> Result<(), String> {
        let (page, texts) = texts(figure);
        apart_and_whole(&page, &texts)
    }

    fn apart_and_whole(page: &Rect, texts: &[(String, Rect)]) -> Result<(), String> {
        for (i, (text, place)) in texts.iter().enumerate() {
            if !page.contains_rect(&place.grown(4.0)) {
                return Err(format!("`{text}` is cut off: {place:?} on {page:?}"));
            }
            // The copies that make a rim are the same words.
            for (other, there) in texts[..i].iter().filter(|(other, _)| other != text) {
                let separate = place.x1 < there.x0
                    || there.x1 < place.x0
                    || place.y1 < there.y0
                    || there.y1 < place.y0;
                if !separate {
                    return Err(format!("`{text}` {place:?} lies on `{other}` {there:?}"));
                }
            }
        }
        Ok(())
    }

    fn axis() -> impl Strategy<Value = Axis> {
        let scale = prop_oneof![Just(Scale::Linear), Just(Scale::Log), Just(Scale::Degrees)];
        let label = prop_oneof![Just(String::new()), "[a-zφω]{1,12}( [a-z]{1,9}){0,7}"];
        let range = prop::option::weighted(0.2, [-10.0..10.0f64, -10.0..1e3f64]);
        (scale, label, "(|m|N m|kg m²)", range).prop_map(|(scale, label, unit, range)| Axis {
            label,
            unit,
            scale,
            range,
        })
    }

    fn series() -> impl Strategy<Value = Series> {
        let value = || {
            prop_oneof![
                8 => -10.0..10.0f64,
                2 => (-18.0..9.0f64).prop_map(|e| 10f64.powf(e)),
                1 => prop_oneof![Just(0.0), Just(f64::NAN), Just(f64::INFINITY), Just(f64::MAX), Just(-f64::MAX), Just(5e-324)],
            ]
        };
        let points = prop::collection::vec([value(), value()], 0..30);
        let stroke = prop_oneof![
            Just(Stroke::Solid),
            Just(Stroke::Dashed),
            Just(Stroke::Points),
            Just(Stroke::Hollow),
            Just(Stroke::Crosses),
            Just(Stroke::LineAndPoints),
            Just(Stroke::Filled)
        ];
        (points, stroke, "[a-z]{0,14}", any::<bool>(), any::<bool>()).prop_map(
            |(mut points, stroke, name, right_axis, sorted)| {
                if sorted {
                    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
                }
                Series {
                    name,
                    points,
                    stroke,
                    right_axis,
                    color: None,
                }
            },
        )
    }

    fn mark() -> impl Strategy<Value = Mark> {
        let words = "[a-z]{0,9}( [a-z]{1,9}){0,2}";
        ([-5.0..5.0f64, -5.0..5.0f64], words, 0..6).prop_map(|([u, v], label, kind)| match kind {
            0 => Mark::Vertical { at: u, label },
            1 => Mark::Horizontal { at: v, label },
            2 => Mark::Band {
                from: u,
                to: v,
                label,
            },
            3 => Mark::Slope {
                order: u,
                through: [u.abs(), v.abs()],
                label,
            },
            4 => Mark::Text { at: [u, v], label },
            _ => Mark::Point { at: [u, v], label },
        })
    }

    fn chart(max_series: usize) -> impl Strategy<Value = Chart> {
        let title = prop_oneof![Just(String::new()), "[A-Z][a-z]{1,9}( [a-z]{1,9}){0,12}"];
        let marks = prop::collection::vec(mark(), 0..4);
        (
            title,
            axis(),
            axis(),
            prop::option::of(axis()),
            prop::collection::vec(series(), 0..=max_series),
            marks,
        )
            .prop_map(|(title, x, y, y2, series, marks)| Chart {
                title,
                x,
                y,
                y2,
                series,
                marks,
            })
    }

    /// Low plots have no room for long legends.
    fn stack() -> impl Strategy<Value = Panel> {
        prop::collection::vec(chart(3), 0..4).prop_map(Panel::Stack)
    }

    fn drawing() -> impl Strategy<Value = Panel> {
        let point = || [-3.0..3.0f64, -1e3..1e3f64];
        let bars = prop::collection::vec((point(), point(), "[a-z]{1,10}"), 0..4);
        (axis(), axis(), bars).prop_map(|(x, y, bars)| {
            let shape = |(from, to, name): ([f64; 2], [f64; 2], String)| {
                Shape::line(vec![from, to], Pen::new(Paint::Ink, 9.0)).named(name)
            };
            let mut shapes: Vec<Shape> = bars.into_iter().map(shape).collect();
            shapes.push(Shape::GroundPin { at: [0.0, 0.0] });
            Drawing {
                title: String::new(),
                x,
                y,
                shapes,
                ..Drawing::default()
            }
            .into()
        })
    }

    fn grid() -> impl Strategy<Value = Panel> {
        let word = || "[A-Z]?[a-zφ½]{1,14}([-_ ][a-z]{1,12}){0,5}";
        let cell = (
            prop::option::of(-5.0..5.0f64),
            "[0-9e−<. ]{0,7}|[a-z]{4,16}",
            any::<bool>(),
        )
            .prop_map(|(value, text, failed)| Cell {
                value,
                text,
                failed,
            });
        let cells = prop::collection::vec(prop::option::weighted(0.8, cell), 0..14);
        let row = (word(), cells).prop_map(|(name, cells)| Row { name, cells });
        let rows = prop_oneof![9 => prop::collection::vec(row.clone(), 0..8), 1 => prop::collection::vec(row, 40..60)];
        let heading = prop_oneof![Just(String::new()), word()];
        let group = (heading, rows).prop_map(|(heading, rows)| Group { heading, rows });
        let title = prop_oneof![Just(String::new()), word()];
        let columns = prop::collection::vec(word(), 0..14);
        let groups = prop::collection::vec(group, 0..3);
        (title, columns, groups, axis(), any::<bool>()).prop_map(
            |(title, columns, groups, values, compact)| {
                Panel::Grid(Grid {
                    title,
                    columns,
                    groups,
                    values,
                    compact,
                })
            },
        )
    }

    fn tiles() -> impl Strategy<Value = Panel> {
        let word = "[a-z]{0,14}( [a-z0-9.]{1,12}){0,5}";
        let tile = (
            word,
            "[a-z]{1,9}( [0-9]{1,3}){0,9}",
            word,
            any::<Option<bool>>(),
        )
            .prop_map(|(name, value, note, passed)| Tile {
                name,
                value,
                note,
                passed,
            });
        (1..7_usize, prop::collection::vec(tile, 0..9))
            .prop_map(|(columns, tiles)| Panel::Tiles(Tiles { columns, tiles }))
    }

    proptest! {
        #[test]
        fn no_text_is_cut_or_lies_on_another(
            panels in prop::collection::vec(prop_oneof![3 => chart(6).prop_map(Panel::from), 1 => drawing(), 1 => stack(), 1 => grid(), 1 => tiles()], 0..5),
            columns in 0..4_usize,
            title in "[A-Z][a-z]{1,9}( [a-z]{1,9}){0,20}",
            caption in "([a-z]{1,9} ){0,60}",
            provenance in "([a-z]{1,9} ){0,40}",
        ) {
            let figure = Figure { name: String::new(), title, caption, provenance, columns, panels };
            prop_assert_eq!(legible(&figure), Ok(()));
        }
    }

    #[test]
    fn long_labels_of_low_stacked_charts_keep_to_their_plots() {
        // The last word, the power of ten and the unit are not parted from each other.
        let axis = || Axis::new("words for displacements", "kg m²/rad").with_range(0.0, 3e-12);
        let chart = |title: &str| Chart {
            title: title.to_owned(),
            y: axis(),
            y2: Some(axis()),
            ..Chart::default()
        };
        let long = "A title as long as its panel is wide, and longer, so that it reaches to the right and is broken";
        let stack = || Panel::Stack(vec![chart(""), chart(long), chart("Low")]);
        // Beside a panel with a title of many lines the stack has less room than it asked for.
        let tall = chart(&long.repeat(3)).into();
        for panels in [vec![stack()], vec![tall, stack()]] {
            let figure = Figure {
                columns: panels.len(),
                panels,
                ..Figure::default()
            };
            assert_eq!(legible(&figure), Ok(()));
        }
    }

    #[test]
    fn the_judge_of_overlaps_sees_them() {
        let words = |text: &str| Shape::text([0.0, 0.0], text, TextPlacement::Left);
        let drawing = |shapes| Drawing {
            shapes,
            ..Drawing::default()
        };
        let one = Figure {
            panels: vec![drawing(vec![words("A")]).into()],
            ..Figure::default()
        };
        let two = Figure {
            panels: vec![drawing(vec![words("A"), words("B")]).into()],
            ..Figure::default()
        };
        assert_eq!(legible(&one), Ok(()));
        // Words of one point are set apart, so the overlap is made here.
        assert_eq!(legible(&two), Ok(()));
        let (page, mut found) = texts(&two);
        let moved = found.iter().position(|(text, _)| text == "B").unwrap();
        found[moved].1 = found.iter().find(|(text, _)| text == "A").unwrap().1;
        assert!(apart_and_whole(&page, &found).is_err());
        assert_eq!(
            texts(&one).1.iter().filter(|(text, _)| text == "A").count(),
            5
        );
    }

    #[test]
    fn a_page_that_is_too_long_is_an_error() {
        let panels = vec![Chart::default().into(); 40];
        let long = Figure {
            name: "long".to_owned(),
            columns: 1,
            panels,
            ..Figure::default()
        };
        assert!(matches!(png(&long), Err(ReportError::Size { height, .. }) if height > MAX_SIDE));
    }
}
