//! What the initial value problems of free motions in the plane and in space have in common.

use crate::explain::{NamedScene as _, StudyError, missing_section_label, scene_error};
use crate::machines::{CoordinateOf, MachineScene};
use crate::number_format::{coordinate_unit, digits};
use dwell_dynamics::{DynamicsError, Event, EventKind, Machine, OdeState, Orbit, ReducedState};
use dwell_kinetostatics::MachineModel as _;
use dwell_scene::{
    EventTrigger, FreeMotionSpec, MotionDuration, NamedEvent, SceneFile, SceneLocation,
};
use std::num::NonZeroUsize;

/// The model of a scene's machine.
pub(crate) type ModelOf<S> = <S as MachineScene>::Model;

/// The initial value problem of a scene's free motion.
pub trait MotionProblem {
    /// The kind of scene.
    type Scene: MachineScene;

    /// The scene; in the plane with the loads of its drives.
    fn scene(&self) -> &Self::Scene;

    /// Its motion.
    fn spec(
        &self,
    ) -> &FreeMotionSpec<CoordinateOf<Self::Scene>, <Self::Scene as MachineScene>::Reaction>;

    /// The equations of motion.
    fn machine(&self) -> &Machine<ModelOf<Self::Scene>>;

    /// Where there are end stops, the same with the requested reactions, for their impulses, and the number of these.
    fn impact_machine(&self) -> Option<(&Machine<ModelOf<Self::Scene>>, usize)>;

    /// An error of its motion in the names of the scene.
    fn explain(&self, error: &DynamicsError) -> StudyError;

    /// Whether an actuator drives an angle.
    fn is_angle(&self, actuator: usize) -> bool {
        self.machine().model().is_angle(actuator)
    }

    /// Name and unit of the coordinate of an actuator.
    fn named_coordinate(&self, actuator: usize) -> (&str, &'static str) {
        let name = self.scene().actuator(actuator).map_or("", |(name, _)| name);
        (name, coordinate_unit(self.is_angle(actuator)))
    }

    /// The explained error of a position at which a motion of several coordinates ends, with the instant and all of them.
    fn with_instant(
        &self,
        error: &DynamicsError,
        explained: StudyError,
        last: Option<&OdeState>,
    ) -> StudyError {
        let free = self.machine().free();
        match (explained, error, last) {
            (StudyError::Scene(mut scene), DynamicsError::Position(_), Some(last))
                if free.len() > 1 && last.t > 0.0 =>
            {
                let values = free.iter().zip(&last.y).map(|(&i, &q)| {
                    let (name, unit) = self.named_coordinate(i);
                    format!("`{name}` = {} {unit}", digits(q, 6))
                });
                let (t, at) = (digits(last.t, 6), values.collect::<Vec<_>>().join(", "));
                scene.message = format!(
                    "the motion cannot continue after t = {t} s, at {at}: {}",
                    scene.message
                );
                StudyError::Scene(scene)
            }
            (explained, ..) => explained,
        }
    }

    /// The initial state of its machine.
    fn initial_state(&self) -> OdeState {
        let spec = self.spec();
        let (q, q_dot) = (&spec.initial_coordinates, &spec.initial_velocities);
        let y = self.machine().initial_state(q, q_dot);
        OdeState { t: 0.0, y }
    }

    /// The initial state of the first free coordinate.
    fn initial_reduced_state(&self) -> ReducedState {
        let first = self.machine().free().first().copied().unwrap_or(0);
        ReducedState {
            t: 0.0,
            q: self.spec().initial_coordinates[first],
            q_dot: self.spec().initial_velocities[first],
        }
    }

    /// The orbit of a conservative motion of one coordinate that starts with a multiple of its speed.
    ///
    /// # Errors
    /// [`DynamicsError`] where the motion is not conservative or does not repeat itself.
    fn orbit(&self, speed_factor: f64) -> Result<Orbit, DynamicsError> {
        let start = self.initial_reduced_state();
        let q_dot = start.q_dot * speed_factor;
        Orbit::loaded(self.machine(), ReducedState { q_dot, ..start })
    }

    /// The duration of the motion, s.
    ///
    /// # Errors
    /// [`StudyError::Scene`] where it is given in periods and has none.
    fn duration(&self) -> Result<f64, StudyError> {
        let periods = match self.spec().duration {
            MotionDuration::Seconds(duration) => return Ok(duration),
            MotionDuration::Periods(periods) => periods,
        };
        match self.orbit(1.0) {
            Ok(orbit) => Ok(periods * orbit.period),
            Err(DynamicsError::NotConservative { .. }) => Err(scene_error(
                self.scene(),
                "the motion is not conservative, so its period is not known in advance",
                "give a `duration` in s",
                [(SceneLocation::Duration, "a period is needed")],
            )),
            Err(error) => Err(self.explain(&error)),
        }
    }

    /// Where the error of the energy balance is among the extra values of a sample.
    fn balance_index(&self) -> usize {
        2 + self.machine().nonconservative_sources().len()
    }
}

/// The motion of a scene that is to be simulated.
///
/// # Errors
/// [`StudyError::Scene`] where it has none.
pub(crate) fn motion_to_simulate<'s, C, R>(
    scene: &SceneFile,
    motion: Option<&'s FreeMotionSpec<C, R>>,
) -> Result<&'s FreeMotionSpec<C, R>, StudyError> {
    motion.ok_or_else(|| {
        scene_error(
            scene,
            "the scene has no [motion] to simulate",
            "add [motion] with `initial-velocity`, and `periods` or `duration`",
            missing_section_label("motion"),
        )
    })
}

/// An event of a scene as a machine locates it, from its coordinates and reactions as they are compiled.
///
/// # Errors
/// That of a coordinate or a reaction.
pub(crate) fn compiled_event<C: Copy, R: Copy, F, E>(
    named: &NamedEvent<C, R>,
    coordinate: impl Fn(C) -> Result<F, E>,
    reaction: impl Fn(R) -> Result<usize, E>,
) -> Result<Event<F>, E> {
    let kind = match named.trigger {
        EventTrigger::Reaches(c, value) => EventKind::Reaches(coordinate(c)?, value),
        EventTrigger::Reversal(c) => EventKind::Reversal(coordinate(c)?),
        EventTrigger::Revolution(c) => EventKind::Revolution(coordinate(c)?),
        EventTrigger::Reaction(r, value) => EventKind::Reaction(reaction(r)?, value),
    };
    Ok(Event {
        kind,
        terminal: named.terminal.then_some(NonZeroUsize::MIN),
    })
}
