//! End stops: impacts, rebounds that accumulate, rest and lifting off, against closed forms.

use crate::{Run, run, tolerance};
use dwell_dynamics::{ContactEvent, Method, StopChange};
use dwell_scene::PlaneScene;

const G: f64 = 9.81;

/// A ball of 2 kg above a floor, with further loads and keys of the stop and the motion.
fn ball(stop: &str, loads: &str, motion: &str) -> String {
    format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.ball]
points = {{ A = [0, 0] }}
mass = 2.0
center = [0, 0]
[joints]
line = {{ prismatic = ["ground.A", "ball.A"], axis = [0, 1] }}
[actuators.z]
length = "line"
[assembly]
z = 1.0
[loads]
weight = {{ gravity = [0, -{G:?}] }}
{loads}
[stops]
floor = {{ coordinate = "z", {stop} }}
[motion]
{motion}
"#
    )
}

fn is_impact(change: &StopChange) -> bool {
    matches!(change, StopChange::Impact { .. })
}

fn near(found: f64, expected: f64, allowed: f64) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    assert!(
        error <= allowed,
        "{found:?} is {error:.1e} from {expected:?}"
    );
}

/// Dropped from 1 m it bounces at √(2h/g) (1 + 2e + 2e² + …), and rests from (1 + e)/(1 − e) √(2h/g) on: exactly.
#[test]
fn a_ball_bounces_and_comes_to_rest_where_its_rebounds_accumulate() {
    let first = (2.0 / G).sqrt();
    for (method, e) in Method::ALL.into_iter().zip([0.5_f64, 0.6, 0.3, 0.8, 0.9]) {
        let text = ball(
            &format!("min = 0.0, restitution = {e:?}"),
            "",
            "duration = 10.0",
        );
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let (impacts, rests) = (run.stops(is_impact), run.stops(|c| *c == StopChange::Rests));
        println!(
            "{method:?} {} impacts, {} evaluations",
            impacts.len(),
            run.evaluations
        );
        // Each of some twenty rebounds begins anew: BDF with its first order and an error of 3e-10 (measured: 7e-9 in all).
        let spread = 20.0 * allowed;
        let mut time = first;
        for (k, t) in impacts.iter().enumerate() {
            near(*t, time, spread);
            time += 2.0 * first * e.powi(1 + i32::try_from(k).expect("few"));
        }
        assert!(impacts.len() > 10 && rests.len() == 1, "{}", impacts.len());
        near(rests[0], first * (1.0 + e) / (1.0 - e), spread);
        assert_eq!(run.end(), [0.0, 0.0]);
        // What the impacts lose is the work of the stop.
        assert!(
            run.energy_error() < allowed.max(1e-10),
            "{:e}",
            run.energy_error()
        );
        let work = run.steps.last().expect("steps").y[run.machine.work_offset()..]
            .last()
            .copied();
        near(work.expect("a work"), -2.0 * G, allowed.max(1e-10));
    }
}

/// Without loss it bounces a thousand times, and keeps its energy.
#[test]
fn a_thousand_rebounds_without_loss_keep_the_energy() {
    let first = (2.0 / G).sqrt();
    let text = ball("min = 0.0, restitution = 1.0", "", "duration = 903.5");
    let run: Run = run(&text, Method::Dop853, 1e-13);
    let impacts = run.stops(is_impact);
    assert_eq!(impacts.len(), 1001);
    println!("{} evaluations, {:e}", run.evaluations, run.energy_error());
    // Measured: 31 for each rebound, which begins with the step of the one before.
    assert!(run.evaluations < 40 * 1001);
    assert!(run.energy_error() < 1e-10, "{:e}", run.energy_error());
    for (k, t) in impacts.iter().enumerate() {
        near(*t / 903.5, first * (1.0 + 2.0 * k as f64) / 903.5, 1e-11);
    }
}

/// A lift stands on its floor until a force that grows by 10 N/s lifts it off at its weight.
#[test]
fn a_lift_stands_on_its_floor_until_it_is_lifted() {
    let loads = r#"rope = { force = "ball.A", direction = [0, 1], magnitude = "10*t" }"#;
    let lifted = 2.0 * G / 10.0;
    // At zero the positions soon after are not rounded to the stop's own.
    let methods = Method::ALL.into_iter();
    for (method, floor) in methods.flat_map(|method| [(method, 1.0), (method, 0.0)]) {
        let text = ball(&format!("min = {floor:?}"), loads, "duration = 3.0")
            .replace("z = 1.0", &format!("z = {floor:?}"));
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        assert_eq!(run.stops(is_impact), Vec::<f64>::new());
        let leaves = run.stops(|c| *c == StopChange::Leaves);
        assert_eq!(leaves.len(), 1, "{method:?} {:?}", run.events);
        near(leaves[0], lifted, 3e-11);
        assert!(
            run.steps
                .iter()
                .filter(|s| s.t <= lifted)
                .all(|s| s.y[..2] == [floor, 0.0])
        );
        let after = 3.0 - lifted;
        near(run.end()[0], floor + 10.0 * after.powi(3) / 12.0, allowed);
    }
}

/// A double pendulum meets a stop with its elbow: momentum balance of the jump, M Δq̇ = e P, and of energy.
#[test]
fn an_impact_of_a_double_pendulum_balances_momentum_and_energy() {
    let text = r#"
[bodies.ground]
points = { A = [0, 0] }
[bodies.upper]
points = { A = [0, 0], B = [1, 0] }
mass = 1.5
center = [0.5, 0]
inertia = 0.1
[bodies.lower]
points = { B = [0, 0] }
mass = 0.7
center = [0.4, 0.1]
inertia = 0.05
[joints]
A = { revolute = ["ground.A", "upper.A"] }
B = { revolute = ["upper.B", "lower.B"] }
[actuators.p]
angle = ["ground", "upper"]
[actuators.r]
angle = ["upper", "lower"]
[assembly]
p = -1.0
r = 0.5
[loads]
weight = { gravity = [0, -9.81] }
[stops]
elbow = { coordinate = "r", min = -0.2, max = 1.2, restitution = 0.7 }
[motion]
initial-velocity = { p = 2.0, r = 3.0 }
duration = 5.0
"#;
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(text, method, rtol);
        let mut workspace = run.machine.workspace();
        let mut count = 0;
        for event in &run.events {
            let ContactEvent::Stop {
                t,
                y,
                change: StopChange::Impact { impulse, changes },
                ..
            } = event
            else {
                continue;
            };
            count += 1;
            // The generalised momenta before and behind: that of p stays, that of r jumps by the impulse.
            let mut before = y.clone();
            for (speed, change) in before[2..4].iter_mut().zip(changes) {
                *speed -= change;
            }
            let mut momenta = |y: &[f64]| {
                let at = |y: &[f64], workspace: &mut _| {
                    let state = run.machine.evaluate(*t, y, workspace).expect("a state");
                    state.energy()[0]
                };
                let mut of = [0.0; 2];
                for k in 0..2 {
                    // T is quadratic in the speeds: its difference quotient of step 1 is exact.
                    let (mut up, mut down) = (y.to_vec(), y.to_vec());
                    up[2 + k] += 0.5;
                    down[2 + k] -= 0.5;
                    of[k] = at(&up, &mut workspace) - at(&down, &mut workspace);
                }
                of
            };
            let (old, new) = (momenta(&before), momenta(y));
            let scale = old[0].abs().max(old[1].abs()).max(1.0);
            assert!(
                (new[0] - old[0]).abs() < 1e-12 * scale,
                "{method:?} {old:?} {new:?}"
            );
            assert!(
                (new[1] - old[1] - impulse).abs() < 1e-12 * scale,
                "{old:?} {new:?}"
            );
            assert!((y[3] + 0.7 * before[3]).abs() < 1e-14 * before[3].abs().max(1.0));
        }
        assert!(count >= 3, "{method:?} {count}");
        assert!(
            run.energy_error() < 10.0 * allowed,
            "{:e}",
            run.energy_error()
        );
    }
}

/// Friction and a stop at once: a block that slides into its stop rests there, and friction holds it when the push ends.
#[test]
fn a_block_with_friction_rests_on_its_stop() {
    let loads =
        r#"push = { force = "ball.A", direction = [0, -1], magnitude = "if(t < 1, 30, 0)" }"#;
    let text = ball("min = 0.5, restitution = 0.2", loads, "duration = 2.0")
        .replace("gravity = [0, -9.81]", "gravity = [-9.81, 0]")
        .replace(
            "[motion]",
            "[friction]\nline = { coefficient = 0.3 }\n[motion]",
        );
    for method in Method::ALL {
        let [rtol, _] = tolerance(method);
        let run = run(&text, method, rtol);
        assert_eq!(run.end(), [0.5, 0.0], "{method:?}");
        assert!(
            run.stops(|c| *c == StopChange::Rests).len() == 1,
            "{:?}",
            run.events
        );
    }
}

/// Careless end stops are refused with a place in the scene.
#[test]
fn careless_stops_are_refused() {
    for (stop, expected) in [
        ("min = 0.0, restitution = -0.1", "restitution"),
        ("min = 0.0, restitution = 1.1", "is above 1"),
        ("min = 2.0, max = 1.5", "is not below its `max`"),
        ("restitution = 0.1", "neither `min` nor `max`"),
        ("min = 0.0, bounce = 1", "unknown key `bounce`"),
    ] {
        let text = ball(stop, "", "duration = 1.0");
        let error = PlaneScene::parse("scene.toml", &text).expect_err(stop);
        assert!(format!("{error:?}").contains(expected), "{error:?}");
    }
    let unknown =
        ball("min = 0.0", "", "duration = 1.0").replace("coordinate = \"z\"", "coordinate = \"y\"");
    let error = PlaneScene::parse("scene.toml", &unknown).expect_err("no actuator");
    assert!(
        format!("{error:?}").contains("there is no actuator `y`"),
        "{error:?}"
    );
}
