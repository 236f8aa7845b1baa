//! Each check of rows passes those of closed forms, and fails where one column of them is wrong.

use super::closure::closure;
use super::equilibrium::equilibrium;
use super::rates::rates;
use super::reading::Reading;
use super::rows::Rows;

/// A pendulum that is swung by φ = 30° + 40°(sin(2πt/1.5 + 20°) − sin 20°), in units of every kind.
const PENDULUM: &str = r#"
[units]
length = "mm"
mass = "g"
inertia = "g cm2"
angle = "deg"
[bodies.ground]
points = { A = [100, 50] }
[bodies.arm]
points = { A = [-20, 0], P = [300, 10] }
mass = 1500
center = [120, 15]
inertia = 90000
[joints]
A = { revolute = ["ground.A", "arm.A"] }
[actuators]
phi = { angle = ["ground", "arm"] }
[assembly]
phi = 30
[prescribed]
duration = 1.2
phi = { sinusoid = { amplitude = 40, period = 1.5, phase = 20 } }
[loads]
weight = { gravity = [0, -9.81] }
push = { force = "arm.P", direction = [1, 0], magnitude = "3*sin(2*t) + phi" }
"#;

/// The rows of the pendulum by its closed forms, in SI units.
fn pendulum() -> Rows {
    let degree = std::f64::consts::PI / 180.0;
    let rate = std::f64::consts::TAU / 1.5;
    let mut rows = Rows {
        count: 61,
        ..Rows::default()
    };
    for row in 0..rows.count {
        let t = 1.2 * row as f64 / 60.0;
        let (sin, cos) = (rate * t + 20.0 * degree).sin_cos();
        let q = degree * (30.0 + 40.0 * (sin - (20.0 * degree).sin()));
        let (v, a) = (
            40.0 * degree * rate * cos,
            -40.0 * degree * rate * rate * sin,
        );
        // A point at p from the pin, and how it moves.
        let at = |[x, y]: [f64; 2]| {
            let (s, c) = q.sin_cos();
            let [x, y] = [c * x - s * y, s * x + c * y];
            [
                [x + 0.1, y + 0.05],
                [-v * y, v * x],
                [-a * y - v * v * x, a * x - v * v * y],
            ]
        };
        let mut put =
            |name: &str, value: f64| rows.columns.entry(name.to_owned()).or_default().push(value);
        for (name, value) in [
            ("t", t),
            ("phi", q),
            ("phi.velocity", v),
            ("phi.acceleration", a),
        ] {
            put(name, value);
        }
        for (name, value) in [
            ("arm.angle", q),
            ("arm.angular_velocity", v),
            ("arm.angular_acceleration", a),
        ] {
            put(name, value);
        }
        for (name, p) in [("A", [0.0, 0.0]), ("P", [0.32, 0.01])] {
            for (ends, [x, y]) in [["x", "y"], ["vx", "vy"], ["ax", "ay"]]
                .into_iter()
                .zip(at(p))
            {
                put(&format!("arm.{name}.{}", ends[0]), x);
                put(&format!("arm.{name}.{}", ends[1]), y);
            }
        }
        let (mass, inertia, push) = (1.5, 9e-3, 3.0 * (2.0 * t).sin() + q);
        let [[gx, gy], _, [ax, ay]] = at([0.14, 0.015]);
        let [[_, py], ..] = at([0.32, 0.01]);
        put("push.load_force", push);
        put("A.x", mass * ax - push);
        put("A.y", mass * (ay + 9.81));
        // About the pin: the rate of the angular momentum less the moments of weight and push.
        let [rx, ry] = [gx - 0.1, gy - 0.05];
        let rate = inertia * a + mass * (rx * ay - ry * ax);
        put(
            "phi.actuator_force",
            rate + rx * mass * 9.81 + (py - 0.05) * push,
        );
    }
    rows
}

/// The relative differences of joints, laws, rates, bodies and loads.
fn differences(rows: &Rows) -> [f64; 5] {
    let reading = Reading::new(PENDULUM).expect("a scene");
    let positions = closure(&reading, rows, "rows");
    let between = rates(&reading, rows, "rows");
    let forces = equilibrium(&reading, rows, "rows", false);
    [
        positions.joints,
        positions.laws,
        between,
        forces.bodies,
        forces.loads,
    ]
    .map(|d| d.largest())
}

#[test]
fn closed_forms_pass_every_check_of_rows() {
    let [joints, laws, rates, bodies, loads] = differences(&pendulum());
    assert!(
        joints < 1e-14 && laws < 1e-14 && bodies < 1e-14 && loads < 1e-14,
        "{joints} {laws} {bodies} {loads}"
    );
    assert!(rates < 1e-8, "{rates}");
}

/// By column: a factor in one row alone, and which checks see it.
#[test]
fn a_wrong_column_fails_at_least_two_checks() {
    for (columns, factor, seen) in [
        (
            &["phi.acceleration", "arm.angular_acceleration"][..],
            1.5,
            [true, true, true, true, false],
        ),
        (&["arm.P.y"], 1.001, [true, false, true, false, false]),
        (&["arm.P.vx"], -1.0, [true, false, true, false, false]),
        (&["A.x"], -1.0, [false, false, false, true, false]),
        (
            &["phi.actuator_force"],
            1.01,
            [false, false, false, true, false],
        ),
        (
            &["push.load_force"],
            1.01,
            [false, false, false, false, true],
        ),
        (&["phi"], 1.0 + 1e-6, [true, true, true, false, false]),
    ] {
        let mut rows = pendulum();
        for column in columns {
            let column = rows.columns.get_mut(*column).expect("a column");
            column[30] *= factor;
        }
        let found = differences(&rows).map(|difference| difference > 1e-7);
        assert_eq!(found, seen, "{columns:?}");
    }
}

#[test]
fn a_unit_that_is_read_otherwise_fails() {
    let other = PENDULUM.replacen("\"g cm2\"", "\"g mm2\"", 1);
    let reading = Reading::new(&other).expect("a scene");
    let forces = equilibrium(&reading, &pendulum(), "rows", false);
    assert!(forces.bodies.largest() > 1e-3);
    for (unit, other) in [("\"mm\"", "\"cm\""), ("\"deg\"", "\"rad\"")] {
        let reading = Reading::new(&PENDULUM.replacen(unit, other, 1)).expect("a scene");
        let of = closure(&reading, &pendulum(), "rows");
        assert!(
            of.joints.largest() > 1e-3 || of.laws.largest() > 1e-3,
            "{unit}"
        );
    }
}
