//! `dwell kinematics`, `dwell statics`, `dwell kinetostatics`: a mechanism followed along a prescribed
//! motion or a sweep, as tables, peaks and pictures.

mod columns;
mod document;
mod doubt;
mod dyads;
mod leverage;
mod link;
mod most;
mod need;
mod peaks;
mod record;
mod select;
mod stop;
mod watch;
mod way;

pub(crate) use columns::{Column, Quantity};
pub(crate) use link::Link;
pub(crate) use most::most;
pub(crate) use need::wanted;
pub(crate) use record::{Record, model, with_loads};
pub(crate) use select::{check as check_variables, is_named};
pub(crate) use watch::broken_relation;
pub(crate) use way::{Sample, Told, Way, over_range};

use crate::error::StudyError;
use crate::figures;
use crate::outcome::{Outcome, Progress, Step};
use crate::provenance;
use dwell_kinetostatics::Model;
use dwell_report::{Figure, ReportError, Table};
use dwell_scene::Scene;
use rayon::prelude::*;

/// Which of the three.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Positions, speeds and accelerations.
    Kinematics,
    /// Actions and reactions under the loads, at rest in every position.
    Statics,
    /// Actions and reactions under the loads and the inertia of the motion.
    Kinetostatics,
    /// The free motion, with all that acts in it.
    Simulate,
}

impl Command {
    /// As the command is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kinematics => "kinematics",
            Self::Statics => "statics",
            Self::Kinetostatics => "kinetostatics",
            Self::Simulate => "motion",
        }
    }
}

/// What a run along a way yields.
#[derive(Debug)]
pub struct Followed {
    /// What was found, up to where it ended.
    pub outcome: Outcome,
    /// Why it ended before the end of the way, if it did.
    pub stopped: Option<StudyError>,
}

/// Positions in a unit of progress.
const PART: usize = 500;

/// Follows a scene along its prescribed motion, its sweep, or the range of its only actuator, at
/// `points` positions (two or more) if these are given.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be put together, the scene does not say where its
/// actuators are, a requested column does not exist, or the first position cannot be reached.
pub fn run(
    scene: &Scene,
    command: Command,
    points: Option<usize>,
    progress: Progress<'_>,
) -> Result<Followed, StudyError> {
    let model = record::model(scene)?;
    select::check(scene, &model)?;
    let way = Way::new(scene, model.plan(), command, points)?;
    write_up(scene, &model, &way, command, progress)
}

/// Follows a scene along a way, and writes up what was found.
///
/// # Errors
/// [`StudyError`] where not even the first position can be reached.
pub(crate) fn write_up(
    scene: &Scene,
    model: &Model,
    way: &Way<'_>,
    command: Command,
    progress: Progress<'_>,
) -> Result<Followed, StudyError> {
    let parts = way.points.div_ceil(PART);
    let heard = |k: usize| {
        if k.is_multiple_of(PART) {
            progress(Step {
                total: parts + 1,
                done: "positions",
            });
        }
    };
    let record = record::follow(scene, model, way, command, &heard)?;
    let stopped = record.stop.as_ref();
    let stopped = stopped.map(|stop| stop.explain(scene, model.plan(), way));
    let chosen = select::chosen(scene, &record.columns);
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-{}{rest}", scene.name, command.name());
    let table = table(&record, &chosen);
    outcome.files.add(name(".csv"), table.csv()?);
    outcome.files.add(name(".npz"), table.npz()?);
    let document = document::Document::new(scene, &record, way, command, &chosen);
    outcome.files.add(name("-peaks.csv"), document.peaks_csv());
    for link in &record.links {
        let of = link.name(scene.mechanism.body_name(link.request.body));
        let file = |rest: &str| name(&format!("-section-{of}{rest}.csv"));
        outcome.files.add(file(""), link.table().csv()?);
        outcome
            .files
            .add(file("-envelope"), link.envelope_table().csv()?);
    }
    let (pictures, left_out) = figures::run(scene, &record, way, command);
    let total = parts + pictures.len() + 1;
    let drawn = draw(scene, &pictures, total, progress)?;
    for (figure, bytes) in pictures.iter().zip(drawn) {
        outcome
            .files
            .add(name(&format!("-{}.png", figure.name)), bytes);
    }
    let film = figures::film(scene, &record, way);
    outcome
        .files
        .add(name("-mechanism.gif"), provenance::film(scene, film)?);
    progress(Step {
        total,
        done: "animation",
    });
    let file = |figure: &Figure| name(&format!("-{}.png", figure.name));
    outcome
        .files
        .add(name(".md"), document.markdown(&pictures, &file));
    outcome.summary = document.summary();
    if let Some(note) = left_out {
        outcome.summary += &format!("  {note}\n");
    }
    Ok(Followed { outcome, stopped })
}

fn draw(
    scene: &Scene,
    pictures: &[Figure],
    total: usize,
    progress: Progress<'_>,
) -> Result<Vec<Vec<u8>>, ReportError> {
    let one = |figure: &Figure| {
        let bytes = provenance::picture(scene, figure)?;
        progress(Step {
            total,
            done: &figure.name,
        });
        Ok(bytes)
    };
    pictures.par_iter().map(one).collect()
}

/// The chosen columns as a table.
fn table(record: &Record, chosen: &[usize]) -> Table {
    let column = |&k: &usize| {
        let column = &record.columns[k];
        dwell_report::Column::new(column.name.clone(), column.unit)
    };
    let row = |row: &Vec<f64>| chosen.iter().map(|&k| row[k]).collect();
    Table {
        columns: chosen.iter().map(column).collect(),
        rows: record.rows.iter().map(row).collect(),
    }
}
