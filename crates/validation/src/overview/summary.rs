//! The verdict: whether all passed, the finding nearest to its tolerance, and the results of the paper's mechanism.

use super::{ValidatedCase, ValidationRun};
use crate::report_parts::{margin, margin_text, nearest, table};
use crate::{audit, export_study};
use dwell_findings::{Check, Finding};
use dwell_report::{Block, Document, Tile, markdown_text};

/// The period that the source paper prints for its mechanism, s.
const PUBLISHED_PERIOD: &str = "5.42";
/// The first check of written files.
const FIRST_WRITTEN: Check = Check::WrittenPositions;

/// The number of judged and passed items of one kind.
pub(super) struct Tally {
    name: &'static str,
    passed: usize,
    of: usize,
    note: &'static str,
}

impl Tally {
    fn new(name: &'static str, results: impl Iterator<Item = bool>, note: &'static str) -> Self {
        let (mut passed, mut of) = (0, 0);
        for result in results {
            passed += usize::from(result);
            of += 1;
        }
        Self {
            name,
            passed,
            of,
            note,
        }
    }

    fn counts(&self) -> String {
        format!("{} of {}", self.passed, self.of)
    }

    fn passes(&self) -> bool {
        self.passed == self.of
    }
}

impl<'a> ValidationRun<'a> {
    /// All findings with the name of their case or study.
    fn findings(&self) -> impl Iterator<Item = (&'a str, &'a Finding)> {
        let cases = self.cases.iter().filter_map(|case| {
            let done: &'a _ = *case.result.as_ref().ok()?;
            Some((case.name, &done.outcome.findings[..]))
        });
        let studies = self.studies.iter().copied();
        let all: Vec<(&'a str, &'a [Finding])> = cases.chain(studies).collect();
        all.into_iter()
            .flat_map(|(name, findings)| findings.iter().map(move |f| (name, f)))
    }

    /// The judged items by kind, without empty kinds.
    pub(super) fn tallies(&self) -> Vec<Tally> {
        let cases = |in_space: bool| {
            let cases = self.cases.iter().filter(move |c| c.in_space == in_space);
            cases.map(ValidatedCase::passes)
        };
        let written = self
            .findings()
            .map(|(_, f)| f)
            .filter(|f| f.check >= FIRST_WRITTEN);
        let mut tallies = vec![
            Tally::new("cases in the plane", cases(false), "up to 21 checks"),
            Tally::new("in space", cases(true), "by the same checks"),
            Tally::new(
                "written files",
                written.map(|f| f.pass),
                "read back and checked",
            ),
        ];
        for &(name, findings) in &self.studies {
            let note = match name {
                export_study::NAME => "tables of other programs",
                audit::NAME => "by a reader that shares nothing",
                _ => "against closed forms",
            };
            tallies.push(Tally::new(name, findings.iter().map(|f| f.pass), note));
        }
        tallies.extend(self.manual.map(|[passed, of]| Tally {
            name: "manual",
            passed,
            of,
            note: "capabilities with evidence",
        }));
        tallies.retain(|tally| tally.of > 0);
        tallies
    }

    /// The finding of a case that is nearest to its tolerance, with the name of the case; failing ones, also of studies, come first.
    /// Passing findings of studies are excluded, because studies are designed to reach their requirements closely.
    pub(super) fn nearest(&self) -> Option<(&'a str, &'a Finding)> {
        let is_case = |name: &str| self.cases.iter().any(|case| case.name == name);
        let counted = self.findings().filter(|(name, f)| !f.pass || is_case(name));
        let worst = nearest(counted.map(|(_, f)| f))?;
        self.findings().find(|(_, f)| std::ptr::eq(*f, worst))
    }

    /// The verdict in one line; a failure names case and check.
    pub(super) fn headline(&self) -> String {
        let lost = self.cases.iter().find(|case| case.result.is_err());
        let failing = self.nearest().filter(|(_, f)| !f.pass);
        let tallies = self.tallies();
        let more = |failed: usize| match failed {
            0 => String::new(),
            more => format!(", and {more} more"),
        };
        if let Some((name, f)) = failing {
            let failed = self.findings().filter(|(_, f)| !f.pass).count();
            let more = more(failed - 1);
            return format!("FAIL: {name}, check {}, {}{more}", f.check, f.key);
        }
        if let Some(case) = lost {
            return format!("FAIL: {} could not be validated", case.name);
        }
        match tallies.iter().find(|tally| !tally.passes()) {
            Some(tally) => format!("FAIL: {} {}", tally.counts(), tally.name),
            None => {
                let tallies = tallies.iter().take(2);
                let counts = tallies.map(|tally| format!("{} {}", tally.counts(), tally.name));
                format!("PASS: {}", counts.collect::<Vec<_>>().join(", "))
            }
        }
    }

    /// The key numbers of the paper's mechanism: its period, the drift of its energy, the unit runs compared with the kinetic energy.
    pub(super) fn paper(&self) -> Vec<Tile> {
        let case = self
            .cases
            .iter()
            .find(|case| case.name == export_study::CASE);
        let Some(done) = case.and_then(|case| case.result.as_ref().ok()) else {
            return Vec::new();
        };
        let finding = |key: &str| done.outcome.findings.iter().find(|f| f.key == key);
        let mut numbers = done.outcome.record.numbers.iter();
        let period = numbers.find(|number| number.name == "period");
        let period = period.zip(finding("period-bdf")).map(|(period, f)| {
            let note = format!(
                "computed by quadrature: {:.9} s; paper: {PUBLISHED_PERIOD} s; adaptive BDF is {:.1e} of it off",
                period.value, f.relative_difference
            );
            Tile::new(
                "period, single-dwell of the paper",
                format!("{:.2} s", period.value),
                note,
            )
        });
        let drift = finding("energy-bdf").map(|f| {
            let note =
                "largest, of the kinetic energy, by adaptive BDF with relative tolerance 1e-13";
            Tile::new(
                "energy drift",
                format!("{:.1e}", f.relative_difference),
                note,
            )
        });
        let unit_runs = finding("half-dm-differences").zip(finding("m-energy")).map(|(slope, m)| {
            let note = format!(
                "relative difference of ½m′ from differences of the kinetic energy; of m: {:.1e}",
                m.relative_difference
            );
            Tile::new(
                "unit runs",
                format!("{:.1e}", slope.relative_difference),
                note,
            )
        });
        [period, drift, unit_runs].into_iter().flatten().collect()
    }
}

/// The verdict in twenty lines: the first states whether all passed, the third which finding is nearest to its tolerance.
pub(super) fn document(judged: &ValidationRun<'_>) -> Document {
    let nearest = judged.nearest().map_or_else(String::new, |(name, f)| {
        let words = if f.pass { "Nearest to its tolerance" } else { "Worst" };
        format!(
            "{words}: **{name}**, check {}, `{}`: margin **{}** (difference {:.1e}, tolerance {:.1e}).",
            f.check,
            f.key,
            margin_text(margin(f)),
            f.relative_difference,
            f.tolerance
        )
    });
    let rows = judged.tallies().into_iter().map(|tally| {
        let result = if tally.passes() { "pass" } else { "**FAIL**" };
        vec![
            tally.name.to_owned(),
            result.to_owned(),
            tally.counts(),
            tally.note.to_owned(),
        ]
    });
    let paper = judged
        .paper()
        .into_iter()
        .map(|tile| format!("{} **{}** ({})", tile.name, tile.value, tile.note));
    let paper: Vec<String> = paper.collect();
    let mut blocks = vec![
        Block::Text(nearest),
        table(&["Part", "Result", "Passed", "How"], rows),
        Block::Text(format!("{}.", paper.join("; "))),
        Block::Figure {
            file: "index.png".to_owned(),
            alt: "Verdict, and margins of every case and check".to_owned(),
            caption: String::new(),
        },
        Block::Text(format!(
            "[All cases](cases.md) · [manual](manual.md) · [extremes](extremes.md) · [in other forms](extremes-forms.md) · [exported runs](exported-runs.md) · [mutations](mutations.md) · [pulses](pulses.md) · [machines](machines.md) · Dwell {}",
            env!("CARGO_PKG_VERSION")
        )),
    ];
    if paper.is_empty() {
        blocks.remove(2);
    }
    if let Some(why) = &judged.no_reader {
        let text = format!("Independent reader: not run ({}).", markdown_text(why));
        blocks.insert(2, Block::Text(text));
    }
    Document {
        title: judged.headline(),
        blocks,
    }
}

/// The kinds as tiles, and the numbers.
pub(super) fn tiles(judged: &ValidationRun<'_>) -> [Vec<Tile>; 2] {
    let tallies = judged.tallies().into_iter().map(|tally| {
        let passed = tally.passes();
        Tile::new(tally.name, tally.counts(), tally.note).with_result(passed)
    });
    let nearest = judged.nearest().map(|(name, f)| {
        let value = if f.pass {
            margin_text(margin(f))
        } else {
            "FAIL".to_owned()
        };
        let by = if f.pass {
            String::new()
        } else {
            format!(
                ": difference {:.1e}, tolerance {:.1e}",
                f.relative_difference, f.tolerance
            )
        };
        let note = format!("{name}, check {}, {}{by}", f.check, f.key);
        let words = if f.pass { "least margin" } else { "worst" };
        Tile::new(words, value, note).with_result(f.pass)
    });
    [
        tallies.collect(),
        nearest.into_iter().chain(judged.paper()).collect(),
    ]
}
