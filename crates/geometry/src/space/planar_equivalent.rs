//! The planar mechanism that moves as one in space does whose bodies all move parallel to one plane of the ground.

use super::closure::RowKind;
use super::joint_kinds::JointKind;
use super::mechanism::{ActuatorKind, Joint, Mechanism, Placement};
use super::plan::{JointPlace, Plan, Pose};
use super::planes::{is_across, is_parallel};
use super::tree::FreedomKind;
use super::vector::{Rotation, Vec3};
use crate::mechanism as planar;
use crate::plan::AssemblyConfiguration;
use crate::plane::{Vec2, vec2};

/// A planar mechanism with the same bodies, joints and coordinate, by their numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanarEquivalent {
    /// The mechanism.
    pub mechanism: planar::Mechanism,
    /// Its assembly.
    pub assembly: AssemblyConfiguration,
    /// By body: the frame whose x and y axes are those of the body in the plane, in the [evaluation frame](Plan::evaluation_frame).
    pub frames: Vec<Placement>,
    /// By body: the height of the evaluation frame's origin along the normal, m; it is constant.
    pub heights: Vec<f64>,
    /// By joint: the heights of its points on both bodies, m.
    pub joint_heights: Vec<[f64; 2]>,
    /// By joint: the bodies that it carries in the [tree](super::tree); `None` for a joint that closes a loop: nothing moves its rows
    /// across the plane, so its moments across the plane are zero.
    pub carried: Vec<Option<Vec<usize>>>,
}

/// A mechanism in space at its assembly, seen along the normal of its plane.
struct View<'a> {
    mechanism: &'a Mechanism,
    plan: &'a Plan,
    pose: Pose,
    normal: Vec3,
    /// By body: where it is, and the axes of the plane in its frame.
    placements: Vec<Placement>,
    axes: Vec<Rotation>,
}

impl Plan {
    /// The planar mechanism with the same motion in its plane; `None` if there is none, if the mechanism does not have exactly one
    /// actuator of a joint, or if planes are not searched for.
    pub fn planar_equivalent(&self, mechanism: &Mechanism) -> Option<PlanarEquivalent> {
        let ([actuator], true) = (&mechanism.actuators[..], self.has_planes) else {
            return None;
        };
        let driven = mechanism.joints.get(actuator.kind.joint().0)?;
        let view = self.view(mechanism, actuator.kind)?;
        let joints = mechanism.joints.iter().map(|joint| view.joint(joint));
        let (joints, branch_hints): (Vec<_>, Vec<_>) =
            joints.collect::<Option<Vec<_>>>()?.into_iter().unzip();
        let kind = match actuator.kind {
            ActuatorKind::Angle(_) => planar::ActuatorKind::Angle,
            ActuatorKind::Travel(joint) => planar::ActuatorKind::Travel(joint),
            ActuatorKind::Length(_) => return None,
        };
        let guesses = (0..mechanism.bodies.len()).map(|b| Some(view.angle(b)));
        let frames = view.axes.iter().enumerate().map(|(b, axes)| Placement {
            position: Vec3::ZERO,
            rotation: self.tree.internal[b].rotation.inverse().after(axes),
        });
        let heights = view.pose.frames.iter();
        let heights = heights.map(|frame| view.normal.dot(frame.position));
        let carried = self.joint_places.iter().map(|place| match *place {
            JointPlace::Link(link) => Some(self.carried_by(link)),
            JointPlace::Closure(_) => None,
        });
        let joint_heights = mechanism.joints.iter().map(|joint| view.heights(joint));
        Some(PlanarEquivalent {
            heights: heights.collect(),
            joint_heights: joint_heights.collect(),
            carried: carried.collect(),
            frames: frames.collect(),
            assembly: AssemblyConfiguration {
                q: self.assembly_q.clone(),
                initial_guess: guesses.collect(),
                branch_hints,
            },
            mechanism: planar::Mechanism {
                bodies: mechanism.bodies.clone(),
                ground: mechanism.ground,
                joints,
                actuators: vec![planar::Actuator::new(&*actuator.name, driven.bodies, kind)],
                couplings: Vec::new(),
            },
        })
    }

    /// The bodies beyond a link, its own among them.
    fn carried_by(&self, link: usize) -> Vec<usize> {
        let mut carried = vec![self.tree.links[link].body];
        for other in &self.tree.links[link + 1..] {
            if carried.contains(&other.parent) {
                carried.push(other.body);
            }
        }
        carried
    }

    /// The view of the mechanism along the normal of its plane. The axes of the bodies are chosen so that the coordinate is that
    /// of the actuator.
    fn view<'a>(&'a self, mechanism: &'a Mechanism, kind: ActuatorKind) -> Option<View<'a>> {
        let mut pose = self.pose();
        self.start_from(&self.start, 0.0, &mut pose);
        self.close(&self.assembly_q, None, &mut pose).ok()?;
        let mut normal = self.common_normal(&pose)?;
        let bodies = 0..mechanism.bodies.len();
        let placements: Vec<Placement> = bodies.map(|b| self.placement(&pose, b)).collect();
        let joint = &mechanism.joints[kind.joint().0];
        let is_angle = matches!(kind, ActuatorKind::Angle(_));
        if is_angle {
            let [first, _] = joint.bodies;
            normal = placements[first.0].rotation.apply(joint.sides[0].axis);
        }
        let axes = placements.iter().enumerate().map(|(b, placement)| {
            let own = placement.rotation.apply_inverse(normal);
            // The angle is counted between the normals of the joint, about its axis.
            let side = (0..2).find(|k| is_angle && joint.bodies[*k].0 == b);
            match side.map(|k| &joint.sides[k]) {
                Some(side) => Rotation::of_axes(side.axis, side.normal),
                None => Rotation::of_axes(own, own.any_normal()),
            }
        });
        Some(View {
            axes: axes.collect(),
            plan: self,
            pose,
            mechanism,
            normal,
            placements,
        })
    }

    /// The normal of the plane to which every body moves parallel.
    fn common_normal(&self, pose: &Pose) -> Option<Vec3> {
        let is_turn = |freedom: &usize| self.tree.freedoms[*freedom] == FreedomKind::Turn;
        let axis = |freedom: usize| pose.screws[freedom].axis;
        let mut freedoms = 0..self.tree.freedoms.len();
        let normal = axis(freedoms.clone().find(is_turn)?);
        // A slide along the normal stands still where no row moves both it and what turns.
        let is_parted = |freedom: usize| {
            let driven = self.drivers.iter().any(|driver| driver.freedom == freedom);
            let mut closures = self.closures.iter();
            !driven
                && closures.all(|closure| {
                    closure
                        .kinds
                        .iter()
                        .all(|kind| !matches!(kind, RowKind::Length(_)))
                })
        };
        let fits = |freedom: usize| match self.tree.freedoms[freedom] {
            FreedomKind::Turn => is_parallel(axis(freedom), normal),
            FreedomKind::Slide if is_across(axis(freedom), normal) => true,
            FreedomKind::Slide => is_parallel(axis(freedom), normal) && is_parted(freedom),
            FreedomKind::Screw(_) | FreedomKind::BallTurn | FreedomKind::Length => false,
        };
        let mut closures = self.closures.iter();
        (freedoms.all(fits) && closures.all(|c| !c.unmoved.is_empty())).then_some(normal)
    }
}

impl View<'_> {
    /// A vector of a body in the axes of the plane.
    fn flat(&self, body: usize, v: Vec3) -> Vec2 {
        let v = self.axes[body].apply_inverse(v);
        vec2(v.x, v.y)
    }

    /// The direction of a vector of the ground's axes in the plane, rad.
    fn direction(&self, v: Vec3) -> f64 {
        let ground = self.mechanism.ground;
        let own = self.placements[ground].rotation.apply_inverse(v);
        self.flat(ground, own).angle()
    }

    /// The angle of a body's axes, rad.
    fn angle(&self, body: usize) -> f64 {
        let x = self.axes[body].columns[0];
        self.direction(self.placements[body].rotation.apply(x))
    }

    /// A joint's point on one of its bodies, in the evaluation frame.
    fn inner_point(&self, joint: &Joint, side: usize) -> Vec3 {
        let internal = &self.plan.tree.internal[joint.bodies[side].0];
        internal.inner_point(joint.sides[side].point)
    }

    /// The position of a point of a joint, m.
    fn point(&self, joint: &Joint, side: usize) -> Vec3 {
        let frame = &self.pose.frames[joint.bodies[side].0];
        frame.point(self.inner_point(joint, side))
    }

    /// The heights of a joint's points on both bodies, m.
    fn heights(&self, joint: &Joint) -> [f64; 2] {
        [0, 1].map(|side| self.normal.dot(self.point(joint, side)))
    }

    /// A joint with the approximate value by which its branch is chosen; `None` if it has no equivalent.
    fn joint(&self, joint: &Joint) -> Option<(planar::Joint, Option<f64>)> {
        let [a, b] = joint.bodies.map(|body| body.0);
        let axis = self.placements[a].rotation.apply(joint.sides[0].axis);
        let (along, across) = (is_parallel(axis, self.normal), is_across(axis, self.normal));
        let d = self.point(joint, 1) - self.point(joint, 0);
        let (kind, hint) = match joint.kind {
            JointKind::Revolute | JointKind::Cylindrical if along => {
                (planar::JointKind::Revolute, None)
            }
            JointKind::Spherical => (planar::JointKind::Revolute, None),
            JointKind::Prismatic if across => {
                let unit = |k: usize, body: usize| {
                    let flat = self.flat(body, joint.sides[k].axis);
                    flat * (1.0 / flat.norm())
                };
                let axes = [unit(0, a), unit(1, b)];
                (planar::JointKind::Prismatic { axes }, Some(axis.dot(d)))
            }
            JointKind::Weld => {
                let angle = self.angle(b) - self.angle(a);
                (planar::JointKind::Weld { angle }, None)
            }
            JointKind::Distance { length } => {
                let height = self.normal.dot(d);
                let length = (length * length - height * height).sqrt();
                let hint = self.direction(d);
                (planar::JointKind::Distance { length }, Some(hint))
            }
            _ => return None,
        };
        let points = [0, 1].map(|k| {
            let body = joint.bodies[k].0;
            let from_origin = joint.sides[k].point - self.plan.tree.internal[body].position;
            self.flat(body, from_origin)
        });
        Some((
            planar::Joint::new(&*joint.name, joint.bodies, points, kind),
            hint,
        ))
    }
}
