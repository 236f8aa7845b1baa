//! Scenes of mechanisms in space: what can be said of them before they move, and their reduced parameters.

mod check;
mod explain;
mod prepared;

pub use check::check_in_space;
pub use prepared::PreparedSpaceScene;

use crate::explain::StudyError;
use crate::output::Outcome;
use crate::reduce::compute::Reduction;
use crate::reduce::reduction_outcome;
use dwell_scene::SpaceScene;

/// The reduced parameters of a scene in space over its range, at `points` positions (two or more) if given.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled or has not one degree of freedom, or a position cannot be evaluated.
pub fn reduce_in_space(scene: &SpaceScene, points: Option<usize>) -> Result<Outcome, StudyError> {
    reduction_outcome(&Reduction::new(PreparedSpaceScene::new(scene)?, points)?)
}
