//! Where each requested reaction comes from: the force in a kinematic pair (a loop joint's multiplier, or the
//! force in a joint of the tree), the couple that holds two bodies at an angle, or a coupling's multiplier.

use super::{PassModel, RecursivePass};
use crate::pass::replaced_vectors::{replace_vector, vector_to};
use dwell_geometry::frames::AngularConstraintSource;
use dwell_geometry::lower::PairKind;
use dwell_geometry::plan::PairRole;
use dwell_geometry::{Component, JointKind, Mechanism, Plan, Pose, Reaction, Vec2, vec2};
use dwell_numerics::{Constant, Scalar, map_array};

/// One end of a loop joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LoopJointEnd<C = f64> {
    pub(crate) body: usize,
    /// Its index among the moving bodies; `None` for the ground.
    pub(crate) moving_body: Option<usize>,
    pub(crate) frame: usize,
    /// From the body's origin to the pair's point, in its frame, m; `None` if they coincide.
    pub(crate) moment_arm: Option<Vec2<C>>,
}

/// A direction along which a force is requested.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ForceDirection {
    /// A constant vector in the ground's frame, and in a frame that turns.
    Ground(Vec2),
    Frame(usize, Vec2),
}

impl ForceDirection {
    /// The component of some forces.
    #[inline(always)]
    fn component<T: Scalar, const N: usize>(self, forces: &[Vec2<T>; N], pose: &Pose<T>) -> [T; N] {
        let direction = match self {
            Self::Ground(direction) => direction.cast(),
            Self::Frame(frame, local) => local.cast().rotate(pose.rotation[frame]),
        };
        map_array(*forces, |force| force.dot(direction))
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum ReactionSource {
    /// The multiplier of a loop closure that constrains its normal only.
    Normal(usize),
    /// A component of the force in a loop joint, by closure.
    LoopJoint(usize, ForceDirection),
    /// A component of the force of a tree's joint on the moving body that it carries.
    TreeJoint(usize, ForceDirection),
    /// The couple that holds a body at an angle, times a sign.
    AngularConstraint { body: usize, sign: f64 },
    /// The multiplier of a coupling.
    Coupling(usize),
    /// The pair is redundant: others already constrain its bodies, so it exerts nothing.
    Redundant,
}

/// The sources of the requested reactions, and the forces and couples that they depend on.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct ReactionSources<C = f64> {
    sources: Vec<ReactionSource>,
    pub(crate) needs_joint_forces: bool,
    pub(crate) needs_joint_moments: bool,
    /// By moving body: whether the force of its joint is needed. By body: whether its couple is.
    pub(crate) joint_force_needed: Vec<bool>,
    pub(crate) joint_moment_needed: Vec<bool>,
    /// By closure: its two ends.
    pub(crate) loop_joint_ends: Vec<[LoopJointEnd<C>; 2]>,
    /// By moving body: the body that carries it.
    pub(crate) parent_body: Vec<usize>,
    /// By moving body: whether it is the second body of the joint that carries it.
    pub(crate) child_is_second: Vec<bool>,
    /// By actuator: the frames that its coordinate turns, with the sign.
    pub(crate) actuated_frames: Vec<Vec<(usize, f64)>>,
    /// By actuator: the slide it drives.
    pub(crate) actuated_slides: Vec<Option<usize>>,
}

impl ReactionSources {
    pub(crate) fn compile(mechanism: &Mechanism, plan: &Plan, reactions: &[Reaction]) -> Self {
        let tree = plan.tree();
        let loop_joint_ends = plan.loop_closures.iter().map(|closure| {
            let pair = &plan.pairs()[closure.pair];
            [0, 1].map(|i| {
                let body = pair.bodies[i];
                let vector = tree.vector_to(plan.frames(), body, pair.points[i]);
                LoopJointEnd {
                    body,
                    moving_body: tree.joint_of_body[body],
                    frame: vector.frame,
                    moment_arm: (vector.local != Vec2::ZERO).then_some(vector.local),
                }
            })
        });
        let second = |c: &dwell_geometry::tree::TreeJoint| plan.pairs()[c.pair].bodies[1] == c.body;
        let actuators = 0..plan.actuators();
        let mut found = Self {
            loop_joint_ends: loop_joint_ends.collect(),
            parent_body: tree.joints.iter().map(|c| c.parent).collect(),
            child_is_second: tree.joints.iter().map(second).collect(),
            actuated_frames: find_actuated_frames(plan),
            actuated_slides: actuators.map(|a| plan.slide_of_actuator(a)).collect(),
            ..Self::default()
        };
        for &reaction in reactions {
            let source = found.source_of(mechanism, plan, reaction);
            found.sources.push(source);
        }
        found.mark_needed(plan);
        found
    }

    /// Finds the bodies from whose forces and couples the requested ones are summed.
    fn mark_needed(&mut self, plan: &Plan) {
        let carried = plan.moving_bodies();
        let mut force_needed = vec![false; carried.len()];
        let mut moment_needed = vec![false; carried.len() + 1];
        for source in &self.sources {
            match *source {
                ReactionSource::TreeJoint(carried, _) => force_needed[carried] = true,
                ReactionSource::AngularConstraint { body, .. } => moment_needed[body] = true,
                ReactionSource::Normal(_)
                | ReactionSource::LoopJoint(..)
                | ReactionSource::Coupling(_)
                | ReactionSource::Redundant => {}
            }
        }
        // A couple is transferred to the reference body, which is further inwards.
        for constraint in &plan.frames().angular_constraints {
            moment_needed[constraint.body] |= moment_needed[constraint.reference_body];
        }
        // A couple depends on the forces of the joints at its body; a force on those of all bodies that its body carries.
        for (i, body) in carried.iter().enumerate() {
            let joint = [body.body, self.parent_body[i]];
            force_needed[i] |= joint.iter().any(|&body| moment_needed[body]);
            force_needed[i] |= body.parent.is_some_and(|parent| force_needed[parent]);
        }
        self.needs_joint_forces = force_needed.contains(&true);
        self.needs_joint_moments = moment_needed.contains(&true);
        (self.joint_force_needed, self.joint_moment_needed) = (force_needed, moment_needed);
    }

    fn source_of(&self, mechanism: &Mechanism, plan: &Plan, reaction: Reaction) -> ReactionSource {
        let Reaction { joint, component } = reaction;
        let (pair, coupling) = plan.joint_parts(joint);
        let kind = mechanism.joints[joint.0].kind;
        match (component, pair, coupling) {
            (Component::Tooth | Component::Tangent | Component::Force, _, Some(coupling)) => {
                ReactionSource::Coupling(coupling)
            }
            (Component::Moment, _, Some(coupling)) if matches!(kind, JointKind::Coupling(_)) => {
                ReactionSource::Coupling(coupling)
            }
            (Component::Moment, Some(pair), _) => angular_constraint_moment(plan, pair),
            (_, Some(pair), _) => self.pair_force(plan, pair, component),
            (_, None, _) => ReactionSource::Redundant,
        }
    }

    /// A component of the force in a kinematic pair.
    fn pair_force(&self, plan: &Plan, pair: usize, component: Component) -> ReactionSource {
        let kinematic_pair = &plan.pairs()[pair];
        let role = plan.pair_roles[pair];
        // On a moving body, as the action of its joint's first body.
        let sign = match role {
            PairRole::TreeJoint(moving_body) if !self.child_is_second[moving_body] => -1.0,
            PairRole::TreeJoint(_) | PairRole::LoopJoint(_) => 1.0,
        };
        let in_frame = |body: usize, local: Vec2| {
            let attitude = plan.frames().orientations[body];
            ForceDirection::Frame(attitude.frame, local.rotate(attitude.offset) * sign)
        };
        let direction = match (component, kinematic_pair.kind) {
            (Component::Y, _) => ForceDirection::Ground(vec2(0.0, sign)),
            (Component::Normal, PairKind::Prismatic { axes, .. }) => {
                in_frame(kinematic_pair.bodies[0], axes[0].perp())
            }
            // The line of a distance is the x axis of its second body.
            (Component::Axial, _) => in_frame(kinematic_pair.bodies[1], Vec2::IDENTITY),
            // Besides x these are the components of couplings, of couples and of pairs without an axis: none of a force here.
            (
                Component::X
                | Component::Normal
                | Component::Moment
                | Component::Tooth
                | Component::Tangent
                | Component::Force,
                _,
            ) => ForceDirection::Ground(vec2(sign, 0.0)),
        };
        match role {
            PairRole::TreeJoint(moving_body) => ReactionSource::TreeJoint(moving_body, direction),
            PairRole::LoopJoint(closure) => match plan.loop_closures[closure].axis {
                Some(_) => ReactionSource::Normal(closure),
                None => ReactionSource::LoopJoint(closure, direction),
            },
        }
    }
}

impl<C: Constant> ReactionSources<C> {
    /// Takes the dimensions that a plan of the same structure has by now; false where an end has a moment arm that
    /// the structure has no place for.
    pub(crate) fn replace_points(&mut self, plan: &Plan<C>) -> bool {
        let mut fits = true;
        for (ends, closure) in self.loop_joint_ends.iter_mut().zip(&plan.loop_closures) {
            let points = plan.pairs()[closure.pair].points;
            for (end, point) in ends.iter_mut().zip(points) {
                fits &= replace_vector(&mut end.moment_arm, vector_to(plan, end.body, point));
            }
        }
        fits
    }
}

impl ReactionSources {
    /// The same with the dimensions (m) in another type.
    pub(super) fn lifted<C: Constant>(&self) -> ReactionSources<C> {
        let end = |end: LoopJointEnd| LoopJointEnd {
            body: end.body,
            moving_body: end.moving_body,
            frame: end.frame,
            moment_arm: end.moment_arm.map(Vec2::cast),
        };
        ReactionSources {
            sources: self.sources.clone(),
            needs_joint_forces: self.needs_joint_forces,
            needs_joint_moments: self.needs_joint_moments,
            joint_force_needed: self.joint_force_needed.clone(),
            joint_moment_needed: self.joint_moment_needed.clone(),
            loop_joint_ends: self
                .loop_joint_ends
                .iter()
                .map(|ends| ends.map(end))
                .collect(),
            parent_body: self.parent_body.clone(),
            child_is_second: self.child_is_second.clone(),
            actuated_frames: self.actuated_frames.clone(),
            actuated_slides: self.actuated_slides.clone(),
        }
    }
}

/// The couple in a pair that holds an angle.
fn angular_constraint_moment(plan: &Plan, pair: usize) -> ReactionSource {
    let source = AngularConstraintSource::Pair(pair);
    let mut constraints = plan.frames().angular_constraints.iter();
    let constraint = constraints.find(|h| h.source == source);
    constraint.map_or(ReactionSource::Redundant, |constraint| {
        ReactionSource::AngularConstraint {
            body: constraint.body,
            sign: if constraint.body_is_first { -1.0 } else { 1.0 },
        }
    })
}

/// By actuator, the frames it turns, directly or through others.
fn find_actuated_frames(plan: &Plan) -> Vec<Vec<(usize, f64)>> {
    let mut actuated = vec![Vec::new(); plan.actuators()];
    for f in 0..plan.frames().frames.len() {
        for (actuator, sign) in plan.frames().turned_by(f) {
            actuated[actuator].push((f, sign));
        }
    }
    actuated
}

impl<T: Scalar, const N: usize> RecursivePass<T, N> {
    /// The `k`th requested reaction in each pass, N or N·m.
    #[inline(always)]
    pub(crate) fn reaction<C>(&self, model: &PassModel<C>, pose: &Pose<T>, k: usize) -> [T; N] {
        match model.reaction_sources.sources[k] {
            ReactionSource::Normal(closure) => {
                map_array(self.balance.loop_multiplier[closure], |m| m.x)
            }
            ReactionSource::LoopJoint(closure, direction) => {
                direction.component(&self.balance.loop_multiplier[closure], pose)
            }
            ReactionSource::TreeJoint(moving_body, direction) => {
                direction.component(&self.joint_forces[moving_body], pose)
            }
            ReactionSource::AngularConstraint { body, sign } => {
                map_array(self.joint_moments[body], |c| c * T::from_f64(sign))
            }
            ReactionSource::Coupling(coupling) => self.balance.coupling_multiplier[coupling],
            ReactionSource::Redundant => [T::from_f64(0.0); N],
        }
    }
}
