//! The maximum of a function that is known at some points: about a local maximum there, three points enclose one of the function. It is
//! found by parabolas and golden sections.

/// Highest number of evaluations for one extremum.
const MAX_EVALUATIONS: usize = 40;
/// Local extrema whose parabolas are lower than the highest by more than this part of it are not searched; of the others as many as this.
/// Where several tie, as in an optimised mechanism, each may be the highest.
const BAND: f64 = 0.03;
const MOST: usize = 12;
/// Width of the interval, relative to the first, at which an extremum is found, and the relative gain that is none.
const WIDTH: f64 = 1e-7;
pub(super) const NO_GAIN: f64 = 1e-13;
/// Fraction of the first or last interval; the value there shows whether the extremum is the end itself.
const NEXT_TO_END: f64 = 1e-3;
/// The part of an interval that a golden section cuts off.
const GOLDEN: f64 = 0.381_966_011_250_105;

/// A position: its parameter, and a value.
pub(crate) type Point = [f64; 2];

/// The highest point of a function that is known at some points, also between them: it is evaluated about those of its local
/// maxima there that are nearly as high as the highest. `None` if no point has a value.
pub(crate) fn highest_between(
    points: &[Point],
    value: &mut dyn FnMut(f64) -> Option<f64>,
) -> Option<Point> {
    let higher = |a: Point, b: Point| if b[1] > a[1] { b } else { a };
    high_points(points, value).into_iter().reduce(higher)
}

/// The highest of some points of a function, then its local maxima that are nearly as high.
pub(crate) fn high_points(
    points: &[Point],
    value: &mut dyn FnMut(f64) -> Option<f64>,
) -> Vec<Point> {
    let known = points.iter().copied().filter(|[_, v]| !v.is_nan());
    let scale = known.clone().map(|[_, v]| v.abs()).fold(0.0, f64::max);
    let higher = |a: Point, b: Point| if b[1] > a[1] { b } else { a };
    let Some(highest) = known.reduce(higher) else {
        return Vec::new();
    };
    let parts: Vec<&[Point]> = between_events(points).collect();
    let lowest = highest[1] - BAND * highest[1].abs();
    let brackets = promising(&parts, 1.0, lowest, MOST).into_iter();
    let found = brackets.filter_map(|(_, bracket)| refine_maximum(value, bracket, scale));
    std::iter::once(highest).chain(found).collect()
}

/// Parts of the spacing of known points at which the derivatives of a function about its extremum are taken, and steps of Newton's method.
const STENCIL: f64 = 0.3;
const LEAST: f64 = 3e-3;
const STEPS: usize = 3;

/// The place of an extremum, near `u` among points of this spacing, where the derivative is zero: an extreme value is flat, so that a search
/// by values leaves half of the digits of its place. It is `u` where the function is not known on both sides.
pub(crate) fn stationary_near(
    value: &mut dyn FnMut(f64) -> Option<f64>,
    u: f64,
    [from, to]: [f64; 2],
    spacing: f64,
) -> f64 {
    let step = STENCIL * spacing.min(u - from).min(to - u);
    if step < LEAST * spacing {
        return u;
    }
    let mut at = u;
    for _ in 0..STEPS {
        let mut values = [0.0; 7];
        for (k, value_there) in values.iter_mut().enumerate() {
            match value(at + (k as f64 - 3.0) * step) {
                Some(found) => *value_there = found,
                None => return u,
            }
        }
        let [a, b, c, d, e, f, g] = values;
        // Central differences of sixth order.
        let slope = (45.0 * (e - c) - 9.0 * (f - b) + (g - a)) / (60.0 * step);
        let curvature =
            (270.0 * (e + c) - 27.0 * (f + b) + 2.0 * (g + a) - 490.0 * d) / (180.0 * step * step);
        let next = at - slope / curvature;
        if !next.is_finite() || (next - u).abs() > spacing {
            return u;
        }
        at = next;
    }
    at
}

/// Extremes that differ by less, as a part of the larger, tie.
const TIE: f64 = 1e-6;

/// A highest place, and others that are as high.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TiedExtremum {
    pub(crate) at: f64,
    pub(crate) value: f64,
    pub(crate) ties: Vec<f64>,
}

/// The highest of some [high points](high_points) with those that tie with it, of a function that is known between two places at
/// points of this spacing. If its values at both are the same they are one place of a turn.
pub(crate) fn extremum_with_ties(
    high: &[Point],
    [from, to]: [f64; 2],
    spacing: f64,
) -> Option<TiedExtremum> {
    let higher = |a: Point, b: Point| if b[1] > a[1] { b } else { a };
    let [at, value] = high.iter().copied().reduce(higher)?;
    let mut ties: Vec<f64> = Vec::new();
    for &[u, other] in high {
        let apart = |v: f64| {
            let distance = (u - v).abs();
            distance.min((to - from - distance).abs()) > spacing
        };
        if value - other <= TIE * value.abs() && apart(at) && ties.iter().all(|tie| apart(*tie)) {
            ties.push(u);
        }
    }
    Some(TiedExtremum { at, value, ties })
}

/// Three points, the middle one not below the others; the middle one may be missing at an end.
pub(super) type Bracket = (Point, Option<Point>, Point);

/// The local maxima of `sign` times the values in whose neighbourhood a value above the lowest may be, each with its value: the first of
/// them, and up to `count` whose parabolas are highest.
pub(super) fn promising(
    parts: &[&[Point]],
    sign: f64,
    lowest: f64,
    count: usize,
) -> Vec<(f64, Bracket)> {
    let mut all = Vec::new();
    for part in parts {
        add_peaks(part, sign, lowest, &mut all);
    }
    let first = all.first().copied();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all.truncate(count);
    if let Some(first) = first.filter(|first| all.iter().all(|other| other.2 != first.2)) {
        all.push(first);
    }
    let bracket = |(_, value, bracket)| (value, bracket);
    all.into_iter().map(bracket).collect()
}

/// The parts of a function's points between the instants at which it may jump: there, both its limits are known, a rounding apart.
pub(super) fn between_events(points: &[Point]) -> impl Iterator<Item = &[Point]> {
    // Nearly all are far from each other, which is cheaper to see.
    points.chunk_by(|a, b| b[0] - a[0] > f64::EPSILON * b[0].abs() || b[0] > a[0].next_up())
}

/// The value that a local maximum may have, its largest point, and its bracket.
type Peak = (f64, f64, Bracket);

/// Adds the local maxima of `sign` times the values that may be above the lowest that counts.
fn add_peaks(points: &[Point], sign: f64, lowest: f64, all: &mut Vec<Peak>) {
    let Some(last) = points.len().checked_sub(1).filter(|last| *last > 0) else {
        return;
    };
    let signed = |i: usize| [points[i][0], sign * points[i][1]];
    let end = |i: usize| {
        let value = sign * points[i][1];
        let ends = (signed(i.max(1) - 1), signed((i + 1).min(last)));
        (value >= lowest).then_some((value, value, (ends.0, None, ends.1)))
    };
    all.extend(end(0));
    for (i, around) in points.windows(3).enumerate() {
        // Not by `map`, which is a call where the program is optimised for size.
        let (low, value, high) = (
            sign * around[0][1],
            sign * around[1][1],
            sign * around[2][1],
        );
        let is_peak = value >= low && value >= high;
        if is_peak && (value > low || value > high) {
            let (before, point, after) = (signed(i), signed(i + 1), signed(i + 2));
            let [_, top] = vertex([before, point, after]).unwrap_or(point);
            // A parabola through three points may be too low by as much again.
            if value + 2.0 * (top - value).max(0.0) >= lowest {
                all.push((top, value, (before, Some(point), after)));
            }
        }
    }
    all.extend(end(last));
}

/// The maximum of the parabola through three points; none if it has none.
fn vertex([a, c, b]: [Point; 3]) -> Option<Point> {
    let slope = (c[1] - a[1]) / (c[0] - a[0]);
    let curvature = ((b[1] - c[1]) / (b[0] - c[0]) - slope) / (b[0] - a[0]);
    if curvature.is_nan() || curvature >= 0.0 {
        return None;
    }
    let u = 0.5 * (a[0] + c[0] - slope / curvature);
    let value = a[1] + slope * (u - a[0]) + curvature * (u - a[0]) * (u - c[0]);
    (u > a[0] && u < b[0]).then_some([u, value])
}

/// The largest value that is found within a bracket; every value is evaluated.
pub(super) fn refine_maximum(
    value: &mut dyn FnMut(f64) -> Option<f64>,
    (mut a, middle, mut b): Bracket,
    scale: f64,
) -> Option<Point> {
    let mut c = match middle {
        Some(middle) => middle,
        None => {
            let (end, next) = if a[1] >= b[1] { (a, b) } else { (b, a) };
            let u = end[0] + NEXT_TO_END * (next[0] - end[0]);
            let inside = [u, value(u)?];
            if inside[1] <= end[1] {
                return Some(end);
            }
            inside
        }
    };
    let width = WIDTH * (b[0] - a[0]);
    let mut before = f64::INFINITY;
    for k in 0..MAX_EVALUATIONS {
        let is_slow = k % 3 == 2 && {
            let slow = b[0] - a[0] > 0.5 * before;
            before = b[0] - a[0];
            slow
        };
        let top = vertex([a, c, b]).filter(|_| !is_slow);
        if top.is_some_and(|[_, top]| top - c[1] <= NO_GAIN * scale) {
            break;
        }
        let u = match top {
            Some([u, _]) if (u - c[0]).abs() > width => u,
            Some([u, _]) => c[0] + width.copysign(u - c[0]),
            None if c[0] - a[0] > b[0] - c[0] => c[0] - GOLDEN * (c[0] - a[0]),
            None => c[0] + GOLDEN * (b[0] - c[0]),
        };
        if u <= a[0] || u >= b[0] || b[0] - a[0] <= 2.0 * width {
            break;
        }
        let Some(found) = value(u).map(|value| [u, value]) else {
            break;
        };
        let (left, right) = if u < c[0] { (found, c) } else { (c, found) };
        if left[1] >= right[1] {
            (c, b) = (left, right);
        } else {
            (a, c) = (left, right);
        }
    }
    Some(c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of three nearly equal peaks the narrow one is the highest, but between 64 positions its parabola is the lowest.
    #[test]
    fn the_highest_of_three_nearly_equal_peaks_is_found() {
        let peaks = [(10.0, 3.0, 1.0), (30.0, 3.0, 1.0), (50.5, 1.5, 1.0005)];
        let at = |u: f64| {
            let bump = |&(top, width, height): &(f64, f64, f64)| {
                height * (-0.5 * ((64.0 * u - top) / width).powi(2)).exp()
            };
            peaks.iter().map(bump).sum::<f64>()
        };
        let points: Vec<Point> = (0..=64)
            .map(|k| f64::from(k) / 64.0)
            .map(|u| [u, at(u)])
            .collect();
        let [place, value] = highest_between(&points, &mut |u| Some(at(u))).expect("a value");
        assert!(
            (64.0 * place - 50.5).abs() < 1e-3 && value > 1.0004,
            "{place} {value}"
        );
    }
}
