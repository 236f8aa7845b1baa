//! Steps past places where another assembly branch is near: within a small part of the coordinate the inertia changes
//! as if the motion passed from one branch of a change point to the other. A step over such a part does not see it, and
//! one over the gap between two limit positions goes on where the motion folds back.
//!
//! So steps are shortened there, to a part of the distance, until they resolve it. Where the part is so small that the
//! accelerations in it are rounding, the motion ends before it.

use super::Chart;
use crate::close_branches::{MIN_HALF_WIDTH, is_too_close};
use crate::ode::OdeState;
use dwell_geometry::NearBranch;
use std::f64::consts::TAU;

/// Longest step within a near part, in half-widths, and how far the part extends.
const WIDTHS_PER_STEP: f64 = 0.5;
const EXTENT: f64 = 4.0;
/// A step this much longer than the distance to a part that is too small leads into it, in half-widths of the smallest
/// that is followed.
const CLEARANCE: f64 = 2.0;

/// A step longer than this (rad, or of the mechanism's size) does not end a motion: a shorter one is tried.
const LONG_STEP: f64 = 1e-3;

/// How far from a place a step that failed may have begun (rad, or of the mechanism's size), and how short steps get
/// there before another cause is assumed, in half-widths.
const FAILURE_REACH: f64 = 1.5;
const MIN_STEP_WIDTHS: f64 = 1e-2;

/// What a step meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum NearBranchStep {
    /// Nothing, or it resolves what is there.
    Resolved,
    /// It is too long for what is there.
    TooLong(Passage),
    /// It leads to branches that are too close to distinguish.
    Unresolvable { q: f64, half_width: f64 },
}

/// A place that is passed in short steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passage {
    /// Its coordinate, in the revolution in which it is passed, rad or m.
    center: f64,
    half_width: f64,
    /// How far from it the short steps began.
    from: f64,
}

impl Passage {
    /// Whether a coordinate is so far behind it, or back before it, that steps may grow again.
    pub(super) fn is_passed(&self, q: f64) -> bool {
        let distance = q - self.center;
        let passed = distance * self.from < 0.0 && distance.abs() > 2.0 * EXTENT * self.half_width;
        passed || distance.abs() > 2.0 * self.from.abs() + 4.0 * EXTENT * self.half_width
    }
}

impl Chart {
    /// The period after which near branches come again, rad.
    fn branch_period(&self) -> Option<f64> {
        let plan = self.machine.model.plan();
        let period = plan.range().period();
        period.or_else(|| plan.is_angle(0).then_some(TAU))
    }

    /// What a step meets of the near branches.
    pub(super) fn near_branch_step(&self, [from, to]: [f64; 2]) -> NearBranchStep {
        let plan = self.machine.model.plan();
        let unit = plan.coordinate_unit();
        let period = self.branch_period();
        for near in plan.near_branches() {
            let is_small = is_too_close(near, plan);
            let reach = match is_small {
                true => CLEARANCE * MIN_HALF_WIDTH * unit,
                false => EXTENT * near.half_width,
            };
            let Some(center) = nearest_in_step(near, period, [from, to], reach) else {
                continue;
            };
            let longest = match is_small {
                true => LONG_STEP * unit,
                false => WIDTHS_PER_STEP * near.half_width,
            };
            if (to - from).abs() > longest {
                return NearBranchStep::TooLong(Passage {
                    center,
                    half_width: near.half_width,
                    from: from - center,
                });
            }
            if is_small {
                let (q, half_width) = (center, near.half_width);
                return NearBranchStep::Unresolvable { q, half_width };
            }
        }
        NearBranchStep::Resolved
    }

    /// The place ahead of a state from which a step failed, and a longest step (s) for which it may not; none where that
    /// is not the cause. `last` is the longest step that failed.
    pub(super) fn shorter_step(&self, at: &OdeState, last: Option<f64>) -> Option<(Passage, f64)> {
        let plan = self.machine.model.plan();
        let (q, speed) = (at.y[0], at.y[1].abs());
        let reach = FAILURE_REACH * plan.coordinate_unit();
        let ends = match at.y[1] < 0.0 {
            true => [q - reach, q],
            false => [q, q + reach],
        };
        let period = self.branch_period();
        let mut near = plan.near_branches().iter();
        let (center, half_width) = near.find_map(|near| {
            let center = nearest_in_step(near, period, ends, near.half_width)?;
            Some((center, near.half_width))
        })?;
        let distance = (q - center).abs().max(half_width);
        let first = 0.25 * distance / speed;
        let next = last.map_or(first, |last| first.min(0.25 * last));
        let passage = Passage {
            center,
            half_width,
            from: q - center,
        };
        let is_worth = next.is_finite() && next * speed > MIN_STEP_WIDTHS * half_width;
        is_worth.then_some((passage, next))
    }

    /// Whether a step leads from one revolution of a limited range to another, or passes over a fit window.
    pub(super) fn steps_over_gap(&self, [from, to]: [f64; 2]) -> bool {
        let step = (to - from).abs();
        let windows = &self.machine.fit_windows;
        if windows.iter().any(|window| step > window.fit.fit_radius) {
            return true;
        }
        let plan = self.machine.model.plan();
        let Some((low, _)) = plan.range().limits().filter(|_| windows.is_empty()) else {
            return false;
        };
        let revolution = |q: f64| ((q - low) / TAU).floor();
        plan.is_angle(0) && revolution(from) != revolution(to)
    }
}

/// The coordinate of a near branch, whole periods apart, that a step meets within a distance.
fn nearest_in_step(
    near: &NearBranch,
    period: Option<f64>,
    [from, to]: [f64; 2],
    reach: f64,
) -> Option<f64> {
    let (low, high) = (from.min(to) - reach, from.max(to) + reach);
    let first = match period {
        Some(period) => near.q + period * ((low - near.q) / period).ceil(),
        None => near.q,
    };
    (low..=high).contains(&first).then_some(first)
}
