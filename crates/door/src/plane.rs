//! Mechanisms that move in a plane.

use crate::model::{Action, GROUND, Joint, Kind, Model};
use crate::options::ImportOptions;
use crate::pose::{Pose, Vector, cross, dot, length, perpendicular, scaled, sub, unit};

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
        // Along an axis of the ground, if it is so but for rounding.
        let rounded = normal.map(f64::round);
        let is_axis = length(sub(normal, rounded)) < ROUNDING;
        let normal = if is_axis { rounded } else { normal };
        let up = match normal[2].abs() > 0.9 {
            true => [0.0, 1.0, 0.0],
            false => [0.0, 0.0, 1.0],
        };
        let flat = sub(up, scaled(normal, dot(up, normal)));
        let y = unit(flat).unwrap_or_else(|| perpendicular(normal));
        let x = cross(y, normal);
        // Of the two sides the one from which x points along an axis of the ground, not against it.
        let larger = |most: f64, c: &f64| {
            if c.abs() > most.abs() + 1e-9 {
                *c
            } else {
                most
            }
        };
        let side = x.iter().fold(0.0, larger).signum();
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

/// The plane in which the mechanism moves, unless it moves in space. What is set right is named.
pub(crate) fn find(model: &Model, options: &ImportOptions) -> Option<Plane> {
    let plane = Plane::new(normal(model).filter(|_| !options.spatial)?);
    let size = size(model);
    let tolerance = options.tolerance.map_or(TOLERANCE, |length| length / size);
    let deviations = deviations(model, plane.normal, size)?;
    let amounts = deviations.iter().map(|(_, amount, _)| *amount);
    let largest = amounts.fold(0.0, f64::max);
    if largest > tolerance {
        if largest < NEARLY {
            let needed = largest * size;
            let text = format!("nearly planar: `--tolerance {needed:.1e}` (m) makes it planar");
            model.bodies[GROUND].place.kept(text);
        }
        return None;
    }
    for (joint, amount, shown) in deviations {
        if amount > ROUNDING {
            let text = format!("snapped: `{}` by {shown}", joint.name);
            joint.place.kept(text);
        }
    }
    Some(plane)
}

/// The largest distance of joints along an axis of the ground.
pub(crate) fn size(model: &Model) -> f64 {
    let ends = model.joints.iter().flat_map(|joint| joint.ends);
    let points: Vec<Vector> = ends.map(|end| end.frame.origin).collect();
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
        joints.map(Joint::axis)
    };
    if let Some(axis) = of(Kind::Hinge).next() {
        return Some(axis);
    }
    let first = of(Kind::Slide).next()?;
    let across = of(Kind::Slide).map(|axis| cross(first, axis));
    let across = across.max_by(|a, b| length(*a).total_cmp(&length(*b)))?;
    match length(across) > NEARLY {
        true => unit(across),
        false => Some(perpendicular(first)),
    }
}

/// A joint that is not as in a planar mechanism: by how much, in rad or relative to the size, and how this is written.
type Deviation<'m> = (&'m Joint, f64, String);

/// How far the joints are from those of a planar mechanism; none if some can never be.
fn deviations<'m>(model: &'m Model, n: Vector, size: f64) -> Option<Vec<Deviation<'m>>> {
    // Hinges and slides have to keep all bodies in the plane: balls among them are then pins.
    let keeps = |joint: &Joint| matches!(joint.kind, Kind::Hinge | Kind::Slide | Kind::Fixed);
    let component = model.components(|_, joint| keeps(joint));
    let depth = |a: Vector, b: Vector| (dot(n, b) - dot(n, a)).abs();
    let mut all = Vec::new();
    for joint in &model.joints {
        if joint.bodies().iter().any(|body| component[*body] != GROUND) {
            return None;
        }
        let ends = joint.ends.map(|end| end.frame);
        let depth = depth(ends[0].origin, ends[1].origin);
        let inside = |end: Pose| end.turn.transposed().apply(n);
        let tilts = match joint.kind {
            Kind::Hinge | Kind::Cylinder => ends.map(|end| length(cross(end.turn.column(2), n))),
            Kind::Slide => ends.map(|end| dot(end.turn.column(2), n).abs()),
            Kind::Fixed => [length(cross(inside(ends[0]), inside(ends[1]))), 0.0],
            Kind::Distance(_) if depth > ROUNDING * size => return None,
            Kind::Ball | Kind::Distance(_) => [0.0; 2],
            Kind::Universal | Kind::Screw(_) | Kind::Planar => return None,
        };
        let tilt = tilts[0].max(tilts[1]);
        all.push((joint, tilt, format!("{tilt:.1e} rad of its axis")));
        if !joint.in_tree && matches!(joint.kind, Kind::Hinge | Kind::Ball | Kind::Fixed) {
            let shown = format!("{depth:.1e} m along the normal");
            all.push((joint, depth / size, shown));
        }
    }
    for load in &model.loads {
        if let (Action::Spring { .. }, [a, b]) = (&load.action, &load.at[..])
            && depth(a.1, b.1) > ROUNDING * size
        {
            return None;
        }
    }
    Some(all)
}
