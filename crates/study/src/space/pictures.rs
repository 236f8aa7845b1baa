//! Pictures of a mechanism in space over its range, beside its reduced parameters.

use super::prepared::PreparedSpaceScene;
use super::reduction::compute_reduction_in_space;
use super::views::{SpacePositions, page_drawing};
use crate::explain::StudyError;
use crate::number_format::{coordinate_unit, count};
use crate::output::{Outcome, Picture, symbol};
use crate::reduce::compute::{ReducedScene as _, TableRequest};
use crate::reduce::{add_table, reduction_outcome};
use crate::trajectory::figures::describe_abscissa;
use dwell_geometry::Range;
use dwell_geometry::space::Placement;
use dwell_report::Figure;
use dwell_scene::SpaceScene;

/// Intervals of a revolution, or of the range, from which paths are drawn.
const DRAWN_INTERVALS: usize = 240;

/// The reduced parameters of a scene in space over its range, at `points` positions (two or more) if given, with pictures, and an
/// interpolation table if requested.
///
/// # Errors
/// As [`compute_reduction_in_space`](crate::compute_reduction_in_space()), and when the table cannot be built.
pub fn reduce_in_space(
    scene: &SpaceScene,
    points: Option<usize>,
    table: Option<TableRequest>,
) -> Result<Outcome, StudyError> {
    let reduction = compute_reduction_in_space(scene, points)?;
    let mut outcome = reduction_outcome(&reduction)?;
    if let Some(request) = table {
        add_table(&reduction.prepared, &request, &mut outcome)?;
    }
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

impl<'a> PreparedSpaceScene<'a> {
    /// The mechanism in three views and an axonometric one.
    ///
    /// # Errors
    /// [`StudyError::Scene`] where a position of the range cannot be reached.
    pub fn mechanism_figure(&self) -> Result<Figure, StudyError> {
        Ok(self.drawn_positions()?.figure())
    }

    /// The mechanism over its range, for pictures: at the start, and in positions that follow each other.
    fn drawn_positions(&self) -> Result<SpacePositions<'a>, StudyError> {
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

/// A mechanism in space in three views and an axonometric one, at the first of some positions, which are given with what they are; from
/// all of them paths are drawn.
pub fn mechanism_figure_in_space(
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
