//! Which files are read, and by which reader.

use crate::error::{DoorError, Result};
use crate::finding::{Findings, sorted};
use crate::model::Model;
use crate::names::rename;
use crate::options::{Format, ImportOptions};
use crate::settle::settle;
use crate::xml::{Coverage, TextFile, Xml};
use crate::{Import, asmt, head, mjcf, plane, pmks, robot, scene};
use std::io::Read as _;
use std::path::{Component, Path};

/// Larger files are refused, in bytes.
const LARGEST: usize = 64 << 20;

/// Reads a file of text.
pub(crate) fn read(path: &Path, name: &str) -> Result<String> {
    let failed = |reason: String| DoorError::new(format!("`{name}` cannot be read: {reason}"), "");
    let mut text = String::new();
    let file = std::fs::File::open(path);
    let read = file.and_then(|file| file.take(LARGEST as u64 + 1).read_to_string(&mut text));
    match read.map_err(|e| failed(e.to_string()))? {
        0..=LARGEST => Ok(text),
        _ => Err(failed(format!("it is larger than {} MB", LARGEST >> 20))),
    }
}

pub(crate) fn import(
    name: &str,
    text: &str,
    options: &ImportOptions,
    folder: Option<&Path>,
) -> Result<Import> {
    let format = options.from.or_else(|| format(name, text));
    let format = format.ok_or_else(|| {
        let message = match text.trim().is_empty() {
            true => format!("`{name}` is empty"),
            false => format!("neither the ending nor the beginning of `{name}` shows its format"),
        };
        DoorError::new(message, "give --from mjcf, urdf, sdf, asmt or pmks")
    })?;
    let shown = format!("{format:?}").to_uppercase();
    for (given, what) in [
        (options.key.is_some() && format != Format::Mjcf, "keyframes"),
        (
            options.loops.is_some() && format != Format::Urdf,
            "YAML files of loops",
        ),
    ] {
        if given {
            let message = format!("`{name}` is {shown}, which has no {what}");
            return Err(DoorError::new(message, ""));
        }
    }
    let findings = Findings::default();
    let file = TextFile::new(name, text, &findings);
    let (mut model, coverage) = match format {
        Format::Mjcf => of_xml(format, &with_includes(file, folder)?, options)?,
        Format::Urdf | Format::Sdf => of_xml(format, &[file], options)?,
        Format::Asmt => {
            let mut tree = file.beside(name, &asmt::as_xml(text));
            tree.shown = Some(text.into());
            of_xml(format, &[tree], options)?
        }
        Format::Pmks => pmks::read(&file)?,
    };
    settle(&mut model, options)?;
    let renamed = rename(&mut model);
    let plane = plane::find(&model, options);
    let mut import = Import {
        scene: scene::write(&model, plane)?,
        findings: sorted(&findings),
        plane: plane.map(|plane| [plane.x, plane.y, plane.normal]),
        coverage,
    };
    // The scene begins with all findings, among them those of its writer.
    import.scene = format!(
        "{}\n\n{}",
        head(name, text, &import, &renamed),
        import.scene
    );
    Ok(import)
}

/// The format that the ending of a file shows, or its beginning.
fn format(name: &str, text: &str) -> Option<Format> {
    let ending = Path::new(name).extension();
    let is_xml = text.trim_start().starts_with('<');
    let has = |element: &str| is_xml && text.contains(element);
    match ending.and_then(|ending| ending.to_str()) {
        Some("mjcf") => Some(Format::Mjcf),
        Some("urdf") => Some(Format::Urdf),
        Some("sdf" | "world") => Some(Format::Sdf),
        Some("asmt") => Some(Format::Asmt),
        _ if has("<mujoco") => Some(Format::Mjcf),
        _ if has("<sdf") => Some(Format::Sdf),
        _ if has("<robot") => Some(Format::Urdf),
        _ if text.starts_with("OndselSolver") => Some(Format::Asmt),
        _ if pmks::is_link(text) => Some(Format::Pmks),
        _ => None,
    }
}

/// The file and those that it includes, each once.
fn with_includes(file: TextFile, folder: Option<&Path>) -> Result<Vec<TextFile>> {
    let mut files = vec![file];
    let mut next = 0;
    while let Some(from) = files.get(next) {
        let mut wanted: Vec<TextFile> = Vec::new();
        let mut size: usize = files.iter().map(|file| file.text.len()).sum();
        let tree = from.parse()?;
        let nodes = tree.descendants();
        for include in nodes.filter(|node| node.has_tag_name("include")) {
            let file = include.attribute("file").unwrap_or_default();
            if files.iter().chain(&wanted).any(|one| &*one.file == file) {
                continue;
            }
            let refuse = |why: &str| {
                let message = format!("`{file}` is not read: {why}");
                from.error(include.range(), &message, "")
            };
            let folder = folder.ok_or_else(|| refuse("only the text is given"))?;
            let below = |part| matches!(part, Component::Normal(_) | Component::CurDir);
            if !Path::new(file).components().all(below) {
                return Err(refuse("it is not below the folder of the model"));
            }
            let text = read(&folder.join(file), file).map_err(|e| refuse(&e.to_string()))?;
            size += text.len();
            if size > LARGEST {
                return Err(refuse("all files together are too large"));
            }
            wanted.push(from.beside(file, &text));
        }
        files.extend(wanted);
        next += 1;
    }
    Ok(files)
}

fn of_xml(
    format: Format,
    files: &[TextFile],
    options: &ImportOptions,
) -> Result<(Model, Coverage)> {
    let trees = files.iter().map(TextFile::parse);
    let trees = trees.collect::<Result<Vec<_>>>()?;
    let xml = Xml::new(files, &trees);
    let root = xml.root();
    let (expected, read) = match format {
        Format::Urdf => ("robot", robot::urdf as fn(&_, &_) -> _),
        Format::Sdf => ("sdf", robot::sdf as _),
        Format::Asmt => ("asmt", asmt::read as _),
        Format::Mjcf | Format::Pmks => ("mujoco", mjcf::read as _),
    };
    if root.tag() != expected {
        let message = format!(
            "the file begins with `{}` in place of `{expected}`",
            root.tag()
        );
        return Err(root.error_with(message, "--from names another format"));
    }
    read(&xml, options)
}
