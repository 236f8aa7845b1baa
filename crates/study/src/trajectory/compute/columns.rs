//! The columns of a trajectory table, each with its unit and meaning.

use crate::trajectory::compute::{Column, ColumnList, Quantity, dyads, units};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{
    ActuatorKind, BodyId, Component, Coordinate, JointId, JointKind, Plan, Reaction,
};
use dwell_kinetostatics::{Load, LoadKind, Model};
use dwell_scene::PlaneScene;

const BODY_ANGLE: [(&str, &str); 3] = [
    (
        "angle",
        "angle of the body frame from the ground frame, unwrapped along the trajectory",
    ),
    ("angular_velocity", "angular velocity"),
    ("angular_acceleration", "angular acceleration"),
];

/// Every column of a scene, whatever the analysis; with the time if `timed`.
pub(crate) fn all_columns(scene: &PlaneScene, model: &Model, timed: bool) -> Vec<Column> {
    let mut columns = Columns {
        scene,
        plan: model.plan(),
        list: ColumnList::new(timed),
    };
    columns.actuators();
    columns.coordinates();
    columns.bodies();
    columns.dyads();
    columns.reactions(model.reactions());
    columns.known_reactions();
    columns.loads();
    columns.totals();
    columns.list.0
}

/// Collects columns.
struct Columns<'a> {
    scene: &'a PlaneScene,
    plan: &'a Plan,
    list: ColumnList,
}

impl Columns<'_> {
    fn actuators(&mut self) {
        let mechanism = &self.scene.mechanism;
        for (i, actuator) in mechanism.actuators.iter().enumerate() {
            let [one, two] = actuator.bodies.map(|b| mechanism.body_name(b));
            let (meaning, force) = match actuator.kind {
                ActuatorKind::Angle => (
                    format!("angle of {two} from {one}"),
                    format!("moment of {one} on {two}"),
                ),
                ActuatorKind::Travel(joint) => (
                    format!("travel of {}", mechanism.joints[joint.0].name),
                    format!("force of {one} on {two} along the travel"),
                ),
                ActuatorKind::Length(_) => (
                    format!("distance of points of {one} and {two}"),
                    "force between the points; positive pushes them apart".to_owned(),
                ),
            };
            let of = (actuator.name.as_str(), self.plan.is_angle(i));
            self.list.add_actuator(i, of, [&meaning, &force]);
        }
    }

    fn coordinates(&mut self) {
        let scene = self.scene;
        for named in &scene.coordinates {
            self.measured(&named.name, named.coordinate, "");
        }
        for (j, joint) in scene.mechanism.joints.iter().enumerate() {
            let [one, two] = joint.bodies.map(|b| scene.mechanism.body_name(b));
            let meaning = format!(
                "position of the point of {two} from that of {one}, along the axis in {one}"
            );
            let name = format!("{}.travel", joint.name);
            self.measured(&name, Coordinate::Travel(JointId(j)), &meaning);
        }
    }

    fn measured(&mut self, name: &str, of: Coordinate, meaning: &str) {
        if let Some(measured) = CoordinateFunction::find(&self.scene.mechanism, of) {
            let quantity = |order| Quantity::Measured(measured, order);
            self.list
                .add_with_derivatives(name, of.is_angle(), quantity, meaning);
        }
    }

    fn bodies(&mut self) {
        let scene = self.scene;
        let mechanism = &scene.mechanism;
        for (b, body) in mechanism.bodies.iter().enumerate() {
            if b == mechanism.ground {
                continue;
            }
            let (id, name) = (BodyId(b), &body.name);
            for (order, (word, meaning)) in BODY_ANGLE.into_iter().enumerate() {
                let quantity = Quantity::BodyAngle(id, order);
                self.list.add(
                    format!("{name}.{word}"),
                    units(true)[order],
                    quantity,
                    meaning,
                );
            }
            if self.plan.actuators() == 1 {
                let meaning = format!("velocity ratio dθ/d{}", mechanism.actuators[0].name);
                let unit = if self.plan.is_angle(0) { "" } else { "rad/m" };
                let name = format!("{name}.velocity_ratio");
                self.list
                    .add(name, unit, Quantity::VelocityRatio(id), meaning);
                self.mechanical_advantages(id);
            }
            self.poles(id);
            for (point, at) in &scene.points[b] {
                for (k, part) in ["x", "y", "vx", "vy", "ax", "ay"].into_iter().enumerate() {
                    let quantity = Quantity::PointCoordinate(id, *at, k);
                    let name = format!("{name}.{point}.{part}");
                    self.list.add(name, units(false)[k / 2], quantity, "");
                }
            }
        }
    }

    /// On request: mechanical advantage of a body and its points.
    fn mechanical_advantages(&mut self, body: BodyId) {
        let scene = self.scene;
        let name = scene.mechanism.body_name(body);
        let force = format!("{}.actuator_force", scene.mechanism.actuators[0].name);
        let [of_rotation, of_travel] = match self.plan.is_angle(0) {
            true => ["", "1/m"],
            false => ["m", ""],
        };
        let meaning = format!(
            "mechanical advantage dq/dθ: output moment of {name} per unit of {force}, statically and without other \
             loads; empty where {name} does not rotate"
        );
        let quantity = Quantity::MechanicalAdvantage(body, None);
        let of_body = format!("{name}.mechanical_advantage");
        self.list.add(of_body, of_rotation, quantity, meaning);
        for (point, at) in &scene.points[body.0] {
            let meaning = format!(
                "mechanical advantage dq/ds: output force at {point} along its path per unit of {force}, statically \
                 and without other loads; empty where the point is at rest"
            );
            let quantity = Quantity::MechanicalAdvantage(body, Some(*at));
            let name = format!("{name}.{point}.mechanical_advantage");
            self.list.add(name, of_travel, quantity, meaning);
        }
    }

    /// On request: the velocity pole and the acceleration pole of a body.
    fn poles(&mut self, body: BodyId) {
        let scene = self.scene;
        let name = scene.mechanism.body_name(body);
        for (order, what) in [(1, "velocity"), (2, "acceleration")] {
            let pole = format!("{what}_pole");
            // A point of the scene with that name takes precedence.
            if scene.points[body.0].iter().any(|(point, _)| *point == pole) {
                continue;
            }
            for (axis, letter) in ["x", "y"].into_iter().enumerate() {
                let meaning = format!(
                    "point of {name} with zero {what}, in the ground frame; empty where {name} does not rotate"
                );
                let quantity = Quantity::Pole(body, order, axis);
                self.list
                    .add(format!("{name}.{pole}.{letter}"), "m", quantity, meaning);
            }
        }
    }

    fn dyads(&mut self) {
        let mechanism = &self.scene.mechanism;
        for (joint, dyad) in dyads(mechanism, self.plan) {
            let name = format!("{}.transmission_angle", mechanism.joints[joint.0].name);
            let quantity = Quantity::TransmissionAngle(dyad);
            self.list.add(name, "rad", quantity, dyad.meaning());
        }
    }

    fn reactions(&mut self, reactions: &[Reaction]) {
        use JointKind::{Prismatic, Revolute, Rolling, Slot, Weld};
        let (mechanism, plan) = (&self.scene.mechanism, self.plan);
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let id = JointId(j);
            let [one, two] = joint.bodies.map(|b| mechanism.body_name(b));
            let of_joint = reactions.iter().enumerate().filter(|(_, r)| r.joint == id);
            // Statically indeterminate reactions are no results.
            let (determinate, others): (Vec<_>, Vec<_>) =
                of_joint.partition(|&(k, _)| plan.is_determinate(k));
            for (k, &reaction) in determinate {
                let meaning = reaction_meaning(joint.kind, reaction.component, one, two);
                let name = mechanism.reaction_name(reaction);
                let unit = reaction.component.unit();
                self.list.add(name, unit, Quantity::Reaction(k), meaning);
            }
            self.separating_force(id);
            if others.iter().any(|(_, r)| r.component != Component::Moment) {
                continue;
            }
            if matches!(joint.kind, Revolute | Weld { .. }) {
                for body in joint.bodies.into_iter().filter(|b| b.0 != mechanism.ground) {
                    let of = mechanism.body_name(body);
                    for (axis, letter) in ["x", "y"].into_iter().enumerate() {
                        let meaning =
                            format!("force of {one} on {two} along the {letter} axis of {of}");
                        let quantity = Quantity::BodyFrameForce(id, body, axis);
                        let name = format!("{}.{letter}@{of}", joint.name);
                        self.list.add(name, "N", quantity, meaning);
                    }
                }
            }
            if matches!(
                joint.kind,
                Revolute | Weld { .. } | Prismatic { .. } | Slot { .. } | Rolling { .. }
            ) {
                let force = format!("of the force of {one} on {two}");
                let name = format!("{}.magnitude", joint.name);
                let meaning = format!("magnitude {force}");
                self.list
                    .add(name, "N", Quantity::ForceMagnitude(id), meaning);
                let name = format!("{}.direction", joint.name);
                let meaning = format!("direction {force}, from the ground's x axis");
                self.list
                    .add(name, "rad", Quantity::ForceDirection(id), meaning);
            }
        }
    }

    /// Reactions within the mechanisms that bodies of varying inertia stand for.
    fn known_reactions(&mut self) {
        let scene = self.scene;
        for (i, varying) in scene.varying_inertias.iter().enumerate() {
            let body = scene.mechanism.body_name(varying.body);
            for (k, reaction) in varying.reactions.iter().enumerate() {
                let unit = if reaction.is_moment { "N m" } else { "N" };
                let meaning = format!(
                    "reaction within the mechanism that {body} stands for, of its inertia and drive alone"
                );
                self.list
                    .add(&reaction.name, unit, Quantity::KnownReaction(i, k), meaning);
            }
        }
    }

    /// The separating force of teeth, beside their tooth force.
    fn separating_force(&mut self, joint: JointId) {
        let mut loads = self.scene.loads.iter();
        let is_of_joint = |load: &Load| load.pressure_angle().is_some_and(|p| p.joint == joint);
        if let Some(k) = loads.position(is_of_joint) {
            let meaning = "separating force: |tooth force| × tan(pressure angle), pushes the two bodies apart at the pitch point";
            let name = self.scene.loads[k].name.clone();
            self.list.add(name, "N", Quantity::LoadForce(k), meaning);
        }
    }

    fn loads(&mut self) {
        let scene = self.scene;
        for (k, load) in scene.loads.iter().enumerate() {
            let description = match load.kind {
                // It has its column beside the tooth force, and does no work.
                LoadKind::SeparatingForce(_) => continue,
                LoadKind::Gravity { .. } => None,
                LoadKind::Force { .. } => Some(("N", "force along its direction")),
                LoadKind::Torque { .. } => Some(("N m", "moment on the second body")),
                LoadKind::Spring { .. }
                | LoadKind::Damper { .. }
                | LoadKind::PointToPointForce { .. } => {
                    Some(("N", "force between the points; positive pushes them apart"))
                }
                LoadKind::TorsionSpring { .. } | LoadKind::RotationalDamper { .. } => {
                    Some(("N m", "moment of the first body on the second"))
                }
                LoadKind::SlideForce(_) | LoadKind::SlideDamper(_) => Some((
                    "N",
                    "force along the slide, of the first body on the second",
                )),
            };
            let is_drive = scene.drives.iter().any(|drive| drive.name == load.name);
            self.list.add_load(k, &load.name, description, is_drive);
        }
    }

    fn totals(&mut self) {
        let mechanism = &self.scene.mechanism;
        let ground = mechanism.body_name(BodyId(mechanism.ground));
        let components = [("fx", "N"), ("fy", "N"), ("moment", "N m")];
        self.list.add_totals(ground, &components);
    }
}

/// The meaning of a component of a joint's reaction.
fn reaction_meaning(kind: JointKind, component: Component, one: &str, two: &str) -> String {
    use Component as C;
    let on = format!("of {one} on {two}");
    match (component, kind) {
        (C::X | C::Y, _) => format!("force {on}, ground's axes"),
        (C::Normal, _) => {
            format!("force {on} along the axis of {one} rotated by +90°, at the point of {two}")
        }
        (C::Moment, JointKind::Coupling(_)) => format!("moment {on} that enforces the coupling"),
        (C::Moment, _) => format!("moment {on}, about the joint's point of {two}"),
        (C::Tooth, JointKind::Rack { .. }) => format!("tooth force {on} along the rack"),
        (C::Tooth, _) => {
            format!("tooth force {on} at the pitch point; positive rotates {two} counter-clockwise")
        }
        (C::Tangent, _) => format!("force {on} along the track at the contact"),
        (C::Axial, _) => {
            "force in the link; positive in compression (pushes its ends apart)".to_owned()
        }
        (C::Force, _) => format!("force {on} that enforces the coupling"),
    }
}
