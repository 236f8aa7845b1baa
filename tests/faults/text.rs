//! The study in words: a rounded text that every machine reproduces, and a page with all details.

use super::operations::{Outcome, Slipped};
use super::source::Source;
use super::steps::Tally;
use super::study::Study;
use super::verdict::{TRUTHS, Verdict};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// `faults.txt`: which truths catch what. Digits and counts are left out: they are not the same everywhere, and
/// each new line of the product changes them.
pub(crate) fn text(study: &Study, functions: &BTreeMap<String, Tally>) -> String {
    let mut out = String::from(HEAD);
    let _ = writeln!(out, "{:<58}  {:<18} truths", "fault", "on");
    let _ = writeln!(
        out,
        "{:<58}  {:<18} [{}]",
        "no fault",
        "all of them",
        study.clean.words()
    );
    for chapter in &study.chapters {
        let _ = writeln!(out, "\n{}", chapter.title);
        for row in &chapter.rows {
            let _ = writeln!(
                out,
                "  {:<56}  {:<18} {}",
                row.fault,
                row.on,
                row.verdict.words()
            );
        }
    }
    let _ = writeln!(
        out,
        "\nEvery sign, term and factor, by function: the fewest truths that catch a fault that an answer shows"
    );
    for (function, tally) in functions {
        let fewest = tally.fewest.map_or("-".to_owned(), |n| n.to_string());
        let _ = writeln!(out, "  {function:<36} {fewest:>3}");
    }
    out
}

const HEAD: &str = "Deliberate faults and the independent truths that catch them\n\
    A truth is named by its number; in brackets where it exceeds its tolerance by less than three digits.\n\n";

/// How many faults, and how many truths.
pub(crate) fn summary(study: &Study) -> String {
    let named: usize = study.chapters.iter().map(|c| c.rows.len()).sum();
    let judged = study.slips.iter().filter_map(verdict);
    let fewest = judged.clone().map(Verdict::count).min().unwrap_or(0);
    let of_named = study
        .chapters
        .iter()
        .flat_map(|c| &c.rows)
        .map(|r| r.verdict.count());
    format!(
        "{named} named faults, each caught by at least {} independent truths.\n\
         {} faults of single operations: {} change an answer, each caught by at least {fewest};\n\
         {} change none, {} end in a refusal.",
        of_named.min().unwrap_or(0),
        study.slips.len(),
        judged.count(),
        study
            .slips
            .iter()
            .filter(|s| s.outcome == Outcome::Same)
            .count(),
        study
            .slips
            .iter()
            .filter(|s| s.outcome == Outcome::Refused)
            .count(),
    )
}

fn verdict(slipped: &Slipped) -> Option<&Verdict> {
    match &slipped.outcome {
        Outcome::Judged(verdict, _) => Some(verdict),
        _ => None,
    }
}

/// `faults.md`.
pub(crate) fn page(study: &Study, functions: &BTreeMap<String, Tally>, source: &Source) -> String {
    let mut out = String::from(
        "# Deliberate faults\n\n![Faults and truths](faults.png)\n\nA fault is a wrapper around what is judged; production \
         code holds none. A cell is the digits by which the difference exceeds the truth's tolerance; 0: the truth was asked and \
         sees nothing; empty: it was not asked. Every fault is shown on the machine that shows it to the fewest truths.\n\n",
    );
    let _ = writeln!(out, "{}\n", summary(study));
    for hole in study.holes() {
        let _ = writeln!(out, "- **{hole}**");
    }
    for (name, by, keys) in &study.blind {
        let _ = writeln!(
            out,
            "- On {name} ({by:?}) these findings fail without a fault and do not count: {}.",
            keys.join(", ")
        );
    }
    let _ = writeln!(
        out,
        "\n## Named faults\n\n| fault | on | of | {} |",
        TRUTHS.join(" | ")
    );
    let _ = writeln!(out, "|---|---|---|{}", "---|".repeat(TRUTHS.len()));
    let _ = writeln!(
        out,
        "| no fault | all | {} | {} |",
        study.machines,
        cells(&study.clean)
    );
    for chapter in &study.chapters {
        let _ = writeln!(
            out,
            "| **{}** | | | {} |",
            chapter.title,
            "| ".repeat(TRUTHS.len() - 1)
        );
        for row in &chapter.rows {
            let _ = writeln!(
                out,
                "| {} | {} | {} | {} |",
                row.fault,
                row.on,
                row.machines,
                cells(&row.verdict)
            );
        }
    }
    let _ = writeln!(
        out,
        "\n## Operations, by function\n\nEach operation of the product's own lines goes wrong in every way: another sign, a \
         term or the whole forgotten, twice, half. The truths' columns say how many faults they catch.\n\n\
         | function | faults | no answer moves | refused | fewest truths | {} |",
        TRUTHS.join(" | ")
    );
    let _ = writeln!(out, "|---|---|---|---|---|{}", "---|".repeat(TRUTHS.len()));
    for (function, tally) in functions {
        let fewest = tally.fewest.map_or("-".to_owned(), |n| n.to_string());
        let caught = tally.caught.map(|n| n.to_string()).join(" | ");
        let _ = writeln!(
            out,
            "| {function} | {} | {} | {} | {fewest} | {caught} |",
            tally.faults, tally.same, tally.refused
        );
    }
    let _ = writeln!(
        out,
        "\n## Faults that no answer shows\n\nThese change nothing that is judged on any machine: a guess of Newton's method or its \
         Jacobian, a term that is zero by construction, a measure that nothing asks for.\n"
    );
    for slipped in study.slips.iter().filter(|s| s.outcome == Outcome::Same) {
        let (place, slip) = (slipped.place, slipped.slip);
        let _ = writeln!(
            out,
            "- {}:{}, {}: `{}`: {} {}",
            place.file,
            place.line,
            source.function(place),
            source.line(place),
            place.operation.words(),
            slip.words()
        );
    }
    out
}

fn cells(verdict: &Verdict) -> String {
    let cell = |digits: &Option<f64>| digits.map_or(String::new(), |d| format!("{d:.0}"));
    verdict
        .digits
        .iter()
        .map(cell)
        .collect::<Vec<_>>()
        .join(" | ")
}
