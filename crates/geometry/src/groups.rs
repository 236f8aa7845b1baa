//! The order in which a mechanism is solved. Each equation is matched with one unknown it can
//! determine; equations that need each other's unknowns form a *group* (an Assur group), solved
//! together, after the groups it depends on. Matching and components are iterative: a chain of
//! ten thousand loops must not overflow the stack.

use crate::error::StructureError;
use crate::frames::Frames;
use crate::mechanism::{BodyId, JointId, Mechanism};
use crate::tree::{Loop, Tree};
use std::collections::VecDeque;

/// An unknown of the position problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Unknown {
    /// The angle of a class of bodies (never class 0).
    Class(usize),
    /// The travel of a prismatic joint of the tree.
    Slide(usize),
}

/// Unknowns that are solved together, and the loops that determine them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Group {
    /// The unknowns.
    pub(crate) unknowns: Vec<Unknown>,
    /// Indices of the loops.
    pub(crate) loops: Vec<usize>,
}

const NONE: usize = usize::MAX;

/// Orders the loops into groups.
///
/// # Errors
/// [`StructureError::UnderDriven`] and [`StructureError::OverConstrained`] when unknowns and
/// equations do not match one to one.
pub(crate) fn order(
    mechanism: &Mechanism,
    frames: &Frames,
    tree: &Tree,
    loops: &[Loop],
) -> Result<Vec<Group>, StructureError> {
    let classes = frames.classes - 1;
    let unknowns = classes + tree.slides;
    // Two equations for a revolute chord, one for a prismatic chord (the angle is no unknown).
    let mut equations: Vec<usize> = Vec::new();
    for (l, one) in loops.iter().enumerate() {
        equations.push(l);
        if one.axis.is_none() {
            equations.push(l);
        }
    }
    let needs: Vec<Vec<usize>> = loops.iter().map(|l| unknowns_of(l, frames)).collect();
    let (of_equation, of_unknown) = match_up(&equations, &needs, unknowns);

    let named = |u: usize| -> Vec<BodyId> {
        if u < classes {
            bodies_of_class(frames, u + 1)
        } else {
            tree.carries
                .iter()
                .filter(|c| c.slide.is_some_and(|(s, _)| s == u - classes))
                .map(|c| c.body)
                .collect()
        }
    };
    let free: Vec<usize> = (0..unknowns).filter(|&u| of_unknown[u] == NONE).collect();
    let surplus: Vec<JointId> = (0..equations.len())
        .filter(|&e| of_equation[e] == NONE)
        .map(|e| loops[equations[e]].joint)
        .collect();
    if !surplus.is_empty() {
        let mut joints = surplus.clone();
        joints.dedup();
        return Err(StructureError::OverConstrained {
            excess: surplus.len(),
            joints,
            actuators: Vec::new(),
        });
    }
    if !free.is_empty() {
        return Err(StructureError::UnderDriven {
            dof: mechanism.actuators.len() + free.len(),
            actuators: mechanism.actuators.len(),
            bodies: free.iter().flat_map(|&u| named(u)).collect(),
        });
    }

    let as_unknown = |u: usize| {
        if u < classes {
            Unknown::Class(u + 1)
        } else {
            Unknown::Slide(u - classes)
        }
    };
    let groups = components(&equations, &needs, &of_unknown);
    Ok(groups
        .into_iter()
        .map(|members| {
            let mut loops: Vec<usize> = members.iter().map(|&e| equations[e]).collect();
            loops.sort_unstable();
            loops.dedup();
            let mut unknowns: Vec<Unknown> = members
                .iter()
                .map(|&e| as_unknown(of_equation[e]))
                .collect();
            unknowns.sort_unstable();
            Group { unknowns, loops }
        })
        .collect())
}

/// The bodies of a class.
pub(crate) fn bodies_of_class(frames: &Frames, class: usize) -> Vec<BodyId> {
    frames
        .attitudes
        .iter()
        .enumerate()
        .filter(|(_, a)| frames.frames[a.frame].class == class)
        .map(|(b, _)| BodyId(b))
        .collect()
}

/// The unknowns a loop depends on: classes first (class c is number c − 1), then slides.
fn unknowns_of(one: &Loop, frames: &Frames) -> Vec<usize> {
    let class = |frame: usize| frames.frames[frame].class;
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
        one.arms.iter().all(|a| class(a.frame) == class(axis.frame))
            && one
                .slides
                .iter()
                .all(|(_, a)| class(a.frame) == class(axis.frame))
    });
    if all_one_class {
        found.clear();
    }
    found.extend(one.slides.iter().map(|&(s, _)| frames.classes - 1 + s));
    found
}

/// Matches equations with unknowns, by augmenting paths found breadth first.
fn match_up(
    equations: &[usize],
    needs: &[Vec<usize>],
    unknowns: usize,
) -> (Vec<usize>, Vec<usize>) {
    let mut of_equation = vec![NONE; equations.len()];
    let mut of_unknown = vec![NONE; unknowns];
    let mut seen = vec![NONE; unknowns];
    let mut from = vec![NONE; unknowns];
    let mut queue = VecDeque::new();
    for start in 0..equations.len() {
        queue.clear();
        queue.push_back(start);
        let mut end = NONE;
        'search: while let Some(e) = queue.pop_front() {
            for &u in &needs[equations[e]] {
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
fn components(equations: &[usize], needs: &[Vec<usize>], of_unknown: &[usize]) -> Vec<Vec<usize>> {
    let n = equations.len();
    let mut index = vec![NONE; n];
    let mut low = vec![0; n];
    let mut on_stack = vec![false; n];
    let mut stack = Vec::new();
    let mut path: Vec<(usize, usize)> = Vec::new();
    let mut next = 0;
    let mut groups = Vec::new();
    for root in 0..n {
        if index[root] != NONE {
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
            if let Some(&u) = needs[equations[e]].get(*step) {
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
