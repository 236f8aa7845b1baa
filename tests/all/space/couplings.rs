//! Couplings of coordinates in space: planar scenes with couplings of every kind of coordinate, placed obliquely in space, where their
//! m, ½m′ and coupling forces are those of the plane.

use dwell_geometry::JointId;
use dwell_geometry::space::{CouplingAction, Joint, JointKind};
use dwell_kinetostatics::space::{Axes, Component, Model as SpaceModel, Reaction};
use dwell_kinetostatics::{Coefficients, Model};
use dwell_scene::PlaneScene;
use dwell_tests::fixtures;
use dwell_tests::lifted::{Lifted, lifted_scene};

/// What is allowed of the largest value of a quantity. Seen: 2.7e-15.
const TOLERANCE: f64 = 2e-13;

/// A crank-rocker whose rocker's angle, which nobody drives, turns a disc.
const BEHIND_A_LOOP: &str = r#"
[bodies]
ground = { points = { A = [0, 0], D = [0.4, 0], E = [0.1, 0.5] } }
crank = { points = { A = [0, 0], B = [0.1, 0] }, mass = 1, center = [0.05, 0.01], inertia = 0.01 }
rod = { points = { B = [0, 0], C = [0.4, 0] }, mass = 2, center = [0.2, 0.02], inertia = 0.04 }
rocker = { points = { D = [0, 0], C = [0.3, 0] }, mass = 1.5, center = [0.15, 0.03], inertia = 0.02 }
disc = { points = { E = [0, 0] }, mass = 3, center = [0.02, 0.03], inertia = 0.03 }
[joints]
A = { revolute = ["ground.A", "crank.A"] }
B = { revolute = ["crank.B", "rod.B"] }
C = { revolute = ["rocker.C", "rod.C"] }
D = { revolute = ["ground.D", "rocker.D"] }
E = { revolute = ["ground.E", "disc.E"] }
law = { coupling = ["turn", "swing"], expression = "2*x + 0.3*sin(3*x)" }
[actuators]
phi = { angle = ["ground", "crank"] }
[coordinates]
swing = { angle = ["ground", "rocker"] }
turn = { angle = ["ground", "disc"] }
[assembly]
phi = 0.7
rod = 0.7
rocker = 1.6
disc = 3.2
"#;

/// The follower is driven, and turns the cam by the inverse of its law.
const INVERSE: &str = r#"
[bodies]
ground = { points = { A = [0, 0], G = [0.2, 0] } }
cam = { points = { A = [0, 0] }, mass = 1, center = [0.05, 0.01], inertia = 0.01 }
follower = { points = { G = [0, 0] }, mass = 2, center = [0.2, 0.02], inertia = 0.04 }
[joints]
A = { revolute = ["ground.A", "cam.A"] }
guide = { prismatic = ["ground.G", "follower.G"], axis = [1, 2] }
law = { coupling = ["rise", "turn"], expression = "0.1*x + 0.02*sin(x)" }
[actuators]
s = { length = "guide" }
[coordinates]
rise = { travel = "guide" }
turn = { angle = ["ground", "cam"] }
[assembly]
s = 0.05
cam = 0.4
"#;

/// The length of a link is a function of the crank's angle, and an angle one of another length.
const LENGTHS: &str = r#"
[bodies]
ground = { points = { A = [0, 0], D = [0.5, 0], E = [0.1, 0.5] } }
crank = { points = { A = [0, 0], B = [0.1, 0] }, mass = 1, center = [0.05, 0.01], inertia = 0.01 }
arm = { points = { D = [0, 0], C = [0.3, 0] }, mass = 1.5, center = [0.15, 0.03], inertia = 0.02 }
disc = { points = { E = [0, 0] }, mass = 3, center = [0.02, 0.03], inertia = 0.03 }
[joints]
A = { revolute = ["ground.A", "crank.A"] }
D = { revolute = ["ground.D", "arm.D"] }
E = { revolute = ["ground.E", "disc.E"] }
reach = { coupling = ["gap", "phi"], expression = "0.45 + 0.03*sin(x)" }
law = { coupling = ["turn", "span"], expression = "3*x - x^2" }
[actuators]
phi = { angle = ["ground", "crank"] }
[coordinates]
gap = { length = ["crank.B", "arm.C"] }
span = { length = ["ground.A", "arm.C"] }
turn = { angle = ["ground", "disc"] }
[assembly]
phi = 0.7
arm = 1.8
disc = 1.2
"#;

fn planar(text: &str) -> PlaneScene {
    PlaneScene::parse("couplings.toml", text).unwrap_or_else(|e| panic!("{e:?}"))
}

/// The couplings' components in space.
fn couplings(lifted: &Lifted) -> Vec<Reaction> {
    let joints = lifted.mechanism.joints.iter().enumerate();
    let of = |(j, joint): (usize, &Joint)| {
        let JointKind::Coupling { action, .. } = joint.kind else {
            return None;
        };
        let component = match action {
            CouplingAction::Couple => Component::Moment(Axes::Joint, 2),
            CouplingAction::Force => Component::Force(Axes::Joint, 2),
            CouplingAction::Line => Component::Force(Axes::Line, 0),
        };
        Some(Reaction {
            joint: JointId(j),
            component,
        })
    };
    joints.filter_map(of).collect()
}

/// Compares a scene with itself in space; the largest differences of m, ½m′, and of a and b of the couplings, over the largest values.
fn compare(scene: &PlaneScene) -> [f64; 4] {
    let (_, lifted) = lifted_scene(scene).expect("all joints exist in space");
    let couplings = couplings(&lifted);
    assert!(!couplings.is_empty());
    let all = scene.mechanism.reactions();
    let wanted = all.into_iter().filter(|reaction| {
        let kind = scene.mechanism.joints[reaction.joint.0].kind;
        matches!(kind, dwell_geometry::JointKind::Coupling(_))
    });
    let wanted: Vec<_> = wanted.collect();
    let start = scene.assembly.to_configuration();
    let plane = Model::new(&scene.mechanism, &scene.masses, &start, &wanted).expect("a model");
    let space = SpaceModel::new(
        &lifted.mechanism,
        &lifted.masses,
        &lifted.assembly,
        &couplings,
    );
    let space = space.unwrap_or_else(|e| panic!("{e}"));
    let ranges = [plane.plan().range(), space.plan().range()];
    let limits = ranges.map(|range| range.limits().unwrap_or((-3.0, 3.5)));
    let (from, to) = (limits[0].0.max(limits[1].0), limits[0].1.min(limits[1].1));
    let (mut p_work, mut s_work) = (plane.workspace(), space.workspace());
    let (mut p, mut s): (Coefficients, Coefficients) =
        (plane.coefficient_buffer(), space.coefficient_buffer());
    let (mut differences, mut largest) = ([0.0_f64; 4], [0.0_f64; 4]);
    for k in 0..24 {
        let q = from + (to - from) * (0.02 + 0.96 * f64::from(k) / 23.0);
        plane
            .reduce(q, &mut p_work, &mut p)
            .unwrap_or_else(|e| panic!("{e}"));
        space
            .reduce(q, &mut s_work, &mut s)
            .unwrap_or_else(|e| panic!("{e}"));
        let mut record = |k: usize, found: f64, wanted: f64| {
            differences[k] = differences[k].max((found - wanted).abs());
            largest[k] = largest[k].max(wanted.abs());
        };
        record(0, s.m, p.m);
        record(1, s.half_dm, p.half_dm);
        let both = [(&s.a, &p.a), (&s.b, &p.b)];
        for (k, (of_space, of_plane)) in both.into_iter().enumerate() {
            for (found, wanted) in of_space.iter().zip(of_plane) {
                record(2 + k, *found, *wanted);
            }
        }
    }
    std::array::from_fn(|k| differences[k] / largest[k])
}

/// Laws of each kind; a coupling behind a loop; one that is inverted; and lengths.
#[test]
fn couplings_in_space_are_those_of_the_plane() {
    let capability = {
        let path = fixtures::repository_root().join("validation/capabilities/coupling-laws.toml");
        std::fs::read_to_string(path).expect("a scene")
    };
    let cases = [
        ("laws", capability.as_str()),
        ("behind a loop", BEHIND_A_LOOP),
        ("inverse", INVERSE),
        ("lengths", LENGTHS),
    ];
    for (name, text) in cases {
        let worst = compare(&planar(text));
        println!("{name}: {worst:?}");
        assert!(
            worst.iter().all(|part| *part < TOLERANCE),
            "{name}: {worst:?}"
        );
    }
}
