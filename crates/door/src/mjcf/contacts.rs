//! Which geoms would touch.

use super::Reader;
use super::defaults::Item;
use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{GROUND, Joint, Kind};
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
        Ok(Self {
            element: item.element,
            body,
            kind: item.text("type").unwrap_or("sphere"),
            bits: [
                item.value("contype", 1.0)? as u32,
                item.value("conaffinity", 1.0)? as u32,
            ],
            fluid: item.text("fluidshape").filter(|shape| *shape != "none"),
        })
    }

    fn meets(&self, other: &Self) -> bool {
        self.bits[0] & other.bits[1] != 0 || other.bits[0] & self.bits[1] != 0
    }
}

impl<'d> Reader<'d, '_> {
    pub(super) fn contact(&mut self, element: Element<'d>) {
        if element.tag() == "pair" {
            let text = "contact pair: left out (changes the motion if touched)";
            element.leave(Effect::Changes, text);
        } else if element.tag() == "exclude" {
            let names = ["body1", "body2"].map(|name| element.attribute(name).unwrap_or_default());
            self.excluded.push(names);
        }
    }

    /// Names the geoms of the world that others can touch, and the first of the others.
    pub(super) fn name_contacts(&self) {
        let mut fixed: Vec<usize> = (0..self.model.bodies.len()).collect();
        let is_fixed = |joint: &&Joint| joint.in_tree && joint.kind == Kind::Fixed;
        for joint in self.model.joints.iter().filter(is_fixed) {
            fixed[joint.second.body] = fixed[joint.first.body];
        }
        let shapes = self.shapes.iter();
        let (still, moving): (Vec<_>, Vec<_>) =
            shapes.partition(|shape| fixed[shape.body] == GROUND);
        for shape in still
            .into_iter()
            .filter(|shape| moving.iter().any(|other| shape.meets(other)))
        {
            self.name_contact(
                shape,
                &format!("{}, {}: contact", shape.element.label(), shape.kind),
            );
        }
        let touches_before = |(k, shape): &(usize, &&Shape<'d>)| {
            let touches =
                |other: &&Shape<'d>| shape.meets(other) && self.may_touch(shape, other, &fixed);
            moving[..*k].iter().any(touches)
        };
        if let Some((_, shape)) = moving.iter().enumerate().find(touches_before) {
            self.name_contact(shape, "contact between geoms of moving bodies");
        }
        for shape in self.shapes.iter().filter(|shape| shape.fluid.is_some()) {
            shape
                .element
                .lost(format!("{} fluidshape", shape.element.label()));
        }
    }

    fn name_contact(&self, shape: &Shape<'d>, what: &str) {
        if self.touches {
            let text = format!("{what}: left out (changes the motion if touched)");
            shape.element.note(Effect::Changes, text);
        }
    }

    /// Geoms of one body, of a body and its parent, and of excluded bodies do not touch.
    fn may_touch(&self, one: &Shape<'d>, other: &Shape<'d>, fixed: &[usize]) -> bool {
        let bodies = [fixed[one.body], fixed[other.body]];
        let is_pair = |[a, b]: [usize; 2]| [a, b] == bodies || [b, a] == bodies;
        let names = [one.body, other.body].map(|body| self.model.bodies[body].name.as_str());
        let excluded = |pair: &[&str; 2]| pair.iter().all(|name| names.contains(name));
        let parent =
            |joint: &Joint| joint.in_tree && is_pair(joint.ends().map(|end| fixed[end.body]));
        bodies[0] != bodies[1]
            && !self.model.joints.iter().any(parent)
            && !self.excluded.iter().any(excluded)
    }
}
