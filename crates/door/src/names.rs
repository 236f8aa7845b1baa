//! Names that a scene accepts.

use crate::model::Model;
use std::collections::HashSet;
use std::iter;

/// The names in the scene of bodies, joints, and the coordinates of joints.
pub(crate) struct Names {
    pub(crate) bodies: Vec<String>,
    pub(crate) joints: Vec<String>,
    pub(crate) coordinates: Vec<String>,
}

impl Names {
    pub(crate) fn new(model: &Model) -> Self {
        // A body and a coordinate have different names.
        let mut taken = HashSet::from(["t".to_owned()]);
        let bodies = model.bodies.iter();
        let bodies = bodies.map(|body| free_name(&allowed(&body.name), &mut taken));
        let bodies = bodies.collect();
        let names = model.joints.iter().map(|joint| allowed(&joint.name));
        let coordinates = names.clone().map(|name| {
            let name = format!("q_{}", name.replace('-', "_"));
            free_name(&name, &mut taken)
        });
        let coordinates = coordinates.collect();
        let mut of_joints = HashSet::new();
        let joints = names.map(|name| free_name(&name, &mut of_joints)).collect();
        Self {
            bodies,
            joints,
            coordinates,
        }
    }

    /// What was renamed: the former name and the new one.
    pub(crate) fn changed(&self, model: &Model) -> Vec<[String; 2]> {
        let bodies = model.bodies.iter().map(|body| &body.name);
        let joints = model.joints.iter().map(|joint| &joint.name);
        let old = bodies.chain(joints);
        let pairs = old.zip(self.bodies.iter().chain(&self.joints));
        let changed = pairs.filter(|(old, new)| old != new);
        changed
            .map(|(old, new)| [old.clone(), new.clone()])
            .collect()
    }
}

/// A name of letters, digits, `_` and `-`.
pub(crate) fn allowed(name: &str) -> String {
    let is_other = |c: char| !(c.is_alphanumeric() || c == '-');
    let name = name.trim().replace(is_other, "_");
    match name.is_empty() {
        true => "unnamed".to_owned(),
        false => name.chars().take(60).collect(),
    }
}

/// The name, with a number if another part has it.
pub(crate) fn free_name(name: &str, taken: &mut HashSet<String>) -> String {
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    let mut all = iter::once(name.to_owned()).chain(numbered);
    let free = all.find(|one| !taken.contains(one)).unwrap_or_default();
    taken.insert(free.clone());
    free
}
