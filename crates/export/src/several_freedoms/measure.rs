//! The operations against the model, and the states of the self-test.

use super::description::{FreeCoordinate, SeveralFreedomsDescription};
use super::evaluator::SeveralFreedomsEvaluator;
use dwell_numerics::Real;
use dwell_numerics::StraightLine;

/// States of the self-test.
const STATES: usize = 3;
/// Terms smaller than this part of the largest of their part are rounding.
const ROUNDING_PART: f64 = 1e-9;
/// Steps of the self-test's motion, and their length, s.
pub(super) const MOTION: (usize, f64) = (100, 1e-3);

/// The largest differences of the operations from the model, relative to the largest value of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SeveralFreedomsErrors {
    /// Error of the mass matrix.
    pub mass_matrix: f64,
    /// Error of the terms of velocities.
    pub velocity_terms: f64,
    /// Error of every w and potential.
    pub loads: f64,
    /// Error of every a, b and c.
    pub reactions: f64,
    /// Error of every position.
    pub positions: f64,
}

impl SeveralFreedomsErrors {
    /// The largest of them.
    pub fn max(&self) -> f64 {
        let Self {
            mass_matrix,
            velocity_terms,
            loads,
            reactions,
            positions,
        } = *self;
        // A number that is none stays none.
        [velocity_terms, loads, reactions, positions]
            .into_iter()
            .fold(
                mass_matrix,
                |max, e| if e.is_nan() { e } else { max.max(e) },
            )
    }
}

/// A state of the self-test with its results in double precision.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledState {
    /// Coordinates, velocities, currents.
    pub y: Vec<f64>,
    /// Accelerations, reactions, kinetic and potential energy, and the forces that keep the velocities; `None` if a loose
    /// mass matrix has no accelerations.
    pub values: Option<[Vec<f64>; 4]>,
    /// The state after the motion of the self-test; `None` if it ends before.
    pub end: Option<Vec<f64>>,
    /// How far the code may be off from each of the values' lists, and from the end: parts of its largest value.
    pub tolerances: [f64; 5],
}

/// The largest absolute value.
fn largest(values: &[&[f64]]) -> f64 {
    let all = values.iter().copied().flatten();
    all.fold(f64::MIN_POSITIVE, |max, x| max.max(x.abs()))
}

/// The largest difference as a part of the largest value, or of `least` where all values are smaller.
fn largest_part<R: Real>(exact: &[&[f64]], found: &[&[R]], least: f64) -> f64 {
    let size = largest(exact).max(least);
    let pairs = exact.iter().copied().flatten();
    let pairs = pairs.zip(found.iter().copied().flatten());
    let worst = pairs.map(|(exact, found)| (found.to_f64() - exact).abs() / size);
    // A value that is no number is not lost in the maximum.
    worst.fold(0.0, |max, e| if e.is_nan() { e } else { e.max(max) })
}

/// The differences over all positions, and the first states with their tolerances.
pub(super) fn measure<R: Real, E>(
    machine: &SeveralFreedomsDescription,
    code: &[StraightLine; 3],
    positions: &[Vec<f64>],
    exact: &mut impl FnMut(&[f64]) -> Result<[Vec<f64>; 3], E>,
) -> Result<(SeveralFreedomsErrors, Vec<SampledState>), E> {
    let n = machine.freedoms();
    let pairs = machine.pairs().len();
    let mut rows: [Vec<(Vec<f64>, Vec<R>)>; 3] = Default::default();
    for q in positions {
        // The code gets the position as it can store it.
        let stored: Vec<R> = q.iter().map(|&q| R::of(q)).collect();
        let q: Vec<f64> = stored.iter().map(|q| q.to_f64()).collect();
        for ((rows, exact), code) in rows.iter_mut().zip(exact(&q)?).zip(code) {
            rows.push((exact, code.evaluate(&stored)));
        }
    }
    // What is zero but for rounding is compared with the other terms of its part.
    let least = rows.each_ref().map(|rows| {
        let exact: Vec<&[f64]> = rows.iter().map(|(exact, _)| &exact[..]).collect();
        ROUNDING_PART * largest(&exact)
    });
    let part = |kind: usize, from: usize, to: usize| {
        let exact: Vec<&[f64]> = rows[kind].iter().map(|(e, _)| &e[from..to]).collect();
        let found: Vec<&[R]> = rows[kind].iter().map(|(_, f)| &f[from..to]).collect();
        largest_part(&exact, &found, least[kind])
    };
    let (loads, all) = (pairs * (n + 1), machine.loads.len());
    let mut of_loads = 0.0_f64;
    for load in 0..all {
        let first = loads + load * n;
        of_loads = of_loads.max(part(0, first, first + n));
        let potential = loads + all * n + load;
        if machine.loads[load].effect.is_conservative() {
            of_loads = of_loads.max(part(0, potential, potential + 1));
        }
    }
    let r = machine.reactions.len();
    let mut of_reactions = 0.0_f64;
    let by_load = (0..all).map(|load| (n + pairs + load, n + pairs + load + 1));
    for (from, to) in [(0, n), (n, n + pairs)].into_iter().chain(by_load) {
        of_reactions = of_reactions.max(part(1, from * r, to * r));
    }
    let errors = SeveralFreedomsErrors {
        mass_matrix: part(0, 0, pairs),
        velocity_terms: part(0, pairs, loads),
        loads: of_loads,
        reactions: of_reactions,
        positions: part(2, 0, 2 * machine.points.len()),
    };
    Ok((errors, states::<R>(machine, code, positions)))
}

/// States at the first positions, the initial state first.
fn states<R: Real>(
    machine: &SeveralFreedomsDescription,
    code: &[StraightLine; 3],
    positions: &[Vec<f64>],
) -> Vec<SampledState> {
    let initial = machine.coordinates.iter().map(|c| c.initial[0]).collect();
    let exact = SeveralFreedomsEvaluator::<f64>::new(machine, code);
    let evaluator = SeveralFreedomsEvaluator::<R>::new(machine, code);
    let others = positions.iter().take(STATES - 1).cloned();
    let all = std::iter::once(initial).chain(others).enumerate();
    all.map(|(k, q)| {
        // Of the others, some velocities that differ.
        let velocity = |(i, c): (usize, &FreeCoordinate)| match k {
            0 => c.initial[1],
            _ => 0.5 * (1.3 * k as f64 + 0.7 * i as f64).sin(),
        };
        let velocities = machine.coordinates.iter().enumerate().map(velocity);
        let mut y: Vec<f64> = q.into_iter().chain(velocities).collect();
        y.resize(evaluator.order(), 0.05);
        let stored: Vec<R> = y.iter().map(|&x| R::of(x)).collect();
        let y = stored.iter().map(|x| x.to_f64()).collect();
        sampled(&exact, y, &evaluator, &stored)
    })
    .collect()
}

fn sampled<R: Real>(
    exact: &SeveralFreedomsEvaluator<'_, f64>,
    y: Vec<f64>,
    evaluator: &SeveralFreedomsEvaluator<'_, R>,
    stored: &[R],
) -> SampledState {
    let values = values(exact, &y);
    let (exact, found) = (end(exact, &y), end(evaluator, stored));
    // Another compiler's functions differ in the last digit, and what it multiplies is not small everywhere.
    let least = 4096.0 * rounding::<R>();
    let mut tolerances = [least; 5];
    if let (Some(exact), Some(found)) = (&values, self::values(evaluator, stored)) {
        for ((tolerance, exact), found) in tolerances.iter_mut().zip(exact).zip(&found) {
            *tolerance = least.max(4.0 * largest_part(&[exact], &[found], 0.0));
        }
    }
    if let (Some(exact), Some(found)) = (&exact, &found) {
        tolerances[4] = least.max(4.0 * largest_part(&[exact], &[found], 0.0));
    }
    SampledState {
        y,
        values,
        end: exact.filter(|_| found.is_some()),
        tolerances,
    }
}

/// The distance from one to the next number.
fn rounding<R: Real>() -> f64 {
    let halves = (1..64).map(|k| 0.5_f64.powi(k));
    let above = halves.take_while(|&h| (R::of(1.0) + R::of(h)).to_f64() > 1.0);
    above.last().unwrap_or(1.0)
}

/// Accelerations, reactions, energies and the forces that keep the velocities.
fn values<R: Real>(evaluator: &SeveralFreedomsEvaluator<'_, R>, y: &[R]) -> Option<[Vec<R>; 4]> {
    let rates = evaluator.rates(y).ok()?;
    let n = evaluator.freedoms();
    let q_ddot = &rates[n..2 * n];
    Some([
        q_ddot.to_vec(),
        evaluator.reactions(y, q_ddot).ok()?,
        evaluator.energies(y).ok()?.to_vec(),
        evaluator.required_forces(y, &vec![R::of(0.0); n]).ok()?,
    ])
}

fn end<R: Real>(evaluator: &SeveralFreedomsEvaluator<'_, R>, y: &[R]) -> Option<Vec<R>> {
    let mut y = y.to_vec();
    for _ in 0..MOTION.0 {
        evaluator.step(R::of(MOTION.1), &mut y).ok()?;
    }
    Some(y)
}
