//! Arrows of forces that act at contacts: teeth at their pitch point, wheels on their track, and followers of couplings.

use super::{JointForces, along_body, force_arrow, pushing_apart};
use crate::symbols::{anchor, anchors, point};
use crate::trajectory::compute::Quantity;
use dwell_geometry::{Component, Coordinate, Vec2, vec2};
use dwell_kinetostatics::{LoadKind, Magnitude, Mesh, PitchLines};
use dwell_page::{Direction, ForceArrow, ForcePart};

/// The place and the frame of a direction with these parts of a force.
fn with(place: &Direction, parts: Vec<ForcePart>) -> Direction {
    let mut direction = place.clone();
    if let Direction::Line { parts: own, .. } | Direction::Body { parts: own, .. } = &mut direction
    {
        *own = parts;
    }
    direction
}

/// The forces of the first body's teeth on the second body, at the pitch point: the tangential one; with a pressure angle also the
/// separating one and both together, along the line of action; and the opposite on the first body.
pub(super) fn tooth_arrows(of: &JointForces<'_>) -> Vec<ForceArrow> {
    let Some((contact, [tangent, away])) = Mesh::of(of.joint).map(axes_of) else {
        return Vec::new();
    };
    let Some(tooth) = of.part(Component::Tooth, tangent) else {
        return Vec::new();
    };
    let name = &of.joint.name;
    let separating = separating_column(of).map(|column| ForcePart {
        column,
        axis: point(away),
    });
    let Some(separating) = separating else {
        return pair(of, &contact, vec![tooth], name, "tooth force");
    };
    let tangential = with(&contact, vec![tooth.clone()]);
    let apart = with(&contact, vec![separating.clone()]);
    let mut arrows = vec![
        on_second(of, name, "tangential force", tangential),
        on_second(of, &format!("{name}.separating"), "separating force", apart),
    ];
    let (both, name) = (vec![tooth, separating], format!("{name}.line-of-action"));
    let what = "force along the line of action";
    arrows.extend(pair(of, &contact, both, &name, what));
    arrows
}

/// Normal and tangential force of a track on a wheel, at their contact; and the opposite on the track. n·(P₂ − P₁) = r: the
/// contact is at P₂ − r n.
pub(super) fn rolling_arrows(of: &JointForces<'_>, axis: Vec2, radius: f64) -> Vec<ForceArrow> {
    let normal = axis.perp();
    let contact = Direction::Body {
        body: of.joint.bodies[0].0,
        parts: Vec::new(),
        offset: point(normal * -radius),
    };
    let parts = [(Component::Normal, normal), (Component::Tangent, axis)]
        .map(|(component, axis)| of.part(component, axis));
    let what = match &parts {
        [Some(_), Some(_)] => "contact force",
        [Some(_), None] => "normal force",
        [None, Some(_)] => "tangential force",
        [None, None] => return Vec::new(),
    };
    let parts = parts.into_iter().flatten().collect();
    pair(of, &contact, parts, &of.joint.name, what)
}

/// The force of a coupling on its follower: along a travel at the slide's second point, or between the two points of a length.
/// On a coupled angle a couple acts, which has no arrow.
pub(super) fn coupling_arrow(of: &JointForces<'_>, coupling: usize) -> Option<ForceArrow> {
    let mechanism = &of.scene.mechanism;
    let column = of.component(Component::Force)?;
    let (bodies, points, direction) = match mechanism.couplings.get(coupling)?.dependent {
        Coordinate::Angle(_) => return None,
        Coordinate::Travel(slide) => {
            let slide = mechanism.joints.get(slide.0)?;
            let axis = point(slide.kind.travel_axis()?);
            let part = ForcePart { column, axis };
            let direction = along_body(slide.bodies[0], vec![part]);
            (slide.bodies, slide.points, direction)
        }
        Coordinate::Length { bodies, points } => {
            let direction = pushing_apart(column, anchors(bodies, points));
            (bodies, points, direction)
        }
    };
    let name = &of.joint.name;
    let on = mechanism.body_name(bodies[1]);
    let title = format!("{name}: force of the coupling on {on}, along what it couples");
    let at = anchor(bodies[1], points[1]);
    Some(force_arrow("Reactions", name, title, at, direction))
}

/// The pitch point, and the axes of the tangential and of the separating force on the second body.
///
/// The line of centres goes from the second centre to the first, or the other way where the first gear is a ring around the
/// second: across it a positive tooth force rotates the second gear counter-clockwise. Teeth push outer gears apart, and a gear
/// towards the centre of its ring.
pub(super) fn axes_of(mesh: Mesh) -> (Direction, [Vec2; 2]) {
    let Mesh {
        bodies,
        points,
        pitch,
    } = mesh;
    let [one, two] = anchors(bodies, points);
    match pitch {
        PitchLines::Circles { radii, internal } => {
            let [r1, r2] = radii;
            let (ends, place, away) = match (internal, r1 > r2) {
                (false, _) => ([two, one], r2 / (r1 + r2), -1.0),
                (true, true) => ([one, two], r1 / (r1 - r2), -1.0),
                (true, false) => ([two, one], r2 / (r2 - r1), 1.0),
            };
            let line = Direction::Line {
                ends,
                parts: Vec::new(),
                place,
            };
            (line, [vec2(0.0, 1.0), vec2(away, 0.0)])
        }
        PitchLines::Line { axis, radius } => {
            let beside = Direction::Body {
                body: bodies[0].0,
                parts: Vec::new(),
                offset: point(axis.perp() * -radius),
            };
            (beside, [axis, axis.perp() * radius.signum()])
        }
    }
}

/// The column of the separating force of a joint's teeth, if they have a pressure angle.
fn separating_column(of: &JointForces<'_>) -> Option<usize> {
    let mut loads = of.scene.loads.iter();
    let k = loads.position(|load| match (&load.kind, &load.magnitude) {
        (LoadKind::Special(_), Magnitude::Separating(teeth)) => teeth.joint == of.id,
        _ => false,
    })?;
    of.results.written_index(Quantity::LoadForce(k))
}

/// A force at a contact on the second body.
fn on_second(of: &JointForces<'_>, name: &str, what: &str, direction: Direction) -> ForceArrow {
    touching(of, name.to_owned(), what, of.body_names(), direction)
}

/// A force at a contact of the first of two bodies on the second.
fn touching(
    of: &JointForces<'_>,
    name: String,
    what: &str,
    [from, on]: [&str; 2],
    direction: Direction,
) -> ForceArrow {
    let joint = &of.joint.name;
    ForceArrow {
        name,
        title: format!("{joint}: {what} of {from} on {on}, where they touch"),
        ..of.on_second(direction)
    }
}

/// A force at a contact on the second body, and the opposite on the first one, which is not shown at first.
fn pair(
    of: &JointForces<'_>,
    contact: &Direction,
    parts: Vec<ForcePart>,
    name: &str,
    what: &str,
) -> Vec<ForceArrow> {
    let [on, from] = of.body_names();
    let opposite = |part: &ForcePart| ForcePart {
        column: part.column,
        axis: part.axis.iter().map(|c| -c).collect(),
    };
    let direction = with(contact, parts.iter().map(opposite).collect());
    let back = touching(of, format!("{name} on {on}"), what, [from, on], direction);
    vec![
        on_second(of, name, what, with(contact, parts)),
        ForceArrow {
            initially_visible: false,
            ..back
        },
    ]
}
