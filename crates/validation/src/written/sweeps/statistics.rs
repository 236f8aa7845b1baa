//! Statistics of the rows of a sweep, against its summary and its sentences.

use crate::written::poses::difference::Differences;
use crate::written::poses::rows::Rows;
use crate::written::poses::stated::{Expected, sentence_differences};
use serde_json::Value;

/// What the rows say of a result.
struct Statistics {
    smallest: f64,
    largest: f64,
    mean: f64,
    rms: f64,
    deviation: f64,
    quantiles: [f64; 2],
    count: f64,
}

impl Statistics {
    fn of(column: &[f64]) -> Option<Self> {
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
        Some(Self {
            smallest: *sorted.first()?,
            largest: *sorted.last()?,
            mean,
            rms: (square(0.0) / n).sqrt(),
            deviation: (square(mean) / (n - 1.0)).sqrt(),
            quantiles: [0.025, 0.975].map(quantile),
            count: n,
        })
    }
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
        let column = rows.columns.get(result);
        let Some(found) = column.and_then(|column| Statistics::of(column)) else {
            self.summary.fail(format!("the rows have no {result}"));
            return;
        };
        let scale = found.smallest.abs().max(found.largest.abs());
        let error = found.deviation / found.count.sqrt();
        let mut compare = |what: &str, expected: f64, scale: f64| {
            let name = format!("{result}.{what}");
            match summary["results"][&name]["value"].as_f64() {
                Some(stated) => self.summary.add(stated - expected, scale, "", || name),
                None => self.summary.fail(format!("the summary has no {name}")),
            }
        };
        let [low, high] = found.quantiles;
        for (what, expected) in [
            ("smallest", found.smallest),
            ("largest", found.largest),
            ("mean", found.mean),
            ("rms", found.rms),
            ("standard_deviation", found.deviation),
            ("mean.standard_error", error),
            ("quantile_2.5", low),
            ("quantile_97.5", high),
        ] {
            compare(what, expected, scale);
        }
        // Where a result is always the same, it has no place.
        let is_constant = found.smallest == found.largest;
        let mut places: Vec<Expected> = Vec::new();
        for (end, value) in [("smallest", found.smallest), ("largest", found.largest)] {
            let row = column.and_then(|column| column.iter().position(|x| *x == value));
            for input in inputs.iter().filter(|_| !is_constant) {
                let expected = rows.get(row.unwrap_or(0), input).unwrap_or(f64::NAN);
                compare(&format!("{end}.{input}"), expected, expected);
                places.push((expected, expected));
            }
        }
        let Statistics {
            mean, deviation, ..
        } = found;
        let numbers = [
            found.smallest,
            found.largest,
            mean,
            error,
            deviation,
            95.0,
            low,
            high,
        ];
        let numbers = numbers.map(|value| (value, scale.max(value)));
        let expected = [(format!("{result} ["), numbers.to_vec())];
        self.sentences
            .merge(sentence_differences(printed, &expected, "sweep"));
        // Below its own line.
        let after = printed.split(&format!("{result} [")).nth(1).unwrap_or("");
        let expected = [("smallest at ".to_owned(), places)];
        if !is_constant {
            self.sentences
                .merge(sentence_differences(after, &expected, "sweep"));
        }
    }
}
