//! MATLAB and Octave: the cells as a file of level 5, a function that evaluates them and one that integrates.

mod functions;
mod level5;

use crate::export::Export;
use crate::identifiers::Identifiers;
use crate::machine::PartKind;
use crate::part::Column;
use functions::{evaluation, rates};
use level5::{MatFile, Matrix};

/// An export for MATLAB and Octave: names and bytes of its data and its functions. None of an exact export, which has no data.
pub fn matlab_files(export: &Export) -> Option<Vec<(String, Vec<u8>)>> {
    if export.code.is_some() {
        return None;
    }
    let name = Identifiers::new(&export.machine).prefix;
    Some(vec![
        (format!("{name}_data.mat"), data(export)),
        (format!("{name}.m"), evaluation(export, &name).into_bytes()),
        (format!("{name}_rates.m"), rates(export, &name).into_bytes()),
    ])
}

/// The name of a part in the data.
fn part_name(kind: PartKind) -> &'static str {
    match kind {
        PartKind::Motion => "motion",
        PartKind::Reactions => "reactions",
        PartKind::Positions => "positions",
    }
}

/// Everything that the functions read, with units and origin.
fn data(export: &Export) -> Vec<u8> {
    let machine = &export.machine;
    let mut file = MatFile::new(&format!("dwell {}", machine.version));
    let mut text = |name: &str, value: &str| file.add(name, &Matrix::Text(value.to_owned()));
    text("title", &machine.title);
    text("scene_hash", &machine.scene_hash);
    text("dwell_version", &machine.version);
    text("coordinate", &machine.coordinate);
    text(
        "coordinate_unit",
        if machine.is_angle { "rad" } else { "m" },
    );
    text("m_unit", if machine.is_angle { "kg m2" } else { "kg" });
    let loads: Vec<String> = machine
        .loads
        .iter()
        .map(|load| format!("{} [{}]", load.name, load.unit))
        .collect();
    text("loads", &loads.join("; "));
    let reactions = machine.reactions.iter();
    let reactions: Vec<String> = reactions
        .map(|(name, unit)| format!("{name} [{unit}]"))
        .collect();
    text("reaction_names", &reactions.join("; "));
    text("points", &machine.points.join("; "));
    let row = |values: Vec<f64>| Matrix::Numbers {
        columns: values.len(),
        values,
    };
    let domain = machine.domain;
    file.add("domain", &row(vec![domain.from, domain.to]));
    file.add("revolutions", &row(vec![f64::from(domain.revolutions)]));
    file.add("accuracy", &row(vec![export.request.accuracy]));
    file.add("largest_error", &row(vec![export.measured.errors.max()]));
    for kind in PartKind::ALL {
        cells(export, kind, &mut file);
    }
    file.finish()
}

/// The cells of a part.
fn cells(export: &Export, kind: PartKind, file: &mut MatFile) {
    let row = |values: Vec<f64>| Matrix::Numbers {
        columns: values.len(),
        values,
    };
    let (part, name) = (&export.parts[kind as usize], part_name(kind));
    // By column: its number in the cells, or zero and a constant.
    let places = part.columns.iter().map(|(_, column)| match column {
        Column::Tabulated(k) => (*k + 1) as f64,
        Column::Constant(_) => 0.0,
    });
    let constants = part.columns.iter().map(|(_, column)| match column {
        Column::Tabulated(_) => 0.0,
        Column::Constant(value) => *value,
    });
    file.add(&format!("{name}_places"), &row(places.collect()));
    file.add(&format!("{name}_constants"), &row(constants.collect()));
    let index = part.index.iter().map(|&cell| f64::from(cell) + 1.0);
    file.add(&format!("{name}_index"), &row(index.collect()));
    file.add(
        &format!("{name}_bins_per_unit"),
        &row(vec![part.bins_per_unit]),
    );
    let cells = Matrix::Numbers {
        columns: part.stride(),
        values: part.cells.clone(),
    };
    file.add(&format!("{name}_cells"), &cells);
}
