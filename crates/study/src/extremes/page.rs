//! Pictures, tables and words of the grid.

use super::grid::{Cell, MOST_TIMES, Measured};
use super::judge::judge;
use crate::error::StudyError;
use crate::outcome::Outcome;
use dwell_findings::{Finding, all_pass};
use dwell_report::{
    Axis, Block, Chart, Column, Document, Figure, Files, Mark, Paint, Series, Stroke, Table, png,
    stable,
};
use rayon::prelude::*;

/// Most digits that a chart shows.
const MOST_DIGITS: f64 = 17.0;
/// Where typed errors stand in a chart of digits.
const REFUSED: f64 = 0.4;
/// The ratios that a chart shows.
const RATIOS: [f64; 2] = [0.1, 1e5];

/// Everything that is written of the grid: `NAME.md`, `NAME.txt` and the folder `NAME/`.
///
/// # Errors
/// [`StudyError`] where a picture cannot be drawn.
pub fn outcome(grid: &[Measured], name: &str) -> Result<Outcome, StudyError> {
    let findings = judge(grid);
    let pages = pages(grid);
    let pictures: Vec<Vec<u8>> = pages.par_iter().map(png).collect::<Result<_, _>>()?;
    let mut files = Files::new();
    for (page, picture) in pages.iter().zip(pictures) {
        files.add(format!("{name}/{}.png", page.name), picture);
    }
    for measured in grid {
        let file = format!("{name}/{}.csv", measured.row.key);
        files.add(file, table(measured).csv()?);
    }
    files.add(format!("{name}.txt"), snapshot(grid, &findings));
    let document = document(grid, name, &pages, &findings);
    files.add(format!("{name}.md"), document.markdown());
    let passed = findings.iter().filter(|f| f.pass).count();
    Ok(Outcome {
        summary: format!(
            "{name}: {passed} of {} findings pass, {} cells\n",
            findings.len(),
            grid.iter().map(|m| m.cells.len()).sum::<usize>()
        ),
        files,
        findings,
    })
}

/// A page for each family of rows: digits on the left, estimates on the right.
fn pages(grid: &[Measured]) -> Vec<Figure> {
    let mut pages: Vec<Figure> = Vec::new();
    for measured in grid {
        let row = &measured.row;
        let (name, title) = row.family;
        if pages.last().is_none_or(|page| page.name != name) {
            pages.push(Figure {
                name: name.to_owned(),
                title: title.to_owned(),
                caption: format!(
                    "Left: decimal digits kept; dashed: the floor stated beforehand; at the foot: typed errors, allowed \
                     where the condition is above 1e8. Right: the estimated error over the true one, which must not be \
                     below 1 and in 95 % of all cells not above {MOST_TIMES}. What the results are held against:"
                ),
                columns: 2,
                ..Figure::default()
            });
        }
        if let Some(page) = pages.last_mut() {
            // Rows of one truth need it but once.
            if !page.caption.contains(row.truth) {
                page.caption += &format!("\n{}: {}.", row.what, row.truth);
            }
            page.panels.push(digits(measured).into());
            page.panels.push(ratios(measured).into());
        }
    }
    pages
}

/// The points of a quantity's cells, where there are any.
fn points(
    measured: &Measured,
    quantity: usize,
    of: impl Fn(&Cell) -> Option<f64>,
) -> Vec<[f64; 2]> {
    let own = measured.cells.iter().filter(|c| c.quantity == quantity);
    own.filter_map(|c| Some([c.at, of(c)?])).collect()
}

fn parameter(measured: &Measured) -> Axis {
    let (label, unit) = measured.row.parameter;
    let values = measured.row.values.iter().copied();
    let (low, high) = (values.clone().reduce(f64::min), values.reduce(f64::max));
    // A little room beside the outermost points, the same on the left and on the right.
    let (low, high) = (low.unwrap_or(1.0), high.unwrap_or(1.0));
    let room = (high / low).powf(0.03);
    Axis::log(label, unit).within(low / room, high * room)
}

fn digits(measured: &Measured) -> Chart {
    let row = &measured.row;
    let mut series = Vec::new();
    let mut floors: Vec<(Vec<[f64; 2]>, Paint)> = Vec::new();
    for (k, quantity) in row.quantities.iter().enumerate() {
        let paint = Paint::Palette(k);
        let kept = points(measured, k, Cell::digits);
        series.push(
            Series::line(*quantity, kept)
                .stroke(Stroke::LineAndPoints)
                .color(paint),
        );
        // A line each where they differ, else one for all.
        let floor = points(measured, k, |c| Some(c.stated.floor.min(MOST_DIGITS)));
        match floors.iter_mut().find(|(known, _)| *known == floor) {
            Some((_, paint)) => *paint = Paint::Grey,
            None => floors.push((floor, paint)),
        }
    }
    for (floor, paint) in floors {
        let dashed = Series::line("", floor).stroke(Stroke::Dashed);
        series.push(dashed.color(paint));
    }
    let refused: Vec<[f64; 2]> = measured
        .cells
        .iter()
        .filter(|c| c.told.is_err())
        .map(|c| [c.at, REFUSED])
        .collect();
    if !refused.is_empty() {
        let marked = Series::line("typed error", refused).stroke(Stroke::Points);
        series.push(marked.color(Paint::Ink));
    }
    Chart {
        title: row.what.clone(),
        x: parameter(measured),
        y: Axis::new("digits kept", "").within(0.0, MOST_DIGITS),
        series,
        ..Chart::default()
    }
}

fn ratios(measured: &Measured) -> Chart {
    let row = &measured.row;
    let named = row.quantities.iter().enumerate();
    let series = named.map(|(k, quantity)| {
        let within = |c: &Cell| Some(c.ratio()?.clamp(RATIOS[0], RATIOS[1]));
        Series::line(*quantity, points(measured, k, within))
            .stroke(Stroke::Points)
            .color(Paint::Palette(k))
    });
    let line = |at: f64| Mark::Horizontal {
        at,
        label: String::new(),
    };
    Chart {
        x: parameter(measured),
        y: Axis::log("estimate / true error", "").within(RATIOS[0], RATIOS[1]),
        series: series.collect(),
        marks: vec![line(1.0), line(MOST_TIMES)],
        ..Chart::default()
    }
}

/// All numbers of a row.
fn table(measured: &Measured) -> Table {
    let row = &measured.row;
    let mut columns = vec![Column::new(row.parameter.0, row.parameter.1)];
    for quantity in row.quantities {
        let kinds = ["", ", truth", ", true error", ", estimate", ", floor"];
        let units = ["", "", "", "", "digits"];
        let own = kinds.iter().zip(units);
        columns.extend(own.map(|(kind, unit)| Column::new(format!("{quantity}{kind}"), unit)));
    }
    let at = |&value: &f64| {
        let mut cells = vec![value];
        for cell in measured.cells.iter().filter(|c| c.at == value) {
            cells.extend(match &cell.told {
                Ok(r) => [r.value, r.truth.hi, r.error(), r.estimate],
                Err(_) => [f64::NAN; 4],
            });
            cells.push(cell.stated.floor);
        }
        cells
    };
    Table {
        columns,
        rows: row.values.iter().map(at).collect(),
    }
}

/// What every machine reproduces: what was stated, and the verdicts.
fn snapshot(grid: &[Measured], findings: &[Finding]) -> String {
    let mut text = "Extremes\n\n".to_owned();
    for measured in grid {
        let row = &measured.row;
        let floors = measured.cells.iter().map(|c| c.stated.floor);
        let least = floors.clone().fold(f64::INFINITY, f64::min);
        let most = floors.fold(0.0, f64::max);
        text += &format!(
            "{}  {} values of {} quantities  floors {most:.1} to {least:.1} digits\n",
            row.key,
            row.values.len(),
            row.quantities.len()
        );
    }
    text + "\n" + &stable(findings)
}

fn document(grid: &[Measured], name: &str, pages: &[Figure], findings: &[Finding]) -> Document {
    let verdict = if all_pass(findings) {
        "pass"
    } else {
        "**FAIL**"
    };
    let header = [
        "Row",
        "Floor, digits",
        "Fewest digits",
        "Typed errors",
        "Estimate / true error",
        "Why this floor",
    ];
    let mut blocks = vec![
        Block::Text(format!(
            "{verdict}. Parameters are driven to their extremes, and the results are held against closed forms in 32 \
             digits. Each row states beforehand how many digits it must keep; below that only a typed error is an \
             answer, and only where the condition is above 1e8. Each result carries an estimate of its error: from the \
             same evaluation in numbers of two words, from a second run at a tenth of the tolerance, or from the \
             change of a period with its start."
        )),
        Block::Table {
            header: header.map(str::to_owned).to_vec(),
            rows: grid.iter().map(told).collect(),
        },
    ];
    blocks.extend(pages.iter().map(|page| Block::Figure {
        file: format!("{name}/{}.png", page.name),
        alt: page.title.clone(),
        caption: page.title.clone(),
    }));
    blocks.push(Block::Heading("Findings".to_owned()));
    blocks.push(Block::Findings(findings.to_vec()));
    Document {
        title: "Extremes".to_owned(),
        blocks,
    }
}

/// A row in words.
fn told(measured: &Measured) -> Vec<String> {
    let cells = &measured.cells;
    let span = |of: &dyn Fn(&Cell) -> Option<f64>| {
        let all = || cells.iter().filter_map(of);
        (
            all().fold(f64::INFINITY, f64::min),
            all().fold(f64::NEG_INFINITY, f64::max),
        )
    };
    let (floor, most) = span(&|c| Some(c.stated.floor));
    let (fewest, _) = span(&Cell::digits);
    let (low, high) = span(&Cell::ratio);
    let refused = cells.iter().filter(|c| c.told.is_err()).count();
    vec![
        measured.row.what.clone(),
        format!("{most:.1} to {floor:.1}"),
        format!("{fewest:.1}"),
        format!("{refused} of {}", cells.len()),
        format!("{low:.2} to {high:.0}"),
        measured.row.why.to_owned(),
    ]
}
