//! Why a motion or a position of a scene failed, with its lines of the file.

use crate::driven::began;
use crate::error::{Labels, StudyError, joint_labels, names};
use crate::words::{digits, number};
use dwell_dynamics::DynamicsError;
use dwell_geometry::{ActuatorId, BodyId, PlaceError, Plan};
use dwell_kinetostatics::KinetostaticsError;
use dwell_scene::{Place, Scene};
use std::f64::consts::TAU;

/// The name of the coordinate, quoted.
fn coordinate(scene: &Scene) -> String {
    let first = scene.mechanism.actuators.first();
    first.map_or_else(|| "the coordinate".to_owned(), |a| format!("`{}`", a.name))
}

/// Explains a motion that failed.
pub(crate) fn explain_motion(scene: &Scene, plan: &Plan, error: &DynamicsError) -> StudyError {
    let phi = coordinate(scene);
    let motion = |message: String, help: &str, at: Place, label: &str| {
        let labels = [(at, label.to_owned())];
        scene.error(message, Some(help.to_owned()), &labels).into()
    };
    let speed = Place::Speed(ActuatorId(0));
    match error {
        DynamicsError::Place(place) => explain_place(scene, plan, place),
        DynamicsError::Limit { t, q } => {
            let limit = match plan.range().limits() {
                None => String::new(),
                Some((from, to)) => {
                    // In the turn in which the motion is.
                    let turns = TAU * ((q - from) / TAU).floor();
                    let nearest = if q - turns - from < to + turns - q {
                        from
                    } else {
                        to
                    };
                    format!(", {} rad,", number(nearest + turns))
                }
            };
            motion(
                format!(
                    "the motion reaches a limit position of {phi}{limit} soon after t = {} s, and \
                     passes to another assembly branch there, which {phi} cannot tell from this one",
                    digits(*t, 3)
                ),
                &match below(*t) {
                    Some(t) => format!(
                        "end it before: `duration = {t}` (s); or drive a joint that turns fully"
                    ),
                    None => "start farther from it, or drive a joint that turns fully".to_owned(),
                },
                Place::Length,
                "longer than that",
            )
        }
        DynamicsError::NoInertia { q, .. } => {
            let label = |b| (Place::Body(BodyId(b)), "no inertia that moves".to_owned());
            let moving = (0..scene.mechanism.bodies.len()).filter(|&b| b != scene.mechanism.ground);
            let labels: Labels = moving.take(8).map(label).collect();
            scene
                .error(
                    format!(
                        "the generalised inertia m is zero at {phi} = {} rad: no body with mass \
                         moves there",
                        number(*q)
                    ),
                    Some("give the bodies that move mass and inertia".to_owned()),
                    &labels,
                )
                .into()
        }
        DynamicsError::AtRest => motion(
            "the free motion starts at rest, and nothing moves the mechanism".to_owned(),
            "give it a speed in [motion]",
            speed,
            "no speed",
        ),
        DynamicsError::BadEnergy { q_dot, energy } => motion(
            format!(
                "the kinetic energy at {} rad/s is {} J: too far from 1 to compute with",
                number(*q_dot),
                number(*energy)
            ),
            "take a speed of a size that occurs; without loads it only scales time and reactions",
            speed,
            "this speed",
        ),
        DynamicsError::NoFullTurn { from, to } => motion(
            format!(
                "{phi} turns only from {} to {} rad, so the motion has no period of turning",
                number(*from),
                number(*to)
            ),
            "give `duration` (s) instead of `periods`",
            Place::Length,
            "no whole turn is reached",
        ),
        DynamicsError::NotResolved { points, left } => motion(
            format!(
                "the inertia changes too sharply within a turn to find the period by quadrature: \
                 {points} points leave {} of it open",
                digits(*left, 2)
            ),
            "bars may nearly be in line, at a change point: `dwell reduce` shows where; a motion with \
             a `duration` is followed without a period",
            Place::Length,
            "a period is needed",
        ),
        DynamicsError::Budget { t, steps } => motion(
            format!(
                "{steps} steps take the motion only to t = {} s",
                digits(*t, 2)
            ),
            "end it before, or follow it less exactly, with a larger --rtol",
            Place::Length,
            "too long to be followed",
        ),
        DynamicsError::SmallStep { t } => motion(
            format!(
                "the motion changes too fast to be followed from t = {} s on: the integrator's steps \
                 become too small",
                number(*t)
            ),
            "a limit position or a change point may be near: end it before, or check the lengths",
            Place::Length,
            "until there",
        ),
        DynamicsError::Load(load) => explain_load(scene, *load),
        DynamicsError::TooShort => motion(
            "the motion is too short to compute: its end is its start, to rounding".to_owned(),
            "give it more time",
            Place::Length,
            "too short",
        ),
        DynamicsError::NotFinite { t } => motion(
            format!("the motion is no longer finite after t = {} s", number(*t)),
            "check the speed and the inertias",
            Place::Motion,
            "this motion",
        ),
        DynamicsError::NoCycle { what } => motion(
            format!("there is no steady cycle of {phi}: {what}"),
            "a cycle needs a drive that keeps it going and loads that are the same after some turns; \
             `dwell simulate` shows how it moves",
            began(scene),
            "of this motion",
        ),
        DynamicsError::Stalls { q } => motion(
            format!(
                "the mechanism comes to rest at {phi} = {} rad and does not complete the turn",
                number(*q)
            ),
            "a stronger drive or a flywheel carries it over its hardest place",
            began(scene),
            "of this motion",
        ),
        DynamicsError::NoEquilibrium { what } => motion(
            format!("no equilibrium is found: {what}"),
            "loads have to hold each other somewhere near the start; `dwell linearise --at start` needs \
             no equilibrium",
            began(scene),
            "near this start",
        ),
        DynamicsError::NoEigenvalues => motion(
            "the linearised motion has coefficients that are not finite, and so no eigenvalues"
                .to_owned(),
            "an expression of a load or a drive may have an infinite slope there, as a root at zero",
            began(scene),
            "near this start",
        ),
        other => motion(
            other.to_string(),
            "check the numbers of the motion",
            Place::Motion,
            "this motion",
        ),
    }
}

/// Explains a load that cannot act.
fn explain_load(scene: &Scene, error: KinetostaticsError) -> StudyError {
    let load = error.load().unwrap_or(0);
    let name = scene.loads.get(load).map_or("", |l| l.name.as_str());
    let (message, help, label) = match error {
        KinetostaticsError::Jams { .. } => (
            "friction jams the mechanism: its effective inertia is no longer positive, so that no \
             single motion balances"
                .to_owned(),
            "take a smaller coefficient, or push where the joints bear less",
            "with the other frictions",
        ),
        KinetostaticsError::NoDirection { .. } => (
            format!("load `{name}` has no direction: its two points meet"),
            "keep them apart; a spring of free length 0 needs no direction",
            "between two points",
        ),
        _ => (
            format!("the magnitude of load `{name}` is not finite"),
            "check its expression there: a root, a logarithm or a division",
            "not a finite number",
        ),
    };
    let labels = [(Place::Load(load), label.to_owned())];
    scene.error(message, Some(help.to_owned()), &labels).into()
}

/// A time of two digits before `t`, if that leaves any.
fn below(t: f64) -> Option<String> {
    let unit = 10_f64.powf(t.log10().floor() - 1.0);
    let time = (t / unit).floor() * unit;
    (time.is_normal() && time > 0.0).then(|| digits(time, 2))
}

/// Explains a position that cannot be placed.
pub(crate) fn explain_place(scene: &Scene, plan: &Plan, error: &PlaceError) -> StudyError {
    let phi = coordinate(scene);
    let joints = error.group().map(|g| plan.group_joints(g));
    let unit = if plan.is_angle(0) { "rad" } else { "m" };
    let who = error.group().map_or_else(String::new, |g| {
        names(&scene.mechanism, &plan.group_bodies(g))
    });
    let range_ends = "the range ends there; `dwell check` shows it";
    let (message, help) = match *error {
        PlaceError::Unreachable { q, gap, .. } => (
            format!(
                "{who} cannot reach each other at {phi} = {} {unit}: {} m are missing",
                number(q),
                digits(gap, 3)
            ),
            range_ends,
        ),
        PlaceError::Singular { q, .. } => (
            format!(
                "{who} are in line at {phi} = {} {unit}: {phi} does not determine their motion there",
                number(q)
            ),
            match plan.range().limits() {
                None => "it is a change point: change a length, or drive another joint",
                Some(_) => range_ends,
            },
        ),
        PlaceError::OtherBranch { q, .. } => (
            format!(
                "{who} can be placed on another assembly branch only at {phi} = {} {unit}",
                number(q)
            ),
            "two branches come close to each other there",
        ),
        PlaceError::NotClosed { q, residual, .. } => (
            format!(
                "{who} could not be placed at {phi} = {} {unit}: {} m stay open",
                number(q),
                digits(residual, 3)
            ),
            range_ends,
        ),
        PlaceError::OutOfRange { q, from, to } => (
            format!(
                "{phi} = {} {unit} is outside its range, {} to {} {unit}",
                number(q),
                number(from),
                number(to)
            ),
            "start within the range; `dwell check` shows it",
        ),
        PlaceError::Apart { q } => (
            format!(
                "the poses from {phi} = {} {unit} on must be evaluated one by one",
                number(q)
            ),
            "evaluate this mechanism in plain numbers",
        ),
        PlaceError::NotFinite { q } => (
            format!("{phi} = {q} {unit} is not a finite number"),
            "check the numbers of the motion",
        ),
    };
    let labels = match joints {
        Some(joints) if !joints.is_empty() => joint_labels(&joints, "cannot stay joined there"),
        _ => vec![(Place::MotionStart(ActuatorId(0)), "this coordinate".into())],
    };
    scene.error(message, Some(help.to_owned()), &labels).into()
}
