//! Check 2, by the slope of the trigonometric interpolant of m over a full revolution.
//!
//! With N equidistant nodes qⱼ, N even, and mⱼ = 2 E_c there at unit velocity,
//!
//! ```text
//! c_k = (1/N) Σⱼ mⱼ e^(−i k qⱼ),  |k| < N/2                  (1)
//! ½ m′(q) ≈ Re Σ_{0<k<N/2} i k c_k e^(i k q)                 (2)
//! ```
//!
//! m is periodic and smooth, so the error falls faster than any power of 1/N: the method uses no step and no local
//! information. N is doubled until the slope at the checked positions no longer changes.
//!
//! The nodes are followed from one to the next by the dense side itself, which also shows that the
//! mechanism comes back to where it started after a revolution.

use crate::comparison::{FindingSpec, LargestDifference};
use crate::constraint_closing::Configuration;
use crate::context::{CheckContext, CheckedPosition};
use crate::error::{DenseError, Result};
use dwell_findings::{Check, Finding};
use dwell_geometry::Range;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Nodes to begin with, and the most.
const MIN_NODES: usize = 32;
const MAX_NODES: usize = 4096;
/// The slope has converged when doubling N moves it by less than this of its largest value, or by
/// less than the rounding of m times N, which more nodes only make worse.
const CONVERGENCE_TOLERANCE: f64 = 1e-13;

const SPECTRAL: FindingSpec<'_> = FindingSpec {
    key: "half-dm-spectral",
    check: Check::EnergySlope,
    comparison: "half dm/dq with the derivative of the trigonometric interpolant of 2 E_c",
    scale: "the largest half dm/dq",
    tolerance: 1e-12,
    tolerance_reason: "the interpolant multiplies the rounding of m by the order of its last harmonics",
};

/// One finding over a full revolution; none over part of a revolution, because m is then not periodic.
pub(crate) fn spectral(context: &CheckContext<'_>) -> Vec<Finding> {
    let Some(first) = context.positions.first() else {
        return Vec::new();
    };
    if context.case.range != Range::Full {
        return Vec::new();
    }
    let (nodes, worst) = match converged_slopes(context, first) {
        Ok((slopes, error, count)) => (count, compare_slopes(context, &slopes, error)),
        Err(message) => (0, LargestDifference::failed(message)),
    };
    let domain = context.domain();
    let domain = format!("{domain}, interpolated from {nodes} equidistant nodes");
    vec![SPECTRAL.finding(domain, worst)]
}

fn compare_slopes(context: &CheckContext<'_>, slopes: &[f64], error: f64) -> LargestDifference {
    let mut worst = LargestDifference::default();
    for (position, slope) in context.positions.iter().zip(slopes) {
        match context.subject.coefficients(position.q) {
            Ok(coefficients) => {
                let difference = coefficients.half_dm - slope;
                let numbers = [difference, context.scales.half_dm, error];
                let location = || context.location(position.q);
                position.record(&mut worst, numbers, "kg m2/rad", location);
            }
            Err(error) => worst.record_error(&error),
        }
    }
    worst
}

/// The slopes at all positions, how much the last doubling moved them, and the number of nodes.
fn converged_slopes(
    context: &CheckContext<'_>,
    first: &CheckedPosition,
) -> Result<(Vec<f64>, f64, usize), String> {
    let mut nodes = follow_revolution(context, first, MIN_NODES)
        .map_err(|e| format!("it cannot be followed through a full revolution: {e}"))?;
    let mut slopes = interpolant_slopes(context, first.q, &nodes);
    loop {
        nodes = double_nodes(context, first.q, &nodes).map_err(|e| e.to_string())?;
        let finer = interpolant_slopes(context, first.q, &nodes);
        let changes = slopes.iter().zip(&finer).map(|(a, b)| (a - b).abs());
        let change = changes.fold(0.0, f64::max);
        slopes = finer;
        let rounding = f64::EPSILON * context.scales.m * fraction(nodes.len(), 1);
        let small = (CONVERGENCE_TOLERANCE * context.scales.half_dm).max(rounding);
        if change <= small || nodes.len() >= MAX_NODES {
            return Ok((slopes, change, nodes.len()));
        }
    }
}

/// Follows one revolution from a position; the end must be the start again.
fn follow_revolution(
    context: &CheckContext<'_>,
    first: &CheckedPosition,
    count: usize,
) -> Result<Vec<Configuration>> {
    let (dense, row) = (&context.dense, context.dense.actuator_row());
    let mut nodes = vec![first.configuration.clone()];
    let mut here = first.configuration.clone();
    for j in 1..=count {
        here = dense.follow(&here, row, first.q + TAU * fraction(j, count))?;
        nodes.push(here.clone());
    }
    nodes.truncate(count);
    let gap = dense.distance(&here, &first.configuration);
    if gap.is_nan() || gap > 1e-9 {
        return Err(DenseError::NotClosed {
            steps: count,
            last_step: gap,
        });
    }
    Ok(nodes)
}

/// Twice the nodes: each new one from its neighbour before.
fn double_nodes(
    context: &CheckContext<'_>,
    start: f64,
    nodes: &[Configuration],
) -> Result<Vec<Configuration>> {
    let (dense, row) = (&context.dense, context.dense.actuator_row());
    let count = 2 * nodes.len();
    let pair = |(j, node): (usize, &Configuration)| {
        let q = start + TAU * fraction(2 * j + 1, count);
        Ok([node.clone(), dense.follow(node, row, q)?])
    };
    let pairs: Result<Vec<_>> = nodes.par_iter().enumerate().map(pair).collect();
    Ok(pairs?.into_iter().flatten().collect())
}

/// Eq. (2) at all positions.
fn interpolant_slopes(context: &CheckContext<'_>, start: f64, nodes: &[Configuration]) -> Vec<f64> {
    let row = context.dense.actuator_row();
    let count = nodes.len();
    let m = |node| 2.0 * context.dense.kinetic_energy(node, &[(row, 1.0)]);
    let m: Vec<f64> = nodes.iter().map(m).collect();
    // A constant has no slope, but would lend its rounding to every harmonic.
    let mean = m.iter().sum::<f64>() / count as f64;
    let on_circle = |j| (TAU * fraction(j, count)).sin_cos();
    let circle: Vec<(f64, f64)> = (0..count).map(on_circle).collect();
    let harmonic = |k: usize| {
        let (mut cos, mut sin) = (0.0, 0.0);
        for (j, m) in m.iter().enumerate() {
            let (s, c) = circle[(j * k) % count];
            cos += (m - mean) * c;
            sin += (m - mean) * s;
        }
        (cos * fraction(2, count), sin * fraction(2, count))
    };
    let harmonics: Vec<(f64, f64)> = (0..count / 2).into_par_iter().map(harmonic).collect();
    let slope = |q: f64| -> f64 {
        let terms = harmonics.iter().zip(0_u32..).map(|(&(cos, sin), k)| {
            let k = f64::from(k);
            let (s, c) = (k * (q - start)).sin_cos();
            k * (sin * c - cos * s)
        });
        0.5 * terms.sum::<f64>()
    };
    let positions = context.positions.par_iter();
    positions.map(|position| slope(position.q)).collect()
}

/// j / n of two counts that are small enough to be exact.
fn fraction(j: usize, n: usize) -> f64 {
    j as f64 / n as f64
}
