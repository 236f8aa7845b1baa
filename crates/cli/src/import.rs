//! `dwell import`: writes a scene from a model of another program.

use crate::values::{Choices, choice, parse_length};
use crate::{print, print_note};
use clap::Args;
use dwell_door::{Closing, DoorError, Effect, Format, ImportOptions};
use dwell_scene::Scene;
use miette::{LabeledSpan, NamedSource, Report, miette};
use std::path::{Path, PathBuf};

const FORMATS: Choices<Format> = &[
    ("mjcf", Format::Mjcf, "MuJoCo"),
    (
        "urdf",
        Format::Urdf,
        "ROS, with the elements by which several programs close loops",
    ),
    ("sdf", Format::Sdf, "Gazebo"),
    ("asmt", Format::Asmt, "OndselSolver and FreeCAD"),
    (
        "pmks",
        Format::Pmks,
        "The link of a PMKS+ mechanism, in a file",
    ),
];

/// Whether the scene is always spatial.
const PLANE: Choices<bool> = &[
    (
        "auto",
        false,
        "A mechanism that moves in a plane becomes a planar scene",
    ),
    ("off", true, "Always a scene in space"),
];

#[derive(Debug, Args)]
pub(crate) struct ImportArgs {
    /// The model
    model: PathBuf,
    /// Its format (default: by the ending and the beginning of the file)
    #[arg(long, value_parser = choice(FORMATS), value_name = "FORMAT")]
    from: Option<Format>,
    /// A joint that drives, once for each (default: those that the file drives)
    #[arg(long, value_name = "JOINT")]
    drive: Vec<String>,
    /// The keyframe in whose pose the mechanism is drawn
    #[arg(long, value_name = "NAME")]
    key: Option<String>,
    /// Coordinates of joints as drawn, in the file's coordinate, in rad or m: q1=2.2,p1=-1.4
    #[arg(long, value_delimiter = ',', value_parser = parse_start, value_name = "JOINT=VALUE", allow_hyphen_values = true)]
    start: Vec<(String, f64)>,
    /// Two frames that a joint connects: FRAME=FRAME:KIND; KIND is revolute (about z), spherical or fixed
    #[arg(long, value_name = "FRAME=FRAME:KIND")]
    close: Vec<Closing>,
    /// The YAML file of an extended URDF that closes its loops
    #[arg(long, value_name = "FILE")]
    loops: Option<PathBuf>,
    /// A floating body that is held where it is drawn
    #[arg(long, value_name = "BODY")]
    fix: Option<String>,
    /// Planar mechanisms
    #[arg(long, action = clap::ArgAction::Set, value_parser = choice(PLANE), default_value = "auto", value_name = "auto|off")]
    plane: bool,
    /// How far, in m, points may be from the plane of a planar mechanism (default: 1e-6 of its size)
    #[arg(long, value_parser = parse_length, value_name = "LENGTH", allow_hyphen_values = true)]
    tolerance: Option<f64>,
    /// Write the scene even if parts are left out on which a motion or a force may depend
    #[arg(long)]
    allow: bool,
}

/// Writes the scene, and prints what became of the parts of the model.
/// `out` is the scene file, a folder for it, or `-`; `name` replaces its name in a folder.
pub(crate) fn write(arguments: &ImportArgs, out: &Path, name: Option<&str>) -> Result<(), Report> {
    let import =
        dwell_door::import(&arguments.model, &import_options(arguments)?).map_err(report)?;
    for finding in &import.findings {
        print_note(&finding.to_string());
    }
    let losses = import.losses().count();
    if losses > 0 && !arguments.allow {
        let parts = if losses == 1 {
            "a part is"
        } else {
            "parts are"
        };
        return Err(miette!(
            help = "no scene was written; --allow writes it without them",
            "{losses} {parts} left out on which a motion or a force may depend"
        ));
    }
    // A scene that cannot be read is no result.
    let scene = Scene::parse("the imported scene", &import.scene).map_err(Report::new)?;
    crate::print_warnings(&scene);
    if out == Path::new("-") {
        return print(&import.scene);
    }
    let path = scene_path(&arguments.model, out, name);
    save(&path, &import.scene)?;
    let limits = import
        .findings
        .iter()
        .filter(|one| one.effect == Effect::AtLimits)
        .count();
    let limits = if limits > 0 {
        format!("{limits} parts that act only at limits are left out.\n")
    } else {
        String::new()
    };
    print(&format!(
        "  {shown}\n{limits}Try:\n  dwell check {shown}\n  dwell kinetostatics {shown}\n",
        shown = path.display()
    ))
}

fn import_options(arguments: &ImportArgs) -> Result<ImportOptions, Report> {
    let loops = arguments.loops.as_ref().map(|path| {
        let text = std::fs::read_to_string(path);
        text.map_err(|e| miette!("`{}` cannot be read: {e}", path.display()))
    });
    Ok(ImportOptions {
        from: arguments.from,
        drives: arguments.drive.clone(),
        key: arguments.key.clone(),
        start: arguments.start.clone(),
        close: arguments.close.clone(),
        loops: loops.transpose()?,
        fix: arguments.fix.clone(),
        spatial: arguments.plane,
        tolerance: arguments.tolerance,
    })
}

/// `--out SCENE.toml`, or the model's name in the folder of `--out`.
fn scene_path(model: &Path, out: &Path, name: Option<&str>) -> PathBuf {
    if out.extension().is_some_and(|ending| ending == "toml") {
        return out.to_owned();
    }
    let stem = model
        .file_stem()
        .map_or("model".into(), |stem| stem.to_string_lossy());
    out.join(name.unwrap_or(&stem)).with_added_extension("toml")
}

/// Only an import of the same model is replaced.
fn save(path: &Path, scene: &str) -> Result<(), Report> {
    let shown = path.display();
    let first = scene.lines().next();
    if path.exists() && std::fs::read_to_string(path).is_ok_and(|old| old.lines().next() != first) {
        return Err(miette!(
            help = "give another name with --out",
            "`{shown}` exists already and is no import of this model; it is not replaced"
        ));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let saved = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(path, scene));
    saved.map_err(|e| miette!("`{shown}` cannot be written: {e}"))
}

/// An error of the import, pointing into the file.
fn report(error: DoorError) -> Report {
    let mut diagnostic = miette::MietteDiagnostic::new(error.to_string());
    if !error.help.is_empty() {
        diagnostic = diagnostic.with_help(error.help);
    }
    let Some(part) = error.part else {
        return Report::new(diagnostic);
    };
    let label = LabeledSpan::new(None, part.span.start, part.span.len());
    let source = NamedSource::new(&*part.file, part.text.to_string());
    Report::new(diagnostic.with_label(label)).with_source_code(source)
}

fn parse_start(text: &str) -> Result<(String, f64), String> {
    let (joint, value) = text.split_once('=').ok_or("write JOINT=VALUE")?;
    let value: f64 = value
        .parse()
        .map_err(|_| format!("`{value}` is no number"))?;
    if value.is_finite() {
        Ok((joint.to_owned(), value))
    } else {
        Err("the value has to be finite".to_owned())
    }
}
