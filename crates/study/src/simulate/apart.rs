//! How far two computations of one motion are apart.

use super::{Free, Moved};
use crate::run::Sample;
use dwell_dynamics::DynamicsError;
use dwell_kinetostatics::Model;

/// Samples at which reactions are compared, along the whole motion.
const COMPARED: usize = 64;

/// The largest differences of two computations at the times that both were sampled at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Apart {
    /// Of the free coordinates: in rad, and of lengths as a part of the largest change.
    pub(super) coordinate: f64,
    /// Of the energy balance, as a part of the largest kinetic energy.
    pub(super) energy: f64,
    /// Of the reactions, as a part of the largest of their unit.
    pub(super) reactions: f64,
    /// Of the end, as a part of the whole time.
    pub(super) end: f64,
}

impl Apart {
    /// The largest of all.
    pub(super) fn worst(&self) -> f64 {
        let others = [self.energy, self.reactions, self.end];
        // What is no number is not near.
        others.into_iter().fold(
            self.coordinate,
            |worst, other| {
                if other <= worst { worst } else { other }
            },
        )
    }

    /// So many times as far.
    pub(super) fn times(self, factor: f64) -> Self {
        Self {
            coordinate: factor * self.coordinate,
            energy: factor * self.energy,
            reactions: factor * self.reactions,
            end: factor * self.end,
        }
    }
}

impl Free<'_> {
    /// How far the second of two computations is from the first.
    pub(super) fn apart(&self, one: &Moved, two: &Moved) -> Result<Apart, DynamicsError> {
        let (first, second) = (self.samples(one)?, self.samples(two)?);
        let pairs = first.iter().zip(&second);
        let pairs: Vec<(&Sample, &Sample)> = pairs.take_while(|(a, b)| a.t == b.t).collect();
        let largest = |of: &dyn Fn(&Sample) -> f64| {
            let values = first.iter().map(|s| of(s).abs());
            values.fold(0.0, f64::max)
        };
        let most = |of: &dyn Fn(&Sample) -> f64| {
            let apart = pairs.iter().map(|(a, b)| (of(a) - of(b)).abs());
            apart.fold(0.0, larger)
        };
        let mut coordinate = 0.0_f64;
        for &i in self.machine.free() {
            let value = |s: &Sample| s.own.map_or(s.q[i], |own| own[0]);
            let start = first.first().map_or(0.0, value);
            let scale = match self.shown.plan().is_angle(i) {
                true => 1.0,
                false => largest(&|s| value(s) - start),
            };
            coordinate = larger(coordinate, part(most(&value), scale));
        }
        let sum = 2 + self.machine.workers().len();
        let balance = |s: &Sample| s.told.get(sum).copied().unwrap_or(0.0);
        let kinetic = largest(&|s| s.told.first().copied().unwrap_or(0.0));
        let ends = [one, two].map(Moved::end);
        Ok(Apart {
            coordinate,
            energy: part(most(&balance), kinetic),
            reactions: self.reactions_apart(one, two, &pairs)?,
            end: part((ends[0] - ends[1]).abs(), ends[0].max(ends[1])),
        })
    }

    fn reactions_apart(
        &self,
        one: &Moved,
        two: &Moved,
        pairs: &[(&Sample, &Sample)],
    ) -> Result<f64, DynamicsError> {
        let units: Vec<&str> = self
            .shown
            .reactions()
            .iter()
            .map(|r| r.component.unit())
            .collect();
        let mut most = vec![0.0_f64; units.len()];
        let mut largest = most.clone();
        let every = pairs.len().div_ceil(COMPARED).max(1);
        for (a, b) in pairs.iter().step_by(every) {
            let (here, there) = (self.reactions(one, a)?, self.reactions(two, b)?);
            for (k, (here, there)) in here.iter().zip(&there).take(units.len()).enumerate() {
                // Next to a change point a reaction may have no value in either.
                if !(here.is_nan() && there.is_nan()) {
                    most[k] = larger(most[k], (here - there).abs());
                    largest[k] = largest[k].max(here.abs());
                }
            }
        }
        let parts = most.iter().zip(&units).map(|(&most, unit)| {
            let alike = largest
                .iter()
                .zip(&units)
                .filter(|(_, other)| *other == unit);
            part(most, alike.fold(0.0, |size, (value, _)| size.max(*value)))
        });
        Ok(parts.fold(0.0, larger))
    }

    /// All reactions at a sample.
    fn reactions(&self, moved: &Moved, sample: &Sample) -> Result<Vec<f64>, DynamicsError> {
        let shown: &Model = moved
            .charts
            .get(sample.chart)
            .map_or(&self.shown, |chart| &chart.shown);
        let (mut work, mut actions) = (shown.workspace(), shown.actions());
        for &(load, magnitude) in &sample.given {
            work.give(load, magnitude);
        }
        let Sample {
            t,
            q,
            q_dot,
            q_ddot,
            ..
        } = sample;
        shown.kinetostatics(*t, q, q_dot, q_ddot, &mut work, &mut actions)?;
        Ok(actions.reactions)
    }
}

/// The larger of two, of which one that is no number is the larger.
fn larger(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

/// A part of a scale; of nothing, nothing is off.
fn part(off: f64, scale: f64) -> f64 {
    if off == 0.0 { 0.0 } else { off / scale }
}
