//! The motion that is studied: that of the scene, or one that the workbench sets, bounded so that a study takes
//! seconds.

use crate::cases::reference::Reference;
use crate::checked::free_motion_setup::FreeMotionSetup;
use crate::checked::multibody::with_drive_loads;
use dwell_dynamics::{DynamicsError, Machine, Method, OdeState, Options, Orbit, ReducedState};
use dwell_geometry::Reaction;
use dwell_kinetostatics::ExactModel;
use dwell_scene::{FreeMotionSpec, Scene, SceneLocation};
use dwell_study::StudyError;
use dwell_study::explain::explain_motion;
use dwell_study::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use dwell_study::models::build_machine;
use dwell_study::number_format::digits;
use std::f64::consts::TAU;

/// Periods of a motion that repeats itself, and turns or swings of another, at most.
const MAX_PERIODS: f64 = 3.0;
/// What is left of a motion that ends by itself: next to its end everything grows.
const KEPT_FRACTION: f64 = 0.9;
/// How the motion is looked at beforehand, and the most steps of that.
const PREVIEW_RUN: (Method, f64, usize) = (Method::Bdf, 1e-6, 20_000);
/// Times at which states are compared, spread evenly: no whole number to a period, three of which are followed.
const COMPARED_TIMES: usize = 50;

/// A motion to be studied.
pub(super) struct Subject {
    /// The scene, with a motion set by the workbench where it had none.
    pub(super) scene: Scene,
    /// The same with the loads through which its drives act.
    scene_with_drives: Scene,
    /// The equations of motion.
    pub(super) machine: Machine,
    /// The same with the reactions that are compared, its first ones.
    pub(super) output_machine: Machine,
    /// These reactions.
    pub(super) reactions: Vec<Reaction>,
    /// The reduced model with these reactions, of one freedom without loads.
    pub(super) reduced: Option<ExactModel>,
    pub(super) initial_state: OdeState,
    /// When states are compared, s; the last is the end.
    pub(super) times: Vec<f64>,
    /// The smallest and the largest value of the first free coordinate.
    pub(super) coordinate_range: [f64; 2],
    /// The motion by its energy, where that tells it.
    pub(super) orbit: Option<Orbit>,
    /// What is to be said of it.
    pub(super) notes: Vec<String>,
}

impl Subject {
    /// The motion of a scene.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the scene cannot be put together, nothing is free, or nothing moves.
    pub(super) fn new(scene: &Scene) -> Result<Self, StudyError> {
        let mut notes = Vec::new();
        let scene = with_free_motion(scene, &mut notes)?;
        let Some(motion) = scene.motion.clone() else {
            return Err(no_free_coordinate(&scene));
        };
        let scene_with_drives = with_drive_loads(&scene)?;
        let machine_without_reactions = build_machine(&scene, &motion, &[])?;
        if machine_without_reactions.free().is_empty() {
            return Err(no_free_coordinate(&scene));
        }
        let plan = machine_without_reactions.model().plan();
        let all = scene.mechanism.reactions().into_iter().enumerate();
        let determinate = all.filter(|&(k, _)| plan.is_determinate(k));
        let reactions: Vec<Reaction> = determinate.map(|(_, reaction)| reaction).collect();
        let output_machine = build_machine(&scene, &motion, &reactions)?;
        let start = OdeState {
            t: 0.0,
            y: machine_without_reactions
                .initial_state(&motion.initial_coordinates, &motion.initial_velocities),
        };
        let orbit = orbit(&machine_without_reactions, &motion);
        let (end, coordinate_range) = bound_duration(
            &scene,
            &scene_with_drives,
            &motion,
            orbit.as_ref(),
            &mut notes,
        )?;
        let subject = Self {
            reduced: reduced(&scene, &machine_without_reactions, &output_machine),
            times: times(end),
            scene,
            scene_with_drives,
            machine: machine_without_reactions,
            output_machine,
            reactions,
            initial_state: start,
            coordinate_range,
            orbit,
            notes,
        };
        subject.require_motion()?;
        Ok(subject)
    }

    /// The end of the motion, s.
    pub(super) fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// The start in the only coordinate.
    pub(super) fn reduced_state(&self) -> ReducedState {
        let [q, q_dot] = [
            self.initial_state.y[0],
            self.initial_state.y[self.machine.free().len()],
        ];
        ReducedState { t: 0.0, q, q_dot }
    }

    /// Unit of the free coordinates.
    pub(super) fn unit(&self) -> &'static str {
        let plan = self.machine.model().plan();
        let angles = self.machine.free().iter().filter(|&&i| plan.is_angle(i));
        match angles.count() {
            0 => "m",
            n if n == self.machine.free().len() => "rad",
            _ => "rad or m",
        }
    }

    /// Unit of each reaction.
    pub(super) fn reaction_unit(&self, k: usize) -> &'static str {
        self.reactions[k].component.unit()
    }

    pub(super) fn explain(&self, error: &DynamicsError) -> StudyError {
        explain_motion(&self.scene_with_drives, self.machine.model().plan(), error)
    }

    /// Refuses what stays at rest: all combinations would be exact.
    fn require_motion(&self) -> Result<(), StudyError> {
        let mut workspace = self.machine.workspace();
        let y = &self.initial_state.y;
        let state = self.machine.evaluate(0.0, y, &mut workspace);
        let state = state.map_err(|e| self.explain(&e))?;
        let free = self.machine.free();
        let is_moving = |&i: &usize| state.q_dot()[i] != 0.0 || state.q_ddot()[i] != 0.0;
        if free.iter().any(is_moving) {
            return Ok(());
        }
        Err(self.explain(&DynamicsError::AtRest))
    }
}

/// The times at which states are compared. The last is the end, to the last bit.
fn times(end: f64) -> Vec<f64> {
    let before = (1..COMPARED_TIMES).map(|k| end * k as f64 / COMPARED_TIMES as f64);
    before.chain([end]).collect()
}

/// The scene with a motion: its own, or one that the workbench sets.
fn with_free_motion(scene: &Scene, notes: &mut Vec<String>) -> Result<Scene, StudyError> {
    if scene.motion.is_some() {
        return Ok(scene.clone());
    }
    if scene.mechanism.actuators.is_empty() {
        return Err(no_free_coordinate(scene));
    }
    let free_scene = FreeMotionSetup::new(scene, &Reference::default())?.scene;
    let motion = free_scene.motion.iter();
    let initial_values = motion.flat_map(|m| {
        scene
            .mechanism
            .actuators
            .iter()
            .zip(&m.initial_velocities)
            .zip(&m.initial_coordinates)
    });
    let texts: Vec<String> = initial_values
        .filter(|((_, speed), _)| **speed != 0.0)
        .map(|((actuator, speed), start)| {
            let unit = if actuator.coordinate().is_angle() {
                "rad"
            } else {
                "m"
            };
            let [start, speed] = [start, speed].map(|&v| digits(v, 6));
            format!("{} = {start} {unit} with {speed} {unit}/s", actuator.name)
        })
        .collect();
    notes.push(format!(
        "the scene has no [motion]: it is set free at {}",
        texts.join(", ")
    ));
    Ok(free_scene)
}

/// Nothing can be followed.
fn no_free_coordinate(scene: &Scene) -> StudyError {
    let message = "nothing can move in this scene: no coordinate is free";
    let help = "declare the coordinate that moves, as in `[actuators.phi]`";
    let labels = [(
        SceneLocation::Whole,
        "no free actuator in this file".to_owned(),
    )];
    scene
        .error(message.to_owned(), Some(help.to_owned()), &labels)
        .into()
}

/// The motion by its energy. A machine with a state of more than one freedom has none.
fn orbit(machine: &Machine, motion: &FreeMotionSpec) -> Option<Orbit> {
    if machine.state_count() != 2 || motion.laws.len() != 1 {
        return None;
    }
    let [q, q_dot] = [motion.initial_coordinates[0], motion.initial_velocities[0]];
    Orbit::loaded(machine, ReducedState { t: 0.0, q, q_dot }).ok()
}

/// The reduced model with the reactions that are compared, where it is the whole equation of motion.
fn reduced(scene: &Scene, machine: &Machine, output_machine: &Machine) -> Option<ExactModel> {
    let unloaded = scene.loads.is_empty() && scene.drives.is_empty();
    let one = unloaded && machine.state_count() == 2 && machine.model().plan().actuators() == 1;
    one.then(|| ExactModel::new(output_machine.model().clone()))
        .flatten()
}

/// How long the motion is followed, and how far its first free coordinate goes.
fn bound_duration(
    scene: &Scene,
    scene_with_drives: &Scene,
    motion: &FreeMotionSpec,
    orbit: Option<&Orbit>,
    notes: &mut Vec<String>,
) -> Result<(f64, [f64; 2]), StudyError> {
    let free = FreeMotionProblem::new(scene, scene_with_drives, motion)?;
    let requested = free.duration()?;
    let mut end = requested;
    if let Some(orbit) = orbit.filter(|orbit| requested > MAX_PERIODS * orbit.period) {
        end = MAX_PERIODS * orbit.period;
        notes.push(format!(
            "followed for {MAX_PERIODS} periods, {} of {} s",
            digits(end, 6),
            digits(requested, 6)
        ));
    }
    let (method, tolerance, max_steps) = PREVIEW_RUN;
    let options = Options {
        max_steps,
        // A step over a whole swing would not see it.
        max_step: Some(end / COMPARED_TIMES as f64),
        ..Options::new(method, tolerance)
    };
    let motion_segments = free.solve(scene, end, &options)?;
    let first = motion_segments.segments.first();
    let steps = first.map_or(&[][..], |(_, solution)| solution.steps.as_slice());
    let reached = steps.last().map_or(0.0, |last| last.t);
    if let Some(error) = motion_segments.failure.as_ref().filter(|_| reached == 0.0) {
        return Err(explain_motion(
            scene_with_drives,
            free.machine.model().plan(),
            error,
        ));
    }
    let (shortened, reason) = match orbit {
        Some(_) => (end, ""),
        None => first_revolutions_or_swings(&free.machine, steps, end),
    };
    if shortened < end {
        notes.push(format!(
            "followed for {reason}, {} of {} s",
            digits(shortened, 6),
            digits(requested, 6)
        ));
        end = shortened;
    }
    if reached < end {
        end = shorten_before_end(&motion_segments, reached, requested, notes);
    }
    let coordinate = |p: &OdeState| p.y.first().copied().unwrap_or(0.0);
    let coordinates = steps.iter().filter(|p| p.t <= end).map(coordinate);
    let (low, high) = coordinates.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| {
        (low.min(q), high.max(q))
    });
    Ok((end, [low, high]))
}

/// The end of a motion that does not last as long as it should in its own coordinate.
fn shorten_before_end(
    motion_segments: &SegmentedMotion,
    reached: f64,
    requested: f64,
    notes: &mut Vec<String>,
) -> f64 {
    let stops = motion_segments.segments.len() == 1 && motion_segments.failure.is_none();
    let (fraction, reason) = match &motion_segments.failure {
        // An event that ends the motion is no place where anything grows.
        None if stops => (1.0, "where an event ends it".to_owned()),
        Some(DynamicsError::MaxStepsReached {
            max_steps: steps, ..
        }) => (1.0, format!("what {steps} steps of a first look reach")),
        Some(error) if motion_segments.segments.len() == 1 => {
            (KEPT_FRACTION, format!("short of where it stops ({error})"))
        }
        _ => (
            KEPT_FRACTION,
            "before its coordinate reaches a dead point or a change point is crossed".to_owned(),
        ),
    };
    let end = fraction * reached;
    notes.push(format!(
        "followed for {} of {} s, {reason}",
        digits(end, 6),
        digits(requested, 6)
    ));
    end
}

/// When some free coordinate has made its turns or swings, and which it made.
fn first_revolutions_or_swings(
    machine: &Machine,
    steps: &[OdeState],
    end: f64,
) -> (f64, &'static str) {
    let (n, plan) = (machine.free().len(), machine.model().plan());
    let (revolutions_text, swings_text) = ("three turns", "three swings");
    let mut reversals = vec![0.0; n];
    for (before, now) in steps.iter().zip(steps.iter().skip(1)) {
        for (k, &i) in machine.free().iter().enumerate() {
            let distance = (now.y[k] - steps[0].y[k]).abs();
            reversals[k] += f64::from(u8::from(now.y[n + k] * before.y[n + k] < 0.0));
            if plan.is_angle(i) && distance >= MAX_PERIODS * TAU {
                return (now.t, revolutions_text);
            }
            if reversals[k] > 2.0 * MAX_PERIODS {
                return (now.t, swings_text);
            }
        }
    }
    (end, "")
}
