//! C99: one header and one source that need no library, no memory and no other file.

mod code;
mod header;
mod rates;
mod results;
mod self_test;
mod source;
mod tables;

pub(crate) use code::{CALLED, COMPILE};
pub(crate) use header::count;

use crate::describe::describe;
use crate::export::Export;
use crate::identifiers::comment;
use crate::part::{Precision, Wrapping};
use crate::template::lines_for;
use crate::writer::{Access, Members};
use std::ops::Deref;

/// How C reaches members.
pub(crate) const ACCESS: Access = Access {
    parameters: "p->",
    inputs: "in->",
    state: "s->",
    zero: "ZERO",
    choice: CHOICE,
};

/// A conditional expression of C.
pub(crate) const CHOICE: [&str; 4] = ["(", " ? ", " : ", ")"];

/// The first arguments of functions of a state.
const ARGUMENTS: &str =
    "const @p@_parameters *parameters, const @p@_inputs *inputs, const @p@_state *state";

/// An export as C99: the name and the text of the header, then of the source.
///
/// The source has a self-test and a `main` if `NAME_SELF_TEST` is defined, with NAME in capitals.
pub fn c_files(export: &Export) -> [(String, String); 2] {
    let machine = &export.machine;
    let members = Members::new(export);
    let mut marks = "1".to_owned();
    for (mark, holds) in [
        ("o", machine.domain.revolutions > 0),
        ("e", machine.domain.revolutions == 0),
        ("v", members.has_potentials()),
        ("d", members.has_rotors()),
    ] {
        marks += if holds { mark } else { "" };
    }
    let writer = CWriter {
        export,
        members,
        precision: export.request.precision,
        coordinate: |_| "q".to_owned(),
        marks,
    };
    let force = if machine.is_angle { "N m" } else { "N" };
    let own = [
        ("q", "@p@_real q".to_owned()),
        ("q_ddot", "@p@_real q_ddot".to_owned()),
        ("found_q_ddot", "@p@_real *q_ddot".to_owned()),
        ("unit", machine.unit().to_owned()),
        ("inertia_unit", machine.inertia_unit().to_owned()),
        ("force", force.to_owned()),
        ("counts", writer.counts()),
        ("coordinate", comment(&machine.coordinate)),
    ];
    let header = writer.header(&description(export), &own);
    writer.files(&header, &writer.source())
}

/// A description of the code of one degree of freedom, with its errors.
fn description(export: &Export) -> Vec<String> {
    let mut lines = describe(export);
    let [motion, all, step] = export.measured.operations;
    let operations = format!(
        "Additions, multiplications and divisions, the worst case at any q: {motion} of the terms of motion, {all} with those of the reactions, {step} of a step"
    );
    match export.code {
        None => {
            let bytes = export.constant_bytes();
            lines.push(format!("constants: {bytes} bytes. {operations}"));
            lines.push(
                "No function allocates, recurses, keeps anything between calls or calls a library."
                    .to_owned(),
            );
        }
        Some(_) => {
            let [motion, all] = export.functions();
            lines.push(operations);
            lines.push(format!(
                "Square roots, sines, cosines and angles: {motion} of the terms of motion, {all} with those of the reactions, {} of a step",
                4 * motion
            ));
            lines.push(CALLED.to_owned());
        }
    }
    lines.push(COMPILE.to_owned());
    let wrapping = Wrapping::new(export.machine.domain, export.request.precision);
    if let Some(limit) = wrapping.map(|w| w.limit.floor()) {
        lines.push(format!("q may be any number of revolutions from {} to {limit} rad; a state keeps q in one period and counts the others.", -limit));
    }
    lines
}

/// Writes an export in C: of one degree of freedom, or of several.
pub(crate) struct CWriter<'a, E> {
    pub(crate) export: &'a E,
    pub(crate) members: Members<'a>,
    pub(crate) precision: Precision,
    /// A coordinate by its place.
    pub(crate) coordinate: fn(usize) -> String,
    /// The marks of template lines for this machine, in addition to those from its members.
    pub(crate) marks: String,
}

impl<'a, E> Deref for CWriter<'a, E> {
    type Target = Members<'a>;

    fn deref(&self) -> &Members<'a> {
        &self.members
    }
}

impl<E> CWriter<'_, E> {
    /// A template with the lines of this machine, its numbers, and the replacement of each `@name@`.
    pub(crate) fn fill(&self, template: &str, own: &[(&str, String)]) -> String {
        let mut marks = self.marks.clone();
        for (mark, holds) in [
            ("l", self.has_loads()),
            ("z", !self.has_loads()),
            ("r", self.has_reactions()),
            ("p", self.has_points()),
        ] {
            marks += if holds { mark } else { "" };
        }
        let numbers = [("zero", 0.0), ("half", 0.5), ("two", 2.0), ("six", 6.0)]
            .map(|(name, value)| (name, self.number(value)));
        let order = [("order", self.order().to_string())];
        let all = own.iter().chain(&numbers).chain(&order);
        all.fold(lines_for(template, &marks), |text, (name, own)| {
            // What stands alone in a line has lines of its own, or none.
            let text = text.replace(&format!("\n@{name}@\n"), &format!("\n{own}"));
            text.replace(&format!("@{name}@"), own)
        })
    }

    /// Header and source with the names inserted: `@p@` for the prefix, `@U@` for the prefix in capitals, `@arguments@` for
    /// the first arguments of most functions.
    pub(crate) fn files(&self, header: &str, source: &str) -> [(String, String); 2] {
        let (prefix, capitals) = (&self.names.prefix, &self.names.capitals);
        [("h", header), ("c", source)].map(|(ending, text)| {
            let text = text.replace("@arguments@", ARGUMENTS);
            let text = text.replace("@p@", prefix).replace("@U@", capitals);
            (format!("{prefix}.{ending}"), text)
        })
    }
}
