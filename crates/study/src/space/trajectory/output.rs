//! Writes the results along a trajectory in space: tables, figures, page and animation.

use super::evaluator::SpaceEvaluator;
use super::page::space_page;
use super::reactions::JointReactions;
use super::rows::computed_rows;
use crate::explain::{NamedScene as _, StudyError};
use crate::number_format::coordinate_unit;
use crate::output::symbol;
use crate::progress::Progress;
use crate::space::views::SpacePositions;
use crate::trajectory::compute::{Analysis, ComputedTrajectory, RowEvaluator as _};
use crate::trajectory::document::Document;
use crate::trajectory::figures::{PictureSpan, describe_abscissa};
use crate::trajectory::output::{TrajectoryOutcome, outcome_of};
use dwell_scene::SpaceScene;

/// Positions from which paths are drawn.
const DRAWN_POSITIONS: usize = 241;

/// Analyses a scene in space along its prescribed motion, its sweep, or the range of its only actuator, at `points` positions
/// (two or more) if given; curves show a part of it.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled, the scene gives no coordinates, or the first position cannot
/// be reached.
pub fn analyse_in_space(
    scene: &SpaceScene,
    analysis: Analysis,
    points: Option<usize>,
    span: PictureSpan,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let (reactions, model) = JointReactions::new(scene)?;
    let (of_model, of) = ((&reactions, &model), (analysis, points));
    let (computed, evaluator) = computed_rows(scene, of_model, of, &|_| true, progress)?;
    let size = model.plan().size();
    let swept = computed.trajectory.swept_actuator();
    let swept = swept.and_then(|k| scene.actuator(k));
    let run = space_page(
        scene,
        size,
        &computed,
        (&reactions, vec![evaluator.clone()]),
    );
    let positions = drawn_positions(scene, &computed, vec![evaluator], swept);
    let mut figures = vec![positions.figure()];
    figures.extend(super::figures::figures(scene, swept, &computed, span)?);
    let document = Document::of_file(&scene.file, size, &computed);
    let pictures = (figures, positions.animation());
    let mut outcome = outcome_of(&scene.file, &computed, &document, pictures)?;
    outcome.run = Some(Box::new(run));
    Ok(TrajectoryOutcome {
        outcome,
        early_stop: computed.early_stop,
    })
}

/// The mechanism along the part of a trajectory that was reached.
pub(crate) fn drawn_positions<'a>(
    scene: &'a SpaceScene,
    computed: &ComputedTrajectory<'_>,
    mut evaluators: Vec<SpaceEvaluator<'_>>,
    swept: Option<(&str, bool)>,
) -> SpacePositions<'a> {
    let trajectory = &computed.trajectory;
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
        Some((evaluator.placements.clone(), at))
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
