//! `dwell validate`: checks a case and makes its report.

use super::document::{findings_sentence, introduction, remarks};
use super::dwell::Dwell;
use super::family::Family;
use super::figures;
use super::numbers::{numbers, tables};
use super::page;
use super::report::CaseReport;
use super::snapshot::values;
use crate::cases::reference::{Reference, SourceKinds};
use crate::checked::analysis::{CaseAnalysis, ReducedAnalysis, analyse};
use crate::error::ValidationError;
use crate::report_parts::findings_text;
use dwell_findings::{Check, Finding};
use dwell_report::{Figure, Files, TableExport as _};
use dwell_scene::PlaneScene;
use dwell_study::{Outcome, Progress, Step, reduce};
use std::path::Path;

/// Steps of the progress bar for one case: three of the analysis and two of the report.
const PROGRESS_STEPS: usize = 5;

/// A validated case.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Validation {
    /// Summary, files and findings.
    pub outcome: Outcome,
    /// Values to the digits that every machine reproduces, and which findings pass.
    pub snapshot: String,
    /// The checks without findings, and in a few words why.
    pub not_applicable: Vec<(Check, &'static str)>,
    /// What the independent reader found of its files, if it ran.
    pub audited: Vec<Finding>,
    /// Who made the reference values, by table.
    pub(crate) source_kinds: SourceKinds,
}

impl Validation {
    /// All findings, also those of the independent reader.
    pub(crate) fn findings(&self) -> impl Iterator<Item = &Finding> + Clone {
        self.outcome.findings.iter().chain(&self.audited)
    }
}

/// Validates a case in the plane: as [`validate`](crate::validate()).
pub(crate) fn validate_in_plane(
    scene: &PlaneScene,
    folder: &Path,
    program: Option<&Path>,
    progress: Progress<'_>,
) -> Result<Validation, ValidationError> {
    let total = PROGRESS_STEPS;
    let done = |what: &str| progress(Step { total, done: what });
    let reference = Reference::read(folder, scene)?;
    let analysis = analyse(scene, &reference, program, &done)?;
    let family = Family::read(folder, scene)?;
    let (figures, dwell) = case_figures(scene, &analysis, family.as_ref())?;
    let mut files = Files::new();
    let name = &scene.name;
    done("figures");
    for (file, table) in analysis.reduced.iter().flat_map(tables) {
        files.add(format!("{name}/{file}.csv"), table.csv()?);
    }
    let tables: Vec<String> = files
        .paths()
        .map(|path| path.display().to_string())
        .collect();
    let html = page::page(scene, &analysis, &figures, &tables)?;
    let (dwell, family) = (dwell.as_ref(), family.as_ref());
    let report = CaseReport {
        findings: analysis.findings.clone(),
        about: findings_sentence(&reference, &analysis),
        introduction: introduction(scene, &reference, &analysis, dwell, family),
        remarks: remarks(&analysis),
        values: values(scene, &analysis),
        figures,
    };
    files.add(format!("{name}.json"), numbers(scene, &analysis)?);
    files.add(format!("{name}.md"), report.document(scene).markdown());
    files.add(format!("{name}.html"), html);
    done("report");
    let mut validation = report.validation(scene, files);
    validation.source_kinds = reference.kinds;
    validation.outcome.summary = summary(scene, &analysis);
    let motion = analysis.reduced.as_ref().and_then(|r| r.motion.as_ref());
    if let Some(motion) = motion {
        let record = &mut validation.outcome.record;
        record.add("period", "s", motion.orbit.period);
    }
    validation.not_applicable = analysis.not_applicable;
    Ok(validation)
}

/// How many findings pass, those that fail, and the period.
pub(super) fn summary(scene: &PlaneScene, analysis: &CaseAnalysis<'_>) -> String {
    let mut text = findings_text(&scene.name, &analysis.findings, "");
    let Some(reduced) = &analysis.reduced else {
        return text;
    };
    if let Some(motion) = &reduced.motion {
        text += &format!("  period {:.12} s by quadrature\n", motion.orbit.period);
    }
    if let Some(c) = &reduced.calibration {
        text += &format!(
            "  {} = {:.12} {} gives a period of {} s; the scene has {}\n",
            c.path, c.value, c.unit, c.period, c.current
        );
    }
    text
}

/// All figures, and the dwell that the drawing of the mechanism shows.
fn case_figures(
    scene: &PlaneScene,
    analysis: &CaseAnalysis<'_>,
    family: Option<&Family>,
) -> Result<(Vec<Figure>, Option<Dwell>), ValidationError> {
    let states = &analysis.states;
    let (mut figures, dwell) = match &analysis.reduced {
        Some(reduced) => reduced_figures(reduced, family)?,
        None => {
            let mut figures = vec![
                figures::states_drawing(scene, states),
                figures::actuator_forces(scene, states),
            ];
            let free_motion = analysis.free_motion.as_ref();
            figures.extend(free_motion.map(|run| figures::energies(scene, run)));
            (figures, None)
        }
    };
    figures.push(figures::margins(scene, &analysis.findings));
    figures.push(figures::rounding(scene, states, &analysis.rounding));
    Ok((figures, dwell))
}

fn reduced_figures(
    reduced: &ReducedAnalysis<'_>,
    family: Option<&Family>,
) -> Result<(Vec<Figure>, Option<Dwell>), ValidationError> {
    let prepared = &reduced.prepared;
    let (drawing, dwell) = figures::mechanism(prepared)?;
    let (curves, is_rounding) = (&reduced.curves, &reduced.curves.rounding(prepared));
    let mut figures = vec![
        drawing,
        reduce::figures::reduced(prepared, curves, is_rounding),
    ];
    // The caption of the last one says which reactions are left out.
    figures.extend(reduce::figures::coefficients(prepared, curves, is_rounding).0);
    let (history, motion) = (reduced.history.as_ref(), reduced.motion.as_ref());
    figures.extend(history.map(|history| figures::history(prepared, history)));
    figures.extend(motion.map(|motion| figures::drift(prepared, motion)));
    figures.extend(family.map(|family| figures::family(prepared, family)));
    if !reduced.error_curves.is_empty() {
        figures.push(figures::finite_differences(prepared, &reduced.error_curves));
    }
    figures.extend(motion.map(|motion| figures::work_precision(prepared, motion)));
    Ok((figures, dwell))
}
