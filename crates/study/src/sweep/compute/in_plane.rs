//! What scenes in the plane are swept for.

use crate::branch_note::branch_note;
use crate::explain::{
    StudyError, explain_machine, explain_model, explain_motion, explain_position,
};
use crate::models::{compile_model, end_stops, exact_model, initial_reduced_state, with_loads};
use crate::sweep::compute::available::{Available, IndexedReaction};
use crate::sweep::compute::extremes::RangeCurves;
use crate::sweep::compute::motions::{
    cycle_quantities, cycle_values, motion_quantities, motion_values,
};
use crate::sweep::compute::point::{ResultKind, Results};
use crate::sweep::compute::{Design, RequestedQuantities, SweptScene, VariantFamily};
use crate::trajectory::compute::{
    WantedForces, check_variables, default_limits, peak_analysis, peak_forces,
};
use dwell_dynamics::{CoordinateMode, DynamicsError, Machine, Orbit, ReducedState};
use dwell_kinetostatics::Model;
use dwell_scene::{Scene, SceneError};

impl SweptScene for Scene {
    fn available_quantities(&self) -> Result<Available, StudyError> {
        let model = compile_model(self, &self.mechanism.reactions())?;
        check_variables(self, &model)?;
        let mut all = Available {
            notes: branch_note(self, model.plan()),
            ..Available::default()
        };
        let has_peaks = peak_analysis(self).is_some();
        if model.plan().actuators() == 1 {
            let is_angle = model.plan().is_angle(0);
            all.add_inertia(is_angle);
            if is_conservative(self, &model) {
                let reactions = match has_peaks {
                    true => Vec::new(),
                    false => determinate_reactions(self, &model),
                };
                all.add_orbit(is_angle, reactions);
            }
        }
        if has_peaks {
            let actuators = self.mechanism.actuators.iter().enumerate();
            let actuators = actuators.map(|(k, a)| (a.name.as_str(), model.plan().is_angle(k)));
            all.add_peaks(actuators, determinate_reactions(self, &model));
        }
        all.add_all(ResultKind::Motion, motion_quantities(self, &model));
        all.add_all(ResultKind::Cycle, cycle_quantities(self));
        Ok(all)
    }

    /// Compiles the mechanism once, for all requested quantities.
    fn compute_results(
        &self,
        requested: &RequestedQuantities,
        results: &mut Results<'_>,
    ) -> Result<(), StudyError> {
        let model = compile_model(self, &self.mechanism.reactions())?;
        let includes = |kind: ResultKind| requested.includes(kind);
        if let Some((from, to)) = model.plan().range().limits() {
            results.set(ResultKind::Range, Ok(vec![from, to]));
        }
        if includes(ResultKind::Motion) {
            results.set(ResultKind::Motion, motion_values(self, &model));
        }
        if includes(ResultKind::Cycle) {
            results.set(ResultKind::Cycle, cycle_values(self));
        }
        if includes(ResultKind::Inertia) || includes(ResultKind::InertiaPlace) {
            let extremes = inertia_curves(self, &model).map(|curves| curves.extremes());
            results.set_points([ResultKind::Inertia, ResultKind::InertiaPlace], extremes);
        }
        compute_orbit(self, &model, requested, results);
        if (includes(ResultKind::Reaction) || includes(ResultKind::ActuatorForce))
            && let Some(analysis) = peak_analysis(self)
        {
            let wanted = WantedForces {
                reactions: requested.indices(&[ResultKind::Reaction]),
                actuators: requested.indices(&[ResultKind::ActuatorForce]),
            };
            match peak_forces(self, &with_loads(self, model)?, analysis, &wanted) {
                Ok(peaks) => {
                    results.set(ResultKind::Reaction, Ok(peaks.reactions));
                    results.set(ResultKind::ActuatorForce, Ok(peaks.tau));
                }
                Err(error) => results.set(ResultKind::Reaction, Err(error)),
            }
        }
        Ok(())
    }

    fn varied(&self, values: &[(&str, f64)]) -> Result<Self, SceneError> {
        self.with_values(values)
    }

    fn family(&self, design: &Design, requested: &RequestedQuantities) -> Option<VariantFamily> {
        VariantFamily::new(self, design, requested)
    }
}

/// The results of the conservative free motion.
fn compute_orbit(
    scene: &Scene,
    model: &Model,
    requested: &RequestedQuantities,
    results: &mut Results<'_>,
) {
    let kinds = [ResultKind::FreeReaction, ResultKind::FreeReactionPlace];
    let reactions = requested.indices(&kinds);
    let is_requested = requested.includes(ResultKind::Orbit);
    let start = initial_reduced_state(scene);
    let Some(start) = start.filter(|_| is_requested || !reactions.is_empty()) else {
        return;
    };
    let orbit = orbit(scene, start, model);
    if !reactions.is_empty()
        && let Ok(orbit) = &orbit
    {
        let curves = free_reaction_curves(scene, model, &reactions, orbit.energy);
        results.set_points(kinds, curves.map(|curves| curves.largest(&reactions)));
    }
    let values = orbit.map(|orbit| vec![orbit.period, orbit.energy]);
    results.set(ResultKind::Orbit, values);
}

/// m and ½m′ over the range.
fn inertia_curves(scene: &Scene, model: &Model) -> Result<RangeCurves<Model>, StudyError> {
    let exact = exact_model(scene, model.without_reactions())?;
    let (limits, ..) = default_limits(scene, model.plan());
    let curves = RangeCurves::of_inertia(exact, limits);
    curves.map_err(|e| explain_position(scene, model.plan(), &e))
}

/// Some reactions of a model, by their index, in the free rotation of an energy, J.
fn free_reaction_curves(
    scene: &Scene,
    model: &Model,
    indices: &[usize],
    energy: f64,
) -> Result<RangeCurves<Model>, StudyError> {
    let all = model.reactions();
    let wanted: Vec<_> = indices
        .iter()
        .filter_map(|&k| all.get(k).copied())
        .collect();
    let with_reactions = model.clone().with_reactions(&wanted);
    let exact = exact_model(scene, with_reactions.map_err(|e| explain_model(scene, &e))?)?;
    let (limits, ..) = default_limits(scene, model.plan());
    let curves = RangeCurves::of_free_reactions(exact, limits, energy);
    curves.map_err(|e| explain_position(scene, model.plan(), &e))
}

/// The requested reactions that are results, with their index in the model, name and unit: not those that are statically
/// indeterminate.
fn determinate_reactions(scene: &Scene, model: &Model) -> Vec<IndexedReaction> {
    let all = model.reactions().iter().enumerate();
    let determinate = all.filter(|&(k, reaction)| {
        model.plan().is_determinate(k) && scene.requests.reactions.contains(reaction)
    });
    let named = determinate.map(|(k, reaction)| {
        let name = scene.mechanism.reaction_name(*reaction);
        (k, name, reaction.component.unit())
    });
    named.collect()
}

/// Whether the scene has a conservative free motion.
fn is_conservative(scene: &Scene, model: &Model) -> bool {
    let laws = scene.motion.iter().flat_map(|spec| &spec.laws);
    let is_free = laws.into_iter().all(Option::is_none) && scene.drives.is_empty();
    let Some(start) = initial_reduced_state(scene).filter(|_| is_free) else {
        return false;
    };
    orbit_machine(scene, model).is_ok_and(|machine| {
        let orbit = Orbit::loaded(&machine, start);
        !matches!(orbit, Err(DynamicsError::NotConservative { .. }))
    })
}

fn orbit_machine(scene: &Scene, model: &Model) -> Result<Machine, StudyError> {
    let (model, modes) = (model.without_reactions(), vec![CoordinateMode::Free]);
    let machine = Machine::new(model, &scene.loads, modes, &scene.drives);
    let machine = machine.and_then(|machine| machine.with_stops(&end_stops(&scene.stops)));
    machine.map_err(|e| explain_machine(scene, e))
}

fn orbit(scene: &Scene, start: ReducedState, model: &Model) -> Result<Orbit, StudyError> {
    let machine = orbit_machine(scene, model)?;
    Orbit::loaded(&machine, start).map_err(|e| explain_motion(scene, model.plan(), &e))
}
