//! Truth 2, third way: the slope of the trigonometric interpolant of m over a full turn.
//!
//! With N equidistant nodes qⱼ, N even, and mⱼ = 2 E_c there at unit speed,
//!
//! ```text
//! c_k = (1/N) Σⱼ mⱼ e^(−i k qⱼ),  |k| < N/2                  (1)
//! ½ m′(q) ≈ Re Σ_{0<k<N/2} i k c_k e^(i k q)                 (2)
//! ```
//!
//! m is periodic and smooth, so the error falls faster than any power of 1/N: no step, and no
//! local information at all. N is doubled until the slope at the judged positions no longer moves.
//!
//! The nodes are followed from one to the next by the dense side itself, which also shows that the
//! mechanism comes back to where it started after a turn.

use crate::bench::{Bench, Site};
use crate::closing::Closed;
use crate::dense::DenseError;
use crate::judge::{Check, Reading, Worst};
use dwell_findings::Finding;
use dwell_geometry::Range;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Nodes to begin with, and the most.
const FEWEST: usize = 32;
const MOST: usize = 4096;
/// The slope has converged when doubling N moves it by less than this of its largest value, or by
/// less than the rounding of m times N, which more nodes only make worse.
const CONVERGED: f64 = 1e-13;

/// One finding over a full turn; none over part of one, where m is not periodic.
pub fn spectral(bench: &Bench<'_>) -> Vec<Finding> {
    let Some(first) = bench.sites.first() else {
        return Vec::new();
    };
    if bench.case.range != Range::Full {
        return Vec::new();
    }
    let mut nodes = 0;
    let worst = match converged(bench, first) {
        Ok((slopes, own, count)) => {
            nodes = count;
            judge(bench, &slopes, own)
        }
        Err(message) => {
            let mut worst = Worst::default();
            worst.refuse(message);
            worst
        }
    };
    vec![
        Check {
            key: "half-dm-spectral",
            truth: "2 slope of the kinetic energy",
            compared: "half dm/dq with the derivative of the trigonometric interpolant of 2 E_c",
            over: format!(
                "{}, interpolated from {nodes} equidistant nodes",
                bench.over()
            ),
            scale: "the largest half dm/dq",
            tolerance: 1e-12,
            why: "the interpolant multiplies the rounding of m by the order of its last harmonics",
        }
        .judge(worst),
    ]
}

fn judge(bench: &Bench<'_>, slopes: &[f64], own: f64) -> Worst {
    let mut worst = Worst::default();
    for (site, slope) in bench.sites.iter().zip(slopes) {
        match bench.subject.coefficients(site.q) {
            Ok(coefficients) => {
                let reading = Reading {
                    difference: coefficients.half_dm - slope,
                    scale: bench.scales.half_dm,
                    own,
                    unit: "kg m2/rad",
                    condition: site.condition,
                };
                worst.meet(&reading, || bench.place(site.q));
            }
            Err(error) => worst.refuse(format!("the subject failed to answer: {error}")),
        }
    }
    worst
}

/// The slopes at all sites, how much the last doubling moved them, and the number of nodes.
fn converged(bench: &Bench<'_>, first: &Site) -> Result<(Vec<f64>, f64, usize), String> {
    let mut nodes = turn(bench, first, FEWEST)
        .map_err(|e| format!("not to be followed through a full turn: {e}"))?;
    let mut slopes = slopes(bench, first.q, &nodes);
    loop {
        nodes = halve(bench, first.q, &nodes).map_err(|e| e.to_string())?;
        let finer = self::slopes(bench, first.q, &nodes);
        let moved = slopes
            .iter()
            .zip(&finer)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        slopes = finer;
        let rounding = f64::EPSILON * bench.scales.m * fraction(nodes.len(), 1);
        let small = (CONVERGED * bench.scales.half_dm).max(rounding);
        if moved <= small || nodes.len() >= MOST {
            return Ok((slopes, moved, nodes.len()));
        }
    }
}

/// Follows one turn from a site; the end must be the start again.
fn turn(bench: &Bench<'_>, first: &Site, count: usize) -> Result<Vec<Closed>, DenseError> {
    let (dense, row) = (&bench.dense, bench.dense.actuator_row());
    let mut nodes = vec![first.closed.clone()];
    let mut here = first.closed.clone();
    for j in 1..=count {
        here = dense.follow(&here, row, first.q + TAU * fraction(j, count))?;
        nodes.push(here.clone());
    }
    nodes.truncate(count);
    let mut gap: Vec<_> = here
        .x
        .iter()
        .zip(&first.closed.x)
        .map(|(a, b)| a - b)
        .collect();
    for angle in gap.iter_mut().skip(2).step_by(3) {
        *angle -= TAU * (*angle / TAU).round();
    }
    let moved = dense.reach(&gap);
    if moved.is_nan() || moved > 1e-9 {
        return Err(DenseError::NotClosed {
            steps: count,
            moved,
        });
    }
    Ok(nodes)
}

/// Twice the nodes: each new one from its neighbour before.
fn halve(bench: &Bench<'_>, start: f64, nodes: &[Closed]) -> Result<Vec<Closed>, DenseError> {
    let (dense, row) = (&bench.dense, bench.dense.actuator_row());
    let count = 2 * nodes.len();
    let pairs: Result<Vec<_>, DenseError> = nodes
        .par_iter()
        .enumerate()
        .map(|(j, node)| {
            let q = start + TAU * fraction(2 * j + 1, count);
            Ok([node.clone(), dense.follow(node, row, q)?])
        })
        .collect();
    Ok(pairs?.into_iter().flatten().collect())
}

/// Eq. (2) at all sites.
fn slopes(bench: &Bench<'_>, start: f64, nodes: &[Closed]) -> Vec<f64> {
    let row = bench.dense.actuator_row();
    let count = nodes.len();
    let m: Vec<f64> = nodes
        .iter()
        .map(|node| 2.0 * bench.dense.kinetic_energy(node, &[(row, 1.0)]))
        .collect();
    // A constant has no slope, but would lend its rounding to every harmonic.
    let mean = m.iter().sum::<f64>() / f64::from(u32::try_from(count).unwrap_or(u32::MAX));
    let circle: Vec<(f64, f64)> = (0..count)
        .map(|j| (TAU * fraction(j, count)).sin_cos())
        .collect();
    let harmonics: Vec<(f64, f64)> = (0..count / 2)
        .into_par_iter()
        .map(|k| {
            let (mut cos, mut sin) = (0.0, 0.0);
            for (j, m) in m.iter().enumerate() {
                let (s, c) = circle[(j * k) % count];
                cos += (m - mean) * c;
                sin += (m - mean) * s;
            }
            (cos * fraction(2, count), sin * fraction(2, count))
        })
        .collect();
    let slope = |q: f64| -> f64 {
        let terms = harmonics.iter().zip(0_u32..).map(|(&(cos, sin), k)| {
            let k = f64::from(k);
            let (s, c) = (k * (q - start)).sin_cos();
            k * (sin * c - cos * s)
        });
        0.5 * terms.sum::<f64>()
    };
    bench.sites.par_iter().map(|site| slope(site.q)).collect()
}

/// j / n of two counts that are small enough to be exact.
fn fraction(j: usize, n: usize) -> f64 {
    let exact = |count: usize| f64::from(u32::try_from(count).unwrap_or(u32::MAX));
    exact(j) / exact(n)
}
