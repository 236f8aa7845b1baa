//! Friction that holds, jams or locks itself, as it is printed, against closed forms.

use crate::test_dir::{Run, TestDir, home};

const G: f64 = 9.81;

fn simulate(text: &str, options: &[&str]) -> (TestDir, Run) {
    let dir = TestDir::new();
    dir.put("friction.toml", text);
    let run = dir.run(&[&["simulate", "friction.toml", "--out", "o"], options].concat());
    (dir, run)
}

/// Masses of the block and the rod, and the distance and the moment of inertia of the rod's centre.
const BLOCK: f64 = 0.1;
const ROD: f64 = 1.0;
const ARM: f64 = 1.0;
const INERTIA: f64 = 0.4;

/// A rod pinned to a block that slides on a rough guide.
fn rod_on_a_guide(angle: f64, velocity: f64, coefficient: f64, duration: f64) -> String {
    format!(
        r#"
[bodies]
ground = {{ points = {{ A = [0, 0] }} }}
block = {{ points = {{ A = [0, 0] }}, mass = {BLOCK}, center = [0, 0], inertia = 0.001 }}
rod = {{ points = {{ A = [0, 0] }}, mass = {ROD}, center = [{ARM}, 0], inertia = {INERTIA} }}
[joints]
guide = {{ prismatic = ["ground.A", "block.A"], axis = [1, 0] }}
pin = {{ revolute = ["block.A", "rod.A"] }}
[actuators]
x = {{ length = "guide" }}
q = {{ angle = ["ground", "rod"] }}
[assembly]
x = 0
q = {angle}
[loads]
weight = {{ gravity = [0, -{G}] }}
[friction]
guide = {{ coefficient = {coefficient} }}
[motion]
initial-velocity = {{ x = {velocity}, q = 0 }}
duration = {duration}
"#
    )
}

/// Painlevé: friction reduces the effective inertia of the block by the force that its acceleration lays on the guide. With
/// µ ≥ (M J / (m l)² − sin² q) / |sin q cos q| nothing is left of it, where the block moves towards the rod's lower end.
#[test]
fn a_rod_jams_from_the_critical_coefficient_on() {
    let angle = 2.1_f64;
    let (about_pin, all) = (INERTIA + ROD * ARM * ARM, BLOCK + ROD);
    let (s, c) = angle.sin_cos();
    let critical = (all * about_pin / (ROD * ARM).powi(2) - s * s) / (s * c).abs();
    let run = |velocity: f64, part: f64| {
        simulate(
            &rod_on_a_guide(angle, velocity, part * critical, 0.001),
            &[],
        )
        .1
    };
    let slides = run(1.0, 0.999);
    assert_eq!(slides.status, Some(0), "{}", slides.err);
    let jams = run(1.0, 1.001);
    assert_eq!(jams.status, Some(2), "{}", jams.out);
    let message = "self-locking by friction: its effective inertia is not";
    assert!(jams.err.contains(message), "{}", jams.err);
    assert!(jams.err.contains("guide = {"), "{}", jams.err);
    // The other way friction adds to the inertia.
    let back = run(-1.0, 1.001);
    assert_eq!(back.status, Some(0), "{}", back.err);
}

/// Where sliding is not possible, rest is: the rod swings about the block, which holds exactly.
#[test]
fn a_block_that_could_not_slide_holds() {
    let (begin, duration) = (2.5_f64, 0.7);
    let (dir, run) = simulate(
        &rod_on_a_guide(begin, 0.0, 6.0, duration),
        &["--method", "dop853"],
    );
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let table = std::fs::read_to_string(dir.0.join("o/friction-motion.csv")).unwrap();
    let head: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|h| h.starts_with(name)).unwrap();
    let [x, q, q_dot] = ["x [m]", "q [rad]", "q.velocity"].map(column);
    let last: Vec<&str> = table.lines().last().unwrap().split(',').collect();
    let [x, q, q_dot] = [x, q, q_dot].map(|k| last[k].parse::<f64>().unwrap());
    assert!(x.abs() < 1e-14, "{x}");
    // Energy of a pendulum about the block.
    let about_pin = INERTIA + ROD * ARM * ARM;
    let expected = (2.0 * ROD * G * ARM * (begin.sin() - q.sin()) / about_pin).sqrt();
    assert!((q_dot / expected - 1.0).abs() < 1e-9, "{q_dot} {expected}");
}

/// A wedge under a load: it holds itself until tan(α − ρ) = µ (M + m) / M, with tan ρ = µ, where M is lifted by the wedge m.
#[test]
fn a_wedge_locks_itself_up_to_its_angle() {
    let (lifted, wedge, coefficient) = (5.0, 1.0, 0.2_f64);
    let limit = (coefficient * (lifted + wedge) / lifted).atan() + coefficient.atan();
    let moves = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let text = format!(
            r#"
[bodies]
ground = {{ points = {{ A = [0, 0], B = [0, 1] }} }}
wedge = {{ points = {{ A = [0, 0] }}, mass = {wedge}, center = [0, 0], inertia = 0.01 }}
lifted = {{ points = {{ B = [0, 0], C = [0, -1] }}, mass = {lifted}, center = [0, 0], inertia = 0.01 }}
[joints]
floor = {{ prismatic = ["ground.A", "wedge.A"], axis = [1, 0] }}
wall = {{ prismatic = ["ground.B", "lifted.B"], axis = [0, 1] }}
face = {{ prismatic = ["wedge.A", "lifted.C"], axis = [{c}, {s}] }}
[actuators]
x = {{ length = "floor" }}
[loads]
weight = {{ gravity = [0, -{G}] }}
[friction]
floor = {{ coefficient = {coefficient} }}
face = {{ coefficient = {coefficient} }}
[motion]
initial-velocity = {{ x = 0 }}
duration = 0.1
"#
        );
        let (_, run) = simulate(&text, &["--pictures", "none"]);
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        !run.out.contains("it stays at rest")
            && !run.out.contains("stays at rest: no force moves it")
    };
    assert!(!moves(limit - 1e-6));
    assert!(moves(limit + 1e-6));
}

/// A table has the reactions that are requested, whatever others friction needs; in the plane and in space.
#[test]
fn tables_have_the_requested_reactions_alone() {
    let planar =
        std::fs::read_to_string(home().join("validation/slider-crank-friction/scene.toml"))
            .unwrap()
            .replace("paths = [\"rod.B\", \"piston.C\"]", "reactions = [\"A.x\"]");
    let space = std::fs::read_to_string(home().join("validation/spatial/rssr.toml")).unwrap()
        + "\n[friction]\nA = { coefficient = 0.2, radius = 0.02 }\n[requests]\nreactions = [\"A.z\"]\n";
    for (name, text, reaction) in [("planar", planar, "A.x"), ("space", space, "A.z")] {
        let dir = TestDir::new();
        dir.put("friction.toml", &text);
        let arguments = [
            "reduce",
            "friction.toml",
            "--table-accuracy",
            "1e-8",
            "--out",
            "o",
        ];
        let run = dir.run(&arguments);
        assert_eq!(run.status, Some(0), "{name}: {}", run.err);
        let table = std::fs::read_to_string(dir.0.join("o/friction-reduced.csv")).unwrap();
        let head = table.lines().next().unwrap();
        let of: Vec<&str> = head.split(',').filter(|h| h.contains(".a [")).collect();
        assert!(of.len() == 1 && of[0].starts_with(reaction), "{head}");
        assert!(head.contains("A.friction.w"), "{head}");
    }
}

/// An error of friction in space points to its table, names the joint and says what to try.
#[test]
fn errors_of_friction_in_space_point_into_the_file() {
    let bennett = std::fs::read_to_string(home().join("validation/spatial/bennett.toml")).unwrap();
    for (friction, words) in [
        (
            "B = { coefficient = 0.1, radius = 0.01 }",
            [
                "the friction of joint `B` depends on a reaction that is not determined",
                "this friction",
                "spherical or a cylindrical joint",
            ],
        ),
        (
            "B = { coefficient = 0.1 }",
            ["`radius`", "friction of `B`", "the radius of the pin"],
        ),
    ] {
        let dir = TestDir::new();
        dir.put(
            "bennett.toml",
            format!("{bennett}\n[friction]\n{friction}\n"),
        );
        let run = dir.run(&["kinetostatics", "bennett.toml", "--out", "o"]);
        assert_eq!(run.status, Some(2), "{}", run.out);
        let said = run.err.split_whitespace().collect::<Vec<_>>().join(" ");
        let said = said.replace("│ ", "");
        for words in words.into_iter().chain([friction]) {
            assert!(said.contains(words), "{words}: {}", run.err);
        }
    }
}
