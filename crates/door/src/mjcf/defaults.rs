//! Classes of defaults, and the frames of elements.

use super::Reader;
use crate::error::Result;
use crate::pose::{Matrix, Pose, cross, length, scaled, unit};
use crate::xml::Element;

/// The name of the class of all elements.
const MAIN: &str = "main";

#[derive(Default)]
pub(super) struct Class<'d> {
    parent: Option<&'d str>,
    elements: Vec<Element<'d>>,
}

impl<'d> Reader<'d> {
    /// Reads a section of defaults. The first has the class of all elements.
    pub(super) fn defaults(&mut self, section: Element<'d>, parent: Option<&'d str>) {
        let own = section.attribute("class");
        let main = *self.main_class.get_or_insert(own.unwrap_or(MAIN));
        let name = own.unwrap_or(main);
        for child in section.children() {
            if child.tag() == "default" {
                self.defaults(child, Some(name));
            } else {
                let class = self.classes.entry(name).or_default();
                class.elements.push(child.read());
            }
        }
        let class = self.classes.entry(name).or_default();
        let parent = parent.or(Some(main)).filter(|parent| *parent != name);
        class.parent = class.parent.or(parent);
    }

    /// An element with the defaults of its class, or of that of the bodies around it.
    pub(super) fn classed(
        &self,
        element: Element<'d>,
        inherited: Option<&'d str>,
    ) -> Result<Element<'d>> {
        let own = element.attribute("class");
        let mut class = own.or(inherited).or(self.main_class).unwrap_or(MAIN);
        let unknown = own.is_some() && !self.classes.contains_key(class);
        element.known((!unknown).then_some(()), "class of defaults", class)?;
        let mut defaults = Vec::new();
        // A class is its own ancestor only in a file that no program reads.
        for _ in 0..=self.classes.len() {
            let Some(one) = self.classes.get(class) else {
                break;
            };
            let same = |other: &&Element<'d>| other.tag() == element.tag();
            defaults.extend(one.elements.iter().rev().filter(same));
            class = one.parent.unwrap_or_default();
        }
        Ok(element.with_defaults(&defaults))
    }

    /// The frame of an element in that around it.
    pub(super) fn pose(&self, of: Element<'d>) -> Result<Pose> {
        let origin = of.vector("pos")?.unwrap_or_default();
        let turn = if let Some(quat) = of.vector("quat")? {
            Matrix::quaternion(quat)
        } else if let Some([x, y, z, angle]) = of.vector("axisangle")? {
            unit([x, y, z]).map(|axis| Matrix::about(axis, angle * self.angle))
        } else if let Some([a, b, c, d, e, f]) = of.vector("xyaxes")? {
            let x = unit([a, b, c]);
            let z = x.and_then(|x| unit(cross(x, [d, e, f])));
            let axes = x.zip(z);
            axes.map(|(x, z)| Matrix([x, cross(z, x), z]).transposed())
        } else if let Some(z) = of.vector("zaxis")? {
            unit(z).map(shortest_to)
        } else if let Some(euler) = of.vector("euler")? {
            Some(turns(scaled(euler, self.angle), self.sequence))
        } else {
            Some(Matrix::IDENTITY)
        };
        let turn = turn.ok_or_else(|| of.error("the orientation is zero"))?;
        Ok(Pose::new(origin, turn))
    }
}

/// Turns about moving axes (lower case) or fixed ones (upper case).
fn turns(angles: [f64; 3], sequence: [char; 3]) -> Matrix {
    let mut turn = Matrix::IDENTITY;
    for (angle, axis) in angles.into_iter().zip(sequence) {
        let k = "xyz".find(axis.to_ascii_lowercase()).unwrap_or(0);
        let one = Matrix::about(Matrix::IDENTITY.column(k), angle);
        turn = match axis.is_lowercase() {
            true => turn.times(one),
            false => one.times(turn),
        };
    }
    turn
}

/// The rotation by the least angle that turns z along `axis`.
pub(super) fn shortest_to(axis: [f64; 3]) -> Matrix {
    let across = cross([0.0, 0.0, 1.0], axis);
    match unit(across) {
        Some(about) => Matrix::about(about, length(across).atan2(axis[2])),
        None if axis[2] < 0.0 => Matrix::diagonal([1.0, -1.0, -1.0]),
        None => Matrix::IDENTITY,
    }
}
