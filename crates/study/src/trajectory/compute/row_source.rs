//! The rows along a trajectory.

use crate::explain::StudyError;
use crate::progress::Progress;
use crate::trajectory::compute::{
    Analysis, Column, ComputedTrajectory, EarlyStop, MotionBetweenRows, Quantity, RoundingError,
    RowEvaluator as _, RowScene, RowStorage, Trajectory, TrajectoryResults, TrajectorySample,
    all_columns, check_variables,
};
use dwell_kinetostatics::MachineModel as _;

/// Analyses a scene along its prescribed motion, its sweep, or the range of its only actuator, with the rows in memory, or, by
/// `storage`, in a file.
///
/// # Errors
/// [`StudyError`] if the first position cannot be reached.
pub(crate) fn compute_trajectory_in<'a, S: RowScene>(
    storage: RowStorage,
    scene: &'a S,
    analysis: Analysis,
    points: Option<usize>,
    progress: Progress<'_>,
) -> Result<ComputedTrajectory<'a>, StudyError> {
    let rows = scene.rows()?;
    let source = RowSource {
        storage,
        ..RowSource::new(scene, &rows)
    };
    source.analysed(analysis, points, progress)
}

/// The scene and model of which rows are evaluated.
pub struct RowSource<'s, 'r, S: RowScene> {
    pub(crate) scene: &'s S,
    pub(crate) rows: &'r S::Rows,
    /// For a motion in other coordinates than the scene's, by chart: the scene and its model there.
    pub(crate) charts: Vec<(&'r S, &'r S::Rows)>,
    pub(crate) storage: RowStorage,
    /// The columns that are computed if requested.
    pub(crate) is_wanted: fn(Quantity) -> bool,
}

impl<'s: 'r, 'r, S: RowScene> RowSource<'s, 'r, S> {
    /// All columns of a scene in its own coordinates.
    pub(crate) fn new(scene: &'s S, rows: &'r S::Rows) -> Self {
        Self {
            scene,
            rows,
            charts: Vec::new(),
            storage: RowStorage::Whole,
            is_wanted: |_| true,
        }
    }

    /// The rows along the scene's own trajectory.
    ///
    /// # Errors
    /// [`StudyError`] if the first position cannot be reached.
    pub(crate) fn analysed(
        &self,
        analysis: Analysis,
        points: Option<usize>,
        progress: Progress<'_>,
    ) -> Result<ComputedTrajectory<'s>, StudyError> {
        let (scene, model) = (self.scene, S::model_of(self.rows));
        check_variables(scene, self.rows)?;
        let trajectory = Trajectory::new(&scene.followed(model), analysis, points)?;
        let computed = self.along(trajectory, None, progress)?;
        Ok(ComputedTrajectory {
            notes: scene.assembly_note(model),
            ..computed
        })
    }

    /// The rows along a trajectory; for a free motion, also with the positions known between them.
    ///
    /// # Errors
    /// [`StudyError`] if the first position cannot be reached.
    pub(crate) fn along<'a>(
        &self,
        trajectory: Trajectory<'a>,
        between: Option<MotionBetweenRows<'_>>,
        progress: Progress<'_>,
    ) -> Result<ComputedTrajectory<'a>, StudyError> {
        let (scene, model) = (self.scene, S::model_of(self.rows));
        let rows = &*scene.pruned(self.rows);
        trajectory.check_laws(&scene.followed(model))?;
        let mut results = self.results(rows, &trajectory);
        results.keep_rows_in(self.storage, trajectory.points)?;
        let mut evaluators = self.evaluators(rows, &trajectory, &results.columns)?;
        let (analysis, points) = (trajectory.analysis, trajectory.points);
        let mut rounding = RoundingError::new(&evaluators[0], analysis, points);
        let early_stop = self.evaluate(&trajectory, &mut evaluators, |k, t, evaluator, sample| {
            results.add_position(k, evaluator, sample);
            if let Some(rounding) = &mut rounding {
                rounding.add_position(k, t, sample, evaluator);
            }
            trajectory.report(k, progress);
        });
        let early_stop = early_stop.map(|stop| scene.explain_stop(model, stop));
        results.rounding_error = rounding.map(|error| error.max_relative());
        let early_stop =
            results.finish(&trajectory, early_stop, model.size(), &evaluators, between)?;
        Ok(ComputedTrajectory {
            table: results.table(),
            early_stop,
            notes: String::new(),
            trajectory,
            results,
        })
    }

    /// The rows of a second computation of a motion, up to where it can be evaluated, and nothing else. `None` if a column cannot be
    /// evaluated.
    pub(super) fn only_rows(&self, trajectory: &Trajectory<'_>) -> Option<Vec<Vec<f64>>> {
        let rows = &*self.scene.pruned(self.rows);
        let mut results = self.results(rows, trajectory);
        let mut evaluators = self.evaluators(rows, trajectory, &results.columns).ok()?;
        for evaluator in &mut evaluators {
            evaluator.limit_to(results.columns.iter().map(|column| column.quantity));
        }
        let mut all = Vec::new();
        // Where it ends early the errors of the other rows are known.
        let _ = self.evaluate(trajectory, &mut evaluators, |_, _, evaluator, sample| {
            all.push(results.next_row(evaluator, sample));
        });
        Some(all)
    }

    /// Evaluates one position after another, each by the evaluator of its chart. Where and why it ends early, if it does.
    fn evaluate<'t>(
        &self,
        trajectory: &'t Trajectory<'_>,
        evaluators: &mut [S::Evaluator<'_>],
        mut visit: impl FnMut(usize, f64, &S::Evaluator<'_>, &TrajectorySample),
    ) -> Option<EarlyStop<'t>> {
        let mut last = None;
        trajectory.follow::<S>(S::model_of(self.rows), |k, sample| {
            if let Some(before) = last.replace(sample.chart)
                && before != sample.chart
            {
                let before = evaluators[before].clone();
                evaluators[sample.chart].continue_from(&before);
            }
            let (evaluator, t) = (&mut evaluators[sample.chart], trajectory.load_time(sample));
            evaluator.evaluate(sample, t)?;
            visit(k, t, evaluator, sample);
            Ok(())
        })
    }

    /// The empty results of a model: the requested columns of an analysis along a trajectory.
    fn results(&self, rows: &S::Rows, trajectory: &Trajectory<'_>) -> TrajectoryResults {
        let (scene, analysis) = (self.scene, trajectory.analysis);
        let (modelled, requests) = (S::modelled(rows), scene.requests());
        let is_modelled = |column: &Column| {
            let bodies = scene.bodies_of(rows, column.quantity);
            let mut modelled = bodies.iter().map(|b| modelled.get(b.0));
            modelled.all(|is_modelled| is_modelled.is_none_or(|is| *is))
        };
        // In a free motion only prescribed actuators exert a force.
        let free_motion = trajectory.free_motion();
        let is_exerted = |quantity: Quantity| match (quantity, free_motion) {
            (Quantity::ActuatorForce(i), Some(motion)) => motion.prescribed[i],
            _ => true,
        };
        let extra = free_motion.map(|motion| motion.extra_columns.clone());
        let mut all = all_columns(scene, rows, trajectory.is_timed());
        all.extend(extra.unwrap_or_default());
        all.retain(|column| {
            let is_had = (self.is_wanted)(column.quantity) && is_exerted(column.quantity);
            let is_asked = !column.is_optional() || requests.name(column);
            is_had && is_asked && column.is_computed_by(analysis) && is_modelled(column)
        });
        TrajectoryResults::new(scene, rows, all, analysis)
    }

    /// The evaluators of some columns along a trajectory, by chart.
    fn evaluators<'e>(
        &'e self,
        rows: &'e S::Rows,
        trajectory: &Trajectory<'_>,
        columns: &[Column],
    ) -> Result<Vec<S::Evaluator<'e>>, StudyError> {
        let of = |(scene, rows): (&'e S, &'e S::Rows)| {
            scene.evaluator(self.rows, rows, trajectory.analysis, columns)
        };
        self.charts_or(rows).into_iter().map(of).collect()
    }

    /// By chart: the scene and its model; in the scene's own coordinates, these with a model.
    pub(crate) fn charts_or<'e>(&'e self, own: &'e S::Rows) -> Vec<(&'e S, &'e S::Rows)> {
        match &self.charts[..] {
            [] => vec![(self.scene, own)],
            charts => charts.to_vec(),
        }
    }
}
