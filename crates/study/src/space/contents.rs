//! What a scene in space has, for `dwell check`: its size and masses at the start, loads, drives, stops and motions.

use crate::contents::{
    Coordinates, ScheduledMotions, describe_drives, describe_motions, describe_stops, magnitude,
};
use crate::number_format::number;
use dwell_findings::Record;
use dwell_geometry::BodyId;
use dwell_geometry::space::{Coordinate, Placement, Plan, Vec3};
use dwell_kinetostatics::Magnitude;
use dwell_kinetostatics::space::{Load, LoadKind, Mass};
use dwell_scene::SpaceScene;

/// A coordinate below this part of the size of the mechanism is but rounding.
const ROUNDING: f64 = 1e-12;

/// Its size, masses, loads, drives, stops and motions as lines of text; the numbers go into the record.
pub(super) fn describe_contents(scene: &SpaceScene, plan: &Plan, record: &mut Record) -> String {
    let mut pose = plan.pose();
    let places: Vec<Placement> = match plan.positions(&scene.assembly.q, &mut pose) {
        Ok(()) => {
            let bodies = 0..scene.mechanism.bodies.len();
            bodies.map(|b| plan.placement(&pose, b)).collect()
        }
        Err(_) => Vec::new(),
    };
    let coordinates = Coordinates {
        name: &|coordinate| scene.name_of(coordinate),
        is_angle: Coordinate::is_angle,
    };
    let motions = ScheduledMotions {
        prescribed: scene.prescribed.as_ref(),
        sweep: scene.sweep.as_ref(),
        motion: scene.motion.as_ref(),
    };
    describe_size(scene, &places, record)
        + &describe_masses(scene, &places, plan.size(), record)
        + &describe_loads(scene, record)
        + &describe_drives(&scene.drives, &coordinates, record)
        + &describe_stops(scene, record)
        + &describe_motions(scene, &motions, record)
}

/// Three numbers in the scene's unit of lengths, and that unit.
fn in_scene_units(scene: &SpaceScene, vector: Vec3) -> ([String; 3], &str) {
    let all = [vector.x, vector.y, vector.z].map(|part| scene.to_scene_unit(part, false));
    (all.map(|(part, _)| number(part)), all[0].1)
}

/// The extents, along the axes of the ground, of the box around all points at which joints act, at the start.
fn describe_size(scene: &SpaceScene, places: &[Placement], record: &mut Record) -> String {
    if places.is_empty() {
        return String::new();
    }
    let joints = scene.mechanism.joints.iter();
    let points = joints.flat_map(|joint| {
        [0, 1].map(|k| {
            let place = &places[joint.side_body(k).0];
            place.position + place.rotation.apply(joint.sides[k].point)
        })
    });
    let points: Vec<Vec3> = points.collect();
    let extent = |axis: Vec3| {
        let [low, high] = crate::ranges::extent(points.iter().map(|p| p.dot(axis)));
        high - low
    };
    let [x, y, z] = Vec3::AXES.map(extent);
    if ![x, y, z].iter().all(|side| side.is_finite()) {
        return String::new();
    }
    for (axis, side) in ["x", "y", "z"].into_iter().zip([x, y, z]) {
        record.add(format!("size.{axis}"), "m", side);
    }
    let ([x, y, z], unit) = in_scene_units(scene, Vec3 { x, y, z });
    format!(
        "  overall size at the start: {x} by {y} by {z} {unit}, around the points of all joints\n"
    )
}

/// The whole mass and its centre at the start, and the mass of each body.
fn describe_masses(
    scene: &SpaceScene,
    places: &[Placement],
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
    if total > 0.0 && !places.is_empty() {
        let moments = massive.iter().map(|(b, m)| {
            let center = places[*b].position + places[*b].rotation.apply(m.center);
            center.scaled(m.mass)
        });
        let sum = moments.fold(Vec3::ZERO, |sum, moment| sum + moment);
        let center = sum.scaled(1.0 / total);
        let written = |part: f64| {
            if part.abs() < ROUNDING * size {
                0.0
            } else {
                part
            }
        };
        let center = Vec3 {
            x: written(center.x),
            y: written(center.y),
            z: written(center.z),
        };
        for (axis, part) in ["x", "y", "z"]
            .into_iter()
            .zip([center.x, center.y, center.z])
        {
            record.add(format!("mass.center.{axis}"), "m", part);
        }
        let ([x, y, z], unit) = in_scene_units(scene, center);
        text += &format!(", its centre at the start at ({x}, {y}, {z}) {unit}");
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

/// What a load is, and the unit of its number.
fn described(scene: &SpaceScene, load: &Load) -> (String, &'static str) {
    let name = |body: BodyId| scene.mechanism.bodies[body.0].name.as_str();
    let joint = |joint: dwell_geometry::JointId| &scene.mechanism.joints[joint.0].name;
    let between = |[a, b]: [BodyId; 2]| format!("between {} and {}", name(a), name(b));
    match load.kind {
        LoadKind::Gravity(_) => ("gravity".to_owned(), "m/s²"),
        LoadKind::Force { body, .. } => (format!("force on {}", name(body)), "N"),
        LoadKind::Torque { bodies: [a, b], .. } => {
            (format!("couple of {} on {}", name(a), name(b)), "N m")
        }
        LoadKind::PointToPointForce { bodies, .. } => (format!("force {}", between(bodies)), "N"),
        LoadKind::Spring { bodies, .. } => (format!("spring {}", between(bodies)), "N/m"),
        LoadKind::Damper { bodies, .. } => (format!("damper {}", between(bodies)), "N s/m"),
        LoadKind::JointTorque(j) => (format!("moment about the axis of {}", joint(j)), "N m"),
        LoadKind::TorsionSpring { joint: j, .. } => {
            (format!("torsion spring in {}", joint(j)), "N m/rad")
        }
        LoadKind::RotationalDamper(j) => {
            (format!("rotational damper in {}", joint(j)), "N m s/rad")
        }
        LoadKind::SlideForce(j) => (format!("force along {}", joint(j)), "N"),
        LoadKind::SlideDamper(j) => (format!("damper along {}", joint(j)), "N s/m"),
    }
}

fn describe_loads(scene: &SpaceScene, record: &mut Record) -> String {
    if scene.loads.is_empty() {
        return "  no loads\n".to_owned();
    }
    let lines = scene.loads.iter().map(|load| {
        let (kind, unit) = described(scene, load);
        let name = format!("load.{}", load.name);
        let name_of = |coordinate| scene.name_of(coordinate);
        let of: &Magnitude<Coordinate> = &load.magnitude;
        let magnitude = magnitude(&name_of, of, (&name, unit), record);
        format!("    {}: {kind}, {magnitude}\n", load.name)
    });
    "  loads:\n".to_owned() + &lines.collect::<String>()
}
