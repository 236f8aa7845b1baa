//! From a mechanism to its plan: which group is solved how, and which arms are rotated when.

use super::arms::ArmTable;
use super::{Aim, Assur, Behind, BondPlace, Closure, Driven, How, Kind, Pin, Plan, Solved, Step};
use crate::error::StructureError;
use crate::frames::{Frame, Frames, Turning};
use crate::groups::{self, Group, Parts, Unknown};
use crate::lower::{self, Lowered};
use crate::mechanism::{BodyId, Drive, Mechanism};
use crate::plane::Vec2;
use crate::range::Range;
use crate::relation::Row;
use crate::seeds::Seeds;
use crate::tree::{Loop, Tree};
use std::collections::HashMap;

impl Plan {
    /// The structure alone: branches and seeds still to be found.
    pub(super) fn structure(
        mechanism: &Mechanism,
        felt: &[BodyId],
        repeated: bool,
    ) -> Result<Self, StructureError> {
        let lowered = Lowered::new(mechanism);
        let frames = Frames::find(&lowered)?;
        let tree = Tree::find(&lowered, &frames)?;
        let loops: Vec<Loop> = tree
            .chords
            .iter()
            .map(|&chord| tree.close(&lowered, &frames, chord))
            .collect();
        let relations = Row::all(&lowered, &frames, &tree);
        let driven_slides = driven_slides(&lowered, &tree);
        let parts = Parts {
            lowered: &lowered,
            frames: &frames,
            tree: &tree,
            loops: &loops,
            relations: &relations,
            driven: &driven_slides,
        };
        let groups = groups::order(&parts, repeated)?;
        let mut class_roots = vec![0; frames.classes];
        for (f, frame) in frames.frames.iter().enumerate() {
            if frame.turning == Turning::Unknown {
                class_roots[frame.class] = f;
            }
        }
        let beside = beside(&lowered, &frames);
        let counted = counted(&frames, &relations, &beside, felt);
        let all_driven = all_driven(&frames, &class_roots, &counted);
        let mut table = ArmTable::new(&frames, &class_roots, &groups, &all_driven);
        let closures: Vec<Closure> = loops.iter().map(|l| table.closure(l)).collect();
        let carried = tree
            .carries
            .iter()
            .map(|c| table.carried(&frames, &tree, c))
            .collect();
        let angular = mechanism.actuators.iter().map(|a| a.drive == Drive::Angle);
        let mut plan = Self {
            driven: driven(&all_driven, |class| class == 0),
            class_roots,
            angular: angular.collect(),
            start: vec![0.0; mechanism.actuators.len()],
            range: Range::Full,
            ends: [None; 2],
            home: None,
            branches: Vec::new(),
            unique: Vec::new(),
            reach: 0.0,
            arms: Vec::new(),
            groups: Vec::new(),
            steps: Vec::new(),
            solve_steps: Vec::new(),
            bond_places: bond_places(&lowered, &tree),
            lowered,
            frames,
            tree,
            carried,
            closures,
            relations,
            counted,
            turns: Vec::new(),
            beside,
            driven_slides,
        };
        plan.arms.clone_from(&table.arms);
        plan.reach = plan.largest_length();
        let (mut lu, mut pivots) = (0, 0);
        for group in groups {
            let assur = plan.prepare(group, &all_driven, lu, pivots);
            if let Kind::Solved(solved) = &assur.kind {
                lu += solved.room();
                pivots += solved.columns;
            }
            plan.groups.push(assur);
        }
        plan.steps = table.steps(&plan.groups, &plan.driven_slides);
        let steps = plan.steps.iter().enumerate();
        plan.solve_steps = steps
            .filter(|(_, step)| matches!(step, Step::Solve(_)))
            .map(|(i, _)| i)
            .collect();
        Ok(plan)
    }

    /// The largest distance between two points of one body, m.
    fn largest_length(&self) -> f64 {
        let arms = self.arms.iter().map(|a| a.local.norm());
        let fixed = self.closures.iter().map(|c| c.fixed.norm());
        arms.chain(fixed).fold(0.0, f64::max)
    }

    /// Chooses how a group is solved.
    fn prepare(
        &self,
        group: Group,
        all_driven: &[(usize, Driven)],
        lu: usize,
        pivots: usize,
    ) -> Assur {
        let in_group = |frame: usize| {
            let class = self.frames.frames[frame].class;
            class > 0 && group.unknowns.contains(&Unknown::Class(class))
        };
        let kind = self
            .closed_form(&group)
            .unwrap_or_else(|| self.solved(&group, lu, pivots));
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
        let size = self.size(&group);
        let counts = group.unknowns.iter().any(|u| match u {
            Unknown::Class(c) => {
                let root = self.class_roots[*c];
                self.counted[root] && !self.beside.contains_key(&root)
            }
            Unknown::Slide(_) => false,
        });
        let counts_beside = group.unknowns.iter().any(|u| match u {
            Unknown::Class(c) => self.beside.contains_key(&self.class_roots[*c]),
            Unknown::Slide(_) => false,
        });
        let remembers = match &kind {
            Kind::Solved(solved) => match solved.how {
                How::Newton => true,
                How::Linear | How::Geared => false,
                _ => counts,
            },
            _ => counts,
        };
        Assur {
            driven: driven(all_driven, |class| {
                group.unknowns.contains(&Unknown::Class(class))
            }),
            group,
            kind,
            behind,
            size,
            scale: size.log2().round().exp2(),
            seeds: Seeds::default(),
            counts: counts || counts_beside,
            remembers,
            skipped: false,
        }
    }

    /// Sum of the lengths in a group's loops, m; that of the mechanism where there are none.
    fn size(&self, group: &Group) -> f64 {
        let closures = || group.loops.iter().map(|&l| &self.closures[l]);
        let arms = closures().flat_map(|c| &c.arms);
        let size: f64 = arms
            .map(|&(a, _)| self.arms[a].local.norm())
            .chain(closures().map(|c| c.fixed.norm()))
            .sum();
        if size > 0.0 {
            size
        } else if self.reach > 0.0 {
            self.reach
        } else {
            1.0
        }
    }

    /// The two closed forms whose motion and forces are closed forms too.
    fn closed_form(&self, group: &Group) -> Option<Kind> {
        let turns = |u: &Unknown| matches!(u, Unknown::Class(_));
        let (&[first], true) = (group.loops.as_slice(), group.relations.is_empty()) else {
            return None;
        };
        if !group.unknowns.iter().all(turns) || group.rows != group.unknowns.len() {
            return None;
        }
        let in_group = |frame: usize| {
            let class = self.frames.frames[frame].class;
            class > 0 && group.unknowns.contains(&Unknown::Class(class))
        };
        let closure = &self.closures[first];
        let is_root = |frame: usize| self.frames.frames[frame].turning == Turning::Unknown;
        let (turning, known): (Vec<_>, Vec<_>) =
            closure.arms.iter().partition(|&&(_, f)| in_group(f));
        if !turning.iter().all(|&(_, f)| is_root(f)) || !closure.slides.is_empty() {
            return None;
        }
        match (closure.axis, turning.as_slice()) {
            (None, &[one, two]) => Some(Kind::Pin(self.prepare_pin(first, [one, two], known))),
            (Some((axis, frame)), arms) if group.unknowns.len() == 1 && arms.len() <= 1 => self
                .prepare_aim(first, (axis, frame), in_group(frame), arms.first(), known)
                .map(Kind::Aim),
            _ => None,
        }
    }

    fn solved(&self, group: &Group, lu: usize, pivots: usize) -> Kind {
        let columns = group.unknowns.len();
        Kind::Solved(Solved {
            how: if group.rows == columns {
                self.how(group)
            } else {
                How::Newton
            },
            rows: group.rows,
            columns,
            lu,
            pivots,
            branch: 1.0,
            side: 1.0,
        })
    }

    /// How a group without a closed form for everything is placed.
    fn how(&self, group: &Group) -> How {
        let class = |c: usize| group.unknowns.contains(&Unknown::Class(c));
        let slide = |s: usize| group.unknowns.contains(&Unknown::Slide(s));
        let turns = group
            .unknowns
            .iter()
            .any(|u| matches!(u, Unknown::Class(_)));
        let linear = |&r: &usize| self.relations[r].linear_in(&self.frames, class, slide);
        if (!turns || group.loops.is_empty()) && group.relations.iter().all(linear) {
            return How::Linear;
        }
        // Loops that only follow lines of centres: the carrier tells where these are.
        let follows = |&l: &usize| {
            let axis = self.closures[l].axis;
            axis.is_some_and(|(_, frame)| self.beside.contains_key(&frame))
        };
        let turn = |u: &Unknown| matches!(u, Unknown::Class(_));
        if group.unknowns.iter().all(turn)
            && group.loops.iter().all(follows)
            && group.relations.iter().all(linear)
        {
            return How::Geared;
        }
        let &[l] = group.loops.as_slice() else {
            return How::Newton;
        };
        let closure = &self.closures[l];
        let once = |s: usize| closure.slides.iter().filter(|x| x.0 == s).count() == 1;
        match (group.unknowns.as_slice(), closure.axis) {
            _ if !group.relations.is_empty() => How::Newton,
            (&[Unknown::Class(one), Unknown::Class(two)], None) => How::Triangle(one, two),
            (&[Unknown::Class(c), Unknown::Slide(s)], None) if once(s) => How::Reach(c, s),
            (&[Unknown::Class(c)], Some(_)) => How::Guide(c),
            _ => How::Newton,
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

/// By bond: where it is in the plan.
fn bond_places(lowered: &Lowered, tree: &Tree) -> Vec<BondPlace> {
    let mut places = vec![BondPlace::Closes(0); lowered.bonds.len()];
    for (c, &chord) in tree.chords.iter().enumerate() {
        places[chord] = BondPlace::Closes(c);
    }
    for (i, carry) in tree.carries.iter().enumerate() {
        places[carry.bond] = BondPlace::Carries(i);
    }
    places
}

/// By slide: the actuator that drives it.
fn driven_slides(lowered: &Lowered, tree: &Tree) -> Vec<Option<usize>> {
    let mut driven = vec![None; tree.slides.len()];
    for (i, drive) in lowered.drives.iter().enumerate() {
        if let lower::Driven::Travel(bond) = *drive
            && let Some(slide) = tree.slide_of(bond)
        {
            driven[slide] = Some(i);
        }
    }
    driven
}

/// By frame: whether it belongs to a class that a relation names, or that turns one of the bodies
/// whose angle is felt. What turns with the ground's class is known from the actuators already.
fn counted(
    frames: &Frames,
    relations: &[Row],
    beside: &HashMap<usize, (usize, f64)>,
    felt: &[BodyId],
) -> Vec<bool> {
    let mut classes = vec![false; frames.classes];
    for body in felt {
        let class = frames.frames[frames.attitudes[body.0].frame].class;
        classes[class] |= class != 0;
    }
    let named = relations.iter().flat_map(Row::frames);
    for frame in named.chain(beside.values().map(|(carrier, _)| *carrier)) {
        classes[frames.frames[frame].class] = true;
    }
    let counted = |f: &Frame| classes[f.class];
    frames.frames.iter().map(counted).collect()
}

/// The lines of centres that turn with a carrier, with the carrier's frame.
fn beside(lowered: &Lowered, frames: &Frames) -> HashMap<usize, (usize, f64)> {
    let of = |body: usize| frames.attitudes[body];
    let lines = lowered.ratios.iter().filter_map(|ratio| ratio.line);
    let held = lines.map(|(line, carrier, lead)| {
        let lead = lead + of(carrier).offset.angle() - of(line).offset.angle();
        (of(line).frame, (of(carrier).frame, lead))
    });
    held.filter(|(line, _)| frames.frames[*line].turning == Turning::Unknown)
        .collect()
}

/// Every driven frame with its class, each after the one it is turned from.
fn all_driven(frames: &Frames, roots: &[usize], counted: &[bool]) -> Vec<(usize, Driven)> {
    let all = frames.frames.iter().enumerate();
    all.filter_map(|(frame, &Frame { turning, class })| match turning {
        Turning::Driven {
            parent,
            actuator,
            sign,
        } => Some((
            class,
            Driven {
                frame,
                parent,
                actuator,
                sign,
                root: roots[class],
                counted: counted[frame],
            },
        )),
        _ => None,
    })
    .collect()
}

/// Those of some classes.
pub(super) fn driven(all: &[(usize, Driven)], of: impl Fn(usize) -> bool) -> Vec<Driven> {
    let picked = all.iter().filter(|(class, _)| of(*class));
    picked.map(|(_, driven)| *driven).collect()
}

impl Solved {
    /// Room for its factors: those of a tall matrix keep a factor for each column beside it.
    pub(super) fn room(&self) -> usize {
        let beside = if self.rows > self.columns {
            self.columns
        } else {
            0
        };
        self.rows * self.columns + beside
    }
}
