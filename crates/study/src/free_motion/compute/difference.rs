//! The difference of two computations of one motion.

use crate::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::DynamicsError;
use dwell_kinetostatics::Model;

/// Samples at which reactions are compared, along the whole motion.
const COMPARED_SAMPLES: usize = 64;

/// The largest differences of two computations at their common sample times.
#[derive(Debug, Clone, Copy, PartialEq)]
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
        let mut coordinate = 0.0_f64;
        for &i in self.machine.free() {
            let value = |s: &TrajectorySample| {
                s.actuator_coordinate
                    .map_or(s.q[i], |derivatives| derivatives[0])
            };
            let start = first.first().map_or(0.0, value);
            let scale = match self.output_model.plan().is_angle(i) {
                true => 1.0,
                false => max_abs(&|s| value(s) - start),
            };
            coordinate = nan_max(coordinate, relative_to(max_difference(&value), scale));
        }
        let balance_index = 2 + self.machine.nonconservative_sources().len();
        let balance =
            |s: &TrajectorySample| s.extra_values.get(balance_index).copied().unwrap_or(0.0);
        let kinetic = max_abs(&|s| s.extra_values.first().copied().unwrap_or(0.0));
        let end_times = [one, two].map(SegmentedMotion::end_time);
        Ok(Difference {
            coordinate,
            energy: relative_to(max_difference(&balance), kinetic),
            reactions: self.reaction_difference(one, two, &pairs)?,
            end: relative_to(
                (end_times[0] - end_times[1]).abs(),
                end_times[0].max(end_times[1]),
            ),
        })
    }

    fn reaction_difference(
        &self,
        one: &SegmentedMotion,
        two: &SegmentedMotion,
        pairs: &[(&TrajectorySample, &TrajectorySample)],
    ) -> Result<f64, DynamicsError> {
        let units: Vec<&str> = self
            .output_model
            .reactions()
            .iter()
            .map(|r| r.component.unit())
            .collect();
        let mut max_differences = vec![0.0_f64; units.len()];
        let mut max_values = max_differences.clone();
        let stride = pairs.len().div_ceil(COMPARED_SAMPLES).max(1);
        for (a, b) in pairs.iter().step_by(stride) {
            let (values_one, values_two) = (self.reactions(one, a)?, self.reactions(two, b)?);
            for (k, (values_one, values_two)) in values_one
                .iter()
                .zip(&values_two)
                .take(units.len())
                .enumerate()
            {
                // Next to a change point a reaction may be undefined in both.
                if !(values_one.is_nan() && values_two.is_nan()) {
                    max_differences[k] =
                        nan_max(max_differences[k], (values_one - values_two).abs());
                    max_values[k] = max_values[k].max(values_one.abs());
                }
            }
        }
        let parts = max_differences
            .iter()
            .zip(&units)
            .map(|(&max_differences, unit)| {
                let alike = max_values
                    .iter()
                    .zip(&units)
                    .filter(|(_, other)| *other == unit);
                relative_to(
                    max_differences,
                    alike.fold(0.0, |size, (value, _)| size.max(*value)),
                )
            });
        Ok(parts.fold(0.0, nan_max))
    }

    /// All reactions at a sample.
    fn reactions(
        &self,
        motion: &SegmentedMotion,
        sample: &TrajectorySample,
    ) -> Result<Vec<f64>, DynamicsError> {
        let output_model: &Model = motion
            .charts
            .get(sample.chart)
            .map_or(&self.output_model, |chart| &chart.output_model);
        let (mut workspace, mut inverse_dynamics) =
            (output_model.workspace(), output_model.result_buffer());
        let state = output_model.kinematic_state(&sample.q, &sample.q_dot, &mut workspace)?;
        let mut state = state.apply_loads(sample.t)?;
        for &(load, magnitude) in &sample.drive_magnitudes {
            state.set_magnitude(load, magnitude);
        }
        state.evaluate(&sample.q_ddot, &mut inverse_dynamics)?;
        Ok(inverse_dynamics.reactions)
    }
}

/// The samples at common times. Next to a change point one of them may lack samples.
fn pair_by_time<'s>(
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

/// A difference relative to a scale; 0 if the difference is 0, whatever the scale.
fn relative_to(difference: f64, scale: f64) -> f64 {
    if difference == 0.0 {
        0.0
    } else {
        difference / scale
    }
}
