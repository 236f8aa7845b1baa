//! The table of constant vectors that are rotated while a mechanism is placed, each once and as soon as
//! its frame is known.

use super::build::actuated_frames;
use crate::plan::{ActuatedFrame, AssurGroup, GroupKind, LoopClosure, MovingBody, Step};
use crate::plane::Vec2;
use crate::structure::frames::Frames;
use crate::structure::groups::Group;
use crate::structure::tree::{FrameVector, LoopJoint, Tree};
use std::collections::HashMap;

/// Collects vectors, each once, and the steps after which their frames are known.
pub(super) struct FrameVectorTable {
    pub(super) vectors: Vec<FrameVector>,
    /// The vectors by frame and the bits of their components.
    index_of: HashMap<(usize, u64, u64), usize>,
    /// By frame: the step that makes it known (0 for the ground).
    known_at: Vec<usize>,
    /// The steps that make frames known, in order.
    steps: Vec<Step>,
}

impl FrameVectorTable {
    pub(super) fn new(
        frames: &Frames,
        class_frames: &[usize],
        groups: &[Group],
        all_actuated_frames: &[(usize, ActuatedFrame)],
    ) -> Self {
        let mut table = Self {
            vectors: Vec::new(),
            index_of: HashMap::new(),
            known_at: vec![0; frames.frames.len()],
            steps: Vec::new(),
        };
        table.rotate_frames(actuated_frames(all_actuated_frames, |class| class == 0));
        for (g, group) in groups.iter().enumerate() {
            table.steps.push(Step::SolveGroup(g));
            for class in group.classes() {
                table.known_at[class_frames[class]] = table.steps.len();
                table.rotate_frames(actuated_frames(all_actuated_frames, |c| c == class));
            }
        }
        table
    }

    /// Adds the steps that rotate the actuated frames of a class, once it is known.
    fn rotate_frames(&mut self, actuated_frames: Vec<ActuatedFrame>) {
        for one in actuated_frames {
            self.known_at[one.frame] = self.steps.len() + 1;
            self.steps.push(Step::RotateFrame(one));
        }
    }

    fn index(&mut self, vector: FrameVector) -> usize {
        let FrameVector { frame, local } = vector;
        let key = (frame, local.x.to_bits(), local.y.to_bits());
        *self.index_of.entry(key).or_insert_with(|| {
            self.vectors.push(vector);
            self.vectors.len() - 1
        })
    }

    pub(super) fn loop_closure(&mut self, one: &LoopJoint) -> LoopClosure {
        let (still, moving): (Vec<FrameVector>, Vec<FrameVector>) = one
            .vectors
            .iter()
            .partition(|a| self.known_at[a.frame] == 0);
        LoopClosure {
            pair: one.pair,
            fixed: still.iter().fold(Vec2::ZERO, |sum, a| sum + a.local),
            vectors: moving.iter().map(|&a| (self.index(a), a.frame)).collect(),
            slides: one
                .slides
                .iter()
                .map(|&(s, a)| (s, self.index(a), a.frame))
                .collect(),
            axis: one.axis.map(|a| (self.index(a), a.frame)),
        }
    }

    pub(super) fn moving_body(
        &mut self,
        frames: &Frames,
        tree: &Tree,
        tree_joint: &crate::structure::tree::TreeJoint,
    ) -> MovingBody {
        let frame = frames.orientations[tree_joint.body].frame;
        let fixed = tree_joint.joint_vector.local == Vec2::ZERO
            || tree.joint_of_body[tree_joint.parent].is_none();
        MovingBody {
            body: tree_joint.body,
            pair: tree_joint.pair,
            parent: tree.joint_of_body[tree_joint.parent],
            frame,
            parent_frame: tree_joint.joint_vector.frame,
            joint_vector: (!fixed).then(|| self.index(tree_joint.joint_vector)),
            slide: tree_joint
                .slide
                .map(|(s, local)| (s, self.index(FrameVector { frame, local }))),
        }
    }

    /// The steps, with each vector rotated as soon as its frame is known, unless its group finds it.
    pub(super) fn steps(self, groups: &[AssurGroup], slides: &[Option<usize>]) -> Vec<Step> {
        let mut waiting: Vec<Vec<Step>> = vec![Vec::new(); self.steps.len() + 1];
        let mut found = vec![false; self.vectors.len()];
        for assur in groups {
            match &assur.kind {
                GroupKind::RrrDyad(dyad) => {
                    dyad.vectors.iter().for_each(|&vector| found[vector] = true);
                }
                GroupKind::GuidedPoint(guided) => found[guided.found_vector] = true,
                GroupKind::Factored(_) => {}
            }
        }
        for (i, &vector) in self.vectors.iter().enumerate() {
            if !found[i] {
                waiting[self.known_at[vector.frame]].push(Step::RotateVector(i, vector));
            }
        }
        let set_slide = |(s, by): (usize, &Option<usize>)| Some(Step::SetSlide(s, (*by)?));
        let actuated = slides.iter().enumerate().filter_map(set_slide);
        // Vectors on the ground are never rotated.
        let rotations = waiting.into_iter().skip(1);
        let both = self.steps.into_iter().zip(rotations);
        let rotated = both.flat_map(|(step, vectors)| std::iter::once(step).chain(vectors));
        actuated.chain(rotated).collect()
    }
}
