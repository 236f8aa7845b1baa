//! The free motion of a mechanism without loads, with the requested reactions by R = a q̈ + b q̇².

use crate::error::StudyError;
use crate::motion_error::explain_motion;
use crate::prepare::Prepared;
use crate::simulate::Accuracy;
use dwell_dynamics::{DynamicsError, Options, Orbit, Run, State, Until, simulate as integrate};
use dwell_kinetostatics::Reduced;
use dwell_report::{Column, Table};
use dwell_scene::Length;

/// Samples of a motion's table: a thousand to a turn, or in all where there is no whole turn.
const SAMPLES: f64 = 1000.0;
/// Most samples of a table: what is longer than a hundred turns is sampled less densely.
const MOST_SAMPLES: f64 = 100_000.0;
/// A motion with everything that is tabulated of it.
#[derive(Debug, Clone)]
pub(crate) struct History {
    pub(crate) run: Run,
    /// Time of a turn, s, where it has one.
    pub(crate) period: Option<f64>,
    /// By sample: q̈ (rad/s²), energy (J), then the requested reactions.
    pub(crate) rows: Vec<Vec<f64>>,
}

impl History {
    /// Integrates the scene's motion.
    pub(crate) fn new(
        prepared: &Prepared<'_>,
        start: State,
        length: Length,
        accuracy: &Accuracy,
    ) -> Result<Self, StudyError> {
        let plan = prepared.model.model().plan();
        Self::integrate(prepared, start, length, accuracy)
            .map_err(|e| explain_motion(prepared.scene, plan, &e))
    }

    fn integrate(
        prepared: &Prepared<'_>,
        start: State,
        length: Length,
        accuracy: &Accuracy,
    ) -> Result<Self, DynamicsError> {
        let model = &prepared.model;
        let period = match Orbit::new(model, start) {
            Ok(turn) => Some(turn.period),
            // Without a period, the motion can still be followed for a given time.
            Err(
                DynamicsError::NoFullTurn { .. }
                | DynamicsError::AtRest
                | DynamicsError::NotResolved { .. },
            ) if matches!(length, Length::Duration(_)) => None,
            Err(e) => return Err(e),
        };
        let duration = match (length, period) {
            (Length::Periods(n), Some(period)) => n * period,
            (Length::Periods(n) | Length::Duration(n), _) => n,
        };
        let sampled = period.map_or(duration, |period| period.min(duration));
        let options = Options {
            relative: accuracy.relative,
            absolute: accuracy.absolute,
            every: Some((sampled / SAMPLES).max(duration / MOST_SAMPLES)),
            ..Options::new(accuracy.method, accuracy.relative)
        };
        let run = integrate(model, start, Until::Time(start.t + duration), &options)?;
        let mut work = model.work();
        let mut at = model.model().coefficients();
        let mut rows = Vec::with_capacity(run.samples.len());
        for state in &run.samples {
            model.coefficients(state.q, &mut work, &mut at)?;
            let square = state.q_dot * state.q_dot;
            let q_ddot = -at.half_dm * square / at.m;
            let mut row = vec![q_ddot, 0.5 * at.m * square];
            let reactions = at.a.iter().zip(&at.b);
            row.extend(reactions.map(|(a, b)| a * q_ddot + b * square));
            rows.push(row);
        }
        Ok(Self { run, period, rows })
    }

    /// The table: time, coordinate, speed, acceleration, energy, requested reactions.
    pub(crate) fn table(&self, prepared: &Prepared<'_>) -> Table {
        let q = prepared.coordinate();
        let mut columns = vec![
            Column::new("t", "s"),
            Column::new(q, "rad"),
            Column::new(format!("{q}_dot"), "rad/s"),
            Column::new(format!("{q}_ddot"), "rad/s2"),
            Column::new("energy", "J"),
        ];
        let reactions = prepared.reactions();
        columns.extend(reactions.into_iter().map(|(n, u)| Column::new(n, u)));
        let row = |(s, rest): (&State, &Vec<f64>)| {
            let mut row = vec![s.t, s.q, s.q_dot];
            row.extend(rest);
            row
        };
        Table {
            columns,
            rows: self.run.samples.iter().zip(&self.rows).map(row).collect(),
        }
    }
}
