//! Writes the two unit runs and their combination: tables, figures, page and summary.

use super::compute::{ComparedCoefficient, UnitRunScene, UnitRuns, compute_unit_runs};
use crate::explain::{Labels, StudyError, scene_error};
use crate::number_format::{coordinate_unit, count, digits};
use crate::output::{Outcome, Picture, provenance_line};
use crate::page::{scene_page, table_page, unit_group};
use crate::progress::Progress;
use crate::reduce::compute::ReducedScene;
use crate::trajectory::output::TrajectoryOutcome;
use dwell_page::PageTable;
use dwell_report::{Block, Document, Figure, Files, TableFormat};
use dwell_scene::SceneFile;

/// The two kinetostatic runs of a scene over the range of its only actuator, at `points` positions (two or more) if given,
/// and the reduced parameters from them. If these differ from the reduced model, [`TrajectoryOutcome::early_stop`] has the
/// error.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled, has several actuators, or a position cannot be
/// reached.
pub fn unit_runs<S: UnitRunScene>(
    scene: &S,
    points: Option<usize>,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let runs = compute_unit_runs(scene, points, progress)?;
    let comparison = runs.comparison();
    let table = runs.table();
    let mut run = table_page(scene_page(scene, "runs"), &table, unit_group);
    run.subtitle = format!(
        "the two kinetostatic runs and their combination at {}",
        count(table.rows.len(), "position")
    );
    run.drawing = scene.drawing_along(&run.columns[0].values);
    run.tables.push(PageTable {
        title: COMPARED.to_owned(),
        header: COMPARISON_HEADER.map(str::to_owned).into(),
        rows: comparison_rows(&comparison),
    });
    let name = |rest: &str| format!("{}-{rest}", scene.name);
    let mut files = Files::new();
    for (run, table) in ["run-i", "run-ii"].into_iter().zip(&runs.runs) {
        files.add_table(&name(run), table, &TableFormat::ALL)?;
    }
    files.add_table(&name("runs"), &table, &TableFormat::ALL)?;
    let file = |figure: &Figure| name(&format!("{}.png", figure.name));
    let figures = runs.figures();
    let page = Some((name("runs.md"), page(&runs, &comparison, &figures, &file)));
    let pictures = figures.into_iter();
    let pictures = pictures.map(|figure| Picture::figure(scene, file(&figure), true, figure));
    let outcome = Outcome {
        summary: summary(&runs, &comparison),
        files,
        pictures: pictures.collect(),
        page,
        run: Some(Box::new(run)),
        ..Outcome::default()
    };
    Ok(TrajectoryOutcome {
        outcome,
        early_stop: difference_error(scene, &comparison),
    })
}

/// The coefficient with the largest difference relative to its tolerance.
fn worst(comparison: &[ComparedCoefficient]) -> Option<&ComparedCoefficient> {
    let part = |of: &ComparedCoefficient| of.relative_difference / of.tolerance;
    comparison.iter().max_by(|a, b| part(a).total_cmp(&part(b)))
}

fn difference_error(scene: &SceneFile, comparison: &[ComparedCoefficient]) -> Option<StudyError> {
    let worst = worst(comparison)?;
    let agree = worst.relative_difference <= worst.tolerance;
    (!agree).then(|| {
        let message = format!(
            "the combined runs differ from the reduced model: {} by {:.1e} of its largest value, where rounding explains {:.0e}",
            worst.symbol, worst.relative_difference, worst.tolerance
        );
        let help = "the rows of the table show where: next to a dead point the runs lose digits";
        scene_error(scene, message, help, Labels::new())
    })
}

fn summary(runs: &UnitRuns<impl ReducedScene>, comparison: &[ComparedCoefficient]) -> String {
    let (prepared, table) = (&runs.prepared, &runs.runs);
    let name = prepared.coordinate_name();
    let unit = coordinate_unit(prepared.is_angle());
    let positions = count(runs.combined.q.len(), "position");
    let range = [runs.combined.q.first(), runs.combined.q.last()];
    let [from, to] = range.map(|q| digits(q.copied().unwrap_or(0.0), 6));
    let mut text = format!(
        "{}: two kinetostatic runs, {positions} of {name} from {from} to {to} {unit}, without loads\n",
        prepared.file().title
    );
    for (run, table, what) in [
        ("i", &table[0], format!("speed 1 {unit}/s, no acceleration")),
        (
            "ii",
            &table[1],
            format!("acceleration 1 {unit}/s² from rest"),
        ),
    ] {
        let end = table.rows.last().map_or(0.0, |row| row[0]);
        let columns = count(table.columns.len(), "column");
        text += &format!("  run {run}: {what}, {} s, {columns}\n", digits(end, 6));
    }
    if let Some(worst) = worst(comparison) {
        text += &format!(
            "  combined: m₁, ½∂m₁/∂q₁, m_e1, m_e2 are those of `dwell reduce` within {:.0e} of the largest value of each; {} differs most\n",
            power_of_ten_above(worst.relative_difference),
            worst.symbol
        );
    }
    text
}

/// A power of ten that is no less than a positive number; zero for zero.
fn power_of_ten_above(value: f64) -> f64 {
    match value {
        0.0 => 0.0,
        value => 10_f64.powf(value.log10().ceil()),
    }
}

/// The heading, the header and the rows of the comparison with the reduced model.
const COMPARED: &str = "Compared with the reduced model";
const COMPARISON_HEADER: [&str; 5] = [
    "coefficient",
    "largest value",
    "unit",
    "difference, relative",
    "tolerance",
];

fn comparison_rows(comparison: &[ComparedCoefficient]) -> Vec<Vec<String>> {
    let row = |of: &ComparedCoefficient| {
        vec![
            of.symbol.clone(),
            digits(of.largest, 6),
            of.unit.to_owned(),
            format!("{:.1e}", of.relative_difference),
            format!("{:.0e}", of.tolerance),
        ]
    };
    comparison.iter().map(row).collect()
}

fn page(
    runs: &UnitRuns<impl ReducedScene>,
    comparison: &[ComparedCoefficient],
    figures: &[Figure],
    file: &dyn Fn(&Figure) -> String,
) -> Document {
    let mut blocks = vec![
        Block::Text(
            "The procedure of Jordi, Zayas and Cardona (2008): two kinetostatic analyses of prescribed motions give the \
             reduced parameters, m₁ and ½∂m₁/∂q₁ from the actuator's moment T, m_e1 and m_e2 from a reaction F. Loads are left \
             out: each has a run of its own (`dwell reduce` gives w and c)."
                .to_owned(),
        ),
        Block::Text(
            "Run i, q̇ = 1 and q̈ = 0: ½∂m₁/∂q₁ = T/q̇², m_e2 = F/q̇². Run ii, q̈ = 1 from rest: m₁ = (T − ½∂m₁/∂q₁ q̇²)/q̈, \
             m_e1 = (F − m_e2 q̇²)/q̈, with the values of run i at the same position."
                .to_owned(),
        ),
        Block::Heading(COMPARED.to_owned()),
        Block::Table {
            header: COMPARISON_HEADER.map(str::to_owned).into(),
            rows: comparison_rows(comparison),
        },
        Block::Heading("Figures".to_owned()),
    ];
    blocks.extend(figures.iter().map(|figure| Block::Figure {
        file: file(figure),
        alt: figure.title.clone(),
        caption: figure.caption.clone(),
    }));
    blocks.push(Block::Text(provenance_line(runs.prepared.file())));
    Document {
        title: format!("{}: kinetostatic runs", runs.prepared.file().title),
        blocks,
    }
}
