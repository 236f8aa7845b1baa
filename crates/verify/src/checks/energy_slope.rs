//! Check 2: ½ m′ is the slope of the kinetic energy, by differences and by inertia power.
//!
//! ```text
//! ½ m′ = d E_c / dq at q̇ = 1                                 (1)  (Jordi, Zayas & Cardona 2008, eq. 3)
//! ½ m′ = Σ m v·a + I ω α at q̇ = 1, q̈ = 0                     (2)  since dE_c/dt = m q̇ q̈ + ½ m′ q̇³
//! ```
//!
//! (1) is differenced from dense velocities alone; (2) uses dense accelerations and has no step.
//! The third way, by a trigonometric interpolant, is in its own file.

use super::row_step;
use crate::comparison::FindingSpec;
use crate::context::CheckContext;
use crate::differences::{DerivativeOrder, derivatives};
use dwell_findings::{Check, Finding};

/// Both findings.
pub fn energy_slope(context: &CheckContext<'_>) -> Vec<Finding> {
    let (dense, row) = (&context.dense, context.dense.actuator_row());
    let scale = context.scales.half_dm;
    let [differences, powers] =
        context.for_each_position_into(|position, [differences, powers]| {
            let half_dm = context.subject.coefficients(position.q)?.half_dm;
            let u = position.unit_velocity();
            let slope = derivatives(
                DerivativeOrder::First,
                row_step(context, u),
                position.energy_rounding(),
                |h| {
                    let configuration = dense
                        .step_row(&position.configuration, row, u, position.q + h)
                        .ok()?;
                    Some(vec![dense.kinetic_energy(&configuration, &[(row, 1.0)])])
                },
            );
            let (slope, reference_error) = slope
                .first()
                .map_or((f64::NAN, 0.0), |e| (e.value, e.error));
            let location = || context.location(position.q);
            let unit = "kg m2/rad";
            let comparison = |difference: f64, reference_error: f64| {
                position.comparison(difference, scale, reference_error, unit)
            };
            differences.record(&comparison(half_dm - slope, reference_error), location);
            let by_power = half_dm - position.reference.half_dm;
            powers.record(
                &comparison(by_power, position.rounding_bound.half_dm),
                location,
            );
            Ok(())
        });
    vec![
        FindingSpec {
            key: "half-dm-differences",
            check: Check::EnergySlope,
            comparison: "half dm/dq with extrapolated central differences of the dense kinetic energy",
            scale: "the largest half dm/dq",
            tolerance: 1e-11,
            tolerance_reason: "rounding of E_c over the shortest step that the extrapolation uses",
        }
.finding(context.domain(), differences),
        FindingSpec {
            key: "half-dm-power",
            check: Check::EnergySlope,
            comparison: "half dm/dq with the sum of m v·a + I omega alpha at unit speed, by dense accelerations",
            scale: "the largest half dm/dq",
            tolerance: 1e-13,
            tolerance_reason: "no step; two dense solutions in a row, and terms larger than their sum",
        }
.finding(context.domain(), powers),
    ]
}
