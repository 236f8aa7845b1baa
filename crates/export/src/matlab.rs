//! MATLAB and Octave: the cells as a file of level 5, a function that evaluates them and one that integrates.

mod functions;
mod level5;

use crate::export::Export;
use crate::identifiers::Identifiers;
use crate::machine::PartKind;
use crate::part::Column;
use functions::{evaluation, rates};
use level5::MatFile;

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

/// The names of the parts in the data.
const PARTS: [&str; 3] = ["motion", "reactions", "positions"];

/// Everything that the functions read, with units and origin.
fn data(export: &Export) -> Vec<u8> {
    let machine = &export.machine;
    let mut file = MatFile::new(&format!("dwell {}", machine.version));
    let mut text = |name: &str, value: &str| file.add_text(name, value);
    text("title", &machine.title);
    text("scene_hash", &machine.scene_hash);
    text("dwell_version", &machine.version);
    text("coordinate", &machine.coordinate);
    text("coordinate_unit", machine.unit());
    text("m_unit", machine.inertia_unit());
    let with_unit = |(name, unit): (&String, &str)| format!("{name} [{unit}]");
    let loads = machine.loads.iter().map(|load| (&load.name, load.unit));
    let loads: Vec<String> = loads.map(with_unit).collect();
    text("loads", &loads.join("; "));
    let reactions = machine.reactions.iter().map(|(name, unit)| (name, *unit));
    let reactions: Vec<String> = reactions.map(with_unit).collect();
    text("reaction_names", &reactions.join("; "));
    text("points", &machine.points.join("; "));
    let domain = machine.domain;
    file.add_row("domain", &[domain.from, domain.to]);
    file.add_row("revolutions", &[f64::from(domain.revolutions)]);
    file.add_row("accuracy", &[export.request.accuracy]);
    file.add_row("largest_error", &[export.measured.errors.max()]);
    for kind in PartKind::ALL {
        cells(export, kind, &mut file);
    }
    file.finish()
}

/// The cells of a part.
fn cells(export: &Export, kind: PartKind, file: &mut MatFile) {
    let (part, name) = (&export.parts[kind as usize], PARTS[kind as usize]);
    // By column: its number in the cells, or zero and a constant.
    let columns = part.columns.iter().map(|(_, column)| match *column {
        Column::Tabulated(k) => ((k + 1) as f64, 0.0),
        Column::Constant(value) => (0.0, value),
    });
    let (places, constants): (Vec<f64>, Vec<f64>) = columns.unzip();
    file.add_row(&format!("{name}_places"), &places);
    file.add_row(&format!("{name}_constants"), &constants);
    let index = part.index.iter().map(|&cell| f64::from(cell) + 1.0);
    file.add_row(&format!("{name}_index"), &index.collect::<Vec<_>>());
    file.add_row(&format!("{name}_bins_per_unit"), &[part.bins_per_unit]);
    file.add_rows(&format!("{name}_cells"), part.stride(), &part.cells);
}
