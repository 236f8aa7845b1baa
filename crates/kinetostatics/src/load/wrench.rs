//! Forces and couples on bodies, and those of a load at its two ends.

use super::{Guide, LoadKind, Mesh};
use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{ActuatorId, BodyId, JointId, Vec2};
use dwell_numerics::Scalar;

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

pub(super) type LoadEnd<T> = Option<(BodyId, Vec2<T>, Vec2<T>, T)>;

/// The body, force, arm and couple at each end of a load of magnitude `f`; none where it has no
/// direction.
// Long because it has one arm for each kind of load.
pub(super) fn load_ends<T: Scalar>(
    kind: LoadKind,
    f: T,
    states: &BodyStates<T>,
    couple_points: [Vec2; 2],
) -> Option<[LoadEnd<T>; 2]> {
    let zero = T::from_f64(0.0);
    let couples = |bodies: [BodyId; 2], couple: T| {
        let end = |i: usize, couple| {
            let moment_arm = states.body(bodies[i]).moment_arm(couple_points[i]);
            Some((bodies[i], Vec2::zero(), moment_arm, couple))
        };
        Some([end(0, -couple), end(1, couple)])
    };
    // Between two points: equal and opposite forces along the line.
    let along = |bodies: [BodyId; 2], points: [Vec2; 2], force: Vec2<T>| {
        let end = |i: usize, force| {
            let moment_arm = states.body(bodies[i]).moment_arm(points[i]);
            Some((bodies[i], force, moment_arm, zero))
        };
        Some([end(0, -force), end(1, force)])
    };
    match kind {
        LoadKind::Gravity { .. } => Some([None, None]),
        LoadKind::Force {
            body,
            point,
            direction,
            body_fixed: follows,
        } => {
            let state = states.body(body);
            let mut unit = direction.cast();
            if follows {
                unit = unit.rotate(state.rotation);
            }
            Some([Some((body, unit * f, state.moment_arm(point), zero)), None])
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
        LoadKind::TorsionSpring {
            bodies,
            free_angle: free,
        } => couples(bodies, -(f * (states.angle(bodies)[0] - T::from_f64(free)))),
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
        LoadKind::RotationalDamper { bodies } => couples(bodies, -(f * states.angle(bodies)[1])),
        LoadKind::PointToPointForce { bodies, points } => {
            match states.separation(bodies, points).direction {
                Some(e) => along(bodies, points, e * f),
                None if f.value() == 0.0 => along(bodies, points, Vec2::zero()),
                None => None,
            }
        }
        LoadKind::SeparatingForce(mesh) => separating_force_ends(mesh, f, states),
        LoadKind::SlideForce(guide) => Some(slide_force_ends(guide, f, states)),
        LoadKind::SlideDamper(guide) => {
            let [_, velocity, _] = states.coordinate(guide.travel());
            Some(slide_force_ends(guide, -(f * velocity), states))
        }
    }
}

/// A force along a guide, on both bodies at the second body's point.
fn slide_force_ends<T: Scalar>(guide: Guide, f: T, states: &BodyStates<T>) -> [LoadEnd<T>; 2] {
    let Guide {
        bodies,
        points,
        axis,
    } = guide;
    let force = axis.cast().rotate(states.body(bodies[0]).rotation) * f;
    let on_first =
        states.body(bodies[0]).moment_arm(points[0]) + states.separation(bodies, points).gap;
    let on_second = states.body(bodies[1]).moment_arm(points[1]);
    let zero = T::from_f64(0.0);
    [
        Some((bodies[0], -force, on_first, zero)),
        Some((bodies[1], force, on_second, zero)),
    ]
}

/// A force that separates teeth, on both bodies at the pitch point.
fn separating_force_ends<T: Scalar>(
    mesh: Mesh,
    f: T,
    states: &BodyStates<T>,
) -> Option<[LoadEnd<T>; 2]> {
    let Mesh { bodies, points, .. } = mesh;
    let [pitch_point, away] = mesh.pitch_point(states)?;
    let force = away * f;
    let on_second = states.body(bodies[1]).moment_arm(points[1]) + pitch_point;
    let between = states.separation(bodies, points).gap + pitch_point;
    let on_first = states.body(bodies[0]).moment_arm(points[0]) + between;
    let zero = T::from_f64(0.0);
    Some([
        Some((bodies[0], -force, on_first, zero)),
        Some((bodies[1], force, on_second, zero)),
    ])
}
