//! A column of a trajectory table: its quantity, and which names ask for it.

use crate::number_format::force_unit;
use crate::trajectory::compute::{Analysis, Dyad};
use dwell_geometry::{BodyId, JointId, Vec2};

/// Whether a name selects a column: its full name, or a prefix up to a dot.
pub(crate) fn is_prefix_of(name: &str, column: &str) -> bool {
    let rest = column.strip_prefix(name);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// The quantity of a column. An order is 0 for a position, 1 for its velocity, 2 for its acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quantity {
    Time,
    ActuatorCoordinate(usize, usize),
    ActuatorForce(usize),
    /// By its number among the [measured](super::RowScene::measured) coordinates.
    Measured(usize, usize),
    /// The rotation of a body, by order and axis: its angle about the third axis, or in space the components of its rotation vector; then
    /// those of its angular velocity and acceleration.
    Rotation(BodyId, usize, usize),
    /// dθ/dq of a body.
    VelocityRatio(BodyId),
    /// dq/dθ of a body, dq/ds of a point along its path.
    MechanicalAdvantage(BodyId, Option<Vec2>),
    /// x and y of where a body has no velocity (order 1) or no acceleration (order 2).
    Pole(BodyId, usize, usize),
    /// Position, velocity and acceleration of a point of a body, by order and axis.
    Point(BodyId, [f64; 3], usize, usize),
    TransmissionAngle(Dyad),
    Reaction(usize),
    /// The k-th reaction of the i-th varying inertia of the scene.
    KnownReaction(usize, usize),
    /// The force of a joint along an axis (0 or 1) of a body.
    BodyFrameForce(JointId, BodyId, usize),
    ForceMagnitude(JointId),
    ForceDirection(JointId),
    /// The magnitude of the moment of a joint in space.
    MomentMagnitude(JointId),
    /// Force x, y and moment on the frame; in space three components of each.
    ShakingForce(usize),
    /// The least determinant of a closure over the lengths of its columns; it has no column.
    LeastDeterminant,
    /// A term of the power balance: actuators, loads, rate of the kinetic energy, residual; and the kinetic energy.
    Power(usize),
    LoadForce(usize),
    LoadPower(usize),
    /// A value of a free motion's integration.
    Extra(usize),
}

/// A column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    pub(crate) quantity: Quantity,
    /// Its meaning, if the name does not state it.
    pub(crate) meaning: String,
    /// Whether it is an angle that is unwrapped along the trajectory.
    pub(crate) unwraps: bool,
}

impl Column {
    /// Whether `request` is its name or the first part of it. A column that has no value in some positions must be
    /// named itself: a body's name does not ask for its pole.
    pub(crate) fn matches(&self, request: &str) -> bool {
        let name = &self.name;
        let optional_suffix = match self.quantity {
            Quantity::MechanicalAdvantage(..) => 0,
            Quantity::Pole(..) => ".x".len(),
            _ => name.len(),
        };
        is_prefix_of(request, name) && request.len() + optional_suffix >= name.len()
    }

    /// Whether it is computed only on request.
    pub(crate) fn is_optional(&self) -> bool {
        use Quantity::{MechanicalAdvantage, Pole};
        matches!(self.quantity, MechanicalAdvantage(..) | Pole(..))
    }

    /// Whether an analysis computes it.
    pub(crate) fn is_computed_by(&self, analysis: Analysis) -> bool {
        let forces = analysis != Analysis::Kinematics;
        let moves = analysis != Analysis::Statics;
        match self.quantity {
            Quantity::Time => true,
            Quantity::ActuatorCoordinate(_, order)
            | Quantity::Measured(_, order)
            | Quantity::Rotation(_, order, _)
            | Quantity::Point(_, _, order, _) => order == 0 || moves,
            Quantity::VelocityRatio(_)
            | Quantity::MechanicalAdvantage(..)
            | Quantity::LeastDeterminant
            | Quantity::TransmissionAngle(_) => analysis != Analysis::FreeMotion,
            Quantity::Extra(_) => analysis == Analysis::FreeMotion,
            Quantity::Pole(..) => moves,
            Quantity::ActuatorForce(_)
            | Quantity::Reaction(_)
            | Quantity::BodyFrameForce(..)
            | Quantity::ForceMagnitude(_)
            | Quantity::ForceDirection(_)
            | Quantity::MomentMagnitude(_)
            | Quantity::ShakingForce(_)
            | Quantity::LoadForce(_) => forces,
            Quantity::KnownReaction(..) | Quantity::Power(_) | Quantity::LoadPower(_) => {
                forces && moves
            }
        }
    }
}

/// The units of a coordinate, its velocity and its acceleration.
pub(crate) fn units(is_angle: bool) -> [&'static str; 3] {
    if is_angle {
        ["rad", "rad/s", "rad/s2"]
    } else {
        ["m", "m/s", "m/s2"]
    }
}

/// Collects columns.
#[derive(Default)]
pub struct ColumnList(pub(crate) Vec<Column>);

impl ColumnList {
    /// The columns, starting with the time if `timed`.
    pub(crate) fn new(timed: bool) -> Self {
        let mut list = Self::default();
        if timed {
            list.add("t", "s", Quantity::Time, "");
        }
        list
    }

    pub(crate) fn add(
        &mut self,
        name: impl Into<String>,
        unit: &'static str,
        quantity: Quantity,
        meaning: impl Into<String>,
    ) {
        self.0.push(Column {
            name: name.into(),
            unit,
            quantity,
            meaning: meaning.into(),
            unwraps: false,
        });
    }

    /// A coordinate with its velocity and its acceleration.
    pub(crate) fn add_with_derivatives(
        &mut self,
        name: &str,
        is_angle: bool,
        quantity: impl Fn(usize) -> Quantity,
        meaning: &str,
    ) {
        let suffixes = ["", ".velocity", ".acceleration"].into_iter();
        for (order, (suffix, unit)) in suffixes.zip(units(is_angle)).enumerate() {
            let meaning = if order == 0 { meaning } else { "" };
            self.add(format!("{name}{suffix}"), unit, quantity(order), meaning);
        }
    }

    /// An actuator's coordinate with its derivatives, and its force, each with its meaning.
    pub(crate) fn add_actuator(
        &mut self,
        i: usize,
        name: &str,
        is_angle: bool,
        [meaning, force]: [&str; 2],
    ) {
        let coordinate = |order| Quantity::ActuatorCoordinate(i, order);
        self.add_with_derivatives(name, is_angle, coordinate, meaning);
        let (name, unit) = (format!("{name}.actuator_force"), force_unit(is_angle));
        self.add(name, unit, Quantity::ActuatorForce(i), force);
    }

    /// The force of the `k`th load, with its unit and meaning, if it has one, and its power.
    pub(crate) fn add_load(
        &mut self,
        k: usize,
        name: &str,
        force: Option<(&'static str, &str)>,
        is_drive: bool,
    ) {
        if let Some((unit, meaning)) = force {
            let kind = if unit == "N" { "force" } else { "moment" };
            let name = format!("{name}.load_{kind}");
            let meaning = if is_drive {
                format!("{meaning}; without what accelerates the drive's rotor")
            } else {
                meaning.to_owned()
            };
            self.add(name, unit, Quantity::LoadForce(k), meaning);
        }
        let meaning = if is_drive {
            "power of the drive on all bodies, without what its rotor takes"
        } else {
            "power of the load on all bodies"
        };
        self.add(
            format!("{name}.power"),
            "W",
            Quantity::LoadPower(k),
            meaning,
        );
    }

    /// The components of the shaking force on the ground, forces first, and the power balance.
    pub(crate) fn add_totals(&mut self, ground: &str, components: &[(&str, &'static str)]) {
        let meaning = format!(
            "shaking force: resultant of all joint, actuator and load forces on {ground}; moment about its origin"
        );
        for (k, (name, unit)) in components.iter().enumerate() {
            let name = format!("shaking.{name}");
            self.add(name, unit, Quantity::ShakingForce(k), &*meaning);
        }
        for (k, (name, unit, meaning)) in POWER_COLUMNS.into_iter().enumerate() {
            self.add(name, unit, Quantity::Power(k), meaning);
        }
    }
}

/// Names, units and meanings of the power balance, by the number of its [`Quantity`].
const POWER_COLUMNS: [(&str, &str, &str); 5] = [
    ("power.actuators", "W", "power of the actuators"),
    ("power.loads", "W", "power of the loads"),
    ("power.kinetic", "W", "rate of the kinetic energy"),
    (
        "power.residual",
        "W",
        "actuators + loads − dE/dt: rounding error",
    ),
    ("energy.kinetic_bodies", "J", "kinetic energy of the bodies"),
];
