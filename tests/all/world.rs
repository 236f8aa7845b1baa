//! Where the cases are, and how a scene becomes a model.

use dwell_geometry::Reaction;
use dwell_kinetostatics::{Exact, Model};
use dwell_scene::Scene;
use std::path::{Path, PathBuf};

/// The repository's folder.
pub(crate) fn home() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The cases: folders of `validation/` that hold a scene.
pub(crate) fn cases() -> Vec<String> {
    let entries = std::fs::read_dir(home().join("validation")).expect("a folder");
    let folders = entries.map(|entry| entry.expect("an entry"));
    let mut names: Vec<String> = folders
        .filter(|folder| folder.path().join("scene.toml").is_file())
        .map(|folder| folder.file_name().into_string().expect("a name"))
        .collect();
    names.sort();
    assert!(names.len() >= 25, "{names:?}");
    names
}

/// The scene of a case in `validation/`.
pub(crate) fn scene(case: &str) -> Scene {
    let path = home().join("validation").join(case).join("scene.toml");
    Scene::read(path).unwrap_or_else(|e| panic!("{case}: {e:?}"))
}

/// A scene's model with every reaction.
pub(crate) fn model(scene: &Scene) -> Exact {
    model_for(scene, &scene.mechanism.reactions())
}

/// A scene's model with some reactions.
pub(crate) fn model_for(scene: &Scene, reactions: &[Reaction]) -> Exact {
    let start = scene.assembly.to_start();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, reactions)
        .unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    Exact::new(model).expect("one actuator")
}
