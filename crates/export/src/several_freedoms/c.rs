//! C99: one header and one source.

mod header;
mod source;

use super::export::SeveralFreedomsExport;
use crate::c::CWriter;
use crate::identifiers::Identifiers;
use crate::writer::Members;

/// An export of several degrees of freedom as C99: the name and the text of the header, then of the source. It calls sqrt, sin, cos and
/// atan2 of the library, each only if it is needed.
///
/// The source has a self-test and a `main` if `NAME_SELF_TEST` is defined, with NAME in capitals.
pub fn c_files_of_several_freedoms(export: &SeveralFreedomsExport) -> [(String, String); 2] {
    let machine = &export.machine;
    let (loads, reactions, points) = (&machine.loads, &machine.reactions, &machine.points);
    let writer = CWriter {
        members: Members {
            names: Identifiers::of(&machine.name, loads, reactions, points),
            loads,
            reactions,
            points,
            freedoms: machine.freedoms(),
            inertia_unit: None,
        },
        precision: export.precision,
        coordinate: |k| format!("q[{k}]"),
        export,
    };
    writer.files(&writer.header(), &writer.source())
}
