//! Scenes of mechanisms in space: what can be said of them before they move, and their reduced parameters.

mod check;
mod explain;
mod export;
mod machine_scene;
mod motion;
mod prepared;
mod trajectory;
mod views;

pub use check::check_in_space;
pub use export::export_in_space;
pub use motion::simulate_in_space;
pub use prepared::PreparedSpaceScene;
pub use trajectory::analyse_in_space;

use crate::explain::StudyError;
use crate::output::{Outcome, Picture};
use crate::reduce::compute::{Reduction, TableRequest};
use crate::reduce::{add_table, reduction_outcome};
use dwell_scene::SpaceScene;

/// The reduced parameters of a scene in space over its range, at `points` positions (two or more) if given, and an interpolation
/// table if requested.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled or has not one degree of freedom, a position cannot be evaluated, or the
/// table cannot be built.
pub fn reduce_in_space(
    scene: &SpaceScene,
    points: Option<usize>,
    table: Option<TableRequest>,
) -> Result<Outcome, StudyError> {
    let reduction = Reduction::new(PreparedSpaceScene::new(scene)?, points)?;
    let mut outcome = reduction_outcome(&reduction)?;
    if let Some(request) = table {
        add_table(&reduction.prepared, &request, &mut outcome)?;
    }
    let positions = reduction.prepared.drawn_positions()?;
    let name = |rest: &str| format!("{}-mechanism.{rest}", scene.name);
    let figure = Picture::figure(scene, name("png"), true, positions.figure());
    let animation = Picture::animation(scene, name("gif"), positions.animation());
    outcome.pictures.insert(0, figure);
    outcome.pictures.push(animation);
    Ok(outcome)
}
