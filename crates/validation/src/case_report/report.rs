//! What is reported of a case, in the plane or in space.

use super::snapshot::verdicts;
use super::validate::Validation;
use crate::report_parts::{figure_blocks, findings_text, result_line};
use dwell_findings::Finding;
use dwell_report::{Block, Document, Figure, Files};
use dwell_scene::SceneFile;
use dwell_study::Outcome;
use dwell_study::output::{Picture, provenance_line};

/// What is reported of a case.
#[derive(Debug, Default)]
pub(crate) struct CaseReport {
    pub(crate) findings: Vec<Finding>,
    /// What follows the number of findings that pass.
    pub(crate) about: String,
    /// What precedes the findings.
    pub(crate) introduction: Vec<Block>,
    /// What follows them.
    pub(crate) remarks: Vec<Block>,
    /// Values to the digits that every machine reproduces.
    pub(crate) values: String,
    pub(crate) figures: Vec<Figure>,
}

impl CaseReport {
    /// The document with its figures.
    pub(crate) fn document(&self, scene: &SceneFile) -> Document {
        let heading = |text: &str| Block::Heading(text.to_owned());
        let verdict = format!("{}{}", result_line(&self.findings), self.about);
        let mut blocks = vec![Block::Text(verdict)];
        blocks.extend(self.introduction.clone());
        blocks.push(heading("Findings"));
        blocks.push(Block::Findings(self.findings.clone()));
        blocks.extend(self.remarks.clone());
        blocks.push(heading("Figures"));
        blocks.extend(figure_blocks(&scene.name, &self.figures, true));
        blocks.push(Block::Text(provenance_line(scene)));
        Document {
            title: scene.title.clone(),
            blocks,
        }
    }

    /// The validated case with its files, to which the snapshot is added.
    pub(crate) fn validation(self, scene: &SceneFile, mut files: Files) -> Validation {
        let name = &scene.name;
        let verdicts = verdicts(&self.findings);
        let snapshot = format!("{}\n\n{}\n{verdicts}", scene.title, self.values);
        files.add(format!("{name}.txt"), snapshot.clone());
        let picture = |figure: Figure| {
            let path = format!("{name}/{}.png", figure.name);
            Picture::figure(scene, path, true, figure)
        };
        Validation {
            outcome: Outcome {
                summary: findings_text(name, &self.findings, ""),
                files,
                findings: self.findings,
                pictures: self.figures.into_iter().map(picture).collect(),
                ..Outcome::default()
            },
            snapshot,
            ..Validation::default()
        }
    }
}
