//! The initial value problem of a scene's free motion, and its integration.

use crate::branch_note::branch_note;
use crate::explain::{
    StudyError, explain_machine, explain_model, explain_motion, explain_position_in,
};
use crate::free_motion::compute::{
    ChartedProblem, MotionProblem, Picked, SegmentedMotion, compiled_event, end_where_impossible,
    first_changes,
};
use crate::models::{build_machine, loaded_model};
use crate::number_format::digits;
use crate::trajectory::compute::{TrajectorySample, check_variables};
use dwell_dynamics::atlas::{
    Atlas, AtlasError, Chart, ChartChange, ChartChangeReason, ContinuedMotion, CoordinateHistory,
    MachineDescription,
};
use dwell_dynamics::{DynamicsError, Event, Machine, Options, solve};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{Coordinate, Reaction};
use dwell_kinetostatics::Model;
use dwell_scene::{FreeMotionSpec, PlaneScene};

/// The initial value problem of a scene's free motion.
pub struct FreeMotionProblem<'a> {
    /// The scene.
    pub(crate) scene: &'a PlaneScene,
    /// The same with the loads of its drives added.
    pub(crate) loaded_scene: &'a PlaneScene,
    pub(crate) spec: &'a FreeMotionSpec,
    /// The model with all loads and reactions, for outputs.
    pub output_model: Model,
    /// A line for each body that is far from its approximate angle.
    pub(crate) notes: String,
    /// The equations of motion.
    pub machine: Machine,
    /// The same with the requested reactions, for their impulses where there are end stops.
    pub(crate) impact_machine: Option<Machine>,
}

impl<'a> FreeMotionProblem<'a> {
    /// Compiles a scene; `loaded_scene` is the same with the loads through which its drives act.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism or its machine cannot be built.
    pub fn new(
        scene: &'a PlaneScene,
        loaded_scene: &'a PlaneScene,
        spec: &'a FreeMotionSpec,
    ) -> Result<Self, StudyError> {
        let output_model = loaded_model(loaded_scene)?;
        check_variables(scene, &output_model)?;
        let notes = branch_note(loaded_scene, output_model.plan());
        let machine = build_machine(scene, spec, &[])?;
        let reactions = &scene.requests.reactions;
        let impact_machine =
            (!scene.stops.is_empty()).then(|| build_machine(scene, spec, reactions));
        Ok(Self {
            impact_machine: impact_machine.transpose()?,
            scene,
            loaded_scene,
            spec,
            output_model,
            notes,
            machine,
        })
    }

    /// The error that ended a motion, in the coordinate in which it was followed last.
    pub(crate) fn explain_end(
        &self,
        motion: &SegmentedMotion,
        error: &DynamicsError,
    ) -> StudyError {
        let last = motion.segments.last().filter(|(chart, _)| *chart > 0);
        let chart = last.and_then(|(chart, _)| motion.charts.get(*chart));
        match (chart, error) {
            (Some(chart), DynamicsError::Position(position)) => {
                let (scene, plan) = (self.loaded_scene, chart.machine.model().plan());
                explain_position_in(&chart.name, scene, plan, position)
            }
            _ => {
                let last = motion.segments.last().and_then(|(_, s)| s.steps.last());
                self.with_instant(error, self.explain(error), last)
            }
        }
    }

    /// Integrates the motion: with one degree of freedom across charts, else in its own coordinates.
    pub fn solve(&self, duration: f64, options: &Options) -> Result<SegmentedMotion, StudyError> {
        let scene = self.scene;
        let (start, events) = (self.initial_state(), self.events());
        // An end stop is one of the mechanism's own coordinate, in which the motion stays.
        let has_stops = !scene.stops.is_empty();
        if has_stops || self.spec.laws.len() != 1 || self.machine.free().len() != 1 {
            let (machine, output) = (&self.machine, &self.output_model);
            let solution = solve(machine, output, &start, duration, options, &events);
            let mut solution = solution.map_err(|e| self.explain(&e))?;
            end_where_impossible(&self.machine, &mut solution);
            return Ok(SegmentedMotion::single_segment(solution));
        }
        let configuration = scene.assembly.to_configuration();
        let description = MachineDescription {
            mechanism: &scene.mechanism,
            masses: &scene.masses,
            varying_inertias: &scene.varying_inertias,
            assembly: &configuration,
            loads: &scene.loads,
            drives: &scene.drives,
            reactions: &scene.mechanism.reactions(),
        };
        let mut atlas = Atlas::new(description).map_err(|e| match e {
            AtlasError::Model(model) => explain_model(scene, &model),
            AtlasError::Machine(machine) => explain_machine(scene, machine),
        })?;
        let continued = atlas.solve(&start, duration, options, &events);
        let mut continued = continued.map_err(|e| self.explain(&e))?;
        if let Some(last) = continued.segments.last_mut() {
            last.solution.sample_end();
        }
        // In the first chart the actuator's coordinate is the first state.
        let history = match continued.segments.iter().all(|segment| segment.chart == 0) {
            true => Ok(CoordinateHistory::default()),
            false => atlas.coordinate_history(&continued, atlas.actuator_coordinate()),
        };
        let statistics = continued.statistics();
        let chart_changes = self.describe_changes(&atlas, &continued);
        let segments = continued.segments.into_iter();
        Ok(SegmentedMotion {
            orbit: None,
            chart_changes,
            charts: atlas.charts().to_vec(),
            actuator_coordinates: history.map_err(|e| self.explain(&e))?,
            failure: continued.error,
            statistics,
            segments: segments.map(|s| (s.chart, s.solution)).collect(),
        })
    }

    /// Lines of the summary about chart changes and change points.
    fn describe_changes(&self, atlas: &Atlas<'_>, continued: &ContinuedMotion) -> Vec<String> {
        let name = |chart: usize| &atlas.charts()[chart].name;
        let describe = |change: &ChartChange| {
            let what = match change.reason {
                ChartChangeReason::CrossesChangePoint { .. } => "change point crossed".to_owned(),
                ChartChangeReason::CoordinateFold { .. } | ChartChangeReason::SolutionEnds => {
                    let [from, to] = [change.from, change.to].map(name);
                    format!("coordinate changed from {from} (at its dead point) to {to}")
                }
            };
            format!("t = {} s: {what}", digits(change.t, 6))
        };
        let mut descriptions = first_changes(continued.changes.iter().map(describe).collect());
        for fit in atlas.change_points_of(continued) {
            let names = fit.indeterminate.iter();
            let names = names.map(|&r| self.loaded_scene.mechanism.reaction_name(r));
            let indeterminate = match names.collect::<Vec<_>>() {
                none if none.is_empty() => String::new(),
                names => format!("; indeterminate there: {}", names.join(", ")),
            };
            descriptions.push(format!(
                "change point at {}: crossed by a polynomial fit within ±{}, where the tables have no rows; {} degrees of freedom there{indeterminate}",
                digits(fit.center, 6),
                digits(fit.half_width, 3),
                fit.mobility,
            ));
        }
        descriptions.extend(atlas.uncrossable().iter().map(|(q, error)| {
            let at = digits(*q, 6);
            format!("the change point at {at} cannot be crossed: {error}")
        }));
        descriptions
    }

    /// The scene's events, in their order.
    pub(crate) fn events(&self) -> Vec<Event> {
        let mechanism = &self.loaded_scene.mechanism;
        let coordinate = |c: Coordinate| CoordinateFunction::find(mechanism, c).ok_or(());
        let reactions = self.output_model.reactions();
        let reaction = |r: Reaction| reactions.iter().position(|&other| other == r).ok_or(());
        let events = self.spec.events.iter();
        let events = events.map(|named| compiled_event(named, coordinate, reaction));
        events.filter_map(Result::ok).collect()
    }
}

impl ChartedProblem for FreeMotionProblem<'_> {
    type Chart = Chart;

    fn machine_in<'m>(&'m self, motion: &'m SegmentedMotion, chart: usize) -> &'m Machine {
        let chart = motion.charts.get(chart);
        chart.map_or(&self.machine, |c| &c.machine)
    }

    fn own_coordinate(
        &self,
        motion: &SegmentedMotion,
        (segment, picked, k): (usize, Picked, usize),
        _: &TrajectorySample,
    ) -> Option<[f64; 3]> {
        let history = &motion.actuator_coordinates;
        let coordinates = match picked {
            Picked::Steps => &history.steps,
            Picked::Samples => &history.samples,
        };
        coordinates.get(segment)?.get(k).copied()
    }
}

impl MotionProblem for FreeMotionProblem<'_> {
    type Scene = PlaneScene;

    #[allow(
        clippy::misnamed_getters,
        reason = "what moves is the scene with the loads of its drives"
    )]
    fn scene(&self) -> &PlaneScene {
        self.loaded_scene
    }

    fn spec(&self) -> &FreeMotionSpec {
        self.spec
    }

    fn machine(&self) -> &Machine {
        &self.machine
    }

    fn impact_machine(&self) -> Option<(&Machine, usize)> {
        let requested = self.loaded_scene.requests.reactions.len();
        Some((self.impact_machine.as_ref()?, requested))
    }

    fn explain(&self, error: &DynamicsError) -> StudyError {
        explain_motion(self.loaded_scene, self.output_model.plan(), error)
    }
}
