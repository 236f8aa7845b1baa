//! The study in words: a rounded text that every machine reproduces, and a page with all details.

use super::detection::{CHECKS, Detection};
use super::operations::{MutationOutcome, MutationResult};
use super::source::SourceFiles;
use super::study::Study;
use super::tallies::Tally;
use dwell_findings::Check;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// `mutations.txt`: which checks detect what. Digits and counts are left out: they are not the same everywhere, and
/// each new line of the product changes them.
pub fn text(study: &Study, functions: &BTreeMap<String, Tally>) -> String {
    let mut out = format!("{}\n{HEAD}", study.title);
    let _ = writeln!(out, "{:<58}  {:<18} checks", "fault", "on");
    let _ = writeln!(
        out,
        "{:<58}  {:<18} [{}]",
        "no fault",
        "all of them",
        study.without_mutation.check_numbers()
    );
    for group in &study.groups {
        let _ = writeln!(out, "\n{}", group.title);
        for row in &group.rows {
            let _ = writeln!(
                out,
                "  {:<56}  {:<18} {}",
                row.description,
                row.mechanism,
                row.detection.check_numbers()
            );
        }
    }
    let _ = writeln!(
        out,
        "\nEvery sign, term and factor, by function: the fewest checks that detect a fault that changes a result"
    );
    for (function, tally) in functions {
        let min_checks = tally.min_checks.map_or("-".to_owned(), |n| n.to_string());
        let _ = writeln!(out, "  {function:<36} {min_checks:>3}");
    }
    if !study.exceptions.is_empty() {
        let _ = writeln!(out, "\nWhere one check is enough, and why");
    }
    for (file, why) in study.exceptions {
        let _ = writeln!(out, "  {file}: {why}");
    }
    out
}

const HEAD: &str = "A check is named by its number; in brackets where it exceeds its tolerance by less than three digits.\n\n";

/// How many faults, and how many checks.
pub fn summary(study: &Study) -> String {
    let named: usize = study.groups.iter().map(|c| c.rows.len()).sum();
    let checked = study.operation_results.iter().filter_map(detection);
    let min_checks = checked
        .clone()
        .map(Detection::check_count)
        .min()
        .unwrap_or(0);
    let of_named = study
        .groups
        .iter()
        .flat_map(|c| &c.rows)
        .map(|r| r.detection.check_count());
    format!(
        "{named} named faults, each detected by at least {} independent checks.\n\
         {} faults of single operations: {} change a result, each detected by at least {min_checks};\n\
         {} change none, {} end in an error.",
        of_named.min().unwrap_or(0),
        study.operation_results.len(),
        checked.count(),
        study
            .operation_results
            .iter()
            .filter(|s| s.outcome == MutationOutcome::Unchanged)
            .count(),
        study
            .operation_results
            .iter()
            .filter(|s| s.outcome == MutationOutcome::NoResult)
            .count(),
    )
}

fn detection(result: &MutationResult) -> Option<&Detection> {
    match &result.outcome {
        MutationOutcome::Checked(detection, _) => Some(detection),
        _ => None,
    }
}

/// `mutations.md`.
// Long: one document.
pub fn markdown(
    study: &Study,
    functions: &BTreeMap<String, Tally>,
    source: &SourceFiles,
) -> String {
    let mut out = format!(
        "# {}\n\n![Faults and checks]({}.png)\n\nA fault is a wrapper around what is checked; production \
         code holds none. A cell is the digits by which the difference exceeds the tolerance of the check; 0: the check \
         applies and does not detect the fault; empty: it does not apply. Every fault is shown on the mechanism where the fewest checks detect it.\n\n",
        study.title, study.name
    );
    let _ = writeln!(out, "{}\n", summary(study));
    for gap in study.gaps() {
        let _ = writeln!(out, "- **{gap}**");
    }
    for (file, why) in study.exceptions {
        let excepted = study.operation_results.iter().filter(|result| {
            result.undetected()
                && study.is_exception(result)
                && result.operation.file.ends_with(file)
        });
        let _ = writeln!(
            out,
            "- {} faults in {file} are detected by one check only: {why}.",
            excepted.count()
        );
    }
    for (name, mode, keys) in &study.ignored {
        let _ = writeln!(
            out,
            "- On {name} ({mode:?}) these findings fail without a fault and do not count: {}.",
            keys.join(", ")
        );
    }
    let _ = writeln!(
        out,
        "\n## Named faults\n\n| fault | on | of | {} |",
        column_heads()
    );
    let _ = writeln!(out, "|---|---|---|{}", "---|".repeat(CHECKS.len()));
    let _ = writeln!(
        out,
        "| no fault | all | {} | {} |",
        study.mechanisms,
        cells(&study.without_mutation)
    );
    for group in &study.groups {
        let _ = writeln!(
            out,
            "| **{}** | | | {} |",
            group.title,
            "| ".repeat(CHECKS.len() - 1)
        );
        for row in &group.rows {
            let _ = writeln!(
                out,
                "| {} | {} | {} | {} |",
                row.description,
                row.mechanism,
                row.mechanisms,
                cells(&row.detection)
            );
        }
    }
    let _ = writeln!(
        out,
        "\n## Operations, by function\n\nEach operation of the source code is mutated: another sign, a \
         term or the whole forgotten, twice, half. The columns of the checks count the faults that they detect.\n\n\
         | function | faults | no effect | error | fewest checks | {} |",
        column_heads()
    );
    let _ = writeln!(out, "|---|---|---|---|---|{}", "---|".repeat(CHECKS.len()));
    for (function, tally) in functions {
        let min_checks = tally.min_checks.map_or("-".to_owned(), |n| n.to_string());
        let detected = tally.detected.map(|n| n.to_string()).join(" | ");
        let _ = writeln!(
            out,
            "| {function} | {} | {} | {} | {min_checks} | {detected} |",
            tally.mutations, tally.unchanged, tally.no_result
        );
    }
    let _ = writeln!(
        out,
        "\n## Faults without effect on any result\n\nThese change nothing that is checked on any mechanism: an initial guess of Newton's method or its \
         Jacobian, a term that is zero by construction, a value that is not used.\n"
    );
    for result in study
        .operation_results
        .iter()
        .filter(|s| s.outcome == MutationOutcome::Unchanged)
    {
        let (operation, kind) = (result.operation, result.kind);
        let _ = writeln!(
            out,
            "- {}:{}, {}: `{}`: {} {}",
            operation.file,
            operation.line,
            source.function(operation),
            source.line(operation),
            operation.operation.description(),
            kind.description()
        );
    }
    out
}

fn cells(detection: &Detection) -> String {
    let cell = |digits: &Option<f64>| digits.map_or(String::new(), |d| format!("{d:.0}"));
    detection
        .digits
        .iter()
        .map(cell)
        .collect::<Vec<_>>()
        .join(" | ")
}

fn column_heads() -> String {
    CHECKS
        .iter()
        .map(Check::to_string)
        .collect::<Vec<_>>()
        .join(" | ")
}
