//! Names that a scene accepts.

use crate::model::{GROUND, Model};
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
        let names = model
            .bodies
            .iter()
            .enumerate()
            .map(|(body, of)| match body {
                GROUND => "ground".to_owned(),
                _ => free_name(&allowed(&of.name), &mut taken),
            });
        let bodies: Vec<String> = names.collect();
        let coordinate = |name: &str| {
            let plain = name
                .chars()
                .map(|c| if c.is_alphanumeric() { c } else { '_' });
            format!("q_{}", plain.collect::<String>())
        };
        let of_joints = model.joints.iter().map(|joint| joint.name.as_str());
        let coordinates = of_joints
            .clone()
            .map(|name| free_name(&coordinate(name), &mut taken))
            .collect();
        let mut of_kind = HashSet::new();
        let joints = of_joints
            .map(|name| free_name(&allowed(name), &mut of_kind))
            .collect();
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
            .map(|body| body.name.as_str())
            .zip(&self.bodies);
        let joints = model
            .joints
            .iter()
            .map(|joint| joint.name.as_str())
            .zip(&self.joints);
        let pairs = bodies.chain(joints).map(|(old, new)| (old, new.as_str()));
        pairs.filter(|(old, new)| old != new).collect()
    }
}

/// A name of letters, digits, `_` and `-`.
pub(crate) fn allowed(name: &str) -> String {
    let one = |c: char| {
        if c.is_alphanumeric() || c == '-' {
            c
        } else {
            '_'
        }
    };
    let name: String = name.trim().chars().take(60).map(one).collect();
    if name.is_empty() {
        "unnamed".to_owned()
    } else {
        name
    }
}

/// The name, with a number if another part has it.
pub(crate) fn free_name(name: &str, taken: &mut HashSet<String>) -> String {
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    let all = std::iter::once(name.to_owned()).chain(numbered);
    let free = all
        .into_iter()
        .find(|one| !taken.contains(one))
        .unwrap_or_default();
    taken.insert(free.clone());
    free
}
