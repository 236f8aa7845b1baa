//! Writes closed forms: document or code, and summary.

use super::document;
use crate::explain::StudyError;
use crate::output::Outcome;
use crate::symbolic::compute::compute_closed_form;
use dwell_scene::Scene;
use dwell_symbolic::Language;

/// The output format of closed forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FormulaFormat {
    /// Markdown with LaTeX.
    Latex,
    /// A function.
    Code(Language),
}

/// The closed forms of a scene as formulas or code, for the named reaction or the first that the scene requests.
///
/// # Errors
/// [`StudyError`] where the mechanism is not made of dyads, has several actuators, or has no such
/// reaction.
pub fn symbolic(
    scene: &Scene,
    output: FormulaFormat,
    reaction: Option<&str>,
) -> Result<Outcome, StudyError> {
    let (form, findings) = compute_closed_form(scene, reaction)?;
    let mut outcome = Outcome {
        summary: document::summary(scene, &form, &findings),
        findings,
        ..Outcome::default()
    };
    let about = format!("{}: closed forms, written by dwell", scene.title);
    let name = document::function_name(&scene.name);
    let (extension, text) = match output {
        FormulaFormat::Latex => ("md", document::document(scene, &form)),
        FormulaFormat::Code(language) => {
            let extension = match language {
                Language::Rust => "rs",
                Language::C => "c",
                Language::Python => "py",
            };
            (extension, form.code(language, &name, &about))
        }
    };
    outcome
        .files
        .add(format!("{}-symbolic.{extension}", scene.name), text);
    Ok(outcome)
}
