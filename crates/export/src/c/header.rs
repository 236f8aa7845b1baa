//! The header: a description with errors, types and functions.

use super::CWriter;
use crate::identifiers::comment;
use std::fmt::Write as _;

impl<E> CWriter<'_, E> {
    /// The header with a description; `own` has the replacements of its template, in addition to members.
    pub(crate) fn header(&self, description: &[String], own: &[(&str, String)]) -> String {
        let mut inputs = members(self.inputs());
        if inputs.is_empty() {
            member(&mut inputs, "none", "there is no input");
        }
        let mut currents = String::new();
        for (_, name, _) in self.currents() {
            member(&mut currents, &name, "A: current of the motor");
        }
        let members = [
            ("real", self.real().to_owned()),
            ("parameters", members(self.parameters())),
            ("inputs", inputs),
            ("currents", currents),
        ];
        let own = [own, &members].concat();
        self.banner(description) + &self.fill(include_str!("header.h"), &own)
    }

    /// The indices of loads, reactions and points, and how many there are.
    pub(crate) fn counts(&self) -> String {
        let lists = self.lists();
        lists.iter().map(|(what, list)| count(what, list)).collect()
    }
}

/// The indices of a list, and its length.
pub(crate) fn count(what: &str, list: &[[String; 2]]) -> String {
    let mut text = String::new();
    for (k, [name, meaning]) in list.iter().enumerate() {
        _ = writeln!(text, "#define @U@_{what}_{name} {k} /* {meaning} */");
    }
    text + &format!("#define @U@_{what}_COUNT {}\n", list.len())
}

fn members(all: Vec<(String, f64, String)>) -> String {
    let mut text = String::new();
    for (name, _, meaning) in all {
        member(&mut text, &name, &meaning);
    }
    text
}

/// A member of a structure.
fn member(text: &mut String, name: &str, meaning: &str) {
    _ = writeln!(text, "    @p@_real {name}; /* {} */", comment(meaning));
}
