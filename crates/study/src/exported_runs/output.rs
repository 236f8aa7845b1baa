//! Writes the reduced parameters of two exported runs: table, figure, page and summary.

use super::columns::ColumnNames;
use super::combine::{ExportedRuns, combine_runs};
use super::figures;
use super::sample_errors::SampleErrors;
use super::sampled_model::{SampleInterpolation, SampledModel};
use super::text_table::ExportedTable;
use super::timed_run::wrong;
use super::written_scene::scene_text;
use crate::explain::StudyError;
use crate::number_format::{coordinate_unit, count, digits_within};
use crate::output::{Outcome, Picture};
use crate::page::table_page;
use crate::ranges::extent;
use crate::reduce::column_group;
use crate::reduce::compute::{coefficient_table, inertia_units};
use dwell_dynamics::{Orbit, ReducedState};
use dwell_findings::{Record, Table};
use dwell_page::Page;
use dwell_report::{Block, Document, Files, TableFormat};

/// Part of the reduced model that may be left open by all errors together, before the result is none.
const USELESS: f64 = 0.05;

/// The reduced parameters of two exported runs: of run i (uniform speed) and of run ii (uniform acceleration). Without a given
/// interpolation, the best for their positions is used.
///
/// # Errors
/// [`StudyError`]: a column is missing, the runs do not determine m or contradict each other, or a trigonometric series is
/// requested for positions that are not a whole revolution.
// Long: one result after another.
pub fn reduce_runs(
    name: &str,
    tables: [&ExportedTable; 2],
    names: &ColumnNames,
    interpolation: Option<SampleInterpolation>,
) -> Result<Outcome, StudyError> {
    let runs = combine_runs(tables, names)?;
    let interpolation = interpolation.unwrap_or_else(|| SampleInterpolation::best_for(&runs));
    if interpolation == SampleInterpolation::Trigonometric && !runs.is_whole_revolution {
        let message = "the positions are no whole revolution at equal distances, so there is no trigonometric series";
        let help = "use --interpolation cubic, or export 361 positions from 0° to 360°";
        return Err(wrong(message.to_owned(), help).into());
    }
    let model = SampledModel::new(&runs, interpolation, 1);
    let errors = SampleErrors::of(&runs, interpolation);
    if errors.sum(0) > USELESS {
        let message = format!(
            "the runs leave an error of {:.1e} of the largest m: {:.1e} by the printed digits, {:.1e} by {} interpolation",
            errors.sum(0),
            errors.digits[0],
            errors.interpolation[0],
            interpolation.name()
        );
        return Err(wrong(message, "export more positions, or more digits").into());
    }
    let mut record = Record::default();
    let mut summary = summary(&runs, &model, interpolation, &errors, tables, &mut record);
    let caption = format!(
        "From `{}` and `{}`, {} interpolation between {}.",
        tables[0].file,
        tables[1].file,
        interpolation.name(),
        count(runs.q.len(), "position")
    );
    let figure = figures::figure(&runs, &model, caption);
    let mut files = Files::new();
    let reduced = table(&runs);
    files.add_table(&format!("{name}-reduced"), &reduced, &TableFormat::ALL)?;
    match scene_text(name, &runs, interpolation, tables) {
        Some(text) => {
            summary += &format!(
                "  {name}-scene.toml is a scene of this model: `dwell simulate {name}-scene.toml` with a [motion] of yours\n"
            );
            files.add(format!("{name}-scene.toml"), text);
        }
        None => {
            summary += "  no scene is written: it needs an angle, and cubic or trigonometric interpolation\n";
        }
    }
    let page = page(&summary, &format!("{name}-reduced.png"), &figure.caption);
    let picture = Picture::of_no_scene(format!("{name}-reduced.png"), figure);
    Ok(Outcome {
        summary,
        record,
        files,
        pictures: vec![picture],
        page: Some((format!("{name}-reduced.md"), page)),
        run: Some(Box::new(rows_page(name, tables, &reduced))),
        ..Outcome::default()
    })
}

/// The rows on an HTML page.
fn rows_page(name: &str, [one, two]: [&ExportedTable; 2], reduced: &Table) -> Page {
    let base = Page {
        title: format!("{name}: reduced parameters of exported runs"),
        subtitle: format!("{} and {}", one.file, two.file),
        ..Page::default()
    };
    table_page(base, reduced, column_group)
}

/// Coordinate, m, ½m′, a and b of each reaction at the positions of the runs, as `dwell reduce` of a scene writes them.
fn table(runs: &ExportedRuns) -> Table {
    let reactions = runs.reactions.iter();
    let reactions = reactions.map(|(name, unit)| (&name[..], unit.as_deref().unwrap_or("N")));
    let (coordinate, is_angle) = (&runs.coordinate, runs.is_angle);
    coefficient_table(coordinate, is_angle, reactions, &runs.q, &runs.coefficients)
}

fn summary(
    runs: &ExportedRuns,
    model: &SampledModel,
    interpolation: SampleInterpolation,
    errors: &SampleErrors,
    [one, two]: [&ExportedTable; 2],
    record: &mut Record,
) -> String {
    let unit = coordinate_unit(runs.is_angle);
    let [from, to] = [runs.q[0], runs.q[runs.q.len() - 1]].map(|q| digits_within(q, 0.0, 9));
    let mut text = format!(
        "{} and {}: {} of {} from {from} to {to} {unit}{}\n",
        one.file,
        two.file,
        count(runs.q.len(), "position"),
        runs.coordinate,
        if runs.is_whole_revolution {
            ", a whole revolution"
        } else {
            ""
        }
    );
    record.add_count("positions", runs.q.len());
    for note in &runs.notes {
        text += &format!("  {note}\n");
    }
    let units = inertia_units(runs.is_angle);
    let values: [Vec<f64>; 2] = [
        runs.coefficients.iter().map(|c| c.m).collect(),
        runs.coefficients.iter().map(|c| c.half_dm).collect(),
    ];
    for (k, (name, key)) in [("m   ", "m"), ("½m′ ", "half_dm")].into_iter().enumerate() {
        let ends = extent(values[k].iter().copied());
        let error = errors.sum(k) * ends[0].abs().max(ends[1].abs());
        let [low, high] = ends.map(|value| digits_within(value, error, 9));
        text += &format!("  {name} from {low} to {high} {}\n", units[k]);
        for (end, value) in ["min", "max"].into_iter().zip(ends) {
            record.add_within(format!("{key}.{end}"), units[k], value, error);
        }
    }
    text += &errors_text(runs, interpolation, errors, record);
    text += &format!(
        "  changes of m are the integral of ½m′ within {:.1e} of the largest m\n",
        runs.contradiction
    );
    record.add("contradiction", "", runs.contradiction);
    text + &period_text(runs, model, errors, record)
}

/// The estimated errors, a line for each kind of coefficient.
fn errors_text(
    runs: &ExportedRuns,
    interpolation: SampleInterpolation,
    errors: &SampleErrors,
    record: &mut Record,
) -> String {
    let mut text = format!(
        "  estimated errors between the positions, {} interpolation, relative to the largest value:\n",
        interpolation.name()
    );
    for (k, (name, key)) in [("m", "m"), ("½m′", "half_dm"), ("a", "a"), ("b", "b")]
        .into_iter()
        .enumerate()
    {
        if k >= 2 && runs.reactions.is_empty() {
            continue;
        }
        let (digits, between) = (errors.digits[k], errors.interpolation[k]);
        let resampling = match errors.resampling[k] {
            0.0 => String::new(),
            error => format!(", {error:.1e} by other positions in run ii"),
        };
        text += &format!(
            "    {name}: {digits:.1e} by the printed digits{resampling}, {between:.1e} by the interpolation\n"
        );
        record.add(format!("error.{key}.digits"), "", digits);
        record.add(format!("error.{key}.resampling"), "", errors.resampling[k]);
        record.add(format!("error.{key}.interpolation"), "", between);
    }
    text
}

/// The period of a free motion with unit speed at the first position.
fn period_text(
    runs: &ExportedRuns,
    model: &SampledModel,
    errors: &SampleErrors,
    record: &mut Record,
) -> String {
    let start = ReducedState {
        t: 0.0,
        q: runs.q[0],
        q_dot: 1.0,
    };
    let orbit = if runs.is_whole_revolution {
        Orbit::to_accuracy(model, start, 0.1 * errors.sum(0))
    } else {
        return String::new();
    };
    let Ok(orbit) = orbit else {
        return String::new();
    };
    // T is the integral of the root of m: half its relative error, of the start and of the mean.
    let error = errors.sum(0) * orbit.period;
    record.add_within("period_at_unit_speed", "s", orbit.period, error);
    format!(
        "  a free motion that begins at {} = {:.6} rad with 1 rad/s has a period of {} s (error by digits and interpolation: {error:.1e} s)\n",
        runs.coordinate,
        runs.q[0],
        digits_within(orbit.period, error, 13)
    )
}

fn page(summary: &str, file: &str, caption: &str) -> Document {
    Document {
        title: "Reduced parameters from two exported runs".to_owned(),
        blocks: vec![
            Block::Text(
                "The procedure of Jordi, Zayas and Cardona (2008) with the exported tables of two kinetostatic runs: \
                 T = m q̈ + ½m′ q̇² and F = a q̈ + b q̇² in both runs give m, ½m′, a and b at each position."
                    .to_owned(),
            ),
            Block::Text(format!("```text\n{summary}```")),
            Block::Figure {
                file: file.to_owned(),
                alt: "m, ½m′, a and b over the coordinate".to_owned(),
                caption: caption.to_owned(),
            },
        ],
    }
}
