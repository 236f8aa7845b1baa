//! Slips of units: each is warned of, in the plane and in space, and no case is.

use crate::spans::SceneLocation;
use crate::{Scene, SceneFile};
use std::path::{Path, PathBuf};

fn doubts(file: &SceneFile) -> Vec<&str> {
    let messages = file.warnings.iter().map(|w| w.message.as_str());
    let is_doubt = |m: &&str| m.starts_with("is a unit meant") || m.contains("but no mass");
    messages.filter(is_doubt).collect()
}

fn doubts_of(text: &str) -> String {
    let scene = Scene::parse("scene.toml", text).expect("a scene");
    doubts(&scene).join("\n")
}

/// A double pendulum.
fn pendulum(units: &str, tip: f64, angle: f64, gravity: f64) -> String {
    format!(
        r#"
[units]
{units}
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.upper]
points = {{ A = [0, 0], B = [{tip:?}, 0] }}
mass = 1.0
center = [{tip:?}, 0]
[bodies.lower]
points = {{ B = [0, 0], C = [{tip:?}, 0] }}
mass = 0.5
center = [{tip:?}, 0]
[joints]
A = {{ revolute = ["ground.A", "upper.A"] }}
B = {{ revolute = ["upper.B", "lower.B"] }}
[actuators.p]
angle = ["ground", "upper"]
[actuators.q]
angle = ["upper", "lower"]
[assembly]
p = {angle:?}
q = 0.0
[loads]
weight = {{ gravity = [0, -{gravity:?}] }}
"#
    )
}

/// An offset slider-crank in mm; the inertias in the unit given, and the line of the rod's mass.
fn slider_crank(unit: &str, inertias: [f64; 3], rod_mass: &str) -> String {
    let [crank, rod, piston] = inertias;
    format!(
        r#"
[units]
length = "mm"
inertia = "{unit}"
[bodies.ground]
points = {{ A = [0, 0], G = [0, 25] }}
[bodies.crank]
points = {{ A = [0, 0], B = [80, 0] }}
mass = 2.0
center = [15, 2]
inertia = {crank:?}
[bodies.rod]
points = {{ B = [0, 0], C = [280, 0] }}
{rod_mass}
center = [95, 3]
inertia = {rod:?}
[bodies.piston]
points = {{ C = [0, 0] }}
mass = 0.9
center = [12, 4]
inertia = {piston:?}
[joints]
A = {{ revolute = ["ground.A", "crank.A"] }}
B = {{ revolute = ["crank.B", "rod.B"] }}
C = {{ revolute = ["rod.C", "piston.C"] }}
guide = {{ prismatic = ["ground.G", "piston.C"], axis = [1, 0] }}
[actuators]
phi = {{ angle = ["ground", "crank"] }}
[assembly]
rod = 0.0
"#
    )
}

/// All cases, in the plane and in space, and their small scenes.
fn cases() -> Vec<Scene> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    let entries = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).expect("a folder").flatten();
        entries.map(|entry| entry.path()).collect()
    };
    let files = entries(&top).into_iter().flat_map(|path| {
        if path.is_dir() {
            entries(&path)
        } else {
            Vec::new()
        }
    });
    let is_scene = |path: &PathBuf| path.extension().is_some_and(|e| e == "toml");
    let read = |path: PathBuf| Scene::read(path).ok();
    files.filter(is_scene).filter_map(read).collect()
}

#[test]
fn slips_of_units_are_warned_of() {
    assert_eq!(doubts_of(&pendulum("", 0.3, 0.5, 9.81)), "");
    assert!(doubts_of(&pendulum("", 0.3, 0.5, 9810.0)).contains("9810 m/s²"));
    assert!(doubts_of(&pendulum("", 0.3, 30.0, 9.81)).contains("4.775 revolutions"));
    assert_eq!(doubts_of(&pendulum("angle = \"deg\"", 0.3, 30.0, 9.81)), "");
    assert!(doubts_of(&pendulum("", 300.0, 0.5, 9.81)).contains("up to 300 m"));
    let mm = |tip| pendulum("length = \"mm\"", tip, 0.5, 9.81);
    assert_eq!(doubts_of(&mm(300.0)), "");
    assert!(doubts_of(&mm(0.3)).contains("0.3 mm"));
}

#[test]
fn inertias_a_million_times_off_are_warned_of_with_both_units() {
    let si = [0.004, 0.0085, 0.0006];
    let mass = "mass = 1.2";
    assert_eq!(doubts_of(&slider_crank("kg m2", si, mass)), "");
    let small = doubts_of(&slider_crank("kg mm2", si, mass));
    assert!(
        small.contains("read in kg mm2, lengths in mm; was the inertia meant in kg m2?"),
        "{small}"
    );
    assert!(small.contains("`crank`, `rod` and `piston`"), "{small}");
    let large = doubts_of(&slider_crank("kg m2", si.map(|i| 1e6 * i), mass));
    assert!(
        large.contains("read in kg m2, lengths in mm; was the inertia meant in kg mm2?"),
        "{large}"
    );
    let missing = doubts_of(&slider_crank("kg m2", si, ""));
    assert_eq!(
        missing,
        "body `rod` has a centre of mass but no mass: it counts as 0 kg"
    );
    assert_eq!(doubts_of(&slider_crank("kg m2", si, "mass = 0")), "");
}

#[test]
fn no_case_is_doubted_and_every_case_with_inertias_a_million_times_off_is() {
    let (mut silent, mut scaled_cases, mut missed) = (0, 0, Vec::new());
    for scene in cases() {
        let file: &SceneFile = &scene;
        assert_eq!(doubts(file), Vec::<&str>::new(), "{}", file.name);
        silent += 1;
        let (size, has_both) = match &scene {
            Scene::Plane(s) => (
                s.mechanism.size(),
                s.masses.iter().any(|m| m.mass > 0.0 && m.inertia > 0.0),
            ),
            Scene::Space(s) => (
                s.mechanism.size(),
                s.masses.iter().any(|m| m.mass > 0.0 && m.inertia[0] > 0.0),
            ),
        };
        if !has_both || size == 0.0 {
            continue;
        }
        let numbers = file.body_numbers.iter();
        let inertias = numbers.filter(|n| matches!(n.location, SceneLocation::Inertia(_)));
        let inertias: Vec<_> = inertias.map(|n| (n.path.as_str(), n.value)).collect();
        for factor in [1e-6, 1e6] {
            let scaled = inertias.iter().map(|(path, i)| (*path, factor * i));
            let scaled: Vec<_> = scaled.collect();
            let scaled = scene.with_values(&scaled).expect("a scene");
            scaled_cases += 1;
            let is_doubt = |message: &&str| message.contains("radius of gyration");
            if !doubts(&scaled).iter().any(is_doubt) {
                missed.push(format!("{} by {factor:e}", file.name));
            }
        }
    }
    // Its wheels are far wider than their points are apart.
    assert_eq!(missed, ["teeth by 1e-6"]);
    assert!(
        silent >= 60 && scaled_cases >= 100,
        "{silent} {scaled_cases}"
    );
}
