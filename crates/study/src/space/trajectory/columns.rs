//! The columns of a trajectory of a scene in space, each with its unit and meaning.

use super::load_forces::{LoadForce, described_drive, described_load};
use super::reactions::JointReactions;
use crate::number_format::force_unit;
use crate::trajectory::compute::{Analysis, Column, POWER_COLUMNS, Quantity};
use dwell_geometry::space::{ActuatorKind, Coordinate, Plan, Vec3};
use dwell_geometry::{BodyId, JointId};
use dwell_kinetostatics::space::{Axes, Component};
use dwell_scene::SpaceScene;

const AXES: [&str; 3] = ["x", "y", "z"];
const ROTATION: [(&str, &str, &str); 3] = [
    (
        "rotation",
        "rad",
        "rotation of the body's frame from that of the ground, as a vector along its axis; followed from row to row",
    ),
    (
        "angular_velocity",
        "rad/s",
        "angular velocity, ground's axes",
    ),
    (
        "angular_acceleration",
        "rad/s2",
        "angular acceleration, ground's axes",
    ),
];
const POINT: [(&str, &str); 3] = [("", "m"), ("v", "m/s"), ("a", "m/s2")];

/// Every column of an analysis of a scene; with the time if `timed`.
pub(crate) fn all_columns(
    scene: &SpaceScene,
    (reactions, plan): (&JointReactions, &Plan),
    (analysis, timed): (Analysis, bool),
) -> Vec<Column> {
    let mut columns = Columns {
        scene,
        list: Vec::new(),
    };
    if timed {
        columns.add("t", "s", Quantity::Time, "");
    }
    columns.actuators();
    columns.coordinates(plan);
    columns.bodies();
    columns.reactions(reactions);
    columns.loads(plan);
    columns.totals();
    let mut list = columns.list;
    list.retain(|column| column.is_computed_by(analysis));
    list
}

/// Collects columns.
struct Columns<'a> {
    scene: &'a SpaceScene,
    list: Vec<Column>,
}

impl Columns<'_> {
    fn add(
        &mut self,
        name: impl Into<String>,
        unit: &'static str,
        quantity: Quantity,
        meaning: impl Into<String>,
    ) {
        self.list.push(Column {
            name: name.into(),
            former: None,
            unit,
            quantity,
            meaning: meaning.into(),
        });
    }

    fn actuators(&mut self) {
        let mechanism = &self.scene.mechanism;
        for (i, actuator) in mechanism.actuators.iter().enumerate() {
            let joint = &mechanism.joints[actuator.kind.joint().0];
            let [one, two] = joint.bodies.map(|b| mechanism.bodies[b.0].name.as_str());
            let (units, is_angle, what) = match actuator.kind {
                ActuatorKind::Angle(_) => (["rad", "rad/s", "rad/s2"], true, "angle"),
                ActuatorKind::Travel(_) => (["m", "m/s", "m/s2"], false, "travel"),
                ActuatorKind::Length(_) => (["m", "m/s", "m/s2"], false, "length"),
            };
            let name = &actuator.name;
            let suffixes = ["", ".velocity", ".acceleration"];
            for (order, (suffix, unit)) in suffixes.into_iter().zip(units).enumerate() {
                let meaning = match order {
                    0 => format!("{what} of joint {}", joint.name),
                    _ => String::new(),
                };
                let quantity = Quantity::ActuatorCoordinate(i, order);
                self.add(format!("{name}{suffix}"), unit, quantity, meaning);
            }
            let kind = if is_angle { "moment" } else { "force" };
            let meaning = format!(
                "{kind} of {one} on {two} about or along the axis of {}",
                joint.name
            );
            let meaning = match is_angle {
                true => meaning.replace("about or along", "about"),
                false => meaning.replace("about or along", "along"),
            };
            let force = format!("{name}.actuator_force");
            self.add(
                force,
                force_unit(is_angle),
                Quantity::ActuatorForce(i),
                meaning,
            );
        }
    }

    /// The named coordinates, and the travels of joints that slide.
    fn coordinates(&mut self, plan: &Plan) {
        for named in &self.scene.coordinates {
            self.measured(plan, &named.name, (named.coordinate, String::new()));
        }
        let mechanism = &self.scene.mechanism;
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let [one, two] = joint.bodies.map(|b| mechanism.bodies[b.0].name.as_str());
            let meaning = format!(
                "position of the point of {two} from that of {one}, along the axis in {one}"
            );
            let name = format!("{}.travel", joint.name);
            self.measured(plan, &name, (Coordinate::Travel(JointId(j)), meaning));
        }
    }

    /// A coordinate with its rates, where the mechanism has it.
    fn measured(&mut self, plan: &Plan, name: &str, (of, meaning): (Coordinate, String)) {
        if plan.coordinate_function(&self.scene.mechanism, of).is_err() {
            return;
        }
        let units = match of.is_angle() {
            true => ["rad", "rad/s", "rad/s2"],
            false => ["m", "m/s", "m/s2"],
        };
        let suffixes = ["", ".velocity", ".acceleration"];
        for (order, (suffix, unit)) in suffixes.into_iter().zip(units).enumerate() {
            let meaning = if order == 0 { meaning.as_str() } else { "" };
            let quantity = Quantity::MeasuredInSpace(of, order);
            self.add(format!("{name}{suffix}"), unit, quantity, meaning);
        }
    }

    fn bodies(&mut self) {
        let mechanism = &self.scene.mechanism;
        for (b, body) in mechanism.bodies.iter().enumerate() {
            if b == mechanism.ground {
                continue;
            }
            let (id, name) = (BodyId(b), &body.name);
            for (order, (word, unit, meaning)) in ROTATION.into_iter().enumerate() {
                for (k, axis) in AXES.into_iter().enumerate() {
                    let quantity = Quantity::RotationInSpace(id, 3 * order + k);
                    self.add(format!("{name}.{word}.{axis}"), unit, quantity, meaning);
                }
            }
            for (point, at) in &self.scene.points[b] {
                self.point(&format!("{name}.{point}"), id, *at);
            }
        }
    }

    fn point(&mut self, name: &str, body: BodyId, at: Vec3) {
        for (order, (letter, unit)) in POINT.into_iter().enumerate() {
            for (k, axis) in AXES.into_iter().enumerate() {
                let quantity = Quantity::PointInSpace(body, at, 3 * order + k);
                self.add(format!("{name}.{letter}{axis}"), unit, quantity, "");
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
            self.add(name, unit, Quantity::Reaction(k), meaning);
        }
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let [one, two] = joint.bodies.map(|b| mechanism.bodies[b.0].name.as_str());
            let id = JointId(j);
            let [force, moment] = reactions.has_magnitude(id);
            if force {
                let meaning = format!("magnitude of the force of {one} on {two}");
                let name = format!("{}.magnitude", joint.name);
                self.add(name, "N", Quantity::ForceMagnitude(id), meaning);
            }
            if moment {
                let meaning = format!(
                    "magnitude of the moment of {one} on {two}, about the joint's point of {two}"
                );
                let name = format!("{}.moment-magnitude", joint.name);
                self.add(name, "N m", Quantity::MomentMagnitude(id), meaning);
            }
        }
    }

    fn loads(&mut self, plan: &Plan) {
        let scene = self.scene;
        let forces = LoadForce::of_all(scene, plan);
        let loads = scene.loads.iter().map(|load| {
            let meaning = "power of the load on all bodies";
            (&load.name, described_load(load), meaning)
        });
        let drives = scene.drives.iter().map(|drive| {
            let meaning = "power of the drive on all bodies, without what its rotor takes";
            (&drive.name, described_drive(drive), meaning)
        });
        let all = loads.chain(drives).zip(forces).enumerate();
        for (k, ((name, (unit, meaning), power), force)) in all {
            if force.is_some() {
                let kind = if unit == "N" { "force" } else { "moment" };
                let name = format!("{name}.load_{kind}");
                self.add(name, unit, Quantity::LoadForce(k), meaning);
            }
            self.add(format!("{name}.power"), "W", Quantity::LoadPower(k), power);
        }
    }

    fn totals(&mut self) {
        let mechanism = &self.scene.mechanism;
        let ground = &mechanism.bodies[mechanism.ground].name;
        let meaning = format!(
            "shaking force: resultant of all joint, actuator and load forces on {ground}; moment about its origin"
        );
        for (k, name) in ["fx", "fy", "fz", "mx", "my", "mz"].into_iter().enumerate() {
            let unit = if k < 3 { "N" } else { "N m" };
            self.add(
                format!("shaking.{name}"),
                unit,
                Quantity::ShakingForce(k),
                &*meaning,
            );
        }
        for (k, (name, unit, meaning)) in POWER_COLUMNS.into_iter().enumerate() {
            self.add(name, unit, Quantity::Power(k), meaning);
        }
    }
}
