//! Writes equilibria: table, figure and summary.

use super::figures;
use crate::equilibria::compute::{EquilibriaResults, compute_equilibria, without_rounding};
use crate::explain::StudyError;
use crate::models::SceneMachine;
use crate::number_format::{coordinate_unit, count, digits};
use crate::output::{Outcome, signed_png};
use dwell_dynamics::{Equilibrium, Stability};
use dwell_report::TableExport as _;
use dwell_scene::Scene;
use std::f64::consts::TAU;

/// The equilibria of a scene: with one coordinate all of its range, with several the one that
/// Newton's method finds from the start.
///
/// # Errors
/// [`StudyError`] when a load depends on time, every position is an equilibrium, or none is found from
/// the start.
pub fn equilibria(scene: &Scene) -> Result<Outcome, StudyError> {
    let results = compute_equilibria(scene)?;
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-equilibria.{rest}", scene.name);
    outcome.files.add(name("csv"), results.table.csv()?);
    if let Some(curves) = &results.curves {
        let figure = figures::equilibria(&results, curves);
        outcome.files.add(name("png"), signed_png(scene, &figure)?);
    }
    outcome.summary = summary(&results);
    Ok(outcome)
}

fn summary(results: &EquilibriaResults<'_>) -> String {
    let (prepared, found) = (&results.prepared, &results.found);
    let (coordinate, is_angle) = prepared.first_free_coordinate();
    let title = &prepared.scene.title;
    let mut text = match results.interval {
        Some([from, to]) => {
            let is_whole_period = is_angle && (to - from) >= TAU * (1.0 - 1e-12);
            let [from, to] = [from, to].map(|q| match is_angle {
                true => format!("{}°", digits(q.to_degrees(), 6)),
                false => format!("{} m", digits(q, 6)),
            });
            let found = match found.len() {
                0 => "no equilibrium".to_owned(),
                1 => "1 equilibrium".to_owned(),
                n => format!("{n} equilibria"),
            };
            let name = prepared.coordinate_name(coordinate);
            let period = match is_whole_period {
                true => ", one revolution around the start",
                false => "",
            };
            format!("{title}: {found} of {name} between {from} and {to}{period}\n")
        }
        None => {
            let free = count(prepared.machine.free().len(), "free coordinate");
            format!(
                "{title}: the equilibrium of {free} that Newton's method finds from the start\n"
            )
        }
    };
    for equilibrium in found {
        text += &describe_equilibrium(prepared, equilibrium);
    }
    text + &prepared.branch_note()
}

/// An equilibrium as text.
pub(crate) fn describe_equilibrium(
    prepared: &SceneMachine<'_>,
    equilibrium: &Equilibrium,
) -> String {
    let start = prepared.initial_state();
    let free = prepared.machine.free().iter().enumerate();
    let positions: Vec<String> = free
        .map(|(k, &i)| {
            let deflection = digits(equilibrium.y[k] - start[k], 6);
            let unit = coordinate_unit(prepared.is_angle(i));
            let position = prepared.describe_coordinate(i, equilibrium.y[k]);
            format!("{position}, {deflection} {unit} from the start")
        })
        .collect();
    let stability = match equilibrium.stability {
        Stability::Asymptotic => "asymptotically stable",
        Stability::Centre => "stable without damping (centre)",
        Stability::Unstable => "unstable",
        Stability::Undecided => "stability is not decided by the linearisation",
    };
    let eigenvalues = describe_eigenvalues(&equilibrium.eigenvalues);
    format!("  {}: {stability}\n{eigenvalues}", positions.join("; "))
}

/// Eigenvalues as text: a complex pair once, with its frequency and damping.
pub(crate) fn describe_eigenvalues(values: &[[f64; 2]]) -> String {
    let one = |&z: &[f64; 2]| {
        let [re, im] = without_rounding(z);
        let size = re.hypot(im);
        let damping = digits(if re == 0.0 { 0.0 } else { -re / size }, 6);
        let [a, b, angular, frequency] = [re, im, size, size / TAU].map(|v| digits(v, 9));
        match im {
            0.0 => format!("    eigenvalue {a} 1/s\n"),
            im if im < 0.0 => String::new(),
            _ => format!(
                "    eigenvalues {a} ± {b}i 1/s: {angular} rad/s = {frequency} Hz, damping ratio {damping}\n"
            ),
        }
    };
    values.iter().map(one).collect()
}
