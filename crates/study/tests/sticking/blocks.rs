//! A block in a guide: its normal force is its weight, so that friction is a constant.

use crate::{Run, holds, run, slides, tolerance};
use dwell_dynamics::Method;

const G: f64 = 9.81;

/// A block of 2 kg on an incline (degrees), with further keys of friction, loads and motion.
fn block(incline: f64, friction: &str, loads: &str, motion: &str) -> String {
    let (sin, cos) = incline.to_radians().sin_cos();
    format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.block]
points = {{ A = [0, 0] }}
mass = 2.0
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
[friction]
guide = {{ coefficient = 0.3, {friction} }}
[motion]
{motion}
"#
    )
}

fn near(found: f64, expected: f64, allowed: f64) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    assert!(
        error <= allowed,
        "{found:?} is {error:.1e} from {expected:?}"
    );
}

/// Pushed up an incline at 3 m/s it stops after v/(g (sin + µ cos)), and stays where tan < µₛ: exactly.
#[test]
fn a_block_pushed_up_a_gentle_incline_stays() {
    let (sin, cos) = 15f64.to_radians().sin_cos();
    let text = block(15.0, "", "", "initial-velocity = 3.0\nduration = 5.0");
    let deceleration = G * (sin + 0.3 * cos);
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let stops = run.times(holds);
        assert_eq!((stops.len(), run.events.len()), (1, 1), "{method:?}");
        near(
            stops[0],
            3.0 / deceleration,
            allowed.min(5.0 * 1e-11 * 100.0),
        );
        let [x, v] = run.end();
        near(x, 4.5 / deceleration, allowed);
        assert_eq!(v, 0.0);
        let after = run.steps.iter().filter(|s| s.t > stops[0]);
        assert!(after.clone().count() > 0 && after.clone().all(|s| s.y[0] == x && s.y[1] == 0.0));
        assert!(run.energy_error() < allowed, "{:e}", run.energy_error());
    }
}

/// On a steep one it slides back at once, with less friction than on its way up.
#[test]
fn a_block_on_a_steep_incline_slides_back() {
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let text = block(
        30.0,
        "static-coefficient = 0.4",
        "",
        "initial-velocity = 3.0\nduration = 2.0",
    );
    let [up, down] = [G * (sin + 0.3 * cos), G * (sin - 0.3 * cos)];
    let turn = 3.0 / up;
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        assert_eq!(run.events.len(), 1, "{method:?} {:?}", run.events);
        near(run.events[0].t(), turn, allowed);
        let [x, v] = run.end();
        near(v, -down * (2.0 - turn), allowed);
        near(
            x,
            4.5 / up - 0.5 * down * (2.0 - turn) * (2.0 - turn),
            allowed,
        );
        assert!(run.energy_error() < allowed);
    }
}

/// The static limit alone decides whether it holds: tan 20° = 0.364 lies between both coefficients.
#[test]
fn between_both_coefficients_a_block_at_rest_stays_and_a_moving_one_goes_on() {
    let friction = "static-coefficient = 0.4";
    let (sin, cos) = 20f64.to_radians().sin_cos();
    let at_rest = run(
        &block(20.0, friction, "", "duration = 3.0"),
        Method::Dop853,
        1e-12,
    );
    assert_eq!(at_rest.end(), [0.0, 0.0]);
    let moving = block(
        20.0,
        friction,
        "",
        "initial-velocity = -1.0\nduration = 3.0",
    );
    let moving = run(&moving, Method::Dop853, 1e-12);
    near(moving.end()[1], -1.0 - G * (sin - 0.3 * cos) * 3.0, 1e-10);
    assert!(moving.events.is_empty());
    // Without the key the static coefficient is the kinetic one.
    let slides = run(
        &block(20.0, "", "", "duration = 3.0"),
        Method::Dop853,
        1e-12,
    );
    near(slides.end()[1], -G * (sin - 0.3 * cos) * 3.0, 1e-10);
}

/// A force that grows by 4 N/s lets a block go at µₛ m g; then µ m g brakes it.
#[test]
fn a_growing_force_lets_go_at_the_static_limit() {
    let loads = r#"push = { force = "block.A", direction = [1, 0], magnitude = "4*t" }"#;
    let text = block(0.0, "static-coefficient = 0.5", loads, "duration = 4.0");
    let released = 0.5 * 2.0 * G / 4.0;
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let times = run.times(slides);
        assert_eq!(
            (times.len(), run.events.len()),
            (1, 1),
            "{method:?} {:?}",
            run.events
        );
        near(times[0], released, 4.0 * 1e-11);
        let brake = 0.3 * 2.0 * G;
        let speed = |t: f64| (2.0 * t * t - brake * t) / 2.0;
        near(run.end()[1], speed(4.0) - speed(released), allowed);
    }
}

/// A block on a moving belt by a spring: it sticks until the spring pulls with µₛ m g, and slips as an oscillator about the
/// sliding force until it has the speed of the belt again. All times follow in closed form.
#[test]
fn stick_slip_on_a_belt_has_its_period() {
    let (m, k, v, mu, mu_s) = (2.0_f64, 50.0_f64, 0.1, 0.3, 0.5);
    let text = format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0], W = [-1, 0] }}
[bodies.belt]
points = {{ A = [0, 0] }}
mass = 1.0
center = [0, 0]
[bodies.block]
points = {{ A = [0, 0] }}
mass = {m:?}
center = [0, 0]
[joints]
track = {{ prismatic = ["ground.A", "belt.A"], axis = [1, 0] }}
top = {{ prismatic = ["belt.A", "block.A"], axis = [1, 0] }}
[actuators.s]
length = "track"
[actuators.u]
length = "top"
[assembly]
s = 0.0
u = 0.0
[loads]
weight = {{ gravity = [0, -{G:?}] }}
spring = {{ spring = ["ground.W", "block.A"], stiffness = {k:?}, free-length = 1.0 }}
[friction]
top = {{ coefficient = {mu:?}, static-coefficient = {mu_s:?} }}
[motion]
duration = 40.0
[motion.prescribed]
s = {{ speed = {v:?} }}
"#
    );
    let omega = (k / m).sqrt();
    let slip_start = mu_s * m * G / k;
    let centre = mu * m * G / k;
    // x − centre = a cos ωt + (v/ω) sin ωt with a = slip_start − centre; the speed is v again at tan(ωt/2) = −aω/v.
    let slip = 2.0 * (std::f64::consts::PI - (omega * (slip_start - centre) / v).atan()) / omega;
    let stick = 2.0 * (slip_start - centre) / v;
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let (freed, held) = (run.times(slides), run.times(holds));
        println!(
            "{method:?}: {} events, {} evaluations",
            run.events.len(),
            run.evaluations
        );
        near(freed[0], slip_start / v, allowed);
        assert!(freed.len() > 8);
        for (n, (freed, held)) in freed.iter().zip(&held).enumerate() {
            let begins = slip_start / v + n as f64 * (slip + stick);
            near(*freed, begins, 40.0 * allowed);
            near(*held, begins + slip, 40.0 * allowed);
        }
        assert!(
            run.energy_error() < 40.0 * allowed,
            "{:e}",
            run.energy_error()
        );
    }
}

/// A harmonic force on a block that sticks at each turn: a thousand events, with the energy balance closed and few
/// evaluations for each.
#[test]
fn a_thousand_events_cost_little_and_close_the_balance() {
    let loads = r#"push = { force = "block.A", direction = [1, 0], magnitude = "8*sin(6.283185307179586*t)" }"#;
    let text = block(0.0, "", loads, "duration = 250.0");
    let run: Run = run(&text, Method::Dop853, 1e-12);
    let (held, freed) = (run.times(holds), run.times(slides));
    println!(
        "{} held, {} freed, {} evaluations, {:e}",
        held.len(),
        freed.len(),
        run.evaluations,
        run.energy_error()
    );
    assert_eq!((held.len(), freed.len()), (500, 500));
    // Measured: 98 for each at this tolerance, 26 at the default one (`costs`).
    assert!(run.evaluations < 110 * 1000);
    assert!(run.energy_error() < 1e-10);
    // The first time is arcsin(µ m g/8)/2π, the others follow half periods apart.
    let first = (0.3 * 2.0 * G / 8.0_f64).asin() / std::f64::consts::TAU;
    for (k, t) in freed.iter().enumerate() {
        near(*t, first + 0.5 * k as f64, 250.0 * 1e-11);
    }
}
