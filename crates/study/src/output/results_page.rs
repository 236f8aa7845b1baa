//! The page of an analysis whose results are single numbers: the printed text, its pictures, and every number with its
//! unit and its error.

use super::{Outcome, Picture, provenance_line};
use crate::number_format::{digits, digits_within};
use dwell_findings::RecordedNumber;
use dwell_report::{Block, Document, Figure};
use dwell_scene::SceneFile;

/// Digits of a number of the page; files have all of them.
const DIGITS: usize = 9;

/// The header of the table of numbers.
pub(super) const RESULTS_HEADER: [&str; 4] = ["quantity", "value", "unit", "estimated error"];

/// Adds the page of an analysis to its outcome, from its summary (whose first line is the heading of the results), its numbers and its
/// figure, if it has one. The names of both files begin with a `stem`.
pub(crate) fn add_results_page(
    outcome: &mut Outcome,
    scene: &SceneFile,
    analysis: &str,
    stem: &str,
    figure: Option<Figure>,
) {
    let (summary, record) = (&outcome.summary, &outcome.record);
    let png = format!("{stem}.png");
    let mut lines = summary.lines();
    let first = lines.next().unwrap_or_default();
    let mut blocks = vec![Block::Text(format!("{}.", plain(first)))];
    blocks.extend(scene.note.clone().map(Block::Words));
    let list: Vec<String> = lines.map(|line| format!("- {}", plain(line))).collect();
    if !list.is_empty() {
        blocks.push(Block::Text(list.join("\n")));
    }
    blocks.extend(figure.iter().map(|figure| Block::Figure {
        file: png.clone(),
        alt: figure.title.clone(),
        caption: String::new(),
    }));
    blocks.push(Block::Heading("Results".to_owned()));
    blocks.push(Block::Table {
        header: RESULTS_HEADER.map(str::to_owned).into(),
        rows: record.numbers.iter().map(row).collect(),
    });
    let method = figure.iter().map(|figure| figure.provenance.clone());
    let line: Vec<String> = [provenance_line(scene)].into_iter().chain(method).collect();
    blocks.push(Block::Text(line.join(" · ")));
    let title = format!("{}: {analysis}", scene.title);
    outcome.page = Some((format!("{stem}.md"), Document { title, blocks }));
    let picture = figure.map(|figure| Picture::figure(scene, png, true, figure));
    outcome.pictures.extend(picture);
}

/// A printed line escaped for Markdown, because names of a scene may contain markup characters.
fn plain(line: &str) -> String {
    let mut text = String::new();
    for c in line.trim().chars() {
        if "\\*_`[]<>#|".contains(c) {
            text.push('\\');
        }
        text.push(c);
    }
    text
}

fn row(number: &RecordedNumber) -> Vec<String> {
    let RecordedNumber {
        name,
        unit,
        value,
        error,
    } = number;
    let (value, error) = match error {
        Some(error) => (
            digits_within(*value, *error, DIGITS),
            format!("{error:.1e}"),
        ),
        None => (digits(*value, DIGITS), String::new()),
    };
    vec![name.clone(), value, unit.clone(), error]
}
