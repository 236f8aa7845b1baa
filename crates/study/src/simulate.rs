//! `dwell simulate`: the free motion in time, with the requested reactions.

use crate::error::StudyError;
use crate::figures;
use crate::motion_error::explain_motion;
use crate::outcome::Outcome;
use crate::prepare::Prepared;
use crate::words::digits;
use dwell_dynamics::{
    DynamicsError, Method, Options, Orbit, Run, State, Until, simulate as integrate,
};
use dwell_kinetostatics::Reduced;
use dwell_report::{Column, Table, png};
use dwell_scene::{Length, Place, Scene};

/// What the user trades for speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// The integrator.
    pub method: Method,
    /// Relative tolerance.
    pub relative: f64,
    /// Absolute tolerance, rad and rad/s.
    pub absolute: f64,
}

impl Default for Accuracy {
    fn default() -> Self {
        Self {
            method: Method::Bdf,
            relative: 1e-10,
            absolute: 1e-10,
        }
    }
}

/// Samples of a motion's table: a thousand to a turn, or in all where there is no whole turn.
const SAMPLES: f64 = 1000.0;
/// Most samples of a table: what is longer than a hundred turns is sampled less densely.
const MOST_SAMPLES: f64 = 100_000.0;
/// Largest change of the energy, of which there should be none, that is not remarked on.
const ENERGY_KEPT: f64 = 1e-3;

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

/// The free motion of a scene.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or it cannot be followed to its end.
pub fn simulate(scene: &Scene, accuracy: &Accuracy) -> Result<Outcome, StudyError> {
    let prepared = Prepared::for_angle(scene, true)?;
    let (Some(start), Some(motion)) = (prepared.start(), &scene.motion) else {
        return Err(scene
            .error(
                "the scene has no [motion] to simulate".to_owned(),
                Some("add [motion] with `speed`, and `periods` or `duration`".to_owned()),
                &[(Place::Whole, "there is no [motion] in this file".to_owned())],
            )
            .into());
    };
    let history = History::new(&prepared, start, motion.length, accuracy)?;
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-{rest}", scene.name);
    outcome
        .files
        .add(name("motion.csv"), history.table(&prepared).csv()?);
    let figure = figures::history(&prepared, &history, accuracy);
    outcome
        .files
        .add(name(&format!("{}.png", figure.name)), png(&figure)?);
    let energies = history.rows.iter().map(|r| r[1]);
    let (low, high) = energies.fold((f64::MAX, f64::MIN), |(a, b), e| (a.min(e), b.max(e)));
    let work = history.run.statistics;
    let end = history.run.steps.last().map_or(0.0, |s| s.t);
    outcome.summary = format!(
        "{}: {} from t = {} to {} s, {} at relative {:e} and absolute {:e}\n",
        scene.title,
        prepared.coordinate(),
        start.t,
        digits(end, 7),
        accuracy.method.name(),
        accuracy.relative,
        accuracy.absolute,
    );
    if let (Some(turn), Some(period)) = (history.run.turns.first(), history.period) {
        outcome.summary += &format!(
            "  first whole turn after {} s (by quadrature {} s)\n",
            digits(turn.t - start.t, 13),
            digits(period, 13),
        );
    }
    let change = (high - low) / high;
    outcome.summary += &if high > 0.0 {
        format!(
            "  energy {} J, kept to {change:.1e} of it\n",
            digits(high, 9)
        )
    } else {
        "  it stays at rest: nothing moves it\n".to_owned()
    };
    if change > ENERGY_KEPT {
        outcome.summary += "  the energy should stay: take a smaller --rtol\n";
    }
    outcome.summary += &format!(
        "  {} steps, {} rejected, {} evaluations, {} Jacobians, {} factorisations\n",
        work.steps, work.rejected, work.evaluations, work.jacobians, work.factorisations,
    );
    outcome.summary += &prepared.told_shared();
    Ok(outcome)
}
