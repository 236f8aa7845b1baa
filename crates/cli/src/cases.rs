//! The scenes of the cases to validate.

use dwell_scene::Scene;
use miette::{Report, miette};
use std::path::{Path, PathBuf};

/// The file that a case in a folder of its own has.
const SCENE: &str = "scene.toml";
/// The folder of scenes in space among the cases, each with its reference beside it.
const IN_SPACE: &str = "spatial";

/// How a case is called that has no name, because its scene cannot be used.
pub(crate) fn shown(scene: &Path) -> String {
    let folder = scene.parent().filter(|_| scene.ends_with(SCENE));
    folder.unwrap_or(scene).display().to_string()
}

/// The scenes of the named cases, each once, or of all cases in `folder`, ordered by name, those in space last.
pub(crate) fn find(names: &[String], folder: &Path) -> Result<Vec<PathBuf>, Report> {
    let all = list(folder);
    if names.is_empty() {
        let shown = folder.display();
        let cases = all.map_err(|reason| {
            miette!(
                help = "run from the folder above `validation`, or name the folder of the cases with \
                     --folder, or a case by its path",
                "cannot list the cases in `{shown}`: {reason}"
            )
        })?;
        return if cases.is_empty() {
            Err(miette!(
                help = "a case is a folder with a scene.toml; name the folder of the cases with --folder",
                "there is no case in `{shown}`"
            ))
        } else {
            Ok(cases)
        };
    }
    let mut found: Vec<PathBuf> = Vec::new();
    for name in names {
        let case = find_one(name, folder, all.as_deref().unwrap_or(&[]))?;
        let canonical = |path: &PathBuf| path.canonicalize().unwrap_or_else(|_| path.clone());
        let mut known = found.iter().map(canonical);
        if known.all(|other| other != canonical(&case)) {
            found.push(case);
        }
    }
    Ok(found)
}

fn find_one(name: &str, folder: &Path, all: &[PathBuf]) -> Result<PathBuf, Report> {
    let given = Path::new(name);
    // The scene file may be given instead of its folder.
    let is_scene = given.file_name().is_some_and(|n| n == SCENE);
    let of_scene = match given.parent() {
        Some(parent) if is_scene && parent != Path::new("") => parent,
        Some(_) if is_scene => Path::new("."),
        _ => given,
    };
    let candidates = [
        folder.join(name).join(SCENE),
        folder.join(IN_SPACE).join(format!("{name}.toml")),
        of_scene.join(SCENE),
        given.join(SCENE),
    ];
    if let Some(case) = candidates.into_iter().find(|path| path.is_file()) {
        return Ok(case);
    }
    let known: Vec<String> = all.iter().map(|path| Scene::name_of_file(path)).collect();
    let help = if given.is_file() {
        format!("`{name}` is a file: a case is a folder with a {SCENE}")
    } else if given.is_dir() {
        format!("there is no {SCENE} in `{name}`")
    } else if known.is_empty() {
        format!("there are no cases in `{}`", folder.display())
    } else {
        format!("the cases are: {}", known.join(", "))
    };
    Err(miette!(help = help, "there is no case `{name}`"))
}

fn list(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let sorted = |folder: &Path| {
        let paths = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
        let mut all = paths.collect::<std::io::Result<Vec<PathBuf>>>()?;
        all.sort();
        Ok(all)
    };
    let folders = sorted(folder)?.into_iter().map(|path| path.join(SCENE));
    let mut cases: Vec<PathBuf> = folders.filter(|path| path.is_file()).collect();
    let in_space: std::io::Result<Vec<PathBuf>> = sorted(&folder.join(IN_SPACE));
    let is_scene = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
    cases.extend(in_space.unwrap_or_default().into_iter().filter(is_scene));
    Ok(cases)
}
