//! Maxima between two points at which a function is not smooth: at a corner, as of the magnitude of a force that passes through zero, and
//! at a jump, as when friction changes its sign. Three points about such a place do not show it; the straight lines through the points
//! before and after it do.

use super::maximum::{Bracket, Point};

/// Ratio of the change of a slope between two points to that next to them which indicates a corner; for values, a jump. The slope of a
/// smooth function changes about twice as much.
const SHARP: f64 = 8.0;
/// A gain of less than this fraction of the largest value is not searched for.
const MIN_GAIN: f64 = 1e-6;
/// Halvings of the interval in which a jump is.
const MAX_HALVINGS: usize = 40;

/// Where a maximum may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sharp {
    /// Within three points, the middle one not below the others.
    Corner(Bracket),
    /// Next to a jump between two points.
    Jump([Point; 2]),
}

/// The corner and the jump at which `sign` times the values, in parts between events, may be highest, each with a value next to it, if they
/// may exceed the largest value so far. `scale` is the largest size of a value.
pub(super) fn sharp_maxima(
    parts: &[&[Point]],
    sign: f64,
    largest: f64,
    scale: f64,
) -> Vec<(f64, Sharp)> {
    let slope = |[a, b]: [Point; 2]| sign * (b[1] - a[1]) / (b[0] - a[0]);
    let mut best: [Option<SharpMaximum>; 2] = [None; 2];
    let wanted = largest + MIN_GAIN * scale;
    // By `for_each`, which is a loop for each part.
    let all = parts.iter().flat_map(|part| part.windows(6));
    all.for_each(|six| {
        let [low, high] = [six[2], six[3]];
        // Nearly all places are decided by differences alone: no corner without a rise before and a fall behind it, no jump that is
        // smaller than the changes next to it.
        let step = |[a, b]: [Point; 2]| sign * (b[1] - a[1]);
        let [ahead, within, behind] = [[six[1], low], [low, high], [high, six[4]]].map(step);
        let may_be_corner = ahead > 0.0 && behind < 0.0;
        if !may_be_corner && within.abs() <= ahead.abs().max(behind.abs()) {
            return;
        }
        let [low_value, high_value] = [sign * low[1], sign * high[1]];
        let value = low_value.max(high_value);
        let maximum = |reach, sharp| SharpMaximum {
            reach,
            value,
            sharp,
        };
        let [before, rise, after] = [[six[1], low], [low, high], [high, six[4]]].map(slope);
        let changes = [
            slope([six[0], six[1]]) - before,
            after - slope([six[4], six[5]]),
        ];
        let change = changes[0].abs().max(changes[1].abs());
        let signed = |[u, value]: Point| [u, sign * value];
        let width = high[0] - low[0];
        // Along the straight lines through the points on either side.
        let [onward, backward] = [low_value + before * width, high_value - after * width];
        if (rise - 0.5 * (before + after)).abs() > SHARP * change.max(before.abs()).max(after.abs())
        {
            let reach = value.max(onward).max(backward);
            let sharp = Sharp::Jump([low, high].map(signed));
            take(&mut best[1], maximum(reach, sharp), wanted);
        } else if before - after > SHARP * change && before > 0.0 && after < 0.0 {
            let reach =
                low_value + before * (high_value - low_value - after * width) / (before - after);
            let bracket = if low_value >= high_value {
                (signed(six[1]), Some(signed(low)), signed(high))
            } else {
                (signed(low), Some(signed(high)), signed(six[4]))
            };
            take(&mut best[0], maximum(reach, Sharp::Corner(bracket)), wanted);
        }
    });
    let found = best.into_iter().flatten();
    found.map(|found| (found.value, found.sharp)).collect()
}

/// Where a maximum may be, how high it may be there, and a value next to it.
#[derive(Clone, Copy)]
struct SharpMaximum {
    reach: f64,
    value: f64,
    sharp: Sharp,
}

/// The one that may be higher, if that is above what is wanted.
fn take(best: &mut Option<SharpMaximum>, found: SharpMaximum, wanted: f64) {
    if found.reach > wanted && best.is_none_or(|best| found.reach > best.reach) {
        *best = Some(found);
    }
}

/// The higher side of a jump between two points, as near to it as numbers tell; every value is evaluated.
pub(super) fn side_of_jump(
    value: &mut dyn FnMut(f64) -> Option<f64>,
    [mut low, mut high]: [Point; 2],
) -> Option<Point> {
    for _ in 0..MAX_HALVINGS {
        let u = 0.5 * (low[0] + high[0]);
        if u <= low[0] || u >= high[0] {
            break;
        }
        let middle = [u, value(u)?];
        if (middle[1] - low[1]).abs() < (high[1] - middle[1]).abs() {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(if high[1] > low[1] { high } else { low })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(f: impl Fn(f64) -> f64) -> Vec<Point> {
        let at = (0..40).map(|k| 0.1 * f64::from(k));
        at.map(|u| [u, f(u)]).collect()
    }

    /// −|sin| is zero at π, where the nearest points have −0.04; a smooth maximum is none.
    #[test]
    fn a_corner_between_points_is_found() {
        let all = points(|u| -(u + 0.3).sin().abs());
        let found = sharp_maxima(&[&all], 1.0, -0.05, 1.0);
        let [(_, Sharp::Corner((a, _, b)))] = found[..] else {
            panic!("{found:?}");
        };
        let at = std::f64::consts::PI - 0.3;
        assert!(a[0] < at && at < b[0], "{a:?} {b:?}");
        assert!(sharp_maxima(&[&points(f64::sin)], 1.0, 0.9, 1.0).is_empty());
        assert!(sharp_maxima(&[&points(f64::sin)], -1.0, -2.0, 1.0).is_empty());
    }

    /// A curve that rises to 1 at u = 1.234 and falls to −1 there.
    #[test]
    fn the_side_of_a_jump_is_found() {
        let f = |u: f64| if u < 1.234 { u / 1.234 } else { -1.0 };
        let found = sharp_maxima(&[&points(f)], 1.0, f(1.2), 1.0);
        let [(_, Sharp::Jump(pair))] = found[..] else {
            panic!("{found:?}");
        };
        let [at, value] = side_of_jump(&mut |u| Some(f(u)), pair).expect("a value");
        assert!((at - 1.234).abs() < 1e-10 && (value - 1.0).abs() < 1e-10);
    }
}
