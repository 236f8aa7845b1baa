//! Forces and couples on bodies, and the forces and couples of a load at its two ends.

use super::{Direction, Guide, Line, LoadKind, LoadState, Mesh, Strength, drag};
use crate::mass::Mass;
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::{ActuatorId, BodyId, Joint, JointId, JointKind, Mechanism, Plan, Vec2};
use dwell_numerics::{Constant, Lift, Scalar, map_array};

/// The cause of a wrench on a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceSource {
    /// A load, by its index in the model.
    Load(usize),
    /// A joint.
    Joint(JointId),
    /// An actuator.
    Actuator(ActuatorId),
}

/// A force and a couple on one body, in ground axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AppliedWrench<T = f64> {
    /// Its cause.
    pub source: ForceSource,
    /// The body it acts on; the ground may be one.
    pub body: BodyId,
    /// The force, N.
    pub force: Vec2<T>,
    /// From the body's origin to the point where the force acts, m.
    pub moment_arm: Vec2<T>,
    /// The couple, in addition to the force, N·m.
    pub couple: T,
}

impl<T: Scalar> AppliedWrench<T> {
    /// The point where the force acts, in the ground's frame, m.
    pub fn point(&self, states: &BodyStates<T>) -> Vec2<T> {
        states.origin().cast() + states.body(self.body).joint_origin + self.moment_arm
    }

    /// Its power, W.
    pub fn power(&self, states: &BodyStates<T>) -> T {
        let body = states.body(self.body);
        self.force.dot(body.velocity_at(self.moment_arm)) + self.couple * body.angular_velocity
    }

    /// Its moment about the body's origin, N·m.
    pub fn moment(&self) -> T {
        self.moment_arm.cross(self.force) + self.couple
    }
}

/// The wrenches on two bodies, each with its moment arm, force and couple.
#[inline]
pub(crate) fn on_two_bodies<T: Scalar>(
    source: ForceSource,
    bodies: [BodyId; 2],
    moment_arms: [Vec2<T>; 2],
    actions: [(Vec2<T>, T); 2],
) -> [AppliedWrench<T>; 2] {
    map_array([0, 1], |i: usize| AppliedWrench {
        source,
        body: bodies[i],
        force: actions[i].0,
        moment_arm: moment_arms[i],
        couple: actions[i].1,
    })
}

/// Where a load finds what its kind alone does not tell: the bodies that have weight, with mass and centre, and the points of its two bodies
/// at which a couple acts.
pub(crate) struct LoadPlaces<'a, C = f64> {
    pub(crate) weighted_bodies: &'a [(BodyId, Mass<C>)],
    pub(crate) couple_points: [Vec2<C>; 2],
}

impl<C: Constant> LoadKind<C> {
    /// Adds the wrenches of a load of this kind and magnitude `f`; `None` if it has no direction.
    #[inline]
    pub(crate) fn add_wrenches<T: Lift<C>>(
        &self,
        f: T,
        source: ForceSource,
        places: &LoadPlaces<'_, C>,
        states: &BodyStates<T, C>,
        out: &mut LoadState<T>,
    ) -> Option<()> {
        let couple = T::from_f64(0.0);
        let at_point = |body: BodyId, point: Vec2<C>, force: Vec2<T>| AppliedWrench {
            source,
            body,
            force,
            moment_arm: states.body(body).moment_arm(point),
            couple,
        };
        match *self {
            LoadKind::Gravity { direction } => {
                let pull = direction.cast() * f;
                out.gravity += pull;
                let weight = |&(body, Mass { mass, center, .. }): &(BodyId, Mass<C>)| {
                    at_point(body, center, pull * T::lift(mass))
                };
                out.wrenches
                    .extend(places.weighted_bodies.iter().map(weight));
            }
            LoadKind::Force {
                body,
                point,
                direction,
            } => {
                let unit = match direction {
                    Direction::Ground(unit) => unit.cast(),
                    Direction::Body(unit) => unit.cast().rotate(states.body(body).rotation),
                };
                out.wrenches.push(at_point(body, point, unit * f));
            }
            LoadKind::Drag { body, point } => {
                let force = drag(f, states.point(body, point).velocity);
                out.wrenches.push(at_point(body, point, force));
            }
            LoadKind::Along(coordinate, strength) => {
                let pair = along(f, source, (coordinate, strength), places, states)?;
                out.wrenches.extend(pair);
            }
            // On both bodies at the pitch point.
            LoadKind::Special(ref mesh) => {
                let &Mesh { bodies, points, .. } = mesh;
                let [pitch_point, away] = mesh.pitch_point(states)?;
                let [first, second] = moment_arms(states, bodies, points);
                let between = states.separation(bodies, points).gap + pitch_point;
                let arms = [first + between, second + pitch_point];
                out.wrenches.extend(forces(source, bodies, arms, away * f));
            }
        }
        Some(())
    }
}

/// The wrenches of a load of this law along a coordinate; `None` if it has no direction.
#[inline]
fn along<C: Constant, T: Lift<C>>(
    f: T,
    source: ForceSource,
    (coordinate, strength): (CoordinateFunction<C>, Strength<C>),
    places: &LoadPlaces<'_, C>,
    states: &BodyStates<T, C>,
) -> Option<[AppliedWrench<T>; 2]> {
    Some(match coordinate {
        CoordinateFunction::Angle(bodies) => {
            let angle = || states.angle(bodies);
            let couple = strength.force(f, || angle()[0], || angle()[1]);
            let actions = [(Vec2::zero(), -couple), (Vec2::zero(), couple)];
            let arms = moment_arms(states, bodies, places.couple_points);
            on_two_bodies(source, bodies, arms, actions)
        }
        // Along the guide, on both bodies at the second body's point.
        CoordinateFunction::Travel(guide) => {
            let Guide { bodies, points, .. } = guide;
            let travel = || states.coordinate(coordinate);
            let f = strength.force(f, || travel()[0], || travel()[1]);
            let force = guide.axis.cast().rotate(states.body(bodies[0]).rotation) * f;
            let [first, second] = moment_arms(states, bodies, points);
            let gap = states.separation(bodies, points).gap;
            forces(source, bodies, [first + gap, second], force)
        }
        CoordinateFunction::Length { bodies, points } => {
            let between = states.separation(bodies, points);
            let line = Line {
                gap: between.gap,
                direction: between.direction,
                velocity: between.velocity,
            };
            let force = strength.force_along_line(f, &line)?;
            forces(source, bodies, moment_arms(states, bodies, points), force)
        }
    })
}

/// From the origins of two bodies to a point on each.
#[inline]
fn moment_arms<C: Constant, T: Lift<C>>(
    states: &BodyStates<T, C>,
    bodies: [BodyId; 2],
    points: [Vec2<C>; 2],
) -> [Vec2<T>; 2] {
    map_array([0, 1], |k: usize| {
        states.body(bodies[k]).moment_arm(points[k])
    })
}

/// A force on the second of two bodies, and its opposite on the first.
#[inline]
fn forces<T: Scalar>(
    source: ForceSource,
    bodies: [BodyId; 2],
    moment_arms: [Vec2<T>; 2],
    force: Vec2<T>,
) -> [AppliedWrench<T>; 2] {
    let zero = T::from_f64(0.0);
    on_two_bodies(source, bodies, moment_arms, [(-force, zero), (force, zero)])
}

/// The points of two bodies at which a couple between them acts: those of a joint between them, of a revolute one
/// if there is one; else the origins of the bodies.
pub(crate) fn find_couple_points(
    mechanism: &Mechanism,
    plan: &Plan,
    bodies: [BodyId; 2],
) -> [Vec2; 2] {
    let joints = || {
        let between = |j: &&Joint| j.bodies == bodies || j.bodies == [bodies[1], bodies[0]];
        mechanism.joints.iter().filter(between)
    };
    let pin = joints().find(|j| j.kind == JointKind::Revolute);
    match pin.or_else(|| joints().next()) {
        Some(joint) if joint.bodies == bodies => joint.points,
        Some(joint) => [joint.points[1], joint.points[0]],
        None => bodies.map(|b| plan.tree().joint_origins[b.0]),
    }
}
