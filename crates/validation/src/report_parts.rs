//! Parts that the reports of cases and studies share.

use dwell_findings::{Finding, all_pass};
use dwell_report::{Block, Column, Document, Figure, Table, reproducible_text};
use dwell_study::Outcome;
use dwell_study::output::Picture;
use std::cmp::Ordering;

/// The report of a study: `NAME.md` and `NAME.html`, the rounded `NAME.txt`, and its pictures in the folder `NAME/`.
pub struct StudyReport<'a> {
    /// Base name of its files and pictures.
    pub name: &'a str,
    /// Its title.
    pub title: &'a str,
    /// A description of the study.
    pub text: String,
    /// The blocks after the description, before the findings.
    pub blocks: Vec<Block>,
    /// The rounded text before the findings.
    pub snapshot: String,
    /// Its pictures.
    pub figures: &'a [Figure],
    /// The findings.
    pub findings: Vec<Finding>,
    /// The number of studied items, in words, at the end of a line of the summary.
    pub count: String,
}

impl StudyReport<'_> {
    /// Adds the report to an outcome.
    pub fn add_to(self, outcome: &mut Outcome) {
        let (name, title, findings) = (self.name, self.title, self.findings);
        let mut blocks = vec![Block::Text(result_line(&findings)), Block::Text(self.text)];
        blocks.extend(self.blocks);
        blocks.push(Block::Heading("Findings".to_owned()));
        blocks.push(Block::Findings(findings.clone()));
        let title = title.to_owned();
        let snapshot = format!("{}\n{}", self.snapshot, reproducible_text(&findings));
        outcome.files.add(format!("{name}.txt"), snapshot);
        outcome
            .files
            .add_document(name, &Document { title, blocks });
        let pictures = self.figures.iter().map(|figure| {
            let path = format!("{name}/{}.png", figure.name);
            Picture::of_no_scene(path, figure.clone())
        });
        outcome.pictures.extend(pictures);
        outcome.summary += &findings_text(name, &findings, &format!(", {}", self.count));
        outcome.findings.extend(findings);
    }
}

/// A table of a document.
pub fn table(header: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Block {
    Block::Table {
        header: header.iter().map(|&cell| cell.to_owned()).collect(),
        rows: rows.into_iter().collect(),
    }
}

/// A cell of a row, below the header of its column.
pub type TextColumn<T> = (&'static str, fn(&T) -> String);

/// A table of a document by its columns.
pub fn table_of<T>(columns: &[TextColumn<T>], rows: impl Iterator<Item = T>) -> Block {
    let header: Vec<&str> = columns.iter().map(|(header, _)| *header).collect();
    let row = |row| columns.iter().map(|(_, cell)| cell(&row)).collect();
    table(&header, rows.map(row))
}

/// A number of a row, with the name and the unit of its column.
pub type NumberColumn<'a, T> = (&'a str, &'a str, fn(&T) -> f64);

/// The numbers of some rows.
pub fn numbers<T>(columns: &[NumberColumn<'_, T>], rows: impl Iterator<Item = T>) -> Table {
    let row = |row| columns.iter().map(|(.., value)| value(&row)).collect();
    Table {
        rows: rows.map(row).collect(),
        columns: (columns
            .iter()
            .map(|(name, unit, _)| Column::new(*name, *unit)))
        .collect(),
    }
}

/// The drawn figures in a document, each with its caption or else its title below it.
pub fn figure_blocks(folder: &str, figures: &[Figure], captions: bool) -> Vec<Block> {
    let block = |figure: &Figure| Block::Figure {
        file: format!("{folder}/{}.png", figure.name),
        alt: figure.title.clone(),
        caption: if captions {
            figure.caption.clone()
        } else {
            figure.title.clone()
        },
    };
    figures.iter().map(block).collect()
}

/// How many findings of a name pass, with `more` at the end of the line, and those that fail.
pub fn findings_text(name: &str, findings: &[Finding], more: &str) -> String {
    let failed: Vec<&Finding> = findings.iter().filter(|f| !f.pass).collect();
    let (all, passed) = (findings.len(), findings.len() - failed.len());
    let mut text = format!("{name}: {passed} of {all} findings pass{more}\n");
    for f in failed {
        text += &format!("  FAIL {} {}\n", f.key, describe_failure(f).join("\n    "));
    }
    text
}

/// Tolerances in this range mean that differences are counted in units of the last printed digit, of which a half is rounding.
const LAST_DIGIT: std::ops::Range<f64> = 0.5..0.6;

/// The ratio of the tolerance to the difference of a finding: infinite without a difference, or without one in the printed digits; zero if
/// the difference is NaN.
pub fn margin(finding: &Finding) -> f64 {
    match finding.relative_difference {
        0.0 if finding.pass => f64::INFINITY,
        _ if finding.pass && LAST_DIGIT.contains(&finding.tolerance) => f64::INFINITY,
        difference if difference.is_nan() => 0.0,
        difference => finding.tolerance / difference,
    }
}

/// A margin in at most four letters.
pub fn margin_text(margin: f64) -> String {
    match margin {
        margin if margin == f64::INFINITY => "=".to_owned(),
        margin if margin < 9.95 => format!("{margin:.1}"),
        margin if margin < 999.5 => format!("{margin:.0}"),
        margin => {
            let power = margin.log10().floor().to_string();
            let digits = power
                .bytes()
                .map(|digit| SUPERSCRIPTS[usize::from(digit - b'0')]);
            format!("10{}", digits.collect::<String>())
        }
    }
}

const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

/// The finding with the least margin; one that fails comes before all that pass.
pub fn nearest<'f>(findings: impl Iterator<Item = &'f Finding>) -> Option<&'f Finding> {
    findings.min_by(|a, b| {
        (a.pass, margin(a))
            .partial_cmp(&(b.pass, margin(b)))
            .unwrap_or(Ordering::Equal)
    })
}

/// The least margin of some findings, and which has it.
pub fn nearness(findings: &[Finding]) -> String {
    let nearest = nearest(findings.iter());
    nearest.map_or_else(String::new, |f| {
        format!("{} of {}", margin_text(margin(f)), f.key)
    })
}

/// The first line of the page of a case or a study: the verdict, and the finding nearest to its tolerance.
pub fn result_line(findings: &[Finding]) -> String {
    let passed = findings.iter().filter(|f| f.pass).count();
    let counts = format!("{passed} of {} findings pass", findings.len());
    let result = if all_pass(findings) { "PASS" } else { "FAIL" };
    match nearest(findings.iter()) {
        None => format!("**{result}**: {counts}."),
        Some(f) => format!(
            "**{result}**: {counts}. {} `{}`, check {}: margin {}.",
            if f.pass {
                "Nearest to its tolerance:"
            } else {
                "The worst:"
            },
            f.key,
            f.check,
            margin_text(margin(f))
        ),
    }
}

/// `pass` or a bold FAIL.
pub fn pass_or_fail(pass: bool) -> &'static str {
    if pass { "pass" } else { "**FAIL**" }
}

/// A failed finding as text: the check, where it fails, and by how much.
pub fn describe_failure(finding: &Finding) -> [String; 3] {
    let location = match finding.domain.is_empty() {
        true => finding.worst_at.clone(),
        false => format!("{}, of {}", finding.worst_at, finding.domain),
    };
    let difference = if finding.relative_difference.is_nan() {
        "none could be taken".to_owned()
    } else {
        let unit = if finding.unit.is_empty() { "" } else { " " };
        format!(
            "{:.2e}{unit}{}, {:.1e} of {}; tolerance {:.1e}",
            finding.absolute_difference,
            finding.unit,
            finding.relative_difference,
            finding.scale,
            finding.tolerance
        )
    };
    [
        format!("check {}, {}", finding.check, finding.comparison),
        format!("at {location}"),
        format!("difference {difference}"),
    ]
}
