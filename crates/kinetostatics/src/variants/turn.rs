//! The turns of variants, several poses side by side.

use super::VariantModel;
use super::search::{Samples, TurnSearch};
use crate::model::{Model, Workspace};
use crate::reduced::{Coefficients, LANES, LaneScalar, LaneWork};

/// The variants of a model, one after another in one thread.
pub(super) struct Turns<'a> {
    pub(super) of: &'a VariantModel,
    pub(super) variants: std::ops::Range<usize>,
    pub(super) fill: &'a mut dyn FnMut(usize, &mut [f64]) -> f64,
    pub(super) done: &'a mut dyn FnMut(usize, Option<&super::Turn>),
}

impl LaneWork for Turns<'_> {
    type Output = ();

    // One call of `sample` only: it contains the whole evaluation.
    #[inline(always)]
    fn run<S: LaneScalar>(self) {
        let mut model = self.of.model.clone();
        let mut sampler = LaneSampler::<S>::new(&model);
        let mut pose = model.plan().pose();
        let mut search = TurnSearch::new(model.reactions().len());
        let bodies = super::PER_BODY * model.masses().len();
        let mut numbers = vec![0.0; model.plan().dimension_count() + bodies];
        for variant in self.variants {
            let start = (self.fill)(variant, &mut numbers);
            let fits = model.set_numbers(&numbers)
                && matches!(
                    model
                        .pass_model
                        .plan
                        .keeps_assembly_modes(&self.of.guess, &mut pose),
                    Ok(true)
                );
            search.restart(start);
            let mut unfinished = fits;
            while unfinished {
                unfinished = sampler.sample(&model, &mut search.samples) && search.advance();
            }
            (self.done)(variant, search.turn().filter(|_| fits));
        }
    }
}

/// Working memory of poses side by side.
struct LaneSampler<S> {
    workspace: Workspace<S>,
    coefficients: Coefficients<S>,
}

impl<S: LaneScalar> LaneSampler<S> {
    fn new(model: &Model) -> Self {
        Self {
            workspace: model.workspace(),
            coefficients: model.coefficient_buffer(),
        }
    }

    /// Evaluates what the samples ask for; false where there is no pose.
    #[inline(always)]
    fn sample(&mut self, model: &Model, samples: &mut Samples) -> bool {
        for first in (0..samples.q.len()).step_by(LANES) {
            let last = samples.q.len() - 1;
            let q = std::array::from_fn(|lane| samples.q[last.min(first + lane)]);
            let out = &mut self.coefficients;
            let evaluated = model.reduce(S::from_array(q), &mut self.workspace, out);
            if evaluated.is_err() {
                return false;
            }
            let (m, half_dm) = (out.m, out.half_dm);
            let inverse = S::from_f64(1.0) / m;
            samples.set(0, first, m.to_array());
            samples.set(1, first, half_dm.to_array());
            for (k, (&a, &b)) in out.a.iter().zip(&out.b).enumerate() {
                // R = a q̈ + b q̇² with q̈ = −½m′ q̇²/m and q̇² = 2E/m, over 2E.
                let free = (b - a * half_dm * inverse) * inverse;
                samples.set(2 + k, first, free.to_array());
            }
            self.clearance(model, first, samples);
        }
        true
    }

    /// The least square of a determinant over its slope, rad²: how far the tangents of the determinants are from zero.
    #[inline(always)]
    fn clearance(&self, model: &Model, first: usize, samples: &mut Samples) {
        let plan = model.plan();
        let mut least = [f64::INFINITY; LANES];
        for group in 0..plan.group_count() {
            let [value, slope] =
                plan.determinant_and_slope(group, &self.workspace.pose, &self.workspace.motion);
            let squares = (value * value / (slope * slope)).to_array();
            for (least, square) in least.iter_mut().zip(squares) {
                // What is no number is not clear either.
                if square < *least || square.is_nan() {
                    *least = square;
                }
            }
        }
        samples.set_clearance(first, least);
    }
}
