//! What the groups of a plan are, for messages and reports.

use super::{Assur, How, Kind, Plan};

use crate::groups::{self, Group, Unknown};
use crate::lower::{Lowered, Owner};
use crate::mechanism::{ActuatorId, BodyId, JointId};

impl Plan {
    /// For each group in the order of solution: its number of unknowns and how it is solved.
    pub fn group_kinds(&self) -> Vec<(usize, &'static str)> {
        let name = |g: &Assur| match &g.kind {
            Kind::Pin(_) => "pinned dyad, closed form",
            Kind::Aim(_) => "guided point, closed form",
            Kind::Solved(solved) if solved.rows > solved.columns => {
                "Newton from stored seeds, least squares"
            }
            Kind::Solved(solved) => match solved.how {
                How::Newton if self.actuators() == 1 => "Newton from stored seeds",
                How::Newton => "Newton along the way from the start",
                How::Linear if g.group.loops.is_empty() => "relation",
                How::Linear => "slides, closed form",
                How::Geared => "gears, closed form",
                How::Triangle(..) => "pinned dyad of changing length, closed form",
                How::Reach(..) => "turn and slide, closed form",
                How::Guide(_) => "guided point, closed form",
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

    /// The bodies that a group places.
    pub fn group_bodies(&self, group: usize) -> Vec<BodyId> {
        self.bodies_of(&self.groups[group].group)
    }

    /// The joints whose loops and relations a group closes.
    pub fn group_joints(&self, group: usize) -> Vec<JointId> {
        self.group_owners(group).0
    }

    pub(crate) fn group_owners(&self, group: usize) -> (Vec<JointId>, Vec<ActuatorId>) {
        let Group {
            loops, relations, ..
        } = &self.groups[group].group;
        let bonds = loops.iter().map(|&l| self.closures[l].bond);
        let owners: Vec<Owner> = bonds
            .map(|b| self.lowered.bonds[b].owner)
            .chain(relations.iter().map(|&r| self.relations[r].owner))
            .collect();
        Lowered::owners(owners)
    }

    pub(crate) fn bodies_of(&self, group: &Group) -> Vec<BodyId> {
        let mut bodies = Vec::new();
        for &unknown in &group.unknowns {
            match unknown {
                Unknown::Class(c) => bodies.extend(&self.frames.members[c]),
                Unknown::Slide(s) => bodies.extend(groups::bodies_of_slide(&self.tree, s)),
            }
        }
        self.lowered.named(bodies)
    }
}
