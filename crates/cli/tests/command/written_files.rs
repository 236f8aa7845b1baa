//! `validate` runs the program itself on a case, and judges what it writes.

use crate::test_dir::{TestDir, home};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;

#[test]
fn validate_judges_what_the_program_writes_by_other_runs_and_its_sentences() {
    let dir = TestDir::new();
    let case = home().join("validation/pendulum-a01");
    let run = dir.run(&["validate", case.to_str().unwrap()]);
    let no_audit = "independent reader: not run (validation/audit/case.py is not found)\n";
    assert_eq!(
        (run.status, run.err.as_str()),
        (Some(0), no_audit),
        "{}",
        run.out
    );
    let numbers = fs::read_to_string(dir.0.join("reports/pendulum-a01.json")).unwrap();
    let numbers: Value = serde_json::from_str(&numbers).unwrap();
    let findings = numbers["findings"].as_array().unwrap();
    let text = |finding: &Value, key: &str| finding[key].as_str().unwrap().to_owned();
    let mut of_files = findings.to_vec();
    of_files.retain(|finding| text(finding, "key").starts_with("written-"));
    let checks: BTreeSet<String> = of_files.iter().map(|f| text(f, "check")).collect();
    assert_eq!(checks.len(), 5, "{checks:?}");
    assert!(
        of_files.len() >= 15 && of_files.iter().all(|f| f["pass"] == true),
        "{of_files:?}"
    );
    // The page of the case shows them.
    let page = fs::read_to_string(dir.0.join("reports/pendulum-a01.md")).unwrap();
    assert!(page.contains("| pass | 14 written forces |"), "{page}");
}
