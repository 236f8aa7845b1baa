//! The output of a sweep: table, summary and figure.

use crate::explain::StudyError;
use crate::number_format::{count, digits, number};
use crate::output::{Outcome, signed_png};
use crate::sweep::compute::Spread;
use crate::sweep::figure::figure;
use crate::sweep::output::{ParameterSweep, PreparedSweep};
use crate::sweep::store::Row;
use dwell_report::TableExport as _;
use dwell_report::{Column, Table, TableFormat};
use std::fmt::Write as _;
use std::path::Path;

/// Maximum number of messages in a summary.
const MAX_LISTED: usize = 3;

/// The origin of the rows, and the number of missing ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) existing: usize,
    pub(crate) imported: usize,
    pub(crate) computed: usize,
    pub(crate) missing: usize,
}

pub(crate) fn report_sweep(
    prepared_sweep: &PreparedSweep<'_>,
    sweep: &ParameterSweep<'_>,
    path: &Path,
    rows: &[Row],
    counts: Counts,
) -> Result<Outcome, StudyError> {
    let mut outcome = Outcome {
        summary: summary(prepared_sweep, sweep, path, rows, counts),
        ..Outcome::default()
    };
    // A shard is incomplete: tables and figures are written when all shards are together.
    if sweep.shard.is_some() {
        return Ok(outcome);
    }
    let scene = prepared_sweep.scene;
    let name = |rest: &str| format!("{}-sweep{rest}", scene.name);
    let wants = |form| sweep.export.is_none_or(|only| only == form);
    for format in TableFormat::ALL.into_iter().filter(|format| wants(*format)) {
        let bytes = match format {
            TableFormat::Csv => csv(prepared_sweep, rows)?.into_bytes(),
            TableFormat::Npz => npz(prepared_sweep, rows)?,
        };
        outcome
            .files
            .add(name(&format!(".{}", format.extension())), bytes);
    }
    if sweep.export.is_none() {
        match figure(prepared_sweep, rows) {
            Ok((figure, note)) => {
                outcome.files.add(name(".png"), signed_png(scene, &figure)?);
                outcome.summary += &note.map_or(String::new(), |note| format!("  {note}\n"));
            }
            Err(why) => outcome.summary += &format!("  no figure: {why}\n"),
        }
    }
    Ok(outcome)
}

/// Inputs and results.
pub(crate) fn table(prepared_sweep: &PreparedSweep<'_>, rows: &[Row]) -> Table {
    let axes = prepared_sweep.design.axes.iter();
    let results = prepared_sweep.requested.quantities.iter();
    let mut columns: Vec<Column> = axes.map(|a| Column::new(&a.path, &a.unit)).collect();
    columns.extend(results.map(|q| Column::new(&q.name, q.unit)));
    let row = |row: &Row| [row.inputs.as_slice(), &row.result.values].concat();
    Table {
        columns,
        rows: rows.iter().map(row).collect(),
    }
}

/// The table as arrays, with the index of each row and whether it has a message.
fn npz(prepared_sweep: &PreparedSweep<'_>, rows: &[Row]) -> Result<Vec<u8>, StudyError> {
    let mut table = table(prepared_sweep, rows);
    table.columns.insert(0, Column::new("index", ""));
    table.columns.push(Column::new("has_message", ""));
    for (cells, row) in table.rows.iter_mut().zip(rows) {
        cells.insert(0, row.index as f64);
        cells.push(f64::from(u8::from(row.result.message.is_some())));
    }
    Ok(table.npz()?)
}

/// The table with the index of each row before it and its message behind it.
pub(crate) fn csv(prepared_sweep: &PreparedSweep<'_>, rows: &[Row]) -> Result<String, StudyError> {
    let numbers = table(prepared_sweep, rows).csv()?;
    let mut lines = numbers.lines();
    let mut text = format!("index,{},message\n", lines.next().unwrap_or_default());
    // One line per row.
    for (line, row) in lines.zip(rows) {
        let _ = write!(text, "{},{line},", row.index);
        if let Some(message) = &row.result.message {
            let _ = write!(text, "\"{}\"", message.replace('"', "\"\""));
        }
        text.push('\n');
    }
    Ok(text)
}

pub(crate) fn summary(
    prepared_sweep: &PreparedSweep<'_>,
    sweep: &ParameterSweep<'_>,
    path: &Path,
    rows: &[Row],
    counts: Counts,
) -> String {
    let design = &prepared_sweep.design;
    let mut text = format!(
        "{}: {}",
        prepared_sweep.scene.title,
        points_text(design.points)
    );
    if design.is_random() {
        let _ = write!(
            text,
            ", {} with seed {}",
            count_u64(design.samples, "sample"),
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
        (counts.existing, "already stored"),
        (counts.imported, "imported from shards"),
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
            "  {} not computed yet",
            points_text(counts.missing as u64)
        );
    }
    for (k, heading) in prepared_sweep.results.iter().enumerate() {
        let values = rows.iter().map(|row| row.result.values[k]);
        let Some(spread) = Spread::of(values) else {
            continue;
        };
        let _ = write!(
            text,
            "  {heading}: from {} to {}",
            number(spread.min),
            number(spread.max)
        );
        if let Some(deviation) = spread.deviation.filter(|_| design.is_random()) {
            let [low, high] = spread.quantiles.map(number);
            let _ = write!(
                text,
                ", mean {}, standard deviation {}, 95 % between {low} and {high}",
                digits(spread.mean, 9),
                digits(deviation, 4)
            );
        }
        text.push('\n');
    }
    text + &failures(rows) + &prepared_sweep.requested.notes
}

/// The number of failed points, and the first messages.
fn failures(rows: &[Row]) -> String {
    let failed: Vec<(u64, &str)> = rows
        .iter()
        .filter_map(|row| Some((row.index, row.result.message.as_deref()?)))
        .collect();
    if failed.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "  {} of {} could not be computed completely; their rows hold the message\n",
        failed.len(),
        rows.len()
    );
    for (index, message) in failed.iter().take(MAX_LISTED) {
        let _ = writeln!(text, "    point {index}: {message}");
    }
    if failed.len() > MAX_LISTED {
        let _ = writeln!(text, "    and {} more", failed.len() - MAX_LISTED);
    }
    text
}

fn points_text(points: u64) -> String {
    count_u64(points, "point")
}

fn count_u64(number: u64, thing: &str) -> String {
    count(usize::try_from(number).unwrap_or(usize::MAX), thing)
}
