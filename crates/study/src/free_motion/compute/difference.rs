//! The difference of two computations of one motion.

use crate::estimate::{error_scale, relative};
use crate::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use crate::trajectory::compute::{TrajectorySample, force_scales};
use dwell_dynamics::DynamicsError;

/// Samples at which reactions are compared, along the whole motion.
const COMPARED_SAMPLES: usize = 64;

/// The largest differences of two computations at their common sample times.
pub(crate) struct Difference {
    /// Of the free coordinates: rad, or for lengths relative to the largest change.
    pub(crate) coordinate: f64,
    /// Of the energy balance, relative to the largest kinetic energy.
    pub(crate) energy: f64,
    /// Of the reactions, relative to the largest of their unit.
    pub(crate) reactions: f64,
    /// Of the end time, relative to it.
    pub(crate) end: f64,
}

impl Difference {
    /// The largest of all.
    pub(crate) fn largest(&self) -> f64 {
        let others = [self.energy, self.reactions, self.end];
        // NaN counts as largest.
        others.into_iter().fold(self.coordinate, |largest, other| {
            if other <= largest { largest } else { other }
        })
    }

    /// The sums of both.
    pub(crate) fn plus(self, other: &Self) -> Self {
        Self {
            coordinate: self.coordinate + other.coordinate,
            energy: self.energy + other.energy,
            reactions: self.reactions + other.reactions,
            end: self.end + other.end,
        }
    }

    /// No less than this in the coordinates and the energy.
    pub(crate) fn with_minimum(self, minimum: f64) -> Self {
        Self {
            coordinate: nan_max(minimum, self.coordinate),
            energy: nan_max(minimum, self.energy),
            ..self
        }
    }

    /// All differences times a factor.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self {
            coordinate: factor * self.coordinate,
            energy: factor * self.energy,
            reactions: factor * self.reactions,
            end: factor * self.end,
        }
    }
}

impl FreeMotionProblem<'_> {
    /// The difference of a second computation from a first.
    pub(crate) fn difference(
        &self,
        one: &SegmentedMotion,
        two: &SegmentedMotion,
    ) -> Result<Difference, DynamicsError> {
        let (first, second) = (self.samples(one)?, self.samples(two)?);
        let pairs = pair_by_time(&first, &second);
        let max_abs = |of: &dyn Fn(&TrajectorySample) -> f64| {
            let values = first.iter().map(|s| of(s).abs());
            values.fold(0.0, f64::max)
        };
        let max_difference = |of: &dyn Fn(&TrajectorySample) -> f64| {
            let differences = pairs.iter().map(|(a, b)| (of(a) - of(b)).abs());
            differences.fold(0.0, nan_max)
        };
        let size = self.loaded_scene.mechanism.size();
        let mut coordinate = 0.0_f64;
        for &i in self.machine.free() {
            let value = |s: &TrajectorySample| s.coordinate(i);
            let start = first.first().map_or(0.0, value);
            let scale = match self.output_model.plan().is_angle(i) {
                true => 1.0,
                false => error_scale(max_abs(&|s| value(s) - start), size),
            };
            coordinate = nan_max(coordinate, relative(max_difference(&value), scale));
        }
        let balance = |s: &TrajectorySample| self.energy_balance(s);
        let [kinetic, potential] = [0, 1].map(|k| max_abs(&|s| s.extra_values[k]));
        let [end_one, end_two] = [one, two].map(SegmentedMotion::end_time);
        Ok(Difference {
            coordinate,
            energy: relative(max_difference(&balance), error_scale(kinetic, potential)),
            reactions: self.reaction_difference([one, two], &pairs, kinetic)?,
            end: relative((end_one - end_two).abs(), end_one.max(end_two)),
        })
    }

    fn reaction_difference(
        &self,
        [one, two]: [&SegmentedMotion; 2],
        pairs: &[(&TrajectorySample, &TrajectorySample)],
        kinetic: f64,
    ) -> Result<f64, DynamicsError> {
        let reactions = self.output_model.reactions();
        let mut differences = vec![0.0_f64; reactions.len()];
        let mut sizes = differences.clone();
        let stride = pairs.len().div_ceil(COMPARED_SAMPLES).max(1);
        for (a, b) in pairs.iter().step_by(stride) {
            let (first, second) = (self.reactions(one, a)?, self.reactions(two, b)?);
            let cells = differences.iter_mut().zip(&mut sizes);
            for ((difference, size), (v, w)) in cells.zip(first.iter().zip(&second)) {
                // Next to a change point a reaction may be undefined in both.
                if !(v.is_nan() && w.is_nan()) {
                    *difference = nan_max(*difference, (v - w).abs());
                    *size = size.max(v.abs());
                }
            }
        }
        let of_unit = |unit: &str| {
            let alike = sizes.iter().zip(reactions);
            let alike = alike.filter(|(_, s)| s.component.unit() == unit);
            alike.fold(0.0, |scale: f64, (size, _)| scale.max(*size))
        };
        // Where all of a unit are zero but for rounding, their difference is that of two roundings.
        let [force, moment] = ["N", "N m"].map(of_unit);
        let size = self.loaded_scene.mechanism.size();
        let references = force_scales(size, [force, moment], kinetic);
        let force = error_scale(force, references[0]);
        let moment = error_scale(moment, references[1]);
        let parts = differences.iter().zip(reactions).map(|(&difference, r)| {
            let scale = match r.component.unit() {
                "N" => force,
                _ => moment,
            };
            relative(difference, scale)
        });
        Ok(parts.fold(0.0, nan_max))
    }

    /// All reactions at a sample.
    fn reactions(
        &self,
        motion: &SegmentedMotion,
        sample: &TrajectorySample,
    ) -> Result<Vec<f64>, DynamicsError> {
        let chart = motion.charts.get(sample.chart);
        let model = chart.map_or(&self.output_model, |chart| &chart.output_model);
        let (mut workspace, mut results) = (model.workspace(), model.result_buffer());
        let state = model.kinematic_state(&sample.q, &sample.q_dot, &mut workspace)?;
        let mut state = state.apply_loads(sample.t)?;
        for &(load, magnitude) in &sample.drive_magnitudes {
            state.set_magnitude(load, magnitude);
        }
        state.evaluate(&sample.q_ddot, &mut results)?;
        Ok(results.reactions)
    }
}

/// The samples at common times. Next to a change point one of them may lack samples.
pub(crate) fn pair_by_time<'s>(
    one: &'s [TrajectorySample],
    two: &'s [TrajectorySample],
) -> Vec<(&'s TrajectorySample, &'s TrajectorySample)> {
    let mut others = two.iter().peekable();
    let pair = |a: &'s TrajectorySample| {
        while others.next_if(|b| b.t < a.t).is_some() {}
        others.next_if(|b| b.t == a.t).map(|b| (a, b))
    };
    one.iter().filter_map(pair).collect()
}

/// The larger of two numbers; NaN counts as larger.
fn nan_max(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}
