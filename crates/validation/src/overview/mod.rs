//! The overview of a validation: the verdict in a picture and twenty lines, and tables of cases by checks.

mod figure;
mod page;
mod summary;

use crate::case_report::validate::Validation;
use crate::cases::reference::SourceKind;
use crate::report_parts::{
    describe_failure, margin, margin_text, nearest, nearness, pass_or_fail, table,
};
use dwell_findings::{Check, Finding, all_pass};
use dwell_report::{Block, Document, markdown_text};
use dwell_study::Outcome;
use dwell_study::output::Picture;

/// The meaning of the kinds of reference values.
const SOURCE_KINDS: &str = "Independent: made by the program in `validation/reference`, which shares nothing with Dwell and remakes every one of them (`just reference`). Literature: as printed, with its citation on the case's page. Own oracle: no value from elsewhere; Dwell's independent checks alone. The values of the squeezer at 0.03 s that the Test Set for IVP Solvers publishes are 1.5e-9 rad off (accelerations and multipliers 1.3e-6 of the largest): the independent energy integral and Dwell's integration agree against them.";

/// A case in the plane or in space, with its result.
#[derive(Debug, Clone)]
pub struct ValidatedCase<'a> {
    /// Its name, or its path.
    pub name: &'a str,
    /// Its title.
    pub title: &'a str,
    /// Whether it is in space.
    pub in_space: bool,
    /// The result, or the reason why there is none.
    pub result: Result<&'a Validation, String>,
}

/// The results of one run of `dwell validate`.
#[derive(Debug, Clone)]
pub struct ValidationRun<'a> {
    /// The cases of the plane, then those in space.
    pub cases: Vec<ValidatedCase<'a>>,
    /// The other studies, by name, with their findings: extremes, exported runs.
    pub studies: Vec<(&'static str, &'a [Finding])>,
    /// The reason if the independent reader did not run.
    pub no_reader: Option<String>,
    /// The number of passing lines of the manual, and of all lines.
    pub manual: Option<[usize; 2]>,
}

/// The result of one check in a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum CheckCell<'a> {
    /// The finding with the smallest margin; failing ones first.
    Nearest(&'a Finding),
    /// The check does not apply, with the reason.
    NotApplicable(&'static str),
}

/// The results of every check in a validated case.
pub(crate) fn check_cells(done: &Validation) -> [CheckCell<'_>; Check::ALL.len()] {
    Check::ALL.map(|check| {
        let all = done.findings();
        let is_audited = check < Check::WrittenPositions || !done.audited.is_empty();
        let none = if is_audited { "nothing" } else { "no audit" };
        let mut reasons = done.not_applicable.iter();
        match nearest(all.filter(|f| f.check == check)) {
            Some(finding) => CheckCell::Nearest(finding),
            None => {
                let reason = reasons.find(|(of, _)| *of == check);
                CheckCell::NotApplicable(reason.map_or(none, |(_, why)| why))
            }
        }
    })
}

/// The report on all cases: `index.md`, the verdict in twenty lines; its picture, `index.png`; and the tables of cases by
/// checks, `cases.md` and `index.html`.
pub fn index(judged: &ValidationRun<'_>) -> Outcome {
    let mut outcome = Outcome::default();
    outcome
        .files
        .add("index.md", summary::document(judged).markdown());
    outcome.files.add("cases.md", cases(judged).markdown());
    outcome.files.add("index.html", page::html(judged));
    let overview = Picture::of_no_scene("index.png".to_owned(), figure::overview(judged));
    outcome.pictures.push(overview);
    outcome
}

/// Every case in tables: margins, reference values, tolerances.
fn cases(judged: &ValidationRun<'_>) -> Document {
    let results = &judged.cases;
    let heads = Check::ALL.map(|check| check.to_string());
    let mut blocks = failures(results);
    blocks.push(Block::Heading("Margins".to_owned()));
    blocks.push(table(
        &[&["Case"][..], &heads.each_ref().map(String::as_str)].concat(),
        results.iter().map(margin_row),
    ));
    blocks.push(Block::Text(
        "Margin: how many times the difference of a finding its tolerance is, of the finding that is nearest to it; `=` where there is no difference. Check 10 compares the results with 32-digit arithmetic, check 11 with closed forms. See also the [extreme parameters](extremes.md) and the [mutation study](mutations.md), which shows the checks that detect each deliberate fault (`just mutations`)."
            .to_owned(),
    ));
    blocks.push(Block::Heading("Reference values".to_owned()));
    let words = SourceKind::ALL.map(SourceKind::word);
    blocks.push(table(
        &[&["Case"][..], &words].concat(),
        results.iter().filter(|case| !case.in_space).map(source_row),
    ));
    blocks.push(Block::Text(SOURCE_KINDS.to_owned()));
    blocks.push(Block::Heading("Tolerances".to_owned()));
    let header = [
        "Case",
        "Result",
        "Findings",
        "Least margin",
        "Loose tolerances",
    ];
    blocks.push(table(&header, results.iter().map(tolerance_row)));
    blocks.push(Block::Text(
        "A tolerance is loose if it exceeds 100 times the largest difference plus 50 rounding errors times the condition number of the dense rows there. Integrated results are exempt: convergence orders and multiples of the integrator's tolerance check them."
            .to_owned(),
    ));
    Document {
        title: "Cases".to_owned(),
        blocks,
    }
}

/// The name of a case and its cells, if it was validated.
fn row<const N: usize>(
    case: &ValidatedCase<'_>,
    cells: impl Fn(&Validation) -> [String; N],
) -> Vec<String> {
    match &case.result {
        Ok(done) => [case.link()].into_iter().chain(cells(done)).collect(),
        Err(_) => vec![format!("`{}`", case.name), "**not validated**".to_owned()],
    }
}

impl ValidatedCase<'_> {
    fn link(&self) -> String {
        format!("[{}]({}.md)", markdown_text(self.title), self.name)
    }

    fn passes(&self) -> bool {
        let done = self.result.as_ref();
        done.is_ok_and(|done| done.findings().all(|finding| finding.pass))
    }
}

/// A row of the table of margins.
fn margin_row(case: &ValidatedCase<'_>) -> Vec<String> {
    row(case, |validation| {
        check_cells(validation).map(|cell| match cell {
            CheckCell::Nearest(f) if f.pass => margin_text(margin(f)),
            CheckCell::Nearest(f) => format!("**FAIL** {}", f.key),
            CheckCell::NotApplicable(why) => why.to_owned(),
        })
    })
}

/// The origin of the reference values of a case.
fn source_row(case: &ValidatedCase<'_>) -> Vec<String> {
    row(case, |validation| {
        SourceKind::ALL.map(|kind| validation.source_kinds.of(kind))
    })
}

/// Every failure: the equation, the location and the difference.
fn failures(results: &[ValidatedCase<'_>]) -> Vec<Block> {
    let mut text = String::new();
    for ValidatedCase { name, result, .. } in results {
        match result {
            Ok(validation) => {
                for failed in validation.findings().filter(|f| !f.pass) {
                    let words = describe_failure(failed).join("; ");
                    text += &format!("- `{name}` {}: {words}\n", failed.key);
                }
            }
            Err(reason) => text += &format!("- `{name}`: {reason}\n"),
        }
    }
    if text.is_empty() {
        Vec::new()
    } else {
        vec![Block::Heading("Failures".to_owned()), Block::Text(text)]
    }
}

/// The margins of the findings, and the loose tolerances.
fn tolerance_row(case: &ValidatedCase<'_>) -> Vec<String> {
    let done = match &case.result {
        Ok(validated) => validated,
        Err(reason) => {
            let row = [&format!("`{}`", case.name), "**not validated**", "", reason];
            return row.map(str::to_owned).into();
        }
    };
    let findings = &done.outcome.findings;
    let passed = findings.iter().filter(|f| f.pass).count();
    let loose: Vec<&str> = findings
        .iter()
        .filter(|f| f.is_loose())
        .map(|f| f.key.as_str())
        .collect();
    let loose = if loose.is_empty() {
        "none".to_owned()
    } else {
        loose.join(", ")
    };
    vec![
        case.link(),
        pass_or_fail(all_pass(findings)).to_owned(),
        format!("{passed} of {}", findings.len()),
        nearness(findings),
        loose,
    ]
}

#[cfg(test)]
mod tests;
