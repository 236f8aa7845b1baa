//! The turns of variants, several poses side by side.

use super::search::{Samples, TurnSearch, largest_lane, sum_of_lanes};
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
        search.has_means = self.of.has_means;
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
                    && search.advance::<S>();
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

    /// The number of forces over the turn: that of the actuator, and the reactions.
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

    /// Evaluates the forces at the requested samples; returns false if there is none.
    #[inline(never)]
    fn sample(&mut self, samples: &mut Samples) -> bool {
        let Some(velocity) = self.of.velocity else {
            return true;
        };
        let [velocity, rest] = [velocity, 0.0].map(|v| [Lanes([v; LANES])]);
        for first in (0..samples.positions().len()).step_by(LANES) {
            let q = [Lanes::load(&samples.positions()[first..])];
            let (workspace, forces) = (&mut self.workspace, &mut self.forces);
            let model = &self.of.model;
            if (model.kinetostatics(0.0, &q, &velocity, &rest, workspace, forces)).is_err() {
                return false;
            }
            let each = self.forces.tau.iter().chain(&self.forces.reactions);
            for (k, force) in each.enumerate() {
                // A spring of no length has no direction.
                if !force.0.iter().all(|force| force.is_finite()) {
                    return false;
                }
                force.store(samples.values_from(self.first_curve + k, first));
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

    /// Evaluates the requested samples; returns false if there is no pose.
    #[inline(always)]
    fn sample(&mut self, model: &Model, samples: &mut Samples) -> bool {
        let zero = S::from_f64(0.0);
        // What is no number is not clear either, and neither is what is not finite.
        let (mut steepness, mut undefined) = (zero, zero);
        for first in (0..samples.positions().len()).step_by(S::LANES) {
            let q = S::load(&samples.positions()[first..]);
            let out = &mut self.coefficients;
            if model.reduce(q, &mut self.workspace, out).is_err() {
                return false;
            }
            let (m, half_dm) = (out.m, out.half_dm);
            let inverse = S::from_f64(1.0) / m;
            m.store(samples.values_from(0, first));
            half_dm.store(samples.values_from(1, first));
            for (k, (&a, &b)) in out.a.iter().zip(&out.b).enumerate() {
                // R = a q̈ + b q̇² with q̈ = −½m′ q̇²/m and q̇² = 2E/m, over 2E.
                let free = (b - a * half_dm * inverse) * inverse;
                free.store(samples.values_from(2 + k, first));
            }
            for group in 0..model.plan().group_count() {
                let of_group = self.steepness(model, group);
                steepness = steepness.maximum(of_group);
                undefined += of_group * zero;
            }
        }
        samples.steepness = largest_lane(steepness) + sum_of_lanes(undefined);
        true
    }

    /// The square of a determinant's slope over that of the determinant, 1/rad²: its inverse square root is the distance
    /// at which the tangent of the determinant reaches zero.
    #[inline(always)]
    fn steepness(&self, model: &Model, group: usize) -> S {
        let Workspace { pose, motion, .. } = &self.workspace;
        let [value, slope] = model.plan().determinant_and_slope(group, pose, motion);
        (slope * slope) / (value * value)
    }
}
