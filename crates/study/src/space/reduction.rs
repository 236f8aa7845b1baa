//! The reduced parameters of a scene in space.

use super::prepared::PreparedSpaceScene;
use super::views::page_drawing;
use crate::explain::StudyError;
use crate::reduce::compute::{Reduction, peak_between_rows};
use crate::reduce::page_of;
use dwell_page::Page;
use dwell_scene::SpaceScene;

/// The reduced parameters of a scene in space over its range, at `points` positions (two or more) if given.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled or has not one degree of freedom, or a position cannot be evaluated.
pub fn compute_reduction_in_space(
    scene: &SpaceScene,
    points: Option<usize>,
) -> Result<Reduction<PreparedSpaceScene<'_>>, StudyError> {
    Reduction::new(PreparedSpaceScene::new(scene)?, points)
}

/// The page of the reduced parameters of a scene in space.
///
/// # Errors
/// [`StudyError`] when a position cannot be reached.
///
/// ```
/// use dwell_study::{compute_reduction_in_space, reduction_page_in_space};
///
/// let scene = dwell_scene::SpaceScene::read("../../validation/spatial/rssr.toml")?;
/// let page = reduction_page_in_space(&compute_reduction_in_space(&scene, Some(7))?)?;
/// assert_eq!(page.columns[1].key, "m");
/// # Ok::<(), dwell_study::StudyError>(())
/// ```
pub fn reduction_page_in_space(
    reduction: &Reduction<PreparedSpaceScene<'_>>,
) -> Result<Page, StudyError> {
    let prepared = &reduction.prepared;
    let peak = peak_between_rows(prepared, &reduction.curves);
    let mut page = page_of(reduction, &reduction.table(), peak);
    if let Some(coordinate) = page.columns.first() {
        let rows = prepared.placements(&coordinate.values)?;
        page.drawing = Some(page_drawing(prepared.scene, rows, Vec::new()));
    }
    Ok(page)
}
