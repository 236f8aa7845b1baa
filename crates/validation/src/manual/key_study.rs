//! Every key of the scene description: the scenes that use it, and a fault planted in its value.

use super::altered::altered_texts;
use super::planted::{PlantedResult, PlantedScene};
use dwell_findings::Check;
use dwell_scene::{KeyUse, PlaneScene, SceneKey, key_uses, scene_keys};
use rayon::prelude::*;
use std::collections::BTreeSet;
use toml::Table;

/// Scenes in which a key is tried, and alterations of it in each.
const MAX_SCENES: usize = 4;
const MAX_ALTERATIONS: usize = 12;
/// Uses in a scene that are tried.
const MAX_USES: usize = 3;
/// Checks that have to detect a fault.
pub(super) const REQUIRED: usize = 2;

/// What is known of a key.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct KeyResult {
    pub(super) key: SceneKey,
    /// Indices of the scenes that use it.
    pub(super) scenes: Vec<usize>,
    /// The fault that the most checks detect, if a fault changes any result.
    pub(super) fault: Option<PlantedFault>,
    /// Whether every other value that was tried is refused with an error.
    pub(super) refused: bool,
}

/// A fault planted in the value of a key.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PlantedFault {
    pub(super) scene: usize,
    pub(super) what: String,
    pub(super) detected_by: BTreeSet<Check>,
}

/// All keys, each with what became of a fault in it.
pub(super) fn study_keys(scenes: &[PlantedScene]) -> Vec<KeyResult> {
    let uses: Vec<Vec<KeyUse>> = scenes.iter().map(|s| key_uses(&s.text)).collect();
    let one = |key: SceneKey| {
        let uses_it = |k: &usize| uses[*k].iter().any(|u| u.key == key.id);
        let users: Vec<usize> = (0..scenes.len()).filter(uses_it).collect();
        let (fault, refused) = match key.holds_keys {
            true => (None, false),
            false => planted_fault(&key, &users, scenes, &uses),
        };
        KeyResult {
            key,
            scenes: users,
            fault,
            refused,
        }
    };
    scene_keys().into_par_iter().map(one).collect()
}

/// The first fault in a key that enough checks detect, or else the best; and whether all were refused.
fn planted_fault(
    key: &SceneKey,
    users: &[usize],
    scenes: &[PlantedScene],
    uses: &[Vec<KeyUse>],
) -> (Option<PlantedFault>, bool) {
    let mut quickest = users.to_vec();
    quickest.sort_by_key(|&k| scenes[k].cost());
    let mut best: Option<PlantedFault> = None;
    let [mut refused, mut unchanged] = [false; 2];
    for &k in quickest.iter().take(MAX_SCENES) {
        let scene = &scenes[k];
        let root: Table = toml::from_str(&scene.text).unwrap_or_default();
        let here = uses[k].iter().filter(|u| u.key == key.id).take(MAX_USES);
        let texts = here.flat_map(|key_use| altered_texts(&root, key_use));
        for altered in texts.take(MAX_ALTERATIONS) {
            // A text that is no scene is a fault that the reader refuses.
            let Ok(read) = PlaneScene::parse(&scene.scene.name, &altered.text) else {
                refused = true;
                continue;
            };
            let detected_by = match scene.check_altered(&read) {
                PlantedResult::Detected(detected_by) => detected_by,
                result => {
                    refused |= result == PlantedResult::Refused;
                    unchanged |= result == PlantedResult::Unchanged;
                    continue;
                }
            };
            let enough = detected_by.len() >= REQUIRED;
            if best
                .as_ref()
                .is_none_or(|b| b.detected_by.len() < detected_by.len())
            {
                best = Some(PlantedFault {
                    scene: k,
                    what: altered.what,
                    detected_by,
                });
            }
            if enough {
                return (best, false);
            }
        }
    }
    let refused = best.is_none() && refused && !unchanged;
    (best, refused)
}
