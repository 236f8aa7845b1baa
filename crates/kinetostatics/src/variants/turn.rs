//! The turns of variants, several poses side by side.

use super::search::{Samples, TurnSearch};
use super::{LoadedModel, TurningVariant, VariantModel};
use crate::model::{Model, Workspace};
use crate::pass::InverseDynamics;
use crate::reduced::{Coefficients, LANES, LaneScalar, LaneWork};
use dwell_numerics::Lanes;

/// The variants of a model, one after another in one thread.
pub(super) struct Turns<'a> {
    pub(super) of: &'a VariantModel,
    pub(super) variants: std::ops::Range<usize>,
    pub(super) fill: &'a mut dyn FnMut(usize, &mut [f64]) -> f64,
    pub(super) done: &'a mut dyn FnMut(usize, Option<TurningVariant<'_>>),
}

impl LaneWork for Turns<'_> {
    type Output = ();

    // One call of `sample` only: it contains the whole evaluation.
    #[inline(always)]
    fn run<S: LaneScalar>(self) {
        let mut model = self.of.model.clone();
        let mut sampler = LaneSampler::<S>::new(&model);
        let mut pose = model.plan().pose();
        let loaded = self.of.loaded.clone();
        let first_curve = TurnSearch::first_force(model.reactions().len());
        let mut loaded = loaded.map(|of| LoadedVariant::new(of, first_curve));
        let forces = loaded.as_ref().map_or(0, LoadedVariant::force_count);
        let mut search = TurnSearch::new(model.reactions().len(), forces);
        let mut numbers = vec![0.0; self.of.number_count()];
        let inertial = self.of.inertial_numbers();
        for variant in self.variants {
            let start = (self.fill)(variant, &mut numbers);
            let (of_inertia, of_loads) = numbers.split_at(inertial);
            let fits = model.set_numbers(of_inertia)
                && loaded
                    .as_mut()
                    .is_none_or(|loaded| loaded.set_numbers(of_inertia, of_loads))
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
                let of_loads = loaded.as_mut();
                unfinished = sampler.sample(&model, &mut search.samples)
                    && of_loads.is_none_or(|loaded| loaded.sample(&mut search.samples))
                    && search.advance();
            }
            let turning = search.turn().filter(|_| fits);
            let loaded = loaded.as_ref().map(|loaded| &loaded.of.model);
            let turning = turning.map(|turn| TurningVariant { turn, loaded });
            (self.done)(variant, turning);
        }
    }
}

/// A variant under loads, with working memory for poses side by side: in two registers, since the evaluation under loads
/// is not compiled for wider ones.
struct LoadedVariant {
    of: LoadedModel,
    workspace: Workspace<Lanes<LANES>>,
    forces: InverseDynamics<Lanes<LANES>>,
    /// Curves of the search before those of the forces.
    first_curve: usize,
}

impl LoadedVariant {
    fn new(of: LoadedModel, first_curve: usize) -> Self {
        Self {
            workspace: of.model.workspace(),
            forces: of.model.result_buffer(),
            first_curve,
            of,
        }
    }

    /// How many forces there are over the turn: that of the actuator, and the reactions.
    fn force_count(&self) -> usize {
        let wanted = self.of.velocity.is_some();
        usize::from(wanted) * (1 + self.of.model.reactions().len())
    }

    fn set_numbers(&mut self, of_inertia: &[f64], of_loads: &[f64]) -> bool {
        let model = &mut self.of.model;
        if !(model.set_numbers(of_inertia) && model.loads.set_numbers(of_loads, &model.masses)) {
            return false;
        }
        self.workspace.states.set_dimensions(model.plan());
        true
    }

    /// Evaluates the forces that the samples ask for; false where there is none.
    #[inline(never)]
    fn sample(&mut self, samples: &mut Samples) -> bool {
        let Some(velocity) = self.of.velocity else {
            return true;
        };
        let [velocity, rest] = [velocity, 0.0].map(|v| [Lanes([v; LANES])]);
        for first in (0..samples.q.len()).step_by(LANES) {
            let q = [Lanes(samples.lanes_at(first))];
            let (workspace, forces) = (&mut self.workspace, &mut self.forces);
            let model = &self.of.model;
            if (model.kinetostatics(0.0, &q, &velocity, &rest, workspace, forces)).is_err() {
                return false;
            }
            let each = self.forces.tau.iter().chain(&self.forces.reactions);
            for (k, force) in each.enumerate() {
                let force = force.to_array();
                // A spring of no length has no direction.
                if !force.iter().all(|force| force.is_finite()) {
                    return false;
                }
                samples.set(self.first_curve + k, first, force);
            }
        }
        true
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
            let q = samples.lanes_at(first);
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
