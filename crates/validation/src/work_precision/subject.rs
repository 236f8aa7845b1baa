//! The motion that is studied: that of the scene, or a free motion from the assembly, bounded so that a study takes
//! seconds.

use crate::cases::reference::Reference;
use crate::checked::free_motion_setup::FreeMotionSetup;
use dwell_dynamics::{DynamicsError, Machine, Method, OdeState, Options, Orbit, ReducedState};
use dwell_geometry::Reaction;
use dwell_kinetostatics::ExactModel;
use dwell_scene::{Scene, SceneLocation};
use dwell_study::StudyError;
use dwell_study::explain::explain_motion;
use dwell_study::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use dwell_study::models::{build_machine, with_drive_loads};
use dwell_study::number_format::digits;
use dwell_study::ranges::extent;
use std::f64::consts::TAU;

/// Periods of a periodic motion, and revolutions or oscillations of another, at most.
const MAX_PERIODS: f64 = 3.0;
/// What is left of a motion that ends by itself: next to its end everything grows.
const KEPT_FRACTION: f64 = 0.9;
/// Method, tolerance and most steps of the run that bounds the motion.
const PREVIEW_RUN: (Method, f64, usize) = (Method::Bdf, 1e-6, 20_000);
/// Times at which states are compared, spread evenly: no whole number to a period, of which there are three.
const COMPARED_TIMES: usize = 50;

/// A motion to be studied.
pub(super) struct Subject {
    /// The scene, with a free motion where it had none.
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
    /// The motion by its energy, where it follows from that.
    pub(super) orbit: Option<Orbit>,
    /// Notes on it.
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
        let problem = FreeMotionProblem::new(&scene, &scene_with_drives, &motion)?;
        let machine = &problem.machine;
        if machine.free().is_empty() {
            return Err(no_free_coordinate(&scene));
        }
        let plan = machine.model().plan();
        let all = scene.mechanism.reactions().into_iter().enumerate();
        let determinate = all.filter(|&(k, _)| plan.is_determinate(k));
        let reactions: Vec<Reaction> = determinate.map(|(_, reaction)| reaction).collect();
        let output_machine = build_machine(&scene, &motion, &reactions)?;
        let initial_state = problem.initial_state();
        // Without loads the reduced model is the whole equation of motion.
        let unloaded = scene.loads.is_empty() && scene.drives.is_empty();
        let reduced = (unloaded && machine.state_count() == 2)
            .then(|| ExactModel::new(output_machine.model().clone()));
        // A machine with more than one degree of freedom has none.
        let is_one = machine.state_count() == 2 && motion.laws.len() == 1;
        let orbit = is_one.then(|| Orbit::loaded(machine, problem.initial_reduced_state()));
        let orbit = orbit.and_then(Result::ok);
        let (end, coordinate_range) = bound_duration(&scene, &problem, orbit.as_ref(), &mut notes)?;
        // The last time is the end, to the last bit.
        let before = (1..COMPARED_TIMES).map(|k| end * k as f64 / COMPARED_TIMES as f64);
        let subject = Self {
            reduced: reduced.flatten(),
            times: before.chain([end]).collect(),
            machine: problem.machine,
            scene,
            scene_with_drives,
            output_machine,
            reactions,
            initial_state,
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
        let y = &self.initial_state.y;
        let (t, q, q_dot) = (0.0, y[0], y[self.machine.free().len()]);
        ReducedState { t, q, q_dot }
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

    pub(super) fn explain(&self, error: &DynamicsError) -> StudyError {
        explain_motion(&self.scene_with_drives, self.machine.model().plan(), error)
    }

    /// Refuses a motion that stays at rest: all combinations would be exact.
    fn require_motion(&self) -> Result<(), StudyError> {
        let mut workspace = self.machine.workspace();
        let state = self
            .machine
            .evaluate(0.0, &self.initial_state.y, &mut workspace);
        let state = state.map_err(|e| self.explain(&e))?;
        // A motor at rest moves first its current, and what depends on time may begin later.
        let mut rates = vec![0.0; self.machine.state_count()];
        state.derivative(&mut rates);
        let changes = rates[..self.machine.work_offset()]
            .iter()
            .any(|rate| *rate != 0.0);
        match changes || self.machine.depends_on_time() {
            true => Ok(()),
            false => Err(self.explain(&DynamicsError::AtRest)),
        }
    }
}

/// The scene with a motion: its own, or a free motion from the assembly.
fn with_free_motion(scene: &Scene, notes: &mut Vec<String>) -> Result<Scene, StudyError> {
    if scene.motion.is_some() {
        return Ok(scene.clone());
    }
    if scene.mechanism.actuators.is_empty() {
        return Err(no_free_coordinate(scene));
    }
    let setup = FreeMotionSetup::new(scene, &Reference::default())?;
    let start = setup.initial_state_text();
    notes.push(format!("without [motion], a free motion starts at {start}"));
    Ok(setup.scene)
}

/// The error of a scene that cannot move.
fn no_free_coordinate(scene: &Scene) -> StudyError {
    let message = "nothing can move in this scene: no coordinate is free";
    let help = "declare the coordinate that moves, as in `[actuators.phi]`";
    let label = "no free actuator in this file".to_owned();
    let (message, help) = (message.to_owned(), Some(help.to_owned()));
    let error = scene.error(message, help, &[(SceneLocation::Whole, label)]);
    error.into()
}

/// The duration of the motion, and the range of its first free coordinate.
fn bound_duration(
    scene: &Scene,
    free: &FreeMotionProblem<'_>,
    orbit: Option<&Orbit>,
    notes: &mut Vec<String>,
) -> Result<(f64, [f64; 2]), StudyError> {
    let requested = free.duration()?;
    let mut end = requested;
    if let Some(orbit) = orbit.filter(|orbit| requested > MAX_PERIODS * orbit.period) {
        end = MAX_PERIODS * orbit.period;
        let periods = format!("{MAX_PERIODS} periods, ");
        notes.push(shortened_text(&periods, end, requested, ""));
    }
    let (method, tolerance, max_steps) = PREVIEW_RUN;
    let options = Options {
        max_steps,
        // A step over a whole oscillation would not show it.
        max_step: Some(end / COMPARED_TIMES as f64),
        ..Options::new(method, tolerance)
    };
    let motion_segments = free.solve(scene, end, &options)?;
    let first = motion_segments.segments.first();
    let steps = first.map_or(&[][..], |(_, solution)| solution.steps.as_slice());
    let reached = steps.last().map_or(0.0, |last| last.t);
    if let Some(error) = motion_segments.failure.as_ref().filter(|_| reached == 0.0) {
        return Err(free.explain(error));
    }
    let (shortened, reason) = match orbit {
        Some(_) => (end, ""),
        None => first_revolutions(&free.machine, steps, end),
    };
    if shortened < end {
        end = shortened;
        notes.push(shortened_text(reason, end, requested, ""));
    }
    if reached < end {
        end = shorten_before_end(&motion_segments, reached, requested, notes);
    }
    let coordinate = |p: &OdeState| p.y.first().copied().unwrap_or(0.0);
    let coordinates = steps.iter().filter(|p| p.t <= end).map(coordinate);
    Ok((end, extent(coordinates)))
}

/// How much of a motion is integrated, and why.
fn shortened_text(what: &str, end: f64, requested: f64, reason: &str) -> String {
    let [end, requested] = [end, requested].map(|t| digits(t, 6));
    format!("computed for {what}{end} of {requested} s{reason}")
}

/// The end of a motion that does not last as long as it should in its own coordinate.
fn shorten_before_end(
    motion: &SegmentedMotion,
    reached: f64,
    requested: f64,
    notes: &mut Vec<String>,
) -> f64 {
    let one_chart = motion.segments.len() == 1;
    let (fraction, reason) = match &motion.failure {
        // An event that ends the motion is no position where anything grows.
        None if one_chart => (1.0, "until an event ends it".to_owned()),
        Some(DynamicsError::MaxStepsReached { max_steps, .. }) => (
            1.0,
            format!("the time that {max_steps} steps of a preliminary run reach"),
        ),
        Some(error) if one_chart => (KEPT_FRACTION, format!("short of its end ({error})")),
        _ => (
            KEPT_FRACTION,
            "before its coordinate reaches a dead point or a change point is crossed".to_owned(),
        ),
    };
    let end = fraction * reached;
    notes.push(shortened_text("", end, requested, &format!(", {reason}")));
    end
}

/// The time at which some free coordinate has made three revolutions or oscillations, and which.
fn first_revolutions(machine: &Machine, steps: &[OdeState], end: f64) -> (f64, &'static str) {
    let (n, plan) = (machine.free().len(), machine.model().plan());
    let mut reversals = vec![0.0; n];
    for (before, now) in steps.iter().zip(steps.iter().skip(1)) {
        for (k, &i) in machine.free().iter().enumerate() {
            let distance = (now.y[k] - steps[0].y[k]).abs();
            reversals[k] += f64::from(u8::from(now.y[n + k] * before.y[n + k] < 0.0));
            if plan.is_angle(i) && distance >= MAX_PERIODS * TAU {
                return (now.t, "three revolutions, ");
            }
            if reversals[k] > 2.0 * MAX_PERIODS {
                return (now.t, "three oscillations, ");
            }
        }
    }
    (end, "")
}
