//! `dwell simulate` of scenes in space: the files that it writes against the references and against balances of energy.

use super::flyball;
use super::reference::{Reference, number, vector};
use dwell_dynamics::Method;
use dwell_findings::Table;
use dwell_scene::SpaceScene;
use dwell_study::{
    MotionSolver, PictureSpan, SolverSettings, TrajectoryOutcome, no_progress, simulate_within,
};

/// A scene of `validation/spatial` with a motion.
fn scene(name: &str, motion: &str) -> SpaceScene {
    let path = format!(
        "{}/../validation/spatial/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).expect("a scene") + motion;
    SpaceScene::parse(name, &text).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn by_dop853(rtol: f64, interval: f64) -> MotionSolver {
    MotionSolver::Settings(SolverSettings {
        method: Method::Dop853,
        rtol,
        atol: rtol,
        sample_interval: Some(interval),
        ..SolverSettings::default()
    })
}

fn simulated(
    scene: &SpaceScene,
    solver: &MotionSolver,
    times: Option<&[f64]>,
) -> TrajectoryOutcome {
    let span = PictureSpan::default();
    let done = simulate_within(scene, solver, times, span, &no_progress);
    let done = done.unwrap_or_else(|e| panic!("{}: {e:?}", scene.name));
    assert!(done.early_stop.is_none(), "{:?}", done.early_stop);
    done
}

/// A table that was written, as a reader of the file gets it.
fn written(done: &TrajectoryOutcome, ending: &str) -> Table {
    let mut files = done.outcome.files.iter();
    let table = files.find(|(path, _)| path.to_string_lossy().ends_with(ending));
    let (_, bytes) = table.expect("a table");
    let text = std::str::from_utf8(bytes).expect("text");
    let mut lines = text.lines();
    let heads = lines.next().expect("a header").split(',');
    let columns = heads.map(|head| {
        let (name, unit) = head.split_once(" [").unwrap_or((head, ""));
        dwell_findings::Column::new(name, unit.trim_end_matches(']'))
    });
    let columns: Vec<_> = columns.collect();
    let row = |line: &str| {
        line.split(',')
            .map(|v| v.parse().expect("a number"))
            .collect()
    };
    Table {
        columns,
        rows: lines.map(row).collect(),
    }
}

fn column<'t>(table: &'t Table, name: &str) -> impl Fn(usize) -> f64 + 't {
    let k = table.columns.iter().position(|c| c.name == name);
    let k = k.unwrap_or_else(|| panic!("no column {name}"));
    move |row| table.rows[row][k]
}

fn recorded(done: &TrajectoryOutcome, name: &str) -> f64 {
    let mut numbers = done.outcome.record.numbers.iter();
    let found = numbers.find(|n| n.name == name);
    found.unwrap_or_else(|| panic!("no {name}")).value
}

/// Ten seconds of the Bricard linkage A04 by DOP853: its point P3 within 1e-9 m, its energy within 1e-12; and its period by
/// quadrature to 1e-12.
#[test]
fn the_bricard_linkage_moves_as_its_reference() {
    let reference = Reference::read("bricard-a04");
    let motion = &reference.data["free_motion"][0];
    let scene = scene("bricard-a04", "\n[motion]\nduration = 10\n");
    let done = simulated(&scene, &by_dop853(1e-13, 0.5), None);
    let table = written(&done, "-motion.csv");
    let time = column(&table, "t");
    let mut compared = 0;
    for state in motion["states"].as_array().expect("states") {
        let t = number(&state["t"]);
        let Some(row) = (0..table.rows.len()).find(|&k| (time(k) - t).abs() < 1e-12) else {
            continue;
        };
        for (point, body) in [("P2", "rod2"), ("P3", "rod3")] {
            let wanted = vector(&state[point]);
            for (axis, wanted) in [("x", wanted.x), ("y", wanted.y), ("z", wanted.z)] {
                let found = column(&table, &format!("{body}.{point}.{axis}"))(row);
                assert!(
                    (found - wanted).abs() < 1e-9,
                    "{point}.{axis} at {t} s: {found}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared >= 12, "{compared}");
    let drift = column(&table, "energy.balance_error");
    let largest = (0..table.rows.len())
        .map(|k| drift(k).abs())
        .fold(0.0, f64::max);
    let kinetic = column(&table, "energy.kinetic");
    let scale = (0..table.rows.len()).map(kinetic).fold(0.0, f64::max);
    assert!(largest < 1e-12 * scale, "{largest:.1e} of {scale}");
    let solver = MotionSolver::Accuracy {
        accuracy: 1e-10,
        sample_interval: None,
    };
    let done = simulated(&scene, &solver, None);
    assert!(
        done.outcome.summary.contains("quadrature"),
        "{}",
        done.outcome.summary
    );
    let period = recorded(&done, "period");
    let wanted = number(&motion["period_s"]);
    assert!(
        (period / wanted - 1.0).abs() < 1e-12,
        "{period} for {wanted}"
    );
}

/// θ and x of the spatial slider-crank after 5 s within 1e-9, at the end and among wanted instants; its revolutions are events.
#[test]
fn the_spatial_slider_crank_moves_as_its_reference() {
    let reference = Reference::read("slider-crank-haug");
    let motion = &reference.data["free_motion"][0];
    let scene = scene(
        "slider-crank-haug",
        "\n[motion]\nduration = 5\ninitial-velocity = 6\nevents.turn = { revolution = \"q\" }\nevents.back = { reverses = \"s\" }\n[coordinates]\ns = { travel = \"D\" }\n",
    );
    let states = motion["states"].as_array().expect("states");
    let last = states.last().expect("a state");
    assert_eq!(number(&last["t"]), 5.0);
    let (theta, x) = (number(&last["q"]), vector(&last["point"]).x);
    for times in [None, Some(&[0.5, 1.25, 5.0][..])] {
        let done = simulated(&scene, &by_dop853(1e-13, 0.5), times);
        let table = written(&done, "-motion.csv");
        let row = table.rows.len() - 1;
        let found = [column(&table, "q")(row), column(&table, "slider.C.x")(row)];
        for (found, wanted) in found.into_iter().zip([theta, x]) {
            assert!((found - wanted).abs() < 1e-9, "{found} for {wanted}");
        }
        let events = written(&done, "-motion-events.csv");
        let number = column(&events, "event");
        let turns = (0..events.rows.len()).filter(|&k| number(k) == 1.0).count();
        assert_eq!(turns, 8, "54.3 rad are eight revolutions");
        let reversals = (0..events.rows.len()).filter(|&k| number(k) == 2.0).count();
        assert!((16..=18).contains(&reversals), "{reversals}");
    }
}

/// Springs, dampers, laws and a drive: the energies and works that are written balance, whatever integrates.
#[test]
fn energies_and_works_of_driven_motions_in_space_balance() {
    let loads = r#"
spring = { spring = ["ground.A", "slider.C"], stiffness = 31.0, free-length = 0.15 }
coil = { torsion-spring = "A", stiffness = 0.7, free-angle = 0.4 }
drag = { rotational-damper = "A", damping = 0.02 }
rub = { slide-damper = "D", damping = 1.5 }
push = { slide-force = "D", magnitude = "3*sin(2*t)" }
[drives]
motor = { motor = "q", voltage = 6.0, torque-constant = 0.05, resistance = 2.0, inductance = 0.01, gear-ratio = 10, inertia = 1e-5 }
[motion]
initial-velocity = 1.0
duration = 1.0
"#;
    let scene = scene("slider-crank-haug", loads);
    for method in [Method::Dop853, Method::Bdf, Method::Tsit45] {
        let solver = MotionSolver::Settings(SolverSettings {
            method,
            rtol: 1e-10,
            atol: 1e-10,
            ..SolverSettings::default()
        });
        let done = simulated(&scene, &solver, None);
        let table = written(&done, "-motion.csv");
        let energy = |row: usize| {
            let of = |name: &str| column(&table, name)(row);
            let works = ["drag", "rub", "push", "motor"].map(|name| of(&format!("{name}.work")));
            of("energy.kinetic") + of("energy.potential") - works.iter().sum::<f64>()
        };
        let start = energy(0);
        let off = (0..table.rows.len()).map(|k| (energy(k) - start).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off < 1e-7, "{method:?}: {off:.1e} J");
        // The power balance of each row, by the accelerations that are written.
        let residual = column(&table, "power.residual");
        let largest = (0..table.rows.len())
            .map(|k| residual(k).abs())
            .fold(0.0, f64::max);
        assert!(largest < 1e-8, "{method:?}: {largest:.1e} W");
    }
}

/// What cannot be simulated is refused with its place.
#[test]
fn motions_in_space_that_cannot_be_are_refused() {
    let refused = |motion: &str| {
        let scene = scene("bricard-a04", motion);
        let solver = by_dop853(1e-10, 0.1);
        let span = PictureSpan::default();
        let done = simulate_within(&scene, &solver, None, span, &no_progress);
        format!("{:?}", done.expect_err("an error"))
    };
    assert!(refused("").contains("no [motion]"));
    let open = "\n[motion]\nduration = 1\nevents.a = { reaction = \"P2.x\", value = 1 }\n";
    assert!(refused(open).contains("do not determine the reaction `P2.x`"));
}

/// The governor A05 with spring-dampers, ten seconds from a spin of 2π rad/s: four coordinates within 1e-7 of Lagrange's equations, its
/// springs decaying in 40 µs.
#[test]
fn the_governor_with_spring_dampers_moves_as_by_lagranges_equations() {
    let scene = scene("governor-a05", "");
    let solver = MotionSolver::Settings(SolverSettings {
        sample_interval: Some(2.5),
        ..SolverSettings::default()
    });
    let done = simulated(&scene, &solver, None);
    let table = written(&done, "-motion.csv");
    let spin = std::f64::consts::TAU;
    let [coarse, wanted] = [40_000, 80_000].map(|steps| flyball::states(spin, 2.5, 4, steps));
    for (k, (state, half)) in wanted.iter().zip(&coarse).enumerate() {
        for (i, name) in ["spin", "alpha1", "alpha2", "s"].into_iter().enumerate() {
            let found = column(&table, name)(k + 1);
            assert!((state[i] - half[i]).abs() < 1e-9, "{name}: no reference");
            let off = (found - state[i]).abs();
            assert!(
                off < 1e-7,
                "{name} at {} s: {off:.1e}",
                2.5 * (k + 1) as f64
            );
        }
    }
}
