//! Check 4: the actuator's power is the rate of the kinetic energy.
//!
//! ```text
//! τ q̇ = dE_c/dt  along  q(t) = q + q̇ t + ½ q̈ t²              (1)
//! ```
//!
//! without loads. E_c(t) comes from dense velocities on the way, its rate from differences in
//! time; so τ is checked as it is used, with q̇ and q̈ at once.

use super::{MOTIONS, motion_location, motions_domain, state_at, time_step};
use crate::comparison::{FindingSpec, LargestDifference};
use crate::context::{CheckContext, CheckedPosition};
use crate::differences::{DerivativeOrder, Extrapolated, NO_ESTIMATE, derivatives};
use dwell_findings::{Check, Finding};
use dwell_laws::Polynomial;
use rayon::prelude::*;

/// One finding.
pub fn power(context: &CheckContext<'_>) -> Vec<Finding> {
    // The scale of a motion is its largest power anywhere, so all rates come first.
    let rates: Vec<[Extrapolated; 3]> = context
        .positions
        .par_iter()
        .map(|position| MOTIONS.map(|motion| energy_rate(context, position, motion)))
        .collect();
    let scales: [f64; 3] = std::array::from_fn(|i| {
        let [q_dot, q_ddot] = MOTIONS[i];
        // Where nothing but q̈ does work the terms m q̇ q̈ are the largest there are.
        let floor = 1e-3 * context.scales.m * (q_dot * q_ddot).abs();
        rates.iter().map(|r| r[i].value.abs()).fold(floor, f64::max)
    });
    let mut worst = LargestDifference::default();
    for (position, rates) in context.positions.iter().zip(&rates) {
        for ((motion, rate), scale) in MOTIONS.into_iter().zip(rates).zip(scales) {
            match context
                .subject
                .inverse_dynamics(position.q, motion[0], motion[1])
            {
                Ok(inverse_dynamics) => {
                    let comparison = position.comparison(
                        inverse_dynamics.tau * motion[0] - rate.value,
                        scale,
                        rate.error,
                        "W",
                    );
                    worst.record(&comparison, || motion_location(context, position.q, motion));
                }
                Err(error) => worst.record_error(&error),
            }
        }
    }
    vec![
        FindingSpec {
            key: "power",
            check: Check::Power,
            comparison: "tau times q_dot with dE_c/dt, differenced in time along the motion",
            scale: "the largest power of the same motion",
            tolerance: 3e-12,
            tolerance_reason: "rounding of E_c over the shortest time step that the extrapolation uses",
        }
.finding(motions_domain(context), worst),
    ]
}

fn energy_rate(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
    motion: [f64; 2],
) -> Extrapolated {
    let law = Polynomial::motion(position.q, motion[0], motion[1]);
    let rates = derivatives(
        DerivativeOrder::First,
        time_step(context, position, motion),
        position.energy_rounding(),
        |t| {
            let (configuration, x_dot) = state_at(context, position, &law, t)?;
            Some(vec![
                0.5 * context.dense.inertia(&configuration, &x_dot, &x_dot),
            ])
        },
    );
    rates.first().copied().unwrap_or(NO_ESTIMATE)
}
