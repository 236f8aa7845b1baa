//! URDF, the format of ROS, with the elements by which several programs close loops.

mod loops;

use crate::error::DoorError;
use crate::model::{Along, Coupling, End, Joint, Kind, Model};
use crate::options::ImportOptions;
use crate::pose::{Matrix, Pose, Vector};
use crate::settle::Read;
use crate::xml::{Element, NO_GRAVITY, Rules, Xml};
use std::collections::HashMap;

const RULES: Rules = Rules {
    idle: "visual material name version safety_controller calibration sensor role state_name drake capsule mechanicalReduction \
        hardwareInterface type rpy ros2_control color mu1 mu2 kp kd minDepth maxVel selfCollide static",
    limits: "limit effort velocity collision acceleration jerk",
};

pub(crate) fn read(xml: &Xml<'_>, options: &ImportOptions) -> Result<Read, DoorError> {
    let root = xml.root(0);
    let title = root.attribute("name").unwrap_or("URDF model");
    root.kept(NO_GRAVITY);
    let mut reader = Reader {
        model: Model::new(title, &root.place(), xml.findings.clone()),
        links: HashMap::new(),
    };
    root.called("link")
        .into_iter()
        .try_for_each(|link| reader.link(link))?;
    let joints = root.called("joint");
    reader.joints(&joints)?;
    joints
        .into_iter()
        .try_for_each(|joint| reader.mimic(joint))?;
    for part in root.children() {
        match part.tag() {
            "transmission" => reader.transmission(part),
            "gazebo" => reader.gazebo(part)?,
            "loop_joint" | "loop" | "loop_constraint" => reader.loop_element(part)?,
            _ => {}
        }
    }
    if let Some(text) = &options.loops {
        reader.extended(text)?;
    }
    Ok(Read {
        coverage: xml.name_the_rest(&RULES),
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
    let turn = Matrix::roll_pitch_yaw(element.vector("rpy")?.unwrap_or_default());
    Ok(Pose::new(element.vector("xyz")?.unwrap_or_default(), turn))
}

/// The name of an element.
fn name<'d>(element: &Element<'d>) -> Result<&'d str, DoorError> {
    let name = element.attribute("name");
    name.ok_or_else(|| element.error(format!("a {} needs a name", element.tag())))
}

impl<'d> Reader<'d> {
    fn link(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let name = name(&element)?;
        let number = self.model.push_body(name, element.place(), Pose::IDENTITY);
        if let Some(inertial) = element.child("inertial") {
            let pose = origin(inertial.child("origin"))?;
            let mass = inertial
                .child("mass")
                .map_or(Ok(-1.0), |mass| mass.value("value", -1.0))?;
            let mut tensor = [0.0; 6];
            if let Some(inertia) = inertial.child("inertia") {
                for (k, name) in ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]
                    .iter()
                    .enumerate()
                {
                    tensor[k] = inertia.value(name, 0.0)?;
                }
            }
            let inertia = Matrix::symmetric(tensor).turned(pose.turn);
            self.model.bodies[number].add_mass(inertial.mass(mass)?, pose.origin, inertia);
        }
        if self.links.insert(name, number).is_some() {
            return Err(element.error(format!("the link `{name}` is given twice")));
        }
        self.model.push_frame(name, number, Pose::IDENTITY);
        Ok(())
    }

    fn body(&self, element: &Element<'d>, name: Option<&'d str>) -> Result<usize, DoorError> {
        let name = name.unwrap_or_default();
        element.known(self.links.get(name).copied(), "link", name)
    }

    fn joints(&mut self, elements: &[Element<'d>]) -> Result<(), DoorError> {
        let mut hangs = vec![false; self.model.bodies.len()];
        for element in elements {
            let joint = self.joint(*element)?;
            if std::mem::replace(&mut hangs[joint.second.body], true) {
                let message = format!("the link of joint `{}` has another parent", joint.name);
                let help = "loops are closed by elements of their own, such as `loop_joint`";
                return Err(element.error_with(message, help));
            }
            self.model
                .push_frame(&joint.name, joint.second.body, Pose::IDENTITY);
            self.model.joints.push(joint);
        }
        // From the links without parent, which are ground, outwards; each joint once.
        let mut known: Vec<bool> = hangs.iter().map(|hangs| !hangs).collect();
        let mut rest: Vec<usize> = (0..self.model.joints.len()).collect();
        while !rest.is_empty() {
            let first = |joint: usize| self.model.joints[joint].first.body;
            let (ready, later): (Vec<usize>, _) =
                rest.iter().partition(|joint| known[first(**joint)]);
            if ready.is_empty() {
                return Err(elements[rest[0]].error("the joints form a circle without a root"));
            }
            for joint in ready {
                let Joint { first, second, .. } = &self.model.joints[joint];
                let (body, place) = (second.body, self.model.drawn(first));
                self.model.bodies[body].pose = place.then(second.frame.inverse());
                known[body] = true;
            }
            rest = later;
        }
        for body in (1..hangs.len()).filter(|body| !hangs[*body]) {
            let (place, name) = (
                self.model.bodies[body].place.clone(),
                &self.model.bodies[body].name,
            );
            let text = format!("link {name}, the root: is the ground");
            self.model.note(&place, crate::finding::Effect::Kept, text);
            self.model.hold(body);
        }
        Ok(())
    }

    fn joint(&mut self, element: Element<'d>) -> Result<Joint, DoorError> {
        let link = |tag| {
            self.body(
                &element,
                element.child(tag).and_then(|one| one.attribute("link")),
            )
        };
        let (parent, child) = (link("parent")?, link("child")?);
        let frame = Pose::along([0.0; 3], axis(element)?);
        let first = End::new(parent, origin(element.child("origin"))?.then(frame));
        let ends = [first, End::new(child, frame)];
        let mut joint = Joint::new(name(&element)?, element.place(), kind(&element)?, ends);
        joint.in_tree = true;
        joint.along = along(element)?;
        let independent = element.attribute("independent").unwrap_or_default();
        if independent.eq_ignore_ascii_case("true") {
            self.model.drive(self.model.joints.len());
        }
        Ok(joint)
    }

    fn joint_named(&self, element: &Element<'d>, name: Option<&str>) -> Result<usize, DoorError> {
        let name = name.unwrap_or_default();
        element.known(self.model.joint_named(name), "joint", name)
    }

    fn mimic(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let Some(mimic) = element.child("mimic") else {
            return Ok(());
        };
        let dependent = self.joint_named(&element, element.attribute("name"))?;
        self.model.couplings.push(Coupling {
            name: format!("{}_mimic", self.model.joints[dependent].name),
            place: mimic.place(),
            dependent,
            independent: self.joint_named(&mimic, mimic.attribute("joint"))?,
            references: [0.0; 2],
            polynomial: vec![mimic.value("offset", 0.0)?, mimic.value("multiplier", 1.0)?],
        });
        Ok(())
    }

    fn transmission(&mut self, element: Element<'d>) {
        let _ = element.attribute("type");
        for part in element.children() {
            let name = part.attribute("name").filter(|_| part.tag() == "joint");
            if let Some(joint) = name.and_then(|name| self.model.joint_named(name)) {
                part.kept(format!(
                    "transmission: drives {}",
                    self.model.joints[joint].name
                ));
                self.model.drive(joint);
            }
        }
    }
}

/// The axis of a joint, or of a loop.
fn axis(element: Element<'_>) -> Result<Vector, DoorError> {
    let Some(axis) = element.child("axis") else {
        return Ok([1.0, 0.0, 0.0]);
    };
    // In a Gazebo joint the axis is the text of a child.
    let vector = axis.child_vector("xyz")?.or(axis.vector("xyz")?);
    let vector = vector.unwrap_or([1.0, 0.0, 0.0]);
    // Fixed joints and balls often have an axis of zeros.
    match kind(&element)? {
        Kind::Fixed | Kind::Ball if vector == [0.0; 3] => Ok([1.0, 0.0, 0.0]),
        _ => axis.unit(vector),
    }
}

/// The kind of a joint, by the names of all dialects.
fn kind(element: &Element<'_>) -> Result<Kind, DoorError> {
    let name = element.attribute("type").unwrap_or("revolute");
    match name.to_ascii_lowercase().as_str() {
        "revolute" | "continuous" => Ok(Kind::Hinge),
        "prismatic" => Ok(Kind::Slide),
        "fixed" | "6d" | "weld" => Ok(Kind::Fixed),
        "spherical" | "ball" | "3d" | "position" => Ok(Kind::Ball),
        _ => {
            let help = "known are revolute, continuous, prismatic, fixed, spherical and ball";
            Err(element.error_with(format!("a joint of type `{name}` is not read"), help))
        }
    }
}

fn along(element: Element<'_>) -> Result<Along, DoorError> {
    let mut along = Along::default();
    for dynamics in ["dynamics", "joint_properties"]
        .iter()
        .filter_map(|tag| element.child(tag))
    {
        along.damping = dynamics.value("damping", along.damping)?;
        along.friction = dynamics.value("friction", along.friction)?;
    }
    if let Some(limit) = element.child("limit") {
        let given = limit
            .names()
            .iter()
            .any(|name| ["lower", "upper"].contains(name));
        let limits = [limit.value("lower", 0.0)?, limit.value("upper", 0.0)?];
        let limited = given && element.attribute("type") != Some("continuous");
        along.limits = limited.then_some(limits);
    }
    Ok(along)
}
