//! C99: one header and one source that need no library, no memory and no other file.

mod code;
mod header;
mod results;
mod self_test;
mod source;
mod step;
mod tables;

pub(crate) use code::Statements;

use crate::export::Export;
use crate::writer::Writer;
use std::ops::Deref;

/// An export as C99: the name and the text of the header, then of the source.
///
/// The source has a self-test and a `main` if `NAME_SELF_TEST` is defined, with NAME in capitals.
pub fn c_files(export: &Export) -> [(String, String); 2] {
    let writer = CWriter(Writer::new(export));
    let prefix = &writer.names.prefix;
    [
        (format!("{prefix}.h"), writer.finish(&writer.header())),
        (format!("{prefix}.c"), writer.finish(&writer.source())),
    ]
}

/// Writes an export in C.
struct CWriter<'a>(Writer<'a>);

impl<'a> Deref for CWriter<'a> {
    type Target = Writer<'a>;

    fn deref(&self) -> &Writer<'a> {
        &self.0
    }
}

impl CWriter<'_> {
    /// Puts the names in: `@p@` for the prefix, `@U@` for it in capitals.
    fn finish(&self, text: &str) -> String {
        text.replace("@p@", &self.names.prefix)
            .replace("@U@", &self.names.capitals)
    }

    /// A number of the exported kind.
    fn number(&self, value: f64) -> String {
        self.statements().number(value)
    }
}
