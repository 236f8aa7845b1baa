//! A planar linkage that drives one in space, and what the planar cases are [placed obliquely in space](dwell_validation::lifted) with.

use dwell_geometry::space::{Joint, JointKind, Placement, Rotation, Side, Vec3, vec3};
use dwell_geometry::{Body, JointId};
use dwell_kinetostatics::space::{Axes, Component, Mass, Reaction};
pub use dwell_validation::lifted::{Lifted, Plane, lifted_scene, tilt};

/// The planar crank-rocker obliquely in space, whose rocker drives another in space by a rod between two balls.
pub fn crank_rocker_and_rod() -> Lifted {
    let scene = crate::fixtures::scene("crank-rocker");
    let (_, lifted) = lifted_scene(&scene).expect("four revolute joints");
    let Lifted {
        mut mechanism,
        mut masses,
        mut assembly,
    } = lifted;
    let bodies = mechanism.bodies.iter();
    let rocker = bodies.clone().position(|b| b.name == "rocker");
    let (rocker, rod) = (rocker.expect("a rocker"), bodies.len());
    let on_rocker = vec3(0.4, 0.1, 0.2);
    let place = assembly.placements[rocker];
    let from = place.position + place.rotation.apply(on_rocker);
    let to = from + vec3(2.0, 1.5, 3.0);
    let hinge = to + vec3(0.2, -1.9, 0.4);
    let along = to - from;
    let e = along.unit().expect("a length");
    let across = |a: f64, b: f64| -0.3 * a * b;
    mechanism
        .bodies
        .extend(["rod", "follower"].map(Body::named));
    masses.push(Mass {
        mass: 1.0,
        center: along.scaled(0.5),
        inertia: [
            0.3 + across(e.x, e.x),
            0.3 + across(e.y, e.y),
            0.3 + across(e.z, e.z),
            across(e.x, e.y),
            across(e.x, e.z),
            across(e.y, e.z),
        ],
    });
    masses.push(Mass {
        mass: 1.5,
        center: vec3(0.1, 0.5, -0.2),
        inertia: [0.2, 0.25, 0.3, 0.01, 0.02, 0.03],
    });
    let ball = |name: &str, bodies: [usize; 2], points: [Vec3; 2]| {
        let sides = points.map(|point| Side {
            point,
            ..Side::default()
        });
        Joint::new(name, bodies, JointKind::Spherical, sides)
    };
    let on_hinge = |point: Vec3| Side {
        point,
        axis: vec3(0.3, 0.5, 0.9),
        ..Side::default()
    };
    mechanism.joints.extend([
        ball("E", [rocker, rod], [on_rocker, Vec3::ZERO]),
        ball("F", [rod, rod + 1], [along, to - hinge]),
        Joint::new(
            "G",
            [mechanism.ground, rod + 1],
            JointKind::Revolute,
            [on_hinge(hinge), on_hinge(Vec3::ZERO)],
        ),
    ]);
    assembly
        .placements
        .extend([from, hinge].map(|position| Placement {
            position,
            rotation: Rotation::IDENTITY,
        }));
    Lifted {
        mechanism,
        masses,
        assembly,
    }
}

/// All forces and moments of joints in these axes.
pub fn wrenches(joints: usize, axes: Axes) -> Vec<Reaction> {
    let of_joint = |j: usize| {
        let parts: [fn(Axes, usize) -> Component; 2] = [Component::Force, Component::Moment];
        parts.into_iter().flat_map(move |part| {
            (0..3).map(move |k| Reaction {
                joint: JointId(j),
                component: part(axes, k),
            })
        })
    };
    (0..joints).flat_map(of_joint).collect()
}
