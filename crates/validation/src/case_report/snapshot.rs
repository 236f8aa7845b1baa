//! The snapshot of a case: values to the digits that every machine reproduces, and which findings pass.

use crate::checked::analysis::{CaseAnalysis, ReducedAnalysis};
use crate::checked::multibody::FreeMotionRun;
use crate::checked::states::CheckedStates;
use dwell_kinetostatics::ReducedModel;
use dwell_scene::Scene;
use std::fmt::Write as _;

/// States whose values are in the snapshot.
const PRINTED_STATES: usize = 8;

/// The whole snapshot.
pub(super) fn snapshot(scene: &Scene, analysis: &CaseAnalysis<'_>) -> String {
    let values = match &analysis.reduced {
        Some(reduced) => reduced_values(reduced),
        None => state_values(scene, &analysis.states, analysis.free_motion.as_ref()),
    };
    let mut text = format!("{}\n\n{values}\n", scene.title);
    // Differences are rounding errors of one machine; which findings pass is the same on all.
    for f in &analysis.findings {
        let result = if f.pass { "pass" } else { "FAIL" };
        text += &format!("{result}  {}  [{}]\n", f.key, f.check);
    }
    text
}

/// The reduced model at eight positions, the period and the fitted value.
fn reduced_values(reduced: &ReducedAnalysis<'_>) -> String {
    let prepared = &reduced.prepared;
    let mut text = String::new();
    let (from, to) = match prepared.model.range().limits() {
        None => (0.0, std::f64::consts::TAU),
        Some((from, to)) => (from, to),
    };
    let mut at = prepared.model.model().coefficient_buffer();
    let mut workspace = prepared.model.workspace();
    for k in 0..8 {
        // Inside the range: next to its ends a machine's own rounding would show.
        let q = from + (to - from) * (f64::from(k) + 0.5) / 8.0;
        if prepared
            .model
            .coefficients(q, &mut workspace, &mut at)
            .is_err()
        {
            continue;
        }
        text += &format!(
            "q = {}  m = {}  half_dm = {}\n",
            to_seven_decimals(q),
            to_seven_decimals(at.m),
            to_seven_decimals(at.half_dm)
        );
        for ((name, _), (a, b)) in prepared.reaction_units().iter().zip(at.a.iter().zip(&at.b)) {
            text += &format!(
                "    {name}  a = {}  b = {}\n",
                to_seven_decimals(*a),
                to_seven_decimals(*b)
            );
        }
    }
    if let Some(motion) = &reduced.motion {
        text += &format!(
            "\nperiod {:.10} s, energy {:.9} J\n",
            motion.orbit.period, motion.orbit.energy
        );
    }
    if let Some(c) = &reduced.calibration {
        text += &format!(
            "{} = {:.9} {} gives {} s\n",
            c.path, c.value, c.unit, c.period
        );
    }
    text
}

/// Some states, and the end of a free motion that the scene does not prescribe.
fn state_values(scene: &Scene, checked: &CheckedStates, run: Option<&FreeMotionRun>) -> String {
    let mechanism = &scene.mechanism;
    let reactions = mechanism.reactions();
    let drawn = &checked.states[..checked.drawn_count];
    // All forces are rounded relative to the largest force, all moments relative to the largest moment.
    let scale = |unit: &str| {
        let joints = reactions.iter().enumerate();
        let joints = joints.filter(|(_, r)| r.component.unit() == unit);
        let of = |k: usize| {
            drawn
                .iter()
                .fold(0.0, |m: f64, s| m.max(s.reactions[k].abs()))
        };
        let of_joints = joints.map(|(k, _)| of(k)).fold(0.0, f64::max);
        let drives = mechanism.actuators.iter().enumerate();
        let drives = drives.filter(|(_, a)| a.coordinate().is_angle() == (unit == "N m"));
        let of = |k: usize| drawn.iter().fold(0.0, |m: f64, s| m.max(s.tau[k].abs()));
        drives.map(|(k, _)| of(k)).fold(of_joints, f64::max)
    };
    let [forces, moments] = ["N", "N m"].map(scale);
    let mut text = format!("{}\n", checked.motion_text);
    // Writing to a string cannot fail.
    for k in 0..PRINTED_STATES.min(drawn.len()) {
        // Between the ends, where a motion may begin with a jump.
        let state = &drawn[(2 * k + 1) * (drawn.len() - 1) / (2 * PRINTED_STATES)];
        let _ = writeln!(
            text,
            "t = {}",
            rounded_to(state.t, drawn[drawn.len() - 1].t)
        );
        for (actuator, (q, tau)) in mechanism
            .actuators
            .iter()
            .zip(state.q.iter().zip(&state.tau))
        {
            let angle = actuator.coordinate().is_angle();
            let tau = rounded_to(*tau, if angle { moments } else { forces });
            let _ = writeln!(text, "    {} = {q:.7}  action = {tau}", actuator.name);
        }
        let requested = scene.requests.reactions.iter();
        for &reaction in requested.filter(|r| !checked.indeterminate.contains(r)) {
            let Some(k) = reactions.iter().position(|&r| r == reaction) else {
                continue;
            };
            let unit = reaction.component.unit();
            let value = rounded_to(
                state.reactions[k],
                if unit == "N" { forces } else { moments },
            );
            let _ = writeln!(text, "    {} = {value}", mechanism.reaction_name(reaction));
        }
    }
    // With steps set by the workbench, the end depends on them.
    if let Some(run) = run.filter(|run| run.setup.is_empty()) {
        text += &end_of_motion(scene, run);
    }
    text
}

/// Where the free motion ends, to the digits that are stable.
fn end_of_motion(scene: &Scene, run: &FreeMotionRun) -> String {
    let (Some(last), Some(coordinates)) = (run.steps.last(), run.coordinates.last()) else {
        return String::new();
    };
    let mut text = format!("free motion, t = {}\n", rounded_to(last.t, last.t));
    let actuators = scene
        .mechanism
        .actuators
        .iter()
        .zip(coordinates)
        .enumerate();
    for (k, (actuator, [q, speed])) in actuators {
        let all = run.coordinates.iter();
        let max_velocity = all.fold(0.0_f64, |max, at| max.max(at[k][1].abs()));
        let speed = rounded_to(*speed, max_velocity);
        let _ = writeln!(text, "    {} = {q:.7}  speed = {speed}", actuator.name);
    }
    text
}

/// Seven decimals, without a sign on zero.
fn to_seven_decimals(value: f64) -> String {
    without_sign_on_zero(format!("{value:.7}"))
}

/// To seven digits after the first digit of `max_abs`, without a sign on zero.
fn rounded_to(value: f64, max_abs: f64) -> String {
    let decimals = if max_abs > 0.0 && max_abs.is_finite() {
        7.0 - max_abs.log10().floor()
    } else {
        7.0
    };
    let decimals = decimals.clamp(0.0, 30.0) as usize;
    without_sign_on_zero(format!("{value:.decimals$}"))
}

fn without_sign_on_zero(text: String) -> String {
    match text.strip_prefix('-') {
        Some(digits) if digits.trim_matches(['0', '.']).is_empty() => digits.to_owned(),
        _ => text,
    }
}
