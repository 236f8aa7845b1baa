//! The interface of the study to scenes in the plane and in space.

use crate::cases::reference::Reference;
use crate::checked::free_motion_setup::FreeMotionSetup;
use crate::spatial::all_reactions;
use dwell_dynamics::{
    DynamicsError, Event, EventKind, Machine, OdeState, Options, TabulatedMachine, TabulationError,
    solve,
};
use dwell_findings::Table;
use dwell_geometry::space::CoordinateFunction;
use dwell_kinetostatics::TableDomain;
use dwell_kinetostatics::space::{Axes, Model as SpaceModel};
use dwell_scene::{Dimensions, FreeMotionSpec, MotionDuration, PlaneScene, SceneIn, SpaceScene};
use dwell_study::explain::NamedScene;
use dwell_study::free_motion::compute::{FreeMotionProblem, MotionProblem as _};
use dwell_study::machines::MachineScene as _;
use dwell_study::models::{pruned_machine, with_drive_loads};
use dwell_study::{
    MotionSolver, StudyError, StudyScene, compute_free_motion, compute_period, no_progress,
};
use std::f64::consts::TAU;
use std::num::NonZeroUsize;

/// Smallest distance of a studied motion from a limit position, relative to the range.
const NEAR_LIMIT: f64 = 0.02;

/// A motion before its duration is bounded.
#[derive(Debug)]
pub struct PreliminaryRun {
    /// The steps in its own coordinate.
    pub(super) steps: Vec<OdeState>,
    /// Whether it stays in this coordinate.
    pub(super) has_one_chart: bool,
    /// The reason if it ended early.
    pub(super) failure: Option<DynamicsError>,
}

/// A motion computed by the command.
#[derive(Debug)]
pub struct CommandedMotion {
    /// Its method.
    pub(super) method: String,
    /// Its stated error.
    pub(super) estimated_error: Option<f64>,
    /// Whether it reaches its end within the accuracy.
    pub(super) is_reached: bool,
    /// Its rows.
    pub(super) table: Table,
}

impl CommandedMotion {
    /// Computes a motion without files, as `dwell simulate --accuracy` does.
    ///
    /// # Errors
    /// [`StudyError`] if the motion cannot be computed.
    pub(super) fn new<S: StudyScene>(scene: &S, accuracy: f64) -> Result<Self, StudyError> {
        let solver = MotionSolver::Accuracy {
            accuracy,
            sample_interval: None,
        };
        let motion = compute_free_motion(scene, &solver, &no_progress)?;
        let computed = motion.computed;
        Ok(Self {
            method: computed.trajectory.method_text,
            estimated_error: motion.estimated_error,
            is_reached: computed.early_stop.is_none(),
            table: computed.table,
        })
    }
}

/// A scene whose motion is studied, in the plane or in space.
pub trait StudiedScene: StudyScene {
    /// The scene with a motion: its own, or a free motion from the assembly.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if the mechanism cannot be assembled.
    fn with_free_motion(&self) -> Result<Self, StudyError>;

    /// The compared reactions: all that equilibrium determines.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if the mechanism has no pose.
    fn compared_reactions(&self, model: &Self::Model) -> Result<Vec<Self::Reaction>, StudyError>;

    /// The duration of its motion, s.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if it follows from an unknown period.
    fn duration(&self) -> Result<f64, StudyError>;

    /// Its machine without idle groups, and their number; in space all groups are evaluated.
    ///
    /// # Errors
    /// [`StudyError`] if the scene cannot be assembled.
    fn pruned_machine(&self) -> Result<(Machine<Self::Model>, usize), StudyError>;

    /// Integrates the motion once.
    ///
    /// # Errors
    /// [`StudyError`] if the initial state cannot be evaluated.
    fn preliminary_run(
        &self,
        machine: &Machine<Self::Model>,
        start: &OdeState,
        end: f64,
        options: &Options,
    ) -> Result<PreliminaryRun, StudyError>;

    /// Its machine on a table; `None` if such machines have no tables.
    fn tabulated(
        machine: &Machine<Self::Model>,
        accuracy: f64,
        domain: TableDomain,
    ) -> Option<Result<TabulatedMachine, TabulationError>>;

    /// A copy of the scene with a motion of another duration, s, and all coordinates and speeds in its table.
    fn lasting(&self, duration: f64) -> Self;
}

/// Events slightly before the limit positions of the only coordinate of a scene in space, which end a motion.
fn range_ends(scene: &SpaceScene, machine: &Machine<SpaceModel>) -> Vec<Event<CoordinateFunction>> {
    let plan = machine.model().plan();
    let ([actuator], [0], Some((from, to))) = (
        &scene.mechanism.actuators[..],
        machine.free(),
        plan.range().limits(),
    ) else {
        return Vec::new();
    };
    let joint = &scene.mechanism.joints[actuator.kind.joint().0];
    let coordinate = actuator.kind.coordinate(joint);
    let Ok(coordinate) = plan.coordinate_function(&scene.mechanism, coordinate) else {
        return Vec::new();
    };
    let margin = NEAR_LIMIT * (to - from);
    let ends = [from + margin, to - margin]
        .into_iter()
        .zip(plan.range_ends())
        .filter(|(_, found)| *found);
    let event = |(q, _): (f64, bool)| Event {
        kind: EventKind::Reaches(coordinate, q),
        terminal: Some(NonZeroUsize::MIN),
    };
    ends.map(event).collect()
}

/// A copy of a scene with a motion of another duration, s, and all coordinates and speeds in its table.
fn lasting<D: Dimensions>(scene: &SceneIn<D>, duration: f64) -> SceneIn<D>
where
    SceneIn<D>: NamedScene,
{
    let mut lasting = scene.clone();
    if let Some(motion) = &mut lasting.motion {
        motion.duration = MotionDuration::Seconds(duration);
    }
    // Without a list all columns are there.
    if let Some(columns) = &mut lasting.requests.variables {
        let names = (0..).map_while(|i| scene.actuator(i));
        let states = names.flat_map(|(name, _)| [name.to_owned(), format!("{name}.velocity")]);
        for state in states {
            if !columns.contains(&state) {
                columns.push(state);
            }
        }
    }
    lasting
}

impl StudiedScene for PlaneScene {
    fn with_free_motion(&self) -> Result<Self, StudyError> {
        if self.motion.is_some() {
            return Ok(self.clone());
        }
        Ok(FreeMotionSetup::new(self, &Reference::default())?.scene)
    }

    fn compared_reactions(&self, model: &Self::Model) -> Result<Vec<Self::Reaction>, StudyError> {
        let all = self.mechanism.reactions().into_iter().enumerate();
        let determinate = all.filter(|&(k, _)| model.plan().is_determinate(k));
        Ok(determinate.map(|(_, reaction)| reaction).collect())
    }

    fn pruned_machine(&self) -> Result<(Machine, usize), StudyError> {
        pruned_machine(self, &self.motion_start().laws)
    }

    fn duration(&self) -> Result<f64, StudyError> {
        let Some(motion) = &self.motion else {
            return Ok(0.0);
        };
        let with_drives = with_drive_loads(self)?;
        FreeMotionProblem::new(self, &with_drives, motion)?.duration()
    }

    fn preliminary_run(
        &self,
        _: &Machine<Self::Model>,
        _: &OdeState,
        end: f64,
        options: &Options,
    ) -> Result<PreliminaryRun, StudyError> {
        let Some(motion) = &self.motion else {
            return Ok(PreliminaryRun {
                steps: Vec::new(),
                has_one_chart: true,
                failure: None,
            });
        };
        let with_drives = with_drive_loads(self)?;
        let problem = FreeMotionProblem::new(self, &with_drives, motion)?;
        let run = problem.solve(end, options)?;
        let has_one_chart = run.segments.len() == 1;
        let mut segments = run.segments.into_iter();
        Ok(PreliminaryRun {
            steps: segments.next().map_or_else(Vec::new, |(_, s)| s.steps),
            has_one_chart,
            failure: run.failure,
        })
    }

    fn tabulated(
        machine: &Machine,
        accuracy: f64,
        domain: TableDomain,
    ) -> Option<Result<TabulatedMachine, TabulationError>> {
        Some(TabulatedMachine::new(machine, accuracy, domain))
    }

    fn lasting(&self, duration: f64) -> Self {
        lasting(self, duration)
    }
}

impl StudiedScene for SpaceScene {
    fn with_free_motion(&self) -> Result<Self, StudyError> {
        let mut scene = self.clone();
        if scene.motion.is_some() || self.mechanism.actuators.is_empty() {
            return Ok(scene);
        }
        // From the assembly, at one rad/s or m/s of the first actuator: about a revolution, or over the size.
        let is_angle = self.actuator(0).is_none_or(|(_, is_angle)| is_angle);
        let machine = self.machine(&[])?;
        let travel = if is_angle {
            TAU
        } else {
            dwell_kinetostatics::MachineModel::size(machine.model())
        };
        let count = self.assembly.q.len();
        let mut velocities = vec![0.0; count];
        velocities[0] = 1.0;
        scene.motion = Some(FreeMotionSpec {
            initial_coordinates: self.assembly.q.clone(),
            initial_velocities: velocities,
            laws: vec![None; count],
            duration: MotionDuration::Seconds(travel),
            events: Vec::new(),
        });
        Ok(scene)
    }

    fn compared_reactions(&self, model: &Self::Model) -> Result<Vec<Self::Reaction>, StudyError> {
        // All in the axes of the ground, those that a joint cannot transmit among them: they are zero.
        let mut scene = self.clone();
        scene.requests.reactions = all_reactions(self, &[Axes::Ground]);
        let [determined, _] = scene.sorted_reactions(model)?;
        Ok(determined)
    }

    fn pruned_machine(&self) -> Result<(Machine<SpaceModel>, usize), StudyError> {
        Ok((self.machine(&[])?, 0))
    }

    fn duration(&self) -> Result<f64, StudyError> {
        match self.motion.as_ref().map(|motion| motion.duration) {
            None => Ok(0.0),
            Some(MotionDuration::Seconds(seconds)) => Ok(seconds),
            Some(MotionDuration::Periods(periods)) => Ok(periods * compute_period(self)?.period),
        }
    }

    fn preliminary_run(
        &self,
        machine: &Machine<Self::Model>,
        start: &OdeState,
        end: f64,
        options: &Options,
    ) -> Result<PreliminaryRun, StudyError> {
        let ends = range_ends(self, machine);
        let solution = solve(machine, machine.model(), start, end, options, &ends)
            .map_err(|e| self.explain(machine.model(), &e))?;
        Ok(PreliminaryRun {
            steps: solution.steps,
            has_one_chart: !solution.terminated_by_event,
            failure: solution.error,
        })
    }

    fn tabulated(
        _: &Machine<Self::Model>,
        _: f64,
        _: TableDomain,
    ) -> Option<Result<TabulatedMachine, TabulationError>> {
        None
    }

    fn lasting(&self, duration: f64) -> Self {
        lasting(self, duration)
    }
}
