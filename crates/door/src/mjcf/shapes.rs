//! Masses of geoms, and which of them would touch.

use super::Reader;
use super::defaults::shortest_to;
use crate::error::Result;
use crate::finding::Effect;
use crate::model::{GROUND, Joint, Kind};
use crate::pose::{Matrix, Pose, Vector, add, length, scaled, sub};
use crate::xml::Element;
use std::f64::consts::PI;

/// kg/m³, where neither mass nor density is given.
const DENSITY: f64 = 1000.0;
const TOUCHED: &str = "left out (changes the motion if touched)";

impl<'d> Reader<'d> {
    /// The mass of a geom, its frame, and its tensor, if geoms give the masses; planes, height fields and meshes have none.
    pub(super) fn mass_of(
        &self,
        geom: Element<'d>,
        frame: Pose,
        takes: bool,
    ) -> Result<Option<(f64, Pose, Matrix)>> {
        let kind = geom.attribute("type").unwrap_or("sphere");
        let mut pose = frame.then(self.pose(geom)?);
        let mut size = geom.numbers("size")?.unwrap_or_default();
        size.resize(3, 0.0);
        if let Some([a, b, c, d, e, f]) = geom.vector("fromto")? {
            // As MuJoCo turns it: z points from the second end to the first.
            let along = sub([a, b, c], [d, e, f]);
            let middle = scaled(add([a, b, c], [d, e, f]), 0.5);
            pose = frame.then(Pose::new(middle, shortest_to(geom.unit(along)?)));
            let half = length(along) / 2.0;
            size = match kind {
                "capsule" | "cylinder" => vec![size[0], half, 0.0],
                _ => vec![size[0], size[0], half],
            };
        }
        let [a, b, c] = [size[0], size[1], size[2]];
        let (needs, (volume, gyration)) = match kind {
            "plane" | "hfield" => return Ok(None),
            "sphere" => (1, ellipsoid([a; 3])),
            "capsule" => (2, capsule(a, b)),
            "cylinder" => (2, cylinder(a, b)),
            "box" => (3, cuboid([a, b, c])),
            "ellipsoid" => (3, ellipsoid([a, b, c])),
            _ => {
                let mesh = geom.attribute("mesh").unwrap_or_default();
                if takes {
                    let of = format!("geom {kind} {mesh}");
                    geom.lost(format!("{}: inertia of a mesh", of.trim_end()));
                }
                return Ok(None);
            }
        };
        if size[..needs].iter().any(|x| *x <= 0.0) {
            return Err(geom.error(format!("a {kind} needs {needs} sizes above zero")));
        }
        let mass = geom.value("density", DENSITY)? * volume;
        let mass = geom.mass(geom.value("mass", mass)?)?;
        let tensor = Matrix::diagonal(scaled(gyration, mass));
        Ok(takes.then_some((mass, pose, tensor)))
    }

    pub(super) fn contact(&mut self, element: Element<'d>) {
        if element.tag() == "pair" {
            element.leave(Effect::Changes, format!("contact pair: {TOUCHED}"));
        } else if element.tag() == "exclude" {
            let names = ["body1", "body2"].map(|name| element.attribute(name).unwrap_or_default());
            self.excluded.push(names);
        }
    }

    /// Names the geoms of the world that others can touch, and the first of the others.
    pub(super) fn name_contacts(&self, floating_alone: bool) -> Result<()> {
        let is_fixed = |joint: &Joint| joint.in_tree && joint.kind == Kind::Fixed;
        let fixed = self.model.components(|_, joint| is_fixed(joint));
        let (mut still, mut moving) = (Vec::new(), Vec::new());
        for (geom, body) in &self.shapes {
            let bits = [geom.value("contype", 1.0)?, geom.value("conaffinity", 1.0)?];
            let shape = (*geom, *body, bits.map(|bits| bits as u32));
            match fixed[*body] {
                GROUND => still.push(shape),
                _ if floating_alone && !self.model.is_used(*body) => {}
                _ => moving.push(shape),
            }
        }
        if !self.touches {
            return Ok(());
        }
        let meets = |[a, b]: [u32; 2], [c, d]: [u32; 2]| a & d != 0 || c & b != 0;
        for (geom, _, bits) in still {
            if moving.iter().any(|(_, _, other)| meets(bits, *other)) {
                let kind = geom.attribute("type").unwrap_or("sphere");
                let text = format!("{}, {kind}: contact: {TOUCHED}", geom.label());
                geom.note(Effect::Changes, text);
            }
        }
        for (k, (geom, body, bits)) in moving.iter().enumerate() {
            let mut before = moving[..k].iter();
            if before
                .any(|(_, other, of)| meets(*bits, *of) && self.may_touch([*body, *other], &fixed))
            {
                let text = format!("contact between geoms of moving bodies: {TOUCHED}");
                geom.note(Effect::Changes, text);
                break;
            }
        }
        Ok(())
    }

    /// Geoms of one body, of a body and its parent, and of excluded bodies do not touch.
    fn may_touch(&self, pair: [usize; 2], fixed: &[usize]) -> bool {
        let names = pair.map(|body| self.model.bodies[body].name.as_str());
        let excluded = |pair: &[&str; 2]| pair.iter().all(|name| names.contains(name));
        let [a, b] = pair.map(|body| fixed[body]);
        let parent = |joint: &Joint| {
            let bodies = joint.bodies().map(|body| fixed[body]);
            joint.in_tree && bodies.contains(&a) && bodies.contains(&b)
        };
        a != b && !self.model.joints.iter().any(parent) && !self.excluded.iter().any(excluded)
    }
}

/// Volume, and the moments of inertia of a mass of 1.
type UnitMass = (f64, Vector);

fn cylinder(r: f64, half: f64) -> UnitMass {
    let across = r * r / 4.0 + half * half / 3.0;
    (2.0 * PI * r * r * half, [across, across, r * r / 2.0])
}

/// A cylinder between two half spheres.
fn capsule(r: f64, half: f64) -> UnitMass {
    let (middle, [middle_across, _, middle_along]) = cylinder(r, half);
    let (ends, [ends_own, ..]) = ellipsoid([r; 3]);
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
    let moments = [fifth(b, c), fifth(a, c), fifth(a, b)];
    (4.0 / 3.0 * PI * a * b * c, moments)
}
