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

    pub(crate) fn meaning(&self) -> &'static str {
        let slides = self.lines.iter().any(|l| matches!(l, Line::Normal(..)));
        match slides {
            false => "transmission angle: between the lines of the two bodies at their pin",
            true => "transmission angle: between the rod and the normal of the slide",
        }
    }
}

/// The dyads of a mechanism, each with its inner pin, in the order of solution.
pub(crate) fn dyads(mechanism: &Mechanism, plan: &Plan) -> Vec<(JointId, Dyad)> {
    let groups: Vec<_> = (0..plan.group_kinds().len())
        .map(|g| plan.group_bodies(g))
        .collect();
    let mut later = vec![false; mechanism.bodies.len()];
    groups.iter().flatten().for_each(|b| later[b.0] = true);
    let mut found = Vec::new();
    for bodies in &groups {
        found.extend(dyad(mechanism, bodies, &later));
        bodies.iter().for_each(|b| later[b.0] = false);
    }
    found
}

/// The dyad of a group; `later` says which bodies are placed with it or after it.
fn dyad(mechanism: &Mechanism, bodies: &[BodyId], later: &[bool]) -> Option<(JointId, Dyad)> {
    let &[one, two] = bodies else { return None };
    let has = |joint: &Joint, body: BodyId| joint.bodies.contains(&body);
    let pin = mechanism
        .joints
        .iter()
        .position(|j| j.kind == JointKind::Revolute && has(j, one) && has(j, two))?;
    let outer = |body: BodyId| {
        let to_placed =
            |j: &&Joint| has(j, body) && j.bodies.iter().all(|&b| b == body || !later[b.0]);
        let mut joints = mechanism.joints.iter().filter(to_placed);
        joints.next().filter(|_| joints.next().is_none())
    };
    let line = |body: BodyId| {
        let at = |joint: &Joint| joint.points[usize::from(joint.bodies[1] == body)];
        let joint = outer(body)?;
        match joint.kind {
            JointKind::Revolute => {
                let along = at(joint) - at(&mechanism.joints[pin]);
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
    (!two_slides).then_some((JointId(pin), Dyad { lines }))
}
