//! The studied motion: that of the scene, or a free motion from the assembly, bounded so that a study takes
//! seconds.

use super::studied_scene::{PreliminaryRun, StudiedScene};
use dwell_dynamics::{
    DynamicsError, Machine, Method, MovingModel, OdeState, Options, Orbit, ReducedState,
};
use dwell_kinetostatics::{ExactModel, MachineModel as _};
use dwell_scene::{SceneFile, SceneLocation};
use dwell_study::StudyError;
use dwell_study::machines::MotionStart;
use dwell_study::number_format::digits;
use dwell_study::ranges::extent;
use std::f64::consts::TAU;
use toml::Value;

/// Maximum number of periods, or of revolutions or oscillations of a motion that is not periodic.
const MAX_PERIODS: f64 = 3.0;
/// Fraction kept of a motion that ends early: errors grow next to its end.
const KEPT_FRACTION: f64 = 0.9;
/// Method, tolerance and maximum number of steps of the run that bounds the motion.
const PREVIEW_RUN: (Method, f64, usize) = (Method::Bdf, 1e-6, 20_000);
/// Number of equally spaced times at which states are compared; no multiple of the three periods.
const COMPARED_TIMES: usize = 50;

/// A studied motion.
pub(super) struct Subject<S: StudiedScene> {
    /// The scene, with a free motion if it had none.
    pub(super) scene: S,
    /// The equations of motion.
    pub(super) machine: Machine<S::Model>,
    /// The equations with the compared reactions as the first ones.
    pub(super) output_machine: Machine<S::Model>,
    /// The units of these reactions.
    pub(super) reaction_units: Vec<String>,
    /// The reduced model with these reactions, of one freedom without loads.
    pub(super) reduced: Option<ExactModel<S::Model>>,
    pub(super) initial_state: OdeState,
    /// The times at which states are compared, s; the last is the end.
    pub(super) times: Vec<f64>,
    /// The smallest and the largest value of the first free coordinate.
    pub(super) coordinate_range: [f64; 2],
    /// The motion by quadrature, if the energy determines it.
    pub(super) orbit: Option<Orbit>,
    /// Notes on it.
    pub(super) notes: Vec<String>,
}

impl<S: StudiedScene> Subject<S> {
    /// The motion of a scene.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if the scene cannot be assembled, nothing is free, or nothing moves.
    pub(super) fn new(scene: &S) -> Result<Self, StudyError> {
        let mut notes = Vec::new();
        if scene.actuator(0).is_none() {
            return Err(no_free_coordinate(scene));
        }
        let has_motion = scene.has_motion();
        let scene = scene.with_free_motion()?;
        let machine = scene.machine(&[])?;
        if machine.free().is_empty() {
            return Err(no_free_coordinate(&scene));
        }
        let reactions = scene.compared_reactions(machine.model())?;
        let output_machine = scene.machine(&reactions)?;
        let columns = scene.reaction_columns(output_machine.model()).into_iter();
        let reaction_units = columns.take(reactions.len()).map(|c| c.unit).collect();
        let starts = scene.motion_start();
        let y = machine.initial_state(&starts.coordinates, &starts.velocities);
        let initial_state = OdeState { t: 0.0, y };
        // Without loads the reduced model is the whole equation of motion.
        let unloaded = machine.model().loads().is_empty();
        let reduced = (unloaded && machine.state_count() == 2)
            .then(|| ExactModel::new(output_machine.model().clone()));
        // A machine with more than one degree of freedom has none.
        let is_one = machine.state_count() == 2 && starts.laws.len() == 1;
        let first = machine.free().first().copied().unwrap_or(0);
        let reduced_start = ReducedState {
            t: 0.0,
            q: starts.coordinates[first],
            q_dot: starts.velocities[first],
        };
        let orbit = is_one
            .then(|| Orbit::loaded(&machine, reduced_start))
            .and_then(Result::ok);
        let (end, coordinate_range) =
            bound_duration(&scene, &machine, &initial_state, orbit.as_ref(), &mut notes)?;
        if !has_motion {
            let motion = written_motion(&scene, machine.free(), &starts, end);
            notes.push(format!("the scene has no motion: the study takes this one, and the lines to type need it as the scene's first line: {motion}"));
        }
        // The last time is the end, to the last bit.
        let before = (1..COMPARED_TIMES).map(|k| end * k as f64 / COMPARED_TIMES as f64);
        let subject = Self {
            reduced: reduced.flatten(),
            times: before.chain([end]).collect(),
            machine,
            scene,
            output_machine,
            reaction_units,
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

    /// The initial state in the only coordinate.
    pub(super) fn reduced_state(&self) -> ReducedState {
        let y = &self.initial_state.y;
        let (t, q, q_dot) = (0.0, y[0], y[self.machine.free().len()]);
        ReducedState { t, q, q_dot }
    }

    /// Unit of the free coordinates.
    pub(super) fn unit(&self) -> &'static str {
        let model = self.machine.model();
        let angles = self.machine.free().iter().filter(|&&i| model.is_angle(i));
        match angles.count() {
            0 => "m",
            n if n == self.machine.free().len() => "rad",
            _ => "rad or m",
        }
    }

    pub(super) fn explain(&self, error: &DynamicsError) -> StudyError {
        self.scene.explain(self.machine.model(), error)
    }

    /// Rejects a motion that stays at rest: all combinations would be exact.
    fn require_motion(&self) -> Result<(), StudyError> {
        let mut workspace = self.machine.workspace();
        let state = self
            .machine
            .evaluate(0.0, &self.initial_state.y, &mut workspace)
            .map_err(|e| self.explain(&e))?;
        // At rest only the current of a motor changes at first, and loads of time may begin later.
        let mut rates = vec![0.0; self.machine.state_count()];
        state.derivative(&mut rates);
        let changes = rates[..self.machine.work_offset()]
            .iter()
            .any(|rate| *rate != 0.0);
        if changes || self.machine.depends_on_time() {
            Ok(())
        } else {
            Err(self.explain(&DynamicsError::AtRest))
        }
    }
}

/// The error of a scene that cannot move.
fn no_free_coordinate(scene: &SceneFile) -> StudyError {
    let message = "nothing can move in this scene: no coordinate is free";
    let help = "declare the coordinate that moves, as in `[actuators.phi]`";
    let label = "no free actuator in this file".to_owned();
    let (message, help) = (message.to_owned(), Some(help.to_owned()));
    let error = scene.error(message, help, &[(SceneLocation::Whole, label)]);
    error.into()
}

/// A free motion of a duration (s) as text of a scene, in one line.
fn written_motion<S: StudiedScene>(
    scene: &S,
    free: &[usize],
    starts: &MotionStart,
    duration: f64,
) -> String {
    let table = |values: &[f64]| {
        let named = free
            .iter()
            .filter_map(|&i| Some((scene.actuator(i)?, values[i])));
        let written = named.map(|((name, is_angle), value)| {
            let (value, _) = scene.to_scene_unit(value, is_angle);
            (name.to_owned(), Value::Float(value))
        });
        Value::Table(written.collect())
    };
    let motion = [
        ("duration", Value::Float(duration)),
        ("initial-coordinate", table(&starts.coordinates)),
        ("initial-velocity", table(&starts.velocities)),
    ]
    .map(|(key, value)| (key.to_owned(), value));
    format!("motion = {}", Value::Table(motion.into_iter().collect()))
}

/// The duration of the motion, and the range of its first free coordinate.
fn bound_duration<S: StudiedScene>(
    scene: &S,
    machine: &Machine<S::Model>,
    start: &OdeState,
    orbit: Option<&Orbit>,
    notes: &mut Vec<String>,
) -> Result<(f64, [f64; 2]), StudyError> {
    let requested = scene.duration()?;
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
    let run = scene.preliminary_run(machine, start, end, &options)?;
    let steps = run.steps.as_slice();
    let reached = steps.last().map_or(0.0, |last| last.t);
    if let Some(error) = run.failure.as_ref().filter(|_| reached == 0.0) {
        return Err(scene.explain(machine.model(), error));
    }
    let (shortened, reason) = match orbit {
        Some(_) => (end, ""),
        None => first_revolutions(machine, steps, end),
    };
    if shortened < end {
        end = shortened;
        notes.push(shortened_text(reason, end, requested, ""));
    }
    if reached < end {
        end = shorten_before_end(&run, reached, requested, notes);
    }
    let coordinate = |p: &OdeState| p.y.first().copied().unwrap_or(0.0);
    let coordinates = steps.iter().filter(|p| p.t <= end).map(coordinate);
    Ok((end, extent(coordinates)))
}

/// The integrated part of a motion with the reason, in words.
fn shortened_text(what: &str, end: f64, requested: f64, reason: &str) -> String {
    let [end, requested] = [end, requested].map(|t| digits(t, 6));
    format!("computed for {what}{end} of {requested} s{reason}")
}

/// The end of a motion that ends early in its own coordinate.
fn shorten_before_end(
    motion: &PreliminaryRun,
    reached: f64,
    requested: f64,
    notes: &mut Vec<String>,
) -> f64 {
    let one_chart = motion.has_one_chart;
    let (fraction, reason) = match &motion.failure {
        // Errors do not grow next to an event that ends the motion.
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

/// The time at which a free coordinate has made three revolutions or oscillations, and its index.
fn first_revolutions<M: MovingModel>(
    machine: &Machine<M>,
    steps: &[OdeState],
    end: f64,
) -> (f64, &'static str) {
    let (n, model) = (machine.free().len(), machine.model());
    let mut reversals = vec![0.0; n];
    for (before, now) in steps.iter().zip(steps.iter().skip(1)) {
        for (k, &i) in machine.free().iter().enumerate() {
            let distance = (now.y[k] - steps[0].y[k]).abs();
            reversals[k] += f64::from(u8::from(now.y[n + k] * before.y[n + k] < 0.0));
            if model.is_angle(i) && distance >= MAX_PERIODS * TAU {
                return (now.t, "three revolutions, ");
            }
            if reversals[k] > 2.0 * MAX_PERIODS {
                return (now.t, "three oscillations, ");
            }
        }
    }
    (end, "")
}
