//! The cases that were validated together, one row each.

use crate::validate::Validation;
use dwell_findings::{Finding, all_pass};
use dwell_report::{Block, Document};
use dwell_scene::Scene;

/// Findings that allow more than this are of approximations, such as an integrated motion: they have
/// no digits to be proud of.
const EXACT: f64 = 1e-10;

/// A case and what became of it: its report, or why there is none.
pub type Verdict<'a> = (&'a str, Result<(&'a Scene, &'a Validation), String>);

/// The table of the cases, as Markdown beside their reports.
pub fn index(verdicts: &[Verdict<'_>]) -> String {
    let header = [
        "Case",
        "Verdict",
        "Findings",
        "Fewest digits",
        "in",
        "Nearest to its tolerance",
    ];
    let row = |(name, verdict): &Verdict<'_>| match verdict {
        Ok((scene, done)) => judged(scene, &done.outcome.findings),
        Err(reason) => vec![
            format!("`{name}`"),
            "**not validated**".to_owned(),
            String::new(),
            String::new(),
            String::new(),
            reason.clone(),
        ],
    };
    let good = |(_, verdict): &&Verdict<'_>| match verdict {
        Ok((_, done)) => all_pass(&done.outcome.findings),
        Err(_) => false,
    };
    let count = verdicts.iter().filter(good).count();
    Document {
        title: "Cases".to_owned(),
        blocks: vec![
            Block::Text(format!(
                "{count} of {} cases pass. Written by Dwell {}.",
                verdicts.len(),
                env!("CARGO_PKG_VERSION")
            )),
            Block::Table {
                header: header.map(str::to_owned).to_vec(),
                rows: verdicts.iter().map(row).collect(),
            },
            Block::Text(
                "The fewest digits are those of the comparisons that must agree to 1e-10 of their scale or better; \
                 the last column is the largest part of a tolerance that any difference takes."
                    .to_owned(),
            ),
        ],
    }
    .markdown()
}

fn judged(scene: &Scene, findings: &[Finding]) -> Vec<String> {
    let most = |of: &dyn Fn(&Finding) -> f64, among: &dyn Fn(&Finding) -> bool| {
        let some = findings.iter().filter(|f| among(f));
        // What is no number is the worst there is.
        let size = |f: &Finding| Some(of(f)).filter(|v| !v.is_nan()).unwrap_or(f64::INFINITY);
        let worst = some.max_by(|a, b| size(a).total_cmp(&size(b)));
        worst.map(|f| (size(f), f.key.clone()))
    };
    let exact = most(&|f| f.relative, &|f| f.tolerance <= EXACT);
    let (digits, of) = exact.map_or((String::new(), String::new()), |(relative, key)| {
        (format!("{:.1}", -relative.max(f64::EPSILON).log10()), key)
    });
    let part = |f: &Finding| match f.relative {
        0.0 => 0.0,
        relative => relative / f.tolerance,
    };
    let near = most(&part, &|_| true);
    let near = near.map_or(String::new(), |(part, key)| format!("{part:.2} of {key}"));
    let passed = findings.iter().filter(|f| f.pass).count();
    vec![
        format!("[{}]({}.md)", scene.title, scene.name),
        if all_pass(findings) {
            "pass"
        } else {
            "**FAIL**"
        }
        .to_owned(),
        format!("{passed} of {}", findings.len()),
        digits,
        of,
        near,
    ]
}
