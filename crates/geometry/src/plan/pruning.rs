//! Pruning: groups that no requested result depends on are not evaluated.

use crate::plan::{Plan, Step};
use crate::structure::groups::Unknown;

impl Plan {
    /// By group: whether the motion of some bodies depends on it.
    pub fn groups_needed_by(&self, bodies: impl IntoIterator<Item = usize>) -> Vec<bool> {
        let mut classes = vec![false; self.frames.orientation_classes];
        let mut slides = vec![false; self.tree.slide_pairs.len()];
        let mut reached = vec![false; self.lowered.bodies];
        for mut body in bodies {
            // Along the tree to the ground.
            while !std::mem::replace(&mut reached[body], true) {
                self.mark(self.frames.orientations[body].frame, &mut classes);
                let Some(joint_index) = self.tree.joint_of_body[body] else {
                    break;
                };
                let tree_joint = &self.tree.joints[joint_index];
                self.mark(tree_joint.joint_vector.frame, &mut classes);
                if let Some((slide, _)) = tree_joint.slide {
                    slides[slide] = true;
                }
                body = tree_joint.parent;
            }
        }
        let mut needed = vec![false; self.groups.len()];
        for (g, assur) in self.groups.iter().enumerate().rev() {
            needed[g] = assur.group.unknowns.iter().any(|u| match *u {
                Unknown::ClassAngle(c) => classes[c],
                Unknown::SlideTravel(s) => slides[s],
            });
            if !needed[g] {
                continue;
            }
            for &l in &assur.group.loops {
                let closure = &self.loop_closures[l];
                let vectors = closure.vectors.iter().map(|&(_, f)| f);
                let axis = closure.axis.iter().map(|&(_, f)| f);
                for frame in vectors.chain(axis) {
                    self.mark(frame, &mut classes);
                }
                for &(slide, _, frame) in &closure.slides {
                    self.mark(frame, &mut classes);
                    slides[slide] = true;
                }
            }
            for &r in &assur.group.couplings {
                let coupling = &self.couplings[r];
                coupling.frames().for_each(|f| self.mark(f, &mut classes));
                coupling.slides().into_iter().for_each(|s| slides[s] = true);
            }
            for class in assur.group.classes() {
                if let Some(&(carrier, _)) = self.carrier_phases.get(&self.class_frame(class)) {
                    self.mark(carrier, &mut classes);
                }
            }
        }
        needed
    }

    fn mark(&self, frame: usize, classes: &mut [bool]) {
        classes[self.frames.frames[frame].orientation_class] = true;
    }

    /// Leaves out the groups that are not needed: the positions of their bodies are not computed, and no load may act
    /// on them. The range is still that of the whole mechanism.
    #[must_use]
    pub fn retain_groups(mut self, needed: &[bool]) -> Self {
        let mut known = vec![true; self.frames.orientation_classes];
        for (assur, &needed) in self.groups.iter_mut().zip(needed) {
            assur.pruned = !needed;
            for class in assur.group.classes() {
                known[class] = needed;
            }
        }
        let frames = &self.frames.frames;
        let groups = &self.groups;
        self.steps.retain(|step| match step {
            Step::SetSlide(..) => true,
            Step::RotateFrame(actuated) => known[frames[actuated.frame].orientation_class],
            Step::RotateVector(_, vector) => known[frames[vector.frame].orientation_class],
            Step::SolveGroup(g) => !groups[*g].pruned,
        });
        self
    }

    /// By group: whether it is left out.
    pub fn pruned_groups(&self) -> Vec<bool> {
        self.groups.iter().map(|g| g.pruned).collect()
    }

    /// By body of the mechanism: whether its position is computed although groups are left out.
    pub fn placed_bodies(&self) -> Vec<bool> {
        let mut classes = vec![true; self.frames.orientation_classes];
        let mut slides = vec![true; self.tree.slide_pairs.len()];
        for assur in self.groups.iter().filter(|g| g.pruned) {
            for unknown in &assur.group.unknowns {
                match *unknown {
                    Unknown::ClassAngle(c) => classes[c] = false,
                    Unknown::SlideTravel(s) => slides[s] = false,
                }
            }
        }
        let known = |frame: usize| classes[self.frames.frames[frame].orientation_class];
        let mut placed = vec![true; self.lowered.bodies];
        for tree_joint in &self.tree.joints {
            placed[tree_joint.body] = placed[tree_joint.parent]
                && known(tree_joint.joint_vector.frame)
                && known(self.frames.orientations[tree_joint.body].frame)
                && tree_joint.slide.is_none_or(|(slide, _)| slides[slide]);
        }
        placed
    }
}
