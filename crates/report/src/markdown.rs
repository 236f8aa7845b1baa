//! A study as Markdown, and findings as text for snapshots.

use crate::number::one_line;
use crate::number::scientific;
use crate::typeset::typeset;
use dwell_findings::Finding;
use std::fmt::Write as _;

/// A document of text, tables, figures and findings.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Document {
    /// The heading of the whole.
    pub title: String,
    /// What follows it.
    pub blocks: Vec<Block>,
}

/// A part of a document.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A heading below the title.
    Heading(String),
    /// Markdown as it is.
    Text(String),
    /// Text of a user, such as the note of a scene, line by line and without markup.
    Words(String),
    /// Cells of text.
    Table {
        /// The header.
        header: Vec<String>,
        /// The rows; a short one is filled with empty cells, a long one is cut.
        rows: Vec<Vec<String>>,
    },
    /// A picture with words under it.
    Figure {
        /// Path of the picture, relative to the document.
        file: String,
        /// Alternative text.
        alt: String,
        /// The caption, or empty.
        caption: String,
    },
    /// Findings, one row each.
    Findings(Vec<Finding>),
}

impl Document {
    /// The document as Markdown.
    pub fn markdown(&self) -> String {
        let mut text = format!("# {}\n", markdown_text(&self.title));
        for block in &self.blocks {
            text.push('\n');
            match block {
                Block::Heading(heading) => text.push_str(&format!("## {}\n", one_line(heading))),
                Block::Text(paragraph) => text.push_str(&format!("{}\n", paragraph.trim_end())),
                Block::Words(words) => text.push_str(&format!("{}\n", words_in_lines(words))),
                Block::Table { header, rows } => text.push_str(&table(header, rows)),
                Block::Figure { file, alt, caption } => text.push_str(&image(file, alt, caption)),
                Block::Findings(findings) => text.push_str(&findings_table(findings)),
            }
        }
        text
    }
}

/// The reproducible part of the findings: key, check, comparison, tolerance and verdict.
pub fn reproducible_text(findings: &[Finding]) -> String {
    let mut text = String::new();
    for f in findings {
        let (result, key, check) = (pass_or_fail(f), one_line(&f.key), &f.check);
        let (comparison, tolerance) = (one_line(&f.comparison), scientific(f.tolerance, 3));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{result}  {key}  [{check}]  {comparison}  <= {tolerance}"
        );
    }
    text
}

fn pass_or_fail(finding: &Finding) -> &'static str {
    if finding.pass { "pass" } else { "FAIL" }
}

fn findings_table(findings: &[Finding]) -> String {
    const HEADER: [&str; 9] = [
        "Result",
        "Check",
        "Comparison",
        "Domain",
        "Difference",
        "Relative",
        "Tolerance",
        "Reason for the tolerance",
        "Worst at",
    ];
    let row = |f: &Finding| {
        let with_text = |number: String, text: &str, separator: &str| match text.trim() {
            "" => number,
            text => format!("{number}{separator}{text}"),
        };
        let result = if f.pass {
            pass_or_fail(f).to_owned()
        } else {
            format!("**{}**", pass_or_fail(f))
        };
        vec![
            result,
            f.check.to_string(),
            f.comparison.clone(),
            f.domain.clone(),
            with_text(scientific(f.absolute_difference, 3), &f.unit, " "),
            with_text(scientific(f.relative_difference, 3), &f.scale, " of "),
            scientific(f.tolerance, 3),
            f.tolerance_reason.clone(),
            f.worst_at.clone(),
        ]
    };
    let rows: Vec<_> = findings.iter().map(row).collect();
    table(&HEADER.map(str::to_owned), &rows)
}

fn table(header: &[String], rows: &[Vec<String>]) -> String {
    let empty = String::new();
    let line = |row: &[String]| {
        let filled = row.iter().chain(std::iter::repeat(&empty));
        let cells: Vec<_> = filled.take(header.len()).map(|c| cell(c)).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let rule = vec!["---".to_owned(); header.len()];
    let mut text = line(header) + &line(&rule);
    text.extend(rows.iter().map(|row| line(row)));
    text
}

fn image(file: &str, alt: &str, caption: &str) -> String {
    let alt = markdown_text(alt);
    // In angle brackets a path may hold blanks and brackets.
    let file = one_line(file).replace('<', "%3C").replace('>', "%3E");
    let target = if file.contains([' ', '(', ')']) {
        format!("<{file}>")
    } else {
        file
    };
    match markdown_text(&typeset(caption)).as_str() {
        "" => format!("![{alt}]({target})\n"),
        caption => format!("![{alt}]({target})\n\n*{caption}*\n"),
    }
}

/// Text of a user, such as the title of a scene, with Markdown markup escaped.
pub fn markdown_text(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '&' => out.push_str("&amp;"),
            '`' | '*' | '[' | ']' | '\\' => out.extend(['\\', c]),
            c => out.push(c),
        }
    }
    one_line(&out)
}

/// Text of a user, line by line, with Markdown markup escaped, also at the beginning of a line.
fn words_in_lines(words: &str) -> String {
    let line = |line: &str| {
        let text = markdown_text(line.trim());
        let digits = text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        // `1.` and `1)` begin a list, the others a heading, a list, a quotation, a rule, a table or code.
        match text[digits..].chars().next() {
            Some('.' | ')') if digits > 0 => format!("{}\\{}", &text[..digits], &text[digits..]),
            Some('#' | '-' | '+' | '>' | '=' | '|' | '~' | '_') if digits == 0 => {
                format!("\\{text}")
            }
            _ => text,
        }
    };
    let lines: Vec<String> = words.trim().lines().map(line).collect();
    lines.join("\n")
}

/// Text that cannot end its cell.
fn cell(text: &str) -> String {
    one_line(text).replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_findings::Check;

    fn finding(pass: bool, absolute_difference: f64) -> Finding {
        Finding {
            key: "m-energy".to_owned(),
            check: Check::KineticEnergy,
            comparison: "m with 2E_c at |φ̇| = 1".to_owned(),
            domain: "360 positions".to_owned(),
            absolute_difference,
            unit: "kg m²".to_owned(),
            relative_difference: 3.456e-16,
            scale: "the largest m".to_owned(),
            worst_at: "phi = 1.3 rad".to_owned(),
            tolerance: 1e-12,
            tolerance_reason: "rounding of\na sum".to_owned(),
            pass,
            ..Finding::default()
        }
    }

    /// Cells of a row, splitting only at bars that are not escaped.
    fn cells(row: &str) -> usize {
        row.replace("\\|", "").matches('|').count() - 1
    }

    #[test]
    fn findings_fill_a_whole_table() {
        let findings = vec![finding(true, 1.234_56e-15), finding(false, f64::NAN)];
        let text = Document {
            title: "Study".to_owned(),
            blocks: vec![Block::Findings(findings)],
        }
        .markdown();
        let rows: Vec<&str> = text.lines().filter(|l| l.starts_with('|')).collect();
        assert_eq!(rows.len(), 4);
        assert!(rows.iter().all(|row| cells(row) == 9), "{text}");
        assert!(
            rows[2].contains("1.23e-15 kg m²")
                && rows[2].contains("3.46e-16 of the largest m")
                && rows[2].contains(" 1e-12 ")
        );
        assert!(rows[2].contains("at \\|φ̇\\| = 1") && rows[2].contains("rounding of a sum"));
        assert!(rows[3].contains("**FAIL**") && rows[3].contains("NaN"));
    }

    #[test]
    fn the_stable_form_holds_no_measured_number() {
        assert_eq!(
            reproducible_text(&[finding(true, 1e-15)]),
            reproducible_text(&[finding(true, 7e-15)])
        );
        assert_eq!(
            reproducible_text(&[finding(false, 1.0)]),
            "FAIL  m-energy  [1 kinetic energy]  m with 2E_c at |φ̇| = 1  <= 1e-12\n"
        );
    }

    #[test]
    fn rows_are_as_long_as_the_header() {
        let block = Block::Table {
            header: vec!["a".to_owned(), "b".to_owned()],
            rows: vec![
                vec!["1".to_owned()],
                vec!["1".to_owned(), "2".to_owned(), "3".to_owned()],
            ],
        };
        let text = Document {
            title: String::new(),
            blocks: vec![block],
        }
        .markdown();
        assert!(
            text.lines()
                .filter(|l| l.starts_with('|'))
                .all(|row| cells(row) == 2)
        );
    }

    #[test]
    fn words_of_a_user_are_no_markup() {
        let words = "A *star*, a <b>tag</b>\n# heading\n- item\n\n1. first\n    code\n3.5 m";
        assert_eq!(
            words_in_lines(words),
            "A \\*star\\*, a &lt;b>tag&lt;/b>\n\\# heading\n\\- item\n\n1\\. first\ncode\n3\\.5 m"
        );
    }

    #[test]
    fn pictures_survive_brackets_and_blanks() {
        assert_eq!(image("a b.png", "x [m]", ""), "![x \\[m\\]](<a b.png>)\n");
        assert_eq!(
            image("a.png", "path", "The path."),
            "![path](a.png)\n\n*The path.*\n"
        );
    }
}
