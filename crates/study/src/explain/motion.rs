//! Explains motions that fail, with their locations in the scene.

use super::contacts::{
    explain_beyond_stop, explain_endless_impacts, explain_no_mode, explain_no_progress,
    explain_sticking, explain_stop,
};
use super::switching::{explain_chatter, explain_several};
use crate::explain::{
    NamedScene, StudyError, body_names, explain_position, joint_labels, labels, own_coordinate,
    own_speed, scene_error,
};
use crate::number_format::{digits, force_unit, number};
use dwell_dynamics::DynamicsError;
use dwell_geometry::{ActuatorId, Plan};
use dwell_kinetostatics::KinetostaticsError;
use dwell_scene::{PlaneScene, SceneFile, SceneLocation};
use std::f64::consts::TAU;

/// Explains a motion that failed.
pub fn explain_motion(scene: &PlaneScene, plan: &Plan, error: &DynamicsError) -> StudyError {
    match error {
        DynamicsError::Position(position) => explain_position(scene, plan, position),
        DynamicsError::LimitPosition { t, q } => explain_limit_position(scene, plan, *t, *q),
        DynamicsError::NearBranches { t, q, half_width } => {
            explain_near_branches(scene, plan, *t, [*q, *half_width])
        }
        other => explain_any_motion(scene, other),
    }
}

/// Explains all errors except those of positions, in the plane or in space; this needs no plan.
pub(crate) fn explain_any_motion(scene: &impl NamedScene, error: &DynamicsError) -> StudyError {
    match error {
        DynamicsError::Load(load) => explain_load(scene, *load),
        DynamicsError::NoInertia { q, .. } => explain_no_inertia(scene, *q),
        DynamicsError::Unbalanced { actuator, force } => {
            explain_unbalanced(scene, *actuator, *force)
        }
        DynamicsError::VariesTooFast {
            source_index,
            width,
            t,
            max_steps,
        } => explain_fast(scene, *source_index, [*width, *t], *max_steps),
        DynamicsError::NoProgress { function, t, step } => {
            explain_no_progress(scene, *function, [*t, *step])
        }
        DynamicsError::Chatters { source_index, t } => explain_chatter(scene, *source_index, *t),
        DynamicsError::SlidesOnSeveral { source_index, t } => {
            explain_several(scene, *source_index, *t)
        }
        DynamicsError::NoContactMode { source_index } => explain_no_mode(scene, *source_index),
        DynamicsError::BeyondStop { stop, q } => explain_beyond_stop(scene, *stop, *q),
        DynamicsError::Stops { stop, what } => explain_stop(scene, *stop, what),
        DynamicsError::StopsWithoutEnd { stop } => explain_endless_impacts(scene, *stop),
        DynamicsError::Sticks { source_index, what } => {
            explain_sticking(scene, *source_index, what)
        }
        other => {
            let (message, help, at, label) = describe(scene, other);
            scene_error(scene, message, help, [(at, label)])
        }
    }
}

/// The limits of the steps of an integration.
pub(crate) struct StepLimits {
    /// The requested longest step, s.
    pub(crate) max_step: Option<f64>,
    /// The option that sets the tolerance.
    pub(crate) tolerance: &'static str,
}

/// Explains a motion that takes too many steps (`what` states their number). The cause is the longest step if the average step is at least
/// half as long, otherwise the tolerance.
pub(crate) fn explain_max_steps(
    scene: &SceneFile,
    t: f64,
    (steps, what): (usize, &str),
    limits: &StepLimits,
) -> StudyError {
    let reached = digits(t, 2);
    let mean = t / steps as f64;
    let tolerance = limits.tolerance;
    let (cause, help) = match limits.max_step {
        Some(max_step) if mean >= 0.5 * max_step => (
            format!(": --max-step allows none above {} s", number(max_step)),
            "end the motion earlier, or give a longer --max-step, or none".to_owned(),
        ),
        Some(_) => (
            ": the tolerance, not --max-step, makes them short".to_owned(),
            format!("end the motion earlier, or use a larger {tolerance}"),
        ),
        None => (
            String::new(),
            format!("end the motion earlier, or use a larger {tolerance}"),
        ),
    };
    let message = format!("{what} at t = {reached} s{cause}");
    scene_error(
        scene,
        message,
        &help,
        [(SceneLocation::Duration, "too long")],
    )
}

/// Message, help, location and its label of an error that needs no more than its own numbers. One arm for each error,
/// so longer than a screen.
fn describe(
    scene: &impl NamedScene,
    error: &DynamicsError,
) -> (String, &'static str, SceneLocation, &'static str) {
    let phi = scene.quoted_coordinate();
    let is_angle = scene.is_first_angle();
    let own = |q| own_coordinate(scene, q, is_angle);
    let speed = SceneLocation::InitialVelocity(ActuatorId(0));
    let start = scene.initial_state_location();
    match error {
        DynamicsError::Interrupted => (
            "the computation was interrupted".to_owned(),
            "",
            SceneLocation::Whole,
            "",
        ),
        DynamicsError::LostBalance { t } => (
            format!(
                "near t = {} s the computed energies stop matching the work of the loads",
                number(*t)
            ),
            "a limit position or a change point may be near: end the motion earlier, or use a smaller tolerance",
            SceneLocation::Duration,
            "beyond that time",
        ),
        DynamicsError::AtRest => (
            "the free motion starts at rest, and no force moves the mechanism".to_owned(),
            "give an `initial-velocity` in [motion]",
            speed,
            "no speed",
        ),
        DynamicsError::EnergyOutOfRange { q_dot, energy } => (
            format!(
                "the kinetic energy {} J at {} is outside the computable range",
                number(*energy),
                own_speed(scene, *q_dot, is_angle)
            ),
            "choose a realistic speed; without loads it only scales time and reactions",
            speed,
            "this speed",
        ),
        DynamicsError::NoFullRevolution { from, to } => (
            format!(
                "{phi} is limited to {} to {}, so the motion has no period of rotation",
                number(scene.to_scene_unit(*from, is_angle).0),
                own(*to)
            ),
            "give `duration` (s) instead of `periods`",
            SceneLocation::Duration,
            "no full revolution",
        ),
        DynamicsError::NotResolved { points, tail } => (
            format!(
                "the quadrature of the period does not converge: the relative error after {points} points \
                 is {}",
                digits(*tail, 2)
            ),
            "a change point may be near: `dwell reduce` shows where; a motion with a `duration` needs no \
             period",
            SceneLocation::Duration,
            "a period is needed",
        ),
        DynamicsError::MaxStepsReached { t, max_steps } => (
            format!(
                "the maximum of {max_steps} steps is reached at t = {} s",
                digits(*t, 2)
            ),
            "end the motion earlier, or use a larger tolerance",
            SceneLocation::Duration,
            "too long",
        ),
        DynamicsError::TooManyEvents { t, max_occurrences } => (
            format!(
                "more than {max_occurrences} events happen: the motion is computed up to t = {} s",
                digits(*t, 6)
            ),
            "make the motion shorter, leave out an event that happens in every period, or let an event stop it",
            SceneLocation::Duration,
            "so many events in this time",
        ),
        DynamicsError::StepTooLongForEvents { t, angle } => (
            format!(
                "a step of the integrator from t = {} s goes through {} revolutions: events within it cannot be found",
                digits(*t, 6),
                digits(angle / TAU, 3)
            ),
            "give --max-step, or --accuracy, with which a motion without losses is not integrated; or leave out the events",
            SceneLocation::Duration,
            "steps are so long in this motion",
        ),
        DynamicsError::StepTooSmall { t } => (
            format!(
                "the integrator's step becomes too small at t = {} s: the motion changes too fast there",
                number(*t)
            ),
            "a limit position or a change point may be near: end the motion earlier, or check the lengths",
            SceneLocation::Duration,
            "beyond that time",
        ),
        DynamicsError::DurationTooShort => (
            "the duration is too short: the motion ends where it starts, up to rounding".to_owned(),
            "give a longer duration",
            SceneLocation::Duration,
            "too short",
        ),
        DynamicsError::NotFinite { t } => (
            format!("the motion is no longer finite after t = {} s", number(*t)),
            "check the speed and the inertias",
            SceneLocation::Motion,
            "this motion",
        ),
        DynamicsError::NoCycle { what } => (
            format!("there is no steady cycle of {phi}: {what}"),
            "a cycle needs a drive and loads that are periodic in the coordinate; \
             `dwell simulate` shows the motion",
            start,
            "of this motion",
        ),
        DynamicsError::NeverBalances { work, q_dot, tried } => (
            format!(
                "there is no steady cycle of {phi}: the machine {} {} J per cycle at {}, and {} energy at every \
                 speed that was tried, from {} to {}",
                if *work > 0.0 { "gains" } else { "loses" },
                digits(work.abs(), 3),
                own_speed(scene, *q_dot, is_angle),
                if *work > 0.0 { "gains" } else { "loses" },
                own_speed(scene, tried[0], is_angle),
                own_speed(scene, tried[1], is_angle)
            ),
            "add a loss or a drive that depends on the speed, such as a damper or a motor, so that the works of a cycle \
             balance at some speed",
            start,
            "of this motion",
        ),
        DynamicsError::ComesToRest { q } => (
            format!(
                "the mechanism comes to rest at {phi} = {} and does not complete the revolution",
                own(*q)
            ),
            "use a stronger drive or a larger flywheel, so that it passes the position of largest resistance",
            start,
            "of this motion",
        ),
        DynamicsError::NoEquilibrium { what } => (
            format!("no equilibrium found: {what}"),
            "the loads must balance near the start; `dwell linearise --about initial` needs no equilibrium",
            start,
            "near this start",
        ),
        DynamicsError::NoEigenvalues => (
            "the coefficients of the linearised motion are not finite, so it has no eigenvalues"
                .to_owned(),
            "an expression of a load or a drive may have an infinite slope there, such as a square root at zero",
            start,
            "near this start",
        ),
        other => (
            other.to_string(),
            "check the numbers of the motion",
            SceneLocation::Motion,
            "this motion",
        ),
    }
}

/// The motion leaves its assembly mode at a limit position.
fn explain_limit_position(scene: &PlaneScene, plan: &Plan, t: f64, q: f64) -> StudyError {
    let phi = scene.quoted_coordinate();
    let limit = plan.range().limits().map(|(from, to)| {
        // In the revolution in which the motion is.
        let revolutions = TAU * ((q - from) / TAU).floor();
        let is_lower = q - revolutions - from < to + revolutions - q;
        let nearest = if is_lower { from } else { to };
        let limit = own_coordinate(scene, nearest + revolutions, plan.is_angle(0));
        format!(", {limit},")
    });
    let message = format!(
        "the motion reaches a limit position of {phi}{} soon after t = {} s, and enters another assembly mode \
         there, which {phi} does not distinguish from this one",
        limit.unwrap_or_default(),
        digits(t, 3)
    );
    let help = match rounded_down(t) {
        Some(t) => {
            format!("end it earlier: `duration = {t}` (s); or drive a joint that rotates fully")
        }
        None => "start farther from it, or drive a joint that rotates fully".to_owned(),
    };
    let place = (SceneLocation::Duration, "too long");
    scene_error(scene, message, help, [place])
}

/// The motion reaches a place where two assembly modes are too close to each other.
fn explain_near_branches(
    scene: &PlaneScene,
    plan: &Plan,
    t: f64,
    [q, half_width]: [f64; 2],
) -> StudyError {
    let own = |value| own_coordinate(scene, value, plan.is_angle(0));
    let mut nearest = plan.near_branches().iter();
    let group = nearest.find(|near| near.half_width == half_width);
    let bodies = group.map(|near| body_names(&scene.mechanism, &plan.group_bodies(near.group)));
    let message = format!(
        "soon after t = {} s the assembly modes of {} nearly meet, at {} = {}: they are as close as at a change \
         point within {}, and rounding does not show in which of them the motion continues",
        digits(t, 6),
        bodies.unwrap_or_else(|| "the mechanism".to_owned()),
        scene.quoted_coordinate(),
        own(q),
        own(half_width),
    );
    let help = "make the lengths exactly those of a change point, which the motion crosses; or change one so that the modes are \
                farther apart than 3e-5 rad, or than that part of the mechanism's size; or end the motion earlier";
    let joints = group.map(|near| plan.group_joints(near.group));
    let places = match joints {
        Some(joints) if !joints.is_empty() => joint_labels(&joints, "their lengths nearly fit"),
        _ => labels([SceneLocation::Duration].into_iter(), "beyond that time"),
    };
    scene_error(scene, message, help, places)
}

/// Explains that there is no equilibrium because a force keeps its sign.
fn explain_unbalanced(
    scene: &impl NamedScene,
    actuator: usize,
    [low, high]: [f64; 2],
) -> StudyError {
    let (name, is_angle) = scene.actuator(actuator).unwrap_or_default();
    let unit = force_unit(is_angle);
    let forces = match [low, high].map(number) {
        [low, high] if low == high => format!("is {low} {unit}"),
        [low, high] => format!("stays between {low} and {high} {unit}"),
    };
    let message = format!(
        "no equilibrium found: the static force along `{name}` {forces} at every position that was evaluated"
    );
    let help = "the loads must balance somewhere, as with a spring or a weight against it; \
                `dwell linearise --about initial` needs no equilibrium";
    let place = (
        SceneLocation::Actuator(ActuatorId(actuator)),
        "pushed to one side only",
    );
    scene_error(scene, message, help, [place])
}

fn explain_no_inertia(scene: &impl NamedScene, q: f64) -> StudyError {
    let message = format!(
        "the generalised inertia m is zero at {} = {}: no body with mass moves there, so the acceleration is \
         undefined",
        scene.quoted_coordinate(),
        own_coordinate(scene, q, scene.is_first_angle())
    );
    let moving = scene.moving_bodies().into_iter();
    let bodies = moving.take(8).map(SceneLocation::Body);
    let help = "give mass and inertia to the moving bodies";
    scene_error(scene, message, help, labels(bodies, "no mass or inertia"))
}

/// Explains a function of time that cannot be followed.
fn explain_fast(
    scene: &impl NamedScene,
    source: usize,
    [width, t]: [f64; 2],
    max_steps: usize,
) -> StudyError {
    let (what, place) = match scene.load_name(source) {
        Some(name) => (format!("load `{name}`"), SceneLocation::Load(source)),
        None => ("a prescribed motion".to_owned(), SceneLocation::Motion),
    };
    let message = format!(
        "{what} varies within {} s near t = {} s: resolving it takes more than the {max_steps} steps allowed",
        digits(width, 2),
        digits(t, 6),
    );
    let help = "shorten the motion; or give --max-step: the variation is then followed only as far as steps of that length resolve it";
    scene_error(scene, message, help, [(place, "varies too fast")])
}

/// Explains a load that is undefined.
fn explain_load(scene: &impl NamedScene, error: KinetostaticsError) -> StudyError {
    let load = error.load().unwrap_or(0);
    let name = scene.load_name(load).unwrap_or_default();
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
    scene_error(scene, message, help, [(SceneLocation::Load(load), label)])
}

/// `t` rounded down to two digits, if that is positive.
fn rounded_down(t: f64) -> Option<String> {
    let unit = 10_f64.powf(t.log10().floor() - 1.0);
    let time = (t / unit).floor() * unit;
    (time.is_normal() && time > 0.0).then(|| digits(time, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The message names the longest step if it is the cause, and otherwise the tolerance with its option.
    #[test]
    fn too_many_steps_are_blamed_on_what_makes_them_many() {
        let text = include_str!("../../tests/run/pendulum.toml");
        let scene = PlaneScene::parse("bar.toml", text).unwrap();
        let explain = |max_step, tolerance, t| {
            let limits = StepLimits {
                max_step,
                tolerance,
            };
            match explain_max_steps(
                &scene,
                t,
                (1000, "the maximum of 1000 steps is reached"),
                &limits,
            ) {
                StudyError::Scene(error) => {
                    let first = &error.errors()[0];
                    (
                        first.message.clone(),
                        first.help.clone().unwrap_or_default(),
                    )
                }
                other => panic!("{other}"),
            }
        };
        // A thousand steps of 1 µs, as long as they may be.
        let (message, help) = explain(Some(1e-6), "--rtol", 1e-3);
        assert!(
            message.contains("--max-step allows none above 1e-6 s"),
            "{message}"
        );
        assert!(
            help.contains("longer --max-step") && !help.contains("--rtol"),
            "{help}"
        );
        // Much shorter than they may be.
        let (message, help) = explain(Some(1.0), "--rtol", 1e-3);
        assert!(message.contains("not --max-step"), "{message}");
        assert!(help.contains("larger --rtol"), "{help}");
        for tolerance in ["--rtol", "--accuracy"] {
            let (message, help) = explain(None, tolerance, 1e-3);
            assert!(
                !message.contains("--max-step") && !help.contains("--max-step"),
                "{help}"
            );
            assert!(help.contains(tolerance), "{help}");
        }
    }
}
