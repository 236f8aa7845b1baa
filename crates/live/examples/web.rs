//! `just web`: the live page as one file and as a folder, in `target/web`, from the module that was built for browsers.
#![allow(clippy::unwrap_used, reason = "a tool of the build")]

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use dwell_page::{SCRIPT, STYLE};
use flate2::{Compression, GzBuilder};
use lzma_rust2::{LzmaOptions, LzmaWriter};
use sha2::{Digest as _, Sha256};
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

const MARKUP: &str = include_str!("../page/live.html");
const LIVE_STYLE: &str = include_str!("../page/live.css");
const WORKER: &str = concat!(
    "'use strict';\n",
    include_str!("../page/lzma.js"),
    include_str!("../page/worker.js"),
);
const LIVE_SCRIPT: &str = concat!(
    "'use strict';\n{\n",
    include_str!("../page/toml.js"),
    include_str!("../page/schema.js"),
    include_str!("../page/completion.js"),
    include_str!("../page/number_slider.js"),
    include_str!("../page/editor.js"),
    include_str!("../page/engine.js"),
    include_str!("../page/link.js"),
    include_str!("../page/scene_files.js"),
    include_str!("../page/live.js"),
    "}\n",
);
/// Bytes of the module at most, packed: what it has, so that growth is seen. The aim is 950 kB. From 1.398 MB it
/// grew by the description of joints in space (2.1 kB), and by the evaluator of rows, written once and compiled for plane and space, with the ends of
/// coupling tables (8.3 kB), then by drags, points on lines and in planes, and the summaries of motions in space (3.5 kB), then by the section
/// `[sweep]`, and by loads and closures of space whose numbers have a type (6.6 kB), then by couplings in space and the
/// section `[optimise]` (15.5 kB, to 1 433 539 bytes); opt-level "z" for laws and page would give
/// 2.6 kB back.
const MAX_MODULE: usize = 1_438_000;
/// The case that a page without a scene begins with.
const FIRST: &str = "single-dwell";

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or(root.join("target"), PathBuf::from);
    let module = target.join("wasm32-unknown-unknown/web/dwell_live.wasm");
    let module = without_names(&fs::read(module).unwrap());
    let packed = packed(&module);
    assert!(
        packed.len() < MAX_MODULE,
        "the module has {} bytes packed: at most {MAX_MODULE} are meant to be carried",
        packed.len()
    );
    let folder = target.join("web");
    fs::create_dir_all(&folder).unwrap();
    let examples = examples(&root.join("validation"));
    let carried = STANDARD.encode(&packed);
    let one = document("", "", &carried, &examples);
    let served = document(
        "; connect-src 'self'",
        " data-file=\"dwell.wasm.lzma\"",
        "",
        &examples,
    );
    fs::write(folder.join("dwell.html"), &one).unwrap();
    fs::write(folder.join("index.html"), &served).unwrap();
    fs::write(folder.join("dwell.wasm.lzma"), &packed).unwrap();
    println!(
        "target/web: dwell.html, {} bytes, for itself; index.html, {} bytes, with dwell.wasm.lzma, {} bytes, for a server. \
         The module has {} bytes, {} by gzip",
        one.len(),
        served.len(),
        packed.len(),
        module.len(),
        gzipped(&module).len()
    );
}

/// A module without its custom sections: names, and what made it.
fn without_names(module: &[u8]) -> Vec<u8> {
    /// Magic number and version.
    const HEADER: usize = 8;
    let mut kept = module[..HEADER].to_vec();
    let mut at = HEADER;
    while at < module.len() {
        // A section: its kind, its length in groups of seven bits, the least significant ones first, and its content.
        let (mut length, mut shift, mut content) = (0_usize, 0, at + 1);
        loop {
            let byte = module[content];
            length |= usize::from(byte & 0x7f) << shift;
            shift += 7;
            content += 1;
            if byte < 0x80 {
                break;
            }
        }
        let end = content + length;
        if module[at] != 0 {
            kept.extend_from_slice(&module[at..end]);
        }
        at = end;
    }
    kept
}

/// The format `.lzma`, whose memory is as large as the module: gzip's 32 kB see no two copies of a generic function, and take half as
/// much again. WebAssembly has no places of four bytes, and a byte depends much on the one before it.
fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut options = LzmaOptions::with_preset(9);
    options.nice_len = LzmaOptions::NICE_LEN_MAX;
    (options.lc, options.pb) = (4, 0);
    let size = Some(bytes.len() as u64);
    let mut writer = LzmaWriter::new_use_header(Vec::new(), &options, size).unwrap();
    writer.write_all(bytes).unwrap();
    writer.finish().unwrap()
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut gzip = GzBuilder::new().write(Vec::new(), Compression::best());
    gzip.write_all(bytes).unwrap();
    gzip.finish().unwrap()
}

/// The cases as JSON: name, title and text of each, the one to begin with first.
fn examples(validation: &Path) -> String {
    let cases = fs::read_dir(validation).unwrap();
    let scenes = cases.map(|case| case.unwrap().path().join("scene.toml"));
    let spatial = fs::read_dir(validation.join("spatial")).unwrap();
    let spatial = spatial.map(|file| file.unwrap().path());
    let files = scenes
        .chain(spatial)
        .filter(|path| path.is_file() && path.extension().is_some_and(|ending| ending == "toml"));
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).unwrap();
        let scene = dwell_scene::Scene::read(&path).unwrap();
        let in_space = matches!(scene, dwell_scene::Scene::Space(_));
        (in_space, scene.name.clone(), scene.title.clone(), text)
    };
    let mut all: Vec<_> = files.map(read).collect();
    // A mechanism of several freedoms that says nothing of their motion has no picture to begin with.
    all.retain(|(.., text)| {
        let request = serde_json::json!({ "do": "run", "command": "motion", "text": text });
        let answer = dwell_live::answer(&request.to_string()).text;
        let answer: serde_json::Value = serde_json::from_str(&answer).unwrap();
        !answer["page"].is_null()
    });
    all.sort_by_key(|(in_space, name, ..)| (name != FIRST, *in_space, name.clone()));
    let object = |(in_space, name, title, text): &(bool, String, String, String)| {
        let title = if *in_space {
            format!("In space: {title}")
        } else {
            title.clone()
        };
        serde_json::json!({ "name": name, "title": title, "text": text })
    };
    let all: Vec<_> = all.iter().map(object).collect();
    data(&serde_json::to_string(&all).unwrap())
}

/// JSON within a script element, where only `</` and `<!--` mean anything: it can do without `<`.
fn data(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// The page. Its policy lets nothing act but these styles, these scripts, the module and the worker.
fn document(more_policy: &str, source: &str, module: &str, examples: &str) -> String {
    let hash = |text: &str| format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)));
    let policy = format!(
        "default-src 'none'; style-src {} {}; script-src {} {} 'wasm-unsafe-eval'; worker-src blob:; base-uri 'none'; \
         form-action 'none'{more_policy}",
        hash(STYLE),
        hash(LIVE_STYLE),
        hash(SCRIPT),
        hash(LIVE_SCRIPT),
    );
    let parts = [
        ("{{policy}}", policy.as_str()),
        ("{{page-style}}", STYLE),
        ("{{live-style}}", LIVE_STYLE),
        ("{{module-source}}", source),
        ("{{module}}", module),
        ("{{worker}}", WORKER),
        ("{{examples}}", examples),
        ("{{scene}}", "null"),
        ("{{page-script}}", SCRIPT),
        ("{{live-script}}", LIVE_SCRIPT),
    ];
    // Each is filled in at its place: what one of them holds is never read as a place.
    let mut html = String::new();
    let mut rest = MARKUP;
    for (place, text) in parts {
        let (before, after) = rest.split_once(place).unwrap();
        html += before;
        html += text;
        rest = after;
    }
    html + rest
}
