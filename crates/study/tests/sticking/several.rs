//! Several joints that stick at once: which of them hold, and when they let go.

use crate::{Run, holds, run, slides};
use dwell_dynamics::{ContactEvent, ContactMode, Method};

const G: f64 = 9.81;

/// A slider-crank with friction in all pins and its guide, under a couple on the crank.
pub(crate) fn slider_crank(couple: &str, motion: &str) -> String {
    format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.crank]
points = {{ A = [0, 0], B = [0.1, 0] }}
mass = 1.0
center = [0, 0]
inertia = 0.002
[bodies.rod]
points = {{ B = [0, 0], C = [0.3, 0] }}
mass = 0.5
center = [0.15, 0]
inertia = 0.004
[bodies.piston]
points = {{ C = [0, 0] }}
mass = 2.0
center = [0, 0]
[joints]
A = {{ revolute = ["ground.A", "crank.A"] }}
B = {{ revolute = ["crank.B", "rod.B"] }}
C = {{ revolute = ["rod.C", "piston.C"] }}
guide = {{ prismatic = ["ground.A", "piston.C"], axis = [1, 0] }}
[actuators.phi]
angle = ["ground", "crank"]
[assembly]
phi = 1.2
rod = -0.3
[loads]
weight = {{ gravity = [0, -{G:?}] }}
couple = {{ torque = ["ground", "crank"], magnitude = "{couple}" }}
[friction]
A = {{ coefficient = 0.2, radius = 0.02 }}
B = {{ coefficient = 0.2, radius = 0.02 }}
C = {{ coefficient = 0.2, radius = 0.01 }}
guide = {{ coefficient = 0.2 }}
[motion]
{motion}
"#
    )
}

/// All four joints hold at once, exactly at rest, until no shares of friction hold any more: where they let go, the
/// mechanism slides with the acceleration of zero, by the smooth friction of the same coefficient just beside.
#[test]
fn four_joints_let_go_together() {
    let text = slider_crank("t", "duration = 3.0");
    let mut first = Vec::new();
    for method in Method::ALL {
        let run = run(&text, method, 1e-11);
        let freed = run.times(slides);
        assert!(freed.len() >= 4, "{method:?} {:?}", run.events);
        let t = freed[0];
        assert!(freed[..4].iter().all(|f| *f == t), "{freed:?}");
        first.push(t);
        let held = run.steps.iter().filter(|s| s.t <= t);
        assert!(held.clone().all(|s| s.y[0] == 1.2 && s.y[1] == 0.0));
    }
    assert!(
        first.iter().all(|t| (t - first[0]).abs() < 1e-11 * 3.0),
        "{first:?}"
    );
    // The acceleration of the sliding mechanism is zero there: as the regularised friction has it at full strength.
    let smooth = |t: f64| {
        let couple = format!("{t:?}");
        let text = slider_crank(&couple, "initial-velocity = 1e-7\nduration = 1e-9").replace(
            "radius = 0.02",
            "radius = 0.02, regularization-speed = 1e-12",
        );
        let text = text.replace(
            "radius = 0.01",
            "radius = 0.01, regularization-speed = 1e-12",
        );
        let text = text.replace(
            "guide = { coefficient = 0.2",
            "guide = { coefficient = 0.2, regularization-speed = 1e-12",
        );
        acceleration(&text)
    };
    let (at, later) = (smooth(first[0]), smooth(first[0] + 0.01));
    assert!(at.abs() < 1e-8 * later.abs().max(1.0), "{at} {later}");
    assert!(later > 0.01);
}

/// The first acceleration of a scene.
fn acceleration(text: &str) -> f64 {
    let run = run(text, Method::Dop853, 1e-6);
    let mut workspace = run.machine.workspace();
    let start = &run.steps[0];
    let state = run.machine.evaluate(start.t, &start.y, &mut workspace);
    state.expect("a state").q_ddot()[0]
}

/// Thrown, it comes to rest in all joints at once, and the energy balance closes.
#[test]
fn a_thrown_slider_crank_comes_to_rest_in_all_joints() {
    let text = slider_crank("0", "initial-velocity = 8.0\nduration = 20.0");
    let mut ends = Vec::new();
    for method in [Method::Dop853, Method::Tsit45, Method::Bdf] {
        let run: Run = run(&text, method, 1e-12);
        let last = run.events.last().expect("events");
        let together: Vec<_> = run.events.iter().filter(|e| e.t() == last.t()).collect();
        assert_eq!(together.len(), 4, "{method:?} {together:?}");
        assert!(
            together
                .iter()
                .all(|e| matches!(e, ContactEvent::Friction { to, .. } if holds(*to)))
        );
        assert_eq!(run.end()[1], 0.0);
        println!(
            "{method:?} {} {:e} {}",
            last.t(),
            run.energy_error(),
            run.evaluations
        );
        assert!(run.energy_error() < 1e-9, "{:e}", run.energy_error());
        ends.push((last.t(), run.end()[0]));
    }
    for (t, q) in &ends {
        assert!(
            (t - ends[0].0).abs() < 1e-8 && (q - ends[0].1).abs() < 1e-8,
            "{ends:?}"
        );
    }
}

/// A double pendulum with friction in both pins, which hold and let go one by one: it ends at rest where both hold, and
/// the balance of energy closes over all events.
#[test]
fn a_double_pendulum_sticks_in_one_joint_and_in_both() {
    let text = format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.upper]
points = {{ A = [0, 0], B = [1, 0] }}
mass = 1.0
center = [0.5, 0]
inertia = 0.08
[bodies.lower]
points = {{ B = [0, 0] }}
mass = 1.0
center = [0.5, 0]
inertia = 0.08
[joints]
A = {{ revolute = ["ground.A", "upper.A"] }}
B = {{ revolute = ["upper.B", "lower.B"] }}
[actuators.p]
angle = ["ground", "upper"]
[actuators.r]
angle = ["upper", "lower"]
[assembly]
p = -1.0
r = 0.3
[loads]
weight = {{ gravity = [0, -{G:?}] }}
[friction]
A = {{ coefficient = 0.2, static-coefficient = 0.25, radius = 0.1 }}
B = {{ coefficient = 0.2, static-coefficient = 0.25, radius = 0.3 }}
[motion]
initial-velocity = {{ p = 3.0, r = 0.0 }}
duration = 30.0
"#
    );
    let run = run(&text, Method::Dop853, 1e-12);
    let of = |wanted: usize, is: fn(ContactMode) -> bool| {
        let is_it = |e: &&ContactEvent| match e {
            ContactEvent::Friction { load, to, .. } => *load == wanted && is(*to),
            ContactEvent::Stop { .. } | ContactEvent::Switch { .. } => false,
        };
        run.events.iter().filter(is_it).count()
    };
    println!("{} events {:e}", run.events.len(), run.energy_error());
    assert!(of(1, holds) >= 1 && of(2, holds) >= 2 && of(2, slides) >= 1);
    let last = run.steps.last().expect("steps");
    assert_eq!(&last.y[2..4], &[0.0, 0.0]);
    assert!(run.energy_error() < 1e-9, "{:e}", run.energy_error());
}

/// A wedge under a weight: a slider on an incline, driven through a strut. With tan α < µ it locks itself under any load,
/// although sliding has no solution there.
#[test]
fn a_self_locking_guide_holds_any_load() {
    // The load is applied far from the guide: it presses with 2 µ a / l > 1 times itself.
    for load in ["1", "1e4", "1e8*t"] {
        let text = format!(
            r#"
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.clamp]
points = {{ A = [0, 0], P = [0.3, 0] }}
mass = 1.0
center = [0, 0]
inertia = 0.01
[joints]
bar = {{ prismatic = ["ground.A", "clamp.A"], axis = [0, 1] }}
[actuators.y]
length = "bar"
[assembly]
y = 0.0
[loads]
screw = {{ force = "clamp.P", direction = [0, -1], magnitude = "{load}" }}
[friction]
bar = {{ coefficient = 0.2, guide-length = 0.05 }}
[motion]
duration = 2.0
"#
        );
        for method in Method::ALL {
            let run = run(&text, method, 1e-9);
            assert_eq!(run.end(), [0.0, 0.0], "{method:?} {load}");
            assert!(run.events.is_empty());
        }
    }
}
