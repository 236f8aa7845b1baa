//! Explains positions that cannot be computed, and names those where a range ends.

use crate::explain::{
    NamedScene as _, StudyError, body_names, body_names_or_mechanism, describe_gap, joint_labels,
    labels, scene_error, uncovered_coupling_error,
};
use crate::number_format::{digits, number};
use dwell_geometry::{ActuatorId, Mechanism, Plan, PositionError, RangeLimit};
use dwell_scene::{PlaneScene, SceneFile, SceneLocation};
use std::f64::consts::TAU;

/// A length, m, with `count` digits in the scene's unit: `12.5 mm`.
pub(crate) fn own_length(file: &SceneFile, length: f64, count: usize) -> String {
    let (value, unit) = file.to_scene_unit(length, false);
    format!("{} {unit}", digits(value, count))
}

/// A coordinate, rad or m, in the scene's own unit: `117.28 deg`.
pub(crate) fn own_coordinate(file: &SceneFile, q: f64, is_angle: bool) -> String {
    let (value, unit) = file.to_scene_unit(q, is_angle);
    format!("{} {unit}", number(value))
}

/// A speed, rad/s or m/s, to three digits in the scene's own unit: `34.4 deg/s`.
pub(crate) fn own_speed(file: &SceneFile, speed: f64, is_angle: bool) -> String {
    let (value, unit) = file.to_scene_unit(speed, is_angle);
    format!("{} {unit}/s", digits(value, 3))
}

/// A coordinate with its name: `phi = 2.046915388 rad (117.28°)`, a length in the scene's own unit. Further digits are rounding at the
/// end of a range.
pub(crate) fn describe_coordinate(file: &SceneFile, name: &str, q: f64, is_angle: bool) -> String {
    let rounded = (q * 1e9).round() * 1e-9 + 0.0;
    if is_angle {
        format!(
            "{name} = {} rad ({}°)",
            digits(rounded, 10),
            number(rounded.to_degrees())
        )
    } else {
        format!("{name} = {}", own_length(file, rounded, 10))
    }
}

/// A description of the end of a range: `limit position of `rod` at s = 0.2 m`. `revolutions` are added to an angle.
pub(crate) fn describe_limit(
    file: &SceneFile,
    mechanism: &Mechanism,
    plan: &Plan,
    limit: RangeLimit,
    revolutions: f64,
) -> String {
    let name = mechanism.actuators.first().map_or("", |a| &a.name);
    let at = describe_coordinate(file, name, limit.q + TAU * revolutions, plan.is_angle(0));
    if let Some(coupling) = limit.table {
        let coupling = &mechanism.joints[coupling.0].name;
        return format!("end of the table of `{coupling}` at {at}");
    }
    let kind = match (limit.change_point, limit.separation) {
        (true, Some(_)) => "narrow passage between assembly modes",
        (true, None) => "change point",
        (false, _) => "limit position",
    };
    let bodies = if plan.group_methods().is_empty() {
        Vec::new()
    } else {
        plan.group_bodies(limit.group)
    };
    let who = body_names_or_mechanism(mechanism, &bodies);
    format!("{kind} of {who} at {at}")
}

/// The two ends of a range: `0 to 2.046915 rad (0° to 117.28°)`.
pub(crate) fn describe_ends(file: &SceneFile, from: f64, to: f64, is_angle: bool) -> String {
    // No zero has a sign.
    let rounded = |q: f64| if q.abs() < 5e-7 { 0.0 } else { q };
    if is_angle {
        let [from, to] = [from, to].map(rounded);
        format!(
            "{from:.6} to {to:.6} rad ({:.2}° to {:.2}°)",
            from.to_degrees(),
            to.to_degrees()
        )
    } else {
        let ([from, to], unit) = (
            [from, to].map(|q| file.to_scene_unit(q, false).0),
            file.to_scene_unit(to, false).1,
        );
        format!("{} to {} {unit}", number(from), number(to))
    }
}

/// Help where a coupling's table ends.
pub(crate) const TABLE_HELP: &str = "add rows to the table: its angles are not reduced to one revolution; for a function that repeats with each revolution write an \
     `expression`, in which `x - tau*floor(x/tau)` is the angle within it";

/// Explains a position that cannot be computed.
pub fn explain_position(scene: &PlaneScene, plan: &Plan, error: &PositionError) -> StudyError {
    explain_position_in(&scene.quoted_coordinate(), scene, plan, error)
}

/// Explains a position in a coordinate with another name than the actuator's, that of the plan. One arm for each error, so
/// longer than a screen.
pub(crate) fn explain_position_in(
    phi: &str,
    scene: &PlaneScene,
    plan: &Plan,
    error: &PositionError,
) -> StudyError {
    const RANGE_ENDS: &str = "this is outside the range; `dwell check` shows the range";
    let place = |q| format!("{phi} = {}", own_coordinate(scene, q, plan.is_angle(0)));
    let at = error.coordinate().map_or_else(String::new, place);
    // Beyond its range, where the table of a coupling ends it.
    if let PositionError::OutOfRange { q, to, .. } = *error
        && let Some(limit) = plan.range_limits()[usize::from(q > to)]
        && let Some(coupling) = limit.table
    {
        let end = describe_limit(scene, &scene.mechanism, plan, limit, 0.0);
        let labels = labels(
            [SceneLocation::CouplingLaw(coupling)].into_iter(),
            "has no value beyond",
        );
        return scene_error(scene, format!("the {end} is reached"), TABLE_HELP, labels);
    }
    let group = error.group();
    let bodies = group.map(|g| body_names(&scene.mechanism, &plan.group_bodies(g)));
    let bodies = bodies.unwrap_or_default();
    let (message, help) = match *error {
        PositionError::NoAssembly { gap, .. } => {
            let cause = describe_gap(scene, gap, scene.mechanism.size());
            let message = format!("{bodies} cannot be assembled at {at}: {cause}");
            (message, RANGE_ENDS)
        }
        PositionError::Singular { .. } => (
            format!(
                "{bodies} are in a singular configuration at {at}: {phi} does not determine their motion there"
            ),
            match plan.range().limits() {
                None => "it is a change point: change a length, or drive another joint",
                Some(_) => RANGE_ENDS,
            },
        ),
        PositionError::OtherBranch { .. } => (
            format!("{bodies} can only be assembled in another assembly mode at {at}"),
            "two assembly modes are close to each other there",
        ),
        PositionError::NotConverged { residual, .. } => {
            let what = format!("the positions of {bodies} could not be computed at {at}");
            let message = format!("{what}: residual {}", own_length(scene, residual, 3));
            (message, RANGE_ENDS)
        }
        PositionError::OutOfRange { from, to, .. } => {
            let range = describe_ends(scene, from, to, plan.is_angle(0));
            let message = format!("{at} is outside its range, {range}");
            (message, "start within the range, which `dwell check` shows")
        }
        PositionError::OffTable { coupling, .. } => {
            return uncovered_coupling_error(scene, &scene.mechanism, coupling, &at);
        }
        PositionError::LanesDiverge { .. } => (
            format!("the poses near {at} cannot be evaluated together in SIMD lanes"),
            "evaluate them one by one",
        ),
        PositionError::NotFinite => (
            format!("{phi} is not a finite number"),
            "check the numbers of the motion",
        ),
    };
    let places = match group.map(|g| plan.group_joints(g)) {
        Some(joints) if !joints.is_empty() => joint_labels(&joints, "cannot stay joined there"),
        _ => {
            let at = SceneLocation::InitialCoordinate(ActuatorId(0));
            labels([at].into_iter(), "this coordinate")
        }
    };
    scene_error(scene, message, help, places)
}
