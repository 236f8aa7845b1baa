//! Equality constraints and tendons.

use super::Reader;
use super::defaults::Item;
use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{Coupling, End, GROUND, Joint, Kind, Load};
use crate::pose::{Matrix, Pose, length, sub};
use crate::xml::{AT_LIMITS, Element, LOST};

impl<'d> Reader<'d, '_> {
    pub(super) fn constraint(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let item = self.defaults.item(element, None)?;
        let name = self.model.loop_name(element.attribute("name"));
        if item.is("active", "false") {
            element.leave(
                Effect::Kept,
                format!("equality {name}: not active, left out"),
            );
            return Ok(());
        }
        let (kind, ends) = match element.tag() {
            "joint" => return self.joint_equality(&item, name),
            "connect" => (Kind::Ball, self.connect(&item, &name)?),
            "weld" => (Kind::Fixed, self.weld(&item)?),
            tag => {
                element.leave(Effect::Changes, format!("equality {name}, {tag}: {LOST}"));
                return Ok(());
            }
        };
        if ends[0].body == ends[1].body {
            return Err(element.error("the constraint connects a body with itself"));
        }
        self.model
            .joints
            .push(Joint::new(name, element.place(), kind, ends));
        Ok(())
    }

    fn site(&self, element: &Element<'d>, name: &str) -> Result<End, DoorError> {
        let site = self
            .sites
            .get(name)
            .map(|(body, frame)| End::new(*body, *frame));
        element.known(site, "site", name)
    }

    /// The two ends at sites, if they are given by sites.
    fn ends_at_sites(&self, element: &Element<'d>) -> Result<Option<[End; 2]>, DoorError> {
        let sites = element.attribute("site1").zip(element.attribute("site2"));
        let ends = |(one, other)| Ok([self.site(element, one)?, self.site(element, other)?]);
        sites.map(ends).transpose()
    }

    fn body_named(&self, element: &Element<'d>, attribute: &str) -> Result<usize, DoorError> {
        let name = element.attribute(attribute).unwrap_or("world");
        let body = self
            .model
            .bodies
            .iter()
            .skip(1)
            .position(|body| body.name == name);
        let ground = (name == "world").then_some(GROUND);
        element.known(ground.or(body.map(|k| k + 1)), "body", name)
    }

    fn connect(&self, item: &Item<'d>, name: &str) -> Result<[End; 2], DoorError> {
        let element = item.element;
        if let Some(ends) = self.ends_at_sites(&element)? {
            return Ok(ends);
        }
        let anchor = item.vector("anchor")?;
        let anchor =
            anchor.ok_or_else(|| element.error("a connect needs an anchor, or two sites"))?;
        let first = End::new(self.body_named(&element, "body1")?, Pose::at(anchor));
        // The point on the second body is where the anchor is in the reference pose, whatever was meant.
        let second = self
            .model
            .seen_from(self.body_named(&element, "body2")?, &first);
        let [x, y, z] = second.frame.origin;
        let body = &self.model.bodies[second.body].name;
        let mut text = format!("derived: `{name}` on {body} at ({x:.6}, {y:.6}, {z:.6})");
        let mut joints = self.model.joints.iter();
        if let Some(joint) = joints.find(|joint| joint.second.body == second.body) {
            let radius = length(sub(second.frame.origin, joint.second.frame.origin));
            text += &format!(", {radius:.6} m from `{}`", joint.name);
        }
        element.kept(text);
        Ok([first, second])
    }

    fn weld(&self, item: &Item<'d>) -> Result<[End; 2], DoorError> {
        let element = item.element;
        if let Some(ends) = self.ends_at_sites(&element)? {
            return Ok(ends);
        }
        let bodies = [
            self.body_named(&element, "body1")?,
            self.body_named(&element, "body2")?,
        ];
        let anchor = item.vector("anchor")?.unwrap_or_default();
        let second = End::new(bodies[1], Pose::at(anchor));
        let relative = item
            .vector::<7>("relpose")?
            .and_then(|[x, y, z, quat @ ..]| {
                let pose = Pose::new([x, y, z], Matrix::quaternion(quat)?);
                Some(End::new(bodies[0], pose.then(second.frame)))
            });
        Ok([
            relative.unwrap_or_else(|| self.model.seen_from(bodies[0], &second)),
            second,
        ])
    }

    fn joint_equality(&mut self, item: &Item<'d>, name: String) -> Result<(), DoorError> {
        let element = item.element;
        let one = element.attribute("joint1").unwrap_or_default();
        let dependent = self.joint_named(&element, one)?;
        let polynomial = item.numbers("polycoef")?.unwrap_or_else(|| vec![0.0, 1.0]);
        let Some(other) = element.attribute("joint2") else {
            if polynomial.first().is_none_or(|offset| *offset == 0.0) {
                self.model.joints[dependent].kind = Kind::Fixed;
                element.kept(format!("equality {name}: joint {one} is fixed"));
            } else {
                element.lost(format!("equality {name}"));
            }
            return Ok(());
        };
        let independent = self.joint_named(&element, other)?;
        let references = [dependent, independent].map(|joint| self.model.joints[joint].drawn);
        self.model.couplings.push(Coupling {
            name,
            place: element.place(),
            dependent,
            independent,
            references,
            polynomial,
        });
        Ok(())
    }

    /// A straight tendon between two sites is a spring.
    pub(super) fn tendon(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let name = element.attribute("name").unwrap_or("tendon").to_owned();
        let item = self.defaults.item(element, None)?;
        let parts = element.children();
        let sites: Vec<_> = parts
            .iter()
            .filter_map(|part| part.attribute("site"))
            .collect();
        let ([one, other], "spatial", 2) = (&sites[..], element.tag(), parts.len()) else {
            element.leave(
                Effect::Changes,
                format!("tendon {name}, {}: {LOST}", element.tag()),
            );
            return Ok(());
        };
        let ends = [self.site(&element, one)?, self.site(&element, other)?];
        let places = ends.map(|end| self.model.drawn(&end).origin);
        let free_length = item.value("springlength", -1.0)?;
        let (stiffness, damping) = (item.value("stiffness", 0.0)?, item.value("damping", 0.0)?);
        for active in ["frictionloss", "armature"] {
            if item.value(active, 0.0)? != 0.0 {
                element.lost(format!("tendon {name} {active}"));
            }
        }
        let limited = item.text("range").is_some() && !item.is("limited", "false");
        let (effect, range) = match limited {
            true => (Effect::AtLimits, format!(", its range {AT_LIMITS}")),
            false => (Effect::Kept, String::new()),
        };
        let between = format!("between {one} and {other} (straight, two sites)");
        element.note(
            effect,
            format!("tendon {name}: kept as a spring {between}{range}"),
        );
        self.model.loads.push(Load::Spring {
            name,
            ends: ends.map(|end| (end.body, end.frame.origin)),
            stiffness,
            damping,
            free_length: if free_length < 0.0 {
                length(sub(places[0], places[1]))
            } else {
                free_length
            },
        });
        Ok(())
    }
}
