//! From one branch to the next, across the change points in which their ranges end.

use super::candidates::actuator;
use super::{Atlas, Chart};
use crate::bridge::{Bridge, BridgeError, Span, ahead, half_window};
use dwell_geometry::measure::BodyStates;
use dwell_geometry::{BodyId, End, Mechanism, Start};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Two branches part by about the distance from their change point; one is known to this part of it.
const PARTED: f64 = 0.1;

/// A bridge with the charts below and above it.
#[derive(Debug, Clone)]
pub(super) struct Crossing {
    pub(super) bridge: Arc<Bridge>,
    pub(super) charts: [usize; 2],
}

impl Atlas<'_> {
    /// Looks for bridges at the change points in which a chart's range ends.
    pub(super) fn prepare(&mut self, chart: usize) {
        for (e, upwards) in [(0, false), (1, true)] {
            let own = &mut self.charts[chart];
            let end = own.machine.model.plan().ends()[e].filter(|end| end.change_point);
            let looked = std::mem::replace(&mut own.looked[e], true);
            let known = self.crossings.iter();
            let mut known = known.filter(|c| c.charts[usize::from(!upwards)] == chart);
            let Some(end) = end.filter(|_| !looked && known.next().is_none()) else {
                continue;
            };
            if let Err(error) = self.span(chart, end, upwards) {
                self.refused.push((end.q, error));
            }
        }
    }

    /// Builds the bridge across a change point, with the chart behind it.
    fn span(&mut self, chart: usize, end: End, upwards: bool) -> Result<(), BridgeError> {
        let own = &self.charts[chart];
        let plan = own.machine.model.plan();
        if own.machine.model.frictions().len() > 0 {
            return Err(BridgeError::Friction);
        }
        if plan.relations() > 0 {
            return Err(BridgeError::Relations);
        }
        let unit = if own.coordinate.is_angle() {
            1.0
        } else {
            self.size
        };
        let half = unit * half_window(plan, self.tolerance);
        // Far enough for the branches to have parted.
        let beyond = (1.5 * half).max(0.05 * unit);
        let way = if upwards { 1.0 } else { -1.0 };
        let to = (4.0 * half).max(0.1 * unit);
        let mut angles = ahead(&own.machine.model, end.q, upwards, [half, to], beyond)?;
        angles.truncate(self.site.mechanism.bodies.len());
        let q = end.q + way * beyond;
        let there = self.behind(chart, q, &angles, PARTED * beyond / unit)?;
        let (center, turns) = self.middle(end, there, upwards, half)?;
        let period = self.close_ring(chart, turns)?;
        let charts = if upwards {
            [chart, there]
        } else {
            [there, chart]
        };
        let sides = charts.map(|c| &self.charts[c].shown);
        let bridge = Bridge::new(self.site.mechanism, sides, center, [half, unit])?;
        let bridge = Arc::new(bridge);
        let far = if there == chart { half } else { bridge.reach };
        for (c, above, reach) in [
            (charts[0], false, [-half, far]),
            (charts[1], true, [-far, half]),
        ] {
            self.charts[c].machine.bridges.push(Span {
                bridge: bridge.clone(),
                crossing: self.crossings.len(),
                above,
                reach,
                period,
            });
        }
        self.crossings.push(Crossing { bridge, charts });
        Ok(())
    }

    /// Notes that a coordinate comes back to a chart after some turns (rad); the period that is known
    /// then, if one is.
    fn close_ring(&mut self, chart: usize, turns: f64) -> Result<Option<f64>, BridgeError> {
        let coordinate = self.charts[chart].coordinate;
        let mut known = self.periods.iter().filter(|(c, _)| *c == coordinate);
        let known = known.next().map(|(_, period)| *period);
        if turns == 0.0 {
            return Ok(known);
        }
        match known {
            Some(period) if (turns / period).fract() == 0.0 => Ok(known),
            Some(_) => Err(BridgeError::NotBehind),
            None => {
                self.periods.push((coordinate, turns.abs()));
                let charts = self
                    .charts
                    .iter_mut()
                    .filter(|c| c.coordinate == coordinate);
                for span in charts.flat_map(|c| &mut c.machine.bridges) {
                    span.period = Some(turns.abs());
                }
                Ok(Some(turns.abs()))
            }
        }
    }

    /// The change point between the end of one range and the beginning of the next: both stop equally
    /// far from it. The second number is the turns between the two, rad.
    fn middle(
        &self,
        end: End,
        there: usize,
        upwards: bool,
        half: f64,
    ) -> Result<(f64, f64), BridgeError> {
        let plan = self.charts[there].machine.model.plan();
        let [low, high] = plan.ends();
        let opposite = if upwards { low } else { high };
        let Some(opposite) = opposite else {
            return Ok((end.q, 0.0));
        };
        let apart = opposite.q - end.q;
        let turns = if plan.is_angle(0) {
            TAU * (apart / TAU).round()
        } else {
            0.0
        };
        let apart = apart - turns;
        if apart.abs() > 0.5 * half {
            return Err(BridgeError::NotBehind);
        }
        Ok((end.q + 0.5 * apart, turns))
    }

    /// The chart of the same coordinate on the branch with these angles of the bodies, to so much.
    fn behind(
        &mut self,
        chart: usize,
        q: f64,
        angles: &[f64],
        within: f64,
    ) -> Result<usize, BridgeError> {
        let own = &self.charts[chart];
        let (name, coordinate) = (own.name.clone(), own.coordinate);
        let on_branch = |chart: &Chart| {
            let plan = chart.machine.model.plan();
            let (mut pose, mut states) = (plan.pose(), BodyStates::new(plan));
            let placed = plan.place(&[q], &mut pose).is_ok();
            states.fill(plan, &pose, &plan.motion());
            let near = |(b, angle): (usize, &f64)| {
                let off = states.body(BodyId(b)).turn.angle() - angle;
                (off - TAU * (off / TAU).round()).abs() < within
            };
            placed && angles.iter().enumerate().all(near)
        };
        let known = |c: &Chart| c.coordinate == coordinate && on_branch(c);
        if let Some(found) = self.charts.iter().position(known) {
            return Ok(found);
        }
        let actuator = actuator(self.site.mechanism, name, coordinate);
        let mechanism = Mechanism {
            actuators: vec![actuator.ok_or(BridgeError::NotBehind)?],
            ..self.site.mechanism.clone()
        };
        let start = Start {
            q: vec![q],
            rough: angles.iter().map(|&a| Some(a)).collect(),
            joints: Vec::new(),
        };
        let built = self.build(&mechanism, &start);
        let built = built.map_err(|_| BridgeError::NotBehind)?;
        if !on_branch(&built) {
            return Err(BridgeError::NotBehind);
        }
        self.charts.push(built);
        Ok(self.charts.len() - 1)
    }
}
