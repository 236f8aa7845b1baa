//! The page of an analysis whose results are single numbers: what is printed, its pictures, and every number with its
//! unit and its error.

use super::provenance_line;
use crate::number_format::{digits, digits_within};
use dwell_findings::{Record, RecordedNumber};
use dwell_report::{Block, Document, Figure};
use dwell_scene::SceneFile;

/// Digits of a number of the page; files have all of them.
const DIGITS: usize = 9;

/// The header of the table of numbers.
pub(super) const RESULTS_HEADER: [&str; 4] = ["quantity", "value", "unit", "estimated error"];

/// The page of an analysis, from its summary (whose first line is the heading of the results), its numbers, and its
/// figures with their files.
pub(crate) fn results_page(
    scene: &SceneFile,
    analysis: &str,
    (summary, record): (&str, &Record),
    figures: &[(&Figure, String)],
) -> Document {
    let mut lines = summary.lines();
    let first = lines.next().unwrap_or_default();
    let mut blocks = vec![Block::Text(format!("{}.", plain(first)))];
    blocks.extend(scene.note.clone().map(Block::Words));
    let list: Vec<String> = lines.map(|line| format!("- {}", plain(line))).collect();
    if !list.is_empty() {
        blocks.push(Block::Text(list.join("\n")));
    }
    blocks.extend(figures.iter().map(|(figure, file)| Block::Figure {
        file: file.clone(),
        alt: figure.title.clone(),
        caption: String::new(),
    }));
    blocks.push(Block::Heading("Results".to_owned()));
    blocks.push(Block::Table {
        header: RESULTS_HEADER.map(str::to_owned).into(),
        rows: record.numbers.iter().map(row).collect(),
    });
    let mut methods: Vec<&str> = figures.iter().map(|(f, _)| f.provenance.as_str()).collect();
    methods.dedup();
    let line = std::iter::once(provenance_line(scene));
    let line = line.chain(methods.into_iter().map(str::to_owned));
    blocks.push(Block::Text(line.collect::<Vec<_>>().join(" · ")));
    let title = format!("{}: {analysis}", scene.title);
    Document { title, blocks }
}

/// A printed line as it stands in Markdown: names of a scene may hold what would mark a part of it.
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
