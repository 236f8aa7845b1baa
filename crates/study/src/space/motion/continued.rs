//! A motion in space through as many coordinates as it takes.

use super::change_points::Barrier;
use super::charts::{Motion, NextChart};
use super::problem::SpaceMotionProblem;
use crate::free_motion::compute::{MotionProblem as _, end_where_impossible};
use dwell_dynamics::{
    DynamicsError, OdeState, Options, Solution, Statistics, solve, solve_further,
};

impl SpaceMotionProblem<'_> {
    /// The motion in as many coordinates as it takes.
    pub(super) fn through_charts(
        &self,
        options: &Options,
        end: f64,
    ) -> Result<Motion, DynamicsError> {
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
}
