//! The free motion of a mechanism without loads, with the requested reactions by R = a q̈ + b q̇².

use dwell_dynamics::{
    DynamicsError, Event, EventKind, Options, Orbit, ReducedCoordinate, ReducedOutputs,
    ReducedState, Solution, solve_reduced,
};
use dwell_report::{Column, Table};
use dwell_scene::MotionDuration;
use dwell_study::{PreparedScene, SolverSettings};

/// Samples of a motion's table: a thousand to a revolution, or in all where there is no whole revolution.
const SAMPLES: f64 = 1000.0;
/// Most samples of a table: a motion of more than a hundred revolutions is sampled less densely.
const MAX_SAMPLES: f64 = 100_000.0;
/// A motion with the values of its table.
#[derive(Debug, Clone)]
pub(crate) struct History {
    pub(crate) run: Solution,
    /// Time of a revolution, s, where it has one.
    pub(crate) period: Option<f64>,
    /// By sample: time (s), coordinate (rad), speed (rad/s), acceleration (rad/s²), energy (J), then the requested
    /// reactions.
    pub(crate) rows: Vec<Vec<f64>>,
}

impl History {
    /// Integrates the scene's motion.
    pub(crate) fn new(
        prepared: &PreparedScene<'_>,
        start: ReducedState,
        length: MotionDuration,
    ) -> Result<Self, DynamicsError> {
        let model = &prepared.model;
        let period = match Orbit::new(model, start) {
            Ok(orbit) => Some(orbit.period),
            // Without a period, the motion can still be integrated for a given time.
            Err(
                DynamicsError::NoFullRevolution { .. }
                | DynamicsError::AtRest
                | DynamicsError::NotResolved { .. },
            ) if matches!(length, MotionDuration::Seconds(_)) => None,
            Err(e) => return Err(e),
        };
        let duration = match (length, period) {
            (MotionDuration::Periods(n), Some(period)) => n * period,
            (MotionDuration::Periods(n) | MotionDuration::Seconds(n), _) => n,
        };
        let settings = SolverSettings::default();
        let sampled_time = period.map_or(duration, |period| period.min(duration));
        let options = Options {
            atol: settings.atol,
            sample_interval: Some((sampled_time / SAMPLES).max(duration / MAX_SAMPLES)),
            ..Options::new(settings.method, settings.rtol)
        };
        let revolution = Event {
            kind: EventKind::Revolution(ReducedCoordinate),
            terminal: None,
        };
        let end = start.t + duration;
        let run = solve_reduced(model, start, Some(end), &options, &[revolution])?.completed()?;
        let mut outputs = ReducedOutputs::new(model);
        let mut rows = Vec::with_capacity(run.samples.len());
        for state in run.samples.iter().map(ReducedState::from) {
            outputs.evaluate(state.q, state.q_dot)?;
            let energy = 0.5 * outputs.coefficients.m * (state.q_dot * state.q_dot);
            let mut row = vec![state.t, state.q, state.q_dot, outputs.q_ddot, energy];
            row.extend(&outputs.reactions);
            rows.push(row);
        }
        Ok(Self { run, period, rows })
    }

    /// The table of its rows.
    pub(crate) fn table(&self, prepared: &PreparedScene<'_>) -> Table {
        let q = prepared.coordinate_name();
        let mut columns = vec![
            Column::new("t", "s"),
            Column::new(q, "rad"),
            Column::new(format!("{q}.velocity"), "rad/s"),
            Column::new(format!("{q}.acceleration"), "rad/s2"),
            Column::new("energy", "J"),
        ];
        let reactions = prepared.reaction_units();
        columns.extend(reactions.into_iter().map(|(n, u)| Column::new(n, u)));
        Table {
            columns,
            rows: self.rows.clone(),
        }
    }
}
