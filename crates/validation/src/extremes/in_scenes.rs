//! Results of commands on the text of a scene, as cells: the row with the largest error, and the error that the command
//! states.

use super::forms::{Form, FormModel};
use super::series::{CellResult, EstimatedValue, RunResult};
use dwell_findings::Table;
use dwell_kinetostatics::Coefficients;
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::PlaneScene;
use dwell_study::{Analysis, StudyError, compute_reduction, compute_trajectory, no_progress};

/// Distance of the rows at which another form is evaluated; rows next to the peaks are included.
const ROW_STEP: usize = 15;

/// A table of a command, with its stated errors.
pub(super) struct StatedTable {
    table: Table,
    /// Errors of m, of ½m′, and of all other columns, relative to the largest value.
    errors: [f64; 3],
}

/// The numbers of a column of a table.
pub fn column(table: &Table, name: &str) -> Result<Vec<f64>, String> {
    let found = table.columns.iter().position(|c| c.name == name);
    let column = found.ok_or_else(|| format!("no column {name}"))?;
    Ok(table.rows.iter().map(|row| row[column]).collect())
}

/// The values of a column at the rows, in 32 digits.
pub(super) type ReferenceColumn<'a> = (&'a str, Vec<DoubleDouble>);

impl StatedTable {
    /// The table of `reduce` for a scene, at a number of positions; in another form, the coefficients at the same rows.
    pub(super) fn reduced(
        form: Form,
        text: &str,
        points: usize,
    ) -> Result<Self, Box<dyn std::error::Error>> {
        let scene = PlaneScene::parse("scene.toml", text)?;
        let reduction = compute_reduction(&scene, Some(points))?;
        let found = Self {
            table: reduction.curves.table(&reduction.prepared),
            errors: reduction.errors.max_errors,
        };
        if form == Form::PLANE {
            return Ok(found);
        }
        let reactions = scene.requests.reactions.clone();
        found.in_form(form, &FormModel::new(form, scene, reactions, None)?)
    }

    /// The rows by a model in another form.
    fn in_form(
        mut self,
        form: Form,
        model: &FormModel,
    ) -> Result<Self, Box<dyn std::error::Error>> {
        let largest =
            |rows: &mut dyn Iterator<Item = f64>| rows.fold(0.0_f64, |a, b| a.max(b.abs()));
        let columns = self.table.columns.len() - 1;
        if self.table.rows.len() > ROW_STEP {
            self.table.rows = self.table.rows.into_iter().step_by(ROW_STEP).collect();
        }
        let mut errors = Vec::new();
        for row in &mut self.table.rows {
            row[0] = form.coordinate(row[0]);
            let numbers = |of: Coefficients| {
                let reactions = of.a.into_iter().zip(of.b).flat_map(|(a, b)| [a, b]);
                [of.m, of.half_dm]
                    .into_iter()
                    .chain(reactions)
                    .collect::<Vec<f64>>()
            };
            let (found, error) = model.coefficients_with_errors(row[0])?;
            let found = numbers(found);
            row[1..=found.len()].copy_from_slice(&found);
            errors.push(numbers(error));
        }
        let relative = |k: usize| {
            let error = largest(&mut errors.iter().map(|row: &Vec<f64>| row[k]));
            // The largest value itself has the error.
            let size = largest(&mut self.table.rows.iter().map(|row| row[1 + k]));
            if size > 0.0 {
                error / (size - error).max(0.1 * size)
            } else {
                0.0
            }
        };
        let rest = (2..columns).map(relative).fold(0.0, f64::max);
        self.errors = [relative(0), relative(1), rest];
        Ok(self)
    }

    /// The table of `kinetostatics`.
    pub(super) fn kinetostatics(text: &str, points: usize) -> Result<Self, StudyError> {
        let scene = PlaneScene::parse("scene.toml", text)?;
        let points = Some(points);
        let found = compute_trajectory(&scene, Analysis::Kinetostatics, points, &no_progress)?;
        if let Some(error) = found.early_stop {
            return Err(error);
        }
        let error = found.results.rounding_error.unwrap_or(f64::NAN);
        Ok(Self {
            table: found.table,
            errors: [error; 3],
        })
    }

    /// The numbers of a column.
    pub(super) fn column(&self, name: &str) -> Result<Vec<f64>, String> {
        column(&self.table, name)
    }

    /// For each group of columns with one stated error, the number with the largest error relative to the largest
    /// value of its column.
    pub(super) fn compare(&self, groups: &[Vec<ReferenceColumn<'_>>]) -> RunResult {
        groups.iter().map(|group| self.worst(group)).collect()
    }

    fn worst(
        &self,
        group: &[ReferenceColumn<'_>],
    ) -> Result<CellResult, Box<dyn std::error::Error>> {
        let mut worst: Option<EstimatedValue> = None;
        for (name, expected) in group {
            let stated = match *name {
                "m" => self.errors[0],
                "half_dm" => self.errors[1],
                _ => self.errors[2],
            };
            let scale = expected.iter().fold(0.0_f64, |s, x| s.max(x.value().abs()));
            for (value, &reference) in self.column(name)?.into_iter().zip(expected) {
                let this = EstimatedValue {
                    value,
                    reference,
                    scale,
                    error_estimate: stated * scale,
                };
                let relative = |of: &EstimatedValue| of.true_error() / of.scale;
                if worst.is_none_or(|worst| relative(&worst) < relative(&this)) {
                    worst = Some(this);
                }
            }
        }
        Ok(worst.ok_or_else(|| "no rows".to_owned()))
    }
}
