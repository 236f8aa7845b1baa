//! What the groups of a plan are, for messages and reports.

use super::{AssurGroup, GroupKind, PlacementMethod, Plan};

use crate::mechanism::{ActuatorId, BodyId, JointId};
use crate::structure::groups::{self, Group, Unknown};
use crate::structure::lower::{Lowered, Owner};

impl Plan {
    /// For each group in the order of solution: its number of unknowns and how it is solved.
    pub fn group_methods(&self) -> Vec<(usize, &'static str)> {
        let name = |g: &AssurGroup| match &g.kind {
            GroupKind::RrrDyad(_) => "pinned dyad, closed form",
            GroupKind::GuidedPoint(_) => "guided point, closed form",
            GroupKind::Factored(factored_group) if factored_group.rows > factored_group.columns => {
                "Newton from stored poses, least squares"
            }
            GroupKind::Factored(factored_group) => match factored_group.method {
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
        self.bodies_of(&self.groups[group].group)
    }

    /// The joints whose loops and couplings a group closes.
    pub fn group_joints(&self, group: usize) -> Vec<JointId> {
        self.group_owners(group).0
    }

    pub(crate) fn group_owners(&self, group: usize) -> (Vec<JointId>, Vec<ActuatorId>) {
        let Group {
            loops, couplings, ..
        } = &self.groups[group].group;
        let pairs = loops.iter().map(|&l| self.loop_closures[l].pair);
        let owners: Vec<Owner> = pairs
            .map(|b| self.lowered.pairs[b].owner)
            .chain(couplings.iter().map(|&r| self.couplings[r].owner))
            .collect();
        Lowered::owners(owners)
    }

    pub(crate) fn bodies_of(&self, group: &Group) -> Vec<BodyId> {
        let mut bodies = Vec::new();
        for &unknown in &group.unknowns {
            match unknown {
                Unknown::ClassAngle(c) => bodies.extend(&self.frames.class_bodies[c]),
                Unknown::SlideTravel(s) => bodies.extend(groups::bodies_of_slide(&self.tree, s)),
            }
        }
        self.lowered.mechanism_bodies(bodies)
    }
}
