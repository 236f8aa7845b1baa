//! Rust without the standard library: one crate without allocation, unsafe code or a dependency.

mod results;
mod self_test;
mod source;

use crate::describe::describe;
use crate::export::Export;
use crate::identifiers::comment;
use crate::part::Precision;
use crate::writer::Members;
use std::fmt::Write as _;
use std::ops::Deref;

/// An export as a crate: paths and texts of its manifest and its source.
///
/// The source has a `self_test` for its feature of that name and for `cargo test`. None of an exact export: without the standard library
/// there is no square root and no sine.
pub fn rust_files(export: &Export) -> Option<[(String, String); 2]> {
    if export.code.is_some() {
        return None;
    }
    let members = Members::new(export);
    let writer = RustWriter { export, members };
    let name = &writer.names.prefix;
    let manifest = format!(
        "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2021\"\n\n[features]\nself-test = []\n\n[dependencies]\n"
    );
    Some([
        (format!("{name}/Cargo.toml"), manifest),
        (format!("{name}/src/lib.rs"), writer.source()),
    ])
}

/// Writes an export in Rust.
struct RustWriter<'a> {
    export: &'a Export,
    members: Members<'a>,
}

impl<'a> Deref for RustWriter<'a> {
    type Target = Members<'a>;

    fn deref(&self) -> &Members<'a> {
        &self.members
    }
}

impl RustWriter<'_> {
    /// A number of the exported kind.
    fn number(&self, value: f64) -> String {
        match self.export.request.precision {
            Precision::Double => format!("{value:e}"),
            Precision::Float => format!("{:e}", value as f32),
        }
    }

    fn list(&self, numbers: &[f64]) -> String {
        let numbers: Vec<String> = numbers.iter().map(|&n| self.number(n)).collect();
        numbers.join(", ")
    }

    /// The description of the code and of its errors.
    fn banner(&self) -> String {
        let mut text = String::new();
        for line in describe(self.export) {
            _ = writeln!(text, "{}", format!("//! {}", comment(&line)).trim_end());
        }
        let [motion, all, step] = self.export.measured.operations;
        _ = writeln!(
            text,
            "//! constants: {} bytes. Additions, multiplications and divisions, the worst case at any q: {motion} of the terms\n//! of motion, {all} with those of the reactions, {step} of a step.",
            self.export.constant_bytes()
        );
        text
    }
}
