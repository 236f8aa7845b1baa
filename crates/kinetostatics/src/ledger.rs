//! Who acts on which body: joints, actuators and loads as forces and couples, from the reactions and
//! actions of one evaluation.

use crate::acts::{Act, By};
use crate::model::{Actions, Model, ModelError, Workspace};
use dwell_geometry::measure::{BodyStates, Measured};
use dwell_geometry::{
    ActuatorId, BodyId, Joint, JointId, JointKind, Mechanism, Plan, Reaction, Vec2,
};

/// Turns reactions and actuator actions into what they do to the bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct Ledger {
    joints: Vec<Entry>,
    /// By actuator: what it drives, and where its couple stands on its bodies.
    actuators: Vec<(Measured, [Vec2; 2])>,
    pub(crate) ground: BodyId,
}

/// A joint with the places of its components among the model's reactions.
#[derive(Debug, Clone, PartialEq)]
struct Entry {
    joint: Joint,
    components: [usize; 3],
    /// For a relation: both coordinates, with where their couples stand, and its law.
    relation: Option<Related>,
}

#[derive(Debug, Clone, PartialEq)]
struct Related {
    of: (Measured, [Vec2; 2]),
    by: (Measured, [Vec2; 2]),
    law: dwell_laws::Law,
}

impl Ledger {
    /// The ledger of a model for which every reaction was asked for.
    ///
    /// # Errors
    /// [`ModelError::Reaction`] with the first reaction that the model does not compute.
    pub fn new(mechanism: &Mechanism, model: &Model) -> Result<Self, ModelError> {
        let coordinate = |coordinate| {
            let measured = Measured::find(mechanism, coordinate)?;
            let stands = match measured {
                Measured::Angle(bodies) => meeting(mechanism, model.plan(), bodies),
                _ => [Vec2::ZERO; 2],
            };
            Some((measured, stands))
        };
        let mut joints = Vec::with_capacity(mechanism.joints.len());
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let mut components = [0; 3];
            for (place, &component) in components.iter_mut().zip(mechanism.components(JointId(j))) {
                let reaction = Reaction {
                    joint: JointId(j),
                    component,
                };
                let found = model.reactions().iter().position(|&r| r == reaction);
                *place = found.ok_or(ModelError::Reaction(reaction))?;
            }
            let relation = match joint.kind {
                JointKind::Relation(r) => mechanism.relations.get(r).and_then(|relation| {
                    Some(Related {
                        of: coordinate(relation.of)?,
                        by: coordinate(relation.by)?,
                        law: relation.law.clone(),
                    })
                }),
                _ => None,
            };
            joints.push(Entry {
                joint: joint.clone(),
                components,
                relation,
            });
        }
        let drives = mechanism.actuators.iter();
        Ok(Self {
            joints,
            actuators: drives.filter_map(|a| coordinate(a.coordinate())).collect(),
            ground: BodyId(mechanism.ground),
        })
    }

    /// Everything that acts on a body, or by a body on the ground, at the state that
    /// [`Model::kinetostatics`] evaluated last into `work` and `actions`: joints, actuators, loads.
    pub fn acts(&self, work: &Workspace<f64>, actions: &Actions<f64>, acts: &mut Vec<Act>) {
        let states = work.states();
        acts.clear();
        for (j, entry) in self.joints.iter().enumerate() {
            let by = By::Joint(JointId(j));
            let value = |i: usize| actions.reactions[entry.components[i]];
            if let Some(Related { of, by: other, law }) = &entry.relation {
                // of − law(by) = 0: the other coordinate feels −λ times the law's slope.
                let lambda = value(0);
                let slope = law.at(states.measure(other.0)[0])[1];
                push(*of, lambda, by, states, acts);
                push(*other, -lambda * slope, by, states, acts);
            } else {
                joint_acts(&entry.joint, value, by, states, acts);
            }
        }
        for (i, (&drive, &tau)) in self.actuators.iter().zip(&actions.tau).enumerate() {
            push(drive, tau, By::Actuator(ActuatorId(i)), states, acts);
        }
        acts.extend_from_slice(&work.loads().acts);
    }
}

/// What a joint does to its two bodies.
fn joint_acts(
    joint: &Joint,
    value: impl Fn(usize) -> f64,
    by: By,
    states: &BodyStates,
    acts: &mut Vec<Act>,
) {
    let Joint { bodies, points, .. } = *joint;
    let [one, two] = bodies.map(|b| states.body(b));
    let second = two.root + two.arm(points[1]);
    let toward = || states.separation(bodies, points).direction;
    let axis_of = |axis: Vec2| axis.turn(one.turn);
    // The force on the second body and where it acts, and the couple on it.
    let (at, force, couple) = match joint.kind {
        JointKind::Revolute => (
            second,
            Vec2 {
                x: value(0),
                y: value(1),
            },
            0.0,
        ),
        JointKind::Weld { .. } => (
            second,
            Vec2 {
                x: value(0),
                y: value(1),
            },
            value(2),
        ),
        JointKind::Prismatic { axes } => (second, axis_of(axes[0]).perp() * value(0), value(1)),
        JointKind::Slot { axis } => (second, axis_of(axis).perp() * value(0), 0.0),
        JointKind::Gear { radii, internal } => {
            let u = toward().unwrap_or(Vec2::ZERO);
            // From the second's centre to the pitch point; a ring reaches over the other's centre.
            let reach = if internal && radii[0] > radii[1] {
                u * radii[1]
            } else {
                u * -radii[1]
            };
            let tangent = reach.perp() * (1.0 / radii[1]);
            (second + reach, tangent * value(0), 0.0)
        }
        JointKind::Rack { axis, radius } => {
            let t = axis_of(axis);
            (second - t.perp() * radius, t * value(0), 0.0)
        }
        JointKind::Rolling { axis, radius } => {
            let t = axis_of(axis);
            let force = t.perp() * value(0) + t * value(1);
            (second - t.perp() * radius, force, 0.0)
        }
        JointKind::Distance { .. } => {
            push(
                (Measured::Length { bodies, points }, points),
                value(0),
                by,
                states,
                acts,
            );
            return;
        }
        JointKind::Relation(_) => return,
    };
    pair(bodies, at, force, couple, by, states, acts);
}

/// A force on the second body at a point (from the states' origin) with a couple, and their
/// opposites on the first.
fn pair(
    bodies: [BodyId; 2],
    at: Vec2,
    force: Vec2,
    couple: f64,
    by: By,
    states: &BodyStates,
    acts: &mut Vec<Act>,
) {
    for (body, sign) in bodies.into_iter().zip([-1.0, 1.0]) {
        acts.push(Act {
            by,
            body,
            force: force * sign,
            arm: at - states.body(body).root,
            couple: couple * sign,
        });
    }
}

/// The action along a coordinate: a couple, a force along an axis at the second body's point, or a
/// force along the line of two points.
fn push(
    (measured, stands): (Measured, [Vec2; 2]),
    value: f64,
    by: By,
    states: &BodyStates,
    acts: &mut Vec<Act>,
) {
    match measured {
        Measured::Travel {
            bodies,
            points,
            axis,
        } => {
            let [one, two] = bodies.map(|b| states.body(b));
            let force = axis.turn(one.turn) * value;
            let at = two.root + two.arm(points[1]);
            pair(bodies, at, force, 0.0, by, states, acts);
        }
        Measured::Angle(bodies) => {
            for i in 0..2 {
                acts.push(Act {
                    by,
                    body: bodies[i],
                    force: Vec2::ZERO,
                    arm: states.body(bodies[i]).arm(stands[i]),
                    couple: if i == 0 { -value } else { value },
                });
            }
        }
        Measured::Length { bodies, points } => {
            // A drive or a link of no length has no pose that gets here.
            let along = states.separation(bodies, points).direction;
            let force = along.unwrap_or(Vec2::ZERO) * value;
            for (i, sign) in [(0, -1.0), (1, 1.0)] {
                acts.push(Act {
                    by,
                    body: bodies[i],
                    force: force * sign,
                    arm: states.body(bodies[i]).arm(points[i]),
                    couple: 0.0,
                });
            }
        }
    }
}

/// Where a couple between two bodies stands on each: at a joint between them, a revolute one if
/// there is one; else at the point where each is carried.
pub(crate) fn meeting(mechanism: &Mechanism, plan: &Plan, bodies: [BodyId; 2]) -> [Vec2; 2] {
    let joints = || {
        let between = |j: &&Joint| j.bodies == bodies || j.bodies == [bodies[1], bodies[0]];
        mechanism.joints.iter().filter(between)
    };
    let pin = joints().find(|j| j.kind == JointKind::Revolute);
    match pin.or_else(|| joints().next()) {
        Some(joint) if joint.bodies == bodies => joint.points,
        Some(joint) => [joint.points[1], joint.points[0]],
        None => bodies.map(|b| plan.tree().roots[b.0]),
    }
}
