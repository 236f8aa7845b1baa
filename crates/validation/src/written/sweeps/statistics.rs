//! Statistics of the rows of a sweep, against its summary.

use crate::written::poses::difference::Differences;
use crate::written::poses::rows::Rows;
use serde_json::Value;

/// Compares what the summary states of a result with its column, and where it is smallest and largest.
pub(super) fn add_statistics(
    to: &mut Differences,
    summary: &Value,
    rows: &Rows,
    (result, inputs): (&str, &[String]),
) {
    let Some(column) = rows.columns.get(result) else {
        to.fail(format!("the rows have no {result}"));
        return;
    };
    let mut sorted = column.clone();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let mean = sorted.iter().sum::<f64>() / n;
    let square = |about: f64| sorted.iter().map(move |x| (x - about) * (x - about)).sum();
    let (about_mean, about_zero): (f64, f64) = (square(mean), square(0.0));
    let deviation = (about_mean / (n - 1.0)).sqrt();
    // Type 7 of Hyndman and Fan (1996), as spreadsheets take it.
    let quantile = |p: f64| {
        let place = p * (n - 1.0);
        let [low, high] = [place.floor(), place.ceil()].map(|k| sorted[k as usize]);
        low * (1.0 - place.fract()) + high * place.fract()
    };
    let [smallest, largest] = [sorted[0], sorted[sorted.len() - 1]];
    let mut compare = |what: &str, expected: f64| {
        let name = format!("{result}.{what}");
        match summary["results"][&name]["value"].as_f64() {
            Some(stated) => {
                let scale = smallest.abs().max(largest.abs());
                to.add(stated - expected, scale, "", || name.clone());
            }
            None => to.fail(format!("the summary has no {name}")),
        }
    };
    compare("smallest", smallest);
    compare("largest", largest);
    compare("mean", mean);
    compare("rms", (about_zero / n).sqrt());
    compare("standard_deviation", deviation);
    compare("mean.standard_error", deviation / n.sqrt());
    compare("quantile_2.5", quantile(0.025));
    compare("quantile_97.5", quantile(0.975));
    for (end, value) in [("smallest", smallest), ("largest", largest)] {
        let row = column.iter().position(|x| *x == value).unwrap_or(0);
        for input in inputs {
            let name = format!("{result}.{end}.{input}");
            let stated = summary["results"][&name]["value"].as_f64();
            let expected = rows.get(row, input).unwrap_or(f64::NAN);
            match stated {
                Some(stated) => to.add(stated - expected, expected, "", || name),
                // Where a result is always the same, it has no place.
                None if smallest == largest => {}
                None => to.fail(format!("the summary has no {name}")),
            }
        }
    }
}
