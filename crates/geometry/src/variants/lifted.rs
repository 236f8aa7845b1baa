//! A plan whose dimensions are numbers of another type, so that an evaluation depends on them: recorded, they are inputs.

use crate::plan::{AssurGroup, GroupKind, GuidedPoint, LoopClosure, Plan, RrrDyad, Step};
use crate::structure::lower::{KinematicPair, Lowered};
use crate::structure::tree::{FrameVector, Tree, TreeJoint};
use dwell_numerics::Constant;

impl FrameVector {
    fn lifted<C: Constant>(self) -> FrameVector<C> {
        FrameVector {
            frame: self.frame,
            local: self.local.cast(),
        }
    }
}

impl Tree {
    fn lifted<C: Constant>(&self) -> Tree<C> {
        let joint = |joint: &TreeJoint| TreeJoint {
            body: joint.body,
            parent: joint.parent,
            pair: joint.pair,
            joint_vector: joint.joint_vector.lifted(),
            slide: joint.slide,
        };
        Tree {
            joints: self.joints.iter().map(joint).collect(),
            joint_of_body: self.joint_of_body.clone(),
            joint_origins: self.joint_origins.iter().map(|v| v.cast()).collect(),
            loop_joints: self.loop_joints.clone(),
            slide_pairs: self.slide_pairs.clone(),
        }
    }
}

impl Lowered {
    fn lifted<C: Constant>(&self) -> Lowered<C> {
        let pair = |pair: &KinematicPair| KinematicPair {
            owner: pair.owner,
            bodies: pair.bodies,
            points: pair.points.map(|point| point.cast()),
            kind: pair.kind,
        };
        Lowered {
            bodies: self.bodies,
            mechanism_bodies: self.mechanism_bodies,
            ground: self.ground,
            pairs: self.pairs.iter().map(pair).collect(),
            couplings: self.couplings.clone(),
            actuated_coordinates: self.actuated_coordinates.clone(),
            joint_parts: self.joint_parts.clone(),
        }
    }
}

impl LoopClosure {
    fn lifted<C: Constant>(&self) -> LoopClosure<C> {
        LoopClosure {
            pair: self.pair,
            fixed: self.fixed.cast(),
            vectors: self.vectors.clone(),
            slides: self.slides.clone(),
            axis: self.axis,
        }
    }
}

impl GroupKind {
    fn lifted<C: Constant>(&self) -> GroupKind<C> {
        match self {
            Self::RrrDyad(dyad) => GroupKind::RrrDyad(RrrDyad {
                closure: dyad.closure,
                vectors: dyad.vectors,
                frames: dyad.frames,
                per_square: dyad.per_square,
                sum_squared: dyad.sum_squared,
                difference_squared: dyad.difference_squared,
                square_difference: dyad.square_difference,
                fixed: dyad.fixed.cast(),
                known: dyad.known.clone(),
                branch: dyad.branch,
            }),
            Self::GuidedPoint(guided) => GroupKind::GuidedPoint(GuidedPoint {
                closure: guided.closure,
                frame: guided.frame,
                axis: guided.axis,
                line_rotates: guided.line_rotates,
                found_vector: guided.found_vector,
                vectors: guided.vectors.clone(),
                local: guided.local.cast(),
                length: guided.length,
                unit: guided.unit,
                fixed: guided.fixed.cast(),
                known: guided.known.clone(),
                branch: guided.branch,
            }),
            Self::Factored(group) => GroupKind::Factored(group.clone()),
        }
    }
}

impl AssurGroup {
    fn lifted<C: Constant>(&self) -> AssurGroup<C> {
        AssurGroup {
            group: self.group.clone(),
            kind: self.kind.lifted(),
            actuated_frames: self.actuated_frames.clone(),
            known_terms: self.known_terms.clone(),
            size: self.size,
            scale: self.scale,
            stored_poses: self.stored_poses.clone(),
            counts_revolutions: self.counts_revolutions,
            has_table: self.has_table,
            uses_stored_poses: self.uses_stored_poses,
            pruned: self.pruned,
        }
    }
}

impl Step {
    fn lifted<C: Constant>(&self) -> Step<C> {
        match self {
            Self::RotateFrame(actuated) => Step::RotateFrame(*actuated),
            Self::SetSlide(slide, actuator) => Step::SetSlide(*slide, *actuator),
            Self::SolveGroup(group) => Step::SolveGroup(*group),
            Self::RotateVector(vector, local) => Step::RotateVector(*vector, local.lifted()),
        }
    }
}

impl Plan {
    /// The same plan with its dimensions (m) in another type: constants of it, until
    /// [`set_dimensions`](Plan::set_dimensions) makes them what an evaluation depends on.
    pub fn lifted<C: Constant>(&self) -> Plan<C> {
        Plan {
            lowered: self.lowered.lifted(),
            frames: self.frames.clone(),
            tree: self.tree.lifted(),
            frame_vectors: self.frame_vectors.iter().map(|v| v.lifted()).collect(),
            moving_bodies: self.moving_bodies.clone(),
            loop_closures: self.loop_closures.iter().map(LoopClosure::lifted).collect(),
            couplings: self.couplings.clone(),
            groups: self.groups.iter().map(AssurGroup::lifted).collect(),
            steps: self.steps.iter().map(Step::lifted).collect(),
            pair_roles: self.pair_roles.clone(),
            solve_steps: self.solve_steps.clone(),
            class_frames: self.class_frames.clone(),
            actuated_frames: self.actuated_frames.clone(),
            revolution_counted: self.revolution_counted.clone(),
            revolution_offsets: self.revolution_offsets.clone(),
            carrier_phases: self.carrier_phases.clone(),
            actuated_slides: self.actuated_slides.clone(),
            angular: self.angular.clone(),
            size: self.size,
            assembly_coordinates: self.assembly_coordinates.clone(),
            range: self.range,
            range_limits: self.range_limits,
            near_branches: self.near_branches.clone(),
            assembly_pose: self.assembly_pose.clone(),
            determinate: self.determinate.clone(),
            group_modes: self.group_modes.clone(),
        }
    }
}
