//! Loads: each is a shape fixed by the configuration, times a magnitude that may depend on time and on the motion.
//!
//! This file describes them; the files below it compile and evaluate them.

mod compiled;
mod friction;
mod function;
mod separating;
mod signal;
mod wrench;

pub(crate) use compiled::CompiledLoads;
pub use compiled::LoadState;
pub use friction::{Friction, FrictionContact};
pub use function::{MAX_FUNCTION_SIGNALS, MagnitudeFunction};
pub use separating::{Mesh, PitchLines, PressureAngle};
pub(crate) use signal::{SignalWorkspace, compile_signals, compile_signals_by};
pub use wrench::{AppliedWrench, ForceSource};
pub(crate) use wrench::{find_couple_points, on_two_bodies};

pub use dwell_geometry::Guide;

use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{BodyId, Coordinate, Mechanism, Vec2};
use dwell_laws::{Expression, Law};

/// A named load: of a mechanism in the plane, or with other shapes and coordinates in [space](crate::space).
#[derive(Debug, Clone, PartialEq)]
pub struct Load<K = LoadKind, C = Coordinate> {
    /// The name a table uses.
    pub name: String,
    /// Its shape.
    pub kind: K,
    /// Its magnitude.
    pub magnitude: Magnitude<C>,
}

/// The shape of a load, and what its magnitude F means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadKind {
    /// Weight of every body: F is the acceleration of gravity, m/s², along this unit vector of the ground.
    Gravity {
        /// Unit vector in the ground's frame.
        direction: Vec2,
    },
    /// A force F, N, at a point of a body.
    Force {
        /// The body.
        body: BodyId,
        /// The point in its frame, m.
        point: Vec2,
        /// Unit vector of the force.
        direction: Vec2,
        /// Whether the direction is given in, and turns with, the body's frame; else the ground's.
        body_fixed: bool,
    },
    /// A couple F, N·m, of the first body on the second.
    Torque {
        /// The two bodies; the first may be the ground.
        bodies: [BodyId; 2],
    },
    /// A spring between two points: F is its stiffness, N/m; it pulls with F (length − free).
    Spring {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each, m.
        points: [Vec2; 2],
        /// Free length, m.
        free_length: f64,
    },
    /// A torsional spring: F is its stiffness, N·m/rad; couple −F (angle − free) of the first body
    /// on the second.
    TorsionSpring {
        /// The bodies.
        bodies: [BodyId; 2],
        /// Free angle of the second from the first, rad; whole turns are those of
        /// [`Model::with_loads`](crate::Model::with_loads).
        free_angle: f64,
    },
    /// A damper between two points: F is its constant, N·s/m; it resists with F × d(length)/dt.
    Damper {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each, m.
        points: [Vec2; 2],
    },
    /// A torsional damper: F is its constant, N·m·s/rad; couple −F × relative speed on the second.
    RotationalDamper {
        /// The bodies.
        bodies: [BodyId; 2],
    },
    /// A force F, N, that pushes two points apart.
    PointToPointForce {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each, m.
        points: [Vec2; 2],
    },
    /// A force F, N, of a joint's first body on its second along their slide, at the second body's point.
    SlideForce(Guide),
    /// Viscous friction in a slide: F is its constant, N·s/m; it resists with F × speed of travel.
    SlideDamper(Guide),
    /// A force F, N, that pushes the teeth of two bodies apart, at the pitch point.
    SeparatingForce(Mesh),
}

impl LoadKind {
    /// The bodies it acts on; none of gravity, which acts on all that have mass.
    pub(crate) fn bodies(&self) -> &[BodyId] {
        match self {
            Self::Gravity { .. } => &[],
            Self::Force { body, .. } => std::slice::from_ref(body),
            Self::Torque { bodies }
            | Self::Spring { bodies, .. }
            | Self::TorsionSpring { bodies, .. }
            | Self::Damper { bodies, .. }
            | Self::RotationalDamper { bodies }
            | Self::PointToPointForce { bodies, .. }
            | Self::SlideForce(Guide { bodies, .. })
            | Self::SlideDamper(Guide { bodies, .. })
            | Self::SeparatingForce(Mesh { bodies, .. }) => bodies,
        }
    }

    /// A couple or force along a coordinate, positive in the direction in which the coordinate grows; none if the
    /// mechanism has no such coordinate.
    pub fn along(mechanism: &Mechanism, coordinate: Coordinate) -> Option<Self> {
        Some(match CoordinateFunction::find(mechanism, coordinate)? {
            CoordinateFunction::Angle(bodies) => Self::Torque { bodies },
            CoordinateFunction::Travel(guide) => Self::SlideForce(guide),
            CoordinateFunction::Length { bodies, points } => {
                Self::PointToPointForce { bodies, points }
            }
        })
    }
}

/// The magnitude of a load. `C` is how a coordinate is described.
#[derive(Debug, Clone, PartialEq)]
pub enum Magnitude<C = Coordinate> {
    /// A constant.
    Constant(f64),
    /// A law of one signal.
    Law(Signal<C>, Law),
    /// An expression of several signals, one for each variable it was parsed with, in their order.
    Expression(Expression, Vec<Signal<C>>),
    /// A function of the program that uses the library, of these signals in their order.
    Function(MagnitudeFunction, Vec<Signal<C>>),
    /// Coulomb friction, from the joint's own reactions.
    Friction(Friction),
    /// The separating force of teeth, from the tooth force of their joint.
    Separating(PressureAngle),
    /// The value given by [`LoadedState::set_magnitude`](crate::LoadedState::set_magnitude), zero until then: of a drive,
    /// which is evaluated outside the model from these signals.
    External(Vec<Signal<C>>),
}

impl LoadKind {
    /// The two bodies on whose relative angle, with whole revolutions, a load of this kind itself depends; none for most.
    pub fn angle_pair(self) -> Option<[BodyId; 2]> {
        match self {
            Self::TorsionSpring { bodies, .. } => Some(bodies),
            Self::Gravity { .. }
            | Self::Force { .. }
            | Self::Torque { .. }
            | Self::Spring { .. }
            | Self::Damper { .. }
            | Self::RotationalDamper { .. }
            | Self::PointToPointForce { .. }
            | Self::SlideForce(_)
            | Self::SlideDamper(_)
            | Self::SeparatingForce(_) => None,
        }
    }

    /// The coordinate along which two surfaces slide whose friction is a load of this kind: of a pin or of a guide. No
    /// other load is a friction.
    pub(crate) fn sliding_coordinate(self) -> Option<CoordinateFunction> {
        match self {
            Self::SlideForce(guide) => Some(CoordinateFunction::Travel(guide)),
            Self::Torque { bodies } => Some(CoordinateFunction::Angle(bodies)),
            Self::Gravity { .. }
            | Self::Force { .. }
            | Self::Spring { .. }
            | Self::TorsionSpring { .. }
            | Self::Damper { .. }
            | Self::RotationalDamper { .. }
            | Self::PointToPointForce { .. }
            | Self::SlideDamper(_)
            | Self::SeparatingForce(_) => None,
        }
    }
}

impl Magnitude {
    /// The pairs of bodies on the value of whose relative angle it depends.
    pub fn angle_pairs(&self) -> impl Iterator<Item = [BodyId; 2]> {
        let pair = |signal: &Signal| match *signal {
            Signal::Value(Coordinate::Angle(bodies)) => Some(bodies),
            Signal::Value(Coordinate::Travel(_) | Coordinate::Length { .. })
            | Signal::Velocity(_)
            | Signal::Time => None,
        };
        self.signals().iter().filter_map(pair)
    }
}

impl<C> Magnitude<C> {
    /// The signals it depends on.
    pub fn signals(&self) -> &[Signal<C>] {
        match self {
            Self::Constant(_) | Self::Friction(_) | Self::Separating(_) => &[],
            Self::Law(signal, _) => std::slice::from_ref(signal),
            Self::Expression(_, signals) | Self::Function(_, signals) | Self::External(signals) => {
                signals
            }
        }
    }
}

/// A quantity that a magnitude can depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Signal<C = Coordinate> {
    /// Time, s.
    Time,
    /// A coordinate, rad or m.
    Value(C),
    /// Its speed, rad/s or m/s.
    Velocity(C),
}

/// A [`Signal`] of a certain mechanism, ready to be evaluated.
pub type CompiledSignal = Signal<CoordinateFunction>;

impl<K, C> Load<K, C> {
    /// The friction that makes its magnitude, if it is one.
    pub fn friction(&self) -> Option<Friction> {
        let Magnitude::Friction(friction) = self.magnitude else {
            return None;
        };
        Some(friction)
    }
}

impl Load {
    /// Whether it has a potential energy: gravity, springs and forces of constant direction, where the magnitude is
    /// constant; and the separating force of teeth, which does no work.
    pub fn is_conservative(&self) -> bool {
        let has_potential = match self.kind {
            LoadKind::Gravity { .. }
            | LoadKind::Spring { .. }
            | LoadKind::TorsionSpring { .. }
            | LoadKind::SeparatingForce(_) => true,
            LoadKind::Force { body_fixed, .. } => !body_fixed,
            LoadKind::Torque { .. }
            | LoadKind::Damper { .. }
            | LoadKind::RotationalDamper { .. }
            | LoadKind::PointToPointForce { .. }
            | LoadKind::SlideForce(_)
            | LoadKind::SlideDamper(_) => false,
        };
        !self.does_work() || has_potential && matches!(self.magnitude, Magnitude::Constant(_))
    }

    /// Whether it can do work in some motion: all but the separating force of teeth.
    pub fn does_work(&self) -> bool {
        !matches!(self.kind, LoadKind::SeparatingForce(_))
    }

    /// The pressure angle that makes its magnitude, if it is the separating force of teeth.
    pub fn pressure_angle(&self) -> Option<PressureAngle> {
        let Magnitude::Separating(teeth) = self.magnitude else {
            return None;
        };
        Some(teeth)
    }

    /// The pairs of bodies on whose relative angle it depends, with whole revolutions: those of a torsional spring
    /// and those of its magnitude's signals.
    pub fn angle_pairs(&self) -> Vec<[BodyId; 2]> {
        let by_kind = self.kind.angle_pair().into_iter();
        by_kind.chain(self.magnitude.angle_pairs()).collect()
    }

    /// The bodies it acts on and those whose motion its magnitude depends on. Gravity acts on those
    /// with mass, which are needed anyway.
    pub fn bodies(&self, mechanism: &Mechanism) -> Vec<BodyId> {
        let mut bodies = self.kind.bodies().to_vec();
        for signal in self.magnitude.signals() {
            let (Signal::Value(coordinate) | Signal::Velocity(coordinate)) = *signal else {
                continue;
            };
            bodies.extend(match coordinate {
                Coordinate::Angle(pair) | Coordinate::Length { bodies: pair, .. } => pair,
                Coordinate::Travel(joint) => mechanism.joints[joint.0].bodies,
            });
        }
        bodies
    }
}
