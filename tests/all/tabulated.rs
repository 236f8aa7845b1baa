//! Machines on their tables, against the machines themselves.

use crate::machine::{machine, parse};
use crate::tables::{IntegratedFunction, check_integral};
use dwell_dynamics::{
    CoordinateMode, DenseOutput, DynamicsError, Event, EventKind, Machine, MachineOde, Method,
    ObservedMachine, OdeState, OdeSystem, Options, StepControl, TabulatedMachine, TabulationError,
    integrate, solve, solve_system,
};
use dwell_geometry::PositionError;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_kinetostatics::{Model, TableDomain, TableError, TableQuantity};
use dwell_laws::{Law, Polynomial};
use dwell_scene::PlaneScene;
use dwell_tests::fixtures::{repository_root, scene};
use std::f64::consts::TAU;

/// A case with more loads or drives at its end.
fn with(case: &str, more: &str) -> PlaneScene {
    let path = repository_root()
        .join("validation")
        .join(case)
        .join("scene.toml");
    let text = std::fs::read_to_string(path).expect("a scene");
    parse(&(text + more))
}

/// The machine of a scene with its own drives.
fn full_machine(scene: &PlaneScene) -> Machine {
    machine(scene, &[], &scene.drives)
}

const GRAVITY_AND_SPRING: &str = r#"
[loads]
weight = { gravity = [0, -9.81] }
spring = { spring = ["ground.A", "rocker.C"], stiffness = 15, free-length = 2.5 }
"#;

/// Name, machine, first coordinate and speed, and how long it is followed (s).
// Long: a list of machines.
fn machines() -> Vec<(&'static str, Machine, [f64; 2], f64)> {
    let time_dependent = r#"
[loads]
push = { torque = "crank", magnitude = "3*sin(7*t) + 0.2*phi.velocity*cos(phi)" }
spring = { spring = ["ground.A", "rocker.C"], stiffness = "15 + 3*t", free-length = 2.5 }
"#;
    let friction_and_damper = r#"
[coordinates]
psi = { angle = ["ground", "rocker"] }
winds = { angle = ["crank", "coupler"] }
wide = { length = ["ground.A", "rocker.C"] }
[loads]
push = { torque = "rocker", magnitude = "psi^2 - 0.3*psi.velocity + sin(winds) + 0.02*winds + wide*wide.velocity" }
"#;
    vec![
        (
            "free",
            full_machine(&scene("crank-rocker")),
            [1.0, 10.0],
            2.0,
        ),
        (
            "single-dwell",
            full_machine(&scene("single-dwell")),
            [0.0, 1.0],
            15.0,
        ),
        (
            "gravity and spring",
            full_machine(&with("crank-rocker", GRAVITY_AND_SPRING)),
            [1.0, 10.0],
            2.0,
        ),
        (
            "damper",
            full_machine(&scene("scotch-yoke")),
            [0.3, 40.0],
            1.0,
        ),
        (
            "gravity and damper",
            full_machine(&scene("watt-six-bar")),
            [0.5, 9.0],
            1.0,
        ),
        (
            "torsion spring",
            full_machine(&scene("massless-coupler")),
            [0.5, 9.0],
            1.0,
        ),
        (
            "expression of q",
            full_machine(&scene("slider-crank")),
            [0.5, 60.0],
            0.3,
        ),
        (
            "motor with a coil and a rotor",
            full_machine(&scene("four-bar")),
            [0.5, 3.0],
            0.6,
        ),
        (
            "regulator and speed elsewhere",
            full_machine(&scene("whitworth")),
            [1.0, 4.0],
            1.5,
        ),
        (
            "values and speeds elsewhere",
            full_machine(&with("crank-rocker", friction_and_damper)),
            [1.0, 10.0],
            2.0,
        ),
        (
            "time and own speed",
            full_machine(&with("crank-rocker", time_dependent)),
            [1.0, 10.0],
            2.0,
        ),
    ]
}

fn end<S: OdeSystem>(system: &mut S, y: &[f64], until: f64) -> Vec<f64> {
    let start = OdeState {
        t: 0.0,
        y: y.to_vec(),
    };
    let mut watch = |_: &OdeState, _: &OdeState, _: DenseOutput<'_>| Ok(StepControl::Continue);
    let options = Options::new(Method::Tsit45, 1e-13);
    let ended = integrate(system, &start, Some(until), &options, &mut watch).expect("a run");
    assert_eq!(ended.error, None);
    ended.state.y
}

fn tabulate(machine: &Machine, accuracy: f64) -> TabulatedMachine {
    TabulatedMachine::new(machine, accuracy, TableDomain::Full).unwrap_or_else(|e| panic!("{e}"))
}

/// The end of a motion on a table is that of the exact machine, in every state, to within the bound. The
/// largest difference met is 0.17 of it.
#[test]
fn val_a_motion_on_a_table_is_that_of_the_machine() {
    for (name, machine, [q, q_dot], until) in machines() {
        let y = machine.initial_state(&[q], &[q_dot]);
        let mut exact = MachineOde::new(&machine, 0.0, &y).expect("a start");
        let expected = end(&mut exact, &y, until);
        for accuracy in [1e-5, 1e-8] {
            let table = tabulate(&machine, accuracy);
            assert!(table.bound() <= accuracy, "{name}");
            assert_eq!(table.state_count(), machine.state_count());
            let mut moving = table.ode(0.0, &y, 0.0).expect("a start");
            let found = end(&mut moving, &y, until);
            let mut max = 0.0_f64;
            for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let weight = exact.error_weight(i);
                assert!((moving.error_weight(i) - weight).abs() <= 4.0 * accuracy * weight);
                max = max.max((found - expected).abs() / expected.abs().max(weight));
            }
            println!(
                "{name} {accuracy:e}: {:e} of the bound",
                max / table.bound()
            );
            assert!(max < table.bound(), "{name}: {max:e}");
            // It is the table that moved, and not the machine: some digit differs.
            assert!(max > 1e-6 * table.bound(), "{name}: {max:e}");
        }
    }
}

/// The Jacobian from the pieces is the machine's, and that of the table's own rates.
#[test]
fn a_tables_jacobian_is_the_machines() {
    for (name, machine, [q, q_dot], _) in machines() {
        let mut y = machine.initial_state(&[q], &[q_dot]);
        // Of the drives' own states, too.
        for (k, y) in y.iter_mut().enumerate().skip(2) {
            *y = 0.1 * k as f64;
        }
        let table = tabulate(&machine, 1e-10);
        let (mut moving, mut exact) = (
            table.ode(0.1, &y, 0.0).expect("a start"),
            MachineOde::new(&machine, 0.1, &y).expect("a start"),
        );
        let n = y.len();
        let (mut tabulated, mut expected) = (vec![0.0; n * n], vec![0.0; n * n]);
        moving
            .jacobian(0.1, &y, &mut tabulated)
            .expect("a Jacobian");
        exact.jacobian(0.1, &y, &mut expected).expect("a Jacobian");
        let [mut up, mut down] = [vec![0.0; n], vec![0.0; n]];
        for row in 0..n {
            let entries = || (0..n).map(|j| expected[row * n + j].abs());
            let scale = entries().fold(1.0, f64::max);
            for j in 0..n {
                // A slope of a piece of cells a tenth wide loses one to two digits.
                let difference = (tabulated[row * n + j] - expected[row * n + j]).abs();
                assert!(
                    difference < 1e-7 * scale,
                    "{name}: ∂f{row}/∂y{j} is off by {difference:e}"
                );
                let step = 1e-6 * y[j].abs().max(1.0);
                let mut at = |offset: f64, out: &mut [f64]| {
                    let mut perturbed = y.clone();
                    perturbed[j] += offset * step;
                    moving.rhs(0.1, &perturbed, out).expect("rates");
                };
                at(1.0, &mut up);
                at(-1.0, &mut down);
                // Truncation h² and rounding eps/h of central differences.
                let slope = (up[row] - down[row]) / (2.0 * step);
                let difference = (tabulated[row * n + j] - slope).abs();
                assert!(
                    difference < 1e-6 * scale,
                    "{name}: ∂f{row}/∂y{j} is not its own: {difference:e}"
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
        let table = tabulate(&machine, 1e-8);
        let scale = |of: TableQuantity| {
            table
                .bounds
                .iter()
                .find(|b| b.quantity == of)
                .map(|b| b.scale)
        };
        let (m, v) = (
            |q: f64| table.inertia(q).expect("within"),
            |q: f64| table.potential(q).expect("within"),
        );
        let mut sums = IntegratedFunction {
            name,
            at: &m,
            extent: table.domain,
            cells: table.cells()[0],
            scale: scale(TableQuantity::M).expect("m"),
            is_periodic: table.period.is_some(),
        };
        check_integral(&sums);
        if let Some(scale) = scale(TableQuantity::V) {
            (sums.at, sums.cells, sums.scale) = (&v, table.cells()[1], scale);
            check_integral(&sums);
            potentials += 1;
        }
    }
    assert!(potentials >= 5, "{potentials}");
}

/// With gravity and a spring, ½ m q̇² + V drifts in 1000 turns on the table as on the machine, by what equal
/// steps do, however coarse the table: what a turn gains is rounding.
#[test]
fn val_energy_with_a_potential_does_not_drift_because_of_a_table() {
    let machine = full_machine(&with("crank-rocker", GRAVITY_AND_SPRING));
    let y = machine.initial_state(&[1.0], &[10.0]);
    let mut workspace = machine.workspace();
    let mut exact = MachineOde::new(&machine, 0.0, &y).expect("a start");
    let expected = states_per_step(&mut exact, |y| {
        let state = machine.evaluate(0.0, y, &mut workspace).expect("a pose");
        state.energy().iter().sum()
    });
    assert!(
        expected[999].abs() > 1e-8,
        "nothing to compare: {:e}",
        expected[999]
    );
    for accuracy in [1e-6, 1e-9] {
        let table = tabulate(&machine, accuracy);
        let mut moving = table.ode(0.0, &y, 0.0).expect("a start");
        let tabulated = states_per_step(&mut moving, |y| {
            table.energy(y[0], y[1]).expect("within").iter().sum()
        });
        for (revolution, (tabulated, expected)) in tabulated.iter().zip(&expected).enumerate() {
            // What steps gain by truncation differs as higher derivatives of the table do. A force that gained
            // its bound in a turn would be at hundreds of bounds in the end.
            let max = 2e-4 * table.bound() + 2e-15 * revolution as f64;
            let difference = (tabulated - expected).abs();
            assert!(
                difference < max,
                "{accuracy:e}, turn {revolution}: {difference:e} apart"
            );
        }
    }
}

/// What the energy has gained after each of 1000 turns or so, as a part of it, by Runge and Kutta's rule of 4.
fn states_per_step<S: OdeSystem>(
    system: &mut S,
    mut energy: impl FnMut(&[f64]) -> f64,
) -> Vec<f64> {
    let (h, mut y) = (0.63 / 400.0, [1.0, 10.0]);
    let first = energy(&y);
    let mut gains = Vec::new();
    for _ in 0..1000 {
        for _ in 0..400 {
            let (mut slope, mut sum) = ([0.0; 2], [0.0; 2]);
            for (ahead, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
                let at = [0, 1].map(|i: usize| y[i] + ahead * h * slope[i]);
                system.rhs(0.0, &at, &mut slope).expect("within");
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
    let machine = full_machine(&scene("four-bar"));
    let y = machine.initial_state(&[0.5], &[0.0]);
    let start = OdeState { t: 0.0, y };
    let mechanism = scene("four-bar").mechanism;
    let actuator_coordinate =
        CoordinateFunction::find(&mechanism, mechanism.actuators[0].coordinate()).expect("there");
    let events = [Event {
        kind: EventKind::Revolution(actuator_coordinate),
        terminal: None,
    }];
    let options = Options::new(Method::Bdf, 1e-10);
    let model = machine.model();
    let expected = solve(&machine, model, &start, 0.6, &options, &events).expect("a run");
    let table = tabulate(&machine, 1e-9);
    let mut moving = table.ode(0.0, &start.y, 0.0).expect("a start");
    let of = ObservedMachine::new(&machine, model);
    let found = solve_system(&mut moving, of, &start, Some(0.6), &options, &events);
    let found = found.expect("a run");
    assert!(
        expected.event_occurrences.len() >= 2,
        "{}",
        expected.event_occurrences.len()
    );
    assert_eq!(
        found.event_occurrences.len(),
        expected.event_occurrences.len()
    );
    for (found, expected) in found
        .event_occurrences
        .iter()
        .zip(&expected.event_occurrences)
    {
        // The integrations' error: the steps are not the same.
        assert!(
            (found.state.t - expected.state.t).abs() < 1e-7,
            "{} {}",
            found.state.t,
            expected.state.t
        );
    }
}

/// A table over a part of the turn ends there.
#[test]
fn a_motion_ends_where_its_table_does() {
    let machine = full_machine(&scene("crank-rocker"));
    let table =
        TabulatedMachine::new(&machine, 1e-9, TableDomain::Between(0.0, 2.0)).expect("a table");
    assert_eq!((table.domain, table.period), ([0.0, 2.0], None));
    let y = machine.initial_state(&[1.0], &[10.0]);
    let mut moving = table.ode(0.0, &y, 0.0).expect("a start");
    let start = OdeState { t: 0.0, y };
    let mut watch = |_: &OdeState, _: &OdeState, _: DenseOutput<'_>| Ok(StepControl::Continue);
    let options = Options::new(Method::Tsit45, 1e-9);
    let ended = integrate(&mut moving, &start, Some(2.0), &options, &mut watch).expect("a run");
    let outside = |e: &DynamicsError| {
        matches!(
            e,
            DynamicsError::Position(PositionError::OutOfRange { to: 2.0, .. })
        )
    };
    assert!(
        ended.error.as_ref().is_some_and(outside),
        "{:?}",
        ended.error
    );
    // A table takes for its end what is within a rounding of its domain: 7.7e-11 of 2 here.
    assert!((ended.state.y[0] - 2.0).abs() < 1e-9, "{:?}", ended.state.y);
}

/// What has no table says why.
#[test]
fn machines_without_a_table_say_why() {
    let refused = |machine: &Machine| {
        TabulatedMachine::new(machine, 1e-6, TableDomain::Full).expect_err("none")
    };
    assert_eq!(
        refused(&full_machine(&scene("five-bar"))),
        TabulationError::DegreesOfFreedom {
            actuators: 2,
            free: 2
        }
    );
    let rubbed = refused(&full_machine(&scene("slider-crank-friction")));
    assert!(
        matches!(rubbed, TabulationError::Friction { .. }),
        "{rubbed}"
    );
    let endless = refused(&full_machine(&scene("planetary")));
    assert_eq!(endless, TabulationError::Table(TableError::Unbounded));
    let winds = r#"
[loads]
spring = { torsion-spring = ["ground", "crank"], stiffness = 2, free-angle = 0 }
"#;
    let winds = full_machine(&with("crank-rocker", winds));
    let what = TableQuantity::V;
    assert_eq!(
        refused(&winds),
        TabulationError::Table(TableError::NotPeriodic { what })
    );
    // Over a part of the turn it has one.
    assert!(TabulatedMachine::new(&winds, 1e-6, TableDomain::Between(-1.0, 4.0)).is_ok());
    let scene = scene("crank-rocker");
    let start = scene.assembly.to_configuration();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &[]).expect("a model");
    let law = Law::Polynomial(Polynomial::motion(0.0, 1.0, 0.0));
    let prescribed = Machine::new(model, &[], vec![CoordinateMode::Prescribed(law)], &[]);
    assert_eq!(
        refused(&prescribed.expect("a machine")),
        TabulationError::DegreesOfFreedom {
            actuators: 1,
            free: 0
        }
    );
}
