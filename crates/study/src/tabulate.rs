//! `dwell reduce --table`: the whole reduced model as a file that gives it back without the mechanism.

use crate::channels::loaded;
use crate::error::{StudyError, not_one_actuator};
use crate::motion_error::explain_motion;
use crate::outcome::Outcome;
use crate::prepare::Prepared;
use crate::words::number;
use dwell_geometry::{Plan, Range};
use dwell_kinetostatics::table::Labels;
use dwell_kinetostatics::{Entry, Exact, Extent, Table, TableError};
use dwell_scene::{Place, Scene};
use std::f64::consts::TAU;

/// A table that is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tabulation {
    /// As a part of the largest value of each coefficient.
    pub accuracy: f64,
    /// From where to where, in the scene's unit; none for all turns, or all but 2 % of a range at each end.
    pub between: Option<(f64, f64)>,
    /// Whether there is to be a table or an error; else what is known exactly will do where no table can be made.
    pub demanded: bool,
}

/// Adds a table of everything that a scene requests to what a command yields: m, ½m′, a and b of the
/// reactions, w and c of the loads, each to the wanted part of its largest value.
pub(crate) fn tabulate(
    prepared: &Prepared<'_>,
    wanted: &Tabulation,
    outcome: &mut Outcome,
) -> Result<(), StudyError> {
    let scene = prepared.scene;
    let exact = Exact::new(loaded(scene)?).ok_or_else(|| not_one_actuator(scene))?;
    let plan = exact.model().plan();
    // What does not come back is shown over a turn, and tabulated where it is shown.
    let si = |written: f64| scene.si(written, plan.is_angle(0));
    let extent = match (wanted.between, plan.range()) {
        (Some((from, to)), _) => Extent::Between(si(from), si(to)),
        (None, Range::Endless) => Extent::Between(0.0, TAU),
        (None, _) => Extent::Whole,
    };
    let labels = Labels {
        scene: scene.hash(),
        coordinate: prepared.coordinate().to_owned(),
        reactions: prepared
            .reactions()
            .into_iter()
            .map(|(name, _)| name)
            .collect(),
        loads: scene.loads.iter().map(|load| load.name.clone()).collect(),
    };
    let refused = |e: TableError| explain(scene, plan, &labels, &e);
    let table = match Table::new(&exact, wanted.accuracy, extent) {
        Ok(table) => table,
        Err(error) if wanted.demanded => return Err(refused(error)),
        Err(error) => {
            outcome.summary += &format!(
                "  accuracy {:e}: every row evaluated exactly; between them there is no table: {}\n",
                wanted.accuracy,
                refused(error)
            );
            return Ok(());
        }
    };
    if !wanted.demanded {
        outcome.summary += &format!(
            "  accuracy {:e}: every row evaluated exactly, which is less than making a table; between them by a table\n",
            wanted.accuracy
        );
    }
    let text = table.to_text(&labels).map_err(|e| {
        let error = scene.error(e.to_string(), None, &[]);
        StudyError::from(error)
    })?;
    outcome
        .files
        .add(format!("{}.table", scene.name), text.into_bytes());
    outcome.summary += &told(scene, &table);
    Ok(())
}

/// Kind, extent, cells, memory and bound.
fn told(scene: &Scene, table: &Table) -> String {
    let [from, to] = table.extent();
    let kind = match table.turns() {
        Some(1) => "of every turn".to_owned(),
        Some(turns) => format!("of every {turns} turns"),
        None => between(scene, from, to),
    };
    let counts = table
        .cells()
        .into_iter()
        .zip(["m and ½m′", "a and b", "w and c"]);
    let cells: Vec<String> = counts
        .filter(|(cells, _)| *cells > 0)
        .map(|(cells, of)| format!("{cells} of {of}"))
        .collect();
    let [inertia, all] = table.bytes().map(|bytes| bytes.div_ceil(1024));
    format!(
        "  table {kind}: cells {}; {inertia} kB for m and ½m′, {all} kB in all; off by at most {:.1e} of the largest value of each\n",
        cells.join(", "),
        table.bound()
    )
}

/// An extent in the scene's unit.
fn between(scene: &Scene, from: f64, to: f64) -> String {
    let [(from, unit), (to, _)] = [from, to].map(|q| scene.written(q, true));
    format!("from {} to {} {unit}", number(from), number(to))
}

/// A table's error with the names and places of the scene.
fn explain(scene: &Scene, plan: &Plan, labels: &Labels, error: &TableError) -> StudyError {
    let (message, help) = match *error {
        TableError::Exact(e) => return explain_motion(scene, plan, &e.into()),
        TableError::NotReached {
            what,
            reached,
            accuracy,
        } => (
            format!(
                "no table of {accuracy:e}: {} is known to {reached:.1e} of its largest value",
                named(what, labels)
            ),
            "ask for less; next to change points and limit positions the model itself loses digits",
        ),
        TableError::NotPeriodic { what } => (
            format!(
                "no table: {} is not the same a turn later",
                named(what, labels)
            ),
            "a load that winds up has a table over a part of its turns: say --from and --to",
        ),
        TableError::NotSmooth { .. } => (
            error.to_string(),
            "ask for less, or for a smaller part of the range with --from and --to, away from limit positions",
        ),
        TableError::Extent { from, to } => {
            let why = match plan.range().limits() {
                Some((least, most)) if from < to => {
                    format!("the range is {}", between(scene, least, most))
                }
                _ => "its end must be beyond its beginning".to_owned(),
            };
            (
                format!("no table {}: {why}", between(scene, from, to)),
                "give --from and --to within the range, in the scene's unit of angles",
            )
        }
        other => (other.to_string(), "ask for less, such as --table 1e-9"),
    };
    let labels = [(
        Place::Actuator(dwell_geometry::ActuatorId(0)),
        "over this coordinate".to_owned(),
    )];
    scene.error(message, Some(help.to_owned()), &labels).into()
}

/// A coefficient by the names of the scene.
fn named(entry: Entry, labels: &Labels) -> String {
    let name = |of: &[String], i: usize| of.get(i).cloned().unwrap_or_default();
    let (reactions, loads) = (&labels.reactions, &labels.loads);
    match entry {
        Entry::A { reaction } => format!("a of {}", name(reactions, reaction)),
        Entry::B { reaction } => format!("b of {}", name(reactions, reaction)),
        Entry::W { load } => format!("w of {}", name(loads, load)),
        Entry::C { load, reaction } => {
            format!(
                "c of {} and {}",
                name(reactions, reaction),
                name(loads, load)
            )
        }
        _ => entry.to_string(),
    }
}
