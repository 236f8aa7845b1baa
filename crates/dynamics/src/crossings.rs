//! When the margins that are watched during an integration fall below zero within a step: how far a switch, or a contact, is from a
//! change.

use crate::error::Result;
use dwell_numerics::root;

/// Roundings of time within which two events happen together.
const TOGETHER: f64 = 16.0 * f64::EPSILON;

/// Whether an event happens together with another, s.
pub(crate) fn are_together(t: f64, other: f64) -> bool {
    (t - other).abs() <= TOGETHER * t.abs()
}

/// The first of some events, and all that happen together with it.
pub(crate) fn first_of<E>(
    all: impl Iterator<Item = Result<Option<(f64, E)>>>,
) -> Result<Option<(f64, Vec<E>)>> {
    let mut first: Option<(f64, Vec<E>)> = None;
    for found in all {
        let Some((at, event)) = found? else { continue };
        match &mut first {
            Some((t, events)) if are_together(at, *t) => events.push(event),
            Some((t, _)) if at > *t => {}
            _ => first = Some((at, vec![event])),
        }
    }
    Ok(first)
}

/// When a margin falls below zero up to the last point of it, known at two earlier ones, the latest first: between the points, it may
/// also fall and rise again. Before the search for the root, it is evaluated where it should be below zero.
pub(crate) fn fall_below_zero(
    earlier: [(f64, f64); 2],
    last: (f64, f64),
    mut margin_at: impl FnMut(f64) -> Result<f64>,
) -> Result<Option<f64>> {
    let lowest = vertex([earlier[1], earlier[0], last]);
    let Some(end) = (last.1 < 0.0).then_some(last.0).or(lowest) else {
        return Ok(None);
    };
    let is_below = margin_at(end)? < 0.0;
    if !is_below {
        return Ok(None);
    }
    let from = if end > earlier[0].0 {
        earlier[0]
    } else {
        earlier[1]
    };
    root::find(margin_at, from.0, end)
}

/// A time soon after the start of an interval at which a margin is positive, and a later one at which it is not: a short rebound or a
/// narrow window, which the motion soon passes again, lies between two points of a step.
pub(crate) fn first_inside(
    [start, end]: [f64; 2],
    mut margin_at: impl FnMut(f64) -> Result<f64>,
) -> Result<Option<[f64; 2]>> {
    /// Halvings of the interval.
    const HALVINGS: usize = 48;
    let mut until = end;
    for _ in 0..HALVINGS {
        let at = start + 0.5 * (until - start);
        if at <= start || at >= until {
            break;
        }
        if margin_at(at)? > 0.0 {
            return Ok(Some([at, until]));
        }
        until = at;
    }
    Ok(None)
}

/// When the margin of a switch that was not positive at the start of an interval, and is negative at its end, is passed: within a rounding
/// at the start, soon after it, or where a margin that rested on zero leaves it.
pub(crate) fn passed_soon(
    over: [f64; 2],
    mut margin_at: impl FnMut(f64) -> Result<f64>,
) -> Result<Option<f64>> {
    if let Some([inside, until]) = first_inside(over, &mut margin_at)? {
        return root::find(margin_at, inside, until);
    }
    let [start, end] = over;
    if margin_at(start)? < 0.0 {
        return Ok(Some(start));
    }
    let side_at = |at| Ok(if margin_at(at)? < 0.0 { -1.0 } else { 1.0 });
    root::find(side_at, start, end)
}

/// The time of the minimum of the parabola through three points, between the outer ones; `None` if it does not come
/// near zero, or starts from there.
fn vertex([(t0, m0), (t1, m1), (t2, m2)]: [(f64, f64); 3]) -> Option<f64> {
    let (before, after) = ((m1 - m0) / (t1 - t0), (m2 - m1) / (t2 - t1));
    let curvature = (after - before) / (t2 - t0);
    let slope = before + curvature * (t1 - t0);
    let lowest = t1 - 0.5 * slope / curvature;
    let value = m1 - 0.25 * slope * slope / curvature;
    let near = value < 0.1 * m0.min(m1).min(m2);
    (m0 > 0.0 && curvature > 0.0 && near && lowest > t0 && lowest < t2).then_some(lowest)
}
