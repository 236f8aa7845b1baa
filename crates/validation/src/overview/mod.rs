//! The cases that were validated together: case by check, as a table and as a figure.

mod figure;
mod page;

use crate::case_report::validate::Validation;
use crate::cases::reference::SourceKind;
use crate::report_parts::{describe_failure, nearness, pass_or_fail, table};
use dwell_findings::{Check, all_pass};
use dwell_report::{Block, Document, markdown_text};
use dwell_scene::Scene;
use dwell_study::Outcome;
use dwell_study::output::Picture;

/// What the kinds of reference values mean.
const SOURCE_KINDS: &str = "Independent: made by the program in `validation/reference`, which shares nothing with Dwell and remakes every one of them (`just reference`). Literature: as printed, with its citation on the case's page. Own oracle: no value from elsewhere; Dwell's independent checks alone. The values of the squeezer at 0.03 s that the Test Set for IVP Solvers publishes are 1.5e-9 rad off (accelerations and multipliers 1.3e-6 of the largest): the independent energy integral and Dwell's integration agree against them.";

/// A case and its result: its report, or why there is none.
pub type CaseResult<'a> = (&'a str, Result<(&'a Scene, &'a Validation), String>);

/// The result of one check in a case.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum CheckCell {
    /// Digits of agreement, of the worst finding.
    Digits(f64),
    /// The key of the finding that failed.
    Failed(String),
    /// Why there is none.
    NotApplicable(&'static str),
}

/// The results of every check in a validated case.
pub(crate) fn check_cells(done: &Validation) -> [CheckCell; Check::ALL.len()] {
    Check::ALL.map(|check| {
        let all = || done.outcome.findings.iter();
        let of = || all().filter(|f| f.check == check);
        if let Some(failed) = of().find(|f| !f.pass) {
            return CheckCell::Failed(failed.key.clone());
        }
        // Double precision has no more digits than its last place.
        let worst = of().map(|f| f.relative_difference.max(f64::EPSILON));
        let mut reasons = done.not_applicable.iter();
        match worst.reduce(f64::max) {
            Some(worst) => CheckCell::Digits(-worst.log10()),
            None => {
                let reason = reasons.find(|(of, _)| *of == check);
                CheckCell::NotApplicable(reason.map_or("nothing", |(_, why)| why))
            }
        }
    })
}

/// The report on all cases beside their own: `index.md`, `index.html`, and the picture of its table, `index.png`, to be drawn.
pub fn index(results: &[CaseResult<'_>]) -> Outcome {
    let heads = Check::ALL.map(|check| check.to_string());
    let mut blocks = vec![
        Block::Text(format!(
            "{} of {} cases pass. Written by Dwell {}.",
            passed(results),
            results.len(),
            env!("CARGO_PKG_VERSION")
        )),
        table(
            &[&["Case"][..], &heads.each_ref().map(String::as_str)].concat(),
            results.iter().map(agreement_row),
        ),
        Block::Text(
            "Agreeing decimal digits of the worst finding of each check; double precision has 15.7. Checks 5, 6 and part of 4 are limited by the integrator's tolerance, not by rounding. Check 10 compares the results with 32-digit arithmetic, check 11 with closed forms. See also the [extreme parameters](extremes.md) and the [mutation study](mutations.md), which shows the checks that detect each deliberate fault (`just mutations`)."
                .to_owned(),
        ),
        Block::Figure {
            file: "index.png".to_owned(),
            alt: "Agreeing digits of every case and check".to_owned(),
            caption: String::new(),
        },
    ];
    blocks.extend(failures(results));
    blocks.push(Block::Heading("Reference values".to_owned()));
    let words = SourceKind::ALL.map(SourceKind::word);
    blocks.push(table(
        &[&["Case"][..], &words].concat(),
        results.iter().map(source_row),
    ));
    blocks.push(Block::Text(SOURCE_KINDS.to_owned()));
    blocks.push(Block::Heading("Tolerances".to_owned()));
    let header = [
        "Case",
        "Result",
        "Findings",
        "Nearest to its tolerance",
        "Loose tolerances",
    ];
    blocks.push(table(&header, results.iter().map(tolerance_row)));
    blocks.push(Block::Text(
        "The last column is the largest ratio of a difference to its tolerance. A tolerance is loose if it exceeds 100 times the largest difference plus 50 rounding errors times the condition number of the dense rows there. Integrated results are exempt: convergence orders and multiples of the integrator's tolerance check them."
            .to_owned(),
    ));
    let document = Document {
        title: "Cases".to_owned(),
        blocks,
    };
    let mut outcome = Outcome::default();
    outcome.files.add("index.md", document.markdown());
    outcome.files.add("index.html", page::html(results));
    let overview = Picture::of_no_scene("index.png".to_owned(), figure::overview(results));
    outcome.pictures.push(overview);
    outcome
}

/// How many cases pass.
fn passed(results: &[CaseResult<'_>]) -> usize {
    let done = results
        .iter()
        .filter_map(|(_, result)| result.as_ref().ok());
    done.filter(|(_, done)| all_pass(&done.outcome.findings))
        .count()
}

fn link(scene: &Scene) -> String {
    format!("[{}]({}.md)", markdown_text(&scene.title), scene.name)
}

/// The name of a case and its cells, if it was validated.
fn row<const N: usize>(
    (name, result): &CaseResult<'_>,
    cells: impl Fn(&Validation) -> [String; N],
) -> Vec<String> {
    match result {
        Ok((scene, done)) => [link(scene)].into_iter().chain(cells(done)).collect(),
        Err(_) => vec![format!("`{name}`"), "**not validated**".to_owned()],
    }
}

/// A row of the table of digits.
fn agreement_row(case: &CaseResult<'_>) -> Vec<String> {
    row(case, |validation| {
        check_cells(validation).map(|cell| match cell {
            CheckCell::Digits(digits) => format!("{digits:.1}"),
            CheckCell::Failed(key) => format!("**FAIL** {key}"),
            CheckCell::NotApplicable(why) => why.to_owned(),
        })
    })
}

/// Who made the reference values of a case.
fn source_row(case: &CaseResult<'_>) -> Vec<String> {
    row(case, |validation| {
        SourceKind::ALL.map(|kind| validation.source_kinds.of(kind))
    })
}

/// Every failure: the equation, the location and the difference.
fn failures(results: &[CaseResult<'_>]) -> Vec<Block> {
    let mut text = String::new();
    for (name, result) in results {
        match result {
            Ok((scene, validation)) => {
                for failed in validation.outcome.findings.iter().filter(|f| !f.pass) {
                    text += &format!(
                        "- `{}` {}: {}\n",
                        scene.name,
                        failed.key,
                        describe_failure(failed).join("; ")
                    );
                }
            }
            Err(reason) => text += &format!("- `{name}`: {reason}\n"),
        }
    }
    match text.is_empty() {
        true => Vec::new(),
        false => vec![Block::Heading("Failures".to_owned()), Block::Text(text)],
    }
}

/// How close the findings are to their tolerances, and which tolerances are loose.
fn tolerance_row((name, status): &CaseResult<'_>) -> Vec<String> {
    let (scene, done) = match status {
        Ok(validated) => validated,
        Err(reason) => {
            let row = [&format!("`{name}`"), "**not validated**", "", reason];
            return row.map(str::to_owned).into();
        }
    };
    let findings = &done.outcome.findings;
    let passed = findings.iter().filter(|f| f.pass).count();
    let loose = findings.iter().filter(|f| f.is_loose());
    let loose: Vec<&str> = loose.map(|f| f.key.as_str()).collect();
    let loose = match loose.is_empty() {
        true => "none".to_owned(),
        false => loose.join(", "),
    };
    vec![
        link(scene),
        pass_or_fail(all_pass(findings)).to_owned(),
        format!("{passed} of {}", findings.len()),
        nearness(findings),
        loose,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::reference::SourceKinds;
    use dwell_findings::Finding;
    use dwell_scene::Scene;

    fn finding(check: Check, relative: f64, tolerance: f64) -> Finding {
        Finding {
            key: format!("key-{}", check.number()),
            check,
            comparison: "m with 2 E_c".into(),
            domain: "24 positions".into(),
            absolute_difference: 2.0 * relative,
            unit: "kg m2".into(),
            relative_difference: relative,
            scale: "the largest m".into(),
            worst_at: "phi = 1 rad".into(),
            tolerance,
            pass: relative <= tolerance,
            ..Finding::default()
        }
    }

    fn validation(findings: Vec<Finding>) -> Validation {
        let mut done = Validation {
            source_kinds: SourceKinds::default(),
            not_applicable: vec![(Check::Period, "driven")],
            ..Validation::default()
        };
        done.outcome.findings = findings;
        done
    }

    #[test]
    fn a_check_has_the_digits_of_its_worst_finding_or_the_reason_for_none() {
        let done = validation(vec![
            finding(Check::KineticEnergy, 1e-15, 1e-14),
            finding(Check::KineticEnergy, 1e-13, 1e-12),
            finding(Check::EnergySlope, 0.0, 1e-12),
            finding(Check::ReleasedConstraint, 1e-9, 1e-12),
            finding(Check::ReleasedConstraint, 1e-15, 1e-12),
        ]);
        let cells = check_cells(&done);
        assert_eq!(cells[0], CheckCell::NotApplicable("nothing"));
        // Digits are given to a tenth.
        assert!(matches!(cells[1], CheckCell::Digits(d) if (d - 13.0).abs() < 0.01));
        assert!(matches!(cells[2], CheckCell::Digits(d) if (d - 15.65).abs() < 0.01));
        assert_eq!(cells[3], CheckCell::Failed("key-3".into()));
        assert_eq!(cells[5], CheckCell::NotApplicable("driven"));
    }

    #[test]
    fn a_failure_names_the_equation_the_place_and_the_difference() {
        let [equation, location, difference] =
            describe_failure(&finding(Check::KineticEnergy, 3e-9, 1e-12));
        assert_eq!(equation, "check 1 kinetic energy, m with 2 E_c");
        assert_eq!(location, "at phi = 1 rad, of 24 positions");
        assert_eq!(
            difference,
            "difference 6.00e-9 kg m2, 3.0e-9 of the largest m; tolerance 1.0e-12"
        );
        let [.., difference] = describe_failure(&finding(Check::KineticEnergy, f64::NAN, 1e-12));
        assert_eq!(difference, "difference none could be taken");
    }

    #[test]
    fn the_index_shows_failures_loose_tolerances_and_cases_that_were_not_validated() {
        let text = "[bodies.ground]\npoints = { A = [0, 0] }\n[bodies.bar]\npoints = { A = [0, 0] }\n\
                    [joints]\nA = { revolute = [\"ground.A\", \"bar.A\"] }\n[actuators]\nphi = { angle = [\"ground\", \"bar\"] }";
        let scene = Scene::parse("bar.toml", text).unwrap();
        let done = validation(vec![
            finding(Check::KineticEnergy, 1e-16, 1e-9),
            finding(Check::EnergySlope, 1e-9, 1e-12),
        ]);
        let results = [
            ("cases/bar", Ok((&scene, &done))),
            ("cases/lost", Err("it cannot be read".to_owned())),
        ];
        let Outcome {
            files, pictures, ..
        } = index(&results);
        let text = files.iter().find(|(path, _)| path.ends_with("index.md"));
        let text = String::from_utf8(text.unwrap().1.to_vec()).unwrap();
        for part in [
            "0 of 2 cases pass",
            "| 15.7 | **FAIL** key-2 |",
            "| driven |",
            "- `bar` key-2: check 2 energy slope, m with 2 E_c; at phi = 1 rad, of 24 positions; difference 2.00e-9 kg m2",
            "| 1 of 2 | 1000.00 of key-2 | key-1 |",
            "| `cases/lost` | **not validated** |",
            "- `cases/lost`: it cannot be read",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        let page = files.iter().find(|(path, _)| path.ends_with("index.html"));
        let page = String::from_utf8(page.unwrap().1.to_vec()).unwrap();
        for part in [
            "<p>0 of 2 cases pass",
            "<a href=\"bar.html#check=1\" title=\"key-1: 1.0e-16, tolerance 1.0e-9\">15.7</a>",
            "title=\"key-2: 1.0e-9, tolerance 1.0e-12\">FAIL key-2</a>",
            "<td class=\"none\" title=\"driven\">",
            "not validated: it cannot be read",
        ] {
            assert!(page.contains(part), "{part}\n{page}");
        }
        assert!(pictures.iter().any(|picture| picture.path == "index.png"));
    }
}
