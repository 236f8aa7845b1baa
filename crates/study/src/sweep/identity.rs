//! The identity of a study: its definition by key and value, which is stored beside its rows and must be the same when it
//! continues.

use crate::explain::SweepError;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// Key of the scene's text; its hash is compared instead.
pub(crate) const SCENE_TEXT: &str = "scene_text";

/// The identity of a study, by key, in the order in which differences are reported.
pub(crate) type StudyIdentity = Vec<(&'static str, String)>;

/// Reads the definition in a folder's file, which must be that of this study, or writes it, through an unfinished file, if
/// there is none.
///
/// # Errors
/// [`SweepError::DifferentStudy`] of the folder; [`SweepError::Store`] of a file that is damaged, or cannot be read or written.
pub(crate) fn check_study(
    file: &Path,
    unfinished: &Path,
    study: &StudyIdentity,
) -> Result<(), SweepError> {
    let reason = |reason: String| StoreFault::Reason(reason).with_path(file);
    match fs::read_to_string(file) {
        Ok(text) => {
            let stored: Result<HashMap<String, String>, _> = toml::from_str(&text);
            let stored = stored
                .map_err(|e| reason(format!("it does not define a study: {}", e.message())))?;
            match study_difference(&stored, study) {
                None => Ok(()),
                Some(difference @ StoreFault::Reason(_)) => Err(difference.with_path(file)),
                Some(difference) => Err(difference.with_path(file.parent().unwrap_or(file))),
            }
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let entries = study
                .iter()
                .map(|(key, value)| ((*key).to_owned(), toml::Value::from(value.as_str())));
            let table: toml::Table = entries.collect();
            let text = toml::to_string_pretty(&table).map_err(|e| reason(e.to_string()))?;
            // Shards may write it at the same time, with the same content.
            let written = fs::write(unfinished, text).and_then(|()| fs::rename(unfinished, file));
            written.map_err(|e| reason(format!("cannot be written: {e}")))
        }
        Err(error) => Err(reason(format!("cannot be read: {error}"))),
    }
}

/// The hash of a study's definition, by which its files are known.
pub(crate) fn study_hash(study: &StudyIdentity) -> String {
    let mut digest = Sha256::new();
    // The scene's text is known by its hash, which is independent of line ends.
    for (key, value) in study.iter().filter(|(key, _)| *key != SCENE_TEXT) {
        digest.update(format!("{key}={value}\n"));
    }
    let hash = digest.finalize();
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The difference of a stored study from this one.
fn study_difference(stored: &HashMap<String, String>, study: &StudyIdentity) -> Option<StoreFault> {
    for (key, expected) in study {
        let found = stored.get(*key).map_or("", String::as_str);
        // The scene's hash is independent of line ends and a byte order mark, its text is not.
        let text = |text: &str| text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
        if *key == SCENE_TEXT && text(found) != text(expected) {
            let fault = "the file is damaged (the text of the scene does not match its hash): move the folder";
            return Some(StoreFault::Reason(fault.to_owned()));
        }
        if *key != SCENE_TEXT && found != expected {
            return Some(StoreFault::Differs(match *key {
                "scene_sha256" => "of a scene that has changed since".to_owned(),
                key => {
                    let [existing, own] = [found, expected].map(shortened);
                    format!(
                        "with the {} {existing} instead of {own}",
                        key.replace('_', " ")
                    )
                }
            }));
        }
    }
    None
}

/// A value in a message, shortened if it is long.
fn shortened(value: &str) -> String {
    const MAX_LENGTH: usize = 70;
    if value.chars().count() <= MAX_LENGTH {
        return format!("`{value}`");
    }
    let start: String = value.chars().take(MAX_LENGTH).collect();
    format!("`{start}…`")
}

/// An error of the store, to which the caller adds the path.
pub(crate) enum StoreFault {
    Reason(String),
    Differs(String),
}

impl StoreFault {
    pub(crate) fn with_path(self, path: &Path) -> SweepError {
        let path = path.to_owned();
        match self {
            Self::Reason(reason) => SweepError::Store { path, reason },
            Self::Differs(difference) => SweepError::DifferentStudy { path, difference },
        }
    }
}
