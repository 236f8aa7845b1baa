//! Curves in page pixels: cut at a rectangle, thinned to what can be seen, broken into dashes.

use crate::dash::Dash;
use crate::rect::Rect;

/// Width of the strips within which neighbouring points cannot be distinguished.
const STRIP: f64 = 0.5;

/// The parts of the line through `points` that lie in `rect`; a missing point breaks the line.
pub(crate) fn clipped(
    points: impl IntoIterator<Item = Option<[f64; 2]>>,
    rect: &Rect,
) -> Vec<Vec<[f64; 2]>> {
    let mut runs: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut run: Vec<[f64; 2]> = Vec::new();
    let mut last: Option<[f64; 2]> = None;
    let mut close = |run: &mut Vec<[f64; 2]>| {
        if run.len() > 1 {
            runs.push(thinned(run));
        }
        run.clear();
    };
    for point in points {
        if let (Some(from), Some(to)) = (last, point) {
            match segment(from, to, rect) {
                Some([a, b]) => {
                    if run.last() != Some(&a) {
                        close(&mut run);
                        run.push(a);
                    }
                    run.push(b);
                }
                None => close(&mut run),
            }
        } else {
            close(&mut run);
        }
        last = point;
    }
    close(&mut run);
    runs
}

/// The part of a segment inside a rectangle (Liang and Barsky, 1984).
fn segment(a: [f64; 2], b: [f64; 2], rect: &Rect) -> Option<[[f64; 2]; 2]> {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (p, q) in [
        (-dx, a[0] - rect.x0),
        (dx, rect.x1 - a[0]),
        (-dy, a[1] - rect.y0),
        (dy, rect.y1 - a[1]),
    ] {
        if p == 0.0 {
            if q < 0.0 {
                return None;
            }
        } else if p < 0.0 {
            enter = enter.max(q / p);
        } else {
            leave = leave.min(q / p);
        }
    }
    if enter > leave {
        return None;
    }
    // Ends that are inside stay as they are, to the bit: the caller joins runs by comparing them.
    let at = |t: f64| [a[0] + t * dx, a[1] + t * dy];
    Some([
        if enter > 0.0 { at(enter) } else { a },
        if leave < 1.0 { at(leave) } else { b },
    ])
}

/// The part of a polygon in `rect` (Sutherland and Hodgman, 1974).
pub(crate) fn clipped_area(points: &[[f64; 2]], rect: &Rect) -> Vec<[f64; 2]> {
    // Each edge of the rectangle as a coordinate, a bound and the side that stays.
    let edges = [
        (0, rect.x0, 1.0),
        (0, rect.x1, -1.0),
        (1, rect.y0, 1.0),
        (1, rect.y1, -1.0),
    ];
    edges
        .into_iter()
        .fold(points.to_vec(), |area, (i, bound, side)| {
            let depth = |p: &[f64; 2]| side * (p[i] - bound);
            let mut kept = Vec::with_capacity(area.len() + 4);
            for (k, b) in area.iter().enumerate() {
                let a = &area[(k + area.len() - 1) % area.len()];
                let (da, db) = (depth(a), depth(b));
                if (da < 0.0) != (db < 0.0) {
                    let t = da / (da - db);
                    kept.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
                }
                if db >= 0.0 {
                    kept.push(*b);
                }
            }
            kept
        })
}

/// Of neighbouring points in one narrow upright strip: the first, the extremes and the last. No peak is lost.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let strip = |p: &[f64; 2]| (p[0] / STRIP).floor();
    let mut kept = Vec::new();
    for group in points.chunk_by(|a, b| strip(a) == strip(b)) {
        if group.len() <= 4 {
            kept.extend_from_slice(group);
            continue;
        }
        let by_height = |a: &usize, b: &usize| group[*a][1].total_cmp(&group[*b][1]);
        let lowest = (0..group.len()).min_by(by_height).unwrap_or(0);
        let highest = (0..group.len()).max_by(by_height).unwrap_or(0);
        let mut places = [0, lowest.min(highest), lowest.max(highest), group.len() - 1].to_vec();
        places.dedup();
        kept.extend(places.into_iter().map(|i| group[i]));
    }
    kept
}

/// Points of a segment, both ends among them, no further apart than `spacing`, unless they would be more than `most`.
pub(crate) fn steps(
    [a, b]: [[f64; 2]; 2],
    spacing: f64,
    most: f64,
) -> impl ExactSizeIterator<Item = [f64; 2]> {
    let length = (b[0] - a[0]).hypot(b[1] - a[1]);
    let steps = (length / spacing).ceil().clamp(1.0, most) as u32;
    (0..steps + 1).map(move |i| {
        let t = f64::from(i) / f64::from(steps);
        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
    })
}

/// The line broken into dashes.
pub(crate) fn dashes(points: &[[f64; 2]], dash: Dash) -> Vec<Vec<[f64; 2]>> {
    let mut all = Vec::new();
    let (length_of_dash, gap) = (dash.length.max(1.0), dash.gap.max(1.0));
    // Before the first dash is a part of a gap.
    let mut drawing = dash.offset <= 0.0;
    let mut remaining = if drawing { length_of_dash } else { dash.offset };
    let first = points.first().filter(|_| drawing);
    let mut current: Vec<[f64; 2]> = first.copied().into_iter().collect();
    for pair in points.windows(2) {
        let [mut a, b] = [pair[0], pair[1]];
        let mut length = (b[0] - a[0]).hypot(b[1] - a[1]);
        while length > remaining {
            let t = remaining / length;
            a = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
            length -= remaining;
            if drawing {
                current.push(a);
                all.push(std::mem::take(&mut current));
            } else {
                current = vec![a];
            }
            drawing = !drawing;
            remaining = if drawing { length_of_dash } else { gap };
        }
        remaining -= length;
        if drawing {
            current.push(b);
        }
    }
    if current.len() > 1 {
        all.push(current);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Rect = Rect {
        x0: 0.0,
        y0: 0.0,
        x1: 100.0,
        y1: 100.0,
    };

    #[test]
    fn a_line_is_cut_where_it_leaves_and_where_it_returns() {
        let points = [
            [-50.0, 50.0],
            [50.0, 50.0],
            [50.0, 150.0],
            [60.0, 150.0],
            [60.0, 50.0],
        ];
        let runs = clipped(points.map(Some), &BOX);
        assert_eq!(runs.len(), 2);
        assert_eq!(runs[0], vec![[0.0, 50.0], [50.0, 50.0], [50.0, 100.0]]);
        assert_eq!(runs[1], vec![[60.0, 100.0], [60.0, 50.0]]);
    }

    #[test]
    fn a_missing_point_breaks_the_line_and_a_lone_point_draws_none() {
        let points = [
            Some([1.0, 1.0]),
            Some([2.0, 2.0]),
            None,
            Some([3.0, 3.0]),
            None,
        ];
        assert_eq!(clipped(points, &BOX), vec![vec![[1.0, 1.0], [2.0, 2.0]]]);
    }

    #[test]
    fn thinning_keeps_every_peak() {
        let mut points: Vec<[f64; 2]> = (0..100_000).map(|i| [f64::from(i) * 1e-3, 50.0]).collect();
        points[77_777][1] = 3.0;
        points[12_345][1] = 97.0;
        let runs = clipped(points.into_iter().map(Some), &BOX);
        assert_eq!(runs.len(), 1);
        assert!(runs[0].len() < 1000, "{} points left", runs[0].len());
        assert!(runs[0].iter().any(|p| p[1] == 3.0));
        assert!(runs[0].iter().any(|p| p[1] == 97.0));
        assert_eq!(runs[0].last(), Some(&[99.999, 50.0]));
    }

    #[test]
    fn a_polygon_keeps_the_area_it_has_inside() {
        let area = clipped_area(
            &[[50.0, -50.0], [150.0, -50.0], [150.0, 50.0], [50.0, 50.0]],
            &BOX,
        );
        let pairs = (0..area.len()).map(|i| (area[i], area[(i + 1) % area.len()]));
        let twice: f64 = pairs.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
        assert!((0.5 * twice.abs() - 2500.0).abs() < 1e-9);
        assert!(clipped_area(&[[200.0, 0.0], [300.0, 0.0], [300.0, 50.0]], &BOX).is_empty());
    }

    #[test]
    fn dashes_cover_their_share_of_the_length() {
        let line: Vec<[f64; 2]> = (0..=90).map(|i| [f64::from(i), 0.0]).collect();
        let dashed = dashes(
            &line,
            Dash {
                length: 20.0,
                gap: 10.0,
                offset: 0.0,
            },
        );
        assert_eq!(dashed.len(), 3);
        let drawn: f64 = dashed.iter().map(|d| d[d.len() - 1][0] - d[0][0]).sum();
        assert!((drawn - 60.0).abs() < 1e-9);
    }
}
