//! A run with its speeds and accelerations, at its own positions and interpolated onto others.

use super::columns::Run;
use super::text_table::ExportedColumn;
use dwell_scene::SceneError;
use std::f64::consts::TAU;

/// Points of the polynomial by which a run is interpolated onto other positions.
const POINTS: usize = 8;
/// Positions that differ by less than this part of the range are the same.
pub(super) const SAME_POSITION: f64 = 1e-9;
/// A speed may differ by this part from the integral of the acceleration over the coordinate, of few positions.
const SPEED_TOLERANCE: f64 = 0.05;

/// A run with the speeds and accelerations that its file has or that the procedure means.
#[derive(Clone)]
pub(super) struct TimedRun {
    pub(super) run: Run,
    /// rad/s or m/s.
    pub(super) speed: Vec<f64>,
    /// rad/s² or m/s².
    pub(super) acceleration: Vec<f64>,
    /// Errors of accelerations and of squares of speeds by interpolation onto other positions.
    pub(super) motion_resampling: [f64; 2],
}

/// The run with its speeds and accelerations; without such columns, those of the paper's procedure.
///
/// # Errors
/// [`SceneError`]: one row, a coordinate that does not increase, or a speed that contradicts its acceleration.
pub(super) fn with_speeds(
    run: Run,
    accelerates: bool,
    notes: &mut Vec<String>,
) -> Result<TimedRun, SceneError> {
    let q = &run.q.values;
    let stays = q.windows(2).position(|pair| pair[1] <= pair[0]);
    if q.len() < 2 || stays.is_some() {
        let message = match stays {
            None => format!("`{}` has one row", run.file),
            Some(k) => format!(
                "the coordinate `{}` in `{}` does not grow in row {}",
                run.name,
                run.file,
                k + 2
            ),
        };
        return Err(wrong(
            message,
            "export a run in which the coordinate grows, without repeated instants",
        ));
    }
    let (speed, acceleration) = match (&run.speed, &run.acceleration) {
        (Some(speed), Some(acceleration)) => (speed.values.clone(), acceleration.values.clone()),
        (None, None) => {
            let (text, acceleration) = if accelerates {
                ("unit acceleration from rest", 1.0)
            } else {
                ("unit speed without acceleration", 0.0)
            };
            let speed = |travelled: f64| {
                if accelerates {
                    (2.0 * travelled).sqrt()
                } else {
                    1.0
                }
            };
            notes.push(format!(
                "`{}` has no speeds and accelerations: {text} is assumed",
                run.file
            ));
            q.iter().map(|at| (speed(at - q[0]), acceleration)).unzip()
        }
        _ => {
            let message = format!(
                "`{}` has a speed without an acceleration, or the reverse",
                run.file
            );
            return Err(wrong(message, "export both, or neither of them"));
        }
    };
    let timed = TimedRun {
        run,
        speed,
        acceleration,
        motion_resampling: [0.0; 2],
    };
    timed.check_speed()?;
    Ok(timed)
}

impl TimedRun {
    /// Checks that q̇² changes by twice the integral of q̈ over q, as in every motion. A mixture of degrees and radians
    /// does not.
    fn check_speed(&self) -> Result<(), SceneError> {
        let (q, v, a) = (&self.run.q.values, &self.speed, &self.acceleration);
        let integral: f64 = (1..q.len())
            .map(|k| (q[k] - q[k - 1]) * (a[k] + a[k - 1]))
            .sum();
        let squares = v.iter().map(|v| v * v);
        let largest = squares.fold(0.0_f64, f64::max);
        let change = v[v.len() - 1].powi(2) - v[0].powi(2);
        if (change - integral).abs() <= SPEED_TOLERANCE * largest.max(integral.abs()) {
            return Ok(());
        }
        let message = format!(
            "in `{}` the square of the speed changes by {change:.4}, but the acceleration makes it {integral:.4}",
            self.run.file
        );
        Err(wrong(
            message,
            "is an angle in degrees and its speed in rad/s, or the reverse? Write the units into the header, `phi [deg]`",
        ))
    }

    /// The effect of half a unit of the last printed digit on accelerations and on squares of speeds.
    pub(super) fn motion_rounding(&self) -> [f64; 2] {
        let of = |column: &Option<ExportedColumn>| column.as_ref().map_or(0.0, |c| c.rounding);
        let fastest = self.speed.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
        [
            of(&self.run.acceleration),
            2.0 * fastest * of(&self.run.speed),
        ]
    }

    /// Whether this number of rows is a whole revolution with equal spacing, within the printed digits.
    pub(super) fn is_whole_revolution(&self, rows: usize) -> bool {
        let q = &self.run.q.values[..rows];
        if !self.run.is_angle || rows < 4 {
            return false;
        }
        let step = TAU / (rows - 1) as f64;
        let printed = 2.0 * self.run.q.rounding;
        let mut rows = q.iter().enumerate();
        rows.all(|(k, x)| (x - q[0] - step * k as f64).abs() < 1e-6 * step + printed)
    }

    /// The run at other positions.
    pub(super) fn at(&self, q: &[f64]) -> Self {
        let known = &self.run.q.values;
        let range = known[known.len() - 1] - known[0];
        let same = q.len() <= known.len()
            && q.iter()
                .zip(known)
                .all(|(a, b)| (a - b).abs() <= SAME_POSITION * range);
        if same {
            let mut same = self.clone();
            same.run.q.values.truncate(q.len());
            return same;
        }
        let values = |of: &[f64]| resampled(known, of, q);
        let column = |column: &ExportedColumn| {
            let (values, resampling) = values(&column.values);
            ExportedColumn {
                values,
                resampling,
                ..column.clone()
            }
        };
        // A root at rest has no slope: its square has.
        let (squares, of_squares) = values(&self.speed.iter().map(|v| v * v).collect::<Vec<_>>());
        let (acceleration, of_acceleration) = values(&self.acceleration);
        Self {
            run: Run {
                q: column(&self.run.q),
                force: column(&self.run.force),
                reactions: self.run.reactions.iter().map(column).collect(),
                ..self.run.clone()
            },
            speed: squares
                .into_iter()
                .map(|square| square.max(0.0).sqrt())
                .collect(),
            acceleration,
            motion_resampling: [of_acceleration, of_squares],
        }
    }
}

/// Values at other positions, and their largest error: the difference from the polynomial of two points less, and as the
/// differences shrink from one to the next, by the root of that: the whole ratio was measured too small by a factor of 2
/// where the positions are few.
fn resampled(known: &[f64], values: &[f64], q: &[f64]) -> (Vec<f64>, f64) {
    let mut differences = [0.0_f64; 2];
    let at = |&x: &f64| {
        let [fine, coarse, coarsest] =
            [0, 2, 4].map(|less| interpolated(known, values, x, POINTS - less));
        for (largest, difference) in differences
            .iter_mut()
            .zip([fine - coarse, coarse - coarsest])
        {
            *largest = largest.max(difference.abs());
        }
        fine
    };
    let found = q.iter().map(at).collect();
    let [last, before] = differences;
    let shrinks = (last / before.max(f64::MIN_POSITIVE)).min(1.0);
    (found, last * shrinks.sqrt())
}

/// A polynomial through the nearest points.
fn interpolated(known: &[f64], values: &[f64], x: f64, points: usize) -> f64 {
    let count = points.min(known.len());
    let after = known.partition_point(|&q| q < x);
    let first = after.saturating_sub(count / 2).min(known.len() - count);
    let points = first..first + count;
    let weight = |i: usize| {
        let others = points.clone().filter(|&j| j != i);
        others
            .map(|j| (x - known[j]) / (known[i] - known[j]))
            .product::<f64>()
    };
    points.clone().map(|i| weight(i) * values[i]).sum()
}

/// An error of the runs.
pub(super) fn wrong(message: String, help: &str) -> SceneError {
    SceneError::without_labels(message, Some(help.to_owned()))
}
