//! Masses of geoms.

use super::defaults::{Angles, Item, shortest_to};
use crate::error::DoorError;
use crate::finding::Effect;
use crate::pose::{Matrix, Pose, Vector, add, length, scaled, sub, unit};
use std::f64::consts::PI;

/// kg/m³, where neither mass nor density is given.
const DENSITY: f64 = 1000.0;

/// Mass, frame and tensor of a geom, in the frame around it.
pub(super) struct Mass {
    pub(super) mass: f64,
    pub(super) center: Vector,
    pub(super) inertia: Matrix,
}

/// The mass of a geom; none of a plane, a height field, or a mesh.
pub(super) fn mass(item: &Item<'_>, angles: Angles) -> Result<Option<Mass>, DoorError> {
    let element = item.element;
    let kind = item.text("type").unwrap_or("sphere");
    let mut pose = item.pose(angles)?;
    let mut size = item.numbers("size")?.unwrap_or_default();
    if let Some([a, b, c, d, e, f]) = item.vector("fromto")? {
        let (from, to) = ([a, b, c], [d, e, f]);
        // From the first end to the second, as MuJoCo turns it: z points back.
        let back = unit(sub(from, to));
        let back = back.ok_or_else(|| {
            element.error(format!("the ends of {} coincide", element.label()), "")
        })?;
        let half = length(sub(to, from)) / 2.0;
        pose = Pose {
            origin: scaled(add(from, to), 0.5),
            turn: shortest_to(back),
        };
        let first = size.first().copied().unwrap_or_default();
        size = match kind {
            "capsule" | "cylinder" => vec![first, half],
            _ => vec![first, first, half],
        };
    }
    let size: [f64; 3] = [0, 1, 2].map(|k| size.get(k).copied().unwrap_or_default());
    let shell = item.is("shellinertia", "true");
    let (needs, unit_mass) = match kind {
        "plane" | "hfield" => return Ok(None),
        "sphere" => (1, sphere(size[0])),
        "capsule" => (2, capsule(size[0], size[1])),
        "cylinder" => (2, cylinder(size[0], size[1])),
        "box" => (3, cuboid(size)),
        "ellipsoid" => (3, ellipsoid(size)),
        _ => {
            let of = item
                .text("mesh")
                .map_or(String::new(), |mesh| format!(" {mesh}"));
            let text = format!(
                "geom {kind}{of}: inertia of a mesh: not computed, left out (changes the motion)"
            );
            element.note(Effect::Changes, text);
            return Ok(None);
        }
    };
    if size[..needs].iter().any(|x| !(*x > 0.0)) {
        let message = format!(
            "a {kind} needs {needs} sizes above zero: {}",
            element.label()
        );
        return Err(element.error(message, ""));
    }
    let density = item.number("density")?.unwrap_or(DENSITY);
    if shell {
        element.note(
            Effect::Changes,
            format!("{} shellinertia: taken as solid", element.label()),
        );
    }
    let (volume, gyration) = unit_mass;
    let mass = item.number("mass")?.unwrap_or(density * volume);
    Ok(Some(Mass {
        mass,
        center: pose.origin,
        inertia: Matrix::diagonal(scaled(gyration, mass)).turned(pose.turn),
    }))
}

type UnitMass = (f64, Vector);

fn sphere(r: f64) -> UnitMass {
    (4.0 / 3.0 * PI * r * r * r, [0.4 * r * r; 3])
}

fn cylinder(r: f64, half: f64) -> UnitMass {
    let across = r * r / 4.0 + half * half / 3.0;
    (2.0 * PI * r * r * half, [across, across, r * r / 2.0])
}

/// A cylinder between two half spheres.
fn capsule(r: f64, half: f64) -> UnitMass {
    let (middle, [middle_across, _, middle_along]) = cylinder(r, half);
    let (ends, [ends_own, ..]) = sphere(r);
    // Half a sphere, its centre of mass 3/8 r beyond the end of the cylinder.
    let offset = half + 0.375 * r;
    let ends_across = ends_own - (0.375 * r) * (0.375 * r) + offset * offset;
    let volume = middle + ends;
    let across = (middle * middle_across + ends * ends_across) / volume;
    let along = (middle * middle_along + ends * ends_own) / volume;
    (volume, [across, across, along])
}

fn cuboid([a, b, c]: Vector) -> UnitMass {
    let third = |x: f64, y: f64| (x * x + y * y) / 3.0;
    (8.0 * a * b * c, [third(b, c), third(a, c), third(a, b)])
}

fn ellipsoid([a, b, c]: Vector) -> UnitMass {
    let fifth = |x: f64, y: f64| (x * x + y * y) / 5.0;
    (
        4.0 / 3.0 * PI * a * b * c,
        [fifth(b, c), fifth(a, c), fifth(a, b)],
    )
}
