//! A scene in space with the exact reduced model of its requests.

use super::explain::{
    explain_load_error, explain_loads, explain_model, explain_position, with_loads,
};
use crate::explain::{StudyError, driven_labels, wrong_actuators};
use crate::machines::MachineScene as _;
#[cfg(feature = "output")]
use crate::output::{indeterminate_note, symbol};
use crate::ranges::equally_spaced;
use crate::reduce::compute::{
    InertiaAt, ReducedScene, TabulatedScene, UnitLoadCurves, reduced_loads,
};
use crate::trajectory::compute::{SweepLimits, one_revolution, range_to_draw};
use dwell_geometry::space::{ActuatorKind, Placement, Plan};
use dwell_geometry::{PositionError, Range};
use dwell_kinetostatics::space::{Component, Model, Reaction};
use dwell_kinetostatics::{
    Coefficients, ExactModel, KinetostaticsError, MachineModel as _, Magnitude, ReducedModel as _,
    TableDomain, TableError, TabulatedModel, reduction_rounding_errors,
};
use dwell_scene::{SceneFile, SpaceScene};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Half a stroke without limits, in sizes of the mechanism.
const DEFAULT_STROKE: f64 = 0.5;

/// A scene in space and the reduced model of its requests.
#[derive(Debug)]
pub struct PreparedSpaceScene<'a> {
    /// The scene.
    pub scene: &'a SpaceScene,
    /// The model, with the requested reactions that the loads determine.
    pub model: ExactModel<Model>,
    /// Requested reactions that redundant constraints leave open.
    pub indeterminate: Vec<Reaction>,
}

impl<'a> PreparedSpaceScene<'a> {
    /// Compiles the requests of a scene.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be assembled, or does not have one actuator.
    pub fn new(scene: &'a SpaceScene) -> Result<Self, StudyError> {
        let model = compile(scene, &scene.requests.reactions)?;
        let [determined, indeterminate] = sort_reactions(scene, &model)?;
        let model = if indeterminate.is_empty() {
            model
        } else {
            compile(scene, &determined)?
        };
        let Some(model) = ExactModel::new(model) else {
            let actuators = scene.mechanism.actuators.len();
            return Err(wrong_actuators(scene, actuators, driven_labels(actuators)));
        };
        Ok(Self {
            scene,
            model,
            indeterminate,
        })
    }

    /// The placements of all bodies at coordinates, rad or m.
    ///
    /// # Errors
    /// [`StudyError::Scene`] where one of them cannot be reached.
    pub(super) fn placements(
        &self,
        coordinates: &[f64],
    ) -> Result<Vec<Vec<Placement>>, StudyError> {
        let plan = self.model.model().plan();
        let mut pose = plan.pose();
        let bodies = 0..self.scene.mechanism.bodies.len();
        let mut placements = |q: f64| {
            plan.positions(&[q], &mut pose)
                .map_err(|e| self.explain(&e))?;
            let all = bodies.clone().map(|b| plan.placement(&pose, b));
            Ok(all.collect())
        };
        coordinates.iter().map(|q| placements(*q)).collect()
    }

    /// The model of the scene with other reactions.
    ///
    /// # Errors
    /// [`StudyError::Scene`] as [`PreparedSpaceScene::new`].
    pub fn model_for(&self, reactions: &[Reaction]) -> Result<Model, StudyError> {
        compile(self.scene, reactions)
    }

    /// The part of the range that is shown, rad or m.
    pub fn drawn_range(&self) -> [f64; 2] {
        range_limits(self.scene, self.model.model().plan()).0
    }

    /// The magnitude of the load `weight`, m/s², if it is a constant one.
    pub fn weight(&self) -> Option<f64> {
        let weight = self.scene.loads.iter().find(|load| load.name == "weight")?;
        let Magnitude::Constant(magnitude) = weight.magnitude else {
            return None;
        };
        Some(magnitude)
    }

    /// An error of a position in the names of the scene.
    pub fn explain(&self, error: &PositionError) -> StudyError {
        explain_position(self.scene, self.model.model().plan(), error)
    }
}

/// A model of a scene for some reactions.
pub(super) fn compile(scene: &SpaceScene, reactions: &[Reaction]) -> Result<Model, StudyError> {
    Model::new(&scene.mechanism, &scene.masses, &scene.assembly, reactions)
        .map_err(|e| explain_model(scene, &e))
}

/// A model of a scene for some reactions, with its loads, and those through which its drives act.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled, or a load does not fit it.
pub fn model_with_loads(scene: &SpaceScene, reactions: &[Reaction]) -> Result<Model, StudyError> {
    with_loads(scene, compile(scene, reactions)?)
}

/// The reactions of a model: those that the loads determine, and those that redundant constraints leave undetermined.
pub(super) fn sort_reactions(
    scene: &SpaceScene,
    model: &Model,
) -> Result<[Vec<Reaction>; 2], StudyError> {
    let determined = model
        .determined_throughout()
        .map_err(|e| explain_position(scene, model.plan(), &e))?;
    let all = model.reactions().zip(determined);
    let (determined, others): (Vec<_>, Vec<_>) = all.partition(|(_, determined)| *determined);
    Ok([determined, others].map(|some| some.into_iter().map(|(reaction, _)| reaction).collect()))
}

/// The unit of a reaction.
pub(super) fn reaction_unit(reaction: &Reaction) -> &'static str {
    match reaction.component {
        Component::Force(..) => "N",
        Component::Moment(..) => "N m",
    }
}

impl TabulatedScene for PreparedSpaceScene<'_> {
    fn tabulated(
        &self,
        accuracy: f64,
        domain: TableDomain,
    ) -> Result<Result<TabulatedModel, TableError>, StudyError> {
        let model = self.model.model().clone();
        // Drives are no part of a table.
        let loaded = model.with_loads(self.scene.loads.clone());
        let loaded = loaded.map_err(|error| explain_load_error(self.scene, &error))?;
        let loaded = loaded.for_unit_loads();
        // The model has one actuator, as the prepared one has.
        let exact = ExactModel::new(loaded).unwrap_or_else(|| self.model.clone());
        let [from, to] = self.drawn_range();
        let domain = match domain {
            // Between the change points, next to which reactions grow.
            TableDomain::Full if !self.model.model().plan().change_points().is_empty() => {
                TableDomain::Between(from, to)
            }
            domain => domain,
        };
        Ok(TabulatedModel::new(&exact, accuracy, domain))
    }
}

impl ReducedScene for PreparedSpaceScene<'_> {
    fn file(&self) -> &SceneFile {
        &self.scene.file
    }

    fn coordinate_name(&self) -> &str {
        &self.scene.mechanism.actuators[0].name
    }

    fn is_angle(&self) -> bool {
        is_angle(self.scene)
    }

    fn reaction_units(&self) -> Vec<(String, &'static str)> {
        self.scene.reaction_units(self.model.model())
    }

    fn lists_reactions(&self) -> bool {
        self.scene.requests.lists_reactions
    }

    fn range(&self) -> Range {
        range_between_change_points(self.model.model().plan(), self.scene.assembly.q[0])
    }

    fn has_limits(&self) -> [bool; 2] {
        range_limits(self.scene, self.model.model().plan()).1
    }

    fn positions(&self, intervals: usize) -> Vec<f64> {
        let (limits, ..) = range_limits(self.scene, self.model.model().plan());
        equally_spaced(limits, intervals)
    }

    fn size(&self) -> f64 {
        self.model.model().plan().size()
    }

    fn coefficients(&self, q: &[f64]) -> Result<Vec<Coefficients>, StudyError> {
        let model = self.model.model();
        let at = |workspace: &mut _, &q: &f64| {
            let mut out = model.coefficient_buffer();
            model
                .reduce(q, workspace, &mut out)
                .map_err(|e| self.explain(&e))?;
            Ok(out)
        };
        q.par_iter().map_init(|| model.workspace(), at).collect()
    }

    fn rounding_errors(&self, q: f64, at: &Coefficients) -> Result<Coefficients, StudyError> {
        let model = self.model.model();
        // In 32 digits there is no prediction: whole periods away from the start, teeth would not mesh.
        let q = match model.plan().range() {
            Range::Revolutions(count) => q.rem_euclid(TAU * f64::from(count)),
            _ => q,
        };
        let (mut workspace, mut errors) = (model.workspace(), model.coefficient_buffer());
        reduction_rounding_errors(model, q, at, &mut workspace, &mut errors)
            .map_err(|e| self.explain(&e))?;
        Ok(errors)
    }

    fn inertia(&self) -> InertiaAt<'_> {
        let mut workspace = self.model.workspace();
        Box::new(move |q| self.model.inertia(q, &mut workspace).ok())
    }

    fn unit_loads(&self, q: &[f64]) -> Result<Option<UnitLoadCurves>, StudyError> {
        let loads = &self.scene.loads;
        if loads.is_empty() {
            return Ok(None);
        }
        let model = self.model.model();
        let loaded = with_loads(self.scene, model.clone())?.for_unit_loads();
        let (mut workspace, mut response) = (loaded.workspace(), loaded.result_buffer());
        let mut curves = UnitLoadCurves {
            loads: reduced_loads(loads, self.is_angle()),
            rows: Vec::with_capacity(q.len()),
            potential: Vec::with_capacity(q.len()),
            conservative: (0..loads.len()).any(|k| loaded.is_conservative(k)),
        };
        for &q in q {
            let (mut row, mut potential) = (Vec::with_capacity(loads.len()), 0.0);
            let mut state = loaded
                .kinematic_state(&[q], &[1.0], &mut workspace)
                .map_err(|e| self.explain(&e))?;
            for load in 0..loads.len() {
                let responded = state.unit_load_response(load, &mut response);
                responded.map_err(|e| explain_loads(self.scene, loaded.plan(), &e))?;
                potential += state.potential_energy(load).unwrap_or_default();
                let mut values = vec![-response.tau[0]];
                values.extend(&response.reactions);
                row.push(values);
            }
            curves.rows.push(row);
            curves.potential.push(potential);
        }
        Ok(Some(curves))
    }

    fn load_names(&self) -> Vec<String> {
        let loads = self.scene.loads.iter();
        loads.map(|load| load.name.clone()).collect()
    }

    fn explain_evaluation(&self, error: &KinetostaticsError) -> StudyError {
        explain_loads(self.scene, self.model.model().plan(), error)
    }

    #[cfg(feature = "output")]
    fn coordinate_label(&self) -> String {
        let actuator = &self.scene.mechanism.actuators[0];
        let joint = &self.scene.mechanism.joints[actuator.kind.joint().0].name;
        let what = if self.is_angle() { "angle" } else { "travel" };
        format!("{what} {} of joint {joint}", symbol(&actuator.name))
    }

    #[cfg(feature = "output")]
    fn notes(&self) -> String {
        let names = self.indeterminate.iter();
        indeterminate_note(names.map(|&r| self.scene.reaction_name(r)))
    }
}

/// The range of the only actuator about a coordinate; with change points, the part between two of them.
fn range_between_change_points(plan: &Plan, start: f64) -> Range {
    let range = plan.range();
    if plan.change_points().is_empty() {
        return range;
    }
    let period = range.period();
    let periods = if period.is_some() { -2..=2 } else { 0..=0 };
    let turns = periods.map(|k| f64::from(k) * period.unwrap_or(0.0));
    let points = turns.flat_map(|turn| plan.change_points().iter().map(move |p| p.q + turn));
    let points: Vec<f64> = points.collect();
    let (low, high) = range.limits().unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let below = points.iter().copied().filter(|q| *q <= start);
    let above = points.iter().copied().filter(|q| *q > start);
    let (from, to) = (below.fold(low, f64::max), above.fold(high, f64::min));
    if plan.is_angle(0) {
        Range::Limited(from, to)
    } else {
        Range::Stroke(from, to)
    }
}

/// The part of the range of the only actuator that is shown, whether its ends are next to limit positions, and its
/// description.
pub(super) fn range_limits(scene: &SpaceScene, plan: &Plan) -> SweepLimits {
    let (start, is_angle) = (scene.assembly.q[0], is_angle(scene));
    let half_stroke = DEFAULT_STROKE * plan.size();
    match range_between_change_points(plan, start) {
        Range::Limited(from, to) | Range::Stroke(from, to) => range_to_draw([from, to], [true; 2]),
        Range::Full => one_revolution(0.0),
        Range::Revolutions(count) => ([0.0, TAU * f64::from(count)], [false; 2], "the period"),
        Range::Unresolved(from, to) => {
            // An end that was not found is only where the search stopped.
            let found = plan.range_ends();
            let half = if is_angle { TAU } else { half_stroke };
            let [nearest, farthest] = [from.max(start - half), to.min(start + half)];
            let low = if found[0] { from } else { nearest };
            let high = if found[1] { to } else { farthest };
            range_to_draw([low, high], found)
        }
        Range::Unbounded if is_angle => one_revolution(start),
        Range::Unbounded => {
            let ends = [start - half_stroke, start + half_stroke];
            (ends, [false; 2], "a stroke")
        }
    }
}

/// Whether the first coordinate is an angle.
pub(super) fn is_angle(scene: &SpaceScene) -> bool {
    let kind = scene.mechanism.actuators.first().map(|a| a.kind);
    !matches!(
        kind,
        Some(ActuatorKind::Travel(_) | ActuatorKind::Length(_))
    )
}
