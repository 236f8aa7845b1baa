//! From a file to the TOML tree, with all errors before the scene itself is read.

use crate::error::{SceneError, Source};
use crate::wording::shorten;
use miette::NamedSource;
use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;
use toml::de::DeTable;

/// Longest scene, bytes: ten thousand loops take five million.
const MAX_SCENE_BYTES: u64 = 1 << 26;

/// The name of a scene in a file, and its text.
pub(crate) fn text_of_file(path: &Path) -> Result<(String, Source), SceneError> {
    let display_path = path.display().to_string();
    let bytes = bytes(path, &display_path)?;
    Ok((name_of_file(path), text_of_bytes(&display_path, bytes)?))
}

/// The text of a stream.
pub(crate) fn text_of_stream(
    stream: impl std::io::Read,
    source_name: &str,
) -> Result<Source, SceneError> {
    let unreadable = |e: &std::io::Error| {
        let message = format!("`{source_name}` cannot be read: {e}");
        SceneError::without_labels(message, None)
    };
    text_of_bytes(
        source_name,
        limited_bytes(stream, source_name, &unreadable)?,
    )
}

/// The name of the scene in a file: its stem, or its folder's name if it is `scene.toml`.
pub(crate) fn name_of_file(path: &Path) -> String {
    // `scene.toml` given without its folder is still in one.
    match path.parent().map(std::fs::canonicalize) {
        Some(Ok(folder)) => scene_name(&folder.join(path.file_name().unwrap_or_default())),
        _ => scene_name(&std::path::absolute(path).unwrap_or_else(|_| path.to_owned())),
    }
}

/// The name of a scene, and its text.
pub(crate) fn named_text(source_name: &str, text: &str) -> (String, Source) {
    let source = NamedSource::new(source_name, text.to_owned());
    (scene_name(Path::new(source_name)), Arc::new(source))
}

/// The file's stem, or its folder's name if the stem is `scene`.
pub(crate) fn scene_name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let folder = path.parent().and_then(Path::file_name);
    match folder {
        Some(folder) if stem == "scene" => folder.to_string_lossy().into_owned(),
        _ if stem.is_empty() => "scene".to_owned(),
        _ => stem.into_owned(),
    }
}

/// The text in the bytes of a file.
fn text_of_bytes(source_name: &str, bytes: Vec<u8>) -> Result<Source, SceneError> {
    let text = match String::from_utf8(bytes) {
        Ok(text) if text.contains('\0') => return Err(not_text(source_name)),
        Ok(text) => text,
        Err(error) if error.as_bytes().contains(&0) => return Err(not_text(source_name)),
        Err(error) => return Err(not_utf8(source_name, &error)),
    };
    Ok(Arc::new(NamedSource::new(source_name, text)))
}

fn bytes(path: &Path, display_path: &str) -> Result<Vec<u8>, SceneError> {
    let error = SceneError::without_labels;
    if path.is_dir() {
        let inside = path.join("scene.toml");
        let help = if inside.is_file() {
            format!("did you mean `{}`?", inside.display())
        } else {
            "give the scene file itself".to_owned()
        };
        return Err(error(format!("`{display_path}` is a folder"), Some(help)));
    }
    let unreadable = |e: &std::io::Error| match e.kind() {
        ErrorKind::NotFound => {
            let with_ending = path.with_added_extension("toml");
            let meant = || format!("did you mean `{}`?", with_ending.display());
            let help = with_ending.is_file().then(meant);
            error(format!("there is no file `{display_path}`"), help)
        }
        _ => error(format!("`{display_path}` cannot be read: {e}"), None),
    };
    let file = File::open(path).map_err(|e| unreadable(&e))?;
    limited_bytes(file, display_path, &unreadable)
}

/// The bytes of a stream, unless it is too long for a scene.
fn limited_bytes(
    stream: impl std::io::Read,
    display_path: &str,
    unreadable: &dyn Fn(&std::io::Error) -> SceneError,
) -> Result<Vec<u8>, SceneError> {
    let error = SceneError::without_labels;
    let mut bytes = Vec::new();
    // One byte more than allowed shows that a file is longer, even one that never ends.
    let read = stream.take(MAX_SCENE_BYTES + 1).read_to_end(&mut bytes);
    let length = read.map_err(|e| unreadable(&e))?;
    if length as u64 > MAX_SCENE_BYTES {
        let limit = MAX_SCENE_BYTES >> 20;
        let message = format!("`{display_path}` is longer than {limit} MiB");
        return Err(error(message, Some("is it a scene?".to_owned())));
    }
    Ok(bytes)
}

/// The error for a file with a zero byte, which is no text; it shows no line of the file.
fn not_text(display_path: &str) -> SceneError {
    let help = "if this is a scene, save it as UTF-8".to_owned();
    SceneError::without_labels(format!("`{display_path}` is not a text file"), Some(help))
}

fn not_utf8(display_path: &str, error: &std::string::FromUtf8Error) -> SceneError {
    let at = error.utf8_error().valid_up_to();
    // Everything before the first bad byte is unchanged by the replacement, so `at` still holds.
    let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
    let source = Arc::new(NamedSource::new(display_path, text));
    SceneError::with_labels(
        &source,
        format!("`{display_path}` is not UTF-8 text"),
        Some("save it as UTF-8".to_owned()),
        [(at..at + 1, "not a character".to_owned())],
    )
}

/// The TOML tree of the text.
pub(crate) fn syntax(source: &Source) -> Result<Spanned<DeTable<'_>>, SceneError> {
    let text = source.inner();
    DeTable::parse(text).map_err(|e| {
        let source = &printable(source);
        let span = e.span().unwrap_or(0..0);
        let (message, help) = explain(
            e.message(),
            text.get(span.clone()).unwrap_or_default(),
            text.get(span.start..).unwrap_or_default(),
        );
        let message = format!("not valid TOML: {message}");
        SceneError::with_labels(source, message, help, [(span, "here".to_owned())])
    })
}

/// The text without control characters, which a terminal would execute. Each is one byte and replaced by one byte, so
/// that places do not change.
fn printable(source: &Source) -> Source {
    let visible = |c: char| match c {
        '\n' | '\r' | '\t' => c,
        c if c.is_ascii_control() => '?',
        c => c,
    };
    let text = source.inner().chars().map(visible).collect();
    Arc::new(NamedSource::new(source.name(), text))
}

/// The message of the parser with a suggestion for frequent mistakes, because the parser's messages assume knowledge of
/// TOML. `found` is the text at the error, `from` the text from there on.
fn explain(message: &str, found: &str, from: &str) -> (String, Option<String>) {
    let quoted = shorten(found);
    let help = |text: &str| Some(text.to_owned());
    if message == "duplicate key" {
        return (
            format!("duplicate key `{quoted}`"),
            help("a name is given once; rename or remove one of them"),
        );
    }
    if message.starts_with("string values must be quoted") || message.starts_with("invalid boolean")
    {
        return match found.trim().chars().next() {
            None => ("a value is missing".to_owned(), None),
            Some('0'..='9' | '+' | '-') => (
                format!("`{quoted}` is not a number"),
                help("a number stands alone; its unit is given once, in [units]"),
            ),
            Some(_) => (
                format!("`{quoted}` is not a value"),
                help("text stands in quotes; the only bare words are `true` and `false`"),
            ),
        };
    }
    let help = match from.chars().next() {
        Some(',') => help("the decimal sign is a point; commas stand between values in brackets"),
        Some('.') => help("a number has digits on both sides of its point: 0.5"),
        _ => None,
    };
    (message.to_owned(), help)
}
