//! The output of a sweep: table, summary and figure.

use crate::explain::StudyError;
use crate::number_format::{count, digits, digits_within, number};
use crate::output::{Outcome, Picture};
use crate::sweep::compute::{Row, SweepQuantity};
use crate::sweep::figure::figure;
use crate::sweep::output::PreparedSweep;
use crate::sweep::spread::Spread;
use dwell_findings::Record;
use dwell_report::{Column, TableExport as _, TableFormat};
use std::path::Path;

/// Maximum number of messages in a summary.
const MAX_LISTED: usize = 3;

/// The origin of the rows, and the number of missing ones.
#[derive(Clone, Copy)]
pub(crate) struct Counts {
    pub(crate) existing: usize,
    pub(crate) imported: usize,
    pub(crate) computed: usize,
    pub(crate) missing: usize,
}

pub(crate) fn report_sweep(
    prepared: &PreparedSweep<'_>,
    path: &Path,
    rows: &[Row],
    counts: Counts,
) -> Result<Outcome, StudyError> {
    let mut outcome = Outcome {
        summary: summary(prepared, path, rows, counts),
        record: record(prepared, path, rows, counts),
        ..Outcome::default()
    };
    let (scene, sweep) = (prepared.scene, prepared.sweep);
    // A shard is incomplete: tables and figures are written when all shards are together.
    if sweep.shard.is_some() {
        return Ok(outcome);
    }
    let name = |rest: &str| format!("{}-sweep{rest}", scene.name);
    let only = sweep.export;
    for format in only.map_or(TableFormat::ALL.to_vec(), |only| vec![only]) {
        let bytes = match format {
            TableFormat::Csv => csv(prepared, rows)?.into_bytes(),
            TableFormat::Npz => npz(prepared, rows)?,
        };
        let path = name(&format!(".{}", format.extension()));
        outcome.files.add(path, bytes);
    }
    if sweep.export.is_none() {
        match figure(prepared, rows) {
            Ok((figure, note)) => {
                let picture = Picture::figure(scene, name(".png"), true, figure);
                outcome.pictures.push(picture);
                outcome.summary += &note.map_or(String::new(), |note| format!("  {note}\n"));
            }
            Err(why) => outcome.summary += &format!("  no figure: {why}\n"),
        }
    }
    Ok(outcome)
}

/// The table as arrays, with the index of each row and whether it has a message.
fn npz(prepared: &PreparedSweep<'_>, rows: &[Row]) -> Result<Vec<u8>, StudyError> {
    let mut table = prepared.requested.table(&prepared.design, rows);
    table.columns.insert(0, Column::new("index", ""));
    table.columns.push(Column::new("has_message", ""));
    for (cells, row) in table.rows.iter_mut().zip(rows) {
        cells.insert(0, row.index as f64);
        cells.push(f64::from(u8::from(row.result.message.is_some())));
    }
    Ok(table.npz()?)
}

/// The table with the index of each row before it and its message behind it.
fn csv(prepared: &PreparedSweep<'_>, rows: &[Row]) -> Result<String, StudyError> {
    let numbers = prepared.requested.table(&prepared.design, rows).csv()?;
    let mut lines = numbers.lines();
    let mut text = format!("index,{},message\n", lines.next().unwrap_or_default());
    // One line per row.
    for (line, row) in lines.zip(rows) {
        text += &format!("{},{line},", row.index);
        if let Some(message) = &row.result.message {
            text += &format!("\"{}\"", message.replace('"', "\"\""));
        }
        text.push('\n');
    }
    Ok(text)
}

/// The printed summary.
fn summary(prepared: &PreparedSweep<'_>, path: &Path, rows: &[Row], counts: Counts) -> String {
    let design = &prepared.design;
    let points = count_u64(design.points, "point");
    let mut text = format!("{}: {points}", prepared.scene.title);
    if design.is_random() {
        let samples = count_u64(design.samples, "sample");
        text += &format!(", {samples} with seed {}", design.seed);
    }
    if let Some(shard) = prepared.sweep.shard {
        let points = rows.len() + counts.missing;
        text += &format!(", of which shard {shard} has {points}");
    }
    text += &format!("\n  {}: {}", path.display(), count(rows.len(), "row"));
    let parts = [
        (counts.existing, "already stored"),
        (counts.imported, "imported from shards"),
        (counts.computed, "computed"),
    ];
    let parts = parts.iter().filter(|(n, _)| *n > 0);
    let parts: Vec<String> = parts.map(|(n, words)| format!("{n} {words}")).collect();
    if !parts.is_empty() {
        text += &format!(" ({})", parts.join(", "));
    }
    text.push('\n');
    if counts.missing > 0 {
        text += &format!("  {} not computed yet\n", count(counts.missing, "point"));
    }
    let quantities = &prepared.requested.quantities;
    if quantities.iter().any(SweepQuantity::is_extremum) {
        text += "  smallest and largest values of a motion or a range are searched between its positions, too\n";
    }
    for (k, heading) in prepared.results.iter().enumerate() {
        if let Some(spread) = Spread::of(rows.iter().map(|row| row.result.values[k])) {
            text += &spread_text(heading, &spread, design.is_random());
            text += &best_text(prepared, rows, k);
        }
    }
    text + &failures(rows) + &prepared.requested.notes
}

/// The numbers of the summary.
fn record(prepared: &PreparedSweep<'_>, path: &Path, rows: &[Row], counts: Counts) -> Record {
    let (design, quantities) = (&prepared.design, &prepared.requested.quantities);
    let mut record = Record::default();
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    record.files.push(file.into_owned());
    let failed = rows.iter().filter(|row| row.result.message.is_some());
    for (name, count) in [
        (
            "points",
            usize::try_from(design.points).unwrap_or(usize::MAX),
        ),
        ("rows", rows.len()),
        ("rows.already_stored", counts.existing),
        ("rows.imported", counts.imported),
        ("rows.computed", counts.computed),
        ("points.missing", counts.missing),
        ("points.failed", failed.count()),
    ] {
        record.add_count(name, count);
    }
    if design.is_random() {
        record.add("samples", "", design.samples as f64);
        record.add("seed", "", design.seed as f64);
    }
    for (k, quantity) in quantities.iter().enumerate() {
        let values = rows.iter().map(|row| row.result.values[k]);
        if let Some(spread) = Spread::of(values) {
            let mut add = |what: &str, value| {
                let name = format!("{}.{what}", quantity.name);
                record.add(name, &quantity.unit, value);
            };
            add("smallest", spread.min);
            add("largest", spread.max);
            add("rms", spread.rms);
            add("mean", spread.mean);
            if let Some(deviation) = spread.deviation.filter(|_| design.is_random()) {
                add("mean.standard_error", spread.sampling_errors(deviation)[0]);
                add("standard_deviation", deviation);
                add("quantile_2.5", spread.quantiles[0]);
                add("quantile_97.5", spread.quantiles[1]);
            }
            let ends = ends(rows, k).filter(|_| spread.min < spread.max);
            for (end, row) in ["smallest", "largest"]
                .into_iter()
                .zip(ends.into_iter().flatten())
            {
                for (axis, value) in design.axes.iter().zip(&row.inputs) {
                    let name = format!("{}.{end}.{}", quantity.name, axis.path);
                    record.add(name, &axis.unit, *value);
                }
            }
        }
    }
    record
}

/// The line about a result.
fn spread_text(heading: &str, spread: &Spread, random: bool) -> String {
    let [min, max] = [spread.min, spread.max].map(number);
    let text = format!("  {heading}: from {min} to {max}");
    match spread.deviation.filter(|_| random) {
        None => {
            let [mean, rms] = [spread.mean, spread.rms].map(number);
            format!("{text}, mean {mean}, RMS {rms}\n")
        }
        Some(deviation) => {
            let [low, high] = spread.quantiles.map(number);
            let [mean_error, deviation_error] = spread.sampling_errors(deviation);
            let mean = digits_within(spread.mean, mean_error, 9);
            let deviation = digits_within(deviation, deviation_error, 4);
            let error = digits(mean_error, 2);
            format!(
                "{text}, mean {mean} (standard error {error}), standard deviation {deviation}, 95 % between {low} and {high}\n"
            )
        }
    }
}

/// The points at which a result is smallest and largest; the first of several.
fn ends(rows: &[Row], k: usize) -> Option<[&Row; 2]> {
    let value = |row: &&Row| row.result.values[k];
    let known = || rows.iter().filter(|row| row.result.values[k].is_finite());
    let smallest = known().min_by(|a, b| value(a).total_cmp(&value(b)))?;
    let largest = known().reduce(|a, b| if value(&b) > value(&a) { b } else { a })?;
    Some([smallest, largest])
}

/// The line about where a result is smallest and largest.
fn best_text(prepared: &PreparedSweep<'_>, rows: &[Row], k: usize) -> String {
    let Some(ends) = ends(rows, k).filter(|[a, b]| a.result.values[k] < b.result.values[k]) else {
        return String::new();
    };
    let [smallest, largest] = ends.map(|row| {
        let inputs = prepared.design.axes.iter().zip(&row.inputs);
        let inputs = inputs.map(|(axis, value)| {
            let value = format!("{} = {} {}", axis.path, number(*value), axis.unit);
            value.trim_end().to_owned()
        });
        inputs.collect::<Vec<_>>().join(", ")
    });
    format!("    smallest at {smallest}; largest at {largest}\n")
}

/// The number of failed points, and the first messages.
fn failures(rows: &[Row]) -> String {
    let failed = |row: &'_ Row| Some((row.index, row.result.message.clone()?));
    let failed: Vec<(u64, String)> = rows.iter().filter_map(failed).collect();
    if failed.is_empty() {
        return String::new();
    }
    let (failures, points) = (failed.len(), rows.len());
    let mut text = format!(
        "  {failures} of {points} could not be computed completely; their rows hold the message\n"
    );
    for (index, message) in failed.iter().take(MAX_LISTED) {
        text += &format!("    point {index}: {message}\n");
    }
    if failed.len() > MAX_LISTED {
        text += &format!("    and {} more\n", failed.len() - MAX_LISTED);
    }
    text
}

fn count_u64(number: u64, thing: &str) -> String {
    count(usize::try_from(number).unwrap_or(usize::MAX), thing)
}
