//! Change points: a mechanism that passes one stays on its branch.
#![allow(clippy::expect_used, reason = "tests")]

mod parts;

use dwell_dynamics::{
    Atlas, ChartChangeReason, ContinuedMotion, Machine, MachineDescription, Method, Options,
};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{Body, BodyId, Joint, Mechanism, Reaction, Vec2, vec2};
use dwell_kinetostatics::{Drive, Load, Mass};
use parts::{
    Setup, angle, energy_lost, four_bar, gravity, mechanism, motor, samples, slider_crank,
    solve_setup, torsion_damper,
};
use std::f64::consts::{FRAC_PI_2, PI};

const G: f64 = 9.81;

/// IFToMM's A02: N equal four-bars in a row.
fn chain(n: usize) -> Mechanism {
    let tip = Vec2::IDENTITY;
    let mut chain = mechanism(
        &["ground", "link0"],
        vec![Joint::revolute("A0", [0, 1], [Vec2::ZERO; 2])],
    );
    for i in 1..=n {
        let [before, coupler, link] = [2 * i - 1, 2 * i, 2 * i + 1];
        let pivot = vec2(i as f64, 0.0);
        let links = [format!("coupler{i}"), format!("link{i}")];
        chain.bodies.extend(links.map(Body::named));
        chain.joints.extend([
            Joint::revolute(format!("B{i}"), [before, coupler], [tip, Vec2::ZERO]),
            Joint::revolute(format!("C{i}"), [coupler, link], [tip, tip]),
            Joint::revolute(format!("A{i}"), [0, link], [pivot, Vec2::ZERO]),
        ]);
    }
    chain
}

/// The chain with its links turned by `q`.
fn chain_at(n: usize, q: f64) -> Setup {
    let chain = chain(n);
    let mut masses = vec![Mass::uniform_bar(1.0, 1.0); chain.bodies.len()];
    masses[0] = Mass::default();
    let initial_guess: Vec<f64> = (0..masses.len())
        .map(|b| if b % 2 == 1 { q } else { 0.0 })
        .collect();
    Setup::new(&chain, angle([0, 1]), &masses, q, &initial_guess).with_loads(&[gravity()], &[])
}

/// The pendulum that it is: m = (4N + 1)/3 and V = (3N + 1)/2 g sin q.
fn pendulum(n: usize, q: f64) -> Setup {
    let links = n as f64;
    let (m, moment) = ((4.0 * links + 1.0) / 3.0, 0.5 * (3.0 * links + 1.0));
    // So heavy that its arm is short, and all of m is not spent on it.
    let mass = 100.0;
    let arm = moment / mass;
    let link = Mass {
        mass,
        center: vec2(arm, 0.0),
        inertia: m - mass * arm * arm,
    };
    let one = mechanism(
        &["ground", "link"],
        vec![Joint::revolute("A", [0, 1], [Vec2::ZERO; 2])],
    );
    Setup::new(&one, angle([0, 1]), &[Mass::default(), link], q, &[0.0, q])
        .with_loads(&[gravity()], &[])
}

fn crossing_count(motion: &ContinuedMotion) -> usize {
    let crosses =
        |reason: &ChartChangeReason| matches!(reason, ChartChangeReason::CrossesChangePoint { .. });
    motion.changes.iter().filter(|c| crosses(&c.reason)).count()
}

/// A02 through its flat positions for 20 s, against its closed form by Jacobi's elliptic functions.
#[test]
fn val_a02_through_the_flat_positions() {
    // θ after 10 and 20 s.
    for (n, theta) in [
        (1, [-30.343_944_970_943_13, -63.118_844_095_901_09]),
        (2, [-30.179_800_860_191_21, -62.257_873_066_351_22]),
        (40, [-30.026_637_417_190_84, -61.684_499_041_396_03]),
    ] {
        for (method, tolerance) in [(Method::Tsit45, 1e-9), (Method::Bdf, 5e-7)] {
            let setup = chain_at(n, FRAC_PI_2);
            let mut atlas = setup.atlas();
            let start = setup.initial_state(&atlas, -1.0);
            let motion = solve_setup(&mut atlas, &start, [20.0, 0.5], method, &[]);
            assert!(crossing_count(&motion) >= 20);
            // Of BDF the thousandfold of its tolerance over thousands of steps was met.
            assert!(energy_lost(&atlas, &motion) < 1e-9);
            let samples = samples(&motion);
            assert_eq!(samples.len(), 41);
            for (sample, theta) in [(&samples[20], theta[0]), (&samples[40], theta[1])] {
                // The tips are 1 m out: what the angle errs, they do.
                assert!(
                    (sample.y[0] - theta).abs() < tolerance,
                    "{n} {}",
                    sample.y[0]
                );
            }
            for fit in atlas.change_point_fits() {
                let flat = fit.center - PI * (fit.center / PI).round();
                assert!(flat.abs() < 1e-5 && fit.gap < 1e-10, "{fit:?}");
                // Each link turns by itself there, and what lies along them is not determined.
                assert_eq!(fit.mobility, n + 1);
                assert_eq!(fit.indeterminate.len(), 3 * n + 1);
            }
        }
    }
}

/// At rest m q̈ = (m + J) q̈ with a flywheel J, within a window and outside of it.
#[test]
fn a_flywheel_counts_on_a_fit() {
    const J: f64 = 0.7;
    let setup = chain_at(1, 0.05);
    let mut atlas = setup.atlas();
    let start = setup.initial_state(&atlas, 0.0);
    solve_setup(&mut atlas, &start, [2.0, 0.5], Method::Tsit45, &[]);
    let fit = atlas.change_point_fits().next().expect("a fit");
    let machine = &atlas.charts()[0].machine;
    let heavier = machine.clone().with_flywheel(0, J);
    let outside = fit.center + 1.5 * fit.half_width;
    for (q, is_fitted) in [(fit.center, true), (outside, false)] {
        let at_rest = machine.initial_state(&[q], &[0.0]);
        assert_eq!(machine.is_in_fit_window(&at_rest), is_fitted, "{q}");
        let acceleration = |of: &Machine| {
            let mut workspace = of.workspace();
            let state = of.evaluate(0.0, &at_rest, &mut workspace).expect("a pose");
            state.q_ddot()[0]
        };
        let moving = machine.initial_state(&[q], &[1.0]);
        let energy = machine.energy(0.0, &moving, &mut machine.workspace());
        let m = 2.0 * energy.expect("a pose")[0];
        let ratio = acceleration(machine) / acceleration(&heavier);
        // Seen: 3.3e-15.
        assert!((ratio / (1.0 + J / m) - 1.0).abs() < 2e-13, "{q}: {ratio}");
    }
}

/// The chain swings between neighbourhoods of both flat positions, within the windows and outside of them.
#[test]
fn a_chain_swings_as_its_pendulum() {
    for q in [0.05, 0.5] {
        let times = [8.0, 0.05];
        let [chain, pendulum] = [chain_at(5, q), pendulum(5, q)].map(|setup| {
            let mut atlas = setup.atlas();
            let start = setup.initial_state(&atlas, 0.0);
            let motion = solve_setup(&mut atlas, &start, times, Method::Tsit45, &[]);
            assert!(energy_lost(&atlas, &motion) < 1e-11);
            samples(&motion)
        });
        assert_eq!(chain.len(), pendulum.len());
        for (a, b) in chain.iter().zip(&pendulum) {
            // Tens of the tolerance.
            assert!((a.y[0] - b.y[0]).abs() < 1e-10, "{a:?} {b:?}");
        }
    }
}

/// A motor's current and rotor, a damper on the far link, and the works of both, across the flat position.
#[test]
fn loads_and_drives_cross_with_it() {
    let driven = |setup: Setup, loads: [Load; 2], drive: Drive| {
        let setup = setup.with_loads(&loads, &[drive]);
        let mut atlas = setup.atlas();
        let start = setup.initial_state(&atlas, -6.0);
        let motion = solve_setup(&mut atlas, &start, [4.0, 0.02], Method::Tsit45, &[]);
        (crossing_count(&motion), samples(&motion))
    };
    let loads = [gravity(), torsion_damper([0, 3])];
    let (times, chain) = driven(chain_at(1, 1.0), loads, motor([0, 1]));
    assert!(times >= 3);
    let loads = [gravity(), torsion_damper([0, 1])];
    let (_, link) = driven(pendulum(1, 1.0), loads, motor([0, 1]));
    assert_eq!(chain.len(), link.len());
    for (a, b) in chain.iter().zip(&link) {
        for (a, b) in a.y.iter().zip(&b.y) {
            // Tens of the tolerance of works of some 40 J.
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }
}

/// Rough steps lead over whole windows, and still to the same branch: the links stay parallel.
#[test]
fn rough_steps_stay_on_the_branch() {
    for n in [1, 5] {
        let setup = chain_at(n, FRAC_PI_2);
        let mut atlas = setup.atlas();
        let start = setup.initial_state(&atlas, -1.0);
        for tolerance in [1e-1, 1e-2, 1e-4, 1e-6, 1e-9] {
            for method in Method::ALL {
                let options = Options::new(method, tolerance);
                let motion = atlas.solve(&start, 6.0, &options, &[]).expect("a run");
                assert_eq!(motion.error, None, "{n} {tolerance} {method:?}");
                assert!(crossing_count(&motion) >= 3, "{n} {tolerance} {method:?}");
                let links = CoordinateFunction::Angle([BodyId(1), BodyId(2 * n + 1)]);
                let track = atlas
                    .coordinate_history(&motion, links)
                    .expect("a track")
                    .steps;
                for [difference, ..] in track.concat() {
                    assert!(
                        difference.abs() < 1e-9,
                        "{n} {tolerance} {method:?} {difference}"
                    );
                }
            }
        }
    }
}

/// Where the sides of 1 + 3 = 2 + 2 lie on one line the angles are curved, and it takes two turns of the
/// crank to come back.
#[test]
fn a_curved_change_point() {
    let chain = four_bar([0.3, 0.1, 0.22, 0.18]);
    let masses = [
        Mass::default(),
        Mass::uniform_bar(1.0, 0.1),
        Mass::uniform_bar(0.8, 0.22),
        Mass::uniform_bar(0.5, 0.18),
    ];
    let setup = Setup::new(&chain, angle([0, 1]), &masses, 1.0, &[0.0, 1.0, 0.5, 1.5])
        .with_loads(&[gravity()], &[]);
    for speed in [25.0, -25.0] {
        let mut atlas = setup.atlas();
        let start = setup.initial_state(&atlas, speed);
        let motion = solve_setup(&mut atlas, &start, [3.0, 0.01], Method::Tsit45, &[]);
        assert!(crossing_count(&motion) >= 8);
        assert_eq!(atlas.charts().len(), 2);
        assert!(energy_lost(&atlas, &motion) < 1e-10);
        // The rocker goes on as it did: its speed is that of its angle, by the trapezium with its end
        // correction.
        let rocker = CoordinateFunction::Angle([BodyId(0), BodyId(3)]);
        let track = atlas
            .coordinate_history(&motion, rocker)
            .expect("a track")
            .samples;
        for w in track.concat().windows(2) {
            let [a, b] = [w[0], w[1]];
            let by_speed = 0.5 * (a[1] + b[1]) - (b[2] - a[2]) * 0.01 / 12.0;
            assert!((b[0] - a[0] - 0.01 * by_speed).abs() < 2e-3, "{w:?}");
        }
    }
}

/// A rod as long as its crank: the piston passes the pivot, at x = 2 r cos q, where the rod could as well
/// turn with the crank and leave it there.
#[test]
fn a_piston_passes_the_pivot() {
    let r = 0.2;
    let piston = Mass {
        mass: 0.6,
        ..Mass::default()
    };
    let masses = [
        Mass::default(),
        Mass::uniform_bar(1.0, r),
        Mass::uniform_bar(0.8, r),
        piston,
    ];
    let chain = slider_crank(r, r, 0.0);
    let setup = Setup::new(&chain, angle([0, 1]), &masses, 0.4, &[0.0, 0.4, -0.4, 0.0])
        .with_loads(&[gravity()], &[]);
    let mut atlas = setup.atlas();
    let start = setup.initial_state(&atlas, 12.0);
    let motion = solve_setup(&mut atlas, &start, [3.0, 0.01], Method::Tsit45, &[]);
    assert!(crossing_count(&motion) >= 8);
    assert!(energy_lost(&atlas, &motion) < 1e-10);
    let travel = CoordinateFunction::Length {
        bodies: [BodyId(0), BodyId(3)],
        points: [vec2(-1.0, 0.0), Vec2::ZERO],
    };
    let track = atlas
        .coordinate_history(&motion, travel)
        .expect("a track")
        .samples
        .concat();
    for ([x, speed, _], sample) in track.iter().zip(samples(&motion)) {
        let (sin, cos) = sample.y[0].sin_cos();
        // Bridges meet the plan to 1e-12 or so.
        assert!((x - 1.0 - 2.0 * r * cos).abs() < 1e-12, "{x}");
        assert!(
            (speed + 2.0 * r * sin * sample.y[1]).abs() < 1e-10,
            "{speed}"
        );
    }
}

/// The forces of all pins of A02 by statics from its free end: A₀, then B, C, A of every four-bar.
fn by_hand(n: usize, [theta, omega, alpha]: [f64; 3]) -> Vec<Vec2> {
    let e = Vec2::from_angle(theta);
    let g = vec2(0.0, -G);
    let tip = e.perp() * alpha - e * (omega * omega);
    let pull = 0.5 * (g.y - tip.y);
    let (mut next, mut forces) = (Vec2::ZERO, Vec::new());
    for _ in 0..n {
        let moment = e.x * (pull - next.y) + 0.5 * e.cross(g) - alpha / 3.0;
        let c = vec2(next.x + moment / e.y, pull);
        let b = c + tip - g;
        forces.extend([tip * 0.5 - g - c + next, c, b]);
        next = b;
    }
    forces.push(tip * 0.5 - g + next);
    forces.reverse();
    forces
}

/// In the window, the reactions that the flat position determines are there and no others; the
/// acceleration is that of the pendulum.
#[test]
fn reactions_across_a_bridge() {
    let n = 5;
    let setup = chain_at(n, FRAC_PI_2);
    let reactions: Vec<Reaction> = setup.mechanism.reactions();
    let description = MachineDescription {
        varying_inertias: &[],
        mechanism: &setup.mechanism,
        masses: &setup.masses,
        assembly: &setup.assembly,
        loads: &setup.loads,
        drives: &[],
        reactions: &reactions,
    };
    let mut atlas = Atlas::new(description).expect("an atlas");
    let start = setup.initial_state(&atlas, -1.0);
    let options = Options::new(Method::Tsit45, 1e-12);
    atlas.solve(&start, 0.1, &options, &[]).expect("a run");
    let half_width = atlas
        .change_point_fits()
        .next()
        .expect("a bridge")
        .half_width;
    let chart = &atlas.charts()[0];
    let (machine, output_model) = (&chart.machine, &chart.output_model);
    let (mut workspace, mut output_workspace) = (machine.workspace(), output_model.workspace());
    let mut result = output_model.result_buffer();
    for (part, inside) in [
        (-0.9, true),
        (0.0, true),
        (0.5, true),
        (0.99, true),
        (1.01, false),
    ] {
        let y = [part * half_width, -5.0];
        assert_eq!(machine.is_in_fit_window(&y), inside);
        let state = machine.evaluate(0.0, &y, &mut workspace).expect("a state");
        let outputs = state.outputs(output_model, &mut output_workspace, &mut result);
        let reactions = &outputs.expect("reactions").inverse_dynamics().reactions;
        let links = n as f64;
        let pull = 0.5 * (3.0 * links + 1.0) * G * y[0].cos();
        let expected = -pull / ((4.0 * links + 1.0) / 3.0);
        // What a bridge is off the plan by.
        assert!((state.q_ddot()[0] - expected).abs() < 1e-9, "{part}");
        let forces = by_hand(n, [y[0], y[1], state.q_ddot()[0]]);
        for (got, force) in reactions.chunks_exact(2).zip(&forces) {
            assert_eq!(got[0].is_nan(), inside);
            // Of some 50 N.
            assert!(
                (got[1] - force.y).abs() < 1e-9,
                "{part} {} {force:?}",
                got[1]
            );
        }
    }
}
