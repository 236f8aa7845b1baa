//! The initial value problem of a free motion of a scene in space.

use super::charts::OfChart;
use crate::explain::{StudyError, scene_error};
use crate::free_motion::compute::{
    MotionProblem, MotionSolver, compiled_event, motion_to_simulate,
};
use crate::machines::MachineScene;
use crate::space::explain::{explain_position, with_loads};
use crate::space::prepared::compile;
use crate::space::trajectory::SpaceRows;
use dwell_dynamics::{DynamicsError, Event, Machine};
use dwell_kinetostatics::MachineModel as _;
use dwell_kinetostatics::space::{Coordinate, CoordinateFunction, Model, Reaction};
use dwell_scene::{EventTrigger, FreeMotionSpec, NamedEvent, SceneLocation, SpaceScene};
use std::borrow::Cow;

/// The tolerance of the fits across change points where an accuracy is required, as a part of it.
const TOLERANCE_OF_ACCURACY: f64 = 1e-2;

/// The motion of a scene.
pub(super) type Spec = FreeMotionSpec<Coordinate, Reaction>;

/// The initial value problem of a scene's free motion.
pub(crate) struct SpaceMotionProblem<'a> {
    scene: Cow<'a, SpaceScene>,
    pub(super) spec: Spec,
    /// Of the same scene driven at another joint.
    pub(super) chart: Option<OfChart>,
    /// The tolerance to which its machine crosses change points, if it has one.
    pub(super) tolerance: Option<f64>,
    /// The model for outputs with all loads, and its reactions.
    pub(in crate::space) rows: SpaceRows,
    /// The equations of motion.
    pub(in crate::space) machine: Machine<Model>,
    /// The same with the requested reactions, for their impulses where there are end stops.
    pub(super) impact_machine: Option<Machine<Model>>,
    /// The model whose reactions events are about.
    pub(super) event_model: Model,
    pub(super) events: Vec<Event<CoordinateFunction>>,
}

impl<'a> SpaceMotionProblem<'a> {
    /// Compiles a scene.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when it has no motion, or its machine cannot be built.
    pub(crate) fn new(scene: &'a SpaceScene) -> Result<Self, StudyError> {
        Self::compiled(Cow::Borrowed(scene), None)
    }

    /// The same with reactions that are sorted already.
    pub(super) fn compiled(
        scene: Cow<'a, SpaceScene>,
        sorted: Option<&SpaceRows>,
    ) -> Result<Self, StudyError> {
        let spec = motion_to_simulate(&scene, scene.motion.as_ref())?.clone();
        let rows = match sorted {
            None => SpaceRows::new(&scene)?,
            Some(rows) => rows.of_chart(&scene)?,
        };
        let of_events = spec.events.iter().filter_map(|event| match event.trigger {
            EventTrigger::Reaction(reaction, _) => Some(reaction),
            EventTrigger::Reaches(..) | EventTrigger::Reversal(_) | EventTrigger::Revolution(_) => {
                None
            }
        });
        let of_events: Vec<Reaction> = of_events.collect();
        let event_model = with_loads(&scene, compile(&scene, &of_events)?)?;
        let has_impacts = !scene.stops.is_empty();
        let impact_machine = has_impacts.then(|| scene.machine(&rows.requested));
        let mut problem = Self {
            machine: scene.machine(&[])?,
            scene,
            spec,
            chart: None,
            tolerance: None,
            impact_machine: impact_machine.transpose()?,
            rows,
            events: Vec::new(),
            event_model,
        };
        problem.require_determined(&of_events)?;
        problem.events = problem.compile_events(&of_events)?;
        Ok(problem)
    }

    /// The same for a solver: its machine crosses the change points of its branch to the tolerance of the solver.
    #[must_use]
    pub(crate) fn for_solver(self, solver: &MotionSolver) -> Self {
        let tolerance = match solver {
            MotionSolver::Settings(settings) => settings.rtol,
            MotionSolver::Accuracy { accuracy, .. } => TOLERANCE_OF_ACCURACY * accuracy,
        };
        self.with_tolerance(tolerance)
    }

    /// Refuses an event of a reaction that redundant constraints leave open.
    fn require_determined(&self, reactions: &[Reaction]) -> Result<(), StudyError> {
        let mut workspace = self.event_model.workspace();
        let determined = self
            .event_model
            .determined(&self.spec.initial_coordinates, &mut workspace);
        let determined =
            determined.map_err(|e| explain_position(self.scene(), self.event_model.plan(), &e))?;
        let open = reactions.iter().zip(determined).find(|(_, d)| !d);
        let Some((&reaction, _)) = open else {
            return Ok(());
        };
        let event = self.spec.events.iter().position(
            |event| matches!(event.trigger, EventTrigger::Reaction(r, _) if r == reaction),
        );
        let name = self.scene().reaction_name(reaction);
        Err(scene_error(
            self.scene(),
            format!(
                "the loads do not determine the reaction `{name}`: redundant constraints share them"
            ),
            "`dwell check` lists the reactions that are determined",
            [(
                SceneLocation::Event(event.unwrap_or(0)),
                "of an open reaction",
            )],
        ))
    }

    fn compile_events(
        &self,
        reactions: &[Reaction],
    ) -> Result<Vec<Event<CoordinateFunction>>, StudyError> {
        let one = |(k, named): (usize, &NamedEvent<Coordinate, Reaction>)| {
            let coordinate = |coordinate: Coordinate| {
                let found = self.event_model.coordinate_function(coordinate);
                found.map_err(|what| {
                    let message = format!("event `{}` cannot be located: {what}", named.name);
                    let help = "watch the coordinate of an actuator";
                    let place = (SceneLocation::Event(k), "here");
                    scene_error(self.scene(), message, help, [place])
                })
            };
            let reaction = |reaction: Reaction| {
                let index = reactions.iter().position(|&other| other == reaction);
                Ok(index.unwrap_or(0))
            };
            compiled_event(named, coordinate, reaction)
        };
        self.spec.events.iter().enumerate().map(one).collect()
    }
}

impl MotionProblem for SpaceMotionProblem<'_> {
    type Scene = SpaceScene;

    fn scene(&self) -> &SpaceScene {
        &self.scene
    }

    fn spec(&self) -> &Spec {
        &self.spec
    }

    fn machine(&self) -> &Machine<Model> {
        &self.machine
    }

    fn impact_machine(&self) -> Option<(&Machine<Model>, usize)> {
        let requested = self.rows.requested.len();
        Some((self.impact_machine.as_ref()?, requested))
    }

    fn explain(&self, error: &DynamicsError) -> StudyError {
        MachineScene::explain(self.scene(), &self.rows.model, error)
    }
}
