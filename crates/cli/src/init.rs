//! `dwell init`: writes a commented scene to start from.

use crate::print;
use miette::{Report, miette};
use std::fs::File;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// The scene.
const SCENE: &str = include_str!("init.toml");
/// The extension of a scene file.
const ENDING: &str = "toml";

/// Writes the scene to a new file, and prints the next commands.
pub(crate) fn write(path: &Path) -> Result<(), Report> {
    let path: PathBuf = match path.extension() {
        Some(ending) if ending == ENDING => path.to_owned(),
        _ => path.with_added_extension(ENDING),
    };
    let shown = path.display();
    let mut file = File::create_new(&path).map_err(|e| match e.kind() {
        ErrorKind::AlreadyExists => miette!(
            help = "give another name, as in `dwell init my-mechanism`",
            "`{shown}` exists already, and is not replaced"
        ),
        _ => miette!("`{shown}` cannot be written: {e}"),
    })?;
    let written = file.write_all(SCENE.as_bytes());
    written.map_err(|e| miette!("`{shown}` cannot be written: {e}"))?;
    print(&format!(
        "  {shown}\nA slider-crank with a motor and friction. Change it, and try:\n  dwell check {shown}\n  dwell kinetostatics \
         {shown}\n  dwell simulate {shown}\n"
    ))
}
