//! The output of a sweep: table, summary and figure.

use crate::explain::StudyError;
use crate::number_format::{count, digits, digits_within, number};
use crate::output::{Outcome, Picture};
use crate::sweep::compute::SweptScene;
use crate::sweep::compute::{Row, SweepQuantity};
use crate::sweep::figure::{Drawn, figure};
use crate::sweep::output::PreparedSweep;
use crate::sweep::parts::{FailedPoints, StoredRows};
use crate::sweep::spread::Spread;
use dwell_findings::Record;
use dwell_report::{Column, TableExport as _, TableFormat};
use std::path::Path;

/// The origin of the rows.
#[derive(Clone, Copy)]
pub(crate) struct Counts {
    pub(crate) existing: usize,
    pub(crate) computed: usize,
}

/// The distribution of a result, and the points at which it is smallest and largest: if there are several, the first; `None` if the
/// result is constant.
struct Statistics {
    spread: Spread,
    ends: Option<[u64; 2]>,
}

/// The data of the summary and its record.
struct SweepReport<'a, S> {
    prepared: &'a PreparedSweep<'a, S>,
    path: &'a Path,
    counts: Counts,
    /// Number of stored points.
    stored: usize,
    /// By result.
    statistics: Vec<Option<Statistics>>,
    failed: FailedPoints,
}

pub(crate) fn report_sweep(
    prepared: &PreparedSweep<'_, impl SweptScene>,
    path: &Path,
    stored: &StoredRows<'_>,
    counts: Counts,
) -> Result<Outcome, StudyError> {
    let results = 0..prepared.results.len();
    let statistics = results.map(|k| Ok(Statistics::of(&stored.values(k)?, stored)));
    let report = SweepReport {
        prepared,
        path,
        counts,
        stored: stored.count(),
        statistics: statistics.collect::<Result<_, StudyError>>()?,
        failed: stored.failed()?,
    };
    let mut record = report.counts();
    let mut outcome = Outcome {
        summary: report.summary(&mut record),
        record,
        ..Outcome::default()
    };
    let (scene, sweep) = (prepared.scene, prepared.sweep);
    // A shard is incomplete: tables and figures are written when all shards are together.
    if sweep.shard.is_some() {
        return Ok(outcome);
    }
    let name = |rest: &str| format!("{}-sweep{rest}", scene.name);
    if let Some(format) = sweep.export {
        let rows = stored.rows()?;
        let bytes = match format {
            TableFormat::Csv => csv(prepared, &rows)?.into_bytes(),
            TableFormat::Npz => npz(prepared, &rows)?,
        };
        let path = name(&format!(".{}", format.extension()));
        outcome.files.add(path, bytes);
    }
    match figure(prepared, stored, report.failed.count)? {
        Drawn::Figure(figure, note) => {
            let picture = Picture::figure(scene, name(".png"), true, *figure);
            outcome.pictures.push(picture);
            outcome.summary += &note.map_or(String::new(), |note| format!("  {note}\n"));
        }
        Drawn::Nothing(why) => outcome.summary += &format!("  no figure: {why}\n"),
    }
    Ok(outcome)
}

impl Statistics {
    fn of(values: &[f64], stored: &StoredRows<'_>) -> Option<Self> {
        let spread = Spread::of(values.iter().copied())?;
        let first = |value: f64| values.iter().position(|v| *v == value);
        let ends = first(spread.min).zip(first(spread.max));
        let ends = ends.filter(|_| spread.min < spread.max);
        let ends = ends.map(|(a, b)| [a, b].map(|position| stored.share().point(position as u64)));
        Some(Self { spread, ends })
    }
}

/// The table as arrays, with the index of each row and whether it has a message.
fn npz(prepared: &PreparedSweep<'_, impl SweptScene>, rows: &[Row]) -> Result<Vec<u8>, StudyError> {
    let mut table = prepared.requested.table(&prepared.design, rows);
    table.columns.insert(0, Column::new("index", ""));
    table.columns.push(Column::new("has_message", ""));
    for (cells, row) in table.rows.iter_mut().zip(rows) {
        cells.insert(0, row.index as f64);
        cells.push(f64::from(u8::from(row.result.message.is_some())));
    }
    Ok(table.npz()?)
}

/// The table; each row starts with its index and ends with its message.
fn csv(prepared: &PreparedSweep<'_, impl SweptScene>, rows: &[Row]) -> Result<String, StudyError> {
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

impl<S: SweptScene> SweepReport<'_, S> {
    /// The printed summary; the numbers in it about the results are recorded.
    fn summary(&self, record: &mut Record) -> String {
        let (prepared, counts) = (self.prepared, self.counts);
        let design = &prepared.design;
        let points = count_u64(design.points, "point");
        let mut text = format!("{}: {points}", prepared.scene.title);
        if design.is_random() {
            let samples = count_u64(design.samples, "sample");
            text += &format!(", {samples} with seed {}", design.seed);
        }
        if let Some(shard) = prepared.sweep.shard {
            text += &format!(", of which shard {shard} has {}", self.stored);
        }
        text += &format!("\n  {}: {}", self.path.display(), count(self.stored, "row"));
        let parts = [
            (counts.existing, "already stored"),
            (counts.computed, "computed"),
        ];
        let parts = parts.iter().filter(|(n, _)| *n > 0);
        let parts: Vec<String> = parts.map(|(n, words)| format!("{n} {words}")).collect();
        if !parts.is_empty() {
            text += &format!(" ({})", parts.join(", "));
        }
        text.push('\n');
        let quantities = &prepared.requested.quantities;
        if quantities.iter().any(SweepQuantity::is_extremum) {
            text += "  smallest and largest values of a motion or a range are searched between its positions, too\n";
        }
        let results = prepared.results.iter().zip(quantities);
        for ((heading, quantity), statistics) in results.zip(&self.statistics) {
            if let Some(statistics) = statistics {
                text += &self.result_text(heading, quantity, statistics, record);
            }
        }
        text + &self.failures() + &prepared.requested.notes
    }

    /// The counts of points.
    fn counts(&self) -> Record {
        let (design, counts) = (&self.prepared.design, self.counts);
        let mut record = Record::default();
        let file = self.path.file_name().unwrap_or_default();
        record.files.push(file.to_string_lossy().into_owned());
        for (name, count) in [
            (
                "points",
                usize::try_from(design.points).unwrap_or(usize::MAX),
            ),
            ("rows", self.stored),
            ("rows.already_stored", counts.existing),
            ("rows.computed", counts.computed),
            ("points.failed", self.failed.count),
        ] {
            record.add_count(name, count);
        }
        if design.is_random() {
            record.add("samples", "", design.samples as f64);
            record.add("seed", "", design.seed as f64);
        }
        record
    }

    /// The lines about a result, whose numbers are recorded: its distribution, and where it is smallest and largest.
    fn result_text(
        &self,
        heading: &str,
        quantity: &SweepQuantity,
        statistics: &Statistics,
        record: &mut Record,
    ) -> String {
        let (design, spread) = (&self.prepared.design, &statistics.spread);
        let mut add = |what: &str, value| {
            let name = format!("{}.{what}", quantity.name);
            record.add(name, &quantity.unit, value);
        };
        add("smallest", spread.min);
        add("largest", spread.max);
        add("rms", spread.rms);
        add("mean", spread.mean);
        let [min, max] = [spread.min, spread.max].map(number);
        let mut text = format!("  {heading}: from {min} to {max}, mean ");
        text += &match spread.deviation.filter(|_| design.is_random()) {
            None => {
                let [mean, rms] = [spread.mean, spread.rms].map(number);
                format!("{mean}, RMS {rms}\n")
            }
            Some(deviation) => {
                let [mean_error, deviation_error] = spread.sampling_errors(deviation);
                add("mean.standard_error", mean_error);
                add("standard_deviation", deviation);
                add("quantile_2.5", spread.quantiles[0]);
                add("quantile_97.5", spread.quantiles[1]);
                let [low, high] = spread.quantiles.map(number);
                let mean = digits_within(spread.mean, mean_error, 9);
                let deviation = digits_within(deviation, deviation_error, 4);
                let error = digits(mean_error, 2);
                format!(
                    "{mean} (standard error {error}), standard deviation {deviation}, 95 % between {low} and {high}\n"
                )
            }
        };
        let Some([smallest, largest]) = statistics.ends else {
            return text;
        };
        let places = [("smallest", smallest), ("largest", largest)].map(|(end, index)| {
            let inputs = design.axes.iter().zip(design.values(index));
            let inputs = inputs.map(|(axis, value)| {
                let name = format!("{}.{end}.{}", quantity.name, axis.path);
                record.add(name, &axis.unit, value);
                let value = format!("{} = {} {}", axis.path, number(value), axis.unit);
                value.trim_end().to_owned()
            });
            format!("{end} at {}", inputs.collect::<Vec<_>>().join(", "))
        });
        text + &format!("    {}\n", places.join("; "))
    }

    /// The number of failed points, and the first messages.
    fn failures(&self) -> String {
        let FailedPoints {
            count,
            left_out,
            first,
        } = &self.failed;
        let points = self.stored;
        let mut text = match left_out {
            0 => String::new(),
            left_out => format!("  {left_out} of {points} are left out by the limits\n"),
        };
        if *count == 0 {
            return text;
        }
        text += &format!(
            "  {count} of {points} could not be computed completely; their rows hold the message\n"
        );
        for (index, message) in first {
            text += &format!("    point {index}: {message}\n");
        }
        if *count > first.len() {
            text += &format!("    and {} more\n", count - first.len());
        }
        text
    }
}

fn count_u64(number: u64, thing: &str) -> String {
    count(usize::try_from(number).unwrap_or(usize::MAX), thing)
}
