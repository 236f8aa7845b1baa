//! Which geoms would touch.

use super::Reader;
use super::defaults::Item;
use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::GROUND;
use crate::xml::Element;

/// A geom, as far as it can touch others.
pub(super) struct Shape<'d> {
    element: Element<'d>,
    pub(super) body: usize,
    kind: &'d str,
    /// `contype` and `conaffinity`.
    bits: [u32; 2],
    pub(super) fluid: Option<&'d str>,
}

impl<'d> Shape<'d> {
    pub(super) fn new(item: &Item<'d>, body: usize) -> Result<Self, DoorError> {
        let bits = |name| Ok::<u32, DoorError>(item.number(name)?.map_or(1, |bits| bits as u32));
        let fluid = item.text("fluidshape").filter(|shape| *shape != "none");
        Ok(Self {
            element: item.element,
            body,
            kind: item.text("type").unwrap_or("sphere"),
            bits: [bits("contype")?, bits("conaffinity")?],
            fluid,
        })
    }

    fn meets(&self, other: &Self) -> bool {
        let [a, b] = [self.bits, other.bits];
        a[0] & b[1] != 0 || b[0] & a[1] != 0
    }
}

impl<'d> Reader<'d, '_> {
    pub(super) fn contact(&mut self, section: Element<'d>) {
        for child in section.children() {
            match child.tag() {
                "pair" => child.leave(
                    Effect::Changes,
                    "contact pair: left out (changes the motion if touched)",
                ),
                "exclude" => {
                    let names =
                        ["body1", "body2"].map(|name| child.attribute(name).unwrap_or_default());
                    self.excluded.push(names);
                    let _ = child.attribute("name");
                }
                _ => {}
            }
        }
    }

    /// Names the geoms of the world that others can touch, and counts the others.
    pub(super) fn name_contacts(&self) {
        let fixed = self.fixed_bodies();
        let (still, moving): (Vec<_>, Vec<_>) = self
            .shapes
            .iter()
            .partition(|shape| fixed[shape.body] == GROUND);
        let touches_before = |(k, shape): &(usize, &&Shape<'d>)| {
            let meets = |other: &&Shape<'d>| {
                shape.meets(other) && self.may_touch([shape.body, other.body], &fixed)
            };
            moving[..*k].iter().any(meets)
        };
        let among = moving.iter().enumerate().find(touches_before);
        let moving_meets = |shape: &Shape<'d>| moving.iter().any(|other| shape.meets(other));
        for shape in still
            .into_iter()
            .filter(|shape| self.touches && moving_meets(shape))
        {
            let text = format!(
                "{}, {}: contact: left out (changes the motion if touched)",
                shape.element.label(),
                shape.kind
            );
            shape.element.note(Effect::Changes, text);
        }
        if let Some((_, shape)) = among.filter(|_| self.touches) {
            let text =
                "contact between geoms of moving bodies: left out (changes the motion if touched)";
            shape.element.note(Effect::Changes, text);
        }
        for shape in &self.shapes {
            if shape.fluid.is_some() {
                shape.element.note(
                    Effect::Changes,
                    format!(
                        "{} fluidshape: left out (changes the motion)",
                        shape.element.label()
                    ),
                );
            }
        }
    }

    /// For each body the one that it is fixed to.
    fn fixed_bodies(&self) -> Vec<usize> {
        let mut fixed: Vec<usize> = (0..self.model.bodies.len()).collect();
        for joint in self.model.joints.iter().filter(|joint| joint.in_tree) {
            if joint.kind == crate::model::Kind::Fixed {
                fixed[joint.second.body] = fixed[joint.first.body];
            }
        }
        fixed
    }

    /// Geoms of one body, of a body and its parent, and of excluded bodies do not touch.
    fn may_touch(&self, [a, b]: [usize; 2], fixed: &[usize]) -> bool {
        let (one, other) = (fixed[a], fixed[b]);
        let joined = |joint: &crate::model::Joint| {
            let ends = [fixed[joint.first.body], fixed[joint.second.body]];
            joint.in_tree && (ends == [one, other] || ends == [other, one])
        };
        let name = |body: usize| self.model.bodies[body].name.as_str();
        let excluded =
            |[p, q]: &[&str; 2]| [*p, *q] == [name(a), name(b)] || [*p, *q] == [name(b), name(a)];
        one != other && !self.model.joints.iter().any(joined) && !self.excluded.iter().any(excluded)
    }
}
