//! `dwell reduce --table-accuracy`: the whole reduced model as an interpolation table, usable without the mechanism.

use super::{ReducedScene, TabulatedScene};
use crate::explain::{self, StudyError, scene_error};
use crate::number_format::number;
use dwell_findings::Record;
use dwell_geometry::{ActuatorId, Range};
use dwell_kinetostatics::table::Labels;
use dwell_kinetostatics::{TableDomain, TableError, TableQuantity, TabulatedModel};
use dwell_scene::{SceneFile, SceneLocation};
use std::f64::consts::TAU;

/// The requested table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableRequest {
    /// Relative to the largest value of each coefficient.
    pub accuracy: f64,
    /// Interval in the scene's unit; `None` for a full period, or the range without 2 % at each end.
    pub interval: Option<(f64, f64)>,
    /// Whether a missing table is an error; otherwise the exactly evaluated rows suffice.
    pub required: bool,
}

/// A table as text, with the lines of the summary about it.
pub struct Tabulation {
    /// Lines of the summary.
    pub summary: String,
    /// The numbers in them.
    pub record: Record,
    /// The table; `None` if none could be built and none was required.
    pub text: Option<String>,
}

/// Builds a table of m, ½m′, a and b of the requested reactions, and w and c of the loads, each to the required
/// accuracy relative to its largest value.
pub fn tabulate(
    prepared: &dyn TabulatedScene,
    request: &TableRequest,
) -> Result<Tabulation, StudyError> {
    let scene = prepared.file();
    if !prepared.is_angle() {
        return Err(scene_error(
            scene,
            "tables are of driven angles: this actuator drives a length",
            "leave --table-accuracy and --accuracy out, and use the rows of the file; or drive an angle",
            [(SceneLocation::Actuator(ActuatorId(0)), "drives a length")],
        ));
    }
    // Without a period the curves cover one revolution, and so does the table.
    let si = |written: f64| scene.to_si(written, true);
    let extent = match (request.interval, prepared.range()) {
        (Some((from, to)), _) => TableDomain::Between(si(from), si(to)),
        (None, Range::Unbounded) => TableDomain::Between(0.0, TAU),
        (None, _) => TableDomain::Full,
    };
    let reactions = prepared.reaction_units().into_iter();
    let labels = Labels {
        scene: scene.hash(),
        coordinate: prepared.coordinate_name().to_owned(),
        reactions: reactions.map(|(name, _)| name).collect(),
        loads: prepared.load_names(),
    };
    let accuracy = request.accuracy;
    let rows = format!("  accuracy {accuracy:e}: all rows evaluated exactly");
    let mut record = Record::default();
    record.add("table.accuracy", "", accuracy);
    let table = match prepared.tabulated(request.accuracy, extent)? {
        Ok(table) => table,
        Err(error) => {
            let error = explain_table_error(prepared, &labels, &error);
            if request.required {
                return Err(error);
            }
            return Ok(Tabulation {
                summary: format!("{rows}; no table for values between them: {error}\n"),
                record,
                text: None,
            });
        }
    };
    let cheaper = if request.required {
        String::new()
    } else {
        format!("{rows} (cheaper than building a table); use the table between rows\n")
    };
    let text = table.to_text(&labels);
    let text = text.map_err(|e| scene_error(scene, e.to_string(), "", explain::Labels::new()))?;
    Ok(Tabulation {
        summary: cheaper + &describe_table(scene, &table, &mut record),
        record,
        text: Some(text),
    })
}

/// Domain, cells, memory and error bound.
fn describe_table(scene: &SceneFile, table: &TabulatedModel, record: &mut Record) -> String {
    let [from, to] = table.domain();
    record.add("table.from", "rad", from);
    record.add("table.to", "rad", to);
    let kind = match table.revolutions() {
        Some(1) => "over a full revolution".to_owned(),
        Some(revolutions) => format!("over a period of {revolutions} revolutions"),
        None => interval_text(scene, from, to),
    };
    let parts = ["m and ½m′", "a and b", "w and c"];
    let counts = table.cells().into_iter().zip(parts);
    let counts = counts.filter(|(cells, _)| *cells > 0);
    let cells = counts.map(|(cells, of)| format!("{cells} of {of}"));
    let cells: Vec<String> = cells.collect();
    let [inertia, all] = table.bytes().map(|bytes| bytes.div_ceil(1024));
    for (cells, of) in table.cells().into_iter().zip(["m", "a", "w"]) {
        record.add_count(format!("table.cells.{of}"), cells);
    }
    record.add("table.size.m", "kB", inertia as f64);
    record.add("table.size", "kB", all as f64);
    record.add("table.error", "", table.max_bound());
    if let Some(revolutions) = table.revolutions() {
        record.add("table.revolutions", "", f64::from(revolutions));
    }
    format!(
        "  table {kind}: cells {}; {inertia} kB for m and ½m′, {all} kB in all; error at most {:.1e} of the largest value of each\n",
        cells.join(", "),
        table.max_bound()
    )
}

/// An interval in the scene's unit.
fn interval_text(scene: &SceneFile, from: f64, to: f64) -> String {
    let [(from, unit), (to, _)] = [from, to].map(|q| scene.to_scene_unit(q, true));
    format!("from {} to {} {unit}", number(from), number(to))
}

/// Explains a table's error with names and locations of the scene.
fn explain_table_error(
    prepared: &dyn ReducedScene,
    labels: &Labels,
    error: &TableError,
) -> StudyError {
    let scene = prepared.file();
    let (message, help) = match *error {
        TableError::Exact(e) => return prepared.explain_evaluation(&e),
        TableError::NotReached {
            what,
            reached,
            accuracy,
        } => (
            format!(
                "no table of accuracy {accuracy:e}: {} is known only to {reached:.1e} of its largest value",
                coefficient_name(what, labels)
            ),
            "require less accuracy; next to change points and limit positions the model itself loses digits",
        ),
        TableError::NotPeriodic { what } => {
            let what = coefficient_name(what, labels);
            let help = "a load that depends on the number of revolutions needs an interval: give --table-from and --table-to";
            (
                format!("no table: {what} is not periodic over a revolution"),
                help,
            )
        }
        TableError::NotSmooth { .. } | TableError::TooNarrow { .. } => (
            error.to_string(),
            "require less accuracy, or a smaller part of the range with --table-from and --table-to, away from limit positions",
        ),
        TableError::Domain { from, to } => {
            let reason = match prepared.range().limits() {
                Some((lower, upper)) if from < to => {
                    format!("the range is {}", interval_text(scene, lower, upper))
                }
                _ => "its end must be greater than its beginning".to_owned(),
            };
            (
                format!("no table {}: {reason}", interval_text(scene, from, to)),
                "give --table-from and --table-to within the range, in the scene's unit of angles",
            )
        }
        other => (
            other.to_string(),
            "require less accuracy, such as --table-accuracy 1e-9",
        ),
    };
    let place = SceneLocation::Actuator(ActuatorId(0));
    scene_error(scene, message, help, [(place, "over this coordinate")])
}

/// The name of a coefficient, with the names of the scene.
fn coefficient_name(entry: TableQuantity, labels: &Labels) -> String {
    let name = |of: &[String], i: usize| of.get(i).cloned().unwrap_or_default();
    let (reactions, loads) = (&labels.reactions, &labels.loads);
    match entry {
        TableQuantity::A { reaction } => format!("a of {}", name(reactions, reaction)),
        TableQuantity::B { reaction } => format!("b of {}", name(reactions, reaction)),
        TableQuantity::W { load } => format!("w of {}", name(loads, load)),
        TableQuantity::C { load, reaction } => {
            let (reaction, load) = (name(reactions, reaction), name(loads, load));
            format!("c of {reaction} and {load}")
        }
        _ => entry.to_string(),
    }
}
