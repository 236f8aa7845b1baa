//! The summary for programs, `NAME-COMMAND.json`.

use serde_json::Value;

/// A number of the summary, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SummaryNumber {
    pub(crate) value: f64,
    pub(crate) unit: String,
    /// NaN where none is known.
    pub(crate) estimated_error: f64,
}

/// The largest and the smallest value of a column, each with where.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SummaryExtrema {
    pub(crate) quantity: String,
    pub(crate) unit: String,
    /// Value and abscissa.
    pub(crate) min: [f64; 2],
    pub(crate) max: [f64; 2],
    pub(crate) estimated_error: f64,
}

/// The summary as it was read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Summary {
    root: Value,
}

impl Summary {
    /// # Errors
    /// That it is no JSON, or of another format.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        let root: Value = serde_json::from_str(text).map_err(|e| format!("no JSON: {e}"))?;
        match root["format"].as_str() {
            Some("dwell-summary-1") => Ok(Self { root }),
            format => Err(format!("the summary's format is {format:?}")),
        }
    }

    /// The exit status that it states.
    pub(crate) fn status(&self) -> Option<i64> {
        self.root["status"].as_i64()
    }

    /// The names of all results.
    pub(crate) fn result_names(&self) -> impl Iterator<Item = &str> {
        let results = self.root["results"].as_object().into_iter().flatten();
        results.map(|(name, _)| name.as_str())
    }

    /// A result by name.
    pub(crate) fn result(&self, name: &str) -> Option<SummaryNumber> {
        let of = self.root["results"].get(name)?;
        Some(SummaryNumber {
            value: number(&of["value"]),
            unit: of["unit"].as_str().unwrap_or_default().to_owned(),
            estimated_error: number(&of["estimated_error"]),
        })
    }

    /// The extrema of all columns.
    pub(crate) fn extrema(&self) -> Vec<SummaryExtrema> {
        let all = self.root["extrema"].as_array().into_iter().flatten();
        let end = |of: &Value| [number(&of["value"]), number(&of["at"])];
        all.map(|of| SummaryExtrema {
            quantity: of["quantity"].as_str().unwrap_or_default().to_owned(),
            unit: of["unit"].as_str().unwrap_or_default().to_owned(),
            min: end(&of["min"]),
            max: end(&of["max"]),
            estimated_error: number(&of["estimated_error"]),
        })
        .collect()
    }

    /// The events: name and time, s.
    pub(crate) fn events(&self) -> Vec<(String, f64)> {
        let all = self.root["events"].as_array().into_iter().flatten();
        let event = |of: &Value| {
            (
                of["name"].as_str().unwrap_or_default().to_owned(),
                number(&of["t"]),
            )
        };
        all.map(event).collect()
    }

    /// The printed summary, line by line.
    pub(crate) fn printed(&self) -> Vec<&str> {
        let all = self.root["printed"].as_array().into_iter().flatten();
        all.filter_map(Value::as_str).collect()
    }

    /// The files that it names.
    pub(crate) fn files(&self) -> Vec<&str> {
        let all = self.root["files"].as_array().into_iter().flatten();
        all.filter_map(Value::as_str).collect()
    }

    /// Anything else.
    pub(crate) fn root(&self) -> &Value {
        &self.root
    }
}

/// A number, or one of the words for what is not finite.
fn number(value: &Value) -> f64 {
    match value.as_str() {
        Some("inf") => f64::INFINITY,
        Some("-inf") => f64::NEG_INFINITY,
        _ => value.as_f64().unwrap_or(f64::NAN),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_extrema_and_events_are_read() {
        let text = r#"{ "format": "dwell-summary-1", "status": 1,
            "results": { "period": { "value": 5.5, "unit": "s", "estimated_error": "inf" } },
            "extrema": [{ "quantity": "A.x", "unit": "N", "min": { "value": -1, "at": 0.5 }, "max": { "value": 2, "at": 1 } }],
            "events": [{ "name": "stop", "t": 0.25 }], "printed": ["one"], "files": ["a.csv"] }"#;
        let summary = Summary::read(text).unwrap();
        let period = summary.result("period").unwrap();
        assert_eq!((period.value, period.unit.as_str()), (5.5, "s"));
        assert!(period.estimated_error.is_infinite() && summary.result("speed").is_none());
        assert_eq!(summary.result_names().collect::<Vec<_>>(), ["period"]);
        assert_eq!(summary.extrema()[0].min, [-1.0, 0.5]);
        assert_eq!(summary.events(), [("stop".to_owned(), 0.25)]);
        assert_eq!(
            (summary.printed(), summary.files()),
            (vec!["one"], vec!["a.csv"])
        );
        assert_eq!(summary.status(), Some(1));
        assert!(Summary::read("{}").is_err() && Summary::read("text").is_err());
    }
}
