//! What a validated case is written as: tables, numbers, a document, and the rounded text.

use crate::error::StudyError;
use crate::prepare::Prepared;
use crate::provenance::origin;
use crate::reference::Reference;
use crate::validate::Evidence;
use dwell_dynamics::Method;
use dwell_findings::{Finding, all_pass};
use dwell_kinetostatics::Reduced;
use dwell_report::{Block, Column, Document, Figure, Table, json};
use dwell_scene::Scene;
use dwell_verify::{FreeMotion, Rung};
use serde::Serialize;

/// The numbers of the report, as JSON.
#[derive(Serialize)]
struct Numbers<'a> {
    title: &'a str,
    note: &'a Option<String>,
    version: &'static str,
    scene: &'a str,
    scene_sha256: String,
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

pub(crate) fn tables(prepared: &Prepared<'_>, evidence: &Evidence) -> Vec<(&'static str, Table)> {
    let mut tables = vec![("reduced", evidence.sweep.table(prepared))];
    if let Some(history) = &evidence.history {
        tables.push(("motion", history.table(prepared)));
    }
    if let Some(motion) = &evidence.motion {
        tables.push(("cost-bdf", cost(motion, Method::Bdf)));
        tables.push(("cost-tsit45", cost(motion, Method::Tsit45)));
    }
    tables
}

/// Work and errors of one method over the ladder of tolerances.
fn cost(motion: &FreeMotion, method: Method) -> Table {
    let columns = [
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
    let rungs = motion.rungs.iter().filter(|r| r.method == method);
    Table {
        columns: columns.map(|(n, u)| Column::new(n, u)).to_vec(),
        rows: rungs.map(row).collect(),
    }
}

pub(crate) fn numbers(scene: &Scene, evidence: &Evidence) -> Result<String, StudyError> {
    let motion = evidence.motion.as_ref();
    Ok(json(&Numbers {
        title: &scene.title,
        note: &scene.note,
        version: env!("CARGO_PKG_VERSION"),
        scene: &scene.name,
        scene_sha256: scene.hash(),
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
pub(crate) fn snapshot(prepared: &Prepared<'_>, evidence: &Evidence) -> String {
    let scene = prepared.scene;
    let mut text = format!("{}\n\n", scene.title);
    let (from, to) = match prepared.model.range().limits() {
        None => (0.0, std::f64::consts::TAU),
        Some((from, to)) => (from, to),
    };
    let mut at = prepared.model.model().coefficients();
    let mut work = prepared.model.work();
    for k in 0..8 {
        // Inside the range: next to its ends a machine's own rounding would show.
        let q = from + (to - from) * (f64::from(k) + 0.5) / 8.0;
        if prepared.model.coefficients(q, &mut work, &mut at).is_err() {
            continue;
        }
        text += &format!(
            "q = {}  m = {}  half_dm = {}\n",
            rounded(q),
            rounded(at.m),
            rounded(at.half_dm)
        );
        for ((name, _), (a, b)) in prepared.reactions().iter().zip(at.a.iter().zip(&at.b)) {
            text += &format!("    {name}  a = {}  b = {}\n", rounded(*a), rounded(*b));
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
    // Differences are a machine's own rounding: only the verdicts are everybody's.
    for f in &evidence.findings {
        let verdict = if f.pass { "pass" } else { "FAIL" };
        text += &format!("{verdict}  {}  [{}]\n", f.key, f.truth);
    }
    text
}

/// Seven decimals, without a sign on zero.
fn rounded(value: f64) -> String {
    let text = format!("{value:.7}");
    match text.strip_prefix('-') {
        Some(digits) if digits.trim_matches(['0', '.']).is_empty() => digits.to_owned(),
        _ => text,
    }
}

/// To seven digits after the first of the largest there is, without a sign on zero.
pub(crate) fn rounded_to(value: f64, largest: f64) -> String {
    let decimals = if largest > 0.0 && largest.is_finite() {
        7.0 - largest.log10().floor()
    } else {
        7.0
    };
    let decimals = decimals.clamp(0.0, 30.0) as usize;
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.trim_matches(['0', '.']).is_empty() => digits.to_owned(),
        _ => text,
    }
}

/// How many findings pass, and those that do not.
pub(crate) fn verdicts(scene: &Scene, findings: &[Finding]) -> String {
    let failed: Vec<&Finding> = findings.iter().filter(|f| !f.pass).collect();
    let mut text = format!(
        "{}: {} of {} findings pass\n",
        scene.name,
        findings.len() - failed.len(),
        findings.len()
    );
    for f in failed {
        text += &format!(
            "  FAIL {} ({}): {}; relative {:.1e}, tolerance {:.1e}, worst at {}\n",
            f.key, f.truth, f.compared, f.relative, f.tolerance, f.worst
        );
    }
    text
}

pub(crate) fn summary(scene: &Scene, evidence: &Evidence) -> String {
    let mut text = verdicts(scene, &evidence.findings);
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

pub(crate) fn document(
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
        "{passed} of {} findings pass.",
        evidence.findings.len()
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
    illustrated(scene, pages, blocks)
}

/// A document of these blocks with the pictures behind them, and where it comes from.
pub(crate) fn illustrated(scene: &Scene, pages: &[Figure], mut blocks: Vec<Block>) -> Document {
    blocks.push(Block::Heading("Pictures".to_owned()));
    blocks.extend(pages.iter().map(|page| Block::Figure {
        file: format!("{}/{}.png", scene.name, page.name),
        alt: page.title.clone(),
        caption: page.caption.clone(),
    }));
    blocks.push(Block::Text(origin(scene)));
    Document {
        title: scene.title.clone(),
        blocks,
    }
}
