//! The spanning tree: each body is placed from its parent by one joint.

use super::frames::Frame;
use super::joint_kinds::{Condition, JointKind};
use super::mechanism::{Actuator, ActuatorKind, Assembly, Joint, JointNumbers, Mechanism, Side};
use super::vector::{Rotation, Vec3};
use crate::error::StructureError;
use crate::mechanism::{BodyId, JointId};
use dwell_numerics::{Constant, Lift, Scalar};
use std::ops::Range;

/// How a freedom of a tree joint moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FreedomKind<C = f64> {
    /// Rotation about the axis: rad.
    Turn,
    /// Translation along the axis: m.
    Slide,
    /// Rotation, with so much translation along the axis, m/rad.
    Screw(C),
    /// Rotation about an axis of the ground: one of three components of a small turn.
    BallTurn,
    /// The distance of two points, which an actuator or a coupling gives, m: no link moves by it.
    Length,
}

impl<C> FreedomKind<C> {
    /// The angular velocity along its axis at unit rate.
    #[inline(always)]
    pub(super) fn angular(&self) -> f64 {
        match self {
            Self::Turn | Self::BallTurn | Self::Screw(_) => 1.0,
            Self::Slide | Self::Length => 0.0,
        }
    }
}

/// One step from the frame of the parent to that of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    /// Rotation about the frame's z axis by a freedom, which may translate along it.
    Turn(usize),
    /// Translation along the frame's axis of this number by a freedom.
    Slide(usize, usize),
    /// The frame's axes renamed, so that y becomes z: between the two axes of a universal joint.
    NextAxis,
    /// Any rotation, of the ball of this number; its three freedoms begin with this one.
    Ball(usize, usize),
}

/// The placement of a body relative to its parent. Here the frame of the body is that of the joint on it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Link<C = f64> {
    pub(super) body: usize,
    pub(super) parent: usize,
    /// `None` if only distances hold the body.
    pub(super) joint: Option<JointId>,
    /// −1 where the body is the joint's first: its coordinates then count backwards.
    pub(super) sign: f64,
    /// The joint's frame on the parent.
    pub(super) on_parent: Frame<C>,
    pub(super) steps: Vec<Step>,
    pub(super) freedoms: Range<usize>,
}

/// The tree.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Tree<C = f64> {
    /// The links, from the ground outwards.
    pub(super) links: Vec<Link<C>>,
    /// By body: the link that places it; none for the ground.
    pub(super) link_of: Vec<Option<usize>>,
    /// By body: the frame in which it is evaluated, in its own frame.
    pub(super) internal: Vec<Frame<C>>,
    /// The bodies that no joint places, the ground among them, each with the joint and its side at whose point its frame is.
    pub(super) placed_at: Vec<(usize, JointId, usize)>,
    pub(super) freedoms: Vec<FreedomKind<C>>,
    pub(super) balls: usize,
    /// The joints that close loops.
    pub(super) closures: Vec<JointId>,
    /// The distances that actuators and couplings give, with their freedoms, which come last.
    pub(super) driven_lengths: Vec<(JointId, usize)>,
}

/// The freedom that an actuator drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Driver<C = f64> {
    pub(super) freedom: usize,
    /// The coordinate of the freedom over that of the actuator: −1 where the tree counts it backwards.
    pub(super) factor: C,
    /// Whether its action is a force, and not a couple.
    pub(super) is_force: bool,
}

impl<C: Constant> Driver<C> {
    /// Its coordinate, rad or m, or the coordinate's rate, from those of all freedoms.
    #[inline(always)]
    pub(super) fn coordinate<T: Lift<C>>(&self, of_freedoms: &[T]) -> T {
        of_freedoms[self.freedom] / T::lift(self.factor)
    }
}

/// A side as a frame: origin in its point, z along the axis and x along the normal.
fn frame_of<C: Scalar>(side: &Side<C>) -> Frame<C> {
    Frame {
        position: side.point,
        rotation: Rotation::of_axes(side.axis, side.normal),
    }
}

impl<C: Scalar> Side<C> {
    /// This side in another frame of its body.
    pub(super) fn in_frame(&self, frame: &Frame<C>) -> Self {
        Self {
            point: frame.inner_point(self.point),
            axis: frame.rotation.apply_inverse(self.axis),
            normal: frame.rotation.apply_inverse(self.normal),
        }
    }
}

impl Tree {
    /// Finds the tree; `measured` are the joints that measure coupled distances.
    ///
    /// # Errors
    /// [`StructureError::NotConnected`] for bodies that no joint connects with the ground.
    pub(super) fn find(
        mechanism: &Mechanism,
        in_tree: &[bool],
        measured: &[Option<JointId>],
    ) -> Result<Self, StructureError> {
        let mut tree = Self {
            link_of: vec![None; mechanism.bodies.len()],
            internal: vec![Frame::default(); mechanism.bodies.len()],
            ..Self::default()
        };
        // A point of the ground near the mechanism is its origin: results do not depend on where it stands.
        let ground = mechanism.ground;
        tree.place_at_first_joint(mechanism, ground);
        let mut reached = vec![ground];
        let mut next = 0;
        loop {
            while let Some(&parent) = reached.get(next) {
                next += 1;
                for (j, joint) in mechanism
                    .joints
                    .iter()
                    .enumerate()
                    .filter(|(j, _)| in_tree[*j])
                {
                    for (side, sign) in [(0, 1.0), (1, -1.0)] {
                        let body = joint.bodies[1 - side].0;
                        let placed = body == ground || tree.link_of[body].is_some();
                        if joint.bodies[side].0 == parent && !placed {
                            tree.add_link(mechanism, body, parent, Some((JointId(j), sign)));
                            reached.push(body);
                        }
                    }
                }
            }
            // Whatever only distances hold moves freely from the ground.
            let held = tree.next_held(mechanism);
            let Some(body) = held else { break };
            tree.add_link(mechanism, body, ground, None);
            reached.push(body);
        }
        let lost =
            (0..mechanism.bodies.len()).filter(|b| *b != ground && tree.link_of[*b].is_none());
        let lost: Vec<BodyId> = lost.map(BodyId).collect();
        if !lost.is_empty() {
            return Err(StructureError::NotConnected { bodies: lost });
        }
        tree.closures = (0..mechanism.joints.len())
            .filter(|j| !in_tree[*j])
            .map(JointId)
            .collect();
        tree.add_lengths(&mechanism.actuators, measured);
        let numbers: Vec<JointNumbers> = mechanism.joints.iter().map(Joint::numbers).collect();
        tree.set_numbers(&numbers);
        Ok(tree)
    }

    /// Adds the freedoms of the distances that actuators drive, and of those that couplings measure.
    fn add_lengths(&mut self, actuators: &[Actuator], measured: &[Option<JointId>]) {
        let of_actuator = |actuator: &Actuator| match actuator.kind {
            ActuatorKind::Length(joint) => Some(joint),
            ActuatorKind::Angle(_) | ActuatorKind::Travel(_) => None,
        };
        let by_actuators = actuators.iter().filter_map(of_actuator);
        for joint in by_actuators.chain(measured.iter().flatten().copied()) {
            self.driven_lengths.push((joint, self.freedoms.len()));
            self.freedoms.push(FreedomKind::Length);
        }
    }

    /// A body that is not placed yet and that a joint connects with one that is.
    fn next_held(&self, mechanism: &Mechanism) -> Option<usize> {
        let is_placed = |b: usize| b == mechanism.ground || self.link_of[b].is_some();
        mechanism.joints.iter().find_map(|joint| {
            let [a, b] = joint.bodies.map(|b| b.0);
            match (is_placed(a), is_placed(b)) {
                (true, false) => Some(b),
                (false, true) => Some(a),
                _ => None,
            }
        })
    }

    fn add_link(
        &mut self,
        mechanism: &Mechanism,
        body: usize,
        parent: usize,
        by: Option<(JointId, f64)>,
    ) {
        let first = self.freedoms.len();
        let steps = match by {
            None => {
                self.place_at_first_joint(mechanism, body);
                self.freedoms.extend([FreedomKind::Slide; 3]);
                let mut steps: Vec<Step> = (0..3).map(|k| Step::Slide(k, first + k)).collect();
                steps.push(self.ball());
                steps
            }
            Some((joint, _)) => self.steps_of(mechanism.joints[joint.0].kind),
        };
        self.link_of[body] = Some(self.links.len());
        self.links.push(Link {
            body,
            parent,
            joint: by.map(|(joint, ..)| joint),
            sign: by.map_or(1.0, |(_, sign)| sign),
            on_parent: Frame::default(),
            steps,
            freedoms: first..self.freedoms.len(),
        });
    }

    /// Puts the frame of a body at the point of the first joint on it; of a body without a joint it stays at its origin.
    fn place_at_first_joint(&mut self, mechanism: &Mechanism, body: usize) {
        let mut joints = mechanism.joints.iter().enumerate();
        let on_body = joints.find_map(|(j, joint)| {
            let side = (0..2).find(|k| joint.side_body(*k).0 == body)?;
            Some((body, JointId(j), side))
        });
        self.placed_at.extend(on_body);
    }

    /// A ball with its three freedoms.
    fn ball(&mut self) -> Step {
        let step = Step::Ball(self.balls, self.freedoms.len());
        self.freedoms.extend([FreedomKind::BallTurn; 3]);
        self.balls += 1;
        step
    }

    /// The steps of a tree joint, with its freedoms: translations of the second point, then rotations.
    fn steps_of(&mut self, kind: JointKind) -> Vec<Step> {
        if let JointKind::Helical { pitch } = kind {
            return vec![Step::Turn(self.add(FreedomKind::Screw(pitch)))];
        }
        let mut steps = Vec::new();
        // Of a cylindrical joint the angle is the first freedom, though its step is the last.
        let angle = kind.has_angle().then(|| self.add(FreedomKind::Turn));
        let slides: &[usize] = if kind.holds(Condition::OnLine) {
            &[2]
        } else if kind.holds(Condition::InPlane) {
            &[0, 1]
        } else {
            &[]
        };
        for axis in slides {
            steps.push(Step::Slide(*axis, self.add(FreedomKind::Slide)));
        }
        let is_turned = kind.holds(Condition::Axes) && !kind.holds(Condition::Normals);
        if is_turned {
            let angle = angle.unwrap_or_else(|| self.add(FreedomKind::Turn));
            steps.push(Step::Turn(angle));
        } else if kind.holds(Condition::AxesAcross) {
            let [first, second] = [(); 2].map(|()| self.add(FreedomKind::Turn));
            steps.extend([Step::Turn(first), Step::NextAxis, Step::Turn(second)]);
        } else if !kind.holds(Condition::Axes) {
            steps.push(self.ball());
        }
        steps
    }

    /// Adds a freedom; its number.
    fn add(&mut self, freedom: FreedomKind) -> usize {
        self.freedoms.push(freedom);
        self.freedoms.len() - 1
    }

    /// Approximate coordinates and rotations of the balls from approximate placements of the bodies.
    pub(super) fn approximate_coordinates(&self, assembly: &Assembly) -> (Vec<f64>, Vec<Rotation>) {
        let mut coordinates = vec![0.0; self.freedoms.len()];
        let mut balls = vec![Rotation::IDENTITY; self.balls];
        let placed = |body: usize| assembly.placement(body).then(&self.internal[body]);
        for link in &self.links {
            let mut from = placed(link.parent).then(&link.on_parent);
            let to = placed(link.body);
            for step in &link.steps {
                let relative = from.inverse().then(&to);
                match *step {
                    Step::Turn(c) => {
                        // Of a universal joint, the turn that brings y nearest to the second axis.
                        let next = link.steps.contains(&Step::NextAxis) && c == link.freedoms.start;
                        let x = relative.rotation.columns[if next { 2 } else { 0 }];
                        let angle = if next {
                            (-x.x).atan2(x.y)
                        } else {
                            x.y.atan2(x.x)
                        };
                        coordinates[c] = angle;
                        let travel = match self.freedoms[c] {
                            FreedomKind::Screw(pitch) => pitch * angle,
                            _ => 0.0,
                        };
                        from.position += from.rotation.columns[2].scaled(travel);
                        from.rotation = from.rotation.turned_about_z(angle.sin_cos());
                    }
                    Step::Slide(axis, c) => {
                        let travel = relative.position.dot(Vec3::AXES[axis]);
                        coordinates[c] = travel;
                        from.position += from.rotation.columns[axis].scaled(travel);
                    }
                    Step::NextAxis => from.rotation = next_axis(&from.rotation),
                    Step::Ball(ball, _) => balls[ball] = relative.rotation,
                }
            }
        }
        (coordinates, balls)
    }
}

impl<C: Constant> Tree<C> {
    /// The freedom that an actuator drives; none of a joint outside the tree.
    pub(super) fn driven(&self, kind: ActuatorKind) -> Option<Driver<C>> {
        let joint = kind.joint();
        if let ActuatorKind::Length(_) = kind {
            let (_, freedom) = self.driven_lengths.iter().find(|(j, _)| *j == joint)?;
            return Some(Driver {
                freedom: *freedom,
                factor: C::from_f64(1.0),
                is_force: true,
            });
        }
        let link = self.links.iter().find(|link| link.joint == Some(joint))?;
        let is_travel = matches!(kind, ActuatorKind::Travel(_));
        let of_two = link.freedoms.len() == 2;
        let freedom = link.freedoms.start + usize::from(is_travel && of_two);
        let factor = match self.freedoms[freedom] {
            FreedomKind::Screw(pitch) if is_travel => C::from_f64(link.sign) / pitch,
            _ => C::from_f64(link.sign),
        };
        Some(Driver {
            freedom,
            factor,
            is_force: is_travel,
        })
    }

    /// The factor of a driver with the numbers of this tree.
    pub(super) fn factor(&self, of: Driver) -> C {
        let sign = C::from_f64(of.factor.signum());
        match self.freedoms[of.freedom] {
            FreedomKind::Screw(pitch) if of.is_force => {
                let link = self.links.iter().find(|l| l.freedoms.contains(&of.freedom));
                C::from_f64(link.map_or(1.0, |link| link.sign)) / pitch
            }
            _ => sign,
        }
    }

    /// Sets the frames and the pitches from the numbers of the joints.
    pub(super) fn set_numbers(&mut self, joints: &[JointNumbers<C>]) {
        for &(body, joint, side) in &self.placed_at {
            self.internal[body].position = joints[joint.0].sides[side].point;
        }
        for link in &mut self.links {
            let Some(joint) = link.joint else { continue };
            let numbers = &joints[joint.0];
            let parent_side = usize::from(link.sign < 0.0);
            let [mut on_parent, mut on_body] =
                [parent_side, 1 - parent_side].map(|k| numbers.sides[k]);
            // The first angle of a universal joint turns from any direction: the axes are at right angles.
            let is_universal = link.steps.contains(&Step::NextAxis);
            if is_universal {
                on_body.normal = on_body.axis.any_normal();
            }
            self.internal[link.body] = frame_of(&on_body);
            on_parent = on_parent.in_frame(&self.internal[link.parent]);
            if is_universal {
                on_parent.normal = on_parent.axis.any_normal();
            }
            link.on_parent = frame_of(&on_parent);
            for freedom in &mut self.freedoms[link.freedoms.clone()] {
                if let FreedomKind::Screw(pitch) = freedom {
                    *pitch = numbers.number;
                }
            }
        }
    }
}

/// The axes renamed: y becomes z, z becomes x.
#[inline(always)]
pub(super) fn next_axis<T: Copy>(frame: &Rotation<T>) -> Rotation<T> {
    let [x, y, z] = frame.columns;
    Rotation { columns: [z, x, y] }
}
