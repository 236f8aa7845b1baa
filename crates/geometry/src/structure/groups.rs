//! The order in which a mechanism is solved. Each equation is matched with one unknown it can
//! determine; equations that need each other's unknowns form a *group* (an Assur group), solved
//! together, after the groups it depends on. Matching and components are iterative: a chain of
//! ten thousand loops must not overflow the stack.

use crate::error::StructureError;
use crate::structure::coupling::CouplingEquation;
use crate::structure::frames::Frames;
use crate::structure::lower::Lowered;
use crate::structure::tree::{LoopJoint, Tree};
use std::collections::VecDeque;

/// An unknown of the position problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Unknown {
    /// The angle of a class of bodies (never class 0).
    ClassAngle(usize),
    /// The travel of a slide that nothing drives.
    SlideTravel(usize),
}

/// Unknowns that are solved together, and the equations that determine them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// The unknowns.
    pub unknowns: Vec<Unknown>,
    /// Indices of the loops.
    pub loops: Vec<usize>,
    /// Indices of the couplings.
    pub couplings: Vec<usize>,
    /// Number of equations: more than unknowns where some are redundant.
    pub rows: usize,
}

impl Group {
    /// Whether the angle of a class is among the unknowns.
    pub(crate) fn contains_class(&self, class: usize) -> bool {
        self.unknowns.contains(&Unknown::ClassAngle(class))
    }

    /// The classes whose angles are unknowns.
    pub(crate) fn classes(&self) -> impl Iterator<Item = usize> {
        self.unknowns.iter().filter_map(|u| match *u {
            Unknown::ClassAngle(class) => Some(class),
            Unknown::SlideTravel(_) => None,
        })
    }

    /// Whether all unknowns are angles.
    pub(crate) fn is_rotational(&self) -> bool {
        self.classes().count() == self.unknowns.len()
    }
}

/// An equation, or one of a loop's two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Equation {
    Loop(usize),
    Coupling(usize),
}

const UNMATCHED: usize = usize::MAX;

/// The parts from which the order is found.
pub(crate) struct PositionProblem<'a> {
    pub(crate) lowered: &'a Lowered,
    pub(crate) frames: &'a Frames,
    pub(crate) tree: &'a Tree,
    pub(crate) loops: &'a [LoopJoint],
    pub(crate) couplings: &'a [CouplingEquation],
    /// By slide: the actuator that drives it.
    pub(crate) actuated_slides: &'a [Option<usize>],
}

/// Orders the equations into groups. With `allow_redundant`, equations without an unknown of their own
/// are taken as redundant to those they depend on, and are solved together with them.
///
/// # Errors
/// [`StructureError::UnderActuated`] and [`StructureError::OverConstrained`] when unknowns and
/// equations do not match one to one.
pub(crate) fn order_groups(
    problem: &PositionProblem<'_>,
    allow_redundant: bool,
) -> Result<Vec<Group>, StructureError> {
    let (equations, dependencies, evaluated_with) = problem.equations();
    let classes = problem.frames.orientation_classes - 1;
    let unknowns = classes + problem.tree.slide_pairs.len();
    let (of_equation, of_unknown) = match_equations(&dependencies, unknowns);
    let is_actuated = |u: usize| u >= classes && problem.actuated_slides[u - classes].is_some();
    let is_undetermined = |&u: &usize| of_unknown[u] == UNMATCHED && !is_actuated(u);
    let undetermined: Vec<usize> = (0..unknowns).filter(is_undetermined).collect();
    let is_redundant = |&e: &usize| of_equation[e] == UNMATCHED;
    let redundant: Vec<usize> = (0..equations.len()).filter(is_redundant).collect();
    if !redundant.is_empty() && !allow_redundant {
        let owners = redundant.iter().map(|&e| match equations[e] {
            Equation::Loop(l) => problem.lowered.pairs[problem.loops[l].pair].owner,
            Equation::Coupling(r) => problem.couplings[r].owner,
        });
        return Err(Lowered::over_constrained(&owners.collect::<Vec<_>>()));
    }
    if !undetermined.is_empty() {
        return Err(problem.under_actuated(&undetermined));
    }
    // Classes with which an equation is evaluated come before it, even if it does not depend on them.
    let mut before = dependencies.clone();
    for (before, evaluated_with) in before.iter_mut().zip(evaluated_with) {
        before.extend(evaluated_with);
    }
    let blocks = strong_components(&of_equation, &before, &of_unknown);
    let groups = absorb_redundant(blocks, &redundant, &equations, &dependencies, &of_unknown);
    let group = |members: Vec<usize>| {
        let rows = members.len();
        let matched = members.iter().map(|&e| of_equation[e]);
        let matched = matched.filter(|&u| u != UNMATCHED);
        let mut unknowns: Vec<Unknown> = matched.map(|u| problem.unknown(u)).collect();
        unknowns.sort_unstable();
        let (mut loops, mut couplings) = (Vec::new(), Vec::new());
        for e in members {
            match equations[e] {
                Equation::Loop(l) => loops.push(l),
                Equation::Coupling(r) => couplings.push(r),
            }
        }
        loops.sort_unstable();
        loops.dedup();
        couplings.sort_unstable();
        Group {
            unknowns,
            loops,
            couplings,
            rows,
        }
    };
    Ok(groups.into_iter().map(group).collect())
}

impl PositionProblem<'_> {
    /// The error of unknowns that no equation determines.
    fn under_actuated(&self, undetermined: &[usize]) -> StructureError {
        let actuators = self.lowered.actuated_coordinates.len();
        let unknowns = undetermined.iter().map(|&u| self.unknown(u));
        let bodies = unknowns.flat_map(|u| bodies_of(self.frames, self.tree, u));
        StructureError::UnderActuated {
            degrees_of_freedom: actuators + undetermined.len(),
            actuators,
            bodies: self.lowered.mechanism_bodies(bodies),
            redundant_joints: Vec::new(),
        }
    }

    /// Every equation; the unknowns it depends on: classes first (class c is number c − 1), then
    /// slides; and the classes with which it is evaluated, though their angle cancels.
    fn equations(&self) -> (Vec<Equation>, Vec<Vec<usize>>, Vec<Vec<usize>>) {
        let (mut equations, mut dependencies, mut evaluated_with) =
            (Vec::new(), Vec::new(), Vec::new());
        for (l, one) in self.loops.iter().enumerate() {
            let (unknowns, cancelled) = self.unknowns_of(one);
            // Two equations for a loop, one where it closes along a normal only.
            if one.axis.is_none() {
                equations.push(Equation::Loop(l));
                dependencies.push(unknowns.clone());
                evaluated_with.push(Vec::new());
            }
            equations.push(Equation::Loop(l));
            dependencies.push(unknowns);
            evaluated_with.push(cancelled);
        }
        for (r, coupling) in self.couplings.iter().enumerate() {
            equations.push(Equation::Coupling(r));
            let classes = coupling.classes(self.frames);
            let mut unknowns: Vec<usize> = classes.iter().map(|c| c - 1).collect();
            let named = self.class_unknowns(coupling.frames());
            evaluated_with.push(named.filter(|c| !unknowns.contains(c)).collect());
            unknowns.extend(self.slide_unknowns(coupling.slides()));
            dependencies.push(unknowns);
        }
        (equations, dependencies, evaluated_with)
    }

    fn unknowns_of(&self, one: &LoopJoint) -> (Vec<usize>, Vec<usize>) {
        let vectors = one.vectors.iter().chain(one.slides.iter().map(|(_, a)| a));
        let frames = || vectors.clone().chain(&one.axis).map(|a| a.frame);
        let mut found: Vec<usize> = self.class_unknowns(frames()).collect();
        found.sort_unstable();
        found.dedup();
        // A common rotation does not change the distance from the axis: a loop of one class alone cannot determine
        // its angle.
        let class = |frame: usize| self.frames.frames[frame].orientation_class;
        let all_one_class =
            (one.axis).is_some_and(|axis| frames().all(|frame| class(frame) == class(axis.frame)));
        let mut cancelled = Vec::new();
        if all_one_class {
            std::mem::swap(&mut found, &mut cancelled);
        }
        found.extend(self.slide_unknowns(one.slides.iter().map(|&(s, _)| s)));
        (found, cancelled)
    }

    /// The unknowns, by number, that are the angles of some frames.
    fn class_unknowns(&self, frames: impl Iterator<Item = usize>) -> impl Iterator<Item = usize> {
        let classes = frames.map(|f| self.frames.frames[f].orientation_class);
        classes.filter(|&c| c > 0).map(|c| c - 1)
    }

    /// The unknowns, by number, among the travels of some slides.
    fn slide_unknowns(
        &self,
        slides: impl IntoIterator<Item = usize>,
    ) -> impl Iterator<Item = usize> {
        let free = slides
            .into_iter()
            .filter(|&s| self.actuated_slides[s].is_none());
        free.map(|s| self.frames.orientation_classes - 1 + s)
    }

    /// An unknown by its number: classes first (class c is number c − 1), then slides.
    fn unknown(&self, u: usize) -> Unknown {
        match u.checked_sub(self.frames.orientation_classes - 1) {
            None => Unknown::ClassAngle(u + 1),
            Some(slide) => Unknown::SlideTravel(slide),
        }
    }
}

/// The bodies whose angles an unknown determines, or that a slide connects with their parents.
pub(crate) fn bodies_of(frames: &Frames, tree: &Tree, unknown: Unknown) -> Vec<usize> {
    match unknown {
        Unknown::ClassAngle(class) => frames.class_bodies[class].clone(),
        Unknown::SlideTravel(slide) => {
            let slides = tree.joints.iter();
            let slides = slides.filter(|c| c.slide.is_some_and(|(s, _)| s == slide));
            slides.map(|c| c.body).collect()
        }
    }
}

/// Adds each redundant equation to the group of everything that it depends on.
fn absorb_redundant(
    groups: Vec<Vec<usize>>,
    redundant: &[usize],
    equations: &[Equation],
    dependencies: &[Vec<usize>],
    of_unknown: &[usize],
) -> Vec<Vec<usize>> {
    if redundant.is_empty() {
        return groups;
    }
    // By equation: the redundant equation whose group it joins.
    let mut joins = vec![UNMATCHED; dependencies.len()];
    for &start in redundant {
        let (mut reached, mut queue) = (vec![start], vec![start]);
        let mut visited = vec![false; dependencies.len()];
        visited[start] = true;
        while let Some(e) = queue.pop() {
            for other in dependencies[e].iter().map(|&u| of_unknown[u]) {
                if !std::mem::replace(&mut visited[other], true) {
                    reached.push(other);
                    queue.push(other);
                }
            }
        }
        let others: Vec<usize> = reached.iter().map(|&e| joins[e]).collect();
        for join in &mut joins {
            if *join != UNMATCHED && others.contains(join) {
                *join = start;
            }
        }
        for e in reached {
            joins[e] = start;
        }
    }
    // Equations that depend on no unknown at all, as of a pin that is written twice: a group for each loop.
    for &e in redundant {
        if e > 0 && equations[e - 1] == equations[e] && dependencies[e].is_empty() {
            joins[e] = joins[e - 1];
        }
    }
    // The whole depends on nothing outside it, so it can come where its first part does.
    let mut order: Vec<Vec<usize>> = Vec::new();
    let mut position: Vec<Option<usize>> = vec![None; dependencies.len()];
    for group in groups.into_iter().chain(redundant.iter().map(|&e| vec![e])) {
        match joins[group[0]] {
            UNMATCHED => order.push(group),
            join => match position[join] {
                Some(at) => order[at].extend(group),
                None => {
                    position[join] = Some(order.len());
                    order.push(group);
                }
            },
        }
    }
    order
}

/// Matches equations with unknowns, by augmenting paths found breadth first.
pub(crate) fn match_equations(
    dependencies: &[Vec<usize>],
    unknowns: usize,
) -> (Vec<usize>, Vec<usize>) {
    let mut of_equation = vec![UNMATCHED; dependencies.len()];
    let mut of_unknown = vec![UNMATCHED; unknowns];
    let mut visited = vec![UNMATCHED; unknowns];
    let mut from = vec![UNMATCHED; unknowns];
    let mut queue = VecDeque::new();
    for start in 0..dependencies.len() {
        queue.clear();
        queue.push_back(start);
        let mut end = UNMATCHED;
        'search: while let Some(e) = queue.pop_front() {
            for &u in &dependencies[e] {
                if visited[u] == start {
                    continue;
                }
                visited[u] = start;
                from[u] = e;
                if of_unknown[u] == UNMATCHED {
                    end = u;
                    break 'search;
                }
                queue.push_back(of_unknown[u]);
            }
        }
        while end != UNMATCHED {
            let e = from[end];
            let next = of_equation[e];
            of_equation[e] = end;
            of_unknown[end] = e;
            end = next;
        }
    }
    (of_equation, of_unknown)
}

/// Strongly connected components of "this equation needs the unknown that one determines",
/// dependencies first (Tarjan 1972, with the recursion on an explicit stack).
pub(crate) fn strong_components(
    of_equation: &[usize],
    dependencies: &[Vec<usize>],
    of_unknown: &[usize],
) -> Vec<Vec<usize>> {
    let n = dependencies.len();
    let mut index = vec![UNMATCHED; n];
    let mut low = vec![0; n];
    let mut on_stack = vec![false; n];
    let mut stack = Vec::new();
    let mut path: Vec<(usize, usize)> = Vec::new();
    let mut next = 0;
    let mut groups = Vec::new();
    for root in 0..n {
        if index[root] != UNMATCHED || of_equation[root] == UNMATCHED {
            continue;
        }
        path.push((root, 0));
        while let Some(&mut (e, ref mut step)) = path.last_mut() {
            if *step == 0 && index[e] == UNMATCHED {
                index[e] = next;
                low[e] = next;
                next += 1;
                stack.push(e);
                on_stack[e] = true;
            }
            if let Some(&u) = dependencies[e].get(*step) {
                *step += 1;
                let other = of_unknown[u];
                if index[other] == UNMATCHED {
                    path.push((other, 0));
                } else if on_stack[other] {
                    low[e] = low[e].min(index[other]);
                }
                continue;
            }
            path.pop();
            if let Some(&(caller, _)) = path.last() {
                low[caller] = low[caller].min(low[e]);
            }
            if low[e] == index[e] {
                let mut group = Vec::new();
                while let Some(member) = stack.pop() {
                    on_stack[member] = false;
                    group.push(member);
                    if member == e {
                        break;
                    }
                }
                groups.push(group);
            }
        }
    }
    groups
}
