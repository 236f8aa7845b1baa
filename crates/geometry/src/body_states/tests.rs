use super::*;
use crate::mechanism::{Actuator, Body, Joint, JointKind};
use crate::plan::AssemblyConfiguration;
use dwell_numerics::Dual;

const CRANK: BodyId = BodyId(1);
const ROCKER: BodyId = BodyId(2);
const BLOCK: BodyId = BodyId(3);

/// A crank whose pin drives a slotted rocker by a block, standing at `place`.
fn slotted_rocker(place: Vec2) -> Mechanism {
    let along = vec2(0.8, 0.6);
    Mechanism {
        bodies: ["ground", "crank", "rocker", "block"]
            .map(Body::named)
            .into(),
        ground: 0,
        joints: vec![
            Joint::revolute("A", [0, 1], [place, vec2(0.3, 0.1)]),
            Joint::revolute("B", [1, 3], [vec2(0.4, 0.1), Vec2::ZERO]),
            Joint::revolute("D", [0, 2], [place + vec2(-0.25, 0.05), vec2(0.2, 0.0)]),
            Joint::new(
                "slot",
                [2, 3],
                [vec2(0.2, 0.02), Vec2::ZERO],
                JointKind::Prismatic {
                    axes: [along, vec2(0.0, 1.0)],
                },
            ),
        ],
        actuators: vec![Actuator::angle("q", [0, 1])],
        couplings: Vec::new(),
    }
}

fn plan(mechanism: &Mechanism) -> Plan {
    let configuration = AssemblyConfiguration {
        q: vec![0.3],
        initial_guess: vec![None, None, Some(-0.6), None],
        ..AssemblyConfiguration::default()
    };
    Plan::compile(mechanism, &configuration).unwrap()
}

/// The states at q, q̇ = `speed`, q̈ = 0, in any kind of number.
fn states<T: Scalar>(plan: &Plan, q: T, speed: f64) -> BodyStates<T> {
    let (mut pose, mut motion) = (plan.pose(), plan.motion());
    plan.positions(&[q], &mut pose).unwrap();
    plan.velocities(&pose, &[T::from_f64(speed)], &mut motion);
    plan.accelerations(&pose, &[T::from_f64(0.0)], &mut motion);
    let mut states = BodyStates::new(plan);
    states.fill(plan, &pose, &motion);
    states
}

fn coordinates() -> [Coordinate; 5] {
    let length = |bodies, points| Coordinate::Length { bodies, points };
    [
        Coordinate::Angle([BodyId(0), ROCKER]),
        Coordinate::Angle([CRANK, BLOCK]),
        Coordinate::Travel(JointId(3)),
        length([CRANK, ROCKER], [vec2(0.5, 0.3), vec2(-0.1, 0.7)]),
        length([BLOCK, BodyId(0)], [vec2(0.1, 0.2), vec2(0.9, -1.0)]),
    ]
}

/// At unit speed d/dt is d/dq: each of the three is the exact derivative of the one before.
#[test]
fn speeds_and_accelerations_are_derivatives() {
    let mechanism = slotted_rocker(Vec2::ZERO);
    let plan = plan(&mechanism);
    for k in 0..20 {
        let states = states(&plan, Dual::variable(0.3 * f64::from(k)), 1.0);
        let known = coordinates().map(|c| CoordinateFunction::find(&mechanism, c));
        // Between points that no joint holds on the axis, too.
        let free = CoordinateFunction::Travel(Guide {
            bodies: [CRANK, ROCKER],
            points: [vec2(0.5, 0.3), vec2(-0.1, 0.7)],
            axis: vec2(0.6, -0.8),
        });
        for function in known.into_iter().flatten().chain([free]) {
            let [value, speed, acceleration] = states.coordinate(function);
            // Values below 3, accelerations below 10: some roundings.
            assert!((value.d - speed.v).abs() < 1e-14, "{function:?}");
            assert!((speed.d - acceleration.v).abs() < 1e-13, "{function:?}");
        }
        for body in 0..4 {
            let point = states.point(BodyId(body), vec2(0.3, -0.7));
            let pairs = [
                (point.position.x.d, point.velocity.x.v),
                (point.position.y.d, point.velocity.y.v),
                (point.velocity.x.d, point.acceleration.x.v),
                (point.velocity.y.d, point.acceleration.y.v),
            ];
            assert!(
                pairs.iter().all(|(d, v)| (d - v).abs() < 1e-13),
                "{pairs:?}"
            );
        }
    }
}

/// The joints' points coincide, the crank's angle is q, the travel is a distance in the slot.
#[test]
fn values_are_those_of_the_mechanism() {
    let mechanism = slotted_rocker(Vec2::ZERO);
    let plan = plan(&mechanism);
    for k in 0..20 {
        let q = -3.0 + 0.3 * f64::from(k);
        let states = states(&plan, q, 2.0);
        assert!((states.angle([BodyId(0), CRANK])[0] - q).abs() < 1e-15);
        assert_eq!(states.angle([BodyId(0), CRANK])[1], 2.0);
        for joint in &mechanism.joints[..3] {
            let gap = states.separation(joint.bodies, joint.points);
            assert!(gap.length < 1e-15);
            assert!(gap.velocity.norm() < 1e-14 && gap.acceleration.norm() < 1e-13);
        }
        let slot = &mechanism.joints[3];
        let travel = Coordinate::Travel(JointId(3));
        let function = CoordinateFunction::find(&mechanism, travel).unwrap();
        let [length, _, _] = states.coordinate(CoordinateFunction::Length {
            bodies: slot.bodies,
            points: slot.points,
        });
        assert!((states.coordinate(function)[0] - length).abs() < 1e-15);
    }
}

/// The same mechanism elsewhere has the same measures, to the last digits of where it stands.
#[test]
fn measures_do_not_depend_on_the_place() {
    let here = slotted_rocker(Vec2::ZERO);
    let place = vec2(8192.0, -4096.0);
    let there = slotted_rocker(place);
    let [one, two] = [&here, &there].map(|m| states(&plan(m), 0.7, 1.3));
    assert_eq!(two.origin() - one.origin(), place);
    for coordinate in &coordinates()[..4] {
        let [a, b] = [(&one, &here), (&two, &there)].map(|(s, m)| -> [f64; 3] {
            s.coordinate(CoordinateFunction::find(m, *coordinate).unwrap())
        });
        // Only the pivots' own coordinates were rounded, at 1e-12 m.
        let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        assert!(differences.fold(0.0, f64::max) < 1e-11, "{a:?} {b:?}");
    }
}

/// |v t + a t²/2|: what parts leaves with its speed, whatever the direction.
#[test]
fn points_that_coincide_part_with_their_speed() {
    let mechanism = slotted_rocker(Vec2::ZERO);
    let plan = plan(&mechanism);
    let states = states(&plan, 0.0, -3.0);
    // A circle of 0.1 m, from its rightmost point.
    let bodies = [BodyId(0), CRANK];
    let points = [vec2(0.1, 0.0), vec2(0.4, 0.1)];
    assert_eq!(states.separation(bodies, points).direction, None);
    let [length, speed, acceleration]: [f64; 3] =
        states.coordinate(CoordinateFunction::Length { bodies, points });
    assert!(length < 1e-16);
    assert!((speed - 0.3).abs() < 1e-15);
    // Along the path, which is not speeding up.
    assert!(acceleration.abs() < 1e-14);
}

#[test]
fn what_is_not_there_is_not_measured() {
    let mechanism = slotted_rocker(Vec2::ZERO);
    let missing = [
        Coordinate::Angle([BodyId(0), BodyId(4)]),
        Coordinate::Travel(JointId(0)),
        Coordinate::Travel(JointId(9)),
    ];
    for coordinate in missing {
        assert_eq!(CoordinateFunction::find(&mechanism, coordinate), None);
    }
}
