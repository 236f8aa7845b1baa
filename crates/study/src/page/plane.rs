//! The mechanism in the plane as the parts of a page: what the pictures draw in one position, fixed to the bodies.

use super::columns::RowChoice;
use crate::bodies::BodyPose;
use crate::symbols::{
    BodyOutline, RAIL_DISTANCE, SLOT_DISTANCE, TOOTH, TRACK_MARGIN, blocks_on, common_joint_name,
    is_cylinder, outline_of, pitch_curve, rack_outline, reach, symbol_size, travels,
};
use dwell_geometry::{ActuatorKind, BodyId, Joint, JointKind, Vec2, vec2};
use dwell_kinetostatics::LoadKind;
use dwell_page::{
    Anchor, Drawing, DrawnBody, DrawnPath, ForceArrow, LinkLook, Mark, MarkLook, OutlineLook, Part,
};
use dwell_scene::PlaneScene;

/// Colours of bodies: six of the palette, then ink.
const PAINTS: usize = 7;
/// Joints nearer than this, in reference lengths, share a label.
const NEAR: f64 = 0.02;

/// The mechanism along the rows of a page.
/// `poses` are those of all bodies by row, of which those that are not modelled are left out.
pub(super) fn plane_drawing(
    scene: &PlaneScene,
    (poses, modelled): (&[Vec<BodyPose>], &[bool]),
    choice: &RowChoice,
    arrows: Vec<ForceArrow>,
) -> Drawing {
    let drawn = DrawnParts {
        scene,
        size: symbol_size(scene, poses),
        travels: travels(scene, poses),
        poses,
        visible: modelled,
        parts: Vec::new(),
    };
    let size = drawn.size;
    let mechanism = &scene.mechanism;
    let body = |(b, body): (usize, &dwell_geometry::Body)| {
        let is_fixed = b == mechanism.ground || !modelled.get(b).copied().unwrap_or(true);
        let part = |k: usize| {
            choice.map(poses, |row: &Vec<BodyPose>| {
                let (origin, rotation) = row[b];
                [origin.x, origin.y, rotation.angle()][k]
            })
        };
        DrawnBody {
            name: body.name.clone(),
            paint: paint(mechanism.ground, b),
            placements: match is_fixed {
                true => Vec::new(),
                false => (0..3).map(part).collect(),
            },
        }
    };
    Drawing {
        size,
        view: None,
        bodies: mechanism.bodies.iter().enumerate().map(body).collect(),
        parts: drawn.all(),
        arrows,
        paths: paths(scene, modelled),
    }
}

/// The number of a body's colour; none of the ground.
pub(crate) fn paint(ground: usize, body: usize) -> Option<usize> {
    (body != ground).then(|| (body - usize::from(body > ground)) % PAINTS)
}

pub(super) fn point(at: Vec2) -> Vec<f64> {
    vec![at.x, at.y]
}

pub(super) fn anchor(body: BodyId, at: Vec2) -> Anchor {
    Anchor {
        body: body.0,
        point: point(at),
    }
}

pub(super) fn anchors(bodies: [BodyId; 2], points: [Vec2; 2]) -> [Anchor; 2] {
    [0, 1].map(|k| anchor(bodies[k], points[k]))
}

/// The paths that can be shown: those that are requested, and those of all named points of moving bodies, each once.
fn paths(scene: &PlaneScene, modelled: &[bool]) -> Vec<DrawnPath> {
    let mechanism = &scene.mechanism;
    let requested = &scene.requests.paths;
    let mut paths = Vec::new();
    for (b, points) in scene.points.iter().enumerate() {
        if b == mechanism.ground || !modelled.get(b).copied().unwrap_or(true) {
            continue;
        }
        for (name, at) in points {
            paths.push(DrawnPath {
                at: anchor(BodyId(b), *at),
                name: format!("{}.{name}", mechanism.bodies[b].name),
                requested: requested.iter().any(|p| p.body.0 == b && p.name == *name),
            });
        }
    }
    paths
}

/// The parts of a mechanism, collected from the back to the front.
struct DrawnParts<'a> {
    scene: &'a PlaneScene,
    size: f64,
    travels: Vec<Option<[f64; 2]>>,
    poses: &'a [Vec<BodyPose>],
    visible: &'a [bool],
    parts: Vec<Part>,
}

impl DrawnParts<'_> {
    fn all(mut self) -> Vec<Part> {
        self.background();
        self.cams();
        self.driven_lengths();
        self.bodies();
        self.loads();
        self.joints();
        self.parts
    }

    fn is_visible(&self, bodies: &[BodyId]) -> bool {
        let is_modelled = |b: &BodyId| self.visible.get(b.0).copied().unwrap_or(true);
        bodies.iter().all(is_modelled)
    }

    fn is_ground(&self, body: BodyId) -> bool {
        body.0 == self.scene.mechanism.ground
    }

    fn outline(&mut self, look: OutlineLook, body: BodyId, points: &[Vec2], closed: bool) {
        self.parts.push(Part::Outline {
            look,
            body: body.0,
            points: points.iter().copied().map(point).collect(),
            closed,
        });
    }

    fn link(
        &mut self,
        look: LinkLook,
        joined: ([BodyId; 2], [Vec2; 2]),
        colored: [Option<usize>; 2],
        title: String,
    ) {
        self.parts.push(Part::Link {
            look,
            ends: anchors(joined.0, joined.1),
            bodies: colored,
            title,
        });
    }

    /// Wheels, tracks, slots, cylinders and massless rods.
    fn background(&mut self) {
        let scene = self.scene;
        for (j, joint) in scene.mechanism.joints.iter().enumerate() {
            if !self.is_visible(&joint.bodies) {
                continue;
            }
            let ([one, two], at, travel) = (joint.bodies, joint.points, self.travels[j]);
            match joint.kind {
                JointKind::Gear { radii, .. } => {
                    self.wheel(one, at[0], radii[0]);
                    self.wheel(two, at[1], radii[1]);
                }
                JointKind::Rack { axis, radius } | JointKind::Rolling { axis, radius } => {
                    self.track(joint, axis, travel);
                    self.wheel(two, at[1], radius.abs());
                }
                JointKind::Slot { axis } => self.track(joint, axis, travel),
                JointKind::Prismatic { .. } if is_cylinder(scene, j) => {
                    let title = self.title(joint, "driven slide");
                    self.link(
                        LinkLook::Cylinder,
                        (joint.bodies, at),
                        [Some(one.0), Some(two.0)],
                        title,
                    );
                }
                JointKind::Prismatic { axes } => self.track(joint, axes[0], travel),
                JointKind::Distance { .. } => {
                    let title = self.title(joint, "massless rod");
                    self.link(LinkLook::Rod, (joint.bodies, at), [None; 2], title);
                }
                JointKind::Revolute | JointKind::Weld { .. } | JointKind::Coupling(_) => {}
            }
        }
    }

    /// Its centre and a point of its rim.
    fn wheel(&mut self, body: BodyId, at: Vec2, radius: f64) {
        self.outline(
            OutlineLook::Wheel,
            body,
            &[at, at + vec2(radius, 0.0)],
            true,
        );
    }

    /// The straight line on the first body along which the joint's second point goes.
    fn track(&mut self, joint: &Joint, axis: Vec2, travel: Option<[f64; 2]>) {
        let one = joint.bodies[0];
        let [low, high] = travel.unwrap_or([0.0; 2]);
        let margin = TRACK_MARGIN * self.size;
        let [from, to] = [low - margin, high + margin].map(|s| joint.points[0] + axis * s);
        match joint.kind {
            JointKind::Rack { radius, .. } => {
                // The wheel is on the left of the track where its radius is positive.
                let normal = axis.perp() * radius.signum();
                let outline = rack_outline([from, to], normal, TOOTH * self.size);
                self.outline(OutlineLook::Profile, one, &outline, true);
            }
            JointKind::Rolling { radius, .. } => {
                let look = match self.is_ground(one) {
                    true => OutlineLook::GroundLine,
                    false => OutlineLook::Bar,
                };
                // The hatching is on the right of the track: away from the disc.
                let ends = if radius < 0.0 { [to, from] } else { [from, to] };
                self.outline(look, one, &ends, false);
            }
            _ if !self.is_ground(one) => self.outline(OutlineLook::Slot, one, &[from, to], false),
            kind => {
                // Two rails, each hatched on its outer side.
                let share = match kind {
                    JointKind::Slot { .. } => SLOT_DISTANCE,
                    _ => RAIL_DISTANCE,
                };
                let across = axis.perp() * (share * self.size);
                let (right, left) = ([from - across, to - across], [to + across, from + across]);
                self.outline(OutlineLook::GroundLine, one, &right, false);
                self.outline(OutlineLook::GroundLine, one, &left, false);
            }
        }
    }

    /// The curves that the followers' points follow on their cams.
    fn cams(&mut self) {
        let (scene, poses) = (self.scene, self.poses);
        let couplings = scene.mechanism.couplings.iter();
        for cam in couplings.filter_map(|coupling| pitch_curve(scene, coupling, poses)) {
            let body = BodyId(cam.body);
            if self.is_visible(&[body]) {
                self.outline(OutlineLook::Profile, body, &cam.points, cam.closed);
            }
        }
    }

    fn driven_lengths(&mut self) {
        for actuator in &self.scene.mechanism.actuators {
            if let ActuatorKind::Length(points) = actuator.kind
                && self.is_visible(&actuator.bodies)
            {
                let title = format!("driven length {}", actuator.name);
                let joined = (actuator.bodies, points);
                self.link(LinkLook::Cylinder, joined, [None; 2], title);
            }
        }
    }

    /// The large ones first: where two lie on each other, the small one stays in sight.
    fn bodies(&mut self) {
        let scene = self.scene;
        let reach = |b: &usize| reach(scene, *b);
        let all = 0..scene.mechanism.bodies.len();
        let is_drawn = |b: &usize| !self.is_ground(BodyId(*b)) && self.is_visible(&[BodyId(*b)]);
        let mut bodies: Vec<usize> = all.filter(is_drawn).collect();
        bodies.sort_by(|a, b| {
            let blocks = (reach(a) == 0.0).cmp(&(reach(b) == 0.0));
            blocks.then(reach(b).total_cmp(&reach(a)))
        });
        for b in bodies {
            let (look, points, closed) = match outline_of(scene, b, self.size) {
                BodyOutline::Block(corners) => (OutlineLook::Block, corners.to_vec(), true),
                BodyOutline::Plate(points) => (OutlineLook::Plate, points, true),
                BodyOutline::Bar(points) => (OutlineLook::Bar, points, false),
            };
            self.outline(look, BodyId(b), &points, closed);
            for corners in blocks_on(scene, b, self.size) {
                self.outline(OutlineLook::Block, BodyId(b), &corners, true);
            }
        }
    }

    /// Springs and dampers between points.
    fn loads(&mut self) {
        for load in &self.scene.loads {
            let (look, joined) = match load.kind {
                LoadKind::Spring { bodies, points, .. } => (LinkLook::Spring, (bodies, points)),
                LoadKind::Damper { bodies, points } => (LinkLook::Damper, (bodies, points)),
                LoadKind::Gravity { .. }
                | LoadKind::Force { .. }
                | LoadKind::Torque { .. }
                | LoadKind::TorsionSpring { .. }
                | LoadKind::RotationalDamper { .. }
                | LoadKind::PointToPointForce { .. }
                | LoadKind::SlideForce(_)
                | LoadKind::SlideDamper(_)
                | LoadKind::SeparatingForce(_) => continue,
            };
            self.link(look, joined, [None; 2], load.name.clone());
        }
    }

    /// Pins and welds; joints at one point at the start share a label.
    fn joints(&mut self) {
        let scene = self.scene;
        let joints = scene.mechanism.joints.iter();
        let joints: Vec<&Joint> = joints.filter(|j| self.is_visible(&j.bodies)).collect();
        let place = |joint: &Joint| -> Option<Vec2> {
            let (origin, rotation) = *self.poses.first()?.get(joint.bodies[0].0)?;
            Some(origin + joint.points[0].rotate(rotation))
        };
        let labelled = |j: &&&Joint| matches!(j.kind, JointKind::Revolute);
        let pins: Vec<&Joint> = joints.iter().filter(labelled).copied().collect();
        let mut marks = Vec::new();
        for joint in &joints {
            let on_ground = joint.bodies.iter().any(|b| self.is_ground(*b));
            let mark = |look, k: usize, label: String| Mark {
                look,
                at: anchor(joint.bodies[k], joint.points[k]),
                axis: Vec::new(),
                on_ground,
                label,
                title: self.title(joint, joint_word(joint.kind)),
            };
            let near = |other: &&&Joint| {
                let places = place(joint).zip(place(other));
                places.is_some_and(|(a, b)| (a - b).norm() < NEAR * self.size)
            };
            let here: Vec<&Joint> = pins.iter().filter(near).copied().collect();
            let label = match here.first() {
                Some(first) if std::ptr::eq(*first, *joint) => common_joint_name(scene, &here),
                _ => String::new(),
            };
            match joint.kind {
                JointKind::Revolute if on_ground => marks.push(mark(MarkLook::GroundPin, 0, label)),
                JointKind::Revolute => marks.push(mark(MarkLook::Pin, 0, label)),
                JointKind::Slot { .. } => marks.push(mark(MarkLook::Pin, 1, String::new())),
                JointKind::Distance { .. } => {
                    marks.extend([0, 1].map(|k| mark(MarkLook::Pin, k, String::new())));
                }
                JointKind::Weld { .. } => marks.push(mark(MarkLook::Weld, 0, String::new())),
                // A prismatic joint is drawn by its line and block, gears and wheels by their circles.
                JointKind::Prismatic { .. }
                | JointKind::Gear { .. }
                | JointKind::Rack { .. }
                | JointKind::Rolling { .. }
                | JointKind::Coupling(_) => {}
            }
        }
        self.parts.extend(marks.into_iter().map(Part::Mark));
    }

    /// A joint in words.
    fn title(&self, joint: &Joint, kind: &str) -> String {
        let [one, two] = joint.bodies.map(|b| self.scene.mechanism.body_name(b));
        format!("{} ({kind} of {one} and {two})", joint.name)
    }
}

fn joint_word(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "revolute joint",
        JointKind::Prismatic { .. } => "prismatic joint",
        JointKind::Slot { .. } => "pin in a slot",
        JointKind::Weld { .. } => "weld",
        JointKind::Gear { .. } => "gears",
        JointKind::Rack { .. } => "rack and pinion",
        JointKind::Rolling { .. } => "rolling contact",
        JointKind::Distance { .. } => "massless rod",
        JointKind::Coupling(_) => "coupling",
    }
}
