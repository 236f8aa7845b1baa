//! Loads on one slide that the place of another decides, in windows and pulses narrower than a step: their impulse is the width times the height.

use crate::test_dir::TestDir;
use std::fs;

/// Two slides in the plane, each of 1 kg with 1 m/s.
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

/// The same in space.
fn slides_in_space(magnitude: &str) -> String {
    slides(magnitude)
        .replace("[0, 0]", "[0, 0, 0]")
        .replace("[1, 0]", "[1, 0, 0]")
        .replace("[0, 1]", "[0, 1, 0]")
        .replace("mass = 1", "mass = 1\ninertia = [1, 1, 1]")
        .replace("length", "travel")
}

/// What a load does to the first slide in a second, by a method.
fn impulse_of(scene: &str, method: &str) -> f64 {
    let dir = TestDir::new();
    dir.put("m.toml", scene);
    let options = ["--method", method, "--pictures", "none", "--out", "o"];
    let run = dir.run(&[&["simulate", "m.toml"][..], &options].concat());
    assert_eq!(run.status, Some(0), "{scene} {method}: {}", run.err);
    let rows = fs::read_to_string(dir.0.join("o/m-motion.csv")).unwrap();
    let last = rows.lines().last().unwrap();
    last.split(',').nth(2).unwrap().parse::<f64>().unwrap() - 1.0
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
        // 48 windows, of which a step may pass many.
        (
            r#""if(sin(300*y) > 0.9, 10, 0)""#.to_owned(),
            48.0 * 10.0 * 2.0 * 0.9_f64.acos() / 300.0,
        ),
        // ∫ sinⁿ(πy) dy over a half wave is √(2/(πn)), to 1/(4n) of it.
        (
            r#""1000*sin(3.141592653589793*y)^1e6""#.to_owned(),
            0.797_884_361_331_2,
        ),
    ] {
        for method in ["bdf", "tsit45", "esdirk34", "dop853"] {
            for scene in [slides(&magnitude), slides_in_space(&magnitude)] {
                let found = impulse_of(&scene, method);
                assert!(
                    (found - impulse).abs() < 1e-6,
                    "{scene} {method}: {found} N s, {impulse}"
                );
            }
        }
    }
}

#[test]
fn dense_output_that_meets_a_wave_is_not_taken_for_the_motion() {
    // At some tolerances stages of the dense output of DOP853 meet the wave where those of the step do not.
    let wave =
        slides(r#""1000*sin(3.141592653589793*y)^1e6""#).replace("duration = 1", "duration = 2");
    for tolerance in ["1e-9", "1e-10", "1e-11", "1e-12", "1e-13"] {
        for method in ["dop853", "tsit45"] {
            let dir = TestDir::new();
            dir.put("m.toml", &wave);
            let options = ["--method", method, "--rtol", tolerance, "--atol", tolerance];
            let out = ["simulate", "m.toml", "--pictures", "none", "--out", "o"];
            let run = dir.run(&[&out[..], &options].concat());
            assert_eq!(run.status, Some(0), "{method} {tolerance}: {}", run.err);
            let rows = fs::read_to_string(dir.0.join("o/m-motion.csv")).unwrap();
            let last = rows.lines().last().unwrap();
            let place: f64 = last.split(',').nth(1).unwrap().parse().unwrap();
            assert!(
                (place - 3.595_768_722_7).abs() < 1e-7,
                "{method} {tolerance}: {place}"
            );
        }
    }
}

#[test]
fn a_motion_that_is_at_rest_in_all_of_its_rows_is_resolved() {
    let scene = slides(r#""t - 1""#)
        .replace("x = 1, y = 1", "x = 0, y = 0")
        .replace("duration = 1", "duration = 2");
    let dir = TestDir::new();
    dir.put("m.toml", &scene);
    let options = ["--sample-interval", "2", "--pictures", "none", "--out", "o"];
    let run = dir.run(&[&["simulate", "m.toml", "--method", "dop853"][..], &options].concat());
    assert_eq!(run.status, Some(0), "{}", run.err);
}

#[test]
fn a_comparison_of_two_equal_values_does_not_switch_by_rounding() {
    let magnitude = r#""if((x.velocity - 1.625) + (-0.25 - x.velocity) <= -1.875, 1, 5) - x""#;
    for method in ["bdf", "tsit45", "esdirk34", "dop853"] {
        // ẍ = 1 − x from x = 0 with 1 m/s.
        let exact = 1f64.cos() + 1f64.sin() - 1.0;
        let found = impulse_of(&slides(magnitude), method);
        assert!((found - exact).abs() < 1e-6, "{method}: {found}, {exact}");
    }
}

/// The comparison rests on its threshold while the inner clamp is at its bound. Decided false behind the clamp's switch, it would lead back to
/// where it rests again: no decision that agrees with the motion there.
#[test]
fn a_condition_that_always_holds_changes_no_motion() {
    let of_law = |law: &str, method: &str| {
        let magnitude = format!(r#""min(floor(abs(sin(7*x))), {law}) - 4*x - 0.5*x.velocity""#);
        let scene = slides(&magnitude)
            .replace("mass = 1", "mass = 2")
            .replace("x = 0\n", "x = 0.5\n")
            .replace("x = 1, y = 1", "x = -1, y = 1")
            .replace("duration = 1", "duration = 2");
        let dir = TestDir::new();
        dir.put("m.toml", &scene);
        let options = ["--rtol", "1e-12", "--pictures", "none", "--out", "o"];
        let run = dir.run(&[&["simulate", "m.toml", "--method", method][..], &options].concat());
        assert_eq!(run.status, Some(0), "{law} {method}: {}", run.err);
        let rows = fs::read_to_string(dir.0.join("o/m-motion.csv")).unwrap();
        let last = rows.lines().last().unwrap();
        last.split(',').nth(2).unwrap().parse::<f64>().unwrap()
    };
    let plain = "clamp(x.velocity - 0.5, -2, 0)";
    let nested = format!("if(clamp(sin(9*x.velocity), 0, 2) >= 0, {plain}, 3.28125*sin(1.5*x))");
    for method in ["bdf", "tsit45", "dop853"] {
        let [one, other] = [plain, &nested].map(|law| of_law(law, method));
        assert!((one - other).abs() < 1e-8, "{method}: {one}, {other}");
    }
}

/// A speed comes to a threshold behind which no force acts, and stays there: `sign` of what is left is 0 on another slide. Law 121 of seed 12.
#[test]
fn a_speed_that_comes_to_rest_on_a_threshold_is_exactly_there() {
    for (function, threshold) in [
        ("3*x.velocity", 0.0_f64),
        ("x.velocity - 0.1", 0.1),
        ("x.velocity^3 - 0.027", 0.3),
        ("sin(x.velocity) - 0.3", 0.3_f64.asin()),
    ] {
        for (start, condition, force) in [(1.0, ">", -2.0), (-0.5, "<", 2.0)] {
            let law = format!(r#""if({function} {condition} 0, {force}, 0)""#);
            let sign =
                format!("h = {{ applied-force = \"y\", magnitude = \"sign({function})\" }}\n");
            let scene = slides(&law)
                .replace("[motion]", &format!("{sign}[motion]"))
                .replace("x = 1, y = 1", &format!("x = {start}, y = 1"))
                .replace("duration = 1", "duration = 2");
            let until = (threshold - start) / force;
            let place = start * until + 0.5 * force * until * until + threshold * (2.0 - until);
            let expected = [place, threshold, 0.0, 0.0, 1.0 - 0.5 * force * until];
            for method in ["bdf", "tsit45", "esdirk34", "dop853"] {
                let dir = TestDir::new();
                dir.put("m.toml", &scene);
                let options = ["--rtol", "1e-12", "--pictures", "none", "--out", "o"];
                let all = [&["simulate", "m.toml", "--method", method][..], &options].concat();
                let run = dir.run(&all);
                assert_eq!(run.status, Some(0), "{function} {method}: {}", run.err);
                let rows = fs::read_to_string(dir.0.join("o/m-motion.csv")).unwrap();
                let last = rows.lines().last().unwrap().split(',').skip(1);
                let found: Vec<f64> = last.map(|cell| cell.parse().unwrap()).collect();
                for k in [0, 1, 4] {
                    let error = (found[k] - expected[k]).abs();
                    assert!(error < 1e-11, "{function} {start} {method}: {found:?}");
                }
            }
        }
    }
}

/// A speed that grows without bounds runs through one threshold after the other, more and more often.
#[test]
fn a_load_whose_switches_accumulate_is_named() {
    let law = r#""floor(sin(6*x.velocity)) + 30*x.velocity""#;
    let dir = TestDir::new();
    dir.put(
        "m.toml",
        slides(law).replace("duration = 1", "duration = 2"),
    );
    let run = dir.run(&[
        "simulate",
        "m.toml",
        "--method",
        "tsit45",
        "--pictures",
        "none",
    ]);
    assert_eq!(run.status, Some(1), "{}", run.err);
    for part in ["load `f` switches too often", "after 4000 switches"] {
        assert!(run.err.contains(part), "{}", run.err);
    }
}
