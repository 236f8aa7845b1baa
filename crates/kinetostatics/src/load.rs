//! Loads: each is a shape fixed by the configuration, times a magnitude that may depend on time and on the motion.
//!
//! This file describes them; the files below it compile and evaluate them.

mod compiled;
mod friction;
mod function;
mod kind;
mod separating;
mod signal;
mod strength;
mod wrench;

pub(crate) use compiled::CompiledLoads;
pub use compiled::LoadState;
pub use friction::{Friction, FrictionContact};
pub use function::{MAX_FUNCTION_SIGNALS, MagnitudeFunction};
pub(crate) use kind::BETWEEN_POINTS;
pub use kind::{
    AnyLoadKind, Direction, LoadCoordinate, LoadKind, LoadNames, LoadShape, SpecialKind,
};
pub use separating::{Mesh, PitchLines, PressureAngle};
pub(crate) use signal::{SignalWorkspace, compile_signals, compile_signals_by};
pub(crate) use strength::{Line, drag};
pub use strength::{LoadSymbol, Strength, StrengthWords};
pub use wrench::{AppliedWrench, ForceSource};
pub(crate) use wrench::{LoadPlaces, find_couple_points, on_two_bodies};

pub use dwell_geometry::Guide;

use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{BodyId, Coordinate, Mechanism};
use dwell_laws::{Expression, Law};

/// A named load: of a mechanism in the plane, or with other shapes and coordinates in [space](crate::space).
#[derive(Debug, Clone, PartialEq)]
pub struct Load<K = LoadKind, C = Coordinate> {
    /// The name a table uses.
    pub name: String,
    /// The place of the load and its strength law, which gives the meaning of the magnitude.
    pub kind: K,
    /// Its magnitude.
    pub magnitude: Magnitude<C>,
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
    /// The velocity of a coordinate, rad/s or m/s.
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

impl<K: LoadShape, C> Load<K, C> {
    /// Whether it has a potential energy: gravity, springs and forces of constant direction, where the magnitude is
    /// constant; and the separating force of teeth, which does no work.
    pub fn is_conservative(&self) -> bool {
        let is_constant = matches!(self.magnitude, Magnitude::Constant(_));
        !self.does_work() || self.kind.has_potential() && is_constant
    }

    /// Whether it can do work in some motion: all but the separating force of teeth.
    pub fn does_work(&self) -> bool {
        self.kind.does_work()
    }
}

impl Load {
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

    /// The bodies on which it acts, and those on whose motion its magnitude depends. Bodies with mass, on which gravity
    /// acts, are omitted, because they are always needed.
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
