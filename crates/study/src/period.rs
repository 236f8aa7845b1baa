//! Truth 5 of a motion under loads that all have a potential: its period by quadrature against the
//! integrator's events.

use crate::error::StudyError;
use crate::freed::Freed;
use crate::multibody::with_drives;
use crate::reference::Reference;
use crate::simulate::Free;
use dwell_dynamics::{DynamicsError, Fate, Method, Options, Orbit};
use dwell_findings::Finding;
use dwell_scene::{EventTrigger, Length, NamedEvent, Scene};
use std::f64::consts::TAU;

/// Tolerances of the integrator, from the coarsest on; the last is judged by itself.
const LADDER: [f64; 4] = [1e-7, 1e-9, 1e-11, 1e-13];
/// The most that the period may err by, in tolerances of a step.
const FACTOR: f64 = 300.0;
/// Below this nothing but rounding is left, and no slope.
const ROUNDING: f64 = 1e-12;
/// The least slope of log error over log tolerance.
const SLOPE: f64 = 0.6;
/// What is followed beyond the event.
const BEYOND: f64 = 1.02;

/// The findings, or in a few words why there is no period.
pub(crate) type Judged = Result<Vec<Finding>, &'static str>;

/// Judges the period of a case, set free where the scene has no motion.
///
/// # Errors
/// As [`judged`].
pub(crate) fn of_case(scene: &Scene, reference: &Reference) -> Result<Judged, StudyError> {
    match scene.motion {
        Some(_) => judged(scene),
        None => judged(&Freed::new(scene, reference)?.scene),
    }
}

/// Judges the period of a scene's motion.
///
/// # Errors
/// [`StudyError::Scene`] when the scene cannot be put together.
fn judged(scene: &Scene) -> Result<Judged, StudyError> {
    let Some(motion) = &scene.motion else {
        return Ok(Err("no motion"));
    };
    if motion.laws.iter().any(Option::is_some) {
        return Ok(Err("led in time"));
    }
    if motion.laws.len() != 1 {
        return Ok(Err("several freedoms"));
    }
    let driven = with_drives(scene)?;
    let free = Free::new(scene, &driven, motion)?;
    let orbit = match Orbit::loaded(&free.machine, free.state()) {
        Ok(orbit) => orbit,
        Err(DynamicsError::NotConservative { .. }) => return Ok(Err(worked(scene))),
        Err(DynamicsError::AtRest) => return Ok(Err("at rest")),
        Err(DynamicsError::Creeps { .. }) => return Ok(Err("creeps")),
        Err(DynamicsError::NotResolved { .. }) => return Ok(Err("too sharp")),
        Err(DynamicsError::NoFullTurn { .. }) => return Ok(Err("reaches a limit")),
        Err(DynamicsError::GoesOn { .. }) => return Ok(Err("never returns")),
        Err(DynamicsError::Place(_)) => return Ok(Err("change point")),
        Err(_) => return Ok(Err("no period")),
    };
    let coordinate = scene.mechanism.actuators[0].coordinate();
    // Of a swing the first and the third turning are a period apart.
    let (trigger, from, to, length) = match orbit.fate {
        Fate::Turns { period, .. } => {
            let turns = (period.abs() / TAU).round().max(1.0);
            (
                EventTrigger::WholeTurn(coordinate),
                None,
                turns as usize - 1,
                1.0,
            )
        }
        _ => (EventTrigger::Turns(coordinate), Some(0), 2, 2.0),
    };
    let mut timed = scene.clone();
    let mut looking = motion.clone();
    looking.length = Length::Duration(BEYOND * length * orbit.period);
    looking.events = vec![NamedEvent {
        name: "period".to_owned(),
        trigger,
        stop: false,
    }];
    timed.motion = Some(looking.clone());
    let free = Free::new(&timed, &driven, &looking)?;
    let mut errors = Vec::new();
    for tolerance in LADDER {
        let options = Options::new(Method::Tsit45, tolerance);
        let moved = free.follow(&timed, free.duration()?, &options)?;
        let times: Vec<f64> = moved.occurrences().map(|(_, o)| o.at.t).collect();
        let began = from.map_or(Some(0.0), |k: usize| times.get(k).copied());
        let (Some(began), Some(ended)) = (began, times.get(to)) else {
            return Ok(Ok(vec![missed(&orbit, tolerance)]));
        };
        errors.push((ended - began - orbit.period).abs());
    }
    Ok(Ok(findings(&orbit, &errors)))
}

/// What does work on it.
fn worked(scene: &Scene) -> &'static str {
    use dwell_kinetostatics::Magnitude;
    let rubs = |load: &dwell_kinetostatics::Load| matches!(load.magnitude, Magnitude::Friction(_));
    match () {
        () if !scene.drives.is_empty() => "driven",
        () if scene.loads.iter().any(rubs) => "friction",
        () => "not conservative",
    }
}

fn words(orbit: &Orbit) -> (String, String) {
    let compared = format!(
        "T = ∮ √(m / 2(E − V)) dq = {:.12} s with the integrator's {}",
        orbit.period,
        match orbit.fate {
            Fate::Turns { .. } => "whole turn",
            _ => "first and third turning points",
        }
    );
    let over = format!("one period, {} points of the trapezoid rule", orbit.points);
    (compared, over)
}

/// The event did not come.
fn missed(orbit: &Orbit, tolerance: f64) -> Finding {
    let (compared, over) = words(orbit);
    Finding {
        key: "period-event".into(),
        truth: "5 period by quadrature".into(),
        compared,
        over,
        worst: format!("no such event, Tsit45 at a tolerance of {tolerance:.0e}"),
        integrated: true,
        ..Finding::default()
    }
}

fn findings(orbit: &Orbit, errors: &[f64]) -> Vec<Finding> {
    let (compared, over) = words(orbit);
    let (first, last) = (errors[0], errors[errors.len() - 1]);
    let [coarse, fine] = [LADDER[0], LADDER[LADDER.len() - 1]];
    let relative = last / orbit.period;
    let mut findings = vec![Finding {
        key: "period-event".into(),
        truth: "5 period by quadrature".into(),
        compared,
        over,
        absolute: last,
        unit: "s".into(),
        relative,
        scale: "the period".into(),
        worst: format!("T = {:.6} s, Tsit45 at {fine:.0e}", orbit.period),
        tolerance: FACTOR * fine,
        why: format!("{FACTOR} times the tolerance of a step: some tens are met in a period"),
        integrated: true,
        pass: relative <= FACTOR * fine,
        ..Finding::default()
    }];
    // A motion that is linear in time has no error that could fall.
    if first / orbit.period > 1e3 * ROUNDING {
        let floor = ROUNDING * orbit.period;
        let reached = errors.iter().position(|&error| error <= floor);
        let until = reached.unwrap_or(errors.len() - 1).max(1);
        let fall = (first / errors[until].max(floor)).log10();
        let slope = fall / (coarse / LADDER[until]).log10();
        let short = (SLOPE - slope).max(0.0);
        findings.push(Finding {
            key: "period-slope".into(),
            truth: "5 period by quadrature".into(),
            compared: format!(
                "the slope of log error of the period over log tolerance, {slope:.1}, with at least {SLOPE}"
            ),
            over: format!("Tsit45 at {coarse:.0e} to {:.0e}", LADDER[until]),
            absolute: short,
            unit: "(missing slope)".into(),
            relative: short,
            scale: "one".into(),
            worst: "the line through both ends".into(),
            tolerance: 0.0,
            why: "an integrator that obeys its tolerance has a slope near 1".into(),
            integrated: true,
            pass: slope >= SLOPE,
            ..Finding::default()
        });
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar on a pin under its weight, started downwards with a speed in rad/s.
    fn pendulum(speed: f64, more: &str) -> Scene {
        let text = format!(
            "[bodies.ground]\npoints = {{ A = [0, 0] }}\n[bodies.bar]\npoints = {{ A = [0, 0] }}\nmass = 2.0\n\
             center = [0.5, 0]\ninertia = 0.3\n[joints]\nA = {{ revolute = [\"ground.A\", \"bar.A\"] }}\n\
             [actuators]\nphi = {{ angle = [\"ground\", \"bar\"] }}\n[assembly]\nbar = -90\n\
             [loads]\nweight = {{ gravity = [0, -9.81] }}\n{more}\n[motion]\nspeed = {speed}\nduration = 1"
        );
        Scene::parse("pendulum.toml", &text).expect("a scene")
    }

    #[test]
    fn turns_and_swings_are_timed() {
        for (speed, event) in [(1.0, "third turning"), (12.0, "whole turn")] {
            let findings = judged(&pendulum(speed, ""))
                .expect("a scene")
                .expect("a period");
            let keys: Vec<&str> = findings.iter().map(|f| f.key.as_str()).collect();
            assert_eq!(keys, ["period-event", "period-slope"]);
            assert!(findings.iter().all(|f| f.pass), "{findings:?}");
            assert!(findings[0].compared.contains(event), "{findings:?}");
        }
    }

    #[test]
    fn what_has_no_period_is_told() {
        let rubbed = pendulum(
            1.0,
            "brake = { torque = [\"ground\", \"bar\"], magnitude = \"-0.1*phi.speed\" }",
        );
        assert_eq!(judged(&rubbed).expect("a scene"), Err("not conservative"));
    }

    #[test]
    fn an_event_that_does_not_come_nearer_fails() {
        let scene = pendulum(1.0, "");
        let motion = scene.motion.as_ref().expect("a motion");
        let free = Free::new(&scene, &scene, motion).expect("a machine");
        let orbit = Orbit::loaded(&free.machine, free.state()).expect("an orbit");
        let wrong = findings(&orbit, &[1e-6; LADDER.len()]);
        assert_eq!(wrong.len(), 2);
        assert!(wrong.iter().all(|f| !f.pass), "{wrong:?}");
        assert!(!missed(&orbit, 1e-9).pass);
    }
}
