//! C99: one header and one source.

mod source;

use super::export::SeveralFreedomsExport;
use crate::c::{CALLED, COMPILE, CWriter, count};
use crate::identifiers::{Identifiers, distinct};
use crate::writer::{Members, list};

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
        marks: if loads.is_empty() { "n" } else { "nv" }.to_owned(),
    };
    let names: Vec<_> = machine.coordinates.iter().map(|c| &c.name).collect();
    let coordinates = count("COORDINATE", &list(&distinct(&names), names));
    let pairs = format!(
        "#define @U@_PAIR_COUNT {} /* products of velocities: i <= j, in the order (0,0), (0,1), ..., (1,1), ... */\n",
        machine.pairs().len()
    );
    let q_ddot = "@p@_real q_ddot[@U@_COORDINATE_COUNT]";
    let own = [
        ("q", "const @p@_real q[@U@_COORDINATE_COUNT]".to_owned()),
        ("q_ddot", format!("const {q_ddot}")),
        ("found_q_ddot", q_ddot.to_owned()),
        ("counts", coordinates + &writer.counts() + &pairs),
    ];
    let header = writer.header(&description(export), &own);
    writer.files(&header, &writer.source())
}

/// The description of the code and of its errors.
fn description(export: &SeveralFreedomsExport) -> Vec<String> {
    let (machine, errors) = (&export.machine, &export.errors);
    let n = machine.freedoms();
    let mut lines = vec![
        machine.title.clone(),
        String::new(),
        format!(
            "Equations of motion of {n} degrees of freedom, written by dwell {} from the scene with the hash {}.",
            machine.version, machine.scene_hash
        ),
        "All quantities are in SI units.".to_owned(),
    ];
    for coordinate in &machine.coordinates {
        let unit = if coordinate.is_angle { "rad" } else { "m" };
        lines.push(format!("coordinate: {}, {unit}", coordinate.name));
    }
    lines.push(format!(
        "accuracy: the operations of the model itself, in the assembly mode of the scene; largest errors measured around the initial position in {}, relative to the largest value of each kind: mass matrix {:.1e}, velocity terms {:.1e}, loads {:.1e}, reactions {:.1e}, positions {:.1e}",
        export.precision.measured_in(),
        errors.mass_matrix,
        errors.velocity_terms,
        errors.loads,
        errors.reactions,
        errors.positions
    ));
    let codes = export.code.each_ref();
    let [motion, reactions, positions] = codes.map(|code| code.operations.len());
    let functions = codes.map(|code| code.functions().to_string());
    lines.push(format!(
        "operations: {motion} of the terms of motion, {reactions} of those of the reactions, {positions} of the positions; of them square roots, sines, cosines and angles: {}",
        functions.join(", ")
    ));
    lines.extend([CALLED, COMPILE].map(str::to_owned));
    let left_out = machine.left_out.iter();
    lines.extend(left_out.map(|words| format!("left out: {words}")));
    lines
}
