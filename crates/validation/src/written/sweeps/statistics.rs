//! Statistics of the rows of a sweep, against its summary and its sentences.

use crate::written::poses::difference::Differences;
use crate::written::poses::rows::Rows;
use crate::written::poses::stated::{Expected, result as number, sentence_differences};
use serde_json::Value;

/// What the rows say of a result, by the names of the summary; none without rows.
fn statistics(column: &[f64]) -> Option<[(&'static str, f64); 8]> {
    let mut sorted = column.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let mean = sorted.iter().sum::<f64>() / n;
    let square = |about: f64| sorted.iter().map(|x| (x - about).powi(2)).sum::<f64>();
    // Type 7 of Hyndman and Fan (1996), as spreadsheets take it.
    let quantile = |p: f64| {
        let place = p * (n - 1.0);
        let [low, high] = [place.floor(), place.ceil()].map(|k| sorted[k as usize]);
        low * (1.0 - place.fract()) + high * place.fract()
    };
    let deviation = (square(mean) / (n - 1.0)).sqrt();
    Some([
        ("smallest", *sorted.first()?),
        ("largest", *sorted.last()?),
        ("mean", mean),
        ("rms", (square(0.0) / n).sqrt()),
        ("standard_deviation", deviation),
        ("mean.standard_error", deviation / n.sqrt()),
        ("quantile_2.5", quantile(0.025)),
        ("quantile_97.5", quantile(0.975)),
    ])
}

/// The findings over the statistics of some results.
#[derive(Debug, Default)]
pub(super) struct Stated {
    pub(super) summary: Differences,
    pub(super) sentences: Differences,
}

impl Stated {
    /// Compares what the summary and the sentences state of a result with its column, and where it is smallest and largest.
    pub(super) fn add(
        &mut self,
        (summary, printed): (&Value, &str),
        rows: &Rows,
        (result, inputs): (&str, &[String]),
    ) {
        let column = rows.column(result);
        let Some(found) = statistics(column) else {
            self.summary.fail(format!("the rows have no {result}"));
            return;
        };
        let [(_, smallest), (_, largest), ..] = found;
        let scale = smallest.abs().max(largest.abs());
        let numbers = found.map(|(what, value)| (what.to_owned(), value, scale));
        let mut places = Vec::new();
        for (end, value) in [("smallest", smallest), ("largest", largest)] {
            // Where a result is always the same, it has no place.
            let inputs = inputs.iter().filter(|_| smallest < largest);
            let row = column.iter().position(|x| *x == value).unwrap_or(0);
            places.extend(inputs.map(|input| {
                let expected = rows.get(row, input).unwrap_or(f64::NAN);
                (format!("{end}.{input}"), expected, expected)
            }));
        }
        for (what, expected, scale) in numbers.iter().chain(&places) {
            let name = format!("{result}.{what}");
            match number(summary, &name) {
                Some(stated) => self.summary.add(stated - expected, *scale, "", || name),
                None => self.summary.fail(format!("the summary has no {name}")),
            }
        }
        let places: Vec<Expected> = places.into_iter().map(|(_, at, size)| (at, size)).collect();
        self.add_sentences(printed, &format!("{result} ["), found, places);
    }

    /// The line that begins with a result, and the one below it about its places.
    fn add_sentences(
        &mut self,
        printed: &str,
        start: &str,
        found: [(&'static str, f64); 8],
        places: Vec<Expected>,
    ) {
        let [smallest, largest, mean, _, deviation, error, low, high] = found.map(|(_, x)| x);
        let values = [smallest, largest, mean, error, deviation, 95.0, low, high];
        let values = values.map(|value| (value, value)).to_vec();
        let line = [(start.to_owned(), values)];
        self.sentences
            .merge(sentence_differences(printed, &line, "sweep"));
        if !places.is_empty() {
            let below = printed.split(start).nth(1).unwrap_or("");
            let line = [("smallest at ".to_owned(), places)];
            self.sentences
                .merge(sentence_differences(below, &line, "sweep"));
        }
    }
}
