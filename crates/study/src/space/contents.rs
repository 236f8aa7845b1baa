//! The contents of a scene in space, for `dwell check`: its size and masses at the start, loads, drives, stops and
//! motions.

use super::views::placed;
use crate::contents::{ScheduledMotions, describe_actions, describe_center, describe_size};
use crate::number_format::number;
use dwell_findings::Record;
use dwell_geometry::BodyId;
use dwell_geometry::space::{Placement, Plan, Vec3};
use dwell_kinetostatics::LoadNames;
use dwell_kinetostatics::space::Mass;
use dwell_scene::SpaceScene;

/// Its size, masses, loads, drives, stops and motions as lines of text; the numbers go into the record.
pub(super) fn describe_contents(scene: &SpaceScene, plan: &Plan, record: &mut Record) -> String {
    let mut pose = plan.pose();
    let found = plan.positions(&scene.assembly.q, &mut pose);
    let places = found.ok().map(|()| {
        let bodies = 0..scene.mechanism.bodies.len();
        bodies.map(|b| plan.placement(&pose, b)).collect::<Vec<_>>()
    });
    let motions = ScheduledMotions {
        prescribed: scene.prescribed.as_ref(),
        sweep: scene.sweep.as_ref(),
        motion: scene.motion.as_ref(),
    };
    let names = LoadNames {
        bodies: scene.mechanism.bodies.iter().map(|b| &b.name[..]).collect(),
        joints: scene.mechanism.joints.iter().map(|j| &j.name[..]).collect(),
    };
    let mut text = String::new();
    if let Some(places) = &places {
        let joints = scene.mechanism.joints.iter();
        let points = joints.flat_map(|joint| {
            [0, 1].map(|k| components(placed(places, joint.side_body(k), joint.sides[k].point)))
        });
        text += &describe_size(scene, ["x", "y", "z"], points, record);
    }
    text + &describe_masses(scene, places.as_deref(), plan.size(), record)
        + &describe_actions(scene, &scene.loads, &names, &motions, record)
}

fn components(v: Vec3) -> [f64; 3] {
    [v.x, v.y, v.z]
}

/// The total mass, the centre of mass at the start, and the mass of each body.
fn describe_masses(
    scene: &SpaceScene,
    places: Option<&[Placement]>,
    size: f64,
    record: &mut Record,
) -> String {
    let ground = scene.mechanism.ground;
    let massive = scene.masses.iter().enumerate().filter(|(b, m)| {
        *b != ground && (m.mass != 0.0 || m.inertia.iter().any(|part| *part != 0.0))
    });
    let massive: Vec<_> = massive.collect();
    let total: f64 = massive.iter().map(|(_, m)| m.mass).sum();
    record.add("mass", "kg", total);
    if massive.is_empty() {
        return "  no body has a mass\n".to_owned();
    }
    let mut text = format!("  moving mass {} kg", number(total));
    if let Some(places) = places.filter(|_| total > 0.0) {
        let moments = massive.iter().map(|(b, m)| {
            let center = placed(places, BodyId(*b), m.center);
            center.scaled(m.mass)
        });
        let sum = moments.fold(Vec3::ZERO, |sum, moment| sum + moment);
        let center = components(sum.scaled(1.0 / total));
        text += &describe_center(scene, center, size, record);
    }
    text += ":\n";
    for (b, mass) in massive {
        let name = &scene.mechanism.bodies[b].name;
        text += &describe_mass(name, mass, record);
    }
    text
}

/// The mass and the tensor of inertia of a body.
fn describe_mass(name: &str, mass: &Mass, record: &mut Record) -> String {
    record.add(format!("mass.{name}"), "kg", mass.mass);
    let parts = ["xx", "yy", "zz", "xy", "xz", "yz"].into_iter();
    for (part, value) in parts.zip(mass.inertia) {
        record.add(format!("inertia.{name}.{part}"), "kg m2", value);
    }
    let has_products = mass.inertia[3..].iter().any(|part| *part != 0.0);
    let written = if has_products { 6 } else { 3 };
    let tensor = mass.inertia[..written].iter().map(|part| number(*part));
    let tensor: Vec<String> = tensor.collect();
    format!(
        "    {name}: {} kg, [{}] kg m² about its centre of mass, in its axes\n",
        number(mass.mass),
        tensor.join(", ")
    )
}
