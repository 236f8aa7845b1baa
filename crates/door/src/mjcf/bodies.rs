//! The tree of bodies.

use super::Reader;
use crate::error::Result;
use crate::finding::{AT_LIMITS, Effect};
use crate::model::{Along, End, Joint, Kind, both};
use crate::pose::{Matrix, Pose};
use crate::xml::Element;

/// A part of a body, with the frame in which its pose is, in the frame of the ground.
pub(super) struct Part<'d> {
    element: Element<'d>,
    frame: Pose,
    class: Option<&'d str>,
}

impl<'d> Reader<'d> {
    /// The parts of a body, those in frames among them.
    pub(super) fn parts(
        &self,
        of: Element<'d>,
        frame: Pose,
        class: Option<&'d str>,
    ) -> Result<Vec<Part<'d>>> {
        let mut parts = Vec::new();
        for element in of.children() {
            match element.tag() {
                "frame" => {
                    let inner = frame.then(self.pose(element)?);
                    let class = element.attribute("childclass").or(class);
                    parts.extend(self.parts(element, inner, class)?);
                }
                "joint" | "freejoint" | "geom" | "site" | "inertial" | "body" => {
                    self.classed(element, class)?;
                    parts.push(Part {
                        element,
                        frame,
                        class,
                    });
                }
                _ => {}
            }
        }
        Ok(parts)
    }

    fn body(&mut self, part: &Part<'d>, parent: usize) -> Result<()> {
        let element = part.element;
        let world = part.frame.then(self.pose(element)?);
        let class = element.attribute("childclass").or(part.class);
        let name = element.name_or(|| format!("body{}", self.model.bodies.len()));
        let parts = self.parts(element, world, class)?;
        let is_joint = |part: &&Part<'d>| part.element.tag().ends_with("joint");
        let (mut body, mut is_free, mut count) = (parent, false, 0);
        let joints = parts.iter().filter(is_joint).count();
        for part in parts.iter().filter(is_joint) {
            count += 1;
            // Between several joints of a body are bodies without mass.
            let name = match count < joints {
                true => format!("{name}_{count}"),
                false => name.clone(),
            };
            let first = body;
            body = self.model.push_body(&name, element.place(), world);
            is_free = part.element.tag() == "freejoint" || part.element.is("type", "free");
            if !is_free {
                self.joint(part, [first, body])?;
            }
        }
        if joints == 0 {
            body = self.model.push_body(&name, element.place(), world);
            let ends = both([parent, body], world);
            let joint = Joint::new(format!("{name}_fixed"), element.place(), Kind::Fixed, ends);
            self.model.push_tree_joint(joint);
            let _ = element.attribute("mocap");
        }
        if is_free {
            self.order.push((None, 7));
        }
        self.fill(body, &parts)?;
        self.external_forces(element, body, is_free, &parts)
    }

    fn joint(&mut self, part: &Part<'d>, bodies: [usize; 2]) -> Result<()> {
        let element = part.element;
        let word = element.attribute("type").unwrap_or("hinge");
        let kind = match word {
            "hinge" => Some(Kind::Hinge),
            "slide" => Some(Kind::Slide),
            "ball" => Some(Kind::Ball),
            _ => None,
        };
        let kind = element.known(kind, "type of joint", word)?;
        let axis = element.unit(element.vector("axis")?.unwrap_or([0.0, 0.0, 1.0]))?;
        let place = Pose::along(element.vector("pos")?.unwrap_or_default(), axis);
        let name = element.name_or(|| format!("{}_joint", self.model.bodies[bodies[1]].name));
        let ends = both(bodies, part.frame.then(place));
        let mut joint = Joint::new(name, element.place(), kind, ends);
        self.along(element, &mut joint)?;
        let number = self.model.push_tree_joint(joint);
        let count = if kind == Kind::Ball { 4 } else { 1 };
        self.order.push((Some(number), count));
        Ok(())
    }

    /// What acts along a coordinate, and the coordinate as drawn.
    fn along(&self, element: Element<'d>, joint: &mut Joint) -> Result<()> {
        let unit = match joint.kind {
            Kind::Slide => 1.0,
            _ => self.angle,
        };
        let limited = match element.attribute("limited") {
            Some("true") => true,
            Some("false") => false,
            _ => !self.limits_need_word,
        };
        let range = element.vector::<2>("range")?.filter(|_| limited);
        let along = Along {
            damping: element.value("damping", 0.0)?,
            friction: element.value("frictionloss", 0.0)?,
            stiffness: element.value("stiffness", 0.0)?,
            armature: element.value("armature", 0.0)?,
            ..Along::default()
        };
        let label = format!("joint {}", joint.name);
        let drawn = element.value("ref", 0.0)? * unit;
        let spring_reference = element.value("springref", 0.0)? * unit;
        if element.attribute("actuatorfrcrange").is_some() {
            let text = format!("{label} actuatorfrcrange: left out (limit of a drive)");
            element.note(Effect::AtLimits, text);
        }
        if joint.kind != Kind::Ball {
            joint.drawn = drawn;
            joint.along = Along {
                spring_reference,
                limits: range.map(|range| range.map(|x| x * unit)),
                ..along
            };
            return Ok(());
        }
        if range.is_some() {
            element.note(Effect::AtLimits, format!("{label} range: {AT_LIMITS}"));
        }
        if along != Along::default() {
            let what = "damping, friction, stiffness or armature of a ball";
            element.lost(format!("{label}: {what}"));
        }
        Ok(())
    }

    /// Masses, points, shapes and inner bodies of a body.
    pub(super) fn fill(&mut self, body: usize, parts: &[Part<'d>]) -> Result<()> {
        let mut inertials = parts.iter().filter(|part| part.element.tag() == "inertial");
        let takes = self.from_shapes.unwrap_or(inertials.next().is_none());
        if let Some(second) = inertials.next() {
            return Err(second.element.error("a body has one inertial"));
        }
        for Part { element, frame, .. } in parts {
            match element.tag() {
                "inertial" if self.from_shapes == Some(true) => {
                    let text = "inertial: not used, for `inertiafromgeom` is true";
                    element.leave(Effect::Nothing, text);
                }
                "inertial" => self.inertial(*element, *frame, body)?,
                "geom" => {
                    if let Some((mass, frame, tensor)) = self.mass_of(*element, *frame, takes)? {
                        self.model.bodies[body].add_mass(mass, frame, tensor);
                    }
                    self.shapes.push((*element, body));
                }
                "site" => self.site(*element, *frame, body)?,
                _ => {}
            }
        }
        for part in parts.iter().filter(|part| part.element.tag() == "body") {
            self.body(part, body)?;
        }
        Ok(())
    }

    fn site(&mut self, element: Element<'d>, frame: Pose, body: usize) -> Result<()> {
        let frame = frame.then(self.pose(element)?);
        if let Some(name) = element.attribute("name") {
            let point = (name.to_owned(), frame.origin);
            self.model.bodies[body].points.push(point);
            let frame = (name.to_owned(), End::new(body, frame));
            self.model.frames.push(frame);
        }
        let _ = ["size", "type", "fromto"].map(|size| element.attribute(size));
        Ok(())
    }

    fn inertial(&mut self, of: Element<'d>, frame: Pose, body: usize) -> Result<()> {
        let frame = frame.then(self.pose(of)?);
        let mass = of.mass(of.value("mass", -1.0)?)?;
        let full = of.vector("fullinertia")?.map(Matrix::symmetric);
        let tensor = full.or(of.vector("diaginertia")?.map(Matrix::diagonal));
        self.model.bodies[body].add_mass(mass, frame, tensor.unwrap_or(Matrix::ZERO));
        Ok(())
    }

    /// Forces against the weight are kept, except those of bodies that float; forces of a fluid are not.
    fn external_forces(
        &mut self,
        element: Element<'d>,
        body: usize,
        is_free: bool,
        parts: &[Part<'d>],
    ) -> Result<()> {
        let share = element.value("gravcomp", 0.0)?;
        let label = format!("body {}", self.model.bodies[body].name);
        if !is_free {
            if share != 0.0 {
                element.kept(format!("{label} gravcomp {share}: kept as a force"));
                self.model.lighten(body, share);
            }
            return Ok(());
        }
        let geoms = parts.iter().map(|part| part.element);
        let fluid = geoms.filter_map(|one| one.attribute("fluidshape"));
        let forces = [
            ("gravcomp", share != 0.0),
            ("fluidshape", fluid.count() > 0),
        ];
        let acting = forces.iter().filter(|(_, acts)| *acts);
        let names: Vec<&str> = acting.map(|(name, _)| *name).collect();
        if !names.is_empty() {
            let what = format!("{label} {}", names.join(", "));
            let text = format!("{what}: left out (gravcomp 1 cancels the weight)");
            element.note(Effect::Changes, text);
        }
        Ok(())
    }
}
