//! Groups of equations that are solved together. The independent rows are matched with unknowns; strongly connected components,
//! in order, are the groups, and each redundant row joins the group of its last unknown.

use super::closure::Closure;
use super::mechanism::Mechanism;
use super::plan::{Plan, Pose};
use super::rod::Rod;
use super::tree::{FreedomKind, Step};
use crate::error::AssemblyError;
use crate::structure::groups::{match_equations, strong_components};
use std::ops::Range;

/// An entry of a group's matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Inner {
    /// Its index in the matrix.
    pub(super) at: usize,
    /// Which entry of the Jacobian it is.
    pub(super) entry: usize,
    pub(super) scale: f64,
}

/// An entry of a group's rows that belongs to a freedom of another group or of an actuator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Outer {
    pub(super) row: usize,
    pub(super) entry: usize,
    pub(super) freedom: usize,
}

/// Unknowns that are solved together.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Group {
    pub(super) unknowns: Vec<usize>,
    /// By closure, and the row's number in it.
    pub(super) rows: Vec<(usize, usize)>,
    /// By row: its number among all.
    pub(super) residuals: Vec<usize>,
    /// Each closure with the range of its rows in this group; they follow each other.
    pub(super) closures: Vec<(usize, Range<usize>)>,
    /// Bodies on its loops that depend on its unknowns.
    pub(super) links: Vec<usize>,
    /// Links with a ball among the unknowns, and the position of its first freedom among them.
    pub(super) balls: Vec<(usize, usize)>,
    pub(super) inner: Vec<Inner>,
    /// The indices without an entry of the matrix.
    pub(super) zeros: Vec<usize>,
    pub(super) outer: Vec<Outer>,
    /// The data of the closed form, if the group is a rod.
    pub(super) rod: Option<Rod>,
    pub(super) row_scales: Vec<f64>,
    pub(super) column_scales: Vec<f64>,
    /// Start of its factors, and of the data of their columns.
    pub(super) factors: usize,
    pub(super) columns: usize,
}

impl Group {
    /// Whether it has as many equations as unknowns; otherwise some are redundant.
    #[inline(always)]
    pub(super) fn is_square(&self) -> bool {
        self.rows.len() == self.unknowns.len()
    }
}

impl Plan {
    /// The unit in which a freedom is measured: the size of the mechanism for translations.
    pub(super) fn unit(&self, freedom: usize) -> f64 {
        match self.tree.freedoms[freedom] {
            FreedomKind::Slide | FreedomKind::Length => self.size,
            FreedomKind::Turn | FreedomKind::Screw(_) | FreedomKind::BallTurn => 1.0,
        }
    }

    /// The factor that makes a row dimensionless.
    pub(super) fn row_scale(&self, (c, k): (usize, usize)) -> f64 {
        if self.closures[c].kinds[k].is_length() {
            1.0 / self.size
        } else {
            1.0
        }
    }

    /// The freedoms that no actuator drives.
    pub(super) fn unknowns(&self) -> Vec<usize> {
        let driven = |f: &usize| self.drivers.iter().any(|d| d.freedom == *f);
        (0..self.tree.freedoms.len())
            .filter(|f| !driven(f))
            .collect()
    }

    /// All rows, by closure and number.
    pub(super) fn all_rows(&self) -> Vec<(usize, usize)> {
        let closures = self.closures.iter().enumerate();
        closures
            .flat_map(|(c, closure)| (0..closure.kinds.len()).map(move |k| (c, k)))
            .collect()
    }

    /// A group of these unknowns and rows; the links are added by [`Plan::schedule`].
    pub(super) fn group(&self, mut unknowns: Vec<usize>, rows: Vec<(usize, usize)>) -> Group {
        unknowns.sort_unstable();
        let n = unknowns.len();
        let residual = |&(c, k): &(usize, usize)| self.closures[c].rows.start + k;
        let mut group = Group {
            residuals: rows.iter().map(residual).collect(),
            row_scales: rows.iter().map(|r| self.row_scale(*r)).collect(),
            column_scales: unknowns.iter().map(|f| self.unit(*f)).collect(),
            ..Group::default()
        };
        for (i, &(c, k)) in rows.iter().enumerate() {
            match group.closures.last_mut() {
                Some((last, rows)) if *last == c => rows.end = i + 1,
                _ => group.closures.push((c, i..i + 1)),
            }
            let closure: &Closure = &self.closures[c];
            for (p, &(freedom, _)) in closure.path.iter().enumerate() {
                if !closure.is_moved(k, p) {
                    continue;
                }
                let entry = closure.entries + k * closure.path.len() + p;
                match unknowns.binary_search(&freedom) {
                    Ok(j) => group.inner.push(Inner {
                        at: i * n + j,
                        entry,
                        scale: group.row_scales[i] * group.column_scales[j],
                    }),
                    Err(_) => group.outer.push(Outer {
                        row: i,
                        entry,
                        freedom,
                    }),
                }
            }
        }
        let is_zero = |at: &usize| group.inner.iter().all(|inner| inner.at != *at);
        group.zeros = (0..rows.len() * n).filter(is_zero).collect();
        for (l, link) in self.tree.links.iter().enumerate() {
            for step in &link.steps {
                if let Step::Ball(_, first) = *step
                    && let Ok(at) = unknowns.binary_search(&first)
                {
                    group.balls.push((l, at));
                }
            }
        }
        (group.unknowns, group.rows) = (unknowns, rows);
        group
    }

    /// Sets the groups, with the places of their factors and the links that each one moves.
    pub(super) fn schedule(&mut self, mut groups: Vec<Group>) {
        let mut level = vec![0; self.tree.links.len()];
        for (l, link) in self.tree.links.iter().enumerate() {
            let before = self.tree.link_of[link.parent].map_or(0, |p| level[p]);
            let of = |f: usize| {
                let group = groups.iter().position(|g| g.unknowns.contains(&f));
                group.map_or(0, |g| g + 1)
            };
            level[l] = link.freedoms.clone().map(of).max().unwrap_or(0).max(before);
        }
        let (mut factors, mut columns) = (0, 0);
        let mut placed: Vec<bool> = level.iter().map(|l| *l == 0).collect();
        self.first_links = (0..level.len()).filter(|l| placed[*l]).collect();
        for (g, group) in groups.iter_mut().enumerate() {
            (group.factors, group.columns) = (factors, columns);
            factors += group.rows.len() * group.unknowns.len();
            columns += group.unknowns.len();
            let mut needed = vec![false; level.len()];
            for &(c, _) in &group.rows {
                for body in self.closures[c].bodies {
                    let mut body = body;
                    while let Some(link) = self.tree.link_of[body] {
                        needed[link] = true;
                        body = self.tree.links[link].parent;
                    }
                }
            }
            group.links = (0..level.len())
                .filter(|l| needed[*l] && !placed[*l] && level[*l] <= g + 1)
                .collect();
            group.links.iter().for_each(|l| placed[*l] = true);
        }
        self.last_links = (0..level.len()).filter(|l| !placed[*l]).collect();
        self.groups = groups;
    }

    /// The freedoms between the ground and a body.
    fn freedoms_above(&self, mut body: usize) -> Vec<usize> {
        let mut freedoms = Vec::new();
        while let Some(link) = self.tree.link_of[body] {
            freedoms.extend(self.tree.links[link].freedoms.clone());
            body = self.tree.links[link].parent;
        }
        freedoms
    }

    /// Replaces the single group of all unknowns by the groups of the structure, in order, after idle freedoms are held.
    ///
    /// # Errors
    /// [`AssemblyError`] where the freedoms are not those of the actuators, or the position is singular.
    pub(super) fn find_groups(
        &mut self,
        mechanism: &Mechanism,
        start: Pose,
    ) -> Result<Pose, AssemblyError> {
        let analysed = self.analyse(mechanism, start)?;
        self.mobility = analysed.mobility;
        let unknowns = self.unknowns();
        let position = |f: &usize| unknowns.binary_search(f).ok();
        let rows = self.all_rows();
        // By row: the unknowns on its path, and those of them that move it. What a row is evaluated with has to be placed before it,
        // whether it moves the row or not.
        let on_path = |only_moving: bool| -> Vec<Vec<usize>> {
            let of_row = |&(c, k): &(usize, usize)| {
                let closure = &self.closures[c];
                let path = closure.path.iter().enumerate();
                let path = path.filter(|(p, _)| !only_moving || closure.is_moved(k, *p));
                path.filter_map(|(_, (f, _))| position(f)).collect()
            };
            rows.iter().map(of_row).collect()
        };
        let (dependencies, moving) = (on_path(false), on_path(true));
        // Beyond its path, what carries the whole loop moves no row, but has to be placed before it, too.
        let carried = |(&(c, _), of_row): (&(usize, usize), &Vec<usize>)| {
            let bodies = self.closures[c].bodies;
            let above = bodies.map(|body| self.freedoms_above(body));
            let above = above.iter().flatten().filter_map(position);
            of_row.iter().copied().chain(above).collect()
        };
        let placed: Vec<Vec<usize>> = rows.iter().zip(&dependencies).map(carried).collect();
        let independent: Vec<usize> = analysed.independent;
        let chosen = |of: &[Vec<usize>]| -> Vec<Vec<usize>> {
            independent.iter().map(|r| of[*r].clone()).collect()
        };
        let (of_equation, of_unknown) = match_equations(&chosen(&moving), unknowns.len());
        let components = strong_components(&of_equation, &chosen(&placed), &of_unknown);
        let members = |equations: Vec<usize>| -> Members {
            let matched = equations.iter().map(|e| unknowns[of_equation[*e]]);
            let rows = equations.iter().map(|e| rows[independent[*e]]);
            (matched.collect(), rows.collect())
        };
        let mut groups: Vec<Members> = components.into_iter().map(members).collect();
        let redundant = (0..rows.len()).filter(|r| !independent.contains(r));
        for r in redundant.filter(|r| !moving[*r].is_empty()) {
            let of_row: Vec<usize> = dependencies[r].iter().map(|u| unknowns[*u]).collect();
            add_redundant(&mut groups, rows[r], &of_row);
        }
        let groups = groups.into_iter().map(|(unknowns, rows)| {
            let mut group = self.group(unknowns, rows);
            group.rod = self.rod(&group);
            group
        });
        let groups = groups.collect();
        self.schedule(groups);
        let mut pose = self.pose();
        pose.coordinates.copy_from_slice(&analysed.pose.coordinates);
        pose.balls.copy_from_slice(&analysed.pose.balls);
        Ok(pose)
    }
}

/// The unknowns of a group and its rows, by closure and number.
type Members = (Vec<usize>, Vec<(usize, usize)>);

/// Adds a redundant row to the last of the groups on whose unknowns it depends.
fn add_redundant(groups: &mut [Members], row: (usize, usize), unknowns: &[usize]) {
    let depends = |g: &Members| unknowns.iter().any(|u| g.0.contains(u));
    if let Some(last) = groups.iter().rposition(depends) {
        groups[last].1.push(row);
        groups[last].1.sort_unstable();
    }
}
