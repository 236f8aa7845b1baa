//! Loads as functions of a program, with jumps: against the same loads as expressions, and without their breakpoints.
#![allow(clippy::unwrap_used, reason = "a test")]

use dwell::{
    Actuator, Coordinate, Drive, Error, Joint, Load, Magnitude, Mechanism, Method, Motion,
    MotionResults, Solver,
};
use std::time::{Duration, Instant};

/// A run that does not end is noticed by this time, also on a machine that does much else: each takes less than 5 s of one processor.
const GUARD: Duration = Duration::from_secs(60);

/// A shaper: a crank with its pin in the slot of a rocker, which a link joins to the ram; the load acts on the forward stroke.
fn shaper(cut: impl Into<Magnitude>, duration: f64) -> Result<Mechanism, Error> {
    let mut m = Mechanism::builder("Shaper");
    m.ground()
        .point("O", [0.0, 0.0])
        .point("P", [0.0, -0.25])
        .point("G", [0.0, 0.33]);
    m.body("crank").bar("O", "A", 0.1).mass(3.0, "O", 0.05);
    let rocker = m.body("rocker").bar("P", "B", 0.6);
    rocker.mass(5.0, [0.3, 0.0], 0.15);
    let link = m.body("link").bar("B", "C", 0.3);
    link.mass(1.0, [0.15, 0.0], 0.008);
    m.body("ram").point("C", [0.0, 0.0]).mass(40.0, "C", 0.0);
    m.pin("O", "ground", "crank").pin("P", "ground", "rocker");
    m.joint("A", Joint::slot("rocker.P", "crank.A", [1.0, 0.0]));
    m.pin("B", "rocker", "link").pin("C", "link", "ram");
    m.joint("guide", Joint::prismatic("ground.G", "ram.C", [1.0, 0.0]));
    m.actuator("phi", Actuator::angle("ground", "crank"));
    m.coordinate("x", Coordinate::travel("guide"));
    m.assembly("phi", 0.0)
        .assembly("rocker", 1.2)
        .assembly("link", 0.0);
    m.load("cut", Load::force("ram.C", [1.0, 0.0], cut));
    m.load("weight", Load::gravity([0.0, -9.81]));
    let motor = Drive::motor_line("phi", 3.0, 160.0).with("gear-ratio", 20.0);
    m.drive("motor", motor.with("inertia", 0.002));
    m.motion(Motion::seconds(duration).initial_velocity("phi", 6.0));
    m.assemble()
}

fn cut() -> Magnitude {
    Magnitude::function(&["x.velocity"], |s| if s[0] < -0.02 { 1500.0 } else { 0.0 })
}

/// The largest difference of two motions in a column, as a part of its largest value.
fn difference(one: &MotionResults, other: &MotionResults, column: &str) -> f64 {
    let [one, other] = [one, other].map(|motion| motion.column(column).unwrap());
    assert_eq!(one.len(), other.len());
    let largest = one.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
    let pairs = one.iter().zip(&other);
    pairs.fold(0.0_f64, |max, (a, b)| max.max((a - b).abs())) / largest
}

#[test]
fn a_jump_that_is_named_is_the_switch_of_the_expression() {
    let solver = Solver::accuracy(1e-6).sample_interval(0.01);
    let text = "if(x.velocity < -0.02, 1500, 0)";
    let expected = shaper(text, 3.0).unwrap().simulate(&solver).unwrap();
    let begin = Instant::now();
    let named = cut().breakpoints("x.velocity", &[-0.02]);
    let found = shaper(named, 3.0).unwrap().simulate(&solver).unwrap();
    assert!(begin.elapsed() < GUARD, "{:?}", begin.elapsed());
    assert!(found.early_stop.is_none(), "{:?}", found.early_stop);
    for column in ["phi", "phi.velocity", "x", "O.magnitude", "cut.load_force"] {
        let error = difference(&expected, &found, column);
        assert!(error < 1e-12, "{column}: {error:.1e}");
    }
}

#[test]
fn a_jump_that_is_not_named_ends_the_motion_with_the_name_of_the_load() {
    let solvers = Method::ALL.map(|method| Solver::method(method, 1e-10));
    for solver in solvers.into_iter().chain([Solver::accuracy(1e-6)]) {
        let begin = Instant::now();
        let motion = shaper(cut(), 3.0).unwrap().simulate(&solver).unwrap();
        let (time, error) = (begin.elapsed(), motion.early_stop);
        println!("{solver:?}: {time:?} {error:?}");
        assert!(time < GUARD, "{solver:?} {time:?}");
        if let Some(error) = error {
            assert!(
                error.to_string().contains("load `cut`"),
                "{solver:?} {error}"
            );
        }
    }
}

/// A number drawn at random from one to another, with two decimals.
fn draw(random: &mut u64, low: f64, high: f64) -> f64 {
    *random = random
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1);
    let part = (*random >> 33) as f64 / 2_f64.powi(31);
    ((low + part * (high - low)) * 100.0).round() / 100.0
}

/// A block on a guide under a load.
fn block(load: Magnitude, velocity: f64) -> Mechanism {
    let mut m = Mechanism::builder("Block");
    m.ground().point("A", [0.0, 0.0]);
    m.body("block").point("A", [0.0, 0.0]).mass(1.3, "A", 0.0);
    m.joint("guide", Joint::prismatic("ground.A", "block.A", [1.0, 0.0]));
    m.actuator("x", Actuator::travel("guide"));
    m.assembly("x", 0.0);
    m.load("load", Load::force("block.A", [1.0, 0.0], load));
    m.load(
        "spring",
        Load::force("block.A", [1.0, 0.0], "-3*x - 0.2*x.velocity"),
    );
    m.motion(Motion::seconds(4.0).initial_velocity("x", velocity));
    m.assemble().unwrap()
}

/// Jumps of a function of time, travel and speed, drawn at random, one of each: the motion is that of the expression.
#[test]
fn random_jumps_that_are_named_are_those_of_the_expression() {
    for seed in 0..24 {
        let mut random = 2 * seed + 1;
        for _ in 0..4 {
            draw(&mut random, 0.0, 1.0);
        }
        let at = [(0.2, 3.8), (-0.6, 0.6), (-0.8, 0.8)].map(|(a, b)| draw(&mut random, a, b));
        let size = [(); 6].map(|()| draw(&mut random, -4.0, 4.0));
        let signals = ["t", "x", "x.velocity"];
        let terms = (0..3).map(|k| {
            let [low, high] = [size[2 * k], size[2 * k + 1]];
            format!("if({} < {:?}, {low:?}, {high:?})", signals[k], at[k])
        });
        let text = terms.collect::<Vec<_>>().join(" + ");
        let function = move |s: &[f64]| {
            let term = |k: usize| {
                if s[k] < at[k] {
                    size[2 * k]
                } else {
                    size[2 * k + 1]
                }
            };
            term(0) + term(1) + term(2)
        };
        let mut named = Magnitude::function(&signals, function);
        for (signal, at) in signals.iter().zip(at) {
            named = named.breakpoints(signal, &[at]);
        }
        let velocity = draw(&mut random, -1.5, 1.5);
        for method in [Method::Bdf, Method::Dop853, Method::Tsit45] {
            let solver = Solver::method(method, 1e-10);
            let [expected, found] = [Magnitude::from(&text[..]), named.clone()]
                .map(|load| block(load, velocity).simulate(&solver).unwrap());
            let ended = |motion: &MotionResults| motion.early_stop.as_ref().map(Error::to_string);
            assert_eq!(ended(&expected), ended(&found), "{seed} {text}");
            for column in ["x", "x.velocity", "load.load_force"] {
                let error = difference(&expected, &found, column);
                // At a tolerance of 1e-10: 1.3e-11 was seen where a motion slides along one switch while another switches.
                assert!(
                    error < 1e-10,
                    "{seed} {method:?} {column} {error:.1e}: {text}"
                );
            }
        }
    }
}
