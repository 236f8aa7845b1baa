//! `dwell reduce`: the reduced parameters over the range, as a table and as figures.

use crate::channels::Channels;
use crate::error::StudyError;
use crate::figures;
use crate::motion_error::explain_place;
use crate::outcome::Outcome;
use crate::prepare::Prepared;
use crate::provenance::picture;
use crate::tabulate::{Tabulation, tabulate};
use crate::words::digits;
use dwell_kinetostatics::{Batch, Coefficients};
use dwell_report::{Axis, Column, Figure, Table};
use dwell_scene::Scene;
use rayon::prelude::*;

/// Positions of the table: half a degree over a turn.
const POSITIONS: usize = 720;

/// The reduced coefficients over the range.
#[derive(Debug, Clone)]
pub(crate) struct Sweep {
    /// Coordinates, rad.
    pub(crate) q: Vec<f64>,
    /// The coefficients at each.
    pub(crate) at: Vec<Coefficients>,
}

/// Estimated rounding errors over a sweep, as parts of the largest value of each coefficient.
#[derive(Debug, Clone)]
pub(crate) struct Errors {
    /// By position: the largest of all coefficients.
    pub(crate) rows: Vec<f64>,
    /// Over all positions: of m, of ½m′, of every a and b.
    pub(crate) most: [f64; 3],
}

impl Errors {
    /// Evaluates a sweep again in numbers of 32 digits.
    pub(crate) fn new(prepared: &Prepared<'_>, sweep: &Sweep) -> Result<Self, StudyError> {
        let model = prepared.model.model();
        let flat = |at: &Coefficients| -> Vec<f64> {
            let rest = at.a.iter().chain(&at.b).copied();
            [at.m, at.half_dm].into_iter().chain(rest).collect()
        };
        let mut scales = vec![0.0_f64; 2 + 2 * model.reactions().len()];
        for at in &sweep.at {
            for (scale, value) in scales.iter_mut().zip(flat(at)) {
                *scale = scale.max(value.abs());
            }
        }
        let judged = |(&q, at): (&f64, &Coefficients)| {
            let (mut work, mut errors) = (model.workspace(), model.coefficients());
            model
                .reduce_errors(q, at, &mut work, &mut errors)
                .map_err(|e| explain_place(prepared.scene, model.plan(), &e))?;
            let parts = flat(&errors).into_iter().zip(&scales);
            let part = |(error, &scale): (f64, &f64)| if error > 0.0 { error / scale } else { 0.0 };
            Ok(parts.map(part).collect())
        };
        let all: Vec<Vec<f64>> = sweep
            .q
            .par_iter()
            .zip(&sweep.at)
            .map(judged)
            .collect::<Result<_, StudyError>>()?;
        let largest = |some: &[f64]| some.iter().copied().fold(0.0, f64::max);
        let over = |pick: &dyn Fn(&Vec<f64>) -> f64| all.iter().map(pick).fold(0.0, f64::max);
        Ok(Self {
            rows: all.iter().map(|row| largest(row)).collect(),
            most: [
                over(&|row| row[0]),
                over(&|row| row[1]),
                over(&|row| largest(&row[2..])),
            ],
        })
    }

    /// To the next power of ten.
    fn words(&self) -> String {
        let [m, half_dm, rest] = self.most.map(|error| match error {
            0.0 => "0".to_owned(),
            error => format!("{:.0e}", 10_f64.powf(error.log10().ceil())),
        });
        format!(
            "  rounding errors, held against 32 digits, below {m} of the largest m, {half_dm} of ½m′, {rest} of any a or b\n"
        )
    }
}

impl Sweep {
    pub(crate) fn new(prepared: &Prepared<'_>) -> Result<Self, StudyError> {
        let model = &prepared.model;
        let q = prepared.sweep(POSITIONS);
        let mut batch = Batch::default();
        model.reduce_all(&q, &mut batch);
        if let Some((_, error)) = batch.errors.first() {
            return Err(explain_place(prepared.scene, model.model().plan(), error));
        }
        let at = (0..q.len()).map(|i| batch.at(i)).collect();
        Ok(Self { q, at })
    }

    /// The table: coordinate, m, ½m′, then a and b of each requested reaction.
    pub(crate) fn table(&self, prepared: &Prepared<'_>) -> Table {
        let mut columns = vec![
            Column::new(prepared.coordinate(), "rad"),
            Column::new("m", "kg m2"),
            Column::new("half_dm", "kg m2/rad"),
        ];
        for (name, unit) in prepared.reactions() {
            let unit = coefficient_unit(unit);
            columns.push(Column::new(format!("{name} a"), unit));
            columns.push(Column::new(format!("{name} b"), unit));
        }
        let row = |(q, at): (&f64, &Coefficients)| {
            let mut row = vec![*q, at.m, at.half_dm];
            for (a, b) in at.a.iter().zip(&at.b) {
                row.extend([*a, *b]);
            }
            row
        };
        Table {
            columns,
            rows: self.q.iter().zip(&self.at).map(row).collect(),
        }
    }
}

/// Unit of a and b for a reaction in N or N m: per rad/s² and per (rad/s)².
pub(crate) fn coefficient_unit(unit: &str) -> &'static str {
    if unit == "N" { "kg m" } else { "kg m2" }
}

/// The reduced parameters of a scene over its range, and a table, if one is wanted.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be put together, a figure cannot be drawn or a table not be
/// made.
pub fn reduce(scene: &Scene, table: Option<Tabulation>) -> Result<Outcome, StudyError> {
    let prepared = Prepared::for_angle(scene, false)?;
    let sweep = Sweep::new(&prepared)?;
    let mut figures: Vec<Figure> = vec![figures::reduced(&prepared, &sweep)];
    let (coefficients, note) = figures::coefficients(&prepared, &sweep);
    figures.extend(coefficients);
    let channels = Channels::new(&prepared, &sweep.q)?;
    let mut sheet = sweep.table(&prepared);
    if let Some(channels) = &channels {
        let x = Axis::degrees(figures::coordinate_label(&prepared));
        figures.push(channels.figure(&prepared, &sweep.q, &x));
        for (column, values) in channels.columns(&prepared) {
            sheet.columns.push(column);
            for (row, value) in sheet.rows.iter_mut().zip(values) {
                row.push(value);
            }
        }
    }
    let errors = Errors::new(&prepared, &sweep)?;
    sheet.columns.push(Column::new("relative_error", ""));
    for (row, error) in sheet.rows.iter_mut().zip(&errors.rows) {
        row.push(*error);
    }
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-reduced.{rest}", scene.name);
    outcome.files.add(name("csv"), sheet.csv()?);
    outcome.files.add(name("npz"), sheet.npz()?);
    for figure in &figures {
        let name = format!("{}-{}.png", scene.name, figure.name);
        outcome.files.add(name, picture(scene, figure)?);
    }
    let over = |pick: fn(&Coefficients) -> f64| {
        let values = sweep.at.iter().map(pick);
        values.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)))
    };
    let ((m0, m1), (h0, h1)) = (over(|c| c.m), over(|c| c.half_dm));
    outcome.summary = format!(
        "{}: {} positions of {}\n  m    from {} to {} kg m²\n  ½m′  from {} to {} kg m²/rad\n",
        scene.title,
        sweep.q.len(),
        prepared.coordinate(),
        digits(m0, 9),
        digits(m1, 9),
        digits(h0, 9),
        digits(h1, 9),
    );
    outcome.summary += &errors.words();
    if let Some(note) = note {
        outcome.summary += &format!("  {note}\n");
    }
    if m1 == 0.0 {
        outcome.summary +=
            "  no body with mass moves: no motion follows from this, and every reaction is zero\n";
    }
    outcome.summary += &prepared.told_shared();
    if let Some(wanted) = table {
        tabulate(&prepared, &wanted, &mut outcome)?;
    }
    Ok(outcome)
}
