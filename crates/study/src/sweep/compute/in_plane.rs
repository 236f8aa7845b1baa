//! Quantities that sweeps compute from scenes in the plane.

use crate::branch_note::branch_note;
use crate::explain::{StudyError, explain_machine, explain_model, explain_position};
use crate::models::{end_stops, exact_model, with_loads};
use crate::number_format::force_unit;
use crate::sweep::compute::available::IndexedReaction;
use crate::sweep::compute::extremes::{ExtremeValues, RangeCurves};
use crate::sweep::compute::point::{ResultKind, Results};
use crate::sweep::compute::{Design, NamedUnit, RequestedQuantities, SweptScene, VariantFamily};
use crate::trajectory::compute::{check_variables, default_limits};
use dwell_dynamics::{CoordinateMode, Machine};
use dwell_kinetostatics::Model;
use dwell_scene::{PlaneScene, SceneError};

impl SweptScene for PlaneScene {
    fn notes(&self, model: &Model) -> Result<String, StudyError> {
        check_variables(self, model)?;
        Ok(branch_note(self, model.plan()))
    }

    /// The statically determinate reactions, with their index in the model.
    fn swept_reactions(&self, model: &Model) -> Vec<IndexedReaction> {
        let all = model.reactions().iter().enumerate();
        let determinate = all.filter(|&(k, reaction)| {
            model.plan().is_determinate(k) && self.requests.reactions.contains(reaction)
        });
        let named = determinate.map(|(k, reaction)| {
            let name = self.mechanism.reaction_name(*reaction);
            (k, name, reaction.component.unit())
        });
        named.collect()
    }

    /// Forces and powers of drives.
    fn further_motion_columns(&self) -> Vec<NamedUnit> {
        let drives = self.drives.iter().flat_map(|drive| {
            let is_angle = drive.coordinate.is_angle();
            let kind = if is_angle { "moment" } else { "force" };
            let force = format!("{}.load_{kind}", drive.name);
            let power = format!("{}.power", drive.name);
            [(force, force_unit(is_angle)), (power, "W")]
        });
        drives.map(|(name, unit)| (name, unit.to_owned())).collect()
    }

    fn free_machine(&self, model: &Model) -> Result<Machine, StudyError> {
        let (model, modes) = (model.without_reactions(), vec![CoordinateMode::Free]);
        let machine = Machine::new(model, &self.loads, modes, &self.drives);
        let machine = machine.and_then(|machine| machine.with_stops(&end_stops(&self.stops)));
        machine.map_err(|e| explain_machine(self, e))
    }

    fn inertia_extremes(&self, model: &Model) -> Result<ExtremeValues, StudyError> {
        let exact = exact_model(self, model.without_reactions())?;
        let (limits, ..) = default_limits(self, model.plan());
        let curves = RangeCurves::of_inertia(exact, limits)
            .map_err(|e| explain_position(self, model.plan(), &e))?;
        Ok(curves.extremes())
    }

    fn compute_free_reactions(
        &self,
        model: &Model,
        energy: f64,
        requested: &RequestedQuantities,
        results: &mut Results<'_>,
    ) {
        let kinds = [ResultKind::FreeReaction, ResultKind::FreeReactionPlace];
        let reactions = requested.indices(&kinds);
        let curves = free_reaction_curves(self, model, &reactions, energy);
        results.set_points(kinds, curves.map(|curves| curves.largest(&reactions)));
    }

    fn with_all_loads(&self, model: Model) -> Result<Model, StudyError> {
        with_loads(self, model)
    }

    fn varied(&self, values: &[(&str, f64)]) -> Result<Self, SceneError> {
        self.with_values(values)
    }

    fn family(&self, design: &Design, requested: &RequestedQuantities) -> Option<VariantFamily> {
        VariantFamily::new(self, design, requested)
    }
}

/// Some reactions of a model, by their index, in the free rotation of an energy, J.
fn free_reaction_curves(
    scene: &PlaneScene,
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
