//! The friction of a joint, as a magnitude of a load.

use super::LoadKind;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{Component, Joint, JointId, Mechanism, Reaction};

/// Coulomb friction in a joint, which holds at zero speed or is regularised around it. The load must be a [`couple`](LoadKind::couple) on the
/// bodies of a revolute joint or a [`slide_force`](LoadKind::slide_force) on those of a prismatic joint or slot; in space also, of a cylindrical
/// joint, one of each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// The joint.
    pub joint: JointId,
    /// Coefficient of friction µ of surfaces that slide.
    pub coefficient: f64,
    /// Coefficient µₛ up to which surfaces at rest hold, not below µ; without effect with a regularisation speed.
    pub static_coefficient: f64,
    /// The surfaces in contact, with their size.
    pub contact: FrictionContact,
    /// Speed ω₀ or v₀ below which the friction fades, rad/s or m/s; none: the surfaces stick at rest.
    pub regularization_speed: Option<f64>,
}

/// The surfaces of a joint that rub on each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrictionContact {
    /// The pin of a revolute joint: the couple −µ r |R| sign(ω), or −µ r |R| tanh(ω/ω₀), on the second body.
    Pin {
        /// Radius r, m.
        radius: f64,
    },
    /// The guide of a prismatic joint or slot: the force −µ N sign(v), or −µ N tanh(v/v₀), along it, N the sum of the forces that press
    /// on its ends.
    Guide {
        /// Distance of its ends, m; zero for contact at one point.
        length: f64,
    },
    /// In space, the pin of a revolute or cylindrical joint in two bearings: N the sum of the forces in them, a couple µ r N about the axis
    /// in a revolute joint, a force µ N on the surface against the direction of sliding in a cylindrical one.
    Bearing {
        /// Radius r of the pin, m.
        radius: f64,
        /// Distance of the bearings, m; with zero, the tilting moment on the pin causes no friction.
        distance: f64,
    },
}

impl Friction {
    /// Why it does not fit a load of this kind on its joint.
    pub(super) fn validate(&self, joint: &Joint, kind: LoadKind) -> Result<(), &'static str> {
        self.validate_numbers()?;
        let bodies = joint.bodies;
        let fits = match self.contact {
            FrictionContact::Pin { .. } => joint.kind.is_pin() && kind == LoadKind::couple(bodies),
            FrictionContact::Guide { .. } => {
                let slides = joint.kind.travel_axis().is_some();
                let along = kind.sliding_coordinate();
                slides
                    && matches!(along, Some(CoordinateFunction::Travel(guide)) if guide.bodies == bodies)
            }
            FrictionContact::Bearing { .. } => false,
        };
        let misfit = "its joint is no revolute joint, prismatic joint or slot between its bodies";
        fits.then_some(()).ok_or(misfit)
    }

    /// Checks its numbers; the error describes the fault.
    pub(crate) fn validate_numbers(&self) -> Result<(), &'static str> {
        let sizes = match self.contact {
            FrictionContact::Pin { radius: size } | FrictionContact::Guide { length: size } => {
                [size; 2]
            }
            FrictionContact::Bearing { radius, distance } => [radius, distance],
        };
        let mut numbers = [self.coefficient].into_iter().chain(sizes);
        let regularized = self.regularization_speed.is_none_or(|speed| speed > 0.0);
        let holds =
            self.static_coefficient.is_finite() && self.static_coefficient >= self.coefficient;
        if !holds {
            return Err(
                "its static coefficient must be finite and not below its coefficient of friction",
            );
        }
        if !(regularized && numbers.all(|n| n.is_finite() && n >= 0.0)) {
            return Err(
                "its coefficient of friction and its size must be finite and not negative, its speed positive",
            );
        }
        Ok(())
    }

    /// The reactions it depends on.
    pub(crate) fn required_reactions(&self, mechanism: &Mechanism) -> Vec<Reaction> {
        let joint = self.joint;
        let presses_at_ends =
            matches!(self.contact, FrictionContact::Guide { length } if length > 0.0);
        let components = mechanism.components(joint).iter();
        let components = components.filter(|c| **c != Component::Moment || presses_at_ends);
        let reactions = components.map(|&component| Reaction { joint, component });
        reactions.collect()
    }
}
