//! A free motion of a case with several coordinates: its accelerations against the dense equations, its energy, and a reference.

use super::claims::{SpaceClaims, constant};
use super::reference::SpaceReference;
use super::states::{SPEEDS, free_accelerations, free_machine, in_units};
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::largest;
use dwell_dynamics::{
    DenseOutput, Machine, MachineOde, Method, OdeState, Options, StepControl, integrate,
};
use dwell_findings::{Check, Finding};
use dwell_kinetostatics::MachineModel as _;
use dwell_kinetostatics::space::{LoadKind, Model};
use dwell_scene::{MotionDuration, SpaceScene};
use dwell_verify::FindingSpec;

/// The longest time, s.
const MAX_DURATION: f64 = 1.0;
/// Times at which it is judged.
const TIMES: usize = 8;
/// Its tolerance, and most steps.
pub(super) const TOLERANCE: f64 = 1e-12;
pub(super) const MAX_STEPS: usize = 20_000;

pub(super) const EQUATIONS: FindingSpec<'_> = FindingSpec {
    key: "motion-equations",
    check: Check::MultibodyMotion,
    comparison: "the accelerations of a free motion with those of the dense equations",
    scale: "the largest acceleration that one action makes, or the largest squared speed",
    // The largest seen in a case is 9.3e-13.
    tolerance: 5e-11,
    tolerance_reason: "rounding, amplified by the condition of the equations and of the inertias",
};
pub(super) const ENERGY: FindingSpec<'_> = FindingSpec {
    key: "motion-energy",
    check: Check::Power,
    comparison: "kinetic and potential energy, of placements and dense velocities, with the start's and the work of all other loads",
    scale: "the largest kinetic energy, or the largest change of the potential one",
    // The largest seen in a case is 1.7e-13.
    tolerance: 1e-11,
    tolerance_reason: "the tolerance of the integration, 1e-12 for each step",
};
const REFERENCE: FindingSpec<'_> = FindingSpec {
    key: "reference-motion",
    check: Check::ReferenceValues,
    comparison: "the coordinates of the free motion with those of the reference",
    scale: "one radian or the size",
    // The largest seen in a case is 7.1e-15.
    tolerance: 5e-13,
    ..ENERGY
};

/// States of the machine at ascending times, as far as the motion goes.
fn states_at(machine: &Machine<Model>, y: &[f64], times: &[f64]) -> Option<Vec<OdeState>> {
    let mut system = MachineOde::new(machine, 0.0, y).ok()?;
    let options = Options {
        max_steps: MAX_STEPS,
        ..Options::new(Method::Dop853, TOLERANCE)
    };
    let mut at = OdeState {
        t: 0.0,
        y: y.to_vec(),
    };
    let mut states = Vec::new();
    for &t in times {
        // Dense output is poorer than the steps: each time ends one.
        let mut watch = |_: &OdeState, _: &OdeState, _: DenseOutput<'_>| Ok(StepControl::Continue);
        if t > at.t {
            let done = integrate(&mut system, &at, Some(t), &options, &mut watch).ok()?;
            if done.error.is_some() {
                break;
            }
            at = done.state;
        }
        states.push(at.clone());
    }
    Some(states)
}

/// The start of the motion, and how long it lasts, s.
pub(super) fn start(scene: &SpaceScene, model: &Model) -> ([Vec<f64>; 2], f64) {
    match &scene.motion {
        Some(motion) => {
            let duration = match motion.duration {
                MotionDuration::Seconds(seconds) => seconds.min(MAX_DURATION),
                MotionDuration::Periods(_) => MAX_DURATION,
            };
            let at = [&motion.initial_coordinates, &motion.initial_velocities];
            (at.map(Clone::clone), duration)
        }
        None => {
            let at = [scene.assembly.q.clone(), in_units(model, &SPEEDS[0])];
            (at, MAX_DURATION)
        }
    }
}

/// The findings; none where the machine has no equation of motion.
pub(super) fn motion_findings(
    claims: &SpaceClaims<'_>,
    reference: Option<&SpaceReference>,
) -> Result<Vec<Finding>, ValidationError> {
    let scene = claims.scene();
    let Some(machine) = free_machine(scene)? else {
        return Ok(Vec::new());
    };
    let ([q, q_dot], duration) = start(scene, claims.model());
    let y = machine.initial_state(&q, &q_dot);
    let times: Vec<f64> = (0..=TIMES)
        .map(|k| duration * k as f64 / TIMES as f64)
        .collect();
    let states = states_at(&machine, &y, &times).unwrap_or_default();
    let domain = format!("{} times", states.len());
    let equations = along(claims, &machine, &states).finding(&EQUATIONS, &domain);
    let energy = energies(claims, &machine, &states).finding(&ENERGY, &domain);
    let mut findings: Vec<Finding> = equations.into_iter().chain(energy).collect();
    // A motion that stops early shows less than it should.
    for finding in &mut findings {
        if states.len() <= TIMES {
            finding.pass = false;
        }
    }
    let wanted = reference.map(SpaceReference::states).unwrap_or_default();
    let times: Vec<f64> = wanted.iter().map(|(t, _)| *t).collect();
    let found = states_at(&machine, &y, &times).unwrap_or_default();
    let mut worst = Differences::default();
    for (k, (t, wanted)) in wanted.iter().enumerate() {
        for (i, wanted) in wanted.iter().enumerate() {
            let found = found.get(k).map_or(f64::NAN, |state| state.y[i]);
            let (scale, unit) = match claims.model().is_angle(i) {
                true => (1.0, "rad"),
                false => (claims.size(), "m"),
            };
            let name = &scene.mechanism.actuators[i].name;
            let place = || format!("t = {t} s, {name}");
            worst.compare([found, *wanted, scale], unit, place);
        }
    }
    let domain = format!("{} times of the reference", wanted.len());
    findings.extend(worst.finding(&REFERENCE, &domain));
    Ok(findings)
}

/// Accelerations along a motion.
fn along(claims: &SpaceClaims<'_>, machine: &Machine<Model>, states: &[OdeState]) -> Differences {
    let mut equations = Differences::default();
    let n = claims.model().plan().actuators();
    for OdeState { t, y } in states {
        let [q, q_dot] = [&y[..n], &y[n..2 * n]];
        let found = free_accelerations(machine, *t, [q, q_dot]);
        let (Some(found), Some(dense)) = (found, Dense::new(claims, *t, [q, q_dot])) else {
            equations.compare([f64::NAN, 0.0, 1.0], "", || format!("t = {t} s"));
            continue;
        };
        // Those of speeds may cancel.
        let unit = |k: usize| match claims.model().is_angle(k) {
            true => 1.0,
            false => claims.size(),
        };
        let speeds = q_dot.iter().enumerate().map(|(k, v)| (v / unit(k)).powi(2));
        let scale = speeds.fold(dense.scale, f64::max);
        for (k, (found, wanted)) in found.iter().zip(&dense.accelerations).enumerate() {
            let name = &claims.scene().mechanism.actuators[k].name;
            equations.compare([*found, *wanted, scale], "1/s2", || {
                format!("t = {t:.4} s, {name}")
            });
        }
    }
    equations
}

/// Kinetic and potential energy with those of the first state and the work since.
pub(super) fn energies(
    claims: &SpaceClaims<'_>,
    machine: &Machine<Model>,
    states: &[OdeState],
) -> Differences {
    let mut worst = Differences::default();
    let n = claims.model().plan().actuators();
    let mut energies: Vec<(f64, [f64; 3])> = Vec::new();
    for OdeState { t, y } in states {
        let Some(dense) = Dense::new(claims, *t, [&y[..n], &y[n..2 * n]]) else {
            worst.compare([f64::NAN, 0.0, 1.0], "", || format!("t = {t} s"));
            continue;
        };
        let work: f64 = y[machine.work_offset()..].iter().sum();
        energies.push((*t, [dense.kinetic, dense.potential, work]));
    }
    let Some(&(_, [kinetic, potential, work])) = energies.first() else {
        return worst;
    };
    let larger =
        |max: f64, (_, [t, v, _]): &(f64, [f64; 3])| max.max(*t).max((v - potential).abs());
    let scale = energies.iter().fold(0.0, larger);
    for (time, [t, v, w]) in energies {
        let (found, wanted) = (t + v - potential, kinetic + w - work);
        worst.compare([found, wanted, scale], "J", || format!("t = {time:.4} s"));
    }
    worst
}

/// What the dense equations say of a state.
pub(super) struct Dense {
    accelerations: Vec<f64>,
    /// The actions that a unit acceleration of each coordinate takes, and those that the state takes without acceleration.
    pub(super) columns: Vec<Vec<f64>>,
    pub(super) rest: Vec<f64>,
    /// The largest acceleration that one actuator's action alone makes.
    scale: f64,
    kinetic: f64,
    potential: f64,
}

impl Dense {
    pub(super) fn new(claims: &SpaceClaims<'_>, t: f64, [q, q_dot]: [&[f64]; 2]) -> Option<Self> {
        let n = q.len();
        let placements = claims.placements::<f64>(q).ok()?;
        let magnitudes = claims.magnitudes(t, [q, q_dot]).ok()?;
        let kinds = claims.model().loads().iter().map(|load| load.kind);
        let loads: Vec<(LoadKind, f64)> = kinds.zip(magnitudes).collect();
        let pose = claims.dense_pose(&placements).ok()?;
        let at_rest = vec![0.0; n];
        let actions = |q_ddot: &[f64], loads: &[(LoadKind, f64)], q_dot: &[f64]| {
            pose.solve([q_dot, q_ddot], loads).actuator_actions
        };
        let rest = actions(&at_rest, &loads, q_dot);
        let column = |j: usize| {
            let mut unit = at_rest.clone();
            unit[j] = 1.0;
            actions(&unit, &[], &at_rest)
        };
        let columns: Vec<Vec<f64>> = (0..n).map(column).collect();
        let negative: Vec<f64> = rest.iter().map(|v| -v).collect();
        let accelerations = solved(&columns, &negative)?;
        // Of each action alone.
        let mut scale = 0.0_f64;
        for (k, action) in rest.iter().enumerate() {
            let mut one = at_rest.clone();
            one[k] = *action;
            let parts = solved(&columns, &one)?;
            scale = scale.max(largest(&parts));
        }
        let constant = claims.model().loads().iter().filter_map(constant);
        let conservative = constant.filter_map(|load| pose.potential_energy(load));
        Some(Self {
            accelerations,
            scale,
            kinetic: pose.kinetic_energy(q_dot),
            potential: conservative.sum(),
            columns,
            rest,
        })
    }
}

/// x of Σ columns x = right, by Gauss's elimination with the largest pivots; none where there is no pivot.
pub fn solved(columns: &[Vec<f64>], right: &[f64]) -> Option<Vec<f64>> {
    let n = columns.len();
    let row = |i: usize| columns.iter().map(|c| c[i]).chain([right[i]]).collect();
    let mut rows: Vec<Vec<f64>> = (0..n).map(row).collect();
    for column in 0..n {
        let size = |row: &usize| rows[*row][column].abs();
        let pivot = (column..n).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        rows.swap(column, pivot);
        let pivot_row = rows[column].clone();
        if pivot_row[column] == 0.0 {
            return None;
        }
        for (_, row) in rows.iter_mut().enumerate().filter(|(k, _)| *k != column) {
            let factor = row[column] / pivot_row[column];
            let pairs = row.iter_mut().zip(&pivot_row);
            pairs.for_each(|(x, p)| *x -= factor * p);
        }
    }
    Some((0..n).map(|k| rows[k][n] / rows[k][k]).collect())
}
