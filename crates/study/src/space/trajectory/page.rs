//! The page of a trajectory in space: rows, peaks, and the mechanism in each row with its reactions.

use super::evaluator::SpaceEvaluator;
use super::reactions::SpaceRows;
use crate::page::{RowChoice, force_arrow, run_page};
use crate::space::views::{anchor, page_drawing};
use crate::trajectory::compute::{ComputedTrajectory, Quantity, RowEvaluator as _, RowSource};
use dwell_geometry::JointId;
use dwell_kinetostatics::space::{Axes, Component};
use dwell_page::{Direction, ForceArrow, Page};
use dwell_scene::SpaceScene;

/// The evaluators of the rows of a trajectory, by chart.
pub(super) fn evaluators_of<'e>(
    source: &'e RowSource<'_, '_, SpaceScene>,
    computed: &ComputedTrajectory<'_>,
) -> Vec<SpaceEvaluator<'e>> {
    let analysis = computed.trajectory.analysis;
    let charts = source.charts_or(source.rows).into_iter();
    let all = charts.map(|(scene, rows)| SpaceEvaluator::new(scene, rows, analysis));
    all.collect()
}

/// The page of rows.
pub(crate) fn space_page(
    source: &RowSource<'_, '_, SpaceScene>,
    computed: &ComputedTrajectory<'_>,
) -> Page {
    let (scene, rows) = (source.scene, source.rows);
    let mut evaluators = evaluators_of(source, computed);
    let (trajectory, results) = (&computed.trajectory, &computed.results);
    let mut page = run_page(&scene.file, rows.model.plan().size(), computed);
    let choice = RowChoice::new(results);
    let mut place = |row: usize| {
        let sample = trajectory.sample_at(trajectory.fraction_at(row));
        let time = trajectory.load_time(&sample);
        let evaluator = evaluators.get_mut(sample.chart)?;
        evaluator.evaluate(&sample, time).ok()?;
        Some(evaluator.placements())
    };
    let long = results.long_rows.as_ref();
    let placements = choice.rows();
    let placements = placements.map(|k| place(long.map_or(k, |long| long.row_number(k))));
    // A row that was evaluated can be evaluated again.
    if let Some(placements) = placements.collect::<Option<Vec<_>>>() {
        let arrows = arrows(scene, computed, rows);
        page.drawing = Some(page_drawing(scene, placements, arrows));
    }
    page
}

/// The forces of the joints whose three components in the axes of the ground are among the columns.
fn arrows(
    scene: &SpaceScene,
    computed: &ComputedTrajectory<'_>,
    rows: &SpaceRows,
) -> Vec<ForceArrow> {
    let column = |joint: usize, axis: usize| {
        let wanted = Component::Force(Axes::Ground, axis);
        let mut all = rows.requested.iter();
        let k = all.position(|r| r.joint == JointId(joint) && r.component == wanted)?;
        computed.results.written_index(Quantity::Reaction(k))
    };
    let joints = scene.mechanism.joints.iter().enumerate();
    let arrow = |(j, joint): (usize, &dwell_geometry::space::Joint)| {
        let columns = (0..3).map(|axis| column(j, axis));
        let columns = columns.collect::<Option<Vec<usize>>>()?;
        let [one, two] = joint
            .bodies
            .map(|b| scene.mechanism.bodies[b.0].name.as_str());
        let title = format!("{}: force of {one} on {two}", joint.name);
        let at = anchor(joint.side_body(1), joint.sides[1].point);
        let direction = Direction::Components { columns };
        Some(force_arrow("Reactions", &joint.name, title, at, direction))
    };
    joints.filter_map(arrow).collect()
}
