//! What a pass over a mechanism in space reads: the plan, the inertia of the bodies, and the reactions.

use super::mass::Mass;
use super::model::{Axes, Component, Reaction};
use crate::pass::InverseDynamics;
use dwell_geometry::space::{Forces, JointNumbers, Mechanism, Plan, Pose, Rotation, Vec3, Wrench};
use dwell_numerics::{Constant, Lift, map_array};

/// The parts of a model that a pass reads, with numbers of a type.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PassModel<C = f64> {
    pub(super) plan: Plan<C>,
    /// In the evaluation frames; the ground has none.
    pub(super) masses: Vec<Mass<C>>,
    /// The bodies that have mass or inertia.
    pub(super) inertial: Vec<usize>,
    /// The requested reactions, then the others on which friction depends.
    pub(super) reactions: Vec<CompiledReaction<C>>,
}

/// A reaction. If it is in the axes of its joint: the body, and these axes in its evaluation frame.
pub(super) type CompiledReaction<C = f64> = (Reaction, Option<(usize, Rotation<C>)>);

/// By body: a mass in its frame, in the evaluation frames of a plan; the ground has none.
fn in_frames<C: Constant>(ground: usize, plan: &Plan<C>, masses: &[Mass<C>]) -> Vec<Mass<C>> {
    let inner = |(b, mass): (usize, &Mass<C>)| match b {
        b if b == ground => Mass::default(),
        _ => mass.in_frame(&plan.evaluation_frame(b)),
    };
    masses.iter().enumerate().map(inner).collect()
}

/// A reaction in the frames of a plan whose joint has these numbers.
pub(super) fn compile_reaction<C: Constant>(
    reaction: Reaction,
    mechanism: &Mechanism,
    joint: &JointNumbers<C>,
    plan: &Plan<C>,
) -> CompiledReaction<C> {
    let (Component::Force(axes, _) | Component::Moment(axes, _)) = reaction.component;
    let of_joint = (axes == Axes::Joint).then(|| {
        let body = mechanism.joints[reaction.joint.0].side_body(0).0;
        let side = &joint.sides[0];
        let in_body = Rotation::of_axes(side.axis, side.normal);
        let frame = plan.evaluation_frame(body);
        (body, frame.rotation.inverse().after(&in_body))
    });
    (reaction, of_joint)
}

impl PassModel {
    /// Without reactions, for one mass per body.
    pub(super) fn new(mechanism: &Mechanism, plan: Plan, masses: &[Mass]) -> Self {
        let masses = in_frames(mechanism.ground, &plan, masses);
        let has_inertia = |b: &usize| masses[*b].mass > 0.0 || masses[*b].inertia != [0.0; 6];
        Self {
            inertial: (0..masses.len()).filter(has_inertia).collect(),
            plan,
            masses,
            reactions: Vec::new(),
        }
    }

    /// The same with these numbers of its joints and bodies, in another type.
    pub(super) fn with_numbers<C: Constant + Lift<C>>(
        &self,
        mechanism: &Mechanism,
        joints: &[JointNumbers<C>],
        masses: &[Mass<C>],
    ) -> Option<PassModel<C>> {
        let plan = self.plan.with_numbers(mechanism, joints)?;
        let compile = |(reaction, _): &CompiledReaction| {
            compile_reaction(*reaction, mechanism, &joints[reaction.joint.0], &plan)
        };
        Some(PassModel {
            masses: in_frames(mechanism.ground, &plan, masses),
            inertial: (0..masses.len())
                .filter(|b| *b != mechanism.ground)
                .collect(),
            reactions: self.reactions.iter().map(compile).collect(),
            plan,
        })
    }
}

impl<C: Constant> PassModel<C> {
    /// The actuator forces and reactions from the required wrenches.
    pub(super) fn balance<T: Lift<C>>(
        &self,
        pose: &Pose<T>,
        forces: &mut Forces<T>,
        result: &mut InverseDynamics<T>,
    ) {
        self.plan.balance(pose, forces);
        for (i, tau) in result.tau.iter_mut().enumerate() {
            [*tau] = self.plan.actuator_action(forces, i);
        }
        self.read_all(pose, forces, |k, [value]| {
            result.reactions[k] = value;
        });
    }

    /// Sets the required wrenches of all bodies from their inertia.
    pub(super) fn require_inertia<T: Lift<C>>(&self, pose: &Pose<T>, forces: &mut Forces<T>) {
        forces.required.fill([Wrench::default()]);
        for &b in &self.inertial {
            forces.required[b] =
                [self.masses[b].required(self.plan.frame(pose, b), self.plan.state(pose, b))];
        }
    }

    /// The inertia of all bodies in unit acceleration from rest, after the velocities at unit speed.
    pub(super) fn require_unit_acceleration<T: Lift<C>>(
        &self,
        pose: &Pose<T>,
        forces: &mut Forces<T>,
    ) {
        forces.required.fill([Wrench::default()]);
        for &b in &self.inertial {
            let from_rest = self.plan.state(pose, b).from_rest();
            forces.required[b] = [self.masses[b].required(self.plan.frame(pose, b), &from_rest)];
        }
    }

    /// The inertia of all bodies in both unit passes, after the accelerations at unit speed: at unit acceleration from rest, and at
    /// unit speed.
    #[inline(always)]
    pub(super) fn require_unit_inertia<T: Lift<C>>(
        &self,
        pose: &Pose<T>,
        forces: &mut Forces<T, 2>,
    ) {
        for &b in &self.inertial {
            let (frame, motion) = (self.plan.frame(pose, b), self.plan.state(pose, b));
            forces.required[b] = self.masses[b].required_in_unit_passes(frame, motion);
        }
    }

    /// Calls a function with each reaction of the last passes: its number and its value in each pass.
    #[inline(always)]
    pub(super) fn read_all<T: Lift<C>, const N: usize>(
        &self,
        pose: &Pose<T>,
        forces: &Forces<T, N>,
        mut take: impl FnMut(usize, [T; N]),
    ) {
        let mut last = None;
        let mut wrenches = [Wrench::default(); N];
        for (index, (reaction, axes)) in self.reactions.iter().enumerate() {
            // The components of a joint mostly follow each other.
            if last.replace(reaction.joint) != Some(reaction.joint) {
                wrenches = self.plan.reaction(pose, forces, reaction.joint);
            }
            let (Component::Force(_, k) | Component::Moment(_, k)) = reaction.component;
            let line = matches!(reaction.component, Component::Force(Axes::Line, _));
            let along = match axes {
                None if line => self.plan.line(pose, reaction.joint),
                None => Vec3::AXES[k].cast(),
                Some((body, axes)) => {
                    let frame = self.plan.frame(pose, *body);
                    frame.rotation.apply(axes.columns[k].cast())
                }
            };
            let part = |wrench: Wrench<T>| match reaction.component {
                Component::Force(..) => along.dot(wrench.force),
                Component::Moment(..) => along.dot(wrench.moment),
            };
            take(index, map_array(wrenches, part));
        }
    }
}
