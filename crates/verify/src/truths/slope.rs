//! Truth 2: ½ m′ is the slope of the kinetic energy, by differences and by inertia power.
//!
//! ```text
//! ½ m′ = d E_c / dq at q̇ = 1                                 (1)  (Jordi, Zayas & Cardona 2008, eq. 3)
//! ½ m′ = Σ m v·a + I ω α at q̇ = 1, q̈ = 0                     (2)  since dE_c/dt = m q̇ q̈ + ½ m′ q̇³
//! ```
//!
//! (1) is differenced from dense velocities alone; (2) uses dense accelerations and has no step.
//! The third way, by a trigonometric interpolant, is in its own file.

use super::row_step;
use crate::bench::Bench;
use crate::differences::{Order, derivatives};
use crate::judge::{Check, Reading};
use dwell_findings::Finding;

/// Both findings.
pub fn slope(bench: &Bench<'_>) -> Vec<Finding> {
    let (dense, row) = (&bench.dense, bench.dense.actuator_row());
    let scale = bench.scales.half_dm;
    let [differences, powers] = bench.each_site_into(|site, [differences, powers]| {
        let half_dm = bench.subject.coefficients(site.q)?.half_dm;
        let u = site.speed();
        let slope = derivatives(
            Order::First,
            row_step(bench, u),
            site.energy_rounding(),
            |h| {
                let closed = dense.step(&site.closed, row, u, site.q + h).ok()?;
                Some(vec![dense.kinetic_energy(&closed, &[(row, 1.0)])])
            },
        );
        let (slope, own) = slope
            .first()
            .map_or((f64::NAN, 0.0), |e| (e.value, e.error));
        let place = || bench.place(site.q);
        let unit = "kg m2/rad";
        let reading = |difference: f64, own: f64| Reading {
            difference,
            scale,
            own,
            unit,
            condition: site.condition,
        };
        differences.meet(&reading(half_dm - slope, own), place);
        let by_power = half_dm - site.exact.half_dm;
        powers.meet(&reading(by_power, site.noise.half_dm), place);
        Ok(())
    });
    vec![
        Check {
            key: "half-dm-differences",
            truth: "2 slope of the kinetic energy",
            compared: "half dm/dq with extrapolated central differences of the dense kinetic energy",
            over: bench.over(),
            scale: "the largest half dm/dq",
            tolerance: 1e-11,
            why: "rounding of E_c over the shortest step that the extrapolation uses",
        }
        .judge(differences),
        Check {
            key: "half-dm-power",
            truth: "2 slope of the kinetic energy",
            compared: "half dm/dq with the sum of m v·a + I omega alpha at unit speed, by dense accelerations",
            over: bench.over(),
            scale: "the largest half dm/dq",
            tolerance: 1e-13,
            why: "no step; two dense solutions in a row, and terms larger than their sum",
        }
        .judge(powers),
    ]
}
