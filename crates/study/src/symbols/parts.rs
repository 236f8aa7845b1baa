//! The drawn parts of a mechanism in the plane, fixed to its bodies: pictures show them in a position, and a page moves them.

use super::{
    RAIL_DISTANCE, SLOT_DISTANCE, TOOTH, TRACK_MARGIN, blocks_on, common_joint_name, is_cylinder,
    link_of, outline_of, pitch_curve, rack_outline, reach, symbol_size, travels,
};
use crate::bodies::{BodyPose, point_position};
use dwell_geometry::{ActuatorKind, BodyId, Joint, JointKind, Vec2, vec2};
use dwell_page::{Anchor, LinkLook, Mark, MarkLook, OutlineLook, Part};
use dwell_scene::PlaneScene;

/// Joints nearer than this, in reference lengths, share a label.
const NEAR: f64 = 0.02;
/// The barrel of a cylinder, in its shortest length.
const BARREL: f64 = 0.85;

/// In which positions of a picture a part is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DrawnIn {
    /// Only in the position that is drawn in full, as most fixed parts.
    Full,
    /// In the light ones.
    Light,
    /// In all.
    All,
}

/// The parts of a mechanism, from the back to the front.
pub(crate) struct PlaneParts<'a> {
    pub(crate) scene: &'a PlaneScene,
    /// Reference length of the symbols, m.
    pub(crate) size: f64,
    /// By joint: range of its second point along its axis over all positions, m.
    travels: Vec<Option<[f64; 2]>>,
    /// By body: whether it is drawn.
    visible: &'a [bool],
    /// Each with the positions of a picture in which it is drawn; a page has none that is in the light ones alone.
    pub(crate) parts: Vec<(Part, DrawnIn)>,
}

impl<'a> PlaneParts<'a> {
    /// The parts of a scene at these positions. Bodies without an entry in `visible` are drawn.
    pub(crate) fn new(
        scene: &'a PlaneScene,
        positions: &[Vec<BodyPose>],
        visible: &'a [bool],
    ) -> Self {
        let mut drawn = Self {
            scene,
            size: symbol_size(scene, positions),
            travels: travels(scene, positions),
            visible,
            parts: Vec::new(),
        };
        drawn.background();
        drawn.cams(positions);
        drawn.driven_lengths();
        drawn.bodies();
        drawn.loads();
        drawn.joints(&match positions.first() {
            Some(first) => drawn.labels(first),
            None => Vec::new(),
        });
        drawn
    }

    pub(crate) fn is_visible(&self, bodies: &[BodyId]) -> bool {
        let is_visible = |b: &BodyId| self.visible.get(b.0).copied().unwrap_or(true);
        bodies.iter().all(is_visible)
    }

    fn visible_joints(&self) -> Vec<(usize, &'a Joint)> {
        let scene: &'a PlaneScene = self.scene;
        let joints = scene.mechanism.joints.iter().enumerate();
        joints
            .filter(|(_, joint)| self.is_visible(&joint.bodies))
            .collect()
    }

    fn is_ground(&self, body: BodyId) -> bool {
        body.0 == self.scene.mechanism.ground
    }

    /// Whether a joint is on the ground.
    pub(crate) fn is_fixed(&self, joint: &Joint) -> bool {
        joint.bodies.iter().any(|b| self.is_ground(*b))
    }

    /// The labels of the pins in a position, each with the first of the joints at one point that share it.
    pub(crate) fn labels(&self, poses: &[BodyPose]) -> Vec<(usize, String)> {
        let mut pins: Vec<(Vec2, Vec<usize>)> = Vec::new();
        let is_pin = |joint: &Joint| matches!(joint.kind, JointKind::Revolute);
        let joints = self.visible_joints().into_iter();
        for (j, joint) in joints.filter(|(_, joint)| is_pin(joint)) {
            let [x, y] = point_position(poses, joint.bodies[0].0, joint.points[0]);
            let is_near = |at: Vec2| (at - vec2(x, y)).norm() < NEAR * self.size;
            match pins.iter_mut().find(|(at, _)| is_near(*at)) {
                Some((_, here)) => here.push(j),
                None => pins.push((vec2(x, y), vec![j])),
            }
        }
        let label = |(_, here): (Vec2, Vec<usize>)| {
            let joints = &self.scene.mechanism.joints;
            let sharing: Vec<&Joint> = here.iter().map(|j| &joints[*j]).collect();
            (here[0], common_joint_name(self.scene, &sharing))
        };
        pins.into_iter().map(label).collect()
    }

    fn outline(&mut self, look: OutlineLook, body: BodyId, points: &[Vec2], drawn_in: DrawnIn) {
        let outline = Part::Outline {
            look,
            body: body.0,
            points: points.iter().copied().map(point).collect(),
        };
        self.parts.push((outline, drawn_in));
    }

    fn link(
        &mut self,
        look: LinkLook,
        bodies: [BodyId; 2],
        points: [Vec2; 2],
        body: Option<BodyId>,
        title: String,
        drawn_in: DrawnIn,
    ) {
        let link = Part::Link {
            look,
            ends: anchors(bodies, points),
            axis: Vec::new(),
            body: body.map(|b| b.0),
            title,
        };
        self.parts.push((link, drawn_in));
    }

    /// Wheels, tracks, slots, cylinders, massless rods and the bearings of pins.
    fn background(&mut self) {
        let scene = self.scene;
        for (j, joint) in self.visible_joints() {
            let (bodies, at) = (joint.bodies, joint.points);
            let [one, two] = bodies;
            match joint.kind {
                JointKind::Gear { radii, .. } => {
                    for k in 0..2 {
                        self.wheel(joint.bodies[k], at[k], radii[k], DrawnIn::Full);
                    }
                }
                JointKind::Rack { axis, radius } | JointKind::Rolling { axis, radius } => {
                    self.track(j, axis);
                    self.wheel(two, at[1], radius.abs(), DrawnIn::All);
                }
                JointKind::Slot { axis } => self.track(j, axis),
                JointKind::Prismatic { axes } if is_cylinder(scene, j) => {
                    let title = self.title(joint, "driven slide");
                    self.link(LinkLook::Rod, bodies, at, Some(two), title, DrawnIn::All);
                    let shortest = self.travels[j].map_or(0.0, |[low, _]| low);
                    let barrel = [at[0], at[0] + axes[0] * (BARREL * shortest)];
                    self.outline(OutlineLook::Barrel, one, &barrel, DrawnIn::All);
                }
                JointKind::Prismatic { axes } => self.track(j, axes[0]),
                JointKind::Distance { .. } => {
                    let title = self.title(joint, "massless rod");
                    self.link(LinkLook::Rod, bodies, at, None, title, DrawnIn::All);
                }
                // Below the bodies: it would hide the end of a link that hangs from it.
                JointKind::Revolute if self.is_fixed(joint) => {
                    self.mark(MarkLook::Support, joint, 0, String::new(), DrawnIn::Full);
                }
                JointKind::Revolute | JointKind::Weld { .. } | JointKind::Coupling(_) => {}
            }
        }
    }

    /// Its centre, and from there a point of its rim.
    fn wheel(&mut self, body: BodyId, at: Vec2, radius: f64, drawn_in: DrawnIn) {
        let points = [at, vec2(radius, 0.0)];
        self.outline(OutlineLook::Wheel, body, &points, drawn_in);
    }

    /// The straight line on the first body along which the joint's second point goes.
    fn track(&mut self, joint: usize, axis: Vec2) {
        use DrawnIn::{All, Full, Light};
        use OutlineLook::{GroundLine, Guide, Rack, Slot};
        let of = &self.scene.mechanism.joints[joint];
        let one = of.bodies[0];
        let [low, high] = self.travels[joint].unwrap_or([0.0; 2]);
        let margin = TRACK_MARGIN * self.size;
        let ends = [low - margin, high + margin].map(|s| of.points[0] + axis * s);
        let [from, to] = ends;
        match of.kind {
            JointKind::Rack { radius, .. } => {
                // The wheel is on the left of the track where its radius is positive.
                let normal = axis.perp() * radius.signum();
                let outline = rack_outline(ends, normal, TOOTH * self.size);
                self.outline(Rack, one, &outline, Full);
                if !self.is_ground(one) {
                    self.outline(Guide, one, &ends, Light);
                }
            }
            JointKind::Rolling { .. } if !self.is_ground(one) => {
                self.outline(Guide, one, &ends, All);
            }
            JointKind::Rolling { radius, .. } => {
                // The hatching is on the right of the track: away from the disc.
                let ends = if radius < 0.0 { [to, from] } else { ends };
                self.outline(GroundLine, one, &ends, Full);
            }
            kind if !self.is_ground(one) => {
                let is_light = matches!(kind, JointKind::Prismatic { .. }) && !self.is_fixed(of);
                self.outline(Slot, one, &ends, if is_light { All } else { Full });
            }
            kind => {
                // Two rails, each hatched on its outer side.
                let share = match kind {
                    JointKind::Slot { .. } => SLOT_DISTANCE,
                    _ => RAIL_DISTANCE,
                };
                let across = axis.perp() * (share * self.size);
                self.outline(GroundLine, one, &[from - across, to - across], Full);
                self.outline(GroundLine, one, &[to + across, from + across], Full);
            }
        }
    }

    /// The curves that the followers' points follow on their cams.
    fn cams(&mut self, positions: &[Vec<BodyPose>]) {
        let scene = self.scene;
        let couplings = scene.mechanism.couplings.iter();
        for cam in couplings.filter_map(|coupling| pitch_curve(scene, coupling, positions)) {
            let body = BodyId(cam.body);
            if self.is_visible(&[body]) {
                let look = if cam.closed {
                    OutlineLook::Cam
                } else {
                    OutlineLook::OpenCam
                };
                self.outline(look, body, &cam.points, DrawnIn::Full);
            }
        }
    }

    fn driven_lengths(&mut self) {
        for actuator in &self.scene.mechanism.actuators {
            if let ActuatorKind::Length(points) = actuator.kind
                && self.is_visible(&actuator.bodies)
            {
                let title = format!("driven length {}", actuator.name);
                let (look, bodies) = (LinkLook::Cylinder, actuator.bodies);
                self.link(look, bodies, points, None, title, DrawnIn::All);
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
            let body = BodyId(b);
            let (look, points) = outline_of(scene, b, self.size);
            self.outline(look, body, &points, DrawnIn::All);
            for corners in blocks_on(scene, b, self.size) {
                self.outline(OutlineLook::Block, body, &corners, DrawnIn::All);
            }
        }
    }

    /// Springs and dampers between points.
    fn loads(&mut self) {
        for load in &self.scene.loads {
            if let Some((look, [from, to])) = link_of(&load.kind) {
                let (bodies, points) = ([from.0, to.0], [from.1, to.1]);
                let title = load.name.clone();
                self.link(look, bodies, points, None, title, DrawnIn::Full);
            }
        }
    }

    fn mark(&mut self, look: MarkLook, joint: &Joint, k: usize, label: String, drawn_in: DrawnIn) {
        let at = anchor(joint.bodies[k], joint.points[k]);
        let mark = Mark {
            look,
            ground: if self.is_fixed(joint) {
                vec![at.clone()]
            } else {
                Vec::new()
            },
            at,
            body: joint.bodies[k].0,
            label,
            title: self.title(joint, joint_word(joint.kind)),
            ..Mark::default()
        };
        self.parts.push((Part::Mark(mark), drawn_in));
    }

    /// Pins and welds.
    fn joints(&mut self, labels: &[(usize, String)]) {
        for (j, joint) in self.visible_joints() {
            let (look, ends, drawn_in) = match joint.kind {
                JointKind::Revolute if self.is_fixed(joint) => (MarkLook::Pin, 0..1, DrawnIn::Full),
                JointKind::Revolute => (MarkLook::Pin, 0..1, DrawnIn::All),
                JointKind::Slot { .. } => (MarkLook::Pin, 1..2, DrawnIn::All),
                JointKind::Distance { .. } => (MarkLook::Pin, 0..2, DrawnIn::All),
                JointKind::Weld { .. } => (MarkLook::Weld, 0..1, DrawnIn::All),
                // A prismatic joint is drawn by its line and block, gears and wheels by their circles.
                JointKind::Prismatic { .. }
                | JointKind::Gear { .. }
                | JointKind::Rack { .. }
                | JointKind::Rolling { .. }
                | JointKind::Coupling(_) => continue,
            };
            let label = labels.iter().find(|(of, _)| *of == j);
            let label = label.map_or_else(String::new, |(_, label)| label.clone());
            for k in ends {
                self.mark(look, joint, k, label.clone(), drawn_in);
            }
        }
    }

    /// A joint in words.
    fn title(&self, joint: &Joint, kind: &str) -> String {
        let [one, two] = joint.bodies.map(|b| self.scene.mechanism.body_name(b));
        format!("{} ({kind} of {one} and {two})", joint.name)
    }
}

pub(crate) fn point(at: Vec2) -> Vec<f64> {
    vec![at.x, at.y]
}

/// A point of a body on a page.
pub(crate) fn anchor(body: BodyId, at: Vec2) -> Anchor {
    Anchor {
        body: body.0,
        point: point(at),
    }
}

pub(crate) fn anchors(bodies: [BodyId; 2], points: [Vec2; 2]) -> [Anchor; 2] {
    [0, 1].map(|k| anchor(bodies[k], points[k]))
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
