//! Where the cases are, and how a scene becomes a model.

use dwell_geometry::Reaction;
use dwell_kinetostatics::{ExactModel, Model};
use dwell_scene::{PlaneScene, SpaceScene};
use std::path::{Path, PathBuf};

/// The repository's folder.
pub fn repository_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The cases: folders of `validation/` that hold a scene.
pub fn case_names() -> Vec<String> {
    let entries = std::fs::read_dir(repository_root().join("validation")).expect("a folder");
    let folders = entries.map(|entry| entry.expect("an entry"));
    let mut names: Vec<String> = folders
        .filter(|folder| folder.path().join("scene.toml").is_file())
        .map(|folder| folder.file_name().into_string().expect("a name"))
        .collect();
    names.sort();
    assert!(names.len() >= 25, "{names:?}");
    names
}

/// The cases in space.
pub fn space_case_names() -> Vec<String> {
    let folder = repository_root().join("validation/spatial");
    let entries = std::fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let scenes = paths.filter(|path| path.extension().is_some_and(|e| e == "toml"));
    let name = |path: std::path::PathBuf| path.file_stem()?.to_str().map(str::to_owned);
    let mut names: Vec<String> = scenes.filter_map(name).collect();
    names.sort();
    names
}

/// The scene of a case in `validation/`.
pub fn scene(case: &str) -> PlaneScene {
    let path = repository_root()
        .join("validation")
        .join(case)
        .join("scene.toml");
    PlaneScene::read(path).unwrap_or_else(|e| panic!("{case}: {e:?}"))
}

/// The scene of a case in space.
pub fn space_scene(case: &str) -> SpaceScene {
    let file = format!("validation/spatial/{case}.toml");
    SpaceScene::read(repository_root().join(file)).unwrap_or_else(|e| panic!("{case}: {e:?}"))
}

/// A scene's model with every reaction.
pub fn model(scene: &PlaneScene) -> ExactModel {
    model_for(scene, &scene.mechanism.reactions())
}

/// A scene's model with some reactions.
pub fn model_for(scene: &PlaneScene, reactions: &[Reaction]) -> ExactModel {
    let start = scene.assembly.to_configuration();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, reactions)
        .unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    ExactModel::new(model).expect("one actuator")
}
