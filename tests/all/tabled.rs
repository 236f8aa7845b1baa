//! Machines on their tables, against the machines themselves.

use crate::machine::{machine, parse};
use crate::tables::{Sums, put_together};
use crate::world::{home, scene};
use dwell_dynamics::{
    Dense, DynamicsError, Event, Guidance, Machine, Method, Moving, Next, NotTabled, Options,
    Point, Shown, System, Tabled, Trigger, follow, follow_by, integrate,
};
use dwell_geometry::PlaceError;
use dwell_geometry::measure::Measured;
use dwell_kinetostatics::{Entry, Extent, Model, TableError};
use dwell_laws::{Law, Polynomial};
use dwell_scene::Scene;
use std::f64::consts::TAU;

/// A case with more loads or drives at its end.
fn with(case: &str, more: &str) -> Scene {
    let path = home().join("validation").join(case).join("scene.toml");
    let text = std::fs::read_to_string(path).expect("a scene");
    parse(&(text + more))
}

/// The machine of a scene with its own drives.
fn whole(scene: &Scene) -> Machine {
    machine(scene, &[], &scene.drives)
}

const GRAVITY_AND_SPRING: &str = r#"
[loads]
weight = { gravity = [0, -9.81] }
spring = { spring = ["ground.A", "rocker.C"], stiffness = 15, free = 2.5 }
"#;

/// Name, machine, first coordinate and speed, and how long it is followed (s).
fn machines() -> Vec<(&'static str, Machine, [f64; 2], f64)> {
    let timed = r#"
[loads]
push = { torque = "crank", magnitude = "3*sin(7*t) + 0.2*phi.speed*cos(phi)" }
spring = { spring = ["ground.A", "rocker.C"], stiffness = "15 + 3*t", free = 2.5 }
"#;
    let felt = r#"
[coordinates]
psi = { angle = ["ground", "rocker"] }
winds = { angle = ["crank", "coupler"] }
wide = { length = ["ground.A", "rocker.C"] }
[loads]
push = { torque = "rocker", magnitude = "psi^2 - 0.3*psi.speed + sin(winds) + 0.02*winds + wide*wide.speed" }
"#;
    vec![
        ("free", whole(&scene("crank-rocker")), [1.0, 10.0], 2.0),
        (
            "single-dwell",
            whole(&scene("single-dwell")),
            [0.0, 1.0],
            15.0,
        ),
        (
            "gravity and spring",
            whole(&with("crank-rocker", GRAVITY_AND_SPRING)),
            [1.0, 10.0],
            2.0,
        ),
        ("damper", whole(&scene("scotch-yoke")), [0.3, 40.0], 1.0),
        (
            "gravity and damper",
            whole(&scene("watt-six-bar")),
            [0.5, 9.0],
            1.0,
        ),
        (
            "torsion spring",
            whole(&scene("massless-coupler")),
            [0.5, 9.0],
            1.0,
        ),
        (
            "expression of q",
            whole(&scene("slider-crank")),
            [0.5, 60.0],
            0.3,
        ),
        (
            "motor with a coil and a rotor",
            whole(&scene("four-bar")),
            [0.5, 3.0],
            0.6,
        ),
        (
            "regulator and speed elsewhere",
            whole(&scene("whitworth")),
            [1.0, 4.0],
            1.5,
        ),
        (
            "values and speeds elsewhere",
            whole(&with("crank-rocker", felt)),
            [1.0, 10.0],
            2.0,
        ),
        (
            "time and own speed",
            whole(&with("crank-rocker", timed)),
            [1.0, 10.0],
            2.0,
        ),
    ]
}

fn end<S: System>(system: &mut S, y: &[f64], until: f64) -> Vec<f64> {
    let start = Point {
        t: 0.0,
        y: y.to_vec(),
    };
    let mut watch = |_: &Point, _: &Point, _: Dense<'_>| Ok(Next::GoOn);
    let options = Options::new(Method::Tsit45, 1e-13);
    let ended = integrate(system, &start, Some(until), &options, &mut watch).expect("a run");
    assert_eq!(ended.failed, None);
    ended.at.y
}

fn tabled(machine: &Machine, accuracy: f64) -> Tabled {
    Tabled::new(machine, accuracy, Extent::Whole).unwrap_or_else(|e| panic!("{e}"))
}

/// The end of a motion on a table is that of the exact machine, in every state, to within the bound. The
/// largest difference met is 0.17 of it.
#[test]
fn val_a_motion_on_a_table_is_that_of_the_machine() {
    for (name, machine, [q, q_dot], until) in machines() {
        let y = machine.start(&[q], &[q_dot]);
        let mut exact = Moving::new(&machine, 0.0, &y).expect("a start");
        let truth = end(&mut exact, &y, until);
        for accuracy in [1e-5, 1e-8] {
            let table = tabled(&machine, accuracy);
            assert!(table.bound() <= accuracy, "{name}");
            assert_eq!(table.states(), machine.states());
            let mut moving = table.moving(0.0, &y).expect("a start");
            let found = end(&mut moving, &y, until);
            let mut most = 0.0_f64;
            for (i, (found, truth)) in found.iter().zip(&truth).enumerate() {
                let weight = exact.weight(i);
                assert!((moving.weight(i) - weight).abs() <= 4.0 * accuracy * weight);
                most = most.max((found - truth).abs() / truth.abs().max(weight));
            }
            println!(
                "{name} {accuracy:e}: {:e} of the bound",
                most / table.bound()
            );
            assert!(most < table.bound(), "{name}: {most:e}");
            // It is the table that moved, and not the machine: some digit differs.
            assert!(most > 1e-6 * table.bound(), "{name}: {most:e}");
        }
    }
}

/// The Jacobian from the pieces is the machine's, and that of the table's own rates.
#[test]
fn a_tables_jacobian_is_the_machines() {
    for (name, machine, [q, q_dot], _) in machines() {
        let mut y = machine.start(&[q], &[q_dot]);
        // Of the drives' own states, too.
        for (k, y) in y.iter_mut().enumerate().skip(2) {
            *y = 0.1 * k as f64;
        }
        let table = tabled(&machine, 1e-10);
        let (mut moving, mut exact) = (
            table.moving(0.1, &y).expect("a start"),
            Moving::new(&machine, 0.1, &y).expect("a start"),
        );
        let n = y.len();
        let (mut own, mut truth) = (vec![0.0; n * n], vec![0.0; n * n]);
        moving.jacobian(0.1, &y, &mut own).expect("a Jacobian");
        exact.jacobian(0.1, &y, &mut truth).expect("a Jacobian");
        let [mut up, mut down] = [vec![0.0; n], vec![0.0; n]];
        for row in 0..n {
            let entries = || (0..n).map(|j| truth[row * n + j].abs());
            let scale = entries().fold(1.0, f64::max);
            for j in 0..n {
                // A slope of a piece of cells a tenth wide loses one to two digits.
                let off = (own[row * n + j] - truth[row * n + j]).abs();
                assert!(
                    off < 1e-7 * scale,
                    "{name}: ∂f{row}/∂y{j} is off by {off:e}"
                );
                let step = 1e-6 * y[j].abs().max(1.0);
                let mut at = |way: f64, out: &mut [f64]| {
                    let mut moved = y.clone();
                    moved[j] += way * step;
                    moving.rates(0.1, &moved, out).expect("rates");
                };
                at(1.0, &mut up);
                at(-1.0, &mut down);
                // Truncation h² and rounding eps/h of central differences.
                let slope = (up[row] - down[row]) / (2.0 * step);
                let off = (own[row * n + j] - slope).abs();
                assert!(
                    off < 1e-6 * scale,
                    "{name}: ∂f{row}/∂y{j} is not its own: {off:e}"
                );
            }
        }
    }
}

/// m and V are the integrals of ½m′ and ½V′ over the cells, and gain nothing in a turn.
#[test]
fn inertia_and_potential_are_put_together_from_their_slopes() {
    let mut potentials = 0;
    for (name, machine, ..) in machines() {
        let table = tabled(&machine, 1e-8);
        let scale = |of: Entry| table.bounds().iter().find(|b| b.of == of).map(|b| b.scale);
        let (m, v) = (
            |q: f64| table.inertia(q).expect("within"),
            |q: f64| table.potential(q).expect("within"),
        );
        let mut sums = Sums {
            name,
            at: &m,
            extent: table.extent(),
            cells: table.cells()[0],
            scale: scale(Entry::M).expect("m"),
            comes_back: table.period().is_some(),
        };
        put_together(&sums);
        if let Some(scale) = scale(Entry::V) {
            (sums.at, sums.cells, sums.scale) = (&v, table.cells()[1], scale);
            put_together(&sums);
            potentials += 1;
        }
    }
    assert!(potentials >= 5, "{potentials}");
}

/// With gravity and a spring, ½ m q̇² + V drifts in 1000 turns on the table as on the machine, by what equal
/// steps do, however coarse the table: what a turn gains is rounding.
#[test]
fn val_energy_with_a_potential_does_not_drift_because_of_a_table() {
    let machine = whole(&with("crank-rocker", GRAVITY_AND_SPRING));
    let y = machine.start(&[1.0], &[10.0]);
    let mut work = machine.work();
    let mut exact = Moving::new(&machine, 0.0, &y).expect("a start");
    let truth = stepped(&mut exact, |y| {
        machine.evaluate(0.0, y, &mut work).expect("a pose");
        machine.energy(&work).iter().sum()
    });
    assert!(
        truth[999].abs() > 1e-8,
        "nothing to compare: {:e}",
        truth[999]
    );
    for accuracy in [1e-6, 1e-9] {
        let table = tabled(&machine, accuracy);
        let mut moving = table.moving(0.0, &y).expect("a start");
        let own = stepped(&mut moving, |y| {
            table.energy(y[0], y[1]).expect("within").iter().sum()
        });
        for (turn, (own, truth)) in own.iter().zip(&truth).enumerate() {
            // What steps gain by truncation differs as higher derivatives of the table do. A force that gained
            // its bound in a turn would be at hundreds of bounds in the end.
            let most = 2e-4 * table.bound() + 2e-15 * turn as f64;
            let apart = (own - truth).abs();
            assert!(apart < most, "{accuracy:e}, turn {turn}: {apart:e} apart");
        }
    }
}

/// What the energy has gained after each of 1000 turns or so, as a part of it, by Runge and Kutta's rule of 4.
fn stepped<S: System>(system: &mut S, mut energy: impl FnMut(&[f64]) -> f64) -> Vec<f64> {
    let (h, mut y) = (0.63 / 400.0, [1.0, 10.0]);
    let first = energy(&y);
    let mut gains = Vec::new();
    for _ in 0..1000 {
        for _ in 0..400 {
            let (mut slope, mut sum) = ([0.0; 2], [0.0; 2]);
            for (ahead, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
                let at = [0, 1].map(|i: usize| y[i] + ahead * h * slope[i]);
                system.rates(0.0, &at, &mut slope).expect("within");
                sum = [0, 1].map(|i: usize| sum[i] + weight * slope[i] / 6.0);
            }
            y = [0, 1].map(|i: usize| y[i] + h * sum[i]);
        }
        // With the turns it has made, q would be rounded to 1e-12.
        y[0] -= TAU * (y[0] / TAU).floor();
        gains.push(energy(&y) / first - 1.0);
    }
    gains
}

/// Events of a motion on a table, with the states of the exact machine.
#[test]
fn events_happen_on_a_table_when_they_do_on_the_machine() {
    let machine = whole(&scene("four-bar"));
    let y = machine.start(&[0.5], &[0.0]);
    let start = Point { t: 0.0, y };
    let mechanism = scene("four-bar").mechanism;
    let own = Measured::find(&mechanism, mechanism.actuators[0].coordinate()).expect("there");
    let events = [Event {
        trigger: Trigger::WholeTurn(own),
        stop: false,
    }];
    let options = Options::new(Method::Bdf, 1e-10);
    let model = machine.model();
    let truth = follow(&machine, model, &start, 0.6, &options, &events).expect("a run");
    let table = tabled(&machine, 1e-9);
    let mut moving = table.moving(0.0, &start.y).expect("a start");
    let of = Shown {
        machine: &machine,
        shown: model,
    };
    let found = follow_by(&mut moving, of, &start, 0.6, &options, &events);
    let found = found.expect("a run");
    assert!(truth.occurrences.len() >= 2, "{}", truth.occurrences.len());
    assert_eq!(found.occurrences.len(), truth.occurrences.len());
    for (found, truth) in found.occurrences.iter().zip(&truth.occurrences) {
        // The integrations' error: the steps are not the same.
        assert!(
            (found.at.t - truth.at.t).abs() < 1e-7,
            "{} {}",
            found.at.t,
            truth.at.t
        );
    }
}

/// A table over a part of the turn ends there.
#[test]
fn a_motion_ends_where_its_table_does() {
    let machine = whole(&scene("crank-rocker"));
    let table = Tabled::new(&machine, 1e-9, Extent::Between(0.0, 2.0)).expect("a table");
    assert_eq!((table.extent(), table.period()), ([0.0, 2.0], None));
    let y = machine.start(&[1.0], &[10.0]);
    let mut moving = table.moving(0.0, &y).expect("a start");
    let start = Point { t: 0.0, y };
    let mut watch = |_: &Point, _: &Point, _: Dense<'_>| Ok(Next::GoOn);
    let options = Options::new(Method::Tsit45, 1e-9);
    let ended = integrate(&mut moving, &start, Some(2.0), &options, &mut watch).expect("a run");
    let outside = |e: &DynamicsError| {
        matches!(
            e,
            DynamicsError::Place(PlaceError::OutOfRange { to: 2.0, .. })
        )
    };
    assert!(
        ended.failed.as_ref().is_some_and(outside),
        "{:?}",
        ended.failed
    );
    assert!(
        ended.at.y[0] > 1.9 && ended.at.y[0] <= 2.0,
        "{:?}",
        ended.at.y
    );
}

/// What has no table says why.
#[test]
fn machines_without_a_table_say_why() {
    let refused = |machine: &Machine| Tabled::new(machine, 1e-6, Extent::Whole).expect_err("none");
    assert_eq!(
        refused(&whole(&scene("five-bar"))),
        NotTabled::Freedoms {
            actuators: 2,
            free: 2
        }
    );
    let rubbed = refused(&whole(&scene("slider-crank-friction")));
    assert!(matches!(rubbed, NotTabled::Friction { .. }), "{rubbed}");
    let endless = refused(&whole(&scene("planetary")));
    assert_eq!(endless, NotTabled::Table(TableError::Endless));
    let winds = r#"
[loads]
spring = { torsion = ["ground", "crank"], stiffness = 2, free = 0 }
"#;
    let winds = whole(&with("crank-rocker", winds));
    let what = Entry::V;
    assert_eq!(
        refused(&winds),
        NotTabled::Table(TableError::NotPeriodic { what })
    );
    // Over a part of the turn it has one.
    assert!(Tabled::new(&winds, 1e-6, Extent::Between(-1.0, 4.0)).is_ok());
    let scene = scene("crank-rocker");
    let start = scene.assembly.to_start();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &[]).expect("a model");
    let law = Law::Polynomial(Polynomial::motion(0.0, 1.0, 0.0));
    let led = Machine::new(
        &scene.mechanism,
        model,
        &[],
        vec![Guidance::Prescribed(law)],
        &[],
    );
    assert_eq!(
        refused(&led.expect("a machine")),
        NotTabled::Freedoms {
            actuators: 1,
            free: 0
        }
    );
}
