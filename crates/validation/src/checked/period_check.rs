//! Check 5 of a motion under conservative loads: its period by quadrature against the
//! integrator's events.

use crate::cases::reference::Reference;
use crate::checked::free_motion_setup::FreeMotionSetup;
use dwell_dynamics::{DynamicsError, Method, MotionClass, Options, Orbit};
use dwell_findings::{Check, Finding};
use dwell_kinetostatics::{Load, Magnitude};
use dwell_scene::{EventTrigger, FreeMotionSpec, MotionDuration, NamedEvent, PlaneScene};
use dwell_study::StudyError;
use dwell_study::free_motion::compute::{FreeMotionProblem, MotionProblem as _};
use dwell_study::models::with_drive_loads;
use std::f64::consts::TAU;

/// Tolerances of the integrator, from the coarsest to the finest; the finest has a tolerance of its own.
const TOLERANCES: [f64; 4] = [1e-7, 1e-9, 1e-11, 1e-13];
/// The largest error of the period, in tolerances of a step.
const ERROR_FACTOR: f64 = 300.0;
/// Below this the error is rounding, without a slope.
const ROUNDING_FLOOR: f64 = 1e-12;
/// The smallest slope of log error over log tolerance.
const MIN_SLOPE: f64 = 0.6;
/// Duration of the integration over that of the event.
const DURATION_RATIO: f64 = 1.02;

/// The findings, or in a few words why there is no period.
pub(crate) type PeriodFindings = Result<Vec<Finding>, &'static str>;

/// Checks the period of a case; a scene without `[motion]` is set free.
///
/// # Errors
/// As [`check_period`].
pub(crate) fn check_case(
    scene: &PlaneScene,
    reference: &Reference,
) -> Result<PeriodFindings, StudyError> {
    match scene.motion {
        Some(_) => check_period(scene),
        None => check_period(&FreeMotionSetup::new(scene, reference)?.scene),
    }
}

/// Checks the period of a scene's motion.
///
/// # Errors
/// [`StudyError::Scene`] when the scene cannot be put together.
fn check_period(scene: &PlaneScene) -> Result<PeriodFindings, StudyError> {
    let Some(spec) = &scene.motion else {
        return Ok(Err("no motion"));
    };
    if spec.laws.iter().any(Option::is_some) {
        return Ok(Err("prescribed"));
    }
    if spec.laws.len() != 1 {
        return Ok(Err("several degrees of freedom"));
    }
    let loaded_scene = with_drive_loads(scene)?;
    let problem = FreeMotionProblem::new(scene, &loaded_scene, spec)?;
    let orbit = match Orbit::loaded(&problem.machine, problem.initial_reduced_state()) {
        Ok(orbit) => orbit,
        Err(DynamicsError::NotConservative { .. }) => return Ok(Err(nonconservative_cause(scene))),
        Err(DynamicsError::AtRest) => return Ok(Err("at rest")),
        Err(DynamicsError::AsymptoticMotion { .. }) => return Ok(Err("asymptotic")),
        Err(DynamicsError::NotResolved { .. }) => return Ok(Err("not resolved")),
        Err(DynamicsError::NoFullRevolution { .. }) => return Ok(Err("reaches a limit")),
        Err(DynamicsError::Undecided { .. }) => return Ok(Err("never returns")),
        Err(DynamicsError::Position(_)) => return Ok(Err("change point")),
        Err(_) => return Ok(Err("no period")),
    };
    let coordinate = scene.mechanism.actuators[0].coordinate();
    // Of a libration the first and the third reversal are a period apart.
    let (trigger, from, to, length) = match orbit.motion_class {
        MotionClass::Rotation { period, .. } => {
            let revolutions = (period.abs() / TAU).round().max(1.0) as usize;
            let trigger = EventTrigger::Revolution(coordinate);
            (trigger, None, revolutions - 1, 1.0)
        }
        _ => (EventTrigger::Reversal(coordinate), Some(0), 2, 2.0),
    };
    let event = NamedEvent {
        name: "period".to_owned(),
        trigger,
        terminal: false,
    };
    let timed_spec = FreeMotionSpec {
        duration: MotionDuration::Seconds(DURATION_RATIO * length * orbit.period),
        events: vec![event],
        ..spec.clone()
    };
    let problem = FreeMotionProblem::new(scene, &loaded_scene, &timed_spec)?;
    let mut errors = Vec::new();
    for tolerance in TOLERANCES {
        let options = Options::new(Method::Tsit45, tolerance);
        let motion = problem.solve(problem.duration()?, &options)?;
        let times: Vec<f64> = motion.occurrences().map(|(_, o)| o.state.t).collect();
        let start_time = from.map_or(Some(0.0), |k: usize| times.get(k).copied());
        let (Some(start_time), Some(end_time)) = (start_time, times.get(to)) else {
            return Ok(Ok(vec![missed_event(&orbit, tolerance)]));
        };
        errors.push((end_time - start_time - orbit.period).abs());
    }
    Ok(Ok(findings(&orbit, &errors)))
}

/// The cause of nonconservative work.
fn nonconservative_cause(scene: &PlaneScene) -> &'static str {
    let is_friction = |load: &Load| matches!(load.magnitude, Magnitude::Friction(_));
    match () {
        () if !scene.drives.is_empty() => "driven",
        () if scene.loads.iter().any(is_friction) => "friction",
        () => "not conservative",
    }
}

/// The finding of the period with an absolute error, s.
fn period_finding(orbit: &Orbit, error: f64, worst_at: String) -> Finding {
    let (period, fine) = (orbit.period, TOLERANCES[TOLERANCES.len() - 1]);
    let event = match orbit.motion_class {
        MotionClass::Rotation { .. } => "whole revolution",
        _ => "first and third reversals",
    };
    let (numbers, tolerance) = ([error, error / period], ERROR_FACTOR * fine);
    Finding {
        comparison: format!(
            "T = ∮ √(m / 2(E − V)) dq = {period:.12} s with the integrator's {event}"
        ),
        domain: format!("one period, {} points of the trapezoid rule", orbit.points),
        unit: "s".into(),
        scale: "the period".into(),
        worst_at,
        tolerance_reason: format!(
            "{ERROR_FACTOR} times the tolerance of a step: some tens are reached in a period"
        ),
        integrated: true,
        ..Finding::new("period-integrated", Check::Period, numbers, tolerance)
    }
}

/// The event did not come.
fn missed_event(orbit: &Orbit, tolerance: f64) -> Finding {
    let worst_at = format!("no such event, Tsit45 at a tolerance of {tolerance:.0e}");
    period_finding(orbit, f64::NAN, worst_at)
}

fn findings(orbit: &Orbit, errors: &[f64]) -> Vec<Finding> {
    let (first, last) = (errors[0], errors[errors.len() - 1]);
    let [coarse, fine] = [TOLERANCES[0], TOLERANCES[TOLERANCES.len() - 1]];
    let worst_at = format!("T = {:.6} s, Tsit45 at {fine:.0e}", orbit.period);
    let mut findings = vec![period_finding(orbit, last, worst_at)];
    // A motion that is linear in time has no error that could fall.
    if first / orbit.period > 1e3 * ROUNDING_FLOOR {
        let rounding_floor = ROUNDING_FLOOR * orbit.period;
        let reached = errors.iter().position(|&error| error <= rounding_floor);
        let until = reached.unwrap_or(errors.len() - 1).max(1);
        let decades = (first / errors[until].max(rounding_floor)).log10();
        let slope = decades / (coarse / TOLERANCES[until]).log10();
        let shortfall = (MIN_SLOPE - slope).max(0.0);
        findings.push(Finding {
            comparison: format!(
                "the slope of log error of the period over log tolerance, {slope:.1}, with at least {MIN_SLOPE}"
            ),
            domain: format!("Tsit45 at {coarse:.0e} to {:.0e}", TOLERANCES[until]),
            unit: "(missing slope)".into(),
            scale: "one".into(),
            worst_at: "the line through both ends".into(),
            tolerance_reason: "an integrator that obeys its tolerance has a slope near 1".into(),
            integrated: true,
            pass: slope >= MIN_SLOPE,
            ..Finding::new("period-convergence", Check::Period, [shortfall; 2], 0.0)
        });
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar on a pin under its weight, started downwards with a speed in rad/s.
    fn pendulum(speed: f64, more: &str) -> PlaneScene {
        let text = format!(
            "[bodies.ground]\npoints = {{ A = [0, 0] }}\n[bodies.bar]\npoints = {{ A = [0, 0] }}\nmass = 2.0\n\
             center = [0.5, 0]\ninertia = 0.3\n[joints]\nA = {{ revolute = [\"ground.A\", \"bar.A\"] }}\n\
             [actuators]\nphi = {{ angle = [\"ground\", \"bar\"] }}\n[assembly]\nbar = -90\n\
             [loads]\nweight = {{ gravity = [0, -9.81] }}\n{more}\n[motion]\ninitial-velocity = {speed}\nduration = 1"
        );
        PlaneScene::parse("pendulum.toml", &text).expect("a scene")
    }

    #[test]
    fn rotations_and_librations_are_timed() {
        for (speed, event) in [(1.0, "third reversals"), (12.0, "whole revolution")] {
            let findings = check_period(&pendulum(speed, ""))
                .expect("a scene")
                .expect("a period");
            let keys: Vec<&str> = findings.iter().map(|f| f.key.as_str()).collect();
            assert_eq!(keys, ["period-integrated", "period-convergence"]);
            assert!(findings.iter().all(|f| f.pass), "{findings:?}");
            assert!(findings[0].comparison.contains(event), "{findings:?}");
        }
    }

    #[test]
    fn a_motion_without_a_period_has_the_cause() {
        let with_friction = pendulum(
            1.0,
            "brake = { torque = [\"ground\", \"bar\"], magnitude = \"-0.1*phi.velocity\" }",
        );
        assert_eq!(
            check_period(&with_friction).expect("a scene"),
            Err("not conservative")
        );
    }

    #[test]
    fn an_event_that_does_not_come_nearer_fails() {
        let scene = pendulum(1.0, "");
        let spec = scene.motion.as_ref().expect("a motion");
        let problem = FreeMotionProblem::new(&scene, &scene, spec).expect("a machine");
        let orbit =
            Orbit::loaded(&problem.machine, problem.initial_reduced_state()).expect("an orbit");
        let wrong = findings(&orbit, &[1e-6; TOLERANCES.len()]);
        assert_eq!(wrong.len(), 2);
        assert!(wrong.iter().all(|f| !f.pass), "{wrong:?}");
        assert!(!missed_event(&orbit, 1e-9).pass);
    }
}
