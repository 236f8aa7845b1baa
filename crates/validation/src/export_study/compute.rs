//! The runs printed with some digits at some positions, combined, and compared with the mechanism itself.

use dwell_dynamics::{Orbit, ReducedState};
use dwell_findings::Table;
use dwell_kinetostatics::{ExactModel, ReducedModel};
use dwell_scene::PlaneScene;
use dwell_study::explain::{explain_motion, explain_position};
use dwell_study::exported_runs::{
    ColumnNames, ExportedRuns, ExportedTable, SampleErrors, SampleInterpolation, SampledModel,
    combine_runs,
};
use dwell_study::unit_runs::compute::compute_unit_runs;
use dwell_study::{PreparedScene, StudyError, no_progress};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Positions of a revolution.
pub(super) const POSITIONS: [usize; 8] = [36, 72, 120, 180, 360, 720, 1440, 3600];
/// Significant digits of each printed number.
pub(super) const DIGITS: [usize; 6] = [4, 6, 8, 10, 12, 16];
/// How values between the positions are found.
pub(super) const INTERPOLATIONS: [SampleInterpolation; 3] = [
    SampleInterpolation::Linear,
    SampleInterpolation::Cubic,
    SampleInterpolation::Trigonometric,
];
/// The compared quantities.
pub(super) const QUANTITIES: [&str; 3] = ["m", "reaction", "period"];
/// The reaction.
const REACTION: &str = "slide.normal";
/// Angles at which the models are compared: a prime number of them, so that they are between the positions.
const COMPARED: usize = 997;

/// One export.
pub(super) struct Cell {
    pub(super) positions: usize,
    pub(super) digits: usize,
    pub(super) interpolation: SampleInterpolation,
    /// Largest errors of m and of the reaction's a or b, relative to the largest value, and that of the period, relative to it.
    pub(super) errors: [f64; 3],
    /// The stated errors.
    pub(super) estimates: [f64; 3],
}

/// The mechanism itself: its coefficients at the compared angles, and its period.
struct Exact {
    coefficients: Vec<[f64; 3]>,
    largest: [f64; 3],
    period: f64,
}

/// All exports, by number of positions, then digits, then interpolation.
pub(super) fn cells(scene: &PlaneScene) -> Result<Vec<Cell>, StudyError> {
    let prepared = PreparedScene::without_loads(scene)?;
    let names = prepared.reaction_units();
    let reaction = names.iter().position(|(name, _)| name == REACTION);
    let exact = Exact::of(scene, &prepared.model, reaction.unwrap_or(0))?;
    let of_positions = |&positions: &usize| -> Result<Vec<Cell>, StudyError> {
        let runs = compute_unit_runs(scene, Some(positions + 1), &no_progress)?;
        let of_digits = |&digits: &usize| -> Result<Vec<Cell>, StudyError> {
            let [one, two] = [0, 1].map(|k| {
                let text = printed(&runs.runs[k], prepared.coordinate_name(), digits);
                ExportedTable::read(["run i", "run ii"][k], &text)
            });
            let combined = combine_runs([&one?, &two?], &ColumnNames::default())?;
            let cell = |interpolation| exact.cell(&combined, digits, interpolation);
            Ok(INTERPOLATIONS.into_iter().map(cell).collect())
        };
        let by_digits: Result<Vec<_>, _> = DIGITS.par_iter().map(of_digits).collect();
        Ok(by_digits?.into_iter().flatten().collect())
    };
    let by_positions: Result<Vec<_>, _> = POSITIONS.par_iter().map(of_positions).collect();
    Ok(by_positions?.into_iter().flatten().collect())
}

/// A run as a program prints it: the coordinate with its rates, the actuator's moment and the reaction.
fn printed(table: &Table, coordinate: &str, digits: usize) -> String {
    let wanted = ["", ".velocity", ".acceleration", ".actuator_force"];
    let wanted = wanted.map(|rest| format!("{coordinate}{rest}"));
    let is_wanted = |name: &String| wanted.contains(name) || name == REACTION;
    let columns = table.columns.iter().enumerate();
    let columns: Vec<_> = columns.filter(|(_, c)| is_wanted(&c.name)).collect();
    let head = columns
        .iter()
        .map(|(_, c)| format!("{} [{}]", c.name, c.unit));
    let mut text = head.collect::<Vec<_>>().join(",") + "\n";
    for row in &table.rows {
        let fields = columns
            .iter()
            .map(|(k, _)| format!("{:.*e}", digits - 1, row[*k]));
        text += &(fields.collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

impl Exact {
    fn of(scene: &PlaneScene, model: &ExactModel, reaction: usize) -> Result<Self, StudyError> {
        let mut workspace = model.workspace();
        let mut at = model.model().coefficient_buffer();
        let mut coefficients = Vec::with_capacity(COMPARED);
        for q in compared_angles() {
            let evaluated = model.coefficients(q, &mut workspace, &mut at);
            evaluated.map_err(|e| explain_position(scene, model.model().plan(), &e))?;
            coefficients.push([at.m, at.a[reaction], at.b[reaction]]);
        }
        let largest = |i: usize| {
            coefficients
                .iter()
                .fold(0.0_f64, |max, c| max.max(c[i].abs()))
        };
        Ok(Self {
            largest: [0, 1, 2].map(largest),
            period: Orbit::new(model, UNIT_SPEED)
                .map_err(|e| explain_motion(scene, model.model().plan(), &e))?
                .period,
            coefficients,
        })
    }

    fn cell(&self, runs: &ExportedRuns, digits: usize, interpolation: SampleInterpolation) -> Cell {
        let model = SampledModel::new(runs, interpolation, 1);
        let stated = SampleErrors::of(runs, interpolation);
        let mut differences = [0.0_f64; 3];
        for (q, exact) in compared_angles().zip(&self.coefficients) {
            // Outside the positions there is no value: none of a whole revolution is.
            let found = model.values(q).unwrap_or_else(|_| vec![f64::NAN; 4]);
            for (i, k) in [0, 2, 3].into_iter().enumerate() {
                differences[i] = differences[i].max((found[k] - exact[i]).abs());
            }
        }
        let relative = [0, 1, 2].map(|i| differences[i] / self.largest[i]);
        let orbit = Orbit::to_accuracy(&model, UNIT_SPEED, 0.1 * stated.sum(0));
        let period = orbit.map_or(f64::NAN, |orbit| (orbit.period / self.period - 1.0).abs());
        Cell {
            positions: runs.q.len(),
            digits,
            interpolation,
            errors: [relative[0], relative[1].max(relative[2]), period],
            estimates: [
                stated.sum(0),
                stated.sum(2).max(stated.sum(3)),
                stated.sum(0),
            ],
        }
    }
}

fn compared_angles() -> impl Iterator<Item = f64> {
    (0..COMPARED).map(|k| TAU * k as f64 / COMPARED as f64 + 1e-3)
}

/// The start of the motions whose periods are compared.
const UNIT_SPEED: ReducedState = ReducedState {
    t: 0.0,
    q: 0.0,
    q_dot: 1.0,
};
