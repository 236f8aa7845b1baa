//! `dwell validate`: a case from its folder to its report: everything computed, everything checked.

use crate::calibrate::{Calibrated, find_value};
use crate::error::{StudyError, explain_motion};
use crate::figures::{self, Dwell};
use crate::outcome::{Outcome, Progress, Step};
use crate::prepare::Prepared;
use crate::reduce::Sweep;
use crate::reference::Reference;
use crate::simulate::{Accuracy, History};
use crate::subject::PlanSubject;
use dwell_findings::{Finding, all_pass};
use dwell_kinetostatics::Reduced;
use dwell_report::{Block, Column, Document, Figure, Files, Table, json, png, stable};
use dwell_scene::{Length, Scene};
use dwell_verify::{
    Bench, Case, ErrorCurve, FreeMotion, FreeMotionCase, Rung, free_motion, half_dm_curve,
    reaction_curve, spread,
};
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;

/// Positions at which every truth is held against the model.
const POSITIONS: usize = 24;
/// Steps of the progress bar for one case.
const STEPS: usize = 4;

/// A validated case.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Validation {
    /// Words, files and findings.
    pub outcome: Outcome,
    /// The rounded text that every machine reproduces.
    pub snapshot: String,
}

/// What the checks of a case yield.
struct Evidence {
    findings: Vec<Finding>,
    curves: Vec<ErrorCurve>,
    motion: Option<FreeMotion>,
    calibrated: Option<Calibrated>,
    history: Option<History>,
    dwell: Option<Dwell>,
    sweep: Sweep,
}

/// The numbers of the report, as JSON.
#[derive(Serialize)]
struct Numbers<'a> {
    title: &'a str,
    note: &'a Option<String>,
    version: &'static str,
    passed: bool,
    period_s: Option<f64>,
    energy_j: Option<f64>,
    calibration: Option<Value<'a>>,
    convergence_slope: Option<f64>,
    findings: &'a [Finding],
    ladder: Vec<LadderRow>,
}

#[derive(Serialize)]
struct Value<'a> {
    path: &'a str,
    unit: &'a str,
    scene: f64,
    scene_period_s: f64,
    found: f64,
    wanted_period_s: f64,
}

#[derive(Serialize)]
struct LadderRow {
    method: &'static str,
    tolerance: f64,
    steps: usize,
    rejected: usize,
    evaluations: usize,
    jacobians: usize,
    seconds: f64,
    period_error: f64,
    energy_drift: f64,
    reaction_error: f64,
}

impl From<&Rung> for LadderRow {
    fn from(r: &Rung) -> Self {
        Self {
            method: r.method.name(),
            tolerance: r.tolerance,
            steps: r.work.steps,
            rejected: r.work.rejected,
            evaluations: r.work.evaluations,
            jacobians: r.work.jacobians,
            seconds: r.seconds,
            period_error: r.period_error,
            energy_drift: r.drift,
            reaction_error: r.reaction_error,
        }
    }
}

/// Validates the case whose scene is `scene` and whose reference, if any, is in `folder`. The
/// files are `NAME.md`, `NAME.json`, `NAME.txt` and the folder `NAME/` with pictures and tables.
///
/// # Errors
/// [`StudyError`] when the scene or the reference cannot be used. A failed check is no error.
pub fn validate(
    scene: &Scene,
    folder: &Path,
    progress: Progress<'_>,
) -> Result<Validation, StudyError> {
    let prepared = Prepared::new(scene)?;
    let reference = Reference::read(folder, scene)?;
    let done = |what: &str| {
        progress(Step {
            total: STEPS,
            done: what,
        });
    };
    let (judged, rest) = rayon::join(
        || judge(scene, &reference).inspect(|_| done("truths")),
        || rest(&prepared, &reference).inspect(|_| done("free motion")),
    );
    let ((mut findings, curves), (motion, calibrated, history)) = (judged?, rest?);
    if let Some(motion) = &motion {
        findings.extend(motion.findings.clone());
    }
    let (drawing, dwell) = figures::mechanism(&prepared)?;
    let evidence = Evidence {
        findings,
        curves,
        motion,
        calibrated,
        history,
        dwell,
        sweep: Sweep::new(&prepared)?,
    };
    let pages = pages(&prepared, drawing, &evidence);
    let pictures: Vec<Vec<u8>> = pages.par_iter().map(png).collect::<Result<_, _>>()?;
    done("pictures");
    let mut files = Files::new();
    let name = &scene.name;
    for (page, picture) in pages.iter().zip(pictures) {
        files.add(format!("{name}/{}.png", page.name), picture);
    }
    for (file, table) in tables(&prepared, &evidence) {
        files.add(format!("{name}/{file}.csv"), table.csv()?);
    }
    let snapshot = snapshot(&prepared, &evidence);
    files.add(format!("{name}.txt"), snapshot.clone());
    files.add(format!("{name}.json"), numbers(scene, &evidence)?);
    let document = document(&prepared, &reference, &pages, &evidence);
    files.add(format!("{name}.md"), document.markdown());
    done("report");
    Ok(Validation {
        outcome: Outcome {
            summary: summary(scene, &evidence),
            files,
            findings: evidence.findings,
        },
        snapshot,
    })
}

/// The truths that need no motion, on every reaction of every joint.
fn judge(
    scene: &Scene,
    reference: &Reference,
) -> Result<(Vec<Finding>, Vec<ErrorCurve>), StudyError> {
    let subject = PlanSubject::new(scene)?;
    let range = subject.exact().range();
    let case = Case {
        mechanism: &scene.mechanism,
        masses: &scene.masses,
        range,
        positions: spread(range, POSITIONS),
    };
    let findings = dwell_verify::verify_all(&case, &subject, &reference.samples);
    let mut curves = Vec::new();
    if let Ok(bench) = Bench::new(&case, &subject) {
        // Where ½m′ is largest, differences have most to get right.
        let steepest = |s: &&dwell_verify::Site| s.exact.half_dm.abs();
        let site = bench
            .sites
            .iter()
            .max_by(|a, b| steepest(a).total_cmp(&steepest(b)));
        if let Some(site) = site {
            let wanted = scene.requests.reactions.first();
            let k = wanted.and_then(|w| bench.reactions.iter().position(|r| r == w));
            curves.extend(half_dm_curve(&bench, site));
            curves.extend(k.and_then(|k| reaction_curve(&bench, site, k)));
        }
    }
    Ok((findings, curves))
}

type Rest = (Option<FreeMotion>, Option<Calibrated>, Option<History>);

/// The motion, the fitted number and the time history, where the scene has them.
fn rest(prepared: &Prepared<'_>, reference: &Reference) -> Result<Rest, StudyError> {
    let scene = prepared.scene;
    let (Some(start), Some(motion)) = (prepared.start(), &scene.motion) else {
        return Ok((None, None, None));
    };
    let plan = prepared.model.model().plan();
    let history = History::new(
        prepared,
        start,
        two_turns(motion.length),
        &Accuracy::default(),
    )?;
    let judged = match (history.period, motion.length) {
        (None, _) => None,
        (Some(period), length) => {
            let turns = match length {
                Length::Periods(n) => n,
                Length::Duration(d) => d / period,
            };
            let case = FreeMotionCase {
                start,
                turns: (turns.floor() as usize).max(1),
                reactions: prepared.reactions(),
                period: reference.period.map(|p| (p, reference.source.clone())),
            };
            let judged = free_motion(&prepared.model, &case);
            Some(judged.map_err(|e| explain_motion(scene, plan, &e))?)
        }
    };
    let wanted = scene.calibration.as_ref();
    let calibrated = wanted
        .map(|c| find_value(scene, &c.path, c.period))
        .transpose()?;
    Ok((judged, calibrated, Some(history)))
}

/// What the time history shows: two turns of a periodic motion, all of another.
fn two_turns(length: Length) -> Length {
    match length {
        Length::Periods(n) => Length::Periods(n.min(2.0)),
        duration @ Length::Duration(_) => duration,
    }
}

fn pages(prepared: &Prepared<'_>, drawing: Figure, evidence: &Evidence) -> Vec<Figure> {
    let mut pages = vec![drawing, figures::reduced(prepared, &evidence.sweep)];
    pages.extend(figures::coefficients(prepared, &evidence.sweep));
    if let Some(history) = &evidence.history {
        pages.push(figures::history(prepared, history, &Accuracy::default()));
    }
    if let Some(motion) = &evidence.motion {
        pages.push(figures::drift(prepared, motion));
    }
    if !evidence.curves.is_empty() {
        pages.push(figures::steps(prepared, &evidence.curves));
    }
    if let Some(motion) = &evidence.motion {
        pages.push(figures::cost(prepared, motion));
    }
    pages
}

fn tables(prepared: &Prepared<'_>, evidence: &Evidence) -> Vec<(&'static str, Table)> {
    let mut tables = vec![("reduced", evidence.sweep.table(prepared))];
    if let Some(history) = &evidence.history {
        tables.push(("motion", history.table(prepared)));
    }
    if let Some(motion) = &evidence.motion {
        let columns = [
            ("bdf_or_tsit45", "0 or 1"),
            ("tolerance", ""),
            ("steps", ""),
            ("evaluations", ""),
            ("jacobians", ""),
            ("wall_time", "s"),
            ("period_error", ""),
            ("energy_drift", ""),
            ("reaction_error", ""),
        ];
        let row = |r: &Rung| {
            vec![
                f64::from(u8::from(r.method == dwell_dynamics::Method::Tsit45)),
                r.tolerance,
                r.work.steps as f64,
                r.work.evaluations as f64,
                r.work.jacobians as f64,
                r.seconds,
                r.period_error,
                r.drift,
                r.reaction_error,
            ]
        };
        tables.push((
            "cost",
            Table {
                columns: columns.map(|(n, u)| Column::new(n, u)).to_vec(),
                rows: motion.rungs.iter().map(row).collect(),
            },
        ));
    }
    tables
}

fn numbers(scene: &Scene, evidence: &Evidence) -> Result<String, StudyError> {
    let motion = evidence.motion.as_ref();
    Ok(json(&Numbers {
        title: &scene.title,
        note: &scene.note,
        version: env!("CARGO_PKG_VERSION"),
        passed: all_pass(&evidence.findings),
        period_s: motion.map(|m| m.turn.period),
        energy_j: motion.map(|m| m.turn.energy),
        calibration: evidence.calibrated.as_ref().map(|c| Value {
            path: &c.path,
            unit: &c.unit,
            scene: c.present,
            scene_period_s: c.present_period,
            found: c.found,
            wanted_period_s: c.period,
        }),
        convergence_slope: motion.map(|m| m.slope),
        findings: &evidence.findings,
        ladder: motion.map_or_else(Vec::new, |m| m.rungs.iter().map(LadderRow::from).collect()),
    })?)
}

/// The text that every machine reproduces: verdicts, and values to the digits that are stable.
fn snapshot(prepared: &Prepared<'_>, evidence: &Evidence) -> String {
    let scene = prepared.scene;
    let mut text = format!("{}\n\n", scene.title);
    let mut model_at = prepared.model.model().coefficients();
    let mut work = prepared.model.work();
    for q in prepared.sweep(8) {
        if prepared
            .model
            .coefficients(q, &mut work, &mut model_at)
            .is_ok()
        {
            text += &format!(
                "q = {q:.6}  m = {:.9}  half_dm = {:.9}\n",
                model_at.m,
                model_at.half_dm + 0.0
            );
        }
    }
    if let Some(motion) = &evidence.motion {
        text += &format!(
            "\nperiod {:.10} s, energy {:.9} J\n",
            motion.turn.period, motion.turn.energy
        );
    }
    if let Some(c) = &evidence.calibrated {
        text += &format!(
            "{} = {:.9} {} gives {} s\n",
            c.path, c.found, c.unit, c.period
        );
    }
    text.push('\n');
    // The measured slope and the words with a machine's own digits stay out.
    let known: Vec<Finding> = evidence
        .findings
        .iter()
        .cloned()
        .map(|mut f| {
            f.compared = String::new();
            f
        })
        .collect();
    for (finding, line) in known.iter().zip(stable(&known).lines()) {
        let line = line.split("  [").next().unwrap_or(line);
        text += &format!("{line}  [{}]\n", finding.truth);
    }
    text
}

fn summary(scene: &Scene, evidence: &Evidence) -> String {
    let failed: Vec<&Finding> = evidence.findings.iter().filter(|f| !f.pass).collect();
    let mut text = format!(
        "{}: {} of {} findings pass\n",
        scene.name,
        evidence.findings.len() - failed.len(),
        evidence.findings.len()
    );
    for f in failed {
        text += &format!(
            "  FAIL {} ({}): {}; relative {:.1e}, tolerance {:.1e}, worst at {}\n",
            f.key, f.truth, f.compared, f.relative, f.tolerance, f.worst
        );
    }
    if let Some(motion) = &evidence.motion {
        text += &format!("  period {:.12} s by quadrature\n", motion.turn.period);
    }
    if let Some(c) = &evidence.calibrated {
        text += &format!(
            "  {} = {:.12} {} gives {} s; the scene has {}\n",
            c.path, c.found, c.unit, c.period, c.present
        );
    }
    text
}

fn document(
    prepared: &Prepared<'_>,
    reference: &Reference,
    pages: &[Figure],
    evidence: &Evidence,
) -> Document {
    let scene = prepared.scene;
    let mut blocks = Vec::new();
    if let Some(note) = &scene.note {
        blocks.push(Block::Text(note.clone()));
    }
    let passed = evidence.findings.iter().filter(|f| f.pass).count();
    blocks.push(Block::Text(format!(
        "{passed} of {} findings pass. Written by Dwell {}.",
        evidence.findings.len(),
        env!("CARGO_PKG_VERSION")
    )));
    if !reference.source.is_empty() {
        blocks.push(Block::Text(format!(
            "Reference numbers: {}.",
            reference.source
        )));
    }
    if let Some(c) = &evidence.calibrated {
        blocks.push(Block::Heading("Agreement by construction".to_owned()));
        blocks.push(Block::Text(format!(
            "`{}` is the fitted number of this scene, so the period of {} s is no finding. Found anew: **{:.12} {}** \
             gives {} s; the scene has the rounded {} {}, which gives {:.12} s.",
            c.path, c.period, c.found, c.unit, c.period, c.present, c.unit, c.present_period
        )));
    }
    if let Some(d) = &evidence.dwell {
        blocks.push(Block::Text(format!(
            "Dwell: `{}` stays within {:.3}° (of a swing of {:.2}°) from {:.1}° to {:.1}° of the actuator.",
            scene.mechanism.body_name(d.body),
            d.moves.to_degrees(),
            d.swing.to_degrees(),
            d.from.to_degrees(),
            d.to.to_degrees()
        )));
    }
    blocks.push(Block::Heading("Findings".to_owned()));
    blocks.push(Block::Findings(evidence.findings.clone()));
    if let Some(motion) = &evidence.motion {
        blocks.push(Block::Heading("What a tolerance is worth".to_owned()));
        blocks.push(Block::Text(
            "A tolerance bounds the error of one step, not of the motion: BDF's energy error is hundreds of times it. \
             Errors are relative; times are of the machine that wrote this."
                .to_owned(),
        ));
        let header = [
            "Method",
            "Tolerance",
            "Steps",
            "Evaluations",
            "Jacobians",
            "Time (ms)",
            "Period",
            "Energy",
            "Reaction",
            "Energy error / tolerance",
        ];
        let row = |r: &Rung| {
            vec![
                r.method.name().to_owned(),
                format!("{:.0e}", r.tolerance),
                r.work.steps.to_string(),
                r.work.evaluations.to_string(),
                r.work.jacobians.to_string(),
                format!("{:.2}", r.seconds * 1e3),
                format!("{:.1e}", r.period_error),
                format!("{:.1e}", r.drift),
                format!("{:.1e}", r.reaction_error),
                format!("{:.0}", r.drift / r.tolerance),
            ]
        };
        blocks.push(Block::Table {
            header: header.map(str::to_owned).to_vec(),
            rows: motion.rungs.iter().map(row).collect(),
        });
    }
    blocks.push(Block::Heading("Pictures".to_owned()));
    for page in pages {
        blocks.push(Block::Figure {
            file: format!("{}/{}.png", scene.name, page.name),
            alt: page.title.clone(),
            caption: page.caption.clone(),
        });
    }
    Document {
        title: scene.title.clone(),
        blocks,
    }
}
