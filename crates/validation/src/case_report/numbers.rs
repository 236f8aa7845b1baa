//! The numbers of a case's report: JSON and tables.

use crate::checked::analysis::{CaseAnalysis, ReducedAnalysis};
use crate::error::ValidationError;
use crate::report_parts::{self, NumberColumn};
use dwell_dynamics::Method;
use dwell_findings::all_pass;
use dwell_report::{FindingRecord, Number, Table, json};
use dwell_scene::PlaneScene;
use dwell_verify::{CheckedFreeMotion, ToleranceRun};
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
    states: usize,
    period_s: Option<Number>,
    energy_j: Option<Number>,
    calibration: Option<CalibrationValue<'a>>,
    convergence_slope: Option<Number>,
    findings: Vec<FindingRecord<'a>>,
    tolerance_series: Vec<ToleranceRunRow>,
}

#[derive(Serialize)]
struct CalibrationValue<'a> {
    path: &'a str,
    unit: &'a str,
    scene: Number,
    scene_period_s: Number,
    found: Number,
    target_period_s: Number,
}

#[derive(Serialize)]
struct ToleranceRunRow {
    method: &'static str,
    tolerance: Number,
    steps: usize,
    rejected: usize,
    evaluations: usize,
    jacobians: usize,
    seconds: Number,
    period_error: Number,
    energy_drift: Number,
    reaction_error: Number,
}

/// The JSON text. What only the reduced model has is null or empty for other cases.
pub(super) fn numbers(
    scene: &PlaneScene,
    analysis: &CaseAnalysis<'_>,
) -> Result<String, ValidationError> {
    let reduced = analysis.reduced.as_ref();
    let motion = reduced.and_then(|r| r.motion.as_ref());
    let calibration = reduced.and_then(|r| r.calibration.as_ref());
    let run = |r: &ToleranceRun| ToleranceRunRow {
        method: r.method.name(),
        tolerance: r.tolerance.into(),
        steps: r.statistics.steps,
        rejected: r.statistics.rejected_steps,
        evaluations: r.statistics.evaluations,
        jacobians: r.statistics.jacobians,
        seconds: r.wall_time.into(),
        period_error: r.period_error.into(),
        energy_drift: r.drift.into(),
        reaction_error: r.reaction_error.into(),
    };
    let runs = motion.iter().flat_map(|m| &m.tolerance_runs);
    Ok(json(&Numbers {
        title: &scene.title,
        note: &scene.note,
        version: env!("CARGO_PKG_VERSION"),
        scene: &scene.name,
        scene_sha256: scene.hash(),
        passed: all_pass(&analysis.findings),
        states: analysis.states.states.len(),
        period_s: motion.map(|m| m.orbit.period.into()),
        energy_j: motion.map(|m| m.orbit.energy.into()),
        calibration: calibration.map(|c| CalibrationValue {
            path: &c.path,
            unit: &c.unit,
            scene: c.current.into(),
            scene_period_s: c.current_period.into(),
            found: c.value.into(),
            target_period_s: c.period.into(),
        }),
        convergence_slope: motion.map(|m| m.drift_slope.into()),
        findings: analysis.findings.iter().map(FindingRecord).collect(),
        tolerance_series: runs.map(run).collect(),
    })?)
}

/// The tables of the reduced model, by file name.
pub(super) fn tables(reduced: &ReducedAnalysis<'_>) -> Vec<(&'static str, Table)> {
    let prepared = &reduced.prepared;
    let mut tables = vec![("reduced", reduced.curves.table(prepared))];
    let history = reduced.history.as_ref();
    tables.extend(history.map(|h| ("motion", h.table(prepared))));
    if let Some(motion) = &reduced.motion {
        let table = |method| tolerance_runs_table(motion, method);
        tables.push(("work-precision-bdf", table(Method::Bdf)));
        tables.push(("work-precision-tsit45", table(Method::Tsit45)));
    }
    tables
}

/// Cost and errors of one method over its tolerances.
fn tolerance_runs_table(motion: &CheckedFreeMotion, method: Method) -> Table {
    let columns: [NumberColumn<'_, &ToleranceRun>; 8] = [
        ("tolerance", "", |r| r.tolerance),
        ("steps", "", |r| r.statistics.steps as f64),
        ("evaluations", "", |r| r.statistics.evaluations as f64),
        ("jacobians", "", |r| r.statistics.jacobians as f64),
        ("wall_time", "s", |r| r.wall_time),
        ("period_error", "", |r| r.period_error),
        ("energy_drift", "", |r| r.drift),
        ("reaction_error", "", |r| r.reaction_error),
    ];
    let runs = motion.tolerance_runs.iter().filter(|r| r.method == method);
    report_parts::numbers(&columns, runs)
}
