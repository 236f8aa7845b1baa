//! Errors of the reduced parameters of exported runs from printed digits and interpolation.

use super::combine::ExportedRuns;
use super::sampled_model::{SampleInterpolation, SampledModel};
use dwell_kinetostatics::Coefficients;
use std::f64::consts::FRAC_2_PI;

/// Estimated errors relative to the largest value: of m, of ½m′, of any a, of any b.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SampleErrors {
    /// By the printed digits.
    pub digits: [f64; 4],
    /// By the interpolation of run ii onto the positions of run i.
    pub resampling: [f64; 4],
    /// By the interpolation between the positions.
    pub interpolation: [f64; 4],
}

impl SampleErrors {
    /// All together.
    pub fn sum(&self, k: usize) -> f64 {
        self.digits[k] + self.resampling[k] + self.interpolation[k]
    }

    /// The errors of a model through the positions of two runs.
    pub fn of(runs: &ExportedRuns, interpolation: SampleInterpolation) -> Self {
        let fine = SampledModel::new(runs, interpolation, 1);
        let coarse = SampledModel::new(runs, interpolation, 2);
        let reactions = runs.reactions.len();
        // Half the distance has a quarter and a sixteenth of the error; of few positions up to four times that was measured.
        let share = match interpolation {
            SampleInterpolation::Linear => 1.0 / 2.0,
            SampleInterpolation::Cubic => 1.0 / 4.0,
            SampleInterpolation::Trigonometric => 0.0,
        };
        let tails = fine.tails();
        // Between equal distances a trigonometric series enlarges errors of its values by its Lebesgue constant at most.
        let enlarged = match interpolation {
            SampleInterpolation::Trigonometric => 1.0 + FRAC_2_PI * (runs.q.len() as f64).ln(),
            SampleInterpolation::Linear | SampleInterpolation::Cubic => 1.0,
        };
        let rounding = printed_errors(runs);
        let resampling = all_of(&runs.resampling);
        let width = rounding.len();
        let (mut largest, mut differences) = (vec![0.0_f64; width], vec![0.0_f64; width]);
        let last = runs.q.len() - 1 + usize::from(runs.is_whole_revolution);
        for (k, (q, at)) in runs.q.iter().zip(&runs.coefficients).enumerate() {
            let row = all_of(at);
            let between = (k % 2 == 1 && k < last)
                .then(|| coarse.values(*q).ok())
                .flatten();
            for (i, value) in row.iter().enumerate() {
                largest[i] = largest[i].max(value.abs());
                if let Some(between) = &between {
                    differences[i] = differences[i].max((between[i] - value).abs());
                }
            }
        }
        // A coefficient that nearly vanishes has the scale of its kind.
        let kinds = [0..1, 1..2, 2..2 + reactions, 2 + reactions..width];
        let mut errors = Self::default();
        for (kind, range) in kinds.into_iter().enumerate() {
            let scale = largest[range.clone()]
                .iter()
                .copied()
                .fold(f64::MIN_POSITIVE, f64::max);
            for i in range {
                // What lies beyond the last coefficients is nearly as much again (measured: 1.3 times them).
                let between = share * differences[i] + 2.0 * tails[i];
                errors.digits[kind] = errors.digits[kind].max(enlarged * rounding[i] / scale);
                errors.resampling[kind] =
                    errors.resampling[kind].max(enlarged * resampling[i] / scale);
                errors.interpolation[kind] = errors.interpolation[kind].max(between / scale);
            }
        }
        errors
    }
}

/// m, ½m′, every a, every b.
pub(super) fn all_of(c: &Coefficients) -> Vec<f64> {
    let rest = c.a.iter().chain(&c.b).copied();
    [c.m, c.half_dm].into_iter().chain(rest).collect()
}

/// The error of each coefficient from printed digits: of forces and motions, and of positions.
fn printed_errors(runs: &ExportedRuns) -> Vec<f64> {
    let mut rounding = all_of(&runs.rounding);
    let rows = runs.coefficients.windows(2).zip(runs.q.windows(2));
    for (coefficients, q) in rows {
        let (one, other) = (all_of(&coefficients[0]), all_of(&coefficients[1]));
        let per_position = runs.position_rounding / (q[1] - q[0]);
        for (rounding, (one, other)) in rounding.iter_mut().zip(one.into_iter().zip(other)) {
            *rounding = rounding.max(((other - one) * per_position).abs());
        }
    }
    rounding
}
