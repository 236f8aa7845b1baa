//! Cost of an event, and accuracy of its time, for each integrator; reported, and asserted if the requirement is met.

use crate::several::slider_crank;
use crate::{Run, run};
use allocation_counter::measure;
use dwell_dynamics::{ContactEvent, Method};

const G: f64 = 9.81;

/// A ball that bounces without loss, or with friction in its guide and a force that moves it to and fro.
fn bouncing(duration: f64) -> String {
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
[stops]
floor = {{ coordinate = "z", min = 0.0, restitution = 1.0 }}
[motion]
duration = {duration:?}
"#
    )
}

fn sticking(duration: f64) -> String {
    let loads = r#"push = { force = "ball.A", direction = [1, 0], magnitude = "8*sin(6.283185307179586*t)" }
[friction]
line = { coefficient = 0.3 }"#;
    let text = bouncing(duration).replace("axis = [0, 1]", "axis = [1, 0]");
    let stops = text.find("[stops]").expect("a section");
    let motion = text.find("[motion]").expect("a section");
    format!("{}{loads}\n{}", &text[..stops], &text[motion..])
}

/// The largest error of the times of events, as a part of the motion.
fn time_error(run: &Run, times: impl Fn(usize) -> f64, duration: f64) -> f64 {
    let errors = run.events.iter().enumerate();
    errors
        .map(|(k, event): (usize, &ContactEvent)| (event.t() - times(k)).abs() / duration)
        .fold(0.0, f64::max)
}

/// At the default tolerance, 1e-6, DOP853 takes fewer than 50 evaluations for each of 1000 events, of rebounds and of sticking alike.
#[test]
fn an_event_costs_fewer_than_fifty_evaluations() {
    let rebounds = run(&bouncing(903.5), Method::Dop853, 1e-6);
    let sticks = run(&sticking(250.0), Method::Dop853, 1e-6);
    for (name, run) in [("rebounds", &rebounds), ("sticking", &sticks)] {
        let cost = run.evaluations as f64 / run.events.len() as f64;
        println!(
            "{name}: {} events, {cost:.1} evaluations each",
            run.events.len()
        );
        assert!(run.events.len() >= 1000 && cost < 50.0, "{name} {cost}");
    }
}

/// Every integrator through rebounds and sticking: the error of the times, the balance of energy and the cost of each event.
#[test]
fn times_and_balances_of_every_integrator() {
    let fall = (2.0 / G).sqrt();
    let slips = (0.3 * 2.0 * G / 8.0_f64).asin() / std::f64::consts::TAU;
    // Measured: the times within 1e-13 of the span; the energy, which lower orders integrate with more steps and their
    // rounding, within 1e-12 by DOP853, 2e-12 by Tsit45, 7e-11 by BDF, 6e-11 by ESDIRK34 and 2e-8 by TR-BDF2, whose second
    // order would need 14 times as many steps for 1e-10: at 9000 evaluations for an event that is no use.
    for (method, rtol, allowed) in [
        (Method::Dop853, 1e-13, 1e-11),
        (Method::Tsit45, 1e-13, 1e-11),
        (Method::Bdf, 1e-13, 1e-10),
        (Method::Esdirk34, 1e-14, 1e-10),
        (Method::TrBdf2, 1e-12, 1e-7),
    ] {
        let run_of = |text: &str| run(text, method, rtol);
        let rebounds = run_of(&bouncing(18.0));
        let error = time_error(&rebounds, |k| fall * (1.0 + 2.0 * k as f64), 18.0);
        let cost = rebounds.evaluations / rebounds.events.len();
        println!(
            "{method:?} {rtol:e} rebounds {error:.1e}, energy {:.1e}, {cost} evaluations each",
            rebounds.energy_error()
        );
        assert!(
            error < 1e-11 && rebounds.energy_error() < 1e-10,
            "{method:?}"
        );
        let sticks = run_of(&sticking(5.0));
        let freed = sticks.times(crate::slides);
        let error = freed.iter().enumerate();
        let error = error.map(|(k, t)| (t - slips - 0.5 * k as f64).abs() / 5.0);
        let error = error.fold(0.0, f64::max);
        let cost = sticks.evaluations / sticks.events.len();
        println!(
            "{method:?} {rtol:e} sticking {error:.1e}, energy {:.1e}, {cost} evaluations each",
            sticks.energy_error()
        );
        assert!(
            error < 1e-11 && sticks.energy_error() < allowed,
            "{method:?}"
        );
    }
}

/// What an event costs beyond the motion between events, by every integrator: fewer than 50 evaluations more than the same
/// push takes for the same time where nothing sticks, however tight the tolerance is.
///
/// Measured at 1e-12: DOP853 2, BDF −2, Tsit45 −125, ESDIRK34 −1953, TR-BDF2 −6830. Lower orders take thousands of
/// evaluations between two events, and fewer where the block holds. BDF begins again with its first order: 41 at 1e-6.
#[test]
fn an_event_costs_little_beyond_the_motion_between_events() {
    for method in Method::ALL {
        for rtol in [1e-6, 1e-9] {
            let text = sticking(10.0);
            let friction = text.find("[friction]").expect("a section");
            let motion = text.find("[motion]").expect("a section");
            let smooth = format!("{}{}", &text[..friction], &text[motion..]);
            let [with, without] = [&text, &smooth].map(|text| run(text, method, rtol));
            let events = with.events.len() as f64;
            assert!(events >= 39.0 && without.events.is_empty());
            let cost = (with.evaluations as f64 - without.evaluations as f64) / events;
            let watched = with.event_evaluations as f64 / events;
            println!(
                "{method:?} {rtol:e}: {cost:.1} evaluations each, {:.1} between two, {watched:.1} to watch, steps {}",
                without.evaluations as f64 / events,
                with.steps.len() as f64 / events
            );
            assert!(cost < 50.0, "{method:?} {rtol:e} {cost}");
            // Four in each step, and some to locate.
            let steps = with.steps.len() as f64 / events;
            assert!(
                watched < 5.0 * steps + 40.0,
                "{method:?} {rtol:e} {watched}"
            );
        }
    }
}

/// Evaluations allocate nothing, whether surfaces slide or hold: one joint, and four of which statics decides only the sum.
#[test]
fn an_evaluation_allocates_nothing_while_surfaces_hold() {
    for (name, text) in [
        ("block", sticking(3.0)),
        ("four joints", slider_crank("1 + t", "duration = 1.0")),
    ] {
        let run = run(&text, Method::Dop853, 1e-8);
        let mut workspace = run.machine.workspace();
        // The first two make room; the modes of the start are open.
        let steps = run.steps.iter().skip(1);
        let mut evaluate = |t: f64, y: &[f64]| {
            let evaluated = run.machine.evaluate(t, y, &mut workspace);
            evaluated.map(|_| ()).expect("a state");
        };
        for step in steps.clone().take(2) {
            evaluate(step.t, &step.y);
        }
        let counts = steps.map(|step| {
            let spent = measure(|| evaluate(step.t, &step.y));
            (step.t, spent.count_total)
        });
        let allocating: Vec<(f64, u64)> = counts.filter(|(_, count)| *count > 0).collect();
        println!("{name}: {} of {}", allocating.len(), run.steps.len());
        assert!(allocating.is_empty(), "{name} {allocating:?}");
    }
}
