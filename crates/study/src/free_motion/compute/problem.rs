//! The initial value problem of a scene's free motion, and its integration.

use crate::explain::{
    StudyError, explain_machine, explain_model, explain_motion, explain_position_in,
};
use crate::free_motion::compute::events::NumberedEvent;
use crate::free_motion::compute::{
    ChartedProblem, Instant, MotionProblem, Picked, SegmentedMotion, compiled_event,
    end_where_impossible, first_changes,
};
use crate::models::{build_machine, loaded_model};
use crate::number_format::digits;
use crate::ranges::extent;
use crate::trajectory::compute::{TrajectorySample, check_variables};
use dwell_dynamics::atlas::{
    Atlas, AtlasError, Chart, ChartChange, ChartChangeReason, ContinuedMotion, CoordinateHistory,
    MachineDescription,
};
use dwell_dynamics::{
    DynamicsError, Event, Machine, ObservedMachine, Options, Orbit, TabulatedMachine, solve,
    solve_system,
};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{Coordinate, Reaction};
use dwell_kinetostatics::{Model, TableDomain};
use dwell_scene::{FreeMotionSpec, PlaneScene};
use std::f64::consts::TAU;

/// Accuracy of a table relative to the tolerance, and its finest value.
const TABLE_TOLERANCE_RATIO: f64 = 0.1;
const MIN_TABLE_TOLERANCE: f64 = 1e-13;
/// Margin of a table of a limited range beyond the coarse run, relative to the range of that run.
const TABLE_MARGIN: f64 = 0.05;

/// The initial value problem of a scene's free motion.
pub struct FreeMotionProblem<'a> {
    /// The scene.
    pub(crate) scene: &'a PlaneScene,
    /// The same with the loads of its drives added.
    pub(crate) loaded_scene: &'a PlaneScene,
    pub(crate) spec: &'a FreeMotionSpec,
    /// The model with all loads and reactions, for outputs.
    pub output_model: Model,
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
            machine,
        })
    }

    /// Integrates the motion: with one degree of freedom across charts, else in its own coordinates.
    pub fn solve(&self, duration: f64, options: &Options) -> Result<SegmentedMotion, StudyError> {
        let scene = self.scene;
        let (start, (events, _)) = (self.initial_state(), self.events());
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
        let chart_changes = self.changes(&atlas, &continued);
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
    fn changes(&self, atlas: &Atlas<'_>, continued: &ContinuedMotion) -> Vec<String> {
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
}

impl ChartedProblem for FreeMotionProblem<'_> {
    type Chart = Chart;

    fn by_method(&self, duration: f64, options: &Options) -> Result<SegmentedMotion, StudyError> {
        self.solve(duration, options)
    }

    /// Where the motion stays in its own coordinate and assembly mode.
    fn range_for_table(&self, coarse: &SegmentedMotion) -> Option<[f64; 2]> {
        let is_single_segment = coarse.segments.len() == 1 && coarse.charts.len() <= 1;
        let stays = is_single_segment && coarse.failure.is_none();
        let coordinates = coarse.steps();
        let coordinates = coordinates.filter_map(|(_, point)| point.y.first().copied());
        (stays && self.machine.free() == [0]).then(|| extent(coordinates))
    }

    fn on_table(
        &self,
        visited: [f64; 2],
        duration: f64,
        options: &Options,
    ) -> Result<Option<SegmentedMotion>, StudyError> {
        let [low, high] = visited;
        let margin = TABLE_MARGIN * (high - low);
        let domain = match self.machine.model().plan().range().limits() {
            None => TableDomain::Full,
            Some((from, to)) => {
                TableDomain::Between((low - margin).max(from), (high + margin).min(to))
            }
        };
        let accuracy = (TABLE_TOLERANCE_RATIO * options.rtol).max(MIN_TABLE_TOLERANCE);
        let Ok(table) = TabulatedMachine::new(&self.machine, accuracy, domain) else {
            return Ok(None);
        };
        let start = self.initial_state();
        let work = self.machine.largest_work(start.t, duration);
        let ode = table.ode(start.t, &start.y, work);
        let mut ode = ode.map_err(|e| self.explain(&e))?;
        let outputs = ObservedMachine::new(&self.machine, &self.output_model).in_modes(ode.modes());
        let (events, _) = self.events();
        let solution = solve_system(&mut ode, outputs, &start, Some(duration), options, &events);
        let mut solution = solution.map_err(|e| self.explain(&e))?;
        solution.add_contact_events(ode.take_contact_events());
        solution.modes = ode.modes().take();
        let is_complete = solution.error.is_none();
        Ok(is_complete.then(|| SegmentedMotion::single_segment(solution)))
    }

    fn passes_close_branches(&self, orbit: &Orbit) -> bool {
        orbit.passes_close_branches(&self.machine)
    }

    fn events(&self) -> (Vec<Event>, &Model) {
        let mechanism = &self.loaded_scene.mechanism;
        let coordinate = |c: Coordinate| CoordinateFunction::find(mechanism, c).ok_or(());
        let reactions = self.output_model.reactions();
        let reaction = |r: Reaction| reactions.iter().position(|&other| other == r).ok_or(());
        let events = self.spec.events.iter();
        let events = events.map(|named| compiled_event(named, coordinate, reaction));
        let events = events.filter_map(Result::ok).collect();
        (events, &self.output_model)
    }

    fn rows(&self) -> &Model {
        &self.output_model
    }

    fn charts<'p>(&'p self, motion: &'p SegmentedMotion) -> Vec<(&'p PlaneScene, &'p Model)> {
        let charts = motion.charts.iter();
        charts
            .map(|chart| (self.loaded_scene, &chart.output_model))
            .collect()
    }

    fn result_reactions(&self) -> usize {
        self.output_model.reactions().len()
    }

    fn machine_in<'m>(&'m self, motion: &'m SegmentedMotion, chart: usize) -> &'m Machine {
        let chart = motion.charts.get(chart);
        chart.map_or(&self.machine, |c| &c.machine)
    }

    fn own_coordinate(
        &self,
        motion: &SegmentedMotion,
        at: &Instant<'_>,
        sample: &TrajectorySample,
    ) -> Option<[f64; 3]> {
        let history = &motion.actuator_coordinates;
        match *at {
            Instant::Picked(segment, Picked::Steps, k) => {
                history.steps.get(segment)?.get(k).copied()
            }
            Instant::Picked(segment, Picked::Samples, k) => {
                history.samples.get(segment)?.get(k).copied()
            }
            Instant::Within(segment, step, point) => {
                let [q, q_dot, _] = *history.steps.get(segment)?.get(step)?;
                let actuator = self.loaded_scene.mechanism.actuators[0].coordinate();
                let measured = CoordinateFunction::find(&self.loaded_scene.mechanism, actuator)?;
                let machine = self.machine_in(motion, sample.chart);
                let mut workspace = machine.workspace();
                let mut state = machine.evaluate(point.t, &point.y, &mut workspace).ok()?;
                let mut now = state.bodies().coordinate(measured);
                if let CoordinateFunction::Angle(_) = measured {
                    let before = &motion.segments[segment].1.steps[step];
                    let near = q + 0.5 * (q_dot + now[1]) * (point.t - before.t);
                    now[0] += TAU * ((near - now[0]) / TAU).round();
                }
                Some(now)
            }
        }
    }

    fn describe_changes(&self, motion: &SegmentedMotion) -> Vec<String> {
        motion.chart_changes.clone()
    }

    fn coordinates_at(&self, motion: &SegmentedMotion, event: &NumberedEvent) -> Option<Vec<f64>> {
        let mechanism = &self.loaded_scene.mechanism;
        let machine = self.machine_in(motion, event.chart);
        let (at, mut workspace) = (&event.state, machine.workspace());
        let state = machine.evaluate(at.t, &at.y, &mut workspace).ok()?;
        let coordinates = mechanism.actuators.iter().flat_map(|actuator| {
            let measured = CoordinateFunction::find(mechanism, actuator.coordinate());
            measured.map_or([f64::NAN; 2], |measured| state.coordinate(measured))
        });
        Some(coordinates.collect())
    }

    fn explain_end(&self, motion: &SegmentedMotion, error: &DynamicsError) -> StudyError {
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
