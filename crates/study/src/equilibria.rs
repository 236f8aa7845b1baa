//! `dwell equilibria`: where a machine stays at rest, and how it moves near there.

use crate::driven::Driven;
use crate::error::StudyError;
use crate::figures;
use crate::outcome::Outcome;
use crate::provenance::picture;
use crate::words::{count, digits};
use dwell_dynamics::{Equilibrium, Stability, at_rest, equilibria as over, equilibrium_near};
use dwell_report::{Column, Table};
use dwell_scene::Scene;
use std::f64::consts::TAU;

/// What is left out of a range at each of its ends, where the mechanism no longer determines itself.
const MARGIN: f64 = 1e-3;
/// Where a turn is cut, in parts of it before the start: not opposite the start, where an equilibrium
/// is likely.
const CUT: f64 = 0.47;
/// Positions of the force in the picture.
const POSITIONS: usize = 360;
/// A part of an eigenvalue below this part of its size is rounding.
const ROUNDING: f64 = 1e-9;

/// The equilibria of a scene: of one free coordinate all over its range, of several the one that
/// Newton's method finds from the start.
///
/// # Errors
/// [`StudyError`] when something follows time, every position is an equilibrium, or none is found from
/// the start.
pub fn equilibria(scene: &Scene) -> Result<Outcome, StudyError> {
    let driven = Driven::new(scene)?;
    let (found, interval) = find(&driven)?;
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-equilibria.{rest}", scene.name);
    outcome
        .files
        .add(name("csv"), table(&driven, &found).csv()?);
    if let Some([from, to]) = interval {
        let at = |k: usize| from + (to - from) * k as f64 / POSITIONS as f64;
        let q: Vec<f64> = (0..=POSITIONS).map(at).collect();
        let held = at_rest(&driven.machine, &q).map_err(|e| driven.explain(&e))?;
        let curves = figures::Rested { q, held };
        let marked: Vec<f64> = found.iter().map(|e| e.y[0]).collect();
        let marked_held = at_rest(&driven.machine, &marked).map_err(|e| driven.explain(&e))?;
        let figure = figures::equilibria(&driven, &curves, &found, &marked_held);
        outcome.files.add(name("png"), picture(scene, &figure)?);
    }
    outcome.summary = summary(&driven, &found, interval);
    Ok(outcome)
}

/// Equilibria, and the interval of the only free coordinate over which they are all.
pub(crate) type Found = (Vec<Equilibrium>, Option<[f64; 2]>);

/// The equilibria, and where all were looked for.
pub(crate) fn find(driven: &Driven<'_>) -> Result<Found, StudyError> {
    driven.timeless("an equilibrium")?;
    let interval = interval(driven);
    let found = match interval {
        Some(interval) => over(&driven.machine, interval),
        None => equilibrium_near(&driven.machine, &driven.start()).map(|only| vec![only]),
    };
    Ok((found.map_err(|e| driven.explain(&e))?, interval))
}

/// The range of the only coordinate of the mechanism; of one that turns the turn about the start.
fn interval(driven: &Driven<'_>) -> Option<[f64; 2]> {
    let plan = driven.machine.model().plan();
    if plan.actuators() != 1 {
        return None;
    }
    let range = plan.range();
    if let Some((from, to)) = range.limits() {
        let margin = MARGIN * (to - from);
        return Some([from + margin, to - margin]);
    }
    let turn = match range.period() {
        Some(turn) => turn,
        None if plan.is_angle(0) => TAU,
        None => return None,
    };
    let from = driven.start()[0] - CUT * turn;
    Some([from, from + turn])
}

/// One row for each equilibrium.
fn table(driven: &Driven<'_>, found: &[Equilibrium]) -> Table {
    let start = driven.start();
    let free = driven.machine.free().len();
    let states: Vec<Column> = driven.states();
    let mut columns: Vec<Column> = states[..free].to_vec();
    let deflection = |c: &Column| Column::new(format!("{}.deflection", c.name), c.unit.clone());
    columns.extend(states[..free].iter().map(deflection));
    columns.extend_from_slice(&states[2 * free..]);
    columns.push(Column::new("stable", ""));
    columns.push(Column::new("growth", "1/s"));
    let modes = found.iter().map(|e| e.modes().len()).max().unwrap_or(0);
    for k in 1..=modes {
        columns.push(Column::new(format!("mode {k} frequency"), "rad/s"));
        columns.push(Column::new(format!("mode {k} frequency"), "Hz"));
        columns.push(Column::new(format!("mode {k} damping ratio"), ""));
    }
    let row = |e: &Equilibrium| {
        let mut row = e.y[..free].to_vec();
        row.extend(e.y[..free].iter().zip(&start).map(|(q, start)| q - start));
        row.extend_from_slice(&e.y[2 * free..driven.machine.first_work()]);
        row.push(match e.stability {
            Stability::Asymptotic => 1.0,
            Stability::Centre => 0.0,
            Stability::Unstable => -1.0,
            Stability::Undecided => f64::NAN,
        });
        row.push(e.eigenvalues.first().map_or(f64::NAN, |z| clean(*z)[0]));
        for mode in e.modes() {
            let damping = clean([mode.damping, 1.0])[0];
            row.extend([mode.frequency, mode.frequency / TAU, damping]);
        }
        row.resize(columns.len(), f64::NAN);
        row
    };
    let rows = found.iter().map(row).collect();
    Table { columns, rows }
}

/// An eigenvalue without rounding.
fn clean([re, im]: [f64; 2]) -> [f64; 2] {
    let none = ROUNDING * re.hypot(im);
    [re, im].map(|part| if part.abs() <= none { 0.0 } else { part })
}

fn summary(driven: &Driven<'_>, found: &[Equilibrium], interval: Option<[f64; 2]>) -> String {
    let (only, angle) = driven.only();
    let mut text = match interval {
        Some([from, to]) => {
            let whole = angle && (to - from) >= TAU * (1.0 - 1e-12);
            let far = |q: f64| {
                if angle {
                    format!("{}°", digits(q.to_degrees(), 6))
                } else {
                    format!("{} m", digits(q, 6))
                }
            };
            format!(
                "{}: {} of {} between {} and {}{}\n",
                driven.scene.title,
                match found.len() {
                    0 => "no equilibrium".to_owned(),
                    1 => "1 equilibrium".to_owned(),
                    n => format!("{n} equilibria"),
                },
                driven.name(only),
                far(from),
                far(to),
                if whole {
                    ", a turn about the start"
                } else {
                    ""
                }
            )
        }
        None => format!(
            "{}: the equilibrium that Newton's method finds from the start, of {}\n",
            driven.scene.title,
            count(driven.machine.free().len(), "free coordinate")
        ),
    };
    for equilibrium in found {
        text += &told(driven, equilibrium);
    }
    text
}

/// An equilibrium in words.
pub(crate) fn told(driven: &Driven<'_>, equilibrium: &Equilibrium) -> String {
    let start = driven.start();
    let free = driven.machine.free().iter().enumerate();
    let places: Vec<String> = free
        .map(|(k, &i)| {
            let moved = equilibrium.y[k] - start[k];
            let moved = match driven.is_angle(i) {
                true => format!("{} rad", digits(moved, 6)),
                false => format!("{} m", digits(moved, 6)),
            };
            let place = driven.place(i, equilibrium.y[k]);
            format!("{place}, {moved} from the start")
        })
        .collect();
    let stability = match equilibrium.stability {
        Stability::Asymptotic => "stable: a disturbance dies out",
        Stability::Centre => "stable without damping: a small disturbance swings on",
        Stability::Unstable => "unstable",
        Stability::Undecided => "the linearised motion does not tell whether it is stable",
    };
    let eigenvalues = eigenvalues(&equilibrium.eigenvalues);
    format!("  {}: {stability}\n{eigenvalues}", places.join("; "))
}

/// Eigenvalues in words: a swing once, by its frequency and damping.
pub(crate) fn eigenvalues(values: &[[f64; 2]]) -> String {
    let one = |&z: &[f64; 2]| {
        let [re, im] = clean(z);
        let size = re.hypot(im);
        match im {
            0.0 => format!("    eigenvalue {} 1/s\n", digits(re, 9)),
            im if im < 0.0 => String::new(),
            _ => format!(
                "    eigenvalues {} ± {}i 1/s: {} rad/s = {} Hz, damping ratio {}\n",
                digits(re, 9),
                digits(im, 9),
                digits(size, 9),
                digits(size / TAU, 9),
                digits(if re == 0.0 { 0.0 } else { -re / size }, 6)
            ),
        }
    };
    values.iter().map(one).collect()
}
