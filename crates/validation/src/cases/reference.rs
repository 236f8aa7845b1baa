//! The reference of a case: `case.toml` beside its scene, with reference numbers, their source and tolerances.

mod file;
mod kinds;
mod states;
mod tolerances;

use crate::error::ValidationError;
use dwell_findings::Finding;
use dwell_geometry::{BodyId, Vec2};
use dwell_scene::PlaneScene;
use dwell_verify::checks::{PublishedPoint, PublishedSample};
pub(crate) use file::{entries, number, numbers, read_file};
pub(crate) use kinds::{SourceKind, SourceKinds};
use serde_json::{Map, Value};
use states::{ReferenceStates, read_states};
use std::path::Path;
use tolerances::Tolerances;

/// The file of a case beside its scene.
const FILE: &str = "case.toml";

/// Published or independently computed values of a case.
#[derive(Debug, Clone, Default)]
pub(crate) struct Reference {
    /// Where they come from.
    pub(crate) source: String,
    /// Who made them, by table of the file.
    pub(crate) kinds: SourceKinds,
    /// How the values of states were computed, if they were.
    pub(crate) computed_by: Option<String>,
    /// Coefficients at sampled positions.
    pub(crate) samples: Vec<PublishedSample>,
    /// Of the mechanisms that bodies of varying inertia stand for.
    pub(crate) known_reactions: Vec<KnownSample>,
    /// Period of the free motion, s.
    pub(crate) period: Option<f64>,
    /// States along the free motion.
    pub(crate) motion_states: Vec<PublishedState>,
    /// Values of states of motion, computed and published.
    pub(crate) computed_states: Option<ReferenceStates>,
    pub(crate) published_states: Option<ReferenceStates>,
    /// By finding.
    pub(crate) tolerances: Tolerances,
    /// The file.
    path: String,
}

/// a and b of a reaction that the scene gives over the angle of a body, which is the coordinate.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct KnownSample {
    /// rad.
    pub(crate) angle: f64,
    pub(crate) name: String,
    /// Whether its unit is N m, else N.
    pub(crate) is_moment: bool,
    /// kg m or kg m².
    pub(crate) a: f64,
    pub(crate) b: f64,
}

/// Known values of a free motion at one time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PublishedState {
    /// Time, s.
    pub(crate) t: f64,
    /// By name of an actuator, its velocity (`phi.velocity`) or a reaction: the value.
    pub(crate) values: Vec<(String, f64)>,
    /// Largest difference, as a part of the largest value of the kind.
    pub(crate) tolerance: f64,
    /// Its reason.
    pub(crate) reason: String,
}

/// The keys of the file. Text is for readers, and so are numbers of other quantities.
const KEYS: [&str; 13] = [
    "title",
    "kind",
    "source",
    "computed",
    "definition",
    "convention",
    "tolerance",
    "tolerances",
    "samples",
    "free_motion",
    "others_measured",
    "published",
    "confirmed",
];
/// The keys of a sample besides points, such as `P_m`, and angles, such as `theta_guide_rad`.
const SAMPLE_KEYS: [&str; 4] = ["q", "m", "half_dm", "reactions"];

impl Reference {
    /// Reads the file of a case; an absent one is an empty reference. A key that is not known
    /// is an error: a value that is never compared would be taken for agreement.
    pub(crate) fn read(folder: &Path, scene: &PlaneScene) -> Result<Self, ValidationError> {
        let path = folder.join(FILE);
        if !path.exists() {
            return Ok(Self::default());
        }
        let value: Value = read_file(&path)?;
        let wrong = |reason: String| ValidationError::Reference {
            path: path.display().to_string(),
            reason,
        };
        let read = Self::from_value(&value, scene).map_err(wrong)?;
        Ok(Self {
            path: path.display().to_string(),
            ..read
        })
    }

    /// Applies the case's own tolerances to its findings.
    ///
    /// # Errors
    /// [`ValidationError::Reference`] where a tolerance is given for no finding.
    pub(crate) fn apply_tolerances(&self, findings: &mut [Finding]) -> Result<(), ValidationError> {
        let path = self.path.clone();
        let applied = self.tolerances.apply(findings);
        applied.map_err(|reason| ValidationError::Reference { path, reason })
    }

    fn from_value(value: &Value, scene: &PlaneScene) -> Result<Self, String> {
        check_keys(object(value, "the file")?, &KEYS)?;
        let has_values = |s: &Value| s.get("values").is_some();
        let all = list(value, "samples")?;
        let (states, samples) = if all.iter().any(has_values) {
            (read_states(value, scene)?, Vec::new())
        } else {
            (None, read_each("samples", all, |s| sample(s, scene))?)
        };
        let published = match &value["published"] {
            Value::Null => None,
            // The tolerance is that of the file.
            given => {
                let mut given = object(given, "`published`")?.clone();
                given.insert("tolerance".to_owned(), value["tolerance"].clone());
                let read = read_states(&Value::Object(given), scene);
                read.map_err(|e| format!("published: {e}"))?
            }
        };
        let (period, motion) = match &value["free_motion"] {
            Value::Null => (None, Vec::new()),
            _ if scene.motion.is_none() => {
                return Err("there is a `free_motion`, but no [motion] in the scene".to_owned());
            }
            motion => free_motion(motion).map_err(|e| format!("free_motion: {e}"))?,
        };
        let source = value["source"].as_str();
        Ok(Self {
            kinds: SourceKinds::read(value)?,
            source: source.unwrap_or("no source given").to_owned(),
            computed_by: value["computed"].as_str().map(str::to_owned),
            known_reactions: known_samples(list(value, "samples")?, &samples, scene)?,
            samples,
            period,
            motion_states: motion,
            computed_states: states,
            published_states: published,
            tolerances: Tolerances::read(&value["tolerances"])?,
            ..Self::default()
        })
    }
}

/// The period of a free motion, s, and states along it.
fn free_motion(value: &Value) -> Result<(Option<f64>, Vec<PublishedState>), String> {
    object(value, "it")?;
    let period = optional(value, "period_s")?;
    let states = list(value, "states")?;
    if period.is_none() && states.is_empty() {
        return Err("neither `period_s` nor `states` is given".to_owned());
    }
    let state = |state: &Value| {
        Ok(PublishedState {
            t: number_of(state, "t")?,
            values: named_values(&state["values"])?,
            tolerance: number_of(value, "relative")?,
            reason: value["reason"].as_str().unwrap_or("as given").to_owned(),
        })
    };
    Ok((period, read_each("states", states, state)?))
}

/// The values of quantities by name.
fn named_values(value: &Value) -> Result<Vec<(String, f64)>, String> {
    let read = |(name, value): (&String, &Value)| match number(value) {
        Some(number) => Ok((name.clone(), number)),
        None => Err(format!("`{name}` is not a number: {value}")),
    };
    object(value, "`values`")?.iter().map(read).collect()
}

/// Reads each entry of a list; an error names the entry.
fn read_each<T>(
    name: &str,
    all: &[Value],
    read: impl Fn(&Value) -> Result<T, String>,
) -> Result<Vec<T>, String> {
    let entries = all.iter().enumerate();
    let read = |(k, entry)| read(entry).map_err(|e| format!("{name}[{k}]: {e}"));
    entries.map(read).collect()
}

/// Rejects keys that are not known.
fn check_keys(fields: &Map<String, Value>, known: &[&str]) -> Result<(), String> {
    match fields.keys().find(|key| !known.contains(&key.as_str())) {
        Some(key) => Err(format!(
            "unknown key `{key}`; known are {}",
            known.join(", ")
        )),
        None => Ok(()),
    }
}

/// The entries of a key that may be absent.
fn list<'a>(object: &'a Value, key: &str) -> Result<&'a [Value], String> {
    match &object[key] {
        Value::Null => Ok(&[]),
        Value::Array(entries) => Ok(entries),
        _ => Err(format!("`{key}` is not a list")),
    }
}

fn object<'a>(value: &'a Value, what: &str) -> Result<&'a Map<String, Value>, String> {
    let object = value.as_object();
    object.ok_or_else(|| format!("{what} is not an object {{ … }}"))
}

/// The number of a key.
fn number_of(object: &Value, key: &str) -> Result<f64, String> {
    optional(object, key)?.ok_or_else(|| format!("`{key}` is missing"))
}

/// The number of a key that may be absent.
fn optional(object: &Value, key: &str) -> Result<Option<f64>, String> {
    let value = &object[key];
    match number(value) {
        None if !value.is_null() => Err(format!("`{key}` is not a number: {value}")),
        number => Ok(number),
    }
}

fn sample(value: &Value, scene: &PlaneScene) -> Result<PublishedSample, String> {
    let fields = object(value, "it")?;
    let q = number_of(value, "q")?;
    let is_point = |key: &str| !SAMPLE_KEYS.contains(&key) && !is_angle(key, scene);
    let points = fields.iter().filter(|(key, _)| is_point(key));
    let points = points.map(|(key, at)| point(key, at, scene));
    let points = points.collect::<Result<_, String>>()?;
    let sample = PublishedSample {
        q,
        m: optional(value, "m")?,
        half_dm: optional(value, "half_dm")?,
        reactions: reactions(&value["reactions"], scene)?,
        points,
    };
    let nothing = sample.m.is_none() && sample.half_dm.is_none();
    if nothing && sample.reactions.is_empty() && sample.points.is_empty() {
        return Err("no values to compare".to_owned());
    }
    Ok(sample)
}

/// The reactions of a sample: (index in the mechanism, a, b).
fn reactions(value: &Value, scene: &PlaneScene) -> Result<Vec<(usize, f64, f64)>, String> {
    if value.is_null() {
        return Ok(Vec::new());
    }
    let mechanism = &scene.mechanism;
    let all = mechanism.reactions().into_iter();
    let names: Vec<String> = all.map(|r| mechanism.reaction_name(r)).collect();
    let known = known_names(scene);
    let pair = |(name, pair): (&String, &Value)| {
        let none = || {
            let known = names.join(", ");
            format!("the scene has no reaction `{name}`; it has {known}")
        };
        let k = names.iter().position(|n| n == name).ok_or_else(none)?;
        let wrong = |e: String| format!("reaction `{name}`: {e}");
        object(pair, "it").map_err(wrong)?;
        let (a, b) = (number_of(pair, "a"), number_of(pair, "b"));
        Ok((k, a.map_err(wrong)?, b.map_err(wrong)?))
    };
    let fields = object(value, "`reactions`")?;
    let of_joints = fields
        .iter()
        .filter(|(name, _)| !known.contains(&name.as_str()));
    of_joints.map(pair).collect()
}

/// The reactions that the scene gives over the angle of a body.
fn known_names(scene: &PlaneScene) -> Vec<&str> {
    let varying = scene.varying_inertias.iter();
    let reactions = varying.flat_map(|varying| &varying.reactions);
    reactions.map(|reaction| reaction.name.as_str()).collect()
}

/// Their values in the samples.
fn known_samples(
    all: &[Value],
    samples: &[PublishedSample],
    scene: &PlaneScene,
) -> Result<Vec<KnownSample>, String> {
    let mut found = Vec::new();
    for (value, sample) in all.iter().zip(samples) {
        for name in known_names(scene) {
            let pair = &value["reactions"][name];
            if !pair.is_null() {
                found.push(KnownSample {
                    angle: sample.q,
                    name: name.to_owned(),
                    is_moment: pair["unit"] == "N m",
                    a: number_of(pair, "a")?,
                    b: number_of(pair, "b")?,
                });
            }
        }
    }
    Ok(found)
}

/// Whether a key gives the angle of a body, such as `theta_guide_rad`. It is not compared: the
/// points are.
fn is_angle(key: &str, scene: &PlaneScene) -> bool {
    let body = key.strip_prefix("theta_");
    let body = body.and_then(|k| k.strip_suffix("_rad"));
    body.is_some_and(|body| scene.mechanism.bodies.iter().any(|b| b.name == body))
}

/// A point is published by its name alone, such as `P_m`: the first body that has it is meant.
fn point(key: &str, at: &Value, scene: &PlaneScene) -> Result<PublishedPoint, String> {
    let Some(name) = key.strip_suffix("_m") else {
        let known = SAMPLE_KEYS.join(", ");
        return Err(format!(
            "unknown key `{key}`; known are {known}, and points such as `P_m`"
        ));
    };
    let found = scene.points.iter().enumerate().find_map(|(body, points)| {
        let (_, local) = points.iter().find(|(n, _)| n == name)?;
        Some((BodyId(body), *local))
    });
    let (body, local) = found.ok_or_else(|| format!("the scene has no point `{name}`"))?;
    let coordinates = at.as_array().into_iter().flatten().map(number);
    match coordinates.collect::<Vec<_>>()[..] {
        [Some(x), Some(y)] => Ok(PublishedPoint {
            body,
            local,
            position: Vec2 { x, y },
        }),
        _ => Err(format!("`{key}` is not a pair of numbers: {at}")),
    }
}
