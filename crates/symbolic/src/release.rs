//! A joint that lets go along one component: what each step feels of it.
//!
//! A second coordinate shifts the joint's second body along the component by one unit. To first order,
//! which is all that a and b take of it, the known part of each loop is shifted by a sum over its pieces, and
//! the points of the bodies are shifted by what carries them.

use crate::algebra::{Term, number, scaled, symbol, times, zero};
use crate::error::SymbolicError;
use crate::positions::{Pair, Positions, add, perp, rotated};
use dwell_geometry::frames::Coupler;
use dwell_geometry::lower::Tie;
use dwell_geometry::{Component, JointKind, Reaction, Vec2};
use std::collections::BTreeMap;

/// What lets go.
#[derive(Debug, Clone)]
enum Released {
    /// A bond, along a direction in the plane.
    Bond(usize, Pair),
    /// The couple of a bond.
    Hold(usize),
    Relation(usize),
}

/// A released joint: what it adds to each step, and to each body's angle beside its frame's.
#[derive(Debug, Clone)]
pub(crate) struct Release {
    pub(crate) shifts: BTreeMap<String, Term>,
    pub(crate) turned: Vec<f64>,
}

impl Positions<'_> {
    /// Releases one component of a joint. Further constants may be named, and no steps.
    pub(crate) fn release(&mut self, reaction: Reaction) -> Result<Release, SymbolicError> {
        let released = self.released(reaction)?;
        let turned = self.turned(&released);
        let mut shifts = BTreeMap::new();
        for closure in 0..self.chains.len() {
            self.shift_loop(closure, &released, &turned, &mut shifts);
        }
        self.shift_bodies(&released, &turned, &mut shifts);
        self.shift_relations(&released, &turned, &mut shifts);
        Ok(Release { shifts, turned })
    }

    fn released(&mut self, reaction: Reaction) -> Result<Released, SymbolicError> {
        let Reaction { joint, component } = reaction;
        let refused = SymbolicError::Reaction(reaction);
        let (bond, relation) = self.plan.parts(joint);
        let is_relation = matches!(self.mechanism.joints[joint.0].kind, JointKind::Relation(_));
        match (component, bond, relation) {
            (Component::Tooth | Component::Tangent | Component::Force, _, Some(relation)) => {
                return Ok(Released::Relation(relation));
            }
            (Component::Moment, _, Some(relation)) if is_relation => {
                return Ok(Released::Relation(relation));
            }
            (Component::Moment, Some(bond), _) => return Ok(Released::Hold(bond)),
            _ => {}
        }
        let bond = bond.ok_or(refused)?;
        let described = self.plan.bonds()[bond];
        let along = match (component, described.tie) {
            (Component::Y, _) => [zero(), number(1.0)],
            (Component::Normal, Tie::Slide { axes, .. }) => {
                let (frame, axis) = self.in_frame(described.bodies[0], axes[0]);
                let axis = self.direction(frame, axis, "direction of the guide");
                perp(&rotated(&axis, &self.angle(frame)))
            }
            // The line of a distance is the x axis of its second body.
            (Component::Axial, _) => {
                let (frame, axis) = self.in_frame(described.bodies[1], Vec2::IDENTITY);
                let axis = self.direction(frame, axis, "direction of the line");
                rotated(&axis, &self.angle(frame))
            }
            _ => [number(1.0), zero()],
        };
        Ok(Released::Bond(bond, along))
    }

    /// By body: how much it turns beside its frame for each unit.
    fn turned(&self, released: &Released) -> Vec<f64> {
        let mut turned = vec![0.0; self.plan.frames().attitudes.len()];
        let Released::Hold(bond) = *released else {
            return turned;
        };
        for hold in &self.plan.frames().holds {
            let own = if hold.by == Coupler::Bond(bond) {
                // Its second body turns from its first.
                if hold.body_is_first { -1.0 } else { 1.0 }
            } else {
                0.0
            };
            turned[hold.body] = turned[hold.against] + own;
        }
        turned
    }

    fn shift_loop(
        &mut self,
        closure: usize,
        released: &Released,
        turned: &[f64],
        shifts: &mut BTreeMap<String, Term>,
    ) {
        let Some(gap) = self.closed[closure].gap.clone() else {
            return;
        };
        let chain = self.chains[closure].clone();
        let mut sum = [zero(), zero()];
        for piece in chain.pieces.iter().filter(|p| turned[p.body] != 0.0) {
            let meaning = self.meaning(piece);
            let pair = self.local(piece.frame, piece.local, &meaning);
            let pair = rotated(&pair, &self.angle(piece.frame));
            sum = add(&sum, &perp(&pair).map(|c| scaled(&c, turned[piece.body])));
        }
        for passage in chain.passages.iter().filter(|p| turned[p.body] != 0.0) {
            let along = self.direction(passage.frame, passage.local, "direction of travel");
            let along = rotated(&along, &self.angle(passage.frame));
            let travel = self.travels[passage.slide].clone().unwrap_or_else(zero);
            let travel = scaled(&travel, turned[passage.body]);
            sum = add(&sum, &perp(&along).map(|c| times(&c, &travel)));
        }
        if let Released::Bond(bond, along) = released {
            for &(_, sign) in chain.bonds.iter().filter(|(b, _)| b == bond) {
                sum = add(&sum, &along.clone().map(|c| scaled(&c, sign)));
            }
            if chain.bond == *bond {
                sum = add(&sum, &along.clone().map(|c| scaled(&c, -1.0)));
            }
        }
        for (code, shift) in gap.into_iter().zip(sum) {
            shifts.insert(code, shift.simplify());
        }
        if let (Some((code, travel)), Some((body, ..))) =
            (self.closed[closure].normal.clone(), chain.axis)
            && turned[body] != 0.0
        {
            shifts.insert(code, scaled(&travel, turned[body]));
        }
    }

    fn shift_bodies(
        &mut self,
        released: &Released,
        turned: &[f64],
        shifts: &mut BTreeMap<String, Term>,
    ) {
        for place in 0..self.plan.tree().carries.len() {
            let carry = self.plan.tree().carries[place];
            let bond = self.plan.bonds()[carry.bond];
            let mut sum = [zero(), zero()];
            let parent = self.roots[carry.parent].clone();
            let root = self.roots[carry.body].clone();
            let (Some(root), by) = (root, turned[carry.parent]) else {
                continue;
            };
            let first = turned[bond.bodies[0]];
            if by != 0.0 || first != 0.0 {
                // From the parent's root, and the travel along the first body's axis.
                let mut whole = root.clone().map(|c| symbol(&c));
                if let Some(parent) = parent {
                    let parent = parent.map(|c| scaled(&symbol(&c), -1.0));
                    whole = add(&whole, &parent);
                }
                let mut along = [zero(), zero()];
                if let Some((slide, away)) = carry.slide {
                    let own = self.plan.frames().attitudes[carry.body].frame;
                    let pair = self.direction(own, away, "direction of travel");
                    let pair = rotated(&pair, &self.angle(own));
                    let travel = self.travels[slide].clone().unwrap_or_else(zero);
                    along = pair.map(|c| times(&c, &travel));
                }
                let arm = add(&whole, &along.clone().map(|c| scaled(&c, -1.0)));
                sum = add(&perp(&arm).map(|c| times(&c, &number(by))), &sum);
                sum = add(&perp(&along).map(|c| times(&c, &number(first))), &sum);
            }
            if let Released::Bond(released, along) = released
                && *released == carry.bond
            {
                let sign = if bond.bodies[1] == carry.body {
                    1.0
                } else {
                    -1.0
                };
                sum = add(&sum, &along.clone().map(|c| scaled(&c, sign)));
            }
            for (code, shift) in root.into_iter().zip(sum) {
                shifts.insert(code, shift.simplify());
            }
        }
        for (body, &by) in turned.iter().enumerate() {
            let (Some(centre), Some(root)) = (self.centres[body].clone(), self.roots[body].clone())
            else {
                continue;
            };
            if by != 0.0 && centre != root {
                let arm = [0, 1].map(|i| symbol(&centre[i]) - symbol(&root[i]));
                let arm = perp(&arm).map(|c| scaled(&c, by).simplify());
                shifts.extend(centre.into_iter().zip(arm));
            }
        }
    }

    fn shift_relations(
        &self,
        released: &Released,
        turned: &[f64],
        shifts: &mut BTreeMap<String, Term>,
    ) {
        let mut pose = self.plan.pose::<f64>();
        if self.plan.place(self.plan.start(), &mut pose).is_err() {
            return;
        }
        for relation in 0..self.related.len() {
            let Some((code, by)) = &self.related[relation] else {
                continue;
            };
            let mut shift = 0.0;
            self.plan.relation_couples(relation, &pose, |body, factor| {
                shift += factor * turned[body];
            });
            if matches!(released, Released::Relation(r) if *r == relation) {
                shift -= 1.0;
            }
            if shift != 0.0 {
                let shift = number(-shift) / by.clone();
                shifts.insert(code.clone(), shift.simplify());
            }
        }
    }
}
