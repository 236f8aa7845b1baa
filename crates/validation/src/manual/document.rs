//! The manual as a document, and its rounded text.

use super::REQUIRED;
use super::capabilities::CAPABILITIES;
use super::lines::{Line, LineState, digits, numbers};
use super::machine;
use crate::report_parts::{
    TextColumn, margin, margin_text, nearness, pass_or_fail, table, table_of,
};
use dwell_findings::{Check, Finding, all_pass};
use dwell_report::{Block, Document, markdown_text};
use std::fmt::Write as _;
use std::path::Path;

/// Maximum number of cases in a cell.
const LISTED_CASES: usize = 3;

/// A case in the list of cases.
pub(super) struct CaseEntry<'a> {
    pub(super) name: &'a str,
    pub(super) title: &'a str,
    pub(super) hash: String,
    pub(super) source: String,
    pub(super) findings: &'a [Finding],
}

impl CaseEntry<'_> {
    fn short_hash(&self) -> &str {
        &self.hash[..self.hash.len().min(16)]
    }
}

/// The contents of the document.
pub(super) struct Contents<'a> {
    pub(super) folder: &'a Path,
    pub(super) lines: &'a [Line],
    pub(super) cases: &'a [CaseEntry<'a>],
    pub(super) extremes: &'a [Finding],
    /// The available texts of committed fault studies, and the number of faults in them.
    pub(super) fault_texts: (&'a [&'static str], usize),
    /// The commit and date of the faults planted in keys, if known.
    pub(super) keys_made: Option<&'a str>,
    /// The result of the independent reader, in words.
    pub(super) independent_reader: &'a str,
}

/// The numbers of lines that pass, fail and are exempt.
pub(super) fn counts(lines: &[Line]) -> [usize; 3] {
    let count = |is: fn(&LineState) -> bool| lines.iter().filter(|line| is(&line.state)).count();
    [
        count(|s| matches!(s, LineState::Pass)),
        count(|s| matches!(s, LineState::Fail(_))),
        count(|s| matches!(s, LineState::Exempt(_))),
    ]
}

/// The manual.
pub(super) fn document(contents: &Contents<'_>) -> Document {
    let mut blocks = vec![summary(contents), how_to_read()];
    blocks.push(Block::Heading("Where it was made".to_owned()));
    blocks.push(table(&["", ""], machine::facts(contents.folder)));
    blocks.extend(failures(contents.lines));
    blocks.push(Block::Heading("Independent targets".to_owned()));
    blocks.push(targets());
    blocks.push(Block::Heading("Cases".to_owned()));
    blocks.push(cases(contents.cases));
    blocks.extend(sections(contents.lines));
    blocks.push(Block::Heading("Extremes".to_owned()));
    blocks.push(extremes(contents.extremes));
    blocks.push(Block::Heading("Known limits".to_owned()));
    blocks.push(limits(contents));
    blocks.push(Block::Heading("Signature".to_owned()));
    blocks.push(signature());
    Document {
        title: "Verification manual".to_owned(),
        blocks,
    }
}

fn summary(contents: &Contents<'_>) -> Block {
    let [passed, failed, exempt] = counts(contents.lines);
    let findings = contents
        .cases
        .iter()
        .flat_map(|case| case.findings)
        .chain(contents.extremes);
    let wrong = findings.clone().filter(|f| !f.pass).count();
    let result = match failed + wrong {
        0 => "**This installation passes.**",
        _ => "**This installation FAILS.**",
    };
    Block::Text(format!(
        "{result} {passed} capabilities pass, {failed} fail, {exempt} change no number that is written or are listed with a reason. {} of {} findings on {} cases and at extreme parameters pass.",
        findings.clone().count() - wrong,
        findings.count(),
        contents.cases.len()
    ))
}

fn how_to_read() -> Block {
    Block::Text(format!(
        "Each line is a capability: a key of the scene description, a command, or an option. It passes where a case uses it, every finding of the checks that apply to it passes on all its cases, and a fault in it is detected by {REQUIRED} checks of different number. For a key the results were computed from a scene in which the value of this key alone is another, and the checks were given the scene as it is written. Faults are those of the committed studies. *Margin* is the tolerance over the difference of the finding nearest to its tolerance; *digits* are those in which result and target agree there."
    )
    .replace('*', ""))
}

/// The failed lines.
fn failures(lines: &[Line]) -> Vec<Block> {
    let failed: Vec<String> = lines
        .iter()
        .filter_map(|line| {
            let why = line.failure()?;
            Some(format!("- `{}` `{}`: {why}", line.section, line.item))
        })
        .collect();
    if failed.is_empty() {
        Vec::new()
    } else {
        vec![
            Block::Heading("Failures".to_owned()),
            Block::Text(failed.join("\n")),
        ]
    }
}

/// The independent targets of the checks.
fn targets() -> Block {
    let about = |check: Check| match check {
        Check::ConstraintClosure => {
            "dense constraint rows in body coordinates, closed by Newton's method"
        }
        Check::KineticEnergy => "kinetic energy of all bodies at unit speed, from dense velocities",
        Check::EnergySlope => {
            "differences and trigonometric interpolation of that energy; Lagrange's equations"
        }
        Check::ReleasedConstraint => "the constraint released as a coordinate; dense multipliers",
        Check::Power => {
            "power of forces with the rate of the kinetic energy; energy along the motion"
        }
        Check::Period => "quadrature of the period; instants of the integrator's events",
        Check::MultibodyMotion => {
            "multibody equations in absolute coordinates, integrated by extrapolation"
        }
        Check::Momentum => "rate of the momentum of the whole mechanism",
        Check::NewtonEuler => "Newton's and Euler's equations of each body, positions differenced",
        Check::ReferenceValues => {
            "published values, and values of other programs, with the digits that they have"
        }
        Check::Rounding => "the same evaluation in single precision and in double-double numbers",
        Check::ClosedForms => {
            "closed forms, in 32 digits where parameters are extreme; a rotor's own equation"
        }
        // New checks are described by their name.
        _ => "what is written to files, read back by readers of its own",
    };
    let rows = Check::ALL.map(|check| vec![check.to_string(), about(check).to_owned()]);
    table(&["Check", "Target"], rows)
}

fn cases(cases: &[CaseEntry<'_>]) -> Block {
    let columns: [TextColumn<&CaseEntry<'_>>; 6] = [
        ("Case", |case| {
            format!("`{}` {}", case.name, markdown_text(case.title))
        }),
        ("Hash of its scene", |case| {
            format!("`{}`", case.short_hash())
        }),
        ("Source", |case| markdown_text(&case.source)),
        ("Findings", |case| {
            let passed = case.findings.iter().filter(|f| f.pass).count();
            format!("{passed} of {}", case.findings.len())
        }),
        ("Nearest to its tolerance", |case| nearness(case.findings)),
        ("Result", |case| {
            pass_or_fail(all_pass(case.findings)).to_owned()
        }),
    ];
    table_of(&columns, cases.iter())
}

/// A section for each table of the scene and each command.
fn sections(lines: &[Line]) -> Vec<Block> {
    let mut blocks = Vec::new();
    for of_section in lines.chunk_by(|a, b| a.section == b.section) {
        let section = of_section[0].section.as_str();
        blocks.push(Block::Heading(markdown_text(section)));
        let command = section.strip_prefix("dwell ");
        let described = match command {
            Some(command) => CAPABILITIES.commands.get(command).map(|(r, t, ..)| (r, t)),
            None => CAPABILITIES.tables.get(section).map(|(r, t)| (r, t)),
        };
        if let Some((requirement, theory)) = described {
            blocks.push(Block::Text(format!(
                "Requirement: {requirement} Theory: [{}](../docs/theory.md#{theory}).",
                theory.replace('-', " ")
            )));
        }
        blocks.push(line_table(of_section));
    }
    blocks
}

/// A table of lines.
fn line_table(lines: &[Line]) -> Block {
    let columns: [TextColumn<&Line>; 10] = [
        ("Item", |line| format!("`{}`", line.item)),
        ("Meaning", |line| markdown_text(&line.meaning)),
        ("Cases", |line| {
            let listed: Vec<&str> = (line.cases.iter().take(LISTED_CASES))
                .map(String::as_str)
                .collect();
            markdown_text(&match line.cases.len().saturating_sub(LISTED_CASES) {
                0 => listed.join(", "),
                more => format!("{} and {more} more", listed.join(", ")),
            })
        }),
        ("Target", |line| {
            near(line, |f| markdown_text(&f.comparison))
        }),
        ("Difference", |line| {
            near(line, |f| format!("{:.1e}", f.relative_difference))
        }),
        ("Margin", |line| near(line, |f| margin_text(margin(f)))),
        ("Digits", |line| near(line, |f| format!("{:.1}", digits(f)))),
        ("Checked by", |line| {
            let checks: Vec<String> = line.checks.iter().map(Check::to_string).collect();
            checks.join(", ")
        }),
        ("Seeded fault, and the checks that caught it", |line| {
            markdown_text(&line.mutations.join("; "))
        }),
        ("Result", |line| match &line.state {
            LineState::Pass => pass_or_fail(true).to_owned(),
            LineState::Fail(why) => format!("{}: {why}", pass_or_fail(false)),
            LineState::Exempt(why) => format!("exempt: {why}"),
        }),
    ];
    table_of(&columns, lines.iter())
}

/// A text on the finding of a line that is nearest to its tolerance.
fn near(line: &Line, text: fn(&Finding) -> String) -> String {
    line.nearest.as_ref().map_or_else(String::new, text)
}

fn extremes(findings: &[Finding]) -> Block {
    let columns: [TextColumn<&Finding>; 5] = [
        ("Series", |f| format!("`{}`", f.key)),
        ("Compared", |f| markdown_text(&f.comparison)),
        ("Margin", |f| margin_text(margin(f))),
        ("Check", |f| f.check.to_string()),
        ("Result", |f| pass_or_fail(f.pass).to_owned()),
    ];
    table_of(&columns, findings.iter())
}

fn limits(contents: &Contents<'_>) -> Block {
    let (texts, count) = contents.fault_texts;
    let keys_made = match contents.keys_made {
        Some(made) => format!("were planted at {made}"),
        None => "are not at hand".to_owned(),
    };
    let mut text = format!(
        "- Faults in keys {keys_made}.\n- A fault in a key is planted between the scene's text and the results; a fault that readers and checks share, because both use the same reader of scenes, is for the independent reader to find.\n- The line of a command lists the findings on what it computes from: states, reduced models, motions. What it alone computes from them (a cycle, an equilibrium, a matrix, a row of a sweep) is checked by tests, by runs of the program from other starts, and by the independent reader.\n- Checks 0 to 11 share the reader of scenes with the program. The numbers of written files, checks 12 to 18 and 20, are judged by the independent reader in Python, `validation/audit`, which shares nothing with it: {}. What needs a second run or the printed text (of 14, 15, 17, 18 and 19) is judged within this program.\n- Committed studies of mutations that were at hand: {}, {count} of them.",
        contents.independent_reader,
        if texts.is_empty() {
            "none".to_owned()
        } else {
            texts.join(", ")
        }
    );
    let exempt = contents.lines.iter().filter_map(|line| match line.state {
        LineState::Exempt(why) => Some((line, why)),
        _ => None,
    });
    for (line, why) in exempt {
        let _ = write!(
            text,
            "\n- Not checked: `{}` `{}`: {why}.",
            line.section, line.item
        );
    }
    Block::Text(text)
}

/// The signature block.
fn signature() -> Block {
    let rows = [
        "Installation",
        "Purpose",
        "Verified by",
        "Date",
        "Signature",
    ];
    let blank = "\u{a0}".repeat(60);
    table(
        &["", ""],
        rows.map(|row| vec![row.to_owned(), blank.clone()]),
    )
}

/// The reproducible text: capabilities, checks, and results.
pub(super) fn text(lines: &[Line], cases: &[CaseEntry<'_>]) -> String {
    let [passed, failed, exempt] = counts(lines);
    let mut out = format!(
        "Verification manual\n\n{passed} capabilities pass, {failed} fail, {exempt} are exempt\nA capability with the number of its cases, the checks that detect a fault in it or apply to it, and the result\n"
    );
    for of_section in lines.chunk_by(|a, b| a.section == b.section) {
        let _ = writeln!(out, "\n{}", of_section[0].section);
        for line in of_section {
            let state = match &line.state {
                LineState::Pass => "pass".to_owned(),
                LineState::Fail(why) => format!("FAIL {why}"),
                LineState::Exempt(why) => format!("exempt: {why}"),
            };
            let checks = numbers(&line.checks);
            let count = line.cases.len();
            let _ = writeln!(out, "  {:<24} {count:>3}  [{checks}]  {state}", line.item);
        }
    }
    let _ = writeln!(out, "\ncases");
    for case in cases {
        let _ = writeln!(out, "  {:<28} {}", case.name, case.short_hash());
    }
    out
}
