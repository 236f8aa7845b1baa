//! A free motion in space by a method, or to an accuracy, with its estimated error.

use super::change_points::Barrier;
use super::charts::{Motion, NextChart};
use super::problem::SpaceMotionProblem;
use crate::estimate;
use crate::explain::StudyError;
use crate::free_motion::compute::{
    ChartedProblem as _, Compared, Difference, MotionProblem as _, MotionSolver, TriedMotion,
    end_where_impossible, error_of, find_motion, pair_by_time, reactions_at,
};
use crate::ranges::extent;
use crate::space::prepared::reaction_unit;
use dwell_dynamics::{
    DynamicsError, Method, ObservedMachine, OdeState, Options, Orbit, Solution, Statistics, solve,
    solve_further, solve_orbit,
};
use dwell_findings::Record;
use rayon::join;

/// How much earlier than a motion that failed its second run ends, as a part of it.
const BEFORE_END: f64 = 1e-6;

/// A computed motion.
pub(crate) struct Run {
    pub(in crate::space) motion: Motion,
    /// The second run, whose difference shows the errors.
    pub(super) second: Option<Motion>,
    /// The orbit that it was computed from, by quadrature, and the part of all times by which it may be late.
    pub(super) orbit: Option<(Orbit, f64)>,
    pub(super) method_text: String,
    /// The options of the rows between its steps.
    pub(super) options: Options,
    /// The accuracy that was required.
    pub(in crate::space) accuracy: Option<f64>,
    /// The error of a motion that was integrated to an accuracy, and what is said of that.
    pub(super) found: Option<(Difference, (String, Record))>,
}

/// By free coordinate: its error, and whether that is no result; then the errors of the energy balance and of the kinetic energy as parts of the largest.
#[derive(Default)]
pub(super) struct Errors {
    pub(super) coordinates: Vec<f64>,
    pub(super) energy: f64,
    /// The same of the kinetic energy itself, which differs in phase, too.
    pub(super) kinetic: f64,
    /// The largest, of angles in rad, of lengths relative to their change.
    pub(super) largest: f64,
}

impl SpaceMotionProblem<'_> {
    /// The motion by a solver over a duration, s.
    pub(super) fn run(&self, solver: &MotionSolver, duration: f64) -> Result<Run, StudyError> {
        let interval = solver.sample_interval(duration)?;
        match solver {
            MotionSolver::Settings(settings) => {
                let options = Options {
                    sample_interval: Some(interval),
                    ..settings.options()
                };
                self.integrated(duration, options, settings.describe())
            }
            MotionSolver::Accuracy { accuracy, .. } => {
                if let Some(run) = self.by_quadrature(*accuracy, duration, interval) {
                    return Ok(run);
                }
                self.to_accuracy(*accuracy, duration, interval)
            }
        }
    }

    /// The motion by one method, with a second run at a tenth of the tolerance.
    fn integrated(
        &self,
        duration: f64,
        options: Options,
        method_text: String,
    ) -> Result<Run, StudyError> {
        let finer = estimate::comparison_options(&options);
        let (first, second) = join(
            || self.through_charts(&options, duration),
            || self.through_charts(&finer, duration),
        );
        let motion = first.map_err(|e| self.explain(&e))?;
        let (failed, end) = (motion.failure.is_some(), motion.end_time());
        let second = match (failed, end > 0.0) {
            // Up to a little before: at a barrier the second run may be there first.
            (true, true) => self.through_charts(&finer, end * (1.0 - BEFORE_END)).ok(),
            (true, false) => None,
            (false, _) => second.ok(),
        };
        Ok(Run {
            motion,
            second: second.filter(|second| second.failure.is_none()),
            orbit: None,
            method_text,
            options,
            accuracy: None,
            found: None,
        })
    }

    /// The motion in as many coordinates as it takes.
    fn through_charts(&self, options: &Options, end: f64) -> Result<Motion, DynamicsError> {
        let mut motion = Motion::default();
        let error = self.follow(&mut motion, options, end)?;
        let statistics = motion.segments.iter().map(|(_, part)| part.statistics);
        motion.statistics = statistics.fold(Statistics::default(), Statistics::plus);
        if let Some((_, last)) = motion.segments.last_mut() {
            if error.is_some() {
                last.error = error;
                last.sample_end();
            }
            motion.failure.clone_from(&last.error);
        }
        Ok(motion)
    }

    /// Adds the segments of a motion; why the next one cannot begin, if so.
    fn follow(
        &self,
        motion: &mut Motion,
        options: &Options,
        end: f64,
    ) -> Result<Option<DynamicsError>, DynamicsError> {
        let mut may_change = self.may_change_coordinate();
        let (mut chart, mut at) = (0, self.initial_state());
        let (mut options, max_steps) = (*options, options.max_steps);
        loop {
            let problem = self.in_chart(motion, chart);
            let is_first = motion.segments.is_empty();
            let part = problem.part((&at, end), &options, (is_first, may_change));
            let (mut solution, barrier) = match part {
                // Nothing is left of the duration after a change.
                Err(DynamicsError::DurationTooShort) if !is_first => return Ok(None),
                Err(error) if is_first => return Err(error),
                Err(error) => return Ok(Some(error)),
                Ok(found) => found,
            };
            options.max_steps = options.max_steps.saturating_sub(solution.statistics.steps);
            if let Some(
                DynamicsError::MaxStepsReached { max_steps: of, .. }
                | DynamicsError::TooSlow { max_steps: of, .. },
            ) = &mut solution.error
            {
                // Those of the whole motion.
                *of = max_steps;
            }
            let (last, turns_back) = (
                solution.steps.last().cloned(),
                barrier.as_ref().is_some_and(|barrier| barrier.turns_back),
            );
            let has_moved = last.as_ref().is_some_and(|last| is_first || last.t > at.t);
            let last = last.filter(|_| turns_back && may_change && has_moved);
            let next = last
                .as_ref()
                .and_then(|last| problem.next_chart(self, &motion.charts, last));
            let goes_on = next.is_some() || last.is_some();
            if let (Some(barrier), false) = (barrier, goes_on) {
                solution.error = Some(barrier.error);
            }
            if !goes_on {
                solution.sample_end();
            }
            motion.segments.push((chart, solution));
            match (next, last) {
                (Some(NextChart::Known(number, state)), _) => (chart, at) = (number, state),
                (Some(NextChart::New(new, state)), _) => {
                    motion.charts.push(*new);
                    (chart, at) = (motion.charts.len(), state);
                }
                // No other coordinate takes over: it goes on as near to the limit position as it can.
                (None, Some(last)) => (at, may_change) = (last, false),
                (None, None) => return Ok(None),
            }
        }
    }

    /// A part of the motion in this coordinate, and the barrier that it comes to.
    fn part(
        &self,
        (at, end): (&OdeState, f64),
        options: &Options,
        (is_first, may_change): (bool, bool),
    ) -> Result<(Solution, Option<Barrier>), DynamicsError> {
        let mut barriers = self.barriers(at, may_change);
        if let (true, Some(k)) = (may_change, barriers.iter().position(|b| b.is_beyond)) {
            let solution = Solution {
                steps: vec![at.clone()],
                samples: is_first.then(|| at.clone()).into_iter().collect(),
                ..Solution::default()
            };
            return Ok((solution, Some(barriers.swap_remove(k))));
        }
        barriers.retain(|barrier| !barrier.is_beyond);
        let of_barriers = barriers.iter().map(|barrier| barrier.event);
        let events: Vec<_> = self.events.iter().copied().chain(of_barriers).collect();
        let (machine, model) = (&self.machine, &self.event_model);
        let mut solution = match is_first {
            true => solve(machine, model, at, end, options, &events)?,
            false => solve_further(machine, model, at, end, options, &events)?,
        };
        if self.spec.laws.len() > 1 {
            end_where_impossible(machine, &mut solution);
        }
        let reached = self.barrier_of(&mut solution, barriers);
        Ok((solution, reached))
    }

    /// The motion by quadrature, if it is conservative and periodic.
    fn by_quadrature(&self, accuracy: f64, duration: f64, interval: f64) -> Option<Run> {
        if self.machine.free().len() != self.spec.laws.len() {
            return None;
        }
        let orbit = self.orbit(1.0).ok()?;
        let late = estimate::of_period(&orbit, |factor| self.orbit(factor)).ok()?;
        let options = Options {
            sample_interval: Some(interval),
            rtol: accuracy,
            // What an event must pass its value by is relative to the motion, whatever its size.
            atol: f64::MIN_POSITIVE,
            ..Options::new(Method::Dop853, 1e-13)
        };
        let observed = ObservedMachine::new(&self.machine, &self.event_model);
        let solution = solve_orbit(&orbit, observed, duration, &options, &self.events);
        let mut solution = solution.ok().filter(|s| s.error.is_none())?;
        solution.sample_end();
        let late = late / orbit.period;
        // The same, as much later.
        let mut second = solution.clone();
        for sample in &mut second.samples {
            let at = orbit.state_at(sample.t * (1.0 + late));
            sample.y[0] = at.q;
            sample.y[1] = at.q_dot;
        }
        let points = orbit.points;
        Some(Run {
            motion: Motion::single_segment(solution),
            second: Some(Motion::single_segment(second)),
            orbit: Some((orbit, late)),
            method_text: format!(
                "quadrature (conservative, periodic motion), {points} quadrature points"
            ),
            options,
            accuracy: Some(accuracy),
            found: None,
        })
    }

    /// The motion by the cheapest method whose estimated error keeps an accuracy.
    fn to_accuracy(&self, accuracy: f64, duration: f64, interval: f64) -> Result<Run, StudyError> {
        let by_method = find_motion(self, accuracy, duration, interval)?;
        let (remarks, found) = (by_method.remarks(accuracy), by_method.found);
        Ok(Run {
            options: Options {
                sample_interval: Some(interval),
                ..Options::new(by_method.method, found.tolerance)
            },
            motion: found.motion,
            second: Some(found.finer),
            orbit: None,
            method_text: by_method.method_text,
            accuracy: Some(accuracy),
            found: Some((found.difference, remarks)),
        })
    }

    /// The largest estimated error of a motion, in the sense of [`MotionSolver::Accuracy`]; none where it has no second run.
    pub(in crate::space) fn largest_error(&self, run: &Run) -> Option<f64> {
        match &run.found {
            Some((difference, _)) => Some(difference.largest()),
            None => self.errors(run).map(|errors| errors.largest),
        }
    }

    /// The errors of a motion from its second run; none where it has none.
    pub(super) fn errors(&self, run: &Run) -> Option<Errors> {
        let samples = self.samples(&run.motion).ok()?;
        let others = self.samples(run.second.as_ref()?).ok()?;
        let pairs = pair_by_time(&samples, &others);
        let mut errors = Errors::default();
        for &i in self.machine.free() {
            let [from, to] = extent(pairs.iter().map(|(a, _)| a.coordinate(i)));
            let rounding =
                4.0 * f64::EPSILON * from.abs().max(to.abs()) + f64::EPSILON * (to - from);
            let error = error_of(&pairs, |s| s.coordinate(i), rounding);
            let relative = match self.is_angle(i) {
                true => error,
                false => error / (to - from).max(f64::MIN_POSITIVE),
            };
            errors.largest = errors.largest.max(relative);
            errors.coordinates.push(error);
        }
        let kinetic = samples
            .iter()
            .map(|s| s.extra_values[0])
            .fold(0.0, f64::max);
        if kinetic > 0.0 {
            let balance = self.balance_index();
            let drift = error_of(&pairs, |s| s.extra_values[balance], 0.0).max(
                samples
                    .iter()
                    .map(|s| s.extra_values[balance].abs())
                    .fold(0.0, f64::max),
            );
            errors.energy = drift / kinetic + 4.0 * f64::EPSILON;
            errors.largest = errors.largest.max(errors.energy);
            let difference = error_of(&pairs, |s| s.extra_values[0], 0.0) / kinetic;
            errors.kinetic = errors.energy.max(difference);
        }
        Some(errors)
    }
}

impl TriedMotion for SpaceMotionProblem<'_> {
    type Motion = Motion;

    fn by_method(&self, duration: f64, options: &Options) -> Result<Motion, StudyError> {
        let motion = self.through_charts(options, duration);
        motion.map_err(|error| self.explain(&error))
    }

    /// Of the reactions, those that are requested and that the loads determine.
    fn difference_of(&self, motions: [&Motion; 2]) -> Result<Difference, StudyError> {
        let explain = |error: DynamicsError| self.explain(&error);
        let [one, two] = motions.map(|motion| self.samples(motion));
        let (one, two) = (one.map_err(explain)?, two.map_err(explain)?);
        let requested = &self.rows.requested;
        let compared = Compared {
            samples: [&one, &two],
            ends: motions.map(Motion::end_time),
            size: self.rows.model.plan().size(),
            units: requested.iter().map(reaction_unit).collect(),
        };
        let difference = compared.difference(self, &|which, sample| {
            let problem = self.in_chart(motions[which], sample.chart);
            let mut all = reactions_at(&problem.rows.model, sample)?;
            all.truncate(requested.len());
            Ok(all)
        });
        difference.map_err(explain)
    }

    fn statistics(motion: &Motion) -> Statistics {
        motion.statistics
    }

    fn reached_end(motion: &Motion) -> bool {
        motion.failure.is_none()
    }
}
