//! `dwell view`: the live page with a scene.

use crate::options::{Options, STANDARD_INPUT};
use crate::{print, print_note, scene_name, unwritten};
use dwell_report::{Files, OutputFolder, json};
use miette::{Report, miette};
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The element of the page that holds its scene, as `just web` writes it.
const SCENE_ELEMENT: &str = r#"<script id="live-scene" type="application/json">null</script>"#;
const SCENE_START: &str = r#"<script id="live-scene" type="application/json">"#;
/// The name of the page in the program's folder.
const PAGE: &str = "dwell.html";
/// Longest text that the page accepts, the same as for links.
const MAX_BYTES: u64 = 1_000_000;

/// Writes the live page with the text of a scene, which may have errors: the page shows them.
pub(crate) fn write(
    options: &Options,
    scene: &Path,
    page: Option<&Path>,
    folder: OutputFolder,
) -> Result<(), Report> {
    let template = template(page)?;
    let text = text(scene)?;
    // Within a script element only `</` and `<!--` are special; in JSON `<` can be escaped.
    let text = json(&text)
        .map_err(|e| unwritten(&e))?
        .trim_end()
        .replace('<', "\\u003c");
    let html = template.replacen(SCENE_ELEMENT, &format!("{SCENE_START}{text}</script>"), 1);
    let mut files = Files::new();
    files.add(format!("{}-live.html", scene_name(options, scene)), html);
    let written = folder.write(&files).map_err(|e| unwritten(&e))?;
    for path in &written {
        print(&format!("  {}\n", path.display()))?;
        open(path);
    }
    Ok(())
}

/// The page without a scene.
fn template(given: Option<&Path>) -> Result<String, Report> {
    let path = match given {
        Some(path) => path.to_owned(),
        None => found()?,
    };
    let shown = path.display();
    let html = fs::read_to_string(&path).map_err(|e| {
        miette!(
            help = "`just web` writes it to target/web/dwell.html",
            "the live page `{shown}` cannot be read: {e}"
        )
    })?;
    if !html.contains(SCENE_ELEMENT) {
        return Err(miette!(
            help = "give the file dwell.html that `just web` writes",
            "`{shown}` is not a live page without a scene"
        ));
    }
    Ok(html)
}

/// The page in the program's folder, or where `just web` writes it if the program is in `target/release`.
fn found() -> Result<PathBuf, Report> {
    let program = std::env::current_exe();
    let beside = program.as_deref().ok().and_then(Path::parent);
    let mut places = beside
        .map(|folder| [folder.join(PAGE), folder.join("../web").join(PAGE)])
        .into_iter()
        .flatten();
    places.find(|path| path.is_file()).ok_or_else(|| {
        miette!(
            help = "build it with `just web` (it needs the target wasm32-unknown-unknown of Rust), or give its file with --page",
            "the live page is not built: `{PAGE}` is not in the folder of this program"
        )
    })
}

/// The text of the scene.
fn text(scene: &Path) -> Result<String, Report> {
    let shown = scene.display();
    let mut bytes = Vec::new();
    let read = if scene == Path::new(STANDARD_INPUT) {
        std::io::stdin()
            .lock()
            .take(MAX_BYTES + 1)
            .read_to_end(&mut bytes)
    } else {
        fs::File::open(scene).and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes))
    };
    read.map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => miette!(
            help = "`dwell init` writes a scene to begin with",
            "there is no file `{shown}`"
        ),
        _ => miette!("`{shown}` cannot be read: {e}"),
    })?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(miette!(
            help = "the other commands read it",
            "`{shown}` is longer than {MAX_BYTES} bytes: too long for a page"
        ));
    }
    String::from_utf8(bytes).map_err(|e| {
        let line = e.as_bytes()[..e.utf8_error().valid_up_to()]
            .iter()
            .filter(|byte| **byte == b'\n')
            .count();
        miette!(
            help = "save it as UTF-8",
            "`{shown}` is not UTF-8 text, from line {} on",
            line + 1
        )
    })
}

/// Opens a file in the browser. If that fails, the printed path remains.
fn open(path: &Path) {
    let program = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    let mut command = Command::new(program);
    command.arg(path);
    let quiet = command.stdin(Stdio::null()).stdout(Stdio::null());
    if let Err(error) = quiet.stderr(Stdio::null()).spawn() {
        print_note(&format!(
            "note: open it in a browser yourself, for `{program}` cannot be started: {error}"
        ));
    }
}
