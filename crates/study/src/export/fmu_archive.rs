//! An FMU as one file: its texts, and a library for this platform where a C compiler is found.

use crate::explain::{StudyError, scene_error};
use dwell_export::{Export, FmiVersion, FmuFiles, fmu_files};
use dwell_scene::{SceneFile, SceneLocation};
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// A C compiler that is tried.
const COMPILERS: [&str; 3] = ["cc", "gcc", "clang"];

/// The bytes of an FMU, and a sentence about its library.
///
/// # Errors
/// [`StudyError::Scene`] if it cannot be packed.
pub fn fmu_archive(
    scene: &SceneFile,
    export: &Export,
    version: FmiVersion,
) -> Result<(Vec<u8>, String), StudyError> {
    let files = fmu_files(export, version, scene.source.inner());
    let folder = platform(version);
    let compiled = folder.and_then(|folder| Some((folder, compile(&files)?)));
    let sentence = match (&compiled, folder) {
        (Some((folder, (compiler, _))), _) => {
            format!("sources, and a library for {folder} by {compiler}")
        }
        (None, Some(_)) => {
            "sources only: no C compiler was found here; an importer compiles them".to_owned()
        }
        (None, None) => "sources only: this platform has no library".to_owned(),
    };
    let library = compiled.map(|(folder, (_, bytes))| {
        let path = format!("binaries/{folder}/{}.so", files.identifier);
        (path, bytes)
    });
    let texts = files.texts.iter();
    let texts = texts.map(|(path, text)| (path.as_str(), text.as_bytes()));
    let library = library
        .iter()
        .map(|(path, bytes)| (path.as_str(), &bytes[..]));
    let bytes = zip(texts.chain(library)).map_err(|error| {
        let place = [(SceneLocation::Whole, "of this scene")];
        scene_error(
            scene,
            format!("the FMU cannot be packed: {error}"),
            "",
            place,
        )
    })?;
    Ok((bytes, sentence))
}

/// The folder of this platform's library.
fn platform(version: FmiVersion) -> Option<&'static str> {
    let linux = cfg!(all(target_os = "linux", target_arch = "x86_64"));
    linux.then(|| version.linux_folder())
}

/// A folder that is removed with its owner.
struct Scratch(PathBuf);

impl Drop for Scratch {
    fn drop(&mut self) {
        // What is left behind is in the system's folder of temporary files.
        _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The library, by the first compiler that makes one.
fn compile(files: &FmuFiles) -> Option<(&'static str, Vec<u8>)> {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let unique = format!("dwell-fmu-{}-{number}", std::process::id());
    let scratch = Scratch(std::env::temp_dir().join(unique));
    for (path, text) in &files.texts {
        let path = scratch.0.join(path);
        std::fs::create_dir_all(path.parent()?).ok()?;
        std::fs::write(path, text).ok()?;
    }
    let found = COMPILERS
        .into_iter()
        .find(|compiler| compiles(compiler, files, &scratch.0))?;
    let bytes = std::fs::read(scratch.0.join("library.so")).ok()?;
    Some((found, bytes))
}

fn compiles(compiler: &str, files: &FmuFiles, folder: &Path) -> bool {
    let mut command = Command::new(compiler);
    command
        .args([
            "-std=c99",
            "-O2",
            "-fPIC",
            "-shared",
            "-fvisibility=hidden",
            "-ffp-contract=off",
        ])
        .args(["-o", "library.so"])
        .args(files.sources.iter().map(|name| format!("sources/{name}")))
        .arg("-lm")
        .current_dir(folder);
    command.output().is_ok_and(|output| output.status.success())
}

/// A ZIP archive whose bytes depend only on the files and their order; it contains no times.
fn zip<'a>(files: impl Iterator<Item = (&'a str, &'a [u8])>) -> zip::result::ZipResult<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (path, bytes) in files {
        archive.start_file(path, options)?;
        archive.write_all(bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}
