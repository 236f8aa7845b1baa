//! The drawn parts of a mechanism in space, fixed to its bodies: pictures show them from several sides, and a page turns them.

use super::arrangement::{GUIDE_MARGIN, SpaceDrawing};
use super::segments::{line_of, nearest_of_segment};
use crate::symbols::link_of;
use dwell_geometry::space::{ActuatorKind, Joint, JointKind, Vec3};
use dwell_geometry::{BodyId, JointId};
use dwell_page::{Anchor, LinkLook, Mark, MarkLook, OutlineLook, Part};

impl SpaceDrawing<'_> {
    /// The parts in their order: bodies, joints, drives and loads, centres of mass.
    pub(super) fn parts(&self) -> Vec<Part> {
        let scene = self.scene;
        let mut drawn = SpaceParts {
            drawing: self,
            parts: Vec::new(),
        };
        let bodies = (0..scene.mechanism.bodies.len()).map(BodyId);
        let moving = bodies.filter(|b| !self.is_ground(*b));
        for body in moving.clone() {
            drawn.body(body);
        }
        for j in 0..scene.mechanism.joints.len() {
            drawn.joint(j);
        }
        for actuator in &scene.mechanism.actuators {
            drawn.driven(actuator.kind);
        }
        for load in &scene.loads {
            if let Some((look, ends)) = link_of(&load.kind) {
                let ends = ends.map(|(body, point)| anchor(body, point));
                drawn.link(look, ends, load.name.clone());
            }
        }
        for body in moving {
            drawn.center_of_mass(body);
        }
        drawn.parts
    }
}

struct SpaceParts<'a> {
    drawing: &'a SpaceDrawing<'a>,
    parts: Vec<Part>,
}

impl SpaceParts<'_> {
    fn outline(&mut self, look: OutlineLook, body: BodyId, points: &[Vec3]) {
        self.parts.push(Part::Outline {
            look,
            body: body.0,
            points: points.iter().map(|p| coordinates(*p)).collect(),
        });
    }

    fn link(&mut self, look: LinkLook, ends: [Anchor; 2], title: String) {
        self.parts.push(Part::Link {
            look,
            ends,
            axis: Vec::new(),
            body: None,
            title,
        });
    }

    /// A bar between two points; a plate through three, or the bars from the middle of more; a ring about one.
    fn body(&mut self, body: BodyId) {
        let points = self.drawing.drawn_points(body.0);
        let line = match points[..] {
            [] => return,
            [_] if self.drawing.is_block(body) => return,
            [point] => {
                let title = self.drawing.scene.mechanism.bodies[body.0].name.clone();
                return self.own_mark(MarkLook::Ring, body, point, title);
            }
            [a, b] => Some([a, b]),
            _ => line_of(&points, self.drawing.same),
        };
        match line {
            Some(ends) => self.outline(OutlineLook::Bar, body, &ends),
            None if points.len() == 3 => self.outline(OutlineLook::Plate, body, &points),
            None => {
                let middle = self.drawing.middle(body);
                for p in points {
                    self.outline(OutlineLook::Bar, body, &[middle, p]);
                }
            }
        }
    }

    /// The mark of a centre of mass, with a line to the body if it is off the body.
    fn center_of_mass(&mut self, body: BodyId) {
        let mass = &self.drawing.scene.masses[body.0];
        if mass.mass == 0.0 {
            return;
        }
        let foot = match self.drawing.drawn_points(body.0)[..] {
            [] => mass.center,
            [a, b] => nearest_of_segment([a, b], mass.center),
            _ => self.drawing.middle(body),
        };
        if (foot - mass.center).norm() > self.drawing.unit {
            self.outline(OutlineLook::Arm, body, &[foot, mass.center]);
        }
        let name = &self.drawing.scene.mechanism.bodies[body.0].name;
        let title = format!("centre of mass of {name}");
        self.own_mark(MarkLook::CenterOfMass, body, mass.center, title);
    }

    /// A mark of a body alone.
    fn own_mark(&mut self, look: MarkLook, body: BodyId, at: Vec3, title: String) {
        self.parts.push(Part::Mark(Mark {
            look,
            at: anchor(body, at),
            body: body.0,
            title,
            ..Mark::default()
        }));
    }

    /// A mark of a joint on its `k`th body, along the axes of one of its bodies and in the colour of one.
    fn mark(&self, look: MarkLook, j: usize, k: usize, [of, colored]: [usize; 2]) -> Mark {
        let mechanism = &self.drawing.scene.mechanism;
        let joint = &mechanism.joints[j];
        let [one, two] = joint.bodies.map(|b| mechanism.bodies[b.0].name.as_str());
        Mark {
            look,
            at: self.at(j, k),
            frame: joint.side_body(of).0,
            axis: coordinates(joint.sides[of].axis),
            normal: coordinates(joint.sides[of].normal),
            body: joint.bodies[colored].0,
            label: joint.name.clone(),
            title: format!("{} (joint of {one} and {two})", joint.name),
            ..Mark::default()
        }
    }

    /// Adds a mark without a label, drawn under the later ones.
    fn add(&mut self, mark: Mark) {
        self.parts.push(Part::Mark(Mark {
            label: String::new(),
            ..mark
        }));
    }

    fn at(&self, j: usize, k: usize) -> Anchor {
        let joint = &self.drawing.scene.mechanism.joints[j];
        anchor(joint.side_body(k), self.drawing.anchor(j, k))
    }

    /// For a joint on the ground, the middle of its moving body.
    fn ground(&self, joint: &Joint) -> Vec<Anchor> {
        let on = (0..2).find(|k| self.drawing.is_ground(joint.bodies[*k]));
        on.map(|k| self.middle(joint.bodies[1 - k]))
            .into_iter()
            .collect()
    }

    fn middle(&self, body: BodyId) -> Anchor {
        anchor(body, self.drawing.middle(body))
    }

    /// The symbol of a joint; its last mark has the label.
    //
    // Long: a few lines for each kind of joint.
    fn joint(&mut self, j: usize) {
        let joint = &self.drawing.scene.mechanism.joints[j];
        let on = self.drawing.guide_side(joint);
        let is_ground = |k: usize| self.drawing.is_ground(joint.bodies[k]);
        let mut ground = self.ground(joint);
        let (look, k, axes) = match joint.kind {
            // In the colour of the body that moves, so that one of two hinges close together is seen, too.
            JointKind::Revolute => (MarkLook::Hinge, 1, [0, usize::from(!is_ground(1))]),
            JointKind::Spherical => (MarkLook::Ball, 1, [0, 1]),
            // A sleeve on the ground, through which a rod of the other body goes.
            JointKind::Cylindrical if !ground.is_empty() => {
                let ends = [on, 1 - on].map(|k| self.at(j, k));
                self.link(LinkLook::Shaft, ends, joint.name.clone());
                if let Some(Part::Link { axis, body, .. }) = self.parts.last_mut() {
                    *axis = coordinates(joint.sides[on].axis);
                    *body = Some(joint.bodies[1 - on].0);
                }
                (MarkLook::Sleeve, on, [on, on])
            }
            JointKind::Cylindrical | JointKind::Helical { .. } => {
                self.guide(j);
                ground.clear();
                let look = match joint.kind {
                    JointKind::Helical { pitch } if pitch < 0.0 => MarkLook::LeftScrew,
                    JointKind::Helical { .. } => MarkLook::Screw,
                    _ => MarkLook::Sleeve,
                };
                (look, 1, [0, 1])
            }
            // A block on its guide: a hatched line of the ground, or a rod of the other body.
            JointKind::Prismatic => {
                ground.clear();
                if is_ground(on) {
                    ground.extend(self.guide_ends(j).map(|end| anchor(joint.bodies[on], end)));
                } else {
                    self.guide(j);
                }
                (MarkLook::Slide, 1 - on, [on, 1 - on])
            }
            JointKind::Universal => {
                ground.clear();
                for k in 0..2 {
                    let fork = self.mark(MarkLook::Fork, j, 1, [k, k]);
                    self.add(Mark {
                        normal: coordinates(self.drawing.stem(j, k)),
                        ground: if is_ground(k) {
                            vec![self.at(j, 1)]
                        } else {
                            Vec::new()
                        },
                        ..fork
                    });
                }
                (MarkLook::Cross, 1, [0, 1])
            }
            JointKind::Planar => {
                self.add(self.mark(MarkLook::Plate, j, 1, [0, 0]));
                (MarkLook::Disc, 1, [0, 1])
            }
            JointKind::PointInPlane => {
                self.add(self.mark(MarkLook::Plate, j, 1, [0, 0]));
                (MarkLook::Ball, 1, [0, 1])
            }
            JointKind::PointOnLine => {
                self.guide(j);
                ground.clear();
                (MarkLook::Ball, 1, [0, 1])
            }
            // A massless rod with its balls.
            JointKind::Distance { .. } => {
                let name = joint.name.clone();
                self.link(LinkLook::Rod, [0, 1].map(|k| self.at(j, k)), name);
                let ground = |k: usize| is_ground(k).then(|| self.middle(joint.bodies[1]));
                let ball = |k: usize| Mark {
                    ground: ground(k).into_iter().collect(),
                    ..self.mark(MarkLook::RodEnd, j, k, [0, 1])
                };
                let [first, second] = [0, 1].map(ball);
                self.add(first);
                return self.parts.push(Part::Mark(second));
            }
            JointKind::Weld => (MarkLook::Weld, 1, [0, 1]),
            // Not a part of the machine, but a law between two coordinates.
            JointKind::Coupling { .. } => return,
            JointKind::Gear { .. } => {
                ground.clear();
                (MarkLook::Teeth, 1, [0, 1])
            }
        };
        let mark = self.mark(look, j, k, axes);
        self.parts.push(Part::Mark(Mark { ground, ..mark }));
    }

    /// The straight rod of one body on which the other one slides.
    fn guide(&mut self, j: usize) {
        let joint = &self.drawing.scene.mechanism.joints[j];
        let body = joint.bodies[self.drawing.guide_side(joint)];
        self.outline(OutlineLook::Guide, body, &self.guide_ends(j));
    }

    /// The ends of the guide of a sliding joint.
    fn guide_ends(&self, j: usize) -> [Vec3; 2] {
        let joint = &self.drawing.scene.mechanism.joints[j];
        let on = self.drawing.guide_side(joint);
        let (start, axis) = (self.drawing.anchor(j, on), joint.sides[on].axis);
        let travel = self.drawing.travels[j];
        let [low, high] = if travel[0] <= travel[1] {
            travel
        } else {
            [0.0; 2]
        };
        let [low, high] = if on == 0 { [low, high] } else { [-high, -low] };
        let margin = GUIDE_MARGIN * self.drawing.unit;
        [low - margin, high + margin].map(|s| start + axis.scaled(s))
    }

    /// The arrow of an actuator: about the axis of its joint, along it, or beside the rod.
    fn driven(&mut self, kind: ActuatorKind) {
        let JointId(j) = kind.joint();
        let look = match kind {
            ActuatorKind::Angle(_) => MarkLook::Turned,
            ActuatorKind::Travel(_) => MarkLook::Pushed,
            ActuatorKind::Length(_) => {
                let name = self.drawing.scene.mechanism.joints[j].name.clone();
                return self.link(LinkLook::Drive, [0, 1].map(|k| self.at(j, k)), name);
            }
        };
        self.add(self.mark(look, j, 1, [0, 1]));
    }
}

fn coordinates(p: Vec3) -> Vec<f64> {
    Vec3::AXES.map(|axis| axis.dot(p)).to_vec()
}

/// A point of a body on a page.
pub(crate) fn anchor(body: BodyId, p: Vec3) -> Anchor {
    Anchor {
        body: body.0,
        point: coordinates(p),
    }
}
