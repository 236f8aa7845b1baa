//! What acts on a mechanism from outside: each load is a shape that the configuration fixes, times a
//! magnitude that may depend on time and on what moves.

use dwell_geometry::measure::Measured;
use dwell_geometry::{BodyId, Coordinate, JointId, Mechanism, Vec2};
use dwell_laws::{Expression, Law};

/// A named load.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// The name a table uses.
    pub name: String,
    /// Its shape.
    pub kind: LoadKind,
    /// Its magnitude.
    pub magnitude: Magnitude,
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
        follows: bool,
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
        free: f64,
    },
    /// A torsional spring: F is its stiffness, N·m/rad; couple −F (angle − free) of the first body
    /// on the second.
    TorsionSpring {
        /// The bodies.
        bodies: [BodyId; 2],
        /// Free angle of the second from the first, rad; whole turns are those of
        /// [`Model::with_loads`](crate::Model::with_loads).
        free: f64,
    },
    /// A damper between two points: F is its constant, N·s/m; it resists with F × d(length)/dt.
    Damper {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each, m.
        points: [Vec2; 2],
    },
    /// A torsional damper: F is its constant, N·m·s/rad; couple −F × relative speed on the second.
    TorsionDamper {
        /// The bodies.
        bodies: [BodyId; 2],
    },
    /// A force F, N, that pushes two points apart.
    Push {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The point on each, m.
        points: [Vec2; 2],
    },
    /// A force F, N, along the slide of a joint: of its first body on its second, at the second's point.
    Slide(Guide),
    /// Viscous friction in a slide: F is its constant, N·s/m; it resists with F × speed of travel.
    SlideDamper(Guide),
}

/// The line along which a prismatic joint or a slot slides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guide {
    /// The joint's bodies.
    pub bodies: [BodyId; 2],
    /// Its point on each, m.
    pub points: [Vec2; 2],
    /// Unit vector of its axis in the first body's frame.
    pub axis: Vec2,
}

impl LoadKind {
    /// A couple or force along a coordinate, that grows it where it is positive; none if the coordinate
    /// is not there.
    pub fn along(mechanism: &Mechanism, coordinate: Coordinate) -> Option<Self> {
        Some(match Measured::find(mechanism, coordinate)? {
            Measured::Angle(bodies) => Self::Torque { bodies },
            Measured::Travel {
                bodies,
                points,
                axis,
            } => Self::Slide(Guide {
                bodies,
                points,
                axis,
            }),
            Measured::Length { bodies, points } => Self::Push { bodies, points },
        })
    }
}

impl Guide {
    /// The travel of the second point along it.
    pub fn travel(&self) -> Measured {
        let &Self {
            bodies,
            points,
            axis,
        } = self;
        Measured::Travel {
            bodies,
            points,
            axis,
        }
    }
}

/// Coulomb friction in a joint: the couple −µ r |R| tanh(ω/ω₀) on the second body of a revolute joint, the
/// force −µ N tanh(v/v₀) along a slide, N the sum of what presses on the guide. The load must be a
/// [`LoadKind::Torque`] or a [`LoadKind::Slide`] between the joint's bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// The joint.
    pub joint: JointId,
    /// Coefficient of friction µ.
    pub coefficient: f64,
    /// Radius r of the pin, m; or the length of the guide, m, at whose ends it presses (0: at one point).
    pub size: f64,
    /// Speed ω₀ or v₀ below which the friction fades, rad/s or m/s.
    pub fade: f64,
}

/// The magnitude of a load.
#[derive(Debug, Clone, PartialEq)]
pub enum Magnitude {
    /// Always the same.
    Constant(f64),
    /// A law of one signal.
    Law(Signal, Law),
    /// An expression of several signals, one for each variable it was parsed with, in their order.
    Expression(Expression, Vec<Signal>),
    /// As the joint's own reactions make it.
    Friction(Friction),
    /// What [`Workspace::give`](crate::Workspace::give) said last: of a drive, for whoever evaluates it
    /// from these signals.
    Given(Vec<Signal>),
}

impl Magnitude {
    /// What it depends on.
    pub fn signals(&self) -> &[Signal] {
        match self {
            Self::Constant(_) | Self::Friction(_) => &[],
            Self::Law(signal, _) => std::slice::from_ref(signal),
            Self::Expression(_, signals) | Self::Given(signals) => signals,
        }
    }
}

/// What a magnitude can depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Signal {
    /// Time, s.
    Time,
    /// A coordinate, rad or m.
    Value(Coordinate),
    /// Its speed, rad/s or m/s.
    Speed(Coordinate),
}

impl Load {
    /// Whether it has a potential energy: gravity, springs and forces that keep their direction, where
    /// their magnitude is constant.
    pub fn conservative(&self) -> bool {
        let shaped = matches!(
            self.kind,
            LoadKind::Gravity { .. }
                | LoadKind::Force { follows: false, .. }
                | LoadKind::Spring { .. }
                | LoadKind::TorsionSpring { .. }
        );
        shaped && matches!(self.magnitude, Magnitude::Constant(_))
    }

    /// The pairs of bodies whose angle it feels, with whole turns: a torsional spring's own, and those
    /// its magnitude depends on.
    pub fn angles(&self) -> Vec<[BodyId; 2]> {
        let own = match self.kind {
            LoadKind::TorsionSpring { bodies, .. } => Some(bodies),
            _ => None,
        };
        let signals = self.magnitude.signals().iter();
        let sensed = signals.filter_map(|signal| match *signal {
            Signal::Value(Coordinate::Angle(pair)) => Some(pair),
            _ => None,
        });
        own.into_iter().chain(sensed).collect()
    }

    /// The bodies it acts on and those whose motion its magnitude depends on. Gravity acts on those
    /// with mass, which are needed anyway.
    pub fn bodies(&self, mechanism: &Mechanism) -> Vec<BodyId> {
        let mut bodies = match self.kind {
            LoadKind::Gravity { .. } => Vec::new(),
            LoadKind::Force { body, .. } => vec![body],
            LoadKind::Torque { bodies }
            | LoadKind::Spring { bodies, .. }
            | LoadKind::TorsionSpring { bodies, .. }
            | LoadKind::Damper { bodies, .. }
            | LoadKind::Push { bodies, .. }
            | LoadKind::TorsionDamper { bodies }
            | LoadKind::Slide(Guide { bodies, .. })
            | LoadKind::SlideDamper(Guide { bodies, .. }) => bodies.to_vec(),
        };
        for signal in self.magnitude.signals() {
            let (Signal::Value(coordinate) | Signal::Speed(coordinate)) = *signal else {
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
