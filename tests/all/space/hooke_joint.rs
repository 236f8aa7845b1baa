//! The Hooke joint of section 13 of docs/theory.md, by hand.

use dwell_geometry::space::{
    Actuator, Assembly, Joint, JointKind, Mechanism, Placement, Rotation, Side, vec3,
};
use dwell_geometry::{Body, JointId};
use dwell_kinetostatics::space::{Axes, Component, Mass, Model, Reaction};
use std::f64::consts::PI;

#[test]
fn the_hooke_joint_is_that_of_the_theory() {
    let (sin_b, cos_b) = (PI / 6.0).sin_cos();
    let q = PI / 3.0;
    // The frames of the shafts are those of the ground at q = 0, where the cross has its axes along y and e × y.
    let first = Side {
        axis: vec3(1.0, 0.0, 0.0),
        normal: vec3(0.0, 1.0, 0.0),
        ..Side::default()
    };
    let second = Side {
        axis: vec3(cos_b, sin_b, 0.0),
        normal: vec3(0.0, 0.0, 1.0),
        ..Side::default()
    };
    let cross = |axis| Side {
        axis,
        ..Side::default()
    };
    let joint = |name: &str, bodies: [usize; 2], kind, sides| Joint::new(name, bodies, kind, sides);
    let mechanism = Mechanism {
        bodies: ["ground", "first", "second"].map(Body::named).into(),
        ground: 0,
        joints: vec![
            joint("A", [0, 1], JointKind::Revolute, [first; 2]),
            joint("B", [0, 2], JointKind::Revolute, [second; 2]),
            joint(
                "U",
                [1, 2],
                JointKind::Universal,
                [cross(vec3(0.0, 1.0, 0.0)), cross(vec3(0.0, 0.0, 1.0))],
            ),
        ],
        actuators: vec![Actuator::angle("q", 0)],
        couplings: Vec::new(),
    };
    // About the axis of the second shaft 0.03 kg m², across it nothing.
    let e = [cos_b, sin_b];
    let masses = [
        Mass::default(),
        Mass {
            mass: 1.0,
            inertia: [0.02, 0.01, 0.01, 0.0, 0.0, 0.0],
            ..Mass::default()
        },
        Mass {
            mass: 1.0,
            inertia: [
                0.03 * e[0] * e[0],
                0.03 * e[1] * e[1],
                0.0,
                0.03 * e[0] * e[1],
                0.0,
                0.0,
            ],
            ..Mass::default()
        },
    ];
    let turned = |turn| Placement {
        rotation: Rotation::of_vector(turn),
        ..Placement::default()
    };
    // The angle of the second shaft is near that of the first.
    let assembly = Assembly {
        q: vec![q],
        placements: vec![
            Placement::default(),
            turned(first.axis.scaled(q)),
            turned(second.axis.scaled(0.98)),
        ],
    };
    let moment = |index| Reaction {
        joint: JointId(2),
        component: Component::Moment(Axes::Ground, index),
    };
    let model = Model::new(
        &mechanism,
        &masses,
        &assembly,
        &[moment(0), moment(1), moment(2)],
    )
    .expect("a model");
    assert_eq!(model.plan().mobility().redundant_count, 3);
    let mut workspace = model.workspace();
    assert_eq!(
        model.determined(&[q], &mut workspace).expect("a pose"),
        [true; 3]
    );
    let mut found = model.coefficient_buffer::<f64>();
    model.reduce(q, &mut workspace, &mut found).expect("a pose");
    let pairs = [
        (found.m, 0.0456),
        (found.half_dm, -0.005_912_066_8),
        (found.a[0], 0.0256),
        (found.a[1], 0.011_085_125),
        (found.a[2], -0.0064),
        (found.b[0], -0.005_912_066_8),
        (found.b[1], -0.002_56),
        (found.b[2], 0.001_478_016_7),
    ];
    // Nine digits behind the point are printed, or more.
    for (found, printed) in pairs {
        assert!((found - printed).abs() < 5.1e-10, "{found} for {printed}");
    }
}
