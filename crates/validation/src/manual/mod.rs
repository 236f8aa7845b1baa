//! The verification manual: for every key of the scene description, every command and every option the requirement, the cases,
//! the independent targets, and the planted faults that the checks detect.
//!
//! ```text
//! keys.toml, commands, options ── capabilities ─┐
//! cases ── findings ────────────────────────────┼── lines ── document ── manual.md, .html, .txt
//! reports/key-faults.txt ── key_faults ─────────┤
//! reports/mutations.txt ── committed_mutations ─┘
//! ```
//!
//! Developers' runs plant the faults, and the manual shows their committed texts: `just trials`, which plants one in each key of
//! a [`PlantedScene`], and `just mutations`.

mod capabilities;
mod committed_mutations;
mod document;
mod key_faults;
mod lines;
mod machine;
mod motion_claims;
mod planted;
mod rotor;

pub use capabilities::{Interface, undescribed};
pub use key_faults::{KeyFault, KeyFaults, PlantedFault};
pub use planted::{PlantedResult, PlantedScene};

use crate::cases::reference::Reference;
use crate::overview::ValidatedCase;
use committed_mutations::committed_mutations;
use document::{CaseEntry, Contents, counts, document, text};
use dwell_findings::Finding;
use dwell_scene::{PlaneScene, key_uses, scene_keys};
use dwell_study::Outcome;
use lines::{CaseFindings, Line, StudiedKey, command_lines, key_line};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// The folder of small scenes for capabilities without a case, within the folder of the cases.
const CAPABILITY_FOLDER: &str = "capabilities";
/// The folder of the committed texts of fault studies, next to that of the cases.
const REPORT_FOLDER: &str = "reports";
/// Number of checks that have to detect a fault.
pub const REQUIRED: usize = 2;

/// Every key with the scenes that use it and the result of a fault in it.
pub struct Manual {
    folder: PathBuf,
    /// The scenes as written.
    written: Vec<PlaneScene>,
    scenes: Vec<PlantedScene>,
    /// By scene: its findings, if it is not a case.
    findings: Vec<Vec<Finding>>,
    keys: Vec<StudiedKey>,
    /// Commit and date of the faults planted in them, if known.
    keys_made: Option<String>,
    /// Errors of scenes in the folder that cannot be read.
    unread: Vec<String>,
}

impl Manual {
    /// The keys used by the scenes of the cases and by the small scenes in their folder, with the committed faults in them.
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
            if is_case {
                Vec::new()
            } else {
                planted.findings()
            }
        });
        let faults = KeyFaults::read(&reports(folder));
        Self {
            folder: folder.to_owned(),
            findings: own.collect(),
            keys: studied_keys(&scenes, faults.as_ref()),
            keys_made: faults.map(|faults| faults.made),
            written,
            scenes,
            unread,
        }
    }

    /// The scenes of the cases and the small ones, in which faults can be planted.
    pub fn scenes(&self) -> &[PlantedScene] {
        &self.scenes
    }

    /// Sentences on keys without a case, and on keys with a fault that fewer than two checks detect.
    pub fn gaps(&self) -> Vec<String> {
        let cases = self.case_findings(&[]);
        let lines: Vec<Line> = self.keys.iter().map(|key| key_line(key, &cases)).collect();
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
    fn case_findings<'a>(&'a self, cases: &[ValidatedCase<'a>]) -> Vec<CaseFindings<'a>> {
        let each = self.scenes.iter().zip(&self.findings);
        each.map(|(planted, own)| {
            let name = planted.scene.name.as_str();
            let of_name = cases.iter().find(|case| case.name == name);
            let validated = of_name.and_then(|case| case.result.as_ref().ok());
            let findings = validated.map_or(&own[..], |done| &done.outcome.findings);
            CaseFindings { name, findings }
        })
        .collect()
    }

    /// `manual.md`, `manual.html` and `manual.txt`, from the validated cases, the findings at extreme parameters and the result of the
    /// independent reader, in words. Each failing capability is a failed finding.
    pub fn outcome(
        &self,
        validated: &[ValidatedCase<'_>],
        extremes: &[Finding],
        interface: &Interface,
        independent_reader: &str,
    ) -> Outcome {
        let cases = self.case_findings(validated);
        let (faults, texts) = committed_mutations(&reports(&self.folder));
        let mut lines: Vec<Line> = self.keys.iter().map(|key| key_line(key, &cases)).collect();
        lines.extend(command_lines(interface, &cases, extremes, &faults));
        let of_name = |name: &str| self.written.iter().find(|scene| scene.name == name);
        let entries: Vec<CaseEntry<'_>> = cases
            .iter()
            .filter_map(|case| Some((of_name(case.name)?, case)))
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
            keys_made: self.keys_made.as_deref(),
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

    /// The origin of the reference values of a scene.
    fn source(&self, scene: &PlaneScene) -> String {
        let reference = Reference::read(&self.folder.join(&scene.name), scene);
        match reference {
            Ok(reference) if !reference.source.is_empty() => reference.source,
            _ => "numbers chosen for this manual".to_owned(),
        }
    }
}

/// The folder of reports, next to that of the cases.
fn reports(folder: &Path) -> PathBuf {
    folder.join("..").join(REPORT_FOLDER)
}

/// All keys with a value, the scenes that use them, and the faults planted in them.
fn studied_keys(scenes: &[PlantedScene], faults: Option<&KeyFaults>) -> Vec<StudiedKey> {
    let uses: Vec<_> = scenes.iter().map(|s| key_uses(s.text())).collect();
    let valued = scene_keys().into_iter().filter(|key| !key.holds_keys);
    let studied = valued.map(|key| {
        let uses_it = |k: &usize| uses[*k].iter().any(|u| u.key == key.id);
        let mut planted = faults.into_iter().flat_map(|faults| &faults.faults);
        StudiedKey {
            scenes: (0..scenes.len()).filter(uses_it).collect(),
            are_faults_at_hand: faults.is_some(),
            fault: planted.find(|f| f.key == key.id).map(|f| f.fault.clone()),
            key,
        }
    });
    studied.collect()
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
    let entries = std::fs::read_dir(folder.join(CAPABILITY_FOLDER))
        .into_iter()
        .flatten();
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut scenes: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    scenes.sort();
    scenes
}
