//! Which folders are validated.

use miette::{Report, miette};
use std::path::{Path, PathBuf};

/// The folders of the named cases, or of all cases below `folder`, in the order of their names.
pub(crate) fn find(names: &[String], folder: &Path) -> Result<Vec<PathBuf>, Report> {
    let all = list(folder);
    if names.is_empty() {
        return match all {
            Ok(cases) if cases.is_empty() => Err(miette!(
                help = "a case is a folder with a scene.toml; name the folder of the cases with --folder",
                "no case in {}",
                folder.display()
            )),
            Ok(cases) => Ok(cases),
            Err(reason) => Err(miette!(
                help = "run from the repository's folder, or name the folder of the cases with --folder",
                "cannot list the cases in {}: {reason}",
                folder.display()
            )),
        };
    }
    names
        .iter()
        .map(|name| {
            let given = PathBuf::from(name);
            let places = [folder.join(name), given];
            let found = places.into_iter().find(|p| p.join("scene.toml").is_file());
            found.ok_or_else(|| {
                let known: Vec<String> = all
                    .iter()
                    .flatten()
                    .filter_map(|p| Some(p.file_name()?.to_string_lossy().into_owned()))
                    .collect();
                miette!(
                    help = format!("the cases are: {}", known.join(", ")),
                    "there is no case `{name}`"
                )
            })
        })
        .collect()
}

fn list(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut cases = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.join("scene.toml").is_file() {
            cases.push(path);
        }
    }
    cases.sort();
    Ok(cases)
}
