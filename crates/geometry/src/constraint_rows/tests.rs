mod counting;

use super::*;
use crate::mechanism::{
    Actuator, ActuatorKind, Body, Coordinate, Coupling, Joint, JointId, JointKind,
};
use crate::plane::{Vec2, vec2};
use dwell_laws::Law;
use std::f64::consts::TAU;

/// Ground, a bar on a revolute, a block sliding on the bar with offsets everywhere, and the
/// block pinned to the ground from the other side, so that every kind of end occurs.
fn swinging_block() -> Mechanism {
    Mechanism {
        bodies: ["bar", "ground", "block"].map(Body::named).into(),
        ground: 1,
        joints: vec![
            Joint::revolute("A", [1, 0], [vec2(3.0, -2.0), vec2(0.4, 0.1)]),
            Joint::prismatic(
                "slide",
                [0, 2],
                [vec2(-0.3, 0.7), vec2(0.2, 0.5)],
                [0.6, -2.9],
            ),
            Joint::revolute("B", [2, 1], [vec2(1.1, 0.0), vec2(5.0, 1.0)]),
        ],
        actuators: vec![Actuator::angle("phi", [0, 2])],
        couplings: vec![],
    }
}

const X: [f64; 6] = [2.5, -1.8, 0.3, 4.0, 1.5, -2.6];
const X_DOT: [f64; 6] = [0.7, -0.4, 1.3, -0.2, 0.9, -0.8];

fn residual_along(rows: &ConstraintRows, s: f64) -> Vec<f64> {
    let x: Vec<f64> = X.iter().zip(X_DOT).map(|(x, v)| x + s * v).collect();
    let mut out = vec![0.0; rows.len()];
    rows.residual(&x, &vec![0.0; rows.len()], &mut out);
    out
}

#[test]
fn the_jacobian_is_the_derivative_of_the_residual() {
    let rows = ConstraintRows::new(&swinging_block()).unwrap();
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
    let rows = ConstraintRows::new(&swinging_block()).unwrap();
    let mut curvature = vec![0.0; 7];
    rows.velocity_product(&X, &X_DOT, &mut curvature);
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
    let mechanism = Mechanism {
        bodies: ["ground", "block"].map(Body::named).into(),
        ground: 0,
        joints: vec![Joint::prismatic(
            "slide",
            [0, 1],
            [Vec2::ZERO, vec2(0.0, 0.25)],
            [0.5, 0.0],
        )],
        actuators: vec![],
        couplings: vec![],
    };
    let rows = ConstraintRows::new(&mechanism).unwrap();
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
    let rows = ConstraintRows::new(&swinging_block()).unwrap();
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
    let error = ConstraintRows::new(&mechanism).unwrap_err();
    assert_eq!(
        error.to_string(),
        "joint 1 names body 9, but there are 3 bodies"
    );
    let mut mechanism = swinging_block();
    mechanism.ground = 3;
    assert!(matches!(
        ConstraintRows::new(&mechanism),
        Err(ConstraintRowsError::NoGround { .. })
    ));
    let mut mechanism = swinging_block();
    mechanism.actuators[0].bodies[0] = BodyId(7);
    assert!(matches!(
        ConstraintRows::new(&mechanism),
        Err(ConstraintRowsError::NoBody {
            what: "actuator",
            index: 0,
            ..
        })
    ));
}

/// One joint of every kind and one actuator of every drive, with offsets everywhere, the ground as
/// the first body, the second and neither. The mechanism cannot close, but its rows can be evaluated.
fn everything() -> Mechanism {
    let (p, q) = (vec2(0.3, -0.2), vec2(-0.5, 0.7));
    let axis = Vec2::from_angle(0.8);
    let length = |bodies: [usize; 2]| Coordinate::Length {
        bodies: bodies.map(BodyId),
        points: [vec2(0.1, 0.6), vec2(-0.4, 0.2)],
    };
    let law = |coefficients: &[f64]| {
        Law::Polynomial(dwell_laws::Polynomial {
            coefficients: coefficients.to_vec(),
        })
    };
    let angle = |bodies: [usize; 2]| Coordinate::Angle(bodies.map(BodyId));
    let actuator = |bodies: [usize; 2], kind| Actuator::new("q", bodies, kind);
    let gear = |internal| JointKind::Gear {
        radii: [0.7, 0.4],
        internal,
    };
    let axes = [axis, Vec2::from_angle(-1.3)];
    let radius = -0.35;
    let mut joints = vec![];
    for on in [[0, 1], [2, 0], [1, 2], [3, 4]] {
        let kinds = [
            JointKind::Revolute,
            JointKind::Prismatic { axes },
            JointKind::Slot { axis },
            JointKind::Weld { angle: 0.4 },
            gear(false),
            gear(true),
            JointKind::Rack { axis, radius },
            JointKind::Rolling { axis, radius },
            JointKind::Distance { length: 0.9 },
            JointKind::Coupling(0),
            JointKind::Coupling(1),
            JointKind::Coupling(2),
        ];
        joints.extend(kinds.map(|kind| Joint::new("joint", on, [p, q], kind)));
    }
    Mechanism {
        bodies: ["ground", "a", "b", "c", "d"].map(Body::named).into(),
        ground: 0,
        joints,
        actuators: vec![
            actuator([1, 3], ActuatorKind::Angle),
            actuator([2, 1], ActuatorKind::Travel(JointId(14))),
            actuator([1, 0], ActuatorKind::Travel(JointId(1))),
            actuator([4, 2], ActuatorKind::Length([p, q])),
        ],
        couplings: vec![
            // Four bodies in one row, three of each other's kind.
            Coupling {
                dependent: length([1, 2]),
                independent: angle([3, 4]),
                law: law(&[0.2, 0.7, -0.3, 0.1]),
            },
            Coupling {
                dependent: angle([2, 0]),
                independent: Coordinate::Travel(JointId(13)),
                law: law(&[0.1, -0.4, 0.6]),
            },
            Coupling {
                dependent: Coordinate::Travel(JointId(26)),
                independent: length([2, 4]),
                law: law(&[0.0, 1.0, 0.0, -0.5]),
            },
        ],
    }
}

const AT: [f64; 12] = [
    0.9, 0.4, 0.3, -0.6, 1.1, 2.0, 0.2, -0.8, -1.1, 1.5, 0.5, 4.0,
];
const MOVING: [f64; 12] = [
    0.7, -0.4, 1.3, -0.2, 0.9, -0.8, 0.5, 0.3, 0.6, -0.9, 0.2, -1.1,
];

fn residual(rows: &ConstraintRows, x: &[f64], prescribed: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; rows.len()];
    rows.residual(x, prescribed, &mut out);
    out
}

fn jacobian(rows: &ConstraintRows, x: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; rows.len() * rows.columns()];
    rows.jacobian(x, &mut out);
    out
}

/// The residuals at `x` + s `along`, with values imposed so that none is near a wrap at `x`.
fn along<'a>(
    rows: &'a ConstraintRows,
    x: &'a [f64],
    v: &'a [f64],
) -> impl Fn(f64) -> Vec<f64> + 'a {
    let here = residual(rows, x, &vec![0.0; rows.len()]);
    move |s| {
        let x: Vec<f64> = x.iter().zip(v).map(|(x, v)| x + s * v).collect();
        residual(rows, &x, &here)
    }
}

#[test]
fn every_kind_has_its_derivatives() {
    let mechanism = everything();
    let mut rows = ConstraintRows::new(&mechanism).unwrap();
    assert_eq!(rows.len(), mechanism.reactions().len() + 4);
    rows.mesh(&AT);
    let exact = jacobian(&rows, &AT);
    for c in 0..rows.columns() {
        let mut unit = [0.0; 12];
        unit[c] = 1.0;
        let f = along(&rows, &AT, &unit);
        // Fourth order: the error is h⁴/30 of a fifth derivative of order 100, and rounding over h.
        let h = 1e-3;
        let (f2, f1, b1, b2) = (f(2.0 * h), f(h), f(-h), f(-2.0 * h));
        for k in 0..rows.len() {
            let slope = (8.0 * (f1[k] - b1[k]) - (f2[k] - b2[k])) / (12.0 * h);
            let error = (exact[k * rows.columns() + c] - slope).abs();
            assert!(error < 1e-10, "row {k}, column {c}: {error:e}");
        }
    }
    let mut curvature = vec![0.0; rows.len()];
    rows.velocity_product(&AT, &MOVING, &mut curvature);
    let f = along(&rows, &AT, &MOVING);
    // As above, with rounding over h².
    let h = 2e-3;
    let (f2, f1, f0, b1, b2) = (f(2.0 * h), f(h), f(0.0), f(-h), f(-2.0 * h));
    for k in 0..rows.len() {
        let bend = (16.0 * (f1[k] + b1[k]) - (f2[k] + b2[k]) - 30.0 * f0[k]) / (12.0 * h * h);
        let error = (curvature[k] - bend).abs();
        assert!(error < 1e-8, "row {k}: {error:e}");
    }
}

/// Every row's unit multiplier as forces at points and couples, told from the words of
/// `Component`, has the row's derivatives as its generalised forces.
#[test]
fn a_multiplier_acts_where_its_component_says() {
    let axis = Vec2::from_angle(0.8);
    // Frames and points such that the geometry of each joint is met: the first body at an angle of
    // 0.3, the second's point 0.5 to the left of the first's axis line, 0.2 ahead.
    let (p, q) = (vec2(0.3, -0.2), vec2(-0.5, 0.7));
    let [theta1, theta2] = [0.3, -1.2];
    let o1 = vec2(0.4, 0.9);
    let t = axis.rotate(Vec2::from_angle(theta1));
    let n = t.perp();
    let p1 = o1 + p.rotate(Vec2::from_angle(theta1));
    let check = |kind: JointKind, p2: Vec2, row: usize, force: Vec2, at: Vec2, couple: f64| {
        let o2 = p2 - q.rotate(Vec2::from_angle(theta2));
        let mechanism = Mechanism {
            bodies: ["a", "ground", "b"].map(Body::named).into(),
            ground: 1,
            joints: vec![Joint::new("joint", [0, 2], [p, q], kind)],
            ..Mechanism::default()
        };
        let rows = ConstraintRows::new(&mechanism).unwrap();
        let all = jacobian(&rows, &[o1.x, o1.y, theta1, o2.x, o2.y, theta2]);
        let want = [
            -force.x,
            -force.y,
            -(at - o1).cross(force) - couple,
            force.x,
            force.y,
            (at - o2).cross(force) + couple,
        ];
        for (got, want) in all[row * 6..row * 6 + 6].iter().zip(want) {
            // Rounding of sums of order one.
            assert!((got - want).abs() < 1e-14, "{kind:?}, {row}: {got} {want}");
        }
    };
    let beside = p1 + t * 0.2 + n * 0.5;
    let zero = Vec2::ZERO;
    for (kind, rows) in [
        (JointKind::Revolute, 2),
        (JointKind::Weld { angle: 0.1 }, 3),
    ] {
        check(kind, p1, 0, vec2(1.0, 0.0), p1, 0.0);
        check(kind, p1, 1, vec2(0.0, 1.0), p1, 0.0);
        if rows == 3 {
            check(kind, p1, 2, zero, p1, 1.0);
        }
    }
    let prismatic = JointKind::Prismatic { axes: [axis, axis] };
    let ahead = p1 + t * 0.7;
    check(prismatic, ahead, 0, n, ahead, 0.0);
    check(prismatic, ahead, 1, zero, ahead, 1.0);
    check(JointKind::Slot { axis }, ahead, 0, n, ahead, 0.0);
    // The pinion and the disc touch the line through P1, whichever side they are on.
    for radius in [0.5, -0.5] {
        let (centre, touch) = (p1 + t * 0.2 + n * radius, p1 + t * 0.2);
        check(JointKind::Rack { axis, radius }, centre, 0, t, touch, 0.0);
        let rolling = JointKind::Rolling { axis, radius };
        check(rolling, centre, 0, n, touch, 0.0);
        check(rolling, centre, 1, t, touch, 0.0);
    }
    let line = (beside - p1) * (1.0 / (beside - p1).norm());
    check(
        JointKind::Distance { length: 1.0 },
        beside,
        0,
        line,
        p1,
        0.0,
    );
    check(
        JointKind::Distance { length: 1.0 },
        beside,
        0,
        line,
        beside,
        0.0,
    );
    // Centres at the distance that the radii make; the pitch point; and the direction in which a
    // force there turns the second gear counter-clockwise, with a moment of its radius.
    for (radii, internal) in [([0.7, 0.4], false), ([0.7, 0.4], true), ([0.4, 0.7], true)] {
        let [r1, r2]: [f64; 2] = radii;
        let distance = if internal { (r1 - r2).abs() } else { r1 + r2 };
        let centre = p1 + line * distance;
        let pitch = if internal && r2 > r1 {
            p1 - line * r1
        } else {
            p1 + line * r1
        };
        assert!(((pitch - centre).norm() - r2).abs() < 1e-15);
        let force = ((pitch - centre) * (1.0 / r2)).perp();
        let gear = JointKind::Gear { radii, internal };
        check(gear, centre, 0, force, pitch, 0.0);
    }
}

#[test]
fn broken_relations_and_travels_are_named() {
    let mut mechanism = everything();
    mechanism.joints[9].kind = JointKind::Coupling(7);
    let error = ConstraintRows::new(&mechanism).unwrap_err();
    assert_eq!(
        error.to_string(),
        "joint 9 names coupling 7, but there are 3 couplings"
    );
    let mut mechanism = everything();
    mechanism.couplings[1].dependent = Coordinate::Angle([BodyId(0), BodyId(8)]);
    assert!(matches!(
        ConstraintRows::new(&mechanism),
        Err(ConstraintRowsError::NoBody {
            what: "coupling",
            index: 1,
            body: 8,
            ..
        })
    ));
    for joint in [0, 400] {
        let mut mechanism = everything();
        mechanism.actuators[1].kind = ActuatorKind::Travel(JointId(joint));
        assert_eq!(
            ConstraintRows::new(&mechanism).unwrap_err(),
            ConstraintRowsError::NoTravel { joint }
        );
    }
    // A gear looks through all joints for the body that holds its centres.
    let mut mechanism = counting::epicyclic(true);
    mechanism.joints[1].bodies[0] = BodyId(9);
    mechanism.joints.rotate_left(2);
    assert!(matches!(
        ConstraintRows::new(&mechanism),
        Err(ConstraintRowsError::NoBody {
            what: "joint",
            index: 2,
            ..
        })
    ));
}
