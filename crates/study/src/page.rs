//! The report of a case that is judged in states alone: with loads, or several actuators.

use crate::dossier::{illustrated, rounded_to, tolerances, verdicts};
use crate::error::StudyError;
use crate::figures;
use crate::multibody::{self, FreeRun};
use crate::outcome::{Outcome, Progress, Step};
use crate::period;
use crate::provenance::picture;
use crate::reference::Reference;
use crate::rounding::{self, Rounding};
use crate::states::{self, Judged};
use crate::validate::{STEPS, Validation, reduced, silent};
use dwell_findings::all_pass;
use dwell_report::{Block, Document, Files, json};
use dwell_scene::Scene;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write as _;

/// States whose numbers are in the rounded text.
const TOLD: usize = 8;

/// The numbers of the report, as JSON.
#[derive(Serialize)]
struct Numbers<'a> {
    title: &'a str,
    note: &'a Option<String>,
    version: &'static str,
    scene: &'a str,
    scene_sha256: String,
    passed: bool,
    states: usize,
    findings: &'a [dwell_findings::Finding],
}

/// Judges a case in states, and writes its report.
///
/// # Errors
/// [`StudyError`] when the scene cannot be used.
pub(crate) fn of_states(
    scene: &Scene,
    reference: &Reference,
    progress: Progress<'_>,
) -> Result<Validation, StudyError> {
    let done = |what: &str| {
        progress(Step {
            total: STEPS,
            done: what,
        });
    };
    let ((judged, motion), (reduced, timed)) = rayon::join(
        || {
            rayon::join(
                || states::judge(scene, reference),
                || multibody::judged(scene, reference),
            )
        },
        || {
            rayon::join(
                // m, half dm/dq, a and b do not depend on loads.
                || match scene.mechanism.actuators.len() {
                    1 => reduced(scene, reference),
                    _ => Ok((Vec::new(), Vec::new())),
                },
                || period::of_case(scene, reference),
            )
        },
    );
    let (mut judged, (run, of_motion), (of_model, _)) = (judged?, motion?, reduced?);
    let timed = timed?;
    judged.findings.extend(of_model);
    judged.findings.extend(timed.iter().flatten().cloned());
    judged.findings.extend(of_motion);
    let rounding = Rounding::new(scene, &judged.states)?;
    judged.findings.extend(rounding::finding(&rounding));
    reference.judge(&mut judged.findings)?;
    done("states");
    let mut pages = vec![
        figures::drawing(scene, &judged),
        figures::actions(scene, &judged),
    ];
    pages.extend(run.as_ref().map(|run| figures::energies(scene, run)));
    pages.push(figures::digits(scene, &judged.findings));
    pages.push(figures::rounding(scene, &judged, &rounding));
    let draw = |page| picture(scene, page);
    let pictures: Vec<Vec<u8>> = pages.par_iter().map(draw).collect::<Result<_, _>>()?;
    done("pictures");
    let mut files = Files::new();
    let name = &scene.name;
    for (page, picture) in pages.iter().zip(pictures) {
        files.add(format!("{name}/{}.png", page.name), picture);
    }
    let snapshot = snapshot(scene, &judged, run.as_ref());
    files.add(format!("{name}.txt"), snapshot.clone());
    let numbers = Numbers {
        title: &scene.title,
        note: &scene.note,
        version: env!("CARGO_PKG_VERSION"),
        scene: &scene.name,
        scene_sha256: scene.hash(),
        passed: all_pass(&judged.findings),
        states: judged.states.len(),
        findings: &judged.findings,
    };
    files.add(format!("{name}.json"), json(&numbers)?);
    files.add(
        format!("{name}.md"),
        document(scene, reference, &pages, &judged).markdown(),
    );
    done("report");
    Ok(Validation {
        silent: silent(scene, &judged.findings, timed.err()),
        outcome: Outcome {
            summary: verdicts(scene, &judged.findings),
            files,
            findings: judged.findings,
        },
        snapshot,
    })
}

/// The text that every machine reproduces: a few states to the digits that are stable, and verdicts.
fn snapshot(scene: &Scene, judged: &Judged, run: Option<&FreeRun>) -> String {
    let mechanism = &scene.mechanism;
    let reactions = mechanism.reactions();
    let drawn = &judged.states[..judged.drawn];
    // Both zero moments and the largest are told to a part of the largest force or moment.
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
    let mut text = format!("{}\n\n{}\n", scene.title, judged.motion);
    // Writing to a string cannot fail.
    for k in 0..TOLD.min(drawn.len()) {
        // Between the ends, where a motion may begin with a jump.
        let state = &drawn[(2 * k + 1) * (drawn.len() - 1) / (2 * TOLD)];
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
        let told = scene.requests.reactions.iter();
        for &wanted in told.filter(|r| !judged.shared.contains(r)) {
            let Some(k) = reactions.iter().position(|&r| r == wanted) else {
                continue;
            };
            let unit = wanted.component.unit();
            let value = rounded_to(
                state.reactions[k],
                if unit == "N" { forces } else { moments },
            );
            let _ = writeln!(text, "    {} = {value}", mechanism.reaction_name(wanted));
        }
    }
    // Where a motion of our own making ends depends on the steps.
    if let Some(run) = run.filter(|run| run.told.is_empty()) {
        text += &ended(scene, run);
    }
    text.push('\n');
    for f in &judged.findings {
        let verdict = if f.pass { "pass" } else { "FAIL" };
        let _ = writeln!(text, "{verdict}  {}  [{}]", f.key, f.truth);
    }
    text
}

/// Where the free motion ends, to the digits that are stable.
fn ended(scene: &Scene, run: &FreeRun) -> String {
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
        let fastest = all.fold(0.0_f64, |most, at| most.max(at[k][1].abs()));
        let speed = rounded_to(*speed, fastest);
        let _ = writeln!(text, "    {} = {q:.7}  speed = {speed}", actuator.name);
    }
    text
}

fn document(
    scene: &Scene,
    reference: &Reference,
    pages: &[dwell_report::Figure],
    judged: &Judged,
) -> Document {
    let passed = judged.findings.iter().filter(|f| f.pass).count();
    let mut blocks: Vec<Block> = scene.note.iter().cloned().map(Block::Text).collect();
    blocks.push(Block::Text(format!(
        "{passed} of {} findings pass, on {} states: {}{}.",
        judged.findings.len(),
        judged.states.len(),
        judged.motion,
        match reference.asks().len() {
            0 => String::new(),
            n => format!(" and {n} of the reference"),
        }
    )));
    if !reference.source.is_empty() {
        blocks.push(Block::Text(format!("Source: {}.", reference.source)));
    }
    if let Some(computed) = &reference.computed {
        blocks.push(Block::Text(format!("Reference numbers: {computed}.")));
    }
    blocks.push(Block::Heading("Findings".to_owned()));
    blocks.push(Block::Findings(judged.findings.clone()));
    blocks.push(tolerances(&judged.findings));
    illustrated(scene, pages, blocks)
}
