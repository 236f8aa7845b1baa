//! The order in which a mechanism is solved. Each equation is matched with one unknown it can
//! determine; equations that need each other's unknowns form a *group* (an Assur group), solved
//! together, after the groups it depends on. Matching and components are iterative: a chain of
//! ten thousand loops must not overflow the stack.

use crate::error::StructureError;
use crate::frames::Frames;
use crate::lower::Lowered;
use crate::relation::Row;
use crate::tree::{Loop, Tree};
use std::collections::VecDeque;

/// An unknown of the position problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Unknown {
    /// The angle of a class of bodies (never class 0).
    Class(usize),
    /// The travel of a slide that nothing drives.
    Slide(usize),
}

/// Unknowns that are solved together, and the equations that determine them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// The unknowns.
    pub unknowns: Vec<Unknown>,
    /// Indices of the loops.
    pub loops: Vec<usize>,
    /// Indices of the relations.
    pub relations: Vec<usize>,
    /// Number of equations: more than unknowns where some only repeat what others say.
    pub rows: usize,
}

/// An equation, or one of a loop's two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Equation {
    Loop(usize),
    Relation(usize),
}

const NONE: usize = usize::MAX;

/// The parts from which the order is found.
pub(crate) struct Parts<'a> {
    pub(crate) lowered: &'a Lowered,
    pub(crate) frames: &'a Frames,
    pub(crate) tree: &'a Tree,
    pub(crate) loops: &'a [Loop],
    pub(crate) relations: &'a [Row],
    /// By slide: the actuator that drives it.
    pub(crate) driven: &'a [Option<usize>],
}

/// Orders the equations into groups. With `repeated`, equations without an unknown of their own
/// are taken to repeat what those say on which they depend, and are solved together with them.
///
/// # Errors
/// [`StructureError::UnderDriven`] and [`StructureError::OverConstrained`] when unknowns and
/// equations do not match one to one.
pub(crate) fn order(parts: &Parts<'_>, repeated: bool) -> Result<Vec<Group>, StructureError> {
    let (equations, needs, also) = parts.equations();
    let classes = parts.frames.classes - 1;
    let unknowns = classes + parts.tree.slides.len();
    let (of_equation, of_unknown) = match_up(&needs, unknowns);
    let driven = |u: usize| u >= classes && parts.driven[u - classes].is_some();
    let free: Vec<usize> = (0..unknowns)
        .filter(|&u| of_unknown[u] == NONE && !driven(u))
        .collect();
    let surplus: Vec<usize> = (0..equations.len())
        .filter(|&e| of_equation[e] == NONE)
        .collect();
    if !surplus.is_empty() && !repeated {
        let owners = surplus.iter().map(|&e| match equations[e] {
            Equation::Loop(l) => parts.lowered.bonds[parts.loops[l].bond].owner,
            Equation::Relation(r) => parts.relations[r].owner,
        });
        let (joints, actuators) = Lowered::owners(owners);
        return Err(StructureError::OverConstrained {
            excess: surplus.len(),
            joints,
            actuators,
        });
    }
    if !free.is_empty() {
        let bodies = free.iter().flat_map(|&u| parts.bodies_of(u));
        return Err(StructureError::UnderDriven {
            dof: parts.lowered.drives.len() + free.len(),
            actuators: parts.lowered.drives.len(),
            bodies: parts.lowered.named(bodies),
            twice: Vec::new(),
        });
    }
    // What an equation is evaluated with comes before it, even if it does not depend on it.
    let mut before = needs.clone();
    for (before, also) in before.iter_mut().zip(also) {
        before.extend(also);
    }
    let groups = components(&of_equation, &before, &of_unknown);
    let groups = absorb(groups, &surplus, &needs, &of_unknown);
    let as_unknown = |u: usize| {
        if u < classes {
            Unknown::Class(u + 1)
        } else {
            Unknown::Slide(u - classes)
        }
    };
    let group = |members: Vec<usize>| {
        let rows = members.len();
        let mut unknowns: Vec<Unknown> = members
            .iter()
            .filter(|&&e| of_equation[e] != NONE)
            .map(|&e| as_unknown(of_equation[e]))
            .collect();
        unknowns.sort_unstable();
        let (mut loops, mut relations) = (Vec::new(), Vec::new());
        for e in members {
            match equations[e] {
                Equation::Loop(l) => loops.push(l),
                Equation::Relation(r) => relations.push(r),
            }
        }
        loops.sort_unstable();
        loops.dedup();
        relations.sort_unstable();
        Group {
            unknowns,
            loops,
            relations,
            rows,
        }
    };
    Ok(groups.into_iter().map(group).collect())
}

impl Parts<'_> {
    /// Every equation; the unknowns it depends on: classes first (class c is number c − 1), then
    /// slides; and the classes with which it is evaluated, though their angle cancels.
    fn equations(&self) -> (Vec<Equation>, Vec<Vec<usize>>, Vec<Vec<usize>>) {
        let (mut equations, mut needs, mut also) = (Vec::new(), Vec::new(), Vec::new());
        for (l, one) in self.loops.iter().enumerate() {
            let (unknowns, cancelled) = self.unknowns_of(one);
            // Two equations for a loop, one where it closes along a normal only.
            if one.axis.is_none() {
                equations.push(Equation::Loop(l));
                needs.push(unknowns.clone());
                also.push(Vec::new());
            }
            equations.push(Equation::Loop(l));
            needs.push(unknowns);
            also.push(cancelled);
        }
        for (r, row) in self.relations.iter().enumerate() {
            equations.push(Equation::Relation(r));
            let classes: Vec<usize> = row.classes(self.frames).iter().map(|c| c - 1).collect();
            let named = row.frames().map(|f| self.frames.frames[f].class);
            let named = named.filter(|&c| c > 0).map(|c| c - 1);
            also.push(named.filter(|c| !classes.contains(c)).collect());
            let slides = row.slides().into_iter();
            let slides = slides.filter(|&s| self.driven[s].is_none());
            let slides = slides.map(|s| self.frames.classes - 1 + s);
            needs.push(classes.into_iter().chain(slides).collect());
        }
        (equations, needs, also)
    }

    fn unknowns_of(&self, one: &Loop) -> (Vec<usize>, Vec<usize>) {
        let class = |frame: usize| self.frames.frames[frame].class;
        let turned = one.arms.iter().map(|a| a.frame);
        let slid = one.slides.iter().map(|(_, a)| a.frame);
        let mut found: Vec<usize> = turned
            .chain(slid)
            .chain(one.axis.iter().map(|a| a.frame))
            .map(class)
            .filter(|&c| c > 0)
            .map(|c| c - 1)
            .collect();
        found.sort_unstable();
        found.dedup();
        // Turning everything together leaves the distance from the axis as it is: where one
        // class is all that is left, nothing of it can be determined by the loop.
        let all_one_class = one.axis.is_some_and(|axis| {
            let same = |frame: usize| class(frame) == class(axis.frame);
            one.arms.iter().all(|a| same(a.frame)) && one.slides.iter().all(|(_, a)| same(a.frame))
        });
        let mut cancelled = Vec::new();
        if all_one_class {
            std::mem::swap(&mut found, &mut cancelled);
        }
        let slides = one.slides.iter().map(|&(s, _)| s);
        found.extend(
            slides
                .filter(|&s| self.driven[s].is_none())
                .map(|s| self.frames.classes - 1 + s),
        );
        (found, cancelled)
    }

    /// The bodies that an unknown moves.
    fn bodies_of(&self, u: usize) -> Vec<usize> {
        let classes = self.frames.classes - 1;
        if u < classes {
            self.frames.members[u + 1].clone()
        } else {
            bodies_of_slide(self.tree, u - classes)
        }
    }
}

/// The bodies that a slide carries itself.
pub(crate) fn bodies_of_slide(tree: &Tree, slide: usize) -> Vec<usize> {
    let carried = tree.carries.iter();
    carried
        .filter(|c| c.slide.is_some_and(|(s, _)| s == slide))
        .map(|c| c.body)
        .collect()
}

/// Adds each surplus equation to the group of everything that it depends on.
fn absorb(
    groups: Vec<Vec<usize>>,
    surplus: &[usize],
    needs: &[Vec<usize>],
    of_unknown: &[usize],
) -> Vec<Vec<usize>> {
    if surplus.is_empty() {
        return groups;
    }
    // By equation: the surplus equation whose group it joins.
    let mut joins = vec![NONE; needs.len()];
    for &start in surplus {
        let mut reached = vec![start];
        let mut queue = vec![start];
        let mut seen = vec![false; needs.len()];
        seen[start] = true;
        while let Some(e) = queue.pop() {
            for other in needs[e].iter().map(|&u| of_unknown[u]) {
                if !std::mem::replace(&mut seen[other], true) {
                    reached.push(other);
                    queue.push(other);
                }
            }
        }
        let others: Vec<usize> = reached.iter().map(|&e| joins[e]).collect();
        for join in &mut joins {
            if *join != NONE && others.contains(join) {
                *join = start;
            }
        }
        for e in reached {
            joins[e] = start;
        }
    }
    // The whole depends on nothing outside it, so it can come where its first part does.
    let mut order: Vec<Vec<usize>> = Vec::new();
    let mut place: Vec<Option<usize>> = vec![None; needs.len()];
    for group in groups {
        match joins[group[0]] {
            NONE => order.push(group),
            join => match place[join] {
                Some(at) => order[at].extend(group),
                None => {
                    place[join] = Some(order.len());
                    order.push(group);
                }
            },
        }
    }
    for &e in surplus {
        match place[joins[e]] {
            Some(at) => order[at].push(e),
            // An equation that depends on no unknown at all: a group of its own.
            None => {
                place[joins[e]] = Some(order.len());
                order.push(vec![e]);
            }
        }
    }
    order
}

/// Matches equations with unknowns, by augmenting paths found breadth first.
fn match_up(needs: &[Vec<usize>], unknowns: usize) -> (Vec<usize>, Vec<usize>) {
    let mut of_equation = vec![NONE; needs.len()];
    let mut of_unknown = vec![NONE; unknowns];
    let mut seen = vec![NONE; unknowns];
    let mut from = vec![NONE; unknowns];
    let mut queue = VecDeque::new();
    for start in 0..needs.len() {
        queue.clear();
        queue.push_back(start);
        let mut end = NONE;
        'search: while let Some(e) = queue.pop_front() {
            for &u in &needs[e] {
                if seen[u] == start {
                    continue;
                }
                seen[u] = start;
                from[u] = e;
                if of_unknown[u] == NONE {
                    end = u;
                    break 'search;
                }
                queue.push_back(of_unknown[u]);
            }
        }
        while end != NONE {
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
fn components(
    of_equation: &[usize],
    needs: &[Vec<usize>],
    of_unknown: &[usize],
) -> Vec<Vec<usize>> {
    let n = needs.len();
    let mut index = vec![NONE; n];
    let mut low = vec![0; n];
    let mut on_stack = vec![false; n];
    let mut stack = Vec::new();
    let mut path: Vec<(usize, usize)> = Vec::new();
    let mut next = 0;
    let mut groups = Vec::new();
    for root in 0..n {
        if index[root] != NONE || of_equation[root] == NONE {
            continue;
        }
        path.push((root, 0));
        while let Some(&mut (e, ref mut step)) = path.last_mut() {
            if *step == 0 && index[e] == NONE {
                index[e] = next;
                low[e] = next;
                next += 1;
                stack.push(e);
                on_stack[e] = true;
            }
            if let Some(&u) = needs[e].get(*step) {
                *step += 1;
                let other = of_unknown[u];
                if index[other] == NONE {
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
