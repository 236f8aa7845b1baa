//! The initial value problem of a scene's free motion, and its integration.

use crate::explain::{StudyError, explain_machine, explain_model, explain_motion};
use crate::free_motion::compute::SegmentedMotion;
use crate::models::{build_machine, loaded_model};
use crate::number_format::digits;
use crate::trajectory::compute::check_variables;
use dwell_dynamics::atlas::{
    Atlas, AtlasError, ChartChangeReason, ContinuedMotion, MachineDescription,
};
use dwell_dynamics::{
    DynamicsError, Event, EventKind, Machine, OdeState, Options, Orbit, ReducedState, solve,
};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{Coordinate, Reaction};
use dwell_kinetostatics::Model;
use dwell_scene::{EventTrigger, FreeMotionSpec, MotionDuration, Scene, SceneLocation};
use std::num::NonZeroUsize;

/// Maximum number of chart changes that a summary lists.
pub(crate) const MAX_LISTED: usize = 6;

/// The initial value problem of a scene's free motion.
pub struct FreeMotionProblem<'a> {
    /// The scene with the loads of its drives added.
    pub(crate) loaded_scene: &'a Scene,
    pub(crate) spec: &'a FreeMotionSpec,
    /// The model with all loads and reactions, for outputs.
    pub(crate) output_model: Model,
    /// A line for each requested column that is called by a former name.
    pub(crate) notes: String,
    /// The equations of motion.
    pub machine: Machine,
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
        let notes = check_variables(loaded_scene, &output_model)?;
        let machine = build_machine(scene, spec, &[])?;
        Ok(Self {
            loaded_scene,
            spec,
            output_model,
            notes,
            machine,
        })
    }

    /// Integrates the motion: with one degree of freedom across charts, else in its own coordinates.
    pub fn solve(
        &self,
        scene: &Scene,
        duration: f64,
        options: &Options,
    ) -> Result<SegmentedMotion, StudyError> {
        let explain =
            |e: &DynamicsError| explain_motion(self.loaded_scene, self.output_model.plan(), e);
        let (start, events) = (self.initial_state(), self.events());
        if self.spec.laws.len() != 1 || self.machine.free().len() != 1 {
            let solution = solve(
                &self.machine,
                &self.output_model,
                &start,
                duration,
                options,
                &events,
            );
            let solution = solution.map_err(|e| explain(&e))?;
            return Ok(SegmentedMotion::single_segment(solution));
        }
        let configuration = scene.assembly.to_configuration();
        let description = MachineDescription {
            mechanism: &scene.mechanism,
            masses: &scene.masses,
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
        let continued = continued.map_err(|e| explain(&e))?;
        let actuator_coordinates =
            atlas.coordinate_history(&continued, atlas.actuator_coordinate());
        let actuator_coordinates = actuator_coordinates.map_err(|e| explain(&e))?.samples;
        let statistics = continued.statistics();
        Ok(SegmentedMotion {
            chart_changes: self.describe_changes(&atlas, &continued),
            charts: atlas.charts().to_vec(),
            actuator_coordinates,
            failure: continued.error,
            statistics,
            segments: continued
                .segments
                .into_iter()
                .map(|segment| (segment.chart, segment.solution))
                .collect(),
        })
    }

    /// Lines of the summary about chart changes and change points.
    pub(crate) fn describe_changes(
        &self,
        atlas: &Atlas<'_>,
        continued: &ContinuedMotion,
    ) -> Vec<String> {
        let mut descriptions = Vec::new();
        let name = |chart: usize| atlas.charts()[chart].name.clone();
        for change in continued.changes.iter().take(MAX_LISTED) {
            let t = digits(change.t, 6);
            descriptions.push(match change.reason {
                ChartChangeReason::CrossesChangePoint { .. } => {
                    format!("t = {t} s: change point crossed")
                }
                ChartChangeReason::CoordinateFold { .. } | ChartChangeReason::SolutionEnds => {
                    format!(
                        "t = {t} s: coordinate changed from {} (at its dead point) to {}",
                        name(change.from),
                        name(change.to)
                    )
                }
            });
        }
        if continued.changes.len() > MAX_LISTED {
            descriptions.push(format!(
                "and {} more changes",
                continued.changes.len() - MAX_LISTED
            ));
        }
        for fit in atlas.change_point_fits() {
            let indeterminate: Vec<String> = fit
                .indeterminate
                .iter()
                .map(|&r| self.loaded_scene.mechanism.reaction_name(r))
                .collect();
            let indeterminate = if indeterminate.is_empty() {
                String::new()
            } else {
                format!("; indeterminate there: {}", indeterminate.join(", "))
            };
            descriptions.push(format!(
                "change point at {}: crossed by a polynomial fit within ±{}; {} degrees of freedom there{indeterminate}",
                digits(fit.center, 6),
                digits(fit.half_width, 3),
                fit.mobility,
            ));
        }
        for (q, error) in atlas.uncrossable() {
            descriptions.push(format!(
                "the change point at {} cannot be crossed: {error}",
                digits(*q, 6)
            ));
        }
        descriptions
    }

    /// The machine of a chart.
    pub(crate) fn machine<'m>(&'m self, motion: &'m SegmentedMotion, chart: usize) -> &'m Machine {
        motion
            .charts
            .get(chart)
            .map_or(&self.machine, |c| &c.machine)
    }

    pub(crate) fn initial_state(&self) -> OdeState {
        OdeState {
            t: 0.0,
            y: self.machine.initial_state(
                &self.spec.initial_coordinates,
                &self.spec.initial_velocities,
            ),
        }
    }

    /// The duration of the motion, s.
    pub fn duration(&self) -> Result<f64, StudyError> {
        let periods = match self.spec.duration {
            MotionDuration::Seconds(duration) => return Ok(duration),
            MotionDuration::Periods(periods) => periods,
        };
        match Orbit::loaded(&self.machine, self.initial_reduced_state()) {
            Ok(orbit) => Ok(periods * orbit.period),
            Err(DynamicsError::NotConservative { .. }) => {
                let labels = [(SceneLocation::Duration, "a period is needed".to_owned())];
                let help = "give a `duration` in s".to_owned();
                let message =
                    "the motion is not conservative, so its period is not known in advance";
                let error = self
                    .loaded_scene
                    .error(message.to_owned(), Some(help), &labels);
                Err(error.into())
            }
            Err(e) => Err(explain_motion(
                self.loaded_scene,
                self.output_model.plan(),
                &e,
            )),
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
        let reaction_index = |r: Reaction| {
            self.output_model
                .reactions()
                .iter()
                .position(|&candidate| candidate == r)
        };
        let event = |named: &dwell_scene::NamedEvent| {
            let trigger = match named.trigger {
                EventTrigger::Reaches(c, value) => EventKind::Reaches(find(c)?, value),
                EventTrigger::Reversal(c) => EventKind::Reversal(find(c)?),
                EventTrigger::Revolution(c) => EventKind::Revolution(find(c)?),
                EventTrigger::Reaction(r, value) => EventKind::Reaction(reaction_index(r)?, value),
            };
            Some(Event {
                kind: trigger,
                terminal: named.terminal.then_some(NonZeroUsize::MIN),
            })
        };
        self.spec.events.iter().filter_map(event).collect()
    }
}
