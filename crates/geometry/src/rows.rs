//! The constraint rows of every joint and actuator in body coordinates, dense and plain: the
//! independent side of the workbench.
//!
//! **Coordinates.** Each moving body has three, x = [x, y, θ]: where the origin of its own frame
//! stands in the plane, and how its frame is turned. The ground stays at 0, 0, 0. The moving
//! bodies follow each other in the order of [`Mechanism::bodies`].
//!
//! **Rows.** One per reaction component in the order of [`Mechanism::reactions`], then one per
//! actuator. Row k reads Φₖ(x) − vₖ = 0. With the imposed value vₖ = 0 of a joint's row, the joint
//! is closed; any other value is the joint really opened by that much, which is what releasing a
//! constraint as a second coordinate means (Jordi, Zayas & Cardona 2008, figure 1). The value of
//! an actuator's row is its coordinate q.
//!
//! With r the arm from a body's origin to its point P, t the first body's axis and n that axis
//! turned +90°, all in the plane's directions:
//!
//! ```text
//! revolute   Φ = P2 − P1                                     (1)  two rows, m
//! prismatic  Φ = n1·(P2 − P1)                                (2)  m
//!            Φ = (θ2 + α2) − (θ1 + α1), α the axis's angle   (3)  rad, to the nearest turn
//! actuator   Φ = θ2 − θ1                                     (4)  rad, to the nearest turn
//! ```
//!
//! **Signs.** Since P2 enters with a plus, the multiplier λₖ of row k in Jᵀλ is the action of the
//! first-named body on the second. In row (2) the derivative with θ1 turns the normal too, so that
//! both bodies feel the normal force at the *second* body's point.

use crate::mechanism::{BodyId, JointKind, Mechanism};
use crate::plane::{Vec2, vec2};
use std::f64::consts::TAU;

/// Why rows cannot be written for a mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RowsError {
    /// The fixed body is not among the bodies.
    #[error("the ground is body {ground}, but there are {bodies} bodies")]
    NoGround {
        /// Index given for the ground.
        ground: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// A joint names a body that is not there.
    #[error("joint {joint} names body {body}, but there are {bodies} bodies")]
    JointBody {
        /// Index of the joint.
        joint: usize,
        /// Index it names.
        body: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// An actuator names a body that is not there.
    #[error("actuator {actuator} names body {body}, but there are {bodies} bodies")]
    ActuatorBody {
        /// Index of the actuator.
        actuator: usize,
        /// Index it names.
        body: usize,
        /// Number of bodies.
        bodies: usize,
    },
}

/// One end of a joint: the body's first column (`None` for the ground) and the point on it.
#[derive(Debug, Clone, Copy)]
struct End {
    column: Option<usize>,
    point: Vec2,
}

/// A pair of rows from a joint, or the single row of an actuator.
#[derive(Debug, Clone, Copy)]
enum Item {
    Revolute([End; 2]),
    /// Normal of the first body in its own frame, and α2 − α1.
    Prismatic([End; 2], Vec2, f64),
    Actuator([Option<usize>; 2]),
}

/// The rows of a mechanism. Everything they need is copied, so they outlive it.
///
/// Slices given to the methods are `columns()` long for coordinates, `len()` long for rows, and
/// `len() × columns()` long, one row after the other, for the Jacobian.
#[derive(Debug, Clone)]
pub struct Rows {
    items: Vec<Item>,
    body_columns: Vec<Option<usize>>,
    columns: usize,
    rows: usize,
}

/// Where a point is, and its arm: the point is o + r, and moves by perp(r) per radian.
struct Placed {
    at: Vec2,
    arm: Vec2,
}

impl End {
    fn place(self, x: &[f64]) -> Placed {
        let arm = self.point.turn(direction(self.column, x));
        let origin = self.column.map_or(Vec2::ZERO, |c| vec2(x[c], x[c + 1]));
        Placed {
            at: origin + arm,
            arm,
        }
    }

    /// Velocity of the point, and the part of its acceleration that comes from ω² alone.
    fn speed(self, arm: Vec2, x_dot: &[f64]) -> (Vec2, Vec2) {
        self.column.map_or((Vec2::ZERO, Vec2::ZERO), |c| {
            let omega = x_dot[c + 2];
            (
                vec2(x_dot[c], x_dot[c + 1]) + arm.perp() * omega,
                -arm * (omega * omega),
            )
        })
    }
}

/// The direction (cos θ, sin θ) of a body's frame.
fn direction(column: Option<usize>, x: &[f64]) -> Vec2 {
    column.map_or(Vec2::IDENTITY, |c| Vec2::from_angle(x[c + 2]))
}

/// A body's angle, or its rate, out of coordinates or speeds.
fn turning(column: Option<usize>, x: &[f64]) -> f64 {
    column.map_or(0.0, |c| x[c + 2])
}

/// The angle less the nearest whole number of turns.
fn nearest_turn(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

impl Rows {
    /// The rows of `mechanism`, or which of its references is broken. The axes of prismatic
    /// joints are taken as the unit vectors they are documented to be.
    pub fn new(mechanism: &Mechanism) -> Result<Self, RowsError> {
        let bodies = mechanism.bodies.len();
        if mechanism.ground >= bodies {
            return Err(RowsError::NoGround {
                ground: mechanism.ground,
                bodies,
            });
        }
        let mut columns = 0;
        let body_columns: Vec<_> = (0..bodies)
            .map(|b| {
                (b != mechanism.ground).then(|| {
                    columns += 3;
                    columns - 3
                })
            })
            .collect();
        let absent = |pair: [BodyId; 2]| pair.into_iter().map(|b| b.0).find(|&b| b >= bodies);

        let mut items = Vec::with_capacity(mechanism.joints.len() + mechanism.actuators.len());
        for (j, joint) in mechanism.joints.iter().enumerate() {
            if let Some(body) = absent(joint.bodies) {
                return Err(RowsError::JointBody {
                    joint: j,
                    body,
                    bodies,
                });
            }
            let end = |i: usize| End {
                column: body_columns[joint.bodies[i].0],
                point: joint.points[i],
            };
            let ends = [end(0), end(1)];
            items.push(match joint.kind {
                JointKind::Revolute => Item::Revolute(ends),
                JointKind::Prismatic {
                    axes: [first, second],
                } => Item::Prismatic(ends, first.perp(), second.angle() - first.angle()),
                // The other kinds: to come.
                _ => Item::Revolute(ends),
            });
        }
        for (a, actuator) in mechanism.actuators.iter().enumerate() {
            if let Some(body) = absent(actuator.bodies) {
                return Err(RowsError::ActuatorBody {
                    actuator: a,
                    body,
                    bodies,
                });
            }
            items.push(Item::Actuator(actuator.bodies.map(|b| body_columns[b.0])));
        }
        Ok(Self {
            items,
            body_columns,
            columns,
            rows: 2 * mechanism.joints.len() + mechanism.actuators.len(),
        })
    }

    /// Number of coordinates: three per moving body.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows: two per joint, one per actuator.
    pub fn len(&self) -> usize {
        self.rows
    }

    /// Whether there are no rows at all.
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// The column of the body's x coordinate, followed by those of y and θ; `None` for the ground.
    pub fn column(&self, body: BodyId) -> Option<usize> {
        self.body_columns.get(body.0).copied().flatten()
    }

    /// Whether each row is an angle (rad) rather than a length (m).
    pub fn angular(&self) -> Vec<bool> {
        let kinds = |item: &Item| match item {
            Item::Revolute(_) => [Some(false), Some(false)],
            Item::Prismatic(..) => [Some(false), Some(true)],
            Item::Actuator(_) => [Some(true), None],
        };
        self.items.iter().flat_map(kinds).flatten().collect()
    }

    /// Φₖ(x) − vₖ into `out`, with the imposed values `imposed`; angles to the nearest turn.
    pub fn residual(&self, x: &[f64], imposed: &[f64], out: &mut [f64]) {
        let mut k = 0;
        for item in &self.items {
            match *item {
                Item::Revolute([first, second]) => {
                    let gap = second.place(x).at - first.place(x).at;
                    out[k] = gap.x - imposed[k];
                    out[k + 1] = gap.y - imposed[k + 1];
                    k += 2;
                }
                Item::Prismatic([first, second], normal, between) => {
                    let normal = normal.turn(direction(first.column, x));
                    let gap = second.place(x).at - first.place(x).at;
                    let angle = turning(second.column, x) - turning(first.column, x) + between;
                    out[k] = normal.dot(gap) - imposed[k];
                    out[k + 1] = nearest_turn(angle - imposed[k + 1]);
                    k += 2;
                }
                Item::Actuator([first, second]) => {
                    out[k] = nearest_turn(turning(second, x) - turning(first, x) - imposed[k]);
                    k += 1;
                }
            }
        }
    }

    /// ∂Φ/∂x into `out`, row after row.
    pub fn jacobian(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let width = self.columns;
        // Adds the row's derivative with one body's x, y and θ, if that body moves.
        let mut add = |row: usize, column: Option<usize>, [x, y, turn]: [f64; 3]| {
            if let Some(c) = column {
                let at = row * width + c;
                out[at] += x;
                out[at + 1] += y;
                out[at + 2] += turn;
            }
        };
        let mut k = 0;
        for item in &self.items {
            match *item {
                Item::Revolute(ends) => {
                    for (end, sign) in ends.into_iter().zip([-1.0, 1.0]) {
                        let swing = end.place(x).arm.perp() * sign;
                        add(k, end.column, [sign, 0.0, swing.x]);
                        add(k + 1, end.column, [0.0, sign, swing.y]);
                    }
                    k += 2;
                }
                Item::Prismatic([first, second], normal, _) => {
                    let n = normal.turn(direction(first.column, x));
                    let (one, two) = (first.place(x), second.place(x));
                    // n·perp(r) is the moment r × n. The first body's arm reaches to P2, not to
                    // P1, because its normal turns with it.
                    let reach = one.arm + (two.at - one.at);
                    add(k, first.column, [-n.x, -n.y, -reach.cross(n)]);
                    add(k, second.column, [n.x, n.y, two.arm.cross(n)]);
                    add(k + 1, first.column, [0.0, 0.0, -1.0]);
                    add(k + 1, second.column, [0.0, 0.0, 1.0]);
                    k += 2;
                }
                Item::Actuator([first, second]) => {
                    add(k, first, [0.0, 0.0, -1.0]);
                    add(k, second, [0.0, 0.0, 1.0]);
                    k += 1;
                }
            }
        }
    }

    /// The velocity-squared terms Φ̇ₓ ẋ into `out`, so that Φ̈ = J ẍ + Φ̇ₓ ẋ: the second derivative
    /// of Φ along x + s ẋ at s = 0.
    pub fn curvature(&self, x: &[f64], x_dot: &[f64], out: &mut [f64]) {
        let mut k = 0;
        for item in &self.items {
            match *item {
                Item::Revolute([first, second]) => {
                    let (_, pull1) = first.speed(first.place(x).arm, x_dot);
                    let (_, pull2) = second.speed(second.place(x).arm, x_dot);
                    out[k] = pull2.x - pull1.x;
                    out[k + 1] = pull2.y - pull1.y;
                    k += 2;
                }
                Item::Prismatic([first, second], normal, _) => {
                    // d²(n·d) = n̈·d + 2 ṅ·ḋ + n·d̈, with ṅ = ω1 perp(n) and n̈ = −ω1² n.
                    let n = normal.turn(direction(first.column, x));
                    let omega = turning(first.column, x_dot);
                    let (one, two) = (first.place(x), second.place(x));
                    let (speed1, pull1) = first.speed(one.arm, x_dot);
                    let (speed2, pull2) = second.speed(two.arm, x_dot);
                    out[k] = -omega * omega * n.dot(two.at - one.at)
                        + 2.0 * omega * n.perp().dot(speed2 - speed1)
                        + n.dot(pull2 - pull1);
                    out[k + 1] = 0.0;
                    k += 2;
                }
                Item::Actuator(_) => {
                    out[k] = 0.0;
                    k += 1;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{Actuator, Body, Joint};

    /// Ground, a bar on a revolute, a block sliding on the bar with offsets everywhere, and the
    /// block pinned to the ground from the other side, so that every kind of end occurs.
    fn swinging_block() -> Mechanism {
        let body = |name: &str| Body { name: name.into() };
        let joint = |name: &str, bodies: [usize; 2], points, kind| Joint {
            name: name.into(),
            bodies: bodies.map(BodyId),
            points,
            kind,
        };
        Mechanism {
            bodies: vec![body("bar"), body("ground"), body("block")],
            ground: 1,
            joints: vec![
                joint(
                    "A",
                    [1, 0],
                    [vec2(3.0, -2.0), vec2(0.4, 0.1)],
                    JointKind::Revolute,
                ),
                joint(
                    "slide",
                    [0, 2],
                    [vec2(-0.3, 0.7), vec2(0.2, 0.5)],
                    JointKind::Prismatic {
                        axes: [Vec2::from_angle(0.6), Vec2::from_angle(-2.9)],
                    },
                ),
                joint(
                    "B",
                    [2, 1],
                    [vec2(1.1, 0.0), vec2(5.0, 1.0)],
                    JointKind::Revolute,
                ),
            ],
            actuators: vec![Actuator {
                name: "phi".into(),
                bodies: [BodyId(0), BodyId(2)],
                drive: crate::mechanism::Drive::Angle,
            }],
            relations: vec![],
        }
    }

    const X: [f64; 6] = [2.5, -1.8, 0.3, 4.0, 1.5, -2.6];
    const X_DOT: [f64; 6] = [0.7, -0.4, 1.3, -0.2, 0.9, -0.8];

    fn residual_along(rows: &Rows, s: f64) -> Vec<f64> {
        let x: Vec<f64> = X.iter().zip(X_DOT).map(|(x, v)| x + s * v).collect();
        let mut out = vec![0.0; rows.len()];
        rows.residual(&x, &vec![0.0; rows.len()], &mut out);
        out
    }

    #[test]
    fn the_jacobian_is_the_derivative_of_the_residual() {
        let rows = Rows::new(&swinging_block()).unwrap();
        assert_eq!((rows.len(), rows.columns()), (7, 6));
        let mut jacobian = vec![0.0; 7 * 6];
        rows.jacobian(&X, &mut jacobian);
        let h = 1e-5;
        for c in 0..6 {
            let at = |s: f64| {
                let mut x = X;
                x[c] += s;
                let mut out = vec![0.0; 7];
                rows.residual(&x, &[0.0; 7], &mut out);
                out
            };
            let (plus, minus) = (at(h), at(-h));
            for k in 0..7 {
                let slope = (plus[k] - minus[k]) / (2.0 * h);
                let error = (jacobian[k * 6 + c] - slope).abs();
                assert!(error < 1e-9, "row {k}, column {c}: {error:e}");
            }
        }
    }

    #[test]
    fn the_curvature_is_the_second_derivative_along_a_straight_line() {
        let rows = Rows::new(&swinging_block()).unwrap();
        let mut curvature = vec![0.0; 7];
        rows.curvature(&X, &X_DOT, &mut curvature);
        let h = 1e-3;
        let (plus, here, minus) = (
            residual_along(&rows, h),
            residual_along(&rows, 0.0),
            residual_along(&rows, -h),
        );
        for k in 0..7 {
            let second = (plus[k] - 2.0 * here[k] + minus[k]) / (h * h);
            let error = (curvature[k] - second).abs();
            assert!(error < 1e-5, "row {k}: {error:e}");
        }
    }

    /// A block on the slope of a fixed guide: the normal row's multiplier pushes the block along
    /// the guide's axis turned +90°, and the ground pushes back on nothing.
    #[test]
    fn the_multiplier_is_the_action_of_the_first_body_on_the_second() {
        let slope = Vec2::from_angle(0.5);
        let body = |name: &str| Body { name: name.into() };
        let mechanism = Mechanism {
            bodies: vec![body("ground"), body("block")],
            ground: 0,
            joints: vec![Joint {
                name: "slide".into(),
                bodies: [BodyId(0), BodyId(1)],
                points: [Vec2::ZERO, vec2(0.0, 0.25)],
                kind: JointKind::Prismatic {
                    axes: [slope, vec2(1.0, 0.0)],
                },
            }],
            actuators: vec![],
            relations: vec![],
        };
        let rows = Rows::new(&mechanism).unwrap();
        let mut jacobian = vec![0.0; 6];
        rows.jacobian(&[1.0, 2.0, 0.5], &mut jacobian);
        let n = slope.perp();
        // The force acts at the block's point, whose arm lies along the normal: no moment.
        for (got, want) in jacobian.iter().zip([n.x, n.y, 0.0, 0.0, 0.0, 1.0]) {
            assert!((got - want).abs() < 1e-15);
        }
        assert_eq!(rows.angular(), [false, true]);
    }

    #[test]
    fn angles_are_taken_to_the_nearest_turn_of_the_imposed_value() {
        let rows = Rows::new(&swinging_block()).unwrap();
        let (mut near, mut far) = (vec![0.0; 7], vec![0.0; 7]);
        let mut x = X;
        rows.residual(&x, &[0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.3], &mut near);
        x[2] += 3.0 * TAU;
        rows.residual(
            &x,
            &[0.0, 0.0, 0.0, 0.01 - TAU, 0.0, 0.0, 0.3 + TAU],
            &mut far,
        );
        for (a, b) in near.iter().zip(&far) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn broken_references_are_named() {
        let mut mechanism = swinging_block();
        mechanism.joints[1].bodies[1] = BodyId(9);
        let error = Rows::new(&mechanism).unwrap_err();
        assert_eq!(
            error.to_string(),
            "joint 1 names body 9, but there are 3 bodies"
        );
        let mut mechanism = swinging_block();
        mechanism.ground = 3;
        assert!(matches!(
            Rows::new(&mechanism),
            Err(RowsError::NoGround { .. })
        ));
        let mut mechanism = swinging_block();
        mechanism.actuators[0].bodies[0] = BodyId(7);
        assert!(matches!(
            Rows::new(&mechanism),
            Err(RowsError::ActuatorBody { actuator: 0, .. })
        ));
    }
}
