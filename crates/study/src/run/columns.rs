//! The columns of a table: everything that can be told of a mechanism, each with its unit and meaning.

use crate::run::Command;
use crate::run::dyads::{Dyad, dyads};
use crate::run::select::stands_for;
use dwell_geometry::measure::Measured;
use dwell_geometry::{BodyId, Component, Drive, JointId, JointKind, Plan, Reaction, Vec2};
use dwell_kinetostatics::{LoadKind, Model};
use dwell_scene::Scene;

/// What a column holds. An order is 0 for a position, 1 for its speed, 2 for its acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Quantity {
    Time,
    Drive(usize, usize),
    Action(usize),
    Measured(Measured, usize),
    Angle(BodyId, usize),
    /// dθ/dq of a body.
    Ratio(BodyId),
    /// dq/dθ of a body, dq/ds of a point along its path.
    Advantage(BodyId, Option<Vec2>),
    /// x and y of where a body has no velocity (order 1) or no acceleration (order 2).
    Pole(BodyId, usize, usize),
    /// x, y, then their speeds, then their accelerations.
    Point(BodyId, Vec2, usize),
    Transmission(Dyad),
    Reaction(usize),
    /// The force of a joint along an axis (0 or 1) of a body.
    ForceIn(JointId, BodyId, usize),
    Magnitude(JointId),
    Direction(JointId),
    /// Force x, y and moment on the frame.
    Frame(usize),
    Balance(Term),
    Load(usize),
    LoadPower(usize),
}

/// A term of the power balance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Term {
    Actuators,
    Loads,
    Kinetic,
    Residual,
    Energy,
}

/// A column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Column {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    pub(crate) quantity: Quantity,
    /// What it means, where the name alone does not say.
    pub(crate) meaning: String,
}

impl Quantity {
    /// The bodies that it is measured on: where they are not placed, it has no value.
    pub(crate) fn bodies(self, scene: &Scene, reactions: &[Reaction]) -> Vec<BodyId> {
        let joint = |j: JointId| scene.mechanism.joints[j.0].bodies.to_vec();
        match self {
            Self::Measured(
                Measured::Angle(bodies)
                | Measured::Travel { bodies, .. }
                | Measured::Length { bodies, .. },
                _,
            ) => bodies.to_vec(),
            Self::Angle(body, _)
            | Self::Ratio(body)
            | Self::Advantage(body, _)
            | Self::Pole(body, ..)
            | Self::Point(body, ..) => vec![body],
            Self::Transmission(dyad) => dyad.bodies().to_vec(),
            Self::Reaction(k) => joint(reactions[k].joint),
            Self::ForceIn(j, ..) | Self::Magnitude(j) | Self::Direction(j) => joint(j),
            // What the actuators and the loads act on is placed anyway, or does not move them.
            Self::Time
            | Self::Drive(..)
            | Self::Action(_)
            | Self::Frame(_)
            | Self::Balance(_)
            | Self::Load(_)
            | Self::LoadPower(_) => Vec::new(),
        }
    }
}

impl Column {
    /// Whether a name asks for it: its own, or the first part of it. What has no value in some
    /// positions is told only where it is meant: a body's name does not ask for its pole.
    pub(crate) fn answers_to(&self, name: &str) -> bool {
        let last = match self.quantity {
            Quantity::Advantage(..) => 0,
            Quantity::Pole(..) => ".x".len(),
            _ => self.name.len(),
        };
        stands_for(name, &self.name) && name.len() + last >= self.name.len()
    }

    /// Whether it is told only where it is asked for.
    pub(crate) fn is_optional(&self) -> bool {
        matches!(self.quantity, Quantity::Advantage(..) | Quantity::Pole(..))
    }

    /// Whether it is an angle that is followed over whole turns.
    pub(crate) fn unwraps(&self) -> bool {
        matches!(
            self.quantity,
            Quantity::Angle(_, 0) | Quantity::Measured(Measured::Angle(_), 0)
        )
    }

    /// Whether a command computes it.
    pub(crate) fn is_of(&self, command: Command) -> bool {
        let forces = command != Command::Kinematics;
        let moves = command != Command::Statics;
        match self.quantity {
            Quantity::Time => true,
            Quantity::Drive(_, order)
            | Quantity::Measured(_, order)
            | Quantity::Angle(_, order) => order == 0 || moves,
            Quantity::Point(_, _, k) => k < 2 || moves,
            Quantity::Ratio(_) | Quantity::Advantage(..) | Quantity::Transmission(_) => true,
            Quantity::Pole(..) => moves,
            Quantity::Action(_)
            | Quantity::Reaction(_)
            | Quantity::ForceIn(..)
            | Quantity::Magnitude(_)
            | Quantity::Direction(_)
            | Quantity::Frame(_)
            | Quantity::Load(_) => forces,
            Quantity::Balance(_) | Quantity::LoadPower(_) => forces && moves,
        }
    }
}

const ANGLE: [&str; 3] = ["rad", "rad/s", "rad/s2"];
const LENGTH: [&str; 3] = ["m", "m/s", "m/s2"];
const ORDERS: [&str; 3] = ["", ".speed", ".acceleration"];

/// Every column of a scene, whatever the command.
pub(crate) struct Columns {
    list: Vec<Column>,
}

impl Columns {
    /// Every column; `timed` where the time passes.
    pub(crate) fn all(scene: &Scene, model: &Model, timed: bool) -> Vec<Column> {
        let mut columns = Self { list: Vec::new() };
        if timed {
            columns.add("t", "s", Quantity::Time, "");
        }
        columns.drives(scene, model.plan());
        columns.coordinates(scene);
        columns.bodies(scene, model.plan());
        columns.dyads(scene, model.plan());
        columns.reactions(scene, model);
        columns.loads(scene);
        columns.wholes(scene);
        columns.list
    }

    fn add(
        &mut self,
        name: impl Into<String>,
        unit: &'static str,
        quantity: Quantity,
        meaning: impl Into<String>,
    ) {
        self.list.push(Column {
            name: name.into(),
            unit,
            quantity,
            meaning: meaning.into(),
        });
    }

    /// A quantity with its speed and its acceleration.
    fn three(
        &mut self,
        name: &str,
        units: [&'static str; 3],
        quantity: impl Fn(usize) -> Quantity,
        meaning: &str,
    ) {
        for order in 0..3 {
            let meaning = if order == 0 { meaning } else { "" };
            let name = format!("{name}{}", ORDERS[order]);
            self.add(name, units[order], quantity(order), meaning);
        }
    }

    fn drives(&mut self, scene: &Scene, plan: &Plan) {
        for (i, actuator) in scene.mechanism.actuators.iter().enumerate() {
            let [one, two] = actuator.bodies.map(|b| scene.mechanism.body_name(b));
            let (units, unit, meaning) = match actuator.drive {
                Drive::Angle => (ANGLE, "N m", format!("angle of {two} from {one}")),
                Drive::Travel(joint) => {
                    let joint = &scene.mechanism.joints[joint.0].name;
                    (LENGTH, "N", format!("travel of {joint}"))
                }
                Drive::Length(_) => (
                    LENGTH,
                    "N",
                    format!("distance of points of {one} and {two}"),
                ),
            };
            debug_assert_eq!(plan.is_angle(i), unit == "N m");
            self.three(&actuator.name, units, |k| Quantity::Drive(i, k), &meaning);
            let name = format!("{}.action", actuator.name);
            let meaning = match actuator.drive {
                Drive::Angle => format!("couple of {one} on {two}"),
                Drive::Travel(_) => format!("force of {one} on {two} along the travel"),
                Drive::Length(_) => {
                    "force between the points; positive pushes them apart".to_owned()
                }
            };
            self.add(name, unit, Quantity::Action(i), meaning);
        }
    }

    fn coordinates(&mut self, scene: &Scene) {
        for named in &scene.coordinates {
            if let Some(measured) = Measured::find(&scene.mechanism, named.coordinate) {
                let units = if named.coordinate.is_angle() {
                    ANGLE
                } else {
                    LENGTH
                };
                self.three(&named.name, units, |k| Quantity::Measured(measured, k), "");
            }
        }
        let coordinate = |j| dwell_geometry::Coordinate::Travel(JointId(j));
        for (j, joint) in scene.mechanism.joints.iter().enumerate() {
            if let Some(measured) = Measured::find(&scene.mechanism, coordinate(j)) {
                let [one, two] = joint.bodies.map(|b| scene.mechanism.body_name(b));
                let meaning =
                    format!("of the point of {two} from that of {one}, along the axis in {one}");
                let name = format!("{}.travel", joint.name);
                self.three(&name, LENGTH, |k| Quantity::Measured(measured, k), &meaning);
            }
        }
    }

    fn bodies(&mut self, scene: &Scene, plan: &Plan) {
        let mechanism = &scene.mechanism;
        for (b, body) in mechanism.bodies.iter().enumerate() {
            if b == mechanism.ground {
                continue;
            }
            let (id, name) = (BodyId(b), &body.name);
            for (order, word) in ["angle", "speed", "acceleration"].into_iter().enumerate() {
                let meaning = match order {
                    0 => "of its frame from the ground's, whole turns counted along the way",
                    _ => "angular",
                };
                let name = format!("{name}.{word}");
                self.add(name, ANGLE[order], Quantity::Angle(id, order), meaning);
            }
            if plan.actuators() == 1 {
                let q = &mechanism.actuators[0].name;
                let unit = if plan.is_angle(0) { "" } else { "rad/m" };
                let meaning = format!("change of its angle with {q}: the velocity ratio");
                self.add(format!("{name}.ratio"), unit, Quantity::Ratio(id), meaning);
            }
            self.leverage(scene, plan, id);
            for (point, at) in &scene.points[b] {
                let parts = ["x", "y", "vx", "vy", "ax", "ay"];
                for (k, part) in parts.into_iter().enumerate() {
                    let name = format!("{name}.{point}.{part}");
                    self.add(name, LENGTH[k / 2], Quantity::Point(id, *at, k), "");
                }
            }
        }
    }

    /// What is told on request: mechanical advantage of a body and its points, and its poles.
    fn leverage(&mut self, scene: &Scene, plan: &Plan, body: BodyId) {
        let name = scene.mechanism.body_name(body);
        let points = &scene.points[body.0];
        if plan.actuators() == 1 {
            let action = format!("{}.action", scene.mechanism.actuators[0].name);
            let [turns, travels] = if plan.is_angle(0) {
                ["", "1/m"]
            } else {
                ["m", ""]
            };
            let meaning = format!(
                "couple of {name} on what resists it, for each unit of {action} and without inertia and other \
                 loads: dq/dθ; empty where {name} does not turn"
            );
            let quantity = Quantity::Advantage(body, None);
            self.add(format!("{name}.advantage"), turns, quantity, meaning);
            for (point, at) in points {
                let meaning = format!(
                    "force on what resists {point} along its path, for each unit of {action} and without inertia \
                     and other loads: dq/ds; empty where it stands still"
                );
                let quantity = Quantity::Advantage(body, Some(*at));
                let name = format!("{name}.{point}.advantage");
                self.add(name, travels, quantity, meaning);
            }
        }
        for (order, pole, what) in [
            (1, "pole", "velocity"),
            (2, "acceleration-pole", "acceleration"),
        ] {
            // A point of that name is what its name says.
            if points.iter().any(|(point, _)| point == pole) {
                continue;
            }
            for (axis, letter) in ["x", "y"].into_iter().enumerate() {
                let meaning = format!(
                    "where {name} has no {what}, in the ground's frame; empty where it does not turn"
                );
                let quantity = Quantity::Pole(body, order, axis);
                self.add(format!("{name}.{pole}.{letter}"), "m", quantity, meaning);
            }
        }
    }

    fn dyads(&mut self, scene: &Scene, plan: &Plan) {
        for (joint, dyad) in dyads(&scene.mechanism, plan) {
            let name = format!("{}.transmission", scene.mechanism.joints[joint.0].name);
            self.add(name, "rad", Quantity::Transmission(dyad), dyad.meaning());
        }
    }

    fn reactions(&mut self, scene: &Scene, model: &Model) {
        let mechanism = &scene.mechanism;
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let id = JointId(j);
            let [one, two] = joint.bodies.map(|b| mechanism.body_name(b));
            for &component in mechanism.components(id) {
                let reaction = dwell_geometry::Reaction {
                    joint: id,
                    component,
                };
                let Some(k) = model.reactions().iter().position(|&r| r == reaction) else {
                    continue;
                };
                // What the loads do not determine is no result.
                if !model.plan().is_unique(k) {
                    continue;
                }
                let meaning = meaning(joint.kind, component, one, two);
                let name = mechanism.reaction_name(reaction);
                self.add(name, component.unit(), Quantity::Reaction(k), meaning);
            }
            use JointKind::{Prismatic, Revolute, Rolling, Slot, Weld};
            if !determined(model, id) {
                continue;
            }
            if matches!(joint.kind, Revolute | Weld { .. }) {
                for body in joint.bodies.into_iter().filter(|b| b.0 != mechanism.ground) {
                    for (axis, letter) in ["x", "y"].into_iter().enumerate() {
                        let name = format!("{}.{letter}@{}", joint.name, mechanism.body_name(body));
                        let quantity = Quantity::ForceIn(id, body, axis);
                        let of = mechanism.body_name(body);
                        let meaning =
                            format!("force of {one} on {two} along the {letter} axis of {of}");
                        self.add(name, "N", quantity, meaning);
                    }
                }
            }
            if matches!(
                joint.kind,
                Revolute | Weld { .. } | Prismatic { .. } | Slot { .. } | Rolling { .. }
            ) {
                let name = |word| format!("{}.{word}", joint.name);
                let meaning = format!("of the force of {one} on {two}");
                self.add(name("magnitude"), "N", Quantity::Magnitude(id), meaning);
                let meaning = format!("of the force of {one} on {two}, from the ground's x axis");
                self.add(name("direction"), "rad", Quantity::Direction(id), meaning);
            }
        }
    }

    fn loads(&mut self, scene: &Scene) {
        for (k, load) in scene.loads.iter().enumerate() {
            let told = match load.kind {
                LoadKind::Gravity { .. } => None,
                LoadKind::Force { .. } => Some(("N", "the force along its direction")),
                LoadKind::Torque { .. } => Some(("N m", "the couple on the second body")),
                LoadKind::Spring { .. } | LoadKind::Damper { .. } | LoadKind::Push { .. } => {
                    Some(("N", "force between the points; positive pushes them apart"))
                }
                LoadKind::TorsionSpring { .. } | LoadKind::TorsionDamper { .. } => {
                    Some(("N m", "couple of the first body on the second"))
                }
                LoadKind::Slide(_) | LoadKind::SlideDamper(_) => Some((
                    "N",
                    "force along the slide, of the first body on the second",
                )),
            };
            if let Some((unit, meaning)) = told {
                let name = format!("{}.load", load.name);
                self.add(name, unit, Quantity::Load(k), meaning);
            }
            let name = format!("{}.power", load.name);
            self.add(
                name,
                "W",
                Quantity::LoadPower(k),
                "of the load, on all bodies",
            );
        }
    }

    fn wholes(&mut self, scene: &Scene) {
        let ground = scene.mechanism.body_name(BodyId(scene.mechanism.ground));
        let meaning = format!(
            "of all that joints, actuators and loads do to {ground}: the shaking force; the moment is about its origin"
        );
        for (k, (name, unit)) in [("fx", "N"), ("fy", "N"), ("m", "N m")]
            .into_iter()
            .enumerate()
        {
            self.add(format!("frame.{name}"), unit, Quantity::Frame(k), &*meaning);
        }
        for (name, unit, term, meaning) in [
            ("actuators", "W", Term::Actuators, "power of the actuators"),
            ("loads", "W", Term::Loads, "power of the loads"),
            ("dE/dt", "W", Term::Kinetic, "rate of the kinetic energy"),
            (
                "residual",
                "W",
                Term::Residual,
                "actuators + loads − dE/dt: rounding",
            ),
            ("energy", "J", Term::Energy, "kinetic energy"),
        ] {
            self.add(
                format!("balance.{name}"),
                unit,
                Quantity::Balance(term),
                meaning,
            );
        }
    }
}

/// What a component of a joint's reaction is.
fn meaning(kind: JointKind, component: dwell_geometry::Component, one: &str, two: &str) -> String {
    use dwell_geometry::Component as C;
    let on = format!("of {one} on {two}");
    match (component, kind) {
        (C::X | C::Y, _) => format!("force {on}, ground's axes"),
        (C::Normal, _) => {
            format!("force {on} along the axis of {one} turned +90°, at the point of {two}")
        }
        (C::Moment, JointKind::Relation(_)) => format!("couple {on} that keeps the relation"),
        (C::Moment, _) => format!("couple {on}, about the joint's point of {two}"),
        (C::Tooth, JointKind::Rack { .. }) => format!("tooth force {on} along the rack"),
        (C::Tooth, _) => {
            format!("tooth force {on} at the pitch point; positive turns {two} counter-clockwise")
        }
        (C::Tangent, _) => format!("force {on} along the track at the contact"),
        (C::Axial, _) => "force of the link; positive pushes its ends apart".to_owned(),
        (C::Force, _) => format!("force {on} that keeps the relation"),
    }
}

/// Whether the loads determine every force of a joint.
fn determined(model: &Model, joint: JointId) -> bool {
    let reactions = model.reactions().iter().enumerate();
    let mut forces =
        reactions.filter(|(_, r)| r.joint == joint && r.component != Component::Moment);
    forces.all(|(k, _)| model.plan().is_unique(k))
}
