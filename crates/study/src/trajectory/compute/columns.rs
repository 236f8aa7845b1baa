//! The columns of a trajectory table, each with its unit and meaning.

use crate::former_names::former_column;
use crate::trajectory::compute::{Analysis, Dyad, dyads};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{ActuatorKind, BodyId, Component, JointId, JointKind, Plan, Reaction, Vec2};
use dwell_kinetostatics::{Load, LoadKind, Model};
use dwell_scene::Scene;
use std::collections::HashSet;

/// Whether a name selects a column: its full name, or a prefix up to a dot.
pub(crate) fn is_prefix_of(name: &str, column: &str) -> bool {
    column
        .strip_prefix(name)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// The quantity of a column. An order is 0 for a position, 1 for its velocity, 2 for its acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ColumnQuantity {
    Time,
    ActuatorCoordinate(usize, usize),
    ActuatorForce(usize),
    Measured(CoordinateFunction, usize),
    BodyAngle(BodyId, usize),
    /// dθ/dq of a body.
    VelocityRatio(BodyId),
    /// dq/dθ of a body, dq/ds of a point along its path.
    MechanicalAdvantage(BodyId, Option<Vec2>),
    /// x and y of where a body has no velocity (order 1) or no acceleration (order 2).
    Pole(BodyId, usize, usize),
    /// x, y, then their speeds, then their accelerations.
    PointCoordinate(BodyId, Vec2, usize),
    TransmissionAngle(Dyad),
    Reaction(usize),
    /// The force of a joint along an axis (0 or 1) of a body.
    BodyFrameForce(JointId, BodyId, usize),
    ForceMagnitude(JointId),
    ForceDirection(JointId),
    /// Force x, y and moment on the frame.
    ShakingForce(usize),
    Power(PowerTerm),
    LoadForce(usize),
    LoadPower(usize),
    /// A column of a free motion's integration, by its index among the [`ExtraColumn`]s.
    Extra(usize),
}

/// A term of the power balance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PowerTerm {
    Actuators,
    Loads,
    KineticRate,
    Residual,
    KineticEnergy,
}

/// A column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Column {
    pub(crate) name: String,
    /// The name it had before it was renamed, unless another column has that name now.
    pub(crate) former: Option<String>,
    pub(crate) unit: &'static str,
    pub(crate) quantity: ColumnQuantity,
    /// Its meaning, where the name alone does not say.
    pub(crate) meaning: String,
}

impl ColumnQuantity {
    /// The bodies that it depends on: if they are not modelled, it has no value.
    pub(crate) fn bodies(self, scene: &Scene, reactions: &[Reaction]) -> Vec<BodyId> {
        let joint = |j: JointId| scene.mechanism.joints[j.0].bodies.to_vec();
        match self {
            Self::Measured(
                CoordinateFunction::Angle(bodies)
                | CoordinateFunction::Travel { bodies, .. }
                | CoordinateFunction::Length { bodies, .. },
                _,
            ) => bodies.to_vec(),
            Self::BodyAngle(body, _)
            | Self::VelocityRatio(body)
            | Self::MechanicalAdvantage(body, _)
            | Self::Pole(body, ..)
            | Self::PointCoordinate(body, ..) => vec![body],
            Self::TransmissionAngle(dyad) => dyad.bodies().to_vec(),
            Self::Reaction(k) => joint(reactions[k].joint),
            Self::BodyFrameForce(j, ..) | Self::ForceMagnitude(j) | Self::ForceDirection(j) => {
                joint(j)
            }
            // What the actuators and the loads act on is placed anyway, or does not move them.
            Self::Time
            | Self::ActuatorCoordinate(..)
            | Self::ActuatorForce(_)
            | Self::ShakingForce(_)
            | Self::Power(_)
            | Self::LoadForce(_)
            | Self::LoadPower(_)
            | Self::Extra(_) => Vec::new(),
        }
    }
}

impl Column {
    /// Whether `request` asks for it: by its name, the first part of it, or its former name.
    pub(crate) fn matches(&self, request: &str) -> bool {
        self.names_it(request, &self.name) || self.matches_former(request)
    }

    /// Whether `request` asks for it by its former name.
    pub(crate) fn matches_former(&self, request: &str) -> bool {
        let former = self.former.as_deref();
        former.is_some_and(|former| {
            self.names_it(request, former) && !self.names_it(request, &self.name)
        })
    }

    /// Whether `request` is `name` or the first part of it. A column that has no value in some positions must be
    /// named itself: a body's name does not ask for its pole.
    fn names_it(&self, request: &str, name: &str) -> bool {
        let optional_suffix = match self.quantity {
            ColumnQuantity::MechanicalAdvantage(..) => 0,
            ColumnQuantity::Pole(..) => ".x".len(),
            _ => name.len(),
        };
        is_prefix_of(request, name) && request.len() + optional_suffix >= name.len()
    }

    /// Whether it is computed only on request.
    pub(crate) fn is_optional(&self) -> bool {
        matches!(
            self.quantity,
            ColumnQuantity::MechanicalAdvantage(..) | ColumnQuantity::Pole(..)
        )
    }

    /// Whether it is an angle that is unwrapped along the trajectory.
    pub(crate) fn unwraps(&self) -> bool {
        matches!(
            self.quantity,
            ColumnQuantity::BodyAngle(_, 0)
                | ColumnQuantity::Measured(CoordinateFunction::Angle(_), 0)
        )
    }

    /// Whether an analysis computes it.
    pub(crate) fn is_computed_by(&self, analysis: Analysis) -> bool {
        let forces = analysis != Analysis::Kinematics;
        let moves = analysis != Analysis::Statics;
        match self.quantity {
            ColumnQuantity::Time => true,
            ColumnQuantity::ActuatorCoordinate(_, order)
            | ColumnQuantity::Measured(_, order)
            | ColumnQuantity::BodyAngle(_, order) => order == 0 || moves,
            ColumnQuantity::PointCoordinate(_, _, k) => k < 2 || moves,
            ColumnQuantity::VelocityRatio(_)
            | ColumnQuantity::MechanicalAdvantage(..)
            | ColumnQuantity::TransmissionAngle(_) => analysis != Analysis::FreeMotion,
            ColumnQuantity::Extra(_) => analysis == Analysis::FreeMotion,
            ColumnQuantity::Pole(..) => moves,
            ColumnQuantity::ActuatorForce(_)
            | ColumnQuantity::Reaction(_)
            | ColumnQuantity::BodyFrameForce(..)
            | ColumnQuantity::ForceMagnitude(_)
            | ColumnQuantity::ForceDirection(_)
            | ColumnQuantity::ShakingForce(_)
            | ColumnQuantity::LoadForce(_) => forces,
            ColumnQuantity::Power(_) | ColumnQuantity::LoadPower(_) => forces && moves,
        }
    }
}

const ANGLE: [&str; 3] = ["rad", "rad/s", "rad/s2"];
const LENGTH: [&str; 3] = ["m", "m/s", "m/s2"];
const DERIVATIVE_SUFFIXES: [&str; 3] = ["", ".velocity", ".acceleration"];

/// Collects every column of a scene, whatever the analysis.
pub(crate) struct Columns {
    list: Vec<Column>,
}

impl Columns {
    /// Every column; with the time if `timed`.
    pub(crate) fn all(scene: &Scene, model: &Model, timed: bool) -> Vec<Column> {
        let mut columns = Self { list: Vec::new() };
        if timed {
            columns.add("t", "s", ColumnQuantity::Time, "");
        }
        columns.actuators(scene, model.plan());
        columns.coordinates(scene);
        columns.bodies(scene, model.plan());
        columns.dyads(scene, model.plan());
        columns.reactions(scene, model);
        columns.loads(scene);
        columns.totals(scene);
        let names: HashSet<String> = columns.list.iter().map(|c| c.name.clone()).collect();
        for column in &mut columns.list {
            column.former = former_column(&column.name).filter(|name| !names.contains(name));
        }
        columns.list
    }

    fn add(
        &mut self,
        name: impl Into<String>,
        unit: &'static str,
        quantity: ColumnQuantity,
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

    /// A quantity with its velocity and its acceleration.
    fn add_with_derivatives(
        &mut self,
        name: &str,
        units: [&'static str; 3],
        quantity: impl Fn(usize) -> ColumnQuantity,
        meaning: &str,
    ) {
        for order in 0..3 {
            let meaning = if order == 0 { meaning } else { "" };
            let name = format!("{name}{}", DERIVATIVE_SUFFIXES[order]);
            self.add(name, units[order], quantity(order), meaning);
        }
    }

    fn actuators(&mut self, scene: &Scene, plan: &Plan) {
        for (i, actuator) in scene.mechanism.actuators.iter().enumerate() {
            let [one, two] = actuator.bodies.map(|b| scene.mechanism.body_name(b));
            let (units, unit, meaning) = match actuator.kind {
                ActuatorKind::Angle => (ANGLE, "N m", format!("angle of {two} from {one}")),
                ActuatorKind::Travel(joint) => {
                    let joint = &scene.mechanism.joints[joint.0].name;
                    (LENGTH, "N", format!("travel of {joint}"))
                }
                ActuatorKind::Length(_) => (
                    LENGTH,
                    "N",
                    format!("distance of points of {one} and {two}"),
                ),
            };
            debug_assert_eq!(plan.is_angle(i), unit == "N m");
            self.add_with_derivatives(
                &actuator.name,
                units,
                |k| ColumnQuantity::ActuatorCoordinate(i, k),
                &meaning,
            );
            let name = format!("{}.actuator_force", actuator.name);
            let meaning = match actuator.kind {
                ActuatorKind::Angle => format!("moment of {one} on {two}"),
                ActuatorKind::Travel(_) => format!("force of {one} on {two} along the travel"),
                ActuatorKind::Length(_) => {
                    "force between the points; positive pushes them apart".to_owned()
                }
            };
            self.add(name, unit, ColumnQuantity::ActuatorForce(i), meaning);
        }
    }

    fn coordinates(&mut self, scene: &Scene) {
        for named in &scene.coordinates {
            if let Some(measured) = CoordinateFunction::find(&scene.mechanism, named.coordinate) {
                let units = if named.coordinate.is_angle() {
                    ANGLE
                } else {
                    LENGTH
                };
                self.add_with_derivatives(
                    &named.name,
                    units,
                    |k| ColumnQuantity::Measured(measured, k),
                    "",
                );
            }
        }
        let coordinate = |j| dwell_geometry::Coordinate::Travel(JointId(j));
        for (j, joint) in scene.mechanism.joints.iter().enumerate() {
            if let Some(measured) = CoordinateFunction::find(&scene.mechanism, coordinate(j)) {
                let [one, two] = joint.bodies.map(|b| scene.mechanism.body_name(b));
                let meaning = format!(
                    "position of the point of {two} from that of {one}, along the axis in {one}"
                );
                let name = format!("{}.travel", joint.name);
                self.add_with_derivatives(
                    &name,
                    LENGTH,
                    |k| ColumnQuantity::Measured(measured, k),
                    &meaning,
                );
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
            for (order, word) in ["angle", "angular_velocity", "angular_acceleration"]
                .into_iter()
                .enumerate()
            {
                let meaning = match order {
                    0 => {
                        "angle of the body frame from the ground frame, unwrapped along the trajectory"
                    }
                    1 => "angular velocity",
                    _ => "angular acceleration",
                };
                let name = format!("{name}.{word}");
                self.add(
                    name,
                    ANGLE[order],
                    ColumnQuantity::BodyAngle(id, order),
                    meaning,
                );
            }
            if plan.actuators() == 1 {
                let q = &mechanism.actuators[0].name;
                let unit = if plan.is_angle(0) { "" } else { "rad/m" };
                let meaning = format!("velocity ratio dθ/d{q}");
                self.add(
                    format!("{name}.velocity_ratio"),
                    unit,
                    ColumnQuantity::VelocityRatio(id),
                    meaning,
                );
            }
            self.advantages_and_poles(scene, plan, id);
            for (point, at) in &scene.points[b] {
                let parts = ["x", "y", "vx", "vy", "ax", "ay"];
                for (k, part) in parts.into_iter().enumerate() {
                    let name = format!("{name}.{point}.{part}");
                    self.add(
                        name,
                        LENGTH[k / 2],
                        ColumnQuantity::PointCoordinate(id, *at, k),
                        "",
                    );
                }
            }
        }
    }

    /// Columns on request: mechanical advantage of a body and its points, and its poles.
    fn advantages_and_poles(&mut self, scene: &Scene, plan: &Plan, body: BodyId) {
        let name = scene.mechanism.body_name(body);
        let points = &scene.points[body.0];
        if plan.actuators() == 1 {
            let actuator_force = format!("{}.actuator_force", scene.mechanism.actuators[0].name);
            let [rotation_unit, travel_unit] = if plan.is_angle(0) {
                ["", "1/m"]
            } else {
                ["m", ""]
            };
            let meaning = format!(
                "mechanical advantage dq/dθ: output moment of {name} per unit of {actuator_force}, statically and \
                 without other loads; empty where {name} does not rotate"
            );
            let quantity = ColumnQuantity::MechanicalAdvantage(body, None);
            self.add(
                format!("{name}.mechanical_advantage"),
                rotation_unit,
                quantity,
                meaning,
            );
            for (point, at) in points {
                let meaning = format!(
                    "mechanical advantage dq/ds: output force at {point} along its path per unit of {actuator_force}, \
                     statically and without other loads; empty where the point is at rest"
                );
                let quantity = ColumnQuantity::MechanicalAdvantage(body, Some(*at));
                let name = format!("{name}.{point}.mechanical_advantage");
                self.add(name, travel_unit, quantity, meaning);
            }
        }
        for (order, pole, what) in [
            (1, "velocity_pole", "velocity"),
            (2, "acceleration_pole", "acceleration"),
        ] {
            // A point of the scene with that name takes precedence.
            if points.iter().any(|(point, _)| point == pole) {
                continue;
            }
            for (axis, letter) in ["x", "y"].into_iter().enumerate() {
                let meaning = format!(
                    "point of {name} with zero {what}, in the ground frame; empty where {name} does not rotate"
                );
                let quantity = ColumnQuantity::Pole(body, order, axis);
                self.add(format!("{name}.{pole}.{letter}"), "m", quantity, meaning);
            }
        }
    }

    fn dyads(&mut self, scene: &Scene, plan: &Plan) {
        for (joint, dyad) in dyads(&scene.mechanism, plan) {
            let name = format!(
                "{}.transmission_angle",
                scene.mechanism.joints[joint.0].name
            );
            self.add(
                name,
                "rad",
                ColumnQuantity::TransmissionAngle(dyad),
                dyad.meaning(),
            );
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
                // Statically indeterminate reactions are no results.
                if !model.plan().is_determinate(k) {
                    continue;
                }
                let meaning = reaction_meaning(joint.kind, component, one, two);
                let name = mechanism.reaction_name(reaction);
                self.add(name, component.unit(), ColumnQuantity::Reaction(k), meaning);
            }
            self.separating_force(scene, id);
            use JointKind::{Prismatic, Revolute, Rolling, Slot, Weld};
            if !is_determinate(model, id) {
                continue;
            }
            if matches!(joint.kind, Revolute | Weld { .. }) {
                for body in joint.bodies.into_iter().filter(|b| b.0 != mechanism.ground) {
                    for (axis, letter) in ["x", "y"].into_iter().enumerate() {
                        let name = format!("{}.{letter}@{}", joint.name, mechanism.body_name(body));
                        let quantity = ColumnQuantity::BodyFrameForce(id, body, axis);
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
                let meaning = format!("magnitude of the force of {one} on {two}");
                self.add(
                    name("magnitude"),
                    "N",
                    ColumnQuantity::ForceMagnitude(id),
                    meaning,
                );
                let meaning =
                    format!("direction of the force of {one} on {two}, from the ground's x axis");
                self.add(
                    name("direction"),
                    "rad",
                    ColumnQuantity::ForceDirection(id),
                    meaning,
                );
            }
        }
    }

    /// The separating force of teeth, beside their tooth force.
    fn separating_force(&mut self, scene: &Scene, joint: JointId) {
        let mut loads = scene.loads.iter();
        let is_of_joint = |load: &Load| load.pressure_angle().is_some_and(|p| p.joint == joint);
        if let Some(k) = loads.position(is_of_joint) {
            let meaning = "separating force: |tooth force| × tan(pressure angle), pushes the two bodies apart at the pitch point";
            let name = scene.loads[k].name.clone();
            self.add(name, "N", ColumnQuantity::LoadForce(k), meaning);
        }
    }

    fn loads(&mut self, scene: &Scene) {
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
            if let Some((unit, meaning)) = description {
                let quantity = if unit == "N" {
                    "load_force"
                } else {
                    "load_moment"
                };
                let name = format!("{}.{quantity}", load.name);
                self.add(name, unit, ColumnQuantity::LoadForce(k), meaning);
            }
            let name = format!("{}.power", load.name);
            self.add(
                name,
                "W",
                ColumnQuantity::LoadPower(k),
                "power of the load on all bodies",
            );
        }
    }

    fn totals(&mut self, scene: &Scene) {
        let ground = scene.mechanism.body_name(BodyId(scene.mechanism.ground));
        let meaning = format!(
            "shaking force: resultant of all joint, actuator and load forces on {ground}; moment about its origin"
        );
        for (k, (name, unit)) in [("fx", "N"), ("fy", "N"), ("moment", "N m")]
            .into_iter()
            .enumerate()
        {
            self.add(
                format!("shaking.{name}"),
                unit,
                ColumnQuantity::ShakingForce(k),
                &*meaning,
            );
        }
        for (name, unit, term, meaning) in [
            (
                "power.actuators",
                "W",
                PowerTerm::Actuators,
                "power of the actuators",
            ),
            ("power.loads", "W", PowerTerm::Loads, "power of the loads"),
            (
                "power.kinetic",
                "W",
                PowerTerm::KineticRate,
                "rate of the kinetic energy",
            ),
            (
                "power.residual",
                "W",
                PowerTerm::Residual,
                "actuators + loads − dE/dt: rounding error",
            ),
            (
                "energy.kinetic_bodies",
                "J",
                PowerTerm::KineticEnergy,
                "kinetic energy of the bodies",
            ),
        ] {
            self.add(name, unit, ColumnQuantity::Power(term), meaning);
        }
    }
}

/// The meaning of a component of a joint's reaction.
fn reaction_meaning(
    kind: JointKind,
    component: dwell_geometry::Component,
    one: &str,
    two: &str,
) -> String {
    use dwell_geometry::Component as C;
    let on = format!("of {one} on {two}");
    match (component, kind) {
        (C::X | C::Y, _) => format!("force {on}, ground's axes"),
        (C::Normal, _) => {
            format!("force {on} along the axis of {one} turned +90°, at the point of {two}")
        }
        (C::Moment, JointKind::Coupling(_)) => format!("moment {on} that enforces the coupling"),
        (C::Moment, _) => format!("moment {on}, about the joint's point of {two}"),
        (C::Tooth, JointKind::Rack { .. }) => format!("tooth force {on} along the rack"),
        (C::Tooth, _) => {
            format!("tooth force {on} at the pitch point; positive turns {two} counter-clockwise")
        }
        (C::Tangent, _) => format!("force {on} along the track at the contact"),
        (C::Axial, _) => {
            "force in the link; positive in compression (pushes its ends apart)".to_owned()
        }
        (C::Force, _) => format!("force {on} that enforces the coupling"),
    }
}

/// Whether every force of a joint is statically determinate.
fn is_determinate(model: &Model, joint: JointId) -> bool {
    let reactions = model.reactions().iter().enumerate();
    let mut forces =
        reactions.filter(|(_, r)| r.joint == joint && r.component != Component::Moment);
    forces.all(|(k, _)| model.plan().is_determinate(k))
}
