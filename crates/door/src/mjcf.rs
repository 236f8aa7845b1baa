//! MJCF, the format of MuJoCo.

mod bodies;
mod constraints;
mod defaults;
mod shapes;

use crate::error::{DoorError, Result};
use crate::model::{Action, GROUND, Model, Move};
use crate::options::ImportOptions;
use crate::pose::{Matrix, Pose, scaled};
use crate::xml::{Coverage, Element, Rules, Xml};
use defaults::Class;
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

struct Reader<'d> {
    model: Model,
    /// What an angle of the file is in rad.
    angle: f64,
    /// The axes of Euler angles.
    sequence: [char; 3],
    /// Whether a range limits only with the word `limited`.
    limits_need_word: bool,
    /// Whether geoms give the inertia: never, always, or where there is no other.
    from_shapes: Option<bool>,
    total_mass: f64,
    main_class: Option<&'d str>,
    classes: HashMap<&'d str, Class<'d>>,
    /// Geoms, each with its body.
    shapes: Vec<(Element<'d>, usize)>,
    /// The coordinates of a keyframe in their order: the joint, unless its body floats, and how many.
    order: Vec<(Option<usize>, usize)>,
    excluded: Vec<[&'d str; 2]>,
    /// Whether shapes touch each other at all.
    touches: bool,
}

/// Reads a model; the first file is that of the root.
pub(crate) fn read(xml: &Xml<'_>, options: &ImportOptions) -> Result<(Model, Coverage)> {
    let root = xml.root();
    let title = root.attribute("model").unwrap_or("MuJoCo model");
    let mut model = Model::new(title, root.place());
    model.terms = ["frictionloss", "range"];
    let mut reader = Reader {
        model,
        angle: 1f64.to_radians(),
        sequence: ['x', 'y', 'z'],
        limits_need_word: false,
        from_shapes: None,
        total_mass: 0.0,
        main_class: None,
        classes: HashMap::new(),
        shapes: Vec::new(),
        order: Vec::new(),
        excluded: Vec::new(),
        touches: true,
    };
    let sections = root.children();
    let of = |tag: &'static str| sections.iter().filter(move |one| one.tag() == tag);
    of("compiler").try_for_each(|one| reader.compiler(*one))?;
    of("default").for_each(|one| reader.defaults(*one, None));
    of("option").try_for_each(|one| reader.option(*one))?;
    for world in of("worldbody") {
        let parts = reader.parts(*world, Pose::IDENTITY, None)?;
        reader.fill(GROUND, &parts)?;
    }
    reader.scale_masses();
    let inner = |tag| of(tag).flat_map(|one| one.children());
    inner("equality").try_for_each(|one| reader.constraint(one))?;
    inner("tendon").try_for_each(|one| reader.tendon(one))?;
    inner("actuator").try_for_each(|one| reader.actuator(one))?;
    inner("contact").for_each(|one| reader.contact(one));
    if let Some(name) = &options.key {
        let keys = of("keyframe").flat_map(|one| one.called("key"));
        reader.keyframe(&keys.collect::<Vec<_>>(), name)?;
    }
    // Only options connect bodies that float with others.
    reader.name_contacts(options.fix.is_none() && options.close.is_empty())?;
    Ok((reader.model, xml.name_the_rest(&RULES)))
}

impl<'d> Reader<'d> {
    fn compiler(&mut self, section: Element<'d>) -> Result<()> {
        if section.is("angle", "radian") {
            self.angle = 1.0;
        }
        if let Some(sequence) = section.attribute("eulerseq") {
            let letters: Vec<char> = sequence.chars().filter(|c| "xyzXYZ".contains(*c)).collect();
            let three = letters.try_into().ok();
            self.sequence = section.known(three, "sequence of axes", sequence)?;
        }
        self.limits_need_word = section.is("autolimits", "false");
        let from_shapes = section.attribute("inertiafromgeom");
        self.from_shapes = from_shapes.and_then(|word| word.parse().ok());
        self.total_mass = section.value("settotalmass", self.total_mass)?;
        Ok(())
    }

    fn option(&mut self, section: Element<'d>) -> Result<()> {
        let gravity = section.vector("gravity")?;
        self.model.gravity = gravity.unwrap_or(self.model.gravity);
        let mut fluid = Vec::new();
        for name in ["density", "viscosity", "wind"] {
            let numbers = section.numbers(name)?.unwrap_or_default();
            if numbers.iter().any(|x| *x != 0.0) {
                fluid.push(name);
            }
        }
        if !fluid.is_empty() {
            section.lost(format!("option {}: fluid forces", fluid.join(", ")));
        }
        for flag in section.called("flag") {
            if flag.is("gravity", "disable") {
                self.model.gravity = [0.0; 3];
            }
            self.touches &= !flag.is("contact", "disable");
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
            // So far these are forces against the weight.
            for load in &mut self.model.loads {
                if let Action::Force { force, .. } = &mut load.action {
                    *force = scaled(*force, factor);
                }
            }
        }
    }

    /// The pose of a keyframe, by the coordinates in the order of the joints.
    fn keyframe(&mut self, keys: &[Element<'d>], wanted: &str) -> Result<()> {
        let name_of = |key: &Element<'d>| key.attribute("name").unwrap_or_default();
        let Some(key) = keys.iter().find(|key| name_of(key) == wanted) else {
            let known = keys.iter().map(name_of);
            return Err(DoorError::unknown("keyframe", wanted, known));
        };
        let numbers = key.numbers("qpos")?.unwrap_or_default();
        let mut rest = &numbers[..];
        for (joint, count) in &self.order {
            let Some((values, after)) = rest.split_at_checked(*count) else {
                return Err(key.error("the keyframe has too few coordinates"));
            };
            rest = after;
            match (joint, values) {
                (Some(joint), [value]) => self.model.moves.push((*joint, Move::To(*value))),
                (Some(joint), [w, x, y, z]) => {
                    let turn = Matrix::quaternion([*w, *x, *y, *z]);
                    let turn = turn.map(|turn| (*joint, Move::Turn(turn)));
                    self.model.moves.extend(turn);
                }
                _ => key.kept("key: the pose of a floating body is not taken from it"),
            }
        }
        Ok(())
    }
}
