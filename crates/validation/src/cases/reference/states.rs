//! Values of named quantities at states of motion, as a reference gives them, and their comparison.

use super::{Reference, check_keys, list, named_values, number_of, object, read_each};
use crate::cases::model_states::{ModelStates, StateRequest};
use crate::cases::state_quantity::{KINDS, StateQuantity};
use crate::error::ValidationError;
use dwell_findings::{Check, Finding};
use dwell_scene::PlaneScene;
use dwell_study::number_format::count;
use dwell_verify::FindingSpec;
use dwell_verify::checks::{ComparedValue, compare_values};
use serde_json::Value;
use std::collections::BTreeSet;

/// Values at states of motion.
#[derive(Debug, Clone)]
pub(crate) struct ReferenceStates {
    samples: Vec<ReferenceState>,
    /// Where a published one comes from.
    source: Option<String>,
    tolerance: f64,
    reason: String,
}

/// The values of one state.
#[derive(Debug, Clone)]
struct ReferenceState {
    request: StateRequest,
    values: Vec<(String, f64)>,
}

/// The keys of a sample; without `q_ddot` it is one of free motion.
const STATE_KEYS: [&str; 4] = ["q", "q_dot", "q_ddot", "values"];

/// The samples with values of a file or of a part of it, if there are any.
pub(super) fn read_states(
    value: &Value,
    scene: &PlaneScene,
) -> Result<Option<ReferenceStates>, String> {
    let samples = list(value, "samples")?;
    if samples.is_empty() {
        return Ok(None);
    }
    let wrong = |e: String| format!("tolerance: {e}");
    let tolerance = &value["tolerance"];
    let why = tolerance["reason"].as_str();
    let why = why.ok_or_else(|| wrong("no `reason` is given".to_owned()))?;
    Ok(Some(ReferenceStates {
        samples: read_each("samples", samples, |s| read_state(s, scene))?,
        source: value["source"].as_str().map(str::to_owned),
        tolerance: number_of(tolerance, "relative").map_err(wrong)?,
        reason: why.to_owned(),
    }))
}

fn read_state(value: &Value, scene: &PlaneScene) -> Result<ReferenceState, String> {
    check_keys(object(value, "it")?, &STATE_KEYS)?;
    let values = named_values(&value["values"])?;
    if values.is_empty() {
        return Err("no values to compare".to_owned());
    }
    let by_name = |key: &str| by_actuator(&value[key], scene).map_err(|e| format!("{key}: {e}"));
    Ok(ReferenceState {
        request: StateRequest {
            t: 0.0,
            q: by_name("q")?,
            q_dot: by_name("q_dot")?,
            q_ddot: match &value["q_ddot"] {
                Value::Null => None,
                _ => Some(by_name("q_ddot")?),
            },
        },
        values,
    })
}

/// One number for each actuator.
fn by_actuator(value: &Value, scene: &PlaneScene) -> Result<Vec<f64>, String> {
    let mut names = object(value, "it")?.keys();
    let actuators = &scene.mechanism.actuators;
    if let Some(name) = names.find(|k| actuators.iter().all(|a| a.name != **k)) {
        return Err(format!("the scene has no actuator `{name}`"));
    }
    actuators
        .iter()
        .map(|a| number_of(value, &a.name))
        .collect()
}

impl ReferenceStates {
    /// The largest value of a unit in all samples.
    fn scale(&self, scene: &PlaneScene, unit: &str) -> f64 {
        let values = self.samples.iter().flat_map(|state| &state.values);
        let quantity = |name: &str| StateQuantity::find(scene, name);
        let of_unit =
            values.filter(|(name, _)| quantity(name).is_some_and(|q| q.unit(scene) == unit));
        of_unit.fold(0.0, |m, (_, value)| m.max(value.abs()))
    }

    /// One finding for each kind that is given.
    fn compare(
        &self,
        scene: &PlaneScene,
        model: &mut ModelStates<'_>,
        published: bool,
    ) -> Result<Vec<Finding>, ValidationError> {
        // Each with the kind of its quantity; and the names that the scene does not have.
        let (mut values, mut unknown) = (Vec::new(), BTreeSet::new());
        for (k, row) in self.samples.iter().enumerate() {
            let state = model.evaluate_at(&row.request)?;
            let condition_number = state.condition_number();
            for (name, expected) in &row.values {
                let Some(quantity) = StateQuantity::find(scene, name) else {
                    unknown.insert(format!("`{name}`"));
                    continue;
                };
                let unit = quantity.unit(scene);
                let value = ComparedValue {
                    location: format!("{name}, sample {}", k + 1),
                    unit,
                    value: quantity.value(&state),
                    expected: *expected,
                    scale: self.scale(scene, unit),
                    condition_number,
                };
                values.push((quantity.kind(), value));
            }
        }
        let mut over = count(self.samples.len(), "sample");
        if let (true, Some(source)) = (published, &self.source) {
            over += &format!(" of {source}");
        }
        let (prefix, source) = match published {
            true => ("published", "the published ones"),
            false => ("reference", "those computed elsewhere"),
        };
        let mut findings = Vec::new();
        if !unknown.is_empty() {
            findings.push(unknown_names(&unknown, &over, prefix));
        }
        for kind in KINDS {
            let of_kind = values.iter().filter(|(of, _)| *of == kind);
            let values: Vec<_> = of_kind.map(|(_, value)| value.clone()).collect();
            if values.is_empty() {
                continue;
            }
            let spec = FindingSpec {
                key: &format!("{prefix}-{kind}"),
                check: Check::ReferenceValues,
                comparison: &format!("{} with {source}", kind.replace('-', " ")),
                scale: "the largest value of the same unit",
                tolerance: self.tolerance,
                tolerance_reason: &self.reason,
            };
            findings.push(compare_values(&spec, over.clone(), &values));
        }
        Ok(findings)
    }
}

/// Names that the scene does not have.
fn unknown_names(unknown: &BTreeSet<String>, over: &str, prefix: &str) -> Finding {
    let key = format!("{prefix}-unknown-names");
    let (count, names) = (unknown.len() as f64, unknown.iter().cloned());
    let names = names.collect::<Vec<_>>().join(", ");
    Finding {
        comparison: "the names of the reference with the quantities of the scene".to_owned(),
        domain: over.to_owned(),
        worst_at: format!("the scene has no quantity {names}"),
        tolerance_reason: "a value that is never compared would be taken for agreement".to_owned(),
        ..Finding::new(&key, Check::ReferenceValues, [count, f64::NAN], 0.0)
    }
}

impl Reference {
    /// The states that values are given for.
    pub(crate) fn state_requests(&self) -> Vec<StateRequest> {
        let tables = self.computed_states.iter().chain(&self.published_states);
        let rows = tables.flat_map(|table| &table.samples);
        rows.map(|state| state.request.clone()).collect()
    }

    /// The largest speed of the first actuator in them, above zero.
    pub(crate) fn max_velocity(&self) -> Option<f64> {
        let requests = self.state_requests().into_iter();
        let velocities = requests.filter_map(|request| request.q_dot.first().copied());
        let max_abs = velocities.fold(0.0, |m, v| v.abs().max(m));
        (max_abs > 0.0).then_some(max_abs)
    }

    /// Compares the results of a scene in those states with the values.
    ///
    /// # Errors
    /// As [`ModelStates::evaluate_at`].
    pub(crate) fn findings(
        &self,
        scene: &PlaneScene,
        model: &mut ModelStates<'_>,
    ) -> Result<Vec<Finding>, ValidationError> {
        let mut findings = Vec::new();
        if let Some(table) = &self.published_states {
            findings.extend(table.compare(scene, model, true)?);
        }
        if let Some(table) = &self.computed_states {
            findings.extend(table.compare(scene, model, false)?);
        }
        Ok(findings)
    }
}
