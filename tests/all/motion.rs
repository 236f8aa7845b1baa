//! Free motion: energy, period and the power law of the integrators' errors.

use crate::world::{model_for, scene};
use dwell_dynamics::{Equation, FreeTurn, Method, Options, State, Until, simulate};

const START: State = State {
    t: 0.0,
    q: 0.0,
    q_dot: 1.0,
};

#[test]
fn val_period_of_the_single_dwell() {
    let model = model_for(&scene("single-dwell"), &[]);
    let turn = FreeTurn::new(&model, START).expect("a period");
    println!("T {} points {}", turn.period, turn.points);
    // 50-digit arithmetic: 5.4196626770642718779 s.
    assert!((turn.period - 5.419_662_677_064_272).abs() < 1e-14 * turn.period * 3.0);
    for method in [Method::Bdf, Method::Tsit45] {
        let run = simulate(&model, START, Until::Turns(1), &Options::new(method, 1e-13));
        let run = run.expect("a run");
        let t = run.turns[0].t;
        println!(
            "{} {t} {:e} {:?}",
            method.name(),
            t - turn.period,
            run.statistics
        );
        assert!((t - turn.period).abs() < 1e-9);
    }
}

#[test]
fn energy_drift_of_bdf_follows_its_tolerance() {
    let model = model_for(&scene("single-dwell"), &[]);
    let mut equation = Equation::new(&model);
    let energy = equation.energy(0.0, 1.0).expect("energy");
    for method in [Method::Bdf, Method::Tsit45] {
        for k in 8..=13 {
            let tolerance = 10f64.powi(-k);
            let began = std::time::Instant::now();
            let run = simulate(
                &model,
                START,
                Until::Turns(10),
                &Options::new(method, tolerance),
            );
            let run = run.expect("a run");
            let took = began.elapsed();
            let drift = run
                .steps
                .iter()
                .map(|s| (equation.energy(s.q, s.q_dot).expect("energy") / energy - 1.0).abs())
                .fold(0.0, f64::max);
            println!(
                "{} {tolerance:e} drift {drift:e} {:?} {took:?}",
                method.name(),
                run.statistics
            );
        }
    }
}
