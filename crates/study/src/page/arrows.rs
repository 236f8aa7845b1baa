//! Which columns of a run are forces that can be drawn as arrows, and where they act.

use super::plane::{anchor, anchors, point};
use crate::trajectory::compute::{Quantity, TrajectoryResults};
use dwell_geometry::{Component, Joint, JointKind, Vec2};
use dwell_kinetostatics::{Guide, LoadKind};
use dwell_page::{Anchor, Direction, ForceArrow};
use dwell_scene::Scene;

/// The reactions and loads among the columns of the page. A reaction is drawn on the joint's second body.
pub(super) fn plane_arrows(scene: &Scene, results: &TrajectoryResults) -> Vec<ForceArrow> {
    let column = |quantity: Quantity| {
        let mut written = results.written.iter();
        written.position(|&k| results.columns[k].quantity == quantity)
    };
    let reactions = scene.mechanism.reactions();
    let mut arrows = Vec::new();
    for (j, joint) in scene.mechanism.joints.iter().enumerate() {
        let component = |wanted: Component| {
            let mut all = reactions.iter();
            let k = all.position(|r| r.joint.0 == j && r.component == wanted)?;
            column(Quantity::Reaction(k))
        };
        arrows.extend(reaction_arrows(scene, joint, component));
    }
    let loads = scene.loads.iter().enumerate();
    arrows.extend(loads.filter_map(|(k, load)| {
        let column = column(Quantity::LoadForce(k))?;
        let (at, direction) = load_direction(scene, &load.kind, column)?;
        Some(ForceArrow {
            name: load.name.clone(),
            group: "Loads".to_owned(),
            title: results.columns[results.written[column]].meaning.clone(),
            at,
            direction,
        })
    }));
    arrows
}

/// The forces of a joint whose columns are there. Tangential forces of rolling contact, whose place moves on both bodies, and
/// forces of couplings have no arrow.
fn reaction_arrows(
    scene: &Scene,
    joint: &Joint,
    component: impl Fn(Component) -> Option<usize>,
) -> Option<ForceArrow> {
    let [one, two] = joint.bodies;
    let along = |column, axis: Vec2| Direction::Along {
        column,
        body: one.0,
        axis: point(axis),
    };
    let direction = match joint.kind {
        JointKind::Revolute | JointKind::Weld { .. } => Direction::Components {
            columns: [Component::X, Component::Y]
                .into_iter()
                .map(&component)
                .collect::<Option<_>>()?,
        },
        JointKind::Prismatic { axes } => along(component(Component::Normal)?, axes[0].perp()),
        JointKind::Slot { axis } | JointKind::Rolling { axis, .. } => {
            along(component(Component::Normal)?, axis.perp())
        }
        JointKind::Rack { axis, .. } => along(component(Component::Tooth)?, axis),
        JointKind::Gear { radii, internal } => {
            tooth_line(joint, radii, internal, component(Component::Tooth)?)
        }
        JointKind::Distance { .. } => Direction::Line {
            column: component(Component::Axial)?,
            ends: anchors(joint.bodies, joint.points),
            across: false,
            part: 1.0,
        },
        JointKind::Coupling(_) => return None,
    };
    let [from, on] = [one, two].map(|b| scene.mechanism.body_name(b));
    Some(ForceArrow {
        name: joint.name.clone(),
        group: "Reactions".to_owned(),
        title: format!("{}: force of {from} on {on}", joint.name),
        at: anchor(two, joint.points[1]),
        direction,
    })
}

/// The tooth force of two gears at their pitch point, across the line of centres; positive rotates the second one
/// counter-clockwise.
///
/// The line goes from the second centre to the first, or the other way where the first gear is a ring around the second.
fn tooth_line(joint: &Joint, radii: [f64; 2], internal: bool, column: usize) -> Direction {
    let [one, two] = anchors(joint.bodies, joint.points);
    let [r1, r2] = radii;
    let (ends, part) = match (internal, r1 > r2) {
        (false, _) => ([two, one], r2 / (r1 + r2)),
        (true, true) => ([one, two], r1 / (r1 - r2)),
        (true, false) => ([two, one], r2 / (r2 - r1)),
    };
    Direction::Line {
        column,
        ends,
        across: true,
        part,
    }
}

/// Where a load acts and where it points to; none where it is no force at one place.
fn load_direction(scene: &Scene, kind: &LoadKind, column: usize) -> Option<(Anchor, Direction)> {
    match kind {
        LoadKind::Force {
            body,
            point: at,
            direction,
            body_fixed,
        } => {
            let frame = if *body_fixed {
                body.0
            } else {
                scene.mechanism.ground
            };
            let axis = point(*direction);
            let along = Direction::Along {
                column,
                body: frame,
                axis,
            };
            Some((anchor(*body, *at), along))
        }
        LoadKind::Spring { bodies, points, .. }
        | LoadKind::Damper { bodies, points }
        | LoadKind::PointToPointForce { bodies, points } => {
            let ends = anchors(*bodies, *points);
            let line = Direction::Line {
                column,
                ends,
                across: false,
                part: 1.0,
            };
            Some((anchor(bodies[1], points[1]), line))
        }
        LoadKind::SlideForce(guide) | LoadKind::SlideDamper(guide) => {
            let Guide {
                bodies,
                points,
                axis,
            } = *guide;
            let along = Direction::Along {
                column,
                body: bodies[0].0,
                axis: point(axis),
            };
            Some((anchor(bodies[1], points[1]), along))
        }
        LoadKind::Gravity { .. }
        | LoadKind::Torque { .. }
        | LoadKind::TorsionSpring { .. }
        | LoadKind::RotationalDamper { .. }
        | LoadKind::SeparatingForce(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_geometry::{BodyId, vec2};

    /// The pitch point is on both pitch circles, and a positive tooth force turns the second gear counter-clockwise by its
    /// pitch radius, whichever gear is the ring.
    #[test]
    fn a_tooth_force_acts_at_the_pitch_point_and_turns_the_second_gear() {
        let along = vec2(0.6, 0.8);
        for (radii, internal) in [
            ([0.3, 0.2], false),
            ([0.2, 0.5], false),
            ([0.5, 0.2], true),
            ([0.2, 0.5], true),
        ] {
            let [r1, r2] = radii;
            let distance: f64 = if internal { r1 - r2 } else { r1 + r2 };
            let centers = [vec2(1.0, -2.0), vec2(1.0, -2.0) + along * distance.abs()];
            let joint = Joint {
                name: "gears".to_owned(),
                bodies: [BodyId(1), BodyId(2)],
                points: centers,
                kind: JointKind::Gear { radii, internal },
            };
            let Direction::Line {
                ends, across, part, ..
            } = tooth_line(&joint, radii, internal, 0)
            else {
                panic!("a line");
            };
            let [from, to] = ends.map(|end| vec2(end.point[0], end.point[1]));
            let pitch = from + (to - from) * part;
            let direction = (to - from).perp() * (1.0 / (to - from).norm());
            for (center, radius) in centers.into_iter().zip(radii) {
                assert!(((pitch - center).norm() - radius).abs() < 1e-12);
            }
            assert!(across && ((pitch - centers[1]).cross(direction) - r2).abs() < 1e-12);
        }
    }
}
