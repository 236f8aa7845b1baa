//! The page of a case: the mechanism in motion with its forces, and every finding.

use super::validate::summary;
use crate::checked::analysis::CaseAnalysis;
use dwell_page::{FileLink, Page};
use dwell_report::Figure;
use dwell_scene::PlaneScene;
use dwell_study::page::scene_page;
use dwell_study::{
    Analysis, MotionSolver, SolverSettings, StudyError, free_motion_page, no_progress,
    trajectory_page,
};

/// The page, as HTML. Its rows are those of the free motion of the scene, or else of its prescribed motion or its sweep.
///
/// # Errors
/// [`StudyError::Page`] where it cannot be made.
pub(super) fn page(
    scene: &PlaneScene,
    analysis: &CaseAnalysis<'_>,
    figures: &[Figure],
    tables: &[String],
) -> Result<String, StudyError> {
    let name = &scene.name;
    let link = |path: String, title: &str| FileLink {
        path,
        title: title.to_owned(),
    };
    let pictures = figures
        .iter()
        .map(|figure| link(format!("{name}/{}.png", figure.name), &figure.title));
    let tables = tables.iter().map(|path| link(path.clone(), path));
    let report = [
        ("index.html", "all cases"),
        (&format!("{name}.md"), "the report of the case"),
        (&format!("{name}.json"), "its numbers"),
        (
            &format!("{name}.txt"),
            "the values that every machine reproduces",
        ),
    ]
    .map(|(path, title)| link(path.to_owned(), title));
    let page = Page {
        command: "validate".to_owned(),
        findings: analysis.findings.clone(),
        printed: summary(scene, analysis),
        files: report.into_iter().chain(pictures).chain(tables).collect(),
        ..rows(scene)
    };
    Ok(page.html()?)
}

/// The rows of the case. Where none can be computed its findings say why.
fn rows(scene: &PlaneScene) -> Page {
    let settings = MotionSolver::Settings(SolverSettings::default());
    if scene.motion.is_some()
        && let Ok((page, _)) = free_motion_page(scene, &settings, &no_progress)
    {
        return page;
    }
    for analysis in [Analysis::Kinetostatics, Analysis::Kinematics] {
        if let Ok((page, _)) = trajectory_page(scene, analysis, None, &no_progress) {
            return page;
        }
    }
    scene_page(scene, "validate")
}
