//! The motion that is studied: that of the scene, or one that it is set free for, bounded so that a study takes
//! seconds.

use crate::error::StudyError;
use crate::freed::Freed;
use crate::motion_error::explain_motion;
use crate::multibody::with_drives;
use crate::reference::Reference;
use crate::simulate::{Free, Moved, machine};
use crate::words::digits;
use dwell_dynamics::{DynamicsError, Machine, Method, Options, Orbit, Point, State};
use dwell_geometry::Reaction;
use dwell_kinetostatics::Exact;
use dwell_scene::{Motion, Place, Scene};
use std::f64::consts::TAU;

/// Periods of a motion that repeats itself, and turns or swings of another, at most.
const MOST_TURNS: f64 = 3.0;
/// What is left of a motion that ends by itself: next to its end everything grows.
const SHORT: f64 = 0.9;
/// How the motion is looked at beforehand, and the most steps of that.
const LOOK: (Method, f64, usize) = (Method::Bdf, 1e-6, 20_000);
/// Times at which states are compared, spread evenly: no whole number to a period, three of which are followed.
const TIMES: usize = 50;

/// A motion to be studied.
pub(super) struct Subject {
    /// The scene, set free where it had no motion.
    pub(super) scene: Scene,
    /// The same with the loads through which its drives act.
    driven: Scene,
    /// What moves.
    pub(super) machine: Machine,
    /// The same with the reactions that are compared, its first ones.
    pub(super) seen: Machine,
    /// These reactions.
    pub(super) reactions: Vec<Reaction>,
    /// The reduced model with these reactions, of one freedom without loads.
    pub(super) reduced: Option<Exact>,
    pub(super) start: Point,
    /// When states are compared, s; the last is the end.
    pub(super) times: Vec<f64>,
    /// The smallest and the largest value of the first free coordinate.
    pub(super) reach: [f64; 2],
    /// The motion by its energy, where that tells it.
    pub(super) orbit: Option<Orbit>,
    /// What is to be said of it.
    pub(super) told: Vec<String>,
}

impl Subject {
    /// The motion of a scene.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the scene cannot be put together, nothing is free, or nothing moves.
    pub(super) fn new(scene: &Scene) -> Result<Self, StudyError> {
        let mut told = Vec::new();
        let scene = set_free(scene, &mut told)?;
        let Some(motion) = scene.motion.clone() else {
            return Err(nothing_free(&scene));
        };
        let driven = with_drives(&scene)?;
        let bare = machine(&scene, &motion, &[])?;
        if bare.free().is_empty() {
            return Err(nothing_free(&scene));
        }
        let unique = bare.model().plan();
        let all = scene.mechanism.reactions().into_iter().enumerate();
        let known = all.filter(|&(k, _)| unique.is_unique(k));
        let reactions: Vec<Reaction> = known.map(|(_, reaction)| reaction).collect();
        let seen = machine(&scene, &motion, &reactions)?;
        let start = Point {
            t: 0.0,
            y: bare.start(&motion.start, &motion.speed),
        };
        let orbit = orbit(&bare, &motion);
        let (end, reach) = bounded(&scene, &driven, &motion, orbit.as_ref(), &mut told)?;
        let subject = Self {
            reduced: reduced(&scene, &bare, &seen),
            times: times(end),
            scene,
            driven,
            machine: bare,
            seen,
            reactions,
            start,
            reach,
            orbit,
            told,
        };
        subject.moves()?;
        Ok(subject)
    }

    /// The end of the motion, s.
    pub(super) fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// The start in the only coordinate.
    pub(super) fn state(&self) -> State {
        let [q, q_dot] = [self.start.y[0], self.start.y[self.machine.free().len()]];
        State { t: 0.0, q, q_dot }
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
        explain_motion(&self.driven, self.machine.model().plan(), error)
    }

    /// Refuses what stays at rest: all combinations would be exact.
    fn moves(&self) -> Result<(), StudyError> {
        let mut work = self.machine.work();
        let started = self.machine.evaluate(0.0, &self.start.y, &mut work);
        started.map_err(|e| self.explain(&e))?;
        let free = self.machine.free();
        let moves = |&i: &usize| work.q_dot[i] != 0.0 || work.q_ddot[i] != 0.0;
        if free.iter().any(moves) {
            return Ok(());
        }
        Err(self.explain(&DynamicsError::AtRest))
    }
}

/// The times at which states are compared. The last is the end, to the last bit.
fn times(end: f64) -> Vec<f64> {
    let before = (1..TIMES).map(|k| end * k as f64 / TIMES as f64);
    before.chain([end]).collect()
}

/// The scene with a motion: its own, or one that it is set free for.
fn set_free(scene: &Scene, told: &mut Vec<String>) -> Result<Scene, StudyError> {
    if scene.motion.is_some() {
        return Ok(scene.clone());
    }
    if scene.mechanism.actuators.is_empty() {
        return Err(nothing_free(scene));
    }
    let freed = Freed::new(scene, &Reference::default())?.scene;
    let motion = freed.motion.iter();
    let started = motion.flat_map(|m| scene.mechanism.actuators.iter().zip(&m.speed).zip(&m.start));
    let speeds: Vec<String> = started
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
    told.push(format!(
        "the scene has no [motion]: it is set free at {}",
        speeds.join(", ")
    ));
    Ok(freed)
}

/// Nothing can be followed.
fn nothing_free(scene: &Scene) -> StudyError {
    let message = "nothing can move in this scene: no coordinate is free";
    let help = "declare the coordinate that moves, as in `[actuators.phi]`";
    let labels = [(Place::Whole, "no free actuator in this file".to_owned())];
    scene
        .error(message.to_owned(), Some(help.to_owned()), &labels)
        .into()
}

/// The motion by its energy. A machine with a state of more than one freedom has none.
fn orbit(machine: &Machine, motion: &Motion) -> Option<Orbit> {
    if machine.states() != 2 || motion.laws.len() != 1 {
        return None;
    }
    let [q, q_dot] = [motion.start[0], motion.speed[0]];
    Orbit::loaded(machine, State { t: 0.0, q, q_dot }).ok()
}

/// The reduced model with the reactions that are compared, where it is the whole equation of motion.
fn reduced(scene: &Scene, machine: &Machine, seen: &Machine) -> Option<Exact> {
    let alone = scene.loads.is_empty() && scene.drives.is_empty();
    let one = alone && machine.states() == 2 && machine.model().plan().actuators() == 1;
    one.then(|| Exact::new(seen.model().clone())).flatten()
}

/// How long the motion is followed, and how far its first free coordinate goes.
fn bounded(
    scene: &Scene,
    driven: &Scene,
    motion: &Motion,
    orbit: Option<&Orbit>,
    told: &mut Vec<String>,
) -> Result<(f64, [f64; 2]), StudyError> {
    let free = Free::new(scene, driven, motion)?;
    let wanted = free.duration()?;
    let mut end = wanted;
    if let Some(orbit) = orbit.filter(|orbit| wanted > MOST_TURNS * orbit.period) {
        end = MOST_TURNS * orbit.period;
        told.push(format!(
            "followed for {MOST_TURNS} periods, {} of {} s",
            digits(end, 6),
            digits(wanted, 6)
        ));
    }
    let (method, tolerance, budget) = LOOK;
    let options = Options {
        budget,
        // A step over a whole swing would not see it.
        longest: Some(end / TIMES as f64),
        ..Options::new(method, tolerance)
    };
    let moved = free.follow(scene, end, &options)?;
    let first = moved.legs.first();
    let steps = first.map_or(&[][..], |(_, trace)| trace.steps.as_slice());
    let reached = steps.last().map_or(0.0, |last| last.t);
    if let Some(error) = moved.failed.as_ref().filter(|_| reached == 0.0) {
        return Err(explain_motion(driven, free.machine.model().plan(), error));
    }
    let (round, why) = match orbit {
        Some(_) => (end, ""),
        None => around(&free.machine, steps, end),
    };
    if round < end {
        told.push(format!(
            "followed for {why}, {} of {} s",
            digits(round, 6),
            digits(wanted, 6)
        ));
        end = round;
    }
    if reached < end {
        end = early(&moved, reached, wanted, told);
    }
    let place = |p: &Point| p.y.first().copied().unwrap_or(0.0);
    let within = steps.iter().filter(|p| p.t <= end).map(place);
    let (low, high) = within.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| {
        (low.min(q), high.max(q))
    });
    Ok((end, [low, high]))
}

/// The end of a motion that does not last as long as it should in its own coordinate.
fn early(moved: &Moved, reached: f64, wanted: f64, told: &mut Vec<String>) -> f64 {
    let stops = moved.legs.len() == 1 && moved.failed.is_none();
    let (part, why) = match &moved.failed {
        // An event that ends the motion is no place where anything grows.
        None if stops => (1.0, "where an event ends it".to_owned()),
        Some(DynamicsError::Budget { steps, .. }) => {
            (1.0, format!("what {steps} steps of a first look reach"))
        }
        Some(error) if moved.legs.len() == 1 => {
            (SHORT, format!("short of where it stops ({error})"))
        }
        _ => (
            SHORT,
            "short of where its coordinate folds back or a change point is crossed".to_owned(),
        ),
    };
    let end = part * reached;
    told.push(format!(
        "followed for {} of {} s, {why}",
        digits(end, 6),
        digits(wanted, 6)
    ));
    end
}

/// When some free coordinate has made its turns or swings, and which it made.
fn around(machine: &Machine, steps: &[Point], end: f64) -> (f64, &'static str) {
    let (n, plan) = (machine.free().len(), machine.model().plan());
    let (turns, swings) = ("three turns", "three swings");
    let mut back = vec![0.0; n];
    for (before, now) in steps.iter().zip(steps.iter().skip(1)) {
        for (k, &i) in machine.free().iter().enumerate() {
            let gone = (now.y[k] - steps[0].y[k]).abs();
            back[k] += f64::from(u8::from(now.y[n + k] * before.y[n + k] < 0.0));
            if plan.is_angle(i) && gone >= MOST_TURNS * TAU {
                return (now.t, turns);
            }
            if back[k] > 2.0 * MOST_TURNS {
                return (now.t, swings);
            }
        }
    }
    (end, "")
}
