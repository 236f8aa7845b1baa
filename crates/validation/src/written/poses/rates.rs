//! Rows against their neighbours: what a column changes by from row to row is the integral of its rate, by the quadrature
//! of Hermite, whose error is estimated from twice the interval.

use super::difference::Differences;
use super::positions::corners;
use super::reading::Reading;
use super::rows::{Rows, largest};

/// Endings of a value, its rate and the rate of that.
const RATES: [[&str; 3]; 5] = [
    ["", ".velocity", ".acceleration"],
    [".angle", ".angular_velocity", ".angular_acceleration"],
    [".x", ".vx", ".ax"],
    [".y", ".vy", ".ay"],
    [".travel", ".travel.velocity", ".travel.acceleration"],
];
/// An estimated error of the quadrature counts this many times: the next order of it is unknown.
const ERROR_FACTOR: f64 = 4.0;

/// Differences between rows, in time; rows next to which a rate jumps (the corners of laws) are left out.
/// None of a file without a time.
pub(crate) fn rates(reading: &Reading, rows: &Rows, file: &str) -> Differences {
    let mut all = Differences::default();
    let Some(time) = rows.columns.get("t") else {
        return all;
    };
    let corners = &corners(reading);
    // Points and travels have one scale, and so have all angles.
    for kinds in [&RATES[..1], &RATES[1..2], &RATES[2..]] {
        let mut found = Vec::new();
        for [value, rate, second] in kinds {
            for (name, values) in rows.ending(value) {
                let Some(stem) = name.strip_suffix(value) else {
                    continue;
                };
                let of = |end: &str| rows.columns.get(&format!("{stem}{end}"));
                if let (Some(first), Some(second)) = (of(rate), of(second)) {
                    found.push((name, [values, first, second]));
                }
            }
        }
        let ends = time.last().zip(time.first());
        let duration = ends.map_or(0.0, |(last, first)| last - first);
        let of = |k: usize| largest(found.iter().flat_map(|(_, columns)| columns[k]));
        let scales =
            [of(0).max(of(1) * duration), of(1).max(of(2) * duration)].map(|s| s / duration);
        for (name, columns) in found {
            let what = format!("{file}, {name}");
            compare(&mut all, columns, time, scales, corners, &what);
        }
    }
    all
}

/// y₂ − y₀ by y′ at three rows and y″ at the ends, and y′ by y″ alone at three rows (Simpson).
fn compare(
    to: &mut Differences,
    [y, v, a]: [&Vec<f64>; 3],
    time: &[f64],
    scales: [f64; 2],
    corners: &[f64],
    what: &str,
) {
    let rows = 2..y.len().saturating_sub(2);
    let at = |column: &[f64], i: usize, k: isize| column[i.wrapping_add_signed(k)];
    // y(+k) − y(−k) = kh/15 (7 y′₋ + 16 y′ + 7 y′₊) + (kh)²/15 (y″₋ − y″₊), of the sixth order.
    let hermite = |i: usize, k: isize| {
        let h = (time[i + 1] - time[i]) * k as f64;
        let sum = 7.0 * (at(v, i, -k) + at(v, i, k)) + 16.0 * at(v, i, 0);
        at(y, i, k) - at(y, i, -k) - h / 15.0 * sum - h * h / 15.0 * (at(a, i, -k) - at(a, i, k))
    };
    let simpson = |i: usize, k: isize| {
        let h = (time[i + 1] - time[i]) * k as f64;
        at(v, i, k) - at(v, i, -k) - h / 3.0 * (at(a, i, -k) + 4.0 * at(a, i, 0) + at(a, i, k))
    };
    let rules: [&dyn Fn(usize, isize) -> f64; 2] = [&hermite, &simpson];
    for i in rows.clone() {
        let h = time[i + 1] - time[i];
        let (low, high) = (time[i - 2], time[i + 2]);
        let slack = 1e-9 * h;
        let is_even =
            (-2..2).all(|k: isize| (at(time, i, k + 1) - at(time, i, k) - h).abs() < 1e-6 * h);
        if !is_even
            || corners
                .iter()
                .any(|c| low - slack <= *c && *c <= high + slack)
        {
            continue;
        }
        for (order, rule) in rules.into_iter().enumerate() {
            // Twice the interval has 2⁷ and 2⁵ times the error; that of the next rows counts, too, for it may pass through zero.
            let near_rows = (i - 2..=i + 2).filter(|k| rows.contains(k));
            let far = near_rows.fold(0.0, |max: f64, k| max.max(rule(k, 2).abs()));
            let estimate = far / [128.0, 32.0][order];
            let difference = (rule(i, 1).abs() - ERROR_FACTOR * estimate).max(0.0) / h;
            to.add(difference, scales[order], "1/s", || {
                format!("{what}, row {i}, derivative {}", order + 1)
            });
        }
    }
}
