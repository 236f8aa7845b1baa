//! Mechanisms that close in several ways which turn no body: the rough travel of a slide, or the
//! direction of a distance, says which is meant.

use crate::refusals::refusal;
use dwell_geometry::{AssemblyError, BodyId, JointId, JointKind, StructureError, Vec2, vec2};
use dwell_tests::changes::{Rng, Setup};
use dwell_tests::sketch::{Sketch, slider_crank};

const GROUND: BodyId = Sketch::GROUND;
const O: [f64; 2] = [0.0, 0.0];
/// Closed positions in rounding, of lengths below 2 m; a double root would lose half of the digits.
const CLOSED: f64 = 1e-13;

/// What the refusal of an ambiguous assembly says: no bodies, these joints and ways.
fn assembly_modes(setup: &Setup, expected_joints: &[JointId]) -> Vec<Vec<f64>> {
    let AssemblyError::Ambiguous {
        bodies,
        joints,
        modes: choices,
    } = refusal(setup)
    else {
        panic!("not ambiguous");
    };
    assert_eq!((bodies, joints), (vec![], expected_joints.to_vec()));
    choices
}

/// The setup with a rough number for some joints.
fn with_hints(mut setup: Setup, hints: &[(JointId, f64)]) -> Setup {
    setup.assembly.branch_hints = vec![None; setup.mechanism.joints.len()];
    for &(joint, value) in hints {
        setup.assembly.branch_hints[joint.0] = Some(value);
    }
    setup
}

/// Where a point of a body is once the setup is put together.
fn point(setup: &Setup, (body, at): (BodyId, [f64; 2])) -> Vec2 {
    let model = setup.model().expect("a model");
    let plan = model.model().plan();
    let mut pose = plan.pose();
    plan.positions(plan.assembly_coordinates(), &mut pose)
        .expect("a pose");
    let [x, y, angle] = plan.body_frames(&setup.mechanism, &pose)[body.0];
    vec2(x, y) + vec2(at[0], at[1]).rotate(Vec2::from_angle(angle))
}

#[track_caller]
fn assert_at(found: Vec2, x: f64, y: f64) {
    assert!((found - vec2(x, y)).norm() < CLOSED, "{found:?}");
}

/// A slider on the x axis at a driven distance of 0.5 m from a point 0.3 m above it.
fn slider_at_a_length() -> (Setup, BodyId, JointId) {
    let mut s = Sketch::new();
    let slider = s.body("slider");
    let guide = s.prismatic("guide", (GROUND, O), (slider, O), vec2(1.0, 0.0));
    s.actuate_length("l", [GROUND, slider], [vec2(0.0, 0.3), Vec2::ZERO]);
    (s.setup(&[0.5]), slider, guide)
}

#[test]
fn a_slider_at_a_length_is_put_on_either_side() {
    let (setup, slider, guide) = slider_at_a_length();
    let mut modes = assembly_modes(&setup, &[guide]);
    modes.sort_by(|a, b| a[0].total_cmp(&b[0]));
    assert!((modes[0][0] + 0.4).abs() < CLOSED && (modes[1][0] - 0.4).abs() < CLOSED);
    for x in [0.4, -0.4] {
        // As rough as it may be: nearer to this way than to the other.
        for hint in [x, 0.1 * x, 3.0 * x] {
            let hinted = with_hints(setup.clone(), &[(guide, hint)]);
            assert_at(point(&hinted, (slider, O)), x, 0.0);
        }
    }
    // Half way between the two nothing is said.
    assembly_modes(&with_hints(setup, &[(guide, 0.0)]), &[guide]);
}

/// A travel counts from the joint's first body, whichever that is, and in the order of the joints.
#[test]
fn the_travel_is_the_joints_own() {
    let (setup, slider, guide) = slider_at_a_length();
    let mut swapped = with_hints(setup.clone(), &[(guide, -0.4)]);
    swapped.mechanism.joints[guide.0].bodies.reverse();
    assert_at(point(&swapped, (slider, O)), 0.4, 0.0);
    let mut setup = with_hints(setup, &[(guide, -0.4)]);
    let body = dwell_geometry::Body::named("pendulum");
    setup.mechanism.bodies.push(body);
    setup.masses.push(Default::default());
    setup.assembly.initial_guess.push(None);
    let pendulum = BodyId(2);
    let weld = JointKind::Weld { angle: 0.0 };
    let held = dwell_geometry::Joint::new("held", [slider, pendulum], [Vec2::ZERO; 2], weld);
    setup.mechanism.joints.push(held);
    setup.assembly.branch_hints.push(None);
    let mut seed = Rng(7);
    for _ in 0..8 {
        setup = setup.shuffled(&mut seed);
        let held = setup.mechanism.bodies.iter();
        let held = held.take_while(|b| b.name != "pendulum").count();
        assert_at(point(&setup, (BodyId(held), O)), -0.4, 0.0);
    }
}

/// A wedge is pushed along the ground; on its face, inclined by 45°, slides a block that a distance
/// of 1 m holds to the origin.
#[test]
fn a_block_on_a_wedge_is_put_on_either_side_of_its_bar() {
    let mut s = Sketch::new();
    let [wedge, block] = ["wedge", "block"].map(|name| s.body(name));
    let floor = s.prismatic("floor", (GROUND, O), (wedge, O), vec2(1.0, 0.0));
    let half = 0.5_f64.sqrt();
    let face = s.prismatic("face", (wedge, O), (block, O), vec2(half, half));
    let length = 1.0;
    let bar = s.joint(
        "bar",
        (GROUND, O),
        (block, O),
        JointKind::Distance { length },
    );
    s.actuate_travel("x", [GROUND, wedge], floor);
    let setup = s.setup(&[0.2]);
    // With u = s/√2: (0.2 + u)² + u² = 1.
    let root = (0.04_f64 - 2.0 * (0.04 - 1.0)).sqrt();
    let modes = assembly_modes(&setup, &[face, bar]);
    assert_eq!(modes.len(), 2);
    for u in [(-0.2 + root) / 2.0, (-0.2 - root) / 2.0] {
        let position = vec2(0.2 + u, u);
        let listed = modes.iter().any(|mode| {
            (mode[0] - u / half).abs() < CLOSED
                && (Vec2::from_angle(mode[1]) - position).norm() < CLOSED
        });
        assert!(listed, "{modes:?}");
        let by_slide = with_hints(setup.clone(), &[(face, 0.5 * u)]);
        assert_at(point(&by_slide, (block, O)), position.x, position.y);
        let by_bar = with_hints(setup.clone(), &[(bar, position.angle() + 0.5)]);
        assert_at(point(&by_bar, (block, O)), position.x, position.y);
    }
}

/// A body whose angle is driven hangs on two distances of 1 m: only their directions differ.
#[test]
fn two_distances_that_hold_a_driven_body() {
    let mut s = Sketch::new();
    let body = s.body("body");
    let kind = JointKind::Distance { length: 1.0 };
    let left = s.joint("left", (GROUND, [-0.6, 0.0]), (body, O), kind);
    let right = s.joint("right", (GROUND, [0.6, 0.0]), (body, O), kind);
    s.actuate("phi", [GROUND, body]);
    let setup = s.setup(&[0.3]);
    assert_eq!(assembly_modes(&setup, &[left, right]).len(), 2);
    for y in [0.8, -0.8] {
        let by_left = with_hints(setup.clone(), &[(left, 0.6 * y)]);
        assert_at(point(&by_left, (body, O)), 0.0, y);
        let by_right = with_hints(setup.clone(), &[(right, 3.0 * y)]);
        assert_at(point(&by_right, (body, O)), 0.0, y);
    }
}

/// Three sliders on lines across the plane, in a triangle of two distances and a driven length: a
/// class III group in which no body turns.
fn three_sliders() -> (Setup, [JointId; 3], [BodyId; 3]) {
    let mut s = Sketch::new();
    let bodies = ["one", "two", "three"].map(|name| s.body(name));
    let lines = [([0.0, 0.0], 0.2), ([1.0, 0.1], 1.9), ([0.1, 0.9], -0.7)];
    let travels = [0.35, 0.4, 0.2];
    let mut slides = [JointId(0); 3];
    let mut positions = [Vec2::ZERO; 3];
    for i in 0..3 {
        let ([x, y], angle) = lines[i];
        let axis = Vec2::from_angle(angle);
        slides[i] = s.prismatic(["a", "b", "c"][i], (GROUND, [x, y]), (bodies[i], O), axis);
        positions[i] = vec2(x, y) + axis * travels[i];
    }
    for (i, k) in [(0, 1), (1, 2)] {
        let length = (positions[k] - positions[i]).norm();
        let kind = JointKind::Distance { length };
        s.joint(["d", "e"][i], (bodies[i], O), (bodies[k], O), kind);
    }
    s.actuate_length("l", [bodies[2], bodies[0]], [Vec2::ZERO; 2]);
    let q = (positions[0] - positions[2]).norm();
    (s.setup(&[q]), slides, bodies)
}

#[test]
fn a_class_three_group_that_differs_in_its_slides() {
    let (setup, slides, bodies) = three_sliders();
    let AssemblyError::Ambiguous {
        bodies: turned,
        joints,
        modes: choices,
    } = refusal(&setup)
    else {
        panic!("not ambiguous");
    };
    assert!(turned.is_empty());
    assert_eq!(joints[..3], slides);
    assert!(choices.len() > 1, "{choices:?}");
    let built = |mode: &Vec<f64>| {
        let differences = mode
            .iter()
            .zip([0.35, 0.4, 0.2])
            .map(|(a, b)| (a - b).abs());
        differences.fold(0.0, f64::max) < 1e-12
    };
    assert!(choices.iter().any(built), "{choices:?}");
    for mode in &choices {
        let hints: Vec<_> = (0..3).map(|i| (slides[i], mode[i] + 0.01)).collect();
        let hinted = with_hints(setup.clone(), &hints);
        for i in 0..3 {
            let joint = &setup.mechanism.joints[slides[i].0];
            let JointKind::Prismatic { axes } = joint.kind else {
                panic!("a slide");
            };
            let on_line = joint.points[0] + axes[0] * mode[i];
            assert_at(point(&hinted, (bodies[i], O)), on_line.x, on_line.y);
        }
    }
}

/// Where bodies tell the ways apart, the slide does too, though no unknown stands for it.
#[test]
fn the_travel_of_a_piston_picks_the_rod() {
    let (sketch, rod) = slider_crank(1.0, 0.0);
    let setup = sketch.setup(&[0.8]);
    let guide = JointId(3);
    let AssemblyError::Ambiguous { bodies, joints, .. } = refusal(&setup) else {
        panic!("not ambiguous");
    };
    assert_eq!((bodies, joints), (vec![rod], vec![]));
    let b = Vec2::from_angle(0.8) * 0.5;
    let rod_projection = (1.0 - b.y * b.y).sqrt();
    for x in [b.x + rod_projection, b.x - rod_projection] {
        let hinted = with_hints(setup.clone(), &[(guide, x + 0.2)]);
        assert_at(point(&hinted, (rod, [1.0, 0.0])), x, 0.0);
    }
}

/// What is told of a joint must be a number, of a joint of which it can be told.
#[test]
fn what_cannot_be_told_is_refused() {
    let (setup, _, guide) = slider_at_a_length();
    let mut short = with_hints(setup.clone(), &[(guide, 0.4)]);
    short.assembly.branch_hints.push(None);
    let (sketch, _) = slider_crank(1.0, 0.0);
    let pin = with_hints(sketch.setup(&[0.8]), &[(JointId(1), 0.4)]);
    for wrong in [with_hints(setup, &[(guide, f64::NAN)]), short, pin] {
        let error = refusal(&wrong);
        assert!(matches!(
            error,
            AssemblyError::Structure(StructureError::Malformed { .. })
        ));
    }
}
