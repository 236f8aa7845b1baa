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
