//! How a loop is made of pieces of bodies: walked anew, body by body, so that each piece can be turned or
//! shifted by itself when a joint is released.

use dwell_geometry::frames::Frames;
use dwell_geometry::lower::{Owner, Tie};
use dwell_geometry::{Mechanism, Plan, Vec2};

/// A constant vector on a body.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece {
    pub(crate) body: usize,
    pub(crate) frame: usize,
    /// In the frame, m; in the direction in which the loop passes it.
    pub(crate) local: Vec2,
    /// From which joint to which.
    pub(crate) between: [String; 2],
}

/// A travel that a loop passes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Passage {
    pub(crate) slide: usize,
    /// The first body of its bond, which holds its direction.
    pub(crate) body: usize,
    pub(crate) frame: usize,
    /// The direction along which it counts, in the frame.
    pub(crate) local: Vec2,
}

/// A loop: P₂ − P₁ of the bond that closes it, through the tree.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chain {
    pub(crate) bond: usize,
    pub(crate) pieces: Vec<Piece>,
    pub(crate) passages: Vec<Passage>,
    /// The tree's bonds that it passes, each with the sign of what shifts its second point.
    pub(crate) bonds: Vec<(usize, f64)>,
    /// Where only the normal part must vanish: the axis, with its body and frame.
    pub(crate) axis: Option<(usize, usize, Vec2)>,
}

/// Pieces shorter than this part of the coordinates that they are differences of are nothing.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The vector between two points of a body, in its frame.
pub(crate) fn between(frames: &Frames, body: usize, from: Vec2, to: Vec2) -> Vec2 {
    let rounding = ROUNDING * (from.norm() + to.norm());
    let clean = |d: f64| if d.abs() <= rounding { 0.0 } else { d };
    let difference = dwell_geometry::vec2(clean(to.x - from.x), clean(to.y - from.y));
    turned(difference, frames.attitudes[body].offset)
}

/// A vector by a constant rotation; what a rotation by quarter turns leaves of a component is
/// nothing.
pub(crate) fn turned(vector: Vec2, by: Vec2) -> Vec2 {
    let turned = vector.turn(by);
    let rounding = ROUNDING * vector.norm();
    let clean = |d: f64| if d.abs() <= rounding { 0.0 } else { d };
    dwell_geometry::vec2(clean(turned.x), clean(turned.y))
}

/// The name of what a bond comes from.
pub(crate) fn bond_name(mechanism: &Mechanism, plan: &Plan, bond: usize) -> String {
    match plan.bonds()[bond].owner {
        Owner::Joint(joint) => mechanism.joints[joint.0].name.clone(),
        Owner::Actuator(actuator) => mechanism.actuators[actuator.0].name.clone(),
    }
}

impl Chain {
    /// The loop that a chord closes.
    pub(crate) fn of(mechanism: &Mechanism, plan: &Plan, closure: usize) -> Self {
        let (tree, frames) = (plan.tree(), plan.frames());
        let chord = plan.closures()[closure].bond;
        let bond = &plan.bonds()[chord];
        let mut chain = Self {
            bond: chord,
            pieces: Vec::new(),
            passages: Vec::new(),
            bonds: Vec::new(),
            axis: None,
        };
        let point_on = |bond: usize, body: usize| {
            let bond = &plan.bonds()[bond];
            bond.points[usize::from(bond.bodies[0] != body)]
        };
        let mut ends = [0, 1].map(|i| (bond.bodies[i], bond.points[i], chord));
        while ends[0].0 != ends[1].0 {
            let which = usize::from(tree.place[ends[1].0] > tree.place[ends[0].0]);
            let sign = if which == 1 { 1.0 } else { -1.0 };
            let (body, point, reached) = ends[which];
            let Some(at) = tree.place[body] else { break };
            let carry = &tree.carries[at];
            let root = point_on(carry.bond, body);
            chain.piece(
                frames,
                body,
                (root, point),
                sign,
                [carry.bond, reached].map(|b| bond_name(mechanism, plan, b)),
            );
            let is_second = plan.bonds()[carry.bond].bodies[1] == body;
            let way = if is_second { sign } else { -sign };
            chain.bonds.push((carry.bond, way));
            if let Some((slide, away)) = carry.slide {
                chain.passages.push(Passage {
                    slide,
                    body: plan.bonds()[carry.bond].bodies[0],
                    frame: frames.attitudes[body].frame,
                    local: away * sign,
                });
            }
            ends[which] = (carry.parent, point_on(carry.bond, carry.parent), carry.bond);
        }
        let names = [ends[0].2, ends[1].2].map(|b| bond_name(mechanism, plan, b));
        chain.piece(frames, ends[0].0, (ends[0].1, ends[1].1), 1.0, names);
        chain.pieces.retain(|piece| piece.local != Vec2::ZERO);
        if let Tie::Slide { axes, measured, .. } = bond.tie {
            let body = bond.bodies[0];
            let attitude = frames.attitudes[body];
            let local = turned(axes[0], attitude.offset);
            let own = plan.tree().slides.iter().position(|&b| b == chord);
            match own.filter(|_| measured) {
                Some(slide) => chain.passages.push(Passage {
                    slide,
                    body,
                    frame: attitude.frame,
                    local: -local,
                }),
                None => chain.axis = Some((body, attitude.frame, local)),
            }
        }
        chain
    }

    fn piece(
        &mut self,
        frames: &Frames,
        body: usize,
        (from, to): (Vec2, Vec2),
        sign: f64,
        between: [String; 2],
    ) {
        self.pieces.push(Piece {
            body,
            frame: frames.attitudes[body].frame,
            local: self::between(frames, body, from, to) * sign,
            between,
        });
    }
}
