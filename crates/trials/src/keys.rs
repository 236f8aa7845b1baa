//! Every key of the scene description: the scenes that use it, and a fault planted in its value.
//!
//! ```text
//! text ──────────────── scene ──── checks ──┐
//!   └─ one value altered ── scene ── claims ┴─→ findings: which checks detect it
//! ```

use crate::altered::altered_texts;
use dwell_scene::{KeyUse, PlaneScene, SceneKey, key_uses, scene_keys};
use dwell_validation::manual::{KeyFault, PlantedFault, PlantedResult, PlantedScene, REQUIRED};
use rayon::prelude::*;
use toml::Table;

/// Scenes in which a key is tried, and alterations of it in each.
const MAX_SCENES: usize = 4;
const MAX_ALTERATIONS: usize = 12;
/// Uses in a scene that are tried.
const MAX_USES: usize = 3;

/// What became of a fault in each key that holds a value, in the order of `keys.toml`.
pub fn key_faults(scenes: &[PlantedScene]) -> Vec<KeyFault> {
    let uses: Vec<Vec<KeyUse>> = scenes.iter().map(|s| key_uses(s.text())).collect();
    let one = |key: SceneKey| {
        let uses_it = |k: &usize| uses[*k].iter().any(|u| u.key == key.id);
        let users: Vec<usize> = (0..scenes.len()).filter(uses_it).collect();
        let fault = planted_fault(&key, &users, scenes, &uses);
        KeyFault { key: key.id, fault }
    };
    let keys = scene_keys().into_par_iter();
    keys.filter(|key| !key.holds_keys).map(one).collect()
}

/// The first fault in a key that enough checks detect, or else the best.
fn planted_fault(
    key: &SceneKey,
    users: &[usize],
    scenes: &[PlantedScene],
    uses: &[Vec<KeyUse>],
) -> PlantedFault {
    let mut quickest = users.to_vec();
    quickest.sort_by_key(|&k| scenes[k].cost());
    let mut best = PlantedFault::Unchanged;
    let [mut refused, mut unchanged] = [false; 2];
    for &k in quickest.iter().take(MAX_SCENES) {
        let scene = &scenes[k];
        let root: Table = toml::from_str(scene.text()).unwrap_or_default();
        let here = uses[k].iter().filter(|u| u.key == key.id).take(MAX_USES);
        let texts = here.flat_map(|key_use| altered_texts(&root, key_use));
        for altered in texts.take(MAX_ALTERATIONS) {
            // A text that is no scene is a fault that the reader refuses.
            let Ok(read) = PlaneScene::parse(&scene.scene().name, &altered.text) else {
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
            if best.detected_by().len() < detected_by.len() || best == PlantedFault::Unchanged {
                best = PlantedFault::Detected {
                    scene: scene.scene().name.clone(),
                    what: altered.what,
                    by: detected_by,
                };
            }
            if enough {
                return best;
            }
        }
    }
    match best {
        PlantedFault::Unchanged if refused && !unchanged => PlantedFault::Refused,
        best => best,
    }
}
