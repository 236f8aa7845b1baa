//! Evaluation along a trajectory: the table, and the data of each position for sections and drawings.

use crate::bodies::BodyPose;
use crate::estimate::{error_scale, relative};
use crate::explain::StudyError;
use crate::trajectory::compute::{
    Analysis, BetweenRows, Column, Extrema, ExtremaSearch, LongRows, Quantity, RequestedColumns,
    RowEvaluator, RowScene, RowStorage, Sampler, SectionedLink, Trajectory, TrajectorySample,
    UnitReferences, not_stored,
};
use dwell_findings::{self as findings, Table};
use std::f64::consts::TAU;
use std::io;

/// The values at the positions of a trajectory.
#[derive(Default)]
pub struct TrajectoryResults {
    /// The columns of the analysis that the scene requests, and those that its pictures need.
    pub(crate) columns: Vec<Column>,
    /// The indices of the columns in the tables.
    pub(crate) written: Vec<usize>,
    /// Whether the scene requests less than everything.
    #[cfg_attr(not(feature = "output"), expect(dead_code, reason = "for summaries"))]
    pub(crate) is_limited: bool,
    /// The reference sizes of all columns of the analysis.
    pub(crate) references: UnitReferences,
    /// By position: a value for each column. Of a long trajectory only of some positions.
    pub(crate) rows: Vec<Vec<f64>>,
    /// All rows of a long trajectory.
    pub(crate) long_rows: Option<LongRows>,
    /// By column, for those that unwrap: the last angle, its rate and its time.
    last_angles: Vec<Option<[f64; 3]>>,
    /// By position: the residual of the power balance, and the sum of its absolute terms, W.
    power_terms: Vec<[f64; 2]>,
    /// By position and body; of the positions of `rows`.
    pub body_poses: Vec<Vec<BodyPose>>,
    /// The links whose internal forces are requested.
    pub sectioned_links: Vec<SectionedLink>,
    /// The largest residual of the power balance, relative to the sum of its absolute terms.
    pub power_residual: f64,
    /// The estimated rounding error of actuator forces and reactions, or of positions, velocities and accelerations, relative to the largest of their unit.
    pub rounding_error: Option<f64>,
    /// The statically indeterminate reactions, by name: no column has them.
    pub indeterminate: Vec<String>,
    /// By body: whether it is modelled; without `variables` all bodies are.
    pub modelled: Vec<bool>,
    /// By column: whether it is zero in every row within rounding.
    pub(crate) is_rounding: Vec<bool>,
    /// The columns among them whose rows do not look like rounding.
    pub(crate) noted_zeros: Vec<String>,
    /// The extrema of the columns.
    pub(crate) extrema: Extrema,
    /// By column: the estimated error of its values, in its unit; empty if unknown.
    pub(crate) errors: Vec<f64>,
}

impl TrajectoryResults {
    /// Results without rows, for those of all columns of an analysis that the scene requests.
    pub(super) fn new<S: RowScene>(
        scene: &S,
        rows: &S::Rows,
        all: Vec<Column>,
        analysis: Analysis,
    ) -> Self {
        let requested = RequestedColumns::new(scene, rows, analysis);
        let is_kept = |c: &&Column| requested.are_with(c) || requested.draw(c);
        let columns: Vec<Column> = all.iter().filter(is_kept).cloned().collect();
        let written = 0..columns.len();
        let written = written.filter(|&k| requested.are_with(&columns[k]));
        let has_sections = analysis != Analysis::Kinematics;
        let sections = has_sections.then(|| scene.sectioned_links());
        Self {
            sectioned_links: sections.unwrap_or_default(),
            indeterminate: scene.open_reactions(rows),
            modelled: S::modelled(rows),
            last_angles: vec![None; columns.len()],
            written: written.collect(),
            is_limited: requested.is_limited,
            references: UnitReferences::new(all, &columns),
            columns,
            ..Self::default()
        }
    }

    /// The requested columns as a table.
    pub(crate) fn table(&self) -> Table {
        let columns = self.written.iter().map(|&k| &self.columns[k]);
        let columns = columns.map(|c| findings::Column::new(&c.name, c.unit));
        let row = |row: &Vec<f64>| self.written.iter().map(|&k| row[k]).collect();
        Table {
            columns: columns.collect(),
            rows: match &self.long_rows {
                Some(_) => Vec::new(),
                None => self.rows.iter().map(row).collect(),
            },
        }
    }

    /// Prepares the memory for the rows of this number of positions.
    pub(super) fn keep_rows_in(
        &mut self,
        storage: RowStorage,
        points: usize,
    ) -> Result<(), StudyError> {
        if storage == RowStorage::Bounded {
            self.long_rows = LongRows::new(&self.columns, points)?;
        }
        Ok(())
    }

    /// Ends the rows: the last one is always in memory.
    fn finish_rows(&mut self) -> Result<(), StudyError> {
        if let Some(long) = &mut self.long_rows
            && let Some((row, poses)) = long.finish()?
        {
            self.rows.push(row);
            self.body_poses.push(poses);
        }
        Ok(())
    }

    /// Number of positions that were evaluated.
    pub(crate) fn len(&self) -> usize {
        let long = self.long_rows.as_ref();
        long.map_or(self.rows.len(), |long| long.table.len())
    }

    /// All values of a column.
    pub(crate) fn values(&self, column: usize) -> io::Result<Vec<f64>> {
        match &self.long_rows {
            Some(long) => long.table.column(column),
            None => {
                let mut values = Vec::with_capacity(self.rows.len());
                for row in &self.rows {
                    values.push(row[column]);
                }
                Ok(values)
            }
        }
    }

    /// The value of a column at the `k`th position; NaN if it cannot be read.
    #[cfg(feature = "output")]
    pub(crate) fn value_at(&self, k: usize, column: usize) -> f64 {
        match &self.long_rows {
            Some(long) => long.table.value(k, column).unwrap_or(f64::NAN),
            None => self.rows.get(k).map_or(f64::NAN, |row| row[column]),
        }
    }

    /// Adds the values at the `k`th position.
    pub(super) fn add_position(
        &mut self,
        k: usize,
        evaluator: &impl RowEvaluator,
        sample: &TrajectorySample,
    ) {
        let links = self.sectioned_links.iter_mut();
        for (link, forces) in links.zip(evaluator.link_forces()) {
            link.add_position(k, forces.as_ref());
        }
        let row = self.next_row(evaluator, sample);
        self.references
            .add_row(&row, &|quantity| evaluator.value(quantity, sample));
        let poses = evaluator.body_poses();
        let kept = match &mut self.long_rows {
            Some(long) => long.add(row, poses),
            None => Some((row, poses)),
        };
        if let Some((row, poses)) = kept {
            self.rows.push(row);
            self.body_poses.push(poses);
        }
        let [.., residual, _] = evaluator.power();
        self.power_terms
            .push([residual.abs(), evaluator.power_scale()]);
    }

    /// The row of the position that was evaluated last.
    pub(super) fn next_row(
        &mut self,
        evaluator: &impl RowEvaluator,
        sample: &TrajectorySample,
    ) -> Vec<f64> {
        let mut row = Vec::with_capacity(self.columns.len());
        for (column, last) in self.columns.iter().zip(&mut self.last_angles) {
            let value = evaluator.value(column.quantity, sample);
            row.push(if column.unwraps {
                let speed = evaluator.angular_velocity(column.quantity);
                unwrap_angle(last, value, speed, sample.t)
            } else {
                value
            });
        }
        row
    }
}

/// Unwraps an angle: adds the revolutions that bring it nearest to the one extrapolated by the velocities.
pub(super) fn unwrap_angle(last: &mut Option<[f64; 3]>, value: f64, speed: f64, t: f64) -> f64 {
    let unwrapped = last.map_or(value, |[previous, previous_speed, previous_time]| {
        let expected = previous + 0.5 * (previous_speed + speed) * (t - previous_time);
        value + TAU * ((expected - value) / TAU).round()
    });
    *last = Some([unwrapped, speed, t]);
    unwrapped
}

/// A free motion between its rows: positions at other times (s), and a sampler at any time for each thread.
pub(crate) struct MotionBetweenRows<'s> {
    pub(crate) further: Vec<(f64, TrajectorySample)>,
    pub(crate) sampler: &'s (dyn Fn() -> Sampler<'s> + Sync),
}

impl TrajectoryResults {
    /// Finds the columns that are zero within rounding, in a mechanism of this size (m), and the residual of the power
    /// balance.
    fn find_rounding(&mut self, size: f64) {
        let scales = self.references.scales(size);
        self.is_rounding = self.references.is_rounding(&scales, self.columns.len());
        self.noted_zeros = self.references.noted_zeros(&scales, &self.is_rounding);
        let power = self.power_terms.iter().map(|[_, scale]| *scale);
        let power = power.fold(scales.of("W"), f64::max);
        let terms = self.power_terms.iter();
        let residuals = terms.map(|&[sum, scale]| relative(sum, error_scale(scale, power)));
        self.power_residual = residuals.fold(0.0, f64::max);
    }

    /// Ends the rows of a trajectory that ended early, and finds extrema, rounding and errors of their columns, by the evaluators of
    /// a mechanism of this size, m.
    ///
    /// # Errors
    /// [`StudyError`] if there is no row, or the rows cannot be stored.
    pub(super) fn finish(
        &mut self,
        trajectory: &Trajectory<'_>,
        early_stop: Option<StudyError>,
        size: f64,
        evaluators: &[impl RowEvaluator],
        between: Option<MotionBetweenRows<'_>>,
    ) -> Result<Option<StudyError>, StudyError> {
        match early_stop {
            Some(error) if self.len() == 0 => return Err(error),
            _ => self.finish_rows()?,
        }
        self.find_extrema(size, trajectory, evaluators, between)?;
        Ok(early_stop)
    }

    /// The index of the column of a quantity.
    pub(crate) fn column_index(&self, quantity: Quantity) -> Option<usize> {
        self.columns.iter().position(|c| c.quantity == quantity)
    }

    /// The index of the column of a quantity, among those in the tables.
    pub(crate) fn written_index(&self, quantity: Quantity) -> Option<usize> {
        let mut written = self.written.iter();
        written.position(|&k| self.columns[k].quantity == quantity)
    }

    /// The index of the column of the abscissa: time, or the swept coordinate.
    pub(crate) fn abscissa(&self, trajectory: &Trajectory<'_>) -> usize {
        let swept = trajectory.swept_actuator();
        let quantity = swept.map_or(Quantity::Time, |a| Quantity::ActuatorCoordinate(a, 0));
        self.column_index(quantity).unwrap_or(0)
    }

    /// Finds the extrema of the columns in the tables that are not zero within rounding, in a mechanism of this size (m).
    fn find_extrema(
        &mut self,
        size: f64,
        trajectory: &Trajectory<'_>,
        evaluators: &[impl RowEvaluator],
        motion: Option<MotionBetweenRows<'_>>,
    ) -> Result<(), StudyError> {
        self.find_rounding(size);
        let written = self.written.iter().copied();
        let wanted: Vec<usize> = written.filter(|&k| !self.is_rounding[k]).collect();
        let search = ExtremaSearch {
            trajectory,
            columns: &self.columns,
            abscissa: self.abscissa(trajectory),
            values: &|k| self.values(k),
            evaluators,
        };
        let extrema = match (trajectory.free_motion(), motion) {
            (None, _) => {
                let fractions = (0..self.len()).map(|k| trajectory.fraction_at(k));
                let sampler = || -> Sampler<'_> { Box::new(|u, _| Some(trajectory.sample_at(u))) };
                let between = BetweenRows::new(fractions.collect(), Vec::new(), &sampler);
                search.between_rows(&wanted, &between)
            }
            (Some(of_rows), Some(MotionBetweenRows { further, sampler })) => {
                let times = of_rows.samples.iter().take(self.rows.len());
                let times = times.map(|s| s.t).collect();
                search.between_rows(&wanted, &BetweenRows::new(times, further, sampler))
            }
            (Some(_), None) => search.in_rows(),
        };
        self.extrema = extrema.map_err(|e| not_stored(&e))?;
        for (extrema, &is_rounding) in self.extrema.of_columns.iter_mut().zip(&self.is_rounding) {
            if let Some(extrema) = extrema.as_mut().filter(|_| is_rounding) {
                extrema.iter_mut().for_each(|extremum| extremum.value = 0.0);
            }
        }
        Ok(())
    }
}

/// An analysis along a trajectory, up to where it ended.
pub struct ComputedTrajectory<'a> {
    /// The coordinates that it followed.
    pub trajectory: Trajectory<'a>,
    /// The values at each position.
    pub results: TrajectoryResults,
    /// A row for each position: time, actuator coordinates and the requested columns. Without rows where a command keeps
    /// them in a temporary file.
    pub table: Table,
    /// Why the trajectory ended early, if it did.
    pub early_stop: Option<StudyError>,
    /// A line for each body that is far from its approximate angle.
    pub notes: String,
}

impl ComputedTrajectory<'_> {
    /// The time (s) of the last row of a free motion that the rows have ended early; `None` if they have not.
    pub(crate) fn end_of_rows(&self) -> Option<f64> {
        let motion = self.trajectory.free_motion()?;
        let last = self.results.len().checked_sub(1)?;
        self.early_stop.as_ref()?;
        motion.samples.get(last).map(|sample| sample.t)
    }
}
