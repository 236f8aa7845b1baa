//! The published samples of a reduced model, as the case's reference holds them.

use dwell_scene::PlaneScene;
use dwell_verify::checks::PublishedSample;
use serde_json::Value;
use std::path::Path;

/// The samples of m, ½m′, a and b.
pub(super) fn samples(folder: &Path, scene: &PlaneScene) -> Vec<PublishedSample> {
    let text = std::fs::read_to_string(folder.join("case.toml")).expect("a reference");
    let value: Value = toml::from_str(&text).expect("TOML");
    let number = |v: &Value| v.as_str().and_then(|s| s.parse::<f64>().ok());
    let mechanism = &scene.mechanism;
    let index = |name: &str| {
        let reactions = mechanism.reactions();
        reactions
            .iter()
            .position(|&r| mechanism.reaction_name(r) == name)
    };
    let sample = |s: &Value| {
        let pairs = s["reactions"].as_object().into_iter().flatten();
        let reactions = pairs.filter_map(|(name, pair)| {
            Some((index(name)?, number(&pair["a"])?, number(&pair["b"])?))
        });
        Some(PublishedSample {
            q: number(&s["q"])?,
            m: number(&s["m"]),
            half_dm: number(&s["half_dm"]),
            reactions: reactions.collect(),
            points: Vec::new(),
        })
    };
    let all = value["samples"].as_array().into_iter().flatten();
    all.filter_map(sample).collect()
}
