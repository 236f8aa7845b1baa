//! The folders of the cases to validate.

use miette::{Report, miette};
use std::path::{Path, PathBuf};

/// The file that every case has.
const SCENE: &str = "scene.toml";

/// The folders of the named cases, each once, or of all cases in `folder`, ordered by name.
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

/// The scenes in space in a folder of cases (all if no names are given, otherwise the named ones), and the remaining names.
pub(crate) fn find_in_space(names: &[String], folder: &Path) -> (Vec<PathBuf>, Vec<String>) {
    let below = folder.join("spatial");
    let (named, others): (Vec<_>, Vec<_>) = names.iter().cloned().partition(|name| {
        let is_case = folder.join(name).join(SCENE).is_file();
        !is_case && below.join(format!("{name}.toml")).is_file()
    });
    if !names.is_empty() {
        let path = |name: &String| below.join(format!("{name}.toml"));
        return (named.iter().map(path).collect(), others);
    }
    let Ok(entries) = std::fs::read_dir(&below) else {
        return (Vec::new(), others);
    };
    let paths = entries.flatten().map(|entry| entry.path());
    let is_case = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
    let mut found: Vec<PathBuf> = paths.filter(is_case).collect();
    found.sort();
    (found, others)
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
    let candidates = [folder.join(name), of_scene.to_owned(), given.to_owned()];
    if let Some(case) = candidates.into_iter().find(|p| p.join(SCENE).is_file()) {
        return Ok(case);
    }
    let names = all.iter().filter_map(|p| p.file_name());
    let known: Vec<_> = names.map(|name| name.to_string_lossy()).collect();
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
    let paths = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let mut cases = paths.collect::<std::io::Result<Vec<PathBuf>>>()?;
    cases.retain(|path| path.join(SCENE).is_file());
    cases.sort();
    Ok(cases)
}
