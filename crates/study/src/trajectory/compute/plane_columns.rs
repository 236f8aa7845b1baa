//! The columns of scenes in the plane that differ from those in space: those of bodies, joints and loads.

use crate::trajectory::compute::{ColumnList, Quantity, dyads};
use dwell_geometry::{ActuatorKind, BodyId, Component, JointId, JointKind, Plan, Reaction};
use dwell_kinetostatics::{Load, LoadShape as _};
use dwell_scene::PlaneScene;

/// The meanings of an actuator's coordinate and of its force.
pub(super) fn actuator_meanings(scene: &PlaneScene, actuator: usize) -> [String; 2] {
    let mechanism = &scene.mechanism;
    let actuator = &mechanism.actuators[actuator];
    let [one, two] = actuator.bodies.map(|b| mechanism.body_name(b));
    match actuator.kind {
        ActuatorKind::Angle => [
            format!("angle of {two} from {one}"),
            format!("moment of {one} on {two}"),
        ],
        ActuatorKind::Travel(joint) => [
            format!("travel of {}", mechanism.joints[joint.0].name),
            format!("force of {one} on {two} along the travel"),
        ],
        ActuatorKind::Length(_) => [
            format!("distance of points of {one} and {two}"),
            "force between the points; positive pushes them apart".to_owned(),
        ],
    }
}

/// Collects columns.
pub(super) struct PlaneColumns<'a> {
    pub(super) scene: &'a PlaneScene,
    pub(super) plan: &'a Plan,
    pub(super) list: &'a mut ColumnList,
}

impl PlaneColumns<'_> {
    /// Adds the velocity ratio of a body, and, on request, its mechanical advantages and its poles.
    pub(super) fn body(&mut self, id: BodyId) {
        let mechanism = &self.scene.mechanism;
        if self.plan.actuators() == 1 {
            let meaning = format!("velocity ratio dθ/d{}", mechanism.actuators[0].name);
            let unit = if self.plan.is_angle(0) { "" } else { "rad/m" };
            let name = format!("{}.velocity_ratio", mechanism.body_name(id));
            self.list
                .add(name, unit, Quantity::VelocityRatio(id), meaning);
            self.mechanical_advantages(id);
        }
        self.poles(id);
    }

    /// On request: mechanical advantage of a body and its points.
    fn mechanical_advantages(&mut self, body: BodyId) {
        let scene = self.scene;
        let name = scene.mechanism.body_name(body);
        let force = format!("{}.actuator_force", scene.mechanism.actuators[0].name);
        let [of_rotation, of_travel] = if self.plan.is_angle(0) {
            ["", "1/m"]
        } else {
            ["m", ""]
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

    pub(super) fn dyads(&mut self) {
        let mechanism = &self.scene.mechanism;
        for (joint, dyad) in dyads(mechanism, self.plan) {
            let name = format!("{}.transmission_angle", mechanism.joints[joint.0].name);
            let quantity = Quantity::TransmissionAngle(dyad);
            self.list.add(name, "rad", quantity, dyad.meaning());
        }
    }

    pub(super) fn reactions(&mut self, reactions: &[Reaction]) {
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
    pub(super) fn known_reactions(&mut self) {
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

    /// Adds the separating force of teeth.
    fn separating_force(&mut self, joint: JointId) {
        let mut loads = self.scene.loads.iter();
        let is_of_joint = |load: &Load| load.pressure_angle().is_some_and(|p| p.joint == joint);
        if let Some(k) = loads.position(is_of_joint) {
            let meaning = "separating force: |tooth force| × tan(pressure angle), pushes the two bodies apart at the pitch point";
            let name = self.scene.loads[k].name.clone();
            self.list.add(name, "N", Quantity::LoadForce(k), meaning);
        }
    }

    pub(super) fn loads(&mut self) {
        let scene = self.scene;
        for (k, load) in scene.loads.iter().enumerate() {
            // It has its column beside the tooth force, and does no work.
            if !load.does_work() {
                continue;
            }
            let meaning = load.kind.meaning();
            let description = meaning.map(|meaning| (load.kind.force_unit(), meaning));
            let is_drive = scene.drives.iter().any(|drive| drive.name == load.name);
            self.list.add_load(k, &load.name, description, is_drive);
        }
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
