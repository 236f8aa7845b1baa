//! Statistics of the rows of a sweep, against its summary and its sentences.

use crate::written::poses::difference::Differences;
use crate::written::poses::rows::Rows;
use crate::written::poses::stated::{Expected, result as number, sentence_differences};
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

    /// All of them by their names in the summary.
    fn numbers(&self) -> [(&'static str, f64); 8] {
        [
            ("smallest", self.smallest),
            ("largest", self.largest),
            ("mean", self.mean),
            ("rms", self.rms),
            ("standard_deviation", self.deviation),
            ("mean.standard_error", self.deviation / self.count.sqrt()),
            ("quantile_2.5", self.quantiles[0]),
            ("quantile_97.5", self.quantiles[1]),
        ]
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
        let column = rows.column(result);
        let Some(found) = Statistics::of(column) else {
            self.summary.fail(format!("the rows have no {result}"));
            return;
        };
        let scale = found.smallest.abs().max(found.largest.abs());
        let numbers = found
            .numbers()
            .map(|(what, value)| (what.to_owned(), value, scale));
        let mut places = Vec::new();
        for (end, value) in [("smallest", found.smallest), ("largest", found.largest)] {
            // Where a result is always the same, it has no place.
            let inputs = inputs.iter().filter(|_| found.smallest < found.largest);
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
        self.add_sentences(printed, &format!("{result} ["), &found, places);
    }

    /// The line that begins with a result, and the one below it about its places.
    fn add_sentences(
        &mut self,
        printed: &str,
        start: &str,
        found: &Statistics,
        places: Vec<Expected>,
    ) {
        let order = [
            "smallest",
            "largest",
            "mean",
            "mean.standard_error",
            "standard_deviation",
        ];
        let numbers = found.numbers();
        let of = |what: &str| {
            numbers
                .iter()
                .find(|(name, _)| *name == what)
                .map(|(_, x)| *x)
        };
        let mut values: Vec<f64> = order.into_iter().filter_map(of).collect();
        values.push(95.0);
        values.extend(found.quantiles);
        let values = values.into_iter().map(|value| (value, value));
        let line = [(start.to_owned(), values.collect())];
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
