//! All forces and couples on every body, from joints, actuators and loads, by the reactions and actions of one
//! evaluation.

use crate::error::ModelError;
use crate::load::{AppliedWrench, ForceSource, Mesh, find_couple_points, on_two_bodies};
use crate::model::Model;
use crate::model::stages::EvaluatedState;
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::{
    ActuatorId, BodyId, Condition, Coupling, Guide, Joint, JointId, JointKind, Reaction, Vec2, vec2,
};

/// Converts reactions and actuator forces into forces and couples on the bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeBodyForces {
    joints: Vec<JointEntry>,
    /// By actuator: its coordinate.
    actuators: Vec<Option<ActedCoordinate>>,
    pub(crate) ground: BodyId,
}

/// A coordinate, with the points of its bodies at which a couple along it acts.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ActedCoordinate {
    function: CoordinateFunction,
    couple_points: [Vec2; 2],
}

/// A joint with the indices of its components in the model's reactions.
#[derive(Debug, Clone, PartialEq)]
struct JointEntry {
    joint: Joint,
    reaction_indices: [usize; 3],
    /// For a coupling: the dependent and the independent coordinate.
    coupling: Option<[ActedCoordinate; 2]>,
}

impl FreeBodyForces {
    /// For a model that computes every reaction of its mechanism.
    ///
    /// # Errors
    /// [`ModelError::Reaction`] with the first reaction that the model does not compute.
    pub fn new(model: &Model) -> Result<Self, ModelError> {
        let mechanism = model.mechanism();
        let coordinate = |coordinate| {
            let function = CoordinateFunction::find(mechanism, coordinate)?;
            let couple_points = match function {
                CoordinateFunction::Angle(bodies) => {
                    find_couple_points(mechanism, model.plan(), bodies)
                }
                CoordinateFunction::Travel { .. } | CoordinateFunction::Length { .. } => {
                    [Vec2::ZERO; 2]
                }
            };
            Some(ActedCoordinate {
                function,
                couple_points,
            })
        };
        let mut joints = Vec::with_capacity(mechanism.joints.len());
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let id = JointId(j);
            let mut reaction_indices = [0; 3];
            let components = mechanism.components(id).iter();
            for (index, &component) in reaction_indices.iter_mut().zip(components) {
                let reaction = Reaction {
                    joint: id,
                    component,
                };
                let found = model.reactions().iter().position(|&r| r == reaction);
                *index = found.ok_or(ModelError::Reaction(reaction))?;
            }
            let law = if let JointKind::Coupling(r) = joint.kind {
                mechanism.couplings.get(r)
            } else {
                None
            };
            let both =
                |law: &Coupling| Some([coordinate(law.dependent)?, coordinate(law.independent)?]);
            let coupling = law.and_then(both);
            joints.push(JointEntry {
                joint: joint.clone(),
                reaction_indices,
                coupling,
            });
        }
        let actuators = mechanism.actuators.iter();
        Ok(Self {
            joints,
            actuators: actuators.map(|a| coordinate(a.coordinate())).collect(),
            ground: BodyId(mechanism.ground),
        })
    }

    /// Replaces `wrenches` by those of all joints, actuators and loads on all bodies and the ground at a state.
    pub fn wrenches(&self, state: &EvaluatedState<'_>, wrenches: &mut Vec<AppliedWrench>) {
        let (states, result) = (state.bodies(), state.inverse_dynamics());
        wrenches.clear();
        for (j, entry) in self.joints.iter().enumerate() {
            let source = ForceSource::Joint(JointId(j));
            let value = |i: usize| result.reactions[entry.reaction_indices[i]];
            if let Some(coupling) = entry.coupling {
                if value(0) == 0.0 {
                    // In a pruned group the law has not been evaluated.
                    continue;
                }
                let plan = state.model().plan();
                let slope = plan.coupling_slope(JointId(j), state.pose()).unwrap_or(0.0);
                coupling_wrenches(coupling, value(0), slope, source, states, wrenches);
            } else {
                joint_wrenches(&entry.joint, value, source, states, wrenches);
            }
        }
        for (i, (&coordinate, &tau)) in self.actuators.iter().zip(&result.tau).enumerate() {
            let source = ForceSource::Actuator(ActuatorId(i));
            if let Some(coordinate) = coordinate {
                coordinate_wrenches(coordinate, tau, source, states, wrenches);
            }
        }
        wrenches.extend_from_slice(&state.loads().wrenches);
    }
}

/// The wrenches of a coupling, dependent = law(independent): −λ times the law's slope acts along the independent
/// coordinate.
fn coupling_wrenches(
    [dependent, independent]: [ActedCoordinate; 2],
    lambda: f64,
    slope: f64,
    by: ForceSource,
    states: &BodyStates,
    acts: &mut Vec<AppliedWrench>,
) {
    coordinate_wrenches(dependent, lambda, by, states, acts);
    coordinate_wrenches(independent, -lambda * slope, by, states, acts);
}

/// The wrenches of a joint on its two bodies.
fn joint_wrenches(
    joint: &Joint,
    value: impl Fn(usize) -> f64,
    source: ForceSource,
    states: &BodyStates,
    wrenches: &mut Vec<AppliedWrench>,
) {
    let Joint { bodies, points, .. } = *joint;
    let [one, two] = bodies.map(|b| states.body(b));
    let second = two.joint_origin + two.moment_arm(points[1]);
    let axis_of = |axis: Vec2| axis.rotate(one.rotation);
    // The point where the force on the second body acts, that force, and the couple on it.
    let (mut at, mut force, mut couple) = (second, Vec2::ZERO, 0.0);
    let mut next = 0..;
    let mut value = || next.next().map_or(0.0, &value);
    for condition in joint.kind.conditions() {
        match condition {
            Condition::Together => force = vec2(value(), value()),
            Condition::OnLine { axis, .. } => force = axis_of(axis).perp() * value(),
            Condition::Turned { .. } => couple = value(),
            Condition::Rolled { axis, radius } => {
                let t = axis_of(axis);
                at = second - t.perp() * radius;
                force += t * value();
            }
            Condition::Meshed { radii, .. } => {
                let found = Mesh::of(joint).and_then(|mesh| mesh.pitch_point(states));
                let [to_pitch_point, _] = found.unwrap_or([Vec2::ZERO; 2]);
                at = second + to_pitch_point;
                force = to_pitch_point.perp() * (1.0 / radii[1]) * value();
            }
            Condition::Apart { .. } => {
                let length = ActedCoordinate {
                    function: CoordinateFunction::Length { bodies, points },
                    couple_points: points,
                };
                return coordinate_wrenches(length, value(), source, states, wrenches);
            }
            Condition::Coupled(_) => return,
        }
    }
    opposite_wrenches(bodies, at, force, couple, source, states, wrenches);
}

/// A force on the second body at a point (from the origin of the states) with a couple, and their opposites on the
/// first.
fn opposite_wrenches(
    bodies: [BodyId; 2],
    at: Vec2,
    force: Vec2,
    couple: f64,
    source: ForceSource,
    states: &BodyStates,
    wrenches: &mut Vec<AppliedWrench>,
) {
    let moment_arms = bodies.map(|body| at - states.body(body).joint_origin);
    let actions = [(-force, -couple), (force, couple)];
    wrenches.extend(on_two_bodies(source, bodies, moment_arms, actions));
}

/// A generalised force along a coordinate: a couple, a force along an axis at the second body's point, or a force along
/// the line of two points.
fn coordinate_wrenches(
    acted: ActedCoordinate,
    value: f64,
    source: ForceSource,
    states: &BodyStates,
    wrenches: &mut Vec<AppliedWrench>,
) {
    let (bodies, points, actions) = match acted.function {
        CoordinateFunction::Travel(Guide {
            bodies,
            points,
            axis,
        }) => {
            let [one, two] = bodies.map(|b| states.body(b));
            let force = axis.rotate(one.rotation) * value;
            let at = two.joint_origin + two.moment_arm(points[1]);
            return opposite_wrenches(bodies, at, force, 0.0, source, states, wrenches);
        }
        CoordinateFunction::Angle(bodies) => (
            bodies,
            acted.couple_points,
            [(Vec2::ZERO, -value), (Vec2::ZERO, value)],
        ),
        CoordinateFunction::Length { bodies, points } => {
            // A length of zero has no pose, so that it is not evaluated here.
            let direction = states.separation(bodies, points).direction;
            let force = direction.unwrap_or(Vec2::ZERO) * value;
            (bodies, points, [(-force, 0.0), (force, 0.0)])
        }
    };
    let moment_arms = [0, 1].map(|i| states.body(bodies[i]).moment_arm(points[i]));
    wrenches.extend(on_two_bodies(source, bodies, moment_arms, actions));
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use dwell_geometry::{Actuator, AssemblyConfiguration, Body, Mechanism, Plan};

    const GROUND: BodyId = BodyId(0);
    const ONE: BodyId = BodyId(1);
    const TWO: BodyId = BodyId(2);
    const A: Vec2 = vec2(0.2, 0.1);
    const B: Vec2 = vec2(0.9, 0.4);

    /// Two bodies pinned to each other, the first to the ground, at these velocities: any joint can be imagined
    /// between two of the three.
    fn states(velocities: [f64; 2]) -> BodyStates {
        let pin = |bodies, points| Joint::revolute("pin", bodies, points);
        let actuator = |bodies| Actuator::angle("q", bodies);
        let mechanism = Mechanism {
            bodies: ["ground", "one", "two"].map(Body::named).into(),
            joints: vec![pin([GROUND, ONE], [A, Vec2::ZERO]), pin([ONE, TWO], [B, B])],
            actuators: vec![actuator([GROUND, ONE]), actuator([GROUND, TWO])],
            ..Mechanism::default()
        };
        let assembly = AssemblyConfiguration {
            q: vec![0.3, -0.8],
            initial_guess: vec![None; 3],
            ..AssemblyConfiguration::default()
        };
        let plan = Plan::compile(&mechanism, &assembly).unwrap();
        let (mut pose, mut motion) = (plan.pose(), plan.motion());
        plan.positions(&assembly.q, &mut pose).unwrap();
        plan.velocities(&pose, &velocities, &mut motion);
        let mut states = BodyStates::new(&plan);
        states.fill(&plan, &pose, &motion);
        states
    }

    fn power(joint: &Joint, value: [f64; 3], states: &BodyStates) -> f64 {
        let mut wrenches = Vec::new();
        let source = ForceSource::Joint(JointId(0));
        joint_wrenches(joint, |i| value[i], source, states, &mut wrenches);
        wrenches.iter().map(|wrench| wrench.power(states)).sum()
    }

    /// The rate of each row of a joint, from the formulas of [`JointKind`], at points that keep the row.
    fn row_rates(joint: &Joint, states: &BodyStates) -> Vec<f64> {
        let gap = states.separation(joint.bodies, joint.points);
        let [w1, w2] = joint.bodies.map(|b| states.body(b).angular_velocity);
        let parts = |axis: Vec2| {
            let t = axis.rotate(states.body(joint.bodies[0]).rotation);
            let relative = gap.velocity - gap.gap.perp() * w1;
            (t.dot(relative), t.perp().dot(relative))
        };
        match joint.kind {
            JointKind::Weld { .. } => vec![gap.velocity.x, gap.velocity.y, w2 - w1],
            JointKind::Slot { axis } => vec![parts(axis).1],
            JointKind::Gear { radii, internal } => {
                let psi = gap.gap.cross(gap.velocity) / gap.gap.dot(gap.gap);
                let sign = if internal { -1.0 } else { 1.0 };
                vec![radii[1] * (w2 - psi) + sign * radii[0] * (w1 - psi)]
            }
            JointKind::Rack { axis, radius } => vec![parts(axis).0 + radius * (w2 - w1)],
            JointKind::Rolling { axis, radius } => {
                let (along, normal) = parts(axis);
                vec![normal, along + radius * (w2 - w1)]
            }
            JointKind::Distance { .. } => vec![gap.direction.unwrap().dot(gap.velocity)],
            _ => Vec::new(),
        }
    }

    /// An axis in the first body's frame whose normal distance to the second point is `above`.
    fn axis_through(bodies: [BodyId; 2], points: [Vec2; 2], above: f64) -> Vec2 {
        let states = states([0.0; 2]);
        let gap = states.separation(bodies, points);
        // n·gap = `above`.
        let inclination = (above / gap.length).asin();
        let direction = Vec2::from_angle(gap.gap.angle() - inclination);
        direction.rotate_inverse(states.body(bodies[0]).rotation)
    }

    /// The power of a multiplier is its value times the rate of its row: this is the meaning of conjugate, and with the
    /// rows of `JointKind` it determines every sign and every point of application.
    #[test]
    fn a_component_works_at_the_rate_of_its_row() {
        let between = [ONE, TWO];
        let points = [vec2(0.1, -0.2), vec2(0.4, 0.7)];
        let distance = states([0.0; 2]).separation(between, points).length;
        let gear = |small: f64, internal: bool| JointKind::Gear {
            radii: if internal {
                [small + distance, small]
            } else {
                [small, distance - small]
            },
            internal,
        };
        let swapped = JointKind::Gear {
            radii: [0.2, 0.2 + distance],
            internal: true,
        };
        let axis = |above| axis_through(between, points, above);
        let track = |radius| JointKind::Rolling {
            axis: axis(radius),
            radius,
        };
        let rack = |radius| JointKind::Rack {
            axis: axis(radius),
            radius,
        };
        let kinds = [
            (points, gear(0.15, false)),
            (points, gear(0.15, true)),
            (points, swapped),
            (points, rack(0.12)),
            (points, rack(-0.12)),
            (points, track(0.2)),
            (points, track(-0.2)),
            (points, JointKind::Slot { axis: axis(0.0) }),
            (points, JointKind::Distance { length: distance }),
            ([B, B], JointKind::Weld { angle: -1.1 }),
        ];
        for (points, kind) in kinds {
            let joint = Joint::new("thought", between, points, kind);
            for velocities in [[1.0, 0.0], [0.0, 1.0], [-0.7, 2.3]] {
                let states = states(velocities);
                let rates = row_rates(&joint, &states);
                for (i, rate) in rates.iter().enumerate() {
                    let mut value = [0.0; 3];
                    value[i] = 3.0;
                    let difference = power(&joint, value, &states) - 3.0 * rate;
                    // Powers of a few watts.
                    assert!(difference.abs() < 1e-14, "{kind:?} {i}: {difference}");
                }
            }
        }
    }

    /// The same for a force along a coordinate.
    #[test]
    fn a_force_works_at_the_speed_of_its_coordinate() {
        let bodies = [ONE, TWO];
        let points = [vec2(0.1, -0.2), vec2(0.4, 0.7)];
        let axis = axis_through(bodies, points, 0.0);
        let all = [
            CoordinateFunction::Angle(bodies),
            CoordinateFunction::Length { bodies, points },
            CoordinateFunction::Travel(Guide {
                bodies,
                points,
                axis,
            }),
        ];
        let states = states([-0.7, 2.3]);
        for coordinate in all {
            let mut wrenches = Vec::new();
            let source = ForceSource::Actuator(ActuatorId(0));
            let acted = ActedCoordinate {
                function: coordinate,
                couple_points: points,
            };
            coordinate_wrenches(acted, 3.0, source, &states, &mut wrenches);
            let power: f64 = wrenches.iter().map(|wrench| wrench.power(&states)).sum();
            let velocity = states.coordinate(coordinate)[1];
            assert!((power - 3.0 * velocity).abs() < 1e-14, "{coordinate:?}");
        }
    }

    /// A coupling's row is dependent − law(independent).
    #[test]
    fn a_coupling_works_at_the_rate_of_its_row() {
        let bodies = [ONE, TWO];
        let points = [vec2(0.1, -0.2), vec2(0.4, 0.7)];
        let dependent = CoordinateFunction::Length { bodies, points };
        let independent = CoordinateFunction::Angle(bodies);
        let coupling = [dependent, independent].map(|function| ActedCoordinate {
            function,
            couple_points: points,
        });
        let states = states([-0.7, 2.3]);
        let mut wrenches = Vec::new();
        let joint = ForceSource::Joint(JointId(0));
        coupling_wrenches(coupling, 3.0, 0.8, joint, &states, &mut wrenches);
        let power: f64 = wrenches.iter().map(|wrench| wrench.power(&states)).sum();
        let rate = states.coordinate(dependent)[1] - 0.8 * states.coordinate(independent)[1];
        assert!((power - 3.0 * rate).abs() < 1e-14);
    }
}
