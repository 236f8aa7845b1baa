//! Equality constraints, tendons and actuators.

use super::Reader;
use crate::error::Result;
use crate::finding::{AT_LIMITS, Effect, LOST};
use crate::model::{Action, Coupling, End, GROUND, Joint, Kind, Load, both};
use crate::pose::{Matrix, Pose, length, sub};
use crate::xml::Element;

impl<'d> Reader<'d> {
    pub(super) fn constraint(&mut self, element: Element<'d>) -> Result<()> {
        self.classed(element, None)?;
        let name = self.model.loop_name(element.attribute("name"));
        if element.is("active", "false") {
            let text = format!("equality {name}: not active, left out");
            element.leave(Effect::Kept, text);
            return Ok(());
        }
        let (kind, ends) = match element.tag() {
            "joint" => return self.joint_equality(element, name),
            "connect" => (Kind::Ball, self.connect(element, &name)?),
            "weld" => (Kind::Fixed, self.weld(element)?),
            tag => {
                element.leave(Effect::Changes, format!("equality {name}, {tag}: {LOST}"));
                return Ok(());
            }
        };
        if ends[0].body == ends[1].body {
            return Err(element.error("the constraint connects a body with itself"));
        }
        let joint = Joint::new(name, element.place(), kind, ends);
        self.model.joints.push(joint);
        Ok(())
    }

    fn site_named(&self, element: Element<'d>, name: &str) -> Result<End> {
        let site = self.model.frames.iter().find(|(one, _)| one == name);
        element.known(site.map(|(_, end)| *end), "site", name)
    }

    /// The two ends at sites, if they are given by sites.
    fn ends_at_sites(&self, element: Element<'d>) -> Result<Option<[End; 2]>> {
        let sites = element.attribute("site1").zip(element.attribute("site2"));
        let site = |name| self.site_named(element, name);
        let ends = sites.map(|(one, other)| Ok([site(one)?, site(other)?]));
        ends.transpose()
    }

    /// The two bodies; without a name it is the world.
    fn bodies_named(&self, element: Element<'d>) -> Result<[usize; 2]> {
        let body = |attribute| {
            let name = element.attribute(attribute).unwrap_or("world");
            let mut bodies = self.model.bodies.iter().skip(1);
            let body = bodies.position(|body| body.name == name).map(|k| k + 1);
            let ground = (name == "world").then_some(GROUND);
            element.known(ground.or(body), "body", name)
        };
        Ok([body("body1")?, body("body2")?])
    }

    fn connect(&self, element: Element<'d>, name: &str) -> Result<[End; 2]> {
        if let Some(ends) = self.ends_at_sites(element)? {
            return Ok(ends);
        }
        let anchor = element.vector("anchor")?;
        let without = || element.error("a connect needs an anchor, or two sites");
        let anchor = anchor.ok_or_else(without)?;
        let bodies = self.bodies_named(element)?;
        let [first, second] = bodies.map(|body| &self.model.bodies[body]);
        // The point on the second body is where the anchor is in the reference pose, whatever was meant.
        let frame = first.pose.then(Pose::new(anchor, Matrix::IDENTITY));
        let [x, y, z] = second.pose.inverse().point(frame.origin);
        let at = format!("({x:.6}, {y:.6}, {z:.6})");
        let mut text = format!("derived: `{name}` on {} at {at}", second.name);
        let mut joints = self.model.joints.iter();
        if let Some(joint) = joints.find(|joint| joint.ends[1].body == bodies[1]) {
            let radius = length(sub(frame.origin, joint.origin()));
            text += &format!(", {radius:.6} m from `{}`", joint.name);
        }
        element.kept(text);
        Ok(both(bodies, frame))
    }

    fn weld(&self, element: Element<'d>) -> Result<[End; 2]> {
        if let Some(ends) = self.ends_at_sites(element)? {
            return Ok(ends);
        }
        let bodies = self.bodies_named(element)?;
        let [first, second] = bodies.map(|body| self.model.bodies[body].pose);
        let anchor = element.vector("anchor")?.unwrap_or_default();
        let anchor = Pose::new(anchor, Matrix::IDENTITY);
        // Without a quaternion the bodies are welded as they are in the reference pose.
        let relative = element.vector("relpose")?;
        let relative = relative.and_then(|[x, y, z, a, b, c, d]: [f64; 7]| {
            let turn = Matrix::quaternion([a, b, c, d])?;
            Some(first.then(Pose::new([x, y, z], turn)))
        });
        let frames = [relative.unwrap_or(second), second].map(|frame| frame.then(anchor));
        Ok([0, 1].map(|k| End::new(bodies[k], frames[k])))
    }

    fn joint_equality(&mut self, element: Element<'d>, name: String) -> Result<()> {
        let one = element.attribute("joint1").unwrap_or_default();
        let dependent = self.joint_named(element, one)?;
        let polynomial = element.numbers("polycoef")?.filter(|all| !all.is_empty());
        let polynomial = polynomial.unwrap_or_else(|| vec![0.0, 1.0]);
        let Some(other) = element.attribute("joint2") else {
            if polynomial.first().is_none_or(|offset| *offset == 0.0) {
                self.model.joints[dependent].kind = Kind::Fixed;
                element.kept(format!("equality {name}: joint {one} is fixed"));
            } else {
                element.lost(format!("equality {name}"));
            }
            return Ok(());
        };
        let independent = self.joint_named(element, other)?;
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

    fn joint_named(&self, element: Element<'d>, name: &str) -> Result<usize> {
        element.known(self.model.joint_named(name), "joint", name)
    }

    /// A straight tendon between two sites is a spring.
    pub(super) fn tendon(&mut self, element: Element<'d>) -> Result<()> {
        self.classed(element, None)?;
        let name = element.attribute("name").unwrap_or("tendon").to_owned();
        let parts = element.children();
        let sites = parts.iter().filter_map(|part| part.attribute("site"));
        let sites: Vec<&str> = sites.collect();
        let ([one, other], "spatial", 2) = (&sites[..], element.tag(), parts.len()) else {
            let text = format!("tendon {name}, {}: {LOST}", element.tag());
            element.leave(Effect::Changes, text);
            return Ok(());
        };
        let ends = [
            self.site_named(element, one)?,
            self.site_named(element, other)?,
        ];
        let places = ends.map(|end| end.frame.origin);
        let limited = element.attribute("range").is_some() && !element.is("limited", "false");
        let (effect, range) = match limited {
            true => (Effect::AtLimits, format!(", its range {AT_LIMITS}")),
            false => (Effect::Kept, String::new()),
        };
        let between = format!("between {one} and {other} (straight, two sites)");
        let text = format!("tendon {name}: kept as a spring {between}{range}");
        element.note(effect, text);
        let length = length(sub(places[0], places[1]));
        self.model.loads.push(Load {
            name,
            at: ends.map(|end| (end.body, end.frame.origin)).to_vec(),
            action: Action::Spring {
                stiffness: element.value("stiffness", 0.0)?,
                damping: element.value("damping", 0.0)?,
                free_length: match element.value("springlength", -1.0)? {
                    given if given >= 0.0 => given,
                    _ => length,
                },
            },
        });
        Ok(())
    }

    /// An actuator of a joint drives it.
    pub(super) fn actuator(&mut self, element: Element<'d>) -> Result<()> {
        self.classed(element, None)?;
        let tag = element.tag();
        let name = element.attribute("joint");
        let joint = name.map(|name| self.joint_named(element, name));
        let joint = joint.transpose()?;
        let drives = ["motor", "position", "velocity", "general", "intvelocity"].contains(&tag);
        let joint = joint.filter(|joint| drives && self.model.joints[*joint].is_driveable());
        let Some((name, joint)) = name.zip(joint) else {
            let of = name.map_or(String::new(), |joint| format!(" of {joint}"));
            element.leave(Effect::Changes, format!("{tag} actuator{of}: {LOST}"));
            return Ok(());
        };
        let gear = element.numbers("gear")?;
        let gear = gear.and_then(|gear| gear.first().copied()).unwrap_or(1.0);
        let text = match tag {
            "motor" => {
                format!("motor of {name}: drives it, with {gear} N m or N for a control of 1")
            }
            "position" => "position actuator: servo: kept as a drive (kp, kv)".to_owned(),
            "velocity" => "velocity actuator: servo: kept as a drive (kv)".to_owned(),
            _ => format!("{tag} actuator of {name}: drives it; its own law is left out"),
        };
        let gains = match tag {
            "position" => Some([element.value("kp", 1.0)?, element.value("kv", 0.0)?]),
            "velocity" => Some([0.0, element.value("kv", 1.0)?]),
            _ => None,
        };
        element.kept(text);
        self.model.drive(joint).servo = gains.map(|gains| gains.map(|gain| gain * gear * gear));
        Ok(())
    }
}
