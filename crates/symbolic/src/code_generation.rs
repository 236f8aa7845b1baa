//! The forms as LaTeX lines and as functions in a programming language.

use crate::algebra::{Term, common_subexpressions, is_atomic, names};
use crate::closed_form::{ClosedForm, FormulaSection};
use crate::format::{Language, OutputStyle, sign};
use crate::symbol_table::Assignment;
use std::collections::{BTreeMap, BTreeSet};

/// Characters of LaTeX on one line; about two or three give one printed character.
const WIDTH: usize = 200;

impl ClosedForm {
    /// The steps of each section as the contents of an `aligned` environment.
    pub fn latex(&self) -> Vec<(FormulaSection, String)> {
        let name = |code: &str| self.symbols.latex_names(code);
        let is_constant = |code: &str| self.constants.iter().any(|c| c.code == code);
        let style = OutputStyle::Latex(&name, &is_constant);
        let line = |assignment: &Assignment| {
            let mut text = format!("{} &= ", self.symbols.latex_names(&assignment.code));
            let mut width = 0;
            for (k, (minus, one)) in style.summands(&assignment.value).iter().enumerate() {
                if width > 0 && width + one.len() > WIDTH {
                    text.push_str(" \\\\\n&\\quad");
                    width = 0;
                }
                width += one.len();
                text += sign(k, *minus);
                text += one;
            }
            text
        };
        let section = |(section, assignments): &(FormulaSection, Vec<Assignment>)| {
            let lines: Vec<String> = assignments.iter().map(line).collect();
            (*section, lines.join(" \\\\\n"))
        };
        self.sections.iter().map(section).collect()
    }

    /// A function of the coordinate in a programming language that returns all quantities, with common subexpressions computed
    /// once. `name` is its name, and `about` is part of the comment above it.
    //
    // Long, because it contains every part in every language.
    pub fn code(&self, language: Language, name: &str, about: &str) -> String {
        let style = OutputStyle::Code(language);
        let kind = camel(name);
        let (q, of) = (&self.coordinate.code, &self.coordinate);
        let of = format!("Of the {}, {}", of.meaning, of.unit);
        // A title may contain any text: it must not end the comment.
        let about = &about.replace(['\n', '\r'], " ").replace("*/", "* /");
        let mut text = match language {
            Language::Rust => format!(
                "// {about}\n\n/// What [`{name}`] gives.\n#[allow(non_snake_case)]\n#[derive(Debug, Clone, Copy)]\npub struct {kind} {{\n"
            ),
            Language::C => format!("/* {about} */\n\n#include <math.h>\n\ntypedef struct {{\n"),
            Language::Python => format!(
                "# {about}\n\nfrom math import atan2, cos, sin, sqrt\n\n\ndef {name}({q}):\n    \"\"\"{of}:\n\n"
            ),
        };
        for quantity in &self.quantities {
            let code = &quantity.code;
            let meaning = format!("{}, {}", quantity.meaning, quantity.unit);
            text += &match language {
                Language::Rust => format!("    /// {meaning}\n    pub {code}: f64,\n"),
                Language::C => format!("    double {code}; /* {meaning} */\n"),
                Language::Python => format!("    {code}: {meaning}\n"),
            };
        }
        text += &match language {
            Language::Rust => format!(
                "}}\n\n/// {of}.\n#[allow(non_snake_case, unused_parens)]\npub fn {name}({q}: f64) -> {kind} {{\n"
            ),
            Language::C => {
                format!("}} {name}_result;\n\n/* {of}. */\n{name}_result {name}(double {q})\n{{\n")
            }
            Language::Python => "    \"\"\"\n".to_owned(),
        };
        for constant in &self.constants {
            let (code, value, unit) = (&constant.code, constant.value, constant.unit);
            let separator = if unit.is_empty() { "" } else { ", " };
            let meaning = format!("{}{separator}{unit}", constant.meaning);
            text += &match language {
                Language::Rust => format!("    // {meaning}\n    let {code}: f64 = {value:?};\n"),
                Language::C => format!("    const double {code} = {value:?}; /* {meaning} */\n"),
                Language::Python => format!("    {code} = {value:?}  # {meaning}\n"),
            };
        }
        for (code, term) in self.lines() {
            let value = style.text(&term);
            text += &match language {
                Language::Rust => format!("    let {code}: f64 = {value};\n"),
                Language::C => format!("    const double {code} = {value};\n"),
                Language::Python => format!("    {code} = {value}\n"),
            };
        }
        let (begin, end) = match language {
            Language::Rust => (format!("    {kind} {{\n"), "    }\n}\n"),
            Language::C => (format!("    return ({name}_result){{\n"), "    };\n}\n"),
            Language::Python => ("    return {\n".to_owned(), "    }\n"),
        };
        text += &begin;
        for code in self.quantities.iter().map(|quantity| &quantity.code) {
            text += &match language {
                Language::Rust => format!("        {code},\n"),
                Language::C => format!("        .{code} = {code},\n"),
                Language::Python => format!("        \"{code}\": {code},\n"),
            };
        }
        text + end
    }

    /// Number of steps in all sections.
    pub fn assignment_count(&self) -> usize {
        self.assignments().filter(|s| !is_atomic(&s.value)).count()
    }

    /// Names and terms in the order of computation, including common subexpressions.
    fn lines(&self) -> Vec<(String, Term)> {
        let values: Vec<Term> = self.assignments().map(|s| s.value.clone()).collect();
        let (shared_terms, reduced_terms) = common_subexpressions(&values);
        let shared_terms: BTreeMap<String, Term> = shared_terms.into_iter().collect();
        let mut emitted = BTreeSet::new();
        let mut lines = Vec::new();
        for (assignment, term) in self.assignments().zip(reduced_terms) {
            emit_dependencies(&term, &shared_terms, &mut emitted, &mut lines);
            lines.push((assignment.code.clone(), term));
        }
        let rename = |(code, _): &mut (String, Term)| *code = code.replace("__x", "t");
        lines.iter_mut().for_each(rename);
        lines
    }
}

/// Emits the common subexpressions that a term needs, each once.
fn emit_dependencies(
    term: &Term,
    shared_terms: &BTreeMap<String, Term>,
    emitted: &mut BTreeSet<String>,
    lines: &mut Vec<(String, Term)>,
) {
    for name in names(term) {
        if let Some(inner) = shared_terms.get(&name)
            && emitted.insert(name.clone())
        {
            emit_dependencies(inner, shared_terms, emitted, lines);
            lines.push((name, inner.clone()));
        }
    }
}

/// The name of a type from that of a function.
fn camel(name: &str) -> String {
    let mut text = String::new();
    for word in name.split('_').filter(|w| !w.is_empty()) {
        let mut chars = word.chars();
        text.extend(chars.next().map(|c| c.to_ascii_uppercase()));
        text.push_str(chars.as_str());
    }
    text
}
