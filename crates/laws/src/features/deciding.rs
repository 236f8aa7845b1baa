//! The side of a switch throughout an interval.

use super::enclosure::Enclosure;
use super::interval::Interval;
use super::switching::{NOTHING, Pieces, Switch};
use crate::expression::Sides;

/// Distance from a touching point, relative to the time, at which a function differs from the level by more than rounding.
const TOUCH: f64 = 1e-7;
/// Number of rounding errors of time on both sides of a switch within which its value is not trusted.
pub(super) const ROUNDINGS: f64 = 2.0;

pub(super) enum Decision {
    /// Throughout.
    Side(f64),
    /// One switch within the interval, at this value of the function, with the values at the ends relative to it.
    Root {
        level: f64,
        values: [f64; 2],
    },
    Unknown,
}

/// The side of a switch in an interval of a problem that begins at `start`.
pub(super) fn decide(
    pieces: &Pieces,
    switch: &Switch,
    over: Interval,
    start: f64,
    sides: &[Sides],
) -> Decision {
    let enclosure = pieces.enclose_switch(switch, over, sides);
    let [value, slope, _] = enclosure.0;
    if let Some(number) = enclosure.number() {
        return Decision::Side(switch.side(number));
    }
    let level = if switch.at_integers {
        let (low, high) = (value.lo.floor(), value.hi.floor());
        if low == high {
            return Decision::Side(low);
        }
        if high > low + 1.0 {
            return Decision::Unknown;
        }
        high
    } else {
        if value.lo > 0.0 || value.hi < 0.0 {
            return Decision::Side(value.lo.signum());
        }
        0.0
    };
    let undecided = || {
        let resting = || {
            let resting_side = || pieces.resting_side(switch, over, sides);
            (!switch.at_integers).then(resting_side).flatten()
        };
        let touches = touching(pieces, switch, over, start, sides, enclosure, level);
        // In a tail that underflows.
        let vanishes = || {
            let [before, behind] = sides_around(pieces, switch, over, over.lo, 0.0);
            (value.magnitude() < NOTHING && before == behind).then_some(before)
        };
        touches
            .or_else(vanishes)
            .or_else(resting)
            .map_or(Decision::Unknown, Decision::Side)
    };
    if slope.contains(0.0) {
        return undecided();
    }
    let values = [over.lo, over.hi].map(|x| pieces.switch_value(switch, x) - level);
    if values[0] * values[1] < 0.0 {
        return Decision::Root { level, values };
    }
    // The function is monotone; a zero at an end, or beyond it within rounding, is outside.
    let sum = values[0] + values[1];
    match (sum == 0.0 || sum.is_nan(), switch.at_integers) {
        (true, _) => undecided(),
        (false, true) => Decision::Side(if sum > 0.0 { level } else { level - 1.0 }),
        (false, false) => Decision::Side(sum.signum()),
    }
}

/// The side of a switch in an interval of a few rounding errors.
pub(super) fn side_within(pieces: &Pieces, switch: &Switch, over: Interval, start: f64) -> f64 {
    let apart = TOUCH * over.magnitude();
    match sides_around(pieces, switch, over, start, apart) {
        [before, behind] if before == behind => before,
        _ => switch.side(pieces.switch_value(switch, 0.5 * (over.lo + over.hi))),
    }
}

/// The sides of a switch before and after a short interval; equal if nothing precedes it.
fn sides_around(
    pieces: &Pieces,
    switch: &Switch,
    over: Interval,
    start: f64,
    apart: f64,
) -> [f64; 2] {
    let ends = [over.lo - apart, over.hi + apart];
    let side_at = |x: f64| switch.side(pieces.switch_value(switch, x));
    [if ends[0] < start { ends[1] } else { ends[0] }, ends[1]].map(side_at)
}

/// The side of a function that touches its level in an interval within rounding, and does not pass it.
fn touching(
    pieces: &Pieces,
    switch: &Switch,
    over: Interval,
    start: f64,
    sides: &[Sides],
    enclosure: Enclosure,
    level: f64,
) -> Option<f64> {
    /// Multiple of the distance from the level at which a parabola differs from it by a rounding error.
    const CLEARLY: f64 = 4.0;
    let [value, _, second] = enclosure.0;
    let rounding = pieces.rounding(switch, over, sides);
    let farthest = (value.lo - level).abs().max((value.hi - level).abs());
    if farthest > rounding {
        return None;
    }
    let apart = CLEARLY * (rounding / second.magnitude()).sqrt();
    if apart > CLEARLY * over.magnitude() {
        // It stays on the level within rounding.
        let middle = 0.5 * (over.lo + over.hi);
        return Some(switch.side(pieces.switch_value(switch, middle)));
    }
    let apart = apart.max(TOUCH * over.magnitude());
    if over.width() > apart {
        return None;
    }
    let [before, behind] = sides_around(pieces, switch, over, start, apart);
    (before == behind).then_some(before)
}

/// The last instant before a switch and the first after it at which the function has the sign of the respective end.
pub(super) fn bracket(
    pieces: &Pieces,
    switch: &Switch,
    level: f64,
    over: Interval,
    values: [f64; 2],
) -> [f64; 2] {
    let value = |x: f64| pieces.switch_value(switch, x) - level;
    // The boundary of the region with the sign of one end.
    let boundary = |mut inside: f64, mut outside: f64, sign: f64| {
        loop {
            let middle = 0.5 * (inside + outside);
            if middle == inside || middle == outside {
                let rounding = ROUNDINGS * f64::EPSILON * inside.abs();
                return (inside, rounding);
            }
            if value(middle) * sign > 0.0 {
                inside = middle;
            } else {
                outside = middle;
            }
        }
    };
    let (before, rounding) = boundary(over.lo, over.hi, values[0]);
    let (behind, _) = boundary(over.hi, over.lo, values[1]);
    [before - rounding, behind + rounding]
}
