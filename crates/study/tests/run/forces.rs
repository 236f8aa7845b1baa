//! Actions, reactions and balances.

use crate::table::{
    MASSES, Table, WEIGHTS, analyse, case, derivative_error, file, largest, scene, table,
};
use dwell_study::Analysis;

const GRAVITY: f64 = 9.81;

fn sum(table: &Table, of: impl Fn(&str, f64) -> Vec<f64>) -> Vec<f64> {
    let mut all = vec![0.0; table.column("phi").len()];
    for (body, mass) in MASSES {
        for (sum, value) in all.iter_mut().zip(of(body, mass)) {
            *sum += value;
        }
    }
    all
}

/// V(φ) = Σ m g y of the centres.
#[test]
fn under_weight_the_action_at_rest_is_the_slope_of_the_potential() {
    let table = table(&scene(WEIGHTS), Analysis::Statics, 721);
    let phi = table.column("phi");
    let height = |body: &str, mass: f64| {
        let y = table.column(&format!("{body}.G.y"));
        y.iter().map(|y| mass * GRAVITY * y).collect()
    };
    let potential = sum(&table, height);
    let action = table.column("phi.actuator_force");
    let difference = derivative_error(&potential, &action, phi[1] - phi[0]);
    // Half a degree: rounding of 10 J over 0.009 rad.
    assert!(
        difference < 2e-12 * largest(&action).max(1.0),
        "{difference:e}"
    );
    assert!(largest(&action) > 1.0);
    assert!(!table.has("crank.angular_velocity") && !table.has("power.loads"));
}

/// Scenes with every kind of load. The tolerance is what the summary says of all rows; besides, the
/// table's own columns must add up, and the energy must change by the power.
#[test]
fn actuators_and_loads_change_the_kinetic_energy() {
    let cases = [
        "boom",
        "cam",
        "ellipse-trammel",
        "five-bar",
        "four-bar",
        "massless-coupler",
        "rack-pinion",
        "slider-crank",
        "watt-six-bar",
        "whitworth",
    ];
    for name in cases {
        let mut scene = case(name);
        scene.requests.variables = None;
        let result = analyse(&scene, Analysis::Kinetostatics, 2001);
        let summary = &result.outcome.summary;
        let residual = summary
            .split("residual of the power balance: ")
            .nth(1)
            .unwrap();
        let residual: f64 = residual.split(' ').next().unwrap().parse().unwrap();
        assert!(residual <= 1e-12, "{name}: {summary}");
        let table = Table::parse(&file(&result, "-kinetostatics.csv"));
        let rows = table.column("t").len();
        let mut terms = vec![(0.0, 0.0); rows];
        let mut add = |i: usize, value: f64| {
            terms[i].0 += value;
            terms[i].1 += value.abs();
        };
        for actuator in &scene.mechanism.actuators {
            let action = table.column(&format!("{}.actuator_force", actuator.name));
            let speed = table.column(&format!("{}.velocity", actuator.name));
            (0..rows).for_each(|i| add(i, action[i] * speed[i]));
        }
        for load in &scene.loads {
            let power = table.column(&format!("{}.power", load.name));
            (0..rows).for_each(|i| add(i, power[i]));
        }
        let rate = table.column("power.kinetic");
        let size = largest(&rate).max(terms.iter().fold(0.0, |m, t| t.1.max(m)));
        for i in 0..rows {
            // A handful of terms, each rounded.
            assert!((terms[i].0 - rate[i]).abs() <= 1e-12 * size, "{name} {i}");
        }
        if ["boom", "rack-pinion"].contains(&name) {
            // Their laws have corners in the acceleration, over which nothing can be differenced.
            continue;
        }
        let t = table.column("t");
        let step = t[1] - t[0];
        let energy = table.column("energy.kinetic_bodies");
        let difference = derivative_error(&energy, &rate, step);
        // As in the test of the speeds, at half as many positions: 6e-10 · 2⁸.
        let allowed = 2e-7 * size + 1e-14 * largest(&energy) / step;
        assert!(difference <= allowed, "{name}: {difference:e} {allowed:e}");
    }
}

/// Newton for the whole mechanism: the frame gets the weights less Σ m a of the centres.
#[test]
fn the_frame_gets_what_the_momentum_does_not() {
    let table = table(&scene(WEIGHTS), Analysis::Kinetostatics, 90);
    let scaled = |factor: f64, part: &'static str| {
        let table = &table;
        move |body: &str, mass: f64| -> Vec<f64> {
            let a = table.column(&format!("{body}.G.{part}"));
            a.iter().map(|a| factor * mass * a).collect()
        }
    };
    let weight: f64 = MASSES.iter().map(|(_, mass)| mass * GRAVITY).sum();
    let x = sum(&table, scaled(-1.0, "ax"));
    let y = sum(&table, scaled(-1.0, "ay"));
    let (fx, fy) = (table.column("shaking.fx"), table.column("shaking.fy"));
    for i in 0..x.len() {
        // Forces of about a hundred newtons.
        assert!((fx[i] - x[i]).abs() < 1e-11);
        assert!((fy[i] - (y[i] - weight)).abs() < 1e-11);
    }
    // It is what the two bearings take.
    let [a, d] = ["A.x", "D.x"].map(|name| table.column(name));
    for i in 0..x.len() {
        assert!((fx[i] + a[i] + d[i]).abs() < 1e-11);
    }
}

/// The actuator and the load of the planetary gear both rotate a body from the ground: at rest, the
/// ground feels nothing of what it does itself.
#[test]
fn loads_from_the_ground_act_on_the_frame_too() {
    let result = analyse(&case("planetary"), Analysis::Statics, 361);
    let table = Table::parse(&file(&result, "-statics.csv"));
    let m = table.column("shaking.moment");
    // Couples of 12 N m.
    assert!(m.len() > 200 && largest(&m) < 1e-13, "{}", largest(&m));
    assert_eq!(largest(&table.column("load.load_moment")), 12.0);
}

#[test]
fn a_force_is_one_in_all_axes() {
    let table = table(&scene(WEIGHTS), Analysis::Kinetostatics, 60);
    for body in ["crank", "coupler"] {
        let [x, y, u, v, size, direction, angle] = [
            "B.x".to_owned(),
            "B.y".to_owned(),
            format!("B.x@{body}"),
            format!("B.y@{body}"),
            "B.magnitude".to_owned(),
            "B.direction".to_owned(),
            format!("{body}.angle"),
        ]
        .map(|name| table.column(&name));
        for i in 0..x.len() {
            let (s, c) = angle[i].sin_cos();
            // Rounding of a rotated vector.
            let small = 1e-14 * (1.0 + size[i]);
            assert!((u[i] - (x[i] * c + y[i] * s)).abs() < small);
            assert!((v[i] - (y[i] * c - x[i] * s)).abs() < small);
            assert!((size[i] - x[i].hypot(y[i])).abs() < small);
            assert!((size[i] * direction[i].cos() - x[i]).abs() < small);
        }
    }
}

/// Between its pins, a coupler bends by what acts between them alone.
#[test]
fn a_link_does_not_bend_at_its_pins() {
    let result = analyse(&scene(WEIGHTS), Analysis::Kinetostatics, 90);
    let sections = Table::parse(&file(&result, "-internal-forces-coupler.B.C.csv"));
    let envelope = Table::parse(&file(&result, "-internal-forces-coupler.B.C.envelope.csv"));
    let bending = sections.column("bending");
    let max_bending = largest(&bending);
    assert!(max_bending > 0.1 && bending[0].abs() < 1e-12 && bending.last().unwrap().abs() < 1e-12);
    let [low, high] = ["bending.min", "bending.max"].map(|name| envelope.column(name));
    // The worst position is one of those in the envelope, which has no station at the mass itself.
    let widest = largest(&low).max(largest(&high));
    assert!(widest <= max_bending * (1.0 + 1e-12) && widest > 0.97 * max_bending);
    assert!(low.iter().zip(&high).all(|(l, h)| l <= h));
    let stations = sections.column("station");
    assert!(stations.is_sorted() && stations.windows(3).all(|s| s[0] < s[2]));
}
