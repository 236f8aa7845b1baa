//! SDF, the format of Gazebo.

mod joints;

use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{Body, End, GROUND, Load, Model};
use crate::pose::{Matrix, Pose, scaled};
use crate::settle::{Read, span};
use crate::xml::{Element, Xml};
use std::collections::HashMap;

/// Parts that no motion depends on.
const IDLE: &[&str] = &[
    "visual",
    "sensor",
    "light",
    "self_collide",
    "physics",
    "scene",
    "gui",
    "material",
    "audio",
    "allow_auto_disable",
    "must_be_base_link",
    "name",
    "version",
    "canonical_link",
    "spherical_coordinates",
    "atmosphere",
    "magnetic_field",
    "wind",
    "enable_wind",
    "camera",
    "default",
    "author",
    "description",
    "license",
    "max_step_size",
    "real_time_factor",
    "real_time_update_rate",
    "audio_source",
    "projector",
    "particle_emitter",
    "battery",
    "xmlns",
    "sdf",
    "provide_feedback",
    "sensors",
    "type",
];
/// Parts that act only at a limit, or where bodies touch.
const LIMITS: &[&str] = &[
    "collision",
    "effort",
    "velocity",
    "stiffness",
    "dissipation",
    "limit",
];

fn judge(element: &Element<'_>, attribute: Option<&str>) -> Effect {
    let name = attribute.unwrap_or(element.tag());
    if IDLE.contains(&name) {
        Effect::Nothing
    } else if LIMITS.contains(&name) {
        Effect::AtLimits
    } else {
        Effect::Changes
    }
}

pub(crate) fn read(xml: &Xml<'_>) -> Result<Read, DoorError> {
    let root = xml.root(0);
    let _ = root.attribute("version");
    let mut parts = root.children();
    let mut gravity = [0.0, 0.0, -9.8];
    if let Some(world) = parts.iter().copied().find(|one| one.tag() == "world") {
        parts = world.children();
        if let Some(text) = world.child_text("gravity") {
            gravity = world.exactly("gravity", text)?;
        }
    }
    let models: Vec<_> = parts
        .into_iter()
        .filter(|one| one.tag() == "model")
        .collect();
    let is_still = |model: &&Element<'_>| {
        model
            .child_text("static")
            .is_some_and(|word| word == "true" || word == "1")
    };
    let moving = models.iter().find(|model| !is_still(model));
    let element = *moving.ok_or_else(|| root.error("the file has no model that moves", ""))?;
    for other in models
        .iter()
        .filter(|one| !std::ptr::eq(*one, moving.unwrap_or(one)))
    {
        let effect = if is_still(&other) {
            Effect::AtLimits
        } else {
            Effect::Changes
        };
        other.leave(
            effect,
            format!("{}: left out, one model is imported", other.label()),
        );
    }
    let title = element.attribute("name").unwrap_or("SDF model");
    let mut reader = Reader {
        model: Model {
            gravity,
            ..Model::new(title, &root.place(), xml.findings.clone())
        },
        frames: HashMap::new(),
        names: Vec::new(),
        links: HashMap::new(),
        model_pose: Pose::IDENTITY,
    };
    reader.model(element)?;
    span(&mut reader.model);
    Ok(Read {
        coverage: xml.name_the_rest(judge),
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
    let (origin, turn) = if pose.attribute("rotation_format") == Some("quat_xyzw") {
        let [x, y, z, qx, qy, qz, qw] = pose.exactly("pose", text)?;
        let turn = Matrix::quaternion([qw, qx, qy, qz]);
        (
            [x, y, z],
            turn.ok_or_else(|| pose.error("the quaternion is zero", ""))?,
        )
    } else if text.is_empty() {
        ([0.0; 3], Matrix::IDENTITY)
    } else {
        let [x, y, z, roll, pitch, yaw] = pose.exactly("pose", text)?;
        (
            [x, y, z],
            Matrix::roll_pitch_yaw([roll, pitch, yaw].map(|angle| angle * unit)),
        )
    };
    Ok((Pose { origin, turn }, relative_to))
}

impl<'d> Reader<'d> {
    fn model(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let parts = element.children();
        for part in &parts {
            if !["link", "frame", "joint"].contains(&part.tag()) {
                continue;
            }
            let name = part
                .attribute("name")
                .ok_or_else(|| part.error(format!("a {} needs a name", part.tag()), ""))?;
            let (pose, relative_to) = pose(*part)?;
            let attached_to = match part.tag() {
                "frame" => part
                    .attribute("attached_to")
                    .filter(|to| !to.is_empty())
                    .unwrap_or(MODEL),
                "joint" => part.child_text("child").unwrap_or(MODEL),
                _ => name,
            };
            let from = if part.tag() == "link" {
                MODEL
            } else {
                attached_to
            };
            let frame = Frame {
                element: *part,
                pose,
                relative_to: relative_to.unwrap_or(from),
                attached_to,
            };
            if self.frames.insert(name, frame).is_some() {
                return Err(part.error(format!("the name `{name}` is given twice"), ""));
            }
            self.names.push(name);
            if part.tag() == "link" {
                self.links.insert(name, self.model.bodies.len());
                self.model
                    .bodies
                    .push(Body::new(name, part.place(), Pose::IDENTITY));
            }
        }
        let (own, _) = pose(element)?;
        self.model_pose = own;
        if let Some(name) = element.attribute("placement_frame") {
            let of_frame = self.in_model(name, &element, 0)?;
            self.model_pose = own.then(of_frame.inverse());
        }
        for name in self.names.clone() {
            let frame = self.frames[name];
            let world = self
                .model_pose
                .then(self.in_model(name, &frame.element, 0)?);
            let body = self.body_of(name, &frame.element)?;
            if frame.element.tag() == "link" {
                self.model.bodies[body].pose = world;
                self.inertial(frame.element, body)?;
            }
        }
        for name in self.names.clone() {
            let frame = self.frames[name];
            let world = self
                .model_pose
                .then(self.in_model(name, &frame.element, 0)?);
            let body = self.body_of(name, &frame.element)?;
            let local = self.model.bodies[body].pose.inverse().then(world);
            self.model.frames.push((name.to_owned(), body, local));
            if frame.element.tag() == "joint" {
                self.joint(name, frame.element, world)?;
            }
        }
        self.mimics()
    }

    /// Where a frame is in that of the model.
    fn in_model(&self, name: &str, at: &Element<'d>, depth: usize) -> Result<Pose, DoorError> {
        if name == MODEL {
            return Ok(Pose::IDENTITY);
        }
        if name == WORLD {
            return Ok(self.model_pose.inverse());
        }
        let frame = self.frame(name, at, depth)?;
        let outer = self.in_model(frame.relative_to, at, depth + 1)?;
        Ok(outer.then(frame.pose))
    }

    fn frame(&self, name: &str, at: &Element<'d>, depth: usize) -> Result<Frame<'d>, DoorError> {
        if depth > self.names.len().min(300) {
            return Err(at.error(format!("the frame `{name}` refers to itself"), ""));
        }
        let frame = self.frames.get(name).copied();
        frame.ok_or_else(|| at.error(format!("there is no frame `{name}`"), ""))
    }

    /// The link that a frame moves with.
    fn body_of(&self, name: &str, at: &Element<'d>) -> Result<usize, DoorError> {
        let mut name = name;
        for depth in 0.. {
            if let Some(body) = self.links.get(name) {
                return Ok(*body);
            }
            match name {
                WORLD => return Ok(GROUND),
                MODEL if self.model.bodies.len() > 1 => return Ok(1),
                _ => name = self.frame(name, at, depth)?.attached_to,
            }
        }
        Ok(GROUND)
    }

    fn inertial(&mut self, link: Element<'d>, body: usize) -> Result<(), DoorError> {
        let mut tensor = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        let (mut mass, mut frame) = (1.0, Pose::IDENTITY);
        match link.child("inertial") {
            None => link.note(
                Effect::Kept,
                format!(
                    "{}: no inertial, 1 kg and 1 kg m2 as in Gazebo",
                    link.label()
                ),
            ),
            Some(inertial) => {
                frame = pose(inertial)?.0;
                mass = inertial.child_number("mass")?.unwrap_or(1.0);
                if let Some(inertia) = inertial.child("inertia") {
                    for (entry, name) in tensor
                        .iter_mut()
                        .zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"])
                    {
                        *entry = inertia.child_number(name)?.unwrap_or(*entry);
                    }
                }
                if mass < 0.0 {
                    return Err(inertial.error("the mass has to be 0 or more", ""));
                }
            }
        }
        let inertia = Matrix::symmetric(tensor).turned(frame.turn);
        self.model.bodies[body].add_mass(mass, frame.origin, inertia);
        let weightless = link
            .child_text("gravity")
            .is_some_and(|word| word == "false" || word == "0");
        let held = link
            .child_text("kinematic")
            .is_some_and(|word| word == "true" || word == "1");
        if held {
            link.note(
                Effect::Changes,
                format!("{} kinematic: left out (changes the motion)", link.label()),
            );
        }
        if weightless && mass > 0.0 {
            link.note(
                Effect::Kept,
                format!(
                    "{} without gravity: kept as a force against its weight",
                    link.label()
                ),
            );
            self.model.loads.push(Load::Force {
                name: format!("no_weight_{}", self.model.bodies[body].name),
                place: link.place(),
                at: (body, frame.origin),
                force: scaled(self.model.gravity, -mass),
                turns: false,
            });
        }
        Ok(())
    }

    /// An end of a joint on a body, from its place in the world.
    fn end(&self, body: usize, world: Pose) -> End {
        let frame = self.model.bodies[body].pose.inverse().then(world);
        End { body, frame }
    }
}
