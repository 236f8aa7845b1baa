//! The constraint rows of joints and actuators in body coordinates, dense, in the plane and in space.
//!
//! **Coordinates.** The ground has none; a body that moves in the plane has x, y and the angle of its frame; a body in space the
//! position of its frame and its rotation, whose derivatives are the velocity of the origin and the angular velocity.
//!
//! **Rows.** Those of the joints, then one per actuator. Row k reads Φₖ(x) − vₖ = 0. With the imposed value vₖ = 0 of a joint's row,
//! the joint is closed. Any other value opens the joint by this amount, as if the released constraint were a second coordinate
//! (Jordi, Zayas & Cardona 2008, figure 1). The value of an actuator's row is its coordinate q.
//!
//! Since the second point enters with a plus, the multiplier λₖ of row k in Jᵀλ is the action of the first body on the second.

pub(crate) mod coupling;
pub(crate) mod gear;
pub(crate) mod mesh;
pub(crate) mod row;
pub(crate) mod terms;

use crate::pose::{Columns, Pose, Twist};
use row::{Row, Since};

/// The rows of a mechanism with the coordinates of its bodies.
///
/// Slices given to the methods are `columns()` long for velocities, `len()` long for rows, and
/// `len() × columns()` long, one row after the other, for the Jacobian.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    rows: Vec<Row>,
    bodies: Vec<Columns>,
    columns: usize,
}

impl Rows {
    /// Rows over bodies with these coordinates.
    pub(crate) fn new(rows: Vec<Row>, bodies: Vec<Columns>) -> Self {
        let columns = bodies.iter().map(|body| body.range().len()).sum();
        Self {
            rows,
            bodies,
            columns,
        }
    }

    /// Number of coordinates.
    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    pub(crate) fn row(&self, row: usize) -> &Row {
        &self.rows[row]
    }

    /// Whether there are gears in space.
    pub(crate) fn has_teeth_in_space(&self) -> bool {
        self.rows.iter().any(|row| matches!(row, Row::Mesh(_)))
    }

    /// By pair of gears in space, with its row: how far its teeth are off after moving from some poses to others, m.
    pub(crate) fn teeth_off(&self, from: &[Pose], to: &[Pose]) -> Vec<(usize, f64)> {
        let teeth = self
            .rows
            .iter()
            .enumerate()
            .filter_map(|(k, row)| match row {
                Row::Mesh(mesh) => Some((k, mesh.travel(from, to))),
                Row::Sum { .. } | Row::Gear(_) | Row::Coupling(_) | Row::Idle(..) => None,
            });
        teeth.collect()
    }

    /// Meshes the gears of the plane as they stand at these poses: their rows vanish there. Neither the Jacobian nor J̇ẋ depends on it.
    pub(crate) fn mesh(&mut self, poses: &[Pose]) {
        for row in &mut self.rows {
            if let Row::Gear(gear) = row {
                gear.mesh(poses);
            }
        }
    }

    /// Φₖ(x) − vₖ into `out`, with the imposed values; rows of velocities are counted since a configuration.
    pub(crate) fn residual(
        &self,
        poses: &[Pose],
        since: Since<'_>,
        imposed: &[f64],
        out: &mut [f64],
    ) {
        for (k, (row, out)) in self.rows.iter().zip(out).enumerate() {
            *out = row.residual(poses, since, k, imposed[k]);
        }
    }

    /// ∂Φ/∂x, row after row.
    pub(crate) fn jacobian(&self, poses: &[Pose]) -> Vec<f64> {
        let mut jacobian = vec![0.0; self.len() * self.columns];
        for (k, row) in self.rows.iter().enumerate() {
            let line = &mut jacobian[k * self.columns..(k + 1) * self.columns];
            row.each_gradient(poses, |body, factor, gradient| {
                self.bodies[body].add(&gradient, factor, line);
            });
        }
        jacobian
    }

    /// By body: its rates.
    pub(crate) fn twists(&self, rates: &[f64]) -> Vec<Twist> {
        self.bodies.iter().map(|body| body.twist(rates)).collect()
    }

    /// J̇ẋ of all rows, so that Φ̈ = J ẍ + J̇ẋ.
    pub(crate) fn velocity_products(&self, poses: &[Pose], rates: &[f64]) -> Vec<f64> {
        let twists = self.twists(rates);
        let rows = self.rows.iter();
        rows.map(|row| row.velocity_product(poses, &twists))
            .collect()
    }
}
