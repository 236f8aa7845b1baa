//! The snapshot of a case: values to the digits that every machine reproduces, and which findings pass.

use crate::checked::analysis::{CaseAnalysis, ReducedAnalysis};
use crate::checked::multibody::FreeMotionRun;
use crate::checked::states::CheckedStates;
use crate::written::WRITTEN_PREFIX;
use dwell_findings::Finding;
use dwell_kinetostatics::ReducedModel;
use dwell_scene::PlaneScene;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// States whose values are in the snapshot.
const PRINTED_STATES: usize = 8;

/// The whole snapshot.
pub(super) fn snapshot(scene: &PlaneScene, analysis: &CaseAnalysis<'_>) -> String {
    let values = match &analysis.reduced {
        Some(reduced) => reduced_values(reduced),
        None => state_values(scene, &analysis.states, analysis.free_motion.as_ref()),
    };
    let verdicts = verdicts(&analysis.findings);
    format!("{}\n\n{values}\n{verdicts}", scene.title)
}

/// Which findings pass.
pub(crate) fn verdicts(findings: &[Finding]) -> String {
    // Differences are rounding errors of one machine; which findings pass is the same on all.
    // Those over written files need the program, which the library has not: they are on the page of the case.
    let of_library = |f: &&Finding| !f.key.starts_with(WRITTEN_PREFIX);
    let all = findings.iter().filter(of_library).map(|f| {
        let result = if f.pass { "pass" } else { "FAIL" };
        format!("{result}  {}  [{}]\n", f.key, f.check)
    });
    all.collect()
}

/// The reduced model at eight positions, the period and the fitted value.
fn reduced_values(reduced: &ReducedAnalysis<'_>) -> String {
    let prepared = &reduced.prepared;
    let mut text = String::new();
    let (from, to) = prepared.model.range().limits().unwrap_or((0.0, TAU));
    let mut at = prepared.model.model().coefficient_buffer();
    let mut workspace = prepared.model.workspace();
    for k in 0..8 {
        // Inside the range: next to its ends a machine's own rounding would show.
        let q = from + (to - from) * (f64::from(k) + 0.5) / 8.0;
        let Ok(()) = prepared.model.coefficients(q, &mut workspace, &mut at) else {
            continue;
        };
        let [q, m, half_dm] = [q, at.m, at.half_dm].map(to_seven_decimals);
        text += &format!("q = {q}  m = {m}  half_dm = {half_dm}\n");
        for ((name, _), (&a, &b)) in prepared.reaction_units().iter().zip(at.a.iter().zip(&at.b)) {
            let [a, b] = [a, b].map(to_seven_decimals);
            text += &format!("    {name}  a = {a}  b = {b}\n");
        }
    }
    if let Some(motion) = &reduced.motion {
        let (period, energy) = (motion.orbit.period, motion.orbit.energy);
        text += &format!("\nperiod {period:.10} s, energy {energy:.9} J\n");
    }
    if let Some(c) = &reduced.calibration {
        let (path, value, unit, period) = (&c.path, c.value, &c.unit, c.period);
        text += &format!("{path} = {value:.9} {unit} gives {period} s\n");
    }
    text
}

/// Some states, and the end of a free motion that the scene does not prescribe.
fn state_values(
    scene: &PlaneScene,
    checked: &CheckedStates,
    run: Option<&FreeMotionRun>,
) -> String {
    let mechanism = &scene.mechanism;
    let reactions = mechanism.reactions();
    let drawn = &checked.states[..checked.drawn_count];
    // All forces are rounded relative to the largest force, all moments relative to the largest moment.
    let joints = reactions.iter().map(|r| r.component.unit());
    let actuators = mechanism.actuators.iter();
    let actuators = actuators.map(|a| a.coordinate().force_unit());
    let units: Vec<&str> = joints.chain(actuators).collect();
    let [forces, moments] = ["N", "N m"].map(|unit| {
        let values = drawn
            .iter()
            .flat_map(|s| units.iter().zip(s.reactions.iter().chain(&s.tau)));
        let same = values.filter(|(of, _)| **of == unit);
        same.fold(0.0, |max: f64, (_, value)| max.max(value.abs()))
    });
    let scale = |unit: &str| if unit == "N" { forces } else { moments };
    let mut text = format!("{}\n", checked.motion_text);
    // Writing to a string cannot fail.
    for k in 0..PRINTED_STATES.min(drawn.len()) {
        // Between the ends, where a motion may begin with a jump.
        let state = &drawn[(2 * k + 1) * (drawn.len() - 1) / (2 * PRINTED_STATES)];
        let t = rounded_to(state.t, drawn[drawn.len() - 1].t);
        let _ = writeln!(text, "t = {t}");
        let values = state.q.iter().zip(&state.tau);
        for (actuator, (q, tau)) in mechanism.actuators.iter().zip(values) {
            let tau = rounded_to(*tau, scale(actuator.coordinate().force_unit()));
            let _ = writeln!(text, "    {} = {q:.7}  force = {tau}", actuator.name);
        }
        let requested = scene.requests.reactions.iter();
        for &reaction in requested.filter(|r| !checked.indeterminate.contains(r)) {
            let Some(k) = reactions.iter().position(|&r| r == reaction) else {
                continue;
            };
            let value = rounded_to(state.reactions[k], scale(reaction.component.unit()));
            let _ = writeln!(text, "    {} = {value}", mechanism.reaction_name(reaction));
        }
    }
    // Of a scene that is set free, the end depends on the steps.
    if let Some(run) = run.filter(|run| run.setup.is_empty()) {
        text += &end_of_motion(scene, run);
    }
    text
}

/// Where the free motion ends, to the digits that are stable.
fn end_of_motion(scene: &PlaneScene, run: &FreeMotionRun) -> String {
    let (Some(last), Some(coordinates)) = (run.steps.last(), run.coordinates.last()) else {
        return String::new();
    };
    let mut text = format!("free motion, t = {}\n", rounded_to(last.t, last.t));
    let actuators = scene.mechanism.actuators.iter().zip(coordinates);
    for (k, (actuator, [q, velocity])) in actuators.enumerate() {
        let all = run.coordinates.iter();
        let max_velocity = all.fold(0.0_f64, |max, at| max.max(at[k][1].abs()));
        let velocity = rounded_to(*velocity, max_velocity);
        let name = &actuator.name;
        let _ = writeln!(text, "    {name} = {q:.7}  velocity = {velocity}");
    }
    text
}

/// Seven decimals, without a sign on zero.
fn to_seven_decimals(value: f64) -> String {
    without_sign_on_zero(format!("{value:.7}"))
}

/// To seven digits after the first digit of `max_abs`, without a sign on zero.
pub(crate) fn rounded_to(value: f64, max_abs: f64) -> String {
    let is_scale = max_abs > 0.0 && max_abs.is_finite();
    let magnitude = if is_scale {
        max_abs.log10().floor()
    } else {
        0.0
    };
    let decimals = (7.0 - magnitude).clamp(0.0, 30.0) as usize;
    without_sign_on_zero(format!("{value:.decimals$}"))
}

fn without_sign_on_zero(text: String) -> String {
    match text.strip_prefix('-') {
        Some(digits) if digits.trim_matches(['0', '.']).is_empty() => digits.to_owned(),
        _ => text,
    }
}
