//! The columns of a trajectory of a scene in space, each with its unit and meaning.

use super::load_forces::{LoadForce, described_drive, described_load};
use super::reactions::JointReactions;
use crate::trajectory::compute::{Analysis, Column, ColumnList, Quantity, units};
use dwell_geometry::space::{ActuatorKind, Coordinate, Plan, Vec3};
use dwell_geometry::{BodyId, JointId};
use dwell_kinetostatics::space::{Axes, Component};
use dwell_scene::SpaceScene;

const AXES: [&str; 3] = ["x", "y", "z"];
const ROTATION: [(&str, &str); 3] = [
    (
        "rotation",
        "rotation of the body's frame from that of the ground, as a vector along its axis; followed from row to row",
    ),
    ("angular_velocity", "angular velocity, ground's axes"),
    (
        "angular_acceleration",
        "angular acceleration, ground's axes",
    ),
];

/// Every column of an analysis of a scene; with the time if `timed`.
pub(crate) fn all_columns(
    scene: &SpaceScene,
    (reactions, plan): (&JointReactions, &Plan),
    (analysis, timed): (Analysis, bool),
) -> Vec<Column> {
    let mut columns = Columns {
        scene,
        list: ColumnList::new(timed),
    };
    columns.actuators();
    columns.coordinates(plan);
    columns.bodies();
    columns.reactions(reactions);
    columns.loads(plan);
    columns.totals();
    let mut list = columns.list.0;
    list.retain(|column| column.is_computed_by(analysis));
    list
}

/// Collects columns.
struct Columns<'a> {
    scene: &'a SpaceScene,
    list: ColumnList,
}

impl Columns<'_> {
    fn actuators(&mut self) {
        let mechanism = &self.scene.mechanism;
        for (i, actuator) in mechanism.actuators.iter().enumerate() {
            let joint = &mechanism.joints[actuator.kind.joint().0];
            let [one, two] = joint.bodies.map(|b| mechanism.bodies[b.0].name.as_str());
            let (what, is_angle) = match actuator.kind {
                ActuatorKind::Angle(_) => ("angle", true),
                ActuatorKind::Travel(_) => ("travel", false),
                ActuatorKind::Length(_) => ("length", false),
            };
            let kind = if is_angle { "moment" } else { "force" };
            let place = if is_angle { "about" } else { "along" };
            let joint = &joint.name;
            let meaning = format!("{what} of joint {joint}");
            let force = format!("{kind} of {one} on {two} {place} the axis of {joint}");
            let of = (actuator.name.as_str(), is_angle);
            self.list.add_actuator(i, of, [&meaning, &force]);
        }
    }

    /// The named coordinates, and the travels of joints that slide.
    fn coordinates(&mut self, plan: &Plan) {
        for named in &self.scene.coordinates {
            self.measured(plan, &named.name, named.coordinate, "");
        }
        let mechanism = &self.scene.mechanism;
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let [one, two] = joint.bodies.map(|b| mechanism.bodies[b.0].name.as_str());
            let meaning = format!(
                "position of the point of {two} from that of {one}, along the axis in {one}"
            );
            let name = format!("{}.travel", joint.name);
            self.measured(plan, &name, Coordinate::Travel(JointId(j)), &meaning);
        }
    }

    /// A coordinate with its rates, where the mechanism has it.
    fn measured(&mut self, plan: &Plan, name: &str, of: Coordinate, meaning: &str) {
        if plan.coordinate_function(&self.scene.mechanism, of).is_ok() {
            let quantity = |order| Quantity::MeasuredInSpace(of, order);
            self.list
                .add_with_derivatives(name, of.is_angle(), quantity, meaning);
        }
    }

    fn bodies(&mut self) {
        let mechanism = &self.scene.mechanism;
        for (b, body) in mechanism.bodies.iter().enumerate() {
            if b == mechanism.ground {
                continue;
            }
            let (id, name) = (BodyId(b), &body.name);
            for (order, (word, meaning)) in ROTATION.into_iter().enumerate() {
                for (k, axis) in AXES.into_iter().enumerate() {
                    let quantity = Quantity::RotationInSpace(id, 3 * order + k);
                    let name = format!("{name}.{word}.{axis}");
                    self.list.add(name, units(true)[order], quantity, meaning);
                }
            }
            for (point, at) in &self.scene.points[b] {
                self.point(&format!("{name}.{point}"), id, *at);
            }
        }
    }

    fn point(&mut self, name: &str, body: BodyId, at: Vec3) {
        for (order, letter) in ["", "v", "a"].into_iter().enumerate() {
            for (k, axis) in AXES.into_iter().enumerate() {
                let quantity = Quantity::PointInSpace(body, at, 3 * order + k);
                let name = format!("{name}.{letter}{axis}");
                self.list.add(name, units(false)[order], quantity, "");
            }
        }
    }

    fn reactions(&mut self, reactions: &JointReactions) {
        let mechanism = &self.scene.mechanism;
        for (k, reaction) in reactions.requested.iter().enumerate() {
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
            };
            let meaning = format!("{what} of {one} on {two}, {axes}{at}");
            let name = self.scene.reaction_name(*reaction);
            self.list.add(name, unit, Quantity::Reaction(k), meaning);
        }
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let [one, two] = joint.bodies.map(|b| mechanism.bodies[b.0].name.as_str());
            let id = JointId(j);
            let [force, moment] = reactions.has_magnitude(id);
            if force {
                let meaning = format!("magnitude of the force of {one} on {two}");
                let name = format!("{}.magnitude", joint.name);
                self.list
                    .add(name, "N", Quantity::ForceMagnitude(id), meaning);
            }
            if moment {
                let meaning = format!(
                    "magnitude of the moment of {one} on {two}, about the joint's point of {two}"
                );
                let name = format!("{}.moment-magnitude", joint.name);
                self.list
                    .add(name, "N m", Quantity::MomentMagnitude(id), meaning);
            }
        }
    }

    fn loads(&mut self, plan: &Plan) {
        let scene = self.scene;
        let forces = LoadForce::of_all(scene, plan);
        let loads = scene.loads.iter();
        let loads = loads.map(|load| (&load.name, described_load(load), false));
        let drives = scene.drives.iter();
        let drives = drives.map(|drive| (&drive.name, described_drive(drive), true));
        let all = loads.chain(drives).zip(forces).enumerate();
        for (k, ((name, described, is_drive), force)) in all {
            let described = force.map(|_| described);
            self.list.add_load(k, name, described, is_drive);
        }
    }

    fn totals(&mut self) {
        let mechanism = &self.scene.mechanism;
        let ground = &mechanism.bodies[mechanism.ground].name;
        let components = [
            ("fx", "N"),
            ("fy", "N"),
            ("fz", "N"),
            ("mx", "N m"),
            ("my", "N m"),
            ("mz", "N m"),
        ];
        self.list.add_totals(ground, &components);
    }
}
