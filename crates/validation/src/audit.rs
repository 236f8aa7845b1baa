//! The independent reader of what the commands write, `validation/audit`: a program in Python that shares nothing with this one. It runs
//! where Python with NumPy is found.

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
/// The oldest Python that has a reader of TOML, and what the reader needs besides.
const NEEDS: &str = "import tomllib, numpy";

const TEXT: &str = "The files that the commands write of each case, judged by `validation/audit`: a program in Python with a reader of \
                    scenes, laws and units of its own, which shares nothing with Dwell. Of each check the file is listed that is nearest to its \
                    tolerance.";

/// Why the independent reader does not run, in words.
pub type NotRun = String;

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
) -> Result<Outcome, NotRun> {
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
    let judged: Vec<Result<Value, String>> = scenes.par_iter().map(judged).collect();
    Ok(report(scenes, &judged))
}

/// What the reader printed as data; why it is none.
fn read(printed: &[u8], messages: &[u8]) -> Result<Value, String> {
    serde_json::from_slice(printed).map_err(|_| {
        let messages = String::from_utf8_lossy(messages);
        let last = messages.lines().last().unwrap_or("it printed nothing");
        last.to_owned()
    })
}

/// The report `audit.md`: of each check the file that is nearest to its tolerance.
fn report(scenes: &[PathBuf], judged: &[Result<Value, String>]) -> Outcome {
    let mut worst: BTreeMap<String, Finding> = BTreeMap::new();
    let (mut count, mut not_judged) = (0, Vec::new());
    for (scene, judged) in scenes.iter().zip(judged) {
        let name = scene_name(scene);
        let failed = |reason: &str| Finding {
            worst_at: format!("{name}: {reason}"),
            pass: false,
            ..Finding::new("audit", Check::WrittenTwice, [f64::NAN; 2], 0.0)
        };
        let judged = match judged {
            Ok(judged) => judged,
            Err(reason) => {
                worst.insert(name.clone(), failed(reason));
                continue;
            }
        };
        let list = |key: &str| judged[key].as_array().cloned().unwrap_or_default();
        for error in list("errors") {
            let reason = error.as_str().unwrap_or_default();
            worst.insert(format!("{name}: {reason}"), failed(reason));
        }
        for skipped in list("not_judged") {
            not_judged.push(format!("{name}: {}", skipped.as_str().unwrap_or_default()));
        }
        for check in list("checks") {
            count += 1;
            let finding = finding(&name, &check);
            let known = worst
                .remove(&finding.key)
                .unwrap_or_else(|| finding.clone());
            let worse = nearest([&known, &finding].into_iter()).cloned();
            worst.insert(finding.key.clone(), worse.unwrap_or(known));
        }
    }
    let findings: Vec<Finding> = worst.into_values().collect();
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
    let judged = format!(", {count} checks of the files of {} cases", scenes.len());
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
