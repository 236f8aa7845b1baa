//! Truth 1: the generalised inertia is twice the kinetic energy at unit speed.
//!
//! ```text
//! E_c = ½ m(q) q̇²   ⇒   m = 2 E_c at q̇ = 1                   (1)  (Jordi, Zayas & Cardona 2008, eq. 2)
//! ```
//!
//! The subject finds m as the actuator's action at q̈ = 1, q̇ = 0: accelerations and a transposed
//! solution. Here there are dense velocities and a sum of squares.
//!
//! A balanced crank's share of m is the same everywhere and may be nearly all of it, so that an
//! error in the rest would look small. The second finding is relative to the part of m that
//! varies. The constant part is then subtracted from both sides, which leaves it the rounding of
//! two numbers of the size of m.

use crate::bench::Bench;
use crate::judge::{Check, Reading};
use dwell_findings::Finding;

/// Tolerance for the quotient of two sums of rounded squares: 45 units in the last place, for a
/// chain of some ten rounded operations per body.
const TOLERANCE: f64 = 1e-14;

/// Both findings; the second only if some body's share in m varies.
pub fn energy(bench: &Bench<'_>) -> Vec<Finding> {
    let (dense, scales) = (&bench.dense, &bench.scales);
    let constant: Vec<usize> = (0..dense.bodies.len())
        .filter(|b| !bench.varying.contains(b))
        .collect();
    let [whole, varying] = bench.each_site_into(|site, [whole, varying]| {
        let m = bench.subject.coefficients(site.q)?.m;
        let (at, u) = (&site.closed, site.speed());
        let share = |bodies: &[usize]| -> f64 {
            bodies.iter().map(|&b| dense.inertia_of(b, at, u, u)).sum()
        };
        let place = || bench.place(site.q);
        let reading = Reading {
            difference: m - site.exact.m,
            scale: scales.m,
            own: site.noise.m,
            unit: "kg m2",
            condition: site.condition,
        };
        whole.meet(&reading, place);
        let reading = Reading {
            difference: (m - share(&constant)) - share(&bench.varying),
            scale: scales.m_varying,
            // A few roundings of m itself at least.
            own: site.noise.m.max(0.5 * f64::EPSILON * scales.m),
            unit: "kg m2",
            condition: site.condition,
        };
        varying.meet(&reading, place);
        Ok(())
    });
    let mut findings = vec![
        Check {
            key: "m-energy",
            truth: "1 kinetic energy",
            compared: "m with 2 E_c at unit speed, by dense velocities",
            over: bench.over(),
            scale: "the largest m",
            tolerance: TOLERANCE,
            why: "some ten roundings per body on either side, 45 units in the last place",
        }
        .judge(whole),
    ];
    if scales.m_varying > 0.0 {
        findings.push(
            Check {
                key: "m-energy-varying",
                truth: "1 kinetic energy",
                compared: "m with 2 E_c at unit speed, without the bodies whose share is constant",
                over: bench.over(),
                scale: "the largest part of m that varies",
                tolerance: TOLERANCE,
                why: "as for m, and m itself is rounded with its constant part",
            }
            .judge(varying),
        );
    }
    findings
}
