//! Names that a scene accepts.

use crate::model::Model;
use std::collections::HashSet;

/// The names in the scene of bodies, joints, and the coordinates of joints.
pub(crate) struct Names {
    pub(crate) bodies: Vec<String>,
    pub(crate) joints: Vec<String>,
    pub(crate) coordinates: Vec<String>,
}

impl Names {
    pub(crate) fn new(model: &Model) -> Self {
        // A body and a coordinate have different names.
        let mut taken: HashSet<String> = ["ground", "t"].map(str::to_owned).into();
        let names = model.bodies.iter().map(|body| body.name.as_str());
        let bodies = names
            .skip(1)
            .map(|name| free_name(&allowed(name), &mut taken));
        let bodies = std::iter::once("ground".to_owned()).chain(bodies).collect();
        let names = model.joints.iter().map(|joint| allowed(&joint.name));
        let coordinate =
            |name: String| free_name(&format!("q_{}", name.replace('-', "_")), &mut taken);
        let coordinates = names.clone().map(coordinate).collect();
        let mut of_joints = HashSet::new();
        let joints = names.map(|name| free_name(&name, &mut of_joints)).collect();
        Self {
            bodies,
            joints,
            coordinates,
        }
    }

    /// What was renamed: the former name and the new one.
    pub(crate) fn changed<'n>(&'n self, model: &'n Model) -> Vec<(&'n str, &'n str)> {
        let bodies = model
            .bodies
            .iter()
            .map(|body| &body.name[..])
            .zip(&self.bodies);
        let joints = model
            .joints
            .iter()
            .map(|joint| &joint.name[..])
            .zip(&self.joints);
        let pairs = bodies.chain(joints).map(|(old, new)| (old, new.as_str()));
        pairs.filter(|(old, new)| old != new).collect()
    }
}

/// A name of letters, digits, `_` and `-`.
pub(crate) fn allowed(name: &str) -> String {
    let is_other = |c: char| !(c.is_alphanumeric() || c == '-');
    let name = name.trim().replace(is_other, "_");
    let name: String = name.chars().take(60).collect();
    if name.is_empty() {
        "unnamed".to_owned()
    } else {
        name
    }
}

/// The name, with a number if another part has it.
pub(crate) fn free_name(name: &str, taken: &mut HashSet<String>) -> String {
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    let mut all = std::iter::once(name.to_owned()).chain(numbered);
    let free = all.find(|one| !taken.contains(one)).unwrap_or_default();
    taken.insert(free.clone());
    free
}
