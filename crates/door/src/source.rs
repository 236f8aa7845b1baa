//! Which files are read, and by which reader.

use crate::error::DoorError;
use crate::finding::Findings;
use crate::options::{Format, ImportOptions};
use crate::plane;
use crate::scene;
use crate::settle::{Read, settle};
use crate::xml::{TextFile, Xml};
use crate::{Import, asmt, head, mjcf, pmks, sdf, urdf};
use std::io::Read as _;
use std::path::{Component, Path};

/// Larger files are refused, in bytes.
const LARGEST: u64 = 64 << 20;

/// Reads a file of text.
pub(crate) fn read(path: &Path, name: &str) -> Result<String, DoorError> {
    let failed = |reason: String| DoorError::File {
        file: name.to_owned(),
        reason,
    };
    let data = std::fs::metadata(path).map_err(|e| failed(e.to_string()))?;
    if !data.is_file() || data.len() > LARGEST {
        return Err(failed(format!(
            "it is no file, or larger than {} MB",
            LARGEST >> 20
        )));
    }
    let file = std::fs::File::open(path).map_err(|e| failed(e.to_string()))?;
    let mut text = String::new();
    let read = file.take(LARGEST).read_to_string(&mut text);
    read.map_err(|e| failed(e.to_string()))?;
    Ok(text)
}

pub(crate) fn import(
    name: &str,
    text: &str,
    options: &ImportOptions,
    folder: Option<&Path>,
) -> Result<Import, DoorError> {
    let format = options.from.or_else(|| format(name, text));
    let file = name.to_owned();
    let format = format.ok_or(DoorError::Format { file })?;
    let findings = Findings::default();
    let read = match format {
        Format::Mjcf => of_xml(
            format,
            &with_includes(name, text, folder)?,
            findings,
            options,
        )?,
        Format::Urdf | Format::Sdf => {
            of_xml(format, &[TextFile::new(name, text)], findings, options)?
        }
        Format::Asmt => {
            let mut file = TextFile::new(name, &asmt::as_xml(text));
            file.shown = Some(text.into());
            of_xml(format, &[file], findings, options)?
        }
        Format::Pmks => pmks::read(&TextFile::new(name, text), findings)?,
    };
    let coverage = read.coverage;
    let model = settle(read, options)?;
    let plane = plane::find(&model, options);
    let mut import = Import {
        scene: scene::write(&model, plane)?,
        findings: model.findings.sorted(),
        plane: plane.map(|plane| [plane.x, plane.y, plane.normal]),
        coverage,
    };
    // The scene begins with all findings, among them those of its writer.
    import.scene = format!("{}\n{}", head(name, text, &import, &model), import.scene);
    Ok(import)
}

/// The format that the ending of a file shows, or its root element.
fn format(name: &str, text: &str) -> Option<Format> {
    let begins = |what: &str| text.trim_start().starts_with(what);
    let has = |what: &str| text.contains(what);
    let ending = Path::new(name).extension();
    match ending.and_then(|ending| ending.to_str()) {
        Some("mjcf") => Some(Format::Mjcf),
        Some("urdf") => Some(Format::Urdf),
        Some("sdf" | "world") => Some(Format::Sdf),
        Some("asmt") => Some(Format::Asmt),
        _ if begins("<") && has("<mujoco") => Some(Format::Mjcf),
        _ if begins("<") && has("<sdf") => Some(Format::Sdf),
        _ if begins("<") && has("<robot") => Some(Format::Urdf),
        _ if begins("OndselSolver") => Some(Format::Asmt),
        _ if has(".") && !text.trim().contains(char::is_whitespace) => Some(Format::Pmks),
        _ => None,
    }
}

/// The file and those that it includes, each once.
fn with_includes(
    name: &str,
    text: &str,
    folder: Option<&Path>,
) -> Result<Vec<TextFile>, DoorError> {
    let mut files = vec![TextFile::new(name, text)];
    let mut next = 0;
    while next < files.len() {
        let tree = files[next].parse()?;
        let mut wanted: Vec<TextFile> = Vec::new();
        let mut size = files.iter().map(|file| file.text.len()).sum::<usize>();
        for include in tree
            .descendants()
            .filter(|node| node.has_tag_name("include"))
        {
            let file = include.attribute("file").unwrap_or_default();
            if files.iter().chain(&wanted).any(|one| &*one.file == file) {
                continue;
            }
            let place = (include.range().start, include.range().len());
            let refuse =
                |why: &str| files[next].error(place, format!("`{file}` is not read: {why}"), "");
            let folder = folder.ok_or_else(|| refuse("only the text is given"))?;
            let below = |part| matches!(part, Component::Normal(_) | Component::CurDir);
            if !Path::new(file).components().all(below) {
                return Err(refuse("it is not below the folder of the model"));
            }
            let text = read(&folder.join(file), file).map_err(|e| refuse(&e.to_string()))?;
            size += text.len();
            if size as u64 > LARGEST {
                return Err(refuse("all files together are too large"));
            }
            wanted.push(TextFile::new(file, &text));
        }
        drop(tree);
        files.extend(wanted);
        next += 1;
    }
    Ok(files)
}

fn of_xml(
    format: Format,
    files: &[TextFile],
    findings: Findings,
    options: &ImportOptions,
) -> Result<Read, DoorError> {
    let trees = files.iter().map(TextFile::parse);
    let trees = trees.collect::<Result<Vec<_>, _>>()?;
    for (file, tree) in files.iter().zip(&trees) {
        let is_macro = |space: &str| space.contains("xacro");
        let mut nodes = tree.descendants();
        if let Some(node) = nodes.find(|node| node.tag_name().namespace().is_some_and(is_macro)) {
            let message = "the file has macros of xacro".to_owned();
            return Err(file.error((node.range().start, 1), message, "run xacro first"));
        }
    }
    let xml = Xml::new(files, &trees, findings);
    match format {
        Format::Urdf => urdf::read(&xml, options),
        Format::Sdf => sdf::read(&xml),
        Format::Asmt => asmt::read(&xml),
        Format::Mjcf | Format::Pmks => mjcf::read(&xml, options),
    }
}
