//! The rows in coordinates of the centres of mass, which of them are solved, and how a motion is put
//! back on them.

use super::equations::Meshed;
use super::{MotionSample, Unreduced, UnreducedError};
use crate::dense::{Dense, each_attachment};
use crate::rank::rank;
use crate::solve::Lu;
use dwell_dynamics::Guidance;
use dwell_geometry::rows::Rows;
use dwell_geometry::{Mechanism, Vec2, vec2};
use dwell_kinetostatics::Mass;
use faer::Mat;

/// What is left of a row of order one below this is rounding.
const DEPENDENT: f64 = 1e-9;
/// Newton's steps to close the rows.
const CLOSING: usize = 30;
/// A step of Newton's method this short, in sizes or rad, is rounding.
const CLOSED: f64 = 1e-14;
/// The largest residual of a row that is not solved, in sizes or rad.
const OPEN: f64 = 1e-9;

/// The rows of the mechanism with its frames moved to the centres of mass.
#[derive(Debug, Clone)]
pub(super) struct Frames {
    pub(super) rows: Rows,
    /// By body: first of its columns, and the new origin in its own frame.
    pub(super) columns: Vec<Option<usize>>,
    shifts: Vec<Vec2>,
    /// Where the ground's origin is moved to.
    pub(super) ground: Vec2,
    /// What a radian is compared with, m.
    pub(super) size: f64,
    pub(super) row_scale: Vec<f64>,
    /// Row of the first actuator.
    pub(super) driven: usize,
}

impl Frames {
    pub(super) fn new(mechanism: &Mechanism, masses: &[Mass]) -> Result<Self, UnreducedError> {
        let dense = Dense::of_any_shape(mechanism, masses)?;
        let shifts: Vec<Vec2> = masses
            .iter()
            .zip(&dense.bodies)
            .map(|(mass, body)| {
                // The ground, and what has no mass, is given no centre.
                let centred = mass.mass > 0.0 && body.column.is_some();
                if centred { mass.center } else { body.shift }
            })
            .collect();
        let mut moved = mechanism.clone();
        each_attachment(&mut moved, |body, point| *point -= shifts[body]);
        Ok(Self {
            rows: Rows::new(&moved).map_err(crate::DenseError::from)?,
            columns: dense.bodies.iter().map(|b| b.column).collect(),
            ground: shifts[mechanism.ground],
            shifts,
            size: dense.size(),
            driven: dense.actuator_row(),
            row_scale: dense.row_scale,
        })
    }

    pub(super) fn count(&self) -> usize {
        self.rows.columns()
    }

    /// Coordinates and speeds of the centres out of frames and their rates.
    pub(super) fn enter(&self, bodies: &[[f64; 3]], velocity: &[[f64; 3]]) -> (Vec<f64>, Vec<f64>) {
        let (mut x, mut v) = (vec![0.0; self.count()], vec![0.0; self.count()]);
        for (b, column) in self.columns.iter().enumerate() {
            let Some(c) = *column else { continue };
            let ([px, py, angle], [vx, vy, omega]) = (bodies[b], velocity[b]);
            let arm = self.shifts[b].turn(Vec2::from_angle(angle));
            let center = (vec2(px, py) - self.ground) + arm;
            let speed = vec2(vx, vy) + arm.perp() * omega;
            x[c..c + 3].copy_from_slice(&[center.x, center.y, angle]);
            v[c..c + 3].copy_from_slice(&[speed.x, speed.y, omega]);
        }
        (x, v)
    }

    /// Frames and their rates out of coordinates and speeds of the centres.
    pub(super) fn leave(&self, x: &[f64], v: &[f64]) -> [Vec<[f64; 3]>; 2] {
        let count = self.columns.len();
        let mut both = [vec![[0.0; 3]; count], vec![[0.0; 3]; count]];
        for (b, column) in self.columns.iter().enumerate() {
            let Some(c) = *column else { continue };
            let arm = self.shifts[b].turn(Vec2::from_angle(x[c + 2]));
            let origin = self.ground + (vec2(x[c], x[c + 1]) - arm);
            let speed = vec2(v[c], v[c + 1]) - arm.perp() * v[c + 2];
            both[0][b] = [origin.x, origin.y, x[c + 2]];
            both[1][b] = [speed.x, speed.y, v[c + 2]];
        }
        both
    }

    pub(super) fn column_scale(&self, column: usize) -> f64 {
        if column % 3 == 2 {
            1.0 / self.size
        } else {
            1.0
        }
    }

    /// ∂Φ/∂x of all rows, row after row.
    pub(super) fn jacobian(&self, x: &[f64]) -> Vec<f64> {
        let mut jacobian = vec![0.0; self.rows.len() * self.count()];
        self.rows.jacobian(x, &mut jacobian);
        jacobian
    }

    /// One row's rate: its line of the Jacobian times the speeds.
    pub(super) fn rate(&self, jacobian: &[f64], row: usize, v: &[f64]) -> f64 {
        let line = &jacobian[row * self.count()..][..self.count()];
        line.iter().zip(v).map(|(j, v)| j * v).sum()
    }
}

/// The rows that are solved at a configuration, of those at hand: by Gram and Schmidt, always the
/// one that is farthest from those before.
fn independent(frames: &Frames, at_hand: &[usize], x: &[f64]) -> Vec<usize> {
    let jacobian = frames.jacobian(x);
    let n = frames.count();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let line = |&row: &usize| -> (usize, Vec<f64>) {
        let scaled = |c: usize| jacobian[row * n + c] * frames.column_scale(c);
        let scale = frames.row_scale[row];
        (row, (0..n).map(|c| scaled(c) * scale).collect())
    };
    let mut left: Vec<(usize, Vec<f64>)> = at_hand.iter().map(line).collect();
    let mut kept = Vec::new();
    while let Some(place) = (0..left.len()).max_by(|&i, &j| {
        let size = |k: usize| dot(&left[k].1, &left[k].1);
        size(i).total_cmp(&size(j))
    }) {
        let (row, line) = left.swap_remove(place);
        let length = dot(&line, &line).sqrt();
        if length.is_nan() || length < DEPENDENT {
            break;
        }
        let unit: Vec<f64> = line.iter().map(|v| v / length).collect();
        for (_, other) in &mut left {
            let part = dot(other, &unit);
            other
                .iter_mut()
                .zip(&unit)
                .for_each(|(v, u)| *v -= part * u);
        }
        kept.push(row);
    }
    kept.sort_unstable();
    kept
}

impl Unreduced {
    /// The mechanism with its prescribed actuators alone, and their rows after all joints'.
    fn constrained(&self) -> (Mechanism, Vec<usize>) {
        let mut mechanism = self.mechanism.clone();
        let mut rows: Vec<usize> = (0..self.frames.driven).collect();
        mechanism.actuators.clear();
        for (i, guidance) in self.guidance.iter().enumerate() {
            if *guidance != Guidance::Free {
                mechanism
                    .actuators
                    .push(self.mechanism.actuators[i].clone());
                rows.push(self.frames.driven + i);
            }
        }
        (mechanism, rows)
    }

    /// By reaction: whether the rows determine it where the bodies stand so.
    pub(super) fn unique(&self, bodies: &[[f64; 3]]) -> Result<Vec<bool>, UnreducedError> {
        let mut unique = vec![true; self.frames.driven];
        for row in rank(&self.constrained().0, bodies)?.driven.dependent {
            if let Some(unique) = unique.get_mut(row) {
                *unique = false;
            }
        }
        Ok(unique)
    }

    /// The equations with gears meshed and independent rows chosen at a start.
    pub(super) fn at_start(&self, start: &MotionSample) -> Result<Meshed<'_>, UnreducedError> {
        let (x, _) = self.frames.enter(&start.bodies, &start.velocity);
        let at_hand = self.constrained().1;
        let mut frames = self.frames.clone();
        frames.rows.mesh(&x);
        let held = independent(&frames, &at_hand, &x);
        Ok(Meshed {
            of: self,
            frames,
            held,
            at_hand,
        })
    }
}

impl Meshed<'_> {
    /// By row: the value, speed and acceleration that is imposed on it.
    pub(super) fn imposed(&self, t: f64) -> [Vec<f64>; 3] {
        let mut imposed = [0; 3].map(|_| vec![0.0; self.frames.rows.len()]);
        for (i, guidance) in self.of.guidance.iter().enumerate() {
            if let Guidance::Prescribed(law) = guidance {
                for (of, value) in imposed.iter_mut().zip(law.at(t)) {
                    of[self.frames.driven + i] = value;
                }
            }
        }
        imposed
    }

    /// The least change of the coordinates, a radian counted as a size, that changes the rows by
    /// `by`.
    fn least(&self, x: &[f64], by: &[f64], t: f64) -> Result<Vec<f64>, UnreducedError> {
        let frames = &self.frames;
        let (n, m) = (frames.count(), self.held.len());
        let jacobian = frames.jacobian(x);
        let mut matrix = Mat::zeros(n + m, n + m);
        let mut right = Mat::zeros(n + m, 1);
        for c in 0..n {
            matrix[(c, c)] = 1.0;
        }
        self.border(&jacobian, &mut matrix);
        for (k, &row) in self.held.iter().enumerate() {
            right[(n + k, 0)] = by[row] * frames.row_scale[row];
        }
        let lu = Lu::new(matrix).map_err(|pivot| UnreducedError::Singular { t, pivot })?;
        lu.solve(&mut right);
        Ok((0..n)
            .map(|c| right[(c, 0)] * frames.column_scale(c))
            .collect())
    }

    /// The scaled rows, below and to the right of what a matrix holds for the coordinates.
    pub(super) fn border(&self, jacobian: &[f64], matrix: &mut Mat<f64>) {
        let n = self.frames.count();
        for (k, &row) in self.held.iter().enumerate() {
            for c in 0..n {
                let entry = jacobian[row * n + c]
                    * self.frames.row_scale[row]
                    * self.frames.column_scale(c);
                matrix[(n + k, c)] = entry;
                matrix[(c, n + k)] = entry;
            }
        }
    }

    /// Puts coordinates and speeds back on the rows, by the least change.
    pub(super) fn project(&self, t: f64, y: &mut [f64]) -> Result<(), UnreducedError> {
        let frames = &self.frames;
        let n = frames.count();
        let (x, rest) = y.split_at_mut(n);
        let v = &mut rest[..n];
        let [value, speed, _] = self.imposed(t);
        let mut residual = vec![0.0; frames.rows.len()];
        let mut closed = false;
        for _ in 0..CLOSING {
            frames.rows.residual(x, &value, &mut residual);
            residual.iter_mut().for_each(|r| *r = -*r);
            let step = self.least(x, &residual, t)?;
            x.iter_mut().zip(&step).for_each(|(x, s)| *x += s);
            if frames.reach(&step) <= CLOSED * (1.0 + frames.reach(x)) {
                closed = true;
                break;
            }
        }
        frames.rows.residual(x, &value, &mut residual);
        let open = |&row: &usize| residual[row].abs() * frames.row_scale[row] / frames.size;
        if !closed || !self.at_hand.iter().all(|row| open(row) <= OPEN) {
            return Err(UnreducedError::NotClosed { t });
        }
        let jacobian = frames.jacobian(x);
        let missing = |row| speed[row] - frames.rate(&jacobian, row, v);
        let by: Vec<f64> = (0..frames.rows.len()).map(missing).collect();
        let change = self.least(x, &by, t)?;
        v.iter_mut().zip(&change).for_each(|(v, c)| *v += c);
        Ok(())
    }
}

impl Frames {
    /// The largest of angles and of lengths over the size.
    pub(super) fn reach(&self, of: &[f64]) -> f64 {
        let one = |(c, v): (usize, &f64)| (v / (self.size * self.column_scale(c))).abs();
        of.iter().enumerate().map(one).fold(0.0, f64::max)
    }
}
