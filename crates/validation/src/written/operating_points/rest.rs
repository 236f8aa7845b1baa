//! The equilibria that are written, by starting the motion at rest in each of them: it must not accelerate, and `linearise`
//! must find the same modes there. One that oscillates does so again with a damper that has a known share of its critical
//! damping.

use super::eigenvalues::{eigenvalues, largest_size, size};
use super::linear_file::LinearFile;
use super::nearest;
use super::runs::{linearise, simulate};
use super::starts::{Changed, FreeCoordinate, Start};
use crate::written::poses::compared::Compared;
use crate::written::poses::difference::Differences;
use crate::written::poses::program::Program;
use crate::written::poses::rows::Rows;
use crate::written::poses::scene_text::value_of;
use serde_json::Value as Json;
use std::f64::consts::TAU;
use toml::Value;

/// The damping ratio of the added damper.
const DAMPING_RATIO: f64 = 0.15;

/// The equilibria of a scene, and the scene's start.
pub(super) struct Rest<'a> {
    pub(super) program: &'a Program,
    pub(super) start: &'a Start,
    pub(super) rows: &'a Rows,
    pub(super) summary: &'a Json,
}

impl Rest<'_> {
    /// Compares every row of the table.
    pub(super) fn compare(&self, compared: &mut Compared) -> Result<(), String> {
        for row in 0..self.rows.count {
            self.compare_place(compared, row)?;
        }
        nearest::compare(self, compared)?;
        self.compare_damped(compared)
    }

    /// Where an equilibrium is, by free coordinate.
    pub(super) fn coordinates(&self, row: usize) -> Option<Vec<f64>> {
        let of = |free: &FreeCoordinate| self.rows.get(row, &free.name);
        self.start.free.iter().map(of).collect()
    }

    /// The scene at rest in an equilibrium, and the contribution of the state of a drive there.
    fn place(&self, row: usize) -> Option<(Start, Changed, f64)> {
        let start = self.start.at_rest_in(&self.coordinates(row)?);
        let state = self
            .start
            .changes()
            .into_iter()
            .find_map(|(changed, column)| {
                matches!(changed, Changed::Force(_)).then_some(())?;
                Some((changed, self.rows.get(row, &column)?))
            });
        let (changed, by) = state.unwrap_or((Changed::Coordinate(0), 0.0));
        Some((start, changed, by))
    }

    fn compare_place(&self, compared: &mut Compared, row: usize) -> Result<(), String> {
        let (start, changed, by) = self.place(row).ok_or("an equilibrium without a place")?;
        let text = start.text(changed, by)?;
        let name = format!("rest{row}");
        let simulated = simulate(self.program, &name, &text)?;
        let run = linearise(self.program, &name, &text)?;
        let file = LinearFile::read(&run.text("-linear.csv")?).ok_or("no matrices")?;
        for free in &start.free {
            let rate = format!("d({}.velocity)/dt", free.name);
            let of = |other: &FreeCoordinate| {
                file.entry(&rate, &other.name).unwrap_or(0.0).abs() * other.size
            };
            let scale = start.free.iter().map(of).fold(0.0, f64::max);
            let acceleration = simulated.get(0, &format!("{}.acceleration", free.name));
            let acceleration = acceleration.ok_or("a row without accelerations")?;
            let place = || format!("equilibrium {}, {}", row + 1, free.name);
            compared.add("written-rest", acceleration, scale, "per s²", place);
        }
        let found = eigenvalues(&run.json("-linearise.json")?, "initial");
        let written = eigenvalues(self.summary, &format!("equilibrium.{}", row + 1));
        let largest = largest_size(&found);
        for (one, other) in found.iter().zip(&written) {
            let difference = size([one[0] - other[0], one[1] - other[1]]);
            let place = || format!("equilibrium {}, eigenvalues", row + 1);
            compared.add("written-rest-modes", difference, largest, "1/s", place);
        }
        Ok(())
    }

    /// For an undamped equilibrium of one freedom: checks that a damper c adds ζ = c/(2 m ω) and does not change ω.
    fn compare_damped(&self, compared: &mut Compared) -> Result<(), String> {
        let [free] = self.start.free.as_slice() else {
            return Ok(());
        };
        let undamped = |&row: &usize| self.rows.get(row, "mode1.damping_ratio") == Some(0.0);
        let Some(row) = (0..self.rows.count).find(undamped) else {
            return Ok(());
        };
        let (start, ..) = self.place(row).ok_or("an equilibrium without a place")?;
        let frequency = self.rows.get(row, "mode1.angular_frequency");
        let frequency = frequency.ok_or("a mode without a frequency")?;
        let run = linearise(self.program, "undamped", &with_damper(&start, free, 0.0)?)?;
        let file = LinearFile::read(&run.text("-linear.csv")?).ok_or("no matrices")?;
        // What a force accelerates: 1/m.
        let rate = format!("d({}.velocity)/dt", free.name);
        let mobility = file.entry(&rate, "added-damper.applied_force");
        let mobility = mobility.ok_or("no column of the added force")?;
        let damping = 2.0 * DAMPING_RATIO * frequency / mobility;
        let text = with_damper(&start, free, damping)?;
        let expected = [
            ("mode1.angular_frequency", frequency, frequency),
            ("mode1.frequency", frequency / TAU, frequency),
            ("mode1.damping_ratio", DAMPING_RATIO, 1.0),
            ("max_real_eigenvalue", -DAMPING_RATIO * frequency, frequency),
            ("stability", 1.0, 1.0),
        ];
        let again = linearise(self.program, "damped-again", &text)?;
        let again = eigenvalues(&again.json("-linearise.json")?, "initial");
        let [re, im] = *again.first().ok_or("no eigenvalues")?;
        let linearised = [
            ("mode1.angular_frequency", size([re, im]), frequency),
            ("mode1.damping_ratio", -re / size([re, im]), 1.0),
            ("max_real_eigenvalue", re, frequency),
        ];
        let table = self.program.run("damped", &text, &["equilibria"])?;
        let table = table.csv("-equilibria.csv")?;
        // The search goes around another start: the row may be another.
        let place = self.rows.get(row, &free.name).unwrap_or(f64::NAN);
        let aside = |k: &usize| (table.get(*k, &free.name).unwrap_or(f64::NAN) - place).abs();
        let same = (0..table.count).min_by(|j, k| aside(j).total_cmp(&aside(k)));
        let same = same.ok_or("no equilibrium with a damper")?;
        add_row(compared.of("written-damped"), &table, same, &expected);
        add_row(compared.of("written-rest-modes"), &table, same, &linearised);
        Ok(())
    }
}

/// The scene with a damper on its coordinate, N m s/rad or N s/m.
fn with_damper(start: &Start, free: &FreeCoordinate, damping: f64) -> Result<String, String> {
    let mut scene = start.scene.clone();
    let force = format!("-({damping:e})*{}.velocity", free.name);
    let coordinate = free.name.as_str().into();
    let added = value_of([("applied-force", coordinate), ("magnitude", force.into())]);
    let drives = scene.entry("drives");
    if let Value::Table(drives) = drives.or_insert(Value::Table(toml::Table::new())) {
        drives.insert("added-damper".to_owned(), added);
    }
    start.text_of_scene(scene)
}

/// Compares columns of a row with their expected values, each with its scale.
fn add_row(to: &mut Differences, table: &Rows, row: usize, expected: &[(&str, f64, f64)]) {
    for (column, expected, scale) in expected {
        let place = || format!("equilibrium {} with a damper, {column}", row + 1);
        match table.get(row, column) {
            Some(value) => to.add(value - expected, *scale, "", place),
            None => to.fail(format!("{}: no number", place())),
        }
    }
}
