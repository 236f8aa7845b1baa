//! Scenes of mechanisms in space: what can be said of them before they move, and their reduced parameters.

mod check;
mod explain;
mod export;
mod motion;
mod prepared;
mod trajectory;
mod views;

pub use check::check_in_space;
pub use export::export_in_space;
pub use motion::simulate_in_space;
pub use prepared::PreparedSpaceScene;
pub use trajectory::analyse_in_space;

use self::views::page_drawing;
use crate::explain::StudyError;
use crate::output::{Outcome, Picture};
use crate::reduce::compute::Reduction;
use crate::reduce::reduction_outcome;
use dwell_scene::SpaceScene;

/// The reduced parameters of a scene in space over its range, at `points` positions (two or more) if given.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled or has not one degree of freedom, or a position cannot be evaluated.
pub fn reduce_in_space(scene: &SpaceScene, points: Option<usize>) -> Result<Outcome, StudyError> {
    let reduction = Reduction::new(PreparedSpaceScene::new(scene)?, points)?;
    let mut outcome = reduction_outcome(&reduction)?;
    if let Some(run) = &mut outcome.run {
        let rows = reduction.prepared.placements(&run.columns[0].values)?;
        run.drawing = Some(page_drawing(scene, rows, Vec::new()));
    }
    let positions = reduction.prepared.drawn_positions()?;
    let name = |rest: &str| format!("{}-mechanism.{rest}", scene.name);
    let figure = Picture::figure(scene, name("png"), true, positions.figure());
    let animation = Picture::animation(scene, name("gif"), positions.animation());
    outcome.pictures.insert(0, figure);
    outcome.pictures.push(animation);
    Ok(outcome)
}
