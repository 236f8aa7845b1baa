//! The compiled form of a mechanism: a flat list of steps that place it, group by group. A plan
//! is constant and shared; what it computes lives in a caller's [`Pose`] and
//! [`Motion`](crate::motion::Motion).

use crate::error::{AssemblyError, StructureError};
use crate::frames::{Frames, Turning};
use crate::groups::{self, Group, Unknown};
use crate::mechanism::{BodyId, JointId, Mechanism};
use crate::plane::Vec2;
use crate::range::{self, Range};
use crate::scalar::Scalar;
use crate::tree::{Arm, Loop, Tree};
use std::collections::HashMap;

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
    /// By class: its driven frames, each after the one it is turned from.
    pub(crate) driven_of: Vec<Vec<usize>>,
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

/// A loop with its arms in the plan's table: L = P₂ − P₁ = Σ arms + Σ travel · direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Closure {
    /// The joint that closes the loop.
    pub joint: JointId,
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
    /// The closures of the group, with what lies behind them.
    pub(crate) behind: Vec<Behind>,
    /// Sum of the lengths in its loops, m: what residuals are small against.
    pub(crate) size: f64,
}

/// The part of a closure that an earlier group or an actuator moves: its multiplier acts there too.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Behind {
    pub(crate) closure: usize,
    /// Arms, with their frames.
    pub(crate) arms: Vec<(usize, usize)>,
    /// The frame of the axis of a prismatic closure.
    pub(crate) axis: Option<usize>,
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
    pub(crate) local: [Vec2; 2],
    pub(crate) length: [f64; 2],
    /// The other arms of the loop.
    pub(crate) known: Vec<(usize, usize)>,
    /// Sign of arm₁ × arm₂: the assembly branch.
    pub(crate) branch: f64,
}

/// A body turned until a point of its loop lies on a line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Aim {
    pub(crate) closure: usize,
    pub(crate) frame: usize,
    /// Whether the line turns (a slotted guide) or the arm does (a connecting rod).
    pub(crate) line_turns: bool,
    /// The arm of the loop in the turning frame.
    pub(crate) local: Vec2,
    /// The unit vector that is found: the line's normal, or the arm's direction.
    pub(crate) unit: Vec2,
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
    pub(crate) seeds: range::Seeds,
}

/// One step of placing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Step {
    /// Turn a frame by an actuator's coordinate.
    Turn(usize),
    /// Solve a group.
    Solve(usize),
    /// Rotate the arms of frames that have become known.
    Rotate(std::ops::Range<usize>),
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
        let mut plan = Self::structure(mechanism)?;
        plan.start.clone_from(&start.q);
        let pose = plan.assemble(&start.rough)?;
        plan.follow(&pose)?;
        Ok(plan)
    }

    /// The structure alone: branches and seeds still to be found.
    fn structure(mechanism: &Mechanism) -> Result<Self, StructureError> {
        let frames = Frames::find(mechanism)?;
        let tree = Tree::find(mechanism, &frames)?;
        let loops: Vec<Loop> = tree
            .chords
            .iter()
            .map(|&chord| tree.close(mechanism, &frames, chord))
            .collect();
        let groups = groups::order(mechanism, &frames, &tree, &loops)?;
        let mut table = ArmTable::new(&frames, &groups);
        let closures: Vec<Closure> = loops.iter().map(|l| table.closure(l)).collect();
        let carried = tree
            .carries
            .iter()
            .map(|c| table.carried(&frames, &tree, c))
            .collect();
        let mut class_roots = vec![0; frames.classes];
        let mut driven_of = vec![Vec::new(); frames.classes];
        for (f, frame) in frames.frames.iter().enumerate() {
            match frame.turning {
                Turning::Ground => {}
                Turning::Unknown => class_roots[frame.class] = f,
                Turning::Driven { .. } => driven_of[frame.class].push(f),
            }
        }
        let mut plan = Self {
            class_roots,
            driven_of,
            ground: mechanism.ground,
            actuators: mechanism.actuators.len(),
            start: vec![0.0; mechanism.actuators.len()],
            range: Range::Full,
            arms: Vec::new(),
            groups: Vec::new(),
            steps: Vec::new(),
            frames,
            tree,
            carried,
            closures,
        };
        plan.steps = table.finish(&mut plan);
        let (mut lu, mut pivots) = (0, 0);
        for group in groups {
            let assur = plan.prepare(group, lu, pivots);
            if let Kind::Newton(_) = assur.kind {
                let n = assur.group.unknowns.len();
                if plan.actuators != 1 {
                    return Err(StructureError::GroupNeedsOneActuator {
                        size: n,
                        bodies: plan.bodies_of(&assur.group),
                    });
                }
                lu += n * n;
                pivots += n;
            }
            plan.groups.push(assur);
        }
        Ok(plan)
    }

    /// Chooses how a group is solved.
    fn prepare(&self, group: Group, lu: usize, pivots: usize) -> Assur {
        let in_group = |frame: usize| {
            let class = self.frames.frames[frame].class;
            class > 0 && group.unknowns.contains(&Unknown::Class(class))
        };
        let is_root = |frame: usize| self.frames.frames[frame].turning == Turning::Unknown;
        let simple = group.loops.len() == 1
            && group
                .unknowns
                .iter()
                .all(|u| matches!(u, Unknown::Class(_)));
        let first = group.loops[0];
        let closure = &self.closures[first];
        let (turning, known): (Vec<_>, Vec<_>) =
            closure.arms.iter().partition(|&&(_, f)| in_group(f));
        let roots_only = turning.iter().all(|&(_, f)| is_root(f)) && closure.slides.is_empty();
        let kind = match (closure.axis, turning.as_slice()) {
            (None, &[one, two]) if simple && roots_only => Kind::Pin(Pin {
                closure: first,
                arms: [one.0, two.0],
                frames: [one.1, two.1],
                local: [one, two].map(|(a, _)| self.arms[a].local),
                length: [one, two].map(|(a, _)| self.arms[a].local.norm()),
                known,
                branch: 1.0,
            }),
            (Some((axis, frame)), arms)
                if simple && roots_only && group.unknowns.len() == 1 && arms.len() <= 1 =>
            {
                self.prepare_aim(first, axis, frame, in_group(frame), arms.first(), known)
                    .map_or_else(|| newton(lu, pivots), Kind::Aim)
            }
            _ => newton(lu, pivots),
        };
        let needs_turning = |frame: usize| match self.frames.frames[frame].turning {
            Turning::Ground => false,
            Turning::Driven { .. } => true,
            Turning::Unknown => !in_group(frame),
        };
        let behind = group
            .loops
            .iter()
            .map(|&closure| {
                let Closure { arms, axis, .. } = &self.closures[closure];
                let moved = arms.iter().copied().filter(|&(_, f)| needs_turning(f));
                Behind {
                    closure,
                    arms: moved.collect(),
                    axis: axis.map(|(_, f)| f).filter(|&f| needs_turning(f)),
                }
            })
            .collect();
        let size = group
            .loops
            .iter()
            .flat_map(|&l| &self.closures[l].arms)
            .map(|&(a, _)| self.arms[a].local.norm())
            .sum();
        Assur {
            group,
            kind,
            behind,
            size,
        }
    }

    fn prepare_aim(
        &self,
        closure: usize,
        axis: usize,
        frame: usize,
        line_turns: bool,
        arm: Option<&(usize, usize)>,
        known: Vec<(usize, usize)>,
    ) -> Option<Aim> {
        let local = arm.map_or(Vec2::ZERO, |&(a, _)| self.arms[a].local);
        let root = self.frames.frames[frame].turning == Turning::Unknown;
        let (frame, unit) = match (line_turns, arm) {
            (true, _) if root => (frame, self.arms[axis].local.perp()),
            (false, Some(&(_, turned))) => (turned, local * (1.0 / local.norm())),
            _ => return None,
        };
        Some(Aim {
            closure,
            frame,
            line_turns,
            local,
            unit,
            known,
            branch: 1.0,
        })
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

fn newton(lu: usize, pivots: usize) -> Kind {
    Kind::Newton(Newton {
        lu,
        pivots,
        branch: 1.0,
        seeds: range::Seeds::default(),
    })
}

/// Collects arms, each once, sorted by the moment at which their frame becomes known.
struct ArmTable {
    arms: Vec<Arm>,
    /// The arms by frame and the bits of their components.
    seen: HashMap<(usize, u64, u64), usize>,
    /// The frames of each class.
    by_class: Vec<Vec<usize>>,
    /// By frame: the step that makes it known (0 for the ground).
    known_at: Vec<usize>,
    /// The steps that make frames known, in order.
    steps: Vec<Step>,
}

impl ArmTable {
    fn new(frames: &Frames, groups: &[Group]) -> Self {
        let mut by_class = vec![Vec::new(); frames.classes];
        for (f, frame) in frames.frames.iter().enumerate() {
            by_class[frame.class].push(f);
        }
        let mut table = Self {
            arms: Vec::new(),
            seen: HashMap::new(),
            by_class,
            known_at: vec![0; frames.frames.len()],
            steps: Vec::new(),
        };
        table.turn(frames, 0);
        for (g, group) in groups.iter().enumerate() {
            table.steps.push(Step::Solve(g));
            for &unknown in &group.unknowns {
                if let Unknown::Class(class) = unknown {
                    table.turn(frames, class);
                }
            }
        }
        table
    }

    /// Notes the frames of a class that has become known, turning the driven ones.
    fn turn(&mut self, frames: &Frames, class: usize) {
        for &f in &self.by_class[class] {
            if let Turning::Driven { .. } = frames.frames[f].turning {
                self.steps.push(Step::Turn(f));
            }
            self.known_at[f] = self.steps.len();
        }
    }

    fn index(&mut self, arm: Arm) -> usize {
        let key = (arm.frame, arm.local.x.to_bits(), arm.local.y.to_bits());
        *self.seen.entry(key).or_insert_with(|| {
            self.arms.push(arm);
            self.arms.len() - 1
        })
    }

    fn closure(&mut self, one: &Loop) -> Closure {
        Closure {
            joint: one.joint,
            arms: one.arms.iter().map(|&a| (self.index(a), a.frame)).collect(),
            slides: one
                .slides
                .iter()
                .map(|&(s, a)| (s, self.index(a), a.frame))
                .collect(),
            axis: one.axis.map(|a| (self.index(a), a.frame)),
        }
    }

    fn carried(&mut self, frames: &Frames, tree: &Tree, carry: &crate::tree::Carry) -> Carried {
        let frame = frames.attitudes[carry.body.0].frame;
        let fixed = carry.arm.local == Vec2::ZERO
            || frames.frames[carry.arm.frame].turning == Turning::Ground;
        Carried {
            body: carry.body,
            joint: carry.joint,
            parent: tree.place[carry.parent.0],
            frame,
            parent_frame: carry.arm.frame,
            arm: (!fixed).then(|| self.index(carry.arm)),
            slide: carry
                .slide
                .map(|(s, local)| (s, self.index(Arm { frame, local }))),
        }
    }

    /// Sorts the arms, renumbers them in the plan, and interleaves the rotations with the steps.
    fn finish(self, plan: &mut Plan) -> Vec<Step> {
        let mut order: Vec<usize> = (0..self.arms.len()).collect();
        order.sort_by_key(|&a| (self.known_at[self.arms[a].frame], self.arms[a].frame));
        let mut new = vec![0; order.len()];
        for (place, &old) in order.iter().enumerate() {
            new[old] = place;
        }
        plan.arms = order.iter().map(|&a| self.arms[a]).collect();
        for closure in &mut plan.closures {
            for (arm, _) in &mut closure.arms {
                *arm = new[*arm];
            }
            for (_, arm, _) in &mut closure.slides {
                *arm = new[*arm];
            }
            if let Some((arm, _)) = &mut closure.axis {
                *arm = new[*arm];
            }
        }
        for carried in &mut plan.carried {
            if let Some(arm) = &mut carried.arm {
                *arm = new[*arm];
            }
            if let Some((_, arm)) = &mut carried.slide {
                *arm = new[*arm];
            }
        }
        let ready = |step: usize| {
            let at = |a: &usize| self.known_at[self.arms[*a].frame];
            let from = order.partition_point(|a| at(a) < step);
            from..order.partition_point(|a| at(a) <= step)
        };
        let mut steps = Vec::new();
        for (s, step) in self.steps.into_iter().enumerate() {
            steps.push(step);
            let arms = ready(s + 1);
            if !arms.is_empty() {
                steps.push(Step::Rotate(arms));
            }
        }
        steps
    }
}
