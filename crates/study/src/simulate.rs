//! `dwell simulate`: the free motion of a machine in time, under its loads and drives.

mod apart;
mod error;
mod rows;
mod within;
mod words;

pub(crate) use rows::{BALANCE, KINETIC, POTENTIAL};

use crate::error::{StudyError, explain_machine, explain_model};
use crate::motion_error::explain_motion;
use crate::outcome::Progress;
use crate::run::{Command, Followed, Way, check_variables, model, write_up};
use crate::words::digits;
use dwell_dynamics::atlas::{Atlas, AtlasError, Chart, Journey, Site, Why};
use dwell_dynamics::{
    DynamicsError, Event, Guidance, Machine, Method, Occurrence, Options, Orbit, Point, State,
    Statistics, Trace, Trigger, all_loads, follow,
};
use dwell_geometry::measure::Measured;
use dwell_geometry::{Coordinate, Reaction};
use dwell_kinetostatics::{Magnitude, Model};
use dwell_scene::{EventTrigger, Length, Motion, Place, Scene};

/// What the user trades for speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// The integrator.
    pub method: Method,
    /// Relative tolerance.
    pub relative: f64,
    /// Absolute tolerance, rad and rad/s or m and m/s.
    pub absolute: f64,
    /// Longest step, s.
    pub longest: Option<f64>,
    /// Distance of the samples, s.
    pub every: Option<f64>,
}

impl Default for Accuracy {
    fn default() -> Self {
        Self {
            method: Method::Bdf,
            relative: 1e-10,
            absolute: 1e-10,
            longest: None,
            every: None,
        }
    }
}

impl Accuracy {
    /// Integrator and tolerance, as figures tell them.
    pub(crate) fn told(&self) -> String {
        let [relative, absolute] = [self.relative, self.absolute].map(|v| format!("{v:e}"));
        let absolute = match absolute {
            same if same == relative => String::new(),
            other => format!(" relative, {other} absolute"),
        };
        format!("{}, tolerance {relative}{absolute}", self.method.name())
    }
}

/// Accuracies by name, the last the finest power of ten that all measured machines keep. What each costs is in
/// docs/performance.md.
pub const PRESETS: [(&str, f64); 4] = [
    ("draft", 1e-3),
    ("standard", 1e-6),
    ("precise", 1e-9),
    ("reference", 1e-10),
];

/// Samples of a motion where the command does not say how far apart.
const SAMPLES: f64 = 1000.0;
/// Most samples of a motion.
const MOST_SAMPLES: f64 = 100_000.0;
/// Changes of coordinate that are told.
const TOLD: usize = 6;

/// The free motion of a scene, by a method and a tolerance.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or its start cannot be evaluated. What ends the motion
/// on the way is in [`Followed::stopped`].
pub fn simulate(
    scene: &Scene,
    accuracy: &Accuracy,
    progress: Progress<'_>,
) -> Result<Followed, StudyError> {
    let compute = |run: &Free<'_>, duration: f64, every: f64| {
        let options = Options {
            absolute: accuracy.absolute,
            longest: accuracy.longest,
            every: Some(every),
            ..Options::new(accuracy.method, accuracy.relative)
        };
        let moved = run.follow(scene, duration, &options)?;
        let error = run.estimated(scene, &moved, &options)?;
        Ok(Computed {
            how: accuracy.told(),
            told: run.hint(&moved, accuracy) + &error,
            accuracy: None,
            moved,
        })
    };
    simulated(scene, accuracy.every, progress, &compute)
}

/// The free motion of a scene to a wanted accuracy, by what reaches it at the least cost: all coordinates within
/// so many rad (lengths: parts of their largest change), energy and reactions within this part of their largest.
///
/// # Errors
/// As [`simulate`]. That the accuracy is not reached is in [`Followed::stopped`].
pub fn simulate_within(
    scene: &Scene,
    wanted: f64,
    every: Option<f64>,
    progress: Progress<'_>,
) -> Result<Followed, StudyError> {
    let compute =
        |run: &Free<'_>, duration: f64, every: f64| run.within(scene, wanted, duration, every);
    simulated(scene, every, progress, &compute)
}

/// A motion that was computed, and what is to be said of it.
struct Computed {
    moved: Moved,
    /// By what, as figures and the summary tell it.
    how: String,
    /// What else is told.
    told: String,
    /// Of a wanted accuracy: it, and the estimated error.
    accuracy: Option<[f64; 2]>,
}

fn simulated(
    scene: &Scene,
    every: Option<f64>,
    progress: Progress<'_>,
    compute: &dyn Fn(&Free<'_>, f64, f64) -> Result<Computed, StudyError>,
) -> Result<Followed, StudyError> {
    let Some(motion) = &scene.motion else {
        return Err(no_motion(scene));
    };
    let mut driven = scene.clone();
    let loads = all_loads(&scene.mechanism, &scene.loads, &scene.drives);
    driven.loads = loads.map_err(|e| explain_machine(scene, e.into()))?;
    let run = Free::new(scene, &driven, motion)?;
    let duration = run.duration()?;
    let every = every.unwrap_or(duration / SAMPLES);
    let computed = compute(&run, duration, every.max(duration / MOST_SAMPLES))?;
    let Computed { moved, how, .. } = &computed;
    let explain = |e: &DynamicsError| explain_motion(&driven, run.shown.plan(), e);
    if let Some(error) = moved.failed.as_ref().filter(|_| moved.end() == 0.0) {
        return Err(explain(error));
    }
    let samples = run.samples(moved).map_err(|e| explain(&e))?;
    let led = motion.laws.iter().map(Option::is_some).collect();
    let charts = moved.charts.iter().map(|c| c.shown.clone()).collect();
    let mut way = Way::free(run.shown.plan(), samples, run.told(), led, charts);
    way.how.clone_from(how);
    let mut followed = write_up(&driven, &run.shown, &way, Command::Simulate, progress)?;
    let outcome = &mut followed.outcome;
    if moved.occurrences().next().is_some() {
        let name = format!("{}-motion-events.csv", scene.name);
        outcome.files.add(name, run.event_table(moved).csv()?);
    }
    outcome.summary += &run.summary(moved, how, duration);
    outcome.summary += &computed.told;
    if let Some(error) = &moved.failed {
        followed.stopped = Some(explain(error));
    } else if let Some([wanted, error]) = computed.accuracy
        && error > wanted
    {
        followed.stopped = Some(too_fine(scene, wanted, error));
    }
    Ok(followed)
}

fn too_fine(scene: &Scene, wanted: f64, error: f64) -> StudyError {
    let message =
        format!("an accuracy of {wanted:e} is not reached: the estimated error is {error:.1e}");
    let help = "what was reached is written; ask for that, or for a shorter motion";
    let label = (Place::Length, "errors grow with its length".to_owned());
    scene.error(message, Some(help.to_owned()), &[label]).into()
}

fn no_motion(scene: &Scene) -> StudyError {
    let help = "add [motion] with `speed`, and `periods` or `duration`";
    let label = (Place::Whole, "there is no [motion] in this file".to_owned());
    scene
        .error(
            "the scene has no [motion] to simulate".to_owned(),
            Some(help.to_owned()),
            &[label],
        )
        .into()
}

/// A scene ready to move.
pub(crate) struct Free<'a> {
    /// The scene with the loads through which its drives act.
    scene: &'a Scene,
    motion: &'a Motion,
    /// Everything that is shown of it.
    shown: Model,
    /// What moves.
    pub(crate) machine: Machine,
}

/// A motion, leg by leg.
pub(crate) struct Moved {
    /// None where there is but the mechanism's own coordinate.
    pub(crate) charts: Vec<Chart>,
    /// By leg: its chart and its trace, and the only actuator's coordinate at its samples.
    pub(crate) legs: Vec<(usize, Trace)>,
    own: Vec<Vec<[f64; 3]>>,
    /// What is to be said of the charts.
    changes: Vec<String>,
    pub(crate) failed: Option<DynamicsError>,
    statistics: Statistics,
}

impl Moved {
    /// A motion in the mechanism's own coordinate alone.
    fn in_one(trace: Trace) -> Self {
        Self {
            charts: Vec::new(),
            own: Vec::new(),
            changes: Vec::new(),
            failed: trace.failed.clone(),
            statistics: trace.statistics,
            legs: vec![(0, trace)],
        }
    }

    pub(crate) fn occurrences(&self) -> impl Iterator<Item = (usize, &Occurrence)> {
        self.legs
            .iter()
            .flat_map(|(chart, trace)| trace.occurrences.iter().map(|o| (*chart, o)))
    }

    pub(crate) fn end(&self) -> f64 {
        let last = self.legs.last().and_then(|(_, trace)| trace.steps.last());
        last.map_or(0.0, |point| point.t)
    }

    fn steps(&self) -> impl Iterator<Item = (usize, &Point)> {
        self.legs
            .iter()
            .flat_map(|(chart, trace)| trace.steps.iter().map(|p| (*chart, p)))
    }
}

impl<'a> Free<'a> {
    pub(crate) fn new(
        scene: &Scene,
        driven: &'a Scene,
        motion: &'a Motion,
    ) -> Result<Self, StudyError> {
        let shown = model(driven)?;
        check_variables(driven, &shown)?;
        let machine = machine(scene, motion, &[])?;
        Ok(Self {
            scene: driven,
            motion,
            shown,
            machine,
        })
    }

    /// Follows the motion: of one freedom from chart to chart, else in its own coordinates.
    pub(crate) fn follow(
        &self,
        scene: &Scene,
        duration: f64,
        options: &Options,
    ) -> Result<Moved, StudyError> {
        let explain = |e: &DynamicsError| explain_motion(self.scene, self.shown.plan(), e);
        let (start, events) = (self.start(), self.events());
        if self.motion.laws.len() != 1 || self.machine.free().len() != 1 {
            let trace = follow(
                &self.machine,
                &self.shown,
                &start,
                duration,
                options,
                &events,
            );
            let trace = trace.map_err(|e| explain(&e))?;
            return Ok(Moved::in_one(trace));
        }
        let at = scene.assembly.to_start();
        let site = Site {
            mechanism: &scene.mechanism,
            masses: &scene.masses,
            start: &at,
            loads: &scene.loads,
            drives: &scene.drives,
            reactions: &scene.mechanism.reactions(),
        };
        let mut atlas = Atlas::new(site).map_err(|e| match e {
            AtlasError::Model(model) => explain_model(scene, &model),
            AtlasError::Machine(machine) => explain_machine(scene, machine),
        })?;
        let journey = atlas.follow(&start, duration, options, &events);
        let journey = journey.map_err(|e| explain(&e))?;
        let own = atlas.track(&journey, atlas.own());
        let own = own.map_err(|e| explain(&e))?.samples;
        let statistics = journey.statistics();
        Ok(Moved {
            changes: self.changes(&atlas, &journey),
            charts: atlas.charts().to_vec(),
            own,
            failed: journey.failed,
            statistics,
            legs: journey
                .legs
                .into_iter()
                .map(|leg| (leg.chart, leg.trace))
                .collect(),
        })
    }

    /// What is to be said of the changes of coordinate, and of the change points.
    fn changes(&self, atlas: &Atlas<'_>, journey: &Journey) -> Vec<String> {
        let mut told = Vec::new();
        let name = |chart: usize| atlas.charts()[chart].name.clone();
        for change in journey.changes.iter().take(TOLD) {
            let t = digits(change.t, 6);
            told.push(match change.why {
                Why::Crosses { .. } => format!("t = {t} s: a change point is crossed"),
                Why::Folds { .. } | Why::Ends => format!(
                    "t = {t} s: followed by {} instead of {}, which folds back",
                    name(change.to),
                    name(change.from)
                ),
            });
        }
        if journey.changes.len() > TOLD {
            told.push(format!(
                "and {} more such changes",
                journey.changes.len() - TOLD
            ));
        }
        for bridge in atlas.bridges() {
            let shared: Vec<String> = bridge
                .not_unique
                .iter()
                .map(|&r| self.scene.mechanism.reaction_name(r))
                .collect();
            let shared = if shared.is_empty() {
                String::new()
            } else {
                format!("; not unique there: {}", shared.join(", "))
            };
            told.push(format!(
                "bridged within {} of {}, where {} freedoms meet{shared}",
                digits(bridge.half, 3),
                digits(bridge.center, 6),
                bridge.mobility,
            ));
        }
        for (q, error) in atlas.refused() {
            told.push(format!(
                "the change point at {} cannot be crossed: {error}",
                digits(*q, 6)
            ));
        }
        told
    }

    /// The machine of a chart.
    fn machine<'m>(&'m self, moved: &'m Moved, chart: usize) -> &'m Machine {
        moved
            .charts
            .get(chart)
            .map_or(&self.machine, |c| &c.machine)
    }

    fn start(&self) -> Point {
        Point {
            t: 0.0,
            y: self.machine.start(&self.motion.start, &self.motion.speed),
        }
    }

    /// How long the motion lasts, s.
    pub(crate) fn duration(&self) -> Result<f64, StudyError> {
        let periods = match self.motion.length {
            Length::Duration(duration) => return Ok(duration),
            Length::Periods(periods) => periods,
        };
        match Orbit::loaded(&self.machine, self.state()) {
            Ok(orbit) => Ok(periods * orbit.period),
            Err(DynamicsError::NotConservative { .. }) => {
                let label = [(Place::Length, "a period is needed".to_owned())];
                let help = "give a `duration` in s".to_owned();
                let message =
                    "no period is known beforehand where loads or drives give or take energy";
                let error = self.scene.error(message.to_owned(), Some(help), &label);
                Err(error.into())
            }
            Err(e) => Err(explain_motion(self.scene, self.shown.plan(), &e)),
        }
    }

    /// The start in the only free coordinate.
    pub(crate) fn state(&self) -> State {
        let first = self.machine.free().first().copied().unwrap_or(0);
        State {
            t: 0.0,
            q: self.motion.start[first],
            q_dot: self.motion.speed[first],
        }
    }

    /// What is looked for: the scene's events, in their order.
    fn events(&self) -> Vec<Event> {
        let mechanism = &self.scene.mechanism;
        let find = |c: Coordinate| Measured::find(mechanism, c);
        let place = |r: Reaction| self.shown.reactions().iter().position(|&shown| shown == r);
        let event = |named: &dwell_scene::NamedEvent| {
            let trigger = match named.trigger {
                EventTrigger::Reaches(c, value) => Trigger::Reaches(find(c)?, value),
                EventTrigger::Turns(c) => Trigger::Turns(find(c)?),
                EventTrigger::WholeTurn(c) => Trigger::WholeTurn(find(c)?),
                EventTrigger::Reaction(r, value) => Trigger::Reaction(place(r)?, value),
            };
            Some(Event {
                trigger,
                stop: named.stop,
            })
        };
        self.motion.events.iter().filter_map(event).collect()
    }
}

/// The machine of a scene: some reactions and what its motion needs, and no other.
pub(crate) fn machine(
    scene: &Scene,
    motion: &Motion,
    reactions: &[Reaction],
) -> Result<Machine, StudyError> {
    let start = scene.assembly.to_start();
    let frictions = scene.loads.iter().filter_map(|load| match load.magnitude {
        Magnitude::Friction(friction) => Some(friction.reactions(&scene.mechanism)),
        _ => None,
    });
    let mut needed = reactions.to_vec();
    for reaction in frictions.flatten() {
        if !needed.contains(&reaction) {
            needed.push(reaction);
        }
    }
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &needed)
        .map_err(|e| explain_model(scene, &e))?;
    let guide =
        |law: &Option<dwell_laws::Law>| law.clone().map_or(Guidance::Free, Guidance::Prescribed);
    let guidance = motion.laws.iter().map(guide).collect();
    Machine::new(
        &scene.mechanism,
        model,
        &scene.loads,
        guidance,
        &scene.drives,
    )
    .map_err(|e| explain_machine(scene, e))
}
