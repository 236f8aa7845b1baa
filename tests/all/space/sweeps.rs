//! Sweeps and calibrations of scenes in space: against the same mechanism in the plane, and against each variant by itself.

use dwell_scene::{PlaneScene, SpaceScene};
use dwell_study::reduce::compute::ReducedScene as _;
use dwell_study::sweep::compute::ComputedSweep;
use dwell_study::{PreparedSpaceScene, compute_sweep, find_value, no_progress};

const IN_PLANE: &str = r#"
bodies.ground.points = { O = [0, 0] }
bodies.bob = { points = { O = [0, 0] }, mass = 2.0, center = [0.5, 0.1], inertia = 0.03 }
joints.O = { revolute = ["ground.O", "bob.O"] }
actuators.phi = { angle = ["ground", "bob"] }
assembly.phi = 0.0
loads.weight = { gravity = [0, -9.81] }
loads.spring = { torsion-spring = ["ground", "bob"], stiffness = 3.0, free-angle = 0.2 }
motion = { initial-velocity = 1.0, periods = 2 }
requests.reactions = ["O.x", "O.y"]
"#;

const IN_SPACE: &str = r#"
bodies.ground.points = { O = [0, 0, 0] }
bodies.bob = { points = { O = [0, 0, 0] }, mass = 2.0, center = [0.5, 0.1, 0.3], inertia = [0.02, 0.01, 0.03] }
joints.O = { revolute = ["ground.O", "bob.O"], axis = [0, 0, 1] }
actuators.phi = { angle = "O" }
assembly.phi = 0.0
loads.weight = { gravity = [0, -9.81, 0] }
loads.spring = { torsion-spring = "O", stiffness = 3.0, free-angle = 0.2 }
motion = { initial-velocity = 1.0, periods = 2 }
requests.reactions = ["O.x", "O.y"]
"#;

fn texts(all: &[&str]) -> Vec<String> {
    all.iter().map(|&text| text.to_owned()).collect()
}

fn column(swept: &ComputedSweep, name: &str) -> Vec<f64> {
    let mut columns = swept.table.columns.iter();
    let k = columns.position(|c| c.name == name);
    let k = k.unwrap_or_else(|| panic!("no column {name}"));
    swept.table.rows.iter().map(|row| row[k]).collect()
}

#[test]
fn a_pendulum_has_the_sweep_that_it_has_in_the_plane() {
    let plane = PlaneScene::parse("pendulum.toml", IN_PLANE).expect("a scene");
    let space = SpaceScene::parse("pendulum.toml", IN_SPACE).expect("a scene");
    let vary = texts(&["bob.mass=1:3:5", "bob.center[0]=0.4,0.6"]);
    let results = texts(&[
        "m",
        "period",
        "energy",
        "O",
        "phi.actuator_force",
        "motion.end",
        "motion.phi",
        "motion.O",
    ]);
    let plane = compute_sweep(&plane, &vary, None, 1, &results, &no_progress).expect("a sweep");
    let space = compute_sweep(&space, &vary, None, 1, &results, &no_progress).expect("a sweep");
    assert!(plane.messages.iter().all(Option::is_none));
    assert!(
        space.messages.iter().all(Option::is_none),
        "{:?}",
        space.messages
    );
    assert_eq!(plane.table.columns.len(), space.table.columns.len());
    assert!(plane.table.columns.len() > 20);
    for of in &plane.table.columns {
        let [wanted, found] = [&plane, &space].map(|swept| column(swept, &of.name));
        let scale = wanted.iter().map(|v| v.abs()).fold(0.0, f64::max);
        for (wanted, found) in wanted.iter().zip(&found) {
            // 3.4e-10 is seen of motions at their tolerance of 1e-10, and 5e-16 of the rest.
            let tolerance = if of.name.starts_with("motion") {
                3e-8
            } else {
                4e-14
            };
            let off = (wanted - found).abs();
            let scale = scale.max(1e-3);
            assert!(
                off <= tolerance * scale,
                "{}: {found} for {wanted}",
                of.name
            );
        }
    }
}

#[test]
fn columns_of_a_sweep_are_their_own_reactions_in_every_variant() {
    // With the axis out of a ground direction the couple about it is a reaction more.
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../validation/spatial/rssr.toml"
    );
    let text = std::fs::read_to_string(path).expect("a scene");
    let text = text.replace("[loads]\nweight = { gravity = [0, 0, -9.81] }\n", "");
    let text = text + "\n[motion]\nperiods = 1\ninitial-velocity = 12\n";
    let scene = SpaceScene::parse("rssr.toml", &text).expect("a scene");
    let vary = texts(&["joints.A.axis[0]=-0.01,0,0.01"]);
    let results = texts(&["energy", "B", "D.moment-x"]);
    let swept = compute_sweep(&scene, &vary, None, 1, &results, &no_progress).expect("a sweep");
    assert!(
        swept.messages.iter().all(Option::is_none),
        "{:?}",
        swept.messages
    );
    let energies = column(&swept, "energy");
    for (k, tilt) in [-0.01, 0.0, 0.01].into_iter().enumerate() {
        let variant = scene
            .with_values(&[("joints.A.axis[0]", tilt)])
            .expect("a variant");
        let prepared = PreparedSpaceScene::new(&variant).expect("a model");
        let all = prepared
            .coefficients(&prepared.positions(3600))
            .expect("positions");
        let names = prepared.reaction_units();
        for name in ["B.x", "B.y", "B.z", "D.moment-x"] {
            let r = names
                .iter()
                .position(|(own, _)| own == name)
                .expect("a reaction");
            let at = |c: &dwell_kinetostatics::Coefficients| {
                2.0 * energies[k] * (c.b[r] - c.a[r] * c.half_dm / c.m) / c.m
            };
            let largest = all.iter().map(|c| at(c).abs()).fold(0.0, f64::max);
            let found = column(&swept, &format!("{name}.max_abs"))[k];
            let off = found - largest;
            assert!(
                (0.0..1e-5 * largest).contains(&off.max(0.0)) && off > -1e-9 * largest,
                "{name} at {tilt}: {found} for {largest}"
            );
        }
    }
}

#[test]
fn a_calibration_in_space_finds_the_value_that_it_finds_in_the_plane() {
    let plane = PlaneScene::parse("pendulum.toml", IN_PLANE).expect("a scene");
    let space = SpaceScene::parse("pendulum.toml", IN_SPACE).expect("a scene");
    let plane = find_value(&plane, "bob.inertia", 1.6).expect("a value");
    let space = find_value(&space, "bob.inertia[2]", 1.6).expect("a value");
    assert!(
        (plane.value - space.value).abs() < 1e-11,
        "{plane:?} {space:?}"
    );
    assert!((plane.value - 0.03).abs() > 1e-3);
}

#[test]
fn a_variant_in_space_that_cannot_be_assembled_has_its_message() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../validation/spatial/rssr.toml"
    );
    let scene = SpaceScene::read(path).expect("a scene");
    let vary = texts(&["crank.points.B[0]=0.1,0.9"]);
    let swept = compute_sweep(&scene, &vary, None, 1, &texts(&["m", "B.x"]), &no_progress)
        .expect("a sweep");
    assert!(swept.messages[0].is_none());
    assert!(swept.messages[1].is_some());
    assert!(column(&swept, "m.max")[1].is_nan());
}
