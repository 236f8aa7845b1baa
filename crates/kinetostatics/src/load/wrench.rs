//! Forces and couples on bodies, and those of a load at its two ends.

use super::{CompiledLoads, Guide, LoadKind, LoadState, Mesh};
use crate::mass::Mass;
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::{ActuatorId, BodyId, Joint, JointId, JointKind, Mechanism, Plan, Vec2};
use dwell_numerics::{Scalar, map_array};

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
    /// The couple beside it, N·m.
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

impl CompiledLoads {
    /// Adds the wrenches of the `i`th load, taken as of this kind and magnitude `f`; none where it has no direction.
    // Long because it has one arm for each kind of load.
    #[inline]
    pub(super) fn add_wrenches<T: Scalar>(
        &self,
        i: usize,
        kind: &LoadKind,
        f: T,
        states: &BodyStates<T>,
        out: &mut LoadState<T>,
    ) -> Option<()> {
        let (source, zero) = (ForceSource::Load(i), T::from_f64(0.0));
        let moment_arms_at = |bodies: [BodyId; 2], points: [Vec2; 2]| {
            map_array([0, 1], |i: usize| {
                states.body(bodies[i]).moment_arm(points[i])
            })
        };
        let forces = |bodies, moment_arms, force: Vec2<T>| {
            on_two_bodies(source, bodies, moment_arms, [(-force, zero), (force, zero)])
        };
        // Between two points: equal and opposite forces along the line.
        let along = |bodies, points, force| forces(bodies, moment_arms_at(bodies, points), force);
        let couples = |bodies, couple: T| {
            let actions = [(Vec2::zero(), -couple), (Vec2::zero(), couple)];
            let moment_arms = moment_arms_at(bodies, self.couple_points[i]);
            on_two_bodies(source, bodies, moment_arms, actions)
        };
        let on_both = match *kind {
            LoadKind::Gravity { direction } => {
                let pull = direction.cast() * f;
                out.gravity += pull;
                let weight = |&(body, Mass { mass, center, .. }): &(BodyId, Mass)| AppliedWrench {
                    source,
                    body,
                    force: pull * T::from_f64(mass),
                    moment_arm: states.body(body).moment_arm(center),
                    couple: zero,
                };
                out.wrenches.extend(self.weighted_bodies.iter().map(weight));
                return Some(());
            }
            LoadKind::Force {
                body,
                point,
                direction,
                body_fixed,
            } => {
                let state = states.body(body);
                let mut unit = direction.cast();
                if body_fixed {
                    unit = unit.rotate(state.rotation);
                }
                out.wrenches.push(AppliedWrench {
                    source,
                    body,
                    force: unit * f,
                    moment_arm: state.moment_arm(point),
                    couple: zero,
                });
                return Some(());
            }
            LoadKind::Torque { bodies } => couples(bodies, f),
            LoadKind::Spring {
                bodies,
                points,
                free_length: free,
            } => {
                let between = states.separation(bodies, points);
                // −k (P₂ − P₁) + k free e: the first part is smooth where the points meet.
                let mut force = -(between.gap * f);
                if free != 0.0 {
                    match between.direction {
                        Some(direction) => force += direction * (f * T::from_f64(free)),
                        None if f.value() == 0.0 => {}
                        None => return None,
                    }
                }
                along(bodies, points, force)
            }
            LoadKind::TorsionSpring { bodies, free_angle } => {
                let twist = states.angle(bodies)[0] - T::from_f64(free_angle);
                couples(bodies, -(f * twist))
            }
            LoadKind::Damper { bodies, points } => {
                let between = states.separation(bodies, points);
                let velocity = between.velocity;
                let still =
                    f.value() == 0.0 || (velocity.x.value() == 0.0 && velocity.y.value() == 0.0);
                let force = match between.direction {
                    Some(e) => -(e * (e.dot(velocity) * f)),
                    None if still => Vec2::zero(),
                    None => return None,
                };
                along(bodies, points, force)
            }
            LoadKind::RotationalDamper { bodies } => {
                couples(bodies, -(f * states.angle(bodies)[1]))
            }
            LoadKind::PointToPointForce { bodies, points } => {
                let force = match states.separation(bodies, points).direction {
                    Some(e) => e * f,
                    None if f.value() == 0.0 => Vec2::zero(),
                    None => return None,
                };
                along(bodies, points, force)
            }
            // On both bodies at the pitch point.
            LoadKind::SeparatingForce(ref mesh) => {
                let &Mesh { bodies, points, .. } = mesh;
                let [pitch_point, away] = mesh.pitch_point(states)?;
                let [first, second] = moment_arms_at(bodies, points);
                let between = states.separation(bodies, points).gap + pitch_point;
                forces(bodies, [first + between, second + pitch_point], away * f)
            }
            // Along the guide, on both bodies at the second body's point.
            LoadKind::SlideForce(ref guide) | LoadKind::SlideDamper(ref guide) => {
                let &Guide { bodies, points, .. } = guide;
                let f = match kind {
                    LoadKind::SlideDamper(_) => {
                        -(f * states.coordinate(CoordinateFunction::Travel(*guide))[1])
                    }
                    _ => f,
                };
                let force = guide.axis.cast().rotate(states.body(bodies[0]).rotation) * f;
                let [first, second] = moment_arms_at(bodies, points);
                let gap = states.separation(bodies, points).gap;
                forces(bodies, [first + gap, second], force)
            }
        };
        out.wrenches.extend(on_both);
        Some(())
    }
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
