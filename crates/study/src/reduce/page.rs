//! The page of reduced parameters: their rows, with the mechanism.

use crate::models::PreparedScene;
use crate::number_format::count;
use crate::page::{drawing_along, scene_page, table_page};
use crate::reduce::compute::{Peak, ReducedScene, Reduction, peak_between_rows};
use dwell_findings::Table;
use dwell_page::Page;

/// The column of m in the table.
const M_COLUMN: usize = 1;

/// The page of the reduced parameters of a scene in the plane.
///
/// ```
/// # let text = r#"
/// # bodies.ground.points = { O = [0, 0] }
/// # bodies.bob = { points = { O = [0, 0] }, mass = 2.0, center = [0.5, 0] }
/// # joints.O = { revolute = ["ground.O", "bob.O"] }
/// # actuators.phi = { angle = ["ground", "bob"] }
/// # "#;
/// let scene = dwell_scene::Scene::parse("pendulum.toml", text)?;
/// let reduction = dwell_study::compute_reduction(&scene, Some(5))?;
/// let page = dwell_study::reduce::reduction_page(&reduction);
/// // m = M r² everywhere.
/// assert_eq!(page.columns[1].values, [0.5; 5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn reduction_page(reduction: &Reduction<PreparedScene<'_>>) -> Page {
    let peak = peak_between_rows(&reduction.prepared, &reduction.curves);
    let mut page = page_of(reduction, &reduction.table(), peak);
    page.drawing = drawing_along(reduction.prepared.scene, &page.columns[0].values);
    page
}

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

/// What belongs in one chart with a column of the table, and what it is.
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
