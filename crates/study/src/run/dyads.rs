//! Dyads whose transmission angle tells how well they pass on a force: two bodies pinned to each other,
//! each held by one more pin or slide.

use dwell_geometry::measure::BodyStates;
use dwell_geometry::{BodyId, Joint, JointId, JointKind, Mechanism, Plan, Vec2};

/// A dyad: its pin, and the line that each of its bodies makes there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dyad {
    lines: [Line; 2],
}

/// The line of a body at the pin of a dyad, in its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Line {
    /// From the inner pin to the outer one.
    Bar(BodyId, Vec2),
    /// At right angles to the axis of its slide.
    Normal(BodyId, Vec2),
}

impl Dyad {
    /// The angle between the two lines, from 0 to π rad.
    pub(crate) fn angle(&self, states: &BodyStates) -> f64 {
        let [a, b] = self.lines.map(|line| {
            let (Line::Bar(body, along) | Line::Normal(body, along)) = line;
            along.turn(states.body(body).turn)
        });
        a.cross(b).abs().atan2(a.dot(b))
    }

    /// Its two bodies.
    pub(crate) fn bodies(&self) -> [BodyId; 2] {
        self.lines.map(|line| match line {
            Line::Bar(body, _) | Line::Normal(body, _) => body,
        })
    }

    pub(crate) fn meaning(&self) -> &'static str {
        let slides = self.lines.iter().any(|l| matches!(l, Line::Normal(..)));
        match slides {
            false => "transmission angle: between the lines of the two bodies at their pin",
            true => {
                "transmission angle: between the rod and the normal of the slide; what it lacks of 90° is the pressure angle"
            }
        }
    }
}

/// The dyads of a mechanism, each with its inner pin, in the order of the joints.
pub(crate) fn dyads(mechanism: &Mechanism, plan: &Plan) -> Vec<(JointId, Dyad)> {
    let levels = levels(mechanism, plan);
    let joints = 0..mechanism.joints.len();
    let found = joints.filter_map(|j| Some((JointId(j), dyad(mechanism, &levels, JointId(j))?)));
    found.collect()
}

/// By body, the group with which its place becomes known; none for those that the actuators place.
fn levels(mechanism: &Mechanism, plan: &Plan) -> Vec<Option<usize>> {
    let mut own = vec![None; mechanism.bodies.len()];
    for g in 0..plan.group_kinds().len() {
        let bodies = plan.group_bodies(g);
        bodies.iter().for_each(|b| own[b.0] = own[b.0].max(Some(g)));
    }
    let mut carried: Vec<Option<usize>> = Vec::with_capacity(plan.carried().len());
    let mut levels = vec![None; mechanism.bodies.len()];
    for body in plan.carried() {
        let parent = body.parent.and_then(|p| carried[p]);
        let level = parent.max(own.get(body.body).copied().flatten());
        carried.push(level);
        if let Some(known) = levels.get_mut(body.body) {
            *known = level;
        }
    }
    levels
}

/// The dyad around a pin.
fn dyad(mechanism: &Mechanism, levels: &[Option<usize>], pin: JointId) -> Option<Dyad> {
    let pin = &mechanism.joints[pin.0];
    let [one, two] = pin.bodies;
    let level = levels[one.0];
    if pin.kind != JointKind::Revolute || level.is_none() || levels[two.0] != level {
        return None;
    }
    let has = |joint: &Joint, body: BodyId| joint.bodies.contains(&body);
    let outer = |body: BodyId| {
        let to_placed =
            |j: &&Joint| has(j, body) && j.bodies.iter().all(|&b| b == body || levels[b.0] < level);
        let mut joints = mechanism.joints.iter().filter(to_placed);
        joints.next().filter(|_| joints.next().is_none())
    };
    let line = |body: BodyId| {
        let at = |joint: &Joint| joint.points[usize::from(joint.bodies[1] == body)];
        let joint = outer(body)?;
        match joint.kind {
            JointKind::Revolute => {
                let along = at(joint) - at(pin);
                (along != Vec2::ZERO).then_some(Line::Bar(body, along))
            }
            JointKind::Prismatic { axes } => {
                let axis = axes[usize::from(joint.bodies[1] == body)];
                Some(Line::Normal(body, axis.perp()))
            }
            _ => None,
        }
    };
    let lines = [line(one)?, line(two)?];
    let two_slides = lines.iter().all(|l| matches!(l, Line::Normal(..)));
    (!two_slides).then_some(Dyad { lines })
}
