//! The constraint rows of every joint and actuator in body coordinates, dense: the description of a mechanism that the
//! independent checks use.
//!
//! **Coordinates.** Each moving body has three, x = [x, y, θ]: the position of the origin of its frame
//! in the plane, and the angle of its frame. The ground stays at 0, 0, 0. The moving
//! bodies follow each other in the order of [`Mechanism::bodies`].
//!
//! **Rows.** One per reaction component in the order of [`Mechanism::reactions`], then one per actuator. Row k reads
//! Φₖ(x) − vₖ = 0. With the imposed value vₖ = 0 of a joint's row, the joint is closed; any other value opens the joint
//! by this amount, as if the released constraint were a second coordinate (Jordi, Zayas & Cardona 2008, figure 1). The
//! value of an actuator's row is its coordinate q.
//!
//! With d = P2 − P1, t the first body's axis and n that axis turned +90°, all in the plane's
//! directions, and ψ the direction of d:
//!
//! ```text
//! revolute   d                                    (1)  two rows, m
//! prismatic  n·d                                  (2)  m
//!            (θ2 + α2) − (θ1 + α1)                (3)  rad, to the nearest turn; α the axis's angle
//! slot       n·d                                  (4)  m
//! weld       d, then θ2 − θ1 − angle              (5)  m, m, rad to the nearest turn
//! gear       r2 (θ2 − ψ) ± r1 (θ1 − ψ) − c        (6)  m; + external, − internal
//! rack       t·d + r (θ2 − θ1)                    (7)  m
//! rolling    n·d − r, then t·d + r (θ2 − θ1)      (8)  m
//! distance   |d| − length                         (9)  m
//! coupling   of − law(by)                         (10) rad or m
//! actuator   θ2 − θ1, or t·d, or |d|              (11) rad or m
//! ```
//!
//! **Counting.** Rows (6) to (8), and (10) with an angle, depend on whole revolutions of a body. A mechanism that has
//! one of these is *counted*: its angles in x must be counted from the start on, and (11) takes an angle as it is. In
//! any other mechanism whole revolutions of a body have no effect, and (11) is taken modulo one revolution. ψ is
//! counted with the body that holds both centres; where there is none, to the turn that leaves the row least open. The
//! constant c is set by [`ConstraintRows::mesh`] at the start; until then it is zero.
//!
//! **Signs.** Since P2 enters with a plus, the multiplier λₖ of row k in Jᵀλ is the action of the
//! first-named body on the second, as [`crate::Component`] says. In rows along an axis the
//! derivative with θ1 turns the axis too, so that the force acts on both bodies at the *second*
//! body's point; the rows with r bring the couple that moves it to the pitch point. The
//! multiplier of (6) has the moment r2 λ on the second body. A coupling's λ acts on the bodies of
//! `of`, and −λ dlaw/dby on those of `by`.

mod from_joints;
mod gear;
mod row;
mod terms;
#[cfg(test)]
mod tests;

use crate::mechanism::{BodyId, Component, Mechanism};
use from_joints::{RowWriter, joint_counts_revolutions};
use row::ConstraintRow;
use terms::{BodyCoordinates, Column, ConstraintTerm};

/// Why rows cannot be written for a mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ConstraintRowsError {
    /// The ground is not among the bodies.
    #[error("the ground is body {ground}, but there are {bodies} bodies")]
    NoGround {
        /// Index given for the ground.
        ground: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// A joint, an actuator or a coupling names a body that does not exist.
    #[error("{what} {index} names body {body}, but there are {bodies} bodies")]
    NoBody {
        /// The kind of its owner: "joint", "actuator" or "coupling".
        what: &'static str,
        /// Which of them.
        index: usize,
        /// Index it names.
        body: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// A joint names a coupling that does not exist.
    #[error("joint {joint} names coupling {coupling}, but there are {couplings} couplings")]
    NoCoupling {
        /// Index of the joint.
        joint: usize,
        /// Index it names.
        coupling: usize,
        /// Number of couplings.
        couplings: usize,
    },
    /// A coordinate is the travel of a joint that has none.
    #[error("joint {joint} has no travel: it is neither a prismatic joint nor a slot")]
    NoTravel {
        /// Index of the joint.
        joint: usize,
    },
}

/// The rows of a mechanism. Everything they need is copied, so they outlive it.
///
/// Slices given to the methods are `columns()` long for coordinates, `len()` long for rows, and
/// `len() × columns()` long, one row after the other, for the Jacobian.
#[derive(Debug, Clone)]
pub struct ConstraintRows {
    rows: Vec<ConstraintRow>,
    angular: Vec<bool>,
    body_columns: Vec<Column>,
    columns: usize,
    counts_revolutions: bool,
}

impl ConstraintRows {
    /// The rows of `mechanism`, or which of its references is broken. Axes are taken as the unit
    /// vectors they are documented to be.
    pub fn new(mechanism: &Mechanism) -> Result<Self, ConstraintRowsError> {
        let (ground, bodies) = (mechanism.ground, mechanism.bodies.len());
        if ground >= bodies {
            return Err(ConstraintRowsError::NoGround { ground, bodies });
        }
        let column = |b: usize| (b != ground).then(|| 3 * (b - usize::from(b > ground)));
        let body_columns: Vec<_> = (0..bodies).map(column).collect();
        let writer = RowWriter {
            mechanism,
            columns: &body_columns,
        };
        let mut joints = mechanism.joints.iter();
        let counts_revolutions = joints.any(|j| joint_counts_revolutions(mechanism, j));
        for (joint, described) in mechanism.joints.iter().enumerate() {
            writer.check_bodies("joint", joint, described.bodies)?;
        }
        let mut rows = Vec::with_capacity(2 * mechanism.joints.len() + mechanism.actuators.len());
        for (joint, described) in mechanism.joints.iter().enumerate() {
            rows.extend(writer.joint(joint, described)?);
        }
        for (actuator, described) in mechanism.actuators.iter().enumerate() {
            writer.check_bodies("actuator", actuator, described.bodies)?;
            let term = writer.term("actuator", actuator, described.coordinate())?;
            rows.push(match term {
                ConstraintTerm::RelativeAngle(angle_columns) if !counts_revolutions => {
                    ConstraintRow::periodic_angle(angle_columns, 0.0)
                }
                term => ConstraintRow::single(term, 0.0),
            });
        }
        let reactions = mechanism.reactions();
        let joints = reactions.iter().map(|r| r.component == Component::Moment);
        let actuators = mechanism.actuators.iter();
        let angular = joints.chain(actuators.map(|a| a.coordinate().is_angle()));
        Ok(Self {
            rows,
            angular: angular.collect(),
            body_columns,
            columns: 3 * (bodies - 1),
            counts_revolutions,
        })
    }

    /// Number of coordinates: three per moving body.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows: one per reaction component, one per actuator.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are no rows at all.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The column of the body's x coordinate, followed by those of y and θ; `None` for the ground.
    pub fn column(&self, body: BodyId) -> Option<usize> {
        self.body_columns.get(body.0).copied().flatten()
    }

    /// Whether each row is an angle (rad) rather than a length (m).
    pub fn angular(&self) -> &[bool] {
        &self.angular
    }

    /// Whether the rows feel whole revolutions of a body, so that the angles in x must be counted.
    pub fn counts_revolutions(&self) -> bool {
        self.counts_revolutions
    }

    /// Meshes the gears as they stand at `x_start`: their rows vanish there. Neither the Jacobian
    /// nor the curvature depends on it.
    pub fn mesh(&mut self, x_start: &[f64]) {
        let at = BodyCoordinates::new(x_start);
        for row in &mut self.rows {
            if let ConstraintRow::Gear(gear) = row {
                gear.mesh(&at, x_start);
            }
        }
    }

    /// Φₖ(x) − vₖ into `out`, with the imposed values `imposed`.
    pub fn residual(&self, x: &[f64], prescribed: &[f64], out: &mut [f64]) {
        let at = BodyCoordinates::new(x);
        for ((row, value), out) in self.rows.iter().zip(prescribed).zip(out) {
            *out = row.residual(&at, x, *value);
        }
    }

    /// ∂Φ/∂x into `out`, row after row.
    pub fn jacobian(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let at = BodyCoordinates::new(x);
        for (k, row) in self.rows.iter().enumerate() {
            let out = &mut out[k * self.columns..(k + 1) * self.columns];
            row.each_term(&at, |factor, term| {
                term.gradient(&at, |c, derivative| {
                    for (out, d) in out[c..c + 3].iter_mut().zip(derivative) {
                        *out += factor * d;
                    }
                });
            });
        }
    }

    /// The velocity-squared terms Φ̇ₓ ẋ into `out`, so that Φ̈ = J ẍ + Φ̇ₓ ẋ: the second derivative
    /// of Φ along x + s ẋ at s = 0.
    pub fn velocity_product(&self, x: &[f64], x_dot: &[f64], out: &mut [f64]) {
        let at = BodyCoordinates::new(x);
        for (row, out) in self.rows.iter().zip(out) {
            *out = row.velocity_product(&at, x_dot);
        }
    }
}
