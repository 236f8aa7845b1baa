//! The independent reader of the written files, `validation/audit`: a program in Python that shares nothing with this one. It runs if
//! Python with NumPy is found.

use crate::report_parts::{findings_text, nearest, result_line};
use dwell_findings::{Check, Finding};
use dwell_report::{Block, Document};
use dwell_study::Outcome;
use rayon::prelude::*;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The name of the study and of its report.
pub const NAME: &str = "audit";
/// The modules that the reader needs; `tomllib` requires Python 3.11.
const NEEDS: &str = "import tomllib, numpy";

const TEXT: &str = "The files that the commands write of each case, judged by `validation/audit`: a program in Python with a reader of \
                    scenes, laws and units of its own, which shares nothing with Dwell. Of each check the file is listed that is nearest to its \
                    tolerance.";

/// Why the independent reader does not run, in words.
pub type NotRun = String;

/// The results of the independent reader.
pub struct Audited {
    /// The report `audit.md`, with the findings of all scenes.
    pub outcome: Outcome,
    /// By scene: its findings, of each check the file that is nearest to its tolerance.
    pub by_scene: Vec<Vec<Finding>>,
}

/// The judgement of the independent reader, whose program is in a folder, on the files that the commands of this program write of some
/// scenes; `done` is called after each.
///
/// # Errors
/// [`NotRun`] where Python 3.11 with NumPy, or the reader, is not found.
pub fn study(
    reader: &Path,
    program: &Path,
    scenes: &[PathBuf],
    done: &(dyn Fn(&str) + Sync),
) -> Result<Audited, NotRun> {
    let case = reader.join("case.py");
    if !case.is_file() {
        return Err(format!("{} is not found", case.display()));
    }
    let python = ["python3", "python"].into_iter().find(|python| {
        let found = Command::new(python).args(["-c", NEEDS]).output();
        found.is_ok_and(|found| found.status.success())
    });
    let python = python.ok_or("Python 3.11 with NumPy is not found")?;
    let judged = |scene: &PathBuf| {
        let command = |python| {
            let mut command = Command::new(python);
            command.arg(&case).arg(program).arg(scene);
            command
        };
        let output = command(python).output().map_err(|error| error.to_string());
        done(&scene_name(scene));
        output.and_then(|output| read(&output.stdout, &output.stderr))
    };
    let judged: Vec<Judged> = scenes
        .par_iter()
        .map(|scene| Judged::new(&scene_name(scene), judged(scene)))
        .collect();
    Ok(Audited {
        outcome: report(&judged),
        by_scene: judged.into_iter().map(|judged| judged.findings).collect(),
    })
}

/// The printed text of the reader as data; otherwise the reason.
fn read(printed: &[u8], messages: &[u8]) -> Result<Value, String> {
    serde_json::from_slice(printed).map_err(|_| {
        let messages = String::from_utf8_lossy(messages);
        let last = messages.lines().last().unwrap_or("it printed nothing");
        last.to_owned()
    })
}

/// The findings on a scene.
struct Judged {
    findings: Vec<Finding>,
    count: usize,
    not_judged: Vec<String>,
}

impl Judged {
    /// For each check, the file that is nearest to its tolerance; unreadable results fail.
    fn new(name: &str, judged: Result<Value, String>) -> Self {
        let (judged, mut errors) = match judged {
            Ok(judged) => (judged, Vec::new()),
            Err(reason) => (Value::Null, vec![reason]),
        };
        let list = |key: &str| judged[key].as_array().cloned().unwrap_or_default();
        let words = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        errors.extend(list("errors").iter().map(words));
        let failed = |reason: String| Finding {
            worst_at: format!("{name}: {reason}"),
            pass: false,
            ..Finding::new(NAME, Check::WrittenTwice, [f64::NAN; 2], 0.0)
        };
        let checks = list("checks");
        let all = checks.iter().map(|check| finding(name, check));
        let mut findings = worst_of(all);
        findings.extend(errors.into_iter().map(failed));
        let not_judged = list("not_judged");
        let not_judged = not_judged
            .iter()
            .map(|why| format!("{name}: {}", words(why)));
        Self {
            findings,
            count: checks.len(),
            not_judged: not_judged.collect(),
        }
    }
}

/// The finding of each key that is nearest to its tolerance.
fn worst_of(all: impl Iterator<Item = Finding>) -> Vec<Finding> {
    let mut worst: BTreeMap<String, Finding> = BTreeMap::new();
    for finding in all {
        let known = worst
            .remove(&finding.key)
            .unwrap_or_else(|| finding.clone());
        let worse = nearest([&known, &finding].into_iter()).cloned();
        worst.insert(finding.key.clone(), worse.unwrap_or(known));
    }
    worst.into_values().collect()
}

/// The report `audit.md`: of each check the file that is nearest to its tolerance.
fn report(judged: &[Judged]) -> Outcome {
    let all = judged.iter().flat_map(|judged| &judged.findings);
    let (read, unread): (Vec<&Finding>, Vec<&Finding>) = all.partition(|f| f.key != NAME);
    let mut findings = worst_of(read.into_iter().cloned());
    findings.extend(unread.into_iter().cloned());
    let count: usize = judged.iter().map(|judged| judged.count).sum();
    let not_judged: Vec<String> = judged
        .iter()
        .flat_map(|judged| judged.not_judged.clone())
        .collect();
    let mut blocks = vec![
        Block::Text(result_line(&findings)),
        Block::Text(TEXT.to_owned()),
        Block::Heading("Findings".to_owned()),
        Block::Findings(findings.clone()),
    ];
    if !not_judged.is_empty() {
        blocks.push(Block::Heading("Not judged".to_owned()));
        blocks.push(Block::Text(not_judged.join("; ") + "."));
    }
    // Without a rounded text: whether there is a Python decides whether there is this report.
    let mut outcome = Outcome::default();
    let title = "Independent reader".to_owned();
    outcome
        .files
        .add_document(NAME, &Document { title, blocks });
    let judged = format!(", {count} checks of the files of {} scenes", judged.len());
    outcome.summary = findings_text(NAME, &findings, &judged);
    outcome.findings = findings;
    outcome
}

/// The name of a case: of its file, or of its folder.
fn scene_name(scene: &Path) -> String {
    let stem = scene.file_stem().unwrap_or_default();
    let folder = scene.parent().and_then(Path::file_name);
    let name = match folder {
        Some(folder) if stem == "scene" => folder,
        _ => stem,
    };
    name.to_string_lossy().into_owned()
}

/// A check of the reader.
fn finding(case: &str, check: &Value) -> Finding {
    let text = |key: &str| check[key].as_str().unwrap_or_default().to_owned();
    let value = |key: &str| check[key].as_f64().unwrap_or(f64::NAN);
    let numbers = ["difference", "relative_difference"].map(value);
    let number = check["number"].as_u64().unwrap_or(0) as usize;
    let of = Check::ALL
        .get(number)
        .copied()
        .unwrap_or(Check::WrittenTwice);
    let key = format!("{NAME}-{}", text("check"));
    Finding {
        comparison: text("comparison"),
        domain: "all cases".to_owned(),
        unit: text("unit"),
        scale: text("scale"),
        worst_at: format!("{case}, {}: {}", text("file"), text("worst_at")),
        tolerance_reason: text("tolerance_reason"),
        pass: check["pass"].as_bool().unwrap_or(false),
        ..Finding::new(&key, of, numbers, value("tolerance"))
    }
}
