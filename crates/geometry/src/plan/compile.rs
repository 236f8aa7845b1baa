//! From a mechanism to its plan: which group is solved how, and which arms are rotated when.

use super::{Aim, Assur, Behind, Carried, Closure, Driven, Kind, Newton, Pin, Plan, Step};
use crate::error::StructureError;
use crate::frames::{Frame, Frames, Turning};
use crate::groups::{self, Group, Unknown};
use crate::mechanism::Mechanism;
use crate::plane::Vec2;
use crate::range::Range;
use crate::tree::{Arm, Loop, Tree};
use std::collections::HashMap;

impl Plan {
    /// The structure alone: branches and seeds still to be found.
    pub(super) fn structure(mechanism: &Mechanism) -> Result<Self, StructureError> {
        let frames = Frames::find(mechanism)?;
        let tree = Tree::find(mechanism, &frames)?;
        let loops: Vec<Loop> = tree
            .chords
            .iter()
            .map(|&chord| tree.close(mechanism, &frames, chord))
            .collect();
        let groups = groups::order(mechanism, &frames, &tree, &loops)?;
        let mut class_roots = vec![0; frames.classes];
        for (f, frame) in frames.frames.iter().enumerate() {
            if frame.turning == Turning::Unknown {
                class_roots[frame.class] = f;
            }
        }
        let mut table = ArmTable::new(&frames, &class_roots, &groups);
        let closures: Vec<Closure> = loops.iter().map(|l| table.closure(l)).collect();
        let carried = tree
            .carries
            .iter()
            .map(|c| table.carried(&frames, &tree, c))
            .collect();
        let mut plan = Self {
            driven: driven(&frames, &class_roots, |class| class == 0),
            class_roots,
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
        plan.arms.clone_from(&table.arms);
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
        plan.steps = table.steps(&plan.groups);
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
            (None, &[one, two]) if simple && roots_only => {
                Kind::Pin(self.prepare_pin(first, [one, two], known))
            }
            (Some((axis, frame)), arms)
                if simple && roots_only && group.unknowns.len() == 1 && arms.len() <= 1 =>
            {
                self.prepare_aim(first, (axis, frame), in_group(frame), arms.first(), known)
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
                let Closure {
                    arms, slides, axis, ..
                } = &self.closures[closure];
                let moved = arms.iter().copied().filter(|&(_, f)| needs_turning(f));
                Behind {
                    closure,
                    axis: axis.map(|(a, _)| a),
                    turning: axis.map(|(_, f)| f).filter(|&f| needs_turning(f)),
                    arms: moved.collect(),
                    slides: slides.clone(),
                }
            })
            .collect();
        let size = group
            .loops
            .iter()
            .flat_map(|&l| &self.closures[l].arms)
            .map(|&(a, _)| self.arms[a].local.norm())
            .chain(group.loops.iter().map(|&l| self.closures[l].fixed.norm()))
            .sum();
        Assur {
            driven: driven(&self.frames, &self.class_roots, |class| {
                group.unknowns.contains(&Unknown::Class(class))
            }),
            group,
            kind,
            behind,
            size,
        }
    }

    fn prepare_pin(
        &self,
        closure: usize,
        turning: [(usize, usize); 2],
        known: Vec<(usize, usize)>,
    ) -> Pin {
        let local = turning.map(|(a, _)| self.arms[a].local);
        let [one, two] = local.map(Vec2::norm);
        Pin {
            closure,
            arms: turning.map(|(a, _)| a),
            frames: turning.map(|(_, f)| f),
            per_square: [
                local[0] * (1.0 / (one * one)),
                local[1] * (1.0 / (two * two)),
            ],
            sum2: (one + two) * (one + two),
            gap2: (one - two) * (one - two),
            excess: (two - one) * (two + one),
            fixed: self.closures[closure].fixed,
            known,
            branch: 1.0,
        }
    }

    fn prepare_aim(
        &self,
        closure: usize,
        axis: (usize, usize),
        line_turns: bool,
        arm: Option<&(usize, usize)>,
        known: Vec<(usize, usize)>,
    ) -> Option<Aim> {
        let local = arm.map_or(Vec2::ZERO, |&(a, _)| self.arms[a].local);
        let root = self.frames.frames[axis.1].turning == Turning::Unknown;
        let (found, frame, unit) = match (line_turns, arm) {
            (true, _) if root => (axis.0, axis.1, self.arms[axis.0].local.perp()),
            (false, Some(&(arm, turned))) => (arm, turned, local * (1.0 / local.norm())),
            _ => return None,
        };
        Some(Aim {
            closure,
            frame,
            axis,
            line_turns,
            found,
            arms: self.closures[closure].arms.clone(),
            local,
            unit,
            fixed: self.closures[closure].fixed,
            known,
            branch: 1.0,
        })
    }
}

/// The driven frames of some classes, each after the one it is turned from.
fn driven(frames: &Frames, roots: &[usize], of: impl Fn(usize) -> bool) -> Vec<Driven> {
    let all = frames.frames.iter().enumerate();
    all.filter_map(|(frame, &Frame { turning, class })| match turning {
        Turning::Driven {
            parent,
            actuator,
            sign,
        } if of(class) => Some(Driven {
            frame,
            parent,
            actuator,
            sign,
            root: roots[class],
        }),
        _ => None,
    })
    .collect()
}

fn newton(lu: usize, pivots: usize) -> Kind {
    Kind::Newton(Newton {
        lu,
        pivots,
        branch: 1.0,
        seeds: crate::seeds::Seeds::default(),
    })
}

/// Collects arms, each once, and the steps that make their frames known.
struct ArmTable {
    arms: Vec<Arm>,
    /// The arms by frame and the bits of their components.
    seen: HashMap<(usize, u64, u64), usize>,
    /// By frame: the step that makes it known (0 for the ground).
    known_at: Vec<usize>,
    /// The steps that make frames known, in order.
    steps: Vec<Step>,
}

impl ArmTable {
    fn new(frames: &Frames, roots: &[usize], groups: &[Group]) -> Self {
        let mut table = Self {
            arms: Vec::new(),
            seen: HashMap::new(),
            known_at: vec![0; frames.frames.len()],
            steps: Vec::new(),
        };
        table.turn(driven(frames, roots, |class| class == 0));
        for (g, group) in groups.iter().enumerate() {
            table.steps.push(Step::Solve(g));
            for &unknown in &group.unknowns {
                if let Unknown::Class(class) = unknown {
                    table.known_at[roots[class]] = table.steps.len();
                    table.turn(driven(frames, roots, |c| c == class));
                }
            }
        }
        table
    }

    /// Turns the driven frames of a class that has become known.
    fn turn(&mut self, driven: Vec<Driven>) {
        for one in driven {
            self.known_at[one.frame] = self.steps.len() + 1;
            self.steps.push(Step::Turn(one));
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
        let (still, moving): (Vec<Arm>, Vec<Arm>) =
            one.arms.iter().partition(|a| self.known_at[a.frame] == 0);
        Closure {
            joint: one.joint,
            fixed: still.iter().fold(Vec2::ZERO, |sum, a| sum + a.local),
            arms: moving.iter().map(|&a| (self.index(a), a.frame)).collect(),
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

    /// The steps, with each arm rotated as soon as its frame is known, unless its group finds it.
    fn steps(self, groups: &[Assur]) -> Vec<Step> {
        let mut waiting: Vec<Vec<Step>> = vec![Vec::new(); self.steps.len() + 1];
        let found = |arm: usize| {
            groups.iter().any(|assur| match &assur.kind {
                Kind::Pin(pin) => pin.arms.contains(&arm),
                Kind::Aim(aim) => aim.found == arm,
                Kind::Newton(_) => false,
            })
        };
        for (i, &arm) in self.arms.iter().enumerate() {
            if !found(i) {
                waiting[self.known_at[arm.frame]].push(Step::Rotate(i, arm));
            }
        }
        // What waits for nothing is on the ground, where it lies as it is.
        let rotations = waiting.into_iter().skip(1);
        let both = self.steps.into_iter().zip(rotations);
        both.flat_map(|(step, arms)| std::iter::once(step).chain(arms))
            .collect()
    }
}
