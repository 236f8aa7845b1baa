//! Rows that feel whole turns.

use super::*;

/// Ground with a fixed sun (first body), an arm and a planet on it: three radii, four columns.
pub(super) fn epicyclic(arm_drives: bool) -> Mechanism {
    let origin = vec2(0.2, -0.1);
    let mut joints = vec![
        Joint::new("O", [0, 1], [origin, vec2(0.1, 0.0)], JointKind::Revolute),
        Joint::new(
            "P",
            [1, 2],
            [vec2(1.2, 0.0), vec2(0.0, 0.3)],
            JointKind::Revolute,
        ),
        Joint::new(
            "teeth",
            [0, 2],
            [origin, vec2(0.0, 0.3)],
            JointKind::Gear {
                radii: [0.7, 0.4],
                internal: false,
            },
        ),
    ];
    if !arm_drives {
        // The same distance kept without a body.
        joints[0].kind = JointKind::Distance { length: 1.1 };
        joints[0].bodies[1] = BodyId(2);
        joints[0].points[1] = vec2(0.0, 0.3);
    }
    Mechanism {
        bodies: ["ground", "arm", "planet"].map(Body::named).into(),
        ground: 0,
        joints,
        actuators: vec![Actuator::angle("q", [0, 1])],
        couplings: vec![],
    }
}

/// Body coordinates of arm and planet when the arm is at `q` and the planet at `angle`.
fn planet_at(q: f64, angle: f64) -> [f64; 6] {
    let arm = Vec2::from_angle(q);
    let o = vec2(0.2, -0.1) - arm * 0.1;
    let centre = o + arm * 1.2;
    let planet = centre - vec2(0.0, 0.3).rotate(Vec2::from_angle(angle));
    [o.x, o.y, q, planet.x, planet.y, angle]
}

/// A planet on a fixed sun turns 1 + r1/r2 = 2.75 times as fast as its arm, for any number of
/// turns, from whatever angle it was put in at.
#[test]
fn a_planet_is_counted_with_its_arm() {
    let mut rows = ConstraintRows::new(&epicyclic(true)).unwrap();
    assert!(rows.counts_revolutions());
    let (q0, planet0) = (2.9, 0.6);
    rows.mesh(&planet_at(q0, planet0));
    for turned in [0.0, 0.4, 3.0, TAU, -40.0] {
        let x = planet_at(q0 + turned, planet0 + 2.75 * turned);
        let open = residual(&rows, &x, &[0.0, 0.0, 0.0, 0.0, 0.0, q0 + turned]);
        // Angles of 100 rad are rounded at 1e-14.
        assert!(open.iter().all(|r| r.abs() < 1e-13), "{turned}: {open:?}");
    }
    // The arm back where it was, a turn later; the planet did not follow: 2π (r1 + r2) are missing.
    let x = planet_at(q0 + TAU, planet0);
    let open = residual(&rows, &x, &[0.0, 0.0, 0.0, 0.0, 0.0, q0]);
    assert!((open[4] + TAU * 1.1).abs() < 1e-13 && (open[5] - TAU).abs() < 1e-13);
    // An imposed value is an opening of the teeth, in metres along the pitch circle.
    let x = planet_at(q0, planet0 + 0.03 / 0.4);
    let open = residual(&rows, &x, &[0.0, 0.0, 0.0, 0.0, 0.03, q0]);
    assert!(open[4].abs() < 1e-15);
}

/// Without a body that holds both centres, the planet determines the revolutions of the line of centres.
#[test]
fn without_an_arm_the_teeth_are_taken_to_the_nearest_turn() {
    let mut rows = ConstraintRows::new(&epicyclic(false)).unwrap();
    rows.mesh(&planet_at(2.9, 0.6));
    let teeth = 3;
    for turned in [0.4, 3.0, TAU, -40.0] {
        let x = planet_at(2.9 + turned, 0.6 + 2.75 * turned);
        let open = residual(&rows, &x, &vec![0.0; rows.len()]);
        assert!(open[teeth].abs() < 1e-13, "{turned}: {open:?}");
    }
}

/// A gear that turns the other by the ratio of the radii, the sense by the kind of pair.
#[test]
fn a_fixed_pair_keeps_its_ratio() {
    for (internal, ratio) in [(false, -1.75), (true, 1.75)] {
        let mechanism = Mechanism {
            bodies: ["one", "two", "ground"].map(Body::named).into(),
            ground: 2,
            joints: vec![Joint::new(
                "teeth",
                [0, 1],
                [Vec2::ZERO; 2],
                JointKind::Gear {
                    radii: [0.7, 0.4],
                    internal,
                },
            )],
            ..Mechanism::default()
        };
        let mut rows = ConstraintRows::new(&mechanism).unwrap();
        let at = |turned: f64| [0.0, 0.0, 0.2 + turned, -1.0, 1e-3, 5.0 + ratio * turned];
        rows.mesh(&at(0.0));
        for turned in [0.1, -2.0, 30.0] {
            let open = residual(&rows, &at(turned), &[0.0]);
            assert!(open[0].abs() < 1e-13, "{internal}, {turned}: {open:?}");
        }
    }
}

#[test]
fn a_drive_is_counted_only_where_turns_are_felt() {
    let counted = |kind| {
        let mut mechanism = swinging_block();
        mechanism
            .joints
            .push(Joint::new("more", [1, 0], [Vec2::ZERO; 2], kind));
        ConstraintRows::new(&mechanism)
            .unwrap()
            .counts_revolutions()
    };
    let axis = vec2(1.0, 0.0);
    assert!(!counted(JointKind::Weld { angle: 0.0 }));
    assert!(!counted(JointKind::Slot { axis }));
    assert!(!counted(JointKind::Distance { length: 1.0 }));
    assert!(counted(JointKind::Rack { axis, radius: 1.0 }));
    assert!(counted(JointKind::Rolling { axis, radius: 1.0 }));
}
