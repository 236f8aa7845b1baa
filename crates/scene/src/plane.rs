//! The parts of scenes that exist only in the plane: joints and actuators, approximate angles, reactions.

use crate::assembly::{AssemblyNotation, ParsedAssembly};
use crate::bodies::Bodies;
use crate::build::Sections;
use crate::coordinates::{CoordinateNotation, ParsedActuator, ParsedCoordinates, Parts, length};
use crate::diagnostics::{Diagnostics, Span};
use crate::dimensions::Plane;
use crate::friction::add_friction;
use crate::joints::Joints;
use crate::keys::table;
use crate::loads::add_separating_forces;
use crate::magnitude::{Magnitudes, Names};
use crate::requests::{ReactionNotation, component_named, joint_and_component};
use crate::scene_data::Assembly;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::{
    Actuator, ActuatorId, ActuatorKind, AssemblyConfiguration, Body, BodyId, BranchHint, Component,
    Coordinate, Joint, JointId, JointKind, Mechanism, Reaction, Vec2,
};
use dwell_kinetostatics::Load;
use toml::de::DeValue;

impl CoordinateNotation for Plane {
    type Joints<'a> = Joints<'a>;
    type Actuator = Actuator;
    const COORDINATE: &'static str =
        "add `angle = [\"ground\", \"rod\"]`, `travel = \"slide\"`, or `length` with two points";

    fn actuator(entry: &Entry<'_>, parts: &Parts<'_, '_, Self>) -> Option<(Actuator, Coordinate)> {
        let actuator = read_actuator(entry, parts.bodies, parts.joints)?;
        let coordinate = actuator.coordinate();
        Some((actuator, coordinate))
    }

    fn angle_or_travel(
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
        parts: &Parts<'_, '_, Self>,
    ) -> Option<Coordinate> {
        if entry.name == "angle" {
            return angle(entry, fields, "measures", parts.bodies).map(Coordinate::Angle);
        }
        let name = entry.value.string(fields.name_of(entry))?;
        let joint = parts.joints.sliding(name, &entry.value.span())?;
        Some(Coordinate::Travel(joint))
    }

    fn distance(bodies: [BodyId; 2], points: [Vec2; 2]) -> Coordinate {
        Coordinate::Length { bodies, points }
    }
}

/// Reads the coordinate that the actuator drives.
fn read_actuator(entry: &Entry<'_>, bodies: &Bodies<'_>, joints: &Joints<'_>) -> Option<Actuator> {
    let what = format!("actuator `{}`", shorten(entry.name));
    let fields = TableReader::open(entry, what)?;
    fields.reject_unknown_keys(table("actuator"));
    let help = "add `angle = [\"ground\", \"crank\"]`: the angle of the second body from the first; or `length` with the name of a sliding joint or with two points";
    let (lacks, label) = ("has no coordinate", "which angle or length?");
    let chosen = fields.alternative(table("actuator"), lacks, label, help)?;
    let (bodies, kind) = match (chosen.name, chosen.value.get()) {
        ("angle", _) => {
            let bodies = angle(chosen, &fields, "drives", bodies)?;
            (bodies, ActuatorKind::Angle)
        }
        (_, DeValue::String(name)) => {
            let joint = joints.sliding(name, &chosen.value.span())?;
            let bodies = joints.list.get(joint.0)?.joint.as_ref()?.bodies;
            (bodies, ActuatorKind::Travel(joint))
        }
        _ => {
            let expected = "a sliding joint, or two points [\"body.point\", \"body.point\"]";
            let (bodies, points) = length(chosen, &fields, "drives", expected, bodies)?;
            (bodies, ActuatorKind::Length(points))
        }
    };
    Some(Actuator::new(entry.name, bodies, kind))
}

/// Two different bodies, of which `fields` drives or measures the angle.
fn angle(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    verb: &str,
    bodies: &Bodies<'_>,
) -> Option<[BodyId; 2]> {
    let [a, b] = &bodies.find_two(entry.value, fields.name_of(entry))?;
    let message = |name: &str| format!("{} {verb} body `{name}` against itself", fields.what);
    let help = "an angle is between two different bodies";
    bodies.require_different([(a.0, &a.1), (b.0, &b.1)], message, help)
}

impl AssemblyNotation for Plane {
    type Guess = f64;
    const NAMED: [&'static str; 2] = [
        "neither an actuator nor a body nor a joint",
        "actuators, bodies and slides",
    ];

    fn guess(entry: &Entry<'_>, what: String, is_ground: bool) -> Option<f64> {
        let angle = entry.value.angle(what);
        if is_ground && angle.is_some_and(|si| si != 0.0) {
            let message = format!("the ground `{}` cannot be rotated", shorten(entry.name));
            let help = "leave it out: its frame is the frame of the plane";
            entry.value.reject::<()>(message, "its angle is 0", help);
        }
        angle
    }

    fn hintable_joints<'j>(joints: &'j Joints<'_>) -> Vec<&'j str> {
        let hintable = joints.list.iter().filter(|j| {
            let kind = j.joint.as_ref().map(|j| j.kind);
            kind.is_some_and(|kind| kind.branch_hint().is_some())
        });
        hintable.map(|j| j.name.as_str()).collect()
    }

    fn branch_hint(
        entry: &Entry<'_>,
        what: &str,
        joints: &Joints<'_>,
    ) -> Option<(usize, Option<f64>)> {
        let k = joints.list.iter().position(|j| j.name == entry.name)?;
        // One that could not be read has been reported.
        let joint = joints.list[k].joint.as_ref();
        let hint = joint.and_then(|joint| branch_hint(entry, what, joints, joint.kind));
        Some((k, hint))
    }

    fn guessed_lengths(
        parsed: &ParsedAssembly<Self>,
        missing: &[usize],
        coordinates: &[f64],
        parts: &Parts<'_, '_, Self>,
        actuators: &[ParsedActuator<'_, Self>],
    ) -> Vec<(usize, Option<f64>)> {
        let Parts { bodies, joints } = *parts;
        let read_joints = joints.list.iter().map(|j| j.joint.clone()).collect();
        let read_actuators = actuators.iter().map(|a| a.actuator.clone()).collect();
        let (Some(ground), Some(all_joints), Some(actuators)) =
            (bodies.ground, read_joints, read_actuators)
        else {
            // What could not be read is reported.
            return Vec::new();
        };
        let mechanism = Mechanism {
            bodies: bodies.list.iter().map(|b| Body::named(b.name)).collect(),
            ground,
            joints: all_joints,
            actuators,
            couplings: Vec::new(),
        };
        let assembly = AssemblyConfiguration {
            q: coordinates.to_vec(),
            initial_guess: parsed.guesses.clone(),
            branch_hints: hints_by_joint(&parsed.branch_hints, joints),
        };
        let length = |&k: &usize| (k, mechanism.guessed_length(&assembly, ActuatorId(k)));
        missing.iter().map(length).collect()
    }
}

fn hints_by_joint(hints: &[(usize, Option<f64>)], joints: &Joints<'_>) -> Vec<Option<f64>> {
    let mut by_joint = vec![None; joints.list.len()];
    for &(k, hint) in hints {
        by_joint[k] = hint;
    }
    by_joint
}

/// The approximate travel of a prismatic joint or a slot, m, or direction of a distance, rad.
fn branch_hint(entry: &Entry<'_>, what: &str, joints: &Joints<'_>, kind: JointKind) -> Option<f64> {
    if let Some(hint) = kind.branch_hint() {
        return entry.value.coordinate(hint == BranchHint::Direction, what);
    }
    let names = Plane::hintable_joints(joints).into_iter();
    let help = entry.log().choices("", "joints that can", names);
    let message = format!("joint `{}` takes no initial guess", shorten(entry.name));
    let label = format!("its kind is {}", kind.name());
    let help = format!(
        "a prismatic joint or a slot takes an initial travel, a distance a direction; {help}"
    );
    entry.reject(message, &label, help)
}

impl ReactionNotation for Plane {
    const REACTIONS: &'static str = "an array such as [\"slide.normal\"]";

    fn reactions_named(text: &str, at: &Span, parts: &Parts<'_, '_, Self>) -> Vec<Reaction> {
        let joints = parts.joints;
        let (name, component) = joint_and_component(text);
        let mut found = Vec::new();
        for k in joints.find(name, at).into_iter().flatten() {
            // A joint that could not be read has been reported already.
            let Some(joint) = &joints.list[k].joint else {
                continue;
            };
            let components = components(joint, component, joints, at);
            if components.is_empty() {
                break;
            }
            found.extend(components.into_iter().map(|component| Reaction {
                joint: JointId(k),
                component,
            }));
        }
        found
    }

    fn name_of_reaction(reaction: Reaction, joints: &Joints<'_>) -> String {
        let joint = &joints.list[reaction.joint.0].name;
        format!("{joint}.{}", reaction.component.name())
    }
}

/// The named component of the joint's reaction, or all of them.
fn components(joint: &Joint, name: Option<&str>, joints: &Joints<'_>, at: &Span) -> Vec<Component> {
    let all = joint.kind.components(&joints.couplings);
    let Some(name) = name else {
        return all.to_vec();
    };
    let all: Vec<_> = all.iter().map(|c| (c.name(), *c)).collect();
    let found = component_named(name, &joint.name, &all, at, joints.log);
    Vec::from_iter(found)
}

impl Sections for Plane {
    fn joints<'a>(
        fields: Option<&TableReader<'a>>,
        bodies: &Bodies<'_>,
        log: &'a Diagnostics,
    ) -> Joints<'a> {
        let joints = Joints::new(log);
        match fields {
            Some(fields) => joints.read(fields, bodies),
            None => joints,
        }
    }

    fn complete_joints(
        joints: &mut Joints<'_>,
        _: &[ParsedActuator<'_, Self>],
        coordinates: &ParsedCoordinates<'_>,
    ) -> Vec<Option<[BodyId; 2]>> {
        joints.read_couplings(coordinates);
        let joints = joints.list.iter();
        joints.map(|j| Some(j.joint.as_ref()?.bodies)).collect()
    }

    fn check_bodies(parts: &Parts<'_, '_, Self>) {
        check_varying_inertias(parts.bodies, parts.joints);
    }

    fn loads(
        loads: Option<&TableReader<'_>>,
        friction: Option<&TableReader<'_>>,
        parts: &Parts<'_, '_, Self>,
        magnitudes: &Magnitudes,
    ) -> Vec<Load> {
        let Parts { bodies, joints } = *parts;
        let names = Names {
            bodies,
            joints,
            magnitudes,
        };
        let mut all = loads.map_or_else(Vec::new, |fields| names.loads(fields));
        if let Some(fields) = friction {
            add_friction(fields, joints, &mut all);
        }
        add_separating_forces(joints, &mut all);
        all
    }

    fn assembly(parsed: ParsedAssembly<Self>, start: &[f64], joints: &Joints<'_>) -> Assembly {
        Assembly {
            coordinates: start.to_vec(),
            branch_hints: hints_by_joint(&parsed.branch_hints, joints),
            initial_guess: parsed.guesses,
        }
    }

    fn mechanism(
        bodies: Vec<Body>,
        ground: usize,
        joints: Joints<'_>,
        actuators: Vec<Actuator>,
        assembly: &Assembly,
    ) -> Mechanism {
        let mut mechanism = Mechanism {
            bodies,
            ground,
            joints: joints.list.into_iter().filter_map(|j| j.joint).collect(),
            actuators,
            couplings: joints.couplings,
        };
        mechanism.mesh_as_given(&assembly.to_configuration());
        mechanism
    }

    fn all_reactions(mechanism: &Mechanism) -> Vec<Reaction> {
        mechanism.reactions()
    }

    fn driven_coordinates(
        mechanism: &Mechanism,
    ) -> impl Iterator<Item = (&str, Coordinate)> + Clone {
        let actuators = mechanism.actuators.iter();
        actuators.map(|a| (a.name.as_str(), a.coordinate()))
    }
}

/// Reports bodies that no revolute joint holds on the ground, and reactions whose names are those of joints.
fn check_varying_inertias(bodies: &Bodies<'_>, joints: &Joints<'_>) {
    for varying in &bodies.varying_inertias() {
        let (body, ground) = (&bodies.list[varying.body.0], bodies.ground);
        let is_pivot = |joint: &Joint| {
            matches!(joint.kind, JointKind::Revolute)
                && joint.bodies.contains(&varying.body)
                && joint.bodies.iter().any(|b| Some(b.0) == ground)
        };
        let mut read = joints.list.iter().filter_map(|j| j.joint.as_ref());
        if !read.any(is_pivot) {
            let message = format!(
                "no revolute joint holds body `{}`, whose inertia varies, on the ground",
                shorten(body.name)
            );
            let help = "its inertia is a function of its angle from the ground: add `A = { revolute = [\"ground.A\", \"…\"] }`";
            joints
                .log
                .report(message, &[(&body.key, "turns about no fixed point")], help);
        }
        for reaction in &varying.reactions {
            let first = reaction.name.split('.').next().unwrap_or_default();
            if joints.list.iter().any(|joint| joint.name == first) {
                let message = format!(
                    "reaction `{}` of a varying inertia has the name of a joint",
                    shorten(&reaction.name)
                );
                let help = "rename the reaction, or the joint";
                joints
                    .log
                    .report(message, &[(&body.key, "in this body")], help);
            }
        }
    }
}
