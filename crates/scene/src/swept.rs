//! The section `[sweep]`: named parameters, numbers that are tied to others, and limits of results. It changes no other analysis.

use crate::expression::expression;
use crate::keys::table;
use crate::number_paths::{SceneNumber, no_number};
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::value::Value;
use crate::wording::shorten;
use dwell_laws::Expression;

/// The beginning of the path of every parameter.
pub(crate) const PARAMETERS: &str = "sweep.parameters.";

/// What `[sweep]` says about the variants of a scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SweepSection {
    /// The numbers that follow from others.
    pub tied: Vec<TiedNumber>,
    /// The limits of results.
    pub limits: Vec<ResultLimit>,
    /// The tables of values that quantities should have.
    pub targets: Vec<SweepTarget>,
}

/// A number that follows from others.
#[derive(Debug, Clone, PartialEq)]
pub struct TiedNumber {
    /// The path of the number.
    pub path: String,
    /// The expression as written.
    pub text: String,
    /// The expression of the [variables](Expression::variables) that occur in it: paths of numbers and names of parameters.
    pub expression: Expression,
}

/// A table of values that quantities should have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SweepTarget {
    /// Its name, with which its results begin.
    pub name: String,
    /// The file of the table, beside that of the scene.
    pub table: String,
    /// The column at whose values the others should have theirs.
    pub at: Option<String>,
}

/// A limit of a result: a variant beyond it is left out.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultLimit {
    /// The name of the result.
    pub result: String,
    /// Whether it is an upper limit.
    pub is_upper: bool,
    /// In the unit of the result.
    pub limit: f64,
}

impl ResultLimit {
    /// Reads `RESULT <= LIMIT` or `RESULT >= LIMIT`; the limit is a number or an expression without variables.
    ///
    /// # Errors
    /// Why it is none.
    pub fn parse(text: &str) -> Result<Self, String> {
        let upper = text.split_once("<=").map(|parts| (parts, true));
        let parts = upper.or_else(|| text.split_once(">=").map(|parts| (parts, false)));
        let ((result, limit), is_upper) =
            parts.ok_or("a limit is `RESULT <= LIMIT` or `RESULT >= LIMIT`")?;
        let (result, limit) = (result.trim(), limit.trim());
        let value = Expression::parse(limit, &[]).map_err(|error| error.message)?;
        if result.is_empty() {
            return Err("the name of the result is missing".to_owned());
        }
        Ok(Self {
            result: result.to_owned(),
            is_upper,
            limit: value.eval(&[]),
        })
    }
}

impl std::fmt::Display for ResultLimit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let sign = if self.is_upper { "<=" } else { ">=" };
        write!(f, "{} {sign} {}", self.result, self.limit)
    }
}

/// The names that expressions know: of all parameters, and the paths of all numbers.
pub(crate) fn variables<'n>(
    numbers: impl Iterator<Item = &'n SceneNumber> + Clone,
) -> Vec<&'n str> {
    let names = numbers.map(|number| number.path.as_str());
    let parameters = names.clone().filter_map(|p| p.strip_prefix(PARAMETERS));
    parameters.chain(names).collect()
}

/// Reads `[sweep]` of a scene with these numbers.
pub(crate) fn sweep_section(fields: &TableReader<'_>, numbers: &[&SceneNumber]) -> SweepSection {
    fields.reject_unknown_keys(table("sweep"));
    let entries = |key: &str| {
        let table = TableReader::open(fields.get(key)?, format!("`{key}` of [sweep]"))?;
        Some(table.entries)
    };
    for entry in entries("parameters").unwrap_or_default() {
        // It is one of the numbers, by its path.
        let what = format!("parameter `{}`", shorten(entry.name));
        entry.value.number(what);
    }
    let limits = fields.get("subject-to").and_then(|entry| {
        let expected = "an array such as [\"m.max <= 2\"]";
        entry.value.array(expected, "`subject-to` of [sweep]")
    });
    SweepSection {
        tied: tied_numbers(
            &entries("tied").unwrap_or_default(),
            numbers,
            &SceneLocation::Tied,
        ),
        limits: limits_of(&limits.unwrap_or_default()),
        targets: targets(&entries("targets").unwrap_or_default()),
    }
}

/// The tied numbers of some entries, each with its place.
pub(crate) fn tied_numbers(
    entries: &[Entry<'_>],
    numbers: &[&SceneNumber],
    place: &dyn Fn(usize) -> SceneLocation,
) -> Vec<TiedNumber> {
    let variables = variables(numbers.iter().copied());
    let mut found = Vec::new();
    for entry in entries {
        if !numbers.iter().any(|number| number.path == entry.name) {
            let (message, help) = no_number(entry.name, numbers.iter().copied());
            entry.reject::<()>(message, "unknown number", help);
            continue;
        }
        let what = format!("tied number `{}`", shorten(entry.name));
        if let Some(expression) = expression(entry.value, &variables, &what)
            && let Some(text) = entry.value.string(&what)
        {
            entry.place(place(found.len()));
            found.push(TiedNumber {
                path: entry.name.to_owned(),
                text: text.to_owned(),
                expression: expression.retain_used(),
            });
        }
    }
    found
}

fn targets(entries: &[Entry<'_>]) -> Vec<SweepTarget> {
    let mut found = Vec::new();
    for entry in entries {
        let what = format!("target `{}`", shorten(entry.name));
        let Some(of) = TableReader::open(entry, what) else {
            continue;
        };
        of.reject_unknown_keys(table("target"));
        let help = "name its file: `table = \"curve.csv\"`";
        let text = |e: &Entry<'_>| e.value.string(of.name_of(e)).map(str::to_owned);
        if let Some(table) = of.require("table", help).and_then(text) {
            entry.place(SceneLocation::Target(found.len()));
            found.push(SweepTarget {
                name: entry.name.to_owned(),
                table,
                at: of.get("at").and_then(text),
            });
        }
    }
    found
}

fn limits_of(values: &[Value<'_>]) -> Vec<ResultLimit> {
    let mut found = Vec::new();
    for value in values {
        let Some(text) = value.string("a limit in [sweep]") else {
            continue;
        };
        match ResultLimit::parse(text) {
            Ok(limit) => {
                let location = SceneLocation::Limit(found.len());
                value.log().place(location, &value.span());
                found.push(limit);
            }
            Err(message) => {
                let help = "write it as `m.max <= 2`, in the unit of the result";
                value.reject::<()>(message, "no limit", help);
            }
        }
    }
    found
}
