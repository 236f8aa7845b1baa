//! Commands on scenes in space beside the same commands on the same mechanism in the plane: columns, ranges, motions through limit
//! positions of the coordinate, requests and messages.

use super::trajectories::written;
use dwell_findings::Table;
use dwell_scene::{PlaneScene, SpaceScene};
use dwell_study::{
    Analysis, MotionSolver, PictureSpan, SolverSettings, StudyError, TrajectoryOutcome,
    analyse_trajectory, analyse_trajectory_within, describe_scene, no_progress, reduce,
    simulate_with, simulate_within,
};
use std::fmt::Write as _;

/// Bodies and joints of a slider-crank, in the plane and in space.
const PLANE: &str = r#"
[bodies.ground]
points = { A = [0, 0], G = [0, 0.02], Q = [0.4, 0.3] }
[bodies.crank]
points = { A = [0, 0], B = [0.08, 0] }
mass = 2.0
center = [0.015, 0.002]
inertia = 0.004
[bodies.rod]
points = { B = [0, 0], C = [0.28, 0] }
mass = 1.2
center = [0.095, 0.003]
inertia = 0.0085
[bodies.piston]
points = { C = [0, 0] }
mass = 0.9
center = [0.012, 0.004]
inertia = 0.0006
[joints]
A = { revolute = ["ground.A", "crank.A"] }
B = { revolute = ["crank.B", "rod.B"] }
C = { revolute = ["rod.C", "piston.C"] }
guide = { prismatic = ["ground.G", "piston.C"], axis = [1, 0] }
"#;
const SPACE: &str = r#"
[bodies.ground]
points = { A = [0, 0, 0], G = [0, 0.02, 0], Q = [0.4, 0.3, 0] }
[bodies.crank]
points = { A = [0, 0, 0], B = [0.08, 0, 0] }
mass = 2.0
center = [0.015, 0.002, 0]
inertia = [0.0024, 0.0028, 0.004]
[bodies.rod]
points = { B = [0, 0, 0], C = [0.28, 0, 0] }
mass = 1.2
center = [0.095, 0.003, 0]
inertia = [0.0051, 0.006, 0.0085]
[bodies.piston]
points = { C = [0, 0, 0] }
mass = 0.9
center = [0.012, 0.004, 0]
inertia = [0.00036, 0.00042, 0.0006]
[joints]
A = { revolute = ["ground.A", "crank.A"], axis = [0, 0, 1] }
B = { cylindrical = ["crank.B", "rod.B"], axis = [0, 0, 1] }
C = { spherical = ["rod.C", "piston.C"] }
guide = { prismatic = ["ground.G", "piston.C"], axis = [1, 0, 0] }
"#;
/// Where its bodies are at the start, with the crank at 1.2448807… rad.
const PLACES: [&str; 2] = [
    "crank = 1.2449\nrod = -0.2006\n",
    "crank = { turn = [0, 0, 1.2449] }\nrod = { at = [0.0256, 0.0758, 0], turn = [0, 0, -0.2006] }\n\
     piston = { at = [0.3, 0.02, 0] }\n",
];
const WEIGHT: [&str; 2] = [
    "weight = { gravity = [0, -9.81] }\n",
    "weight = { gravity = [0, -9.81, 0] }\n",
];
/// Driven at the slide.
const SLIDE: [&str; 2] = [
    "[actuators]\ns = { length = \"guide\" }\n[assembly]\ns = 0.3\n",
    "[actuators]\ns = { travel = \"guide\" }\n[assembly]\ns = 0.3\n",
];

/// The slider-crank with a driver, loads and a last section, in the plane and in space.
pub(super) fn both(driver: [&str; 2], loads: [&str; 2], rest: &str) -> (PlaneScene, SpaceScene) {
    let text = |k: usize, bodies: &str| {
        format!(
            "{bodies}{}{}[loads]\n{}{}{rest}",
            driver[k], PLACES[k], WEIGHT[k], loads[k]
        )
    };
    let plane = PlaneScene::parse("plane", &text(0, PLANE)).unwrap_or_else(|e| panic!("{e}"));
    let space = SpaceScene::parse("space", &text(1, SPACE)).unwrap_or_else(|e| panic!("{e}"));
    (plane, space)
}

pub(super) fn column(table: &Table, name: &str) -> Vec<f64> {
    let k = table.columns.iter().position(|c| c.name == name);
    let k = k.unwrap_or_else(|| panic!("no column {name}"));
    table.rows.iter().map(|row| row[k]).collect()
}

/// The largest difference of two columns, relative to the largest value.
pub(super) fn difference(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    let size = one.iter().fold(0.0_f64, |size, v| size.max(v.abs()));
    assert!(size > 0.0);
    let pairs = one.iter().zip(other);
    pairs.fold(0.0_f64, |off, (a, b)| off.max((a - b).abs())) / size
}

pub(super) fn analysed(scene: &SpaceScene, analysis: Analysis) -> TrajectoryOutcome {
    let done =
        analyse_trajectory_within(scene, analysis, None, PictureSpan::default(), &no_progress);
    done.unwrap_or_else(|e| panic!("{e:?}"))
}

fn message(error: &StudyError) -> String {
    let mut text = error.to_string();
    let mut source = std::error::Error::source(error);
    while let Some(of) = source {
        write!(text, " {of}").expect("text");
        source = of.source();
    }
    format!("{text} {error:?}")
}

/// Every load with a force of its own, the travel of the slide, and a named coordinate: the columns of the plane. Largest difference
/// seen 1.9e-15.
#[test]
fn loads_travels_and_named_coordinates_have_the_columns_of_the_plane() {
    let crank = [
        "[actuators]\nphi = { angle = [\"ground\", \"crank\"] }\n[coordinates]\nreach = { length = [\"ground.Q\", \"piston.C\"] }\n[assembly]\nphi = 1.2\n",
        "[actuators]\nphi = { angle = \"A\" }\n[coordinates]\nreach = { length = [\"ground.Q\", \"piston.C\"] }\n[assembly]\nphi = 1.2\n",
    ];
    let shared = "spring = { spring = [\"ground.Q\", \"rod.C\"], stiffness = 300, free-length = 0.2 }\n\
                  damper = { damper = [\"ground.Q\", \"rod.C\"], damping = 20 }\n\
                  push = { point-to-point-force = [\"ground.Q\", \"rod.C\"], magnitude = \"5*reach\" }\n\
                  along = { slide-force = \"guide\", magnitude = \"-3*reach.velocity\" }\n";
    let plane = "coil = { torsion-spring = [\"ground\", \"crank\"], stiffness = 2, free-angle = 0.4 }\n\
                 brake = { rotational-damper = [\"ground\", \"crank\"], damping = 0.3 }\n\
                 couple = { torque = [\"ground\", \"crank\"], magnitude = 1.5 }\n";
    let space = "coil = { torsion-spring = \"A\", stiffness = 2, free-angle = 0.4 }\n\
                 brake = { rotational-damper = \"A\", damping = 0.3 }\n\
                 couple = { torque = [\"ground\", \"crank\"], axis = [0, 0, 1], magnitude = 1.5 }\n";
    let loads = [plane, space].map(|own| format!("{shared}{own}"));
    let motion =
        "[prescribed]\nduration = 0.7\npoints = 31\nphi = { expression = \"1.2 + 4*t + 2*t^2\" }\n";
    let (plane, space) = both(crank, [&loads[0], &loads[1]], motion);
    let done = analyse_trajectory(&plane, Analysis::Kinetostatics, None, &no_progress);
    let plane = written(&done.unwrap_or_else(|e| panic!("{e:?}")));
    let found = analysed(&space, Analysis::Kinetostatics);
    assert!(
        found
            .outcome
            .summary
            .contains("estimated rounding error below")
    );
    let space = written(&found);
    let forces = ["spring", "damper", "push", "along"].map(|name| format!("{name}.load_force"));
    let moments = ["coil", "brake", "couple"].map(|name| format!("{name}.load_moment"));
    let motions = ["guide.travel", "reach"]
        .map(|name| ["", ".velocity", ".acceleration"].map(|suffix| format!("{name}{suffix}")));
    let names = forces
        .iter()
        .chain(&moments)
        .chain(motions.iter().flatten());
    let mut largest = 0.0_f64;
    for name in names {
        let off = difference(&column(&plane, name), &column(&space, name));
        assert!(off < 1.5e-13, "{name}: {off:.1e}");
        largest = largest.max(off);
    }
    println!("columns of loads and coordinates: {largest:.1e}");
}

/// The range of a coordinate that a slide has between limit positions, with the margin of the plane: m and ½m′ there, which grow with the
/// power −1 and −2 of the distance from a limit position that is found to 1e-6 of that margin. Largest difference seen 4e-6.
#[test]
fn a_driven_slide_has_the_range_of_the_plane() {
    let (plane, space) = both(SLIDE, ["", ""], "");
    let text = describe_scene(&space).unwrap_or_else(|e| panic!("{e:?}"));
    assert!(text.contains("limit positions at both ends"), "{text}");
    let plane = reduce(&plane, None, None).unwrap_or_else(|e| panic!("{e:?}"));
    let space = reduce(&space, None, None).unwrap_or_else(|e| panic!("{e:?}"));
    let number = |of: &dwell_study::Outcome, name: &str| {
        let mut all = of.record.numbers.iter();
        all.find(|n| n.name == name).map(|n| n.value)
    };
    let names: Vec<&str> = plane
        .record
        .numbers
        .iter()
        .map(|n| n.name.as_str())
        .collect();
    let mut compared = 0;
    for name in names
        .into_iter()
        .filter(|name| name.starts_with("m.") || name.starts_with("half_dm."))
    {
        let both = number(&plane, name).zip(number(&space, name));
        let (a, b) = both.unwrap_or_else(|| panic!("no {name}"));
        assert!((a - b).abs() < 1e-4 * a.abs(), "{name}: {a} {b}");
        compared += 1;
    }
    assert!(compared >= 2, "{compared}");
}

pub(super) fn by_dop853() -> MotionSolver {
    MotionSolver::Settings(SolverSettings {
        method: dwell_dynamics::Method::Dop853,
        rtol: 1e-12,
        atol: 1e-12,
        sample_interval: Some(0.01),
        ..SolverSettings::default()
    })
}

pub(super) fn simulated(
    scene: &SpaceScene,
    solver: &MotionSolver,
    times: Option<&[f64]>,
) -> TrajectoryOutcome {
    let done = simulate_within(scene, solver, times, PictureSpan::default(), &no_progress);
    done.unwrap_or_else(|e| panic!("{e:?}"))
}

/// A free motion that comes to the dead point of its slide goes on in another coordinate: all columns beside those of the plane, whose
/// atlas shares nothing with it. Largest difference seen 5.8e-11, of a reaction.
#[test]
fn a_free_motion_passes_the_dead_points_of_its_coordinate() {
    let motion = "[motion]\nduration = 1\ninitial-velocity = -1\nevents.low = { reaches = \"s\", value = 0.25 }\n";
    let (plane, space) = both(SLIDE, ["", ""], motion);
    let plane =
        simulate_with(&plane, &by_dop853(), None, &no_progress).unwrap_or_else(|e| panic!("{e:?}"));
    assert!(plane.early_stop.is_none(), "{:?}", plane.early_stop);
    let plane_table = written(&plane);
    let found = simulated(&space, &by_dop853(), None);
    assert!(found.early_stop.is_none(), "{:?}", found.early_stop);
    let summary = &found.outcome.summary;
    assert!(
        summary.contains("coordinate changed from s (next to its dead point)"),
        "{summary}"
    );
    let table = written(&found);
    let names = [
        "s",
        "s.velocity",
        "s.acceleration",
        "crank.B.x",
        "crank.B.y",
        "rod.C.vx",
        "piston.C.ax",
        "A.x",
        "A.y",
        "B.x",
        "C.y",
        "energy.kinetic",
    ];
    let mut largest = 0.0_f64;
    for name in names {
        let off = difference(&column(&plane_table, name), &column(&table, name));
        assert!(off < 5e-9, "{name}: {off:.1e}");
        largest = largest.max(off);
    }
    println!("through dead points: {largest:.1e}");
    // The event is met in every coordinate, and the energy is that of the start.
    let count = |of: &TrajectoryOutcome| {
        let mut numbers = of.outcome.record.numbers.iter();
        numbers
            .find(|n| n.name == "event.low.count")
            .map(|n| n.value)
    };
    assert_eq!(count(&plane), count(&found));
    let balance = column(&table, "energy.balance_error");
    assert!(
        balance.iter().all(|error| error.abs() < 1e-9),
        "{balance:?}"
    );
    // At wanted times it is the same motion.
    let times = [0.05, 0.1234, 0.5, 0.77];
    let wanted = written(&simulated(&space, &by_dop853(), Some(&times)));
    let (t, s) = (column(&wanted, "t"), column(&wanted, "s"));
    let at = |t: f64| {
        let rows = column(&table, "t");
        rows.iter().position(|row| (row - t).abs() < 1e-12)
    };
    for (t, s) in t.iter().zip(&s) {
        if let Some(row) = at(*t) {
            assert!((column(&table, "s")[row] - s).abs() < 1e-9);
        }
    }
    assert_eq!(t.len(), times.len() + 1);
}

/// A cylinder between two points has no other coordinate to go on in: its motion ends at its dead point, by that name, after few steps.
#[test]
fn a_motion_ends_at_a_dead_point_that_no_other_coordinate_takes_it_through() {
    let text = r#"
        [bodies.ground]
        points = { O = [0, 0, 0], Q = [0.3, 0.1, 0] }
        [bodies.arm]
        points = { O = [0, 0, 0], R = [0.2, 0, 0] }
        mass = 2.0
        center = [0.12, 0.01, 0]
        inertia = [0.02, 0.02, 0.02]
        [joints]
        O = { revolute = ["ground.O", "arm.O"], axis = [0, 0, 1] }
        link = { distance = ["ground.Q", "arm.R"] }
        [actuators]
        jack = { length = "link" }
        [assembly]
        jack = 0.25
        arm = { turn = [0, 0, 1.0] }
        [loads]
        weight = { gravity = [0, -9.81, 0] }
        [motion]
        duration = 1
        initial-velocity = 0.5
    "#;
    let scene = SpaceScene::parse("jack", text).unwrap_or_else(|e| panic!("{e}"));
    let solver = MotionSolver::Settings(SolverSettings::default());
    let done = simulated(&scene, &solver, None);
    let error = message(done.early_stop.as_ref().expect("an end"));
    assert!(
        error.contains("jack") && error.contains("drive a joint that moves on"),
        "{error}"
    );
    let mut numbers = done.outcome.record.numbers.iter();
    let steps = numbers.find(|n| n.name == "steps").map(|n| n.value);
    assert!(steps.is_some_and(|steps| steps < 2000.0), "{steps:?}");
    let s = column(&written(&done), "jack");
    let limit = 0.2 + 0.1_f64.sqrt();
    // 1e-5 of the range in front of it.
    assert!(
        s.last().is_some_and(|last| (last - limit).abs() < 1e-4),
        "{s:?}"
    );
}

/// Rows end where the table of a load does, and say where that is; a motion that would end later for another reason does not.
#[test]
fn the_end_of_a_table_is_named_where_it_is_reached() {
    let table = "force = { force = \"piston.C\", direction = [-1, 0, 0], magnitude = { table = [[0.25, 1], [0.3, 2], [0.4, 3]], of = \"s\" } }\n";
    let (_, space) = both(
        SLIDE,
        ["", table],
        "[motion]\nduration = 1\ninitial-velocity = -1\n",
    );
    let done = simulated(&space, &by_dop853(), None);
    let error = message(done.early_stop.as_ref().expect("an end"));
    assert!(
        error.contains("the table of load `force`") && error.contains("soon after t = 0.0"),
        "{error}"
    );
}

/// Requested columns are those of the tables; what no analysis has is refused at its place.
#[test]
fn columns_are_requested_by_name() {
    let rest = "[requests]\nvariables = [\"rod.C.x\", \"guide.travel\"]\npaths = [\"rod.C\"]\n[prescribed]\nduration = 1\npoints = 5\ns = { sinusoid = { amplitude = 0.02, period = 1 } }\n";
    let (_, space) = both(SLIDE, ["", ""], rest);
    let table = written(&analysed(&space, Analysis::Kinetostatics));
    let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "t",
            "s",
            "guide.travel",
            "guide.travel.velocity",
            "guide.travel.acceleration",
            "rod.C.x"
        ]
    );
    let (_, space) = both(SLIDE, ["", ""], &rest.replace("rod.C.x", "rod.C.angle"));
    for analysis in [
        Analysis::Kinematics,
        Analysis::Statics,
        Analysis::Kinetostatics,
    ] {
        let done =
            analyse_trajectory_within(&space, analysis, None, PictureSpan::default(), &no_progress);
        let error = message(&done.expect_err("refused"));
        assert!(
            error.contains("there is no column `rod.C.angle`"),
            "{error}"
        );
    }
    assert!(describe_scene(&space).is_err());
}

/// `check` says what a scene has.
#[test]
fn a_scene_is_described_with_its_loads_and_motions() {
    let rest = "[drives]\nmotor = { applied-force = \"s\", magnitude = 2 }\n[motion]\nduration = 1\n[coordinate-sweep]\ns = [0.25, 0.35]\n";
    let (_, space) = both(
        SLIDE,
        [
            "",
            "spring = { spring = [\"ground.Q\", \"rod.C\"], stiffness = 300, free-length = 0.2 }\n",
        ],
        rest,
    );
    let text = describe_scene(&space).unwrap_or_else(|e| panic!("{e:?}"));
    for line in [
        "overall size at the start: 0.3 by",
        "moving mass 4.1 kg, with its centre of mass at (",
        "    rod: 1.2 kg, [0.0051, 0.006, 0.0085] kg m² about its centre of mass, in its axes",
        "    weight: gravity, 9.81 m/s²",
        "    spring: spring between ground and rod, 300 N/m",
        "    motor: applied force on s, 2 N",
        "coordinate sweep: s from 0.25 m to 0.35 m, 361 positions",
        "free motion: s from 0.3 m at 0 m/s, for 1 s",
    ] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
}
