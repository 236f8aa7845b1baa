//! Loads that switch with a speed and drive it back from both sides: the motion slides along their switch, against closed
//! forms.

use crate::{Run, attempt, run, tolerance};
use dwell_dynamics::{ContactEvent, DynamicsError, Method};

const G: f64 = 9.81;
const MASS: f64 = 2.0;

/// A block on an incline (degrees) without friction in its guide, with further loads, sections and keys of the motion.
fn block(incline: f64, loads: &str, sections: &str, motion: &str) -> String {
    let (sin, cos) = incline.to_radians().sin_cos();
    let loads = loads.replace("ALONG", &format!("[{cos:?}, {sin:?}]"));
    format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.block]
points = {{ A = [0, 0] }}
mass = {MASS:?}
center = [0, 0]
[joints]
guide = {{ prismatic = ["ground.A", "block.A"], axis = [{cos:?}, {sin:?}] }}
[actuators.x]
length = "guide"
[assembly]
x = 0.0
[loads]
weight = {{ gravity = [0, -{G:?}] }}
{loads}
{sections}
[motion]
{motion}
"#
    )
}

/// The times at which the motion begins to slide along a switch, and at which it leaves it.
fn sliding(run: &Run) -> [Vec<f64>; 2] {
    [true, false].map(|begins| {
        let of_kind = |event: &ContactEvent| match event {
            ContactEvent::Switch { t, sliding, .. } => (sliding.is_some() == begins).then_some(*t),
            ContactEvent::Friction { .. } | ContactEvent::Stop { .. } => None,
        };
        run.events.iter().filter_map(of_kind).collect()
    })
}

fn near(found: f64, expected: f64, allowed: f64) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    assert!(
        error <= allowed,
        "{found:?} is {error:.1e} from {expected:?}"
    );
}

/// A brake −F sign(v) stops a block on an incline at v/(g sin + F/m), holds it, and lets it go where a growing force
/// exceeds m g sin + F. A brake whose force is an expression with two switches does the same.
#[test]
fn a_brake_holds_a_block_until_a_force_exceeds_it() {
    let sin = 15f64.to_radians().sin();
    let force = 8.0;
    let stops = 3.0 / (G * sin + force / MASS);
    let released = (MASS * G * sin + force) / 4.0;
    for brake in [
        "-8*sign(x.velocity)",
        "if(x.velocity > 0, -8, 8)",
        "-4*sign(x.velocity) + 4*sign(-x.velocity)",
    ] {
        let loads = format!(
            r#"brake = {{ force = "block.A", direction = ALONG, magnitude = "{brake}" }}
push = {{ force = "block.A", direction = ALONG, magnitude = "if(t < 1, 0, 4*t)" }}"#
        );
        let text = block(15.0, &loads, "", "initial-velocity = 3.0\nduration = 5.0");
        for method in Method::ALL {
            let [rtol, allowed] = tolerance(method);
            let run = run(&text, method, rtol);
            let [held, left] = sliding(&run);
            assert!(
                !held.is_empty() && left.len() == 1,
                "{method:?} {:?}",
                run.events
            );
            println!(
                "{method:?} {:.1e} {:.1e}, {} evaluations",
                held[0] - stops,
                left[0] - released,
                run.evaluations
            );
            near(held[0], stops, allowed);
            near(left[0], released, 5e-11);
            let at_rest = run
                .steps
                .iter()
                .filter(|s| s.t > stops + 1e-7 && s.t < released - 1e-7);
            for step in at_rest {
                assert!(step.y[1].abs() < 1e-14, "{method:?} {step:?}");
                near(step.y[0], 1.5 * stops, allowed);
            }
            let after = 5.0 - released;
            near(run.end()[1], 2.0 * after * after / MASS, allowed);
            near(
                run.end()[0],
                1.5 * stops + 2.0 * after.powi(3) / (3.0 * MASS),
                allowed,
            );
            assert!(run.energy_error() < allowed, "{:e}", run.energy_error());
        }
    }
}

/// At rest from the start it stays exactly where it is.
#[test]
fn a_brake_holds_from_the_start() {
    let loads =
        r#"brake = { force = "block.A", direction = ALONG, magnitude = "-8*sign(x.velocity)" }"#;
    let text = block(15.0, loads, "", "duration = 5.0");
    for method in Method::ALL {
        let [rtol, _] = tolerance(method);
        let run = run(&text, method, rtol);
        assert!(
            run.end()[0].abs() < 1e-14 && run.end()[1].abs() < 1e-15,
            "{method:?} {:?}",
            run.end()
        );
        assert_eq!(run.steps[0].y[..2], [0.0, 0.0]);
    }
}

/// A belt whose speed is a function of time carries a block by a force of constant size: once it has the belt's speed, it keeps
/// it, until the belt accelerates more than the force can.
#[test]
fn a_block_follows_a_belt_whose_speed_varies() {
    let loads = r#"belt = { force = "block.A", direction = ALONG, magnitude = "-6*sign(x.velocity - 2*sin(t^2))" }"#;
    let text = block(0.0, loads, "", "duration = 2.0");
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let [held, leaves] = sliding(&run);
        println!(
            "{method:?} {held:?} {leaves:?} {} evaluations",
            run.evaluations
        );
        assert_eq!(held[0], 0.0, "{method:?}");
        for step in run.steps.iter().filter(|s| s.t < leaves[0]) {
            let speed = 2.0 * (step.t * step.t).sin();
            assert!(
                (step.y[1] - speed).abs() < allowed,
                "{method:?} {step:?} {speed}"
            );
        }
        // The belt brakes by 6/m there for the first time.
        let t = leaves[0];
        assert!(
            (4.0 * t * (t * t).cos() + 3.0).abs() < 1e-7,
            "{method:?} {t}"
        );
    }
}

/// A PI controller whose integral stops at its limit: the sum stays at the limit while the speed grows uniformly, until the error
/// is P a/I; before and behind it is a damped oscillation.
#[test]
fn a_controller_stays_at_its_limit_and_leaves_it() {
    let (p, i, limit) = (1.0_f64, 10.0_f64, 2.0_f64);
    let drives = format!(
        r#"[drives]
feed = {{ speed-controller = "x", speed = 1.0, proportional = {p:?}, integral = {i:?}, limit = {limit:?} }}"#
    );
    let text = block(0.0, "", &drives, "duration = 2.0");
    // m e″ + P e′ + I e = 0: e and e′ after a time.
    let (decay, natural) = (p / (2.0 * MASS), i / MASS);
    let omega = (natural - decay * decay).sqrt();
    let motion = |[e, rate]: [f64; 2], t: f64| {
        let (sin, cos) = (omega * t).sin_cos();
        let b = (rate + decay * e) / omega;
        let size = (-decay * t).exp();
        let value = size * (e * cos + b * sin);
        [value, -decay * value + size * omega * (b * cos - e * sin)]
    };
    let start = [1.0, -p / MASS];
    let (mut low, mut high) = (0.0, 0.5);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if motion(start, middle)[1] > -limit / MASS {
            low = middle;
        } else {
            high = middle;
        }
    }
    let acceleration = limit / MASS;
    let reaches = low;
    let last_error = p * acceleration / i;
    let leaves = reaches + (motion(start, reaches)[0] - last_error) / acceleration;
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let [held, left] = sliding(&run);
        println!(
            "{method:?} {held:?} {left:?} {} evaluations",
            run.evaluations
        );
        assert_eq!((held.len(), left.len()), (1, 1), "{method:?}");
        near(held[0], reaches, allowed);
        near(left[0], leaves, allowed);
        let [e, _] = motion([last_error, -acceleration], 2.0 - leaves);
        near(run.end()[1], 1.0 - e, 10.0 * allowed);
    }
}

/// A ball with a drag of constant size bounces on its floor, where its speed jumps to the other side of the switch.
#[test]
fn a_switch_of_the_speed_jumps_with_an_impact() {
    let loads =
        r#"drag = { force = "block.A", direction = ALONG, magnitude = "-4*sign(x.velocity)" }"#;
    let stops = "[stops]\nfloor = { coordinate = \"x\", min = -1.0, restitution = 0.5 }";
    let text = block(90.0, loads, stops, "duration = 1.0");
    let [down, up] = [G - 2.0, G + 2.0];
    let strikes = (2.0 / down).sqrt();
    let speed = 0.5 * down * strikes;
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let impacts = run.stops(|c| matches!(c, dwell_dynamics::StopChange::Impact { .. }));
        near(impacts[0], strikes, allowed);
        let rises = speed / up;
        let height = 0.5 * speed * rises;
        let second = strikes + rises + (2.0 * height / down).sqrt();
        if second < 1.0 {
            near(impacts[1], second, allowed);
        } else {
            let after = 1.0 - strikes - rises;
            near(run.end()[1], -down * after, allowed);
        }
        assert!(run.energy_error() < allowed, "{:e}", run.energy_error());
    }
}

/// Two brakes that hold at once are refused, by name and time.
#[test]
fn two_switches_that_hold_together_are_refused() {
    let text = r#"
[bodies.ground]
points = { A = [0, 0] }
[bodies.one]
points = { A = [0, 0] }
mass = 1.0
center = [0, 0]
[bodies.other]
points = { A = [0, 0] }
mass = 1.0
center = [0, 0]
[joints]
p = { prismatic = ["ground.A", "one.A"], axis = [1, 0] }
r = { prismatic = ["ground.A", "other.A"], axis = [1, 0] }
[actuators.x]
length = "p"
[actuators.z]
length = "r"
[assembly]
x = 0.0
z = 0.0
[loads]
first = { force = "one.A", direction = [1, 0], magnitude = "-2*sign(x.velocity)" }
second = { force = "other.A", direction = [1, 0], magnitude = "-2*sign(z.velocity)" }
[motion]
initial-velocity = { x = 1.0, z = 2.0 }
duration = 3.0
"#;
    for method in Method::ALL {
        let error = attempt(text, method, 1e-9);
        let Some(DynamicsError::SlidesOnSeveral { source_index: 0, t }) = error else {
            panic!("{method:?} {error:?}");
        };
        near(t, 1.0, 1e-6);
    }
}
