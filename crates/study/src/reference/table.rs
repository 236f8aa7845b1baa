//! Values of named quantities at states of motion, as a reference gives them, and their comparison.

use super::{Reference, list, number, object, parse};
use crate::claims::{Ask, Claims};
use crate::error::StudyError;
use crate::quantity::{Kind, Quantity};
use crate::words::count;
use dwell_findings::Finding;
use dwell_scene::Scene;
use dwell_verify::truths::{self, Values};
use serde_json::Value;

/// Values at states of motion.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    samples: Vec<Row>,
    /// Where a published one comes from.
    source: Option<String>,
    tolerance: f64,
    why: String,
}

/// The values of one state.
#[derive(Debug, Clone)]
struct Row {
    ask: Ask,
    values: Vec<(String, f64)>,
}

/// What a sample holds; without `q_ddot` it is one of free motion.
const KEYS: [&str; 4] = ["q", "q_dot", "q_ddot", "values"];

/// The samples with values of a file or of a part of it, if there are any.
pub(super) fn table(value: &Value, scene: &Scene) -> Result<Option<Table>, String> {
    let samples = list(value, "samples")?;
    if samples.is_empty() {
        return Ok(None);
    }
    let wrong = |e: String| format!("tolerance: {e}");
    let tolerance = &value["tolerance"];
    let why = tolerance["reason"].as_str();
    let why = why.ok_or_else(|| wrong("no `reason` is given".to_owned()))?;
    let rows = samples.iter().enumerate();
    let rows = rows.map(|(k, s)| row(s, scene).map_err(|e| format!("samples[{k}]: {e}")));
    Ok(Some(Table {
        samples: rows.collect::<Result<_, _>>()?,
        source: value["source"].as_str().map(str::to_owned),
        tolerance: number(tolerance, "relative").map_err(wrong)?,
        why: why.to_owned(),
    }))
}

fn row(value: &Value, scene: &Scene) -> Result<Row, String> {
    let fields = object(value, "it")?;
    if let Some(key) = fields.keys().find(|key| !KEYS.contains(&key.as_str())) {
        return Err(format!(
            "unknown key `{key}`; known are {}",
            KEYS.join(", ")
        ));
    }
    let given = object(&value["values"], "`values`")?;
    let read = |(name, at): (&String, &Value)| match parse(at) {
        Some(parsed) => Ok((name.clone(), parsed)),
        None => Err(format!("`{name}` is not a number: {at}")),
    };
    let values: Vec<_> = given.iter().map(read).collect::<Result<_, _>>()?;
    if values.is_empty() {
        return Err("there is nothing to compare in it".to_owned());
    }
    let rates = |key: &str| by_actuator(&value[key], scene).map_err(|e| format!("{key}: {e}"));
    Ok(Row {
        ask: Ask {
            t: 0.0,
            q: rates("q")?,
            q_dot: rates("q_dot")?,
            q_ddot: match &value["q_ddot"] {
                Value::Null => None,
                _ => Some(rates("q_ddot")?),
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

/// The words of what is judged together.
struct Part {
    kind: Kind,
    computed: [&'static str; 2],
    published: [&'static str; 2],
}

const PARTS: [Part; 5] = [
    Part {
        kind: Kind::Positions,
        computed: [
            "reference-positions",
            "angles and places with those computed elsewhere",
        ],
        published: [
            "published-positions",
            "angles and places with the published ones",
        ],
    },
    Part {
        kind: Kind::Velocities,
        computed: [
            "reference-velocities",
            "velocities with those computed elsewhere",
        ],
        published: ["published-velocities", "velocities with the published ones"],
    },
    Part {
        kind: Kind::Accelerations,
        computed: [
            "reference-accelerations",
            "accelerations with those computed elsewhere",
        ],
        published: [
            "published-accelerations",
            "accelerations with the published ones",
        ],
    },
    Part {
        kind: Kind::Reactions,
        computed: [
            "reference-reactions",
            "reactions with those computed elsewhere",
        ],
        published: ["published-reactions", "reactions with the published ones"],
    },
    Part {
        kind: Kind::Actions,
        computed: [
            "reference-actions",
            "actuator actions with those computed elsewhere",
        ],
        published: [
            "published-actions",
            "actuator actions with the published ones",
        ],
    },
];

impl Table {
    /// The largest value of a unit in all samples.
    fn scale(&self, scene: &Scene, unit: &str) -> f64 {
        let values = self.samples.iter().flat_map(|row| &row.values);
        let of_unit = values
            .filter(|(name, _)| Quantity::find(scene, name).is_some_and(|q| q.unit(scene) == unit));
        of_unit.fold(0.0, |m, (_, value)| m.max(value.abs()))
    }

    /// One finding for each kind that is given, after one of the names.
    fn findings(
        &self,
        scene: &Scene,
        claims: &mut Claims<'_>,
        published: bool,
    ) -> Result<Vec<Finding>, StudyError> {
        let mut read = Vec::new();
        let mut unknown = Vec::new();
        for (k, row) in self.samples.iter().enumerate() {
            claims.go(&row.ask)?;
            let condition = claims.condition();
            let moment = claims.moment();
            for (name, wanted) in &row.values {
                let Some(quantity) = Quantity::find(scene, name) else {
                    unknown.push(format!("`{name}`"));
                    continue;
                };
                let unit = quantity.unit(scene);
                let value = truths::Value {
                    place: format!("{name}, sample {}", k + 1),
                    unit,
                    got: quantity.at(&moment),
                    wanted: *wanted,
                    scale: 0.0,
                    condition,
                };
                read.push((quantity.kind(), value));
            }
        }
        for unit in ["m", "rad", "m/s", "rad/s", "m/s2", "rad/s2", "N", "N m"] {
            let scale = self.scale(scene, unit);
            let of_unit = read.iter_mut().filter(|(_, value)| value.unit == unit);
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
            findings.push(names(&unknown, &over, published));
        }
        for part in &PARTS {
            let of_kind = read.iter().filter(|(kind, _)| *kind == part.kind);
            let values: Vec<_> = of_kind.map(|(_, value)| value.clone()).collect();
            if values.is_empty() {
                continue;
            }
            let [key, compared] = if published {
                part.published
            } else {
                part.computed
            };
            let words = Values {
                key,
                truth: truth(published),
                compared,
                over: over.clone(),
                tolerance: self.tolerance,
                why: &self.why,
            };
            findings.push(truths::values(words, &values));
        }
        Ok(findings)
    }
}

fn truth(published: bool) -> &'static str {
    if published {
        "9 published values"
    } else {
        "9 values computed elsewhere"
    }
}

/// Names that the scene does not have.
fn names(unknown: &[String], over: &str, published: bool) -> Finding {
    let key = if published {
        "published-names"
    } else {
        "reference-names"
    };
    Finding {
        key: key.to_owned(),
        truth: truth(published).to_owned(),
        compared: "the names of the reference with the quantities of the scene".to_owned(),
        over: over.to_owned(),
        absolute: unknown.len() as f64,
        unit: String::new(),
        relative: f64::NAN,
        scale: "none".to_owned(),
        worst: format!("the scene has no quantity {}", unknown.join(", ")),
        tolerance: 0.0,
        why: "what is given and never compared would pass for agreement".to_owned(),
        ..Finding::default()
    }
}

impl Reference {
    /// The states that values are given for.
    pub(crate) fn asks(&self) -> Vec<Ask> {
        let tables = self.states.iter().chain(&self.published);
        let rows = tables.flat_map(|table| &table.samples);
        rows.map(|row| row.ask.clone()).collect()
    }

    /// The largest speed of the first actuator in them, above zero.
    pub(crate) fn fastest(&self) -> Option<f64> {
        let speeds = self
            .asks()
            .into_iter()
            .filter_map(|ask| ask.q_dot.first().copied());
        let fastest = speeds.fold(0.0, |m, v| v.abs().max(m));
        (fastest > 0.0).then_some(fastest)
    }

    /// What a scene says at those states, held against the values.
    ///
    /// # Errors
    /// As [`Claims::go`].
    pub(crate) fn findings(
        &self,
        scene: &Scene,
        claims: &mut Claims<'_>,
    ) -> Result<Vec<Finding>, StudyError> {
        let mut findings = Vec::new();
        for (table, published) in [(&self.published, true), (&self.states, false)] {
            if let Some(table) = table {
                findings.extend(table.findings(scene, claims, published)?);
            }
        }
        Ok(findings)
    }
}
