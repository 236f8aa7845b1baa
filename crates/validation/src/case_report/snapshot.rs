//! What the snapshot of a case is made of: values to the digits that every machine reproduces, and which findings pass.

use crate::checked::analysis::{CaseAnalysis, ReducedAnalysis};
use crate::checked::multibody::FreeMotionRun;
use crate::checked::states::CheckedStates;
use crate::written::WRITTEN_PREFIX;
use dwell_findings::Finding;
use dwell_kinetostatics::{Coefficients, ReducedModel as _};
use dwell_scene::PlaneScene;
use dwell_study::reduce::compute::ReducedScene;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// States whose values are in the snapshot.
const PRINTED_STATES: usize = 8;

/// The values of a case in the plane.
pub(super) fn values(scene: &PlaneScene, analysis: &CaseAnalysis<'_>) -> String {
    match &analysis.reduced {
        Some(reduced) => reduced_values(reduced),
        None => state_values(scene, &analysis.states, analysis.free_motion.as_ref()),
    }
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

/// Positions at which the reduced model is printed. They are inside the range: next to its ends a machine's own rounding would show.
pub(crate) fn printed_positions([from, to]: [f64; 2]) -> [f64; 8] {
    std::array::from_fn(|k| from + (to - from) * (k as f64 + 0.5) / 8.0)
}

/// The reduced model at positions, relative to the largest m, force and moment.
pub(crate) fn reduced_text(
    prepared: &dyn ReducedScene,
    rows: impl IntoIterator<Item = (f64, Coefficients)>,
    [m_max, forces, moments]: [f64; 3],
) -> String {
    let (names, mut text) = (prepared.reaction_units(), String::new());
    // Writing to a string cannot fail.
    for (q, at) in rows {
        let q = rounded_to(q, 1.0);
        let [m, half_dm] = [at.m, at.half_dm].map(|value| rounded_to(value, m_max));
        let _ = writeln!(text, "q = {q}  m = {m}  half_dm = {half_dm}");
        for ((name, unit), (&a, &b)) in names.iter().zip(at.a.iter().zip(&at.b)) {
            let scale = if *unit == "N" { forces } else { moments };
            let [a, b] = [a, b].map(|value| rounded_to(value, scale));
            let _ = writeln!(text, "    {name}  a = {a}  b = {b}");
        }
    }
    text
}

/// The reduced model to seven decimals, the period and the fitted value.
fn reduced_values(reduced: &ReducedAnalysis<'_>) -> String {
    let prepared = &reduced.prepared;
    let limits = prepared.model.range().limits();
    let positions = printed_positions(limits.map_or([0.0, TAU], <[f64; 2]>::from));
    let row = |q| Some((q, prepared.coefficients(&[q]).ok()?.pop()?));
    let rows = positions.into_iter().filter_map(row);
    let mut text = reduced_text(prepared, rows, [1.0; 3]);
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

/// To seven digits after the first digit of `max_abs`, without a sign on zero.
pub(crate) fn rounded_to(value: f64, max_abs: f64) -> String {
    let is_scale = max_abs > 0.0 && max_abs.is_finite();
    let magnitude = if is_scale {
        max_abs.log10().floor()
    } else {
        0.0
    };
    let decimals = (7.0 - magnitude).clamp(0.0, 30.0) as usize;
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.trim_matches(['0', '.']).is_empty() => digits.to_owned(),
        _ => text,
    }
}
