//! Friction that holds makes equilibria intervals, whose ends are where the static limit is reached.

use dwell_scene::PlaneScene;
use dwell_study::compute_equilibria;

const G: f64 = 9.81;

/// The intervals in which a scene of one coordinate holds, rad or m.
fn intervals(text: &str) -> Vec<[f64; 2]> {
    let scene = PlaneScene::parse("scene.toml", text).unwrap_or_else(|e| panic!("{e:?}"));
    let results = compute_equilibria(&scene).unwrap_or_else(|e| panic!("{e}"));
    let neutral = results.found.iter().flat_map(|e| &e.neutral);
    neutral.filter_map(|direction| direction.extent).collect()
}

fn near(found: f64, expected: f64) {
    let error = (found - expected).abs();
    assert!(error < 1e-11, "{found:?} is {error:.1e} from {expected:?}");
}

/// A pendulum holds where |cos φ| ≤ µₛ r/l: below and above its pin, in intervals wide and narrow.
#[test]
fn a_pendulum_holds_by_its_pin_around_the_vertical() {
    for radius in [0.2, 0.02, 0.0005] {
        let text = format!(
            r#"
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.bar]
points = {{ A = [0, 0] }}
mass = 2.0
center = [0.3, 0]
inertia = 0.05
[joints]
pin = {{ revolute = ["ground.A", "bar.A"] }}
[actuators.phi]
angle = ["ground", "bar"]
[assembly]
phi = 0.3
[loads]
weight = {{ gravity = [0, -{G:?}] }}
[friction]
pin = {{ coefficient = 0.2, static-coefficient = 0.25, radius = {radius:?} }}
[motion]
duration = 1
"#
        );
        let half = (0.25 * radius / 0.3_f64).asin();
        let vertical = std::f64::consts::FRAC_PI_2;
        let found = intervals(&text);
        println!("{radius}: {found:?}, half {half}");
        assert_eq!(found.len(), 2, "{found:?}");
        for (found, middle) in found.iter().zip([-vertical, vertical]) {
            near(found[0], middle - half);
            near(found[1], middle + half);
        }
    }
}

/// A block on a spring holds where the spring does not pull with more than µₛ m g.
#[test]
fn a_block_on_a_spring_holds_within_its_static_limit() {
    let text = format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0], W = [-1, 0] }}
[bodies.block]
points = {{ A = [0, 0] }}
mass = 2.0
center = [0, 0]
[joints]
guide = {{ prismatic = ["ground.A", "block.A"], axis = [1, 0] }}
[actuators.x]
length = "guide"
[assembly]
x = 0.0
[loads]
weight = {{ gravity = [0, -{G:?}] }}
spring = {{ force = "block.A", direction = [1, 0], magnitude = "-50*(x + 0.1)" }}
[friction]
guide = {{ coefficient = 0.3, static-coefficient = 0.5 }}
[motion]
duration = 1
"#
    );
    let half = 0.5 * 2.0 * G / 50.0;
    let found = intervals(&text);
    assert_eq!(found.len(), 1, "{found:?}");
    near(found[0][0], -0.1 - half);
    near(found[0][1], -0.1 + half);
}
