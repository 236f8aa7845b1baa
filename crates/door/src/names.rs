//! Names that a scene accepts.

use crate::model::Model;
use std::collections::HashSet;

/// Gives all parts names that a scene accepts, and returns the changes: the former name and the new one.
pub(crate) fn rename(model: &mut Model) -> Vec<[String; 2]> {
    let mut changes = Vec::new();
    let mut change = |name: &mut String, taken: &mut HashSet<String>| {
        let new = free_name(&allowed(name), taken);
        if new != *name {
            changes.push([std::mem::replace(name, new.clone()), new]);
        }
    };
    // A body and a coordinate have different names.
    let mut taken = HashSet::from(["t".to_owned()]);
    for body in &mut model.bodies {
        change(&mut body.name, &mut taken);
    }
    let mut of_joints = HashSet::new();
    for joint in &mut model.joints {
        let name = format!("q_{}", allowed(&joint.name).replace('-', "_"));
        joint.coordinate = free_name(&name, &mut taken);
        change(&mut joint.name, &mut of_joints);
    }
    for coupling in &mut model.couplings {
        change(&mut coupling.name, &mut of_joints);
    }
    let mut of_loads = HashSet::new();
    for load in &mut model.loads {
        change(&mut load.name, &mut of_loads);
    }
    changes
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
    let mut free = name.to_owned();
    let mut number = 1;
    while !taken.insert(free.clone()) {
        number += 1;
        free = format!("{name}_{number}");
    }
    free
}
