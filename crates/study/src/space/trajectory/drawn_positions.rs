//! The mechanism along a trajectory in space, for its pictures.

use super::page::evaluators_of;
use crate::number_format::coordinate_unit;
use crate::output::symbol;
use crate::space::views::SpacePositions;
use crate::trajectory::compute::{ComputedTrajectory, RowEvaluator as _, RowSource};
use crate::trajectory::figures::describe_abscissa;
use dwell_scene::SpaceScene;

/// Positions from which paths are drawn.
const DRAWN_POSITIONS: usize = 241;

/// The mechanism along the part of a trajectory that was reached.
pub(crate) fn drawn_positions<'a>(
    source: &RowSource<'a, '_, SpaceScene>,
    computed: &ComputedTrajectory<'_>,
    swept: Option<(&str, bool)>,
) -> SpacePositions<'a> {
    let (scene, trajectory) = (source.scene, &computed.trajectory);
    let mut evaluators = evaluators_of(source, computed);
    let last = trajectory.fraction_at(computed.results.len().saturating_sub(1));
    let mut place = |fraction: f64| {
        let sample = trajectory.sample_at(fraction);
        let evaluator = evaluators.get_mut(sample.chart)?;
        evaluator
            .evaluate(&sample, trajectory.load_time(&sample))
            .ok()?;
        let q = sample.q[trajectory.swept_actuator().unwrap_or(0)];
        let at = match swept {
            Some((name, is_angle)) => {
                describe_abscissa(scene, &symbol(name), coordinate_unit(is_angle), q)
            }
            None => describe_abscissa(scene, "time", "s", sample.t),
        };
        Some((evaluator.placements(), at))
    };
    let intervals = DRAWN_POSITIONS - 1;
    let all: Vec<_> = (0..=intervals)
        .filter_map(|k| place(last * k as f64 / intervals as f64))
        .collect();
    let (drawn, drawn_at) = all.first().cloned().unwrap_or_default();
    SpacePositions {
        scene,
        drawn,
        drawn_at,
        all,
        provenance: trajectory.method_text.clone(),
    }
}
