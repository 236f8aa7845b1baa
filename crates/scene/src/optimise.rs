//! The section `[optimise]`: jobs that search the best design. It changes no other analysis.

use crate::keys::table;
use crate::number_paths::{SceneNumber, no_number};
use crate::spans::{JobPart, SceneLocation};
use crate::swept::{PARAMETERS, TiedNumber, tied_numbers};
use crate::table_reader::{Entry, TableReader};
use crate::value::Value;
use crate::wording::shorten;

/// A search for the best design.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OptimiseJob {
    /// Its name.
    pub name: String,
    /// The numbers that vary.
    pub vary: Vec<VariedNumber>,
    /// The numbers that follow from them, besides those of `[sweep]`.
    pub tied: Vec<TiedNumber>,
    /// The goal as a sum: expressions of results, with their weights.
    pub minimise: Vec<(String, f64)>,
    /// Instead of a goal, two results of which none can be made smaller without the other growing.
    pub front: Vec<String>,
    /// The conditions as written.
    pub subject_to: Vec<String>,
    /// The number of starts.
    pub starts: Option<usize>,
    /// The number of random designs among which the starts are chosen.
    pub pool: Option<usize>,
    /// The tables of parts from which one is chosen each.
    pub choose: Vec<Choice>,
}

/// A number that varies between two bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct VariedNumber {
    /// Its path.
    pub path: String,
    /// The smallest and the largest value, in the unit of the number.
    pub bounds: [f64; 2],
}

/// A part that is chosen from a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Choice {
    /// The name of the part.
    pub name: String,
    /// The file of the table, beside that of the scene.
    pub table: String,
}

/// Reads `[optimise]` of a scene with these numbers.
pub(crate) fn optimise_section(
    fields: &TableReader<'_>,
    numbers: &[&SceneNumber],
) -> Vec<OptimiseJob> {
    let mut jobs = Vec::new();
    for entry in &fields.entries {
        entry.place(SceneLocation::Job(jobs.len()));
        let what = format!("job `{}`", shorten(entry.name));
        if let Some(fields) = TableReader::open(entry, what) {
            let job = JobReader {
                fields: &fields,
                numbers,
                number: jobs.len(),
            };
            jobs.extend(job.read(entry));
        }
    }
    jobs
}

/// The reader of a job.
struct JobReader<'r> {
    fields: &'r TableReader<'r>,
    numbers: &'r [&'r SceneNumber],
    /// Its number among the jobs.
    number: usize,
}

impl JobReader<'_> {
    fn read(&self, entry: &Entry<'_>) -> Option<OptimiseJob> {
        let fields = self.fields;
        fields.reject_unknown_keys(table("optimise-job"));
        let help = "name numbers with their bounds: `vary = { \"crank.points.B[0]\" = [80, 120] }`";
        let vary = fields.require("vary", help).map(|e| self.vary(e));
        let tied = self.entries("tied");
        let tied = tied_numbers(&tied, self.numbers, &|k| self.place(JobPart::Tied, k));
        let minimise = fields
            .get("minimise")
            .map_or_else(Vec::new, |e| self.goal(e));
        let front = self.texts(
            "front",
            "an array such as [\"m.max\", \"A.max_abs\"]",
            JobPart::Goal,
        );
        if minimise.is_empty() && front.is_empty() {
            let help = "write `minimise = \"m.max\"` or `front = [\"m.max\", \"A.max_abs\"]`";
            entry.reject::<()>("the job has no goal".to_owned(), "no goal", help);
        }
        let expected = "an array such as [\"m.max <= 2\"]";
        let subject_to = self.texts("subject-to", expected, JobPart::Condition);
        let choices = self.entries("choose");
        let choose = choices.iter().enumerate().filter_map(|(k, e)| {
            e.place(self.place(JobPart::Choice, k));
            let what = format!("table of `{}`", shorten(e.name));
            Some(Choice {
                name: e.name.to_owned(),
                table: e.value.string(what)?.to_owned(),
            })
        });
        let count = |key: &str| {
            let e = fields.get(key)?;
            e.value.count(fields.name_of(e))
        };
        Some(OptimiseJob {
            name: entry.name.to_owned(),
            vary: vary?,
            tied,
            minimise,
            front,
            subject_to,
            starts: count("starts"),
            pool: count("pool"),
            choose: choose.collect(),
        })
    }

    fn place(&self, part: JobPart, k: usize) -> SceneLocation {
        SceneLocation::JobPart(self.number, part, k)
    }

    /// The entries of a table of the job.
    fn entries(&self, key: &str) -> Vec<Entry<'_>> {
        let entry = self.fields.get(key);
        let of = entry.and_then(|e| TableReader::open(e, self.fields.name_of(e)));
        of.map_or_else(Vec::new, |of| of.entries)
    }

    fn vary(&self, entry: &Entry<'_>) -> Vec<VariedNumber> {
        let Some(of) = TableReader::open(entry, self.fields.name_of(entry)) else {
            return Vec::new();
        };
        let mut found = Vec::new();
        for entry in &of.entries {
            let is_named = |n: &&&SceneNumber| {
                n.path == entry.name || n.path.strip_prefix(PARAMETERS) == Some(entry.name)
            };
            if !self.numbers.iter().any(|n| is_named(&n)) {
                let (message, help) = no_number(entry.name, self.numbers.iter().copied());
                entry.reject::<()>(message, "unknown number", help);
                continue;
            }
            let what = format!("bounds of `{}`", shorten(entry.name));
            let ends = ["the smallest value", "the largest value"];
            let bounds = entry
                .value
                .pair_of("[from, to]", &what, ends, |value, what| value.number(what));
            let Some([from, to]) = bounds else {
                continue;
            };
            if from >= to {
                let message = format!("{what}: the smallest value is not below the largest");
                entry
                    .value
                    .reject::<()>(message, "no room", "write [from, to]");
                continue;
            }
            entry.place(self.place(JobPart::Vary, found.len()));
            found.push(VariedNumber {
                path: entry.name.to_owned(),
                bounds: [from, to],
            });
        }
        found
    }

    /// A goal as one expression, or as a table of weights.
    fn goal(&self, entry: &Entry<'_>) -> Vec<(String, f64)> {
        let what = self.fields.name_of(entry);
        entry.place(self.place(JobPart::Goal, 0));
        if !matches!(entry.value.get(), toml::de::DeValue::Table(_)) {
            let goal = entry.value.string(what);
            return goal
                .map(|goal| (goal.to_owned(), 1.0))
                .into_iter()
                .collect();
        }
        let weights = self.entries("minimise");
        let weight = |(k, e): (usize, &Entry<'_>)| {
            e.place(self.place(JobPart::Goal, k));
            let what = format!("weight of `{}`", shorten(e.name));
            Some((e.name.to_owned(), e.value.number(what)?))
        };
        weights.iter().enumerate().filter_map(weight).collect()
    }

    fn texts(&self, key: &str, expected: &str, part: JobPart) -> Vec<String> {
        let Some(entry) = self.fields.get(key) else {
            return Vec::new();
        };
        let what = self.fields.name_of(entry);
        let values: Vec<Value<'_>> = entry.value.array(expected, &what).unwrap_or_default();
        let text = |(k, value): (usize, &Value<'_>)| {
            value.log().place(self.place(part, k), &value.span());
            Some(value.string(&what)?.to_owned())
        };
        values.iter().enumerate().filter_map(text).collect()
    }
}
