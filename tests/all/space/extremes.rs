//! Nearly parallel axes, nearly planar loops, and offsets that contradict the redundant constraints of an overconstrained linkage.

use dwell_geometry::space::Placement;
use dwell_geometry::{AssemblyError, JointId};
use dwell_kinetostatics::space::{Axes, Component, Model, ModelError, Reaction};
use dwell_scene::SpaceScene;
use dwell_verify::space::DenseSpace;

/// A scene of `validation/spatial` with parts of its text replaced.
fn varied(name: &str, changes: &[(&str, String)]) -> SpaceScene {
    let path = format!(
        "{}/../validation/spatial/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let mut text = std::fs::read_to_string(path).expect("a scene");
    for (from, to) in changes {
        assert!(text.contains(from), "{name}: {from}");
        text = text.replace(from, to);
    }
    SpaceScene::parse(name, &text).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn model(scene: &SpaceScene) -> Result<Model, ModelError> {
    let (mechanism, masses) = (&scene.mechanism, &scene.masses);
    let components = |j: usize| {
        (0..6).map(move |k| Reaction {
            joint: JointId(j),
            component: match k {
                0..3 => Component::Force(Axes::Ground, k),
                _ => Component::Moment(Axes::Ground, k - 3),
            },
        })
    };
    let all: Vec<Reaction> = (0..mechanism.joints.len()).flat_map(components).collect();
    Model::new(mechanism, masses, &scene.assembly, &all)
}

/// The size of the contradiction, m, with the number of redundant constraints.
fn contradiction(scene: &SpaceScene) -> (f64, usize) {
    match model(scene) {
        Err(ModelError::Assembly(AssemblyError::Inconsistent {
            gap,
            redundant_count,
            ..
        })) => (gap, redundant_count),
        other => panic!("{:?}", other.err()),
    }
}

/// A Bennett linkage closes for its exact lengths only, an oblique planar four-bar with hinges for parallel axes only. A deviation is refused
/// with what stays open, which is proportional to it; one of rounding is not.
#[test]
fn tiny_offsets_of_overconstrained_linkages_are_refused_with_their_size() {
    let bennett = |offset: f64| {
        let longer = format!("B = [0, 0, 0], C = [{:?}, 0, 0]", 0.3 + offset);
        varied("bennett", &[("B = [0, 0, 0], C = [0.3, 0, 0]", longer)])
    };
    let four_bar = |tilt: f64| {
        let axes = |z: f64| format!("\"rocker.D\"], axes = [[1, -2, {z:?}], [0, 0, 1]]");
        let parallel = "\"rocker.D\"], axes = [[1, -2, 2], [0, 0, 1]]";
        varied("planar-oblique-4r", &[(parallel, axes(2.0 + tilt))])
    };
    let varied: [(&str, &dyn Fn(f64) -> SpaceScene); 2] =
        [("bennett", &bennett), ("four-bar", &four_bar)];
    for (name, of) in varied {
        let (first, _) = contradiction(&of(1e-5));
        for deviation in [1e-3, 1e-4, 1e-6, 1e-7] {
            let (gap, redundant_count) = contradiction(&of(deviation));
            assert_eq!(redundant_count, 3, "{name}");
            let ratio = gap / deviation / (first / 1e-5);
            assert!((ratio - 1.0).abs() < 0.02, "{name} {deviation}: {gap}");
        }
        for rounding in [0.0, 1e-14] {
            assert!(model(&of(rounding)).is_ok(), "{name} {rounding}");
        }
    }
}

/// The largest difference from the dense equations of actions and reactions in the three passes, relative to the largest of its kind.
fn difference(scene: &SpaceScene, model: &Model, q: f64) -> f64 {
    let mut pose = model.plan().pose();
    model.plan().positions(&[q], &mut pose).expect("a pose");
    let bodies = 0..scene.mechanism.bodies.len();
    let placements: Vec<Placement> = bodies.map(|b| model.plan().placement(&pose, b)).collect();
    let mut workspace = model.workspace();
    let determined = model.determined(&[q], &mut workspace).expect("a pose");
    let mut worst = 0.0_f64;
    for [q_dot, q_ddot] in [[1.0, 0.0], [0.0, 1.0]] {
        let mut found = model.result_buffer();
        model
            .inverse_dynamics(&[q], &[q_dot], &[q_ddot], &mut workspace, &mut found)
            .expect("a pose");
        let dense = DenseSpace::new(
            &scene.mechanism,
            &scene.masses,
            &placements,
            [&[q_dot], &[q_ddot]],
            &[],
        );
        let dense = dense.expect("singular values");
        let wanted = dense.reactions.iter().flat_map(|w| {
            let (f, m) = (w.force, w.moment);
            [f.x, f.y, f.z, m.x, m.y, m.z]
        });
        let wanted: Vec<f64> = wanted.collect();
        let largest = wanted.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        worst = worst.max((found.tau[0] - dense.actuator_actions[0]).abs() / largest);
        for (k, wanted) in wanted.iter().enumerate() {
            assert_eq!(determined[k], dense.determined[k / 6][k % 6], "{k}");
            if determined[k] {
                worst = worst.max((found.reactions[k] - wanted).abs() / largest);
            }
        }
    }
    worst
}

/// Two balls between hinges whose axes are nearly parallel, and a nearly planar loop that has no redundant constraint: whatever the angle, the results
/// are those of the dense equations, and m tends to that of parallel axes.
#[test]
fn nearly_parallel_axes_and_nearly_planar_loops_keep_their_digits() {
    let two_balls = |tilt: f64| {
        let coupler = "coupler = { at = [0.1, 0, 0], turn = [0, 0, 1.38] }".to_owned();
        varied(
            "rssr",
            &[
                ("axis = [0, 1, 0]", format!("axis = [0, {tilt:?}, 1]")),
                (
                    "coupler = { at = [0.1, 0, 0], turn = [0.2476, -0.7121, 0.3176] }",
                    coupler,
                ),
                ("turn = [0, -1.3127, 0]", "turn = [0, 0, 1.955]".to_owned()),
            ],
        )
    };
    let determinate = |tilt: f64| {
        let axes = |z: f64| format!("\"rocker.D\"], axes = [[1, -2, {z:?}], [0, 0, 1]]");
        let parallel = "\"rocker.D\"], axes = [[1, -2, 2], [0, 0, 1]]";
        varied("planar-oblique-rcsr", &[(parallel, axes(2.0 + tilt))])
    };
    let varied: [(&str, &dyn Fn(f64) -> SpaceScene); 2] =
        [("two balls", &two_balls), ("planar", &determinate)];
    for (name, of) in varied {
        let at_limit = model(&of(0.0)).expect("parallel axes");
        let m_at = |model: &Model, q: f64| {
            let (mut workspace, mut out) = (model.workspace(), model.coefficient_buffer());
            model.reduce(q, &mut workspace, &mut out).expect("a pose");
            out.m
        };
        for tilt in [1e-1, 1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 0.0] {
            let scene = of(tilt);
            let model = model(&scene).unwrap_or_else(|e| panic!("{name} {tilt}: {e:?}"));
            for q in [0.4, 1.3, 2.9, 4.4] {
                let wrong = difference(&scene, &model, q);
                assert!(wrong < 1e-11, "{name}, tilt {tilt}, at {q}: {wrong:.1e}");
                let change = (m_at(&model, q) / m_at(&at_limit, q) - 1.0).abs();
                assert!(change < 20.0 * tilt + 1e-13, "{name} {tilt}: {change:.1e}");
            }
        }
    }
}

/// However far from the origin, in single precision too: a coefficient is a number, or there is none.
#[test]
fn far_from_the_origin_nothing_is_not_a_number() {
    let mut found = 0;
    for exponent in 0..40 {
        let distance = 10_f64.powi(exponent);
        let far = |point: [f64; 3]| {
            format!(
                "[{:?}, {:?}, {:?}]",
                point[0] + distance,
                point[1] - distance,
                point[2]
            )
        };
        let scene = varied(
            "rssr",
            &[
                (
                    "A = [0, 0, 0], D = [0.25, 0.06, -0.04]",
                    format!("A = {}, D = {}", far([0.0; 3]), far([0.25, 0.06, -0.04])),
                ),
                ("at = [0.1, 0, 0]", format!("at = {}", far([0.1, 0.0, 0.0]))),
                (
                    "at = [0.25, 0.06, -0.04]",
                    format!("at = {}", far([0.25, 0.06, -0.04])),
                ),
            ],
        );
        let Ok(model) = model(&scene) else {
            continue;
        };
        let (mut workspace, mut out) =
            (model.workspace::<f32>(), model.coefficient_buffer::<f32>());
        for q in [-1.0, 0.3, 1.125] {
            if model.reduce(q, &mut workspace, &mut out).is_ok() {
                let all = [out.m, out.half_dm];
                let mut all = all.iter().chain(&out.a).chain(&out.b);
                assert!(
                    all.all(|value| value.is_finite()),
                    "{q} at {distance:e}: {out:?}"
                );
                found += 1;
            }
        }
    }
    assert!(found > 10, "{found}");
}
