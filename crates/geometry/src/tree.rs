//! How the bodies are carried from the ground, and the loops that the remaining joints close.
//!
//! A spanning tree of joints carries each body from a body that comes earlier. A body's *root*
//! is its point in the joint that carries it; every other attachment is measured from there, so
//! nothing depends on where the mechanism or a body's frame stands. A joint outside the tree is a
//! *chord*: its loop says that the point on the second body, reached through the tree, meets the
//! point on the first.

use crate::error::StructureError;
use crate::frames::Frames;
use crate::lower::{Driven, Lowered, Tie};
use crate::plane::Vec2;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A constant vector in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arm {
    /// The frame it turns with.
    pub frame: usize,
    /// Its components in that frame, m (or a unit direction).
    pub local: Vec2,
}

/// How a body is carried from an earlier one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carry {
    /// The body; an index beyond the mechanism's bodies is an added, massless one.
    pub body: usize,
    /// The body that carries it.
    pub parent: usize,
    /// The bond that carries it.
    pub bond: usize,
    /// From the parent's root to the bond's point on the parent.
    pub arm: Arm,
    /// The slide, if the bond is one: its index and the direction, in the frame of both
    /// bodies, along which the body moves away from the parent.
    pub slide: Option<(usize, Vec2)>,
}

/// The tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    /// The moving bodies, each after the one that carries it.
    pub carries: Vec<Carry>,
    /// By body: its place in `carries`; none for the ground.
    pub place: Vec<Option<usize>>,
    /// By body: its root, in its own frame, m.
    pub roots: Vec<Vec2>,
    /// The bonds outside the tree.
    pub chords: Vec<usize>,
    /// By slide: its bond.
    pub slides: Vec<usize>,
}

/// The closure of a chord: P₂ − P₁ as a sum of arms and slides.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Loop {
    /// The chord, by bond.
    pub(crate) bond: usize,
    /// One arm for each frame it passes, all attachments of that frame summed.
    pub(crate) arms: Vec<Arm>,
    /// The slides it passes, each with the direction it counts along.
    pub(crate) slides: Vec<(usize, Arm)>,
    /// For a slide whose travel nothing measures, its axis (first body): only the part along the
    /// normal must vanish.
    pub(crate) axis: Option<Arm>,
}

impl Tree {
    /// Carries every body from the ground: over driven joints first, then revolute ones, then
    /// prismatic ones, and along as few joints as possible.
    ///
    /// # Errors
    /// [`StructureError::Detached`] when some bodies cannot be reached.
    pub(crate) fn find(lowered: &Lowered, frames: &Frames) -> Result<Self, StructureError> {
        let n = lowered.bodies;
        let mut bonds_of: Vec<Vec<usize>> = vec![Vec::new(); n];
        for (b, bond) in lowered.bonds.iter().enumerate() {
            for body in bond.bodies {
                bonds_of[body].push(b);
            }
        }
        let mut tree = Self {
            carries: Vec::with_capacity(n.saturating_sub(1)),
            place: vec![None; n],
            roots: vec![Vec2::ZERO; n],
            chords: Vec::new(),
            slides: Vec::new(),
        };
        let ground = lowered.ground;
        let mut reached = vec![false; n];
        let mut in_tree = vec![false; lowered.bonds.len()];
        let mut queue = BinaryHeap::new();
        reached[ground] = true;
        // Measured from one of its own points, the ground adds no rounding of where it stands.
        if let Some(&b) = bonds_of[ground].first() {
            tree.roots[ground] = point_on(lowered, b, ground);
        }
        let rank = ranks(lowered);
        let offer = |queue: &mut BinaryHeap<_>, body: usize, depth: usize| {
            for &b in &bonds_of[body] {
                queue.push(Reverse((rank[b], depth + 1, b, body)));
            }
        };
        offer(&mut queue, ground, 0);
        while let Some(Reverse((_, depth, b, parent))) = queue.pop() {
            let bond = &lowered.bonds[b];
            let child = bond.bodies[usize::from(bond.bodies[0] == parent)];
            if std::mem::replace(&mut reached[child], true) {
                continue;
            }
            in_tree[b] = true;
            tree.roots[child] = point_on(lowered, b, child);
            tree.carry(lowered, frames, b, parent, child);
            offer(&mut queue, child, depth);
        }
        let detached = lowered.named((0..n).filter(|&b| !reached[b]));
        if !detached.is_empty() {
            return Err(StructureError::Detached { bodies: detached });
        }
        tree.chords = (0..in_tree.len()).filter(|&b| !in_tree[b]).collect();
        for &chord in &tree.chords {
            if let Tie::Slide { measured: true, .. } = lowered.bonds[chord].tie {
                tree.slides.push(chord);
            }
        }
        Ok(tree)
    }

    fn carry(&mut self, lowered: &Lowered, frames: &Frames, b: usize, parent: usize, child: usize) {
        let bond = &lowered.bonds[b];
        let slide = match bond.tie {
            Tie::Slide { axes, .. } => {
                let axis = axes[0].turn(frames.attitudes[bond.bodies[0]].offset);
                let away = if bond.bodies[1] == child { axis } else { -axis };
                self.slides.push(b);
                Some((self.slides.len() - 1, away))
            }
            Tie::Pin | Tie::Weld(_) => None,
        };
        let arm = self.arm(frames, parent, point_on(lowered, b, parent));
        self.place[child] = Some(self.carries.len());
        self.carries.push(Carry {
            body: child,
            parent,
            bond: b,
            arm,
            slide,
        });
    }

    /// The slide of a bond, if its travel is an unknown or a coordinate.
    pub(crate) fn slide_of(&self, bond: usize) -> Option<usize> {
        self.slides.iter().position(|&b| b == bond)
    }

    /// The arm from a body's root to one of its points.
    pub fn arm(&self, frames: &Frames, body: usize, point: Vec2) -> Arm {
        arm_between(frames, body, self.roots[body], point)
    }

    /// The loop that a chord closes.
    pub(crate) fn close(&self, lowered: &Lowered, frames: &Frames, chord: usize) -> Loop {
        let bond = &lowered.bonds[chord];
        let mut arms: Vec<Arm> = Vec::new();
        let mut slides: Vec<(usize, Arm)> = Vec::new();
        // Walk both ends down to the body where they meet, the later one first.
        let [mut first, mut second] = [0, 1].map(|i| (bond.bodies[i], bond.points[i]));
        while first.0 != second.0 {
            let step_second = self.place[second.0] > self.place[first.0];
            let (end, sign) = if step_second {
                (&mut second, 1.0)
            } else {
                (&mut first, -1.0)
            };
            // The end that comes later in the tree is never the ground, so it is carried.
            let Some(at) = self.place[end.0] else { break };
            let carry = &self.carries[at];
            add(
                &mut arms,
                arm_between(frames, end.0, self.roots[end.0], end.1),
                sign,
            );
            if let Some((slide, away)) = carry.slide {
                let frame = frames.attitudes[end.0].frame;
                let local = away * sign;
                slides.push((slide, Arm { frame, local }));
            }
            *end = (carry.parent, point_on(lowered, carry.bond, carry.parent));
        }
        add(
            &mut arms,
            arm_between(frames, first.0, first.1, second.1),
            1.0,
        );
        arms.retain(|arm| arm.local != Vec2::ZERO);
        let mut axis = None;
        if let Tie::Slide { axes, measured, .. } = bond.tie {
            let attitude = frames.attitudes[bond.bodies[0]];
            let frame = attitude.frame;
            let local = axes[0].turn(attitude.offset);
            match self.slide_of(chord).filter(|_| measured) {
                // Its travel is a coordinate: the loop closes along the axis too.
                Some(own) => slides.push((
                    own,
                    Arm {
                        frame,
                        local: -local,
                    },
                )),
                None => axis = Some(Arm { frame, local }),
            }
        }
        Loop {
            bond: chord,
            arms,
            slides,
            axis,
        }
    }
}

/// By bond: 0 where an actuator drives it or its travel is measured, 1 a pin or a weld, 2 a slide.
fn ranks(lowered: &Lowered) -> Vec<u8> {
    let mut pairs: Vec<[usize; 2]> = lowered
        .drives
        .iter()
        .filter_map(|drive| match *drive {
            Driven::Angle(bodies) => Some(sorted(bodies)),
            Driven::Travel(_) => None,
        })
        .collect();
    pairs.sort_unstable();
    let rank = |bond: &crate::lower::Bond| match bond.tie {
        Tie::Pin if pairs.binary_search(&sorted(bond.bodies)).is_ok() => 0,
        Tie::Slide { measured: true, .. } => 0,
        Tie::Pin | Tie::Weld(_) => 1,
        Tie::Slide { .. } => 2,
    };
    lowered.bonds.iter().map(rank).collect()
}

fn sorted([a, b]: [usize; 2]) -> [usize; 2] {
    if a <= b { [a, b] } else { [b, a] }
}

/// The bond's point on one of its bodies.
fn point_on(lowered: &Lowered, bond: usize, body: usize) -> Vec2 {
    let bond = &lowered.bonds[bond];
    bond.points[usize::from(bond.bodies[0] != body)]
}

/// The vector from one point of a body to another, in its frame. What is left of two points that
/// coincide to the rounding of their coordinates is nothing: a mechanism drawn far from the origin
/// has the structure of the same one drawn near it.
fn arm_between(frames: &Frames, body: usize, from: Vec2, to: Vec2) -> Arm {
    let attitude = frames.attitudes[body];
    let difference = to - from;
    let rounding = 4.0 * f64::EPSILON * (from.norm() + to.norm());
    let local = if difference.norm() <= rounding {
        Vec2::ZERO
    } else {
        difference.turn(attitude.offset)
    };
    Arm {
        frame: attitude.frame,
        local,
    }
}

/// Adds an arm to a loop, into the one that turns with the same frame if there is one.
fn add(arms: &mut Vec<Arm>, arm: Arm, sign: f64) {
    let local = arm.local * sign;
    if let Some(same) = arms.iter_mut().find(|a| a.frame == arm.frame) {
        let sum = same.local + local;
        let rounding = 4.0 * f64::EPSILON * (same.local.norm() + local.norm());
        same.local = if sum.norm() <= rounding {
            Vec2::ZERO
        } else {
            sum
        };
    } else {
        arms.push(Arm {
            frame: arm.frame,
            local,
        });
    }
}
