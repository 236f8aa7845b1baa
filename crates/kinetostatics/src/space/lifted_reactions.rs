//! The reactions of a mechanism that moves in a plane with the normal n, from those of its planar equivalent. In the plane they are the
//! same. Across it no inertia force acts, and, if no rod is oblique to the plane, no joint transmits one; a body with the
//! products of inertia I_xz, I_yz about its centre, the axes x, y in the plane and the angle θ requires the moment
//!
//! ```text
//! N = θ̈ u + θ̇² n×u,     u = I_xz x + I_yz y                                                              (1)
//! ```
//!
//! A joint j of the tree carries the bodies S. Joints that close loops transmit no moment across the plane
//! ([`PlanarEquivalent::carried`]), so that the balance of S about the joint's point on its second body, at the height z_j, is
//!
//! ```text
//! ±M_j = Σ_S N_b + n × Σ_k h_jk F_k,     h_jk = Σ_S s_kb (z_b − z_k)                                      (2)
//! ```
//!
//! with the forces F_k of all joints of these bodies, the sign s_kb = 1 where b is the second body of joint k and −1 where it is the first, the height
//! z_b of its centre of mass, and ± = s_jb of the joint's own body in S. The force of an actuator along a slide belongs to F_k. All h are
//! constants of the mechanism.

use super::mass::Mass;
use super::model::{Axes, Component, Model, Reaction};
use crate::model::Workspace as PlanarWorkspace;
use crate::reduced::Coefficients;
use dwell_geometry::space::{JointKind, PlanarEquivalent, Rotation, Vec3};
use dwell_geometry::{
    BodyId, Component as PlanarComponent, JointId, JointKind as PlanarJointKind, Plan, Pose,
    Reaction as PlanarReaction, Vec2, vec2,
};
use dwell_numerics::{Scalar, map_array};

/// Heights that differ by less, relative to the size, are equal: the rounding of numbers in a scene.
const LEVEL: f64 = 1e-13;

/// A direction in the plane that turns with a body.
#[derive(Debug, Clone, Copy, PartialEq)]
struct BodyDirection {
    /// The body's frame in the planar plan.
    frame: usize,
    local: Vec2,
}

/// The force of a joint in the plane, by numbers of planar reactions.
#[derive(Debug, Clone, Copy, PartialEq)]
enum PlanarForce {
    /// Along the axes of the plane: the second follows the first.
    Axes(usize),
    /// Along one direction.
    Along(usize, BodyDirection),
}

/// A direction of a requested component.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Direction {
    /// In the axes of the plane, the last along n.
    Ground(Vec3),
    /// In a body: in the plane, and along n.
    Body(BodyDirection, f64),
}

/// The requested part of a joint's reaction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    /// The force of this joint, by its index among the forces that are read.
    Force(usize),
    /// The moment of this number.
    Moment(usize),
}

/// The moment of a joint.
#[derive(Debug, Clone, PartialEq)]
struct LiftedMoment {
    /// The planar reaction that is its part along n, of a joint that bears one.
    along: Option<usize>,
    /// Its part across the plane, for a joint of the tree.
    across: Option<AcrossPlane>,
}

/// The terms of the sum (2) of a joint.
#[derive(Debug, Clone, PartialEq)]
struct AcrossPlane {
    /// ±.
    sign: f64,
    /// Joints by their place among the forces that are read, with h, m.
    forces: Vec<(usize, f64)>,
    /// Bodies, by their index among those with products of inertia.
    products: Vec<usize>,
    /// h of the actuator's force, m.
    driven: f64,
}

/// How the requested reactions follow from the planar ones.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct LiftedReactions {
    planar: Vec<PlanarReaction>,
    /// The forces that are read.
    forces: Vec<PlanarForce>,
    moments: Vec<LiftedMoment>,
    /// I_xz x + I_yz y of the bodies of (1), kg m².
    products: Vec<BodyDirection>,
    /// Along which the actuator drives a slide.
    driven: Option<BodyDirection>,
    /// By requested reaction.
    read: Vec<(Part, Direction)>,
    /// The bodies whose angles are read.
    bodies: Vec<BodyId>,
}

/// Memory for one thread. The two values are those of unit acceleration from rest and of unit speed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LiftedWorkspace<T> {
    forces: Vec<[Vec2<T>; 2]>,
    products: Vec<[Vec2<T>; 2]>,
}

impl BodyDirection {
    fn new(plan: &Plan, body: usize, local: Vec2) -> Self {
        let orientation = plan.frames().orientations[body];
        let (frame, local) = (orientation.frame, local.rotate(orientation.offset));
        Self { frame, local }
    }

    #[inline(always)]
    fn at<T: Scalar>(self, pose: &Pose<T>) -> Vec2<T> {
        self.local.cast().rotate(pose.rotation[self.frame])
    }
}

/// The data from which reactions are compiled.
struct Lifting<'a> {
    of: &'a Model,
    equivalent: &'a PlanarEquivalent,
    /// By body, in the axes of the plane, with the centre from the origin of its evaluation frame.
    masses: &'a [Mass],
    plan: &'a Plan,
    /// By joint: its place among the forces that are read.
    places: Vec<Option<usize>>,
    /// By body: its index among those with products of inertia.
    products: Vec<Option<usize>>,
    found: LiftedReactions,
}

impl LiftedReactions {
    /// The reactions of a model with these masses, in the axes of the plane; `None` if a rod is oblique to the plane, whose force has a
    /// part along n at an arm that varies.
    pub(super) fn new(
        of: &Model,
        equivalent: &PlanarEquivalent,
        masses: &[Mass],
        plan: &Plan,
    ) -> Option<Self> {
        let level = LEVEL * of.plan().size();
        let joints = of.mechanism().joints.iter().zip(&equivalent.joint_heights);
        let mut oblique = joints.filter(|(joint, [one, two])| {
            matches!(joint.kind, JointKind::Distance { .. }) && (one - two).abs() > level
        });
        if of.reactions().len() == 0 {
            return Some(Self::default());
        }
        if oblique.next().is_some() {
            return None;
        }
        let mut lifting = Lifting {
            places: vec![None; of.mechanism().joints.len()],
            products: vec![None; masses.len()],
            found: Self::default(),
            of,
            equivalent,
            masses,
            plan,
        };
        lifting.find_driven();
        let is_on_line =
            |reaction: &Reaction| matches!(reaction.component, Component::Force(Axes::Line, _));
        // Nothing fixed in a body has the direction of a line between two.
        if of
            .compiled_reactions()
            .iter()
            .any(|(reaction, _)| is_on_line(reaction))
        {
            return None;
        }
        let mut last = None;
        for (reaction, axes) in of.compiled_reactions() {
            let direction = lifting.direction(reaction, axes.as_ref());
            let is_force = matches!(reaction.component, Component::Force(..));
            let part = match last {
                Some((joint, force, part)) if (joint, force) == (reaction.joint, is_force) => part,
                _ if is_force => Part::Force(lifting.force(reaction.joint.0)),
                _ => Part::Moment(lifting.moment(reaction.joint.0)),
            };
            last = Some((reaction.joint, is_force, part));
            lifting.found.read.push((part, direction));
        }
        Some(lifting.found)
    }

    /// The planar reactions that are read.
    pub(super) fn planar_reactions(&self) -> &[PlanarReaction] {
        &self.planar
    }

    /// The bodies whose angles are read.
    pub(super) fn bodies(&self) -> &[BodyId] {
        &self.bodies
    }

    /// Memory for one thread.
    pub(super) fn workspace<T: Scalar>(&self) -> LiftedWorkspace<T> {
        let zero = [Vec2::zero(); 2];
        LiftedWorkspace {
            forces: vec![zero; self.forces.len()],
            products: vec![zero; self.products.len()],
        }
    }

    /// The coefficients of the requested reactions from those of the planar ones, after the planar passes.
    #[inline(always)]
    pub(super) fn lift<T: Scalar>(
        &self,
        planar: &PlanarWorkspace<T>,
        found: &Coefficients<T>,
        memory: &mut LiftedWorkspace<T>,
        out: &mut Coefficients<T>,
    ) {
        let (pose, motion) = (&planar.pose, &planar.motion);
        for (force, source) in memory.forces.iter_mut().zip(&self.forces) {
            *force = match *source {
                PlanarForce::Axes(k) => [&found.a, &found.b].map(|of| vec2(of[k], of[k + 1])),
                PlanarForce::Along(k, direction) => {
                    let along = direction.at(pose);
                    [along * found.a[k], along * found.b[k]]
                }
            };
        }
        for (moment, product) in memory.products.iter_mut().zip(&self.products) {
            let (u, w) = (product.at(pose), motion.velocity.angular[product.frame]);
            let acceleration = motion.acceleration.angular[product.frame];
            *moment = [u * w, u * acceleration + u.perp() * (w * w)];
        }
        let mut last = None;
        let mut parts = [(Vec2::zero(), T::from_f64(0.0)); 2];
        let reactions = out.a.iter_mut().zip(&mut out.b);
        for ((a, b), (part, direction)) in reactions.zip(&self.read) {
            if last.replace(*part) != Some(*part) {
                parts = match *part {
                    Part::Force(place) => {
                        map_array(memory.forces[place], |force| (force, T::from_f64(0.0)))
                    }
                    Part::Moment(moment) => self.moment(moment, pose, found, memory),
                };
            }
            let (across, along) = match *direction {
                Direction::Ground(direction) => (
                    vec2(T::from_f64(direction.x), T::from_f64(direction.y)),
                    T::from_f64(direction.z),
                ),
                Direction::Body(direction, along) => (direction.at(pose), T::from_f64(along)),
            };
            [*a, *b] = map_array(parts, |(flat, normal)| across.dot(flat) + along * normal);
        }
    }

    /// The moment of a joint in both passes: across the plane by (2), and along n.
    #[inline(always)]
    fn moment<T: Scalar>(
        &self,
        moment: usize,
        pose: &Pose<T>,
        found: &Coefficients<T>,
        memory: &LiftedWorkspace<T>,
    ) -> [(Vec2<T>, T); 2] {
        let LiftedMoment { along, across } = &self.moments[moment];
        let zero = T::from_f64(0.0);
        let along = along.map_or([zero; 2], |k| [found.a[k], found.b[k]]);
        let mut sums = [Vec2::zero(); 2];
        if let Some(across) = across {
            for &(place, height) in &across.forces {
                for (sum, force) in sums.iter_mut().zip(memory.forces[place]) {
                    *sum += force * T::from_f64(height);
                }
            }
            if let Some(direction) = self.driven {
                let along = direction.at(pose) * T::from_f64(across.driven);
                sums[0] += along * found.m;
                sums[1] += along * found.half_dm;
            }
            sums = map_array(sums, Vec2::perp);
            for &body in &across.products {
                for (sum, moment) in sums.iter_mut().zip(memory.products[body]) {
                    *sum += moment;
                }
            }
            sums = map_array(sums, |sum| sum * T::from_f64(across.sign));
        }
        [(sums[0], along[0]), (sums[1], along[1])]
    }
}

impl Lifting<'_> {
    fn request(&mut self, joint: usize, component: PlanarComponent) -> usize {
        let joint = JointId(joint);
        self.found.planar.push(PlanarReaction { joint, component });
        self.found.planar.len() - 1
    }

    fn body_direction(&mut self, body: usize, local: Vec2) -> BodyDirection {
        self.found.bodies.push(BodyId(body));
        BodyDirection::new(self.plan, body, local)
    }

    /// The planar axis of a sliding joint, in its first body.
    fn axis(&self, joint: usize) -> Option<(usize, Vec2)> {
        let joint = &self.equivalent.mechanism.joints[joint];
        match joint.kind {
            PlanarJointKind::Prismatic { axes: [axis, _] } => Some((joint.bodies[0].0, axis)),
            _ => None,
        }
    }

    /// The slide that the actuator drives.
    fn find_driven(&mut self) {
        let actuators = &self.equivalent.mechanism.actuators;
        let driven = actuators.iter().find_map(|actuator| match actuator.kind {
            dwell_geometry::ActuatorKind::Travel(joint) => self.axis(joint.0),
            _ => None,
        });
        self.found.driven = driven.map(|(body, axis)| self.body_direction(body, axis));
    }

    /// The index of a joint's force among those that are read.
    fn force(&mut self, joint: usize) -> usize {
        if let Some(place) = self.places[joint] {
            return place;
        }
        let kind = self.equivalent.mechanism.joints[joint].kind;
        let force = match (self.axis(joint), kind) {
            (Some((body, axis)), _) => {
                let normal = self.request(joint, PlanarComponent::Normal);
                PlanarForce::Along(normal, self.body_direction(body, axis.perp()))
            }
            (None, PlanarJointKind::Distance { .. }) => {
                // Its line is the x axis of the body that stands for it.
                let axial = self.request(joint, PlanarComponent::Axial);
                let pair = self.plan.joint_parts(JointId(joint)).0;
                let rod = pair.map_or(0, |pair| self.plan.pairs()[pair].bodies[1]);
                PlanarForce::Along(axial, BodyDirection::new(self.plan, rod, Vec2::IDENTITY))
            }
            _ => {
                let first = self.request(joint, PlanarComponent::X);
                self.request(joint, PlanarComponent::Y);
                PlanarForce::Axes(first)
            }
        };
        let place = self.found.forces.len();
        self.found.forces.push(force);
        self.places[joint] = Some(place);
        place
    }

    /// The number of a joint's moment.
    fn moment(&mut self, joint: usize) -> usize {
        let kind = self.equivalent.mechanism.joints[joint].kind;
        let bears_one = matches!(
            kind,
            PlanarJointKind::Prismatic { .. } | PlanarJointKind::Weld { .. }
        );
        let along = bears_one.then(|| self.request(joint, PlanarComponent::Moment));
        let carried = self.equivalent.carried[joint].clone();
        let across = carried.map(|carried| self.across(joint, &carried));
        self.found.moments.push(LiftedMoment { along, across });
        self.found.moments.len() - 1
    }

    /// The terms of (2) for a joint that carries these bodies.
    fn across(&mut self, joint: usize, carried: &[usize]) -> AcrossPlane {
        let height = |body: usize| self.equivalent.heights[body] + self.masses[body].center.z;
        let joints = &self.of.mechanism().joints;
        let levers = joints.iter().enumerate().map(|(k, other)| {
            let [_, at] = self.equivalent.joint_heights[k];
            let sides = other.bodies.iter().zip([-1.0, 1.0]);
            let ours = sides.filter(|(body, _)| carried.contains(&body.0));
            ours.map(|(body, sign)| sign * (height(body.0) - at)).sum()
        });
        let levers: Vec<f64> = levers.collect();
        let [_, second] = joints[joint].bodies.map(|body| body.0);
        let sign = if carried.contains(&second) { 1.0 } else { -1.0 };
        let driven = self.of.mechanism().actuators[0].kind.joint().0;
        let forces = levers.iter().enumerate();
        let forces = forces.filter(|(_, lever)| **lever != 0.0);
        let forces = forces.map(|(k, lever)| (self.force(k), *lever)).collect();
        let products = carried.iter().filter_map(|body| self.product(*body));
        AcrossPlane {
            sign,
            forces,
            products: products.collect(),
            driven: levers[driven],
        }
    }

    /// The index of a body among those with products of inertia.
    fn product(&mut self, body: usize) -> Option<usize> {
        let [.., xz, yz] = self.masses[body].inertia;
        if (xz, yz) == (0.0, 0.0) {
            return None;
        }
        if self.products[body].is_none() {
            let product = self.body_direction(body, vec2(xz, yz));
            self.products[body] = Some(self.found.products.len());
            self.found.products.push(product);
        }
        self.products[body]
    }

    /// The direction of a component. For a component in the axes of its joint, the axes are given with their body.
    fn direction(&mut self, reaction: &Reaction, axes: Option<&(usize, Rotation)>) -> Direction {
        let (Component::Force(_, k) | Component::Moment(_, k)) = reaction.component;
        match axes {
            None => {
                let plane = self.equivalent.frames[self.of.mechanism().ground].rotation;
                Direction::Ground(plane.apply_inverse(Vec3::AXES[k]))
            }
            Some((body, axes)) => {
                let frame = self.equivalent.frames[*body].rotation;
                let local = frame.apply_inverse(axes.columns[k]);
                let in_plane = self.body_direction(*body, vec2(local.x, local.y));
                Direction::Body(in_plane, local.z)
            }
        }
    }
}
