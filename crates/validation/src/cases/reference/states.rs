//! Values of named quantities at states of motion, as a reference gives them, and their comparison.

use super::{Reference, list, number, object, parse};
use crate::cases::model_states::{ModelStates, StateRequest};
use crate::cases::state_quantity::{QuantityKind, StateQuantity};
use crate::error::ValidationError;
use dwell_findings::{Check, Finding};
use dwell_scene::Scene;
use dwell_study::number_format::count;
use dwell_verify::{FindingSpec, checks};
use serde_json::Value;

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

/// What a sample holds; without `q_ddot` it is one of free motion.
const STATE_KEYS: [&str; 4] = ["q", "q_dot", "q_ddot", "values"];

/// The samples with values of a file or of a part of it, if there are any.
pub(super) fn read_states(value: &Value, scene: &Scene) -> Result<Option<ReferenceStates>, String> {
    let samples = list(value, "samples")?;
    if samples.is_empty() {
        return Ok(None);
    }
    let wrong = |e: String| format!("tolerance: {e}");
    let tolerance = &value["tolerance"];
    let why = tolerance["reason"].as_str();
    let why = why.ok_or_else(|| wrong("no `reason` is given".to_owned()))?;
    let rows = samples.iter().enumerate();
    let rows = rows.map(|(k, s)| read_state(s, scene).map_err(|e| format!("samples[{k}]: {e}")));
    Ok(Some(ReferenceStates {
        samples: rows.collect::<Result<_, _>>()?,
        source: value["source"].as_str().map(str::to_owned),
        tolerance: number(tolerance, "relative").map_err(wrong)?,
        reason: why.to_owned(),
    }))
}

fn read_state(value: &Value, scene: &Scene) -> Result<ReferenceState, String> {
    let fields = object(value, "it")?;
    if let Some(key) = fields
        .keys()
        .find(|key| !STATE_KEYS.contains(&key.as_str()))
    {
        return Err(format!(
            "unknown key `{key}`; known are {}",
            STATE_KEYS.join(", ")
        ));
    }
    let named_values = object(&value["values"], "`values`")?;
    let read = |(name, at): (&String, &Value)| match parse(at) {
        Some(parsed) => Ok((name.clone(), parsed)),
        None => Err(format!("`{name}` is not a number: {at}")),
    };
    let values: Vec<_> = named_values.iter().map(read).collect::<Result<_, _>>()?;
    if values.is_empty() {
        return Err("there is nothing to compare in it".to_owned());
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
fn by_actuator(value: &Value, scene: &Scene) -> Result<Vec<f64>, String> {
    let fields = object(value, "it")?;
    let actuators = &scene.mechanism.actuators;
    if let Some(name) = fields
        .keys()
        .find(|k| actuators.iter().all(|a| a.name != **k))
    {
        return Err(format!("the scene has no actuator `{name}`"));
    }
    actuators.iter().map(|a| number(value, &a.name)).collect()
}

/// How findings name the quantities that share a scale.
struct FindingText {
    kind: QuantityKind,
    computed: [&'static str; 2],
    published: [&'static str; 2],
}

const FINDING_TEXTS: [FindingText; 5] = [
    FindingText {
        kind: QuantityKind::Positions,
        computed: [
            "reference-positions",
            "angles and places with those computed elsewhere",
        ],
        published: [
            "published-positions",
            "angles and places with the published ones",
        ],
    },
    FindingText {
        kind: QuantityKind::Velocities,
        computed: [
            "reference-velocities",
            "velocities with those computed elsewhere",
        ],
        published: ["published-velocities", "velocities with the published ones"],
    },
    FindingText {
        kind: QuantityKind::Accelerations,
        computed: [
            "reference-accelerations",
            "accelerations with those computed elsewhere",
        ],
        published: [
            "published-accelerations",
            "accelerations with the published ones",
        ],
    },
    FindingText {
        kind: QuantityKind::Reactions,
        computed: [
            "reference-reactions",
            "reactions with those computed elsewhere",
        ],
        published: ["published-reactions", "reactions with the published ones"],
    },
    FindingText {
        kind: QuantityKind::ActuatorForces,
        computed: [
            "reference-actuator-forces",
            "actuator actions with those computed elsewhere",
        ],
        published: [
            "published-actuator-forces",
            "actuator actions with the published ones",
        ],
    },
];

impl ReferenceStates {
    /// The largest value of a unit in all samples.
    fn scale(&self, scene: &Scene, unit: &str) -> f64 {
        let values = self.samples.iter().flat_map(|state| &state.values);
        let of_unit = values.filter(|(name, _)| {
            StateQuantity::find(scene, name).is_some_and(|q| q.unit(scene) == unit)
        });
        of_unit.fold(0.0, |m, (_, value)| m.max(value.abs()))
    }

    /// One finding for each kind that is given, after one of the names.
    fn compare(
        &self,
        scene: &Scene,
        model: &mut ModelStates<'_>,
        published: bool,
    ) -> Result<Vec<Finding>, ValidationError> {
        let mut read_values = Vec::new();
        let mut unknown = Vec::new();
        for (k, row) in self.samples.iter().enumerate() {
            let state = model.evaluate_at(&row.request)?;
            let condition = state.condition_number();
            for (name, expected) in &row.values {
                let Some(quantity) = StateQuantity::find(scene, name) else {
                    unknown.push(format!("`{name}`"));
                    continue;
                };
                let unit = quantity.unit(scene);
                let value = checks::ComparedValue {
                    location: format!("{name}, sample {}", k + 1),
                    unit,
                    value: quantity.value(&state),
                    expected: *expected,
                    scale: 0.0,
                    condition_number: condition,
                };
                read_values.push((quantity.kind(), value));
            }
        }
        for unit in ["m", "rad", "m/s", "rad/s", "m/s2", "rad/s2", "N", "N m"] {
            let scale = self.scale(scene, unit);
            let of_unit = read_values
                .iter_mut()
                .filter(|(_, value)| value.unit == unit);
            of_unit.for_each(|(_, value)| value.scale = scale);
        }
        let mut over = count(self.samples.len(), "sample");
        if let (true, Some(source)) = (published, &self.source) {
            over += &format!(" of {source}");
        }
        let mut findings = Vec::new();
        if !unknown.is_empty() {
            unknown.sort();
            unknown.dedup();
            findings.push(unknown_names(&unknown, &over, published));
        }
        for text in &FINDING_TEXTS {
            let of_kind = read_values.iter().filter(|(kind, _)| *kind == text.kind);
            let values: Vec<_> = of_kind.map(|(_, value)| value.clone()).collect();
            if values.is_empty() {
                continue;
            }
            let [key, compared] = if published {
                text.published
            } else {
                text.computed
            };
            let spec = FindingSpec {
                key,
                check: Check::ReferenceValues,
                comparison: compared,
                scale: "the largest value of the same unit",
                tolerance: self.tolerance,
                tolerance_reason: &self.reason,
            };
            findings.push(checks::compare_values(&spec, over.clone(), &values));
        }
        Ok(findings)
    }
}

/// Names that the scene does not have.
fn unknown_names(unknown: &[String], over: &str, published: bool) -> Finding {
    let key = if published {
        "published-unknown-names"
    } else {
        "reference-unknown-names"
    };
    Finding {
        key: key.to_owned(),
        check: Check::ReferenceValues,
        comparison: "the names of the reference with the quantities of the scene".to_owned(),
        domain: over.to_owned(),
        absolute_difference: unknown.len() as f64,
        unit: String::new(),
        relative_difference: f64::NAN,
        scale: "none".to_owned(),
        worst_at: format!("the scene has no quantity {}", unknown.join(", ")),
        tolerance: 0.0,
        tolerance_reason: "what is given and never compared would pass for agreement".to_owned(),
        ..Finding::default()
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
        let velocities = self
            .state_requests()
            .into_iter()
            .filter_map(|request| request.q_dot.first().copied());
        let max_abs = velocities.fold(0.0, |m, v| v.abs().max(m));
        (max_abs > 0.0).then_some(max_abs)
    }

    /// What a scene says at those states, held against the values.
    ///
    /// # Errors
    /// As [`ModelStates::evaluate_at`].
    pub(crate) fn findings(
        &self,
        scene: &Scene,
        model: &mut ModelStates<'_>,
    ) -> Result<Vec<Finding>, ValidationError> {
        let mut findings = Vec::new();
        for (table, published) in [
            (&self.published_states, true),
            (&self.computed_states, false),
        ] {
            if let Some(table) = table {
                findings.extend(table.compare(scene, model, published)?);
            }
        }
        Ok(findings)
    }
}
