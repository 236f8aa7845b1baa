//! Truth 4: the actuator's power is the rate of the kinetic energy.
//!
//! ```text
//! τ q̇ = dE_c/dt  along  q(t) = q + q̇ t + ½ q̈ t²              (1)
//! ```
//!
//! without loads. E_c(t) comes from dense velocities on the way, its rate from differences in
//! time; so τ is judged as it is used, with q̇ and q̈ at once.

use super::{MOTIONS, over_motions, pass, place_in, time_step};
use crate::bench::{Bench, Site};
use crate::differences::{Estimate, Order, derivatives};
use crate::judge::{Check, Reading, Worst};
use dwell_findings::Finding;
use dwell_laws::Polynomial;
use rayon::prelude::*;

/// One finding.
pub fn power(bench: &Bench<'_>) -> Vec<Finding> {
    // The scale of a motion is its largest power anywhere, so all rates come first.
    let rates: Vec<[Estimate; 3]> = bench
        .sites
        .par_iter()
        .map(|site| MOTIONS.map(|motion| energy_rate(bench, site, motion)))
        .collect();
    let scales: [f64; 3] = std::array::from_fn(|i| {
        let [q_dot, q_ddot] = MOTIONS[i];
        // Where nothing but q̈ does work the terms m q̇ q̈ are the largest there are.
        let floor = 1e-3 * bench.scales.m * (q_dot * q_ddot).abs();
        rates.iter().map(|r| r[i].value.abs()).fold(floor, f64::max)
    });
    let mut all = Worst::default();
    for (site, rates) in bench.sites.iter().zip(&rates) {
        for ((motion, rate), scale) in MOTIONS.into_iter().zip(rates).zip(scales) {
            match bench.subject.actions(site.q, motion[0], motion[1]) {
                Ok(actions) => {
                    let reading = Reading {
                        difference: actions.tau * motion[0] - rate.value,
                        scale,
                        own: rate.error,
                        unit: "W",
                        condition: site.condition,
                    };
                    all.meet(&reading, || place_in(bench, site.q, motion));
                }
                Err(error) => all.refuse(format!("the subject failed to answer: {error}")),
            }
        }
    }
    vec![
        Check {
            key: "power",
            truth: "4 power",
            compared: "tau times q_dot with dE_c/dt, differenced in time along the motion",
            over: over_motions(bench),
            scale: "the largest power of the same motion",
            tolerance: 3e-12,
            why: "rounding of E_c over the shortest time step that the extrapolation uses",
        }
        .judge(all),
    ]
}

fn energy_rate(bench: &Bench<'_>, site: &Site, motion: [f64; 2]) -> Estimate {
    let law = Polynomial::motion(site.q, motion[0], motion[1]);
    let rates = derivatives(
        Order::First,
        time_step(bench, site, motion),
        site.energy_rounding(),
        |t| {
            let (closed, x_dot) = pass(bench, site, &law, t)?;
            Some(vec![0.5 * bench.dense.inertia(&closed, &x_dot, &x_dot)])
        },
    );
    rates.first().copied().unwrap_or(Estimate {
        value: f64::NAN,
        error: f64::NAN,
    })
}
