//! Mechanisms that move in a plane.

use crate::finding::Effect;
use crate::model::{GROUND, Joint, Kind, Load, Model};
use crate::options::ImportOptions;
use crate::pose::{Pose, Vector, cross, dot, length, perpendicular, scaled, sub, unit};
use crate::settle::components;

/// What differs by less is rounding, in rad, or relative to the size.
const ROUNDING: f64 = 1e-13;
/// Points may be as far from the plane, relative to the size, and axes may tilt as much in rad.
const TOLERANCE: f64 = 1e-6;
/// A mechanism within this is called nearly planar.
const NEARLY: f64 = 0.02;

/// The axes of a plane through the origin of the ground.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    pub(crate) x: Vector,
    pub(crate) y: Vector,
    pub(crate) normal: Vector,
}

impl Plane {
    fn new(normal: Vector) -> Self {
        let normal = snapped(normal);
        let up = if normal[2].abs() > 0.9 {
            [0.0, 1.0, 0.0]
        } else {
            [0.0, 0.0, 1.0]
        };
        let flat = sub(up, scaled(normal, dot(up, normal)));
        let y = unit(flat).unwrap_or_else(|| perpendicular(normal));
        let x = cross(y, normal);
        // Of the two sides the one from which x points along an axis of the ground, not against it.
        let most = x.iter().fold(0.0f64, |most, c| {
            if c.abs() > most.abs() + 1e-9 {
                *c
            } else {
                most
            }
        });
        let side = if most < 0.0 { -1.0 } else { 1.0 };
        // Zero in place of rounding, and of minus zero.
        let clean = |v: Vector| v.map(|c| if c.abs() < ROUNDING / 1000.0 { 0.0 } else { c });
        Self {
            x: clean(scaled(x, side)),
            y: clean(y),
            normal: clean(scaled(normal, side)),
        }
    }

    pub(crate) fn point(&self, point: Vector) -> [f64; 2] {
        [dot(self.x, point), dot(self.y, point)]
    }
}

/// A unit vector along an axis of the ground, if it is so but for rounding.
fn snapped(axis: Vector) -> Vector {
    let rounded = axis.map(f64::round);
    if length(sub(axis, rounded)) < ROUNDING {
        rounded
    } else {
        axis
    }
}

/// A deviation from the plane: the part, how much in its unit, and relative to the size, or in rad.
struct Deviation<'m> {
    joint: &'m Joint,
    amount: String,
    relative: f64,
}

/// The plane in which the mechanism moves, unless it moves in space. What is set right is named.
pub(crate) fn find(model: &Model, options: &ImportOptions) -> Option<Plane> {
    if !options.flatten {
        return None;
    }
    let plane = Plane::new(normal(model)?);
    let size = size(model);
    let tolerance = options.tolerance.map_or(TOLERANCE, |length| length / size);
    let deviations = deviations(model, &plane, size)?;
    let largest = deviations
        .iter()
        .map(|one| one.relative)
        .fold(0.0, f64::max);
    if largest > tolerance {
        if largest < NEARLY {
            let needed = largest * size;
            let text = format!("nearly planar: `--tolerance {needed:.1e}` (m) makes it planar");
            model.note(&model.bodies[GROUND].place, Effect::Kept, text);
        }
        return None;
    }
    for one in deviations.iter().filter(|one| one.relative > ROUNDING) {
        let text = format!("snapped: `{}` by {}", one.joint.name, one.amount);
        model.note(&one.joint.place, Effect::Kept, text);
    }
    Some(plane)
}

/// The largest distance of joints along an axis of the ground.
pub(crate) fn size(model: &Model) -> f64 {
    let ends = model.joints.iter().flat_map(Joint::ends);
    let points: Vec<Vector> = ends.map(|end| model.drawn(end).origin).collect();
    let extent = |k: usize| {
        let most = points.iter().map(|p| p[k]).fold(f64::MIN, f64::max);
        most - points.iter().map(|p| p[k]).fold(f64::MAX, f64::min)
    };
    let size = (0..3).map(extent).fold(0.0, f64::max);
    if size > 0.0 { size } else { 1.0 }
}

/// The direction that hinges turn about, or across two slides.
fn normal(model: &Model) -> Option<Vector> {
    let of = |kind: Kind| {
        let joints = model.joints.iter().filter(move |joint| joint.kind == kind);
        joints.map(|joint| model.drawn(&joint.second).turn.column(2))
    };
    if let Some(axis) = of(Kind::Hinge).next() {
        return Some(axis);
    }
    let first = of(Kind::Slide).next()?;
    let across = of(Kind::Slide).map(|axis| cross(first, axis));
    let across = across.max_by(|a, b| length(*a).total_cmp(&length(*b)))?;
    if length(across) > NEARLY {
        unit(across)
    } else {
        Some(perpendicular(first))
    }
}

/// How far the joints are from those of a planar mechanism; none if some can never be.
fn deviations<'m>(model: &'m Model, plane: &Plane, size: f64) -> Option<Vec<Deviation<'m>>> {
    let n = plane.normal;
    let mut all = Vec::new();
    // Hinges and slides have to keep all bodies in the plane: balls among them are then pins.
    let keeps = |joint: &&Joint| matches!(joint.kind, Kind::Hinge | Kind::Slide | Kind::Fixed);
    let keeping: Vec<Joint> = model.joints.iter().filter(keeps).cloned().collect();
    let component = components(model, &keeping);
    for joint in &model.joints {
        if joint.ends().iter().any(|end| component[end.body] != GROUND) {
            return None;
        }
        let ends = joint.ends().map(|end| model.drawn(end));
        let depth = (dot(n, ends[1].origin) - dot(n, ends[0].origin)).abs();
        let across = |end: Pose| length(cross(end.turn.column(2), n));
        let along = |end: Pose| dot(end.turn.column(2), n).abs();
        let inside = |end: Pose| end.turn.transposed().apply(n);
        let tilts = match joint.kind {
            Kind::Hinge | Kind::Cylinder => ends.map(across),
            Kind::Slide => ends.map(along),
            Kind::Fixed => [length(cross(inside(ends[0]), inside(ends[1]))), 0.0],
            Kind::Distance(_) if depth > ROUNDING * size => return None,
            Kind::Ball | Kind::Distance(_) => [0.0; 2],
            Kind::Universal | Kind::Screw(_) | Kind::Planar => return None,
        };
        let tilt = tilts[0].max(tilts[1]);
        let amount = format!("{tilt:.1e} rad of its axis");
        all.push(Deviation {
            joint,
            amount,
            relative: tilt,
        });
        if !joint.in_tree && matches!(joint.kind, Kind::Hinge | Kind::Ball | Kind::Fixed) {
            let (amount, relative) = (format!("{depth:.1e} m along the normal"), depth / size);
            all.push(Deviation {
                joint,
                amount,
                relative,
            });
        }
    }
    for load in &model.loads {
        if let Load::Spring { ends, .. } = load {
            let [a, b] = ends.map(|(body, point)| dot(n, model.bodies[body].pose.point(point)));
            if (a - b).abs() > ROUNDING * size {
                return None;
            }
        }
    }
    Some(all)
}
