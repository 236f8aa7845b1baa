//! Every kind of joint and drive, held against the dense rows: positions close them, and the
//! reactions and actions are those of the full equations Jᵀ[λ; τ] = M ẍ + h.

use crate::changes::Setup;
use crate::sketch::{FourBar, Sketch};
use dwell_geometry::rows::Rows;
use dwell_geometry::{BodyId, Coordinate, JointKind, Relation, Vec2, vec2};
use dwell_kinetostatics::{Mass, Model};
use dwell_laws::{Law, Polynomial};

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

/// Solves the square system a x = b, row after row.
fn solve(mut a: Vec<f64>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let best = (k..n)
            .max_by(|&i, &j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs()))
            .unwrap();
        for j in 0..n {
            a.swap(k * n + j, best * n + j);
        }
        b.swap(k, best);
        assert!(a[k * n + k].abs() > 1e-9, "a singular dense system");
        for i in k + 1..n {
            let ratio = a[i * n + k] / a[k * n + k];
            for j in k..n {
                a[i * n + j] -= ratio * a[k * n + j];
            }
            b[i] -= ratio * b[k];
        }
    }
    for i in (0..n).rev() {
        for j in i + 1..n {
            b[i] -= a[i * n + j] * b[j];
        }
        b[i] /= a[i * n + i];
    }
    b
}

/// Judges the mechanism at some steps away from its start. Each step is in rad or m.
fn judge(setup: &Setup, steps: &[f64]) {
    let Setup {
        mechanism,
        masses,
        start,
        ..
    } = setup;
    let reactions = mechanism.reactions();
    let model = match Model::new(mechanism, masses, start, &reactions) {
        Ok(model) => model,
        Err(error) => panic!("{error}"),
    };
    let mut rows = Rows::new(mechanism).unwrap();
    let mut work = model.workspace::<f64>();
    let mut actions = model.actions();
    let n = rows.columns();
    assert_eq!(n, rows.len(), "as many rows as coordinates");
    let zero = vec![0.0; start.q.len()];
    model
        .act(&start.q, &zero, &zero, &mut work, &mut actions)
        .unwrap();
    let coordinates = |work: &dwell_kinetostatics::Workspace<f64>| -> Vec<f64> {
        let frames = model.plan().body_frames(mechanism, &work.pose);
        (0..frames.len())
            .filter(|&b| b != mechanism.ground)
            .flat_map(|b| frames[b])
            .collect()
    };
    rows.mesh(&coordinates(&work));
    for (s, step) in steps.iter().enumerate() {
        let turn = |i: usize| step * (1.0 - 0.3 * i as f64);
        let q: Vec<f64> = start
            .q
            .iter()
            .enumerate()
            .map(|(i, q)| q + turn(i))
            .collect();
        let q_dot: Vec<f64> = (0..q.len()).map(|i| 1.3 - 0.8 * i as f64).collect();
        let q_ddot: Vec<f64> = (0..q.len()).map(|i| -0.7 + 1.1 * i as f64).collect();
        if let Err(error) = model.act(&q, &q_dot, &q_ddot, &mut work, &mut actions) {
            panic!("step {s}: {error}");
        }
        let x = coordinates(&work);
        let mut imposed = vec![0.0; rows.len()];
        imposed[reactions.len()..].copy_from_slice(&q);
        let mut open = vec![0.0; rows.len()];
        rows.residual(&x, &imposed, &mut open);
        let worst = open.iter().fold(0.0_f64, |w, o| w.max(o.abs()));
        assert!(worst < 1e-12, "step {s}: rows open by {worst:e}: {open:?}");

        let mut jacobian = vec![0.0; n * n];
        rows.jacobian(&x, &mut jacobian);
        let mut rates = vec![0.0; n];
        rates[reactions.len()..].copy_from_slice(&q_dot);
        let speed = solve(jacobian.clone(), rates);
        let mut bend = vec![0.0; n];
        rows.curvature(&x, &speed, &mut bend);
        let mut rates: Vec<f64> = bend.iter().map(|b| -b).collect();
        for (rate, q_ddot) in rates[reactions.len()..].iter_mut().zip(&q_ddot) {
            *rate += q_ddot;
        }
        let acceleration = solve(jacobian.clone(), rates);
        let mut force = vec![0.0; n];
        let moving = (0..masses.len()).filter(|&b| b != mechanism.ground);
        for (k, b) in moving.enumerate() {
            let Mass {
                mass,
                center,
                inertia,
            } = masses[b];
            let [w, a] = [speed[3 * k + 2], acceleration[3 * k + 2]];
            let arm = center.turn(Vec2::from_angle(x[3 * k + 2]));
            let at =
                vec2(acceleration[3 * k], acceleration[3 * k + 1]) + arm.perp() * a - arm * (w * w);
            force[3 * k] = mass * at.x;
            force[3 * k + 1] = mass * at.y;
            force[3 * k + 2] = inertia * a + arm.cross(at * mass);
        }
        let mut transposed = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..n {
                transposed[j * n + i] = jacobian[i * n + j];
            }
        }
        let all = solve(transposed, force);
        let scale = all.iter().fold(1e-3_f64, |s, v| s.max(v.abs()));
        let got = actions.reactions.iter().chain(&actions.tau);
        let mut wrong = Vec::new();
        for (k, (got, want)) in got.zip(&all).enumerate() {
            let name = reactions
                .get(k)
                .map_or("an actuator".to_owned(), |&r| mechanism.reaction_name(r));
            if (got - want).abs() > 1e-10 * scale {
                wrong.push(format!("{name} is {got}, by the dense rows {want}"));
            }
        }
        assert!(wrong.is_empty(), "step {s}: {}", wrong.join("; "));
    }
}

const TURN: [f64; 6] = [0.0, 0.7, 2.1, 3.9, -4.4, 9.0];
const SWING: [f64; 5] = [0.0, 0.15, -0.2, 0.31, -0.4];

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
    s.drive("phi", [GROUND, crank]);
    judge(&s.setup(&[0.3]), &TURN);
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
    s.drive("phi", [GROUND, crank]);
    judge(&s.setup(&[1.0]), &TURN);
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
        s.drive("phi", [GROUND, one]);
        judge(&s.setup(&[0.3]), &TURN);
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
    s.drive("phi", [GROUND, sun]);
    judge(&s.setup(&[0.1]), &TURN);
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
    s.drive("phi", [GROUND, one]);
    judge(&s.setup(&[0.5]), &TURN);
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
            s.drive_travel("x", [GROUND, rack], slide);
        } else {
            s.drive("phi", [GROUND, pinion]);
        }
        judge(&s.setup(&[0.2]), &SWING);
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
        s.drive("phi", [GROUND, crank]);
        judge(&s.setup(&[0.4]), &TURN);
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
    s.drive("phi", [GROUND, crank]);
    judge(&s.setup(&[1.0]), &TURN);
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
    s.drive("phi", [GROUND, cam]);
    let law = |coefficients: [f64; 4]| {
        Law::Polynomial(Polynomial {
            coefficients: coefficients.to_vec(),
        })
    };
    let rise = Relation {
        of: Coordinate::Travel(guide),
        by: Coordinate::Angle([GROUND, cam]),
        law: law([0.3, 0.1, -0.04, 0.02]),
    };
    let flip = Relation {
        of: Coordinate::Angle([follower, flap]),
        by: Coordinate::Travel(guide),
        law: law([0.1, 2.0, 0.5, 0.0]),
    };
    s.relate("lift", [GROUND, follower], rise);
    s.relate("flip", [follower, flap], flip);
    judge(&s.setup(&[0.3]), &SWING);
}

#[test]
fn a_boom_with_a_cylinder_between_two_points_and_one_of_two_bodies() {
    let mut s = Sketch::new();
    let boom = s.mass("boom", bar(40.0, 3.0), Some(0.7));
    s.revolute("A", (GROUND, [0.0, 0.0]), (boom, [0.0, 0.0]));
    let points = [vec2(0.8, -0.3), vec2(1.5, 0.1)];
    s.drive_length("l", [GROUND, boom], points);
    judge(&s.setup(&[1.2]), &SWING);

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
    s.drive_travel("l", [rod, barrel], slide);
    judge(&s.setup(&[0.8]), &SWING);
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
        s.drive("phi", [GROUND, one]);
        let mut start = [1.4, 1.7];
        if by_length {
            s.drive_length("l", [GROUND, two], [vec2(1.6, 0.0), vec2(0.4, 0.0)]);
            start[1] = 0.7;
        } else {
            s.drive("psi", [GROUND, two]);
        }
        judge(&s.setup(&start), &SWING);
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
    s.drive("phi", [GROUND, crank]);
    judge(&s.setup(&[0.3]), &TURN);

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
    s.drive_travel("x", [GROUND, across], slide);
    judge(&s.setup(&[0.5]), &SWING);
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
        s.drive(&format!("q{i}"), [GROUND, crank]);
        start.push(turn);
    }
    judge(&s.setup(&start), &[0.0, 0.1, -0.15, 0.2]);
}

#[test]
fn a_four_bar_driven_at_the_floating_joint() {
    let bars = FourBar::new([1.0, 3.5, 3.0, 4.0]);
    let mut s = bars.sketch;
    s.drive("phi", [bars.coupler, bars.rocker]);
    let mut setup = s.setup(&[1.2]);
    setup.masses = vec![Mass::default(), bar(1.0, 1.0), bar(2.0, 3.5), bar(2.0, 3.0)];
    setup.start.rough[bars.crank.0] = Some(1.0);
    judge(&setup, &[0.0, 0.1, -0.1]);
}
