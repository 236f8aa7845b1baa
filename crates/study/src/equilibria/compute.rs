//! Finds equilibria and tabulates them.

use crate::explain::StudyError;
use crate::machines::{MachineScene, SceneMachine};
use crate::ranges::{equally_spaced, extent};
use dwell_dynamics::{
    DynamicsError, Equilibrium, Stability, equilibria as equilibria_over, equilibria_from_starts,
    equilibrium_near, static_force_and_potential,
};
use dwell_findings::{Column, Table};
use dwell_kinetostatics::{MachineModel as _, ReducibleModel as _};
use dwell_scene::PlaneScene;
use std::f64::consts::TAU;

/// Static force (N·m or N) and potential (J) over the coordinate.
pub struct StaticCurves {
    /// Coordinates, rad or m.
    pub q: Vec<f64>,
    /// Force and potential at each.
    pub force_and_potential: Vec<[f64; 2]>,
    /// Force and potential at each equilibrium.
    pub at_equilibria: Vec<[f64; 2]>,
}

/// Fraction of a range left out at each end, where the configuration is singular.
const MARGIN: f64 = 1e-3;
/// Lower end of the search interval, in periods before the start: not opposite the start, where an
/// equilibrium is likely.
const CUT_FRACTION: f64 = 0.47;
/// Positions of the force in the figure.
const POSITIONS: usize = 360;
/// Starts of the search for one free coordinate, which double with each further one, and their highest number.
const STARTS: usize = 200;
const MAX_STARTS: usize = 3200;
/// Range of a length on both sides of the start, in sizes of the mechanism.
const LENGTH_RANGE: f64 = 2.0;

/// The range in which equilibria were searched for.
#[derive(Debug, Clone, PartialEq)]
pub enum SearchedRange {
    /// The interval of the only coordinate of the mechanism, rad or m, in which all are found.
    Interval([f64; 2]),
    /// The number of starts within the ranges of the free coordinates, rad or m. An equilibrium to which no start leads
    /// is not found.
    Starts {
        /// How many.
        starts: usize,
        /// By free coordinate.
        ranges: Vec<[f64; 2]>,
    },
}

/// Finds the equilibria.
pub(crate) fn find_equilibria(
    prepared: &SceneMachine<'_, impl MachineScene>,
) -> Result<(Vec<Equilibrium>, SearchedRange), StudyError> {
    prepared.require_autonomous("an equilibrium")?;
    let (machine, start) = (&prepared.machine, prepared.initial_state());
    let searched = match searched_range(prepared) {
        SearchedRange::Interval(interval) => {
            SearchedRange::Interval(prepared.covered_interval(interval)?)
        }
        starts @ SearchedRange::Starts { .. } => {
            prepared.require_covered(&start, "at the start")?;
            starts
        }
    };
    let found = match &searched {
        SearchedRange::Interval(interval) => equilibria_over(machine, *interval)
            .and_then(|found| found.into_iter().map(|e| nearest_to(prepared, e)).collect()),
        SearchedRange::Starts { starts, ranges } => {
            equilibria_from_starts(machine, &start, ranges, *starts).map(|mut found| {
                // Beyond the end of a table nothing is known of its load.
                found.retain(|e| prepared.uncovered(&e.y).is_none());
                found
            })
        }
    };
    Ok((found.map_err(|e| prepared.explain(&e))?, searched))
}

/// An equilibrium; where every position of an interval is one, that at the start if the start is within.
fn nearest_to(
    prepared: &SceneMachine<'_, impl MachineScene>,
    found: Equilibrium,
) -> Result<Equilibrium, DynamicsError> {
    let start = prepared.initial_state();
    let holds_start = found.neutral.iter().any(|neutral| {
        let extent = neutral.extent;
        extent.is_some_and(|[from, to]| (from..=to).contains(&start[0]))
    });
    if !holds_start {
        return Ok(found);
    }
    Ok(Equilibrium {
        neutral: found.neutral,
        stability: found.stability,
        ..equilibrium_near(&prepared.machine, &start)?
    })
}

/// The range of the only coordinate of the mechanism; if it is unlimited, one period around the start. With several
/// coordinates one revolution around the start of each free angle, and lengths around the start.
fn searched_range(prepared: &SceneMachine<'_, impl MachineScene>) -> SearchedRange {
    let model = prepared.machine.model();
    let start = prepared.initial_state();
    if model.actuators() == 1 {
        let range = model.range();
        if let Some((from, to)) = range.limits() {
            let margin = MARGIN * (to - from);
            return SearchedRange::Interval([from + margin, to - margin]);
        }
        let period = range.period().or(model.is_angle(0).then_some(TAU));
        if let Some(period) = period {
            let from = start[0] - CUT_FRACTION * period;
            return SearchedRange::Interval([from, from + period]);
        }
    }
    let length = LENGTH_RANGE * model.size();
    let sticks = prepared.machine.contact_loads().next().is_some();
    if model.actuators() == 1 && sticks {
        // Friction that holds has intervals, which no search from single starts finds.
        return SearchedRange::Interval([start[0] - length, start[0] + length]);
    }
    let free = prepared.machine.free();
    let range = |(&i, q): (&usize, &f64)| {
        if model.is_angle(i) {
            [q - CUT_FRACTION * TAU, q + (1.0 - CUT_FRACTION) * TAU]
        } else {
            [q - length, q + length]
        }
    };
    let doublings = free.len().saturating_sub(1).min(8);
    SearchedRange::Starts {
        starts: (STARTS << doublings).min(MAX_STARTS),
        ranges: free.iter().zip(&start).map(range).collect(),
    }
}

/// The smallest and the largest static force (N·m or N) over an interval.
pub(crate) fn force_extent(
    prepared: &SceneMachine<'_, impl MachineScene>,
    interval: [f64; 2],
) -> Result<[f64; 2], StudyError> {
    let values =
        static_force_and_potential(&prepared.machine, &equally_spaced(interval, POSITIONS))
            .map_err(|e| prepared.explain(&e))?;
    Ok(extent(values.into_iter().map(|[force, _]| force)))
}

/// One row per equilibrium.
// Long because columns and rows have the same parts in one order.
fn equilibrium_table(
    prepared: &SceneMachine<'_, impl MachineScene>,
    found: &[Equilibrium],
) -> Table {
    let start = prepared.initial_state();
    let free = prepared.machine.free().len();
    let states: Vec<Column> = prepared.state_columns();
    let mut columns: Vec<Column> = states[..free].to_vec();
    let deflection = |c: &Column| Column::new(format!("{}.deflection", c.name), c.unit.clone());
    columns.extend(states[..free].iter().map(deflection));
    columns.extend_from_slice(&states[2 * free..]);
    columns.push(Column::new("stability", ""));
    columns.push(Column::new("max_real_eigenvalue", "1/s"));
    let has_neutral = found.iter().any(|e| !e.neutral.is_empty());
    let modes = found.iter().map(|e| e.modes().len()).max().unwrap_or(0);
    for k in 1..=modes {
        let parts = [
            ("angular_frequency", "rad/s"),
            ("frequency", "Hz"),
            ("damping_ratio", ""),
        ];
        columns.extend(parts.map(|(part, unit)| Column::new(format!("mode{k}.{part}"), unit)));
    }
    if has_neutral {
        columns.push(Column::new("neutral_directions", ""));
    }
    // Where friction holds, an equilibrium is an interval: its ends.
    let sticks = prepared.machine.contact_loads().next().is_some();
    if let (true, Some(coordinate)) = (sticks, states.first()) {
        let end = |end: &str| Column::new(format!("{}.{end}", coordinate.name), &coordinate.unit);
        columns.extend(["from", "to"].map(end));
    }
    let row = |e: &Equilibrium| {
        let mut row = e.y[..free].to_vec();
        row.extend(e.y[..free].iter().zip(&start).map(|(q, start)| q - start));
        row.extend_from_slice(&e.y[prepared.machine.drive_states()]);
        row.push(match e.stability {
            Stability::Asymptotic => 1.0,
            Stability::Centre => 0.0,
            Stability::Unstable => -1.0,
            Stability::Neutral | Stability::Undecided => f64::NAN,
        });
        let first = e.eigenvalues.first().zip(e.eigenvalue_errors.first());
        row.push(first.map_or(f64::NAN, |([re, _], error)| zero_within(*re, *error)));
        let largest_error = e.eigenvalue_errors.iter().copied().fold(0.0, f64::max);
        for mode in e.modes() {
            let frequency = mode.angular_frequency;
            let damping = zero_within(mode.damping_ratio, largest_error / frequency);
            row.extend([frequency, frequency / TAU, damping]);
        }
        let behind = usize::from(has_neutral) + 2 * usize::from(sticks);
        row.resize(columns.len() - behind, f64::NAN);
        if has_neutral {
            row.push(e.neutral.len() as f64);
        }
        if sticks {
            let extent = e.neutral.iter().find_map(|neutral| neutral.extent);
            row.extend(extent.unwrap_or([f64::NAN; 2]));
        }
        row
    };
    let rows = found.iter().map(row).collect();
    Table { columns, rows }
}

/// A value, or zero where its error leaves no digit.
fn zero_within(value: f64, error: f64) -> f64 {
    if value.abs() <= error { 0.0 } else { value }
}

/// The equilibria of a scene with their table, and the static force around them.
pub struct EquilibriaResults<'a, S: MachineScene = PlaneScene> {
    /// The scene with its machine.
    pub prepared: SceneMachine<'a, S>,
    /// The equilibria.
    pub found: Vec<Equilibrium>,
    /// The range in which they were searched for.
    pub searched: SearchedRange,
    /// One row per equilibrium.
    pub table: Table,
    /// Static force and potential over the interval.
    pub curves: Option<StaticCurves>,
}

/// Computes the equilibria of a scene.
///
/// # Errors
/// As [`equilibria`](crate::equilibria()).
pub fn compute_equilibria<S: MachineScene>(
    scene: &S,
) -> Result<EquilibriaResults<'_, S>, StudyError> {
    scene.reject_unknown_columns()?;
    let prepared = SceneMachine::new(scene)?;
    let (found, searched) = find_equilibria(&prepared)?;
    let table = equilibrium_table(&prepared, &found);
    let force_and_potential = |q: &[f64]| {
        let values = static_force_and_potential(&prepared.machine, q);
        values.map_err(|e| prepared.explain(&e))
    };
    let curves = match &searched {
        SearchedRange::Starts { .. } => None,
        SearchedRange::Interval(interval) => {
            let q = equally_spaced(*interval, POSITIONS);
            let marked: Vec<f64> = found.iter().map(|e| e.y[0]).collect();
            Some(StaticCurves {
                force_and_potential: force_and_potential(&q)?,
                at_equilibria: force_and_potential(&marked)?,
                q,
            })
        }
    };
    Ok(EquilibriaResults {
        prepared,
        found,
        searched,
        table,
        curves,
    })
}
