//! The free motion of a scene, compared with the multibody equations in absolute coordinates.

use crate::cases::reference::{PublishedState, Reference};
use crate::checked::free_motion_setup::FreeMotionSetup;
use crate::checked::states::inertias;
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::largest;
use dwell_dynamics::{CoordinateMode, DynamicsError, Machine, Method, OdeState, Options, Orbit};
use dwell_findings::{Check, Finding};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{BodyId, Vec2};
use dwell_kinetostatics::{InverseDynamics, Model, Workspace};
use dwell_scene::{MotionDuration, PlaneScene};
use dwell_study::StudyError;
use dwell_study::free_motion::compute::{FreeMotionProblem, MotionProblem as _, SegmentedMotion};
use dwell_study::models::with_drive_loads;
use dwell_verify::{FindingSpec, MotionSample, MultibodyError, MultibodySystem, check_motion};
use std::f64::consts::TAU;

/// Integrator of the motion, and its relative and absolute tolerance.
const METHOD: Method = Method::Tsit45;
const TOLERANCE: f64 = 1e-13;
/// The most periods that are compared.
const MAX_PERIODS: f64 = 2.0;
/// Instants at which the motion is compared with the multibody equations.
const CHECKED_INSTANTS: usize = 40;
/// The residual force of a free actuator that is rounding, as a part of the largest reaction.
const ZERO_FORCE: f64 = 1e-10;

/// A free motion, step by step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FreeMotionRun {
    /// Every step of the integration, the start first, as it is claimed.
    pub steps: Vec<MotionSample>,
    /// By step and actuator: coordinate (rad or m) and speed (per s).
    pub coordinates: Vec<Vec<[f64; 2]>>,
    /// Why it ended early, if it did.
    pub stop_reason: Option<String>,
    /// The free motion of a scene without `[motion]` in words; else empty.
    pub setup: String,
    /// The scene's events that happened: the number of each, with its instant.
    pub events: Vec<(usize, OdeState)>,
}

impl FreeMotionRun {
    /// Integrator and tolerance, as figure captions give them.
    pub(crate) fn method_text() -> String {
        format!("{}, tolerance {TOLERANCE:e}", METHOD.name())
    }
}

/// The free motion of a scene over its duration or two periods, whichever is shorter; none where
/// the scene has no `[motion]`.
///
/// # Errors
/// [`StudyError::Scene`] when the scene cannot be put together or its start cannot be evaluated.
pub fn free_motion_run(scene: &PlaneScene) -> Result<Option<FreeMotionRun>, StudyError> {
    solve_motion(scene, None, None)
}

/// The same, or until a time.
fn solve_motion(
    scene: &PlaneScene,
    until: Option<f64>,
    max_step: Option<f64>,
) -> Result<Option<FreeMotionRun>, StudyError> {
    let Some(motion) = &scene.motion else {
        return Ok(None);
    };
    let scene_with_drives = with_drive_loads(scene)?;
    let free = FreeMotionProblem::new(scene, &scene_with_drives, motion)?;
    let period = Orbit::loaded(&free.machine, free.initial_reduced_state()).ok();
    let period = period.filter(|_| free.machine.free().len() == 1 && motion.laws.len() == 1);
    let duration = match (motion.duration, period) {
        _ if until.is_some() => until.unwrap_or_default(),
        (MotionDuration::Periods(n), Some(orbit)) => n.min(MAX_PERIODS) * orbit.period,
        (MotionDuration::Seconds(d), Some(orbit)) => d.min(MAX_PERIODS * orbit.period),
        (_, None) => free.duration()?,
    };
    let options = Options {
        max_step,
        ..Options::new(METHOD, TOLERANCE)
    };
    let motion_segments = free.solve(duration, &options)?;
    let run = collect_steps(scene, &free, &motion_segments);
    let mut run = run.map_err(|e| free.explain(&e))?;
    let events = motion_segments.occurrences();
    let events = events.map(|(_, o)| (o.event, o.state.clone()));
    run.events = events.collect();
    let failure = motion_segments.failure.as_ref();
    run.stop_reason = failure.map(|e| free.explain(e).to_string());
    Ok(Some(run))
}

/// Every step, segment by segment. Within the window of a change point's fit there are no reactions.
fn collect_steps(
    scene: &PlaneScene,
    problem: &FreeMotionProblem<'_>,
    motion_segments: &SegmentedMotion,
) -> Result<FreeMotionRun, DynamicsError> {
    let mut run = FreeMotionRun::default();
    for (k, (chart, solution)) in motion_segments.segments.iter().enumerate() {
        let chart = motion_segments.charts.get(*chart);
        let (machine, output_model) = match chart {
            Some(chart) => (&chart.machine, &chart.output_model),
            None => (&problem.machine, &problem.output_model),
        };
        let mut reader = StateReader {
            scene,
            machine,
            output_model,
            workspace: machine.workspace(),
            output_workspace: output_model.workspace(),
            result: output_model.result_buffer(),
        };
        // A segment begins with the state in which the last one ended.
        for point in solution.steps.iter().skip(usize::from(k > 0)) {
            if !machine.is_in_fit_window(&point.y) {
                reader.append(point, &mut run)?;
            }
        }
    }
    Ok(run)
}

/// Evaluates states of a machine.
struct StateReader<'a> {
    scene: &'a PlaneScene,
    machine: &'a Machine,
    output_model: &'a Model,
    workspace: dwell_dynamics::MachineWorkspace,
    output_workspace: Workspace<f64>,
    result: InverseDynamics<f64>,
}

impl StateReader<'_> {
    /// Adds a state to the run. Angles go on from those before: no step rotates a body by half a revolution.
    fn append(&mut self, at: &OdeState, run: &mut FreeMotionRun) -> Result<(), DynamicsError> {
        let machine = self.machine;
        let state = machine.evaluate(at.t, &at.y, &mut self.workspace)?;
        let (workspace, result) = (&mut self.output_workspace, &mut self.result);
        let outputs = state.outputs(self.output_model, workspace, result)?;
        let (states, result) = (outputs.bodies(), outputs.inverse_dynamics());
        let unwrapped = |angle: f64, last: Option<f64>| match last {
            Some(last) => angle + ((last - angle) / TAU).round() * TAU,
            None => angle,
        };
        let last = run.steps.last();
        // There are more bodies: those that the lowering and the charts add.
        let motion_of = |b: usize| {
            let (body, state) = (BodyId(b), states.body(BodyId(b)));
            let origin = states.point(body, Vec2::ZERO);
            let angle = state.angle.unwrap_or_else(|| state.rotation.angle());
            let angle = unwrapped(angle, last.map(|sample| sample.poses[b][2]));
            let (x, v) = (origin.position, origin.velocity);
            ([x.x, x.y, angle], [v.x, v.y, state.angular_velocity])
        };
        let bodies = 0..self.scene.mechanism.bodies.len();
        let (poses, velocities) = bodies.map(motion_of).unzip();
        let previous = run.coordinates.last();
        let actuators = self.scene.mechanism.actuators.iter().enumerate();
        let coordinate = |(k, actuator): (usize, &dwell_geometry::Actuator)| {
            let function = CoordinateFunction::find(&self.scene.mechanism, actuator.coordinate());
            let [q, speed, _] = function.map_or([f64::NAN; 3], |m| states.coordinate(m));
            match actuator.coordinate().is_angle() {
                true => [unwrapped(q, previous.map(|all| all[k][0])), speed],
                false => [q, speed],
            }
        };
        let [kinetic, potential] = state.energy();
        let sample = MotionSample {
            t: at.t,
            poses,
            velocities,
            reactions: result.reactions.clone(),
            tau: residual_actuator_forces(machine, result),
            drive_forces: state.drive_forces().to_vec(),
            kinetic,
            potential,
            work: at.y[machine.work_offset()..].iter().sum(),
        };
        let coordinates = actuators.map(coordinate).collect();
        run.steps.push(sample);
        run.coordinates.push(coordinates);
        Ok(())
    }
}

/// The actuator forces; that of a free actuator is zero but for rounding.
fn residual_actuator_forces(machine: &Machine, result: &InverseDynamics<f64>) -> Vec<f64> {
    let reactions = result.reactions.iter();
    let max = reactions.fold(1.0_f64, |max, r| max.max(r.abs()));
    let mut tau = result.tau.clone();
    for &free in machine.free() {
        if tau[free].abs() < ZERO_FORCE * max {
            tau[free] = 0.0;
        }
    }
    tau
}

/// A free motion, if the scene has one, with its findings.
pub(crate) type CheckedRun = (Option<FreeMotionRun>, Vec<Finding>);

/// The findings of a scene's motion: the multibody equations, then its published values. A scene without one is
/// set free.
///
/// # Errors
/// As [`free_motion_run`]; [`ValidationError::Reference`] where a name is none of the scene's.
pub(crate) fn check_free_motion(
    scene: &PlaneScene,
    reference: &Reference,
) -> Result<CheckedRun, ValidationError> {
    let Some(run) = free_motion_run(scene)? else {
        let setup = FreeMotionSetup::new(scene, reference)?;
        let Some(mut run) = solve_motion(&setup.scene, None, Some(setup.max_step))? else {
            return Ok((None, Vec::new()));
        };
        setup.truncate(&mut run);
        let mut findings = run.check(&setup.scene);
        for finding in &mut findings {
            finding.domain += &format!(", {}", run.setup);
        }
        return Ok((Some(run), findings));
    };
    let mut findings = run.check(scene);
    for published in &reference.motion_states {
        if let Some(run) = solve_motion(scene, Some(published.t), None)? {
            findings.push(run.compare_published(scene, published, &reference.source)?);
        }
    }
    Ok((Some(run), findings))
}

impl FreeMotionRun {
    /// The values of the last step by name, each with its unit.
    fn final_values(&self, scene: &PlaneScene) -> Vec<(String, &'static str, f64)> {
        let (Some(step), Some(coordinates)) = (self.steps.last(), self.coordinates.last()) else {
            return Vec::new();
        };
        let actuators = scene.mechanism.actuators.iter().zip(coordinates);
        let values = actuators.flat_map(|(actuator, [q, speed])| {
            let units = match actuator.coordinate().is_angle() {
                true => ["rad", "rad/s"],
                false => ["m", "m/s"],
            };
            let name = &actuator.name;
            let velocity = (format!("{name}.velocity"), units[1], *speed);
            [(name.clone(), units[0], *q), velocity]
        });
        let reactions = scene.mechanism.reactions();
        let named = reactions.iter().zip(&step.reactions).map(|(&r, value)| {
            let name = scene.mechanism.reaction_name(r);
            (name, r.component.unit(), *value)
        });
        values.chain(named).collect()
    }

    /// Compares the last step with its published values.
    fn compare_published(
        &self,
        scene: &PlaneScene,
        published: &PublishedState,
        source: &str,
    ) -> Result<Finding, ValidationError> {
        let values = self.final_values(scene);
        let mut found = Vec::new();
        for (name, expected) in &published.values {
            let Some((_, unit, value)) = values.iter().find(|(known, ..)| known == name) else {
                return Err(ValidationError::Reference {
                    path: format!("{}: free_motion", scene.name),
                    reason: format!("`{name}` is no actuator, velocity or reaction"),
                });
            };
            found.push((name, *unit, *value, *expected));
        }
        let mut worst = Differences::default();
        for (name, unit, value, expected) in &found {
            let same = found.iter().filter(|(_, of, ..)| of == unit);
            let scale = largest(same.map(|(.., expected)| expected));
            worst.compare([*value, *expected, scale], unit, || name.as_str());
        }
        if found.is_empty() {
            worst.fail("there are no values");
        }
        let spec = FindingSpec {
            key: "published-motion",
            check: Check::ReferenceValues,
            comparison: &format!("the state that is reached with its published values ({source})"),
            scale: "the largest published value of the unit",
            tolerance: published.tolerance,
            tolerance_reason: &published.reason,
        };
        let domain = format!("{} values at t = {} s", found.len(), published.t);
        let finding = worst.finding(&spec, &domain).unwrap_or_default();
        Ok(Finding {
            integrated: true,
            pass: finding.pass && self.stop_reason.is_none(),
            ..finding
        })
    }

    /// Compares the run with the multibody equations of a scene: its own, but for deliberate faults.
    pub fn check(&self, scene: &PlaneScene) -> Vec<Finding> {
        let last = self.steps.len().saturating_sub(1);
        let instants = (0..=CHECKED_INSTANTS).map(|k| k * last / CHECKED_INSTANTS);
        let mut instants: Vec<usize> = instants.collect();
        instants.dedup();
        let claimed: Vec<MotionSample> = instants.iter().map(|&k| self.steps[k].clone()).collect();
        let outcome = multibody_system(scene).and_then(|system| check_motion(&system, &claimed));
        match (outcome, &self.stop_reason) {
            (Ok(findings), None) => findings,
            (Ok(_), Some(why)) => vec![failed_finding(why.clone())],
            (Err(error), _) => vec![failed_finding(error.to_string())],
        }
    }
}

/// The multibody equations of a scene.
fn multibody_system(scene: &PlaneScene) -> Result<MultibodySystem, MultibodyError> {
    let laws = scene.motion.iter().flat_map(|motion| &motion.laws);
    let mode = |law: &Option<dwell_laws::Law>| {
        let prescribed = law.clone().map(CoordinateMode::Prescribed);
        prescribed.unwrap_or(CoordinateMode::Free)
    };
    let modes: Vec<CoordinateMode> = laws.map(mode).collect();
    let (inertias, loads) = (inertias(scene), &scene.loads);
    MultibodySystem::new(&scene.mechanism, inertias, loads, &modes, &scene.drives)
}

/// The failed finding of a motion that could not be compared.
fn failed_finding(why: String) -> Finding {
    Finding {
        key: "motion".into(),
        check: Check::MultibodyMotion,
        comparison: "the motion with that of the multibody equations".into(),
        domain: "the motion".into(),
        worst_at: why,
        tolerance_reason: "a motion that cannot be computed cannot be checked".into(),
        integrated: true,
        ..Finding::default()
    }
}
