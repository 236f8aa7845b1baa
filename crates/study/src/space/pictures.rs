//! Pictures of a mechanism in space over its range, in addition to those of its reduced parameters.

use super::prepared::PreparedSpaceScene;
use super::views::SpacePositions;
use crate::explain::StudyError;
use crate::number_format::{coordinate_unit, count};
use crate::output::symbol;
use crate::reduce::compute::ReducedScene as _;
use crate::trajectory::figures::describe_abscissa;
use dwell_geometry::Range;
use dwell_geometry::space::Placement;
use dwell_report::Figure;
use dwell_scene::SpaceScene;

/// Intervals of a revolution, or of the range, from which paths are drawn.
const DRAWN_INTERVALS: usize = 240;

impl<'a> PreparedSpaceScene<'a> {
    /// The mechanism in three views and an axonometric one.
    ///
    /// # Errors
    /// [`StudyError::Scene`] where a position of the range cannot be reached.
    pub fn mechanism_figure(&self) -> Result<Figure, StudyError> {
        Ok(self.drawn_positions()?.figure())
    }

    /// The mechanism over its range, for pictures: at the start, and in positions that follow each other.
    pub(super) fn drawn_positions(&self) -> Result<SpacePositions<'a>, StudyError> {
        let turns = match self.range() {
            Range::Revolutions(count) => count as usize,
            _ => 1,
        };
        let q = self.positions(DRAWN_INTERVALS * turns);
        let name = symbol(self.coordinate_name());
        let describe =
            |q: f64| describe_abscissa(self.scene, &name, coordinate_unit(self.is_angle()), q);
        let names = q.iter().map(|&q| describe(q));
        let all: Vec<_> = self.placements(&q)?.into_iter().zip(names).collect();
        let start = self.scene.assembly.q[0];
        let drawn = self.placements(&[start])?.pop().unwrap_or_default();
        Ok(SpacePositions {
            scene: self.scene,
            drawn,
            drawn_at: describe(start),
            provenance: format!("the mechanism at {}", count(all.len(), "position")),
            all,
        })
    }
}

/// A mechanism in space in three views and an axonometric one, at the first of some positions, which are given with descriptions. Paths
/// are drawn through all positions.
pub fn figure_of_positions(
    scene: &SpaceScene,
    positions: Vec<(Vec<Placement>, String)>,
    provenance: String,
) -> Figure {
    let (drawn, drawn_at) = positions.first().cloned().unwrap_or_default();
    let positions = SpacePositions {
        scene,
        drawn,
        drawn_at,
        all: positions,
        provenance,
    };
    positions.figure()
}
