//! Answers to requests of the page.

use crate::diagnostics::{self, MessageInText};
use crate::request::{Command, Request};
use crate::{export, runs};
use dwell_page::EncodedPage;
use dwell_scene::{Scene, SceneError};
use serde::Serialize;

/// An answer: JSON, and the numbers that it refers to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Answer {
    /// An object with `messages` (errors and warnings); `page`, if the scene could be evaluated (the description that
    /// [`dwell_page`] documents); `files` (pairs of name and text); `schema` (the JSON schema).
    pub text: String,
    /// The rows of `page`, column after column.
    pub numbers: Vec<f64>,
}

#[derive(Default, Serialize)]
struct AnswerText {
    messages: Vec<MessageInText>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    files: Vec<(String, String)>,
}

/// Answers a request.
///
/// ```
/// let schema = dwell_live::answer(r#"{ "do": "schema" }"#);
/// assert!(schema.text.contains("revolute"));
/// let nonsense = dwell_live::answer("{}");
/// assert!(nonsense.text.contains("cannot be read"));
/// ```
pub fn answer(request: &str) -> Answer {
    match serde_json::from_str(request) {
        Ok(Request::Schema) => Answer {
            text: format!(r#"{{"messages":[],"schema":{}}}"#, dwell_scene::schema()),
            numbers: Vec::new(),
        },
        Ok(Request::Run { command, text }) => run(command, &text),
        Ok(Request::C { text }) => exported(&text),
        Err(error) => {
            let message = format!("the request cannot be read: {error}");
            let error = SceneError::without_labels(message, None);
            of_messages(diagnostics::errors(&error), Vec::new())
        }
    }
}

/// The name of the text in messages.
const SOURCE_NAME: &str = "scene.toml";

fn run(command: Command, text: &str) -> Answer {
    let mut messages = Vec::new();
    match page(command, text, &mut messages) {
        Ok(page) => {
            let Answer { mut text, .. } = of_messages(messages, Vec::new());
            // The description is already JSON: it becomes the last member of the object.
            text.pop();
            Answer {
                text: format!(r#"{text},"page":{}}}"#, page.description),
                numbers: page.numbers,
            }
        }
        Err(error) => {
            messages.extend(diagnostics::errors(&error));
            of_messages(messages, Vec::new())
        }
    }
}

/// The page of a command. Warnings, and the reason why a motion ended early, become messages.
fn page(
    command: Command,
    text: &str,
    messages: &mut Vec<MessageInText>,
) -> Result<EncodedPage, SceneError> {
    let scene = Scene::parse(SOURCE_NAME, text)?.named("scene".to_owned());
    messages.extend(diagnostics::warnings(&scene.warnings));
    let (page, early_stop) = runs::run(command, &scene)?;
    let early_stop = early_stop.map(SceneError::from);
    messages.extend(early_stop.iter().flat_map(diagnostics::errors));
    let page = page.encode();
    page.map_err(|error| SceneError::without_labels(error.to_string(), None))
}

fn exported(text: &str) -> Answer {
    let exported = Scene::parse(SOURCE_NAME, text).and_then(|scene| export::c_files(&scene));
    match exported {
        Ok(files) => of_messages(Vec::new(), files),
        Err(error) => of_messages(diagnostics::errors(&error), Vec::new()),
    }
}

fn of_messages(messages: Vec<MessageInText>, files: Vec<(String, String)>) -> Answer {
    let text = serde_json::to_string(&AnswerText { messages, files });
    Answer {
        // Text and numbers can always be written as JSON.
        text: text.unwrap_or_else(|_| r#"{"messages":[]}"#.to_owned()),
        numbers: Vec::new(),
    }
}
