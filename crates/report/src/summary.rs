//! The summary of a command as JSON, for programs that read its results.

use crate::error::ReportError;
use crate::json::{FindingRecord, Number, json};
use dwell_findings::{Finding, Record, RecordedNumber};
use serde::Serialize;
use serde::ser::{SerializeMap as _, Serializer};

/// The version of the file's format. It changes with every incompatible change.
const FORMAT: &str = "dwell-summary-1";
/// Events that are listed; all of them are in the table of events.
const MAX_EVENTS: usize = 10_000;

/// The scene that a command read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SceneRecord {
    /// Its name: the base name of its files.
    pub name: String,
    /// Its title.
    pub title: String,
    /// The hash of its text.
    pub sha256: String,
}

/// A message on standard error.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Message {
    /// `error` or `warning`.
    pub severity: &'static str,
    /// The message.
    pub text: String,
    /// A suggestion.
    pub help: Option<String>,
}

/// The results of a command.
#[derive(Debug, Clone, Default)]
pub struct Summary<'a> {
    /// The name of the command.
    pub command: &'a str,
    /// The version of the program.
    pub version: &'a str,
    /// The scene, if the command reads one.
    pub scene: Option<SceneRecord>,
    /// The exit status.
    pub status: u8,
    /// The meaning of the status.
    pub status_meaning: &'a str,
    /// The numbers, extrema and events.
    pub record: Record,
    /// The checks.
    pub findings: &'a [Finding],
    /// The printed summary.
    pub printed: &'a str,
    /// The messages on standard error.
    pub messages: Vec<Message>,
    /// The files that are written, relative to the output folder.
    pub files: Vec<String>,
}

/// A number under its name.
#[derive(Serialize)]
struct NumberRecord<'a> {
    value: Number,
    unit: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    estimated_error: Option<Number>,
}

/// The numbers as one object, in their order.
struct Numbers<'a>(&'a [RecordedNumber]);

impl Serialize for Numbers<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for number in self.0 {
            let record = NumberRecord {
                value: Number(number.value),
                unit: &number.unit,
                estimated_error: number.error.map(Number),
            };
            map.serialize_entry(&number.name, &record)?;
        }
        map.end()
    }
}

#[derive(Serialize)]
struct EndRecord {
    value: Number,
    at: Number,
}

#[derive(Serialize)]
struct ExtremaRecord<'a> {
    quantity: &'a str,
    unit: &'a str,
    min: EndRecord,
    max: EndRecord,
    #[serde(skip_serializing_if = "Option::is_none")]
    estimated_error: Option<Number>,
}

#[derive(Serialize)]
struct AbscissaRecord<'a> {
    name: &'a str,
    unit: &'a str,
}

#[derive(Serialize)]
struct EventRecord<'a> {
    name: &'a str,
    t: Number,
}

/// The file: its fields are the keys of the JSON document.
#[derive(Serialize)]
struct SummaryFile<'a> {
    format: &'a str,
    program: String,
    command: &'a str,
    scene: &'a Option<SceneRecord>,
    status: u8,
    status_meaning: &'a str,
    results: Numbers<'a>,
    extrema_over: Option<AbscissaRecord<'a>>,
    extrema: Vec<ExtremaRecord<'a>>,
    event_count: usize,
    events: Vec<EventRecord<'a>>,
    findings: Vec<FindingRecord<'a>>,
    messages: &'a [Message],
    printed: Vec<&'a str>,
    files: &'a [String],
}

impl Summary<'_> {
    /// The summary as JSON. A number that is not finite becomes a word, as in [`Number`].
    ///
    /// # Errors
    ///
    /// [`ReportError::Json`], which does not occur for a summary.
    pub fn json(&self) -> Result<String, ReportError> {
        let record = &self.record;
        let events = record
            .events
            .iter()
            .take(MAX_EVENTS)
            .map(|event| EventRecord {
                name: &event.name,
                t: Number(event.t),
            });
        let end = |[value, at]: [f64; 2]| EndRecord {
            value: Number(value),
            at: Number(at),
        };
        let extrema = record.extrema.iter().map(|extrema| ExtremaRecord {
            quantity: &extrema.column.name,
            unit: &extrema.column.unit,
            min: end(extrema.ends[0]),
            max: end(extrema.ends[1]),
            estimated_error: extrema.error.map(Number),
        });
        json(&SummaryFile {
            format: FORMAT,
            program: format!("Dwell {}", self.version),
            command: self.command,
            scene: &self.scene,
            status: self.status,
            status_meaning: self.status_meaning,
            results: Numbers(&record.numbers),
            extrema_over: record.abscissa.as_ref().map(|column| AbscissaRecord {
                name: &column.name,
                unit: &column.unit,
            }),
            extrema: extrema.collect(),
            event_count: record.events.len(),
            events: events.collect(),
            findings: self.findings.iter().map(FindingRecord).collect(),
            messages: &self.messages,
            printed: self.printed.lines().collect(),
            files: &self.files,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_findings::{Column, RecordedEvent, RecordedExtrema};

    #[test]
    fn every_number_is_kept_or_named() {
        let mut record = Record::default();
        record.add_within("period", "s", 0.1, f64::INFINITY);
        record.add("largest", "N", f64::NAN);
        record.extrema.push(RecordedExtrema {
            column: Column::new("A.x", "N"),
            ends: [[-1.0, 0.25], [f64::INFINITY, 0.5]],
            error: None,
        });
        record.events.push(RecordedEvent {
            name: "impact".to_owned(),
            t: 1.0 / 3.0,
        });
        let summary = Summary {
            command: "simulate",
            version: "0",
            record,
            printed: "one\n  two\n",
            ..Summary::default()
        };
        let text = summary.json().unwrap();
        let read: serde_json::Value = serde_json::from_str(&text).unwrap();
        let period = serde_json::json!({"value": 0.1, "unit": "s", "estimated_error": "inf"});
        assert_eq!(read["results"]["period"], period);
        assert_eq!(read["results"]["largest"]["value"], "NaN");
        assert_eq!(read["extrema"][0]["max"]["value"], "inf");
        assert_eq!(read["events"][0]["t"], 1.0 / 3.0);
        assert_eq!(read["printed"], serde_json::json!(["one", "  two"]));
    }
}
