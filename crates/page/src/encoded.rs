//! A page as one JSON description and one block of numbers.

use crate::description::{
    DisplayUnit, FileLink, Page, PageColumn, PageMessage, PageScene, PageTable, Peak,
};
use crate::drawing::{Drawing, DrawnBody, DrawnPath, ForceArrow, Part};
use dwell_findings::Finding;
use serde::{Serialize, Serializer};
use std::collections::HashMap;

/// The version of the description's format. It changes with every incompatible change.
pub const FORMAT: &str = "dwell-page-3";

/// Why a page cannot be encoded.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// The columns differ in length.
    #[error("column `{key}` of the page has {found} rows, and the first has {expected}")]
    Rows {
        /// The column.
        key: String,
        /// Its rows.
        found: usize,
        /// Number of rows of the first column.
        expected: usize,
    },
    /// The description cannot be written as JSON.
    #[error("the description of the page cannot be written: {0}")]
    Json(#[from] serde_json::Error),
    /// The numbers cannot be packed.
    #[error("the numbers of the page cannot be packed: {0}")]
    Packing(#[from] std::io::Error),
}

/// A page, encoded.
#[derive(Debug, Clone, PartialEq)]
pub struct EncodedPage {
    /// The description, JSON.
    pub description: String,
    /// The columns, one after another, each with the description's number of `rows`; equal columns are stored once. The description
    /// refers to them by index.
    pub numbers: Vec<f64>,
}

impl Page {
    /// The page as a description and its numbers.
    ///
    /// # Errors
    /// [`PageError::Rows`] if columns differ in length; [`PageError::Json`] if the description cannot be written.
    pub fn encode(&self) -> Result<EncodedPage, PageError> {
        let rows = self.columns.first().map_or(0, |first| first.values.len());
        let mut block = Block {
            rows,
            ..Block::default()
        };
        let columns = self.columns.iter().map(|of| block.column(of));
        let columns = columns.collect::<Result<Vec<_>, _>>()?;
        let drawing = self.drawing.as_ref();
        let drawing = drawing.map(|drawing| block.drawing(drawing)).transpose()?;
        let peak = |peak: &Peak| {
            let [min, max] = peak.ends.map(|end| end.map(Number));
            EncodedPeak {
                column: peak.column,
                min,
                max,
                error: peak.error.map(Number),
            }
        };
        let numbers = self.numbers.iter().map(|number| EncodedNumber {
            name: &number.name,
            unit: &number.unit,
            value: Number(number.value),
            error: number.error.map(Number),
        });
        let events = self.events.iter().map(|event| EncodedEvent {
            name: &event.name,
            t: Number(event.t),
        });
        let description = serde_json::to_string(&Description {
            format: FORMAT,
            title: &self.title,
            command: &self.command,
            subtitle: &self.subtitle,
            note: self.note.as_deref(),
            scene: self.scene.as_ref(),
            version: &self.version,
            method: &self.method,
            units: &self.units,
            rows,
            axis: self.axis,
            columns,
            rows_note: self.rows_note.as_deref(),
            drawing,
            peaks: self.peaks.iter().map(peak).collect(),
            peaks_note: self.peaks_note.as_deref(),
            findings: self.findings.iter().map(EncodedFinding::from).collect(),
            messages: &self.messages,
            printed: &self.printed,
            numbers: numbers.collect(),
            events: events.collect(),
            tables: &self.tables,
            pictures: &self.pictures,
            files: &self.files,
        })?;
        Ok(EncodedPage {
            description,
            numbers: block.numbers,
        })
    }
}

/// An odd number with random bits (from FxHash).
const MIX: u64 = 0x517c_c1b7_2722_0a95;

/// The stored columns, without duplicates.
#[derive(Default)]
struct Block {
    rows: usize,
    numbers: Vec<f64>,
    /// Number of stored columns, and their indices by a fingerprint of their bits.
    count: usize,
    known: HashMap<u64, Vec<usize>>,
}

impl Block {
    /// The index of a column; the column is stored unless an equal one exists.
    fn add(&mut self, values: &[f64]) -> usize {
        let mix = |print: u64, v: &f64| (print.rotate_left(5) ^ v.to_bits()).wrapping_mul(MIX);
        let alike = self.known.entry(values.iter().fold(0, mix)).or_default();
        let numbers = &self.numbers;
        let is_equal = |k: &&usize| {
            let stored = &numbers[**k * values.len()..][..values.len()];
            let mut pairs = stored.iter().zip(values);
            pairs.all(|(a, b)| a.to_bits() == b.to_bits())
        };
        if let Some(&known) = alike.iter().find(is_equal) {
            return known;
        }
        alike.push(self.count);
        self.numbers.extend_from_slice(values);
        self.count += 1;
        self.count - 1
    }

    fn column<'a>(&mut self, of: &'a PageColumn) -> Result<EncodedColumn<'a>, PageError> {
        if of.values.len() != self.rows {
            return Err(self.unequal(&of.key, &of.values));
        }
        let slot = self.add(&of.values);
        Ok(EncodedColumn { of, slot })
    }

    fn drawing<'a>(&mut self, drawing: &'a Drawing) -> Result<EncodedDrawing<'a>, PageError> {
        let bodies = drawing.bodies.iter().map(|body| self.body(body));
        Ok(EncodedDrawing {
            size: drawing.size,
            view: drawing.view,
            bodies: bodies.collect::<Result<_, _>>()?,
            parts: &drawing.parts,
            arrows: &drawing.arrows,
            paths: &drawing.paths,
        })
    }

    fn body<'a>(&mut self, body: &'a DrawnBody) -> Result<EncodedBody<'a>, PageError> {
        let placement = |values: &Vec<f64>| {
            if values.len() != self.rows {
                return Err(self.unequal(&body.name, values));
            }
            // Placements are only drawn, so single precision suffices.
            let single: Vec<f64> = values.iter().map(|v| f64::from(*v as f32)).collect();
            Ok(self.add(&single))
        };
        Ok(EncodedBody {
            name: &body.name,
            paint: body.paint,
            placements: body
                .placements
                .iter()
                .map(placement)
                .collect::<Result<_, _>>()?,
        })
    }

    /// The error for a column with a different number of rows.
    fn unequal(&self, key: &str, values: &[f64]) -> PageError {
        PageError::Rows {
            key: key.to_owned(),
            found: values.len(),
            expected: self.rows,
        }
    }
}

#[derive(Serialize)]
struct Description<'a> {
    format: &'static str,
    title: &'a str,
    command: &'a str,
    subtitle: &'a str,
    note: Option<&'a str>,
    scene: Option<&'a PageScene>,
    version: &'a str,
    method: &'a str,
    units: &'a [DisplayUnit],
    rows: usize,
    axis: Option<usize>,
    columns: Vec<EncodedColumn<'a>>,
    rows_note: Option<&'a str>,
    drawing: Option<EncodedDrawing<'a>>,
    peaks: Vec<EncodedPeak>,
    peaks_note: Option<&'a str>,
    findings: Vec<EncodedFinding<'a>>,
    messages: &'a [PageMessage],
    printed: &'a str,
    numbers: Vec<EncodedNumber<'a>>,
    events: Vec<EncodedEvent<'a>>,
    tables: &'a [PageTable],
    pictures: &'a [FileLink],
    files: &'a [FileLink],
}

/// A column without its values, which are stored at an index.
#[derive(Serialize)]
struct EncodedColumn<'a> {
    #[serde(flatten)]
    of: &'a PageColumn,
    slot: usize,
}

#[derive(Serialize)]
struct EncodedDrawing<'a> {
    size: f64,
    view: Option<[f64; 2]>,
    bodies: Vec<EncodedBody<'a>>,
    parts: &'a [Part],
    arrows: &'a [ForceArrow],
    paths: &'a [DrawnPath],
}

#[derive(Serialize)]
struct EncodedBody<'a> {
    name: &'a str,
    paint: Option<usize>,
    placements: Vec<usize>,
}

#[derive(Serialize)]
struct EncodedPeak {
    column: usize,
    min: [Number; 2],
    max: [Number; 2],
    error: Option<Number>,
}

/// A finding, with the texts of the reports.
#[derive(Serialize)]
struct EncodedFinding<'a> {
    key: &'a str,
    check: String,
    pass: bool,
    comparison: &'a str,
    domain: &'a str,
    absolute_difference: Number,
    unit: &'a str,
    relative_difference: Number,
    scale: &'a str,
    tolerance: Number,
    tolerance_reason: &'a str,
    worst_at: &'a str,
}

impl<'a> From<&'a Finding> for EncodedFinding<'a> {
    fn from(f: &'a Finding) -> Self {
        Self {
            key: &f.key,
            check: f.check.to_string(),
            pass: f.pass,
            comparison: &f.comparison,
            domain: &f.domain,
            absolute_difference: Number(f.absolute_difference),
            unit: &f.unit,
            relative_difference: Number(f.relative_difference),
            scale: &f.scale,
            tolerance: Number(f.tolerance),
            tolerance_reason: &f.tolerance_reason,
            worst_at: &f.worst_at,
        }
    }
}

#[derive(Serialize)]
struct EncodedNumber<'a> {
    name: &'a str,
    unit: &'a str,
    value: Number,
    error: Option<Number>,
}

#[derive(Serialize)]
struct EncodedEvent<'a> {
    name: &'a str,
    t: Number,
}

/// A number of the description. Numbers that are not finite are written as `"NaN"`, `"Infinity"` or `"-Infinity"`, which JavaScript's `Number()`
/// reads.
struct Number(f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            v if v.is_finite() => serializer.serialize_f64(v),
            v if v.is_nan() => serializer.serialize_str("NaN"),
            v if v > 0.0 => serializer.serialize_str("Infinity"),
            _ => serializer.serialize_str("-Infinity"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(page: &Page) -> (serde_json::Value, Vec<f64>) {
        let encoded = page.encode().unwrap();
        let json = serde_json::from_str(&encoded.description).unwrap();
        (json, encoded.numbers)
    }

    #[test]
    fn columns_come_back_by_their_numbers_to_the_last_bit() {
        let values = [0.1 + 0.2, -0.0, 1e-310, f64::NAN, f64::INFINITY];
        let columns = vec![
            PageColumn::new("a", "m", values.to_vec()),
            PageColumn::new("b", "m", vec![0.0; 5]),
            PageColumn::new("a again", "m", values.to_vec()),
            // Minus zero differs from zero.
            PageColumn::new("c", "m", vec![-0.0; 5]),
        ];
        let page = Page {
            columns,
            ..Page::default()
        };
        let (json, numbers) = read(&page);
        let slots: Vec<u64> = (0..4)
            .map(|k| json["columns"][k]["slot"].as_u64().unwrap())
            .collect();
        assert_eq!(slots, [0, 1, 0, 2]);
        let bits = |all: &[f64]| -> Vec<u64> { all.iter().map(|v| v.to_bits()).collect() };
        assert_eq!(bits(&numbers[..5]), bits(&values));
        assert_eq!(bits(&numbers[10..]), bits(&[-0.0; 5]));
        assert_eq!(json["rows"], 5);
    }

    #[test]
    fn a_short_column_is_an_error_that_names_it() {
        let columns = vec![
            PageColumn::new("a", "", vec![0.0, 1.0]),
            PageColumn::new("b", "", vec![0.0]),
        ];
        let page = Page {
            columns,
            ..Page::default()
        };
        let error = page.encode().unwrap_err().to_string();
        assert_eq!(
            error,
            "column `b` of the page has 1 rows, and the first has 2"
        );
    }

    #[test]
    fn a_body_with_other_rows_than_the_columns_is_an_error() {
        let body = DrawnBody {
            name: "bar".to_owned(),
            placements: vec![vec![0.0; 3]; 3],
            ..DrawnBody::default()
        };
        let page = Page {
            columns: vec![PageColumn::new("x", "m", vec![0.0; 2])],
            drawing: Some(Drawing {
                bodies: vec![body],
                ..Drawing::default()
            }),
            ..Page::default()
        };
        let error = page.encode().unwrap_err().to_string();
        assert!(error.contains("`bar`"), "{error}");
    }

    #[test]
    fn placements_are_columns_in_single_precision() {
        let x = vec![1.0 / 3.0, 2.0];
        let body = DrawnBody {
            name: "bar".to_owned(),
            paint: Some(0),
            placements: vec![x.clone(), vec![2.0, 4.0], vec![0.0, 0.0]],
        };
        let page = Page {
            columns: vec![PageColumn::new("x", "m", x.clone())],
            drawing: Some(Drawing {
                bodies: vec![body],
                ..Drawing::default()
            }),
            ..Page::default()
        };
        let (json, numbers) = read(&page);
        assert_eq!(
            json["drawing"]["bodies"][0]["placements"],
            serde_json::json!([1, 2, 3])
        );
        assert_eq!(numbers[..2], x);
        assert_eq!(numbers[2], f64::from(1.0_f32 / 3.0));
    }
}
