//! Every kind of joint and drive, judged by the dense rows: poses, motion, reactions and actions.

use dwell_geometry::{BodyId, Coordinate, Coupling, JointKind, Mechanism, Vec2, vec2};
use dwell_kinetostatics::{Mass, Model};
use dwell_laws::{Law, Polynomial};
use dwell_tests::changes::Setup;
use dwell_tests::sketch::{FourBar, Sketch};
use dwell_validation::claimed_motion;
use dwell_verify::{AssembledMechanism, CheckedMechanism, ClaimedState, check_states};

const GROUND: BodyId = Sketch::GROUND;

fn bar(mass: f64, length: f64) -> Mass {
    Mass {
        mass,
        center: vec2(0.47 * length, 0.03 * length),
        inertia: mass * length * length / 12.0,
    }
}

fn block(mass: f64) -> Mass {
    Mass {
        mass,
        center: vec2(0.02, -0.01),
        inertia: 0.1 * mass,
    }
}

/// Judges the mechanism at some steps away from its start. Each step is in rad or m.
fn check(setup: &Setup, steps: &[f64]) {
    let Setup {
        mechanism,
        masses,
        assembly: start,
        ..
    } = setup;
    let model = Model::new(mechanism, masses, start, &mechanism.reactions());
    let model = model.unwrap_or_else(|error| panic!("{error}"));
    let states: Vec<ClaimedState> = steps
        .iter()
        .map(|step| {
            let each = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
                (0..start.q.len()).map(|i| of(i as f64)).collect()
            };
            let offsets = each(&|i| step * (1.0 - 0.3 * i));
            let q = start
                .q
                .iter()
                .zip(offsets)
                .map(|(q, offset)| q + offset)
                .collect();
            let rates = [each(&|i| 1.3 - 0.8 * i), each(&|i| -0.7 + 1.1 * i)];
            state(&model, mechanism, q, rates)
        })
        .collect();
    let rest = || vec![0.0; start.q.len()];
    let home = state(&model, mechanism, start.q.clone(), [rest(), rest()]);
    let assembled = AssembledMechanism {
        mechanism: CheckedMechanism::Plane(mechanism, masses.into()),
        q: &start.q,
        poses: &home.poses,
    };
    for finding in check_states(&assembled, &states, 0) {
        assert!(finding.pass, "{finding:?}");
    }
}

/// What the model claims of a state of motion.
fn state(model: &Model, mechanism: &Mechanism, q: Vec<f64>, rates: [Vec<f64>; 2]) -> ClaimedState {
    let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
    let [q_dot, q_ddot] = rates;
    let state = model.kinetostatics(0.0, &q, &q_dot, &q_ddot, &mut workspace, &mut result);
    let state = state.unwrap_or_else(|error| panic!("{q:?}: {error}"));
    let bodies = model.plan().body_frames(mechanism, state.pose());
    let motion = claimed_motion(&bodies, state.bodies());
    ClaimedState {
        q,
        q_dot,
        q_ddot,
        reactions: result.reactions,
        tau: result.tau,
        ..motion
    }
}

const REVOLUTION_STEPS: [f64; 6] = [0.0, 0.7, 2.1, 3.9, -4.4, 9.0];
const LIMITED_STEPS: [f64; 5] = [0.0, 0.15, -0.2, 0.31, -0.4];

#[test]
fn a_slot_with_its_pin_on_either_body() {
    let mut s = Sketch::new();
    let crank = s.mass("crank", bar(1.0, 0.2), None);
    let rocker = s.mass("rocker", bar(2.0, 0.9), Some(1.5));
    s.revolute("A", (GROUND, [0.0, 0.4]), (crank, [0.0, 0.0]));
    s.revolute("O", (GROUND, [0.0, 0.0]), (rocker, [0.1, 0.0]));
    let slot = JointKind::Slot {
        axis: vec2(1.0, 0.0),
    };
    s.joint("k", (rocker, [0.0, 0.05]), (crank, [0.2, 0.0]), slot);
    s.actuate("phi", [GROUND, crank]);
    check(&s.setup(&[0.3]), &REVOLUTION_STEPS);
}

#[test]
fn a_coupler_welded_of_two_parts() {
    let mut s = Sketch::new();
    let crank = s.mass("crank", bar(1.0, 1.0), None);
    let part = s.mass("part", bar(2.0, 2.0), Some(0.6));
    let tip = s.mass("tip", bar(0.5, 1.5), None);
    let rocker = s.mass("rocker", bar(1.5, 3.0), None);
    s.revolute("A", (GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    s.revolute("B", (crank, [1.0, 0.0]), (part, [0.0, 0.0]));
    s.joint(
        "w",
        (tip, [0.0, 0.1]),
        (part, [2.0, 0.0]),
        JointKind::Weld { angle: 0.4 },
    );
    s.revolute("C", (tip, [1.5, 0.0]), (rocker, [3.0, 0.0]));
    s.revolute("D", (GROUND, [4.0, 0.0]), (rocker, [0.0, 0.0]));
    s.actuate("phi", [GROUND, crank]);
    check(&s.setup(&[1.0]), &REVOLUTION_STEPS);
}

#[test]
fn two_gears_on_the_ground() {
    for internal in [false, true] {
        let mut s = Sketch::new();
        let one = s.mass("one", block(1.0), None);
        let two = s.mass("two", block(2.0), Some(0.2));
        let base = if internal { 0.2 } else { 0.8 };
        s.revolute("A", (GROUND, [0.1, 0.0]), (one, [0.0, 0.0]));
        s.revolute("B", (GROUND, [0.1, base]), (two, [0.0, 0.0]));
        let radii = [0.3, 0.5];
        let gear = JointKind::Gear { radii, internal };
        s.joint("g", (one, [0.0, 0.0]), (two, [0.0, 0.0]), gear);
        s.actuate("phi", [GROUND, one]);
        check(&s.setup(&[0.3]), &REVOLUTION_STEPS);
    }
}

#[test]
fn a_planet_between_sun_and_ring() {
    let mut s = Sketch::new();
    let sun = s.mass("sun", block(3.0), None);
    let arm = s.mass("arm", bar(1.0, 0.5), Some(0.4));
    let planet = s.mass("planet", block(0.7), Some(0.0));
    s.revolute("A", (GROUND, [0.0, 0.0]), (sun, [0.0, 0.0]));
    s.revolute("B", (GROUND, [0.0, 0.0]), (arm, [0.0, 0.0]));
    s.revolute("C", (arm, [0.5, 0.0]), (planet, [0.0, 0.0]));
    let gear = |radii, internal| JointKind::Gear { radii, internal };
    s.joint(
        "sp",
        (sun, [0.0, 0.0]),
        (planet, [0.0, 0.0]),
        gear([0.3, 0.2], false),
    );
    s.joint(
        "rp",
        (GROUND, [0.0, 0.0]),
        (planet, [0.0, 0.0]),
        gear([0.7, 0.2], true),
    );
    s.actuate("phi", [GROUND, sun]);
    check(&s.setup(&[0.1]), &REVOLUTION_STEPS);
}

#[test]
fn two_gears_close_a_five_bar() {
    let mut s = Sketch::new();
    let one = s.mass("one", bar(1.0, 0.3), None);
    let two = s.mass("two", bar(1.0, 0.3), Some(0.5));
    let three = s.mass("three", bar(0.6, 1.0), Some(0.9));
    let four = s.mass("four", bar(0.6, 1.0), Some(2.2));
    s.revolute("A", (GROUND, [0.0, 0.0]), (one, [0.0, 0.0]));
    s.revolute("B", (GROUND, [0.9, 0.0]), (two, [0.0, 0.0]));
    s.revolute("C", (one, [0.3, 0.0]), (three, [0.0, 0.0]));
    s.revolute("D", (two, [0.3, 0.0]), (four, [0.0, 0.0]));
    s.revolute("E", (three, [1.0, 0.0]), (four, [1.0, 0.0]));
    let gear = JointKind::Gear {
        radii: [0.3, 0.6],
        internal: false,
    };
    s.joint("g", (one, [0.0, 0.0]), (two, [0.0, 0.0]), gear);
    s.actuate("phi", [GROUND, one]);
    check(&s.setup(&[0.5]), &REVOLUTION_STEPS);
}

#[test]
fn a_rack_driven_by_its_pinion_and_a_pinion_by_its_rack() {
    for by_rack in [false, true] {
        let mut s = Sketch::new();
        let pinion = s.mass("pinion", block(1.0), None);
        let rack = s.mass("rack", block(2.0), None);
        let axis = Vec2::from_angle(0.4);
        s.revolute("A", (GROUND, [0.3, 0.6]), (pinion, [0.0, 0.0]));
        let slide = s.prismatic("s", (GROUND, [0.0, 0.0]), (rack, [0.1, 0.0]), axis);
        // From the pitch line to the pinion's centre: n·((0.3, 0.6) − (−0.1, 0.2)).
        let radius = axis.perp().dot(vec2(0.4, 0.4));
        let kind = JointKind::Rack { axis, radius };
        s.joint("r", (rack, [0.0, 0.2]), (pinion, [0.0, 0.0]), kind);
        if by_rack {
            s.actuate_travel("x", [GROUND, rack], slide);
        } else {
            s.actuate("phi", [GROUND, pinion]);
        }
        check(&s.setup(&[0.2]), &LIMITED_STEPS);
    }
}

#[test]
fn a_crank_pulls_a_rolling_wheel() {
    for side in [1.0, -1.0] {
        let mut s = Sketch::new();
        let crank = s.mass("crank", bar(1.0, 0.2), None);
        let rod = s.mass("rod", bar(1.0, 1.0), Some(0.1));
        let wheel = s.mass("wheel", block(3.0), Some(0.0));
        let axis = Vec2::from_angle(0.1);
        let radius = 0.3 * side;
        s.revolute("A", (GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
        s.revolute("B", (crank, [0.2, 0.0]), (rod, [0.0, 0.0]));
        s.revolute("C", (rod, [1.0, 0.0]), (wheel, [0.0, 0.0]));
        let kind = JointKind::Rolling { axis, radius };
        s.joint("d", (GROUND, [0.9, -radius]), (wheel, [0.0, 0.0]), kind);
        s.actuate("phi", [GROUND, crank]);
        check(&s.setup(&[0.4]), &REVOLUTION_STEPS);
    }
}

#[test]
fn a_distance_is_a_massless_coupler() {
    let mut s = Sketch::new();
    let crank = s.mass("crank", bar(1.0, 1.0), None);
    let rocker = s.mass("rocker", bar(2.0, 3.0), Some(1.8));
    s.revolute("A", (GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    s.revolute("D", (GROUND, [4.0, 0.0]), (rocker, [0.0, 0.0]));
    let length = 3.5;
    let kind = JointKind::Distance { length };
    s.joint("l", (crank, [1.0, 0.0]), (rocker, [3.0, 0.0]), kind);
    s.actuate("phi", [GROUND, crank]);
    check(&s.setup(&[1.0]), &REVOLUTION_STEPS);
}

#[test]
fn a_cam_lifts_its_follower_and_turns_another() {
    let mut s = Sketch::new();
    let cam = s.mass("cam", block(1.0), None);
    let follower = s.mass("follower", block(2.0), None);
    let flap = s.mass("flap", bar(0.5, 0.4), None);
    s.revolute("A", (GROUND, [0.0, 0.0]), (cam, [0.0, 0.0]));
    let guide = s.prismatic(
        "s",
        (GROUND, [0.1, 0.0]),
        (follower, [0.0, 0.1]),
        vec2(0.0, 1.0),
    );
    s.revolute("B", (follower, [0.0, 0.3]), (flap, [0.0, 0.0]));
    s.actuate("phi", [GROUND, cam]);
    let law = |coefficients: [f64; 4]| {
        Law::Polynomial(Polynomial {
            coefficients: coefficients.to_vec(),
        })
    };
    let rise = Coupling {
        dependent: Coordinate::Travel(guide),
        independent: Coordinate::Angle([GROUND, cam]),
        law: law([0.3, 0.1, -0.04, 0.02]),
    };
    let flip = Coupling {
        dependent: Coordinate::Angle([follower, flap]),
        independent: Coordinate::Travel(guide),
        law: law([0.1, 2.0, 0.5, 0.0]),
    };
    s.couple("lift", [GROUND, follower], rise);
    s.couple("flip", [follower, flap], flip);
    check(&s.setup(&[0.3]), &LIMITED_STEPS);
}

#[test]
fn a_boom_with_a_cylinder_between_two_points_and_one_of_two_bodies() {
    let mut s = Sketch::new();
    let boom = s.mass("boom", bar(40.0, 3.0), Some(0.7));
    s.revolute("A", (GROUND, [0.0, 0.0]), (boom, [0.0, 0.0]));
    let points = [vec2(0.8, -0.3), vec2(1.5, 0.1)];
    s.actuate_length("l", [GROUND, boom], points);
    check(&s.setup(&[1.2]), &LIMITED_STEPS);

    let mut s = Sketch::new();
    let boom = s.mass("boom", bar(40.0, 3.0), Some(0.7));
    let barrel = s.mass("barrel", bar(5.0, 0.8), None);
    let rod = s.mass("rod", bar(2.0, 0.8), None);
    s.revolute("A", (GROUND, [0.0, 0.0]), (boom, [0.0, 0.0]));
    s.revolute("B", (GROUND, [0.8, -0.3]), (barrel, [0.0, 0.0]));
    let slide = s.prismatic(
        "s",
        (rod, [0.0, 0.02]),
        (barrel, [0.0, 0.0]),
        vec2(-1.0, 0.0),
    );
    s.revolute("C", (boom, [1.5, 0.1]), (rod, [0.4, 0.0]));
    s.actuate_travel("l", [rod, barrel], slide);
    check(&s.setup(&[0.8]), &LIMITED_STEPS);
}

#[test]
fn a_five_bar_with_two_cranks_and_one_with_a_crank_and_a_cylinder() {
    for by_length in [false, true] {
        let mut s = Sketch::new();
        let one = s.mass("one", bar(1.0, 0.4), None);
        let two = s.mass("two", bar(1.0, 0.4), Some(1.5));
        let three = s.mass("three", bar(0.6, 1.0), Some(0.9));
        let four = s.mass("four", bar(0.6, 1.0), Some(2.2));
        s.revolute("A", (GROUND, [0.0, 0.0]), (one, [0.0, 0.0]));
        s.revolute("B", (GROUND, [0.9, 0.0]), (two, [0.0, 0.0]));
        s.revolute("C", (one, [0.4, 0.0]), (three, [0.0, 0.0]));
        s.revolute("D", (two, [0.4, 0.0]), (four, [0.0, 0.0]));
        s.revolute("E", (three, [1.0, 0.0]), (four, [1.0, 0.0]));
        s.actuate("phi", [GROUND, one]);
        let mut start = [1.4, 1.7];
        if by_length {
            s.actuate_length("l", [GROUND, two], [vec2(1.6, 0.0), vec2(0.4, 0.0)]);
            start[1] = 0.7;
        } else {
            s.actuate("psi", [GROUND, two]);
        }
        check(&s.setup(&start), &LIMITED_STEPS);
    }
}

#[test]
fn a_scotch_yoke_and_a_trammel() {
    let mut s = Sketch::new();
    let crank = s.mass("crank", bar(1.0, 0.2), None);
    let yoke = s.mass("yoke", block(2.0), None);
    s.revolute("A", (GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    s.prismatic(
        "s",
        (GROUND, [0.0, 0.0]),
        (yoke, [0.1, 0.0]),
        vec2(1.0, 0.0),
    );
    let axis = Vec2::from_angle(1.3);
    s.joint(
        "k",
        (yoke, [0.0, 0.0]),
        (crank, [0.2, 0.0]),
        JointKind::Slot { axis },
    );
    s.actuate("phi", [GROUND, crank]);
    check(&s.setup(&[0.3]), &REVOLUTION_STEPS);

    let mut s = Sketch::new();
    let across = s.mass("across", block(1.0), None);
    let up = s.mass("up", block(1.5), None);
    let beam = s.mass("beam", bar(2.0, 1.0), Some(-0.9));
    let slide = s.prismatic(
        "x",
        (GROUND, [0.0, 0.0]),
        (across, [0.0, 0.0]),
        vec2(1.0, 0.0),
    );
    s.prismatic("y", (GROUND, [0.0, 0.0]), (up, [0.0, 0.0]), vec2(0.0, 1.0));
    s.revolute("A", (up, [0.0, 0.0]), (beam, [0.0, 0.0]));
    s.revolute("B", (across, [0.0, 0.0]), (beam, [1.0, 0.0]));
    s.actuate_travel("x", [GROUND, across], slide);
    check(&s.setup(&[0.5]), &LIMITED_STEPS);
}

#[test]
fn three_cranks_hold_a_plate() {
    let mut s = Sketch::new();
    let plate = s.mass("plate", block(3.0), Some(0.1));
    let mut start = Vec::new();
    for (i, (pivot, corner)) in [
        ([0.0, 0.0], [-0.3, -0.2]),
        ([2.0, 0.0], [0.3, -0.2]),
        ([1.0, 1.8], [0.0, 0.3]),
    ]
    .into_iter()
    .enumerate()
    {
        let [crank, rod] = ["crank", "rod"].map(|name| format!("{name}{i}"));
        let turn = [0.9, 2.0, -2.2][i];
        let crank = s.mass(&crank, bar(1.0, 0.5), None);
        let rod = s.mass(&rod, bar(0.6, 0.75), None);
        s.revolute(&format!("A{i}"), (GROUND, pivot), (crank, [0.0, 0.0]));
        s.revolute(&format!("B{i}"), (crank, [0.5, 0.0]), (rod, [0.0, 0.0]));
        s.revolute(&format!("C{i}"), (rod, [0.75, 0.0]), (plate, corner));
        s.actuate(&format!("q{i}"), [GROUND, crank]);
        start.push(turn);
    }
    check(&s.setup(&start), &[0.0, 0.1, -0.15, 0.2]);
}

#[test]
fn a_four_bar_driven_at_the_floating_joint() {
    let bars = FourBar::new([1.0, 3.5, 3.0, 4.0]);
    let mut s = bars.sketch;
    s.actuate("phi", [bars.coupler, bars.rocker]);
    let mut setup = s.setup(&[1.2]);
    setup.masses = vec![Mass::default(), bar(1.0, 1.0), bar(2.0, 3.5), bar(2.0, 3.0)];
    setup.assembly.initial_guess[bars.crank.0] = Some(1.0);
    check(&setup, &[0.0, 0.1, -0.1]);
}
