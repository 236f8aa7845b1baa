//! Crossings from one branch to the next, at the change points in which their ranges end.

use super::candidates::with_actuator;
use super::{Atlas, Chart};
use crate::change_point_fit::{
    ChangePointFit, ChangePointFitError, FitWindow, Result, extrapolate, half_width_for,
};
use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{AssemblyConfiguration, BodyId, RangeLimit};
use dwell_kinetostatics::MachineModel as _;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Two branches separate by about the distance from their change point; one is known to this part of it.
const SEPARATION_FRACTION: f64 = 0.1;

/// A change-point fit with the charts below and above it.
#[derive(Debug, Clone)]
pub(super) struct ChangePointCrossing {
    pub(super) fit: Arc<ChangePointFit>,
    pub(super) charts: [usize; 2],
}

impl Atlas<'_> {
    /// Makes fits for the change points in which a chart's range ends.
    pub(super) fn prepare_crossings(&mut self, chart: usize) {
        for (e, upwards) in [(0, false), (1, true)] {
            let current = &mut self.charts[chart];
            let limit = current.machine.model.plan().range_limits()[e];
            let limit = limit.filter(|limit| limit.change_point);
            let searched = std::mem::replace(&mut current.limits_searched[e], true);
            let known = self.crossings.iter();
            let mut known = known.filter(|c| c.charts[usize::from(!upwards)] == chart);
            let Some(limit) = limit.filter(|_| !searched && known.next().is_none()) else {
                continue;
            };
            if let Err(error) = self.build_crossing(chart, limit, upwards) {
                self.uncrossable.push((limit.q, error));
            }
        }
    }

    /// Builds the fit across a change point, with the chart behind it.
    fn build_crossing(&mut self, chart: usize, limit: RangeLimit, upwards: bool) -> Result<()> {
        let current = &self.charts[chart];
        let plan = current.machine.model.plan();
        if let Some(half_width) = limit.separation {
            return Err(ChangePointFitError::Separate { half_width });
        }
        if current.machine.model.frictions().len() > 0 {
            return Err(ChangePointFitError::Friction);
        }
        if !plan.couplings.is_empty() {
            return Err(ChangePointFitError::Couplings);
        }
        let is_angle = current.coordinate.is_angle();
        let scale = if is_angle { 1.0 } else { self.size };
        let half_width = scale * half_width_for(plan, self.tolerance);
        // Far enough for the branches to have separated.
        let beyond = (1.5 * half_width).max(0.05 * scale);
        let direction = if upwards { 1.0 } else { -1.0 };
        let nodes = [half_width, (4.0 * half_width).max(0.1 * scale)];
        let model = &current.machine.model;
        let mut angles = extrapolate(model, limit.q, upwards, nodes, beyond)?;
        angles.truncate(self.description.mechanism.bodies.len());
        let q = limit.q + direction * beyond;
        let tolerance = SEPARATION_FRACTION * beyond / scale;
        let next = self.next_branch(chart, q, &angles, tolerance)?;
        let (center, angle_shift) = self.change_point_between(limit, next, upwards, half_width)?;
        let period = self.record_period(chart, angle_shift)?;
        let charts = if upwards {
            [chart, next]
        } else {
            [next, chart]
        };
        let branches = charts.map(|c| &self.charts[c].output_model);
        let mechanism = self.description.mechanism;
        let fit = ChangePointFit::new(mechanism, branches, center, [half_width, scale])?;
        let fit = Arc::new(fit);
        let far_bound = if next == chart {
            half_width
        } else {
            fit.fit_radius
        };
        for (c, above, bounds) in [
            (charts[0], false, [-half_width, far_bound]),
            (charts[1], true, [-far_bound, half_width]),
        ] {
            self.charts[c].machine.fit_windows.push(FitWindow {
                fit: fit.clone(),
                crossing: self.crossings.len(),
                above,
                bounds,
                period,
            });
        }
        self.crossings.push(ChangePointCrossing { fit, charts });
        Ok(())
    }

    /// Records that a coordinate returns to a chart after some revolutions (rad); the period that is known
    /// then, if one is.
    fn record_period(&mut self, chart: usize, angle_shift: f64) -> Result<Option<f64>> {
        let coordinate = self.charts[chart].coordinate;
        let mut known = self.periods.iter().filter(|(c, _)| *c == coordinate);
        let known = known.next().map(|(_, period)| *period);
        if angle_shift == 0.0 {
            return Ok(known);
        }
        match known {
            Some(period) if (angle_shift / period).fract() == 0.0 => Ok(known),
            Some(_) => Err(ChangePointFitError::NoContinuation),
            None => {
                self.periods.push((coordinate, angle_shift.abs()));
                let charts = self.charts.iter_mut();
                let charts = charts.filter(|c| c.coordinate == coordinate);
                for window in charts.flat_map(|c| &mut c.machine.fit_windows) {
                    window.period = Some(angle_shift.abs());
                }
                Ok(Some(angle_shift.abs()))
            }
        }
    }

    /// The change point between the end of one range and the beginning of the next, which are equally
    /// far from it. The second number is the whole revolutions between the two, rad.
    fn change_point_between(
        &self,
        limit: RangeLimit,
        next_chart: usize,
        upwards: bool,
        half_width: f64,
    ) -> Result<(f64, f64)> {
        let plan = self.charts[next_chart].machine.model.plan();
        let [low, high] = plan.range_limits();
        let opposite = if upwards { low } else { high };
        let Some(opposite) = opposite else {
            return Ok((limit.q, 0.0));
        };
        let difference = opposite.q - limit.q;
        let angle_shift = if plan.is_angle(0) {
            TAU * (difference / TAU).round()
        } else {
            0.0
        };
        let difference = difference - angle_shift;
        if difference.abs() > 0.5 * half_width {
            return Err(ChangePointFitError::NoContinuation);
        }
        Ok((limit.q + 0.5 * difference, angle_shift))
    }

    /// The chart of the same coordinate on the branch with these angles of the bodies, to a tolerance.
    fn next_branch(
        &mut self,
        chart: usize,
        q: f64,
        angles: &[f64],
        tolerance: f64,
    ) -> Result<usize> {
        let current = &self.charts[chart];
        let (name, coordinate) = (current.name.clone(), current.coordinate);
        let on_branch = |chart: &Chart| {
            let plan = chart.machine.model.plan();
            let (mut pose, mut states) = (plan.pose(), BodyStates::new(plan));
            let placed = plan.positions(&[q], &mut pose).is_ok();
            states.fill(plan, &pose, &plan.motion());
            let near = |(b, angle): (usize, &f64)| {
                let difference = states.body(BodyId(b)).rotation.angle() - angle;
                (difference - TAU * (difference / TAU).round()).abs() < tolerance
            };
            placed && angles.iter().enumerate().all(near)
        };
        let known = |c: &Chart| c.coordinate == coordinate && on_branch(c);
        if let Some(found) = self.charts.iter().position(known) {
            return Ok(found);
        }
        let mechanism = with_actuator(self.description.mechanism, name, coordinate);
        let mechanism = mechanism.ok_or(ChangePointFitError::NoContinuation)?;
        let assembly = AssemblyConfiguration {
            q: vec![q],
            initial_guess: angles.iter().map(|&a| Some(a)).collect(),
            branch_hints: Vec::new(),
        };
        let built = self.build_chart(&mechanism, &assembly);
        let built = built.map_err(|_| ChangePointFitError::NoContinuation)?;
        if !on_branch(&built) {
            return Err(ChangePointFitError::NoContinuation);
        }
        self.charts.push(built);
        Ok(self.charts.len() - 1)
    }
}
