//! The forms as LaTeX lines and as functions in a programming language.

use crate::algebra::{Term, common_subexpressions, is_atomic, names};
use crate::closed_form::{ClosedForm, FormulaSection};
use crate::format::{Language, OutputStyle};
use crate::symbol_table::Assignment;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// Characters of LaTeX on one line: two or three of them are one in print.
const WIDTH: usize = 200;

impl ClosedForm {
    /// The steps of each part as the inside of an `aligned` environment.
    pub fn latex(&self) -> Vec<(FormulaSection, String)> {
        let name = |code: &str| self.symbols.latex_names(code);
        let is_constant = |code: &str| self.constants.iter().any(|c| c.code == code);
        let style = OutputStyle::Latex(&name, &is_constant);
        let line = |assignment: &Assignment| {
            let mut text = format!("{} &=", self.symbols.latex_names(&assignment.code));
            let mut width = 0;
            for (k, (minus, one)) in style.summands(&assignment.value).iter().enumerate() {
                if width > 0 && width + one.len() > WIDTH {
                    text.push_str(" \\\\\n&\\quad");
                    width = 0;
                }
                width += one.len();
                text.push_str(match (k, minus) {
                    (0, false) => " ",
                    (_, false) => " + ",
                    (0, true) => " -",
                    (_, true) => " - ",
                });
                text.push_str(one);
            }
            text
        };
        let section = |(section, assignments): &(FormulaSection, Vec<Assignment>)| {
            let lines: Vec<String> = assignments.iter().map(line).collect();
            (*section, lines.join(" \\\\\n"))
        };
        self.sections.iter().map(section).collect()
    }

    /// A function of the coordinate in a language, that gives all quantities: what steps share is computed
    /// once. `name` is its name, and `about` stands in the comment above it.
    pub fn code(&self, language: Language, name: &str, about: &str) -> String {
        let lines = self.lines();
        // A title may hold anything: it must not end the comment that it stands in.
        let about = &about.replace(['\n', '\r'], " ").replace("*/", "* /");
        match language {
            Language::Rust => self.rust(name, about, &lines),
            Language::C => self.c(name, about, &lines),
            Language::Python => self.python(name, about, &lines),
        }
    }

    /// Names and terms in the order in which they can be computed, what is shared among them.
    fn lines(&self) -> Vec<(String, Term)> {
        let assignments: Vec<&Assignment> = self.assignments().collect();
        let values: Vec<Term> = assignments.iter().map(|s| s.value.clone()).collect();
        let (shared_terms, reduced_terms) = common_subexpressions(&values);
        let shared_terms: BTreeMap<String, Term> = shared_terms.into_iter().collect();
        let mut emitted = BTreeSet::new();
        let mut lines = Vec::new();
        for (assignment, term) in assignments.iter().zip(reduced_terms) {
            emit_dependencies(&term, &shared_terms, &mut emitted, &mut lines);
            lines.push((assignment.code.clone(), term));
        }
        lines
            .into_iter()
            .map(|(code, term)| (code.replace("__x", "t"), term))
            .collect()
    }

    fn rust(&self, name: &str, about: &str, lines: &[(String, Term)]) -> String {
        let style = OutputStyle::Code(Language::Rust);
        let kind = camel(name);
        let mut text = format!(
            "// {about}\n\n/// What [`{name}`] gives.\n#[allow(non_snake_case)]\n#[derive(Debug, Clone, Copy)]\npub struct {kind} {{\n"
        );
        for q in &self.quantities {
            let _ = writeln!(text, "    /// {}, {}", q.meaning, q.unit);
            let _ = writeln!(text, "    pub {}: f64,", q.code);
        }
        let of = &self.coordinate;
        let _ = writeln!(
            text,
            "}}\n\n/// Of the {}, {}.\n#[allow(non_snake_case, unused_parens)]\npub fn {name}({}: f64) -> {kind} {{",
            of.meaning, of.unit, of.code
        );
        for c in &self.constants {
            let _ = writeln!(text, "    // {}{}", c.meaning, unit(c.unit));
            let _ = writeln!(text, "    let {}: f64 = {:?};", c.code, c.value);
        }
        for (code, term) in lines {
            let _ = writeln!(text, "    let {code}: f64 = {};", style.text(term));
        }
        let _ = writeln!(text, "    {kind} {{");
        for q in &self.quantities {
            let _ = writeln!(text, "        {},", q.code);
        }
        text + "    }\n}\n"
    }

    fn c(&self, name: &str, about: &str, lines: &[(String, Term)]) -> String {
        let style = OutputStyle::Code(Language::C);
        let mut text = format!("/* {about} */\n\n#include <math.h>\n\ntypedef struct {{\n");
        for q in &self.quantities {
            let _ = writeln!(
                text,
                "    double {}; /* {}, {} */",
                q.code, q.meaning, q.unit
            );
        }
        let of = &self.coordinate;
        let _ = writeln!(
            text,
            "}} {name}_result;\n\n/* Of the {}, {}. */\n{name}_result {name}(double {})\n{{",
            of.meaning, of.unit, of.code
        );
        for c in &self.constants {
            let (meaning, unit) = (&c.meaning, unit(c.unit));
            let _ = writeln!(
                text,
                "    const double {} = {:?}; /* {meaning}{unit} */",
                c.code, c.value
            );
        }
        for (code, term) in lines {
            let _ = writeln!(text, "    const double {code} = {};", style.text(term));
        }
        let _ = writeln!(text, "    return ({name}_result){{");
        for q in &self.quantities {
            let _ = writeln!(text, "        .{0} = {0},", q.code);
        }
        text + "    };\n}\n"
    }

    fn python(&self, name: &str, about: &str, lines: &[(String, Term)]) -> String {
        let style = OutputStyle::Code(Language::Python);
        let of = &self.coordinate;
        let mut text = format!(
            "# {about}\n\nfrom math import atan2, cos, sin, sqrt\n\n\ndef {name}({}):\n    \"\"\"Of the {}, {}:\n\n",
            of.code, of.meaning, of.unit
        );
        for q in &self.quantities {
            let _ = writeln!(text, "    {}: {}, {}", q.code, q.meaning, q.unit);
        }
        text.push_str("    \"\"\"\n");
        for c in &self.constants {
            let _ = writeln!(
                text,
                "    {} = {:?}  # {}{}",
                c.code,
                c.value,
                c.meaning,
                unit(c.unit)
            );
        }
        for (code, term) in lines {
            let _ = writeln!(text, "    {code} = {}", style.text(term));
        }
        text.push_str("    return {\n");
        for q in &self.quantities {
            let _ = writeln!(text, "        \"{0}\": {0},", q.code);
        }
        text + "    }\n"
    }
}

/// Writes down what is shared and a term needs, once.
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

fn unit(unit: &str) -> String {
    if unit.is_empty() {
        String::new()
    } else {
        format!(", {unit}")
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

impl ClosedForm {
    /// Steps that are more than another name, in all parts.
    pub fn assignment_count(&self) -> usize {
        self.assignments().filter(|s| !is_atomic(&s.value)).count()
    }
}
