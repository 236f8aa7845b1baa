//! The numbers that a scene writes down outside its bodies, by the keys that lead to them: `loads.brake.constant`,
//! `motion.speed.phi`, `joints.guide.axis[0]`. They are read anew with the text, so nothing here knows what they mean.

use crate::problem::Span;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Sections whose numbers can be varied. (Units, requests and the calibration are about the others.)
const SECTIONS: [&str; 8] = [
    "joints",
    "loads",
    "friction",
    "drives",
    "assembly",
    "motion",
    "prescribed",
    "sweep",
];

/// A number outside the bodies.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Elsewhere {
    /// The keys that lead to it.
    pub(crate) path: String,
    /// As written, in the scene's unit.
    pub(crate) value: f64,
    pub(crate) span: Span,
}

/// All of them, in the order of the file's sections.
pub(crate) fn elsewhere(text: &str, root: &DeTable<'_>) -> Vec<Elsewhere> {
    let mut found = Vec::new();
    for section in SECTIONS {
        if let Some(value) = root.get(section) {
            gather(text, section.to_owned(), value, &mut found);
        }
    }
    found
}

fn gather(text: &str, path: String, value: &Spanned<DeValue<'_>>, found: &mut Vec<Elsewhere>) {
    match value.get_ref() {
        DeValue::Table(table) => {
            for (key, value) in table {
                gather(text, format!("{path}.{}", key.get_ref()), value, found);
            }
        }
        DeValue::Array(array) => {
            for (i, value) in array.iter().enumerate() {
                gather(text, format!("{path}[{i}]"), value, found);
            }
        }
        DeValue::Integer(_) | DeValue::Float(_) => {
            let span = value.span();
            let written = text.get(span.clone()).map(|t| t.replace('_', ""));
            let number = written.and_then(|t| t.parse::<f64>().ok());
            if let Some(value) = number.filter(|n| n.is_finite()) {
                found.push(Elsewhere { path, value, span });
            }
        }
        _ => {}
    }
}
