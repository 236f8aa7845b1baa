//! `dwell simulate`: the free motion of a machine in time, under its loads and drives.

use crate::error::{StudyError, explain_machine};
use crate::motion_error::explain_motion;
use crate::outcome::Progress;
use crate::run::{Command, Followed, Sample, Told, Way, check_variables, loaded, write_up};
use crate::words::digits;
use dwell_dynamics::{
    DriveKind, DynamicsError, Event, FreeTurn, Guidance, Machine, MachineWork, Method, Options,
    Point, State, Trace, Trigger, Worker, all_loads, follow,
};
use dwell_geometry::measure::Measured;
use dwell_geometry::{Coordinate, Reaction};
use dwell_kinetostatics::{Exact, Magnitude, Model};
use dwell_report::{Column, Table};
use dwell_scene::{EventTrigger, Length, Motion, Place, Scene};
use std::fmt::Write as _;

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

/// Samples of a motion where the command does not say how far apart.
const SAMPLES: f64 = 1000.0;
/// Most samples of a motion.
const MOST_SAMPLES: f64 = 100_000.0;
/// Largest part of the energies exchanged that may be lost without a remark.
const ENERGY_KEPT: f64 = 1e-6;
/// A method is said to be far cheaper if it would take so many times fewer evaluations.
const FAR_CHEAPER: f64 = 4.0;

/// The free motion of a scene.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or its start cannot be evaluated. What ends the motion
/// on the way is in [`Followed::stopped`].
pub fn simulate(
    scene: &Scene,
    accuracy: &Accuracy,
    progress: Progress<'_>,
) -> Result<Followed, StudyError> {
    let Some(motion) = &scene.motion else {
        return Err(no_motion(scene));
    };
    let run = Free::new(scene, motion)?;
    let duration = run.duration()?;
    let every = accuracy.every.unwrap_or(duration / SAMPLES);
    let options = Options {
        absolute: accuracy.absolute,
        longest: accuracy.longest,
        every: Some(every.max(duration / MOST_SAMPLES)),
        ..Options::new(accuracy.method, accuracy.relative)
    };
    let explain = |e: &DynamicsError| explain_motion(scene, run.shown.plan(), e);
    let start = run.start();
    let events = run.events();
    let trace = follow(
        &run.machine,
        &run.shown,
        &start,
        duration,
        &options,
        &events,
    );
    let trace = trace.map_err(|e| explain(&e))?;
    let (samples, told) = run.samples(&trace).map_err(|e| explain(&e))?;
    let led = motion.laws.iter().map(Option::is_some).collect();
    let way = Way::free(run.shown.plan(), samples, told, led);
    let mut followed = write_up(&run.scene, &run.shown, &way, Command::Simulate, progress)?;
    let outcome = &mut followed.outcome;
    if !trace.occurrences.is_empty() {
        let name = format!("{}-motion-events.csv", scene.name);
        outcome.files.add(name, run.event_table(&trace).csv()?);
    }
    outcome.summary += &run.summary(&trace, accuracy, duration);
    if let Some(error) = &trace.failed {
        followed.stopped = Some(explain(error));
    }
    Ok(followed)
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
struct Free<'a> {
    /// The scene with the loads through which its drives act.
    scene: Scene,
    motion: &'a Motion,
    /// Everything that is shown of it.
    shown: Model,
    /// What moves.
    machine: Machine,
}

impl<'a> Free<'a> {
    fn new(scene: &Scene, motion: &'a Motion) -> Result<Self, StudyError> {
        let mut driven = scene.clone();
        let loads = all_loads(&scene.mechanism, &scene.loads, &scene.drives);
        driven.loads = loads.map_err(|e| explain_machine(scene, e.into()))?;
        let shown = loaded(&driven)?;
        check_variables(&driven, &shown)?;
        let machine = machine(scene, motion)?;
        Ok(Self {
            scene: driven,
            motion,
            shown,
            machine,
        })
    }

    fn start(&self) -> Point {
        Point {
            t: 0.0,
            y: self.machine.start(&self.motion.start, &self.motion.speed),
        }
    }

    /// How long the motion lasts, s.
    fn duration(&self) -> Result<f64, StudyError> {
        let periods = match self.motion.length {
            Length::Duration(duration) => return Ok(duration),
            Length::Periods(periods) => periods,
        };
        let label = [(Place::Length, "a period is needed".to_owned())];
        let unknown = || {
            self.scene.error(
                "only a free motion without loads and drives has a period that is known beforehand"
                    .to_owned(),
                Some("give a `duration` in s".to_owned()),
                &label,
            )
        };
        if !self.scene.loads.is_empty() || self.machine.free().len() != 1 {
            return Err(unknown().into());
        }
        let exact = Exact::new(self.machine.model().clone()).ok_or_else(unknown)?;
        let start = State {
            t: 0.0,
            q: self.motion.start[0],
            q_dot: self.motion.speed[0],
        };
        let turn = FreeTurn::new(&exact, start);
        let turn = turn.map_err(|e| explain_motion(&self.scene, self.shown.plan(), &e))?;
        Ok(periods * turn.period)
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

    /// Every sample with its accelerations, the drives' actions and the energies.
    fn samples(&self, trace: &Trace) -> Result<(Vec<Sample>, Vec<Told>), DynamicsError> {
        let mut work = self.machine.work();
        let mut ledger: Option<f64> = None;
        let mut samples = Vec::with_capacity(trace.samples.len() + 1);
        let end = trace.steps.last().filter(|end| {
            let last = trace.samples.last();
            last.is_some_and(|last| last.t < end.t)
        });
        for point in trace.samples.iter().chain(end) {
            self.machine.evaluate(point.t, &point.y, &mut work)?;
            samples.push(self.sample(point, &work, &mut ledger));
        }
        if let [only] = samples.as_slice() {
            // A motion that ends where it starts is still shown.
            samples.push(only.clone());
        }
        Ok((samples, self.told()))
    }

    fn sample(&self, point: &Point, work: &MachineWork, ledger: &mut Option<f64>) -> Sample {
        let first = self.machine.first_work();
        let [kinetic, potential] = self.machine.energy(work);
        let works = &point.y[first..];
        let sum = kinetic + potential - works.iter().sum::<f64>();
        let began = *ledger.get_or_insert(sum);
        let mut told = vec![kinetic, potential];
        told.extend(works);
        told.push(sum - began);
        told.extend(&point.y[2 * self.machine.free().len()..first]);
        let count = self.scene.loads.len();
        let drives = count - self.machine.drives()..count;
        Sample {
            t: point.t,
            q: work.q.clone(),
            q_dot: work.q_dot.clone(),
            q_ddot: work.q_ddot.clone(),
            given: drives
                .map(|load| (load, work.inner.loads().magnitude[load]))
                .collect(),
            told,
        }
    }

    /// The names of what [`Free::sample`] tells.
    fn told(&self) -> Vec<Told> {
        let told = |name: String, unit, meaning: &str| Told {
            name,
            unit,
            meaning: meaning.to_owned(),
        };
        let mut all = vec![
            told(KINETIC.into(), "J", "of all bodies and rotors"),
            told(
                POTENTIAL.into(),
                "J",
                "of gravity, springs and constant forces",
            ),
        ];
        for worker in self.machine.workers() {
            let name = self.worker(*worker);
            all.push(told(format!("{name}.work"), "J", "done since the start"));
        }
        let meaning =
            "kinetic + potential − work, less its value at the start: the integration's error";
        all.push(told(BALANCE.into(), "J", meaning));
        for drive in &self.scene.drives {
            match &drive.kind {
                DriveKind::Motor(motor) if motor.inductance > 0.0 => {
                    all.push(told(format!("{}.current", drive.name), "A", ""));
                }
                DriveKind::Regulator(regulator) if regulator.integral > 0.0 => {
                    let unit = if drive.coordinate.is_angle() {
                        "rad"
                    } else {
                        "m"
                    };
                    let meaning = "of the regulator's error";
                    all.push(told(format!("{}.integral", drive.name), unit, meaning));
                }
                _ => {}
            }
        }
        all
    }

    fn worker(&self, worker: Worker) -> String {
        match worker {
            Worker::Load(load) => self.scene.loads[load].name.clone(),
            Worker::Drive(drive) => self.scene.drives[drive].name.clone(),
            Worker::Prescribed(actuator) => self.scene.mechanism.actuators[actuator].name.clone(),
        }
    }

    /// When each event happened, and the coordinates then.
    fn event_table(&self, trace: &Trace) -> Table {
        let mut columns = vec![Column::new("t", "s"), Column::new("event", "")];
        let actuators = &self.scene.mechanism.actuators;
        for actuator in actuators {
            let unit = if actuator.coordinate().is_angle() {
                "rad"
            } else {
                "m"
            };
            columns.push(Column::new(actuator.name.clone(), unit));
            columns.push(Column::new(
                format!("{}.speed", actuator.name),
                format!("{unit}/s"),
            ));
        }
        let mut work = self.machine.work();
        let row = |o: &dwell_dynamics::Occurrence| {
            let mut row = vec![o.at.t, (o.event + 1) as f64];
            if self.machine.evaluate(o.at.t, &o.at.y, &mut work).is_ok() {
                let pairs = work.q.iter().zip(&work.q_dot);
                row.extend(pairs.flat_map(|(&q, &q_dot)| [q, q_dot]));
            }
            row.resize(2 + 2 * actuators.len(), f64::NAN);
            row
        };
        Table {
            columns,
            rows: trace.occurrences.iter().map(row).collect(),
        }
    }

    fn summary(&self, trace: &Trace, accuracy: &Accuracy, duration: f64) -> String {
        let end = trace.steps.last().map_or(0.0, |p| p.t);
        // Writing to a string cannot fail.
        let mut text = String::new();
        let reached = if end < duration {
            format!("{} of {} s", digits(end, 7), digits(duration, 7))
        } else {
            format!("{} s", digits(end, 7))
        };
        let _ = writeln!(
            text,
            "  {reached} by {} at relative {:e} and absolute {:e}",
            accuracy.method.name(),
            accuracy.relative,
            accuracy.absolute,
        );
        for (i, event) in self.motion.events.iter().enumerate() {
            let times: Vec<_> = trace.occurrences.iter().filter(|o| o.event == i).collect();
            let first = times
                .first()
                .map(|o| format!(", first at t = {} s", digits(o.at.t, 13)));
            let stopped = if event.stop && !times.is_empty() {
                ", where it ends"
            } else {
                ""
            };
            let _ = writeln!(
                text,
                "  {}: {} times{}{stopped}",
                event.name,
                times.len(),
                first.unwrap_or_default()
            );
        }
        let work = trace.statistics;
        let _ = writeln!(
            text,
            "  {} steps, {} rejected, {} evaluations, {} Jacobians, {} factorisations",
            work.steps, work.rejected, work.evaluations, work.jacobians, work.factorisations,
        );
        text + &self.energy(trace) + &self.hint(trace, accuracy, end)
    }

    /// How well the energies add up.
    fn energy(&self, trace: &Trace) -> String {
        let mut work = self.machine.work();
        let first = self.machine.first_work();
        let (mut began, mut largest, mut apart) = (None, 0.0_f64, 0.0_f64);
        for point in &trace.steps {
            if self.machine.evaluate(point.t, &point.y, &mut work).is_err() {
                break;
            }
            let [kinetic, potential] = self.machine.energy(&work);
            let sum = kinetic + potential - point.y[first..].iter().sum::<f64>();
            let began = *began.get_or_insert(sum);
            largest = largest.max(kinetic);
            apart = apart.max((sum - began).abs());
        }
        if largest == 0.0 {
            return "  it stays at rest: nothing moves it\n".to_owned();
        }
        let lost = apart / largest;
        let kinetic = digits(largest, 6);
        let mut text = format!(
            "  energy balance kept to {lost:.1e} of the largest kinetic energy, {kinetic} J\n"
        );
        if lost > ENERGY_KEPT {
            text += "  that is much: take a smaller --rtol\n";
        }
        text
    }

    /// Whether another method would be far cheaper, by how long this one's steps are against what its
    /// accuracy and its stability ask for.
    fn hint(&self, trace: &Trace, accuracy: &Accuracy, end: f64) -> String {
        let other = if accuracy.method.implicit() {
            Method::Tsit45
        } else {
            Method::Bdf
        };
        if trace.statistics.steps < 100 || end <= 0.0 {
            return String::new();
        }
        // A tenth of the motion by the other method says what the whole would take.
        let options = Options {
            absolute: accuracy.absolute,
            budget: trace.statistics.steps.max(100),
            ..Options::new(other, accuracy.relative)
        };
        let part = 0.1 * end;
        let tried = follow(
            &self.machine,
            &self.shown,
            &self.start(),
            part,
            &options,
            &[],
        );
        let cost = |method: Method, work: dwell_dynamics::Statistics| {
            // A Jacobian takes two evaluations in dual numbers for each free coordinate.
            let columns = 4 * self.machine.free().len() * usize::from(method.implicit());
            (work.evaluations + columns * work.jacobians) as f64
        };
        let Ok(tried) = tried else {
            return String::new();
        };
        let before = trace
            .steps
            .iter()
            .take_while(|p| p.t <= part)
            .count()
            .max(1);
        let share = before as f64 / trace.steps.len() as f64;
        let here = cost(accuracy.method, trace.statistics) * share;
        let there = cost(other, tried.statistics);
        if tried.failed.is_some() || here < FAR_CHEAPER * there {
            return String::new();
        }
        format!(
            "  hint: --method {} would take about {:.0} times fewer evaluations\n",
            other.name().to_lowercase(),
            here / there
        )
    }
}

/// Names of the energies' columns.
pub(crate) const KINETIC: &str = "energy.kinetic";
pub(crate) const POTENTIAL: &str = "energy.potential";
pub(crate) const BALANCE: &str = "energy.balance";

/// The machine of a scene: what its motion needs, and no other reaction.
pub(crate) fn machine(scene: &Scene, motion: &Motion) -> Result<Machine, StudyError> {
    let start = scene.assembly.to_start();
    let frictions = scene.loads.iter().filter_map(|load| match load.magnitude {
        Magnitude::Friction(friction) => Some(friction.reactions(&scene.mechanism)),
        _ => None,
    });
    let needed: Vec<Reaction> = frictions.flatten().collect();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &needed)
        .map_err(|e| crate::error::explain_model(scene, &e))?;
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
