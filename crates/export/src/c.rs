//! C99: one header and one source that need no library, no memory and no other file.

mod code;
mod header;
mod results;
mod self_test;
mod source;
mod step;
mod tables;

pub(crate) use code::{CALLED, COMPILE, POTENTIALS, member};

use crate::export::Export;
use crate::part::Precision;
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
    let writer = CWriter {
        export,
        members: Members::new(export),
        precision: export.request.precision,
        coordinate: |_| "q".to_owned(),
    };
    writer.files(&writer.header(), &writer.source())
}

/// Writes an export in C: of one degree of freedom, or of several.
pub(crate) struct CWriter<'a, E> {
    pub(crate) export: &'a E,
    pub(crate) members: Members<'a>,
    pub(crate) precision: Precision,
    /// A coordinate by its place.
    pub(crate) coordinate: fn(usize) -> String,
}

impl<'a, E> Deref for CWriter<'a, E> {
    type Target = Members<'a>;

    fn deref(&self) -> &Members<'a> {
        &self.members
    }
}

impl<E> CWriter<'_, E> {
    /// Header and source with the names put in: `@p@` for the prefix, `@U@` for it in capitals, `@arguments@` for what most
    /// functions begin with.
    pub(crate) fn files(&self, header: &str, source: &str) -> [(String, String); 2] {
        let (prefix, capitals) = (&self.names.prefix, &self.names.capitals);
        [("h", header), ("c", source)].map(|(ending, text)| {
            let text = text.replace("@arguments@", ARGUMENTS);
            let text = text.replace("@p@", prefix).replace("@U@", capitals);
            (format!("{prefix}.{ending}"), text)
        })
    }
}
