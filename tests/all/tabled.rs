//! Machines on their tables, against the machines themselves.

use crate::machine::{machine, parse};
use crate::tables::{Sums, put_together};
use crate::world::{home, scene};
use dwell_dynamics::{
    Dense, Drive, DriveKind, Event, Machine, Method, Motor, Moving, Next, NotTabled, Options,
    Point, System, Tabled, Trigger, follow, follow_by, integrate,
};
use dwell_geometry::PlaceError;
use dwell_geometry::measure::Measured;
use dwell_kinetostatics::{Entry, Extent, Magnitude, TableError};
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
follow = { force = "rocker.C", direction = [0, 1], magnitude = "5*coupler.angle + 0.1*rocker.speed" }
[coordinates]
coupler.angle = { angle = ["ground", "coupler"] }
"#;
    let timed = timed.split("[coordinates]").next().expect("loads");
    let timed = timed.replace("5*coupler.angle + 0.1*rocker.speed", "5 + t");
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
            "time and own speed",
            whole(&with("crank-rocker", &timed)),
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

/// The end of a motion on a table is that of the exact machine, in every state, by so many times the bound.
#[test]
fn val_a_motion_on_a_table_is_that_of_the_machine() {
    for (name, machine, [q, q_dot], until) in machines() {
        let y = machine.start(&[q], &[q_dot]);
        let mut exact = Moving::new(&machine, 0.0, &y).expect("a start");
        let truth = end(&mut exact, &y, until);
        for accuracy in [1e-5, 1e-8] {
            let table = Tabled::new(&machine, accuracy, Extent::Whole);
            let table = table.unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(table.bound() <= accuracy, "{name}");
            assert_eq!(table.states(), machine.states());
            let mut moving = table.moving(0.0, &y).expect("a start");
            let found = end(&mut moving, &y, until);
            let mut most = 0.0_f64;
            for (i, (found, truth)) in found.iter().zip(&truth).enumerate() {
                assert!(
                    (moving.weight(i) - exact.weight(i)).abs() <= 2.0 * accuracy * exact.weight(i)
                );
                let size = truth.abs().max(exact.weight(i));
                most = most.max((found - truth).abs() / size);
            }
            println!(
                "{name} {accuracy:e}: {:e} {:?} {:?} {}",
                most / table.bound(),
                truth,
                table.cells(),
                table.bytes()
            );
            assert!(most < 30.0 * table.bound(), "{name}: {most:e}");
        }
    }
}
