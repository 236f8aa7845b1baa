//! Parts that the reports of cases and studies share.

use dwell_findings::{Finding, all_pass};
use dwell_report::{Block, Column, Document, Figure, Table, reproducible_text};
use dwell_study::Outcome;
use dwell_study::output::Picture;

/// The report of a study: `NAME.md` and `NAME.html`, the rounded `NAME.txt`, and its pictures in the folder `NAME/`.
pub(crate) struct StudyReport<'a> {
    pub(crate) name: &'a str,
    pub(crate) title: &'a str,
    /// What is studied, in words.
    pub(crate) text: String,
    /// What follows these words, before the findings.
    pub(crate) blocks: Vec<Block>,
    /// What the rounded text says before the findings.
    pub(crate) snapshot: String,
    pub(crate) figures: &'a [Figure],
    pub(crate) findings: Vec<Finding>,
    /// What was studied and how much of it, at the end of a line of the summary.
    pub(crate) count: String,
}

impl StudyReport<'_> {
    /// Adds the report to an outcome.
    pub(crate) fn add_to(self, outcome: &mut Outcome) {
        let (name, title, findings) = (self.name, self.title, self.findings);
        let result = pass_or_fail(all_pass(&findings));
        let mut blocks = vec![Block::Text(format!("{result}. {}", self.text))];
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
pub(crate) fn table(header: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Block {
    Block::Table {
        header: header.iter().map(|&cell| cell.to_owned()).collect(),
        rows: rows.into_iter().collect(),
    }
}

/// A cell of a row, below the header of its column.
pub(crate) type TextColumn<T> = (&'static str, fn(&T) -> String);

/// A table of a document by its columns.
pub(crate) fn table_of<T>(columns: &[TextColumn<T>], rows: impl Iterator<Item = T>) -> Block {
    let header: Vec<&str> = columns.iter().map(|(header, _)| *header).collect();
    let row = |row| columns.iter().map(|(_, cell)| cell(&row)).collect();
    table(&header, rows.map(row))
}

/// A number of a row, with the name and the unit of its column.
pub(crate) type NumberColumn<'a, T> = (&'a str, &'a str, fn(&T) -> f64);

/// The numbers of some rows.
pub(crate) fn numbers<T>(columns: &[NumberColumn<'_, T>], rows: impl Iterator<Item = T>) -> Table {
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
pub(crate) fn figure_blocks(folder: &str, figures: &[Figure], captions: bool) -> Vec<Block> {
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
pub(crate) fn findings_text(name: &str, findings: &[Finding], more: &str) -> String {
    let failed: Vec<&Finding> = findings.iter().filter(|f| !f.pass).collect();
    let (all, passed) = (findings.len(), findings.len() - failed.len());
    let mut text = format!("{name}: {passed} of {all} findings pass{more}\n");
    for f in failed {
        text += &format!("  FAIL {} {}\n", f.key, describe_failure(f).join("\n    "));
    }
    text
}

/// The difference of a finding as a part of its tolerance.
pub(crate) fn ratio(finding: &Finding) -> f64 {
    match finding.relative_difference {
        0.0 => 0.0,
        // What is not a number is the worst there is.
        relative if relative.is_nan() => f64::INFINITY,
        relative => relative / finding.tolerance,
    }
}

/// The finding nearest to its tolerance.
pub(crate) fn nearest<'f>(findings: impl Iterator<Item = &'f Finding>) -> Option<&'f Finding> {
    findings.max_by(|a, b| ratio(a).total_cmp(&ratio(b)))
}

/// How near the nearest of some findings is, and which.
pub(crate) fn nearness(findings: &[Finding]) -> String {
    let nearest = nearest(findings.iter());
    nearest.map_or_else(String::new, |f| format!("{:.2} of {}", ratio(f), f.key))
}

/// `pass` or a bold FAIL.
pub(crate) fn pass_or_fail(pass: bool) -> &'static str {
    if pass { "pass" } else { "**FAIL**" }
}

/// A failed finding as text: the check, where it fails, and by how much.
pub(crate) fn describe_failure(finding: &Finding) -> [String; 3] {
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
