//! Mechanisms whose bodies are reached over slides, or driven from a body that moves: every truth
//! holds on them as on the cases.

use dwell_kinetostatics::ReducedModel;
use dwell_scene::PlaneScene;
use dwell_validation::PlanSubject;
use dwell_verify::{Case, CheckedMechanism, spread, verify_all};

/// Judges a scene by every truth, and says how large its largest group is.
fn check_scene(name: &str, text: &str, largest: usize) {
    let scene = PlaneScene::parse(name, text).unwrap_or_else(|e| panic!("{name}: {e:?}"));
    let subject = PlanSubject::new(&scene).unwrap_or_else(|e| panic!("{name}: {e:?}"));
    let groups = subject.exact().model().plan().group_methods();
    assert!(
        groups.iter().all(|(n, _)| *n <= largest),
        "{name}: {groups:?}"
    );
    let range = subject.exact().range();
    let case = Case {
        mechanism: CheckedMechanism::Plane(&scene.mechanism, (&scene.masses).into()),
        range,
        positions: spread(range, 12),
    };
    for finding in verify_all(&case, &subject, &[]) {
        println!(
            "{name} {} {:e} {}",
            finding.key, finding.relative_difference, finding.worst_at
        );
        assert!(finding.pass, "{name}: {finding:#?} {groups:?} {range:?}");
    }
}

/// Elliptic trammel: a bar between two sliders of the ground, driven by its angle.
#[test]
fn trammel() {
    check_scene(
        "trammel",
        r#"
[bodies.ground]
points = { O = [0.1, -0.2] }
[bodies.one]
points = { A = [0.02, 0.01] }
mass = 1.0
center = [0.05, 0.03]
inertia = 0.01
[bodies.two]
points = { B = [0.0, 0.0] }
mass = 0.7
center = [0.02, -0.04]
inertia = 0.02
[bodies.bar]
points = { A = [0.0, 0.1], B = [0.5, 0.1] }
mass = 2.0
center = [0.2, 0.15]
inertia = 0.05
[joints]
x = { prismatic = ["ground.O", "one.A"], axis = [1, 0] }
y = { prismatic = ["two.B", "ground.O"], axis = [0, 1] }
A = { revolute = ["one.A", "bar.A"] }
B = { revolute = ["bar.B", "two.B"] }
[actuators.phi]
angle = ["ground", "bar"]
[assembly]
phi = 0.4
"#,
        2,
    );
}

/// Scotch yoke: a block on the crank's pin slides in a yoke that slides on the ground.
#[test]
fn scotch_yoke() {
    check_scene(
        "scotch yoke",
        r#"
[bodies.ground]
points = { O = [0, 0], S = [0.5, 0.02] }
[bodies.crank]
points = { O = [0, 0], P = [0.1, 0] }
mass = 2.0
center = [0.01, 0.02]
inertia = 0.02
[bodies.block]
points = { P = [0, 0] }
mass = 0.3
center = [0.01, 0.02]
inertia = 0.001
[bodies.yoke]
points = { Y = [0, 0], S = [0.4, 0.1] }
mass = 1.5
center = [0.2, 0.05]
inertia = 0.04
[joints]
O = { revolute = ["ground.O", "crank.O"] }
P = { revolute = ["block.P", "crank.P"] }
slot = { prismatic = ["yoke.Y", "block.P"], axis = [0.2, 1] }
guide = { prismatic = ["yoke.S", "ground.S"], axis = [1, 0.1] }
[actuators.phi]
angle = ["ground", "crank"]
[assembly]
phi = 0.3
"#,
        2,
    );
}

/// A cylinder pinned to the ground and to a boom, driven by the angle between rod and boom: a
/// relative drive, the rod carried by the cylinder's slide.
#[test]
fn boom_driven_at_the_rod() {
    check_scene(
        "boom",
        r#"
[bodies.ground]
points = { A = [0, 0], B = [0.6, -0.1] }
[bodies.boom]
points = { A = [0, 0], C = [0.5, 0.1], D = [1.0, 0.0] }
mass = 5.0
center = "D"
inertia = 0.3
[bodies.cylinder]
points = { B = [0, 0] }
mass = 2.0
center = [0.1, 0.01]
inertia = 0.02
[bodies.rod]
points = { C = [0.4, 0.03] }
mass = 1.0
center = [0.2, 0.0]
inertia = 0.01
[joints]
A = { revolute = ["ground.A", "boom.A"] }
B = { revolute = ["cylinder.B", "ground.B"] }
C = { revolute = ["rod.C", "boom.C"] }
slide = { prismatic = ["rod.C", "cylinder.B"], axis = [1, 0] }
[actuators.q]
angle = ["rod", "boom"]
[assembly]
q = -1.2
boom = 0.4
cylinder = 1.7
"#,
        4,
    );
}

/// Two slides in a row carry the pin of a bar whose other end is pinned to the ground.
#[test]
fn cross_slide() {
    check_scene(
        "cross slide",
        r#"
[bodies.ground]
points = { O = [0.3, 0.1], S = [0, 0] }
[bodies.carriage]
points = { S = [0, 0], T = [0.1, 0.2] }
mass = 3.0
center = [0.05, 0.1]
inertia = 0.05
[bodies.table]
points = { T = [0, 0.05], P = [0.2, 0.1] }
mass = 2.0
center = [0.1, 0.1]
inertia = 0.03
[bodies.bar]
points = { O = [0, 0], P = [0.25, 0] }
mass = 1.0
center = [0.1, 0.02]
inertia = 0.01
[joints]
x = { prismatic = ["carriage.S", "ground.S"], axis = [1, 0.3] }
y = { prismatic = ["carriage.T", "table.T"], axis = [0.2, 1] }
O = { revolute = ["ground.O", "bar.O"] }
P = { revolute = ["table.P", "bar.P"] }
[actuators.phi]
angle = ["bar", "ground"]
[assembly]
phi = 0.7
"#,
        2,
    );
}

/// A block slides along the driven crank and is pinned to a rod of the ground: a connecting rod on a
/// rail that moves.
#[test]
fn rod_on_a_turning_rail() {
    check_scene(
        "turning rail",
        r#"
[bodies.ground]
points = { O = [0, 0], R = [0.1, 0.05] }
[bodies.crank]
points = { O = [0, 0.02] }
mass = 1.0
center = [0.2, 0.01]
inertia = 0.02
[bodies.block]
points = { P = [0.01, 0.0] }
mass = 0.4
center = [0.03, 0.02]
inertia = 0.003
[bodies.rod]
points = { R = [0, 0], P = [0.4, 0] }
mass = 0.8
center = [0.15, -0.02]
inertia = 0.015
[joints]
O = { revolute = ["ground.O", "crank.O"] }
R = { revolute = ["rod.R", "ground.R"] }
P = { revolute = ["rod.P", "block.P"] }
slot = { prismatic = ["crank.O", "block.P"], axes = [[1, 0.1], [0.3, 1]] }
[actuators.phi]
angle = ["crank", "ground"]
[assembly]
phi = -0.3
rod = 0.3
"#,
        1,
    );
}
