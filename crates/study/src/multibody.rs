//! The free motion of a scene, judged by the full multibody equations.

use crate::error::{StudyError, explain_machine, explain_model};
use crate::motion_error::explain_motion;
use crate::reference::{Reached, Reference};
use crate::simulate::{Free, Moved};
use dwell_dynamics::{
    DynamicsError, Guidance, Machine, MachineError, Method, Options, Orbit, Point, all_loads,
};
use dwell_findings::Finding;
use dwell_geometry::measure::Measured;
use dwell_geometry::{BodyId, Vec2};
use dwell_kinetostatics::{Actions, Model, Workspace};
use dwell_scene::{Length, Scene};
use dwell_verify::{MotionSample, Unreduced, UnreducedError, judge_motion};
use std::f64::consts::TAU;

/// Integrator of the motion, and its relative and absolute tolerance.
const METHOD: Method = Method::Tsit45;
const TOLERANCE: f64 = 1e-13;
/// Periods that are judged, where there is a period and the scene asks for so many.
const PERIODS: f64 = 2.0;
/// Instants at which the motion is held against the multibody equations.
const INSTANTS: usize = 40;
/// What is left to do for a free actuator, as a part of the largest reaction: rounding.
const NOTHING: f64 = 1e-10;

/// A free motion, step by step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FreeRun {
    /// Every step of the integration, the start first: what is claimed of it.
    pub steps: Vec<MotionSample>,
    /// By step and actuator: coordinate (rad or m) and speed (per s).
    pub coordinates: Vec<Vec<[f64; 2]>>,
    /// Why it ended early, if it did.
    pub stopped: Option<String>,
}

impl FreeRun {
    /// Integrator and tolerance, as figures tell them.
    pub(crate) fn how() -> String {
        format!("{}, tolerance {TOLERANCE:e}", METHOD.name())
    }
}

/// The free motion of a scene over its duration or two periods, whichever is shorter; none where
/// the scene has no `[motion]`.
///
/// # Errors
/// [`StudyError::Scene`] when the scene cannot be put together or its start cannot be evaluated.
pub fn free_run(scene: &Scene) -> Result<Option<FreeRun>, StudyError> {
    followed(scene, None)
}

/// The same, or until a time.
fn followed(scene: &Scene, until: Option<f64>) -> Result<Option<FreeRun>, StudyError> {
    let Some(motion) = &scene.motion else {
        return Ok(None);
    };
    let loads = all_loads(&scene.mechanism, &scene.loads, &scene.drives);
    let mut driven = scene.clone();
    driven.loads = loads.map_err(|e| explain_machine(scene, e.into()))?;
    let free = Free::new(scene, &driven, motion)?;
    let period = Orbit::loaded(&free.machine, free.state()).ok();
    let period = period.filter(|_| free.machine.free().len() == 1 && motion.laws.len() == 1);
    let duration = match (motion.length, period) {
        _ if until.is_some() => until.unwrap_or_default(),
        (Length::Periods(n), Some(orbit)) => n.min(PERIODS) * orbit.period,
        (Length::Duration(d), Some(orbit)) => d.min(PERIODS * orbit.period),
        (_, None) => free.duration()?,
    };
    let moved = free.follow(scene, duration, &Options::new(METHOD, TOLERANCE))?;
    let shown = shown(&driven)?;
    let explain = |e: &DynamicsError| explain_motion(&driven, shown.plan(), e);
    let mut run = run(scene, &free.machine, &shown, &moved).map_err(|e| explain(&e))?;
    run.stopped = moved.failed.as_ref().map(|e| explain(e).to_string());
    Ok(Some(run))
}

/// The model with all loads and reactions.
fn shown(driven: &Scene) -> Result<Model, StudyError> {
    let start = driven.assembly.to_start();
    let mechanism = &driven.mechanism;
    Model::new(mechanism, &driven.masses, &start, &mechanism.reactions())
        .map_err(|e| explain_model(driven, &e))?
        .with_loads(mechanism, driven.loads.clone())
        .map_err(|e| explain_machine(driven, MachineError::from(e)))
}

/// Every step, leg by leg. Within the window of a bridge nothing is known of the reactions.
fn run(
    scene: &Scene,
    machine: &Machine,
    shown: &Model,
    moved: &Moved,
) -> Result<FreeRun, DynamicsError> {
    let mut run = FreeRun::default();
    for (k, (chart, trace)) in moved.legs.iter().enumerate() {
        let chart = moved.charts.get(*chart);
        let (machine, shown) =
            chart.map_or((machine, shown), |chart| (&chart.machine, &chart.shown));
        let mut eye = Eye::new(scene, machine, shown);
        // A leg begins with the state in which the last one ended.
        for point in trace.steps.iter().skip(usize::from(k > 0)) {
            if !machine.on_bridge(&point.y) {
                eye.look(point, &mut run)?;
            }
        }
    }
    Ok(run)
}

/// Reads everything off a state of a machine.
struct Eye<'a> {
    scene: &'a Scene,
    machine: &'a Machine,
    shown: &'a Model,
    work: dwell_dynamics::MachineWork,
    all: Workspace<f64>,
    actions: Actions<f64>,
}

impl<'a> Eye<'a> {
    fn new(scene: &'a Scene, machine: &'a Machine, shown: &'a Model) -> Self {
        Self {
            scene,
            machine,
            shown,
            work: machine.work(),
            all: shown.workspace(),
            actions: shown.actions(),
        }
    }

    /// Adds a state to the run. Angles go on from those before: no step turns a body by half a turn.
    fn look(&mut self, at: &Point, run: &mut FreeRun) -> Result<(), DynamicsError> {
        let (machine, work) = (self.machine, &mut self.work);
        machine.evaluate(at.t, &at.y, work)?;
        machine.show(self.shown, at.t, work, &mut self.all, &mut self.actions)?;
        let states = self.all.states();
        let near = |angle: f64, last: Option<f64>| match last {
            Some(last) => angle + ((last - angle) / TAU).round() * TAU,
            None => angle,
        };
        let last = run.steps.last();
        // There are more states: of what the lowering and the charts add.
        let all = (0..self.scene.mechanism.bodies.len()).map(BodyId);
        let frame = |body: BodyId| {
            let position = states.point(body, Vec2::ZERO).position;
            let state = states.body(body);
            let angle = state.angle.unwrap_or_else(|| state.turn.angle());
            let last = last.map(|sample| sample.bodies[body.0][2]);
            [position.x, position.y, near(angle, last)]
        };
        let rate = |body: BodyId| {
            let velocity = states.point(body, Vec2::ZERO).velocity;
            [velocity.x, velocity.y, states.body(body).spin]
        };
        let before = run.coordinates.last();
        let actuators = self.scene.mechanism.actuators.iter().enumerate();
        let coordinate = |(k, actuator): (usize, &dwell_geometry::Actuator)| {
            let measured = Measured::find(&self.scene.mechanism, actuator.coordinate());
            let [q, speed, _] = measured.map_or([f64::NAN; 3], |m| states.measure(m));
            match actuator.coordinate().is_angle() {
                true => [near(q, before.map(|all| all[k][0])), speed],
                false => [q, speed],
            }
        };
        let [kinetic, potential] = machine.energy(work);
        let sample = MotionSample {
            t: at.t,
            bodies: all.clone().map(frame).collect(),
            velocity: all.map(rate).collect(),
            reactions: self.actions.reactions.clone(),
            tau: self.left_over(),
            drives: self.work.action.clone(),
            kinetic,
            potential,
            work: at.y[machine.first_work()..].iter().sum(),
        };
        let coordinates = actuators.map(coordinate).collect();
        run.steps.push(sample);
        run.coordinates.push(coordinates);
        Ok(())
    }

    /// What the actuators do: nothing is left for one that is free, but for rounding.
    fn left_over(&self) -> Vec<f64> {
        let reactions = self.actions.reactions.iter();
        let most = reactions.fold(1.0_f64, |most, r| most.max(r.abs()));
        let mut tau = self.actions.tau.clone();
        for &free in self.machine.free() {
            if tau[free].abs() < NOTHING * most {
                tau[free] = 0.0;
            }
        }
        tau
    }
}

/// The findings of a scene's motion: the multibody equations, then what is known of it.
///
/// # Errors
/// As [`free_run`]; [`StudyError::Reference`] where a name is none of the scene's.
pub(crate) fn judged(
    scene: &Scene,
    reference: &Reference,
) -> Result<(Option<FreeRun>, Vec<Finding>), StudyError> {
    let Some(run) = free_run(scene)? else {
        return Ok((None, Vec::new()));
    };
    let mut findings = run.judge(scene);
    for known in &reference.motion {
        if let Some(run) = followed(scene, Some(known.t))? {
            findings.push(run.reaches(scene, known, &reference.source)?);
        }
    }
    Ok((Some(run), findings))
}

impl FreeRun {
    /// The values of the last step by name, each with its unit.
    fn last(&self, scene: &Scene) -> Vec<(String, &'static str, f64)> {
        let (Some(step), Some(coordinates)) = (self.steps.last(), self.coordinates.last()) else {
            return Vec::new();
        };
        let mut all = Vec::new();
        for (actuator, [q, speed]) in scene.mechanism.actuators.iter().zip(coordinates) {
            let [unit, of_speed] = match actuator.coordinate().is_angle() {
                true => ["rad", "rad/s"],
                false => ["m", "m/s"],
            };
            all.push((actuator.name.clone(), unit, *q));
            all.push((format!("{}.speed", actuator.name), of_speed, *speed));
        }
        let reactions = scene.mechanism.reactions();
        let named = reactions.iter().zip(&step.reactions).map(|(&r, value)| {
            let name = scene.mechanism.reaction_name(r);
            (name, r.component.unit(), *value)
        });
        all.extend(named);
        all
    }

    /// Holds the last step against what is known of it.
    fn reaches(&self, scene: &Scene, known: &Reached, source: &str) -> Result<Finding, StudyError> {
        let all = self.last(scene);
        let mut found = Vec::new();
        for (name, wanted) in &known.values {
            let Some((_, unit, value)) = all.iter().find(|(own, ..)| own == name) else {
                return Err(StudyError::Reference {
                    path: format!("{}: free_motion", scene.name),
                    reason: format!("`{name}` is no actuator, speed or reaction"),
                });
            };
            found.push((name, *unit, *value, *wanted));
        }
        let scale = |unit: &str| {
            let alike = found.iter().filter(|(_, own, ..)| *own == unit);
            alike.fold(0.0_f64, |most, (.., wanted)| most.max(wanted.abs()))
        };
        let mut finding = Finding {
            key: "published-motion".into(),
            truth: "9 published values".into(),
            compared: format!("the state that is reached with its published values ({source})"),
            over: format!("{} values at t = {} s", found.len(), known.t),
            absolute: 0.0,
            unit: String::new(),
            relative: 0.0,
            scale: "the largest published value of the unit".into(),
            worst: "none".into(),
            tolerance: known.relative,
            why: known.reason.clone(),
            integrated: true,
            ..Finding::default()
        };
        for (name, unit, value, wanted) in &found {
            let absolute = (value - wanted).abs();
            let relative = absolute / scale(unit);
            // What is not a number is the worst there is.
            if relative >= finding.relative || relative.is_nan() {
                (finding.absolute, finding.relative) = (absolute, relative);
                (finding.unit, finding.worst) = ((*unit).to_owned(), (*name).clone());
            }
        }
        finding.pass =
            self.stopped.is_none() && !found.is_empty() && finding.relative <= known.relative;
        Ok(finding)
    }

    /// Holds the run against the multibody equations of a scene: its own, but for deliberate faults.
    pub fn judge(&self, scene: &Scene) -> Vec<Finding> {
        let last = self.steps.len().saturating_sub(1);
        let mut instants: Vec<usize> = (0..=INSTANTS).map(|k| k * last / INSTANTS).collect();
        instants.dedup();
        let claims: Vec<MotionSample> = instants.iter().map(|&k| self.steps[k].clone()).collect();
        let judged = truth(scene).and_then(|truth| judge_motion(&truth, &claims));
        match (judged, &self.stopped) {
            (Ok(findings), None) => findings,
            (Ok(_), Some(why)) => vec![refused(why.clone())],
            (Err(error), _) => vec![refused(error.to_string())],
        }
    }
}

/// The multibody equations of a scene.
fn truth(scene: &Scene) -> Result<Unreduced, UnreducedError> {
    let laws = scene.motion.iter().flat_map(|motion| &motion.laws);
    let guide = |law: &Option<dwell_laws::Law>| {
        let led = law.clone().map(Guidance::Prescribed);
        led.unwrap_or(Guidance::Free)
    };
    let guidance: Vec<Guidance> = laws.map(guide).collect();
    Unreduced::new(
        &scene.mechanism,
        &scene.masses,
        &scene.loads,
        &guidance,
        &scene.drives,
    )
}

/// A motion that could not be judged fails.
fn refused(why: String) -> Finding {
    Finding {
        key: "motion".into(),
        truth: "6 full multibody equations".into(),
        compared: "the motion with that of the multibody equations".into(),
        over: "the motion".into(),
        worst: why,
        why: "a motion that cannot be followed cannot be judged".into(),
        integrated: true,
        ..Finding::default()
    }
}
