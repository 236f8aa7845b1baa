//! URDF, the format of ROS, with the elements by which several programs close loops.

mod loops;

use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{Along, Body, Coupling, End, GROUND, Joint, Kind, Model};
use crate::options::ImportOptions;
use crate::pose::{Matrix, Pose, Vector, unit};
use crate::settle::Read;
use crate::xml::{Element, Xml};
use std::collections::HashMap;

/// Parts that no motion depends on.
const IDLE: &[&str] = &[
    "visual",
    "material",
    "name",
    "version",
    "safety_controller",
    "calibration",
    "gazebo",
    "sensor",
    "role",
    "state_name",
    "xacro",
    "drake",
    "capsule",
    "mechanicalReduction",
    "hardwareInterface",
    "type",
    "rpy",
    "ros2_control",
    "group_state",
    "color",
];
/// Parts that act only at a limit, or where bodies touch.
const LIMITS: &[&str] = &[
    "limit",
    "effort",
    "velocity",
    "collision",
    "acceleration",
    "jerk",
    "drake_acceleration",
];

fn judge(element: &Element<'_>, attribute: Option<&str>) -> Effect {
    let name = attribute.unwrap_or(element.tag());
    let in_gazebo = element
        .parent()
        .is_some_and(|parent| parent.tag() == "gazebo");
    if attribute.is_none() && in_gazebo {
        // Plugins, springs, contact laws: what they do is not known.
        return if [
            "material",
            "sensor",
            "mu1",
            "mu2",
            "kp",
            "kd",
            "minDepth",
            "maxVel",
            "selfCollide",
            "static",
        ]
        .contains(&name)
        {
            Effect::Nothing
        } else {
            Effect::Changes
        };
    }
    if IDLE.contains(&name) {
        Effect::Nothing
    } else if LIMITS.contains(&name) {
        Effect::AtLimits
    } else {
        Effect::Changes
    }
}

pub(crate) fn read(xml: &Xml<'_>, options: &ImportOptions) -> Result<Read, DoorError> {
    let root = xml.root(0);
    let title = root.attribute("name").unwrap_or("URDF model");
    let mut reader = Reader {
        model: Model::new(title, &root.place(), xml.findings.clone()),
        links: HashMap::new(),
    };
    let parts = root.children();
    let called = |tag: &'static str| parts.iter().filter(move |one| one.tag() == tag);
    for link in called("link") {
        reader.link(*link)?;
    }
    reader.joints(&called("joint").copied().collect::<Vec<_>>())?;
    for joint in called("joint") {
        reader.mimic(*joint)?;
    }
    for transmission in called("transmission") {
        reader.transmission(*transmission);
    }
    for part in &parts {
        match part.tag() {
            "gazebo" => reader.gazebo(*part)?,
            "loop_joint" => reader.loop_joint(*part)?,
            "loop" | "loop_constraint" => reader.constraint(*part)?,
            _ => {}
        }
    }
    if let Some(text) = &options.loops {
        reader.extended(text)?;
    }
    Ok(Read {
        coverage: xml.name_the_rest(judge),
        model: reader.model,
        moves: Vec::new(),
    })
}

struct Reader<'d> {
    model: Model,
    links: HashMap<&'d str, usize>,
}

/// The pose of an `origin`.
fn origin(element: Option<Element<'_>>) -> Result<Pose, DoorError> {
    let Some(element) = element else {
        return Ok(Pose::IDENTITY);
    };
    Ok(Pose {
        origin: element.vector("xyz")?.unwrap_or_default(),
        turn: Matrix::roll_pitch_yaw(element.vector("rpy")?.unwrap_or_default()),
    })
}

impl<'d> Reader<'d> {
    fn link(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let name = element
            .attribute("name")
            .ok_or_else(|| element.error("a link needs a name", ""))?;
        let mut body = Body::new(name, element.place(), Pose::IDENTITY);
        if let Some(inertial) = element.child("inertial") {
            let pose = origin(inertial.child("origin"))?;
            let mass = inertial
                .child("mass")
                .map(|mass| mass.number("value"))
                .transpose()?
                .flatten();
            let mass = mass.filter(|mass| *mass >= 0.0);
            let mass =
                mass.ok_or_else(|| inertial.error("an inertial needs a mass of 0 or more", ""))?;
            let mut tensor = [0.0; 6];
            if let Some(inertia) = inertial.child("inertia") {
                for (entry, name) in tensor
                    .iter_mut()
                    .zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"])
                {
                    *entry = inertia.number(name)?.unwrap_or_default();
                }
            }
            body.add_mass(
                mass,
                pose.origin,
                Matrix::symmetric(tensor).turned(pose.turn),
            );
        }
        let number = self.model.bodies.len();
        if self.links.insert(name, number).is_some() {
            return Err(element.error(format!("the link `{name}` is given twice"), ""));
        }
        self.model
            .frames
            .push((name.to_owned(), number, Pose::IDENTITY));
        self.model.bodies.push(body);
        Ok(())
    }

    fn body(&self, element: &Element<'d>, name: Option<&'d str>) -> Result<usize, DoorError> {
        let name = name.unwrap_or_default();
        let body = self.links.get(name).copied();
        body.ok_or_else(|| element.error(format!("there is no link `{name}`"), ""))
    }

    fn joints(&mut self, elements: &[Element<'d>]) -> Result<(), DoorError> {
        let mut has_parent = vec![false; self.model.bodies.len()];
        for element in elements {
            let joint = self.joint(*element)?;
            if std::mem::replace(&mut has_parent[joint.second.body], true) {
                let message = format!("the link of joint `{}` has another parent", joint.name);
                return Err(element.error(
                    message,
                    "a loop is closed by an element of its own, see `dwell help import`",
                ));
            }
            self.model
                .frames
                .push((joint.name.clone(), joint.second.body, Pose::IDENTITY));
            self.model.joints.push(joint);
        }
        // The links without parent are ground.
        for body in (1..has_parent.len()).filter(|body| !has_parent[*body]) {
            let (place, name) = (
                self.model.bodies[body].place.clone(),
                self.model.bodies[body].name.clone(),
            );
            self.model.findings.add(
                &place,
                Effect::Kept,
                format!("link {name}, the root: is the ground"),
            );
            self.fixed_to_ground(body);
        }
        // From the root outwards, each joint once.
        let mut known: Vec<bool> = has_parent.iter().map(|has| !has).collect();
        let mut rest: Vec<usize> = (0..self.model.joints.len()).collect();
        while !rest.is_empty() {
            let (ready, later): (Vec<usize>, Vec<usize>) = rest
                .iter()
                .copied()
                .partition(|joint| known[self.model.joints[*joint].first.body]);
            if ready.is_empty() {
                return Err(elements[rest[0].min(elements.len() - 1)]
                    .error("the joints form a circle without a root", ""));
            }
            for joint in ready {
                let joint = &self.model.joints[joint];
                let (body, frame) = (joint.second.body, self.model.drawn(&joint.first));
                let back = joint.second.frame.inverse();
                self.model.bodies[body].pose = frame.then(back);
                known[body] = true;
            }
            rest = later;
        }
        Ok(())
    }

    fn fixed_to_ground(&mut self, body: usize) {
        let end = |body| End {
            body,
            frame: Pose::IDENTITY,
        };
        self.model.joints.push(Joint {
            name: format!("{}_ground", self.model.bodies[body].name),
            place: self.model.bodies[body].place.clone(),
            kind: Kind::Fixed,
            first: end(GROUND),
            second: end(body),
            in_tree: true,
            drawn: 0.0,
            along: Along::default(),
        });
    }

    fn joint(&mut self, element: Element<'d>) -> Result<Joint, DoorError> {
        let name = element
            .attribute("name")
            .ok_or_else(|| element.error("a joint needs a name", ""))?;
        let link = |tag| {
            self.body(
                &element,
                element.child(tag).and_then(|one| one.attribute("link")),
            )
        };
        let (parent, child) = (link("parent")?, link("child")?);
        let kind = kind(&element)?;
        let axis = axis(element)?;
        let frame = Pose {
            turn: Matrix::z_along(axis),
            ..Pose::IDENTITY
        };
        let along = along(element)?;
        if element
            .attribute("independent")
            .is_some_and(|word| word.eq_ignore_ascii_case("true"))
        {
            // Joints come before the ground's: their numbers stay.
            self.model.drive(self.model.joints.len());
        }
        Ok(Joint {
            name: name.to_owned(),
            place: element.place(),
            kind,
            first: End {
                body: parent,
                frame: origin(element.child("origin"))?.then(frame),
            },
            second: End { body: child, frame },
            in_tree: true,
            drawn: 0.0,
            along,
        })
    }

    fn mimic(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let Some(mimic) = element.child("mimic") else {
            return Ok(());
        };
        let find = |name: Option<&str>| {
            let name = name.unwrap_or_default();
            let joint = self.model.joint_named(name);
            joint.ok_or_else(|| mimic.error(format!("there is no joint `{name}`"), ""))
        };
        let dependent = find(element.attribute("name"))?;
        let independent = find(mimic.attribute("joint"))?;
        let multiplier = mimic.number("multiplier")?.unwrap_or(1.0);
        self.model.couplings.push(Coupling {
            name: format!("{}_mimic", self.model.joints[dependent].name),
            place: mimic.place(),
            dependent,
            independent,
            references: [0.0; 2],
            polynomial: vec![mimic.number("offset")?.unwrap_or_default(), multiplier],
        });
        Ok(())
    }

    fn transmission(&mut self, element: Element<'d>) {
        let _ = element.attribute("type");
        for part in element.children() {
            let joint = part.attribute("name").filter(|_| part.tag() == "joint");
            if let Some(joint) = joint.and_then(|name| self.model.joint_named(name)) {
                part.note(
                    Effect::Kept,
                    format!("transmission: drives {}", self.model.joints[joint].name),
                );
                self.model.drive(joint);
            }
            // Gear ratios and interfaces of controllers do not change what the joint needs.
            part.children().into_iter().for_each(|inner| {
                let _ = inner.text();
            });
        }
    }
}

/// The axis of a joint, or of a loop.
fn axis(element: Element<'_>) -> Result<Vector, DoorError> {
    let Some(axis) = element.child("axis") else {
        return Ok([1.0, 0.0, 0.0]);
    };
    // In a Gazebo joint the axis is the text of a child.
    let vector = match axis.child_text("xyz") {
        Some(text) => axis.exactly("xyz", text)?,
        None => axis.vector("xyz")?.unwrap_or([1.0, 0.0, 0.0]),
    };
    unit(vector).ok_or_else(|| axis.error("the axis is zero", ""))
}

/// The kind of a joint, by the names of all dialects.
fn kind(element: &Element<'_>) -> Result<Kind, DoorError> {
    let name = element.attribute("type").unwrap_or("revolute");
    let help = "known are revolute, continuous, prismatic, fixed, spherical, ball and universal";
    match name.to_ascii_lowercase().as_str() {
        "revolute" | "continuous" => Ok(Kind::Hinge),
        "prismatic" => Ok(Kind::Slide),
        "fixed" | "6d" | "weld" => Ok(Kind::Fixed),
        "spherical" | "ball" | "3d" | "position" => Ok(Kind::Ball),
        "floating" => Err(element.error(
            "a floating joint: nothing holds the link",
            "make it `fixed` to hold it",
        )),
        _ => Err(element.error(format!("a joint of type `{name}` is not read"), help)),
    }
}

fn along(element: Element<'_>) -> Result<Along, DoorError> {
    let mut along = Along::default();
    if let Some(dynamics) = element.child("dynamics") {
        along.damping = dynamics.number("damping")?.unwrap_or_default();
        along.friction = dynamics.number("friction")?.unwrap_or_default();
    }
    if let Some(limit) = element.child("limit") {
        let [lower, upper] = [limit.number("lower")?, limit.number("upper")?];
        along.limits = (lower.is_some() || upper.is_some())
            .then(|| [lower.unwrap_or_default(), upper.unwrap_or_default()]);
    }
    if element.attribute("type") == Some("continuous") {
        along.limits = None;
    }
    Ok(along)
}
