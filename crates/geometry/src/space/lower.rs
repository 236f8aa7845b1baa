//! Selects the joints of the tree, and adds bodies so that joints whose coordinates are needed can be in the tree.
//!
//! The joints with the fewest freedoms are in the tree, so that those with many are cut and no orientation is an unknown where it
//! need not be; before them those whose coordinates are needed: bearings of gear pairs, driven joints, screws (whose angle counts all
//! revolutions). If a driven joint or a screw still closes a loop of such joints, it moves a massless body that is welded to its
//! second body.

use super::coordinate::Coordinate;
use super::joint_kinds::{Condition, JointKind};
use super::mechanism::{Assembly, Joint, Mechanism, Placement, Side};
use crate::error::{AssemblyError, StructureError};
use crate::mechanism::{Body, BodyId, JointId};

/// A mechanism with the massless bodies that it needs, and their welds, after its own.
pub(super) struct Lowered {
    pub(super) mechanism: Mechanism,
    /// By joint: whether it is in the tree.
    pub(super) in_tree: Vec<bool>,
    /// By massless body: the joint that moves it. Its weld has the same place among the welds.
    pub(super) split: Vec<JointId>,
    /// By coupled coordinate: the joint that measures it, if it is a distance. These joints follow the welds.
    pub(super) measured: Vec<Option<JointId>>,
    /// By added joint: the one for which it was added.
    added_for: Vec<JointId>,
}

/// By joint: whether it is on the chain between a wheel of a gear pair and its carrier.
///
/// # Errors
/// [`StructureError::Gear`] where there is no such chain.
fn bearings(mechanism: &Mechanism) -> Result<Vec<bool>, StructureError> {
    let mut found = vec![false; mechanism.joints.len()];
    for (j, joint) in mechanism.joints.iter().enumerate() {
        let JointKind::Gear { carrier } = joint.kind else {
            continue;
        };
        for wheel in joint.bodies {
            let chain = chain_between(mechanism, carrier, wheel).ok_or(StructureError::Gear {
                joint: JointId(j),
                reason: "no joints with one axis connect a wheel with the carrier",
            })?;
            chain.iter().for_each(|j| found[j.0] = true);
        }
    }
    Ok(found)
}

/// The fewest joints with one axis that connect two bodies.
fn chain_between(mechanism: &Mechanism, from: BodyId, to: BodyId) -> Option<Vec<JointId>> {
    // By body: the joint that leads to it from a body nearer to the first.
    let mut by: Vec<Option<(JointId, BodyId)>> = vec![None; mechanism.bodies.len()];
    let mut reached = vec![from];
    let mut next = 0;
    while let Some(&body) = reached.get(next) {
        next += 1;
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let side = joint.bodies.iter().position(|b| *b == body);
            let Some(side) = side.filter(|_| joint.kind.has_common_axis()) else {
                continue;
            };
            let other = joint.bodies[1 - side];
            if by[other.0].is_none() && other != from {
                by[other.0] = Some((JointId(j), body));
                reached.push(other);
            }
        }
    }
    let (mut chain, mut body) = (Vec::new(), to);
    while body != from {
        let (joint, nearer) = by[body.0]?;
        chain.push(joint);
        body = nearer;
    }
    Some(chain)
}

/// By joint: whether it is in the tree, by Kruskal's rule with the freedoms as weights.
fn tree_joints(mechanism: &Mechanism, bearings: &[bool]) -> Vec<bool> {
    let weight = |j: &usize| match mechanism.joints[*j].kind {
        _ if bearings.get(*j) == Some(&true) => 0,
        _ if mechanism.needs_coordinate(JointId(*j)) => 1,
        JointKind::Helical { .. } => 2,
        kind => 3 + kind.freedoms(),
    };
    let can_carry = |j: &usize| mechanism.joints[*j].kind.can_carry();
    let mut order: Vec<usize> = (0..mechanism.joints.len()).filter(can_carry).collect();
    order.sort_by_key(weight);
    let mut part: Vec<usize> = (0..mechanism.bodies.len()).collect();
    let mut in_tree = vec![false; mechanism.joints.len()];
    for j in order {
        let [a, b] = mechanism.joints[j].bodies.map(|b| part[b.0]);
        if a != b {
            in_tree[j] = true;
            part.iter_mut().filter(|p| **p == b).for_each(|p| *p = a);
        }
    }
    in_tree
}

impl Lowered {
    /// Adds the bodies that the tree needs.
    ///
    /// # Errors
    /// [`StructureError::Gear`] where the bearings of gear pairs cannot be in a tree.
    pub(super) fn new(mechanism: &Mechanism) -> Result<Self, StructureError> {
        let bearings = bearings(mechanism)?;
        let mut lowered = Self {
            in_tree: tree_joints(mechanism, &bearings),
            mechanism: mechanism.clone(),
            split: Vec::new(),
            measured: Vec::new(),
            added_for: Vec::new(),
        };
        let is_gear = |j: &JointId| {
            let kind = mechanism.joints[j.0].kind;
            matches!(kind, JointKind::Gear { .. })
        };
        let mut bearings_in_tree = bearings.iter().zip(&lowered.in_tree);
        if bearings_in_tree.any(|(bearing, in_tree)| *bearing && !in_tree) {
            let mut joints = (0..mechanism.joints.len()).map(JointId);
            return Err(StructureError::Gear {
                joint: joints.find(is_gear).unwrap_or(JointId(0)),
                reason: "the bearings of gear pairs form a loop of their own",
            });
        }
        let is_counted = |j: &usize| {
            let kind = mechanism.joints[*j].kind;
            let is_needed =
                kind.holds(Condition::Thread) || mechanism.needs_coordinate(JointId(*j));
            is_needed && kind.can_carry() && !lowered.in_tree[*j]
        };
        lowered.split = (0..mechanism.joints.len())
            .filter(is_counted)
            .map(JointId)
            .collect();
        lowered.add_welds(mechanism);
        lowered.add_measuring_joints(mechanism);
        if !lowered.added_for.is_empty() {
            lowered.in_tree = tree_joints(&lowered.mechanism, &bearings);
        }
        Ok(lowered)
    }

    /// Adds a massless body, with its weld, for each joint that is split.
    fn add_welds(&mut self, mechanism: &Mechanism) {
        let with = &mut self.mechanism;
        for joint in &self.split {
            let Joint {
                name,
                bodies,
                sides,
                ..
            } = mechanism.joints[joint.0].clone();
            let moved = BodyId(with.bodies.len());
            with.bodies.push(Body::named(name.clone()));
            with.joints[joint.0].bodies[1] = moved;
            let weld = Joint::new(name, [moved, bodies[1]], JointKind::Weld, [sides[1]; 2]);
            with.joints.push(weld);
        }
        self.added_for.clone_from(&self.split);
    }

    /// Adds a joint for each coupled distance, which measures it and does not hold it.
    fn add_measuring_joints(&mut self, mechanism: &Mechanism) {
        for (owner, of) in mechanism.coupled() {
            let Coordinate::Distance { bodies, points } = of else {
                self.measured.push(None);
                continue;
            };
            let side = |point| Side {
                point,
                ..Side::default()
            };
            let name = &mechanism.joints[owner.0].name;
            let kind = JointKind::Distance { length: 0.0 };
            let joint = Joint::new(name, bodies, kind, points.map(side));
            self.measured
                .push(Some(JointId(self.mechanism.joints.len())));
            self.mechanism.joints.push(joint);
            self.added_for.push(owner);
        }
    }

    /// The assembly with the placements of the massless bodies.
    pub(super) fn assembly(&self, assembly: &Assembly) -> Assembly {
        let bodies = self.mechanism.bodies.len() - self.split.len();
        let own = (0..bodies).map(|b| assembly.placement(b));
        let welded = (0..self.split.len()).map(|k| assembly.placement(self.welded_to(k).0));
        let placements: Vec<Placement> = own.chain(welded).collect();
        Assembly {
            q: assembly.q.clone(),
            placements,
        }
    }

    /// The body to which a massless one is welded.
    fn welded_to(&self, k: usize) -> BodyId {
        let joints = self.mechanism.joints.len() - self.added_for.len();
        self.mechanism.joints[joints + k].bodies[1]
    }

    /// The joint of the mechanism as it was described, of which this is one or for which this was added.
    pub(super) fn described_joint(&self, joint: JointId) -> JointId {
        let own = self.mechanism.joints.len() - self.added_for.len();
        match joint.0.checked_sub(own) {
            Some(added) => self.added_for[added],
            None => joint,
        }
    }

    /// An error in terms of the mechanism as it was described.
    pub(super) fn described(&self, mut error: AssemblyError) -> AssemblyError {
        let bodies = self.mechanism.bodies.len() - self.split.len();
        let own_bodies = |list: &mut Vec<BodyId>| {
            for body in list.iter_mut().filter(|b| b.0 >= bodies) {
                *body = self.welded_to(body.0 - bodies);
            }
            list.sort_unstable();
            list.dedup();
        };
        let own_joints = |list: &mut Vec<JointId>| {
            list.iter_mut()
                .for_each(|joint| *joint = self.described_joint(*joint));
            list.sort_unstable();
            list.dedup();
        };
        if self.added_for.is_empty() {
            return error;
        }
        match &mut error {
            AssemblyError::NoAssembly { bodies, joints, .. }
            | AssemblyError::SingularAssembly { bodies, joints }
            | AssemblyError::Ambiguous { bodies, joints, .. } => {
                own_bodies(bodies);
                own_joints(joints);
            }
            AssemblyError::Inconsistent { joints, .. }
            | AssemblyError::NotThroughout { joints, .. } => own_joints(joints),
            AssemblyError::NearlyParallel { joints: pair, .. } => {
                *pair = pair.map(|joint| self.described_joint(joint));
            }
            AssemblyError::NotMeshing { .. } | AssemblyError::OffTable { .. } => {}
            AssemblyError::Structure(structure) => match structure {
                StructureError::UnderActuated { bodies, .. }
                | StructureError::NotConnected { bodies } => own_bodies(bodies),
                StructureError::OverConstrained { joints, .. } => own_joints(joints),
                StructureError::Gear { .. } | StructureError::Malformed { .. } => {}
            },
        }
        error
    }
}
