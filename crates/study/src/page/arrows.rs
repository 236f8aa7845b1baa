//! Selects the columns of a run that are drawn as force arrows, with their points of application.

mod contacts;
#[cfg(test)]
mod tests;

use crate::symbols::{anchor, anchors, point};
use crate::trajectory::compute::{Quantity, TrajectoryResults};
use contacts::{coupling_arrow, rolling_arrows, tooth_arrows};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{BodyId, Component, Joint, JointId, JointKind, Reaction, Vec2};
use dwell_kinetostatics::{Direction, Guide, LoadKind};
use dwell_page::{Anchor, Direction as ArrowDirection, ForceArrow, ForcePart};
use dwell_scene::PlaneScene;

/// The reactions and loads among the columns of the page. A reaction is drawn on the joint's second body.
pub(super) fn plane_arrows(scene: &PlaneScene, results: &TrajectoryResults) -> Vec<ForceArrow> {
    let reactions = scene.mechanism.reactions();
    let joints = scene.mechanism.joints.iter().enumerate();
    let joints = joints.map(|(j, joint)| JointForces {
        scene,
        results,
        reactions: &reactions,
        id: JointId(j),
        joint,
    });
    let mut arrows: Vec<ForceArrow> = joints.flat_map(|joint| joint.arrows()).collect();
    let loads = scene.loads.iter().enumerate();
    arrows.extend(loads.filter_map(|(k, load)| {
        let column = results.written_index(Quantity::LoadForce(k))?;
        let (at, direction) = load_direction(scene, &load.kind, column)?;
        let title = results.columns[results.written[column]].meaning.clone();
        Some(force_arrow("Loads", &load.name, title, at, direction))
    }));
    arrows
}

/// An arrow that is shown by default, with its point and its direction.
pub(crate) fn force_arrow(
    group: &str,
    name: &str,
    title: String,
    at: Anchor,
    direction: ArrowDirection,
) -> ForceArrow {
    ForceArrow {
        name: name.to_owned(),
        group: group.to_owned(),
        title,
        initially_visible: true,
        at,
        direction,
    }
}

/// The forces of a joint whose columns are there.
struct JointForces<'a> {
    scene: &'a PlaneScene,
    results: &'a TrajectoryResults,
    /// All of the mechanism.
    reactions: &'a [Reaction],
    id: JointId,
    joint: &'a Joint,
}

impl JointForces<'_> {
    /// The column of a component of the reaction.
    fn component(&self, wanted: Component) -> Option<usize> {
        let mut all = self.reactions.iter();
        let k = all.position(|r| r.joint == self.id && r.component == wanted)?;
        self.results.written_index(Quantity::Reaction(k))
    }

    /// A component along a direction; `None` if it has no column.
    fn part(&self, component: Component, axis: Vec2) -> Option<ForcePart> {
        let column = self.component(component)?;
        let axis = point(axis);
        Some(ForcePart { column, axis })
    }

    /// Whatever can be drawn of it. Couples have no arrow.
    fn arrows(&self) -> Vec<ForceArrow> {
        let kind = self.joint.kind;
        if let JointKind::Coupling(k) = kind {
            return coupling_arrow(self, k).into_iter().collect();
        }
        if kind.has_teeth() {
            return tooth_arrows(self);
        }
        if let Some((axis, radius)) = kind.rolled() {
            return rolling_arrows(self, axis, radius);
        }
        let direction = self.at_its_point();
        direction.map(|d| self.on_second(d)).into_iter().collect()
    }

    /// The force at the second body's point of a joint that is no contact.
    fn at_its_point(&self) -> Option<ArrowDirection> {
        if let Some(axis) = self.joint.kind.travel_axis() {
            let part = self.part(Component::Normal, axis.perp())?;
            return Some(along_body(self.joint.bodies[0], vec![part]));
        }
        if let JointKind::Distance { .. } = self.joint.kind {
            let ends = anchors(self.joint.bodies, self.joint.points);
            return Some(pushing_apart(self.component(Component::Axial)?, ends));
        }
        let components = [Component::X, Component::Y];
        let columns = components.into_iter().map(|c| self.component(c));
        let columns = columns.collect::<Option<_>>()?;
        Some(ArrowDirection::Components { columns })
    }

    fn on_second(&self, direction: ArrowDirection) -> ForceArrow {
        let ([from, on], name) = (self.body_names(), &self.joint.name);
        let title = format!("{name}: force of {from} on {on}");
        let at = anchor(self.joint.bodies[1], self.joint.points[1]);
        force_arrow("Reactions", name, title, at, direction)
    }

    fn body_names(&self) -> [&str; 2] {
        let mechanism = &self.scene.mechanism;
        self.joint.bodies.map(|b| mechanism.body_name(b))
    }
}

/// Along directions of a body, at the anchor.
fn along_body(body: BodyId, parts: Vec<ForcePart>) -> ArrowDirection {
    ArrowDirection::Body {
        body: body.0,
        parts,
        offset: Vec::new(),
    }
}

/// On the second of two points, along the line from the first.
fn pushing_apart(column: usize, ends: [Anchor; 2]) -> ArrowDirection {
    let axis = vec![1.0, 0.0];
    ArrowDirection::Line {
        ends,
        parts: vec![ForcePart { column, axis }],
        place: 1.0,
    }
}

/// The point and the direction of a load; `None` if it is not a force at one point, and for separating forces, which are
/// drawn with the teeth.
fn load_direction(
    scene: &PlaneScene,
    kind: &LoadKind,
    column: usize,
) -> Option<(Anchor, ArrowDirection)> {
    match *kind {
        LoadKind::Force {
            body,
            point: at,
            direction,
        } => {
            let frame = match direction {
                Direction::Ground(_) => BodyId(scene.mechanism.ground),
                Direction::Body(_) => body,
            };
            let axis = point(direction.vector());
            let along = along_body(frame, vec![ForcePart { column, axis }]);
            Some((anchor(body, at), along))
        }
        LoadKind::Along(CoordinateFunction::Length { bodies, points }, _) => {
            let ends = anchors(bodies, points);
            Some((anchor(bodies[1], points[1]), pushing_apart(column, ends)))
        }
        LoadKind::Along(CoordinateFunction::Travel(guide), _) => {
            let Guide {
                bodies,
                points,
                axis,
            } = guide;
            let axis = point(axis);
            let along = along_body(bodies[0], vec![ForcePart { column, axis }]);
            Some((anchor(bodies[1], points[1]), along))
        }
        // The direction of a velocity is in no column.
        LoadKind::Drag { .. }
        | LoadKind::Gravity { .. }
        | LoadKind::Along(CoordinateFunction::Angle(_), _)
        | LoadKind::Special(_) => None,
    }
}
