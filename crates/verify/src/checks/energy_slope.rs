//! Check 2: ½ m′ is the slope of the kinetic energy, by differences and by inertia power.
//!
//! ```text
//! ½ m′ = d E_c / dq at q̇ = 1                                 (1)  (Jordi, Zayas & Cardona 2008, eq. 3)
//! ½ m′ = Σ m v·a + I ω α at q̇ = 1, q̈ = 0                     (2)  since dE_c/dt = m q̇ q̈ + ½ m′ q̇³
//! ```
//!
//! (1) is differenced from dense velocities alone; (2) uses dense accelerations and has no step.
//! The third, by a trigonometric interpolant, is in its own file.

use super::row_step;
use crate::comparison::FindingSpec;
use crate::context::CheckContext;
use crate::differences::slope;
use dwell_findings::{Check, Finding};

const DIFFERENCES: FindingSpec<'_> = FindingSpec {
    key: "half-dm-differences",
    check: Check::EnergySlope,
    comparison: "half dm/dq with extrapolated central differences of the dense kinetic energy",
    scale: "the largest half dm/dq",
    tolerance: 1e-11,
    tolerance_reason: "rounding of E_c over the shortest step that the extrapolation uses",
};
const POWER: FindingSpec<'_> = FindingSpec {
    key: "half-dm-power",
    comparison: "half dm/dq with the sum of m v·a + I omega alpha at unit velocity, by dense accelerations",
    tolerance: 1e-13,
    tolerance_reason: "no step; two dense solutions in a row, and terms larger than their sum",
    ..DIFFERENCES
};

/// Both findings.
pub(crate) fn energy_slope(context: &CheckContext<'_>) -> Vec<Finding> {
    let scale = context.scales.half_dm;
    let [differences, power] = context.for_each_position(|position, [differences, power]| {
        let half_dm = context.subject.coefficients(position.q)?.half_dm;
        let step = row_step(context, position.unit_velocity());
        let rounding = position.energy_rounding();
        let slope = slope(step, rounding, |h| context.energy_at(position, h));
        let (slope, error) = slope.map_or((f64::NAN, 0.0), |e| (e.value, e.error));
        let (location, unit) = (|| context.location(position.q), "kg m2/rad");
        position.record(differences, [half_dm - slope, scale, error], unit, location);
        let by_power = half_dm - position.reference.half_dm;
        let bound = position.rounding_bound.half_dm;
        position.record(power, [by_power, scale, bound], unit, location);
        Ok(())
    });
    vec![
        DIFFERENCES.finding(context.domain(), differences),
        POWER.finding(context.domain(), power),
    ]
}
