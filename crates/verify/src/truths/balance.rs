//! Truth 7: what the ground does to the mechanism changes its momentum.
//!
//! ```text
//! Σ F of the ground on the mechanism = d/dt Σ m v_G                          (1)
//! Σ M of the ground on the mechanism about O = d/dt Σ (r_G × m v_G + I ω)    (2)
//! ```
//!
//! without loads, O fixed in the ground. Every internal reaction drops out, so this judges the
//! ground reactions and the actuator together, with the momentum differenced in time from dense
//! velocities.
//!
//! Signs: a reaction is the action of a joint's first body on its second. Where the ground is the
//! first body it is what the ground does; where the ground is the second, the opposite is. The
//! force of a prismatic joint acts at the second body's point along the first body's normal, with
//! the joint's moment as a couple.

use super::{MOTIONS, over_motions, pass, place_in, time_step};
use crate::bench::{Bench, FORCE_FLOOR, Site};
use crate::differences::{Estimate, Order, derivatives};
use crate::judge::{Check, Reading, Worst};
use crate::subject::SubjectError;
use dwell_findings::Finding;
use dwell_geometry::Vec2;
use dwell_laws::Polynomial;
use rayon::prelude::*;

/// The balance of one motion at one site: x, y and moment.
struct Balance {
    acting: [f64; 3],
    rate: [Estimate; 3],
    /// Sums of absolute terms of force and of moment.
    terms: [f64; 2],
}

/// Two findings: force and moment.
pub fn balance(bench: &Bench<'_>) -> Vec<Finding> {
    let all: Vec<Result<[Balance; 3], SubjectError>> = bench
        .sites
        .par_iter()
        .map(|site| {
            let [one, two, three] = MOTIONS.map(|motion| at(bench, site, motion));
            Ok([one?, two?, three?])
        })
        .collect();
    let [mut force, mut moment] = [Worst::default(), Worst::default()];
    for i in 0..MOTIONS.len() {
        let largest = |kind: usize| {
            let terms = all.iter().flatten().map(|b| b[i].terms[kind]);
            terms.fold(0.0, f64::max)
        };
        let moments = largest(1);
        let forces = largest(0).max(FORCE_FLOOR * moments / bench.dense.size());
        for (site, balances) in bench.sites.iter().zip(&all) {
            let balance = match balances {
                Ok(balances) => &balances[i],
                Err(error) => {
                    for worst in [&mut force, &mut moment] {
                        worst.refuse(format!("the subject failed to answer: {error}"));
                    }
                    continue;
                }
            };
            for c in 0..3 {
                let (worst, scale, unit) = if c < 2 {
                    (&mut force, forces, "N")
                } else {
                    (&mut moment, moments, "N m")
                };
                let reading = Reading {
                    difference: balance.acting[c] - balance.rate[c].value,
                    scale,
                    own: balance.rate[c].error,
                    unit,
                    condition: site.condition,
                };
                worst.meet(&reading, || place_in(bench, site.q, MOTIONS[i]));
            }
        }
    }
    let check = |key, compared, scale| Check {
        key,
        truth: "7 balance of the whole mechanism",
        compared,
        over: over_motions(bench),
        scale,
        tolerance: 1e-12,
        why: "rounding of the momentum over the shortest time step that the extrapolation uses",
    };
    vec![
        check(
            "balance-force",
            "the ground's forces with the rate of the momentum, differenced in time",
            "the largest sum of absolute forces of the same motion",
        )
        .judge(force),
        check(
            "balance-moment",
            "the ground's moments with the rate of the angular momentum, differenced in time",
            "the largest sum of absolute moments of the same motion",
        )
        .judge(moment),
    ]
}

fn at(bench: &Bench<'_>, site: &Site, motion: [f64; 2]) -> Result<Balance, SubjectError> {
    let dense = &bench.dense;
    let [q_dot, q_ddot] = motion;
    let actions = bench.subject.actions(site.q, q_dot, q_ddot)?;
    let law = Polynomial::motion(site.q, q_dot, q_ddot);
    let rates = derivatives(
        Order::First,
        time_step(bench, site, motion),
        site.energy_rounding(),
        |t| {
            let (closed, x_dot) = pass(bench, site, &law, t)?;
            Some(dense.momentum(&closed, &x_dot).to_vec())
        },
    );
    let rate = std::array::from_fn(|c| {
        rates.get(c).copied().unwrap_or(Estimate {
            value: f64::NAN,
            error: f64::NAN,
        })
    });
    let mut balance = Balance {
        acting: [0.0; 3],
        rate,
        terms: [
            rate[0].value.abs().max(rate[1].value.abs()),
            rate[2].value.abs(),
        ],
    };
    for act in dense.acts(&site.closed, &actions.reactions, &[actions.tau]) {
        if act.body == bench.case.mechanism.ground {
            // What acts on the ground is the opposite of what the ground does.
            balance.acting[0] -= act.force.x;
            balance.acting[1] -= act.force.y;
            balance.acting[2] -= act.moment(Vec2::ZERO);
            balance.terms[0] += act.force.norm();
            balance.terms[1] += act.moment_terms(Vec2::ZERO);
        }
    }
    Ok(balance)
}
