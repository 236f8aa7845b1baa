//! MJCF, the format of MuJoCo.

mod constraints;
mod contacts;
mod defaults;
mod drives;
mod shapes;

use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{Along, Body, End, GROUND, Joint, Kind, Load, Model};
use crate::options::ImportOptions;
use crate::pose::{Matrix, Pose, add, scaled, unit};
use crate::settle::{Move, Read};
use crate::xml::{Element, Xml};
use contacts::Shape;
use defaults::{Angles, Defaults, Item};
use std::collections::HashMap;

/// Parts that no motion depends on.
const IDLE: &[&str] = &[
    "name",
    "visual",
    "statistic",
    "size",
    "asset",
    "sensor",
    "camera",
    "light",
    "custom",
    "keyframe",
    "rgba",
    "material",
    "group",
    "user",
    "texcoord",
    "condim",
    "priority",
    "friction",
    "solmix",
    "solref",
    "solimp",
    "margin",
    "gap",
    "contype",
    "conaffinity",
    "solreflimit",
    "solimplimit",
    "solreffriction",
    "solimpfriction",
    "hfield",
    "mesh",
    "fitscale",
    "timestep",
    "integrator",
    "iterations",
    "tolerance",
    "solver",
    "cone",
    "jacobian",
    "impratio",
    "meshdir",
    "texturedir",
    "assetdir",
    "strippath",
    "discardvisual",
    "fusestatic",
    "usethread",
    "noslip_iterations",
    "noslip_tolerance",
    "ls_iterations",
    "ls_tolerance",
    "ccd_iterations",
    "ccd_tolerance",
    "sdf_iterations",
    "sdf_initpoints",
    "mpr_iterations",
    "mpr_tolerance",
    "apirate",
    "magnetic",
    "torquescale",
    "width",
    "solreffix",
    "solimpfix",
    "actdim",
    "actlimited",
    "dyntype",
    "gaintype",
    "biastype",
    "dynprm",
    "gainprm",
    "biasprm",
    "exclude",
    "model",
    "nativeccd",
    "multiccd",
    "sleep",
    "balanceinertia",
    "alignfree",
    "saveinertial",
    "conflict",
    "texture",
    "dclass",
    "o_margin",
    "o_solref",
    "o_solimp",
    "o_friction",
    "resolution",
    "actuatorgravcomp",
    "warmstart",
    "filterparent",
    "refsafe",
    "midphase",
    "eulerdamp",
    "autoreset",
    "island",
    "energy",
    "fwdinv",
    "invdiscrete",
    "override",
];
/// Parts that act only at a limit.
const LIMITS: &[&str] = &[
    "ctrlrange",
    "ctrllimited",
    "forcerange",
    "forcelimited",
    "actrange",
    "range",
    "limited",
    "actuatorfrcrange",
    "actuatorfrclimited",
    "inheritrange",
    "lengthrange",
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

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FromShapes {
    Never,
    IfAbsent,
    Always,
}

struct Reader<'d, 'o> {
    model: Model,
    options: &'o ImportOptions,
    angles: Angles,
    limits_need_word: bool,
    from_shapes: FromShapes,
    total_mass: Option<f64>,
    defaults: Defaults<'d>,
    shapes: Vec<Shape<'d>>,
    /// The coordinates of a keyframe in their order: the joint, unless it is that of a floating body, and how many numbers.
    order: Vec<(Option<usize>, usize)>,
    sites: HashMap<&'d str, (usize, Pose)>,
    excluded: Vec<[&'d str; 2]>,
    /// Whether shapes touch each other at all.
    touches: bool,
    moves: Vec<(usize, Move)>,
    /// Bodies that float, with their elements.
    floating: Vec<(usize, Element<'d>)>,
}

/// What a body holds, each part with its frame in the body's and the class around it.
#[derive(Default)]
struct Contents<'d> {
    joints: Vec<(Item<'d>, Pose)>,
    free: Option<Element<'d>>,
    shapes: Vec<(Item<'d>, Pose)>,
    inertial: Option<(Item<'d>, Pose)>,
    sites: Vec<(Item<'d>, Pose)>,
    bodies: Vec<(Element<'d>, Pose, Option<&'d str>)>,
}

/// Reads a model; the first file is that of the root.
pub(crate) fn read(xml: &Xml<'_>, options: &ImportOptions) -> Result<Read, DoorError> {
    let root = xml.root(0);
    let title = root.attribute("model").unwrap_or("MuJoCo model");
    let mut reader = Reader {
        model: Model {
            terms: ["frictionloss", "range"],
            ..Model::new(title, &root.place(), xml.findings.clone())
        },
        options,
        angles: Angles {
            unit: 1f64.to_radians(),
            sequence: ['x', 'y', 'z'],
        },
        limits_need_word: false,
        from_shapes: FromShapes::IfAbsent,
        total_mass: None,
        defaults: Defaults::default(),
        shapes: Vec::new(),
        order: Vec::new(),
        sites: HashMap::new(),
        excluded: Vec::new(),
        touches: true,
        moves: Vec::new(),
        floating: Vec::new(),
    };
    let sections = root.children();
    let called = |tag: &'static str| sections.iter().filter(move |one| one.tag() == tag);
    for section in called("compiler") {
        reader.compiler(section)?;
    }
    for section in called("default") {
        reader.defaults.add(*section, None);
    }
    for section in called("option") {
        reader.option(section)?;
    }
    for section in called("worldbody") {
        let mut contents = Contents::default();
        reader.collect(*section, Pose::IDENTITY, None, &mut contents)?;
        reader.fill(GROUND, &contents)?;
        for (element, pose, class) in contents.bodies {
            reader.body(element, GROUND, pose, class)?;
        }
    }
    reader.scale_masses();
    for section in called("equality")
        .chain(called("tendon"))
        .chain(called("actuator"))
    {
        for child in section.children() {
            match section.tag() {
                "equality" => reader.constraint(child)?,
                "tendon" => reader.tendon(child)?,
                _ => reader.actuator(child)?,
            }
        }
    }
    for section in called("contact") {
        reader.contact(*section);
    }
    for section in called("keyframe") {
        reader.keyframe(*section)?;
    }
    reader.name_floating();
    reader.name_contacts();
    reader.defaults.read_known();
    let coverage = xml.name_the_rest(judge);
    Ok(Read {
        model: reader.model,
        moves: reader.moves,
        coverage,
    })
}

impl<'d> Reader<'d, '_> {
    fn compiler(&mut self, section: &Element<'d>) -> Result<(), DoorError> {
        if let Some(angle) = section.attribute("angle") {
            self.angles.unit = if angle == "radian" {
                1.0
            } else {
                1f64.to_radians()
            };
        }
        if let Some(sequence) = section.attribute("eulerseq") {
            let letters: Vec<char> = sequence.chars().collect();
            let known = letters.iter().all(|c| "xyzXYZ".contains(*c));
            let three = <[char; 3]>::try_from(letters).ok().filter(|_| known);
            self.angles.sequence = three
                .ok_or_else(|| section.error(format!("`{sequence}` is no sequence of axes"), ""))?;
        }
        self.limits_need_word = section.attribute("autolimits") == Some("false");
        match section.attribute("inertiafromgeom") {
            Some("true") => self.from_shapes = FromShapes::Always,
            Some("false") => self.from_shapes = FromShapes::Never,
            _ => {}
        }
        self.total_mass = section
            .number("settotalmass")?
            .filter(|mass| *mass > 0.0)
            .or(self.total_mass);
        for bound in ["boundmass", "boundinertia"] {
            if section.number(bound)?.is_some_and(|bound| bound > 0.0) {
                section.note(
                    Effect::Changes,
                    format!("compiler {bound}: left out (changes small masses)"),
                );
            }
        }
        Ok(())
    }

    fn option(&mut self, section: &Element<'d>) -> Result<(), DoorError> {
        if let Some(gravity) = section.vector("gravity")? {
            self.model.gravity = gravity;
        }
        let mut fluid = Vec::new();
        for name in ["density", "viscosity", "wind"] {
            let values = section
                .attribute(name)
                .map(|text| section.numbers(name, text))
                .transpose()?;
            if values.is_some_and(|values| values.iter().any(|x| *x != 0.0)) {
                fluid.push(name);
            }
        }
        if !fluid.is_empty() {
            let text = format!(
                "option {}: fluid forces: left out (changes the motion)",
                fluid.join(", ")
            );
            section.note(Effect::Changes, text);
        }
        for flag in section
            .children()
            .into_iter()
            .filter(|one| one.tag() == "flag")
        {
            if flag.read().attribute("gravity") == Some("disable") {
                self.model.gravity = [0.0; 3];
            }
            self.touches = self.touches && flag.attribute("contact") != Some("disable");
        }
        Ok(())
    }

    /// Collects the parts of a body or a frame.
    fn collect(
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
                    let _ = child.attribute("name");
                    self.collect(child, inner, class, contents)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn body(
        &mut self,
        element: Element<'d>,
        parent: usize,
        outer: Pose,
        class: Option<&'d str>,
    ) -> Result<(), DoorError> {
        let pose = outer.then(self.defaults.item(element, None)?.pose(self.angles)?);
        let world = self.model.bodies[parent].pose.then(pose);
        let class = element.attribute("childclass").or(class);
        let count = self.model.bodies.len();
        let name = element
            .attribute("name")
            .map_or(format!("body{count}"), str::to_owned);
        let mut contents = Contents::default();
        self.collect(element, Pose::IDENTITY, class, &mut contents)?;
        let free_joint = contents
            .joints
            .iter()
            .position(|(item, _)| item.is("type", "free"));
        if let Some(position) = free_joint {
            contents.free = Some(contents.joints.remove(position).0.element);
        }
        let mut first = parent;
        let joints = contents.joints.len();
        for (k, (item, frame)) in contents.joints.iter().enumerate() {
            // Between several joints of a body are bodies without mass.
            let between = if k + 1 < joints {
                format!("{name}_{}", k + 1)
            } else {
                name.clone()
            };
            let second = self.model.bodies.len();
            self.model
                .bodies
                .push(Body::new(&between, element.place(), world));
            self.joint(item, *frame, [first, second], &name)?;
            first = second;
        }
        let body = if joints > 0 {
            first
        } else {
            self.model.bodies.len()
        };
        if joints == 0 {
            self.model
                .bodies
                .push(Body::new(&name, element.place(), world));
        }
        if let Some(free) = contents.free {
            let _ = free.attribute("name");
            self.order.push((None, 7));
            self.floating.push((body, element));
            self.model.floating.push(body);
        } else if joints == 0 {
            let second = End {
                body,
                frame: Pose::IDENTITY,
            };
            let first = self.model.seen_from(parent, &second);
            self.push_joint(
                format!("{name}_fixed"),
                element,
                Kind::Fixed,
                [first, second],
            );
            let _ = element.attribute("mocap");
        }
        self.fill(body, &contents)?;
        self.gravity_compensation(element, body)?;
        for (child, pose, class) in contents.bodies {
            self.body(child, body, pose, class)?;
        }
        Ok(())
    }

    fn push_joint(
        &mut self,
        name: String,
        element: Element<'d>,
        kind: Kind,
        [first, second]: [End; 2],
    ) -> usize {
        self.model.joints.push(Joint {
            name,
            place: element.place(),
            kind,
            first,
            second,
            in_tree: true,
            drawn: 0.0,
            along: Along::default(),
        });
        self.model.joints.len() - 1
    }

    fn joint(
        &mut self,
        item: &Item<'d>,
        frame: Pose,
        [first, second]: [usize; 2],
        body: &str,
    ) -> Result<(), DoorError> {
        let element = item.element;
        let kind = match item.text("type").unwrap_or("hinge") {
            "hinge" => Kind::Hinge,
            "slide" => Kind::Slide,
            "ball" => Kind::Ball,
            other => return Err(element.error(format!("there is no joint of type `{other}`"), "")),
        };
        let axis = item.vector("axis")?.unwrap_or([0.0, 0.0, 1.0]);
        let axis = unit(axis).ok_or_else(|| element.error("the axis is zero", ""))?;
        let place = Pose {
            origin: item.vector("pos")?.unwrap_or_default(),
            turn: Matrix::z_along(axis),
        };
        let second = End {
            body: second,
            frame: frame.then(place),
        };
        let first = self.model.seen_from(first, &second);
        let name = element
            .attribute("name")
            .map_or(format!("{body}_joint"), str::to_owned);
        let joint = self.push_joint(name, element, kind, [first, second]);
        self.order
            .push((Some(joint), if kind == Kind::Ball { 4 } else { 1 }));
        self.along(item, joint)
    }

    /// What acts along a coordinate.
    fn along(&mut self, item: &Item<'d>, joint: usize) -> Result<(), DoorError> {
        let kind = self.model.joints[joint].kind;
        let unit = if kind == Kind::Slide {
            1.0
        } else {
            self.angles.unit
        };
        let value = |name| Ok::<f64, DoorError>(item.number(name)?.unwrap_or_default());
        let range = item
            .vector::<2>("range")?
            .map(|range| range.map(|x| x * unit));
        let limited = match item.text("limited") {
            Some("true") => true,
            Some("false") => false,
            _ => range.is_some() && !self.limits_need_word,
        };
        let along = Along {
            damping: value("damping")?,
            friction: value("frictionloss")?,
            stiffness: value("stiffness")?,
            spring_reference: value("springref")? * unit,
            armature: value("armature")?,
            limits: range.filter(|_| limited),
        };
        let reference = value("ref")? * unit;
        let of = &mut self.model.joints[joint];
        let label = format!("joint {}", of.name);
        if item.text("actuatorfrcrange").is_some() {
            let text = format!("{label} actuatorfrcrange: left out (limit of a drive)");
            item.element.note(Effect::AtLimits, text);
        }
        if item.text("springdamper").is_some() {
            item.element.note(
                Effect::Changes,
                format!("{label} springdamper: left out (changes the motion)"),
            );
        }
        if kind != Kind::Ball {
            (of.along, of.drawn) = (along, reference);
            return Ok(());
        }
        if along.limits.is_some() {
            item.element.note(
                Effect::AtLimits,
                format!("{label} range: left out (acts only at a limit)"),
            );
        }
        if [
            along.damping,
            along.friction,
            along.stiffness,
            along.armature,
        ]
        .iter()
        .any(|x| *x != 0.0)
        {
            let text = format!(
                "{label} damping, frictionloss, stiffness or armature of a ball: left out (changes the motion)"
            );
            item.element.note(Effect::Changes, text);
        }
        Ok(())
    }

    /// Masses, points and shapes of a body.
    fn fill(&mut self, body: usize, contents: &Contents<'d>) -> Result<(), DoorError> {
        for (item, frame) in &contents.sites {
            if let Some(name) = item.element.attribute("name") {
                let pose = frame.then(item.pose(self.angles)?);
                self.sites.insert(name, (body, pose));
                self.model.frames.push((name.to_owned(), body, pose));
                self.model.bodies[body]
                    .points
                    .push((name.to_owned(), pose.origin));
            }
            for size in ["size", "type", "fromto"] {
                let _ = item.text(size);
            }
        }
        let inertial = contents
            .inertial
            .as_ref()
            .filter(|_| self.from_shapes != FromShapes::Always);
        if let Some((ignored, _)) = contents.inertial.as_ref().filter(|_| inertial.is_none()) {
            ignored.element.leave(
                Effect::Nothing,
                "inertial: not used, for `inertiafromgeom` is true",
            );
        }
        if let Some((item, frame)) = inertial {
            self.inertial(item, *frame, body)?;
        }
        for (item, frame) in &contents.shapes {
            let mass = shapes::mass(item, self.angles)?;
            self.shapes.push(Shape::new(item, body)?);
            let Some(mass) =
                mass.filter(|_| inertial.is_none() && self.from_shapes != FromShapes::Never)
            else {
                continue;
            };
            let inertia = mass.inertia.turned(frame.turn);
            self.model.bodies[body].add_mass(mass.mass, frame.point(mass.center), inertia);
        }
        Ok(())
    }

    fn inertial(&mut self, item: &Item<'d>, frame: Pose, body: usize) -> Result<(), DoorError> {
        let element = item.element;
        let pose = frame.then(item.pose(self.angles)?);
        let mass = item.number("mass")?.filter(|mass| *mass >= 0.0);
        let mass =
            mass.ok_or_else(|| element.error("an inertial needs a mass of 0 or more", ""))?;
        let inertia = match (item.vector("fullinertia")?, item.vector("diaginertia")?) {
            (Some(full), _) => Matrix::symmetric(full),
            (None, Some(diagonal)) => Matrix::diagonal(diagonal),
            (None, None) => Matrix::ZERO,
        };
        self.model.bodies[body].add_mass(mass, pose.origin, inertia.turned(pose.turn));
        Ok(())
    }

    /// A constant force against the weight.
    fn gravity_compensation(&mut self, element: Element<'d>, body: usize) -> Result<(), DoorError> {
        let share = element.number("gravcomp")?.unwrap_or_default();
        if share != 0.0 && !self.model.floating.contains(&body) {
            let of = &self.model.bodies[body];
            element.note(
                Effect::Kept,
                format!("body {} gravcomp {share}: kept as a force", of.name),
            );
            self.model.loads.push(Load::Force {
                name: format!("gravcomp_{}", of.name),
                place: element.place(),
                at: (body, of.center),
                force: scaled(self.model.gravity, -share * of.mass),
                turns: false,
            });
        }
        Ok(())
    }

    fn scale_masses(&mut self) {
        let total = self.model.bodies.iter().map(|body| body.mass).sum::<f64>();
        let Some(factor) = self
            .total_mass
            .map(|wanted| wanted / total)
            .filter(|x| x.is_finite())
        else {
            return;
        };
        for body in &mut self.model.bodies {
            body.mass *= factor;
            body.inertia = body.inertia.scaled(factor);
        }
    }

    fn keyframe(&mut self, section: Element<'d>) -> Result<(), DoorError> {
        let Some(wanted) = &self.options.key else {
            return Ok(());
        };
        let keys: Vec<_> = section
            .children()
            .into_iter()
            .filter(|key| key.tag() == "key")
            .collect();
        let name_of = |key: &Element<'d>| key.attribute("name").unwrap_or_default();
        let Some(key) = keys.iter().find(|key| name_of(key) == wanted) else {
            let known: Vec<_> = keys.iter().map(name_of).collect();
            return Err(DoorError::Unknown {
                what: "keyframe",
                name: wanted.clone(),
                known: known.join(", "),
            });
        };
        let Some(text) = key.attribute("qpos") else {
            return Ok(());
        };
        let numbers = key.numbers("qpos", text)?;
        let mut rest = &numbers[..];
        for (joint, count) in &self.order {
            let Some((values, after)) = rest.split_at_checked(*count) else {
                return Err(key.error("the keyframe has too few coordinates", ""));
            };
            rest = after;
            match (joint, values) {
                (Some(joint), [value]) => self.moves.push((*joint, Move::To(*value))),
                (Some(joint), [w, x, y, z]) => {
                    let turn = Matrix::quaternion([*w, *x, *y, *z]);
                    self.moves
                        .extend(turn.map(|turn| (*joint, Move::Turn(turn))));
                }
                _ => key.note(
                    Effect::Kept,
                    "key: the pose of a floating body is not taken from it",
                ),
            }
        }
        Ok(())
    }

    /// Bodies that float and that nothing refers to are left out.
    fn name_floating(&mut self) {
        for (body, element) in std::mem::take(&mut self.floating) {
            let of_joint = |joint: &Joint| joint.first.body == body || joint.second.body == body;
            let of_load = |load: &Load| load.bodies().contains(&body);
            let held = self.options.fix.as_deref() == Some(&self.model.bodies[body].name);
            if held
                || self.model.joints.iter().any(of_joint)
                || self.model.loads.iter().any(of_load)
            {
                continue;
            }
            let name = &self.model.bodies[body].name;
            element.note(
                Effect::Changes,
                format!("body {name}, free, joined to nothing: left out"),
            );
            let mut forces: Vec<&str> = element
                .attribute("gravcomp")
                .map(|_| "gravcomp")
                .into_iter()
                .collect();
            let of_body = self.shapes.iter().filter(|shape| shape.body == body);
            forces.extend(of_body.filter_map(|shape| shape.fluid.map(|_| "fluidshape")));
            if !forces.is_empty() {
                let text = format!(
                    "body {name} {}: left out (gravcomp 1 cancels the weight)",
                    forces.join(", ")
                );
                element.note(Effect::Changes, text);
            }
            self.model.floating.retain(|one| *one != body);
            self.model.left_out.push(body);
            self.shapes.retain(|shape| shape.body != body);
        }
    }

    fn body_named(
        &self,
        element: &Element<'d>,
        attribute: &str,
    ) -> Result<Option<usize>, DoorError> {
        let Some(name) = element.attribute(attribute) else {
            return Ok(None);
        };
        if name == "world" {
            return Ok(Some(GROUND));
        }
        let body = self
            .model
            .bodies
            .iter()
            .skip(1)
            .position(|body| body.name == name);
        body.map(|k| Some(k + 1))
            .ok_or_else(|| element.error(format!("there is no body `{name}`"), ""))
    }

    fn joint_named(&self, element: &Element<'d>, name: &str) -> Result<usize, DoorError> {
        let joint = self.model.joint_named(name);
        joint.ok_or_else(|| element.error(format!("there is no joint `{name}`"), ""))
    }

    fn site(&self, element: &Element<'d>, name: &str) -> Result<(usize, Pose), DoorError> {
        let site = self.sites.get(name).copied();
        site.ok_or_else(|| element.error(format!("there is no site `{name}`"), ""))
    }

    fn world_point(&self, (body, point): (usize, [f64; 3])) -> [f64; 3] {
        let pose = self.model.bodies[body].pose;
        add(pose.origin, pose.turn.apply(point))
    }
}
