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
    actuators: Vec<Option<(Measured, [Vec2; 2])>>,
    pub(crate) ground: BodyId,
}

/// A joint with the places of its components among the model's reactions.
#[derive(Debug, Clone, PartialEq)]
struct Entry {
    joint: Joint,
    components: [usize; 3],
    /// For a relation: both coordinates, with where their couples stand.
    relation: Option<Related>,
}

#[derive(Debug, Clone, PartialEq)]
struct Related {
    of: (Measured, [Vec2; 2]),
    by: (Measured, [Vec2; 2]),
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
            actuators: drives.map(|a| coordinate(a.coordinate())).collect(),
            ground: BodyId(mechanism.ground),
        })
    }

    /// Everything that acts on a body, or by a body on the ground, at the state that
    /// [`Model::kinetostatics`] evaluated last into `work` and `actions`: joints, actuators, loads.
    pub fn acts(
        &self,
        model: &Model,
        work: &Workspace<f64>,
        actions: &Actions<f64>,
        acts: &mut Vec<Act>,
    ) {
        let states = work.states();
        acts.clear();
        for (j, entry) in self.joints.iter().enumerate() {
            let by = By::Joint(JointId(j));
            let value = |i: usize| actions.reactions[entry.components[i]];
            if let Some(relation) = &entry.relation {
                if value(0) == 0.0 {
                    // Where the group is left out, its law has not been evaluated.
                    continue;
                }
                let slope = model.plan().relation_slope(JointId(j), &work.pose);
                relate(relation, value(0), slope.unwrap_or(0.0), by, states, acts);
            } else {
                joint_acts(&entry.joint, value, by, states, acts);
            }
        }
        for (i, (&drive, &tau)) in self.actuators.iter().zip(&actions.tau).enumerate() {
            if let Some(drive) = drive {
                push(drive, tau, By::Actuator(ActuatorId(i)), states, acts);
            }
        }
        acts.extend_from_slice(&work.loads().acts);
    }
}

/// What a relation of = law(by) does: the other coordinate feels −λ times the law's slope.
fn relate(
    Related { of, by: other }: &Related,
    lambda: f64,
    slope: f64,
    by: By,
    states: &BodyStates,
    acts: &mut Vec<Act>,
) {
    push(*of, lambda, by, states, acts);
    push(*other, -lambda * slope, by, states, acts);
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

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use dwell_geometry::{Actuator, Body, Drive, Start, vec2};

    const GROUND: BodyId = BodyId(0);
    const ONE: BodyId = BodyId(1);
    const TWO: BodyId = BodyId(2);
    const A: Vec2 = vec2(0.2, 0.1);
    const B: Vec2 = vec2(0.9, 0.4);

    /// Two bodies pinned to each other, the first to the ground, at the speeds given: any joint
    /// can be thought between two of the three.
    fn states(speeds: [f64; 2]) -> BodyStates {
        let body = |name: &str| Body { name: name.into() };
        let pin = |bodies, points| Joint {
            name: "pin".into(),
            bodies,
            points,
            kind: JointKind::Revolute,
        };
        let actuator = |bodies| Actuator {
            name: "q".into(),
            bodies,
            drive: Drive::Angle,
        };
        let mechanism = Mechanism {
            bodies: ["ground", "one", "two"].map(body).into(),
            joints: vec![pin([GROUND, ONE], [A, Vec2::ZERO]), pin([ONE, TWO], [B, B])],
            actuators: vec![actuator([GROUND, ONE]), actuator([GROUND, TWO])],
            ..Mechanism::default()
        };
        let start = Start {
            q: vec![0.3, -0.8],
            rough: vec![None; 3],
            ..Start::default()
        };
        let plan = Plan::compile(&mechanism, &start).unwrap();
        let (mut pose, mut motion) = (plan.pose(), plan.motion());
        plan.place(&start.q, &mut pose).unwrap();
        plan.speeds(&pose, &speeds, &mut motion);
        let mut states = BodyStates::new(&plan);
        states.fill(&plan, &pose, &motion);
        states
    }

    fn power(joint: &Joint, value: [f64; 3], states: &BodyStates) -> f64 {
        let mut acts = Vec::new();
        let by = By::Joint(JointId(0));
        joint_acts(joint, |i| value[i], by, states, &mut acts);
        acts.iter().map(|act| act.power(states)).sum()
    }

    /// The rate of each row of a joint, from the formulas of [`JointKind`], at points that keep the row.
    fn row_rates(joint: &Joint, states: &BodyStates) -> Vec<f64> {
        let gap = states.separation(joint.bodies, joint.points);
        let [w1, w2] = joint.bodies.map(|b| states.body(b).spin);
        let parts = |axis: Vec2| {
            let t = axis.turn(states.body(joint.bodies[0]).turn);
            let turned = gap.rate - gap.gap.perp() * w1;
            (t.dot(turned), t.perp().dot(turned))
        };
        match joint.kind {
            JointKind::Weld { .. } => vec![gap.rate.x, gap.rate.y, w2 - w1],
            JointKind::Slot { axis } => vec![parts(axis).1],
            JointKind::Gear { radii, internal } => {
                let psi = gap.gap.cross(gap.rate) / gap.gap.dot(gap.gap);
                let sign = if internal { -1.0 } else { 1.0 };
                vec![radii[1] * (w2 - psi) + sign * radii[0] * (w1 - psi)]
            }
            JointKind::Rack { axis, radius } => vec![parts(axis).0 + radius * (w2 - w1)],
            JointKind::Rolling { axis, radius } => {
                let (along, normal) = parts(axis);
                vec![normal, along + radius * (w2 - w1)]
            }
            JointKind::Distance { .. } => vec![gap.direction.unwrap().dot(gap.rate)],
            _ => Vec::new(),
        }
    }

    /// The angle of a body's frame here, to lay an axis through what is already placed.
    fn axis_through(bodies: [BodyId; 2], points: [Vec2; 2], above: f64) -> Vec2 {
        let states = states([0.0; 2]);
        let gap = states.separation(bodies, points);
        // n·gap = `above`.
        let lean = (above / gap.length).asin();
        let turn = Vec2::from_angle(gap.gap.angle() - lean);
        turn.turn_back(states.body(bodies[0]).turn)
    }

    /// A multiplier works at the rate of its row: that is what conjugate means, and with the rows of
    /// `JointKind` it fixes every sign and every point of application.
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
            let joint = Joint {
                name: "thought".into(),
                bodies: between,
                points,
                kind,
            };
            for speeds in [[1.0, 0.0], [0.0, 1.0], [-0.7, 2.3]] {
                let states = states(speeds);
                let rates = row_rates(&joint, &states);
                for (i, rate) in rates.iter().enumerate() {
                    let mut value = [0.0; 3];
                    value[i] = 3.0;
                    let off = power(&joint, value, &states) - 3.0 * rate;
                    // Powers of a few watts.
                    assert!(off.abs() < 1e-14, "{kind:?} {i}: {off}");
                }
            }
        }
    }

    /// The same for what is pushed along a coordinate.
    #[test]
    fn a_push_works_at_the_speed_of_its_coordinate() {
        let bodies = [ONE, TWO];
        let points = [vec2(0.1, -0.2), vec2(0.4, 0.7)];
        let axis = axis_through(bodies, points, 0.0);
        let all = [
            Measured::Angle(bodies),
            Measured::Length { bodies, points },
            Measured::Travel {
                bodies,
                points,
                axis,
            },
        ];
        let states = states([-0.7, 2.3]);
        for measured in all {
            let mut acts = Vec::new();
            let by = By::Actuator(ActuatorId(0));
            push((measured, points), 3.0, by, &states, &mut acts);
            let power: f64 = acts.iter().map(|act| act.power(&states)).sum();
            let speed = states.measure(measured)[1];
            assert!((power - 3.0 * speed).abs() < 1e-14, "{measured:?}");
        }
    }

    /// A relation's row is of − law(by).
    #[test]
    fn a_relation_works_at_the_rate_of_its_row() {
        let bodies = [ONE, TWO];
        let points = [vec2(0.1, -0.2), vec2(0.4, 0.7)];
        let of = Measured::Length { bodies, points };
        let by = Measured::Angle(bodies);
        let relation = Related {
            of: (of, points),
            by: (by, points),
        };
        let states = states([-0.7, 2.3]);
        let mut acts = Vec::new();
        let joint = By::Joint(JointId(0));
        relate(&relation, 3.0, 0.8, joint, &states, &mut acts);
        let power: f64 = acts.iter().map(|act| act.power(&states)).sum();
        let rate = states.measure(of)[1] - 0.8 * states.measure(by)[1];
        assert!((power - 3.0 * rate).abs() < 1e-14);
    }
}
