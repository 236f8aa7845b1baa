//! C99: one header and one source.

mod header;
mod source;

use super::export::SeveralFreedomsExport;
use crate::c::Statements;
use crate::identifiers::{Identifiers, distinct};
use crate::machine::LoadEffect;
use crate::writer::{load_inputs, load_parameters};

/// An export of several degrees of freedom as C99: the name and the text of the header, then of the source. It calls sqrt, sin, cos and
/// atan2 of the library, each only if it is needed.
///
/// The source has a self-test and a `main` if `NAME_SELF_TEST` is defined, with NAME in capitals.
pub fn c_files_of_several_freedoms(export: &SeveralFreedomsExport) -> [(String, String); 2] {
    let writer = Writer::new(export);
    let prefix = &writer.names.prefix;
    [
        (format!("{prefix}.h"), writer.finish(&writer.header())),
        (format!("{prefix}.c"), writer.finish(&writer.source())),
    ]
}

struct Writer<'a> {
    export: &'a SeveralFreedomsExport,
    names: Identifiers,
    coordinates: Vec<String>,
    statements: Statements,
}

impl<'a> Writer<'a> {
    fn new(export: &'a SeveralFreedomsExport) -> Self {
        let machine = &export.machine;
        let coordinates: Vec<_> = machine.coordinates.iter().map(|c| &c.name).collect();
        Self {
            names: Identifiers::of(
                &machine.name,
                &machine.loads,
                &machine.reactions,
                &machine.points,
            ),
            coordinates: distinct(&coordinates),
            statements: Statements {
                precision: export.precision,
                coordinate: |k| format!("q[{k}]"),
            },
            export,
        }
    }

    /// Puts the names in: `@p@` for the prefix, `@U@` for it in capitals.
    fn finish(&self, text: &str) -> String {
        text.replace("@p@", &self.names.prefix)
            .replace("@U@", &self.names.capitals)
    }

    fn number(&self, value: f64) -> String {
        self.statements.number(value)
    }

    fn has_loads(&self) -> bool {
        !self.export.machine.loads.is_empty()
    }

    fn has_reactions(&self) -> bool {
        !self.export.machine.reactions.is_empty()
    }

    /// The loads with a current: their index, and the place of the current in the rates.
    fn currents(&self) -> Vec<(usize, usize)> {
        let machine = &self.export.machine;
        let loads = machine.loads.iter().enumerate();
        let has_current = |effect: &LoadEffect| effect.motor().is_some_and(|m| m.inductance > 0.0);
        let loads = loads.filter(|(_, load)| has_current(&load.effect));
        loads
            .map(|(k, _)| k)
            .zip(2 * machine.freedoms()..)
            .collect()
    }

    fn parameters(&self) -> Vec<(String, f64, String)> {
        load_parameters(&self.export.machine.loads, &self.names.loads)
    }

    fn inputs(&self) -> Vec<(usize, String, f64, String)> {
        load_inputs(&self.export.machine.loads, &self.names.loads)
    }
}
