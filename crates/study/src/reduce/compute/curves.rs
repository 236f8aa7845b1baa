//! Reduced coefficients over the range, and their rounding errors.

use crate::estimate::{is_rounding, relative};
use crate::explain::StudyError;
use crate::number_format::coordinate_unit;
use crate::reduce::compute::{ReducedScene, UnitLoadCurves};
use crate::trajectory::compute::force_scales;
use dwell_findings::{Column, Table};
use dwell_kinetostatics::Coefficients;
use dwell_scene::SceneError;
use rayon::prelude::*;

/// Positions of the table if their number is not given: half a degree apart over a revolution.
const DEFAULT_POINTS: usize = 721;

/// Numbers that a table may have: they take some seconds and two gigabytes.
const MAX_NUMBERS: usize = 30_000_000;

/// The reduced coefficients over the range.
#[derive(Debug, Clone)]
pub struct ReducedCurves {
    /// Coordinates, rad or m.
    pub q: Vec<f64>,
    /// The coefficients at each.
    pub coefficients: Vec<Coefficients>,
}

/// Estimated rounding errors over the range, relative to the largest value of each coefficient.
#[derive(Debug, Clone)]
pub struct RoundingErrors {
    /// By position: the largest of all coefficients.
    pub(crate) rows: Vec<f64>,
    /// Over all positions: of m, of ½m′, of every a and b.
    pub max_errors: [f64; 3],
    /// For m, ½m′, every a and every b: whether it is zero everywhere within rounding.
    pub is_rounding: Vec<bool>,
}

/// m, ½m′, every a, every b.
pub(crate) fn flat(at: &Coefficients) -> Vec<f64> {
    let rest = at.a.iter().chain(&at.b).copied();
    [at.m, at.half_dm].into_iter().chain(rest).collect()
}

impl RoundingErrors {
    /// Evaluates the curves again in 32-digit arithmetic.
    pub(crate) fn new(
        prepared: &dyn ReducedScene,
        curves: &ReducedCurves,
    ) -> Result<Self, StudyError> {
        let errors_at = |(&q, at): (&f64, &Coefficients)| {
            let errors = prepared.rounding_errors(q, at)?;
            Ok(flat(&errors))
        };
        let all = curves.q.par_iter().zip(&curves.coefficients);
        let all = all.map(errors_at).collect::<Result<_, StudyError>>();
        let mut all: Vec<Vec<f64>> = all?;
        let [mut scales, references] = curves.scales(prepared);
        let mut is_rounding = curves.rounding(prepared);
        for (k, is_rounding) in is_rounding.iter_mut().enumerate() {
            // Nowhere more than its error.
            let mut both = all.iter().zip(&curves.coefficients);
            *is_rounding |= both.all(|(errors, at)| flat(at)[k].abs() <= 4.0 * errors[k]);
            if *is_rounding {
                scales[k] = references[k];
            }
        }
        for row in &mut all {
            let parts = row.iter_mut().zip(&scales);
            parts.for_each(|(error, &scale)| *error = relative(*error, scale));
        }
        let largest = |some: &[f64]| some.iter().copied().fold(0.0, f64::max);
        let max_of = |part: std::ops::Range<usize>| {
            let parts = all.iter().map(|row| largest(&row[part.clone()]));
            parts.fold(0.0, f64::max)
        };
        Ok(Self {
            rows: all.iter().map(|row| largest(row)).collect(),
            max_errors: [max_of(0..1), max_of(1..2), max_of(2..scales.len())],
            is_rounding,
        })
    }
}

impl ReducedCurves {
    /// Evaluates the model over its range, at `points` positions (two or more) if given.
    ///
    /// # Errors
    /// [`StudyError::Scene`] where a position cannot be reached.
    pub fn new(prepared: &dyn ReducedScene, points: Option<usize>) -> Result<Self, StudyError> {
        let intervals = points.unwrap_or(DEFAULT_POINTS).max(2) - 1;
        Self::at(prepared, prepared.positions(intervals))
    }

    /// Evaluates the model at given coordinates, rad or m.
    ///
    /// # Errors
    /// [`StudyError::Scene`] where a position cannot be reached.
    pub(crate) fn at(prepared: &dyn ReducedScene, q: Vec<f64>) -> Result<Self, StudyError> {
        let coefficients = prepared.coefficients(&q)?;
        Ok(Self { q, coefficients })
    }

    /// For m, ½m′, every a and every b: the largest value, and the size expected from m and the other reactions.
    pub(crate) fn scales(&self, prepared: &dyn ReducedScene) -> [Vec<f64>; 2] {
        let reactions = prepared.reaction_units();
        let mut sizes = vec![0.0_f64; 2 + 2 * reactions.len()];
        for at in &self.coefficients {
            for (size, value) in sizes.iter_mut().zip(flat(at)) {
                *size = size.max(value.abs());
            }
        }
        let (m, arm) = (sizes[0], prepared.size());
        let mut references = vec![m; 2];
        for part in sizes[2..].chunks(reactions.len().max(1)) {
            let of_unit = |unit: &str| {
                let alike = part.iter().zip(&reactions);
                let alike = alike.filter(|(_, (_, of))| *of == unit);
                alike.fold(0.0_f64, |scale, (&size, _)| scale.max(size))
            };
            let [force, moment] = force_scales(arm, ["N", "N m"].map(of_unit), m);
            references.extend(reactions.iter().map(|(_, of)| match *of {
                "N" => force,
                _ => moment,
            }));
        }
        [sizes, references]
    }

    /// For m, ½m′, every a and every b: whether it is zero everywhere within rounding.
    pub fn rounding(&self, prepared: &dyn ReducedScene) -> Vec<bool> {
        let [sizes, references] = self.scales(prepared);
        let both = sizes.into_iter().zip(references);
        both.map(|(size, of)| is_rounding(size, of)).collect()
    }

    /// The table: coordinate, m, ½m′, then a and b of each requested reaction.
    pub fn table(&self, prepared: &dyn ReducedScene) -> Table {
        let (coordinate, is_angle) = (prepared.coordinate_name(), prepared.is_angle());
        let reactions = prepared.reaction_units();
        let reactions = reactions.iter().map(|(name, unit)| (&name[..], *unit));
        coefficient_table(coordinate, is_angle, reactions, &self.q, &self.coefficients)
    }
}

/// The table of coefficients at positions: coordinate, m, ½m′, then a and b of each reaction by its name and unit.
pub(crate) fn coefficient_table<'r>(
    coordinate: &str,
    is_angle: bool,
    reactions: impl Iterator<Item = (&'r str, &'r str)>,
    q: &[f64],
    coefficients: &[Coefficients],
) -> Table {
    let [m, half_dm] = inertia_units(is_angle);
    let mut columns = vec![
        Column::new(coordinate, coordinate_unit(is_angle)),
        Column::new("m", m),
        Column::new("half_dm", half_dm),
    ];
    for (name, unit) in reactions {
        let [a, b] = coefficient_units(unit, is_angle);
        columns.push(Column::new(format!("{name}.a"), a));
        columns.push(Column::new(format!("{name}.b"), b));
    }
    let row = |(q, at): (&f64, &Coefficients)| {
        let mut row = vec![*q, at.m, at.half_dm];
        for (a, b) in at.a.iter().zip(&at.b) {
            row.extend([*a, *b]);
        }
        row
    };
    let rows = q.iter().zip(coefficients).map(row).collect();
    Table { columns, rows }
}

/// Units of m and of ½m′ of an angle or a length.
pub(crate) fn inertia_units(is_angle: bool) -> [&'static str; 2] {
    if is_angle {
        ["kg m2", "kg m2/rad"]
    } else {
        ["kg", "kg/m"]
    }
}

/// Units of a and b for a reaction in N or N m: per rad/s² and per (rad/s)², or per m/s² and per (m/s)².
pub(crate) fn coefficient_units(unit: &str, is_angle: bool) -> [&'static str; 2] {
    match (unit, is_angle) {
        ("N", true) => ["kg m"; 2],
        (_, true) => ["kg m2"; 2],
        ("N", false) => ["kg", "kg/m"],
        (_, false) => ["kg m", "kg"],
    }
}

/// Each load has a column of w and one of c for each reaction: many of them are more than a computer holds.
fn reject_large_table(
    prepared: &dyn ReducedScene,
    points: Option<usize>,
) -> Result<(), StudyError> {
    let (reactions, loads) = (prepared.reaction_units().len(), prepared.load_names().len());
    let columns = 4 + 2 * reactions + loads * (1 + reactions);
    let rows = points.unwrap_or(DEFAULT_POINTS);
    if columns.saturating_mul(rows) <= MAX_NUMBERS {
        return Ok(());
    }
    let message = format!(
        "a table of {rows} positions and {columns} columns is too large: {loads} loads have a w each, and a c for each of {reactions} reactions"
    );
    let help = format!(
        "reduce the number of positions with --points (here at most {}), or list the reactions that are needed in [requests]",
        MAX_NUMBERS / columns
    );
    Err(SceneError::without_labels(message, Some(help)).into())
}

/// The reduced parameters of a scene over its range.
pub struct Reduction<P> {
    /// The scene and its model.
    pub prepared: P,
    /// The coefficients.
    pub curves: ReducedCurves,
    /// The unit-load response, if there are loads.
    pub unit_loads: Option<UnitLoadCurves>,
    /// Estimated rounding errors of the coefficients.
    pub errors: RoundingErrors,
}

impl<P: ReducedScene> Reduction<P> {
    /// The reduced parameters over the range of a model.
    ///
    /// # Errors
    /// [`StudyError`] when a position of the range cannot be evaluated.
    pub(crate) fn new(prepared: P, points: Option<usize>) -> Result<Self, StudyError> {
        reject_large_table(&prepared, points)?;
        let curves = ReducedCurves::new(&prepared, points)?;
        let unit_loads = prepared.unit_loads(&curves.q)?;
        let errors = RoundingErrors::new(&prepared, &curves)?;
        Ok(Self {
            prepared,
            curves,
            unit_loads,
            errors,
        })
    }

    /// Coordinate, m, ½m′, a and b of each requested reaction; V, w and c of the loads; relative rounding error.
    pub fn table(&self) -> Table {
        let mut table = self.curves.table(&self.prepared);
        let unit_loads = self.unit_loads.iter();
        let unit_loads = unit_loads.flat_map(|l| l.columns(&self.prepared));
        let errors = (Column::new("relative_error", ""), self.errors.rows.clone());
        let known = self.prepared.known_reactions(&self.curves.q);
        for (column, values) in known.into_iter().chain(unit_loads).chain([errors]) {
            table.columns.push(column);
            for (row, value) in table.rows.iter_mut().zip(values) {
                row.push(value);
            }
        }
        table
    }
}
