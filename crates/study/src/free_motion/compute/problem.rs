//! The initial value problem of a scene's free motion, and its integration.

use crate::branch_note::branch_note;
use crate::explain::{
    StudyError, explain_machine, explain_model, explain_motion, explain_position_in, scene_error,
};
use crate::free_motion::compute::SegmentedMotion;
use crate::models::{build_machine, loaded_model};
use crate::number_format::digits;
use crate::trajectory::compute::check_variables;
use dwell_dynamics::atlas::{
    Atlas, AtlasError, ChartChange, ChartChangeReason, ContinuedMotion, CoordinateHistory,
    MachineDescription,
};
use dwell_dynamics::{
    DynamicsError, Event, EventKind, Machine, OdeState, Options, Orbit, ReducedState, Solution,
    solve,
};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{Coordinate, Reaction};
use dwell_kinetostatics::Model;
use dwell_scene::{EventTrigger, FreeMotionSpec, MotionDuration, NamedEvent, Scene, SceneLocation};
use std::num::NonZeroUsize;

/// Maximum number of chart changes that a summary lists.
pub(crate) const MAX_LISTED: usize = 6;

/// The initial value problem of a scene's free motion.
pub struct FreeMotionProblem<'a> {
    /// The scene with the loads of its drives added.
    pub(crate) loaded_scene: &'a Scene,
    pub(crate) spec: &'a FreeMotionSpec,
    /// The model with all loads and reactions, for outputs.
    pub output_model: Model,
    /// A line for each requested column that is called by a former name.
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
        scene: &Scene,
        loaded_scene: &'a Scene,
        spec: &'a FreeMotionSpec,
    ) -> Result<Self, StudyError> {
        let output_model = loaded_model(loaded_scene)?;
        let notes = check_variables(scene, &output_model)?
            + &branch_note(loaded_scene, output_model.plan());
        let machine = build_machine(scene, spec, &[])?;
        let reactions = &scene.requests.reactions;
        let impact_machine =
            (!scene.stops.is_empty()).then(|| build_machine(scene, spec, reactions));
        Ok(Self {
            impact_machine: impact_machine.transpose()?,
            loaded_scene,
            spec,
            output_model,
            notes,
            machine,
        })
    }

    /// An error of its motion in the names of the scene.
    pub fn explain(&self, error: &DynamicsError) -> StudyError {
        explain_motion(self.loaded_scene, self.output_model.plan(), error)
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
            _ => self.explain(error),
        }
    }

    /// Ends a motion before its first sample that the mechanism cannot take, be it by rounding: an implicit method may
    /// stay at the end of the range of several coordinates.
    fn end_where_impossible(&self, solution: &mut Solution) {
        let mut workspace = self.machine.workspace();
        let mut failure = |at: &OdeState| {
            let evaluated = self.machine.evaluate(at.t, &at.y, &mut workspace);
            evaluated.err().map(|e| (at.t, e))
        };
        let Some((t, error)) = solution.samples.iter().find_map(&mut failure) else {
            return;
        };
        solution.samples.retain(|s| s.t < t);
        solution.event_occurrences.retain(|o| o.state.t < t);
        solution.steps.retain(|s| s.t < t);
        while let Some((t, _)) = solution.steps.last().and_then(&mut failure) {
            solution.steps.retain(|s| s.t < t);
        }
        // The last sample may be in a step whose end is impossible: the motion ends with it.
        let last_step = solution.steps.last().map_or(f64::NEG_INFINITY, |s| s.t);
        let end = solution.samples.last().filter(|last| last.t > last_step);
        solution.steps.extend(end.cloned());
        solution.error = Some(error);
    }

    /// Integrates the motion: with one degree of freedom across charts, else in its own coordinates.
    pub fn solve(
        &self,
        scene: &Scene,
        duration: f64,
        options: &Options,
    ) -> Result<SegmentedMotion, StudyError> {
        let (start, events) = (self.initial_state(), self.events());
        // An end stop is one of the mechanism's own coordinate, in which the motion stays.
        let has_stops = !scene.stops.is_empty();
        if has_stops || self.spec.laws.len() != 1 || self.machine.free().len() != 1 {
            let (machine, output) = (&self.machine, &self.output_model);
            let solution = solve(machine, output, &start, duration, options, &events);
            let mut solution = solution.map_err(|e| self.explain(&e))?;
            self.end_where_impossible(&mut solution);
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
        let listed = continued.changes.iter().take(MAX_LISTED);
        let mut descriptions: Vec<String> = listed.map(describe).collect();
        if continued.changes.len() > MAX_LISTED {
            let more = continued.changes.len() - MAX_LISTED;
            descriptions.push(format!("and {more} more changes"));
        }
        for fit in atlas.change_point_fits() {
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

    /// The machine of a chart.
    pub(crate) fn machine<'m>(&'m self, motion: &'m SegmentedMotion, chart: usize) -> &'m Machine {
        let chart = motion.charts.get(chart);
        chart.map_or(&self.machine, |c| &c.machine)
    }

    /// The initial state of its machine.
    pub fn initial_state(&self) -> OdeState {
        let spec = self.spec;
        let (q, q_dot) = (&spec.initial_coordinates, &spec.initial_velocities);
        let y = self.machine.initial_state(q, q_dot);
        OdeState { t: 0.0, y }
    }

    /// The duration of the motion, s.
    pub fn duration(&self) -> Result<f64, StudyError> {
        let periods = match self.spec.duration {
            MotionDuration::Seconds(duration) => return Ok(duration),
            MotionDuration::Periods(periods) => periods,
        };
        match Orbit::loaded(&self.machine, self.initial_reduced_state()) {
            Ok(orbit) => Ok(periods * orbit.period),
            Err(DynamicsError::NotConservative { .. }) => Err(scene_error(
                self.loaded_scene,
                "the motion is not conservative, so its period is not known in advance",
                "give a `duration` in s",
                [(SceneLocation::Duration, "a period is needed")],
            )),
            Err(e) => Err(self.explain(&e)),
        }
    }

    /// The initial state of the first free coordinate.
    pub fn initial_reduced_state(&self) -> ReducedState {
        let first = self.machine.free().first().copied().unwrap_or(0);
        ReducedState {
            t: 0.0,
            q: self.spec.initial_coordinates[first],
            q_dot: self.spec.initial_velocities[first],
        }
    }

    /// The scene's events, in their order.
    pub(crate) fn events(&self) -> Vec<Event> {
        let mechanism = &self.loaded_scene.mechanism;
        let find = |c: Coordinate| CoordinateFunction::find(mechanism, c);
        let reactions = self.output_model.reactions();
        let reaction_index = |r: Reaction| reactions.iter().position(|&other| other == r);
        let event = |named: &NamedEvent| {
            let kind = match named.trigger {
                EventTrigger::Reaches(c, value) => EventKind::Reaches(find(c)?, value),
                EventTrigger::Reversal(c) => EventKind::Reversal(find(c)?),
                EventTrigger::Revolution(c) => EventKind::Revolution(find(c)?),
                EventTrigger::Reaction(r, value) => EventKind::Reaction(reaction_index(r)?, value),
            };
            Some(Event {
                kind,
                terminal: named.terminal.then_some(NonZeroUsize::MIN),
            })
        };
        self.spec.events.iter().filter_map(event).collect()
    }
}
