//! The compiled form of a mechanism: a flat list of steps that place it, group by group. A plan
//! is constant and shared; what it computes lives in a caller's [`Pose`] and
//! [`Motion`](crate::motion::Motion).

mod compile;

use crate::error::{AssemblyError, StructureError};
use crate::frames::Frames;
use crate::groups::{self, Group, Unknown};
use crate::mechanism::{BodyId, JointId, Mechanism};
use crate::plane::Vec2;
use crate::range::Range;
use crate::scalar::Scalar;
use crate::tree::{Arm, Tree};

/// How and where the mechanism is put together.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The coordinate of each actuator at assembly, rad.
    pub q: Vec<f64>,
    /// Rough angle of each body, where one is given, rad: picks the assembly branch.
    pub rough: Vec<Option<f64>>,
}

/// A mechanism compiled for evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub(crate) frames: Frames,
    pub(crate) tree: Tree,
    pub(crate) arms: Vec<Arm>,
    pub(crate) carried: Vec<Carried>,
    pub(crate) closures: Vec<Closure>,
    pub(crate) groups: Vec<Assur>,
    pub(crate) steps: Vec<Step>,
    /// By class: the frame whose angle is the unknown (the ground's for class 0).
    pub(crate) class_roots: Vec<usize>,
    /// The frames that turn with the ground but for the actuators, each after the one it is
    /// turned from.
    pub(crate) driven: Vec<Driven>,
    pub(crate) ground: usize,
    pub(crate) actuators: usize,
    pub(crate) start: Vec<f64>,
    pub(crate) range: Range,
}

/// A moving body, in the order in which bodies carry each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carried {
    /// The body.
    pub body: BodyId,
    /// The joint that carries it.
    pub joint: JointId,
    /// Place of the body that carries it in the same order; none for the ground.
    pub parent: Option<usize>,
    /// Its frame.
    pub frame: usize,
    /// The frame of the body that carries it.
    pub parent_frame: usize,
    /// The rotated arm from the parent's root to the joint; none where it has no length or
    /// belongs to the ground, so that it does not move.
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
}

/// A loop with its arms in the plan's table: L = P₂ − P₁ = fixed + Σ arms + Σ travel · direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Closure {
    /// The joint that closes the loop.
    pub joint: JointId,
    /// The part of the loop on the ground, m.
    pub fixed: Vec2,
    /// The arms it sums, as (arm, frame).
    pub arms: Vec<(usize, usize)>,
    /// The slides it passes, as (slide, direction arm, frame).
    pub slides: Vec<(usize, usize, usize)>,
    /// For a prismatic joint, the rotated axis of its first body, as (arm, frame).
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
    Newton(Newton),
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

/// Any other group: Newton's method from stored seeds.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Newton {
    /// Where its factors begin in [`Pose::lu`], and its pivots in [`Pose::pivots`].
    pub(crate) lu: usize,
    pub(crate) pivots: usize,
    pub(crate) branch: f64,
    pub(crate) seeds: crate::seeds::Seeds,
}

/// One step of placing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Step {
    /// Turn a frame by an actuator's coordinate.
    Turn(Driven),
    /// Solve a group.
    Solve(usize),
    /// Rotate an arm whose frame has become known.
    Rotate(usize, Arm),
}

/// What placing computes: the orientation of every frame and every rotated arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose<T> {
    /// The actuators' coordinates, rad.
    pub q: Vec<T>,
    /// By frame: (cos, sin).
    pub turn: Vec<Vec2<T>>,
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
}

impl Newton {
    /// The group's factors in a pose.
    pub(crate) fn factors<'a, T>(&self, pose: &'a Pose<T>, n: usize) -> (&'a [T], &'a [usize]) {
        (
            &pose.lu[self.lu..self.lu + n * n],
            &pose.pivots[self.pivots..self.pivots + n],
        )
    }
}

impl Plan {
    /// Compiles a mechanism: finds its structure, assembles it at the start on the branch asked
    /// for, and follows that branch over the range of a single actuator.
    ///
    /// # Errors
    /// [`AssemblyError`] when the structure is not driven by its actuators, the bodies do not
    /// reach each other, or the branch is not told.
    pub fn compile(mechanism: &Mechanism, start: &Start) -> Result<Self, AssemblyError> {
        check(mechanism, start)?;
        let mut plan = Self::structure(mechanism)?;
        plan.start.clone_from(&start.q);
        let pose = plan.assemble(&start.rough)?;
        plan.follow(&pose)?;
        Ok(plan)
    }

    /// A pose with the right sizes, to be filled by [`Plan::place`].
    pub fn pose<T: Scalar>(&self) -> Pose<T> {
        let newton = |g: &Assur| match g.kind {
            Kind::Newton(_) => g.group.unknowns.len(),
            _ => 0,
        };
        let lu = self.groups.iter().map(|g| newton(g).pow(2)).sum();
        let pivots = self.groups.iter().map(newton).sum();
        let most = self.groups.iter().map(newton).max().unwrap_or(0);
        let zero = T::lift(0.0);
        Pose {
            q: vec![zero; self.actuators],
            turn: vec![Vec2::IDENTITY.lift(); self.frames.frames.len()],
            arm: self.arms.iter().map(|a| a.local.lift()).collect(),
            slide: vec![zero; self.tree.slides],
            travel: vec![zero; self.closures.len()],
            inverse: vec![zero; self.groups.len()],
            lu: vec![zero; lu],
            pivots: vec![0; pivots],
            work: vec![zero; most],
        }
    }

    /// Number of independent coordinates.
    pub fn actuators(&self) -> usize {
        self.actuators
    }

    /// The coordinates at which the mechanism was assembled, rad.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// How far the single actuator can turn on this branch.
    pub fn range(&self) -> Range {
        self.range
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

    /// For each group in the order of solution: its number of unknowns and how it is solved.
    pub fn group_kinds(&self) -> Vec<(usize, &'static str)> {
        let name = |g: &Assur| match g.kind {
            Kind::Pin(_) => "pinned dyad, closed form",
            Kind::Aim(_) => "guided point, closed form",
            Kind::Newton(_) => "Newton from stored seeds",
        };
        self.groups
            .iter()
            .map(|g| (g.group.unknowns.len(), name(g)))
            .collect()
    }

    /// The bodies that a group places.
    pub fn group_bodies(&self, group: usize) -> Vec<BodyId> {
        self.bodies_of(&self.groups[group].group)
    }

    /// The joints whose loops a group closes.
    pub fn group_joints(&self, group: usize) -> Vec<JointId> {
        let loops = &self.groups[group].group.loops;
        loops.iter().map(|&l| self.closures[l].joint).collect()
    }

    pub(crate) fn bodies_of(&self, group: &Group) -> Vec<BodyId> {
        let mut bodies = Vec::new();
        for &unknown in &group.unknowns {
            match unknown {
                Unknown::Class(c) => bodies.extend(groups::bodies_of_class(&self.frames, c)),
                Unknown::Slide(s) => bodies.extend(
                    self.tree
                        .carries
                        .iter()
                        .filter(|c| c.slide.is_some_and(|(t, _)| t == s))
                        .map(|c| c.body),
                ),
            }
        }
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    }
}

/// Refuses a description whose parts refer to what is not there.
fn check(mechanism: &Mechanism, start: &Start) -> Result<(), StructureError> {
    let bodies = mechanism.bodies.len();
    let ends = mechanism.joints.iter().map(|j| j.bodies);
    let mut ends = ends.chain(mechanism.actuators.iter().map(|a| a.bodies));
    let finite = |angle: &Option<f64>| angle.is_none_or(f64::is_finite);
    let what = if mechanism.ground >= bodies || !ends.all(|e| e.iter().all(|b| b.0 < bodies)) {
        "a body that is not there"
    } else if start.q.len() != mechanism.actuators.len() || start.rough.len() != bodies {
        "the start needs a coordinate for each actuator and a place for each body"
    } else if !start.q.iter().all(|q| q.is_finite()) || !start.rough.iter().all(finite) {
        "an angle that is not a finite number"
    } else {
        return Ok(());
    };
    Err(StructureError::Malformed { what })
}
