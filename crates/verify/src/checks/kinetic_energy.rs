//! Check 1: the generalised inertia is twice the kinetic energy at unit velocity.
//!
//! ```text
//! E_c = ½ m(q) q̇²   ⇒   m = 2 E_c at q̇ = 1                   (1)  (Jordi, Zayas & Cardona 2008, eq. 2)
//! ```
//!
//! The subject finds m as the actuator force at q̈ = 1, q̇ = 0: accelerations and a transposed
//! solution. Here there are dense velocities and a sum of squares.
//!
//! A balanced crank's share of m is the same everywhere and may be nearly all of it, so that an
//! error in the rest would look small. The second finding is relative to the part of m that
//! varies. The constant part is then subtracted from both sides, which leaves it the rounding of
//! two numbers of the size of m.

use crate::comparison::FindingSpec;
use crate::context::CheckContext;
use dwell_findings::{Check, Finding};

/// Tolerance for the quotient of two sums of rounded squares: 45 units in the last place, for a
/// chain of some ten rounded operations per body.
const TOLERANCE: f64 = 1e-14;

const WHOLE: FindingSpec<'_> = FindingSpec {
    key: "m-energy",
    check: Check::KineticEnergy,
    comparison: "m with 2 E_c at unit velocity, by dense velocities",
    scale: "the largest m",
    tolerance: TOLERANCE,
    tolerance_reason: "some ten roundings per body on either side, 45 units in the last place",
};
const VARYING: FindingSpec<'_> = FindingSpec {
    key: "m-energy-varying",
    comparison: "m with 2 E_c at unit velocity, without the bodies whose share is constant",
    scale: "the largest part of m that varies",
    tolerance_reason: "as for m, and m itself is rounded with its constant part",
    ..WHOLE
};

/// Both findings; the second only if some body's share in m varies.
pub(crate) fn kinetic_energy(context: &CheckContext<'_>) -> Vec<Finding> {
    let (dense, scales) = (&context.dense, &context.scales);
    let is_constant = |b: &usize| !context.varying_bodies.contains(b);
    let constant: Vec<usize> = (0..dense.bodies.len()).filter(is_constant).collect();
    let [whole, varying] = context.for_each_position(|position, [whole, varying]| {
        let m = context.subject.coefficients(position.q)?.m;
        let location = || context.location(position.q);
        let bound = position.rounding_bound.m;
        let numbers = [m - position.reference.m, scales.m, bound];
        position.record(whole, numbers, "kg m2", location);
        // A few roundings of m itself at least.
        let bound = bound.max(0.5 * f64::EPSILON * scales.m);
        let share = |bodies| position.inertia_share(dense, bodies);
        let difference = (m - share(&constant)) - share(&context.varying_bodies);
        let numbers = [difference, scales.m_varying, bound];
        position.record(varying, numbers, "kg m2", location);
        Ok(())
    });
    let mut findings = vec![WHOLE.finding(context.domain(), whole)];
    if scales.m_varying > 0.0 {
        findings.push(VARYING.finding(context.domain(), varying));
    }
    findings
}
