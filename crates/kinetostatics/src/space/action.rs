//! Kinds of loads in the evaluation frames of a plan, and the forces and couples of each on the bodies.

use super::load::{DirectedCouple, Direction, LoadKind};
use crate::load::{AnyLoadKind, Line, LoadCoordinate as _, Strength, drag};
use dwell_geometry::space::{
    Coordinate, CoordinateFunction, CountedRevolutions, JointNumbers, Mechanism, Plan, Pose, Vec3,
};
use dwell_geometry::{BodyId, JointId};
use dwell_numerics::{Constant, Lift, Scalar};

/// Why a kind of load has unusable numbers.
const NOT_FINITE: &str =
    "its points, directions and free value must be finite, its free length not negative";

fn has_usable_numbers(kind: &LoadKind) -> bool {
    match *kind {
        LoadKind::Gravity { direction } => direction.is_finite(),
        LoadKind::Force {
            point, direction, ..
        } => point.is_finite() && direction.vector().is_finite(),
        LoadKind::Drag { point, .. } => point.is_finite(),
        LoadKind::Along(coordinate, strength) => strength.is_sound(coordinate.ends().is_some()),
        LoadKind::Special(couple) => couple.direction.vector().is_finite(),
    }
}

/// A kind of load in the evaluation frames of its bodies.
pub(super) type CompiledKind<C = f64> =
    AnyLoadKind<Vec3<C>, CoordinateFunction<C>, DirectedCouple<C>, C>;

/// On a body, at an arm from the origin of its evaluation frame, a force and a couple, in the axes of the ground.
pub(super) type BodyAction<T> = (usize, [Vec3<T>; 3]);

impl CompiledKind {
    /// Checks and compiles a kind of load.
    pub(super) fn new(
        kind: &LoadKind,
        mechanism: &Mechanism,
        plan: &Plan,
    ) -> Result<Self, &'static str> {
        let exists = |body: &BodyId| body.0 < mechanism.bodies.len();
        if !kind.bodies(mechanism).iter().all(exists) {
            return Err("it acts on a body that does not exist");
        }
        if !has_usable_numbers(kind) {
            return Err(NOT_FINITE);
        }
        let numbers = |joint: JointId| mechanism.joints[joint.0].numbers();
        let compiled = Self::in_frames(kind, mechanism, numbers, plan)?;
        if let Self::Along(CoordinateFunction::Distance { points, .. }, _) = compiled
            && !points.iter().all(|p| p.is_finite())
        {
            return Err(NOT_FINITE);
        }
        Ok(compiled)
    }

    /// Loads at rest whose forces span all forces that the load can exert in motion.
    pub(super) fn directions(&self) -> Vec<(Self, f64)> {
        match *self {
            Self::Drag { body, point } => {
                let along = |axis| Self::Force {
                    body,
                    point,
                    direction: Direction::Ground(axis),
                };
                Vec3::AXES.map(|axis| (along(axis), 1.0)).into()
            }
            Self::Along(coordinate, strength) if strength.resists() => {
                vec![(Self::Along(coordinate, Strength::Direct), -1.0)]
            }
            _ => vec![self.unit_load()],
        }
    }

    /// The potential energy of a unit of the load at a pose, J: zero at the origin of the ground's frame; `None` for a load without a
    /// potential.
    pub(super) fn potential(
        &self,
        plan: &Plan,
        pose: &Pose,
        masses: &[super::Mass],
    ) -> Option<f64> {
        let at = |body: usize, point: Vec3| plan.origin() + plan.frame(pose, body).point(point);
        match *self {
            Self::Gravity { direction } => {
                let weights = masses
                    .iter()
                    .enumerate()
                    .map(|(body, mass)| -mass.mass * at(body, mass.center).dot(direction));
                Some(weights.sum())
            }
            Self::Force {
                body,
                point,
                direction: Direction::Ground(direction),
            } => Some(-at(body.0, point).dot(direction)),
            Self::Along(coordinate, strength) => {
                let free = strength.free()?;
                let [value, ..] = plan.coordinate(pose, coordinate);
                Some(0.5 * (value - free) * (value - free))
            }
            Self::Force { .. } | Self::Drag { .. } | Self::Special(_) => None,
        }
    }
}

impl<C: Constant> CompiledKind<C> {
    /// A kind of load in the frames of a plan whose joints have these numbers.
    pub(super) fn in_frames(
        kind: &LoadKind<C>,
        mechanism: &Mechanism,
        numbers: impl Fn(JointId) -> JointNumbers<C>,
        plan: &Plan<C>,
    ) -> Result<Self, &'static str> {
        let frame = |body: BodyId| plan.evaluation_frame(body.0);
        let turned = |body: BodyId, direction: Direction<C>| match direction {
            Direction::Ground(u) => Direction::Ground(u),
            Direction::Body(u) => Direction::Body(frame(body).rotation.apply_inverse(u)),
        };
        let arm = |body: BodyId, point: Vec3<C>| frame(body).inner_point(point);
        Ok(match *kind {
            LoadKind::Gravity { direction } => Self::Gravity { direction },
            LoadKind::Force {
                body,
                point,
                direction,
            } => Self::Force {
                body,
                point: arm(body, point),
                direction: turned(body, direction),
            },
            LoadKind::Drag { body, point } => Self::Drag {
                body,
                point: arm(body, point),
            },
            LoadKind::Along(coordinate, strength) => {
                let revolutions = match (coordinate, strength.free()) {
                    // Without the angle itself.
                    (Coordinate::Angle(_), None) => CountedRevolutions::IfPossible,
                    _ => CountedRevolutions::Always,
                };
                let function = plan.function_of(mechanism, numbers, coordinate, revolutions)?;
                Self::Along(function, strength)
            }
            LoadKind::Special(DirectedCouple { bodies, direction }) => {
                let direction = turned(bodies[0], direction);
                Self::Special(DirectedCouple { bodies, direction })
            }
        })
    }

    /// Gives the forces and couples on the bodies at magnitude `f` to `add`; `None` if it has no direction.
    #[inline]
    pub(super) fn act<T: Lift<C>>(
        &self,
        f: T,
        plan: &Plan<C>,
        pose: &Pose<T>,
        masses: &[super::Mass<C>],
        mut add: impl FnMut(BodyAction<T>),
    ) -> Option<()> {
        let zero = Vec3::zero();
        let turned = |body: BodyId, direction: Direction<C>| match direction {
            Direction::Ground(u) => u.cast(),
            Direction::Body(u) => plan.frame(pose, body.0).rotation.apply(u.cast()),
        };
        match *self {
            Self::Gravity { direction } => {
                let pull = direction.cast().scaled(f);
                for (body, mass) in masses
                    .iter()
                    .enumerate()
                    .filter(|(_, m)| m.mass.value() > 0.0)
                {
                    let arm = plan.frame(pose, body).rotation.apply(mass.center.cast());
                    add((body, [arm, pull.scaled(T::lift(mass.mass)), zero]));
                }
            }
            Self::Force {
                body,
                point,
                direction,
            } => {
                let arm = plan.frame(pose, body.0).rotation.apply(point.cast());
                add((body.0, [arm, turned(body, direction).scaled(f), zero]));
            }
            Self::Drag { body, point } => {
                let arm = plan.frame(pose, body.0).rotation.apply(point.cast());
                let state = plan.state(pose, body.0);
                let velocity = state.velocity + state.angular_velocity.cross(arm);
                add((body.0, [arm, drag(f, velocity), zero]));
            }
            Self::Special(DirectedCouple { bodies, direction }) => {
                let couple = turned(bodies[0], direction).scaled(f);
                couples(bodies, couple, add);
            }
            Self::Along(coordinate, strength) => {
                return act_along(coordinate, strength, f, plan, pose, add);
            }
        }
        Some(())
    }
}

/// The forces and couples of a load along a coordinate; `None` if it has no direction.
#[inline]
fn act_along<C: Constant, T: Lift<C>>(
    coordinate: CoordinateFunction<C>,
    strength: Strength<C>,
    f: T,
    plan: &Plan<C>,
    pose: &Pose<T>,
    mut add: impl FnMut(BodyAction<T>),
) -> Option<()> {
    let arm = |body: BodyId, point: Vec3<C>| plan.frame(pose, body.0).rotation.apply(point.cast());
    let along = || {
        let value = || plan.coordinate(pose, coordinate)[0];
        strength.force(f, value, || plan.coordinate_rate(pose, coordinate))
    };
    let (bodies, arms, force) = match coordinate {
        CoordinateFunction::Angle { bodies, axis, .. } => {
            let couple = arm(bodies[0], axis).scaled(along());
            couples(bodies, couple, add);
            return Some(());
        }
        CoordinateFunction::Travel(guide) => {
            let (bodies, points) = (guide.bodies, guide.points);
            let force = arm(bodies[0], guide.axis).scaled(along());
            let [d, ..] = plan.separation(pose, bodies, points);
            // On both bodies at the second body's point.
            let arms = [arm(bodies[0], points[0]) + d, arm(bodies[1], points[1])];
            (bodies, arms, force)
        }
        CoordinateFunction::Distance { bodies, points } => {
            let [gap, velocity, _] = plan.separation(pose, bodies, points);
            let square = gap.dot(gap);
            let inverse = || T::from_f64(1.0) / square.sqrt();
            let line = Line {
                gap,
                direction: (square.value() > 0.0).then(|| gap.scaled(inverse())),
                velocity,
            };
            let force = strength.force_along_line(f, &line)?;
            (bodies, [0, 1].map(|k| arm(bodies[k], points[k])), force)
        }
    };
    for (k, force) in [-force, force].into_iter().enumerate() {
        add((bodies[k].0, [arms[k], force, Vec3::zero()]));
    }
    Some(())
}

/// A couple on the second body and the opposite on the first.
#[inline]
fn couples<T: Scalar>(bodies: [BodyId; 2], couple: Vec3<T>, mut add: impl FnMut(BodyAction<T>)) {
    for (body, couple) in bodies.into_iter().zip([-couple, couple]) {
        add((body.0, [Vec3::zero(), Vec3::zero(), couple]));
    }
}
