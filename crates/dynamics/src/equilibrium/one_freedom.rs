//! All equilibria of a machine of one free coordinate over an interval.
//!
//! The acceleration and its slope are evaluated at many positions, and at further positions between them if the cubic
//! through both ends does not describe it. The zeros of the slope then divide the interval into pieces on which the
//! acceleration is monotone, so that each piece has at most one zero; a zero of both is a double zero. If the
//! acceleration is zero within rounding at several successive positions, every position between them is an equilibrium.

use super::at_rest::{AtRest, none};
use super::{Equilibrium, NeutralDirection, Stability};
use crate::error::Result;
use crate::machine::{Machine, MovingModel};
use dwell_numerics::root;
use std::f64::consts::TAU;

/// Equal parts of the interval, and how often each may be halved.
const PARTS: usize = 512;
const MAX_HALVINGS: usize = 10;
/// A part is halved where the cubic errs at its middle by more than this part of its largest value.
const CUBIC_TOLERANCE: f64 = 0.02;
/// Least number of successive positions without a force that form an interval of equilibria.
const FLAT_POSITIONS: usize = 4;
/// Bisections for its ends.
const BISECTIONS: usize = 60;
/// Zeros that are nearer than this, relative to the interval, are one.
const SAME_ZERO: f64 = 1e-13;

/// The acceleration at a position, its slope, and the size below which it counts as zero.
#[derive(Debug, Clone, Copy)]
struct Sample {
    q: f64,
    value: f64,
    slope: f64,
    zero: f64,
}

impl Sample {
    fn is_zero(&self) -> bool {
        self.value.abs() <= self.zero
    }
}

/// A zero of the acceleration: a position, or an interval.
enum Zero {
    At(f64),
    Between([f64; 2]),
}

/// All equilibria of a machine of one free coordinate between two values of it, in their order.
///
/// For a whole revolution only one end counts. An interval of equilibria is one equilibrium at its middle, with the
/// interval as its [`NeutralDirection::extent`].
///
/// # Errors
/// [`DynamicsError::NoEquilibrium`](crate::DynamicsError::NoEquilibrium) if a drive never settles; and the errors of
/// evaluations.
pub fn equilibria<M: MovingModel>(
    machine: &Machine<M>,
    [from, to]: [f64; 2],
) -> Result<Vec<Equilibrium>> {
    let mut search = Search::new(machine, [from, to])?;
    let mut zeros = search.zeros()?;
    let revolutions = (to - from) / TAU;
    let is_end = |zero: Option<&Zero>, end: f64| matches!(zero, Some(Zero::At(q)) if *q == end);
    let at_both_ends = zeros.len() > 1 && is_end(zeros.first(), from) && is_end(zeros.last(), to);
    let periodic = machine.model().range().period().is_some();
    if at_both_ends && revolutions == revolutions.round() && periodic {
        zeros.pop();
    }
    let equilibrium = |zero: Zero| {
        let (q, extent) = match zero {
            Zero::At(q) => (q, None),
            Zero::Between(extent) => (0.5 * (extent[0] + extent[1]), Some(extent)),
        };
        search.at_rest.acceleration(q)?;
        let mut found = search.at_rest.equilibrium()?;
        if extent.is_some() {
            let stability = Stability::of(&found.eigenvalues, &found.eigenvalue_errors, 1);
            found.stability = stability;
            found.neutral = vec![NeutralDirection {
                direction: vec![1.0],
                extent,
            }];
        }
        Ok(found)
    };
    zeros.into_iter().map(equilibrium).collect()
}

/// The generalised force (N·m or N) and the potential (J) of a machine of one free coordinate at rest, at each of some
/// coordinates, with the drives settled.
///
/// # Errors
/// As of [`equilibria`].
pub fn static_force_and_potential<M: MovingModel>(
    machine: &Machine<M>,
    coordinates: &[f64],
) -> Result<Vec<[f64; 2]>> {
    let mut at_rest = of_one_freedom(machine)?;
    let mut workspace = machine.workspace();
    let mut found = Vec::with_capacity(coordinates.len());
    for &q in coordinates {
        at_rest.acceleration(q)?;
        let force = at_rest.forces()?[0];
        let state = machine.evaluate(0.0, &at_rest.y, &mut workspace)?;
        let [_, potential] = state.energy();
        found.push([force, potential]);
    }
    Ok(found)
}

fn of_one_freedom<M: MovingModel>(machine: &Machine<M>) -> Result<AtRest<'_, M>> {
    let at_rest = AtRest::new(machine)?;
    match machine.free().len() {
        1 => Ok(at_rest),
        _ => none("over an interval they are found for one degree of freedom only"),
    }
}

/// The search over an interval.
struct Search<'m, M: MovingModel> {
    at_rest: AtRest<'m, M>,
    samples: Vec<Sample>,
    /// Whether friction holds at rest.
    sticks: bool,
}

impl<'m, M: MovingModel> Search<'m, M> {
    fn new(machine: &'m Machine<M>, [from, to]: [f64; 2]) -> Result<Self> {
        let mut at_rest = of_one_freedom(machine)?;
        let position = |k: usize| from + (to - from) * k as f64 / PARTS as f64;
        for k in 0..=PARTS {
            at_rest.acceleration(position(k))?;
            at_rest.count_forces()?;
        }
        let mut search = Self {
            at_rest,
            samples: Vec::with_capacity(2 * PARTS),
            sticks: machine.contact_loads().next().is_some(),
        };
        let mut before = search.sample(position(0))?;
        search.samples.push(before);
        for k in 1..=PARTS {
            let now = search.sample(position(k))?;
            search.add_until(before, now, MAX_HALVINGS)?;
            before = now;
        }
        Ok(search)
    }

    fn sample(&mut self, q: f64) -> Result<Sample> {
        let value = self.at_rest.acceleration(q)?;
        let slope = self.at_rest.acceleration_slope()?;
        let zero = self.at_rest.zero_acceleration()?;
        Ok(Sample {
            q,
            value,
            slope,
            zero,
        })
    }

    /// Adds the positions after one sample up to another, so that cubics describe the acceleration between them.
    fn add_until(&mut self, before: Sample, now: Sample, halvings: usize) -> Result<()> {
        let width = now.q - before.q;
        let middle = self.sample(before.q + 0.5 * width)?;
        let cubic = 0.5 * (before.value + now.value) + 0.125 * width * (before.slope - now.slope);
        let sizes = [
            before.value,
            now.value,
            width * before.slope,
            width * now.slope,
        ];
        let size = sizes
            .into_iter()
            .fold(middle.value.abs(), |size, s| size.max(s.abs()));
        let error = (middle.value - cubic).abs();
        if halvings == 0 || error <= (CUBIC_TOLERANCE * size).max(middle.zero) {
            self.samples.extend([middle, now]);
            return Ok(());
        }
        self.add_until(before, middle, halvings - 1)?;
        self.add_until(middle, now, halvings - 1)
    }

    /// The zeros of the acceleration, in order.
    fn zeros(&mut self) -> Result<Vec<Zero>> {
        let samples = std::mem::take(&mut self.samples);
        let (Some(&first), Some(&last)) = (samples.first(), samples.last()) else {
            return Ok(Vec::new());
        };
        let mut zeros: Vec<Zero> = Vec::new();
        let mut before: Option<Sample> = None;
        let mut rest = samples.as_slice();
        while let Some(&sample) = rest.first() {
            let run = rest.iter().take_while(|s| s.is_zero()).count();
            // Friction that holds does so in an interval, however narrow.
            if run >= FLAT_POSITIONS || run > 0 && self.sticks {
                let next = rest.get(run).copied();
                let start = self.end_of_flat(rest[0], before)?;
                let end = self.end_of_flat(rest[run - 1], next)?;
                if let Some(before) = before {
                    self.add_between(before, rest[0], &mut zeros)?;
                    zeros.retain(|zero| !matches!(zero, Zero::At(q) if *q >= start));
                }
                zeros.push(Zero::Between([start, end]));
                before = None;
                rest = &rest[run..];
                continue;
            }
            // A position that happens to be a zero says nothing of its sign; only an end counts itself.
            let is_end = sample.q == first.q || sample.q == last.q;
            rest = &rest[1..];
            if sample.is_zero() && !is_end {
                continue;
            }
            match before {
                Some(before) => self.add_between(before, sample, &mut zeros)?,
                None if sample.is_zero() => zeros.push(Zero::At(sample.q)),
                None => {}
            }
            before = Some(sample);
        }
        let same = SAME_ZERO * (last.q - first.q).abs();
        zeros.dedup_by(|next, zero| {
            matches!((next, zero), (Zero::At(a), Zero::At(b)) if (*a - *b).abs() <= same)
        });
        Ok(zeros)
    }

    /// Where an interval without force ends, between its last position and the next.
    fn end_of_flat(&mut self, flat: Sample, next: Option<Sample>) -> Result<f64> {
        let (mut inside, Some(next)) = (flat.q, next) else {
            return Ok(flat.q);
        };
        let mut outside = next.q;
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (inside + outside);
            if self.sample(middle)?.is_zero() {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        Ok(inside)
    }

    /// The interval around a position in which friction holds, between two others in which it does not.
    fn around(&mut self, inside: Sample, before: Sample, now: Sample) -> Result<Zero> {
        let start = self.end_of_flat(inside, Some(before))?;
        let end = self.end_of_flat(inside, Some(now))?;
        Ok(Zero::Between([start, end]))
    }

    /// Adds the zeros between two samples, the second one included.
    fn add_between(&mut self, before: Sample, now: Sample, zeros: &mut Vec<Zero>) -> Result<()> {
        let mut ends = vec![before];
        for q in self.zeros_of_slope(before, now)? {
            ends.push(self.sample(q)?);
        }
        ends.push(now);
        for pair in ends.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            if b.is_zero() {
                if b.q != now.q && self.sticks {
                    zeros.push(self.around(b, before, now)?);
                    return Ok(());
                }
                zeros.push(Zero::At(b.q));
            } else if !a.is_zero() && a.value * b.value < 0.0 {
                let found = root::find(|q| self.at_rest.acceleration(q), a.q, b.q)?;
                let Some(q) = found else { continue };
                let found = self.sample(q)?;
                zeros.push(if self.sticks && found.is_zero() {
                    self.around(found, before, now)?
                } else {
                    Zero::At(q)
                });
            }
        }
        Ok(())
    }

    /// The zeros of the slope of the acceleration between two samples, by its cubic.
    fn zeros_of_slope(&mut self, before: Sample, now: Sample) -> Result<Vec<f64>> {
        let width = now.q - before.q;
        let mut ends = vec![before.q, now.q];
        if before.slope * now.slope > 0.0 {
            // The slope of the cubic is a parabola; its vertex parts two zeros.
            let mean = (now.value - before.value) / width;
            let curvature = before.slope + now.slope - 2.0 * mean;
            let vertex = (2.0 * before.slope + now.slope - 3.0 * mean) / (3.0 * curvature);
            if !(vertex > 0.0 && vertex < 1.0) {
                return Ok(Vec::new());
            }
            ends.insert(1, before.q + vertex * width);
        }
        let mut found = Vec::new();
        for pair in ends.windows(2) {
            let slope = |q: f64| {
                let at_rest = &mut self.at_rest;
                at_rest.acceleration(q)?;
                at_rest.acceleration_slope()
            };
            found.extend(root::find(slope, pair[0], pair[1])?);
        }
        Ok(found)
    }
}
