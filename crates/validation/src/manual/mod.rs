//! The verification manual: what every key of the scene description, every command and every option is required to do, which cases
//! show it, what the results were compared with, and which faults planted in it the checks detect.
//!
//! ```text
//! keys.toml, commands, options ── capabilities ─┐
//! cases ── findings ────────────────────────────┼── lines ── document ── manual.md, .html, .txt
//! scenes ── altered ── planted ── key_study ────┤
//! reports/mutations.txt ── committed_mutations ────┘
//! ```
//!
//! A fault is planted in each key when the manual is made: [`KeyStudy`]. So a check that has become blind to a key fails here.

mod altered;
mod capabilities;
mod committed_mutations;
mod document;
mod key_study;
mod lines;
mod machine;
mod motion_claims;
mod planted;
mod rotor;

pub use capabilities::{Interface, undescribed};

use crate::cases::reference::Reference;
use crate::overview::CaseResult;
use committed_mutations::committed_mutations;
use document::{CaseEntry, Contents, counts, document, text};
use dwell_findings::Finding;
use dwell_scene::PlaneScene;
use dwell_study::Outcome;
use key_study::{KeyResult, study_keys};
use lines::{CaseFindings, Line, command_lines, key_lines};
use planted::PlantedScene;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// The folder of small scenes that show what no case does, in that of the cases.
const CAPABILITY_FOLDER: &str = "capabilities";
/// The folder of the committed texts of fault studies, beside that of the cases.
const REPORT_FOLDER: &str = "reports";

/// Every key with the scenes that use it and a fault planted in it.
pub struct KeyStudy {
    folder: PathBuf,
    /// As they are written.
    written: Vec<PlaneScene>,
    scenes: Vec<PlantedScene>,
    /// By scene: its findings, where it is not a case.
    findings: Vec<Vec<Finding>>,
    keys: Vec<KeyResult>,
    /// Why a scene of the folder cannot be read.
    unread: Vec<String>,
}

impl KeyStudy {
    /// Plants a fault in every key that the cases' scenes use, or the small scenes in their folder.
    pub fn new(cases: &[&PlaneScene], folder: &Path) -> Self {
        let mut written: Vec<PlaneScene> = cases.iter().map(|scene| (*scene).clone()).collect();
        let mut unread = Vec::new();
        for path in capability_scenes(folder) {
            match PlaneScene::read(&path) {
                Ok(scene) => written.push(scene),
                Err(error) => unread.push(format!("{}: {}", path.display(), error.message)),
            }
        }
        let planted = |scene: &PlaneScene| PlantedScene::new(scene, &folder.join(&scene.name));
        let scenes: Vec<PlantedScene> = written.iter().filter_map(planted).collect();
        let own = scenes.par_iter().map(|planted| {
            let is_case = cases.iter().any(|case| case.name == planted.scene.name);
            match is_case {
                true => Vec::new(),
                false => planted.findings(),
            }
        });
        Self {
            folder: folder.to_owned(),
            findings: own.collect(),
            keys: study_keys(&scenes),
            written,
            scenes,
            unread,
        }
    }

    /// What is missing of keys, in sentences: a key without a case, or a fault in one that fewer than two checks detect.
    pub fn gaps(&self) -> Vec<String> {
        let cases = self.case_findings(&[]);
        let lines = key_lines(&self.keys, &cases);
        let missing = missing(&lines);
        let own = self.scenes.iter().zip(&self.findings);
        let own =
            own.flat_map(|(planted, findings)| findings.iter().map(|f| (&planted.scene.name, f)));
        let wrong = own.filter(|(_, f)| !f.pass).map(|(name, f)| {
            let (apart, tolerance) = (f.relative_difference, f.tolerance);
            format!("{name}: {} is {apart:.1e}, above {tolerance:.1e}", f.key)
        });
        let unread = self.unread.iter().cloned();
        missing.chain(wrong).chain(unread).collect()
    }

    /// The findings of each scene: those of its case, or its own.
    fn case_findings<'a>(&'a self, results: &[CaseResult<'a>]) -> Vec<CaseFindings<'a>> {
        let each = self.scenes.iter().zip(&self.findings);
        each.map(|(planted, own)| {
            let name = planted.scene.name.as_str();
            let mut done = results
                .iter()
                .filter_map(|(_, result)| result.as_ref().ok());
            let validated = done.find(|(scene, _)| scene.name == name);
            let findings = validated.map_or(&own[..], |(_, done)| &done.outcome.findings);
            CaseFindings { name, findings }
        })
        .collect()
    }

    /// `manual.md`, `manual.html` and `manual.txt`, from the validated cases, the findings at extreme parameters and what the independent
    /// reader says, in words. Each capability that fails is a failed finding.
    pub fn manual(
        &self,
        results: &[CaseResult<'_>],
        extremes: &[Finding],
        interface: &Interface,
        independent_reader: &str,
    ) -> Outcome {
        let cases = self.case_findings(results);
        let reports = self.folder.join("..").join(REPORT_FOLDER);
        let (faults, texts) = committed_mutations(&reports);
        let mut lines = key_lines(&self.keys, &cases);
        lines.extend(command_lines(interface, &cases, extremes, &faults));
        let of_name = |name: &str| self.written.iter().find(|scene| scene.name == name);
        let entries = cases
            .iter()
            .filter_map(|case| Some((of_name(case.name)?, case)));
        let entries: Vec<CaseEntry<'_>> = entries
            .map(|(scene, case)| CaseEntry {
                name: case.name,
                title: &scene.title,
                hash: scene.hash(),
                source: self.source(scene),
                findings: case.findings,
            })
            .collect();
        let contents = Contents {
            folder: &self.folder,
            lines: &lines,
            cases: &entries,
            extremes,
            fault_texts: (&texts, faults.len()),
            independent_reader,
        };
        let document = document(&contents);
        let mut outcome = Outcome::default();
        outcome.files.add_document("manual", &document);
        outcome.files.add("manual.txt", text(&lines, &entries));
        let [passed, failed, exempt] = counts(&lines);
        outcome.record.add_count("passed", passed);
        outcome.record.add_count("required", passed + failed);
        outcome.summary = format!(
            "verification manual: {passed} capabilities pass, {failed} fail, {exempt} are exempt (manual.md, manual.html)\n"
        );
        let failed = missing(&lines).chain(self.unread.iter().cloned());
        let own = self.findings.iter().flatten().cloned();
        outcome.findings = failed.map(failed_finding).chain(own).collect();
        outcome
    }

    /// Where the reference values of a scene come from.
    fn source(&self, scene: &PlaneScene) -> String {
        let reference = Reference::read(&self.folder.join(&scene.name), scene);
        match reference {
            Ok(reference) if !reference.source.is_empty() => reference.source,
            _ => "numbers chosen for this manual".to_owned(),
        }
    }
}

/// A sentence for each capability that fails.
fn missing(lines: &[Line]) -> impl Iterator<Item = String> {
    let missing = |line: &Line| {
        Some(format!(
            "{} {}: {}",
            line.section,
            line.item,
            line.failure()?
        ))
    };
    lines.iter().filter_map(missing)
}

fn failed_finding(why: String) -> Finding {
    Finding {
        key: "manual".to_owned(),
        comparison: "a capability with what the verification manual requires".to_owned(),
        worst_at: why,
        ..Finding::default()
    }
}

/// The small scenes in the folder of the cases, by name.
pub fn capability_scenes(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder.join(CAPABILITY_FOLDER));
    let entries = entries.into_iter().flatten();
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut scenes: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    scenes.sort();
    scenes
}
