//! The results along a trajectory as one table.

use crate::explain::StudyError;
use crate::models::loaded_model;
use crate::trajectory::compute::{
    Analysis, Trajectory, TrajectoryResults, check_variables, evaluate_trajectory, selected_columns,
};
use dwell_findings::{Column, Table};
use dwell_kinetostatics::Model;
use dwell_scene::Scene;

/// The requested columns along a trajectory.
#[derive(Debug)]
pub struct TrajectoryTable {
    /// A row for each position.
    pub table: Table,
    /// Why the trajectory ended early, if it did.
    pub early_stop: Option<StudyError>,
}

impl TrajectoryTable {
    pub(crate) fn evaluate(
        scene: &Scene,
        model: &Model,
        trajectory: &Trajectory<'_>,
        analysis: Analysis,
    ) -> Result<Self, StudyError> {
        let results = evaluate_trajectory(scene, model, trajectory, analysis, &|_| {})?;
        let stop = results.early_stop.as_ref();
        Ok(Self {
            early_stop: stop.map(|stop| stop.explain(scene, model.plan(), trajectory)),
            table: results.table(&selected_columns(scene, &results.columns)),
        })
    }
}

impl TrajectoryResults {
    /// The selected columns as a table.
    pub(crate) fn table(&self, selected: &[usize]) -> Table {
        let column = |&k: &usize| Column::new(self.columns[k].name.clone(), self.columns[k].unit);
        let row = |row: &Vec<f64>| selected.iter().map(|&k| row[k]).collect();
        Table {
            columns: selected.iter().map(column).collect(),
            rows: self.rows.iter().map(row).collect(),
        }
    }
}

/// Computes kinematics, statics or kinetostatics of a scene along its prescribed motion, its sweep, or the range of its
/// only actuator, at `points` positions (two or more) if given.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled, the scene defines no actuator coordinates, a requested column
/// does not exist, or the first position cannot be reached.
pub fn compute_trajectory(
    scene: &Scene,
    analysis: Analysis,
    points: Option<usize>,
) -> Result<TrajectoryTable, StudyError> {
    let model = loaded_model(scene)?;
    check_variables(scene, &model)?;
    let trajectory = Trajectory::new(scene, model.plan(), analysis, points)?;
    TrajectoryTable::evaluate(scene, &model, &trajectory, analysis)
}
