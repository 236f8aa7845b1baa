//! Masses of geoms.

use super::defaults::{Angles, Item, shortest_to};
use crate::error::DoorError;
use crate::pose::{Matrix, Vector, add, length, scaled, sub};
use std::f64::consts::PI;

/// kg/m³, where neither mass nor density is given.
const DENSITY: f64 = 1000.0;

/// Mass, centre and tensor of a geom in the frame around it; none of a plane, a height field, or a mesh.
pub(super) fn mass(
    item: &Item<'_>,
    angles: Angles,
    takes: bool,
) -> Result<Option<Mass>, DoorError> {
    let element = item.element;
    let kind = item.text("type").unwrap_or("sphere");
    let mut pose = item.pose(angles)?;
    let mut size = item.numbers("size")?.unwrap_or_default();
    size.resize(3, 0.0);
    if let Some([a, b, c, d, e, f]) = item.vector("fromto")? {
        // As MuJoCo turns it: z points from the second end to the first.
        let along = sub([a, b, c], [d, e, f]);
        pose.turn = shortest_to(element.unit(along)?);
        pose.origin = scaled(add([a, b, c], [d, e, f]), 0.5);
        let half = length(along) / 2.0;
        size = match kind {
            "capsule" | "cylinder" => vec![size[0], half, 0.0],
            _ => vec![size[0], size[0], half],
        };
    }
    let [a, b, c] = [size[0], size[1], size[2]];
    let (needs, (volume, gyration)) = match kind {
        "plane" | "hfield" => return Ok(None),
        "sphere" => (1, sphere(a)),
        "capsule" => (2, capsule(a, b)),
        "cylinder" => (2, cylinder(a, b)),
        "box" => (3, cuboid([a, b, c])),
        "ellipsoid" => (3, ellipsoid([a, b, c])),
        _ => {
            let of = item
                .text("mesh")
                .map_or(String::new(), |mesh| format!(" {mesh}"));
            if takes {
                element.lost(format!("geom {kind}{of}: inertia of a mesh"));
            }
            return Ok(None);
        }
    };
    if size[..needs].iter().any(|x| *x <= 0.0) {
        return Err(element.error(format!("a {kind} needs {needs} sizes above zero")));
    }
    if item.is("shellinertia", "true") && takes {
        element.lost(format!("{} shellinertia, taken as solid", element.label()));
    }
    let mass = item.value("density", DENSITY)? * volume;
    let mass = element.mass(item.value("mass", mass)?)?;
    let inertia = Matrix::diagonal(scaled(gyration, mass)).turned(pose.turn);
    Ok(Some((mass, pose.origin, inertia)))
}

type Mass = (f64, Vector, Matrix);
/// Volume, and the moments of inertia of a mass of 1.
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
