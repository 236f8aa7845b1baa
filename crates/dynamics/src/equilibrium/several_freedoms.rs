//! The equilibria of a machine of several free coordinates, from many starts.
//!
//! No search can prove that it has found all of them. The starts fill the ranges of the coordinates evenly, by the
//! additive sequence of Roberts (2018), the same in every run.

use super::Equilibrium;
use super::around::projection;
use super::at_rest::{AtRest, none};
use crate::error::{DynamicsError, Result};
use crate::machine::{Machine, MovingModel};
use std::f64::consts::TAU;

/// Two equilibria are equal if their coordinates differ by less than this, rad or m, in addition to their errors.
const SAME: f64 = 1e-6;
/// Steps from one equilibrium to another, between which no force must act if one continues into the other.
const WAY_STEPS: usize = 16;

/// The equilibria that Newton's method finds within the `ranges` of the free coordinates (rad or m), from the state `first`
/// and from as many more `starts` in these ranges, in the order of the coordinates. If equilibria continue along some
/// directions, the one nearest to `first` is found.
///
/// # Errors
/// [`DynamicsError::Unbalanced`] or [`DynamicsError::NoEquilibrium`] if there is none; and the error of an evaluation if
/// every start fails.
pub fn equilibria_from_starts<M: MovingModel>(
    machine: &Machine<M>,
    first: &[f64],
    ranges: &[[f64; 2]],
    starts: usize,
) -> Result<Vec<Equilibrium>> {
    machine.require_smooth("its equilibria are no points but whole regions")?;
    let mut search = Search {
        at_rest: AtRest::new(machine)?,
        first,
        ranges,
        found: Vec::new(),
    };
    let n = machine.free().len();
    let (mut forces, mut failure) = (vec![None::<[f64; 2]>; n], None);
    for k in 0..=starts {
        let mut start = first.to_vec();
        if k > 0 {
            let coordinates = start.iter_mut().zip(ranges).zip(fractions(n, k));
            coordinates.for_each(|((q, [from, to]), part)| *q = from + (to - from) * part);
        }
        match search.forces_at(&start) {
            Ok(here) => forces.iter_mut().zip(here).for_each(|(extent, force)| {
                let [low, high] = extent.unwrap_or([force; 2]);
                *extent = Some([low.min(force), high.max(force)]);
            }),
            Err(error) => {
                failure.get_or_insert(error);
                continue;
            }
        }
        if search.at_rest.solve_all().is_ok() {
            search.add()?;
        }
    }
    if search.found.is_empty() {
        return Err(cause(machine, &forces, failure));
    }
    let mut found = search.distinct()?;
    // Coordinates that differ by rounding are in no order.
    let key = |e: &Equilibrium| -> Vec<i64> {
        let coordinates = e.y[..n].iter();
        coordinates.map(|q| (q / SAME).round() as i64).collect()
    };
    found.sort_by_key(key);
    Ok(found)
}

/// Why there is no equilibrium: a force that never changes its direction, or else an evaluation that failed.
fn cause<M: MovingModel>(
    machine: &Machine<M>,
    forces: &[Option<[f64; 2]>],
    failure: Option<DynamicsError>,
) -> DynamicsError {
    let constant_sign = forces.iter().zip(machine.free()).find_map(|(force, &i)| {
        let [low, high] = (*force)?;
        (low * high > 0.0).then_some(DynamicsError::Unbalanced {
            actuator: i,
            force: [low, high],
        })
    });
    let all_failed = forces.iter().all(Option::is_none);
    match (constant_sign, failure) {
        (Some(cause), _) => cause,
        (None, Some(failure)) if all_failed => failure,
        _ => DynamicsError::NoEquilibrium {
            what: "Newton's method finds none from any start",
        },
    }
}

/// The `k`th point of the sequence in the unit cube.
fn fractions(n: usize, k: usize) -> impl Iterator<Item = f64> {
    // The positive root of x^(n + 1) = x + 1.
    let root = (0..64).fold(1.5_f64, |x, _| (1.0 + x).powf(1.0 / (n as f64 + 1.0)));
    (1..=n).map(move |j| (0.5 + k as f64 * root.powi(-(j as i32))).fract())
}

struct Search<'m, 'a, M: MovingModel> {
    at_rest: AtRest<'m, M>,
    first: &'a [f64],
    ranges: &'a [[f64; 2]],
    found: Vec<Equilibrium>,
}

impl<M: MovingModel> Search<'_, '_, M> {
    /// The static forces along the free coordinates at a start.
    fn forces_at(&mut self, start: &[f64]) -> Result<Vec<f64>> {
        self.at_rest.begin_at(start);
        self.at_rest.is_balanced()?;
        self.at_rest.count_forces()
    }

    /// Adds the equilibrium at the present state, unless it is outside the ranges or known.
    fn add(&mut self) -> Result<()> {
        if !self.move_into_ranges()? || self.is_known() || self.at_rest.has_forces()? {
            return Ok(());
        }
        let found = self.at_rest.equilibrium()?;
        if found.neutral.is_empty() {
            self.found.push(found);
            return Ok(());
        }
        self.at_rest.y.copy_from_slice(&found.y);
        self.at_rest.slide_towards(self.first)?;
        if self.move_into_ranges()? && !self.is_known() {
            let found = self.at_rest.equilibrium()?;
            self.found.push(found);
        }
        Ok(())
    }

    /// One equilibrium of those that continue into each other: of those with the most neutral directions the nearest to the start. They are
    /// several where a slide towards the start ended early, because the inertia is singular: massless gimbals in line.
    fn distinct(mut self) -> Result<Vec<Equilibrium>> {
        let mut all = std::mem::take(&mut self.found);
        let n = self.at_rest.free();
        let distance = |found: &Equilibrium| -> f64 {
            let apart = found.y[..n].iter().zip(self.first);
            apart.map(|(q, start)| (q - start) * (q - start)).sum()
        };
        all.sort_by(|one, other| {
            let by_distance = distance(one).total_cmp(&distance(other));
            let by_directions = other.neutral.len().cmp(&one.neutral.len());
            by_directions.then(by_distance)
        });
        let mut kept = Vec::new();
        for found in all {
            if !self.continues_one_of(&kept, &found)? {
                kept.push(found);
            }
        }
        Ok(kept)
    }

    /// Whether an equilibrium differs from a known one along neutral directions alone, and no force acts on the way.
    fn continues_one_of(&mut self, kept: &[Equilibrium], found: &Equilibrium) -> Result<bool> {
        let n = self.at_rest.free();
        for known in kept {
            let neutral = known.neutral.iter().chain(&found.neutral);
            let directions: Vec<Vec<f64>> = neutral.map(|n| n.direction.clone()).collect();
            let apart: Vec<f64> = (0..n).map(|k| found.y[k] - known.y[k]).collect();
            let along = projection(&apart, &directions);
            let errors = known.errors.iter().zip(&found.errors);
            let mut across = apart.iter().zip(&along).zip(errors);
            let differs = |((apart, along), (one, other)): ((&f64, &f64), (&f64, &f64))| {
                (apart - along).abs() > SAME + 4.0 * (one + other)
            };
            if known.neutral.is_empty() || across.any(differs) {
                continue;
            }
            let is_free = |k: usize| {
                self.at_rest.y.copy_from_slice(&known.y);
                let coordinates = self.at_rest.y.iter_mut().zip(&along);
                coordinates.for_each(|(q, along)| *q += along * k as f64 / WAY_STEPS as f64);
                matches!(self.at_rest.has_forces(), Ok(false))
            };
            if (1..WAY_STEPS).all(is_free) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Turns angles by whole revolutions into their ranges; whether the state is then within them, and balanced.
    fn move_into_ranges(&mut self) -> Result<bool> {
        let before = self.at_rest.y.clone();
        let model = self.at_rest.machine.model();
        for (k, (&i, &[from, to])) in self
            .at_rest
            .machine
            .free()
            .iter()
            .zip(self.ranges)
            .enumerate()
        {
            let q = &mut self.at_rest.y[k];
            if model.is_angle(i) {
                *q -= TAU * ((*q - from) / TAU).floor();
            }
            if !(from..=to).contains(q) {
                return Ok(false);
            }
        }
        Ok(self.at_rest.y == before || self.at_rest.is_balanced().unwrap_or(false))
    }

    fn is_known(&self) -> bool {
        let n = self.at_rest.free();
        let is_same = |found: &Equilibrium| {
            let pairs = found.y[..n].iter().zip(&self.at_rest.y).zip(&found.errors);
            let mut apart = pairs.map(|((a, b), error)| (a - b).abs() - 4.0 * error);
            apart.all(|apart| apart <= SAME)
        };
        self.found.iter().any(is_same)
    }
}

/// The equilibrium that Newton's method finds from a state, whatever the number of free coordinates; if equilibria continue
/// along some directions, the one nearest to that state.
///
/// # Errors
/// [`DynamicsError::NoEquilibrium`] if it finds none; and the errors of evaluations.
pub fn equilibrium_near<M: MovingModel>(machine: &Machine<M>, y: &[f64]) -> Result<Equilibrium> {
    let mut at_rest = AtRest::new(machine)?;
    if machine.free().is_empty() {
        return none("no coordinate is free");
    }
    at_rest.begin_at(y);
    at_rest.is_balanced()?;
    at_rest.count_forces()?;
    at_rest.solve_all()?;
    if at_rest.has_forces()? {
        return none(
            "Newton's method ends where the inertia grows beyond all bounds, next to a limit position or a change point",
        );
    }
    let found = at_rest.equilibrium()?;
    if found.neutral.is_empty() {
        return Ok(found);
    }
    at_rest.slide_towards(y)?;
    at_rest.equilibrium()
}
