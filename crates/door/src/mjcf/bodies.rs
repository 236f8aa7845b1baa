//! The tree of bodies.

use super::Reader;
use super::contacts::Shape;
use super::defaults::Item;
use super::shapes;
use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{Along, End, Joint, Kind, Load};
use crate::pose::{Matrix, Pose, scaled};
use crate::xml::{AT_LIMITS, Element};

/// What a body holds, each part with its frame in the body's and the class around it.
#[derive(Default)]
pub(super) struct Contents<'d> {
    joints: Vec<(Item<'d>, Pose)>,
    free: Option<Element<'d>>,
    shapes: Vec<(Item<'d>, Pose)>,
    inertial: Option<(Item<'d>, Pose)>,
    sites: Vec<(Item<'d>, Pose)>,
    pub(super) bodies: Vec<(Element<'d>, Pose, Option<&'d str>)>,
}

impl<'d> Reader<'d, '_> {
    /// Collects the parts of a body or a frame.
    pub(super) fn collect(
        &self,
        element: Element<'d>,
        frame: Pose,
        class: Option<&'d str>,
        contents: &mut Contents<'d>,
    ) -> Result<(), DoorError> {
        for child in element.children() {
            let item = |class| self.defaults.item(child.read(), class);
            match child.tag() {
                "joint" => contents.joints.push((item(class)?, frame)),
                "freejoint" => contents.free = Some(child.read()),
                "geom" => contents.shapes.push((item(class)?, frame)),
                "site" => contents.sites.push((item(class)?, frame)),
                "inertial" => contents.inertial = Some((item(class)?, frame)),
                "body" => contents.bodies.push((child.read(), frame, class)),
                "frame" => {
                    let inner = frame.then(item(None)?.pose(self.angles)?);
                    let class = child.attribute("childclass").or(class);
                    self.collect(child, inner, class, contents)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    pub(super) fn body(
        &mut self,
        element: Element<'d>,
        parent: usize,
        outer: Pose,
        class: Option<&'d str>,
    ) -> Result<(), DoorError> {
        let pose = outer.then(self.defaults.item(element, None)?.pose(self.angles)?);
        let world = self.model.bodies[parent].pose.then(pose);
        let class = element.attribute("childclass").or(class);
        let number = self.model.bodies.len();
        let name = element.name_or(|| format!("body{number}"));
        let mut contents = Contents::default();
        self.collect(element, Pose::IDENTITY, class, &mut contents)?;
        let is_free = |(item, _): &(Item<'d>, Pose)| item.is("type", "free");
        if let Some(position) = contents.joints.iter().position(is_free) {
            contents.free = Some(contents.joints.remove(position).0.element);
        }
        // Between several joints of a body are bodies without mass.
        let mut body = parent;
        let count = contents.joints.len();
        for k in 0..count.max(1) {
            let name = if k + 1 < count {
                format!("{name}_{}", k + 1)
            } else {
                name.clone()
            };
            let next = self.model.push_body(&name, element.place(), world);
            let first = std::mem::replace(&mut body, next);
            if let Some((item, frame)) = contents.joints.get(k) {
                self.joint(item, *frame, [first, body])?;
            }
        }
        if contents.free.is_some() {
            self.order.push((None, 7));
            self.floating.push((body, element));
        } else if count == 0 {
            let second = End::new(body, Pose::IDENTITY);
            let ends = [self.model.seen_from(parent, &second), second];
            self.push_joint(format!("{name}_fixed"), element, Kind::Fixed, ends);
            let _ = element.attribute("mocap");
        }
        self.fill(body, &contents)?;
        if contents.free.is_none() {
            self.gravity_compensation(element, body)?;
        }
        for (child, pose, class) in contents.bodies {
            self.body(child, body, pose, class)?;
        }
        Ok(())
    }

    /// A joint of the tree.
    pub(super) fn push_joint(
        &mut self,
        name: String,
        element: Element<'d>,
        kind: Kind,
        ends: [End; 2],
    ) {
        let mut joint = Joint::new(name, element.place(), kind, ends);
        joint.in_tree = true;
        self.model.joints.push(joint);
    }

    fn joint(
        &mut self,
        item: &Item<'d>,
        frame: Pose,
        [first, second]: [usize; 2],
    ) -> Result<(), DoorError> {
        let element = item.element;
        let word = item.text("type").unwrap_or("hinge");
        let kind = match word {
            "hinge" => Some(Kind::Hinge),
            "slide" => Some(Kind::Slide),
            "ball" => Some(Kind::Ball),
            _ => None,
        };
        let kind = element.known(kind, "type of joint", word)?;
        let axis = element.unit(item.vector("axis")?.unwrap_or([0.0, 0.0, 1.0]))?;
        let place = Pose::along(item.vector("pos")?.unwrap_or_default(), axis);
        let second = End::new(second, frame.then(place));
        let ends = [self.model.seen_from(first, &second), second];
        let body = &self.model.bodies[second.body].name;
        let name = element.name_or(|| format!("{body}_joint"));
        let count = if kind == Kind::Ball { 4 } else { 1 };
        self.order.push((Some(self.model.joints.len()), count));
        let (along, reference) = self.along(item, kind, &name)?;
        self.push_joint(name, element, kind, ends);
        if let Some(joint) = self.model.joints.last_mut().filter(|_| kind != Kind::Ball) {
            (joint.along, joint.drawn) = (along, reference);
        }
        Ok(())
    }

    /// What acts along a coordinate, and the coordinate as drawn.
    fn along(&self, item: &Item<'d>, kind: Kind, name: &str) -> Result<(Along, f64), DoorError> {
        let unit = if kind == Kind::Slide {
            1.0
        } else {
            self.angles.unit
        };
        let range = item
            .vector::<2>("range")?
            .map(|range| range.map(|x| x * unit));
        let limited = match item.text("limited") {
            Some("true") => true,
            Some("false") => false,
            _ => !self.limits_need_word,
        };
        let along = Along {
            damping: item.value("damping", 0.0)?,
            friction: item.value("frictionloss", 0.0)?,
            stiffness: item.value("stiffness", 0.0)?,
            spring_reference: item.value("springref", 0.0)? * unit,
            armature: item.value("armature", 0.0)?,
            limits: range.filter(|_| limited),
        };
        if item.text("actuatorfrcrange").is_some() {
            let text = format!("joint {name} actuatorfrcrange: left out (limit of a drive)");
            item.element.note(Effect::AtLimits, text);
        }
        if item.text("springdamper").is_some() {
            item.element.lost(format!("joint {name} springdamper"));
        }
        if kind == Kind::Ball && along.limits.is_some() {
            let text = format!("joint {name} range: {AT_LIMITS}");
            item.element.note(Effect::AtLimits, text);
        }
        let unlimited = Along {
            limits: None,
            ..along
        };
        let zero = Along {
            spring_reference: along.spring_reference,
            ..Along::default()
        };
        if kind == Kind::Ball && unlimited != zero {
            item.element.lost(format!(
                "joint {name}: damping, friction, stiffness or armature of a ball"
            ));
        }
        Ok((along, item.value("ref", 0.0)? * unit))
    }

    /// Masses, points and shapes of a body.
    pub(super) fn fill(&mut self, body: usize, contents: &Contents<'d>) -> Result<(), DoorError> {
        for (item, frame) in &contents.sites {
            let pose = frame.then(item.pose(self.angles)?);
            if let Some(name) = item.element.attribute("name") {
                self.sites.insert(name, (body, pose));
                self.model.push_frame(name, body, pose);
                self.model.bodies[body]
                    .points
                    .push((name.to_owned(), pose.origin));
            }
            let _ = ["size", "type", "fromto"].map(|size| item.text(size));
        }
        let always = self.from_shapes == Some(true);
        match &contents.inertial {
            Some((item, _)) if always => {
                let text = "inertial: not used, for `inertiafromgeom` is true";
                item.element.leave(Effect::Nothing, text);
            }
            Some((item, frame)) => self.inertial(item, *frame, body)?,
            None => {}
        }
        let takes = self.from_shapes.unwrap_or(contents.inertial.is_none());
        for (item, frame) in &contents.shapes {
            let mass = shapes::mass(item, self.angles, takes)?;
            self.shapes.push(Shape::new(item, body)?);
            if let Some((mass, center, inertia)) = mass.filter(|_| takes) {
                let inertia = inertia.turned(frame.turn);
                self.model.bodies[body].add_mass(mass, frame.point(center), inertia);
            }
        }
        Ok(())
    }

    fn inertial(&mut self, item: &Item<'d>, frame: Pose, body: usize) -> Result<(), DoorError> {
        let pose = frame.then(item.pose(self.angles)?);
        let mass = item.element.mass(item.value("mass", -1.0)?)?;
        let full = item.vector("fullinertia")?.map(Matrix::symmetric);
        let inertia = full.or(item.vector("diaginertia")?.map(Matrix::diagonal));
        let inertia = inertia.unwrap_or(Matrix::ZERO).turned(pose.turn);
        self.model.bodies[body].add_mass(mass, pose.origin, inertia);
        Ok(())
    }

    /// A constant force against the weight.
    fn gravity_compensation(&mut self, element: Element<'d>, body: usize) -> Result<(), DoorError> {
        let share = element.value("gravcomp", 0.0)?;
        if share != 0.0 {
            let of = &self.model.bodies[body];
            element.kept(format!(
                "body {} gravcomp {share}: kept as a force",
                of.name
            ));
            self.model.loads.push(Load::Force {
                name: format!("gravcomp_{}", of.name),
                at: (body, of.center),
                force: scaled(self.model.gravity, -share * of.mass),
                turns: false,
            });
        }
        Ok(())
    }
}
