//! Finds the folders to validate.

use miette::{Report, miette};
use std::path::{Path, PathBuf};

/// The file that every case has.
const SCENE: &str = "scene.toml";

/// The folders of the named cases, each once, or of all cases in `folder`, ordered by name.
pub(crate) fn find(names: &[String], folder: &Path) -> Result<Vec<PathBuf>, Report> {
    let all = list(folder);
    if names.is_empty() {
        return match all {
            Ok(cases) if cases.is_empty() => Err(miette!(
                help = "a case is a folder with a scene.toml; name the folder of the cases with --folder",
                "there is no case in `{}`",
                folder.display()
            )),
            Ok(cases) => Ok(cases),
            Err(reason) => Err(miette!(
                help = "run from the folder above `validation`, or name the folder of the cases with \
                     --folder, or a case by its path",
                "cannot list the cases in `{}`: {reason}",
                folder.display()
            )),
        };
    }
    let mut found: Vec<PathBuf> = Vec::new();
    for name in names {
        let case = find_one(name, folder, all.as_deref().unwrap_or(&[]))?;
        let canonical = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if found
            .iter()
            .all(|other| canonical(other) != canonical(&case))
        {
            found.push(case);
        }
    }
    Ok(found)
}

fn find_one(name: &str, folder: &Path, all: &[PathBuf]) -> Result<PathBuf, Report> {
    let given = Path::new(name);
    // The scene file itself stands for its folder.
    let of_scene = given
        .file_name()
        .filter(|n| *n == SCENE)
        .and(given.parent())
        .map(|p| {
            if p.as_os_str().is_empty() {
                Path::new(".")
            } else {
                p
            }
        });
    let candidates = [
        Some(folder.join(name)),
        of_scene.map(Path::to_owned),
        Some(given.to_owned()),
    ];
    let case = candidates
        .into_iter()
        .flatten()
        .find(|p| p.join(SCENE).is_file());
    if let Some(case) = case {
        return Ok(case);
    }
    let known: Vec<String> = all
        .iter()
        .filter_map(|p| Some(p.file_name()?.to_string_lossy().into_owned()))
        .collect();
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
    let mut cases = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.join(SCENE).is_file() {
            cases.push(path);
        }
    }
    cases.sort();
    Ok(cases)
}
