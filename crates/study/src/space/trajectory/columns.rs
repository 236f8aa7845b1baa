//! The columns of scenes in space that differ from those in the plane: those of actuators, joints and loads.

use super::load_forces::LoadForce;
use super::reactions::SpaceRows;
use crate::trajectory::compute::{ColumnList, Quantity};
use dwell_geometry::JointId;
use dwell_geometry::space::{ActuatorKind, Plan};
use dwell_kinetostatics::space::{Axes, Component, LoadKind};
use dwell_kinetostatics::{LoadShape as _, Strength};
use dwell_scene::SpaceScene;

/// The meanings of an actuator's coordinate and of its force.
pub(super) fn actuator_meanings(scene: &SpaceScene, actuator: usize) -> [String; 2] {
    let mechanism = &scene.mechanism;
    let kind = mechanism.actuators[actuator].kind;
    let joint = &mechanism.joints[kind.joint().0];
    let [one, two] = joint.bodies.map(|b| mechanism.bodies[b.0].name.as_str());
    let (what, force) = match kind {
        ActuatorKind::Angle(_) => ("angle", "moment"),
        ActuatorKind::Travel(_) => ("travel", "force"),
        ActuatorKind::Length(_) => ("length", "force"),
    };
    let place = if force == "moment" { "about" } else { "along" };
    let joint = &joint.name;
    [
        format!("{what} of joint {joint}"),
        format!("{force} of {one} on {two} {place} the axis of {joint}"),
    ]
}

/// Adds the columns of joints.
pub(super) fn add_joint_columns(scene: &SpaceScene, rows: &SpaceRows, list: &mut ColumnList) {
    let mechanism = &scene.mechanism;
    for (k, reaction) in rows.requested.iter().enumerate() {
        let joint = &mechanism.joints[reaction.joint.0];
        let [one, two] = joint.bodies.map(|b| mechanism.bodies[b.0].name.as_str());
        let (what, unit, axes) = match reaction.component {
            Component::Force(axes, _) => ("force", "N", axes),
            Component::Moment(axes, _) => ("moment", "N m", axes),
        };
        let at = match reaction.component {
            Component::Force(..) => String::new(),
            Component::Moment(..) => format!(", about the joint's point of {two}"),
        };
        let axes = match axes {
            Axes::Ground => "ground's axes".to_owned(),
            Axes::Joint => format!("the joint's axes on {one}"),
            Axes::Line => "along the line of the joint's points".to_owned(),
        };
        let meaning = if joint.kind.is_coupling() {
            format!("{what} of {one} on {two} along the dependent coordinate of the coupling")
        } else {
            format!("{what} of {one} on {two}, {axes}{at}")
        };
        let name = scene.reaction_name(*reaction);
        list.add(name, unit, Quantity::Reaction(k), meaning);
    }
    for (j, joint) in mechanism.joints.iter().enumerate() {
        let [one, two] = joint.bodies.map(|b| mechanism.bodies[b.0].name.as_str());
        let id = JointId(j);
        let [force, moment] = rows.has_magnitude(id);
        if force {
            let meaning = format!("magnitude of the force of {one} on {two}");
            let name = format!("{}.magnitude", joint.name);
            list.add(name, "N", Quantity::ForceMagnitude(id), meaning);
        }
        if moment {
            let meaning = format!(
                "magnitude of the moment of {one} on {two}, about the joint's point of {two}"
            );
            let name = format!("{}.moment-magnitude", joint.name);
            list.add(name, "N m", Quantity::MomentMagnitude(id), meaning);
        }
    }
}

/// Adds the columns of loads and drives.
pub(super) fn add_load_columns(scene: &SpaceScene, plan: &Plan, list: &mut ColumnList) {
    let forces = LoadForce::of_all(scene, plan);
    let loads = scene.loads.iter();
    let loads = loads.map(|load| (&load.name, load.kind, false));
    let drives = scene.drives.iter().map(|drive| {
        let kind = LoadKind::Along(drive.coordinate, Strength::Direct);
        (&drive.name, kind, true)
    });
    let all = loads.chain(drives).zip(forces).enumerate();
    for (k, ((name, kind, is_drive), force)) in all {
        let meaning = force.and(kind.meaning());
        let described = meaning.map(|meaning| (kind.force_unit(), meaning));
        list.add_load(k, name, described, is_drive);
    }
}
