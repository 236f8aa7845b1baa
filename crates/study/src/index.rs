//! The cases that were validated together: case by truth, as a table and as a picture.

use crate::error::StudyError;
use crate::figures;
use crate::validate::Validation;
use dwell_findings::{Finding, all_pass};
use dwell_report::{Block, Document, Files, png};
use dwell_scene::Scene;

/// The truths by number, in a word each.
pub(crate) const TRUTHS: [&str; 12] = [
    "0 closure",
    "1 energy",
    "2 slope",
    "3 release",
    "4 power",
    "5 period",
    "6 motion",
    "7 balance",
    "8 bodies",
    "9 values",
    "10 rounding",
    "11 symbols",
];

/// A case and what became of it: its report, or why there is none.
pub type Verdict<'a> = (&'a str, Result<(&'a Scene, &'a Validation), String>);

/// What a case says of one truth.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Word {
    /// Digits of agreement, of the worst finding.
    Digits(f64),
    /// The key of the finding that failed.
    Failed(String),
    /// Why there is none.
    None(&'static str),
}

/// What a validated case says of every truth.
pub(crate) fn words(done: &Validation) -> [Word; TRUTHS.len()] {
    std::array::from_fn(|number| {
        let all = || done.outcome.findings.iter();
        let of = || all().filter(|f| f.number() == Some(number));
        if let Some(failed) = of().find(|f| !f.pass) {
            return Word::Failed(failed.key.clone());
        }
        // Double precision has no more digits than its last place.
        let worst = of().map(|f| f.relative.max(f64::EPSILON));
        let worst = worst.reduce(f64::max);
        let silent = || done.silent.iter().find(|(silent, _)| *silent == number);
        match worst {
            Some(worst) => Word::Digits(-worst.log10()),
            None => Word::None(silent().map_or("nothing", |(_, why)| why)),
        }
    })
}

/// The report on all cases beside their own: `index.md` and the picture of its table, `index.png`.
///
/// # Errors
/// [`StudyError::Report`] when the picture cannot be drawn.
pub fn index(verdicts: &[Verdict<'_>]) -> Result<Files, StudyError> {
    let good = |(_, verdict): &&Verdict<'_>| match verdict {
        Ok((_, done)) => all_pass(&done.outcome.findings),
        Err(_) => false,
    };
    let mut blocks = vec![
        Block::Text(format!(
            "{} of {} cases pass. Written by Dwell {}.",
            verdicts.iter().filter(good).count(),
            verdicts.len(),
            env!("CARGO_PKG_VERSION")
        )),
        table(
            [&["Case"][..], &TRUTHS].concat(),
            verdicts.iter().map(agreement),
        ),
        Block::Text(
            "Digits of agreement: those of the worst finding of each truth, 15.7 being the last place. The findings of 5, 6 and \
             the integrated ones of 4 are of motions: they err by a factor times the tolerance of the integrator, not by rounding. \
             10 holds the numbers against the same in 32 digits, 11 against closed forms. Beside the cases: [extremes](extremes.md), \
             and [deliberate faults](faults.md) with the truths that catch them (`just faults`)."
                .to_owned(),
        ),
        Block::Figure {
            file: "index.png".to_owned(),
            alt: "Digits of agreement of every case and truth".to_owned(),
            caption: String::new(),
        },
    ];
    blocks.extend(failures(verdicts));
    blocks.push(Block::Heading("Tolerances".to_owned()));
    blocks.push(table(
        vec![
            "Case",
            "Verdict",
            "Findings",
            "Nearest to its tolerance",
            "Slack tolerances",
        ],
        verdicts.iter().map(margins),
    ));
    blocks.push(Block::Text(
        "The nearest is the largest part of a tolerance that any difference takes. A tolerance is slack above 100 times the \
         difference met plus 50 roundings times the condition number of the dense rows at the worst place. Integrated results \
         are exempt: slopes of error over tolerance, and factors of it, judge them."
            .to_owned(),
    ));
    let document = Document {
        title: "Cases".to_owned(),
        blocks,
    };
    let mut files = Files::new();
    files.add("index.md", document.markdown());
    files.add("index.png", png(&figures::overview(verdicts))?);
    Ok(files)
}

fn table(header: Vec<&str>, rows: impl Iterator<Item = Vec<String>>) -> Block {
    Block::Table {
        header: header.into_iter().map(str::to_owned).collect(),
        rows: rows.collect(),
    }
}

fn link(scene: &Scene) -> String {
    format!("[{}]({}.md)", scene.title, scene.name)
}

/// A row of the table of digits.
fn agreement((name, verdict): &Verdict<'_>) -> Vec<String> {
    match verdict {
        Ok((scene, done)) => {
            let cells = words(done).map(|word| match word {
                Word::Digits(digits) => format!("{digits:.1}"),
                Word::Failed(key) => format!("**FAIL** {key}"),
                Word::None(why) => why.to_owned(),
            });
            std::iter::once(link(scene)).chain(cells).collect()
        }
        Err(_) => vec![format!("`{name}`"), "**not validated**".to_owned()],
    }
}

/// Every failure: the equation, the place and the difference.
fn failures(verdicts: &[Verdict<'_>]) -> Vec<Block> {
    let mut text = String::new();
    for (name, verdict) in verdicts {
        match verdict {
            Ok((scene, done)) => {
                for failed in done.outcome.findings.iter().filter(|f| !f.pass) {
                    text += &format!(
                        "- `{}` {}: {}\n",
                        scene.name,
                        failed.key,
                        told(failed).join("; ")
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

/// What a failed finding has to say: the equation, the place, the difference.
pub(crate) fn told(finding: &Finding) -> [String; 3] {
    let place = match finding.over.is_empty() {
        true => finding.worst.clone(),
        false => format!("{}, of {}", finding.worst, finding.over),
    };
    let difference = if finding.relative.is_nan() {
        "none could be taken".to_owned()
    } else {
        let unit = if finding.unit.is_empty() { "" } else { " " };
        format!(
            "{:.2e}{unit}{}, {:.1e} of {}; tolerance {:.1e}",
            finding.absolute, finding.unit, finding.relative, finding.scale, finding.tolerance
        )
    };
    [
        format!("truth {}, {}", finding.truth, finding.compared),
        format!("at {place}"),
        format!("difference {difference}"),
    ]
}

/// How near the findings come to their tolerances, and how near these to the findings.
fn margins((name, verdict): &Verdict<'_>) -> Vec<String> {
    let (scene, done) = match verdict {
        Ok(validated) => validated,
        Err(reason) => {
            return vec![
                format!("`{name}`"),
                "**not validated**".to_owned(),
                String::new(),
                reason.clone(),
            ];
        }
    };
    let findings = &done.outcome.findings;
    let part = |f: &Finding| match f.relative {
        0.0 => 0.0,
        // What is no number is the worst there is.
        relative if relative.is_nan() => f64::INFINITY,
        relative => relative / f.tolerance,
    };
    let near = findings.iter().max_by(|a, b| part(a).total_cmp(&part(b)));
    let near = near.map_or(String::new(), |f| format!("{:.2} of {}", part(f), f.key));
    let passed = findings.iter().filter(|f| f.pass).count();
    let slack: Vec<&str> = findings
        .iter()
        .filter(|f| f.slack())
        .map(|f| f.key.as_str())
        .collect();
    let verdict = match all_pass(findings) {
        true => "pass",
        false => "**FAIL**",
    };
    vec![
        link(scene),
        verdict.to_owned(),
        format!("{passed} of {}", findings.len()),
        near,
        match slack.is_empty() {
            true => "none".to_owned(),
            false => slack.join(", "),
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_scene::Scene;

    fn finding(truth: &str, relative: f64, tolerance: f64) -> Finding {
        Finding {
            key: format!("key-{}", &truth[..1]),
            truth: truth.into(),
            compared: "m with 2 E_c".into(),
            over: "24 positions".into(),
            absolute: 2.0 * relative,
            unit: "kg m2".into(),
            relative,
            scale: "the largest m".into(),
            worst: "phi = 1 rad".into(),
            tolerance,
            pass: relative <= tolerance,
            ..Finding::default()
        }
    }

    fn validation(findings: Vec<Finding>) -> Validation {
        let mut done = Validation {
            silent: vec![(5, "driven")],
            ..Validation::default()
        };
        done.outcome.findings = findings;
        done
    }

    #[test]
    fn a_truth_has_the_digits_of_its_worst_finding_or_says_why_it_has_none() {
        let done = validation(vec![
            finding("1 energy", 1e-15, 1e-14),
            finding("1 energy", 1e-13, 1e-12),
            finding("2 slope", 0.0, 1e-12),
            finding("3 release", 1e-9, 1e-12),
            finding("3 release", 1e-15, 1e-12),
        ]);
        let words = words(&done);
        assert_eq!(words[0], Word::None("nothing"));
        // A tenth of a digit is told.
        assert!(matches!(words[1], Word::Digits(d) if (d - 13.0).abs() < 0.01));
        assert!(matches!(words[2], Word::Digits(d) if (d - 15.65).abs() < 0.01));
        assert_eq!(words[3], Word::Failed("key-3".into()));
        assert_eq!(words[5], Word::None("driven"));
    }

    #[test]
    fn a_failure_names_the_equation_the_place_and_the_difference() {
        let [equation, place, difference] = told(&finding("1 energy", 3e-9, 1e-12));
        assert_eq!(equation, "truth 1 energy, m with 2 E_c");
        assert_eq!(place, "at phi = 1 rad, of 24 positions");
        assert_eq!(
            difference,
            "difference 6.00e-9 kg m2, 3.0e-9 of the largest m; tolerance 1.0e-12"
        );
        let [.., difference] = told(&finding("1 energy", f64::NAN, 1e-12));
        assert_eq!(difference, "difference none could be taken");
    }

    #[test]
    fn the_index_tells_failures_slack_and_what_was_not_validated() {
        let text = "[bodies.ground]\npoints = { A = [0, 0] }\n[bodies.bar]\npoints = { A = [0, 0] }\n\
                    [joints]\nA = { revolute = [\"ground.A\", \"bar.A\"] }\n[actuators]\nphi = { angle = [\"ground\", \"bar\"] }";
        let scene = Scene::parse("bar.toml", text).unwrap();
        let done = validation(vec![
            finding("1 energy", 1e-16, 1e-9),
            finding("2 slope", 1e-9, 1e-12),
        ]);
        let verdicts = [
            ("cases/bar", Ok((&scene, &done))),
            ("cases/lost", Err("it cannot be read".to_owned())),
        ];
        let files = index(&verdicts).unwrap();
        let text = files.iter().find(|(path, _)| path.ends_with("index.md"));
        let text = String::from_utf8(text.unwrap().1.to_vec()).unwrap();
        for part in [
            "0 of 2 cases pass",
            "| 15.7 | **FAIL** key-2 |",
            "| driven |",
            "- `bar` key-2: truth 2 slope, m with 2 E_c; at phi = 1 rad, of 24 positions; difference 2.00e-9 kg m2",
            "| 1 of 2 | 1000.00 of key-2 | key-1 |",
            "| `cases/lost` | **not validated** |",
            "- `cases/lost`: it cannot be read",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        assert!(
            files
                .iter()
                .any(|(path, bytes)| path.ends_with("index.png") && !bytes.is_empty())
        );
    }
}
