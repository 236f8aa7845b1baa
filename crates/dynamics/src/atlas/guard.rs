//! Looks after the steps of a chart: whether its coordinate still tells how the mechanism moves.

use super::{Atlas, Chart, FOLDS, SAME};
use crate::driver::{Dense, Next};
use crate::error::DynamicsError;
use crate::follow::inside;
use crate::machine::MachineWork;
use crate::root;
use crate::system::Point;
use dwell_geometry::Motion;
use dwell_geometry::measure::BodyStates;

/// Times the ratio at which a chart is left that a good step may lead to.
const FAR: f64 = 2.0;
/// Parts of a step between which the speed's sign is looked at.
const LOOKS: usize = 4;

/// How a chart is left.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Turning {
    /// Its coordinate folds back.
    Folds(Ranks),
    /// It ends, for whatever reason.
    Ends(Ranks),
    /// It is not left: a step of so many seconds was too rough to tell a return from a fold.
    Rough(f64),
    /// It goes on behind a change point.
    Crosses { crossing: usize, above: bool },
}

/// How fast the candidates move, against the present coordinate.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ranks {
    /// Candidates with how many times as fast they are, the fastest first, without the present one.
    order: Vec<(usize, f64)>,
}

impl Ranks {
    /// How many times the fastest is as fast.
    pub(super) fn times(&self) -> f64 {
        self.order.first().map_or(0.0, |(_, times)| *times)
    }

    /// The candidates, the fastest first.
    pub(super) fn best(&self) -> impl Iterator<Item = usize> + '_ {
        let moving = self.order.iter().filter(|(_, times)| *times > 0.0);
        moving.map(|&(candidate, _)| candidate)
    }

    /// These, if there is one that is so many times as fast.
    pub(super) fn better_than(self, times: f64) -> Option<Self> {
        (self.times() > times).then_some(self)
    }
}

pub(super) struct Guard<'a, 's> {
    atlas: &'a Atlas<'s>,
    chart: &'a Chart,
    /// Whether its coordinate has ends at all.
    limited: bool,
    work: MachineWork<f64>,
    unit: Motion<f64>,
    states: BodyStates,
}

impl<'a, 's> Guard<'a, 's> {
    pub(super) fn new(atlas: &'a Atlas<'s>, index: usize) -> Self {
        let chart = &atlas.charts[index];
        let plan = chart.machine.model.plan();
        Self {
            atlas,
            chart,
            limited: plan.range().limits().is_some(),
            work: chart.machine.work(),
            unit: plan.motion(),
            states: BodyStates::new(plan),
        }
    }

    /// Whether the coordinate folds at a state.
    pub(super) fn folds(&mut self, at: &Point) -> Result<Option<Turning>, DynamicsError> {
        if !self.limited || self.on_bridge(at) {
            return Ok(None);
        }
        let ranks = self.ranks(at)?;
        Ok(ranks.better_than(FOLDS).map(Turning::Folds))
    }

    /// Looks at one step, and takes it by `step` where it is good. `left` is then how the chart is left,
    /// from the end of the last step that was taken.
    pub(super) fn watch(
        &mut self,
        before: &Point,
        now: &Point,
        dense: Dense<'_>,
        left: &mut Option<Turning>,
        step: impl FnOnce(Dense<'_>) -> Result<Next, DynamicsError>,
    ) -> Result<Next, DynamicsError> {
        if !self.limited {
            return step(dense);
        }
        if let Some(turning) = self.folds_within(before, now, dense)? {
            // What comes after the fold is on another branch: the step is thrown away.
            *left = Some(turning);
            return Ok(Next::Stop);
        }
        // An explicit method may take a step to where nothing can be evaluated; it is not good.
        let leaves = self.leaves(now)?;
        if let Some(Turning::Folds(ranks)) = &leaves
            && ranks.times() > FAR * FOLDS
        {
            // The nearer the fold, the more an error of the coordinate does to all others.
            *left = Some(Turning::Rough(now.t - before.t));
            return Ok(Next::Stop);
        }
        let next = step(dense)?;
        if next == Next::GoOn {
            *left = leaves;
        }
        Ok(if left.is_some() { Next::Stop } else { next })
    }

    /// How the chart is left after a good step, if it is.
    fn leaves(&mut self, now: &Point) -> Result<Option<Turning>, DynamicsError> {
        let q = now.y[0];
        let mut spans = self.chart.machine.bridges.iter();
        if let Some(span) = spans.find(|span| span.crossed(q)) {
            return Ok(Some(Turning::Crosses {
                crossing: span.crossing,
                above: !span.above,
            }));
        }
        self.folds(now)
    }

    /// How far the range's next end is from a coordinate.
    fn room(&self, q: f64) -> f64 {
        let range = self.chart.machine.model.plan().range();
        match (range.limits(), range.fold(q)) {
            (Some((from, to)), Ok(q)) => (q - from).min(to - q),
            _ => f64::INFINITY,
        }
    }

    fn on_bridge(&self, at: &Point) -> bool {
        self.chart.machine.bridge_at(at.y.first()).is_some()
    }

    /// Whether the coordinate folds within a step: its speed changes sign where others go on. A step that is
    /// longer than the way from there to the range's end is not believed to have returned.
    fn folds_within(
        &mut self,
        before: &Point,
        now: &Point,
        dense: Dense<'_>,
    ) -> Result<Option<Turning>, DynamicsError> {
        let mut last = before.clone();
        for k in 1..=LOOKS {
            let t = before.t + (now.t - before.t) * k as f64 / LOOKS as f64;
            let point = inside(if k == LOOKS { now.t } else { t }, now, dense)?;
            if last.y[1] * point.y[1] < 0.0 {
                let speed = |t: f64| Ok::<_, DynamicsError>(inside(t, now, dense)?.y[1]);
                let zero = root::zero(speed, last.t, point.t)?;
                let at = inside(zero.unwrap_or(point.t), now, dense)?;
                if !self.on_bridge(&at) {
                    match self.ranks(&at) {
                        Ok(ranks) if ranks.times() <= FOLDS => {
                            let way = (at.y[0] - before.y[0])
                                .abs()
                                .max((at.y[0] - now.y[0]).abs());
                            if way > self.room(at.y[0]) {
                                return Ok(Some(Turning::Rough(now.t - before.t)));
                            }
                        }
                        Ok(ranks) => return Ok(Some(Turning::Folds(ranks))),
                        // The zero lies beyond the range's end, by the error of the step.
                        Err(_) => {
                            let ranks = self.ranks(&last).or_else(|_| self.ranks(before))?;
                            return Ok(Some(Turning::Folds(ranks)));
                        }
                    }
                }
            }
            last = point;
        }
        Ok(None)
    }

    /// How fast the candidates are at a state, from the motion at unit speed.
    pub(super) fn ranks(&mut self, at: &Point) -> Result<Ranks, DynamicsError> {
        let machine = &self.chart.machine;
        let plan = machine.model.plan();
        machine.evaluate(at.t, &at.y, &mut self.work)?;
        plan.speeds(&self.work.inner.pose, &[1.0], &mut self.unit);
        self.states.fill(plan, &self.work.inner.pose, &self.unit);
        let all = &self.atlas.coordinates;
        let present = all.iter().find(|c| c.coordinate == self.chart.coordinate);
        let present = present.map_or(1.0, |c| c.weight);
        let mut order: Vec<(usize, f64)> = Vec::with_capacity(all.len());
        for (i, candidate) in all.iter().enumerate() {
            if candidate.coordinate != self.chart.coordinate {
                let [_, speed, _] = self.states.measure(candidate.measured);
                let times = (speed * candidate.weight).abs() / present;
                // A coordinate that others only move by rounding carries nothing.
                order.push((i, if times > SAME { times } else { 0.0 }));
            }
        }
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(Ranks { order })
    }
}
