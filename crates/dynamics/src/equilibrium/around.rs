//! The neighbourhood of an equilibrium: its error, and the directions in which equilibria continue.

use super::at_rest::AtRest;
use super::{Equilibrium, NeutralDirection, Stability};
use crate::error::Result;
use crate::machine::MovingModel;
use crate::state_space::{eigenvalues_about, linearise_where_it_holds};

/// Below this fraction of the largest singular value the Jacobian does not decide on a direction, which is then
/// examined over a distance.
const WEAK: f64 = 1e-6;
/// This distance, relative to 1 rad or the size of the mechanism, and the fraction of it that must remain after the
/// correction if equilibria continue.
const NEUTRAL_DISTANCE: f64 = 0.02;
const REMAINING_DISTANCE: f64 = 0.5;
/// Corrections of a displaced state.
const MAX_CORRECTIONS: usize = 12;
/// The shortest distance over which a weak direction is examined.
const SHORTEST: f64 = 1e-12;
/// Steps towards the start along neutral directions, the longest of them, and the shortest that counts.
const SLIDE_STEPS: usize = 64;
const MAX_SLIDE: f64 = 0.3;
const MIN_SLIDE: f64 = 1e-12;

impl<M: MovingModel> AtRest<'_, M> {
    /// The equilibrium at the present state, which is one.
    pub(super) fn equilibrium(&mut self) -> Result<Equilibrium> {
        let factored = self.factor_here()?;
        let rounding = self.rounding()?;
        let rank = factored.rank(WEAK, 1.0);
        let mut errors = factored.largest_change(&rounding, rank);
        let mut neutral = Vec::new();
        let at = self.y.clone();
        for direction in factored.null_directions(rank) {
            if self.stays_balanced(&at, &direction, NEUTRAL_DISTANCE)? {
                neutral.push(direction[..self.free()].to_vec());
                continue;
            }
            // What rounding leaves open grows with a root of it.
            let mut distance = SHORTEST;
            while distance < NEUTRAL_DISTANCE && self.stays_balanced(&at, &direction, distance)? {
                distance *= 2.0;
            }
            let parts = errors.iter_mut().zip(&direction);
            parts.for_each(|(error, part)| *error += distance * part.abs());
        }
        self.y.copy_from_slice(&at);
        let mut state_errors = vec![0.0; self.machine.work_offset()];
        for (&j, error) in self.unknowns().iter().zip(&errors) {
            state_errors[j] = *error;
        }
        let state_space = linearise_where_it_holds(self.machine, 0.0, &at)?;
        let (eigenvalues, eigenvalue_errors) =
            eigenvalues_about(self.machine, 0.0, &at, &state_errors, &state_space)?;
        let direction = |direction| NeutralDirection {
            direction,
            extent: None,
        };
        let neutral: Vec<NeutralDirection> = neutral.into_iter().map(direction).collect();
        Ok(Equilibrium {
            stability: Stability::of(&eigenvalues, &eigenvalue_errors, neutral.len()),
            y: at,
            errors: state_errors,
            state_space,
            eigenvalues,
            eigenvalue_errors,
            neutral,
        })
    }

    /// Whether the machine is still balanced after a displacement along a direction to one side, and a correction.
    fn stays_balanced(&mut self, at: &[f64], direction: &[f64], distance: f64) -> Result<bool> {
        for side in [-distance, distance] {
            self.y.copy_from_slice(at);
            self.add_to_unknowns(side, direction);
            if self.balance_again().unwrap_or(false) {
                let unknowns = self.unknowns();
                let moved = unknowns.iter().map(|&j| self.y[j] - at[j]);
                let along: f64 = moved.zip(direction).map(|(moved, part)| moved * part).sum();
                let whole: f64 = direction.iter().map(|part| part * part).sum();
                if along / (side * whole) >= REMAINING_DISTANCE {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    fn add_to_unknowns(&mut self, factor: f64, changes: &[f64]) {
        for (&j, change) in self.unknowns().iter().zip(changes) {
            self.y[j] += factor * change;
        }
    }

    /// Corrects a state that is nearly one of equilibrium, across the weak directions; whether it then is one.
    fn balance_again(&mut self) -> Result<bool> {
        for _ in 0..MAX_CORRECTIONS {
            if self.is_balanced()? {
                return Ok(true);
            }
            let factored = self.factor_here()?;
            let step = self.correction(&factored, factored.rank(WEAK, 1.0));
            self.add_to_unknowns(1.0, &step);
        }
        self.is_balanced()
    }

    /// Moves an equilibrium along its neutral directions to the point nearest to `start`.
    pub(super) fn slide_towards(&mut self, start: &[f64]) -> Result<()> {
        for _ in 0..SLIDE_STEPS {
            let factored = self.factor_here()?;
            let directions = factored.null_directions(factored.rank(WEAK, 1.0));
            let unknowns = self.unknowns();
            let missing = unknowns.iter().map(|&j| start[j] - self.y[j]);
            let step = projection(&missing.collect::<Vec<_>>(), &directions);
            let length = step.iter().fold(0.0_f64, |max, part| max.max(part.abs()));
            if length <= MIN_SLIDE {
                return Ok(());
            }
            let before = self.y.clone();
            self.add_to_unknowns((MAX_SLIDE / length).min(1.0), &step);
            if !self.balance_again().unwrap_or(false) {
                self.y = before;
                return Ok(());
            }
        }
        Ok(())
    }
}

/// The part of a vector that lies in the span of some directions (Gram and Schmidt).
pub(super) fn projection(vector: &[f64], directions: &[Vec<f64>]) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut sum = vec![0.0; vector.len()];
    for direction in directions {
        let mut unit = direction.clone();
        for other in &basis {
            let part = dot(&unit, other);
            let parts = unit.iter_mut().zip(other);
            parts.for_each(|(unit, other)| *unit -= part * other);
        }
        let length = dot(&unit, &unit).sqrt();
        if length == 0.0 {
            continue;
        }
        unit.iter_mut().for_each(|part| *part /= length);
        let part = dot(vector, &unit);
        let parts = sum.iter_mut().zip(&unit);
        parts.for_each(|(sum, unit)| *sum += part * unit);
        basis.push(unit);
    }
    sum
}
