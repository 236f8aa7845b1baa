//! Descriptions of the groups of a plan, for messages and reports.

use super::{AssurGroup, GroupKind, PlacementMethod, Plan};

use crate::mechanism::{BodyId, JointId};
use crate::structure::groups::{self, Group};
use crate::structure::lower::Lowered;

impl Plan {
    /// For each group in the order of solution: its number of unknowns and how it is solved.
    pub fn group_methods(&self) -> Vec<(usize, &'static str)> {
        let name = |g: &AssurGroup| match &g.kind {
            GroupKind::RrrDyad(_) => "pinned dyad, closed form",
            GroupKind::GuidedPoint(_) => "guided point, closed form",
            GroupKind::Factored(factored_group) => match factored_group.method {
                PlacementMethod::Newton if factored_group.is_overdetermined() => {
                    "Newton from stored poses, least squares"
                }
                PlacementMethod::Newton if self.actuators() == 1 => "Newton from stored poses",
                PlacementMethod::Newton => "Newton along a path from the assembly",
                PlacementMethod::Linear if g.group.loops.is_empty() => "coupling",
                PlacementMethod::Linear => "slides, closed form",
                PlacementMethod::GearTrain => "gears, closed form",
                PlacementMethod::Triangle(..) => "pinned dyad of variable length, closed form",
                PlacementMethod::LineCircle(..) => "rotation and slide, closed form",
                PlacementMethod::PointOnLine(_) => "guided point, closed form",
            },
        };
        self.groups
            .iter()
            .map(|g| (g.group.unknowns.len(), name(g)))
            .collect()
    }

    /// A group: its unknowns and its equations.
    pub fn group(&self, group: usize) -> &Group {
        &self.groups[group].group
    }

    /// The bodies whose positions a group determines.
    pub fn group_bodies(&self, group: usize) -> Vec<BodyId> {
        let unknowns = self.groups[group].group.unknowns.iter();
        let bodies = unknowns.flat_map(|&u| groups::bodies_of(&self.frames, &self.tree, u));
        self.lowered.mechanism_bodies(bodies)
    }

    /// The joints whose loops and couplings a group closes.
    pub fn group_joints(&self, group: usize) -> Vec<JointId> {
        let Group {
            loops, couplings, ..
        } = &self.groups[group].group;
        let pairs = loops.iter().map(|&l| self.loop_closures[l].pair);
        let owners = pairs
            .map(|b| self.lowered.pairs[b].owner)
            .chain(couplings.iter().map(|&r| self.couplings[r].owner));
        Lowered::owners(owners).0
    }
}
