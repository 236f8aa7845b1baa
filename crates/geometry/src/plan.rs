//! The compiled form of a mechanism: a flat list of steps that place it, group by group. A plan
//! is constant and shared; what it computes lives in a caller's [`Pose`] and
//! [`Motion`](crate::motion::Motion).

mod arms;
mod build;
mod compile;
mod parts;

use crate::frames::Frames;
use crate::groups::Group;
use crate::lower::{Bond, Lowered, Measure};
use crate::mechanism::{BodyId, JointId};
use crate::plane::Vec2;
use crate::range::{End, Range};
use crate::relation::Row;
use crate::scalar::Scalar;
use crate::seeds::Seeds;
use crate::tree::{Arm, Tree};
use std::collections::HashMap;

/// How and where the mechanism is put together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Start {
    /// The coordinate of each actuator at assembly, rad or m.
    pub q: Vec<f64>,
    /// Rough angle of each body, where one is given, rad: picks the assembly branch.
    pub rough: Vec<Option<f64>>,
    /// What is known roughly of each joint, where it is: picks the branch too, where the angles of the
    /// bodies do not. The travel of a prismatic joint or a slot, m, or the direction of a distance,
    /// rad ([`Told`](crate::mechanism::Told)). Empty where nothing is known of any joint.
    pub joints: Vec<Option<f64>>,
}

/// A mechanism compiled for evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub(crate) lowered: Lowered,
    pub(crate) frames: Frames,
    pub(crate) tree: Tree,
    pub(crate) arms: Vec<Arm>,
    pub(crate) carried: Vec<Carried>,
    pub(crate) closures: Vec<Closure>,
    pub(crate) relations: Vec<Row>,
    pub(crate) groups: Vec<Assur>,
    pub(crate) steps: Vec<Step>,
    /// By bond: its place in the tree or among the closures.
    pub(crate) bond_places: Vec<BondPlace>,
    /// By group: the step that solves it.
    pub(crate) solve_steps: Vec<usize>,
    /// By class: the frame whose angle is the unknown (the ground's for class 0).
    pub(crate) class_roots: Vec<usize>,
    /// The frames that turn with the ground but for the actuators, each after the one it is
    /// turned from.
    pub(crate) driven: Vec<Driven>,
    /// By frame: whether its whole turns are counted, because a relation or a load needs its angle.
    pub(crate) counted: Vec<bool>,
    /// By body: the whole turns that it is ahead of its frame, rad.
    pub(crate) turns: Vec<f64>,
    /// By frame of a line of centres: the frame beside which its turns are counted, and how far it is
    /// turned from it, rad.
    pub(crate) beside: HashMap<usize, (usize, f64)>,
    /// By slide: the actuator that drives it.
    pub(crate) driven_slides: Vec<Option<usize>>,
    /// By actuator: whether it drives an angle rather than a length.
    pub(crate) angular: Vec<bool>,
    /// The largest length in it, m: what a step of a driven length is measured against.
    pub(crate) reach: f64,
    pub(crate) start: Vec<f64>,
    pub(crate) range: Range,
    /// Where the range ends, downwards and upwards, if it does.
    pub(crate) ends: [Option<End>; 2],
    /// The pose at the start, once it is assembled.
    pub(crate) home: Option<Box<Pose<f64>>>,
    /// By reaction of the mechanism: whether the loads determine it; empty where they determine all.
    pub(crate) unique: Vec<bool>,
    /// By group: the ways in which it closes at the start.
    pub(crate) branches: Vec<Branches>,
}

/// The ways in which a group closes at the start.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Branches {
    /// The bodies whose angles tell them apart.
    pub bodies: Vec<BodyId>,
    /// The joints that do where no body does: [`JointKind::told`](crate::mechanism::JointKind::told)
    /// says by what.
    pub joints: Vec<JointId>,
    /// For each way, the angle of each of `bodies`, rad, and the travel or direction of each of
    /// `joints`, m or rad; the way that was picked comes first.
    pub ways: Vec<Vec<f64>>,
}

/// Where a bond is in the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BondPlace {
    /// It carries a body: index in [`Plan::carried`].
    Carries(usize),
    /// It closes a loop: index in [`Plan::closures`].
    Closes(usize),
}

/// A moving body, in the order in which bodies carry each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carried {
    /// The body; an index beyond the mechanism's bodies is an added, massless one.
    pub body: usize,
    /// The bond that carries it.
    pub bond: usize,
    /// Place of the body that carries it in the same order; none for the ground.
    pub parent: Option<usize>,
    /// Its frame.
    pub frame: usize,
    /// The frame of the body that carries it.
    pub parent_frame: usize,
    /// The rotated arm from the parent's root to the joint; none where it has no length or
    /// belongs to the ground itself. (A body that slides without turning carries moments by it.)
    pub arm: Option<usize>,
    /// The slide of a prismatic joint: its index, and the rotated direction of its travel.
    pub slide: Option<(usize, usize)>,
}

/// A frame turned from another one by an actuator's coordinate, times `sign`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Driven {
    pub(crate) frame: usize,
    pub(crate) parent: usize,
    pub(crate) actuator: usize,
    pub(crate) sign: f64,
    /// The frame whose angle is the unknown of its class.
    pub(crate) root: usize,
    /// Whether its whole turns are counted.
    pub(crate) counted: bool,
}

/// A loop with its arms in the plan's table: L = P₂ − P₁ = fixed + Σ arms + Σ travel · direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Closure {
    /// The bond that closes the loop.
    pub bond: usize,
    /// The part of the loop on the ground, m.
    pub fixed: Vec2,
    /// The arms it sums, as (arm, frame).
    pub arms: Vec<(usize, usize)>,
    /// The slides it passes, as (slide, direction arm, frame).
    pub slides: Vec<(usize, usize, usize)>,
    /// For a slide whose travel nothing measures, the rotated axis of its first body, as (arm, frame).
    pub axis: Option<(usize, usize)>,
}

/// A group with what its way of solving needs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Assur {
    pub(crate) group: Group,
    pub(crate) kind: Kind,
    /// The driven frames of its classes, each after the one it is turned from.
    pub(crate) driven: Vec<Driven>,
    /// The closures of the group, with what lies behind them.
    pub(crate) behind: Vec<Behind>,
    /// Sum of the lengths in its loops, m: what residuals are small against.
    pub(crate) size: f64,
    /// A power of two near `size`: travels are counted in it, so that pivots can be compared.
    pub(crate) scale: f64,
    /// Where Newton's method starts, and where whole turns are counted from.
    pub(crate) seeds: Seeds,
    /// Whether a closed form leaves turns to be counted.
    pub(crate) counts: bool,
    /// Whether the seeds are needed.
    pub(crate) remembers: bool,
    /// Whether nothing that was asked for needs it.
    pub(crate) skipped: bool,
}

/// The part of a closure that an earlier group or an actuator moves: its multiplier acts there too.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Behind {
    pub(crate) closure: usize,
    /// The axis of a prismatic closure, and its frame if that is behind.
    pub(crate) axis: Option<usize>,
    pub(crate) turning: Option<usize>,
    /// Arms, with their frames.
    pub(crate) arms: Vec<(usize, usize)>,
    /// All slides of the closure, as (slide, direction arm, frame).
    pub(crate) slides: Vec<(usize, usize, usize)>,
}

/// How a group is solved.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Kind {
    Pin(Pin),
    Aim(Aim),
    Solved(Solved),
}

/// Two bodies pinned to each other and to known points: a triangle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pin {
    pub(crate) closure: usize,
    /// The two arms that turn, and their frames.
    pub(crate) arms: [usize; 2],
    pub(crate) frames: [usize; 2],
    /// The arms in their frames, each over its length squared: turns one back to its rotation.
    pub(crate) per_square: [Vec2; 2],
    /// Squares of the arms' sum, difference and (second less first) lengths, m².
    pub(crate) sum2: f64,
    pub(crate) gap2: f64,
    pub(crate) excess: f64,
    /// The other arms of the loop: those on the ground, and those that move.
    pub(crate) fixed: Vec2,
    pub(crate) known: Vec<(usize, usize)>,
    /// Sign of arm₁ × arm₂: the assembly branch.
    pub(crate) branch: f64,
}

/// A body turned until a point of its loop lies on a line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Aim {
    pub(crate) closure: usize,
    pub(crate) frame: usize,
    /// The rotated axis of the line, with its frame.
    pub(crate) axis: (usize, usize),
    /// Whether the line turns (a slotted guide) or the arm does (a connecting rod).
    pub(crate) line_turns: bool,
    /// The rotated arm that comes with the solution: the axis, or the arm of the loop.
    pub(crate) found: usize,
    /// The arms of the loop that move.
    pub(crate) arms: Vec<(usize, usize)>,
    /// The arm of the loop in the turning frame.
    pub(crate) local: Vec2,
    /// The unit vector that is found: the line's normal, or the arm's direction.
    pub(crate) unit: Vec2,
    /// The other arms of the loop: those on the ground, and those that move.
    pub(crate) fixed: Vec2,
    pub(crate) known: Vec<(usize, usize)>,
    /// Sign of −∂(normal distance)/∂angle: the assembly branch.
    pub(crate) branch: f64,
}

/// Any other group, whose motion and forces come from the factors of its Jacobian.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Solved {
    pub(crate) how: How,
    /// Numbers of equations and unknowns.
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    /// Where its factors begin in [`Pose::lu`], and its pivots in [`Pose::pivots`].
    pub(crate) lu: usize,
    pub(crate) pivots: usize,
    /// Sign of the determinant at the start.
    pub(crate) branch: f64,
    /// Sign of the root that a construction takes.
    pub(crate) side: f64,
}

/// How a group is placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum How {
    /// Newton's method from stored seeds.
    Newton,
    /// Its equations are linear in its unknowns.
    Linear,
    /// Gears whose lines of centres turn with their carriers: linear in the angles.
    Geared,
    /// Two classes turn until a loop closes: a triangle with sides that may change.
    Triangle(usize, usize),
    /// A class turns and a slide travels until a loop closes.
    Reach(usize, usize),
    /// A class turns until a point lies on a line.
    Guide(usize),
}

/// One step of placing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Step {
    /// Turn a frame by an actuator's coordinate.
    Turn(Driven),
    /// Set a slide to an actuator's coordinate: (slide, actuator).
    Slide(usize, usize),
    /// Solve a group.
    Solve(usize),
    /// Rotate an arm whose frame has become known.
    Rotate(usize, Arm),
}

/// What placing computes: the orientation of every frame and every rotated arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose<T> {
    /// The actuators' coordinates, rad or m.
    pub q: Vec<T>,
    /// By frame: (cos, sin).
    pub turn: Vec<Vec2<T>>,
    /// By frame: its angle with whole turns counted, rad; only where a relation or a load needs it.
    pub angle: Vec<T>,
    /// By arm: its components in ground axes, m.
    pub arm: Vec<Vec2<T>>,
    /// By slide of the tree: its travel, m.
    pub slide: Vec<T>,
    /// By closure: along a prismatic chord's axis, the travel P₂ − P₁, m.
    pub travel: Vec<T>,
    /// By closed-form group: one over the determinant of its Jacobian.
    pub(crate) inverse: Vec<T>,
    pub(crate) lu: Vec<T>,
    pub(crate) pivots: Vec<usize>,
    pub(crate) work: Vec<T>,
    pub(crate) path: Vec<T>,
}

impl Plan {
    /// A pose with the right sizes, to be filled by [`Plan::place`].
    pub fn pose<T: Scalar>(&self) -> Pose<T> {
        let solved = || {
            self.groups.iter().filter_map(|g| match &g.kind {
                Kind::Solved(solved) => Some(solved),
                _ => None,
            })
        };
        let zero = T::lift(0.0);
        Pose {
            q: vec![zero; self.actuators()],
            turn: vec![Vec2::IDENTITY.lift(); self.frames.frames.len()],
            angle: vec![zero; self.frames.frames.len()],
            arm: self.arms.iter().map(|a| a.local.lift()).collect(),
            slide: vec![zero; self.tree.slides.len()],
            travel: vec![zero; self.closures.len()],
            inverse: vec![zero; self.groups.len()],
            lu: vec![zero; solved().map(Solved::room).sum()],
            pivots: vec![0; solved().map(|s| s.columns).sum()],
            work: vec![zero; solved().map(|s| s.rows).max().unwrap_or(0)],
            path: vec![zero; self.actuators()],
        }
    }

    /// Number of independent coordinates.
    pub fn actuators(&self) -> usize {
        self.angular.len()
    }

    /// Whether an actuator's coordinate is an angle (rad) rather than a length (m).
    pub fn is_angle(&self, actuator: usize) -> bool {
        self.angular[actuator]
    }

    /// The coordinates at which the mechanism was assembled, rad or m.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// How far the single actuator can go on this branch.
    pub fn range(&self) -> Range {
        self.range
    }

    /// Where and why the range ends, downwards and upwards.
    pub fn ends(&self) -> [Option<End>; 2] {
        self.ends
    }

    /// The moving bodies, each after the one that carries it.
    pub fn carried(&self) -> &[Carried] {
        &self.carried
    }

    /// The loops, by index.
    pub fn closures(&self) -> &[Closure] {
        &self.closures
    }

    /// The orientations of the bodies.
    pub fn frames(&self) -> &Frames {
        &self.frames
    }

    /// The tree that carries the bodies.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The relations between angles and travels, by index, their coupling evaluated by the plan.
    pub fn relation(&self, index: usize) -> &Row {
        &self.relations[index]
    }

    /// The pins, slides and welds that the mechanism is made of; the bonds of joints come first.
    pub fn bonds(&self) -> &[Bond] {
        &self.lowered.bonds
    }

    /// A joint's first bond and its relation.
    pub fn parts(&self, joint: JointId) -> (Option<usize>, Option<usize>) {
        self.lowered.of_joint[joint.0]
    }

    /// Whether the loads determine a reaction, by its index in [`Mechanism::reactions`](crate::mechanism::Mechanism::reactions). Where joints
    /// repeat each other they do not: of all forces that balance the loads, the smallest are given.
    pub fn is_unique(&self, reaction: usize) -> bool {
        self.unique.get(reaction).copied().unwrap_or(true)
    }

    /// Where a bond is in the plan.
    pub fn bond_place(&self, bond: usize) -> BondPlace {
        self.bond_places[bond]
    }

    /// By an actuator that drives a length: its slide.
    pub fn slide_of(&self, actuator: usize) -> Option<usize> {
        self.driven_slides
            .iter()
            .position(|&by| by == Some(actuator))
    }

    /// The derivative of a relation with the angle of each body it names.
    pub fn relation_couples<T: Scalar>(
        &self,
        relation: usize,
        pose: &Pose<T>,
        mut couple: impl FnMut(usize, T),
    ) {
        let ratio = &self.lowered.ratios[relation];
        let mut each = |sum: &[(Measure, f64)], by: T| {
            for &(measure, factor) in sum {
                if let Measure::Angle(body) = measure {
                    couple(body, by * T::lift(factor));
                }
            }
        };
        each(&ratio.of, T::lift(1.0));
        if let Some((_, sum)) = &ratio.law {
            let slope = self.relations[relation].slope(&pose.angle, &pose.slide);
            each(sum, -slope);
        }
    }

    /// By slide: the actuator that drives it, if any.
    pub fn driven_slides(&self) -> &[Option<usize>] {
        &self.driven_slides
    }

    /// Number of relations.
    pub fn relations(&self) -> usize {
        self.relations.len()
    }

    /// For each group, the ways in which it closes at the start.
    pub fn branches(&self) -> &[Branches] {
        &self.branches
    }
}
