//! Reads a reference of 25 digits: samples of the reduced parameters, and periods of free motions.

use crate::error::ValidationError;
use dwell_laws::Expression;
use serde_json::Value;
use std::path::Path;

/// A reference with its samples.
pub(super) struct Reference {
    data: Value,
}

/// A free motion of the reference.
pub(super) struct ReferenceMotion {
    /// Whether the loads of the scene act.
    pub(super) is_loaded: bool,
    /// Coordinate (rad) and speed (rad/s) at its start.
    pub(super) start: [f64; 2],
    /// Its period, s.
    pub(super) period: f64,
}

/// A number, or an exact expression.
fn number(value: &Value) -> Option<f64> {
    let text = match value {
        Value::Number(number) => return number.as_f64(),
        Value::String(text) => text,
        _ => return None,
    };
    let parsed = text.parse().ok();
    parsed.or_else(|| {
        let expression = Expression::parse(&text.replace("**", "^"), &[]);
        Some(expression.ok()?.eval(&[]))
    })
}

impl Reference {
    /// The reference in a file.
    pub(super) fn read(path: &Path) -> Result<Self, ValidationError> {
        let fault = |reason: String| ValidationError::Reference {
            path: path.display().to_string(),
            reason,
        };
        let text = std::fs::read_to_string(path).map_err(|e| fault(e.to_string()))?;
        let data = serde_json::from_str(&text).map_err(|e| fault(e.to_string()))?;
        Ok(Self { data })
    }

    /// Where it comes from.
    pub(super) fn source(&self) -> &str {
        self.data["source"].as_str().unwrap_or_default()
    }

    /// Its samples.
    pub(super) fn samples(&self) -> impl Iterator<Item = Sample<'_>> {
        let all = self.data["samples"].as_array();
        all.into_iter().flatten().map(|data| Sample { data })
    }

    /// Its free motions whose start is given by coordinate and speed.
    pub(super) fn motions(&self) -> Vec<ReferenceMotion> {
        let read = |motion: &Value| {
            let is_loaded = match motion["loads"].as_str()? {
                "none" => false,
                "as defined" => true,
                _ => return None,
            };
            Some(ReferenceMotion {
                is_loaded,
                start: [number(&motion["q0"])?, number(&motion["qdot0"])?],
                period: number(&motion["period_s"])?,
            })
        };
        let all = self.data["free_motion"].as_array();
        all.into_iter().flatten().filter_map(read).collect()
    }
}

/// The reference at one position.
pub(super) struct Sample<'a> {
    data: &'a Value,
}

impl Sample<'_> {
    /// A number by its name: q, m or ½m′.
    pub(super) fn number(&self, name: &str) -> Option<f64> {
        number(&self.data[name])
    }

    /// w of the whole weight.
    pub(super) fn weight(&self) -> Option<f64> {
        number(&self.data["w"]["gravity"])
    }

    /// a, b and c of the whole weight of a reaction, of which each may be missing.
    pub(super) fn reaction(&self, name: &str) -> [Option<f64>; 3] {
        let reaction = &self.data["reactions"][reference_name(name)];
        let c = &reaction["c"]["gravity"];
        [&reaction["a"], &reaction["b"], c].map(number)
    }
}

/// The reference's name of a component: `P0.Mx` of `P0.moment-x`.
fn reference_name(column: &str) -> String {
    let (joint, component) = column.split_once('.').unwrap_or((column, ""));
    let axis = component.chars().last().unwrap_or('x');
    let letter = match component.starts_with("moment") {
        true => 'M',
        false => 'F',
    };
    format!("{joint}.{letter}{axis}")
}
