//! MJCF, the format of MuJoCo.

mod bodies;
mod constraints;
mod contacts;
mod defaults;
mod shapes;

use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{GROUND, Model};
use crate::options::ImportOptions;
use crate::pose::{Matrix, Pose};
use crate::settle::{Move, Read};
use crate::xml::{Element, Rules, Xml};
use bodies::Contents;
use contacts::Shape;
use defaults::{Angles, Defaults};
use std::collections::HashMap;

const RULES: Rules = Rules {
    idle: "name visual statistic size asset sensor camera light custom keyframe rgba material group user texcoord condim priority \
        friction solmix solref solimp margin gap contype conaffinity solreflimit solimplimit solreffriction solimpfriction hfield mesh \
        fitscale timestep integrator iterations tolerance solver cone jacobian impratio meshdir texturedir assetdir strippath \
        discardvisual fusestatic usethread noslip_iterations noslip_tolerance ls_iterations ls_tolerance ccd_iterations ccd_tolerance \
        sdf_iterations sdf_initpoints mpr_iterations mpr_tolerance apirate magnetic torquescale width solreffix solimpfix actdim \
        actlimited dyntype gaintype biastype dynprm gainprm biasprm exclude model nativeccd multiccd sleep balanceinertia alignfree \
        saveinertial conflict texture dclass o_margin o_solref o_solimp o_friction resolution actuatorgravcomp warmstart filterparent \
        refsafe midphase eulerdamp autoreset island energy fwdinv invdiscrete override",
    limits: "ctrlrange ctrllimited forcerange forcelimited actrange range limited actuatorfrcrange actuatorfrclimited inheritrange \
        lengthrange",
};

struct Reader<'d, 'o> {
    model: Model,
    options: &'o ImportOptions,
    angles: Angles,
    /// Whether a range limits only with the word `limited`.
    limits_need_word: bool,
    /// Whether geoms give the inertia: never, always, or where there is no other.
    from_shapes: Option<bool>,
    total_mass: f64,
    defaults: Defaults<'d>,
    shapes: Vec<Shape<'d>>,
    /// The coordinates of a keyframe in their order: the joint, unless its body floats, and how many.
    order: Vec<(Option<usize>, usize)>,
    sites: HashMap<&'d str, (usize, Pose)>,
    excluded: Vec<[&'d str; 2]>,
    /// Whether shapes touch each other at all.
    touches: bool,
    moves: Vec<(usize, Move)>,
    /// Bodies that float, with their elements.
    floating: Vec<(usize, Element<'d>)>,
}

/// Reads a model; the first file is that of the root.
pub(crate) fn read(xml: &Xml<'_>, options: &ImportOptions) -> Result<Read, DoorError> {
    let root = xml.root(0);
    let title = root.attribute("model").unwrap_or("MuJoCo model");
    let mut model = Model::new(title, &root.place(), xml.findings.clone());
    model.terms = ["frictionloss", "range"];
    let mut reader = Reader {
        model,
        options,
        angles: Angles::default(),
        limits_need_word: false,
        from_shapes: None,
        total_mass: 0.0,
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
    for tag in [
        "compiler",
        "default",
        "option",
        "worldbody",
        "equality",
        "tendon",
        "actuator",
        "contact",
        "keyframe",
    ] {
        for section in sections.iter().filter(|one| one.tag() == tag) {
            reader.section(*section)?;
        }
    }
    reader.name_floating();
    reader.name_contacts();
    reader.defaults.read_known();
    Ok(Read {
        coverage: xml.name_the_rest(&RULES),
        model: reader.model,
        moves: reader.moves,
    })
}

impl<'d> Reader<'d, '_> {
    fn section(&mut self, section: Element<'d>) -> Result<(), DoorError> {
        match section.tag() {
            "compiler" => return self.compiler(section),
            "default" => self.defaults.add(section, None),
            "option" => return self.option(section),
            "worldbody" => {
                let mut contents = Contents::default();
                self.collect(section, Pose::IDENTITY, None, &mut contents)?;
                self.fill(GROUND, &contents)?;
                for (element, pose, class) in contents.bodies {
                    self.body(element, GROUND, pose, class)?;
                }
                self.scale_masses();
            }
            "keyframe" => return self.keyframe(section),
            tag => {
                for child in section.children() {
                    match tag {
                        "equality" => self.constraint(child)?,
                        "tendon" => self.tendon(child)?,
                        "actuator" => self.actuator(child)?,
                        _ => self.contact(child),
                    }
                }
            }
        }
        Ok(())
    }

    fn compiler(&mut self, section: Element<'d>) -> Result<(), DoorError> {
        if section.attribute("angle") == Some("radian") {
            self.angles.unit = 1.0;
        }
        if let Some(sequence) = section.attribute("eulerseq") {
            let letters: Vec<char> = sequence.chars().filter(|c| "xyzXYZ".contains(*c)).collect();
            let three = letters.try_into().ok();
            self.angles.sequence = section.known(three, "sequence of axes", sequence)?;
        }
        self.limits_need_word = section.attribute("autolimits") == Some("false");
        let from_shapes = section.attribute("inertiafromgeom");
        self.from_shapes = from_shapes.and_then(|word| word.parse().ok());
        self.total_mass = section.value("settotalmass", self.total_mass)?;
        for bound in ["boundmass", "boundinertia"] {
            if section.value(bound, 0.0)? > 0.0 {
                section.lost(format!("compiler {bound}, which lifts small masses"));
            }
        }
        Ok(())
    }

    fn option(&mut self, section: Element<'d>) -> Result<(), DoorError> {
        let gravity = section.vector("gravity")?;
        self.model.gravity = gravity.unwrap_or(self.model.gravity);
        let mut fluid = Vec::new();
        for name in ["density", "viscosity", "wind"] {
            let text = section.attribute(name).unwrap_or_default();
            if section.numbers(name, text)?.iter().any(|x| *x != 0.0) {
                fluid.push(name);
            }
        }
        if !fluid.is_empty() {
            section.lost(format!("option {}: fluid forces", fluid.join(", ")));
        }
        for flag in section.called("flag") {
            if flag.attribute("gravity") == Some("disable") {
                self.model.gravity = [0.0; 3];
            }
            self.touches &= flag.attribute("contact") != Some("disable");
        }
        Ok(())
    }

    fn scale_masses(&mut self) {
        let total = self.model.bodies.iter().map(|body| body.mass).sum::<f64>();
        if self.total_mass > 0.0 && total > 0.0 {
            let factor = self.total_mass / total;
            for body in &mut self.model.bodies {
                body.mass *= factor;
                body.inertia = body.inertia.scaled(factor);
            }
        }
    }

    fn keyframe(&mut self, section: Element<'d>) -> Result<(), DoorError> {
        let Some(wanted) = &self.options.key else {
            return Ok(());
        };
        let keys = section.called("key");
        let name_of = |key: &Element<'d>| key.attribute("name").unwrap_or_default();
        let Some(key) = keys.iter().find(|key| name_of(key) == wanted) else {
            return Err(DoorError::unknown(
                "keyframe",
                wanted,
                keys.iter().map(name_of),
            ));
        };
        let numbers = key.numbers("qpos", key.attribute("qpos").unwrap_or_default())?;
        let mut rest = &numbers[..];
        for (joint, count) in &self.order {
            let Some((values, after)) = rest.split_at_checked(*count) else {
                return Err(key.error("the keyframe has too few coordinates"));
            };
            rest = after;
            match (joint, values) {
                (Some(joint), [value]) => self.moves.push((*joint, Move::To(*value))),
                (Some(joint), [w, x, y, z]) => {
                    let turn = Matrix::quaternion([*w, *x, *y, *z]);
                    self.moves
                        .extend(turn.map(|turn| (*joint, Move::Turn(turn))));
                }
                _ => key.kept("key: the pose of a floating body is not taken from it"),
            }
        }
        Ok(())
    }

    /// Bodies that float and that nothing refers to are left out.
    fn name_floating(&mut self) {
        for (body, element) in std::mem::take(&mut self.floating) {
            let name = self.model.bodies[body].name.clone();
            let used = self.model.joints.iter().any(|joint| joint.touches(body));
            let loaded = self
                .model
                .loads
                .iter()
                .any(|load| load.bodies().contains(&body));
            if used || loaded || self.options.fix.as_ref() == Some(&name) {
                continue;
            }
            let text = format!("body {name}, free, joined to nothing: left out");
            element.note(Effect::Changes, text);
            let mut forces: Vec<&str> = Vec::new();
            forces.extend(element.attribute("gravcomp").map(|_| "gravcomp"));
            let own = self.shapes.iter().filter(|shape| shape.body == body);
            forces.extend(own.filter_map(|shape| shape.fluid.map(|_| "fluidshape")));
            if !forces.is_empty() {
                let forces = forces.join(", ");
                let text =
                    format!("body {name} {forces}: left out (gravcomp 1 cancels the weight)");
                element.note(Effect::Changes, text);
            }
            self.model.left_out.push(body);
            self.shapes.retain(|shape| shape.body != body);
        }
    }

    fn joint_named(&self, element: &Element<'d>, name: &str) -> Result<usize, DoorError> {
        element.known(self.model.joint_named(name), "joint", name)
    }

    /// An actuator of a joint drives it.
    fn actuator(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let tag = element.tag();
        let item = self.defaults.item(element, None)?;
        let _ = element.attribute("name");
        let name = element.attribute("joint");
        let joint = name
            .map(|name| self.joint_named(&element, name))
            .transpose()?;
        let drives = ["motor", "position", "velocity", "general", "intvelocity"].contains(&tag);
        let joint = joint.filter(|joint| drives && self.model.joints[*joint].is_driveable());
        let Some((name, joint)) = name.zip(joint) else {
            let of = name.map_or(String::new(), |joint| format!(" of {joint}"));
            let text = format!("{tag} actuator{of}: {}", crate::xml::LOST);
            element.leave(Effect::Changes, text);
            return Ok(());
        };
        let gear = item.numbers("gear")?.and_then(|gear| gear.first().copied());
        let gear = gear.unwrap_or(1.0);
        let gains = match tag {
            "position" => Some([item.value("kp", 1.0)?, item.value("kv", 0.0)?]),
            "velocity" => Some([0.0, item.value("kv", 1.0)?]),
            _ => None,
        };
        element.kept(match tag {
            "motor" => {
                format!("motor of {name}: drives it, with {gear} N m or N for a control of 1")
            }
            "position" => "position actuator: servo: kept as a drive (kp, kv)".to_owned(),
            "velocity" => "velocity actuator: servo: kept as a drive (kv)".to_owned(),
            _ => format!("{tag} actuator of {name}: drives it; its own law is left out"),
        });
        self.model.drive(joint).servo = gains.map(|gains| gains.map(|gain| gain * gear * gear));
        Ok(())
    }
}
