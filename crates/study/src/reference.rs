//! The reference numbers of a case: `reference.json` beside its scene.

use crate::error::StudyError;
use dwell_geometry::{BodyId, Vec2};
use dwell_scene::Scene;
use dwell_verify::truths::{Point, Sample};
use serde_json::Value;
use std::path::Path;

/// Published or independently computed values of a case.
#[derive(Debug, Clone, Default)]
pub(crate) struct Reference {
    /// Where they come from.
    pub(crate) source: String,
    /// Coefficients at sampled positions.
    pub(crate) samples: Vec<Sample>,
    /// Period of the free motion, s.
    pub(crate) period: Option<f64>,
}

impl Reference {
    /// Reads the reference of a case; an absent file is an empty reference.
    pub(crate) fn read(folder: &Path, scene: &Scene) -> Result<Self, StudyError> {
        let path = folder.join("reference.json");
        if !path.exists() {
            return Ok(Self::default());
        }
        let wrong = |reason: String| StudyError::Reference {
            path: path.display().to_string(),
            reason,
        };
        let text = std::fs::read_to_string(&path).map_err(|e| wrong(e.to_string()))?;
        let value: Value = serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))?;
        Self::from_value(&value, scene).map_err(wrong)
    }

    fn from_value(value: &Value, scene: &Scene) -> Result<Self, String> {
        let samples = match &value["samples"] {
            Value::Null => Vec::new(),
            Value::Array(samples) => samples
                .iter()
                .map(|s| sample(s, scene))
                .collect::<Result<_, _>>()?,
            _ => return Err("`samples` is not a list".to_owned()),
        };
        let period = &value["free_motion"]["period_s"];
        Ok(Self {
            source: value["source"]
                .as_str()
                .unwrap_or("no source given")
                .to_owned(),
            samples,
            period: optional(period)?,
        })
    }
}

/// A number, or the text of one (fifty digits do not fit a JSON number).
fn number(value: &Value) -> Result<f64, String> {
    let parsed = match value {
        Value::String(text) => text.trim().parse().ok(),
        other => other.as_f64(),
    };
    let finite = parsed.filter(|v: &f64| v.is_finite());
    finite.ok_or_else(|| format!("{value} is not a number"))
}

fn optional(value: &Value) -> Result<Option<f64>, String> {
    match value {
        Value::Null => Ok(None),
        value => number(value).map(Some),
    }
}

fn sample(value: &Value, scene: &Scene) -> Result<Sample, String> {
    let q = match (&value["phi_rad"], &value["phi_deg"]) {
        (Value::Null, Value::Null) => return Err("a sample has neither phi_rad nor phi_deg".into()),
        (Value::Null, degrees) => number(degrees)?.to_radians(),
        (radians, _) => number(radians)?,
    };
    let mechanism = &scene.mechanism;
    let all = mechanism.reactions();
    let mut reactions = Vec::new();
    for (name, pair) in value["reactions"].as_object().into_iter().flatten() {
        let k = all
            .iter()
            .position(|&r| mechanism.reaction_name(r) == *name);
        let k = k.ok_or_else(|| format!("no reaction `{name}` in the scene"))?;
        reactions.push((k, number(&pair["a"])?, number(&pair["b"])?));
    }
    let mut points = Vec::new();
    // A point is published by its name alone, such as `P_m`: any body that has it will do.
    for (key, place) in value.as_object().into_iter().flatten() {
        let (Some(name), Some(at)) = (key.strip_suffix("_m"), place.as_array()) else {
            continue;
        };
        let found = scene.points.iter().enumerate().find_map(|(body, points)| {
            let (_, local) = points.iter().find(|(n, _)| n == name)?;
            Some((BodyId(body), *local))
        });
        let (body, local) = found.ok_or_else(|| format!("no point `{name}` in the scene"))?;
        let [x, y] = at.as_slice() else {
            return Err(format!("`{key}` is not a pair of numbers"));
        };
        let at = Vec2 {
            x: number(x)?,
            y: number(y)?,
        };
        points.push(Point { body, local, at });
    }
    Ok(Sample {
        q,
        m: optional(&value["m1_kg_m2"])?,
        half_dm: optional(&value["half_dm1"])?,
        reactions,
        points,
    })
}
