//! Loads and drives that switch as the coordinate and the speed of a wheel move, against closed forms: each is met on
//! the way, located, and passed with the error of a smooth motion.
#![allow(clippy::expect_used, clippy::panic, reason = "tests")]

mod parts;

use dwell_dynamics::{
    ContactEvent, Machine, Method, OdeState, Options, Solution, TabulatedMachine, solve,
    solve_system,
};
use dwell_kinetostatics::{Drive, DriveKind, Magnitude, Signal, SpeedController, TableDomain};
use dwell_laws::{Expression, Interpolation, Law, Spline};
use parts::{INERTIA, angle, end_state, error_ratio, wheel};

/// A couple as a function of angle, speed and time.
fn couple(text: &str) -> Magnitude {
    let expression = Expression::parse(text, &["q", "v", "t"]).expect(text);
    let coordinate = angle([0, 1]).coordinate();
    let signals = [
        Signal::Value(coordinate),
        Signal::Velocity(coordinate),
        Signal::Time,
    ];
    Magnitude::Expression(expression, signals.into())
}

fn run(machine: &Machine, speed: f64, end: f64, options: &Options) -> Solution {
    let start = OdeState {
        t: 0.0,
        y: machine.initial_state(&[0.0], &[speed]),
    };
    solve(machine, machine.model(), &start, end, options, &[]).expect("a start")
}

/// The end state by every method at three tolerances is `expected`, where errors grow by a factor.
fn check(machine: &Machine, speed: f64, end: f64, expected: [f64; 2], growth: f64) {
    for method in Method::ALL {
        for exponent in [-5, -8, -11] {
            let options = Options::new(method, 10_f64.powi(exponent));
            let solution = run(machine, speed, end, &options);
            let found = end_state(&solution);
            let allowed = growth * error_ratio(method) * options.rtol + 1e-13;
            for (found, expected) in found.into_iter().zip(expected) {
                let error = (found - expected).abs();
                assert!(
                    error <= allowed * expected.abs().max(1.0),
                    "{method:?} 1e{exponent}: {found} {expected}, {:.1} tolerances, {} steps",
                    error / options.rtol,
                    solution.statistics.steps
                );
            }
        }
    }
}

/// A stop of stiffness k is met at a speed v: half a period later the wheel leaves it with −v.
#[test]
fn an_elastic_stop_returns_the_speed() {
    let (stiffness, speed) = (5e4, 3.0);
    let machine = wheel(couple("if(q > 1, -5e4*(q - 1), 0)"), &[]);
    let contact = std::f64::consts::PI * (INERTIA / stiffness).sqrt();
    let end = 2.0;
    let angle = 1.0 - speed * (end - 1.0 / speed - contact);
    // In the stop the phase turns by half a revolution in 20 ms.
    check(&machine, speed, end, [angle, -speed], 30.0);
}

/// A bump of work W on a millionth of the way: ½ J v² grows by W. No step sees it by chance.
#[test]
fn a_narrow_bump_on_the_way_is_met() {
    for (text, ramp) in [
        ("if(abs(q - 1) < 5e-7, 5e5, 0)", 0.0),
        ("if((q - 1)^2 < 2.5e-13, 5e5, 0)", 0.0),
        ("5e5*(step(q - 1 + 5e-7) - step(q - 1 - 5e-7))", 0.0),
        ("5e5*max(0, min(1, 1e10*(5e-7 - abs(q - 1))))", 1e-10),
        ("clamp(1e15*(5e-7 - abs(q - 1)), 0, 5e5)", 5e-10),
    ] {
        let work = 5e5 * (1e-6 - ramp);
        let machine = wheel(couple(text), &[]);
        let speed = (1.0 + 2.0 * work / INERTIA).sqrt();
        let end = 3.0;
        println!("{text}");
        // Its edges lie within 1e-10 of its width by the rounding of the angle. BDF begins anew thrice in 1e-6 s: 1100
        // tolerances, the others below 200.
        check(&machine, 1.0, end, [1.0 + speed * (end - 1.0), speed], 20.0);
    }
}

/// The couple 4 up to speed 2, then −1 up to −∞: two uniform accelerations.
#[test]
fn a_switch_of_the_speed_is_located() {
    let machine = wheel(couple("if(t < 5, if(v < 2, 4, 1), if(v > 1, -4, -1))"), &[]);
    // 2 rad/s at 1 s; 4 rad/s at 5 s; 1 rad/s at 6.5 s.
    let angle = 1.0 + (2.0 * 4.0 + 0.25 * 16.0) + (4.0 * 1.5 - 2.25) + (1.0 - 0.25);
    check(&machine, 0.0, 7.5, [angle, 0.5], 1.0);
}

/// A staircase of couples, one more each 0.1 rad: the work is a sum.
#[test]
fn every_stair_is_met() {
    let machine = wheel(couple("0.2*floor(q/0.1)"), &[]);
    let (mut q, mut v, mut t) = (0.0, 1.0_f64, 0.0);
    for stair in 0..30 {
        let acceleration = 0.2 * f64::from(stair) / INERTIA;
        let next = (v * v + 0.2 * acceleration).sqrt();
        t += 0.2 / (v + next);
        (q, v) = (q + 0.1, next);
    }
    let machine_end = t;
    check(&machine, 1.0, machine_end, [q, v], 2.0);
    // A table of the angle in straight lines and one in steps.
    let points: Vec<[f64; 2]> = (0..=30)
        .map(|k| [0.1 * f64::from(k), 0.2 * f64::from(k)])
        .collect();
    let curve = Spline::interpolating(&points, Interpolation::Step).expect("a curve");
    let signal = Signal::Value(angle([0, 1]).coordinate());
    let stepped = wheel(Magnitude::Law(signal, Law::Spline(curve)), &[]);
    check(&stepped, 1.0, machine_end, [q, v], 2.0);
}

/// From rest on a jump of a table with steps, downwards and upwards: the direction of the motion decides which couple
/// acts.
#[test]
fn an_angle_at_rest_on_a_point_of_a_table_is_decided_as_it_moves() {
    for [below, above] in [[-1.0, -2.0], [2.0, 1.0]] {
        let points = [[-50.0, below], [0.5, above], [50.0, above]];
        let curve = Spline::interpolating(&points, Interpolation::Step).expect("a curve");
        let signal = Signal::Value(angle([0, 1]).coordinate());
        let machine = wheel(Magnitude::Law(signal, Law::Spline(curve)), &[]);
        let couple = if above < 0.0 { below } else { above };
        let acceleration = couple / INERTIA;
        for method in Method::ALL {
            let y = machine.initial_state(&[0.5], &[0.0]);
            let (start, options) = (OdeState { t: 0.0, y }, Options::new(method, 1e-11));
            let solution = solve(&machine, machine.model(), &start, 0.5, &options, &[]);
            let [_, speed] = end_state(&solution.expect("a start"));
            // Of a constant acceleration; the couple above, for the time of a rounding of the angle, would change it by 1e-8.
            let error = (speed / (0.5 * acceleration) - 1.0).abs();
            assert!(error < 1e-11, "{method:?}: {error:e}");
        }
    }
}

/// A switch of angle and time together: the couple acts while the wheel is behind a hand that turns uniformly.
#[test]
fn a_switch_of_angle_and_time_is_located() {
    let machine = wheel(couple("if(q < t, 2, -2)"), &[]);
    // From rest: q = t²/2 meets t at 2 s with speed 2; then q̈ = −1: behind again at 4 s with speed 0.
    check(&machine, 0.0, 3.0, [2.0 + 2.0 - 0.5, 1.0], 1.0);
    check(&machine, 0.0, 5.0, [4.0 + 0.5, 1.0], 1.0);
}

/// A brake of constant couple stops the wheel, and holds it.
#[test]
fn a_brake_stops_the_wheel() {
    let machine = wheel(couple("-3*sign(v)"), &[]);
    let (speed, deceleration) = (2.0, 3.0 / INERTIA);
    let angle = speed * speed / (2.0 * deceleration);
    for (method, end) in [(Method::Dop853, 1.3), (Method::Tsit45, 1.33)] {
        let options = Options::new(method, 1e-8);
        let [q, v] = end_state(&run(&machine, speed, end, &options));
        let left = speed - deceleration * end;
        assert!((v - left).abs() < 1e-10, "{v} {left}");
        assert!(
            (q - (angle - 0.5 * left * left / deceleration)).abs() < 1e-10,
            "{q}"
        );
    }
}

/// If the brake holds the wheel, the wheel rests, after few steps.
#[test]
fn a_brake_at_rest_holds() {
    let machine = wheel(couple("-3*sign(v)"), &[]);
    for method in Method::ALL {
        let solution = run(&machine, 2.0, 3.0, &Options::new(method, 1e-8));
        assert_eq!(solution.error, None, "{method:?}");
        let last = solution.steps.last().expect("steps");
        let [q, v] = [last.y[0], last.y[1]];
        assert!(
            (q - 4.0 / 3.0).abs() < 1e-6 && v.abs() < 1e-14,
            "{method:?} {last:?}"
        );
        assert!(solution.statistics.steps < 2000);
    }
}

/// A speed controller at its limit accelerates uniformly; below it the error decays.
#[test]
fn a_controller_leaves_its_limit() {
    let (gain, limit, wanted) = (10.0, 4.0, 3.0);
    let controller = |integral_gain| Drive {
        name: "controller".into(),
        coordinate: angle([0, 1]).coordinate(),
        kind: DriveKind::SpeedController(SpeedController {
            reference_speed: Magnitude::Constant(wanted),
            proportional_gain: gain,
            integral_gain,
            limit,
        }),
    };
    let machine = wheel(couple("0*q"), &[controller(0.0)]);
    let acceleration = limit / INERTIA;
    let error = limit / gain;
    let leaves = (wanted - error) / acceleration;
    let (rate, end) = (gain / INERTIA, 2.0);
    let decay = (-rate * (end - leaves)).exp();
    let speed = wanted - error * decay;
    let angle = 0.5 * acceleration * leaves * leaves + wanted * (end - leaves)
        - error / rate * (1.0 - decay);
    check(&machine, 0.0, end, [angle, speed], 1.0);
}

/// The table of a machine switches as the machine does.
#[test]
fn a_table_meets_the_same_switches() {
    let machine = wheel(couple("if(abs(q - 1) < 5e-7, 5e5, 0) - 0.1*v"), &[]);
    let table = TabulatedMachine::new(&machine, 1e-10, TableDomain::Between(-1.0, 5.0));
    let table = table.expect("a table");
    let start = OdeState {
        t: 0.0,
        y: machine.initial_state(&[0.0], &[1.0]),
    };
    let options = Options::new(Method::Dop853, 1e-10);
    let exact = end_state(&run(&machine, 1.0, 3.0, &options));
    let mut ode = table.ode(0.0, &start.y, 0.0).expect("a start");
    let outputs = dwell_dynamics::ObservedMachine::new(&machine, machine.model());
    let solution = solve_system(&mut ode, outputs, &start, Some(3.0), &options, &[]);
    let found = end_state(&solution.expect("a start"));
    for (found, exact) in found.into_iter().zip(exact) {
        assert!((found - exact).abs() < 1e-8, "{found} {exact}");
    }
}

/// The table of a machine slides along a switch as the machine does: a brake holds the wheel until a growing couple exceeds
/// it.
#[test]
fn a_table_slides_along_the_same_switch() {
    let machine = wheel(couple("-3*sign(v) + if(t < 1.5, 0, 2*t - 1)"), &[]);
    let table = TabulatedMachine::new(&machine, 1e-10, TableDomain::Between(-1.0, 5.0));
    let table = table.expect("a table");
    let start = OdeState {
        t: 0.0,
        y: machine.initial_state(&[0.0], &[2.0]),
    };
    for method in Method::ALL {
        let options = Options::new(method, 1e-10);
        let exact = run(&machine, 2.0, 2.5, &options);
        let mut ode = table.ode(0.0, &start.y, 0.0).expect("a start");
        let outputs = dwell_dynamics::ObservedMachine::new(&machine, machine.model());
        let solution = solve_system(&mut ode, outputs, &start, Some(2.5), &options, &[]);
        let mut solution = solution.expect("a start").completed().expect("a motion");
        solution.add_contact_events(ode.take_contact_events());
        let times =
            |of: &Solution| -> Vec<f64> { of.contact_events.iter().map(ContactEvent::t).collect() };
        let (found, expected) = (times(&solution), times(&exact));
        assert_eq!(
            found.len(),
            expected.len(),
            "{method:?} {found:?} {expected:?}"
        );
        // It stops where the brake has used up its kinetic energy, and goes on where the couple is that of the brake.
        assert!(found.len() >= 2, "{method:?} {found:?}");
        for (found, expected) in found.iter().zip(&expected) {
            assert!(
                (found - expected).abs() < 1e-8,
                "{method:?} {found} {expected}"
            );
        }
        for (found, exact) in end_state(&solution).into_iter().zip(end_state(&exact)) {
            assert!((found - exact).abs() < 1e-8, "{method:?} {found} {exact}");
        }
    }
}

/// Beyond its piece a function need not be defined: the root of a distance that is left.
#[test]
fn a_piece_that_ends_at_its_bound_is_left() {
    let machine = wheel(couple("if(q < 1, sqrt(1 - q), 0)"), &[]);
    for method in [Method::Dop853, Method::Tsit45, Method::Bdf] {
        let [_, v] = end_state(&run(&machine, 1.0, 3.0, &Options::new(method, 1e-8)));
        // Work ∫ √(1−q) dq = 2/3.
        let expected = (1.0 + 4.0 / 3.0 / INERTIA).sqrt();
        assert!((v - expected).abs() < 1e-5, "{method:?} {v} {expected}");
    }
}
