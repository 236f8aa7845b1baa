//! What the joints leave free and what they hold twice, by the rank of their dense rows at generic
//! configurations. Counting and matching alone miss a part that is held twice while another is free.
//!
//! With the rows J (joints, then actuators) and J = U Σ Vᵀ of rank r, the last columns of V are
//! motions that every row allows, the last of U are forces in the joints that balance each other
//! without any load: a reaction with a part in one of these is not unique (M. Wojtyra, Joint
//! reaction forces in multibody systems with redundant constraints, 2005).

use crate::measure::BodyStates;
use crate::mechanism::{BodyId, JointKind, Mechanism};
use crate::plan::Start;
use crate::plane::{Vec2, vec2};
use crate::rows::Rows;
use faer::{Mat, MatRef};

/// What a mechanism's joints and actuators leave free and hold twice.
#[derive(Debug, Clone, PartialEq)]
pub struct Mobility {
    /// Number of moving bodies.
    pub bodies: usize,
    /// Number of constraint rows of the joints.
    pub rows: usize,
    /// Number of actuators.
    pub actuators: usize,
    /// Rank of the joints' rows.
    pub rank: usize,
    /// Bodies that still move with every actuator held.
    pub free: Vec<BodyId>,
    /// By row, the joints' reactions in the order of [`Mechanism::reactions`] and then the
    /// actuators: whether its force is determined by the loads.
    pub unique: Vec<bool>,
    /// Rows that the joints and actuators have more than their rank.
    pub excess: usize,
    /// Its largest length, m.
    pub size: f64,
    /// What stays open, m, where the mechanism closes nowhere.
    pub gap: Option<f64>,
}

impl Mobility {
    /// Degrees of freedom by counting: three for each moving body less one for each row.
    pub fn counted(&self) -> i64 {
        3 * self.bodies as i64 - self.rows as i64
    }

    /// Degrees of freedom by rank.
    pub fn freedom(&self) -> usize {
        3 * self.bodies - self.rank
    }
}

/// A singular value this small against the largest is zero: configurations are closed to 1e-12.
const ZERO: f64 = 1e-8;
/// A body or a row has a part in a null space of orthonormal vectors from here on.
const PART: f64 = 1e-6;
/// Where a position is known to less, what is zero there is this small.
const NEARLY_ZERO: f64 = 1e-5;
/// Closed: the residual relative to the size.
const CLOSED: f64 = 1e-11;
/// Steps of one attempt to close, and attempts from other angles.
const STEPS: usize = 60;
const ATTEMPTS: usize = 24;
/// Of a mechanism with more columns, only so many.
const MANY_COLUMNS: usize = 45;
const FEW_ATTEMPTS: usize = 4;
/// Columns above which the dense matrices would take seconds.
const MOST_COLUMNS: usize = 150;

/// The mechanism in dense coordinates, lengths over its size.
struct Dense {
    rows: Rows,
    size: f64,
    joints: usize,
    imposed: Vec<f64>,
    /// Singular values this small against the largest are zero.
    zero: f64,
}

/// Finds the mobility of a mechanism near its start; none where it is too large for dense matrices
/// or its rows cannot be written.
pub fn mobility(mechanism: &Mechanism, start: &Start) -> Option<Mobility> {
    let rows = Rows::new(mechanism).ok()?;
    if rows.columns() == 0 || rows.columns() > MOST_COLUMNS {
        return None;
    }
    let joints = rows.len() - mechanism.actuators.len();
    let mut imposed = vec![0.0; rows.len()];
    imposed[joints..].copy_from_slice(&start.q);
    let mut dense = Dense {
        size: size(mechanism),
        joints,
        imposed,
        zero: ZERO,
        rows,
    };
    let (x, gap) = dense.assemble(mechanism, start);
    let closed = gap <= CLOSED * dense.size;
    let mut ranks = dense.ranks(mechanism, &x);
    if closed && let Some(other) = dense.elsewhere(&x) {
        let elsewhere = dense.ranks(mechanism, &other);
        if elsewhere.rank > ranks.rank || elsewhere.excess < ranks.excess {
            ranks = elsewhere;
        }
    }
    ranks.gap = (!closed).then_some(gap);
    Some(ranks)
}

/// The mobility at one position, which may be singular: more may move there than elsewhere, and fewer
/// reactions be determined. None where the rows cannot be written.
pub fn mobility_here(mechanism: &Mechanism, states: &BodyStates) -> Option<Mobility> {
    let rows = Rows::new(mechanism).ok()?;
    let mut x = vec![0.0; rows.columns()];
    for b in (0..mechanism.bodies.len()).map(BodyId) {
        if let Some(c) = rows.column(b) {
            let origin = states.point(b, Vec2::ZERO).position;
            (x[c], x[c + 1]) = (origin.x, origin.y);
            x[c + 2] = states.body(b).turn.angle();
        }
    }
    let dense = Dense {
        size: size(mechanism),
        joints: rows.len() - mechanism.actuators.len(),
        imposed: vec![0.0; rows.len()],
        zero: NEARLY_ZERO,
        rows,
    };
    Some(dense.ranks(mechanism, &x))
}

/// The largest distance of two points of one body, m.
fn size(mechanism: &Mechanism) -> f64 {
    let mut corners: Vec<Option<(Vec2, f64)>> = vec![None; mechanism.bodies.len()];
    let mut size = 0.0_f64;
    for joint in &mechanism.joints {
        for (body, point) in joint.bodies.iter().zip(joint.points) {
            match &mut corners[body.0] {
                Some((first, reach)) => *reach = reach.max((point - *first).norm()),
                none => *none = Some((point, 0.0)),
            }
        }
        size = size.max(match joint.kind {
            JointKind::Gear { radii, .. } => radii[0].max(radii[1]),
            JointKind::Rack { radius, .. } | JointKind::Rolling { radius, .. } => radius.abs(),
            JointKind::Distance { length } => length,
            _ => 0.0,
        });
    }
    let reach = corners.iter().flatten().map(|c| c.1).fold(size, f64::max);
    if reach > 0.0 { reach } else { 1.0 }
}

impl Dense {
    /// A configuration near the rough angles that closes all rows, or comes nearest, and what is
    /// left open there, m.
    fn assemble(&mut self, mechanism: &Mechanism, start: &Start) -> (Vec<f64>, f64) {
        let mut best = (vec![0.0; self.rows.columns()], f64::INFINITY);
        let attempts = if self.rows.columns() > MANY_COLUMNS {
            FEW_ATTEMPTS
        } else {
            ATTEMPTS
        };
        for attempt in 0..attempts {
            let mut x = self.guess(mechanism, start, attempt);
            self.rows.mesh(&x);
            let gap = self.close(&mut x, self.rows.len());
            if gap < best.1 {
                best = (x, gap);
            }
            if best.1 <= CLOSED * self.size {
                break;
            }
        }
        best
    }

    /// Rough angles where they are known, others else, and each body put to one that is placed.
    fn guess(&self, mechanism: &Mechanism, start: &Start, attempt: usize) -> Vec<f64> {
        let mut x = vec![0.0; self.rows.columns()];
        for (b, rough) in start.rough.iter().enumerate() {
            if let Some(c) = self.rows.column(BodyId(b)) {
                let other = 0.3 + 2.4 * (attempt * (b + 1)) as f64;
                x[c + 2] = rough.unwrap_or(other);
            }
        }
        let frame = |x: &[f64], b: BodyId| match self.rows.column(b) {
            Some(c) => (vec2(x[c], x[c + 1]), Vec2::from_angle(x[c + 2])),
            None => (Vec2::ZERO, Vec2::IDENTITY),
        };
        let mut placed = vec![false; mechanism.bodies.len()];
        placed[mechanism.ground] = true;
        let mut again = true;
        while std::mem::replace(&mut again, false) {
            for joint in &mechanism.joints {
                for (from, to) in [(0, 1), (1, 0)] {
                    let [parent, child] = [from, to].map(|i| joint.bodies[i]);
                    if !placed[parent.0] || placed[child.0] {
                        continue;
                    }
                    if let Some(c) = self.rows.column(child) {
                        let (origin, turn) = frame(&x, parent);
                        let (_, own) = frame(&x, child);
                        let at =
                            origin + joint.points[from].turn(turn) - joint.points[to].turn(own);
                        (x[c], x[c + 1]) = (at.x, at.y);
                    }
                    placed[child.0] = true;
                    again = true;
                }
            }
        }
        x
    }

    /// Closes the first `count` rows by the smallest corrections; what is left open, m.
    fn close(&self, x: &mut [f64], count: usize) -> f64 {
        let mut gap = self.open(x, count);
        for _ in 0..STEPS {
            let (jacobian, residual) = (self.jacobian(x), self.residual(x));
            let Ok(svd) = jacobian.subrows(0, count).svd() else {
                return f64::INFINITY;
            };
            let (u, v) = (svd.U(), svd.V());
            let values = svd.S().column_vector();
            let mut step = vec![0.0; x.len()];
            for k in 0..values.nrows() {
                if values[k] <= ZERO * values[0] {
                    break;
                }
                let along: f64 = (0..count).map(|i| u[(i, k)] * residual[i]).sum();
                for (j, step) in step.iter_mut().enumerate() {
                    *step -= v[(j, k)] * along / values[k];
                }
            }
            // At most about half a radian or half the size in a step.
            let most = step.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
            let damp = if most > 0.5 { 0.5 / most } else { 1.0 };
            for (j, step) in step.iter().enumerate() {
                let unit = if j % 3 == 2 { 1.0 } else { self.size };
                x[j] += step * damp * unit;
            }
            let next = self.open(x, count);
            if next.is_nan() {
                return f64::INFINITY;
            }
            if most < 1e-14 || (next >= gap && next <= CLOSED * self.size) {
                return next;
            }
            gap = next;
        }
        gap
    }

    /// Another configuration that closes the joints, a step along what they leave free.
    fn elsewhere(&self, x: &[f64]) -> Option<Vec<f64>> {
        let jacobian = self.jacobian(x);
        let svd = jacobian.subrows(0, self.joints).svd().ok()?;
        let (rank, v) = (rank_of(&svd.S().column_vector(), self.zero), svd.V());
        let mut other = x.to_vec();
        for k in rank..v.ncols() {
            for (j, value) in other.iter_mut().enumerate() {
                let unit = if j % 3 == 2 { 1.0 } else { self.size };
                *value += 0.2 * unit * v[(j, k)] / (1.0 + 0.3 * k as f64);
            }
        }
        let gap = self.close(&mut other, self.joints);
        (gap <= CLOSED * self.size).then_some(other)
    }

    fn ranks(&self, mechanism: &Mechanism, x: &[f64]) -> Mobility {
        let all = self.jacobian(x);
        let mut found = Mobility {
            bodies: mechanism.bodies.len() - 1,
            rows: self.joints,
            actuators: mechanism.actuators.len(),
            rank: 0,
            free: Vec::new(),
            unique: vec![false; self.rows.len()],
            excess: 0,
            size: self.size,
            gap: None,
        };
        if let Ok(svd) = all.subrows(0, self.joints).svd() {
            found.rank = rank_of(&svd.S().column_vector(), self.zero);
        }
        if let Ok(svd) = all.svd() {
            let rank = rank_of(&svd.S().column_vector(), self.zero);
            found.excess = self.rows.len() - rank;
            let part = |m: MatRef<'_, f64>, i: usize| -> f64 {
                (rank..m.ncols()).map(|k| m[(i, k)] * m[(i, k)]).sum()
            };
            for (k, unique) in found.unique.iter_mut().enumerate() {
                *unique = part(svd.U(), k) <= PART * PART;
            }
            let bodies = (0..mechanism.bodies.len()).map(BodyId);
            let moves = |b: &BodyId| {
                let column = self.rows.column(*b);
                column.is_some_and(|c| (c..c + 3).any(|c| part(svd.V(), c) > PART * PART))
            };
            found.free = bodies.filter(moves).collect();
        }
        found
    }

    /// The rows' derivatives, lengths over the size.
    fn jacobian(&self, x: &[f64]) -> Mat<f64> {
        let (m, n) = (self.rows.len(), self.rows.columns());
        let mut flat = vec![0.0; m * n];
        self.rows.jacobian(x, &mut flat);
        let angular = self.rows.angular();
        Mat::from_fn(m, n, |i, j| {
            let row = if angular[i] { 1.0 } else { 1.0 / self.size };
            let column = if j % 3 == 2 { 1.0 } else { self.size };
            flat[i * n + j] * row * column
        })
    }

    /// What is open, lengths over the size.
    fn residual(&self, x: &[f64]) -> Vec<f64> {
        let mut open = vec![0.0; self.rows.len()];
        self.rows.residual(x, &self.imposed, &mut open);
        for (open, &angular) in open.iter_mut().zip(self.rows.angular()) {
            if !angular {
                *open /= self.size;
            }
        }
        open
    }

    /// The largest opening of the first rows, m.
    fn open(&self, x: &[f64], count: usize) -> f64 {
        let open = self.residual(x);
        let largest =
            open[..count].iter().fold(
                0.0_f64,
                |m, o| {
                    if o.is_nan() { f64::NAN } else { m.max(o.abs()) }
                },
            );
        largest * self.size
    }
}

fn rank_of(values: &faer::ColRef<'_, f64>, zero: f64) -> usize {
    let largest = if values.nrows() > 0 { values[0] } else { 0.0 };
    (0..values.nrows())
        .filter(|&k| values[k] > zero * largest)
        .count()
}
