//! Explains failures of motions and positions, with their locations in the scene.

use crate::explain::{Labels, StudyError, body_names, initial_state_location, joint_labels};
use crate::number_format::{digits, number};
use dwell_dynamics::DynamicsError;
use dwell_geometry::{ActuatorId, BodyId, Plan, PositionError};
use dwell_kinetostatics::KinetostaticsError;
use dwell_scene::{Scene, SceneLocation};
use std::f64::consts::TAU;

/// The name of the coordinate, quoted.
fn coordinate_name(scene: &Scene) -> String {
    let first = scene.mechanism.actuators.first();
    first.map_or_else(|| "the coordinate".to_owned(), |a| format!("`{}`", a.name))
}

/// Explains a motion that failed.
pub fn explain_motion(scene: &Scene, plan: &Plan, error: &DynamicsError) -> StudyError {
    let phi = coordinate_name(scene);
    let motion_error = |message: String, help: &str, at: SceneLocation, label: &str| {
        let labels = [(at, label.to_owned())];
        scene.error(message, Some(help.to_owned()), &labels).into()
    };
    let speed = SceneLocation::InitialVelocity(ActuatorId(0));
    match error {
        DynamicsError::Position(position) => explain_position(scene, plan, position),
        DynamicsError::LimitPosition { t, q } => {
            let limit = match plan.range().limits() {
                None => String::new(),
                Some((from, to)) => {
                    // In the turn in which the motion is.
                    let revolutions = TAU * ((q - from) / TAU).floor();
                    let nearest = if q - revolutions - from < to + revolutions - q {
                        from
                    } else {
                        to
                    };
                    format!(", {} rad,", number(nearest + revolutions))
                }
            };
            motion_error(
                format!(
                    "the motion reaches a limit position of {phi}{limit} soon after t = {} s, and \
                     enters another assembly mode there, which {phi} does not distinguish from this one",
                    digits(*t, 3)
                ),
                &match rounded_down(*t) {
                    Some(t) => format!(
                        "end it earlier: `duration = {t}` (s); or drive a joint that rotates fully"
                    ),
                    None => "start farther from it, or drive a joint that rotates fully".to_owned(),
                },
                SceneLocation::Duration,
                "too long",
            )
        }
        DynamicsError::NoInertia { q, .. } => {
            let label = |b| {
                (
                    SceneLocation::Body(BodyId(b)),
                    "no mass or inertia".to_owned(),
                )
            };
            let moving = (0..scene.mechanism.bodies.len()).filter(|&b| b != scene.mechanism.ground);
            let labels: Labels = moving.take(8).map(label).collect();
            scene
                .error(
                    format!(
                        "the generalised inertia m is zero at {phi} = {} rad: no body with mass moves there, so the \
                         acceleration is undefined",
                        number(*q)
                    ),
                    Some("give mass and inertia to the moving bodies".to_owned()),
                    &labels,
                )
                .into()
        }
        DynamicsError::AtRest => motion_error(
            "the free motion starts at rest, and no force moves the mechanism".to_owned(),
            "give a `speed` in [motion]",
            speed,
            "no speed",
        ),
        DynamicsError::EnergyOutOfRange { q_dot, energy } => motion_error(
            format!(
                "the kinetic energy {1} J at {0} rad/s is outside the computable range",
                number(*q_dot),
                number(*energy)
            ),
            "choose a realistic speed; without loads it only scales time and reactions",
            speed,
            "this speed",
        ),
        DynamicsError::NoFullRevolution { from, to } => motion_error(
            format!(
                "{phi} is limited to {} to {} rad, so the motion has no period of rotation",
                number(*from),
                number(*to)
            ),
            "give `duration` (s) instead of `periods`",
            SceneLocation::Duration,
            "no full revolution",
        ),
        DynamicsError::NotResolved { points, tail: left } => motion_error(
            format!(
                "the quadrature of the period does not converge: the relative error after {points} points \
                 is {}",
                digits(*left, 2)
            ),
            "a change point may be near: `dwell reduce` shows where; a motion with a `duration` needs no \
             period",
            SceneLocation::Duration,
            "a period is needed",
        ),
        DynamicsError::MaxStepsReached {
            t,
            max_steps: steps,
        } => motion_error(
            format!(
                "the maximum of {steps} steps is reached at t = {} s",
                digits(*t, 2)
            ),
            "end the motion earlier, or use a larger --rtol",
            SceneLocation::Duration,
            "too long",
        ),
        DynamicsError::StepTooSmall { t } => motion_error(
            format!(
                "the integrator's step becomes too small at t = {} s: the motion changes too fast there",
                number(*t)
            ),
            "a limit position or a change point may be near: end the motion earlier, or check the lengths",
            SceneLocation::Duration,
            "beyond that time",
        ),
        DynamicsError::Load(load) => explain_load(scene, *load),
        DynamicsError::DurationTooShort => motion_error(
            "the duration is too short: the motion ends where it starts, up to rounding".to_owned(),
            "give a longer duration",
            SceneLocation::Duration,
            "too short",
        ),
        DynamicsError::NotFinite { t } => motion_error(
            format!("the motion is no longer finite after t = {} s", number(*t)),
            "check the speed and the inertias",
            SceneLocation::Motion,
            "this motion",
        ),
        DynamicsError::NoCycle { what } => motion_error(
            format!("there is no steady cycle of {phi}: {what}"),
            "a cycle needs a drive and loads that are periodic in the coordinate; \
             `dwell simulate` shows the motion",
            initial_state_location(scene),
            "of this motion",
        ),
        DynamicsError::ComesToRest { q } => motion_error(
            format!(
                "the mechanism comes to rest at {phi} = {} rad and does not complete the revolution",
                number(*q)
            ),
            "use a stronger drive or a larger flywheel, so that it passes the position of largest resistance",
            initial_state_location(scene),
            "of this motion",
        ),
        DynamicsError::NoEquilibrium { what } => motion_error(
            format!("no equilibrium found: {what}"),
            "the loads must balance near the start; `dwell linearise --about initial` needs no equilibrium",
            initial_state_location(scene),
            "near this start",
        ),
        DynamicsError::NoEigenvalues => motion_error(
            "the coefficients of the linearised motion are not finite, so it has no eigenvalues"
                .to_owned(),
            "an expression of a load or a drive may have an infinite slope there, such as a square root at zero",
            initial_state_location(scene),
            "near this start",
        ),
        other => motion_error(
            other.to_string(),
            "check the numbers of the motion",
            SceneLocation::Motion,
            "this motion",
        ),
    }
}

/// Explains a load that is undefined.
fn explain_load(scene: &Scene, error: KinetostaticsError) -> StudyError {
    let load = error.load().unwrap_or(0);
    let name = scene.loads.get(load).map_or("", |l| l.name.as_str());
    let (message, help, label) = match error {
        KinetostaticsError::SelfLocking { .. } => (
            "the mechanism is self-locking by friction: its effective inertia is not positive, so the \
             acceleration is not unique"
                .to_owned(),
            "reduce a friction coefficient, or apply the force where the joint reactions are smaller",
            "together with the other friction loads",
        ),
        KinetostaticsError::NoDirection { .. } => (
            format!("load `{name}` has no direction: its two points coincide"),
            "keep the points apart; a spring of free length 0 needs no direction",
            "between two points",
        ),
        _ => (
            format!("the magnitude of load `{name}` is not finite"),
            "check its expression there for a square root, a logarithm or a division",
            "not a finite number",
        ),
    };
    let labels = [(SceneLocation::Load(load), label.to_owned())];
    scene.error(message, Some(help.to_owned()), &labels).into()
}

/// `t` rounded down to two digits, if that is positive.
fn rounded_down(t: f64) -> Option<String> {
    let unit = 10_f64.powf(t.log10().floor() - 1.0);
    let time = (t / unit).floor() * unit;
    (time.is_normal() && time > 0.0).then(|| digits(time, 2))
}

/// Explains a position that cannot be computed.
pub fn explain_position(scene: &Scene, plan: &Plan, error: &PositionError) -> StudyError {
    let phi = coordinate_name(scene);
    let joints = error.group().map(|g| plan.group_joints(g));
    let unit = if plan.is_angle(0) { "rad" } else { "m" };
    let bodies_text = error.group().map_or_else(String::new, |g| {
        body_names(&scene.mechanism, &plan.group_bodies(g))
    });
    let range_ends = "this is outside the range; `dwell check` shows the range";
    let (message, help) = match *error {
        PositionError::NoAssembly { q, gap, .. } => (
            format!(
                "{bodies_text} cannot reach each other at {phi} = {} {unit}: gap of {} m",
                number(q),
                digits(gap, 3)
            ),
            range_ends,
        ),
        PositionError::Singular { q, .. } => (
            format!(
                "{bodies_text} are in a singular configuration at {phi} = {} {unit}: {phi} does not determine their motion there",
                number(q)
            ),
            match plan.range().limits() {
                None => "it is a change point: change a length, or drive another joint",
                Some(_) => range_ends,
            },
        ),
        PositionError::OtherBranch { q, .. } => (
            format!(
                "{bodies_text} can only be assembled in another assembly mode at {phi} = {} {unit}",
                number(q)
            ),
            "two assembly modes are close to each other there",
        ),
        PositionError::NotConverged { q, residual, .. } => (
            format!(
                "the positions of {bodies_text} could not be computed at {phi} = {} {unit}: residual {} m",
                number(q),
                digits(residual, 3)
            ),
            range_ends,
        ),
        PositionError::OutOfRange { q, from, to } => (
            format!(
                "{phi} = {} {unit} is outside its range, {} to {} {unit}",
                number(q),
                number(from),
                number(to)
            ),
            "start within the range; `dwell check` shows it",
        ),
        PositionError::LanesDiverge { q } => (
            format!(
                "the poses near {phi} = {} {unit} cannot be evaluated together in SIMD lanes",
                number(q)
            ),
            "evaluate them one by one",
        ),
        PositionError::NotFinite { q } => (
            format!("{phi} = {q} {unit} is not a finite number"),
            "check the numbers of the motion",
        ),
    };
    let labels = match joints {
        Some(joints) if !joints.is_empty() => joint_labels(&joints, "cannot stay joined there"),
        _ => vec![(
            SceneLocation::InitialCoordinate(ActuatorId(0)),
            "this coordinate".into(),
        )],
    };
    scene.error(message, Some(help.to_owned()), &labels).into()
}
