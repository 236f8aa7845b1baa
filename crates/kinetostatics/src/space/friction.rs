//! Dry friction of revolute, prismatic and cylindrical joints in space. The force F and the moment M of the joint, about its
//! point on the second body, press on two bearings, or on the two ends of a guide, at distance L along the axis u:
//!
//! ```text
//! f₁,₂ = F_n/2 ± M × u / L,    N = |f₁| + |f₂|          F_n = F − (F·u) u;  without L:  N = |F_n|          (1)
//!
//! revolute      g = r N,  φ = µ tanh(ω/ω₀)          couple −φ g about the axis
//! prismatic     g = N,    φ = µ tanh(v/v₀)          force −φ g along the axis
//! cylindrical   g = N,    φ = µ tanh(s/v₀) v/s      force −φ g along the axis,         s² = v² + (r ω)²    (2)
//!               g = r N,  φ = µ tanh(s/v₀) r ω/s    couple −φ g about the axis
//! ```
//!
//! So in a cylindrical joint the friction is against the velocity of the pin's surface, and its power is −µ tanh(s/v₀) N s. Without a
//! regularisation speed v₀ it is one force along that velocity, which holds at rest: see `surface_friction`. Neither the force along
//! the axis of a revolute joint nor the moment about that of a prismatic joint counts: the surfaces that carry them have their own
//! sizes, which are not described.

use super::load::LoadKind;
use super::model::{Axes, Component, Model, Reaction};
use super::surface_friction::TWO_DIRECTIONS;
use crate::error::LoadError;
use crate::friction::{ContactLaw, DependentLoad};
use crate::load::{Friction, FrictionContact, Strength};
use dwell_geometry::space::{Coordinate, CoordinateFunction, JointKind, Mechanism, Plan};
use dwell_numerics::Scalar;

/// The components of (1): of the force and the moment along the joint's normal and across it.
const COMPONENTS: [Component; 4] = [
    Component::Force(Axes::Joint, 0),
    Component::Force(Axes::Joint, 1),
    Component::Moment(Axes::Joint, 0),
    Component::Moment(Axes::Joint, 1),
];
/// Below this square of s/v₀ the quotient of (2) is its series.
const SLOW: f64 = 1e-4;

/// A friction whose joint, bodies and reactions are those of a model.
pub(super) type JointFriction = DependentLoad<FrictionLaw, 4>;

/// How the friction of a joint depends on its reaction and its speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FrictionLaw {
    friction: Friction,
    sliding: Sliding,
    /// The ratio of g to N: the radius for a couple, m, or 1 for a force.
    lever: f64,
    /// Distance of the bearings or of the ends of the guide, m.
    distance: f64,
}

/// How the surfaces slide.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Sliding {
    /// About or along one coordinate.
    Along(CoordinateFunction),
    /// For a cylindrical joint: the coordinate of the load and the other one, with the factors from their rates to speeds of the
    /// surface.
    Both([CoordinateFunction; 2], [f64; 2]),
}

impl FrictionLaw {
    // Long because it has one arm for each kind of joint.
    fn compile(
        friction: Friction,
        kind: LoadKind,
        mechanism: &Mechanism,
        plan: &Plan,
    ) -> Result<Self, &'static str> {
        friction.validate_numbers()?;
        let id = friction.joint;
        let joint = mechanism.joints.get(id.0);
        let joint = joint.ok_or("its joint does not exist")?;
        let function = |coordinate| plan.direction_function(mechanism, coordinate);
        let (angle, travel) = (Coordinate::Angle(id), Coordinate::Travel(id));
        let (sliding, lever, distance) = match (joint.kind, friction.contact, kind) {
            (
                JointKind::Revolute,
                FrictionContact::Bearing { radius, distance },
                LoadKind::Along(Coordinate::Angle(of), Strength::Direct),
            ) if of == id => (Sliding::Along(function(angle)?), radius, distance),
            (
                JointKind::Prismatic,
                FrictionContact::Guide { length },
                LoadKind::Along(Coordinate::Travel(of), Strength::Direct),
            ) if of == id => (Sliding::Along(function(travel)?), 1.0, length),
            // One line in a mechanism of one coordinate: see `surface_friction`.
            (
                JointKind::Cylindrical,
                FrictionContact::Bearing { distance, .. },
                LoadKind::Along(Coordinate::Travel(of), Strength::Direct),
            ) if of == id && friction.regularization_speed.is_none() => {
                let only = only_coordinate(mechanism)?;
                (Sliding::Along(function(only)?), 1.0, distance)
            }
            (
                JointKind::Cylindrical,
                FrictionContact::Bearing { radius, distance },
                LoadKind::Along(Coordinate::Angle(of) | Coordinate::Travel(of), Strength::Direct),
            ) if of == id && friction.regularization_speed.is_some() => {
                let (mut coordinates, mut levers) =
                    ([function(travel)?, function(angle)?], [1.0, radius]);
                if kind == LoadKind::couple(id) {
                    coordinates.reverse();
                    levers.reverse();
                }
                let [lever, _] = levers;
                (Sliding::Both(coordinates, levers), lever, distance)
            }
            _ => {
                return Err(
                    "its joint is no revolute, prismatic or cylindrical joint with such a friction",
                );
            }
        };
        Ok(Self {
            friction,
            sliding,
            lever,
            distance,
        })
    }
}

/// The coordinate of a mechanism that has one, with which the surface of a cylindrical joint slides along one line: see `surface_friction`.
fn only_coordinate(mechanism: &Mechanism) -> Result<Coordinate, &'static str> {
    let [actuator] = &mechanism.actuators[..] else {
        return Err(TWO_DIRECTIONS);
    };
    let joint = &mechanism.joints[actuator.kind.joint().0];
    Ok(actuator.kind.coordinate(joint))
}

impl ContactLaw<4> for FrictionLaw {
    fn force<T: Scalar>(self, [force_n, force_a, moment_n, moment_a]: [T; 4]) -> (T, [T; 4]) {
        let (zero, lever) = (T::from_f64(0.0), T::from_f64(self.lever));
        // The length of a vector across the axis, and its derivatives by both components.
        let length = |x: T, y: T| {
            let square = x * x + y * y;
            if square.value() == 0.0 {
                return [zero; 3];
            }
            let length = square.sqrt();
            [length, x / length, y / length]
        };
        if self.distance == 0.0 {
            let [press, by_n, by_a] = length(force_n, force_a);
            return (lever * press, [lever * by_n, lever * by_a, zero, zero]);
        }
        let (half, turn) = (T::from_f64(0.5), T::from_f64(1.0 / self.distance));
        // M × u = M_a n − M_n a.
        let [n, a] = [half * force_n, half * force_a];
        let [first, second] =
            [turn, -turn].map(|turn| length(n + turn * moment_a, a - turn * moment_n));
        let slopes = [
            half * (first[1] + second[1]),
            half * (first[2] + second[2]),
            turn * (second[2] - first[2]),
            turn * (first[1] - second[1]),
        ];
        (
            lever * (first[0] + second[0]),
            slopes.map(|slope| lever * slope),
        )
    }
}

impl JointFriction {
    /// φ of (2).
    #[inline]
    pub(super) fn factor<T: Scalar>(&self, rate: impl Fn(CoordinateFunction) -> T) -> T {
        let friction = &self.law.friction;
        match (self.law.sliding, friction.regularization_speed) {
            (Sliding::Along(coordinate), _) => friction.factor(rate(coordinate)),
            // It is not compiled without a speed.
            (Sliding::Both(..), None) => T::from_f64(f64::NAN),
            (Sliding::Both(coordinates, levers), Some(slow)) => {
                let speed = |k: usize| rate(coordinates[k]) * T::from_f64(levers[k] / slow);
                let [own, other] = [speed(0), speed(1)];
                own * tanh_quotient(own * own + other * other) * T::from_f64(friction.coefficient)
            }
        }
    }

    /// A friction that holds its surfaces at rest, with the coordinate along which they slide.
    pub(super) fn sticking(&self) -> Option<(Friction, CoordinateFunction)> {
        let friction = self.law.friction;
        match self.law.sliding {
            Sliding::Along(coordinate) if friction.regularization_speed.is_none() => {
                Some((friction, coordinate))
            }
            Sliding::Along(_) | Sliding::Both(..) => None,
        }
    }
}

/// tanh(x)/x of x².
fn tanh_quotient<T: Scalar>(square: T) -> T {
    if square.value() < SLOW {
        let [second, third, fourth] = [-1.0 / 3.0, 2.0 / 15.0, -17.0 / 315.0].map(T::from_f64);
        return T::from_f64(1.0) + square * (second + square * (third + square * fourth));
    }
    let x = square.sqrt();
    let tanh = x.value().tanh();
    let slope = 1.0 - tanh * tanh;
    x.compose(&[tanh, slope, -2.0 * tanh * slope, 0.0]) / x
}

impl Model {
    /// Compiles the frictions among the loads, and appends the reactions on which they depend to the requested ones.
    ///
    /// # Errors
    /// [`LoadError`] for a friction that does not fit its joint, or depends on a reaction that redundant constraints leave open.
    pub(super) fn compile_frictions(&mut self) -> Result<(), LoadError> {
        let mut all: Vec<Reaction> = self.requested_reactions().collect();
        let mut frictions = Vec::new();
        for (load, one) in self.loads.loads.iter().enumerate() {
            let Some(friction) = one.friction() else {
                continue;
            };
            let law = FrictionLaw::compile(friction, one.kind, self.mechanism(), self.plan())
                .map_err(|what| LoadError { load, what })?;
            let joint = friction.joint;
            let needed = if law.distance > 0.0 { 4 } else { 2 };
            let mut reactions = [None; 4];
            for (index, component) in reactions.iter_mut().zip(COMPONENTS).take(needed) {
                let reaction = Reaction { joint, component };
                let known = all.iter().position(|other| *other == reaction);
                *index = known.or(Some(all.len()));
                if known.is_none() {
                    all.push(reaction);
                }
            }
            frictions.push(JointFriction {
                load,
                reactions,
                law,
            });
        }
        self.set_reactions(&all, frictions);
        self.require_determined()
    }

    /// Refuses a friction whose contact force has no value.
    fn require_determined(&self) -> Result<(), LoadError> {
        if self.frictions.is_empty() || self.plan().mobility().redundant_count == 0 {
            return Ok(());
        }
        // It was assembled there.
        let Ok(determined) = self.determined_throughout() else {
            return Ok(());
        };
        let is_open = |friction: &&JointFriction| {
            let mut needed = friction.reactions.iter().flatten();
            needed.any(|&k| !determined[k])
        };
        let what =
            "depends on a reaction that is not determined: redundant constraints share the load";
        let open = self.frictions.iter().find(is_open);
        open.map_or(Ok(()), |friction| {
            Err(LoadError {
                load: friction.load,
                what,
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_geometry::space::Vec3;
    use dwell_geometry::{BodyId, Guide, JointId};
    use dwell_numerics::Dual;

    /// The slopes with which the friction is solved are the derivatives of its contact force.
    #[test]
    fn slopes_are_those_of_the_contact_force() {
        let reactions = [[3.0, -4.0, 0.5, 0.2], [-0.7, 0.1, -0.3, 2.0]];
        for (distance, lever) in [(0.0, 0.02), (0.3, 0.02), (0.15, 1.0)] {
            let friction = Friction {
                joint: JointId(0),
                coefficient: 0.1,
                static_coefficient: 0.1,
                contact: FrictionContact::Guide { length: distance },
                regularization_speed: None,
            };
            let law = FrictionLaw {
                friction,
                sliding: Sliding::Along(CoordinateFunction::Travel(Guide {
                    bodies: [BodyId(0), BodyId(1)],
                    points: [Vec3::AXES[0]; 2],
                    axis: Vec3::AXES[2],
                })),
                lever,
                distance,
            };
            for reaction in reactions {
                let (_, slopes) = law.force(reaction);
                for k in 0..4 {
                    let mut varied = reaction.map(Dual::from_f64);
                    varied[k] = Dual::variable(reaction[k]);
                    let (force, _) = law.force(varied);
                    // Seen: 1.8e-15.
                    assert!((force.d - slopes[k]).abs() < 1e-14, "{force:?} {slopes:?}");
                }
            }
        }
    }
}
