//! A leg: a planar four-bar on the tarsus, a body that another loop carries, whose ankle a rod with two balls holds.

use dwell_geometry::space::{Plan, Vec3, vec3};
use dwell_scene::SpaceScene;

const LEG: &str = r#"
[bodies.ground]
points = { K = [0, 0, 0], B = [-0.05, 0.02, 0.06] }
[bodies.knee]
points = { K = [0, 0, 0], T = [0.3, 0, 0] }
[bodies.tarsus]
points = { T = [0.3, 0, 0], H = [0.28, 0, 0.04], E = [0.35, 0, -0.05], F = [0.4, 0, -0.35] }
[bodies.heel]
points = { H = [0.28, 0, 0.04], C = [0.25, 0.02, 0.14] }
[bodies.rod]
points = { B = [-0.05, 0.02, 0.06], C = [0.25, 0.02, 0.14] }
[bodies.arm]
points = { E = [0.35, 0, -0.05], G = [0.4, 0, -0.06] }
[bodies.bar]
points = { G = [0.4, 0, -0.06], I = [0.46, 0, -0.34] }
[bodies.foot]
points = { F = [0.4, 0, -0.35], I = [0.46, 0, -0.34] }
[joints]
K = { revolute = ["ground.K", "knee.K"], axis = [0, 1, 0] }
T = { revolute = ["knee.T", "tarsus.T"], axis = [0, 1, 0] }
H = { revolute = ["tarsus.H", "heel.H"], axis = [0.05, 1, 0.02] }
E = { revolute = ["tarsus.E", "arm.E"], axis = [0, 1, 0] }
G = { revolute = ["arm.G", "bar.G"], axis = [0, 1, 0] }
F = { revolute = ["tarsus.F", "foot.F"], axis = [0, 1, 0] }
B = { spherical = ["ground.B", "rod.B"] }
I = { spherical = ["bar.I", "foot.I"] }
C = { spherical = ["rod.C", "heel.C"] }
[actuators]
qk = { angle = "K" }
qh = { angle = "H" }
qf = { angle = "F" }
"#;

/// All loops are closed wherever the coordinates are; only the rod's turn is idle.
#[test]
fn a_loop_on_a_carried_body_is_closed_after_what_carries_it() {
    let scene = SpaceScene::parse("leg.toml", LEG).unwrap();
    let plan = Plan::compile(&scene.mechanism, &scene.assembly).unwrap();
    let mobility = plan.mobility();
    assert_eq!((mobility.degrees_of_freedom, mobility.idle.len()), (3, 1));
    let body = |name: &str| {
        let mut bodies = scene.mechanism.bodies.iter();
        bodies.position(|body| body.name == name).unwrap()
    };
    let mut pose = plan.pose::<f64>();
    for q in [[0.0; 3], [0.2, -0.1, 0.15], [-0.1, 0.1, -0.2]] {
        plan.positions(&q, &mut pose).unwrap();
        let gap = |[a, b]: [&str; 2], point: Vec3| {
            let ends = [a, b].map(|name| plan.point(&pose, body(name), point));
            (ends[0] - ends[1]).norm()
        };
        for (joint, bodies, point) in [
            ("B", ["ground", "rod"], vec3(-0.05, 0.02, 0.06)),
            ("C", ["rod", "heel"], vec3(0.25, 0.02, 0.14)),
            ("H", ["tarsus", "heel"], vec3(0.28, 0.0, 0.04)),
            ("I", ["bar", "foot"], vec3(0.46, 0.0, -0.34)),
        ] {
            let open = gap(bodies, point);
            assert!(open < 1e-12, "{joint} at {q:?}: {open:e} m");
        }
    }
}

/// `check` refuses a load whose moment about an idle body's line nothing balances, as statics does.
#[test]
fn a_load_off_the_line_of_an_idle_body_is_refused_by_check() {
    let loaded = LEG.replace(
        "C = [0.25, 0.02, 0.14] }\n[bodies.arm]",
        "C = [0.25, 0.02, 0.14], P = [0.1, 0.1, 0] }\n[bodies.arm]",
    ) + "[loads]\npull = { force = \"rod.P\", direction = [0, 0, 1], magnitude = 5 }\n";
    let scene = SpaceScene::parse("leg.toml", &loaded).unwrap();
    let refused = dwell_study::describe_scene(&scene).unwrap_err();
    let message = refused.to_string();
    assert!(message.contains("`pull` cannot act"), "{message}");
}

/// Axes that a typed digit turns by 1e-6 rad hold a planar loop: both joints are named.
#[test]
fn nearly_parallel_axes_that_leave_no_freedom_are_named() {
    for tilt in ["1e-6", "1e-4"] {
        let text = LEG.replace(
            "[\"arm.G\", \"bar.G\"], axis = [0, 1, 0]",
            &format!("[\"arm.G\", \"bar.G\"], axis = [{tilt}, 1, 0]"),
        );
        let text = text.replace(
            "I = { spherical = [\"bar.I\", \"foot.I\"] }",
            "I = { revolute = [\"bar.I\", \"foot.I\"], axis = [0, 1, 0] }",
        );
        let scene = SpaceScene::parse("leg.toml", &text).unwrap();
        let refused = dwell_study::describe_scene(&scene).unwrap_err();
        let message = refused.to_string();
        assert!(
            message.contains("`G`") && message.contains("from parallel"),
            "{message}"
        );
    }
}
