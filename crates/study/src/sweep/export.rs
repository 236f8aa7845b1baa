//! A study written up: its table, its summary, its pictures.

use super::spread::Spread;
use super::store::Row;
use super::{Prepared, Sweep, figure};
use crate::error::StudyError;
use crate::outcome::Outcome;
use crate::provenance::picture;
use crate::words::{count, digits, number};
use dwell_report::{Column, Table};
use std::fmt::Write as _;
use std::path::Path;

/// Messages that a summary repeats.
const TOLD: usize = 3;

/// A form in which the rows are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exported {
    /// Text, with the messages.
    Csv,
    /// A NumPy archive.
    Npz,
}

/// Where the rows come from, and how many are not there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) found: usize,
    pub(super) taken: usize,
    pub(super) computed: usize,
    pub(super) missing: usize,
}

pub(super) fn write_up(
    prepared: &Prepared<'_>,
    sweep: &Sweep<'_>,
    path: &Path,
    rows: &[Row],
    counts: Counts,
) -> Result<Outcome, StudyError> {
    let mut outcome = Outcome {
        summary: summary(prepared, sweep, path, rows, counts),
        ..Outcome::default()
    };
    // A shard is half a study: it is written up where all of them meet.
    if sweep.shard.is_some() {
        return Ok(outcome);
    }
    let scene = prepared.scene;
    let name = |rest: &str| format!("{}-sweep{rest}", scene.name);
    let wants = |form| sweep.export.is_none_or(|only| only == form);
    if wants(Exported::Csv) {
        outcome.files.add(name(".csv"), csv(prepared, rows)?);
    }
    if wants(Exported::Npz) {
        outcome.files.add(name(".npz"), archive(prepared, rows)?);
    }
    if sweep.export.is_none() {
        match figure::figure(prepared, rows) {
            Ok((figure, note)) => {
                outcome.files.add(name(".png"), picture(scene, &figure)?);
                outcome.summary += &note.map_or(String::new(), |note| format!("  {note}\n"));
            }
            Err(why) => outcome.summary += &format!("  no picture: {why}\n"),
        }
    }
    Ok(outcome)
}

/// Inputs and results.
fn table(prepared: &Prepared<'_>, rows: &[Row]) -> Table {
    let axes = prepared.design.axes.iter();
    let results = prepared.wanted.quantities.iter();
    let mut columns: Vec<Column> = axes.map(|a| Column::new(&a.path, &a.unit)).collect();
    columns.extend(results.map(|q| Column::new(&q.name, q.unit)));
    let row = |row: &Row| [row.inputs.as_slice(), &row.found.values].concat();
    Table {
        columns,
        rows: rows.iter().map(row).collect(),
    }
}

/// The table as arrays, with the index of each row and whether it has a message.
fn archive(prepared: &Prepared<'_>, rows: &[Row]) -> Result<Vec<u8>, StudyError> {
    let mut table = table(prepared, rows);
    table.columns.insert(0, Column::new("index", ""));
    table.columns.push(Column::new("failed", ""));
    for (cells, row) in table.rows.iter_mut().zip(rows) {
        cells.insert(0, row.index as f64);
        cells.push(f64::from(u8::from(row.found.message.is_some())));
    }
    Ok(table.npz()?)
}

/// The table with the index of each row before it and its message behind it.
fn csv(prepared: &Prepared<'_>, rows: &[Row]) -> Result<String, StudyError> {
    let numbers = table(prepared, rows).csv()?;
    let mut lines = numbers.lines();
    let mut text = format!("index,{},message\n", lines.next().unwrap_or_default());
    // No number has a line of its own.
    for (line, row) in lines.zip(rows) {
        let _ = write!(text, "{},{line},", row.index);
        if let Some(message) = &row.found.message {
            let _ = write!(text, "\"{}\"", message.replace('"', "\"\""));
        }
        text.push('\n');
    }
    Ok(text)
}

fn summary(
    prepared: &Prepared<'_>,
    sweep: &Sweep<'_>,
    path: &Path,
    rows: &[Row],
    counts: Counts,
) -> String {
    let design = &prepared.design;
    let mut text = format!("{}: {}", prepared.scene.title, of_points(design.points));
    if design.is_random() {
        let _ = write!(
            text,
            ", {} of seed {}",
            count_of(design.samples, "sample"),
            design.seed
        );
    }
    if let Some(shard) = sweep.shard {
        let _ = write!(
            text,
            ", of which shard {shard} has {}",
            rows.len() + counts.missing
        );
    }
    let _ = write!(text, "\n  {}: {}", path.display(), count(rows.len(), "row"));
    let parts = [
        (counts.found, "were there"),
        (counts.taken, "taken over from shards"),
        (counts.computed, "computed"),
    ];
    let parts: Vec<String> = parts
        .iter()
        .filter(|(n, _)| *n > 0)
        .map(|(n, words)| format!("{n} {words}"))
        .collect();
    if !parts.is_empty() {
        let _ = write!(text, " ({})", parts.join(", "));
    }
    text.push('\n');
    if counts.missing > 0 {
        let _ = writeln!(
            text,
            "  {} still to be computed",
            of_points(counts.missing as u64)
        );
    }
    for (k, heading) in prepared.results.iter().enumerate() {
        let values = rows.iter().map(|row| row.found.values[k]);
        let Some(spread) = Spread::of(values) else {
            continue;
        };
        let _ = write!(
            text,
            "  {heading}: from {} to {}",
            number(spread.least),
            number(spread.most)
        );
        if let Some(deviation) = spread.deviation.filter(|_| design.is_random()) {
            let [low, high] = spread.limits.map(number);
            let _ = write!(
                text,
                ", mean {}, standard deviation {}, 95 % between {low} and {high}",
                digits(spread.mean, 9),
                digits(deviation, 4)
            );
        }
        text.push('\n');
    }
    text + &failures(rows)
}

/// What could not be computed, and the first reasons.
fn failures(rows: &[Row]) -> String {
    let failed: Vec<(u64, &str)> = rows
        .iter()
        .filter_map(|row| Some((row.index, row.found.message.as_deref()?)))
        .collect();
    if failed.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "  {} of {} could not be computed, or not in all; their rows say why\n",
        failed.len(),
        rows.len()
    );
    for (index, message) in failed.iter().take(TOLD) {
        let _ = writeln!(text, "    point {index}: {message}");
    }
    if failed.len() > TOLD {
        let _ = writeln!(text, "    and {} more", failed.len() - TOLD);
    }
    text
}

fn of_points(points: u64) -> String {
    count_of(points, "point")
}

fn count_of(number: u64, thing: &str) -> String {
    count(usize::try_from(number).unwrap_or(usize::MAX), thing)
}
