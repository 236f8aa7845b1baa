//! Quantities that sweeps compute from scenes in space.

use super::explain::explain_position;
use super::prepared::{compile, range_limits, reaction_unit};
use super::trajectory::SpaceRows;
use crate::explain::StudyError;
use crate::progress::no_progress;
use crate::sweep::compute::{
    Design, ExtremeValues, IndexedReaction, RangeCurves, RequestedQuantities, ResultKind, Results,
    SweptScene, VariantFamily,
};
use crate::trajectory::compute::{Analysis, Quantity, RowSource, Statistic};
use dwell_kinetostatics::ExactModel;
use dwell_kinetostatics::space::{Model, Reaction};
use dwell_scene::{SceneError, SpaceScene};

impl SweptScene for SpaceScene {
    /// By their index.
    fn swept_reactions(&self, rows: &SpaceRows) -> Vec<IndexedReaction> {
        let all = rows.requested.iter().enumerate();
        let named = all.map(|(k, r)| (k, self.reaction_name(*r), reaction_unit(r)));
        named.collect()
    }

    fn inertia_extremes(&self, _: &SpaceRows) -> Result<ExtremeValues, StudyError> {
        Ok(range_curves(self, compile(self, &[])?, RangeCurves::of_inertia)?.extremes())
    }

    /// Rejects a variant that leaves a reaction undetermined which the unchanged scene determines; the message of its
    /// point states this.
    fn reject_open(
        &self,
        rows: &SpaceRows,
        requested: &RequestedQuantities,
    ) -> Result<(), StudyError> {
        let mut open = rows.indeterminate.iter();
        let open = open.find(|r| is_requested(requested, &self.reaction_name(**r)));
        match open {
            None => Ok(()),
            Some(&reaction) => {
                let name = self.reaction_name(reaction);
                let message = format!("redundant constraints leave the reaction `{name}` open");
                Err(self.error(message, None, &[]).into())
            }
        }
    }

    fn compute_free_reactions(
        &self,
        rows: &SpaceRows,
        energy: f64,
        requested: &RequestedQuantities,
        results: &mut Results<'_>,
    ) {
        let all = rows.requested.iter();
        let named = all.map(|reaction| (*reaction, self.reaction_name(*reaction)));
        let named: Vec<_> = named
            .filter(|(_, name)| is_requested(requested, name))
            .collect();
        match largest_in_motion(self, &named, energy) {
            Ok([values, places]) => {
                results.set_named(ResultKind::FreeReaction, Ok(values));
                results.set_named(ResultKind::FreeReactionPlace, Ok(places));
            }
            Err(error) => results.set(ResultKind::FreeReaction, Err(error)),
        }
    }

    fn largest_forces(
        &self,
        rows: &SpaceRows,
        analysis: Analysis,
    ) -> Result<Vec<(String, f64)>, StudyError> {
        peaks(self, rows, analysis)
    }

    fn varied(&self, values: &[(&str, f64)]) -> Result<Self, SceneError> {
        let mut scene = self.with_values(values)?;
        // Without a list, the components that are requested depend on the directions of the axes.
        let reactions = &self.requests.reactions;
        scene.requests.reactions.clone_from(reactions);
        Ok(scene)
    }

    fn family(&self, _: &Design, _: &RequestedQuantities) -> Option<VariantFamily> {
        // Each variant is compiled: only mechanisms in the plane have their structure apart from their numbers.
        None
    }
}

/// Whether a result of a reaction is requested.
fn is_requested(requested: &RequestedQuantities, reaction: &str) -> bool {
    let mut quantities = requested.quantities.iter();
    quantities.any(|q| {
        let of = Statistic::of_name(&q.name).map(|(name, _)| name);
        of.map(|name| name.strip_prefix("place.").unwrap_or(name)) == Some(reaction)
    })
}

/// The largest magnitudes of reactions and of actuator forces, also between the rows; zero where a column is zero within rounding.
fn peaks(
    scene: &SpaceScene,
    rows: &SpaceRows,
    analysis: Analysis,
) -> Result<Vec<(String, f64)>, StudyError> {
    // The abscissa is among them.
    let mut source = RowSource::new(scene, rows);
    source.is_wanted = |quantity| {
        matches!(
            quantity,
            Quantity::Time
                | Quantity::ActuatorCoordinate(_, 0)
                | Quantity::ActuatorForce(_)
                | Quantity::Reaction(_)
        )
    };
    let mut computed = source.analysed(analysis, None, &no_progress)?;
    if let Some(error) = computed.early_stop.take() {
        return Err(error);
    }
    let results = &computed.results;
    let columns = results.columns.iter().zip(&results.extrema.of_columns);
    let largest = columns.map(|(column, ends)| {
        let ends = ends.iter().flatten().map(|end| end.value.abs());
        let largest = ends.fold(f64::NAN, f64::max);
        (format!("{}.max_abs", column.name), largest)
    });
    Ok(largest.collect())
}

/// Curves over the range of the only actuator.
fn range_curves(
    scene: &SpaceScene,
    model: Model,
    of: impl Fn(
        ExactModel<Model>,
        [f64; 2],
    ) -> Result<RangeCurves<Model>, dwell_geometry::PositionError>,
) -> Result<RangeCurves<Model>, StudyError> {
    let plan = model.plan().clone();
    let (limits, ..) = range_limits(scene, &plan);
    let Some(exact) = ExactModel::new(model) else {
        let message = "the reduced model needs exactly one actuator".to_owned();
        return Err(scene.error(message, None, &[]).into());
    };
    of(exact, limits).map_err(|e| explain_position(scene, &plan, &e))
}

/// The largest magnitudes of reactions in the free rotation of an energy, J, and their places.
fn largest_in_motion(
    scene: &SpaceScene,
    named: &[(Reaction, String)],
    energy: f64,
) -> Result<[Vec<(String, f64)>; 2], StudyError> {
    let wanted: Vec<Reaction> = named.iter().map(|(reaction, _)| *reaction).collect();
    let curves = range_curves(scene, compile(scene, &wanted)?, |exact, limits| {
        RangeCurves::of_free_reactions(exact, limits, energy)
    })?;
    let indices: Vec<usize> = (0..named.len()).collect();
    let points = named.iter().zip(curves.largest(&indices));
    let both = points.map(|((_, name), [place, value])| {
        let name = format!("{name}.max_abs");
        ((name.clone(), value), (format!("place.{name}"), place))
    });
    let (values, places) = both.unzip();
    Ok([values, places])
}
