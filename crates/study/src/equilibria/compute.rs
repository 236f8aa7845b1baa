//! Finds equilibria and tabulates them.

use crate::explain::StudyError;
use crate::models::SceneMachine;
use crate::ranges::equally_spaced;
use dwell_dynamics::{
    Equilibrium, Stability, equilibria as equilibria_over, equilibrium_near,
    static_force_and_potential,
};
use dwell_findings::{Column, Table};
use dwell_scene::Scene;
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
/// A real or imaginary part below this fraction of the eigenvalue's modulus is rounding.
const ROUNDING: f64 = 1e-9;

/// Equilibria, and the interval of the only coordinate that was searched for all of them.
pub(crate) type FoundEquilibria = (Vec<Equilibrium>, Option<[f64; 2]>);

/// Finds the equilibria.
pub(crate) fn find_equilibria(prepared: &SceneMachine<'_>) -> Result<FoundEquilibria, StudyError> {
    prepared.require_autonomous("an equilibrium")?;
    let interval = search_interval(prepared);
    let found = match interval {
        Some(interval) => equilibria_over(&prepared.machine, interval),
        None => equilibrium_near(&prepared.machine, &prepared.initial_state()).map(|e| vec![e]),
    };
    Ok((found.map_err(|e| prepared.explain(&e))?, interval))
}

/// The range of the only coordinate of the mechanism; if it is unlimited, one period around the start.
fn search_interval(prepared: &SceneMachine<'_>) -> Option<[f64; 2]> {
    let plan = prepared.machine.model().plan();
    if plan.actuators() != 1 {
        return None;
    }
    let range = plan.range();
    if let Some((from, to)) = range.limits() {
        let margin = MARGIN * (to - from);
        return Some([from + margin, to - margin]);
    }
    let period = match range.period() {
        Some(period) => period,
        None if plan.is_angle(0) => TAU,
        None => return None,
    };
    let from = prepared.initial_state()[0] - CUT_FRACTION * period;
    Some([from, from + period])
}

/// One row per equilibrium.
fn equilibrium_table(prepared: &SceneMachine<'_>, found: &[Equilibrium]) -> Table {
    let start = prepared.initial_state();
    let free = prepared.machine.free().len();
    let states: Vec<Column> = prepared.state_columns();
    let mut columns: Vec<Column> = states[..free].to_vec();
    let deflection = |c: &Column| Column::new(format!("{}.deflection", c.name), c.unit.clone());
    columns.extend(states[..free].iter().map(deflection));
    columns.extend_from_slice(&states[2 * free..]);
    columns.push(Column::new("stability", ""));
    columns.push(Column::new("max_real_eigenvalue", "1/s"));
    let modes = found.iter().map(|e| e.modes().len()).max().unwrap_or(0);
    for k in 1..=modes {
        let parts = [
            ("angular_frequency", "rad/s"),
            ("frequency", "Hz"),
            ("damping_ratio", ""),
        ];
        columns.extend(parts.map(|(part, unit)| Column::new(format!("mode{k}.{part}"), unit)));
    }
    let row = |e: &Equilibrium| {
        let mut row = e.y[..free].to_vec();
        row.extend(e.y[..free].iter().zip(&start).map(|(q, start)| q - start));
        row.extend_from_slice(&e.y[2 * free..prepared.machine.work_offset()]);
        row.push(match e.stability {
            Stability::Asymptotic => 1.0,
            Stability::Centre => 0.0,
            Stability::Unstable => -1.0,
            Stability::Undecided => f64::NAN,
        });
        let first = e.eigenvalues.first();
        row.push(first.map_or(f64::NAN, |z| without_rounding(*z)[0]));
        for mode in e.modes() {
            let [damping, _] = without_rounding([mode.damping_ratio, 1.0]);
            let frequency = mode.angular_frequency;
            row.extend([frequency, frequency / TAU, damping]);
        }
        row.resize(columns.len(), f64::NAN);
        row
    };
    let rows = found.iter().map(row).collect();
    Table { columns, rows }
}

/// An eigenvalue without rounding.
pub(crate) fn without_rounding([re, im]: [f64; 2]) -> [f64; 2] {
    let threshold = ROUNDING * re.hypot(im);
    [re, im].map(|part| if part.abs() <= threshold { 0.0 } else { part })
}

/// The equilibria of a scene with their table, and the static force around them.
pub struct EquilibriaResults<'a> {
    /// The scene with its machine.
    pub prepared: SceneMachine<'a>,
    /// The equilibria.
    pub found: Vec<Equilibrium>,
    /// The interval that was searched for all equilibria, if there is a single coordinate.
    pub interval: Option<[f64; 2]>,
    /// One row per equilibrium.
    pub table: Table,
    /// Static force and potential over the interval.
    pub curves: Option<StaticCurves>,
}

/// Computes the equilibria of a scene.
///
/// # Errors
/// As [`equilibria`](crate::equilibria()).
pub fn compute_equilibria(scene: &Scene) -> Result<EquilibriaResults<'_>, StudyError> {
    let prepared = SceneMachine::new(scene)?;
    let (found, interval) = find_equilibria(&prepared)?;
    let table = equilibrium_table(&prepared, &found);
    let force_and_potential = |q: &[f64]| {
        let values = static_force_and_potential(&prepared.machine, q);
        values.map_err(|e| prepared.explain(&e))
    };
    let curves = match interval {
        None => None,
        Some(interval) => {
            let q = equally_spaced(interval, POSITIONS);
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
        interval,
        table,
        curves,
    })
}
