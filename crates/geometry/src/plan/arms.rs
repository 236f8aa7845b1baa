//! The table of constant vectors that are rotated while a mechanism is placed, each once and as soon as
//! its frame is known.

use super::compile::driven;
use super::{Assur, Carried, Closure, Driven, Kind, Step};
use crate::frames::Frames;
use crate::groups::{Group, Unknown};
use crate::plane::Vec2;
use crate::tree::{Arm, Loop, Tree};
use std::collections::HashMap;

/// Collects arms, each once, and the steps that make their frames known.
pub(super) struct ArmTable {
    pub(super) arms: Vec<Arm>,
    /// The arms by frame and the bits of their components.
    seen: HashMap<(usize, u64, u64), usize>,
    /// By frame: the step that makes it known (0 for the ground).
    known_at: Vec<usize>,
    /// The steps that make frames known, in order.
    steps: Vec<Step>,
}

impl ArmTable {
    pub(super) fn new(
        frames: &Frames,
        roots: &[usize],
        groups: &[Group],
        all_driven: &[(usize, Driven)],
    ) -> Self {
        let mut table = Self {
            arms: Vec::new(),
            seen: HashMap::new(),
            known_at: vec![0; frames.frames.len()],
            steps: Vec::new(),
        };
        table.turn(driven(all_driven, |class| class == 0));
        for (g, group) in groups.iter().enumerate() {
            table.steps.push(Step::Solve(g));
            for &unknown in &group.unknowns {
                if let Unknown::Class(class) = unknown {
                    table.known_at[roots[class]] = table.steps.len();
                    table.turn(driven(all_driven, |c| c == class));
                }
            }
        }
        table
    }

    /// Turns the driven frames of a class that has become known.
    fn turn(&mut self, driven: Vec<Driven>) {
        for one in driven {
            self.known_at[one.frame] = self.steps.len() + 1;
            self.steps.push(Step::Turn(one));
        }
    }

    fn index(&mut self, arm: Arm) -> usize {
        let key = (arm.frame, arm.local.x.to_bits(), arm.local.y.to_bits());
        *self.seen.entry(key).or_insert_with(|| {
            self.arms.push(arm);
            self.arms.len() - 1
        })
    }

    pub(super) fn closure(&mut self, one: &Loop) -> Closure {
        let (still, moving): (Vec<Arm>, Vec<Arm>) =
            one.arms.iter().partition(|a| self.known_at[a.frame] == 0);
        Closure {
            bond: one.bond,
            fixed: still.iter().fold(Vec2::ZERO, |sum, a| sum + a.local),
            arms: moving.iter().map(|&a| (self.index(a), a.frame)).collect(),
            slides: one
                .slides
                .iter()
                .map(|&(s, a)| (s, self.index(a), a.frame))
                .collect(),
            axis: one.axis.map(|a| (self.index(a), a.frame)),
        }
    }

    pub(super) fn carried(
        &mut self,
        frames: &Frames,
        tree: &Tree,
        carry: &crate::tree::Carry,
    ) -> Carried {
        let frame = frames.attitudes[carry.body].frame;
        let fixed = carry.arm.local == Vec2::ZERO || tree.place[carry.parent].is_none();
        Carried {
            body: carry.body,
            bond: carry.bond,
            parent: tree.place[carry.parent],
            frame,
            parent_frame: carry.arm.frame,
            arm: (!fixed).then(|| self.index(carry.arm)),
            slide: carry
                .slide
                .map(|(s, local)| (s, self.index(Arm { frame, local }))),
        }
    }

    /// The steps, with each arm rotated as soon as its frame is known, unless its group finds it.
    pub(super) fn steps(self, groups: &[Assur], slides: &[Option<usize>]) -> Vec<Step> {
        let mut waiting: Vec<Vec<Step>> = vec![Vec::new(); self.steps.len() + 1];
        let mut found = vec![false; self.arms.len()];
        for assur in groups {
            match &assur.kind {
                Kind::Pin(pin) => pin.arms.iter().for_each(|&arm| found[arm] = true),
                Kind::Aim(aim) => found[aim.found] = true,
                Kind::Solved(_) => {}
            }
        }
        for (i, &arm) in self.arms.iter().enumerate() {
            if !found[i] {
                waiting[self.known_at[arm.frame]].push(Step::Rotate(i, arm));
            }
        }
        let driven = slides.iter().enumerate();
        let driven = driven.filter_map(|(s, by)| by.map(|actuator| Step::Slide(s, actuator)));
        // What waits for nothing is on the ground, where it lies as it is.
        let rotations = waiting.into_iter().skip(1);
        let both = self.steps.into_iter().zip(rotations);
        let turned = both.flat_map(|(step, arms)| std::iter::once(step).chain(arms));
        driven.chain(turned).collect()
    }
}
