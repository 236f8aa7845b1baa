//! Loads on one slide that the place of another decides, in windows and pulses narrower than a step: their impulse is the width times the height.

use crate::test_dir::TestDir;
use std::fs;

/// Two slides, each of 1 kg with 1 m/s.
fn slides(magnitude: &str) -> String {
    format!(
        r#"
[bodies.ground]
points = {{ O = [0, 0] }}
[bodies.a]
points = {{ P = [0, 0] }}
mass = 1
center = "P"
[bodies.b]
points = {{ P = [0, 0] }}
mass = 1
center = "P"
[joints]
J0 = {{ prismatic = ["ground.O", "a.P"], axis = [1, 0] }}
J1 = {{ prismatic = ["ground.O", "b.P"], axis = [0, 1] }}
[actuators]
x = {{ length = "J0" }}
y = {{ length = "J1" }}
[assembly]
x = 0
y = 0
[drives]
f = {{ applied-force = "x", magnitude = {magnitude} }}
[motion]
initial-velocity = {{ x = 1, y = 1 }}
duration = 1
"#
    )
}

#[test]
fn narrow_loads_of_another_coordinate_do_their_impulse() {
    let table = |points: &str, kind: &str| {
        format!(r#"{{ table = [{points}], interpolation = "{kind}", of = "y" }}"#)
    };
    let bump =
        "[-1, 0], [0.5136, 0], [0.5137, 0], [0.51373, 1000], [0.51376, 0], [0.5139, 0], [3, 0]";
    let window = 2e-5 * std::f64::consts::LN_2.sqrt();
    for (magnitude, impulse) in [
        (
            r#""if(exp(-((y - 0.5)/1e-5)^2) > 0.5, 1000, 0)""#.to_owned(),
            1e3 * window,
        ),
        (
            table("[-9, 0], [0.5, 1000], [0.50001, 0], [9, 0]", "step"),
            1e-2,
        ),
        (table(bump, "monotone"), 3e-2),
        // ∫ sinⁿ(πy) dy over a half wave is √(2/(πn)), to 1/(4n) of it.
        (
            r#""1000*sin(3.141592653589793*y)^1e6""#.to_owned(),
            0.797_884_361_331_2,
        ),
    ] {
        for method in ["bdf", "tsit45", "esdirk34"] {
            let dir = TestDir::new();
            dir.put("m.toml", slides(&magnitude));
            let options = ["--method", method, "--pictures", "none", "--out", "o"];
            let run = dir.run(&[&["simulate", "m.toml"][..], &options].concat());
            assert_eq!(run.status, Some(0), "{magnitude} {method}: {}", run.err);
            let rows = fs::read_to_string(dir.0.join("o/m-motion.csv")).unwrap();
            let last = rows.lines().last().unwrap();
            let speed: f64 = last.split(',').nth(2).unwrap().parse().unwrap();
            assert!(
                (speed - 1.0 - impulse).abs() < 1e-6,
                "{magnitude} {method}: {speed}"
            );
        }
    }
}
