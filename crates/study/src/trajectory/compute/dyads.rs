//! Dyads with a transmission angle: two bodies pinned to each other, each connected by one more revolute
//! or prismatic joint to bodies that are placed before.

use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{BodyId, Joint, JointId, JointKind, Mechanism, Plan, Vec2};

/// A dyad: its pin, and the line that each of its bodies makes there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dyad {
    lines: [Line; 2],
}

/// The line of a body at the pin of a dyad, in its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    body: BodyId,
    along: Vec2,
    /// Whether it is at right angles to the axis of its slide; otherwise it goes from the inner pin to the outer one.
    is_normal: bool,
}

impl Dyad {
    /// The angle between the two lines, from 0 to π rad.
    pub(crate) fn angle(&self, states: &BodyStates) -> f64 {
        let along = |line: Line| line.along.rotate(states.body(line.body).rotation);
        let [a, b] = self.lines.map(along);
        a.cross(b).abs().atan2(a.dot(b))
    }

    /// Its lines: their bodies, and their vectors in the frames of these, m.
    pub(crate) fn lines(&self) -> [(BodyId, [f64; 2]); 2] {
        self.lines
            .map(|line| (line.body, [line.along.x, line.along.y]))
    }

    /// Its two bodies.
    pub(crate) fn bodies(&self) -> [BodyId; 2] {
        self.lines.map(|line| line.body)
    }

    pub(crate) fn meaning(&self) -> &'static str {
        if self.lines.iter().any(|line| line.is_normal) {
            "transmission angle between the rod and the normal of the guide; the pressure angle is 90° minus it"
        } else {
            "transmission angle between the lines of the two bodies at their pin"
        }
    }
}

/// The dyads of a mechanism, each with its inner pin, in the order of the joints.
pub(crate) fn dyads(mechanism: &Mechanism, plan: &Plan) -> Vec<(JointId, Dyad)> {
    let levels = levels(mechanism, plan);
    let joints = 0..mechanism.joints.len();
    let dyads = joints.filter_map(|j| Some((JointId(j), dyad(mechanism, &levels, JointId(j))?)));
    dyads.collect()
}

/// By body, the group that determines its position; `None` for those that the actuators place.
fn levels(mechanism: &Mechanism, plan: &Plan) -> Vec<Option<usize>> {
    let mut groups = vec![None; mechanism.bodies.len()];
    for g in 0..plan.group_methods().len() {
        for body in plan.group_bodies(g) {
            groups[body.0] = groups[body.0].max(Some(g));
        }
    }
    let mut tree_levels: Vec<Option<usize>> = Vec::with_capacity(plan.moving_bodies().len());
    let mut levels = vec![None; mechanism.bodies.len()];
    for body in plan.moving_bodies() {
        let parent = body.parent.and_then(|p| tree_levels[p]);
        let level = parent.max(groups.get(body.body).copied().flatten());
        tree_levels.push(level);
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
        let (along, is_normal) = match joint.kind {
            JointKind::Revolute => (at(joint) - at(pin), false),
            JointKind::Prismatic { axes } => {
                (axes[usize::from(joint.bodies[1] == body)].perp(), true)
            }
            _ => return None,
        };
        (is_normal || along != Vec2::ZERO).then_some(Line {
            body,
            along,
            is_normal,
        })
    };
    let lines = [line(one)?, line(two)?];
    let two_slides = lines.iter().all(|line| line.is_normal);
    (!two_slides).then_some(Dyad { lines })
}
