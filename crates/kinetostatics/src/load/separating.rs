//! The separating force of gears and racks whose teeth have a pressure angle.
//!
//! The force between two teeth acts along the line of action, which is inclined by the pressure angle α to the common
//! tangent of the pitch circles. Its tangential part is the tooth force F_t, the reaction of the coupling; the other
//! part, |F_t| tan α, pushes the teeth apart along the line of centres (of a rack: normal to the pitch line). Where
//! the teeth bear on their other flanks, it still pushes them apart. It acts across the velocity of the teeth, so it
//! does no work and is conjugate to no constraint row: it is a load, whose magnitude depends on the reactions.

use super::{Load, LoadKind, Magnitude};
use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{BodyId, Component, Condition, Joint, JointId, Reaction, Vec2};
use dwell_numerics::{Constant, Lift};

/// The teeth of two gears, or of a rack and its pinion, in mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mesh<C = f64> {
    /// The two gears, or the rack and the pinion.
    pub bodies: [BodyId; 2],
    /// The centres of the gears, or a point of the rack's pitch line and the pinion's centre, m.
    pub points: [Vec2<C>; 2],
    /// The pitch lines, which determine the pitch point.
    pub pitch: PitchLines<C>,
}

/// The lines of two bodies in mesh that roll on each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PitchLines<C = f64> {
    /// The pitch circles of two gears.
    Circles {
        /// Pitch radii, m.
        radii: [C; 2],
        /// Whether the larger one is a ring around the other.
        internal: bool,
    },
    /// The pitch line of a rack and the pitch circle of its pinion.
    Line {
        /// Unit vector of the pitch line in the rack's frame.
        axis: Vec2<C>,
        /// Pitch radius, m: positive with the pinion on the side of the axis turned by +90°.
        radius: C,
    },
}

/// The pressure angle of the teeth of a joint: the separating force is tan α times the absolute tooth force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureAngle {
    /// The gear pair, or the rack and its pinion.
    pub joint: JointId,
    /// α, rad, above zero and at most [`PressureAngle::MAX`].
    pub angle: f64,
}

impl PressureAngle {
    /// The largest pressure angle, rad (45°): standard teeth have 14.5° to 25°, and with more than 45° more force would
    /// separate the teeth than drives them.
    pub const MAX: f64 = std::f64::consts::FRAC_PI_4;

    /// The tooth force on which the separating force depends.
    pub(crate) fn tooth_force(&self) -> Reaction {
        let (joint, component) = (self.joint, Component::Tooth);
        Reaction { joint, component }
    }

    /// Why it does not fit a load of this kind on its joint.
    pub(super) fn validate(&self, joint: &Joint, kind: LoadKind) -> Result<(), &'static str> {
        if !(self.angle > 0.0 && self.angle <= Self::MAX) {
            return Err("its pressure angle must be above 0 and at most 45°");
        }
        match Mesh::of(joint).map(LoadKind::Special) {
            Some(separating) if separating == kind => Ok(()),
            _ => Err("its joint is no gear pair or rack with these teeth"),
        }
    }
}

impl Mesh {
    /// The teeth of a joint; none if it has no teeth.
    pub fn of(joint: &Joint) -> Option<Self> {
        let teeth = joint.kind.has_teeth();
        let pitch = match joint.kind.conditions().next().filter(|_| teeth)? {
            Condition::Meshed { radii, internal } => PitchLines::Circles { radii, internal },
            Condition::Rolled { axis, radius } => PitchLines::Line { axis, radius },
            _ => return None,
        };
        Some(Self {
            bodies: joint.bodies,
            points: joint.points,
            pitch,
        })
    }

    /// Whether its points, axis and radii are usable.
    pub(super) fn is_valid(&self) -> bool {
        let positive = |radius: f64| radius.is_finite() && radius > 0.0;
        let pitch = match self.pitch {
            PitchLines::Circles { radii, .. } => radii.into_iter().all(positive),
            // A unit vector to rounding, from any way of normalising it.
            PitchLines::Line { axis, radius } => {
                (axis.norm() - 1.0).abs() < 1e-9 && positive(radius.abs())
            }
        };
        pitch && self.points.iter().all(|point| point.is_finite())
    }
}

impl<C: Constant> Mesh<C> {
    /// From the second body's centre to the pitch point, m, and the unit vector along which the teeth of the first
    /// body push the second away; `None` if the centres of two gears coincide.
    pub(crate) fn pitch_point<T: Lift<C>>(
        &self,
        states: &BodyStates<T, C>,
    ) -> Option<[Vec2<T>; 2]> {
        let Self { bodies, points, .. } = *self;
        match self.pitch {
            PitchLines::Circles { radii, internal } => {
                let u = states.separation(bodies, points).direction?;
                let radius = T::lift(radii[1]);
                // A ring reaches over the other's centre, and pushes its pinion towards its own.
                Some(match (internal, radii[0].value() > radii[1].value()) {
                    (false, _) => [u * -radius, u],
                    (true, true) => [u * radius, -u],
                    (true, false) => [u * -radius, -u],
                })
            }
            PitchLines::Line { axis, radius } => {
                let normal = axis.perp().cast().rotate(states.body(bodies[0]).rotation);
                let away = normal * T::from_f64(radius.value().signum());
                Some([normal * T::lift(-radius), away])
            }
        }
    }
}

impl Load {
    /// The separating force of a gear pair or a rack with teeth of this pressure angle (rad), named after the joint; none
    /// if the joint has no teeth. `id` is the joint's index in its mechanism.
    pub fn separating(joint: &Joint, id: JointId, pressure_angle: f64) -> Option<Self> {
        Some(Self {
            name: format!("{}.separating", joint.name),
            kind: LoadKind::Special(Mesh::of(joint)?),
            magnitude: Magnitude::Separating(PressureAngle {
                joint: id,
                angle: pressure_angle,
            }),
        })
    }
}
