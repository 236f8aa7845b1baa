//! SDF, the format of Gazebo.

mod joints;

use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{GROUND, Load, Model};
use crate::pose::{Matrix, Pose, scaled};
use crate::settle::{Read, span};
use crate::xml::{AT_LIMITS, Element, LOST, NO_GRAVITY, Rules, Xml};
use std::collections::HashMap;

const RULES: Rules = Rules {
    idle: "visual sensor light self_collide physics scene gui material audio allow_auto_disable must_be_base_link name version \
        canonical_link spherical_coordinates atmosphere magnetic_field wind enable_wind camera default author description license \
        max_step_size real_time_factor real_time_update_rate audio_source projector particle_emitter battery xmlns provide_feedback type",
    limits: "collision effort velocity stiffness dissipation limit",
};

pub(crate) fn read(xml: &Xml<'_>) -> Result<Read, DoorError> {
    let root = xml.root(0);
    let _ = root.attribute("version");
    let mut top = root;
    let mut gravity = [0.0, 0.0, -9.81];
    if let Some(world) = root.child("world") {
        let _ = world.attribute("name");
        gravity = world.child_vector("gravity")?.unwrap_or([0.0, 0.0, -9.8]);
        top = world;
    } else {
        root.kept(NO_GRAVITY);
    }
    let (still, moving): (Vec<_>, Vec<_>) = top
        .called("model")
        .into_iter()
        .partition(|one| one.says("static"));
    let Some((element, others)) = moving.split_first() else {
        return Err(root.error("the file has no model that moves"));
    };
    for other in others {
        other.leave(
            Effect::Changes,
            format!("{}: {LOST}; one model is imported", other.label()),
        );
    }
    for other in still {
        other.leave(
            Effect::AtLimits,
            format!("{}, static: {AT_LIMITS}", other.label()),
        );
    }
    let title = element.attribute("name").unwrap_or("SDF model");
    let mut model = Model::new(title, &root.place(), xml.findings.clone());
    model.gravity = gravity;
    let mut reader = Reader {
        model,
        frames: HashMap::new(),
        names: Vec::new(),
        links: HashMap::new(),
        model_pose: Pose::IDENTITY,
    };
    reader.model(*element)?;
    span(&mut reader.model);
    Ok(Read {
        coverage: xml.name_the_rest(&RULES),
        model: reader.model,
        moves: Vec::new(),
    })
}

/// A named frame: where it is, from which frame, and to which frame or link it is attached.
#[derive(Clone, Copy)]
struct Frame<'d> {
    element: Element<'d>,
    pose: Pose,
    relative_to: &'d str,
    attached_to: &'d str,
}

const MODEL: &str = "__model__";
const WORLD: &str = "world";

struct Reader<'d> {
    model: Model,
    frames: HashMap<&'d str, Frame<'d>>,
    /// The names of the frames in their order.
    names: Vec<&'d str>,
    links: HashMap<&'d str, usize>,
    model_pose: Pose,
}

/// A pose with the frame that it names.
fn pose<'d>(element: Element<'d>) -> Result<(Pose, Option<&'d str>), DoorError> {
    let Some(pose) = element.child("pose") else {
        return Ok((Pose::IDENTITY, None));
    };
    let relative_to = pose
        .attribute("relative_to")
        .or_else(|| pose.attribute("frame"));
    let relative_to = relative_to.filter(|name| !name.is_empty());
    let unit = if pose.attribute("degrees") == Some("true") {
        1f64.to_radians()
    } else {
        1.0
    };
    let text = pose.text();
    let pose = if pose.attribute("rotation_format") == Some("quat_xyzw") {
        let [x, y, z, qx, qy, qz, qw] = pose.exactly("pose", text)?;
        let turn = Matrix::quaternion([qw, qx, qy, qz]);
        Pose::new(
            [x, y, z],
            turn.ok_or_else(|| pose.error("the quaternion is zero"))?,
        )
    } else if text.is_empty() {
        Pose::IDENTITY
    } else {
        let [x, y, z, angles @ ..] = pose.exactly::<6>("pose", text)?;
        Pose::new(
            [x, y, z],
            Matrix::roll_pitch_yaw(angles.map(|angle| angle * unit)),
        )
    };
    Ok((pose, relative_to))
}

impl<'d> Reader<'d> {
    fn model(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        for part in element.children() {
            if ["link", "frame", "joint"].contains(&part.tag()) {
                self.frame_of(part)?;
            }
        }
        let (own, _) = pose(element)?;
        self.model_pose = own;
        if let Some(name) = element.attribute("placement_frame") {
            self.model_pose = own.then(self.in_model(name, &element, 0)?.inverse());
        }
        for (name, body) in self.links.clone() {
            let link = self.frames[name].element;
            self.model.bodies[body].pose = self.in_world(name, &link)?;
            self.inertial(link, body)?;
        }
        for name in self.names.clone() {
            let element = self.frames[name].element;
            let world = self.in_world(name, &element)?;
            let end = self.model.end_at(self.body_of(name, &element)?, world);
            self.model.push_frame(name, end.body, end.frame);
            if element.tag() == "joint" {
                self.joint(name, element, world)?;
            }
        }
        self.mimics()
    }

    /// The frame of a link, a frame or a joint.
    fn frame_of(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let tag = element.tag();
        let name = element.attribute("name");
        let name = name.ok_or_else(|| element.error(format!("a {tag} needs a name")))?;
        let (pose, relative_to) = pose(element)?;
        let attached_to = match tag {
            "frame" => element.attribute("attached_to").filter(|to| !to.is_empty()),
            "joint" => element.child_text("child"),
            _ => None,
        };
        let attached_to = attached_to.unwrap_or(MODEL);
        let frame = Frame {
            element,
            pose,
            relative_to: relative_to.unwrap_or(attached_to),
            attached_to,
        };
        if self.frames.insert(name, frame).is_some() {
            return Err(element.error(format!("the name `{name}` is given twice")));
        }
        self.names.push(name);
        if tag == "link" {
            let body = self.model.push_body(name, element.place(), Pose::IDENTITY);
            self.links.insert(name, body);
        }
        Ok(())
    }

    fn in_world(&self, name: &str, at: &Element<'d>) -> Result<Pose, DoorError> {
        Ok(self.model_pose.then(self.in_model(name, at, 0)?))
    }

    /// Where a frame is in that of the model.
    fn in_model(&self, name: &str, at: &Element<'d>, depth: usize) -> Result<Pose, DoorError> {
        match name {
            MODEL => Ok(Pose::IDENTITY),
            WORLD => Ok(self.model_pose.inverse()),
            _ => {
                let frame = self.frame(name, at, depth)?;
                Ok(self
                    .in_model(frame.relative_to, at, depth + 1)?
                    .then(frame.pose))
            }
        }
    }

    fn frame(&self, name: &str, at: &Element<'d>, depth: usize) -> Result<Frame<'d>, DoorError> {
        if depth > self.names.len().min(300) {
            return Err(at.error(format!("the frame `{name}` refers to itself")));
        }
        at.known(self.frames.get(name).copied(), "frame", name)
    }

    /// The link that a frame moves with.
    fn body_of(&self, name: &str, at: &Element<'d>) -> Result<usize, DoorError> {
        let mut name = name;
        for depth in 0.. {
            match (name, self.links.get(name)) {
                (_, Some(body)) => return Ok(*body),
                (WORLD, None) => break,
                (MODEL, None) => return Ok(self.model.bodies.len().min(2) - 1),
                _ => name = self.frame(name, at, depth)?.attached_to,
            }
        }
        Ok(GROUND)
    }

    fn inertial(&mut self, link: Element<'d>, body: usize) -> Result<(), DoorError> {
        let mut tensor = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        let (mut mass, mut frame) = (1.0, Pose::IDENTITY);
        let label = link.label();
        if let Some(inertial) = link.child("inertial") {
            frame = pose(inertial)?.0;
            mass = inertial.mass(inertial.child_value("mass", 1.0)?)?;
            if let Some(inertia) = inertial.child("inertia") {
                for (k, name) in ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]
                    .iter()
                    .enumerate()
                {
                    tensor[k] = inertia.child_value(name, tensor[k])?;
                }
            }
        } else {
            link.kept(format!(
                "{label}: no inertial, so 1 kg and 1 kg m2, as in Gazebo"
            ));
        }
        let inertia = Matrix::symmetric(tensor).turned(frame.turn);
        self.model.bodies[body].add_mass(mass, frame.origin, inertia);
        if link.says("kinematic") {
            link.lost(format!("{label} kinematic"));
        }
        if link
            .child_text("gravity")
            .is_some_and(|word| word == "false" || word == "0")
        {
            link.kept(format!(
                "{label} without gravity: kept as a force against its weight"
            ));
            self.model.loads.push(Load::Force {
                name: format!("no_weight_{}", self.model.bodies[body].name),
                at: (body, frame.origin),
                force: scaled(self.model.gravity, -mass),
                turns: false,
            });
        }
        Ok(())
    }
}
