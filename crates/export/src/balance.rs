//! Single precision rounds every coefficient, and so the tabulated slope and its integral m fit each other to a rounding
//! only. A motion without loads obeys d ln q̇² = −2 (½m′)/m dq, and in each revolution its q̇² changes by the same factor
//!
//! ```text
//! exp(−∮ 2 (½m′)/m dq)                                                                    (1)
//! ```
//!
//! which is one of the mechanism. A million steps take hundreds of revolutions. So coefficients of the tabulated slopes are changed
//! by single roundings until the integral in (1) vanishes.

use crate::machine::Domain;
use crate::part::{HEAD, TERMS};

/// Roundings by which a coefficient may be changed, up or down.
const MAX_ROUNDINGS: i32 = 2;
/// Changes in all.
const MAX_CHANGES: usize = 256;

/// Where a cell begins and ends, as positions in it.
struct Ends {
    begin: usize,
    x: [f64; 2],
}

/// Changes the even coefficients of the slope of m, the first curve, by roundings until the integral (1) vanishes.
pub(crate) fn balance(cells: &mut [f64], stride: usize, index: &[u16], domain: Domain) {
    if domain.revolutions == 0 || index.is_empty() {
        return;
    }
    let step = domain.length() / index.len() as f64;
    let count = cells.len() / stride;
    let ends = (0..count).map(|cell| {
        let begin = cell * stride;
        let bins = index.iter().filter(|&&c| usize::from(c) == cell).count();
        let first = index.iter().position(|&c| usize::from(c) == cell);
        let first = first.unwrap_or(0);
        let x = [first, first + bins]
            .map(|bin| (domain.from + step * bin as f64 - cells[begin]) * cells[begin + 1]);
        Ends { begin, x }
    });
    let ends: Vec<Ends> = ends.collect();
    let mut changes: Vec<f64> = ends.iter().map(|e| log_change(cells, e)).collect();
    let mut used = vec![0_i32; cells.len()];
    for _ in 0..MAX_CHANGES {
        let sum: f64 = changes.iter().sum();
        let mut best = Change {
            rest: sum.abs(),
            ..Change::default()
        };
        for (cell, at) in ends.iter().enumerate() {
            for place in (at.begin + HEAD + 1..).step_by(2).take(TERMS / 2) {
                let now = cells[place];
                for sign in [-1, 1] {
                    if (used[place] + sign).abs() > MAX_ROUNDINGS {
                        continue;
                    }
                    cells[place] = next(now, sign);
                    let changed = log_change(cells, at);
                    let rest = (sum - changes[cell] + changed).abs();
                    if rest < best.rest {
                        best = Change {
                            rest,
                            cell,
                            place,
                            sign,
                            changed,
                        };
                    }
                }
                cells[place] = now;
            }
        }
        if best.sign == 0 {
            return;
        }
        cells[best.place] = next(cells[best.place], best.sign);
        changes[best.cell] = best.changed;
        used[best.place] += best.sign;
    }
}

/// The change of one coefficient that leaves the smallest remainder.
#[derive(Debug, Default)]
struct Change {
    rest: f64,
    cell: usize,
    place: usize,
    sign: i32,
    changed: f64,
}

/// The next number of single precision.
fn next(value: f64, sign: i32) -> f64 {
    let single = value as f32;
    f64::from(if sign > 0 {
        single.next_up()
    } else {
        single.next_down()
    })
}

/// The integral of 2 (½m′)/m over a cell, with m as single precision has it, by Gauss's rule of five points on panels.
fn log_change(cells: &[f64], at: &Ends) -> f64 {
    const RULE: [[f64; 2]; 5] = [
        [-0.906_179_845_938_664, 0.236_926_885_056_189_08],
        [-0.538_469_310_105_683, 0.478_628_670_499_366_47],
        [0.0, 0.568_888_888_888_888_9],
        [0.538_469_310_105_683, 0.478_628_670_499_366_47],
        [0.906_179_845_938_664, 0.236_926_885_056_189_08],
    ];
    const PANELS: usize = 8;
    let numbers = &cells[at.begin..];
    let [_, per_half, width, m] = [numbers[0], numbers[1], numbers[2], numbers[HEAD]];
    let g = &numbers[HEAD + 1..][..TERMS];
    let ratio = |x: f64| {
        let terms = g.iter().enumerate().rev();
        let slope = terms.clone().fold(0.0, |sum, (_, g)| sum * x + g);
        // The code multiplies by these quotients, and that product is rounded, too.
        let part = |j: usize, g: f64| f64::from(g as f32 * (1.0 / (j + 1) as f64) as f32);
        let integral = terms.fold(0.0, |sum, (j, g)| (sum + part(j, *g)) * x);
        slope / (m + width * integral)
    };
    let half_panel = (at.x[1] - at.x[0]) / (2 * PANELS) as f64;
    let panels = (0..PANELS).map(|panel| {
        let middle = at.x[0] + half_panel * (2 * panel + 1) as f64;
        let points = RULE.iter();
        let sum: f64 = points
            .map(|[x, weight]| weight * ratio(middle + half_panel * x))
            .sum();
        sum * half_panel
    });
    let sum: f64 = panels.sum();
    let found = 2.0 * sum / per_half;
    // Without inertia there is no motion.
    if found.is_finite() { found } else { 0.0 }
}
