//! Combines two runs row by row, eqs. (4) and (5) of Jordi, Zayas and Cardona (2008) for any speeds and accelerations:
//!
//! ```text
//! run i    T_i  = m q̈_i  + ½m′ q̇_i²        F_i  = a q̈_i  + b q̇_i²
//! run ii   T_ii = m q̈_ii + ½m′ q̇_ii²       F_ii = a q̈_ii + b q̇_ii²
//! ```
//!
//! At each position of run i these are two equations for m and ½m′, and two for a and b of each reaction. Where run ii has
//! other positions, it is interpolated.

use super::columns::ColumnNames;
use super::text_table::{ExportedColumn, ExportedTable, by_name};
use super::timed_run::{SAME_POSITION, TimedRun, with_speeds, wrong};
use dwell_kinetostatics::Coefficients;
use dwell_scene::SceneError;
use std::f64::consts::TAU;

/// The runs may contradict each other by this part of the largest m, of few positions.
const CONTRADICTION: f64 = 0.05;

/// The reduced parameters at the positions of run i.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportedRuns {
    /// The name of the coordinate's column.
    pub coordinate: String,
    /// Whether it is an angle (rad), or a length (m).
    pub is_angle: bool,
    /// Names of the reactions, with their units where the files say them.
    pub reactions: Vec<(String, Option<String>)>,
    /// Positions, rad or m, ascending; of a whole revolution without its end.
    pub q: Vec<f64>,
    /// m, ½m′, a and b at each.
    pub coefficients: Vec<Coefficients>,
    /// Largest effect of half a unit of the last printed digit on m, ½m′, any a and any b.
    pub rounding: Coefficients,
    /// Largest effect of the interpolation of run ii at the positions of run i.
    pub resampling: Coefficients,
    /// Half a unit of the last printed digit of the positions, rad or m; zero if they are equally spaced over a whole
    /// revolution.
    pub position_rounding: f64,
    /// The largest difference between changes of m and the integral of ½m′, relative to the largest m.
    pub contradiction: f64,
    /// Whether the positions are equally spaced over a whole revolution.
    pub is_whole_revolution: bool,
    /// Notes on assumptions.
    pub notes: Vec<String>,
}

/// The two equations of a position: accelerations and squares of speeds of both runs.
#[derive(Clone, Copy)]
struct Equations {
    acceleration: [f64; 2],
    square: [f64; 2],
}

/// Combines the tables of run i (uniform speed) and run ii (uniform acceleration).
///
/// # Errors
/// [`SceneError`]: a column is missing, positions do not ascend, speeds contradict positions, the runs are exchanged or do not
/// determine m, or contradict each other.
pub fn combine_runs(
    [one, two]: [&ExportedTable; 2],
    names: &ColumnNames,
) -> Result<ExportedRuns, SceneError> {
    let mut notes = Vec::new();
    let [one, two] = [names.select(one)?, names.select(two)?];
    if one.is_angle != two.is_angle {
        let message = format!("`{}` has an angle, `{}` a length", one.file, two.file);
        return Err(wrong(message, "both runs are of one coordinate"));
    }
    let one = with_speeds(one, false, &mut notes)?;
    let two = with_speeds(two, true, &mut notes)?;
    check_order(&one, &two)?;
    let rows = shared_rows(&one, &two)?;
    let two = two.at(&one.run.q.values[..rows]);
    let is_whole = one.is_whole_revolution(rows);
    // The end of a revolution is its beginning.
    let rows = if is_whole { rows - 1 } else { rows };
    let pair = AlignedRuns::new(one, two, rows);
    let (one, two) = (&pair.one, &pair.two);
    let inertia = pair.solve([&one.run.force, &two.run.force]);
    let mut reactions = Vec::new();
    let mut solved = Vec::new();
    let of_two = by_name(&two.run.reactions);
    for of_one in &one.run.reactions {
        let Some(of_two) = of_two.get(of_one.name.as_str()) else {
            let (file, name) = (&two.run.file, &of_one.name);
            let message = format!("`{file}` has no column of the reaction `{name}`");
            return Err(wrong(message, "export the same reactions in both runs"));
        };
        reactions.push((of_one.name.clone(), of_one.unit.clone()));
        solved.push(pair.solve([of_one, of_two]));
    }
    let coefficients = (0..rows).map(|k| Coefficients {
        m: inertia.values[k][0],
        half_dm: inertia.values[k][1],
        a: solved.iter().map(|of| of.values[k][0]).collect(),
        b: solved.iter().map(|of| of.values[k][1]).collect(),
    });
    let coefficients: Vec<Coefficients> = coefficients.collect();
    let q = positions(&one.run.q.values, rows, is_whole);
    let combined = ExportedRuns {
        coordinate: one.run.name.clone(),
        is_angle: one.run.is_angle,
        reactions,
        rounding: largest(&inertia, &solved, |of| of.rounding),
        resampling: largest(&inertia, &solved, |of| of.resampling),
        contradiction: contradiction(&q, &coefficients),
        q,
        coefficients,
        position_rounding: if is_whole { 0.0 } else { one.run.q.rounding },
        is_whole_revolution: is_whole,
        notes,
    };
    combined.check()?;
    Ok(combined)
}

/// The positions; over a whole revolution, equally spaced ones without the rounding of printed digits.
fn positions(q: &[f64], rows: usize, is_whole: bool) -> Vec<f64> {
    let equal = |k: usize| q[0] + TAU * k as f64 / rows as f64;
    if is_whole {
        (0..rows).map(equal).collect()
    } else {
        q[..rows].to_vec()
    }
}

/// Both runs at the same positions, with their equations.
struct AlignedRuns {
    one: TimedRun,
    two: TimedRun,
    equations: Vec<Equations>,
}

impl AlignedRuns {
    fn new(one: TimedRun, two: TimedRun, rows: usize) -> Self {
        let at = |k: usize| Equations {
            acceleration: [one.acceleration[k], two.acceleration[k]],
            square: [one.speed[k], two.speed[k]].map(|v| v * v),
        };
        let equations = (0..rows).map(at).collect();
        Self {
            one,
            two,
            equations,
        }
    }

    /// The coefficients of q̈ and of q̇² of a force at each position, with the errors by digits and by interpolation.
    fn solve(&self, [of_one, of_two]: [&ExportedColumn; 2]) -> SolvedForce {
        let solved = self.equations.iter().enumerate();
        let values: Vec<[f64; 2]> = solved
            .map(|(k, e)| e.solve([of_one.values[k], of_two.values[k]]))
            .collect();
        let runs = [&self.one, &self.two];
        let largest = |forces: [f64; 2], motion: [[f64; 2]; 2]| {
            let errors = self.equations.iter().zip(&values).map(|(e, &found)| {
                let of_motion = e.force_errors(found, motion);
                e.errors([forces[0] + of_motion[0], forces[1] + of_motion[1]])
            });
            errors.fold([0.0_f64; 2], |max, e| [max[0].max(e[0]), max[1].max(e[1])])
        };
        SolvedForce {
            rounding: largest(
                [of_one.rounding, of_two.rounding],
                runs.map(TimedRun::motion_rounding),
            ),
            resampling: largest(
                [of_one.resampling, of_two.resampling],
                runs.map(|run| run.motion_resampling),
            ),
            values,
        }
    }
}

/// The coefficients of q̈ and of q̇² of a force at each position, and their largest errors.
struct SolvedForce {
    values: Vec<[f64; 2]>,
    rounding: [f64; 2],
    resampling: [f64; 2],
}

/// The largest errors of one source, as coefficients.
fn largest(
    inertia: &SolvedForce,
    reactions: &[SolvedForce],
    source: impl Fn(&SolvedForce) -> [f64; 2],
) -> Coefficients {
    let [m, half_dm] = source(inertia);
    let (a, b) = reactions.iter().map(|of| source(of).into()).unzip();
    Coefficients { m, half_dm, a, b }
}

impl Equations {
    fn determinant(&self) -> f64 {
        let ([a, c], [b, d]) = (self.acceleration, self.square);
        a * d - b * c
    }

    /// The coefficients of q̈ and of q̇² of a force.
    fn solve(&self, [one, two]: [f64; 2]) -> [f64; 2] {
        let ([a, c], [b, d]) = (self.acceleration, self.square);
        let determinant = self.determinant();
        [
            (one * d - two * b) / determinant,
            (a * two - c * one) / determinant,
        ]
    }

    /// The effect of errors of accelerations and of squares of speeds on the forces of both runs, by the computed
    /// coefficients.
    fn force_errors(
        &self,
        [of_acceleration, of_square]: [f64; 2],
        motion: [[f64; 2]; 2],
    ) -> [f64; 2] {
        [0, 1].map(|run| {
            let [acceleration, square] = motion[run];
            of_square.abs() * square + of_acceleration.abs() * acceleration
        })
    }

    /// Their errors for errors of the force.
    fn errors(&self, [one, two]: [f64; 2]) -> [f64; 2] {
        let ([a, c], [b, d]) = (self.acceleration, self.square);
        let determinant = self.determinant().abs();
        let of_acceleration = one * d.abs() + two * b.abs();
        let of_square = two * a.abs() + one * c.abs();
        [of_acceleration / determinant, of_square / determinant]
    }
}

/// The runs are not exchanged: the second accelerates more.
fn check_order(one: &TimedRun, two: &TimedRun) -> Result<(), SceneError> {
    let share = |run: &TimedRun| {
        let size = |values: &[f64]| values.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
        size(&run.acceleration) / size(&run.speed).powi(2).max(f64::MIN_POSITIVE)
    };
    if share(one) <= share(two) {
        return Ok(());
    }
    let message = format!(
        "`{}` accelerates more than `{}`: the runs seem to be exchanged",
        one.run.file, two.run.file
    );
    Err(wrong(
        message,
        "give run i (uniform speed) first, then run ii (uniform acceleration)",
    ))
}

/// How many rows of run i are within run ii.
fn shared_rows(one: &TimedRun, two: &TimedRun) -> Result<usize, SceneError> {
    let (q, other) = (&one.run.q.values, &two.run.q.values);
    let range = q[q.len() - 1] - q[0];
    let slack = SAME_POSITION * range;
    let first = q[0] - other[0];
    let covered = q
        .iter()
        .filter(|&&x| x <= other[other.len() - 1] + slack)
        .count();
    if first < -slack || covered * 2 < q.len() {
        let message = format!(
            "`{}` covers {:.6} to {:.6}, but `{}` only {:.6} to {:.6}",
            one.run.file,
            q[0],
            q[q.len() - 1],
            two.run.file,
            other[0],
            other[other.len() - 1]
        );
        return Err(wrong(
            message,
            "both runs pass through the same positions: export both over the same range",
        ));
    }
    Ok(covered)
}

/// How far changes of m are from twice the integral of ½m′ over every two intervals, relative to the largest m.
fn contradiction(q: &[f64], at: &[Coefficients]) -> f64 {
    let largest = at.iter().fold(0.0_f64, |max, c| max.max(c.m.abs()));
    let of_row = |k: usize| {
        let (h, g) = (q[k] - q[k - 1], q[k + 1] - q[k]);
        let [f, mid, l] = [k - 1, k, k + 1].map(|i| at[i].half_dm);
        // Simpson's rule for unequal intervals.
        let sum = (2.0 - g / h) * f + (h + g).powi(2) / (h * g) * mid + (2.0 - h / g) * l;
        (at[k + 1].m - at[k - 1].m - (h + g) / 3.0 * sum).abs()
    };
    let worst = (1..at.len().saturating_sub(1))
        .map(of_row)
        .fold(0.0, f64::max);
    worst / largest.max(f64::MIN_POSITIVE)
}

impl ExportedRuns {
    fn check(&self) -> Result<(), SceneError> {
        let undetermined = |c: &Coefficients| !(c.m.is_finite() && c.half_dm.is_finite());
        if let Some(k) = self.coefficients.iter().position(undetermined) {
            let message = format!(
                "the runs do not determine m at {} = {:.6}",
                self.coordinate, self.q[k]
            );
            return Err(wrong(
                message,
                "one run moves with uniform speed, the other accelerates from rest",
            ));
        }
        if let Some(k) = self.coefficients.iter().position(|c| c.m <= 0.0) {
            let message = format!(
                "m = {:.4e} at {} = {:.6}: an inertia is above zero",
                self.coefficients[k].m, self.coordinate, self.q[k]
            );
            return Err(wrong(
                message,
                "is the sign of the drive's moment reversed in one of the runs, or are there loads?",
            ));
        }
        if self.contradiction > CONTRADICTION {
            let message = format!(
                "the runs are inconsistent: the changes of m do not agree with ½m′: they differ by {:.1e} of the largest m",
                self.contradiction
            );
            return Err(wrong(
                message,
                "export both from one mechanism without loads, in one system of units, at more positions",
            ));
        }
        Ok(())
    }
}
