//! Mobility: degrees of freedom and redundant constraints, by the rank of the dense constraint rows at generic
//! configurations. Counting and matching alone miss a part that is over-constrained while another is free.
//!
//! With the rows J (joints, then actuators) and J = U Σ Vᵀ of rank r, the last columns of V are
//! motions that every row allows, the last of U are self-equilibrated forces in the joints: a reaction with a part in one of these is not unique (M. Wojtyra, Joint
//! reaction forces in multibody systems with redundant constraints, 2005).

use crate::body_states::BodyStates;
use crate::constraint_rows::ConstraintRows;
use crate::mechanism::{BodyId, Condition, Joint, JointKind, Mechanism};
use crate::plan::AssemblyConfiguration;
use crate::plane::{Vec2, vec2};
use dwell_numerics::dense::{Matrix, Svd};

/// Degrees of freedom and redundant constraints of a mechanism.
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
    /// Bodies that can still move with every actuator locked.
    pub free_bodies: Vec<BodyId>,
    /// By row, the joints' reactions in the order of [`Mechanism::reactions`] and then the
    /// actuators: whether its force is determined by the loads.
    pub determinate: Vec<bool>,
    /// Number of rows of joints and actuators less their rank.
    pub redundant_count: usize,
    /// The [size](Mechanism::size) of the mechanism, m.
    pub size: f64,
    /// The smallest residual, m, where no configuration closes all rows.
    pub gap: Option<f64>,
}

impl Mobility {
    /// Degrees of freedom by counting: three for each moving body less one for each row.
    pub fn grubler_count(&self) -> i64 {
        3 * self.bodies as i64 - self.rows as i64
    }

    /// Degrees of freedom by rank.
    pub fn degrees_of_freedom(&self) -> usize {
        3 * self.bodies - self.rank
    }
}

/// A singular value this small against the largest is zero: configurations are closed to 1e-12.
const RANK_TOLERANCE: f64 = 1e-8;
/// A body or a row has a part in a null space of orthonormal vectors from here on.
const NULL_SPACE_PART: f64 = 1e-6;
/// The rank tolerance at a position that is known less precisely.
const LOOSE_RANK_TOLERANCE: f64 = 1e-5;
/// Closed: the residual relative to the size.
const CLOSED: f64 = 1e-11;
/// Steps of one attempt to close, and attempts from other angles.
const MAX_STEPS: usize = 60;
const MAX_ATTEMPTS: usize = 24;
/// Attempts for a mechanism with more columns.
const LARGE_COLUMNS: usize = 45;
const MAX_ATTEMPTS_LARGE: usize = 4;
/// Columns above which the dense matrices would take seconds.
const MAX_COLUMNS: usize = 150;

/// The mechanism in dense coordinates, lengths over its size.
struct DenseConstraints {
    rows: ConstraintRows,
    size: f64,
    joint_rows: usize,
    prescribed_values: Vec<f64>,
    /// Singular values this small against the largest are zero.
    rank_tolerance: f64,
}

/// Finds the mobility of a mechanism near its assembly; `None` if it is too large for dense matrices
/// or its rows cannot be written.
pub fn mobility(mechanism: &Mechanism, configuration: &AssemblyConfiguration) -> Option<Mobility> {
    let mut constraints = DenseConstraints::new(mechanism, RANK_TOLERANCE)?;
    if constraints.rows.columns() == 0 || constraints.rows.columns() > MAX_COLUMNS {
        return None;
    }
    let joint_rows = constraints.joint_rows;
    constraints.prescribed_values[joint_rows..].copy_from_slice(&configuration.q);
    let (x, gap) = constraints.assemble(mechanism, configuration);
    let closed = gap <= CLOSED * constraints.size;
    let mut found = constraints.analyse(mechanism, &x);
    if closed && let Some(other) = constraints.other_configuration(&x) {
        let elsewhere = constraints.analyse(mechanism, &other);
        if elsewhere.rank > found.rank || elsewhere.redundant_count < found.redundant_count {
            found = elsewhere;
        }
    }
    found.gap = (!closed).then_some(gap);
    Some(found)
}

/// The mobility at one position, which may be singular: there may be more degrees of freedom than elsewhere, and fewer
/// determinate reactions. `None` if the rows cannot be written.
pub fn mobility_at(mechanism: &Mechanism, states: &BodyStates) -> Option<Mobility> {
    let constraints = DenseConstraints::new(mechanism, LOOSE_RANK_TOLERANCE)?;
    let mut x = vec![0.0; constraints.rows.columns()];
    for b in (0..mechanism.bodies.len()).map(BodyId) {
        if let Some(c) = constraints.rows.column(b) {
            let origin = states.point(b, Vec2::ZERO).position;
            (x[c], x[c + 1]) = (origin.x, origin.y);
            x[c + 2] = states.body(b).rotation.angle();
        }
    }
    Some(constraints.analyse(mechanism, &x))
}

/// How far the two points of a joint are apart, m; `None` if they meet or lie on a line of both bodies.
fn points_apart(kind: JointKind) -> Option<f64> {
    kind.conditions().find_map(|condition| match condition {
        Condition::Together | Condition::OnLine { .. } | Condition::Turned { .. } => None,
        Condition::Meshed { radii, internal } => {
            let sign = if internal { -1.0 } else { 1.0 };
            Some((radii[0] + sign * radii[1]).abs())
        }
        Condition::Rolled { radius, .. } => Some(radius.abs()),
        Condition::Apart { length } => Some(length),
        Condition::Coupled(_) => Some(0.0),
    })
}

impl DenseConstraints {
    fn new(mechanism: &Mechanism, rank_tolerance: f64) -> Option<Self> {
        let rows = ConstraintRows::new(mechanism).ok()?;
        Some(Self {
            size: mechanism.size(),
            joint_rows: rows.len() - mechanism.actuators.len(),
            prescribed_values: vec![0.0; rows.len()],
            rank_tolerance,
            rows,
        })
    }

    /// The unit of a column: lengths are over the size.
    fn unit(&self, column: usize) -> f64 {
        if column % 3 == 2 { 1.0 } else { self.size }
    }

    /// A configuration near the approximate angles that closes all rows, or comes nearest, and its residual, m.
    fn assemble(
        &mut self,
        mechanism: &Mechanism,
        configuration: &AssemblyConfiguration,
    ) -> (Vec<f64>, f64) {
        let mut best = (vec![0.0; self.rows.columns()], f64::INFINITY);
        let attempts = if self.rows.columns() > LARGE_COLUMNS {
            MAX_ATTEMPTS_LARGE
        } else {
            MAX_ATTEMPTS
        };
        for attempt in 0..attempts {
            let mut x = self.initial_guess(mechanism, configuration, attempt);
            self.rows.mesh(&x);
            let gap = self.close_rows(&mut x, self.rows.len());
            if gap < best.1 {
                best = (x, gap);
            }
            if best.1 <= CLOSED * self.size {
                break;
            }
        }
        best
    }

    /// Approximate angles where they are given, trial angles else; each body is joined to one that has a position.
    fn initial_guess(
        &self,
        mechanism: &Mechanism,
        configuration: &AssemblyConfiguration,
        attempt: usize,
    ) -> Vec<f64> {
        let mut x = vec![0.0; self.rows.columns()];
        for (b, angle) in configuration.initial_guess.iter().enumerate() {
            if let Some(c) = self.rows.column(BodyId(b)) {
                let other = 0.3 + 2.4 * (attempt * (b + 1)) as f64;
                x[c + 2] = angle.unwrap_or(other);
            }
        }
        let frame = |x: &[f64], b: BodyId| match self.rows.column(b) {
            Some(c) => (vec2(x[c], x[c + 1]), Vec2::from_angle(x[c + 2])),
            None => (Vec2::ZERO, Vec2::IDENTITY),
        };
        let mut placed = vec![false; mechanism.bodies.len()];
        placed[mechanism.ground] = true;
        // Where gears, wheels and the ends of a distance are, other joints say if they can: joints whose points meet come first.
        let is_together = |joint: &&Joint| points_apart(joint.kind).is_none();
        loop {
            let can_place = |joint: &&Joint| {
                let [one, two] = joint.bodies.map(|b| placed[b.0]);
                one != two
            };
            let joints = || mechanism.joints.iter().filter(can_place);
            let Some(joint) = joints().find(is_together).or_else(|| joints().next()) else {
                break x;
            };
            let from = usize::from(!placed[joint.bodies[0].0]);
            let [parent, child] = [from, 1 - from].map(|i| joint.bodies[i]);
            if let Some(c) = self.rows.column(child) {
                let (origin, rotation) = frame(&x, parent);
                let (_, child_rotation) = frame(&x, child);
                let apart =
                    Vec2::from_angle(attempt as f64) * points_apart(joint.kind).unwrap_or(0.0);
                let at = origin + joint.points[from].rotate(rotation) + apart
                    - joint.points[1 - from].rotate(child_rotation);
                (x[c], x[c + 1]) = (at.x, at.y);
            }
            placed[child.0] = true;
        }
    }

    /// Closes the first `count` rows by the smallest corrections; returns the residual, m.
    fn close_rows(&self, x: &mut [f64], count: usize) -> f64 {
        let mut gap = self.largest_residual(x, count);
        for _ in 0..MAX_STEPS {
            let (jacobian, residual) = (self.jacobian(x), self.residual(x));
            let Some(Svd { u, values, v }) = jacobian.first_rows(count).svd() else {
                return f64::INFINITY;
            };
            let mut step = vec![0.0; x.len()];
            for (k, &value) in values.iter().enumerate() {
                if value <= RANK_TOLERANCE * values[0] {
                    break;
                }
                let along: f64 = (0..count).map(|i| u[(i, k)] * residual[i]).sum();
                for (j, step) in step.iter_mut().enumerate() {
                    *step -= v[(j, k)] * along / value;
                }
            }
            // At most about half a radian or half the size in a step.
            let largest_step = step.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
            let damp = if largest_step > 0.5 {
                0.5 / largest_step
            } else {
                1.0
            };
            for (j, step) in step.iter().enumerate() {
                x[j] += step * damp * self.unit(j);
            }
            let next = self.largest_residual(x, count);
            if next.is_nan() {
                return f64::INFINITY;
            }
            if largest_step < 1e-14 || (next >= gap && next <= CLOSED * self.size) {
                return next;
            }
            gap = next;
        }
        gap
    }

    /// Another configuration that closes the joints, a step along their null space.
    fn other_configuration(&self, x: &[f64]) -> Option<Vec<f64>> {
        let jacobian = self.jacobian(x);
        let svd = jacobian.first_rows(self.joint_rows).svd()?;
        let (rank, v) = (svd.rank(self.rank_tolerance), svd.v);
        let mut other = x.to_vec();
        for k in rank..v.columns() {
            for (j, value) in other.iter_mut().enumerate() {
                *value += 0.2 * self.unit(j) * v[(j, k)] / (1.0 + 0.3 * k as f64);
            }
        }
        let gap = self.close_rows(&mut other, self.joint_rows);
        (gap <= CLOSED * self.size).then_some(other)
    }

    fn analyse(&self, mechanism: &Mechanism, x: &[f64]) -> Mobility {
        let all = self.jacobian(x);
        let mut found = Mobility {
            bodies: mechanism.bodies.len() - 1,
            rows: self.joint_rows,
            actuators: mechanism.actuators.len(),
            rank: 0,
            free_bodies: Vec::new(),
            determinate: vec![false; self.rows.len()],
            redundant_count: 0,
            size: self.size,
            gap: None,
        };
        if let Some(svd) = all.first_rows(self.joint_rows).svd() {
            found.rank = svd.rank(self.rank_tolerance);
        }
        if let Some(svd) = all.svd() {
            let rank = svd.rank(self.rank_tolerance);
            found.redundant_count = self.rows.len() - rank;
            let part = |m: &Matrix, i: usize| -> f64 {
                (rank..m.columns()).map(|k| m[(i, k)] * m[(i, k)]).sum()
            };
            for (k, determinate) in found.determinate.iter_mut().enumerate() {
                *determinate = part(&svd.u, k) <= NULL_SPACE_PART * NULL_SPACE_PART;
            }
            let bodies = (0..mechanism.bodies.len()).map(BodyId);
            let moves = |b: &BodyId| {
                let column = self.rows.column(*b);
                column.is_some_and(|c| {
                    (c..c + 3).any(|c| part(&svd.v, c) > NULL_SPACE_PART * NULL_SPACE_PART)
                })
            };
            found.free_bodies = bodies.filter(moves).collect();
        }
        found
    }

    /// The rows' derivatives, lengths over the size.
    fn jacobian(&self, x: &[f64]) -> Matrix {
        let (m, n) = (self.rows.len(), self.rows.columns());
        let mut flat = vec![0.0; m * n];
        self.rows.jacobian(x, &mut flat);
        let angular = self.rows.angular();
        Matrix::from_fn(m, n, |i, j| {
            let row = if angular[i] { 1.0 } else { 1.0 / self.size };
            flat[i * n + j] * row * self.unit(j)
        })
    }

    /// The residuals, lengths over the size.
    fn residual(&self, x: &[f64]) -> Vec<f64> {
        let mut residual = vec![0.0; self.rows.len()];
        self.rows
            .residual(x, &self.prescribed_values, &mut residual);
        for (residual, &angular) in residual.iter_mut().zip(self.rows.angular()) {
            if !angular {
                *residual /= self.size;
            }
        }
        residual
    }

    /// The largest residual of the first rows, m.
    fn largest_residual(&self, x: &[f64], count: usize) -> f64 {
        let residual = self.residual(x);
        let largest = residual[..count].iter().fold(0.0_f64, |m, o| {
            if o.is_nan() { f64::NAN } else { m.max(o.abs()) }
        });
        largest * self.size
    }
}
