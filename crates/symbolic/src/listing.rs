//! The forms as LaTeX lines and as functions in a programming language.

use crate::algebra::{Term, is_plain, names, shared};
use crate::form::{Form, Part};
use crate::print::{Language, Style};
use crate::sheet::Step;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// Characters of LaTeX on one line: two or three of them are one in print.
const WIDTH: usize = 200;

impl Form {
    /// The steps of each part as the inside of an `aligned` environment.
    pub fn latex(&self) -> Vec<(Part, String)> {
        let name = |code: &str| self.sheet.latex(code);
        let is_constant = |code: &str| self.constants.iter().any(|c| c.code == code);
        let style = Style::Latex(&name, &is_constant);
        let line = |step: &Step| {
            let mut text = format!("{} &=", self.sheet.latex(&step.code));
            let mut width = 0;
            for (k, (minus, one)) in style.summands(&step.value).iter().enumerate() {
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
        let part = |(part, steps): &(Part, Vec<Step>)| {
            let lines: Vec<String> = steps.iter().map(line).collect();
            (*part, lines.join(" \\\\\n"))
        };
        self.parts.iter().map(part).collect()
    }

    /// A function of the coordinate in a language, that gives all quantities: what steps share is computed
    /// once. `name` is its name, and `about` is said above it.
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
        let steps: Vec<&Step> = self.steps().collect();
        let values: Vec<Term> = steps.iter().map(|s| s.value.clone()).collect();
        let (found, rest) = shared(&values);
        let found: BTreeMap<String, Term> = found.into_iter().collect();
        let mut done = BTreeSet::new();
        let mut lines = Vec::new();
        for (step, term) in steps.iter().zip(rest) {
            before(&term, &found, &mut done, &mut lines);
            lines.push((step.code.clone(), term));
        }
        lines
            .into_iter()
            .map(|(code, term)| (code.replace("__x", "t"), term))
            .collect()
    }

    fn rust(&self, name: &str, about: &str, lines: &[(String, Term)]) -> String {
        let style = Style::Code(Language::Rust);
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
        let style = Style::Code(Language::C);
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
        let style = Style::Code(Language::Python);
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
fn before(
    term: &Term,
    found: &BTreeMap<String, Term>,
    done: &mut BTreeSet<String>,
    lines: &mut Vec<(String, Term)>,
) {
    for name in names(term) {
        if let Some(inner) = found.get(&name)
            && done.insert(name.clone())
        {
            before(inner, found, done, lines);
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

impl Form {
    /// Steps that say more than another name, in all parts.
    pub fn length(&self) -> usize {
        self.steps().filter(|s| !is_plain(&s.value)).count()
    }
}
