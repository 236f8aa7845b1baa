//! Change points: positions where two assembly branches meet. A branch ends there; it is never
//! carried on on the other one, whose closed form has the same sign.

use dwell_geometry::PositionError;
use dwell_kinetostatics::ReducedModel;
use dwell_scene::PlaneScene;
use dwell_tests::fixtures::model;
use std::f64::consts::PI;

/// A parallelogram whose ground is turned, so that no round angle is a flat position.
fn parallelogram(rotation: f64) -> PlaneScene {
    let (sin, cos) = rotation.sin_cos();
    let text = format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0], D = [{}, {}] }}
[bodies.crank]
points = {{ A = [0, 0], B = [0.2, 0] }}
mass = 1.0
center = "B"
[bodies.coupler]
points = {{ B = [0, 0], C = [0.4, 0] }}
mass = 2.0
center = [0.2, 0.05]
inertia = 0.03
[bodies.rocker]
points = {{ D = [0, 0], C = [0.2, 0] }}
mass = 0.5
center = [0.1, 0]
inertia = 0.002
[joints]
A = {{ revolute = ["ground.A", "crank.A"] }}
B = {{ revolute = ["crank.B", "coupler.B"] }}
C = {{ revolute = ["coupler.C", "rocker.C"] }}
D = {{ revolute = ["ground.D", "rocker.D"] }}
[actuators.phi]
angle = ["ground", "crank"]
[assembly]
phi = 1.0
coupler = {rotation}
rocker = 1.0
"#,
        0.4 * cos,
        0.4 * sin
    );
    PlaneScene::parse("parallelogram.toml", &text).expect("a scene")
}

#[test]
fn a_parallelogram_ends_where_it_is_flat() {
    for rotation in [0.0, 0.123, -0.7, 0.3] {
        let model = model(&parallelogram(rotation));
        let Some((from, to)) = model.range().limits() else {
            panic!("{rotation}: {:?}", model.range());
        };
        // Flat where the crank lies along the ground; the end is told from the other branch by
        // what rounding leaves, a millionth of the determinant.
        assert!((from - rotation).abs() < 1e-5, "{rotation}: {from}");
        assert!((to - rotation - PI).abs() < 1e-5, "{rotation}: {to}");
        let mut workspace = model.workspace();
        // As a parallelogram the coupler does not turn, so m is that of a crank:
        // (1 + 2) r² + I_rocker about D, with no term of the coupler's inertia.
        let expected = 3.0 * 0.04 + 0.002 + 0.5 * 0.01;
        for k in 1..20 {
            let q = from + (to - from) * f64::from(k) / 20.0;
            let (m, half_dm) = model.inertia(q, &mut workspace).expect("a pose");
            assert!(
                (m - expected).abs() < 1e-13 && half_dm.abs() < 1e-12,
                "{q}: {m}"
            );
        }
        assert!(matches!(
            model.inertia(to + 0.1, &mut workspace),
            Err(PositionError::OutOfRange { .. })
        ));
    }
}
