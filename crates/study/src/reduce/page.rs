//! The page of reduced parameters: their rows, with the mechanism.

use crate::number_format::count;
use crate::page::{scene_page, table_page};
use crate::reduce::compute::{Peak, ReducedScene, Reduction};
use dwell_findings::Table;
use dwell_page::Page;

/// The column of m in the table.
const M_COLUMN: usize = 1;

/// The rows on a page; the largest m may be between them.
pub(crate) fn page_of<P: ReducedScene>(
    reduction: &Reduction<P>,
    table: &Table,
    peak: Option<Peak>,
) -> Page {
    let prepared = &reduction.prepared;
    let mut page = table_page(scene_page(prepared.file(), "reduce"), table, column_group);
    let positions = count(table.rows.len(), "position");
    page.subtitle = format!("{positions} of {}", prepared.coordinate_name());
    if let Some(peak) = peak
        && let Some(of_m) = page.peaks.iter_mut().find(|of| of.column == M_COLUMN)
    {
        of_m.ends[1] = [peak.m, peak.q];
    }
    page
}

/// The chart group of a column of the table, and its description.
pub(crate) fn column_group(name: &str, _: &str) -> (String, String) {
    let (group, description) = match name {
        "m" => ("Generalised inertia", "m(q): generalised inertia"),
        "half_dm" => ("Half its slope, ½m′", "½ dm/dq"),
        "V" => ("Potential energy", "potential energy of the loads"),
        "relative_error" => (
            "Rounding",
            "estimated rounding error, relative to the largest value of each coefficient",
        ),
        name if name.ends_with(".a") => (
            "Reaction coefficients a",
            "reaction for a unit acceleration of the coordinate, without speed",
        ),
        name if name.ends_with(".b") => (
            "Reaction coefficients b",
            "reaction for a unit speed of the coordinate, without acceleration",
        ),
        name if name.ends_with(".w") => (
            "Generalised forces w",
            "generalised force of the load at magnitude one",
        ),
        name if name.contains(".c.") => (
            "Reaction coefficients c",
            "reaction for a unit of the load's magnitude, at rest",
        ),
        _ => ("Coordinates and others", ""),
    };
    (group.to_owned(), description.to_owned())
}
