//! Input and output of motors in space: the columns of the plane, and the circuits of the scene.

use super::as_in_the_plane::{both, column, difference};
use super::scene;
use super::trajectories::written;
use dwell_findings::Table;
use dwell_scene::SpaceScene;
use dwell_study::{
    MotionSolver, PictureSpan, SolverSettings, TrajectoryOutcome, no_progress, simulate_with,
    simulate_within,
};

/// A motor with an inductance, one without, and a drive that is no motor between them.
const DRIVES: &str = "[drives]\n\
     wound = { motor = \"phi\", voltage = 24, torque-constant = 0.05, resistance = 1.2, inductance = 0.003, gear-ratio = 4, inertia = 1e-4 }\n\
     push = { applied-force = \"reach\", magnitude = 3 }\n\
     quick = { motor = \"phi\", voltage = \"6*sin(20*t)\", torque-constant = 0.1, resistance = 2.5 }\n\
     [motion]\nduration = 0.5\ninitial-velocity = 1.0\n";

fn simulated(scene: &SpaceScene) -> TrajectoryOutcome {
    let solver = MotionSolver::Settings(SolverSettings::default());
    let done = simulate_within(scene, &solver, None, PictureSpan::default(), &no_progress);
    done.unwrap_or_else(|e| panic!("{e:?}"))
}

fn names() -> Vec<String> {
    let of = |motor: &str| {
        ["current", "electrical_power", "efficiency"].map(|what| format!("{motor}.{what}"))
    };
    [of("wound"), of("quick")].concat()
}

/// The columns of the plane, in its order, with the same meaning, and the picture of drives. The largest difference seen is 2.5e-11: two
/// integrations by BDF to 1e-10.
#[test]
fn motors_have_the_columns_of_the_plane() {
    let crank = [
        "[actuators]\nphi = { angle = [\"ground\", \"crank\"] }\n[coordinates]\nreach = { length = [\"ground.Q\", \"piston.C\"] }\n[assembly]\nphi = 1.2449\n",
        "[actuators]\nphi = { angle = \"A\" }\n[coordinates]\nreach = { length = [\"ground.Q\", \"piston.C\"] }\n[assembly]\nphi = 1.2449\n",
    ];
    let (plane, space) = both(crank, ["", ""], DRIVES);
    let solver = MotionSolver::Settings(SolverSettings::default());
    let done = simulate_with(&plane, &solver, None, &no_progress);
    let plane = done.unwrap_or_else(|e| panic!("{e:?}"));
    let space = simulated(&space);
    let (planar, spatial) = (written(&plane), written(&space));
    let of_motors = |table: &Table| {
        let columns = table.columns.iter();
        let columns = columns.filter(|c| names().contains(&c.name));
        columns
            .map(|c| (c.name.clone(), c.unit.clone()))
            .collect::<Vec<_>>()
    };
    assert_eq!(of_motors(&planar), of_motors(&spatial));
    assert_eq!(of_motors(&planar).len(), 6);
    let mut largest = 0.0_f64;
    for name in names() {
        let off = difference(&column(&planar, &name), &column(&spatial, &name));
        assert!(off < 2e-9, "{name}: {off:.1e}");
        largest = largest.max(off);
    }
    println!("motors in the plane and in space: {largest:.1e}");
    for done in [&plane, &space] {
        let mut pictures = done.outcome.pictures.iter();
        assert!(pictures.any(|picture| picture.path.contains("-drives")));
    }
}

/// Of a mechanism that moves in no plane: the power is voltage times current, the current that of the circuit, and the efficiency that of
/// the torque at the coordinate. Largest difference seen 3.5e-15.
#[test]
fn powers_and_efficiencies_follow_from_the_circuit() {
    let text = "\n[drives]\n\
        motor = { motor = \"q\", voltage = \"40 - 30*t\", torque-constant = 0.2, resistance = 1.5 }\n\
        [motion]\nduration = 1.5\ninitial-velocity = 2.0\n";
    let table = written(&simulated(&scene("double-hooke", text)));
    let of = |name: &str| column(&table, name);
    let (t, speed, current) = (of("t"), of("q.velocity"), of("motor.current"));
    let (taken, efficiency) = (of("motor.electrical_power"), of("motor.efficiency"));
    let voltage: Vec<f64> = t.iter().map(|t| 40.0 - 30.0 * t).collect();
    let rows = 0..t.len();
    let by_circuit = |k: usize| (voltage[k] - 0.2 * speed[k]) / 1.5;
    let currents: Vec<f64> = rows.clone().map(by_circuit).collect();
    let powers: Vec<f64> = rows.clone().map(|k| voltage[k] * currents[k]).collect();
    let parts = rows.map(|k| {
        let (delivered, lost) = (0.2 * currents[k] * speed[k], 1.5 * currents[k].powi(2));
        if delivered > 0.0 {
            delivered / (delivered + lost)
        } else {
            0.0
        }
    });
    let parts: Vec<f64> = parts.collect();
    // It brakes at the end, where the voltage is below that of the rotor.
    assert!(parts.iter().any(|p| *p > 0.5) && parts.contains(&0.0));
    for (what, found, expected) in [
        ("current", &current, &currents),
        ("power", &taken, &powers),
        ("efficiency", &efficiency, &parts),
    ] {
        let off = difference(expected, found);
        println!("{what}: {off:.1e}");
        assert!(off < 1e-13, "{what}: {off:.1e}");
    }
}
