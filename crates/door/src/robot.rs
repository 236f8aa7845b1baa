//! URDF, the format of ROS, and SDF, the format of Gazebo: links at named frames, and joints between them.

mod joints;
mod loops;

use crate::error::Result;
use crate::finding::{AT_LIMITS, Effect, LOST};
use crate::model::{Body, End, GROUND, Model};
use crate::options::ImportOptions;
use crate::pose::{Matrix, Pose, scaled};
use crate::xml::{Coverage, Element, FALSE, Rules, TRUE, Xml};
use std::collections::HashMap;

const RULES: Rules = Rules {
    idle: "visual sensor light material gui scene audio audio_source camera projector particle_emitter battery physics self_collide selfCollide \
        static name version type xmlns author description license default canonical_link spherical_coordinates atmosphere magnetic_field wind \
        enable_wind allow_auto_disable must_be_base_link max_step_size real_time_factor real_time_update_rate provide_feedback \
        safety_controller calibration role state_name drake capsule mechanicalReduction hardwareInterface rpy ros2_control color mu1 mu2 kp kd \
        minDepth maxVel",
    limits: "collision limit effort velocity acceleration jerk stiffness dissipation",
};

const MODEL: &str = "__model__";
const WORLD: &str = "world";
const NO_GRAVITY: &str = "no gravity in the file: 9.81 m/s2 against z";

/// A named frame: where it is, from which frame, and to which frame or link it is attached.
struct Frame<'d> {
    pose: Pose,
    relative_to: &'d str,
    attached_to: &'d str,
    /// The body of a link.
    body: Option<usize>,
}

struct Reader<'d> {
    model: Model,
    frames: HashMap<&'d str, Frame<'d>>,
    /// Where the frame of the model is in the world.
    model_pose: Pose,
    is_sdf: bool,
}

/// Reads URDF.
pub(crate) fn urdf(xml: &Xml<'_>, options: &ImportOptions) -> Result<(Model, Coverage)> {
    let root = xml.root();
    root.kept(NO_GRAVITY);
    let model = Model::new(root.attribute("name").unwrap_or("URDF model"), root.place());
    let model = read(model, root, false, options)?;
    Ok((model, xml.name_the_rest(&RULES)))
}

/// Reads the first model of an SDF file that moves.
pub(crate) fn sdf(xml: &Xml<'_>, options: &ImportOptions) -> Result<(Model, Coverage)> {
    let root = xml.root();
    let _ = root.attribute("version");
    let world = root.child("world");
    let models = world.unwrap_or(root).called("model");
    let moves = |one: &Element<'_>| !one.says("static", TRUE);
    let (moving, still): (Vec<_>, Vec<_>) = models.into_iter().partition(moves);
    let Some((element, others)) = moving.split_first() else {
        return Err(root.error("the file has no model that moves"));
    };
    for other in others {
        let text = format!("{}: {LOST}; one model is imported", other.label());
        other.leave(Effect::Changes, text);
    }
    for other in still {
        let text = format!("{}, static: {AT_LIMITS}", other.label());
        other.leave(Effect::AtLimits, text);
    }
    let title = element.attribute("name").unwrap_or("SDF model");
    let mut model = Model::new(title, root.place());
    match world {
        Some(world) => model.gravity = world.vector("gravity")?.unwrap_or([0.0, 0.0, -9.8]),
        None => root.kept(NO_GRAVITY),
    }
    let model = read(model, *element, true, options)?;
    Ok((model, xml.name_the_rest(&RULES)))
}

/// Reads links, frames, joints, and what URDF has besides.
fn read<'d>(
    model: Model,
    element: Element<'d>,
    is_sdf: bool,
    options: &ImportOptions,
) -> Result<Model> {
    let mut reader = Reader {
        model,
        frames: HashMap::new(),
        model_pose: Pose::IDENTITY,
        is_sdf,
    };
    let parts = element.children();
    let of = |tag: &'static str| parts.iter().filter(move |part| part.tag() == tag);
    of("link").try_for_each(|link| reader.frame(*link))?;
    of("frame").try_for_each(|frame| reader.frame(*frame))?;
    for joint in of("joint") {
        match is_sdf {
            true => reader.frame(*joint)?,
            false => reader.hang(*joint)?,
        }
    }
    let (own, _) = pose(element)?;
    let placed = element.attribute("placement_frame");
    let placed = placed.map(|name| reader.in_world(name, &element));
    let placed = placed.transpose()?.unwrap_or(Pose::IDENTITY);
    reader.model_pose = own.then(placed.inverse());
    of("link").try_for_each(|link| reader.link(*link))?;
    for frame in of("frame") {
        let name = name(*frame)?;
        let end = End::new(reader.body_of(name, frame)?, reader.in_world(name, frame)?);
        reader.model.frames.push((name.to_owned(), end));
    }
    for joint in of("joint") {
        let name = name(*joint)?;
        let at = if is_sdf {
            name
        } else {
            joints::side(*joint, &["child"])
        };
        reader.joint(name, *joint, reader.in_world(at, joint)?)?;
        let number = reader.model.joints.len() - 1;
        reader.model.joints[number].in_tree = !is_sdf;
        let independent = joint.attribute("independent").unwrap_or_default();
        if independent.eq_ignore_ascii_case("true") {
            reader.model.drive(number);
        }
    }
    reader.hold_roots();
    of("joint").try_for_each(|joint| reader.mimic(*joint))?;
    of("transmission").for_each(|one| reader.transmission(*one));
    reader.loops(&parts, options.loops.as_deref())?;
    Ok(reader.model)
}

fn name<'d>(element: Element<'d>) -> Result<&'d str> {
    let name = element.attribute("name");
    name.ok_or_else(|| element.error(format!("a {} needs a name", element.tag())))
}

/// The pose of an element in its `origin` (URDF) or its `pose` (SDF), with the frame that it names.
fn pose<'d>(element: Element<'d>) -> Result<(Pose, Option<&'d str>)> {
    if let Some(origin) = element.child("origin") {
        return Ok((xyz_rpy(origin)?, None));
    }
    let Some(pose) = element.child("pose") else {
        return Ok((Pose::IDENTITY, None));
    };
    let relative_to = pose.attribute("relative_to").or(pose.attribute("frame"));
    let relative_to = relative_to.filter(|name| !name.is_empty());
    let unit = match pose.is("degrees", "true") {
        true => 1f64.to_radians(),
        false => 1.0,
    };
    let text = pose.text();
    let pose = if pose.is("rotation_format", "quat_xyzw") {
        let [x, y, z, qx, qy, qz, qw] = pose.exactly("pose", text)?;
        let turn = Matrix::quaternion([qw, qx, qy, qz]);
        let zero = || pose.error("the quaternion is zero");
        Pose::new([x, y, z], turn.ok_or_else(zero)?)
    } else if text.is_empty() {
        Pose::IDENTITY
    } else {
        let [x, y, z, angles @ ..] = pose.exactly::<6>("pose", text)?;
        let turn = Matrix::roll_pitch_yaw(scaled(angles, unit));
        Pose::new([x, y, z], turn)
    };
    Ok((pose, relative_to))
}

/// A pose in the attributes of URDF.
fn xyz_rpy(element: Element<'_>) -> Result<Pose> {
    let turn = Matrix::roll_pitch_yaw(element.vector("rpy")?.unwrap_or_default());
    Ok(Pose::new(element.vector("xyz")?.unwrap_or_default(), turn))
}

impl<'d> Reader<'d> {
    /// The frame of a link, a frame or a joint.
    fn frame(&mut self, element: Element<'d>) -> Result<()> {
        let (tag, name) = (element.tag(), name(element)?);
        let attached_to = match tag {
            "frame" => element.attribute("attached_to"),
            "joint" => element.given("child"),
            _ => None,
        };
        let attached_to = attached_to.filter(|to| !to.is_empty()).unwrap_or(MODEL);
        let (pose, relative_to) = pose(element)?;
        let link = (tag == "link").then(|| element.place());
        let frame = Frame {
            pose,
            relative_to: relative_to.unwrap_or(attached_to),
            attached_to,
            body: link.map(|place| self.model.push_body(name, place, Pose::IDENTITY)),
        };
        match self.frames.insert(name, frame) {
            Some(_) => Err(element.error(format!("the name `{name}` is given twice"))),
            None => Ok(()),
        }
    }

    /// Hangs the child of a URDF joint on the parent.
    fn hang(&mut self, joint: Element<'d>) -> Result<()> {
        let [parent, child] = ["parent", "child"].map(|tag| joints::side(joint, &[tag]));
        joint.known(self.frames.get(parent), "link", parent)?;
        let frame = joint.known(self.frames.get_mut(child), "link", child)?;
        if frame.relative_to != MODEL {
            let message = format!("the link of {} has another parent", joint.label());
            let help = "loops are closed by elements of their own, such as `loop_joint`";
            return Err(joint.error_with(message, help));
        }
        (frame.pose, frame.relative_to) = (pose(joint)?.0, parent);
        Ok(())
    }

    /// Links of URDF that hang on no joint are the ground.
    fn hold_roots(&mut self) {
        for body in 1..self.model.bodies.len() {
            let Body { name, place, .. } = &self.model.bodies[body];
            if !self.is_sdf && self.frames[name.as_str()].relative_to == MODEL {
                place.kept(format!("link {name}, the root: is the ground"));
                self.model.hold(body);
            }
        }
    }

    /// Where a frame is in the world.
    fn in_world(&self, name: &str, at: &Element<'d>) -> Result<Pose> {
        let (mut frame, mut pose) = (name, Pose::IDENTITY);
        for _ in 0..=self.frames.len() {
            match (self.frames.get(frame), frame) {
                (Some(one), _) => (frame, pose) = (one.relative_to, one.pose.then(pose)),
                (None, MODEL) => return Ok(self.model_pose.then(pose)),
                (None, WORLD) => return Ok(pose),
                (None, _) => return at.known(None, "frame", frame),
            }
        }
        Err(at.error(format!("the frame `{name}` refers to itself")))
    }

    /// The link that a frame moves with.
    fn body_of(&self, name: &str, at: &Element<'d>) -> Result<usize> {
        let mut frame = name;
        for _ in 0..=self.frames.len() {
            match (self.frames.get(frame), frame) {
                (
                    Some(Frame {
                        body: Some(body), ..
                    }),
                    _,
                ) => return Ok(*body),
                (Some(one), _) => frame = one.attached_to,
                (None, WORLD) => return Ok(GROUND),
                // The model is where its first link is.
                (None, MODEL) => return Ok(self.model.bodies.len().min(2) - 1),
                (None, _) => return at.known(None, "frame", frame),
            }
        }
        Err(at.error(format!("the frame `{name}` refers to itself")))
    }

    /// The pose and the mass of a link.
    fn link(&mut self, link: Element<'d>) -> Result<()> {
        let name = name(link)?;
        let (body, world) = (self.body_of(name, &link)?, self.in_world(name, &link)?);
        self.model.bodies[body].pose = world;
        let label = link.label();
        // Gazebo takes 1 kg and 1 kg m2 for what is not given.
        let (mut mass, mut tensor) = match self.is_sdf {
            true => (1.0, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]),
            false => (0.0, [0.0; 6]),
        };
        let mut frame = world;
        if let Some(inertial) = link.child("inertial") {
            frame = world.then(pose(inertial)?.0);
            mass = inertial.mass(inertial.value("mass", if self.is_sdf { 1.0 } else { -1.0 })?)?;
            if let Some(inertia) = inertial.child("inertia") {
                let names = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];
                for (element, name) in tensor.iter_mut().zip(names) {
                    *element = inertia.value(name, *element)?;
                }
            }
        } else if self.is_sdf {
            link.kept(format!(
                "{label}: no inertial, so 1 kg and 1 kg m2, as in Gazebo"
            ));
        }
        self.model.bodies[body].add_mass(mass, frame, Matrix::symmetric(tensor));
        if link.says("kinematic", TRUE) {
            link.lost(format!("{label} kinematic"));
        }
        if link.says("gravity", FALSE) {
            link.kept(format!(
                "{label} without gravity: kept as a force against its weight"
            ));
            self.model.lighten(body, 1.0);
        }
        Ok(())
    }
}
