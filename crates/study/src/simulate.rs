//! `dwell simulate`: the free motion of a machine in time, under its loads and drives.

use crate::error::{StudyError, explain_machine, explain_model};
use crate::motion_error::explain_motion;
use crate::outcome::Progress;
use crate::run::{Command, Followed, Sample, Told, Way, check_variables, loaded, write_up};
use crate::words::digits;
use dwell_dynamics::atlas::{Atlas, AtlasError, Chart, Journey, Site, Why};
use dwell_dynamics::{
    DriveKind, DynamicsError, Event, Fate, Guidance, Machine, MachineWork, Method, Occurrence,
    Options, Orbit, Point, State, Statistics, Trace, Trigger, Worker, all_loads, fate, follow,
};
use dwell_geometry::measure::Measured;
use dwell_geometry::{Coordinate, Reaction, Start};
use dwell_kinetostatics::{Magnitude, Model};
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
/// Changes of coordinate that are told.
const TOLD: usize = 6;
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
    let mut driven = scene.clone();
    let loads = all_loads(&scene.mechanism, &scene.loads, &scene.drives);
    driven.loads = loads.map_err(|e| explain_machine(scene, e.into()))?;
    let run = Free::new(scene, &driven, motion)?;
    let duration = run.duration()?;
    let every = accuracy.every.unwrap_or(duration / SAMPLES);
    let options = Options {
        absolute: accuracy.absolute,
        longest: accuracy.longest,
        every: Some(every.max(duration / MOST_SAMPLES)),
        ..Options::new(accuracy.method, accuracy.relative)
    };
    let explain = |e: &DynamicsError| explain_motion(&driven, run.shown.plan(), e);
    let moved = run.follow(scene, duration, &options)?;
    let told = run.told();
    let samples = run.samples(&moved).map_err(|e| explain(&e))?;
    let led = motion.laws.iter().map(Option::is_some).collect();
    let charts = moved.charts.iter().map(|c| c.shown.clone()).collect();
    let way = Way::free(run.shown.plan(), samples, told, led, charts);
    let mut followed = write_up(&driven, &run.shown, &way, Command::Simulate, progress)?;
    let outcome = &mut followed.outcome;
    if moved.occurrences().next().is_some() {
        let name = format!("{}-motion-events.csv", scene.name);
        outcome.files.add(name, run.event_table(&moved).csv()?);
    }
    outcome.summary += &run.summary(&moved, accuracy, duration);
    if let Some(error) = &moved.failed {
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
    scene: &'a Scene,
    motion: &'a Motion,
    /// Everything that is shown of it.
    shown: Model,
    /// What moves.
    machine: Machine,
}

/// A motion, leg by leg.
struct Moved {
    /// None where there is but the mechanism's own coordinate.
    charts: Vec<Chart>,
    /// By leg: its chart and its trace, and the only actuator's coordinate at its samples.
    legs: Vec<(usize, Trace)>,
    own: Vec<Vec<[f64; 3]>>,
    /// What is to be said of the charts.
    changes: Vec<String>,
    failed: Option<DynamicsError>,
    statistics: Statistics,
}

impl Moved {
    fn occurrences(&self) -> impl Iterator<Item = (usize, &Occurrence)> {
        self.legs
            .iter()
            .flat_map(|(chart, trace)| trace.occurrences.iter().map(|o| (*chart, o)))
    }

    fn end(&self) -> f64 {
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
    fn new(scene: &Scene, driven: &'a Scene, motion: &'a Motion) -> Result<Self, StudyError> {
        let shown = loaded(driven)?;
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
    fn follow(&self, scene: &Scene, duration: f64, options: &Options) -> Result<Moved, StudyError> {
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
            return Ok(Moved {
                charts: Vec::new(),
                own: Vec::new(),
                changes: Vec::new(),
                failed: trace.failed.clone(),
                statistics: trace.statistics,
                legs: vec![(0, trace)],
            });
        }
        let at = Start {
            q: scene.assembly.start.clone(),
            rough: scene.assembly.rough.clone(),
        };
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
    fn duration(&self) -> Result<f64, StudyError> {
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
    fn state(&self) -> State {
        let first = self.machine.free().first().copied().unwrap_or(0);
        State {
            t: 0.0,
            q: self.motion.start[first],
            q_dot: self.motion.speed[first],
        }
    }

    /// What becomes of a conservative motion of one freedom, by its energy alone.
    fn fate(&self) -> String {
        let led = self.motion.laws.iter().any(Option::is_some);
        if led || self.machine.free().len() != 1 || !self.scene.drives.is_empty() {
            return String::new();
        }
        let name = &self.scene.mechanism.actuators[0].name;
        let angle = self.shown.plan().is_angle(0);
        let unit = if angle { "rad" } else { "m" };
        let period = || match Orbit::loaded(&self.machine, self.state()) {
            Ok(orbit) => format!("; period {} s by quadrature", digits(orbit.period, 13)),
            Err(_) => String::new(),
        };
        match fate(&self.machine, self.state()) {
            Ok(Fate::Turns { spare, .. }) => format!(
                "  by its energy it passes its highest potential, with {} J to spare{}\n",
                digits(spare, 6),
                period()
            ),
            Ok(Fate::Swings { between: [a, b] }) => format!(
                "  by its energy it swings between {name} = {} and {} {unit}{}\n",
                digits(a, 10),
                digits(b, 10),
                period()
            ),
            Ok(Fate::Creeps { to }) => format!(
                "  by its energy it creeps towards {name} = {} {unit} and does not arrive\n",
                digits(to, 10)
            ),
            _ => String::new(),
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

    /// Every sample with its accelerations, the drives' actions and the energies. Within the window of a
    /// bridge there are no reactions to be told, and no row.
    fn samples(&self, moved: &Moved) -> Result<Vec<Sample>, DynamicsError> {
        let mut ledger: Option<f64> = None;
        let mut samples = Vec::new();
        for (leg, (chart, trace)) in moved.legs.iter().enumerate() {
            let machine = self.machine(moved, *chart);
            let mut work = machine.work();
            for (k, point) in trace.samples.iter().enumerate() {
                if machine.on_bridge(&point.y) {
                    continue;
                }
                machine.evaluate(point.t, &point.y, &mut work)?;
                let own = moved.own.get(leg).and_then(|leg| leg.get(k)).copied();
                samples.push(self.sample(machine, *chart, own, point, &work, &mut ledger));
            }
        }
        if let [only] = samples.as_slice() {
            // A motion that ends where it starts is still shown.
            samples.push(only.clone());
        }
        Ok(samples)
    }

    fn sample(
        &self,
        machine: &Machine,
        chart: usize,
        own: Option<[f64; 3]>,
        point: &Point,
        work: &MachineWork,
        ledger: &mut Option<f64>,
    ) -> Sample {
        let first = machine.first_work();
        let [kinetic, potential] = machine.energy(work);
        let works = &point.y[first..];
        let sum = kinetic + potential - works.iter().sum::<f64>();
        let began = *ledger.get_or_insert(sum);
        let mut told = vec![kinetic, potential];
        told.extend(works);
        told.push(sum - began);
        told.extend(&point.y[2 * machine.free().len()..first]);
        let count = self.scene.loads.len();
        let drives = count - machine.drives()..count;
        Sample {
            t: point.t,
            q: work.q.clone(),
            q_dot: work.q_dot.clone(),
            q_ddot: work.q_ddot.clone(),
            chart,
            own,
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
    fn event_table(&self, moved: &Moved) -> Table {
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
        let row = |(chart, o): (usize, &Occurrence)| {
            let machine = self.machine(moved, chart);
            let mut work = machine.work();
            let mut row = vec![o.at.t, (o.event + 1) as f64];
            if machine.evaluate(o.at.t, &o.at.y, &mut work).is_ok() {
                for actuator in actuators {
                    let measured = Measured::find(&self.scene.mechanism, actuator.coordinate());
                    let [q, q_dot, _] = measured.map_or([f64::NAN; 3], |measured| {
                        work.inner.states().measure(measured)
                    });
                    row.extend([q, q_dot]);
                }
            }
            row.resize(2 + 2 * actuators.len(), f64::NAN);
            row
        };
        Table {
            columns,
            rows: moved.occurrences().map(row).collect(),
        }
    }

    fn summary(&self, moved: &Moved, accuracy: &Accuracy, duration: f64) -> String {
        let end = moved.end();
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
            let times: Vec<_> = moved.occurrences().filter(|(_, o)| o.event == i).collect();
            let first = times
                .first()
                .map(|(_, o)| format!(", first at t = {} s", digits(o.at.t, 13)));
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
        for change in &moved.changes {
            let _ = writeln!(text, "  {change}");
        }
        let work = moved.statistics;
        let _ = writeln!(
            text,
            "  {} steps, {} rejected, {} evaluations, {} Jacobians, {} factorisations",
            work.steps, work.rejected, work.evaluations, work.jacobians, work.factorisations,
        );
        text + &self.fate() + &self.energy(moved) + &self.hint(moved, accuracy, end)
    }

    /// How well the energies add up.
    fn energy(&self, moved: &Moved) -> String {
        let (mut began, mut largest, mut apart) = (None, 0.0_f64, 0.0_f64);
        let mut works: Vec<Option<MachineWork>> = Vec::new();
        for (chart, point) in moved.steps() {
            let machine = self.machine(moved, chart);
            works.resize_with(works.len().max(chart + 1), || None);
            let work = works[chart].get_or_insert_with(|| machine.work());
            if machine.evaluate(point.t, &point.y, work).is_err() {
                break;
            }
            let [kinetic, potential] = machine.energy(work);
            let sum = kinetic + potential - point.y[machine.first_work()..].iter().sum::<f64>();
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
    fn hint(&self, moved: &Moved, accuracy: &Accuracy, end: f64) -> String {
        let other = if accuracy.method.implicit() {
            Method::Tsit45
        } else {
            Method::Bdf
        };
        if moved.statistics.steps < 100 || end <= 0.0 || moved.legs.len() > 1 {
            return String::new();
        }
        // A tenth of the motion by the other method says what the whole would take.
        let options = Options {
            absolute: accuracy.absolute,
            budget: moved.statistics.steps.max(100),
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
        let before = moved.steps().take_while(|(_, p)| p.t <= part).count();
        let share = before.max(1) as f64 / moved.steps().count() as f64;
        let here = cost(accuracy.method, moved.statistics) * share;
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

/// The machine of a scene: some reactions and what its motion needs, and no other.
pub(crate) fn machine(
    scene: &Scene,
    motion: &Motion,
    reactions: &[Reaction],
) -> Result<Machine, StudyError> {
    let start = Start {
        q: scene.assembly.start.clone(),
        rough: scene.assembly.rough.clone(),
    };
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
