//! What of a mechanism is needed: a group that places nothing of interest is not placed at all.

use crate::groups::Unknown;
use crate::plan::{Plan, Step};

impl Plan {
    /// By group: whether it is needed to place some bodies and to move them.
    pub fn needed_for(&self, bodies: impl IntoIterator<Item = usize>) -> Vec<bool> {
        let mut classes = vec![false; self.frames.classes];
        let mut slides = vec![false; self.tree.slides.len()];
        let mut reached = vec![false; self.lowered.bodies];
        for mut body in bodies {
            // Along the tree to the ground; what carries it may be known already.
            while !std::mem::replace(&mut reached[body], true) {
                self.mark(self.frames.attitudes[body].frame, &mut classes);
                let Some(place) = self.tree.place[body] else {
                    break;
                };
                let carry = &self.tree.carries[place];
                self.mark(carry.arm.frame, &mut classes);
                if let Some((slide, _)) = carry.slide {
                    slides[slide] = true;
                }
                body = carry.parent;
            }
        }
        let mut needed = vec![false; self.groups.len()];
        for (g, assur) in self.groups.iter().enumerate().rev() {
            needed[g] = assur.group.unknowns.iter().any(|u| match *u {
                Unknown::Class(c) => classes[c],
                Unknown::Slide(s) => slides[s],
            });
            if !needed[g] {
                continue;
            }
            for &l in &assur.group.loops {
                let closure = &self.closures[l];
                let arms = closure.arms.iter().map(|&(_, f)| f);
                let axis = closure.axis.iter().map(|&(_, f)| f);
                for frame in arms.chain(axis) {
                    self.mark(frame, &mut classes);
                }
                for &(slide, _, frame) in &closure.slides {
                    self.mark(frame, &mut classes);
                    slides[slide] = true;
                }
            }
            for &r in &assur.group.relations {
                let row = &self.relations[r];
                row.frames().for_each(|f| self.mark(f, &mut classes));
                row.slides().into_iter().for_each(|s| slides[s] = true);
            }
            for unknown in &assur.group.unknowns {
                if let Unknown::Class(c) = *unknown
                    && let Some(&(carrier, _)) = self.beside.get(&self.root_of(c))
                {
                    self.mark(carrier, &mut classes);
                }
            }
        }
        needed
    }

    fn mark(&self, frame: usize, classes: &mut [bool]) {
        classes[self.frames.frames[frame].class] = true;
    }

    /// Leaves out the groups that are not needed: their bodies are not placed, and nothing may act
    /// on them. The range stays that of the whole mechanism.
    #[must_use]
    pub fn only(mut self, needed: &[bool]) -> Self {
        let mut known = vec![true; self.frames.classes];
        for (assur, &needed) in self.groups.iter_mut().zip(needed) {
            assur.skipped = !needed;
            for unknown in &assur.group.unknowns {
                if let Unknown::Class(c) = *unknown {
                    known[c] = needed;
                }
            }
        }
        let frames = &self.frames.frames;
        let groups = &self.groups;
        self.steps.retain(|step| match step {
            Step::Slide(..) => true,
            Step::Turn(driven) => known[frames[driven.frame].class],
            Step::Rotate(_, arm) => known[frames[arm.frame].class],
            Step::Solve(g) => !groups[*g].skipped,
        });
        self
    }

    /// By group: whether it is left out.
    pub fn skipped(&self) -> Vec<bool> {
        self.groups.iter().map(|g| g.skipped).collect()
    }

    /// By body of the mechanism: whether it is placed although groups are left out.
    pub fn placed(&self) -> Vec<bool> {
        let mut classes = vec![true; self.frames.classes];
        let mut slides = vec![true; self.tree.slides.len()];
        for assur in self.groups.iter().filter(|g| g.skipped) {
            for unknown in &assur.group.unknowns {
                match *unknown {
                    Unknown::Class(c) => classes[c] = false,
                    Unknown::Slide(s) => slides[s] = false,
                }
            }
        }
        let known = |frame: usize| classes[self.frames.frames[frame].class];
        let mut placed = vec![true; self.lowered.bodies];
        for carry in &self.tree.carries {
            placed[carry.body] = placed[carry.parent]
                && known(carry.arm.frame)
                && known(self.frames.attitudes[carry.body].frame)
                && carry.slide.is_none_or(|(slide, _)| slides[slide]);
        }
        placed
    }
}
