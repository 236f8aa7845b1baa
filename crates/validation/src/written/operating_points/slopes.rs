//! The matrices of `linearise` against differences of written results for neighbouring starts: rows of `simulate`, and the rates and
//! outputs of `linearise` itself.

use super::linear_file::LinearFile;
use super::runs::{linearise, simulate};
use super::starts::{Changed, Start};
use crate::written::poses::compared::Compared;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::rows::Rows;
use std::collections::BTreeMap;

/// Rates and outputs by the names of the matrices' rows.
type Values = BTreeMap<String, f64>;
/// Multiples of a step, and the weights of the values there: the derivative to the fourth order.
const STENCIL: [(f64, f64); 4] = [
    (-2.0, 1.0 / 12.0),
    (-1.0, -8.0 / 12.0),
    (1.0, 8.0 / 12.0),
    (2.0, -1.0 / 12.0),
];

/// A scene whose starts are changed.
pub(super) struct Slopes<'a> {
    pub(super) program: &'a Program,
    pub(super) start: &'a Start,
    pub(super) linear: &'a LinearFile,
}

/// Both programs' values at a start.
struct AtStart {
    rows: Values,
    linearised: Values,
}

impl Slopes<'_> {
    /// Compares every column of the matrices, and the values at the state itself.
    pub(super) fn compare(&self, compared: &mut Compared, archive: &Rows) -> Result<(), String> {
        let own = self.linear.values(archive);
        let own = own.ok_or("the archive has no rates and outputs")?;
        let base = self.at("start", Changed::Coordinate(0), 0.0)?;
        let scales = self.scales(&own);
        for (row, unit) in &self.linear.rows {
            let (Some(own), Some(of_row)) = (own.get(row), base.rows.get(row)) else {
                continue;
            };
            let place = || format!("{row} at the state itself");
            let scale = scales.get(unit).copied().unwrap_or(0.0);
            compared.add("written-linear", own - of_row, scale, "", place);
        }
        for (changed, column) in self.start.changes() {
            if !self.linear.columns.contains(&column) {
                continue;
            }
            self.compare_column(compared, changed, &column, &scales)?;
        }
        Ok(())
    }

    fn compare_column(
        &self,
        compared: &mut Compared,
        changed: Changed,
        column: &str,
        scales: &BTreeMap<String, f64>,
    ) -> Result<(), String> {
        let step = self.start.step(changed);
        let mut slopes = [Values::new(), Values::new()];
        for (k, (multiple, weight)) in STENCIL.into_iter().enumerate() {
            let at = self.at(&format!("{column}{k}"), changed, multiple * step)?;
            for (slopes, values) in slopes.iter_mut().zip([at.rows, at.linearised]) {
                for (name, value) in values {
                    *slopes.entry(name).or_default() += weight * value / step;
                }
            }
        }
        if let Changed::Force(k) = changed {
            let drive = &self.start.drives[k];
            let [force, rate] = drive.state_slopes;
            for slopes in &mut slopes {
                slopes.insert(format!("{}.actuator_force", drive.name), force);
                slopes.insert(format!("d({column})/dt"), rate);
            }
        }
        for (key, slopes) in ["written-linear", "written-linear-again"]
            .into_iter()
            .zip(slopes)
        {
            for (row, unit) in &self.linear.rows {
                let (Some(entry), Some(slope)) = (self.linear.entry(row, column), slopes.get(row))
                else {
                    // Rates of the states of drives are in no row of `simulate`.
                    if key == "written-linear-again" {
                        compared.fail(key, format!("`{row}` has no slope by `{column}`"));
                    }
                    continue;
                };
                let scale = scales.get(unit).copied().unwrap_or(0.0) / self.size(changed);
                let place = || format!("{row} by {column}");
                compared.add(key, entry - slope, scale, "", place);
            }
        }
        Ok(())
    }

    /// By unit of a row: the largest value, or change by a natural change of a state or input.
    fn scales(&self, own: &Values) -> BTreeMap<String, f64> {
        let mut scales = BTreeMap::new();
        for (row, unit) in &self.linear.rows {
            let change = |(changed, column): (Changed, String)| {
                let entry = self.linear.entry(row, &column).unwrap_or(0.0);
                (entry * self.size(changed)).abs()
            };
            let value = own.get(row).map_or(0.0, |value| value.abs());
            let largest = self.start.changes().into_iter().map(change);
            let largest = largest.fold(value, f64::max);
            let scale: &mut f64 = scales.entry(unit.clone()).or_default();
            *scale = scale.max(largest);
        }
        scales
    }

    /// A natural change: a thousand steps of a coordinate or velocity, a hundred of an input.
    fn size(&self, changed: Changed) -> f64 {
        let steps = match changed {
            Changed::Coordinate(_) | Changed::Velocity(_) => 1e3,
            Changed::Input(_) | Changed::Force(_) => 1e2,
        };
        steps * self.start.step(changed)
    }

    /// The values at a changed start.
    fn at(&self, name: &str, changed: Changed, by: f64) -> Result<AtStart, String> {
        let text = self.start.text(changed, by)?;
        let simulated = simulate(self.program, name, &text)?;
        let values = self.values(&simulated);
        Ok(AtStart {
            rows: values.ok_or("no rates in a row of `simulate`")?,
            linearised: linearised_values(&linearise(self.program, name, &text)?)?,
        })
    }

    /// Rates and outputs of the first row.
    fn values(&self, rows: &Rows) -> Option<Values> {
        let first = |(name, values): (&String, &Vec<f64>)| Some((name.clone(), *values.first()?));
        let mut values: Values = rows.columns.iter().filter_map(first).collect();
        for free in &self.start.free {
            let name = &free.name;
            for [of, rate] in [["", ".velocity"], [".velocity", ".acceleration"]] {
                let rate = *values.get(&format!("{name}{rate}"))?;
                values.insert(format!("d({name}{of})/dt"), rate);
            }
        }
        for drive in &self.start.drives {
            // What is written is what remains beside the force that accelerates the rotor.
            let net =
                ["moment", "force"].map(|end| values.get(&format!("{}.load_{end}", drive.name)));
            let net = *net.into_iter().flatten().next()?;
            let acceleration = *values.get(&format!("{}.acceleration", drive.coordinate))?;
            let force = net + drive.rotor_inertia * acceleration;
            values.insert(format!("{}.actuator_force", drive.name), force);
        }
        Some(values)
    }
}

/// Rates and outputs of a run of `linearise`.
fn linearised_values(run: &Run) -> Result<Values, String> {
    let file = LinearFile::read(&run.text("-linear.csv")?);
    let values = file.and_then(|file| file.values(&run.npz("-linear.npz").ok()?));
    values.ok_or_else(|| "`linearise` has written no rates and outputs".to_owned())
}
